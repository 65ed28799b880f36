// Unit tests of confinement: what a confined process can do, and what each layer refuses.

#include "server/run/confinement.h"
#include "tests/unit/helper_cmocka.h"

#include <errno.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <pthread.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED 1
#else
#define IS_SANITIZED 0
#endif

enum { BIT_FILES = 1 << METRICS_LAYER_FILES, BIT_CALLS = 1 << METRICS_LAYER_CALLS };

enum { EXIT_NOT_CONFINED = 200, EXIT_SIGNALLED = 201 };

// Something to try. Returns 0 when it was done, else its errno.
typedef int attempt(void);

static int tcp = -1; // a socket from before

static int result_of(long value)
{
    return value < 0 ? errno : 0;
}

static int open_to_read(void)
{
    return result_of(open("/etc/passwd", O_RDONLY | O_CLOEXEC));
}

static int make_file(void)
{
    return result_of(open("/tmp/beltflow-confined", O_WRONLY | O_CREAT | O_CLOEXEC, 0600));
}

static int make_folder(void)
{
    return result_of(mkdir("/tmp/beltflow-confined", 0700));
}

static int list_folder(void)
{
    return result_of(open("/", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

static int stat_path(void)
{
    struct stat info;
    return result_of(stat("/etc/passwd", &info));
}

static int make_socket(void)
{
    return result_of(socket(AF_INET, SOCK_STREAM, 0));
}

static int make_unix_socket(void)
{
    return result_of(socket(AF_UNIX, SOCK_DGRAM, 0));
}

static int connect_tcp(void)
{
    const struct sockaddr_in nobody = { .sin_family = AF_INET,
                                        .sin_port = htons(9),
                                        .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    return result_of(connect(tcp, (const struct sockaddr *)&nobody, sizeof nobody));
}

static int execute(void)
{
    char *argv[] = { (char[]){ "true" }, NULL };
    return result_of(execve("/bin/true", argv, NULL));
}

static int make_process(void)
{
    const pid_t pid = fork();

    if (pid == 0)
        _exit(0);
    return result_of(pid);
}

static int signal_parent(void)
{
    return result_of(kill(getppid(), SIGURG));
}

static int trace_parent(void)
{
    return result_of(ptrace(PTRACE_ATTACH, getppid(), NULL, NULL));
}

static int map_code(void)
{
    void *code = mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    return code == MAP_FAILED ? errno : 0;
}

static int raise_limit(void)
{
    const struct rlimit all = { RLIM_INFINITY, RLIM_INFINITY };
    return result_of(setrlimit(RLIMIT_NOFILE, &all));
}

static int make_namespace(void)
{
    return result_of(unshare(CLONE_NEWUSER));
}

static int take_privileges(void)
{
    return result_of(setresuid(0, 0, 0));
}

static int duplicate(void)
{
    return result_of(dup(STDERR_FILENO));
}

// Kernel features that are taken from a process, to see what is left: its call then fails with ENOSYS.
static void take_call(int call)
{
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);

    if (filter == NULL || seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), call, 0) != 0 ||
        seccomp_load(filter) != 0)
        _exit(EXIT_NOT_CONFINED);
    seccomp_release(filter);
}

// What comes of an attempt in a confined process whose kernel lacks these calls (-1: none).
static int attempt_without(int first, int second, attempt *try)
{
    int status = 0;

    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        tcp = socket(AF_INET, SOCK_STREAM, 0);
        if (first >= 0)
            take_call(first);
        if (second >= 0)
            take_call(second);
        if (confinement_enter(NULL) != BF_OK)
            _exit(EXIT_NOT_CONFINED);
        _exit(try());
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    return WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_SIGNALLED;
}

static void nothing_of_the_machine_can_be_used(void **state)
{
    static attempt *const attempts[] = {
        open_to_read, make_file,      make_folder,     list_folder,   stat_path,        make_socket,
        connect_tcp,  execute,        make_process,    signal_parent, trace_parent,     map_code,
        raise_limit,  make_namespace, take_privileges, duplicate,     make_unix_socket,
    };

    if ((confinement_find() & BIT_CALLS) == 0)
        skip();
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++)
        assert_int_equal(attempt_without(-1, -1, attempts[i]), EPERM);
}

static void landlock_alone_refuses_files_and_signals(void **state)
{
    const int lost = SCMP_SYS(seccomp);

    if ((confinement_find() & BIT_FILES) == 0)
        skip();
    assert_int_equal(attempt_without(lost, -1, make_folder), EACCES);
    assert_int_equal(attempt_without(lost, -1, execute), EACCES);
    if ((confinement_find() & 1U << METRICS_LAYER_TCP) != 0)
        assert_int_equal(attempt_without(lost, -1, connect_tcp), EACCES);
    if ((confinement_find() & 1U << METRICS_LAYER_SIGNALS) != 0)
        assert_int_equal(attempt_without(lost, -1, signal_parent), EPERM);
}

static void without_the_kernels_help_no_descriptor_can_be_made(void **state)
{
    static attempt *const attempts[] = { open_to_read, list_folder, make_socket, duplicate };

    if (IS_SANITIZED)
        skip();
    for (size_t i = 0; i < sizeof attempts / sizeof *attempts; i++)
        assert_int_equal(
            attempt_without(SCMP_SYS(landlock_create_ruleset), SCMP_SYS(seccomp), attempts[i]),
            EMFILE);
}

static int find_layers(void)
{
    return (int)confinement_find();
}

// Runs before the process is confined, so that what is left can be asked for.
static int layers_without(int call)
{
    int status = 0;

    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0) {
        take_call(call);
        _exit(find_layers());
    }
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    return WEXITSTATUS(status);
}

static void layers_that_the_kernel_lacks_are_known(void **state)
{
    const int all = find_layers();

    assert_int_equal(layers_without(SCMP_SYS(landlock_create_ruleset)), all & BIT_CALLS);
    assert_int_equal(layers_without(SCMP_SYS(seccomp)), all & ~BIT_CALLS);
}

// A layer that is there but cannot be entered: the solver must not go on.
static int enter_again(void)
{
    bf_error err = { 0 };

    take_call(SCMP_SYS(landlock_restrict_self));
    const bf_status status = confinement_enter(&err);
    return status == BF_ESYSTEM && strstr(err.text, "cannot be confined (Landlock)") != NULL;
}

static void a_layer_that_fails_is_an_error(void **state)
{
    int status = 0;

    if ((confinement_find() & BIT_FILES) == 0)
        skip();
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0)
        _exit(enter_again());
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 1);
}

static void *add_one(void *number)
{
    ++*(int *)number;
    return NULL;
}

// What a solver needs: memory of all sizes, threads, clocks, the pipes that it has.
static int work(void)
{
    struct timespec now;
    pthread_t thread;
    int number = 0;

    char *small = malloc(100), *large = calloc(1, 64 << 20);
    if (small == NULL || large == NULL || (large = realloc(large, 128 << 20)) == NULL)
        return 1;
    free(small);
    free(large);
    if (pthread_create(&thread, NULL, add_one, &number) != 0 || pthread_join(thread, NULL) != 0)
        return 2;
    if (clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now) != 0 || write(STDERR_FILENO, "", 0) != 0)
        return 3;
    return number == 1 ? 0 : 4;
}

static void what_a_solver_needs_goes_on(void **state)
{
    assert_int_equal(attempt_without(-1, -1, work), 0);
}

static int abort_here(void)
{
    const struct rlimit none = { 0, 0 };

    (void)setrlimit(RLIMIT_CORE, &none);
    abort();
}

static void a_solver_can_abort(void **state)
{
    assert_int_equal(attempt_without(-1, -1, abort_here), EXIT_SIGNALLED);
}

static int leave_root(void)
{
    if (!confinement_leave_root() || geteuid() == 0 || getegid() == 0)
        return 1;
    return setresuid(0, 0, 0) == 0;
}

static void root_is_left_for_good(void **state)
{
    int status = 0;

    if (IS_SANITIZED || geteuid() != 0)
        skip();
    const pid_t pid = fork();
    assert_true(pid >= 0);
    if (pid == 0)
        _exit(leave_root());
    assert_int_equal(waitpid(pid, &status, 0), pid);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nothing_of_the_machine_can_be_used),
        cmocka_unit_test(landlock_alone_refuses_files_and_signals),
        cmocka_unit_test(without_the_kernels_help_no_descriptor_can_be_made),
        cmocka_unit_test(layers_that_the_kernel_lacks_are_known),
        cmocka_unit_test(a_layer_that_fails_is_an_error),
        cmocka_unit_test(what_a_solver_needs_goes_on),
        cmocka_unit_test(a_solver_can_abort),
        cmocka_unit_test(root_is_left_for_good),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}

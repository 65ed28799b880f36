#include "server/run/confinement.h"

#include <errno.h>
#include <grp.h>
#include <linux/landlock.h>
#include <linux/seccomp.h>
#include <sched.h>
#include <seccomp.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IS_SANITIZED 1
#else
#define IS_SANITIZED 0
#endif

enum {
    NOBODY = 65534, // uid of nobody and gid of nogroup
    // Versions of Landlock's interface, by what came with them.
    ABI_REFER = 2,
    ABI_TRUNCATE = 3,
    ABI_TCP = 4,
    ABI_IOCTL = 5,
    ABI_SCOPES = 6,
    // Bits of a ruleset that the headers of older kernels lack.
    ALL_TCP = 3,     // bind, connect
    ALL_SCOPES = 3,  // abstract Unix sockets, signals
    N_OF_FILES = 13, // accesses of the first version
};

// struct landlock_ruleset_attr of version 6; earlier versions have its beginning.
typedef struct ruleset {
    uint64_t files;
    uint64_t tcp;
    uint64_t scopes;
} ruleset;

// What a solver calls: its pipes, memory, threads, clocks and ends. glibc asks for the rest when memory and threads
// are made.
static const int allowed_calls[] = {
    SCMP_SYS(read),
    SCMP_SYS(write),
    SCMP_SYS(writev),
    SCMP_SYS(close),
    SCMP_SYS(brk),
    SCMP_SYS(munmap),
    SCMP_SYS(mremap),
    SCMP_SYS(madvise),
    SCMP_SYS(futex),
    SCMP_SYS(set_robust_list),
    SCMP_SYS(rseq),
    SCMP_SYS(sched_yield),
    SCMP_SYS(sched_getaffinity),
    SCMP_SYS(sysinfo),
    SCMP_SYS(getpid),
    SCMP_SYS(getppid),
    SCMP_SYS(gettid),
    SCMP_SYS(getrandom),
    SCMP_SYS(clock_gettime),
    SCMP_SYS(clock_getres),
    SCMP_SYS(clock_nanosleep),
    SCMP_SYS(gettimeofday),
    SCMP_SYS(restart_syscall),
    SCMP_SYS(rt_sigaction),
    SCMP_SYS(rt_sigprocmask),
    SCMP_SYS(rt_sigreturn),
    SCMP_SYS(sigaltstack),
    SCMP_SYS(exit),
    SCMP_SYS(exit_group),
};

static int find_landlock(void)
{
    return (int)syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
}

static bool has_seccomp(void)
{
    const uint32_t action = SECCOMP_RET_ERRNO;

    return !IS_SANITIZED && syscall(SYS_seccomp, SECCOMP_GET_ACTION_AVAIL, 0, &action) == 0;
}

unsigned confinement_find(void)
{
    const int abi = find_landlock();

    return (abi >= 1 ? 1U << METRICS_LAYER_FILES : 0) |
           (abi >= ABI_TCP ? 1U << METRICS_LAYER_TCP : 0) |
           (abi >= ABI_SCOPES ? 1U << METRICS_LAYER_SIGNALS : 0) |
           (has_seccomp() ? 1U << METRICS_LAYER_CALLS : 0);
}

bool confinement_leave_root(void)
{
    if (IS_SANITIZED || geteuid() != 0)
        return geteuid() != 0;
    return setgroups(0, NULL) == 0 && setresgid(NOBODY, NOBODY, NOBODY) == 0 &&
           setresuid(NOBODY, NOBODY, NOBODY) == 0;
}

static bf_status fail(bf_error *err, const char *layer, int error)
{
    return bf_fail(err, BF_ESYSTEM, "", "the solver cannot be confined (%s): %s", layer,
                   strerror(error));
}

static uint64_t find_file_accesses(int abi)
{
    const int n = N_OF_FILES + (abi >= ABI_REFER) + (abi >= ABI_TRUNCATE) + (abi >= ABI_IOCTL);
    const uint64_t all = (1ULL << n) - 1;
    const uint64_t reading = LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR;

    return IS_SANITIZED ? all & ~reading : all;
}

// A ruleset without a rule forbids all that it handles.
static bf_status enter_landlock(bf_error *err)
{
    const int abi = find_landlock();
    const ruleset rules = { .files = find_file_accesses(abi),
                            .tcp = abi >= ABI_TCP ? ALL_TCP : 0,
                            .scopes = abi >= ABI_SCOPES ? ALL_SCOPES : 0 };
    const size_t size = abi >= ABI_SCOPES ? sizeof rules
                        : abi >= ABI_TCP  ? offsetof(ruleset, scopes)
                                          : offsetof(ruleset, tcp);

    if (abi < 1)
        return BF_OK;
    const int fd = (int)syscall(SYS_landlock_create_ruleset, &rules, size, 0);
    if (fd < 0)
        return fail(err, "Landlock", errno);
    const int error = syscall(SYS_landlock_restrict_self, fd, 0) != 0 ? errno : 0;
    (void)close(fd);
    return error == 0 ? BF_OK : fail(err, "Landlock", error);
}

static bf_status forbid_descriptors(bf_error *err)
{
    const struct rlimit none = { 0, 0 };

    return IS_SANITIZED || setrlimit(RLIMIT_NOFILE, &none) == 0 ? BF_OK
                                                                : fail(err, "descriptors", errno);
}

// Returns 0 or a negative errno.
static int allow_with_conditions(scmp_filter_ctx filter)
{
    const uint64_t thread = CLONE_VM | CLONE_SIGHAND | CLONE_THREAD;
    const struct scmp_arg_cmp is_data = SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0);

    int error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mmap), 1, is_data);
    if (error == 0)
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(mprotect), 1, is_data);
    if (error == 0) // threads, no processes
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                                 SCMP_A0(SCMP_CMP_MASKED_EQ, thread, thread));
    if (error == 0) // its flags lie in memory, where a filter cannot look: glibc then takes clone()
        error = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
    if (error == 0) // abort() signals itself
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1,
                                 SCMP_A0(SCMP_CMP_EQ, (uint64_t)getpid()));
    if (error == 0) // limits are read, not set
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, SCMP_SYS(prlimit64), 2,
                                 SCMP_A0(SCMP_CMP_EQ, 0), SCMP_A2(SCMP_CMP_EQ, 0));
    return error;
}

static bf_status enter_seccomp(bf_error *err)
{
    const size_t n = sizeof allowed_calls / sizeof *allowed_calls;

    if (!has_seccomp())
        return BF_OK;
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    int error = filter == NULL ? -ENOMEM : 0;
    for (size_t i = 0; i < n && error == 0; i++)
        error = seccomp_rule_add(filter, SCMP_ACT_ALLOW, allowed_calls[i], 0);
    if (error == 0)
        error = allow_with_conditions(filter);
    if (error == 0)
        error = seccomp_load(filter);
    seccomp_release(filter);
    return error == 0 ? BF_OK : fail(err, "seccomp", -error);
}

bf_status confinement_enter(bf_error *err)
{
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
        return fail(err, "privileges", errno);
    BF_TRY(enter_landlock(err));
    BF_TRY(forbid_descriptors(err));
    return enter_seccomp(err);
}

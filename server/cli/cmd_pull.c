#include "api/json/number.h"
#include "server/base/cores.h"
#include "server/base/file_io.h"
#include "server/base/solver.h"
#include "server/cli/cmd.h"
#include "server/worker/pull_worker.h"

#include <argp.h>
#include <ctype.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    TOKEN_BYTES_MAX = 400,
    KEY_PULL = 256,
    KEY_TOKEN,
    KEY_NAME,
    KEY_CORES,
    KEY_MEMORY,
    KEY_LIFETIME,
    KEY_IDLE,
    KEY_SPOOL,
    KEY_SPOOL_BYTES,
    KEY_CA,
};

typedef struct pull_arguments {
    pull_worker_options options;
    const char *token_file;
    uint64_t cores;
} pull_arguments;

static void take_name(pull_worker_options *o, const char *name, const struct argp_state *state)
{
    bool is_good = name[0] != '\0' && strlen(name) < sizeof o->who.name;

    for (const char *at = name; *at != '\0'; at++)
        is_good = is_good && (isalnum((unsigned char)*at) || strchr("._-", *at) != NULL);
    if (!is_good)
        argp_error(state, "a name has 1 to %d letters, digits, '.', '_' and '-'",
                   API_WORKER_SIZE - 1);
    else
        snprintf(o->who.name, sizeof o->who.name, "%s", name);
}

static uint64_t *find_number(pull_arguments *a, int key)
{
    switch (key) {
    case KEY_CORES:
        return &a->cores;
    case KEY_MEMORY:
        return &a->options.who.memory_bytes;
    case KEY_LIFETIME:
        return &a->options.lifetime_s;
    case KEY_IDLE:
        return &a->options.idle_s;
    case KEY_SPOOL_BYTES:
        return &a->options.spool_bytes;
    default:
        return NULL;
    }
}

static error_t take_number(pull_arguments *a, int key, const char *text,
                           const struct argp_state *state)
{
    const uint64_t most = key == KEY_CORES ? API_WORKER_CORES : UINT64_C(1) << 50;
    const uint64_t least = key == KEY_CORES ? 1 : 0;
    uint64_t *target = find_number(a, key);

    if (target == NULL)
        return ARGP_ERR_UNKNOWN;
    if (!number_read_digits(text, least, most, target))
        argp_error(state, "'%s' is not a number from %llu to %llu", text, (unsigned long long)least,
                   (unsigned long long)most);
    return 0;
}

static error_t parse_option(int key, char *argument, struct argp_state *state)
{
    pull_arguments *a = state->input;

    if (key == KEY_PULL)
        a->options.url = argument;
    else if (key == KEY_TOKEN)
        a->token_file = argument;
    else if (key == KEY_NAME)
        take_name(&a->options, argument, state);
    else if (key == KEY_SPOOL)
        a->options.spool = argument;
    else if (key == KEY_CA)
        a->options.ca_file = argument;
    else
        return take_number(a, key, argument, state);
    return 0;
}

static pull_arguments find_defaults(void)
{
    const unsigned cores = cores_count();
    const char *folder = getenv("TMPDIR");
    pull_arguments a = { .cores = cores < API_WORKER_CORES ? cores : API_WORKER_CORES };

    // The machine and the process, so that workers of one machine have different names.
    char host[40] = "";
    if (gethostname(host, sizeof host - 1) != 0 || host[0] == '\0')
        snprintf(host, sizeof host, "worker");
    for (char *at = host; *at != '\0'; at++)
        if (!isalnum((unsigned char)*at) && strchr("._-", *at) == NULL)
            *at = '-';
    snprintf(a.options.who.name, API_WORKER_SIZE, "%s-%ld", host, (long)getpid());
    (void)solver_name(a.options.who.solver);
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    a.options.who.memory_bytes = pages > 0 && size > 0 ? (uint64_t)pages * (uint64_t)size : 0;
    a.options.spool = folder == NULL || folder[0] == '\0' ? "/tmp" : folder;
    a.options.spool_bytes = UINT64_C(16) << 30;
    return a;
}

// The solver lies beside this program.
static bf_status find_program(char *path, size_t size, bf_error *err)
{
    static const char name[] = "beltflow-worker";
    const ssize_t n = readlink("/proc/self/exe", path, size - 1);

    path[n < 0 ? 0 : n] = '\0';
    char *slash = strrchr(path, '/');
    if (slash == NULL || (size_t)(slash + 1 - path) + sizeof name > size)
        return bf_fail(err, BF_ESYSTEM, "", "cannot find out where this program lies");
    memcpy(slash + 1, name, sizeof name);
    return BF_OK;
}

static bf_status read_token(const char *path, bf_buffer *token, bf_error *err)
{
    BF_TRY(file_io_read(path, NULL, TOKEN_BYTES_MAX, token, err));
    while (token->n > 0 && isspace((unsigned char)token->bytes[token->n - 1]))
        buffer_truncate(token, token->n - 1);
    for (size_t k = 0; k < token->n; k++)
        if (!isgraph((unsigned char)token->bytes[k]))
            return bf_fail(err, BF_EINPUT, "", "%s holds more than a token", path);
    return token->n > 0 ? BF_OK : bf_fail(err, BF_EINPUT, "", "%s holds no token", path);
}

static bf_status pull(pull_arguments *a, bf_error *err)
{
    char program[PATH_MAX];
    bf_buffer token = { 0 };

    a->options.who.cores = (uint32_t)a->cores;
    a->options.program = program;
    bf_status status = find_program(program, sizeof program, err);
    if (status == BF_OK && a->token_file != NULL)
        status = read_token(a->token_file, &token, err);
    a->options.token = token.n == 0 ? "" : token.bytes;
    if (status == BF_OK)
        status = pull_worker_run(&a->options, err);
    if (token.n > 0)
        explicit_bzero(token.bytes, token.n);
    buffer_fini(&token);
    return status;
}

int cmd_pull(int argc, char **argv)
{
    static const struct argp_option options[] = {
        { "pull", KEY_PULL, "URL", 0, "Solve for the daemon at this URL", 0 },
        { "token-file", KEY_TOKEN, "FILE", 0, "Holds an access token with the scope work", 0 },
        { "ca-file", KEY_CA, "FILE", 0, "CA certificates for https (default: the system's)", 0 },
        { "name", KEY_NAME, "NAME", 0, "Name of this worker (default: machine and process)", 0 },
        { "cores", KEY_CORES, "N", 0, "Cores to use (default: all)", 0 },
        { "memory-bytes", KEY_MEMORY, "N", 0, "Memory to tell of (default: the machine's)", 0 },
        { "lifetime-s", KEY_LIFETIME, "N", 0, "End by itself after so long (default 0: never)", 0 },
        { "idle-s", KEY_IDLE, "N", 0, "End after so long without a job (default 0: never)", 0 },
        { "spool", KEY_SPOOL, "DIR", 0, "Folder for frames (default: TMPDIR, /tmp)", 0 },
        { "spool-bytes", KEY_SPOOL_BYTES, "N", 0, "All of them at once (default 16 GiB)", 0 },
        { 0 },
    };
    static const struct argp parser = {
        .options = options,
        .parser = parse_option,
        .doc = "Lease runs of a daemon with `executor = pull`, solve them on this machine, and "
               "send their "
               "results.\v"
               "SIGTERM lets them write checkpoints, delivers what is left, and ends.",
    };
    pull_arguments arguments = find_defaults();
    bf_error err = { 0 };

    argp_parse(&parser, argc, argv, 0, NULL, &arguments);
    return pull(&arguments, &err) == BF_OK ? CMD_DONE : (int)cmd_fail("beltflow worker", &err);
}

#include "server/daemon/config.h"
#include "server/http/client.h"
#include "server/http/cors.h"
#include "server/http/http.h"
#include "server/http/listen.h"

#include <argp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum {
    EXIT_SETTINGS = 2,
    KEY_CONFIG = 256,
    KEY_CHECK,
    KEY_PRINT,
    KEY_SAMPLE,
    KEY_VERIFY,
    KEY_OWNER,
    KEY_SCOPES,
    KEY_EXPIRES,
    KEY_OVERLAP,
    KEY_COPIES,
    KEY_DRY_RUN,
    KEY_ROWS,
    N_OTHERS = 11 // flags that are no settings
};

static void parse_word(config_flags *f, const char *word, const struct argp_state *state)
{
    if (f->command == CONFIG_TOKEN && f->action == NULL)
        f->action = word;
    else if (f->command != CONFIG_SERVE && f->command != CONFIG_SCRIPT && f->subject == NULL)
        f->subject = word;
    else if (f->command == CONFIG_SERVE && strcmp(word, "backup") == 0)
        f->command = CONFIG_BACKUP;
    else if (f->command == CONFIG_SERVE && strcmp(word, "restore") == 0)
        f->command = CONFIG_RESTORE;
    else if (f->command == CONFIG_SERVE && strcmp(word, "verify") == 0)
        f->command = CONFIG_VERIFY;
    else if (f->command == CONFIG_SERVE && strcmp(word, "token") == 0)
        f->command = CONFIG_TOKEN;
    else if (f->command == CONFIG_SERVE && strcmp(word, "slurm") == 0)
        f->command = CONFIG_SCRIPT;
    else
        argp_error(state, "this is no command, and nothing else fits here: '%s'", word);
}

// Of a token's words; NULL: nothing.
static const char *find_token_fault(const config_flags *f)
{
    const char *action = f->action == NULL ? "" : f->action;
    const bool is_list = strcmp(action, "list") == 0;

    if (!is_list && strcmp(action, "add") != 0 && strcmp(action, "rotate") != 0 &&
        strcmp(action, "revoke") != 0)
        return "token wants add NAME, list, rotate ID or revoke ID";
    if (is_list && f->subject != NULL)
        return "token list wants nothing else";
    return is_list || f->subject != NULL
               ? NULL
               : "token add wants a NAME, and token rotate and token revoke an ID";
}

// What is wrong with the words all together; NULL: nothing.
static const char *find_fault(const config_flags *f)
{
    const char *action = f->command == CONFIG_TOKEN && f->action != NULL ? f->action : "";

    if (f->command == CONFIG_BACKUP && f->subject == NULL)
        return "backup wants the name of a new file, or of a directory";
    if (f->command == CONFIG_RESTORE && f->subject == NULL)
        return "restore wants the name of a copy";
    if (f->command == CONFIG_TOKEN && find_token_fault(f) != NULL)
        return find_token_fault(f);
    if (f->is_dry_run != (f->command == CONFIG_SCRIPT))
        return f->is_dry_run ? "--dry-run is for slurm" : "slurm wants --dry-run";
    if (strcmp(action, "add") != 0 && (f->owner != NULL || f->scopes != NULL || f->expires != NULL))
        return "--owner, --scopes and --expires are for token add";
    if (strcmp(action, "rotate") != 0 && f->overlap != NULL)
        return "--overlap is for token rotate";
    return f->command != CONFIG_BACKUP && f->copies != NULL ? "--copies is for backup" : NULL;
}

static error_t parse_flag(int key, char *value, struct argp_state *state)
{
    config_flags *f = state->input;

    if (key == KEY_CONFIG)
        f->file = value;
    else if (key == KEY_CHECK)
        f->is_check = true;
    else if (key == KEY_PRINT)
        f->is_print = true;
    else if (key == KEY_SAMPLE)
        f->is_sample = true;
    else if (key == KEY_DRY_RUN)
        f->is_dry_run = true;
    else if (key >= KEY_ROWS && key < KEY_ROWS + CONFIG_COUNT)
        f->values[key - KEY_ROWS] = value;
    else if (key == KEY_VERIFY)
        f->command = CONFIG_VERIFY;
    else if (key == ARGP_KEY_ARG)
        parse_word(f, value, state);
    else if (key == KEY_OWNER)
        f->owner = value;
    else if (key == KEY_SCOPES)
        f->scopes = value;
    else if (key == KEY_EXPIRES)
        f->expires = value;
    else if (key == KEY_OVERLAP)
        f->overlap = value;
    else if (key == KEY_COPIES)
        f->copies = value;
    else if (key == ARGP_KEY_END && find_fault(f) != NULL)
        argp_error(state, "%s", find_fault(f));
    else
        return ARGP_ERR_UNKNOWN;
    return 0;
}

// The flag of a setting, without its dashes, in storage of 64 bytes.
static char *flag_of(const char *name, char *storage)
{
    (void)snprintf(storage, 64, "%s", name);
    for (char *c = storage; *c != '\0'; c++)
        *c = *c == '_' ? '-' : *c;
    return storage;
}

static void add_rows(struct argp_option *options)
{
    static char names[CONFIG_COUNT][64];
    static char helps[CONFIG_COUNT][200];
    size_t n = 0;
    const config_row *rows = config_rows(&n);

    for (size_t i = 0; i < n; i++) {
        const char *initial = rows[i].initial[0] == '\0' ? "empty" : rows[i].initial;
        (void)snprintf(helps[i], sizeof helps[i], "%s (default: %s)", rows[i].help, initial);
        options[i].name = flag_of(rows[i].name, names[i]);
        options[i].key = KEY_ROWS + (int)i;
        options[i].arg = "VALUE";
        options[i].doc = helps[i];
        options[i].group = 1;
    }
}

static const char *find_settings(void)
{
    const char *named = getenv("BELTFLOW_CONFIG");

    if (named != NULL)
        return named;
    return access(CONFIG_PACKAGED, F_OK) == 0 ? CONFIG_PACKAGED : NULL;
}

void config_parse_flags(int argc, char **argv, config_flags *ret_flags)
{
    struct argp_option options[CONFIG_COUNT + N_OTHERS + 1] = {
        { "config", KEY_CONFIG, "FILE", 0, "read settings from FILE (lines 'name = value')", 0 },
        { "check-config", KEY_CHECK, NULL, 0, "check the settings and leave: 0, or 2 and why", 0 },
        { "print-config", KEY_PRINT, NULL, 0, "print all settings with their origins and leave",
          0 },
        { "sample-config", KEY_SAMPLE, NULL, 0, "print a sample of FILE and leave", 0 },
        { "verify", KEY_VERIFY, NULL, 0, "the same as the command verify", 0 },
        { "owner", KEY_OWNER, "OWNER", 0, "whose the new token is (default: its NAME)", 0 },
        { "scopes", KEY_SCOPES, "LIST", 0,
          "what it allows, of read,submit,work,admin,priority,metrics (default: read,submit)", 0 },
        { "expires", KEY_EXPIRES, "TIME", 0, "when it ends, such as 90d or 12h (default: never)",
          0 },
        { "overlap", KEY_OVERLAP, "TIME", 0,
          "with token rotate: how long the old one still counts (default: 7d)", 0 },
        { "copies", KEY_COPIES, "N", 0,
          "with backup: how many copies of the directory stay (default: all)", 0 },
        { "dry-run", KEY_DRY_RUN, NULL, 0, "with slurm: print the batch script and leave", 0 },
    };
    const struct argp argp = {
        .options = options,
        .parser = parse_flag,
        .args_doc = "\nbackup FILE\nrestore FILE\nverify [FILE]\ntoken add NAME\ntoken list\n"
                    "token rotate ID\ntoken revoke ID\nslurm --dry-run",
        .doc =
            "Solves material flow on conveyor belts and offers it over HTTP. With backup, copies "
            "store, tokens and settings to a new FILE, or one in the directory FILE, also while "
            "they "
            "are in use; with restore, puts a copy in their place; with verify, checks the store, "
            "or a copy of it; with token, adds, lists, rotates or revokes access tokens, also "
            "while the daemon runs; with slurm, prints the batch script of workers that Slurm "
            "starts. Without --config and --data, commands use the settings that BELTFLOW_CONFIG "
            "names, or " CONFIG_PACKAGED "."
            "\vA flag goes before the environment (BELTFLOW_<NAME>), and that before FILE. SIGHUP "
            "lets the daemon read its settings again, SIGTERM and SIGINT stop it.",
    };

    add_rows(options + N_OTHERS);
    argp_err_exit_status = EXIT_SETTINGS;
    *ret_flags = (config_flags){ .file = NULL };
    (void)argp_parse(&argp, argc, argv, 0, NULL, ret_flags);
    if (ret_flags->command != CONFIG_SERVE && ret_flags->file == NULL &&
        ret_flags->values[CONFIG_data] == NULL && getenv("BELTFLOW_DATA") == NULL)
        ret_flags->file = find_settings();
}

static bf_status apply_flags(const config_flags *flags, config *c, bf_error *err)
{
    size_t n = 0;
    const config_row *rows = config_rows(&n);

    for (size_t i = 0; i < n; i++) {
        char name[64], where[80];
        if (flags->values[i] == NULL)
            continue;
        (void)snprintf(where, sizeof where, "--%s", flag_of(rows[i].name, name));
        BF_TRY(config_set(c, rows[i].name, flags->values[i], where, err));
    }
    return BF_OK;
}

static bf_status locate(config *c, bf_error *err)
{
    char folder[CONFIG_TEXT_SIZE];
    ssize_t n = readlink("/proc/self/exe", folder, sizeof folder - 1);

    if (n <= 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot find out where this program lies");
    folder[n] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash != NULL)
        *slash = '\0';
    return config_locate(c, folder, err);
}

static bf_status check_proxies(const char *text, bf_error *err)
{
    http_proxies proxies;
    return http_client_read_proxies(text, &proxies, err);
}

// What can only be judged as a whole text, by those who will use it.
static bf_status check_texts(const config *c, bf_error *err)
{
    const struct {
        size_t row;
        const char *text;
        bf_status (*check)(const char *text, bf_error *err);
    } texts[] = {
        { CONFIG_listen, c->listen, http_check_address },
        { CONFIG_plaintext, c->plaintext, http_check_plaintext },
        { CONFIG_cors_origins, c->cors_origins, http_cors_check },
        { CONFIG_hosts, c->hosts, http_host_check },
        { CONFIG_trusted_proxies, c->trusted_proxies, check_proxies },
    };
    bf_error found = { 0 };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        bf_status status = texts[i].check(texts[i].text, &found);
        if (status != BF_OK)
            return bf_fail(err, status, "", "%s: %s", c->origins[texts[i].row], found.text);
    }
    return BF_OK;
}

// What a worker that has API_LEASE_JOBS_MAX jobs says of them when it renews their lease. Frames come in smaller requests.
enum { WORKERS_BODY_BYTES = 262144 };

static bf_status check_pairs(const config *c, bf_error *err)
{
    bf_error found = { 0 };

    if (config_find_executor(c) == CONFIG_SLURM && c->slurm_url[0] == '\0')
        return bf_fail(err, BF_EINPUT, "", "%s: executor = slurm needs slurm_url",
                       c->origins[CONFIG_executor]);
    if (config_find_executor(c) != CONFIG_LOCAL && c->body_bytes < WORKERS_BODY_BYTES)
        return bf_fail(err, BF_EINPUT, "",
                       "%s: workers send requests of up to %d bytes, more than body_bytes = %llu",
                       c->origins[CONFIG_body_bytes], WORKERS_BODY_BYTES,
                       (unsigned long long)c->body_bytes);
    bf_status status = http_check_listen(c->listen, c->plaintext, &found);
    return status == BF_OK
               ? BF_OK
               : bf_fail(err, status, "", "%s: %s", c->origins[CONFIG_listen], found.text);
}

bf_status config_read(const config_flags *flags, config *ret_config, bf_error *err)
{
    config c;

    config_init(&c);
    BF_TRY(flags->file == NULL ? BF_OK : config_read_file(&c, flags->file, err));
    BF_TRY(config_read_environment(&c, err));
    BF_TRY(apply_flags(flags, &c, err));
    BF_TRY(check_texts(&c, err));
    if (flags->command == CONFIG_SERVE)
        BF_TRY(check_pairs(&c, err));
    BF_TRY(locate(&c, err));
    *ret_config = c;
    return BF_OK;
}

#include "server/daemon/config.h"

#include "api/json/number.h"
#include "api/json/text.h"
#include "core/base/check.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

typedef enum config_kind { KIND_TEXT, KIND_NUMBER } config_kind;

// Where a row's value is, and what it may be.
typedef struct config_place {
    config_kind kind;
    size_t offset;  // in config
    uint64_t least; // of a number
    uint64_t most;  // of a number
} config_place;

enum { CAN_RESTART = false, CAN_RELOAD = true };

static const config_row rows[] = {
#define X(name, kind, initial, least, most, when, help) { #name, initial, help, CAN_##when },
    CONFIG_LIST(X)
#undef X
};

static const config_place places[] = {
#define X(name, kind, initial, least, most, when, help)                                            \
    { KIND_##kind, offsetof(config, name), (uint64_t)(least), (uint64_t)(most) },
    CONFIG_LIST(X)
#undef X
};

enum { N_ROWS = CONFIG_COUNT };

const config_row *config_rows(size_t *ret_n)
{
    *ret_n = N_ROWS;
    return rows;
}

static bf_status refuse_unknown(const char *name, const char *where, bf_error *err)
{
    size_t nearest = SIZE_MAX;
    const char *meant = "";

    for (size_t i = 0; i < N_ROWS; i++) {
        size_t distance = text_distance(name, rows[i].name);
        if (distance < nearest && text_is_near(rows[i].name, distance)) {
            nearest = distance;
            meant = rows[i].name;
        }
    }
    if (nearest == SIZE_MAX)
        return bf_fail(err, BF_EINPUT, "", "%s: there is no setting '%s'", where, name);
    return bf_fail(err, BF_EINPUT, "", "%s: there is no setting '%s'; is '%s' meant?", where, name,
                   meant);
}

static bf_status set_number(config *c, size_t i, const char *value, const char *where,
                            bf_error *err)
{
    const config_place *place = &places[i];
    uint64_t number = 0;

    if (!number_read_digits(value, place->least, place->most, &number))
        return bf_fail(err, BF_EINPUT, "",
                       "%s: %s must be a whole number from %llu to %llu, not '%.40s'", where,
                       rows[i].name, (unsigned long long)place->least,
                       (unsigned long long)place->most, value);
    memcpy((char *)c + place->offset, &number, sizeof number);
    return BF_OK;
}

// True if a line of a file can say the text: no line ends, no blanks that would be taken off, and
// nothing that would be taken for a comment.
static bool is_sayable(const char *text)
{
    size_t n = strlen(text);

    if (n > 0 && (text[0] == ' ' || text[0] == ';' || text[n - 1] == ' '))
        return false;
    for (size_t i = 0; i < n; i++) {
        if ((unsigned char)text[i] < 0x20 || text[i] == 0x7f)
            return false;
    }
    return strstr(text, " ;") == NULL;
}

static config_executor find_executor(const char *word)
{
    static const char *const words[] = {
#define X(kind, name) name,
        CONFIG_EXECUTOR_LIST(X)
#undef X
    };
    return (config_executor)text_find_word(words, CONFIG_EXECUTOR_COUNT, word);
}

static bf_status set_text(config *c, size_t i, const char *value, const char *where, bf_error *err)
{
    char *to = (char *)c + places[i].offset;

    if (strlen(value) >= CONFIG_TEXT_SIZE)
        return bf_fail(err, BF_EINPUT, "", "%s: %s is longer than %d bytes", where, rows[i].name,
                       CONFIG_TEXT_SIZE - 1);
    if (to == c->executor && find_executor(value) == CONFIG_EXECUTOR_COUNT)
        return bf_fail(err, BF_EINPUT, "", "%s: executor must be local, pull or slurm, not '%.40s'",
                       where, value);
    if (to == c->access && strcmp(value, "tokens") != 0 && strcmp(value, "open") != 0)
        return bf_fail(err, BF_EINPUT, "", "%s: access must be tokens or open, not '%.40s'", where,
                       value);
    if (to == c->log_level && log_level_find(value) == LOG_LEVEL_COUNT)
        return bf_fail(err, BF_EINPUT, "", "%s: log_level must be %s, not '%.40s'", where,
                       rows[i].help, value);
    if (!is_sayable(value))
        return bf_fail(err, BF_EINPUT, "",
                       "%s: %s must not have control characters, blanks at its ends, or a ';' "
                       "after a blank",
                       where, rows[i].name);
    memcpy(to, value, strlen(value) + 1);
    return BF_OK;
}

bf_status config_set(config *c, const char *name, const char *value, const char *where,
                     bf_error *err)
{
    size_t i = 0;

    while (i < N_ROWS && strcmp(rows[i].name, name) != 0)
        i++;
    if (i == N_ROWS)
        return refuse_unknown(name, where, err);
    BF_TRY(places[i].kind == KIND_NUMBER ? set_number(c, i, value, where, err)
                                         : set_text(c, i, value, where, err));
    (void)snprintf(c->origins[i], sizeof c->origins[i], "%s", where);
    return BF_OK;
}

void config_init(config *c)
{
    memset(c, 0, sizeof *c);
    for (size_t i = 0; i < N_ROWS; i++)
        BF_CHECK(config_set(c, rows[i].name, rows[i].initial, "default", NULL) == BF_OK);
}

config_executor config_find_executor(const config *c)
{
    return find_executor(c->executor);
}

log_level config_log_level(const config *c)
{
    log_level level = log_level_find(c->log_level);
    BF_CHECK(level != LOG_LEVEL_COUNT);
    return level;
}

static const char *value_of(const config *c, size_t i, char *storage)
{
    const char *value = (const char *)c + places[i].offset;
    uint64_t number = 0;

    if (places[i].kind == KIND_TEXT)
        return value;
    memcpy(&number, value, sizeof number);
    (void)snprintf(storage, CONFIG_TEXT_SIZE, "%llu", (unsigned long long)number);
    return storage;
}

void config_reload(config *c, const config *fresh, config_change_fn *on_change, void *context)
{
    char storage[2][CONFIG_TEXT_SIZE];

    for (size_t i = 0; i < N_ROWS; i++) {
        const char *before = value_of(c, i, storage[0]), *after = value_of(fresh, i, storage[1]);
        if (strcmp(before, after) == 0)
            continue;
        on_change(context, &rows[i], before, after);
        if (!rows[i].can_reload)
            continue;
        memcpy((char *)c + places[i].offset, (const char *)fresh + places[i].offset,
               places[i].kind == KIND_TEXT ? CONFIG_TEXT_SIZE : sizeof(uint64_t));
        memcpy(c->origins[i], fresh->origins[i], sizeof c->origins[i]);
    }
}

bf_status config_sample(bf_buffer *out, bf_error *err)
{
    bf_status status = buffer_printf(
        out,
        "# Settings of beltflowd, with their defaults. Also BELTFLOW_<NAME> in the environment "
        "and --<name>.\n# SIGHUP lets it read them again; (r): only a restart counts.\n");

    for (size_t i = 0; status == BF_OK && i < N_ROWS; i++)
        status = buffer_printf(out, "\n# %s%s\n#%s =%s%s\n", rows[i].help,
                               rows[i].can_reload ? "" : " (r)", rows[i].name,
                               rows[i].initial[0] == '\0' ? "" : " ", rows[i].initial);
    return status == BF_OK ? BF_OK : bf_fail(err, status, "", "no memory for a sample");
}

bf_status config_print(const config *c, bf_buffer *out, bf_error *err)
{
    char storage[CONFIG_TEXT_SIZE];
    bf_status status = buffer_printf(out, "# Settings of beltflowd %s.\n", BELTFLOW_VERSION);

    for (size_t i = 0; status == BF_OK && i < N_ROWS; i++)
        status = buffer_printf(out, "\n# %s\n# from: %s\n%s = %s\n", rows[i].help, c->origins[i],
                               rows[i].name, value_of(c, i, storage));
    return status == BF_OK ? BF_OK : bf_fail(err, status, "", "no memory for the settings");
}

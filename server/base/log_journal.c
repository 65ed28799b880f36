// The journal: MESSAGE is the line without its time and level, which the journal has in fields of its
// own; the ids that the line names become fields, so that `journalctl RUN_ID=...` finds them.

#include "server/base/base_priv.h"

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>

// Omit the source location: it would always be this file.
#define SD_JOURNAL_SUPPRESS_LOCATION
#include <systemd/sd-journal.h>

enum { FIELD_SIZE = 128, MESSAGE_SIZE = 4096 + 16 };

// Key of a pair and the field that it becomes.
typedef struct journal_field {
    const char *key;
    const char *name;
} journal_field;

static const journal_field fields[] = {
    { "event", "BELTFLOW_EVENT" },
    { "run", "RUN_ID" },
    { "request_id", "REQUEST_ID" },
};

enum { N_FIELDS = sizeof fields / sizeof *fields };

static const char *const priorities[LOG_LEVEL_COUNT] = {
#define X(level, word, priority) "PRIORITY=" #priority,
    LOG_LEVEL_LIST(X)
#undef X
};

bool log__is_journal(int fd, const char *stream)
{
    uint64_t device = 0, inode = 0;
    struct stat found;

    if (stream == NULL || sscanf(stream, "%" SCNu64 ":%" SCNu64, &device, &inode) != 2 ||
        fstat(fd, &found) != 0)
        return false;
    return found.st_dev == device && found.st_ino == inode;
}

// The end of the value that starts here: a blank, but not one between quotes.
static const char *skip_value(const char *value)
{
    bool is_quoted = *value == '"';

    if (!is_quoted)
        return value + strcspn(value, " ");
    for (value++; *value != '\0' && *value != '"'; value++)
        value += *value == '\\' && value[1] != '\0';
    return value + strcspn(value, " ");
}

// Writes "NAME=value" of the first pair with that key. False: there is none, or "-".
static bool write_field(const journal_field *field, const char *text, char *ret_text)
{
    size_t n_key = strlen(field->key);

    for (const char *pair = text; *pair != '\0'; pair += strspn(pair, " ")) {
        const char *value = pair + strcspn(pair, "= ");
        bool is_it = (size_t)(value - pair) == n_key && strncmp(pair, field->key, n_key) == 0;
        const char *end = *value == '=' ? skip_value(value + 1) : value;
        if (is_it && *value == '=') {
            int n = (int)(end - value - 1);
            (void)snprintf(ret_text, FIELD_SIZE, "%s=%.*s", field->name, n, value + 1);
            return n > 0 && !(n == 1 && value[1] == '-');
        }
        pair = end;
    }
    return false;
}

static void add_item(struct iovec *items, int *n, char *text)
{
    items[(*n)++] = (struct iovec){ .iov_base = text, .iov_len = strlen(text) };
}

bool log__send(log_level level, const char *text)
{
    struct iovec items[N_FIELDS + 2];
    char storage[N_FIELDS][FIELD_SIZE], message[MESSAGE_SIZE], priority[FIELD_SIZE];
    int n = 0;

    (void)snprintf(message, sizeof message, "MESSAGE=%s", text);
    (void)snprintf(priority, sizeof priority, "%s", priorities[level]);
    add_item(items, &n, message);
    add_item(items, &n, priority);
    for (size_t i = 0; i < N_FIELDS; i++) {
        if (write_field(&fields[i], text, storage[i]))
            add_item(items, &n, storage[i]);
    }
    return sd_journal_sendv(items, n) == 0;
}

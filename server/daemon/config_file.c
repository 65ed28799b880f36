#include "server/daemon/config.h"

#include <ctype.h>
#include <errno.h>
#include <ini.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { PATH_SIZE = 2 * CONFIG_TEXT_SIZE };

// A file that is being read.
typedef struct config_reader {
    config *settings; // to be filled
    const char *path; // for errors
    FILE *file;       // open
    int line;         // the one read last, from 1
    bf_status status; // first failure
    bf_error *err;    // of it
} config_reader;

static void fail_line(config_reader *reader, const char *text)
{
    if (reader->status == BF_OK)
        reader->status =
            bf_fail(reader->err, BF_EINPUT, "", "%s:%d: %s", reader->path, reader->line, text);
}

// inih's reader. Leading blanks go, since inih would take an indented line for more of the value
// before it; what does not fit into its buffer is a failure.
static char *read_line(char *line, int size, void *context)
{
    config_reader *reader = context;

    if (reader->status != BF_OK || fgets(line, size, reader->file) == NULL)
        return NULL;
    reader->line++;
    size_t n = strlen(line);
    if (n + 1 == (size_t)size && line[n - 1] != '\n') {
        fail_line(reader, "the line is too long");
        return NULL;
    }
    size_t n_blank = strspn(line, " \t");
    memmove(line, line + n_blank, n - n_blank + 1);
    return line;
}

static int on_setting(void *context, const char *section, const char *name, const char *value)
{
    config_reader *reader = context;
    char where[CONFIG_ORIGIN_SIZE];

    if (reader->status != BF_OK)
        return 0;
    if (*section != '\0') {
        fail_line(reader, "there are no sections");
        return 0;
    }
    (void)snprintf(where, sizeof where, "%s:%d", reader->path, reader->line);
    reader->status = config_set(reader->settings, name, value, where, reader->err);
    return reader->status == BF_OK;
}

bf_status config_read_file(config *c, const char *path, bf_error *err)
{
    config settings = *c;
    config_reader reader = { .settings = &settings, .path = path, .status = BF_OK, .err = err };

    reader.file = fopen(path, "re");
    if (reader.file == NULL)
        return bf_fail(err, BF_ESYSTEM, "", "cannot read %s: %s", path, strerror(errno));
    int line = ini_parse_stream(read_line, &reader, on_setting, &reader);
    if (ferror(reader.file) && reader.status == BF_OK)
        reader.status = bf_fail(err, BF_ESYSTEM, "", "cannot read %s", path);
    (void)fclose(reader.file);
    if (line > 0 && reader.status == BF_OK) {
        reader.line = line;
        fail_line(&reader, "this is not 'name = value'");
    }
    if (reader.status == BF_OK)
        *c = settings;
    return reader.status;
}

bf_status config_read_environment(config *c, bf_error *err)
{
    size_t n = 0;
    const config_row *rows = config_rows(&n);
    config settings = *c;

    for (size_t i = 0; i < n; i++) {
        char name[64] = "BELTFLOW_";
        size_t n_name = strlen(name);
        for (const char *from = rows[i].name; *from != '\0' && n_name + 1 < sizeof name; from++)
            name[n_name++] = (char)toupper((unsigned char)*from);
        const char *value = getenv(name);
        BF_TRY(value == NULL ? BF_OK : config_set(&settings, rows[i].name, value, name, err));
    }
    *c = settings;
    return BF_OK;
}

static void note_found(config *c, size_t row)
{
    (void)snprintf(c->origins[row], sizeof c->origins[row], "found beside this program");
}

// Sets an empty path of CONFIG_TEXT_SIZE bytes to a program in a folder.
static bf_status locate_program(config *c, size_t row, char *setting, const char *folder,
                                const char *name, bf_error *err)
{
    char path[PATH_SIZE];

    if (setting[0] != '\0')
        return BF_OK;
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    if (strlen(path) >= CONFIG_TEXT_SIZE)
        return bf_fail(err, BF_ELIMIT, "", "the path of this program is too long: %.100s", folder);
    memcpy(setting, path, strlen(path) + 1);
    note_found(c, row);
    return BF_OK;
}

bf_status config_locate(config *c, const char *folder, bf_error *err)
{
    static const char *const web_places[] = { "../share/beltflow/web", "../web" };
    char path[PATH_SIZE];

    BF_TRY(locate_program(c, CONFIG_program, c->program, folder, "beltflow-worker", err));
    BF_TRY(locate_program(c, CONFIG_slurm_program, c->slurm_program, folder, "beltflow", err));
    for (size_t i = 0; c->web[0] == '\0' && i < sizeof web_places / sizeof *web_places; i++) {
        (void)snprintf(path, sizeof path, "%s/%s/index.html", folder, web_places[i]);
        if (access(path, R_OK) != 0 || strlen(path) - strlen("/index.html") >= sizeof c->web)
            continue;
        (void)snprintf(c->web, sizeof c->web, "%.*s", (int)(strlen(path) - strlen("/index.html")),
                       path);
        note_found(c, CONFIG_web);
    }
    return BF_OK;
}

#include "server/cli/terminal.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { COLUMNS_DEFAULT = 80 };

// The variable's value; NULL where it is unset or empty, which mean the same.
static const char *read_variable(const char *name)
{
    const char *value = getenv(name);

    return value == NULL || *value == '\0' ? NULL : value;
}

size_t terminal_columns(void)
{
    struct winsize size;
    const char *text = read_variable("COLUMNS");
    long columns = text == NULL ? 0 : strtol(text, NULL, 10);

    if (columns > 0)
        return (size_t)columns;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
        return size.ws_col;
    return COLUMNS_DEFAULT;
}

bool terminal_is_utf8(void)
{
    const char *locale = read_variable("LC_ALL");

    // Read by name: setlocale() would change how numbers are printed.
    if (locale == NULL)
        locale = read_variable("LC_CTYPE");
    if (locale == NULL)
        locale = read_variable("LANG");
    return locale != NULL &&
           (strcasestr(locale, "utf-8") != NULL || strcasestr(locale, "utf8") != NULL);
}

bool terminal_has_colors(void)
{
    const char *term = read_variable("TERM");

    return isatty(STDOUT_FILENO) && term != NULL && strcmp(term, "dumb") != 0 &&
           read_variable("NO_COLOR") == NULL;
}

#include "api/json/moment.h"

#include <stdio.h>
#include <string.h>
#include <time.h>

bool moment_write(int64_t unix_ms, char ret_text[MOMENT_SIZE])
{
    time_t seconds = (time_t)(unix_ms / 1000);
    struct tm tm;

    if (unix_ms <= 0 || gmtime_r(&seconds, &tm) == NULL)
        return false;
    (void)snprintf(ret_text, MOMENT_SIZE, "%04d-%02d-%02dT%02d:%02d:%02d.%03dZ", tm.tm_year + 1900,
                   tm.tm_mon + 1, tm.tm_mday, tm.tm_hour, tm.tm_min, tm.tm_sec,
                   (int)(unix_ms % 1000));
    return true;
}

bool moment_read(const char *text, int64_t *ret_unix_ms)
{
    // Characters; digits that count; digits that there may be.
    enum { WHOLE = sizeof "2026-11-24T09:00:00" - 1, FRACTION = 3, FRACTION_MAX = 9 };
    struct tm tm = { 0 };
    const bool has_seconds = strptime(text, "%Y-%m-%dT%H:%M:%S", &tm) == text + WHOLE;
    const char *rest = has_seconds ? text + WHOLE : "";
    const size_t n_digits = *rest == '.' ? strspn(rest + 1, "0123456789") : 0;
    const int day = tm.tm_mday;
    int64_t ms = 1000 * (int64_t)timegm(&tm);

    for (size_t i = 1, unit = 100; i <= n_digits && i <= FRACTION; i++, unit /= 10)
        ms += (int64_t)unit * (rest[i] - '0');
    rest += n_digits == 0 ? 0 : n_digits + 1;
    // The 30th of February became another day.
    if (strcmp(rest, "Z") != 0 || n_digits > FRACTION_MAX || tm.tm_mday != day || ms < 0)
        return false;
    *ret_unix_ms = ms;
    return true;
}

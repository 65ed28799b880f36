#include "core/base/status.h"

#include <stdarg.h>
#include <stdio.h>

const char *bf_status_word(bf_status code)
{
    static const char *const words[] = {
#define X(code, word) word,
        BF_STATUS_LIST(X)
#undef X
    };
    return (size_t)code < sizeof words / sizeof *words ? words[code] : "unknown";
}

bf_status bf_fail(bf_error *err, bf_status code, const char *pointer, const char *format, ...)
{
    va_list args;

    if (err == NULL)
        return code;
    err->code = code;
    err->has_limit = false;
    snprintf(err->pointer, sizeof err->pointer, "%s", pointer);
    va_start(args, format);
    vsnprintf(err->text, sizeof err->text, format, args);
    va_end(args);
    return code;
}

bf_status bf_fail_memory(bf_error *err)
{
    return bf_fail(err, BF_ENOMEM, "", "out of memory");
}

#include "core/base/faults.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static void add(bf_faults *faults, bf_status code, const char *pointer, const char *format,
                va_list args)
{
    if (faults->n < FAULTS_MAX) {
        bf_error *item = &faults->items[faults->n];
        item->code = code;
        item->has_limit = false;
        snprintf(item->pointer, sizeof item->pointer, "%s", pointer);
        vsnprintf(item->text, sizeof item->text, format, args);
    }
    faults->n++;
}

void faults_add(bf_faults *faults, const char *pointer, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    add(faults, BF_EINPUT, pointer, format, args);
    va_end(args);
}

void faults_add_limit(bf_faults *faults, const char *pointer, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    add(faults, BF_ELIMIT, pointer, format, args);
    va_end(args);
}

void faults_set_limit(bf_faults *faults, double value, double limit)
{
    if (faults->n == 0 || faults->n > FAULTS_MAX || !isfinite(value) || !isfinite(limit))
        return;
    bf_error *item = &faults->items[faults->n - 1];
    item->has_limit = true;
    item->value = value;
    item->limit = limit;
}

void faults_add_error(bf_faults *faults, const bf_error *err)
{
    if (faults->n < FAULTS_MAX)
        faults->items[faults->n] = *err;
    faults->n++;
}

size_t faults_kept(const bf_faults *faults)
{
    return faults->n < FAULTS_MAX ? faults->n : FAULTS_MAX;
}

bf_status faults_status(const bf_faults *faults, bf_error *err)
{
    if (faults->n == 0)
        return BF_OK;
    if (err != NULL)
        *err = faults->items[0];
    return faults->items[0].code;
}

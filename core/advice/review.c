#include "core/advice/review.h"

#include <stdarg.h>
#include <stdio.h>

// Where the next warning goes: one too many is dropped.
static review_warning *next_item(review_warnings *w)
{
    review_warning *item = &w->items[w->n];

    w->n += w->n < REVIEW_WARNINGS_MAX;
    return item;
}

review_warning *review_add(review_warnings *w, const char *title, const char *pointer, ...)
{
    review_warning *item = next_item(w);
    va_list args;

    *item = (review_warning){ 0 };
    snprintf(item->title, sizeof item->title, "%s", title);
    va_start(args, pointer);
    vsnprintf(item->pointer, sizeof item->pointer, pointer, args);
    va_end(args);
    return item;
}

void review_explain(review_warning *item, const char *meaning, ...)
{
    va_list args;

    va_start(args, meaning);
    vsnprintf(item->meaning, sizeof item->meaning, meaning, args);
    va_end(args);
}

void review_append(review_warnings *w, const review_warnings *others)
{
    for (size_t k = 0; k < others->n; k++)
        *next_item(w) = others->items[k];
}

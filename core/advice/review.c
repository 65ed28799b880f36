#include "core/advice/review.h"

#include <stdio.h>

review_warning *review_add(review_warnings *w, const char *pointer, const char *title)
{
    review_warning *item = &w->items[w->n];

    *item = (review_warning){ 0 };
    snprintf(item->title, sizeof item->title, "%s", title);
    snprintf(item->pointer, sizeof item->pointer, "%s", pointer);
    w->n += w->n < REVIEW_WARNINGS_MAX;
    return item;
}

void review_append(review_warnings *w, const review_warnings *others)
{
    for (size_t k = 0; k < others->n; k++)
        *review_add(w, "", "") = others->items[k];
}

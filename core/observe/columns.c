#include "core/observe/columns.h"

#include "core/observe/figure.h"

#include <stdio.h>
#include <string.h>

static const struct {
    const char *word;
    size_t offset; // in feed_balance
} of_feed[COLUMNS_OF_FEED] = {
    { "offered", offsetof(feed_balance, offered) },
    { "admitted", offsetof(feed_balance, admitted) },
    { "waiting", offsetof(feed_balance, waiting) },
    { "discarded", offsetof(feed_balance, discarded) },
};

static size_t count_before_feeds(const scene *s)
{
    return s->n_counters + 1 + (s->may_drop ? 1 : 0);
}

size_t columns_count(const scene *s)
{
    return count_before_feeds(s) + COLUMNS_OF_FEED * s->n_feeds + s->n_eyes +
           figure_items(s, FIGURE_OF_BELT) + figure_items(s, FIGURE_OF_FAILURE) +
           figure_items(s, FIGURE_OF_OUTLET) + s->n_sinks;
}

void columns_name(const scene *s, size_t k, char *ret_name)
{
    const size_t n_before_feeds = count_before_feeds(s);
    const size_t n_before_eyes = n_before_feeds + COLUMNS_OF_FEED * s->n_feeds;
    const size_t n_before_belts = n_before_eyes + s->n_eyes;
    const size_t n_before_failures = n_before_belts + figure_items(s, FIGURE_OF_BELT);
    const size_t n_before_outlets = n_before_failures + figure_items(s, FIGURE_OF_FAILURE);
    const size_t n_before_sinks = n_before_outlets + figure_items(s, FIGURE_OF_OUTLET);

    if (k < s->n_counters)
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s", s->counters[k].id);
    else if (k == s->n_counters)
        snprintf(ret_name, COLUMN_NAME_SIZE, "left_domain");
    else if (k < n_before_feeds)
        snprintf(ret_name, COLUMN_NAME_SIZE, "fallen");
    else if (k < n_before_eyes)
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s.%s",
                 s->feeds[(k - n_before_feeds) / COLUMNS_OF_FEED].id,
                 of_feed[(k - n_before_feeds) % COLUMNS_OF_FEED].word);
    else if (k < n_before_belts)
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s.blocked", s->eyes[k - n_before_eyes].id);
    else if (k < n_before_failures)
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s.speed_m_s",
                 figure_item_id(s, FIGURE_OF_BELT, k - n_before_belts));
    else if (k < n_before_outlets)
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s.failed",
                 figure_item_id(s, FIGURE_OF_FAILURE, k - n_before_failures));
    else if (k < n_before_sinks)
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s.left",
                 figure_item_id(s, FIGURE_OF_OUTLET, k - n_before_outlets));
    else
        snprintf(ret_name, COLUMN_NAME_SIZE, "%s.taken", s->sinks[k - n_before_sinks].id);
}

bool columns_is_count(const char *name)
{
    static const char *const counts[] = { "left_domain", "fallen", ".offered", ".admitted",
                                          ".discarded",  ".left",  ".taken" };
    const size_t n = strlen(name);

    for (size_t k = 0; k < sizeof counts / sizeof *counts; k++) {
        const size_t n_word = strlen(counts[k]);
        const bool is_whole = counts[k][0] != '.';
        if (n >= n_word && (n == n_word) == is_whole && strcmp(name + n - n_word, counts[k]) == 0)
            return true;
    }
    return false;
}

void columns_put_feed(const feed_balance *balance, double *ret_values)
{
    for (size_t k = 0; k < COLUMNS_OF_FEED; k++)
        memcpy(&ret_values[k], (const char *)balance + of_feed[k].offset, sizeof *ret_values);
}

void columns_check(const scene *s, bf_faults *faults)
{
    char name[COLUMN_NAME_SIZE], pointer[BF_POINTER_SIZE];

    for (size_t k = s->n_counters + 1; k < columns_count(s); k++) {
        columns_name(s, k, name);
        for (size_t c = 0; c < s->n_counters; c++) {
            snprintf(pointer, sizeof pointer, "/counters/%zu/id", c);
            if (strcmp(s->counters[c].id, name) == 0)
                faults_add(faults, pointer, "\"%s\" is the name of another column of the curve",
                           name);
        }
    }
}

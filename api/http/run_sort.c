#include "api/http/run_sort.h"

#include "api/json/number.h"
#include "api/json/text.h"
#include "core/base/check.h"
#include "core/observe/figure.h"

#include <stdio.h>
#include <string.h>

static const char *const words[] = {
    [API_SORT_CREATED] = "created", [API_SORT_FINISHED] = "finished", [API_SORT_NAME] = "name",
    [API_SORT_LABEL] = "label",     [API_SORT_MODEL] = "model",       [API_SORT_STATUS] = "status",
};

bool run_sort_read(const char *text, api_sort *ret_sort)
{
    const char *word = text + (*text == '-' ? 1 : 0);
    api_sort sort = { .by = (api_sort_by)text_find_word(words, API_SORT_FIGURE, word),
                      .is_rising = *text != '-' };
    figure_id id = figure_first(FIGURE_OF_RUN);
    for (; sort.by == API_SORT_FIGURE && id < figure_first(FIGURE_OF_RUN + 1); id++) {
        const figure *f = &figure_table[id];
        const bool has_part = f->part != NULL;
        const int n = snprintf(sort.figure, sizeof sort.figure, "%s%s%s", f->word,
                               has_part ? "." : "", has_part ? f->part : "");
        BF_CHECK(n > 0 && n < API_SORT_FIGURE_SIZE);
        if (strcmp(word, sort.figure) == 0)
            break;
    }
    if (id == figure_first(FIGURE_OF_RUN + 1))
        return false;
    *ret_sort = sort;
    return true;
}

bool run_sort_is_word(const char *text)
{
    api_sort sort;

    return run_sort_read(text, &sort);
}

const char *run_sort_words(void)
{
    return "created finished name label model status, a key figure of runs as residence_s.p95, "
           "each also with - before it";
}

void run_sort_write_cursor(const char *id, const char *key, char ret_cursor[API_CURSOR_SIZE])
{
    char *at = ret_cursor + snprintf(ret_cursor, API_CURSOR_SIZE, "%s", id);

    if (*key != '\0')
        *at++ = '.';
    for (; *key != '\0'; key++)
        at += snprintf(at, 3, "%02x", (unsigned)(unsigned char)*key);
    *at = '\0';
}

static int digit_of(char c)
{
    static const char digits[] = "0123456789abcdef";
    const char *found = c == '\0' ? NULL : strchr(digits, c);

    return found == NULL ? -1 : (int)(found - digits);
}

// Reads what follows the id. False: it is no key.
static bool read_key(const char *text, char ret_key[API_SORT_KEY_SIZE])
{
    size_t n = 0;

    for (; *text != '\0'; text += 2) {
        const int high = digit_of(text[0]), low = high < 0 ? -1 : digit_of(text[1]);
        if (low < 0 || (high == 0 && low == 0) || n == API_SORT_KEY_SIZE - 1)
            return false;
        ret_key[n++] = (char)(16 * high + low);
    }
    ret_key[n] = '\0';
    return n > 0;
}

// False: it is no cursor of any order.
static bool read_cursor(const char *cursor, char ret_id[API_ID_SIZE],
                        char ret_key[API_SORT_KEY_SIZE])
{
    const size_t n_id = strcspn(cursor, ".");

    if (n_id != API_ID_SIZE - 1)
        return false;
    memcpy(ret_id, cursor, n_id);
    ret_id[n_id] = ret_key[0] = '\0';
    return param_is_id(ret_id) && (cursor[n_id] == '\0' || read_key(cursor + n_id + 1, ret_key));
}

bool run_sort_read_cursor(const char *cursor, api_list_query *query)
{
    const api_sort_by by = query->sort.by;
    char id[API_ID_SIZE], key[API_SORT_KEY_SIZE];
    double value;

    if (!read_cursor(cursor, id, key) || (by == API_SORT_CREATED && key[0] != '\0'))
        return false;
    const bool is_number = by != API_SORT_NAME && by != API_SORT_LABEL;
    if (is_number && key[0] != '\0' && number_read(key, strlen(key), &value) != 0)
        return false;
    memcpy(query->before, id, sizeof id);
    memcpy(query->before_key, key, sizeof key);
    return true;
}

static bf_status read_any_cursor(const param *row, const char *text, param_value *ret_value,
                                 bf_error *err)
{
    char id[API_ID_SIZE], key[API_SORT_KEY_SIZE];

    (void)ret_value;
    if (read_cursor(text, id, key))
        return BF_OK;
    return bf_fail(err, BF_EINPUT, "", "query parameter '%s' is not from a `next` link", row->name);
}

const param_kind run_sort_cursor_kind = { "string", read_any_cursor, NULL };

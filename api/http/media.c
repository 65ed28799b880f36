#include "api/http/media.h"

#include "api/http/accept.h"
#include "core/base/check.h"

#include <string.h>

#define X(format, word, type, content_type) { format, word, type, content_type },
static const media table[] = { MEDIA_LIST(X) };
#undef X

enum { N_MEDIA = sizeof table / sizeof *table };

// Gathers the rows of the formats, in the order of formats. Returns how many.
static size_t gather(const char *formats, const media **ret_rows)
{
    size_t n = 0;

    while (*formats != '\0') {
        size_t length = strcspn(formats, " ");
        for (size_t i = 0; i < N_MEDIA; i++) {
            if (strlen(table[i].word) == length && memcmp(table[i].word, formats, length) == 0)
                ret_rows[n++] = &table[i];
        }
        formats += length;
        formats += strspn(formats, " ");
    }
    BF_CHECK(n > 0);
    return n;
}

static int find_word(const media *const *rows, size_t n, const char *word)
{
    for (size_t i = 0; i < n; i++) {
        if (strcmp(rows[i]->word, word) == 0)
            return (int)i;
    }
    return -1;
}

bf_status media_choose(const char *formats, const char *word, const char *accept,
                       const media **ret_media, bf_error *err)
{
    const media *rows[N_MEDIA];
    const char *types[N_MEDIA];
    size_t n = gather(formats, rows);

    for (size_t i = 0; i < n; i++)
        types[i] = rows[i]->type;
    int chosen = word != NULL ? find_word(rows, n, word) : accept_choose(accept, types, n);
    if (chosen < 0 && word != NULL)
        return bf_fail(err, BF_EINPUT, "", "there is no format '%.32s' of this; there is: %s", word,
                       formats);
    if (chosen < 0)
        return bf_fail(err, BF_EINPUT, "",
                       "nothing that the Accept header asks for exists of this; there is: %s",
                       formats);
    *ret_media = rows[chosen];
    return BF_OK;
}

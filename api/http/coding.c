#include "api/http/coding.h"

#include "api/http/accept.h"
#include "core/base/check.h"

#include <stdio.h>

static const char *const words[CODING_COUNT] = {
#define X(name, word) [name] = word,
    CODING_LIST(X)
#undef X
};

const char *coding_word(coding c)
{
    BF_CHECK(c >= 0 && c < CODING_COUNT);
    return words[c];
}

int coding_quality(const char *header, coding c)
{
    int quality = header == NULL ? -1 : accept_token_quality(header, coding_word(c));

    if (quality < 0 && c == CODING_GZIP && header != NULL)
        quality = accept_token_quality(header, "x-gzip"); // its old name
    if (quality < 0)
        quality = c == CODING_IDENTITY ? 1 : 0;
    return quality;
}

int coding_choose(const char *header, const coding *offers, size_t n_offers)
{
    int chosen = -1, best = 0;

    for (size_t i = 0; i < n_offers; i++) {
        int quality = coding_quality(header, offers[i]);
        if (quality > best) {
            best = quality;
            chosen = (int)i;
        }
    }
    return chosen;
}

void coding_tag(const char *tag, coding c, char *ret_tag)
{
    bool is_plain = c == CODING_IDENTITY;
    int n = snprintf(ret_tag, CODING_TAG_SIZE, "%s%s%s", tag, is_plain ? "" : "-",
                     is_plain ? "" : coding_word(c));

    BF_CHECK(n >= 0 && n < CODING_TAG_SIZE);
}

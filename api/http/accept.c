#include "api/http/accept.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

// A member of the header, "type/subtype;q=0.5".
typedef struct media_range {
    const char *type;    // not terminated
    size_t n_type;       // bytes
    const char *subtype; // not terminated
    size_t n_subtype;    // bytes
    int quality;         // thousandths
} media_range;

static bool is_space(char c)
{
    return c == ' ' || c == '\t';
}

static const char *skip_spaces(const char *text)
{
    while (is_space(*text))
        text++;
    return text;
}

// Reads a token of RFC 9110; its length may be 0.
static size_t token_length(const char *text)
{
    return strspn(text, "!#$%&'*+-.^_`|~0123456789"
                        "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ");
}

// The length of a parameter's value, a token or a quoted string; 0 if it is neither.
static size_t value_length(const char *text)
{
    size_t n = 1;

    if (*text != '"')
        return token_length(text);
    while (text[n] != '\0' && text[n] != '"')
        n += text[n] == '\\' && text[n + 1] != '\0' ? 2 : 1;
    return text[n] == '"' ? n + 1 : 0;
}

// A q-value ("0.25", at most three decimals) in thousandths, or -1.
static int read_quality(const char *text, size_t n)
{
    int quality = 0, scale = 1000;

    if (n == 0 || n > 5 || (text[0] != '0' && text[0] != '1') || (n > 1 && text[1] != '.'))
        return -1;
    for (size_t i = 0; i < n; i++) {
        if (i == 1)
            continue;
        if (text[i] < '0' || text[i] > '9')
            return -1;
        quality += (text[i] - '0') * scale;
        scale /= 10;
    }
    return quality <= 1000 ? quality : -1;
}

// Reads the parameters of a range for its q; false if they cannot be read.
static bool read_params(const char **text, media_range *range)
{
    const char *p = skip_spaces(*text);

    range->quality = 1000;
    while (*p == ';') {
        p = skip_spaces(p + 1);
        size_t n_name = token_length(p);
        const char *name = p;
        p += n_name;
        if (n_name == 0 || *p != '=')
            return false;
        p++;
        size_t n_value = value_length(p);
        if (n_value == 0)
            return false;
        if (n_name == 1 && (*name == 'q' || *name == 'Q'))
            range->quality = read_quality(p, n_value);
        p = skip_spaces(p + n_value);
    }
    *text = p;
    return range->quality >= 0 && (*p == ',' || *p == '\0');
}

static bool read_range(const char **text, media_range *ret_range)
{
    media_range range = { .type = *text, .n_type = token_length(*text) };
    const char *p = range.type + range.n_type;

    if (range.n_type == 0 || *p != '/')
        return false;
    range.subtype = p + 1;
    range.n_subtype = token_length(range.subtype);
    p = range.subtype + range.n_subtype;
    if (range.n_subtype == 0 || !read_params(&p, &range))
        return false;
    *ret_range = range;
    *text = p;
    return true;
}

// How well a range fits an offer: 3 exactly, 2 by type, 1 by */*, 0 not at all.
static int specificity(const media_range *range, const char *offer)
{
    size_t n_type = strcspn(offer, "/");
    const char *subtype = offer + n_type + 1;
    bool any_subtype = range->n_subtype == 1 && *range->subtype == '*';

    if (range->n_type == 1 && *range->type == '*')
        return any_subtype ? 1 : 0;
    if (range->n_type != n_type || strncasecmp(range->type, offer, n_type) != 0)
        return 0;
    if (any_subtype)
        return 2;
    return range->n_subtype == strlen(subtype) &&
                   strncasecmp(range->subtype, subtype, range->n_subtype) == 0
               ? 3
               : 0;
}

// The q-value that the header gives one offer, in thousandths; 0: not acceptable.
static int offer_quality(const char *header, const char *offer)
{
    int quality = 0, best = 0;

    for (const char *p = header; *p != '\0';) {
        media_range range;
        p += strspn(p, ", \t");
        if (*p == '\0')
            break;
        if (!read_range(&p, &range)) {
            p += strcspn(p, ",");
            continue;
        }
        int fit = specificity(&range, offer);
        if (fit > best) {
            best = fit;
            quality = range.quality;
        }
    }
    return quality;
}

int accept_choose(const char *header, const char *const *offers, size_t n_offers)
{
    int chosen = -1, best = 0;

    if (header == NULL || *skip_spaces(header) == '\0')
        return n_offers > 0 ? 0 : -1;
    for (size_t i = 0; i < n_offers; i++) {
        int quality = offer_quality(header, offers[i]);
        if (quality > best) {
            best = quality;
            chosen = (int)i;
        }
    }
    return chosen;
}

int accept_token_quality(const char *header, const char *token)
{
    size_t n_token = strlen(token);
    int quality = -1;

    for (const char *p = header; *p != '\0';) {
        media_range member;
        p += strspn(p, ", \t");
        const char *name = p;
        size_t n = token_length(p);
        p += n;
        if (n == 0 || !read_params(&p, &member)) {
            p += strcspn(p, ",");
            continue;
        }
        if (n == n_token && strncasecmp(name, token, n) == 0)
            return member.quality;
        if (n == 1 && *name == '*' && quality < 0)
            quality = member.quality;
    }
    return quality;
}

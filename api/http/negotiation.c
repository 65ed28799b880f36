#include "api/http/negotiation.h"

#include "core/base/check.h"

#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

// A member of Accept, "type/subtype;q=0.5".
typedef struct media_range {
    const char *type;    // not terminated
    size_t n_type;       // bytes
    const char *subtype; // not terminated
    size_t n_subtype;    // bytes
    int quality;         // thousandths
} media_range;

static const char *skip_spaces(const char *text)
{
    return text + strspn(text, " \t");
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

int negotiation_choose_type(const char *header, const char *const *offers, size_t n_offers)
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

#define X(format, word, type, content_type) { format, word, type, content_type },
static const media media_rows[] = { MEDIA_LIST(X) };
#undef X

enum { N_MEDIA = sizeof media_rows / sizeof *media_rows };

// Gathers the rows of the formats, in the order of formats. Returns how many.
static size_t gather(const char *formats, const media **ret_rows)
{
    size_t n = 0;

    while (*formats != '\0') {
        size_t length = strcspn(formats, " ");
        for (size_t i = 0; i < N_MEDIA; i++) {
            if (strlen(media_rows[i].word) == length &&
                memcmp(media_rows[i].word, formats, length) == 0)
                ret_rows[n++] = &media_rows[i];
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

bool negotiation_has_format(const char *formats, const char *word)
{
    const media *rows[N_MEDIA];

    return find_word(rows, gather(formats, rows), word) >= 0;
}

const media *negotiation_find_body(const char *formats, const char *content_type, char *ret_types)
{
    const media *rows[N_MEDIA], *found = NULL;
    const size_t n_rows = gather(formats, rows);
    const size_t n_type = strcspn(content_type, "; \t");
    size_t n = 0;

    for (size_t i = 0; i < n_rows && n < NEGOTIATION_TYPES_SIZE; i++) {
        const char *type = rows[i]->type;
        n += (size_t)snprintf(ret_types + n, NEGOTIATION_TYPES_SIZE - n, "%s%s", n == 0 ? "" : ", ",
                              type);
        if (strlen(type) == n_type && strncasecmp(content_type, type, n_type) == 0)
            found = rows[i];
    }
    return found;
}

bf_status negotiation_choose_media(const char *formats, const char *word, const char *accept,
                                   const media **ret_media, bf_error *err)
{
    const media *rows[N_MEDIA];
    const char *types[N_MEDIA];
    size_t n = gather(formats, rows);

    for (size_t i = 0; i < n; i++)
        types[i] = rows[i]->type;
    int chosen =
        word != NULL ? find_word(rows, n, word) : negotiation_choose_type(accept, types, n);
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

// The q-value of a token in a list such as "gzip;q=0.8, *;q=0", in thousandths: of its own member, else
// of `*`; -1 if neither is there. Members that cannot be read are ignored.
static int token_quality(const char *header, const char *token)
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

static const char *const coding_words[CODING_COUNT] = {
#define X(name, word) [name] = word,
    CODING_LIST(X)
#undef X
};

const char *negotiation_coding_word(coding c)
{
    BF_CHECK(c >= 0 && c < CODING_COUNT);
    return coding_words[c];
}

int negotiation_coding_quality(const char *header, coding c)
{
    int quality = header == NULL ? -1 : token_quality(header, negotiation_coding_word(c));

    if (quality < 0 && c == CODING_GZIP && header != NULL)
        quality = token_quality(header, "x-gzip"); // its old name
    if (quality < 0)
        quality = c == CODING_IDENTITY ? 1 : 0;
    return quality;
}

int negotiation_choose_coding(const char *header, const coding *offers, size_t n_offers)
{
    int chosen = -1, best = 0;

    for (size_t i = 0; i < n_offers; i++) {
        int quality = negotiation_coding_quality(header, offers[i]);
        if (quality > best) {
            best = quality;
            chosen = (int)i;
        }
    }
    return chosen;
}

void negotiation_coding_tag(const char *tag, coding c, char *ret_tag)
{
    bool is_plain = c == CODING_IDENTITY;
    int n = snprintf(ret_tag, CODING_TAG_SIZE, "%s%s%s", tag, is_plain ? "" : "-",
                     is_plain ? "" : negotiation_coding_word(c));

    BF_CHECK(n >= 0 && n < CODING_TAG_SIZE);
}

// A member of If-Match or If-None-Match, `W/"abc"`.
typedef struct entity_tag {
    const char *text; // between the quotes, not terminated
    size_t n;         // bytes
    bool is_weak;     // W/ stands before it
    bool is_any;      // it is `*`
} entity_tag;

// Takes the next member off the list. False: there is none, or none that can be read.
static bool next_tag(const char **list, entity_tag *ret_tag)
{
    const char *p = *list + strspn(*list, ", \t");
    entity_tag tag = { .is_any = *p == '*' };

    if (tag.is_any) {
        *list = p + 1;
        *ret_tag = tag;
        return true;
    }
    tag.is_weak = strncmp(p, "W/", 2) == 0;
    if (tag.is_weak)
        p += 2;
    if (*p != '"')
        return false;
    tag.text = p + 1;
    tag.n = strcspn(tag.text, "\"");
    if (tag.text[tag.n] == '\0')
        return false;
    *list = tag.text + tag.n + 1;
    *ret_tag = tag;
    return true;
}

// True if the member is the tag of one of the forms: those of quality > 0, or all (qualities NULL).
static bool is_form_of(const entity_tag *member, const char *tag, const int *qualities,
                       char *ret_tag)
{
    for (int c = 0; c < CODING_COUNT; c++) {
        char form[CODING_TAG_SIZE];
        if (qualities != NULL && qualities[c] == 0)
            continue;
        negotiation_coding_tag(tag, (coding)c, form);
        if (strlen(form) != member->n || memcmp(form, member->text, member->n) != 0)
            continue;
        memcpy(ret_tag, form, sizeof form);
        return true;
    }
    return false;
}

bool negotiation_match_etag(const char *if_none_match, const char *tag, const char *accept_encoding,
                            char *ret_tag)
{
    entity_tag member;
    int qualities[CODING_COUNT];

    for (int c = 0; c < CODING_COUNT; c++)
        qualities[c] = negotiation_coding_quality(accept_encoding, (coding)c);
    while (next_tag(&if_none_match, &member)) {
        if (member.is_any) {
            negotiation_coding_tag(tag, CODING_IDENTITY, ret_tag);
            return true;
        }
        if (is_form_of(&member, tag, qualities, ret_tag))
            return true;
    }
    return false;
}

bool negotiation_allows_change(const char *if_match, const char *tag)
{
    char form[CODING_TAG_SIZE];
    entity_tag member;

    while (next_tag(&if_match, &member)) {
        if (member.is_any || (!member.is_weak && is_form_of(&member, tag, NULL, form)))
            return true;
    }
    return false;
}

// The end of a preference in Prefer: the next comma that is not inside a quoted string.
static const char *find_preference_end(const char *text)
{
    bool is_quoted = false;

    for (; *text != '\0' && (is_quoted || *text != ','); text++) {
        if (*text == '"')
            is_quoted = !is_quoted;
        else if (is_quoted && *text == '\\' && text[1] != '\0')
            text++;
    }
    return text;
}

// Reads `= 10` or `="10"` and what may follow, up to end.
static bool read_seconds(const char *text, const char *end, unsigned *ret_seconds)
{
    unsigned long long seconds = 0;

    text = skip_spaces(text);
    if (*text != '=')
        return false;
    text = skip_spaces(text + 1);
    bool is_quoted = *text == '"';
    text += is_quoted;
    const char *digits = text;
    for (; *text >= '0' && *text <= '9'; text++)
        seconds = seconds > UINT_MAX ? seconds : seconds * 10 + (unsigned)(*text - '0');
    bool has_digits = text > digits;
    if (is_quoted && *text++ != '"')
        return false;
    text = skip_spaces(text);
    if (!has_digits || (text != end && *text != ';'))
        return false;
    *ret_seconds = seconds > UINT_MAX ? UINT_MAX : (unsigned)seconds;
    return true;
}

bool negotiation_read_wait(const char *header, unsigned *ret_seconds)
{
    static const char name[] = "wait";
    size_t n = sizeof name - 1;

    for (const char *p = header; p != NULL && *p != '\0';) {
        p += strspn(p, ", \t");
        const char *end = find_preference_end(p);
        bool is_named = strncasecmp(p, name, n) == 0 && strchr(" \t=;,", p[n]) != NULL;
        if (is_named)
            return read_seconds(p + n, end, ret_seconds);
        p = end;
    }
    return false;
}

static bool is_bare(char c)
{
    return c > ' ' && c <= '~' && strchr("\",;\\", c) == NULL;
}

// Reads an Idempotency-Key without quotes. Returns what follows it.
static const char *read_bare(const char *from, char *key, size_t *n)
{
    for (; is_bare(*from) && *n < API_KEY_SIZE; from++)
        key[(*n)++] = *from;
    return from;
}

// Reads a string behind its first quote. Returns what follows it, NULL if it is none.
static const char *read_string(const char *from, char *key, size_t *n)
{
    for (; *from != '"' && *n < API_KEY_SIZE; from++) {
        if (*from == '\\' && (from[1] == '"' || from[1] == '\\'))
            from++;
        else if (*from < ' ' || *from > '~' || *from == '\\')
            return NULL;
        key[(*n)++] = *from;
    }
    return *n < API_KEY_SIZE ? from + 1 : from;
}

bf_status negotiation_read_key(const char *header, char ret_key[API_KEY_SIZE], bf_error *err)
{
    char key[API_KEY_SIZE];
    size_t n = 0;

    if (header == NULL) {
        ret_key[0] = '\0';
        return BF_OK;
    }
    header += strspn(header, " ");
    const char *rest =
        *header == '"' ? read_string(header + 1, key, &n) : read_bare(header, key, &n);
    if (n == API_KEY_SIZE)
        return bf_fail(err, BF_EINPUT, "", "Idempotency-Key has more than %d bytes",
                       API_KEY_SIZE - 1);
    if (n == 0 || rest == NULL || rest[strspn(rest, " ")] != '\0')
        return bf_fail(err, BF_EINPUT, "",
                       "Idempotency-Key is no key: a string in quotes, or visible characters "
                       "without quotes, commas, semicolons and backslashes");
    memcpy(ret_key, key, n);
    ret_key[n] = '\0';
    return BF_OK;
}

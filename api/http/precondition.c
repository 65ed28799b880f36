#include "api/http/precondition.h"

#include <string.h>

// One member of a list, `W/"abc"`.
typedef struct entity_tag {
    const char *text; // between the quotes, not terminated
    size_t n;         // bytes
    bool is_weak;     // W/ stands before it
    bool is_any;      // it is `*`
} entity_tag;

// Takes the next member off the list. False: there is none, or none that can be read.
static bool take_tag(const char **list, entity_tag *ret_tag)
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
        coding_tag(tag, (coding)c, form);
        if (strlen(form) != member->n || memcmp(form, member->text, member->n) != 0)
            continue;
        memcpy(ret_tag, form, sizeof form);
        return true;
    }
    return false;
}

bool precondition_match_etag(const char *if_none_match, const char *tag,
                             const char *accept_encoding, char *ret_tag)
{
    entity_tag member;
    int qualities[CODING_COUNT];

    for (int c = 0; c < CODING_COUNT; c++)
        qualities[c] = coding_quality(accept_encoding, (coding)c);
    while (take_tag(&if_none_match, &member)) {
        if (member.is_any) {
            coding_tag(tag, CODING_IDENTITY, ret_tag);
            return true;
        }
        if (is_form_of(&member, tag, qualities, ret_tag))
            return true;
    }
    return false;
}

bool precondition_holds(const char *if_match, const char *tag)
{
    char form[CODING_TAG_SIZE];
    entity_tag member;

    while (take_tag(&if_match, &member)) {
        if (member.is_any || (!member.is_weak && is_form_of(&member, tag, NULL, form)))
            return true;
    }
    return false;
}

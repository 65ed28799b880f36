#include "api/json/members.h"

#include "api/json/schema.h"
#include "api/json/text.h"
#include "core/base/check.h"

#include <ctype.h>
#include <jansson.h>
#include <math.h>
#include <stdalign.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

enum { ITEM_SIZE = 16384 }; // bytes of the largest struct whose defaults are named

static void *place_of(void *item, size_t offset)
{
    return (char *)item + offset;
}

static unsigned read_choice(const void *item, size_t offset)
{
    unsigned choice; // enums of the structs are unsigned

    memcpy(&choice, (const char *)item + offset, sizeof choice);
    return choice;
}

// True if the member is of no form or of the one that the object has.
static bool is_of_form(const member_table *table, const member *m, unsigned choice)
{
    bool is_of_any = false;

    for (unsigned k = 0; table->forms[k] != NULL; k++) {
        bool is_of_this = text_has_word(table->forms[k], m->name);
        if (is_of_this && k == choice)
            return true;
        is_of_any = is_of_any || is_of_this;
    }
    return !is_of_any;
}

// True if the member can stand in the object that *item is (by its tag, its choice, its rule).
static bool applies(const member_table *table, const member *m, const void *item)
{
    if (m->applies != NULL)
        return m->applies(item);
    if (m->offset_if > 0)
        return *(const bool *)((const char *)item + m->offset_if);
    if (table->choice == MEMBER_ONE_OF)
        return (size_t)(m - table->members) == read_choice(item, table->offset_choice);
    if (table->choice == MEMBER_ONE_FORM)
        return is_of_form(table, m, read_choice(item, table->offset_choice));
    if (table->choice == MEMBER_TAGGED && m->tags != 0)
        return (m->tags >> read_choice(item, table->members[0].offset) & 1U) != 0;
    return true;
}

static const member *find_member(const member_table *table, const char *name)
{
    for (size_t k = 0; k < table->n; k++) {
        if (strcmp(table->members[k].name, name) == 0)
            return &table->members[k];
    }
    return NULL;
}

static const char *nearest_name(const member_table *table, const char *name)
{
    const char *nearest = NULL;
    size_t least = SIZE_MAX;

    for (size_t k = 0; k < table->n; k++) {
        size_t distance = text_distance(name, table->members[k].name);
        if (distance < least) {
            least = distance;
            nearest = table->members[k].name;
        }
    }
    return nearest != NULL && text_is_near(nearest, least) ? nearest : NULL;
}

static void note_unknown(json_in *in, const json_t *object, const member_table *table)
{
    for (void *at = json_object_iter((json_t *)object); at != NULL;
         at = json_object_iter_next((json_t *)object, at)) {
        const char *name = json_object_iter_key(at);
        if (find_member(table, name) != NULL)
            continue;
        const char *nearest = nearest_name(table, name);
        size_t mark = json_pointer_enter(&in->pointer, name, strlen(name));
        if (nearest != NULL)
            json_in_fault(in, "unknown member; \"%s\" is like it", nearest);
        else
            json_in_fault(in, "unknown member");
        json_pointer_leave(&in->pointer, mark);
    }
}

static void read_member(json_in *in, const json_t *object, const member_table *table,
                        const member *m, void *item)
{
    const json_t *value = json_object_get(object, m->name);
    size_t mark = json_pointer_enter(&in->pointer, m->name, strlen(m->name));

    if (!applies(table, m, item)) {
        if (value != NULL)
            json_in_fault(in, "does not belong to this %s", table->title);
    } else if (in->is_answer && m->null != NULL && json_is_null(value)) {
        // its place says the same
    } else if (value != NULL) {
        m->kind->read(in, value, m, item);
    } else if (!members_has_default(m) && (m->flags & MEMBER_KEPT) == 0) {
        json_in_fault(in, "is missing");
    }
    json_pointer_leave(&in->pointer, mark);
}

// The name that tells choice k of an object; NULL: there are no more choices.
static const char *choice_name(const member_table *table, unsigned k)
{
    if (table->choice == MEMBER_ONE_FORM)
        return table->forms[k] != NULL ? table->forms[k][0] : NULL;
    return k < table->n ? table->members[k].name : NULL;
}

static void note_choices(json_in *in, const member_table *table, unsigned n_found)
{
    char names[MEMBER_TEXT_SIZE] = "";
    size_t n = 0;

    if (table->choice != MEMBER_ONE_FORM) {
        json_in_fault(in, "must have exactly one of its members, not %u", n_found);
        return;
    }
    for (unsigned k = 0; choice_name(table, k) != NULL && n < sizeof names; k++)
        n += (size_t)snprintf(names + n, sizeof names - n, "%s%s", k == 0 ? "" : ", ",
                              choice_name(table, k));
    json_in_fault(in, "must have exactly one of: %s; not %u", names, n_found);
}

// Sets the enum of a MEMBER_ONE_OF or MEMBER_ONE_FORM; false: there is not exactly one choice.
static bool choose(json_in *in, const json_t *object, const member_table *table, void *item)
{
    unsigned n_found = 0;
    unsigned choice = 0;

    for (unsigned k = 0; choice_name(table, k) != NULL; k++) {
        if (json_object_get(object, choice_name(table, k)) != NULL) {
            n_found++;
            choice = k;
        }
    }
    if (n_found != 1) {
        note_choices(in, table, n_found);
        return false;
    }
    memcpy(place_of(item, table->offset_choice), &choice, sizeof choice);
    return true;
}

void members_read(json_in *in, const struct json_t *value, const member_table *table, void *item)
{
    if (!json_in_is_object(in, value))
        return;
    if (!in->is_answer)
        note_unknown(in, value, table);
    if ((table->choice == MEMBER_ONE_OF || table->choice == MEMBER_ONE_FORM) &&
        !choose(in, value, table, item))
        return;
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        size_t n_faults = in->faults->n;
        if ((m->flags & MEMBER_FORM) == 0)
            read_member(in, value, table, m, item);
        // Without the tag the other members cannot be checked.
        if (table->choice == MEMBER_TAGGED && k == 0 && in->faults->n != n_faults)
            return;
    }
    if (table->post_read != NULL)
        table->post_read(in, value, item);
}

void members_schema_name(const member_table *table, member_view view, char *ret_name)
{
    const char *prefix = view == MEMBER_RESOLVED ? "Resolved" : "";
    int n = snprintf(ret_name, MEMBER_TEXT_SIZE, "%s%s", prefix, table->title);

    BF_CHECK(n > 0 && n < MEMBER_TEXT_SIZE);
    char *first = ret_name + strlen(prefix);
    *first = (char)toupper((unsigned char)*first);
}

void members_write_ref(json_out *w, const member_table *table, member_view view)
{
    char name[MEMBER_TEXT_SIZE];

    members_schema_name(table, view, name);
    schema_write_ref(w, "schemas", name, strlen(name));
}

static const member *find_part(const member_table *table, const char *name, size_t n)
{
    const member *found = NULL;

    for (size_t k = 0; k < table->n && found == NULL; k++) {
        const member *m = &table->members[k];
        if (m->name == NULL)
            found = find_part(m->table, name, n);
        else if (strlen(m->name) == n && memcmp(m->name, name, n) == 0)
            found = m;
    }
    return found;
}

const char *members_unit(const member_table *table, const char *pointer)
{
    const member *m = NULL;
    bool is_list = false;

    while (*pointer == '/') {
        const char *name = pointer + 1;
        const size_t n = strcspn(name, "/");
        pointer = name + n;
        if (m != NULL && isdigit((unsigned char)*name)) {
            table = m->items != NULL ? m->items : table;
            is_list = false;
            continue;
        }
        m = table == NULL ? NULL : find_part(table, name, n);
        if (m == NULL)
            return NULL;
        table = m->table;
        is_list = m->kind->element != NULL;
    }
    return m == NULL || is_list ? NULL : m->unit;
}

// ---- ranges and defaults as texts

void members_range_text(const bf_range *range, char *ret_text)
{
    static const double two_53 = 9007199254740992.0;
    bool has_min = range != NULL && isfinite(range->minimum);
    bool has_max = range != NULL && isfinite(range->maximum);
    size_t n = 0;

    ret_text[0] = '\0';
    if (has_min && has_max && range->minimum < 0.0) {
        snprintf(ret_text, MEMBER_TEXT_SIZE, "%g to %g", range->minimum, range->maximum);
        return;
    }
    if (has_min)
        n = (size_t)snprintf(ret_text, MEMBER_TEXT_SIZE, "%s %g%s",
                             range->excludes_min ? ">" : ">=", range->minimum, has_max ? ", " : "");
    if (has_max && range->maximum == two_53 - 1.0)
        snprintf(ret_text + n, MEMBER_TEXT_SIZE - n, "< 2^53");
    else if (has_max)
        snprintf(ret_text + n, MEMBER_TEXT_SIZE - n, "%s %g",
                 range->excludes_max ? "<" : "<=", range->maximum);
}

bool members_has_default(const member *m)
{
    return m->default_text != NULL || (m->flags & MEMBER_INIT) != 0;
}

// Appends the value of a member as JSON, of an object those of its members with their units.
static void append_value(const member *m, const void *item, bf_buffer *out, bool *has_failed)
{
    const void *object = (const char *)item + m->offset;
    json_out w = json_out_to(out);

    if (m->table == NULL) {
        m->kind->write(&w, m, item);
        *has_failed |= w.has_failed;
    }
    for (size_t k = 0; m->table != NULL && k < m->table->n; k++) {
        const member *part = &m->table->members[k];
        *has_failed |= k > 0 && buffer_append(out, ", ", 2) != BF_OK;
        append_value(part, object, out, has_failed);
        if (part->unit != NULL)
            *has_failed |= buffer_printf(out, " %s", part->unit) != BF_OK;
    }
}

// Appends what init gives to the member: one value if it is the same at every place.
static void append_init(const member_table *table, const member *m, bf_buffer *out,
                        bool *has_failed)
{
    alignas(max_align_t) char item[ITEM_SIZE];
    bf_buffer first = { 0 };
    bool are_equal = true;

    BF_CHECK(table->init != NULL && table->size > 0 && table->size <= sizeof item);
    for (size_t place = 0; place < table->n_places || place == 0; place++) {
        table->init(item, place);
        *has_failed |= place > 0 && buffer_append(out, ", ", 2) != BF_OK;
        size_t n = out->n;
        append_value(m, item, out, has_failed);
        if (*has_failed)
            break;
        if (place == 0)
            *has_failed = buffer_printf(&first, "%s", out->bytes) != BF_OK;
        else
            are_equal = are_equal && strcmp(out->bytes + n, first.bytes) == 0;
    }
    if (!*has_failed && are_equal)
        buffer_truncate(out, first.n);
    buffer_fini(&first);
}

bool members_default_text(const member_table *table, const member *m, char *ret_text)
{
    bf_buffer text = { 0 };
    bool has_failed = false;

    ret_text[0] = '\0';
    if (m->default_text != NULL)
        snprintf(ret_text, MEMBER_TEXT_SIZE, "%s", m->default_text);
    if (m->default_text != NULL || (m->flags & MEMBER_INIT) == 0)
        return true;
    append_init(table, m, &text, &has_failed);
    if (!has_failed && strcmp(text.bytes, "\"\"") == 0)
        snprintf(ret_text, MEMBER_TEXT_SIZE, "empty");
    else if (!has_failed && text.bytes[0] == '"')
        snprintf(ret_text, MEMBER_TEXT_SIZE, "%.*s", (int)text.n - 2, text.bytes + 1);
    else if (!has_failed)
        snprintf(ret_text, MEMBER_TEXT_SIZE, "%s", text.bytes);
    buffer_fini(&text);
    return !has_failed;
}

// ---- writing

// MEMBER_OMIT_EMPTY
static bool is_empty(const member *m, const void *item)
{
    const void *place = (const char *)item + m->offset;
    double number;
    size_t n;

    if (m->is_empty != NULL)
        return m->is_empty(item);
    if (m->kind == &member_number || m->kind == &member_whole) {
        memcpy(&number, place, sizeof number);
        return !isfinite(number);
    }
    if (m->kind == &member_text || m->kind == &member_link)
        return *(const char *)place == '\0';
    if (m->kind == &member_bool)
        return !*(const bool *)place;
    if (m->kind == &member_enum)
        return m->words[read_choice(item, m->offset)] == NULL;
    const bool is_number = m->kind == &member_size || m->kind == &member_time;
    memcpy(&n, is_number ? place : (const char *)item + m->offset_n, sizeof n);
    return n == 0;
}

// MEMBER_OMIT_DEFAULT
static bool is_default(json_out *w, const member_table *table, const member *m, const void *item)
{
    bf_buffer standard = { 0 }, value = { 0 };

    append_init(table, m, &standard, &w->has_failed);
    append_value(m, item, &value, &w->has_failed);
    bool are_equal = !w->has_failed && strcmp(standard.bytes, value.bytes) == 0;
    buffer_fini(&standard);
    buffer_fini(&value);
    return are_equal;
}

static bool is_written(json_out *w, const member_table *table, const member *m, const void *item)
{
    if ((m->flags & MEMBER_FORM) != 0 || (m->name != NULL && m->kind->write == NULL))
        return false;
    if ((m->flags & MEMBER_OMIT_EMPTY) != 0 && is_empty(m, item))
        return false;
    if ((m->flags & MEMBER_OMIT_DEFAULT) != 0 && is_default(w, table, m, item))
        return false;
    return applies(table, m, item);
}

void members_write_into(json_out *w, const member_table *table, const void *item)
{
    for (size_t k = 0; k < table->n; k++) {
        const member *m = &table->members[k];
        if (!is_written(w, table, m, item))
            continue;
        if (m->name == NULL) {
            members_write_into(w, m->table, (const char *)item + m->offset);
            continue;
        }
        json_out_key(w, m->name);
        m->kind->write(w, m, item);
    }
}

void members_write(json_out *w, const member_table *table, const void *item)
{
    json_out_object(w);
    members_write_into(w, table, item);
    json_out_object_end(w);
}

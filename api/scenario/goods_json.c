#include "api/scenario/goods_json.h"

#include "api/json/json_out.h"
#include "api/scenario/scenario_priv.h"
#include "core/scene/goods.h"
#include "core/scene/scene.h"
#include "core/scene/shape.h"

#include <math.h>

// A row of each list, as it is written.
typedef struct item {
    const char *name;
    const char *title;
    const char *surface;
    scene_shape shape;
    double mass;
    const char *source_title;
    const char *source_url;
    const char *note;
} item;

typedef struct surface {
    const char *name;
    const char *title;
} surface;

typedef struct friction {
    const char *a;
    const char *b;
    double value;
    double range[2];
    const char *source_title;
    const char *source_url;
    const char *note;
} friction;

#define SOURCE                                                                                     \
    MEMBER("source", string, AT(source_title), "Who published it; `assumed`: nobody"),             \
        MEMBER("source_url", string, AT(source_url), "Where", .null = "there is no address",       \
               .type = "string?"),                                                                 \
        MEMBER("note", string, AT(note), "Conditions, and what is assumed of it and why")

#define AT(place) offsetof(item, place)
static const member item_members[] = {
    MEMBER("name", string, AT(name), "What `goods` of cargo is"),
    MEMBER("title", string, AT(title), "For people"),
    MEMBER("surface", string, AT(surface), "What it is made of outside",
           .null = "its frictions are the paper's", .type = "string?"),
    MEMBER("shape", object, AT(shape), "Of a part", .table = &scenario__shape_members,
           .type = "#ResolvedShape"),
    MEMBER("mass_kg", number, AT(mass), "Of a part [kg]"),
    SOURCE,
};
const member_table goods_json_item = { MEMBER_TABLE("GoodsItem", item_members) };
#undef AT

#define AT(place) offsetof(surface, place)
static const member surface_members[] = {
    MEMBER("name", string, AT(name), "What `surface` of cargo and members of `surfaces` are"),
    MEMBER("title", string, AT(title), "For people"),
};
const member_table goods_json_surface = { MEMBER_TABLE("GoodsSurface", surface_members) };
#undef AT

#define AT(place) offsetof(friction, place)
static const member friction_members[] = {
    MEMBER("a", string, AT(a), "A surface"),
    MEMBER("b", string, AT(b), "The other one"),
    MEMBER("friction", number, AT(value), "Coulomb's, which is taken: the middle of the range"),
    MEMBER("range", interval, AT(range), "What the source gives"),
    SOURCE,
};
const member_table goods_json_friction = { MEMBER_TABLE("GoodsFriction", friction_members) };
#undef AT

static const member answer_members[] = {
    MEMBER("goods", described, 0, "Usual goods", .type = "[#GoodsItem]"),
    MEMBER("surfaces", described, 0, "What goods, belts, obstacles and walls are made of",
           .type = "[#GoodsSurface]"),
    MEMBER("frictions", described, 0,
           "Of two surfaces, in any order; a pair that is missing is not known",
           .type = "[#GoodsFriction]"),
};
const member_table goods_json_members = { MEMBER_TABLE("Goods", answer_members) };

// Goods as a part of a scenario that says nothing else of its cargo.
static item make_item(scene_goods goods)
{
    const goods_item *of = &goods_items[goods];
    scene_cargo kind;

    scene_cargo_init(&kind);
    goods_apply(goods, &kind);
    if (isnan(kind.mass))
        kind.mass = SCENE_STEEL_DENSITY * shape_volume(&kind.shape);
    return (item){ .name = scene_goods_words[goods],
                   .title = of->title,
                   .surface = scene_surface_words[of->surface],
                   .shape = kind.shape,
                   .mass = kind.mass,
                   .source_title = of->source->title,
                   .source_url = of->source->url,
                   .note = of->note };
}

static friction make_friction(const goods_friction *of)
{
    return (friction){ .a = scene_surface_words[of->a],
                       .b = scene_surface_words[of->b],
                       .value = goods_friction_of(of),
                       .range = { of->low, of->high },
                       .source_title = of->source->title,
                       .source_url = of->source->url,
                       .note = of->note };
}

static void begin_list(json_out *w, const char *name)
{
    json_out_key(w, name);
    json_out_array(w);
}

bf_status goods_json_write(bf_buffer *out, bf_error *err)
{
    json_out w = json_out_to(out);

    json_out_object(&w);
    begin_list(&w, "goods");
    for (unsigned k = 0; k < SCENE_GOODS_COUNT; k++) {
        const item view = make_item((scene_goods)k);
        members_write(&w, &goods_json_item, &view);
    }
    json_out_array_end(&w);
    begin_list(&w, "surfaces");
    for (unsigned k = 0; k < SCENE_SURFACE_COUNT; k++) {
        const surface view = { scene_surface_words[k], goods_surface_titles[k] };
        members_write(&w, &goods_json_surface, &view);
    }
    json_out_array_end(&w);
    begin_list(&w, "frictions");
    for (size_t k = 0; k < goods_n_frictions; k++) {
        const friction view = make_friction(&goods_frictions[k]);
        members_write(&w, &goods_json_friction, &view);
    }
    json_out_array_end(&w);
    json_out_object_end(&w);
    return json_out_status(&w, err);
}

static bf_status append_source(bf_buffer *out, const char *title, const char *url, const char *note)
{
    const char *separator = note[0] != '\0' ? "; " : "";

    return url != NULL ? buffer_printf(out, "[%s](%s)%s%s |\n", title, url, separator, note)
                       : buffer_printf(out, "%s%s%s |\n", title, separator, note);
}

static bf_status append_item(bf_buffer *out, const item *of)
{
    const scene_shape *s = &of->shape;

    BF_TRY(buffer_printf(out, "| `%s` | %s | ", of->name, of->title));
    if (s->type == SCENE_CYLINDER)
        BF_TRY(buffer_printf(out, "⌀ %g × %g", 2000.0 * s->radius, 1000.0 * s->height));
    else
        BF_TRY(buffer_printf(out, "%g × %g × %g", 1000.0 * s->length, 1000.0 * s->width,
                             1000.0 * s->height));
    BF_TRY(buffer_printf(out, " | %.4g | %s | ", of->mass,
                         of->surface != NULL ? of->surface : "the paper's"));
    return append_source(out, of->source_title, of->source_url, of->note);
}

static bf_status append_friction(bf_buffer *out, const friction *of)
{
    const bool is_range = of->range[0] < of->range[1];

    BF_TRY(buffer_printf(out, "| %s | %s | %g | ", of->a, of->b, of->value));
    if (is_range)
        BF_TRY(buffer_printf(out, "%g to %g", of->range[0], of->range[1]));
    BF_TRY(buffer_printf(out, " | "));
    return append_source(out, of->source_title, of->source_url, of->note);
}

bf_status goods_json_write_text(bf_buffer *out, bf_error *err)
{
    bf_status status = buffer_printf(
        out, "| goods | are | mm | kg | surface | source |\n|---|---|---|---|---|---|\n");

    for (unsigned k = 0; k < SCENE_GOODS_COUNT && status == BF_OK; k++) {
        const item view = make_item((scene_goods)k);
        status = append_item(out, &view);
    }
    if (status == BF_OK)
        status = buffer_printf(out, "\n| surface | means |\n|---|---|\n");
    for (unsigned k = 0; k < SCENE_SURFACE_COUNT && status == BF_OK; k++)
        status =
            buffer_printf(out, "| `%s` | %s |\n", scene_surface_words[k], goods_surface_titles[k]);
    if (status == BF_OK)
        status = buffer_printf(
            out, "\n| surface | on | friction | range | source |\n|---|---|---|---|---|\n");
    for (size_t k = 0; k < goods_n_frictions && status == BF_OK; k++) {
        const friction view = make_friction(&goods_frictions[k]);
        status = append_friction(out, &view);
    }
    return status == BF_OK ? BF_OK : bf_fail_memory(err);
}

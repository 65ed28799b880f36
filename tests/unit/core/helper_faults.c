#include "tests/unit/core/helper_faults.h"

#include "tests/unit/core/helper_scene.h"
#include "tests/unit/helper_cmocka.h"

#include <string.h>

const bf_faults *helper_faults_of(scene *s)
{
    static bf_faults faults;

    faults = (bf_faults){ 0 };
    helper_scene_resolve(s);
    scene_check(s, &faults);
    scene_fini(s);
    return &faults;
}

void helper_faults_none(scene *s)
{
    const bf_faults *faults = helper_faults_of(s);

    if (faults->n > 0)
        fail_msg("%s: %s", faults->items[0].pointer, faults->items[0].text);
}

void helper_faults_one(scene *s, const char *pointer, const char *words)
{
    const bf_faults *faults = helper_faults_of(s);

    if (faults->n != 1 || strcmp(faults->items[0].pointer, pointer) != 0 ||
        strstr(faults->items[0].text, words) == NULL)
        fail_msg("%zu faults, %s: %s; not %s: %s", faults->n, faults->items[0].pointer,
                 faults->items[0].text, pointer, words);
}

void helper_faults_each(void (*make)(scene *s), const helper_faults_case *cases, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        scene s;
        make(&s);
        cases[k].spoil(&s);
        helper_faults_one(&s, cases[k].pointer, cases[k].words);
    }
}

#include "server/base/log.h"
#include "server/run/confinement.h"

static const char *word_of(bool is_there)
{
    return is_there ? "yes" : "no";
}

void confinement_report(void)
{
    const unsigned wanted = 1U << METRICS_LAYER_FILES | 1U << METRICS_LAYER_CALLS;
    const unsigned layers = confinement_find();
    const bool is_whole = (layers & wanted) == wanted;

    for (unsigned layer = 0; layer < METRICS_LAYER_COUNT; layer++)
        metrics_set(METRICS_CONFINEMENT, layer, layers >> layer & 1);
    log_event(
        is_whole ? LOG_LEVEL_INFO : LOG_LEVEL_WARN,
        is_whole ? "solvers_confined" : "solvers_not_confined",
        "files=%s tcp=%s signals=%s system_calls=%s%s", word_of(layers >> METRICS_LAYER_FILES & 1),
        word_of(layers >> METRICS_LAYER_TCP & 1), word_of(layers >> METRICS_LAYER_SIGNALS & 1),
        word_of(layers >> METRICS_LAYER_CALLS & 1),
        is_whole ? ""
                 : " why=\"the build has a sanitizer, or the kernel no Landlock or no seccomp\"");
}

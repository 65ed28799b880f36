#include "api/services.h"

#include "core/base/check.h"

const char *api_event_word(api_event_type type)
{
    static const char *const words[] = {
#define X(type, word) [type] = word,
        API_EVENT_LIST(X)
#undef X
    };
    BF_CHECK(type < API_EVENT_TYPE_COUNT);
    return words[type];
}

void api_curve_fini(api_curve *curve)
{
    if (curve == NULL)
        return;
    buffer_fini(&curve->columns);
    buffer_fini(&curve->t);
    buffer_fini(&curve->values);
    *curve = (api_curve){ 0 };
}

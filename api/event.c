#include "api/event.h"

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

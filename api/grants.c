#include "api/grants.h"

#include "core/base/memory.h"

void api_grant_list_fini(api_grant_list *list)
{
    if (list == NULL)
        return;
    memory_free(list->grants);
    *list = (api_grant_list){ .n = 0 };
}

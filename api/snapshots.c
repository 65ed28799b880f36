#include "api/snapshots.h"

void api_slices_fini(api_slices *slices)
{
    if (slices->destroy != NULL)
        slices->destroy(slices->state);
    *slices = (api_slices){ .n = 0 };
}

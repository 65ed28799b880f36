#include "api/leases.h"

#include "core/base/memory.h"

void api_lease_fini(api_lease *lease)
{
    memory_free(lease->jobs);
    *lease = (api_lease){ .n_jobs = 0 };
}

void api_renewal_fini(api_renewal *renewal)
{
    memory_free(renewal->jobs);
    memory_free(renewal->ended);
    *renewal = (api_renewal){ .n_jobs = 0 };
}

void api_worker_list_fini(api_worker_list *list)
{
    memory_free(list->workers);
    memory_free(list->leases);
    *list = (api_worker_list){ .n = 0 };
}

#include "server/base/thread.h"

#include "core/base/check.h"

#include <signal.h>
#include <string.h>

bf_status thread_start(pthread_t *ret_thread, void *(*work)(void *), void *context,
                       const char *name, bf_error *err)
{
    sigset_t all, before;

    sigfillset(&all);
    BF_CHECK(pthread_sigmask(SIG_SETMASK, &all, &before) == 0);
    const int error = pthread_create(ret_thread, NULL, work, context);
    BF_CHECK(pthread_sigmask(SIG_SETMASK, &before, NULL) == 0);
    if (error != 0)
        return bf_fail(err, BF_ESYSTEM, "", "cannot start a thread of %s: %s", name,
                       strerror(error));
    return BF_OK;
}

// What the store remembers of how it was used.

#include "server/store/store_priv.h"

static bf_status apply_need_tokens(store__connection *writer, store__operation *operation,
                                   bf_error *err)
{
    (void)operation;
    return store__run_plain(writer, STORE__SQL_NEED_TOKENS, err);
}

bf_status store_need_tokens(store *s, bf_error *err)
{
    return store__write(s, apply_need_tokens, NULL, err);
}

bf_status store_needs_tokens(store *s, bool *ret_needs, bf_error *err)
{
    store__connection *reader = store__acquire_reader(&s->pool);
    int64_t needs = 0;

    bf_status status = store__read_number(reader, STORE__SQL_NEEDS_TOKENS, &needs, err);
    store__release_reader(&s->pool, reader);
    if (status == BF_OK)
        *ret_needs = needs != 0;
    return status;
}

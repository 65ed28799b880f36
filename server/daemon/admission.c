#include "server/daemon/admission.h"

#include "server/base/log.h"

#include <string.h>

static void warn(const char *why)
{
    log_event(LOG_LEVEL_WARN, "open_to_everybody",
              "why=%s error=\"there is no access token: whoever comes may submit, read and "
              "remove\"",
              why);
}

bf_status admission_check(const config *c, store *s, tokens *t, bf_error *err)
{
    const bool has_strangers = c->trusted_proxies[0] != '\0' || c->hosts[0] != '\0';
    bool needs_tokens = false;

    if (tokens_exist(t))
        return store_need_tokens(s, err);
    BF_TRY(store_needs_tokens(s, &needs_tokens, err));
    if (needs_tokens && strcmp(c->access, "open") != 0)
        return bf_fail(
            err, BF_EINPUT, "",
            "the store in %.200s was used with access tokens, and there are none: put "
            "access.db back, or add one (beltflowd token add NAME), or set access = open to "
            "let everybody submit, read and remove",
            c->data);
    if (has_strangers && strcmp(c->plaintext, "open") != 0)
        return bf_fail(
            err, BF_EINPUT, "",
            "%s says that a proxy passes on the requests of others, and there is no access "
            "token: add one (beltflowd token add NAME), or set plaintext = open to let "
            "everybody submit, read and remove",
            c->trusted_proxies[0] != '\0' ? "trusted_proxies" : "hosts");
    if (needs_tokens)
        warn("access");
    if (has_strangers)
        warn("plaintext");
    return BF_OK;
}

void admission_note(store *s, tokens *t, bool *has_noted)
{
    char quoted[LOG_QUOTED_SIZE];
    bf_error err = { 0 };

    if (*has_noted || !tokens_exist(t))
        return;
    *has_noted = store_need_tokens(s, &err) == BF_OK;
    if (!*has_noted)
        log_event(LOG_LEVEL_WARN, "tokens_not_noted", "error=%s", log_quote(err.text, quoted));
}

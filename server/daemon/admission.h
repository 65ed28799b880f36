/// Whether the daemon may be started as it is: nobody may come in without a token because a file was lost, or because a
/// proxy brings strangers to an address of this machine.

#pragma once

#include "core/base/status.h"
#include "server/daemon/config.h"
#include "server/store/store.h"
#include "server/store/tokens.h"

/// Refuse to serve everybody unasked. BF_EINPUT: there are no tokens, and the store was used with some (access.db was lost,
/// or the store comes from a copy without it; unless `access = open`), or the settings `hosts` or `trusted_proxies` say that
/// others than this machine come (unless `plaintext = open`). With tokens the store remembers them from now on.
BF_MUST_CHECK bf_status admission_check(const config *c, store *s, tokens *t, bf_error *err);

/// Let the store remember tokens that were made since. *has_noted: it does.
void admission_note(store *s, tokens *t, bool *has_noted);

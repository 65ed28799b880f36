/// What each owner of tokens uses and when tokens expire, as lines of /metrics.

#pragma once

#include "server/store/store.h"
#include "server/store/tokens.h"

/// Append them to *out, in Prometheus' text form; nothing where there are no tokens. Reads the store. BF_ENOMEM; BF_ESYSTEM.
BF_MUST_CHECK bf_status owner_figures_write(tokens *t, store *s, bf_buffer *out, bf_error *err);

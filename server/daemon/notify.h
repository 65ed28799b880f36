/// State notifications to the service manager (sd_notify): ready, reloading, stopping, watchdog, and a
/// status text. Without a manager the functions do nothing. The only place beside the journal
/// that includes libsystemd.
///
/// Threads  any; none waits.

#pragma once

#include <stdint.h>

enum { NOTIFY_TEXT_SIZE = 256 }; ///< bytes of a text with its terminator; a longer one is cut

/// The daemon serves: everything is open. Also the end of what notify_reloading() began.
void notify_ready(const char *format, ...) __attribute__((format(printf, 1, 2)));

/// The settings are being read again.
void notify_reloading(void);

/// The daemon stops.
void notify_stopping(const char *format, ...) __attribute__((format(printf, 1, 2)));

/// Watchdog notification, with a status text for operators.
void notify_alive(const char *format, ...) __attribute__((format(printf, 1, 2)));

/// How often notify_alive() must be called at least, ms; 0: the manager does not watch.
int64_t notify_watchdog_ms(void);

#include "server/daemon/notify.h"

#include "server/base/clock.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <systemd/sd-daemon.h>

// Sends head, a line or more, and the text of a status.
static void send_status(const char *head, const char *format, va_list args)
    __attribute__((format(printf, 2, 0)));

static void send_status(const char *head, const char *format, va_list args)
{
    char text[NOTIFY_TEXT_SIZE];

    (void)vsnprintf(text, sizeof text, format, args);
    (void)sd_notifyf(0, "%s\nSTATUS=%s", head, text);
}

void notify_ready(const char *format, ...)
{
    va_list args;

    va_start(args, format);
    send_status("READY=1", format, args);
    va_end(args);
}

void notify_reloading(void)
{
    (void)sd_notifyf(0,
                     "RELOADING=1\nMONOTONIC_USEC=%" PRId64 "\nSTATUS=reading the settings again",
                     clock_monotonic_ns() / 1000);
}

void notify_stopping(const char *format, ...)
{
    va_list args;

    va_start(args, format);
    send_status("STOPPING=1", format, args);
    va_end(args);
}

void notify_alive(const char *format, ...)
{
    va_list args;

    va_start(args, format);
    send_status("WATCHDOG=1", format, args);
    va_end(args);
}

int64_t notify_watchdog_ms(void)
{
    uint64_t interval_us = 0;

    return sd_watchdog_enabled(0, &interval_us) > 0 ? (int64_t)(interval_us / 1000) : 0;
}

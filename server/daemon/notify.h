#pragma once
/* Reports the daemon's state to the service manager that started it: datagrams to the Unix socket in NOTIFY_SOCKET, as
 * in sd_notify(3). Without that variable nothing is sent. Main thread only. */
#include <stdint.h>

/* Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID, and removes them from the environment: child processes must not
 * report in the daemon's place. */
void notify_open(void);
/* "READY=1", "WATCHDOG=1", "STOPPING=1" */
void notify_send(const char *state);
/* The manager kills the daemon when it gets no "WATCHDOG=1" for this long; 0: there is no watchdog. */
int64_t notify_watchdog_us(void);

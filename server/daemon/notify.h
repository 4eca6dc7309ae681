#pragma once
/* Tells the service manager that started us about our state: a datagram to the Unix socket named by NOTIFY_SOCKET, as
 * sd_notify(3) describes it. Without that variable nothing is told. Main thread only. */
#include <stdint.h>

/* Reads NOTIFY_SOCKET, WATCHDOG_USEC and WATCHDOG_PID and takes them out of the environment: our children must not
 * answer for us. */
void notify_open(void);
/* "READY=1", "WATCHDOG=1", "STOPPING=1" */
void notify_send(const char *state);
/* The manager kills us when it hears no "WATCHDOG=1" for so long; 0: it does not watch. */
int64_t notify_watchdog_us(void);

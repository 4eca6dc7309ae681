#pragma once
/* The watchdog: checks that the serving threads still run. Each has to set a mark; only when all have, the service
 * manager is sent a sign of life, and the marks are cleared for the next round. When a thread hangs its mark stays
 * unset: the manager then ends the process and starts another one. Main thread. */
#include <stdint.h>

struct net;
struct front;
struct tls;

enum { HEARTBEAT_PARTS = 4 }; /* rounds within the manager's time limit */

struct heartbeat;

/* net, front and tls outlive it. tls: NULL when there is none. */
struct heartbeat *heartbeat_create(struct net *net, struct front *front, struct tls *tls);
/* After all threads have ended. */
void heartbeat_destroy(struct heartbeat *heartbeat);
/* Time until the next heartbeat_beat; -1: there is no watchdog. */
int64_t heartbeat_wait_us(const struct heartbeat *heartbeat);
void heartbeat_beat(struct heartbeat *heartbeat);

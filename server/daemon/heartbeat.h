#pragma once
/* Whether the threads that serve still move. Each is asked to set a mark; only when all have is the service manager
 * told that we live, and asks again. A thread that hangs leaves its mark unset: the manager then ends the process and
 * starts another one. */
#include <stdint.h>

struct net;
struct http;
struct acceptor;

enum { HEARTBEAT_PARTS = 4 }; /* so many rounds fit into the time the manager waits */

struct heartbeat;

/* All three outlive it. */
struct heartbeat *heartbeat_create(struct net *net, struct http *http, struct acceptor *acceptor);
/* After all threads have ended. */
void heartbeat_destroy(struct heartbeat *heartbeat);
/* How long to wait before the next heartbeat_beat; -1: for ever, nobody watches. */
int64_t heartbeat_wait_us(const struct heartbeat *heartbeat);
void heartbeat_beat(struct heartbeat *heartbeat);

#pragma once
/* The socket to the daemon: whole, checked packets in, packets out without ever blocking. Thread: the main thread. */
#include "server/wire/packet.h"

struct link;

/* Takes the socket and makes it non-blocking. max_bytes: memory the process may take, which problems with memory name;
 * 0: no limit. */
struct link *link_create(int socket, uint64_t max_bytes);
void link_destroy(struct link *link);
int link_file(const struct link *link);
bool link_has_outgoing(const struct link *link);
/* Queues a packet and writes what the socket takes. The blob is copied. A packet that cannot be sent (too large, out of
 * range) is replaced by a problem with the same id, or by failed: the daemon waits for an answer. */
void link_send(struct link *link, const struct packet *packet, const uint8_t *blob, size_t n_blob);
/* Answers the request id with a problem. */
void link_send_problem(struct link *link, int64_t id, const struct problem *problem);
/* Reports that the plan cannot be loaded. */
void link_send_failed(struct link *link, const struct problem *problem);
/* Writes what the socket takes. */
void link_write(struct link *link);
/* Reads the bytes received. False: the daemon's end is closed, or memory is lacking. */
bool link_read(struct link *link);
/* 1 a packet (the caller's to finish), 0 none yet, -1 the daemon sent something that is no packet. */
int link_take(struct link *link, struct packet *packet);
/* Writes everything, waiting up to timeout_ms: for the last packets before the process ends. */
void link_flush(struct link *link, int timeout_ms);

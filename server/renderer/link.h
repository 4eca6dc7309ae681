#pragma once
/* The socket to the daemon: whole packets in, packets out without ever blocking. One thread. */
#include "server/wire/packet.h"

struct link;

struct link *link_create(int socket); /* takes the socket and makes it non-blocking */
void link_destroy(struct link *link);
int link_file(const struct link *link);
bool link_has_outgoing(const struct link *link);
/* Queues a packet and writes what fits. blob is copied. */
void link_say(struct link *link, const cJSON *json, const uint8_t *blob, size_t n_blob);
void link_write(struct link *link);
/* Reads what is there. False: the daemon's end is closed, or says what is no packet. */
bool link_read(struct link *link);
/* 1 a packet, 0 none yet, -1 broken. */
int link_take(struct link *link, struct packet *packet);
/* Writes everything, waiting up to timeout_ms: for the last words. */
void link_flush(struct link *link, int timeout_ms);

#pragma once
/* One link: a client's connection, from its first byte to its end. Internal to server/front; the relay's thread. */
#include "server/front/relay_state.h"

/* Does all that can be done now: receives, checks, passes on, sends, ends. */
void relay_link_advance(struct relay_link *link);
/* Sends the bytes that the library has written, as far as the client takes them. */
void relay_link_pass_answer(struct relay_link *link);
/* Ends the link with an answer, if none has begun; reads and drops up to max_dropped bytes more. */
void relay_link_refuse(struct relay_link *link, const struct problem *problem, uint64_t max_dropped);
/* Ends the link at once; the thread frees it when the library has closed its end, too. */
void relay_link_die(struct relay_link *link);
void relay_end_oldest_lingering(struct relay *relay);
void relay_link_begin_window(struct relay_link *link);

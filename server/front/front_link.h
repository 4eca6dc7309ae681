#pragma once
/* One link: a client's connection, from its first byte to its end. Internal to server/front; the front's thread. */
#include "server/front/front_state.h"

/* Does all that can be done now: receives, checks, passes on, sends, ends. */
void front_link_advance(struct front_link *link);
/* Sends the bytes that the library has written, as far as the client takes them. */
void front_link_pass_answer(struct front_link *link);
/* Ends the link with an answer, if none has begun; reads and drops up to max_dropped bytes more. */
void front_link_refuse(struct front_link *link, const struct problem *problem, uint64_t max_dropped);
/* Refuses a head that is not whole in its time. */
void front_link_refuse_late(struct front_link *link);
/* Ends the link at once; the thread frees it when the library has closed its end, too. */
void front_link_die(struct front_link *link);
void front_link_begin_window(struct front_link *link);

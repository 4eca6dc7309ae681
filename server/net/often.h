#pragma once
/* Rows for the audit of what may happen many times a second, as pictures and refusals: the first at once, and what is
 * equal to it in everything but its time as one row a minute, with its number. Internal to server/net; net thread. */
#include "server/net/net_state.h"

enum { OFTEN_MAX = 256, OFTEN_EVERY_MS = 60000 };

void often_tick(struct net *net);   /* writes rows that are due */
void often_finish(struct net *net); /* writes all that is left: the server stops */

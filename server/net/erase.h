#pragma once
/* Erases what is kept of a plan (net_erase_plan): says so on the disk, ends its rooms and its renderer, throws its
 * files away, and has the store erase the rows. Internal to server/net; net thread. */
#include "server/net/net_state.h"

void erase_answered(struct net *net, const struct store_answer *answer); /* borrowed */
void erase_tick(struct net *net); /* goes on once the files are gone; to be called often while one runs */
void erase_end(struct net *net);  /* the server stops: the next start goes on */

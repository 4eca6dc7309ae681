#pragma once
/* Counts connections by state and per client, and keeps the list of links that have something to do. Internal to
 * server/front; the front's thread. */
#include "server/front/front_state.h"

/* Every change of a link's state, so that waiting and lingering links are counted. */
void front_set_state(struct front_link *link, enum link_state state);
/* The first head is whole: the connection waits no longer. */
void front_end_waiting(struct front_link *link);
/* True if one more connection from this address may wait for its first head. */
bool front_may_wait(const struct front *front, const struct address *peer, bool is_trusted);
/* Counts the connection for this client, and no longer for another. Returns false with a problem at the limit. */
bool front_count(struct front_link *link, const struct address *client, struct problem *problem);
void front_uncount(struct front_link *link);
/* Stops counting a connection whose client is gone, unless the library still has its end: then front_link_closed does.
 */
void front_uncount_ended(struct front_link *link);
/* Counts a refused connection, and logs the sum at most every 10 s. */
void front_log_refusal(struct front *front);
/* Has the thread advance the link in its next round. */
void front_touch(struct front_link *link);

#pragma once
/* Counts connections per client, and keeps the list of links that have something to do. Internal to server/front; the
 * relay's thread. */
#include "server/front/relay_state.h"

/* Counts the connection for this client, and no longer for another. Returns false with a problem at the limit. */
bool relay_count(struct relay_link *link, const struct address *client, struct problem *problem);
void relay_uncount(struct relay_link *link);
/* Stops counting a connection whose client is gone, unless the library still has its end: then relay_link_closed does.
 */
void relay_uncount_ended(struct relay_link *link);
/* Counts a refused connection, and logs the sum at most every 10 s. */
void relay_log_refusal(struct relay *relay);
/* Has the thread advance the link in its next round. */
void relay_touch(struct relay_link *link);

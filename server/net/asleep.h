#pragma once
/* Rooms that are kept on disk alone: their list, and waking them by reading them. Internal to server/net; net thread.
 */
#include "server/net/net_state.h"

struct asleep_room *asleep_find(const struct net *net, const char *room_id);
void asleep_add(struct net *net, const struct store_summary *facts); /* the one last used; takes what it owns */
/* Adds those that are not awake or listed yet, in their order, and takes what they own. */
void asleep_add_all(struct net *net, struct store_summary *rooms, size_t n);
void asleep_remove(struct net *net, const char *room_id);
/* The room is read, unless it is already; done is called with asleep_woken. */
void asleep_wake(struct net *net, const char *room_id,
                 void (*done)(void *context, const char *room_id, const struct problem *problem), void *context);
/* Calls who waits for the room; problem NULL: it is awake. room_id NULL: whoever waits for any. */
void asleep_tell(struct net *net, const char *room_id, const struct problem *problem);
/* The room that this answer of the store is about; NULL: it was deleted meanwhile. */
struct asleep_room *asleep_of_answer(const struct net *net, const struct store_answer *answer);
/* Like asleep_wake, for the room that has a bookmark with this token. */
void asleep_wake_bookmark(struct net *net, const char *token,
                          void (*done)(void *context, const char *room_id, const struct problem *problem),
                          void *context);
/* The waiter for that whose answer this is; NULL: none. */
const struct waiter *asleep_waiter_of_answer(const struct net *net, const struct store_answer *answer);
void asleep_finish(struct net *net);

#pragma once
/* The life of rooms. Those of net.h that begin with net_room are here as well. Internal to server/net; net thread. */
#include "server/net/net_state.h"

struct net_room *rooms_find(const struct net *net, const char *id);
/* The id that the plan has now: rooms on the disk may have that of a time when people signed in, or when they did not.
 */
const char *rooms_plan_id_now(const struct net *net, const char *plan_id, char known[64]);
/* Closes the room in memory; on disk it stays as it is. */
void rooms_close(struct net *net, size_t index);
/* Puts rooms to sleep that nobody was in for a while; deletes those that nobody ever used. */
void rooms_close_idle(struct net *net);
/* Time until the next one is due for that; INT64_MAX: none will be. */
int64_t rooms_idle_left_us(const struct net *net, int64_t now_us);
/* A room that sleeps was read from the disk, or cannot be. */
void rooms_was_read(struct net *net, const struct store_answer *answer);

#pragma once
/* When the net thread wakes: at the earliest time that a room or the fleet is due. Internal to server/net. */
#include "server/net/net_state.h"

/* Notes when the room is due next. To be called after anything that came into it. */
void schedule_room(struct net_room *room);
/* Settles the room, then notes when it is due next. */
void schedule_settle(struct net_room *room);
/* The room is due at this time at the latest. */
void schedule_room_at(struct net_room *room, int64_t time_us);
/* Something of rooms, or of what is kept of them, is due at this time at the latest; 0: soon. */
void schedule_at(struct net *net, int64_t time_us);
/* True when a room is due, or what is kept of one. */
bool schedule_is_due(const struct net *net);
/* Does what is due of rooms. */
void schedule_due_rooms(struct net *net);
/* Sets the thread's next wake-up to the earliest time due. */
void schedule_wake(struct net *net);

#pragma once
/* When the net thread wakes: at the earliest time that a room or the fleet is due. Internal to server/net. */
#include "server/net/net_state.h"

/* Ticks the room and notes when it is due next. To be called after anything that may have changed that. */
void schedule_room(struct net_room *room);
/* Sets the thread's next wake-up to the earliest time due. */
void schedule_wake(struct net *net);

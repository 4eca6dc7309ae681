/* Ticks rooms and sets the net thread's next wake-up. */
#include "server/net/schedule.h"

#include "core/base/clock.h"

void schedule_wake(struct net *net)
{
    int64_t next_us = net->fleet_tick_us;
    for (size_t i = 0; i < net->n_rooms; i++)
        if (net->rooms[i]->wake_us < next_us)
            next_us = net->rooms[i]->wake_us;
    ws_wake_at(net->ws, next_us);
}

void schedule_room(struct net_room *room)
{
    int64_t now_us = clock_now_us();
    room->wake_us = room_tick(room->room, now_us);
    if (room_n_connected(room->room))
        room->empty_since_us = 0;
    else if (room->empty_since_us == 0)
        room->empty_since_us = now_us;
}

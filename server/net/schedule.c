/* Settles rooms and sets the net thread's next wake-up. */
#include "server/net/schedule.h"

#include "core/base/clock.h"

/* net->due_us only moves to earlier times here; schedule_due_rooms, once it is reached, finds the true one. */
void schedule_at(struct net *net, int64_t time_us)
{
    if (time_us < net->due_us)
        net->due_us = time_us;
}

void schedule_wake(struct net *net)
{
    ws_wake_at(net->ws, net->due_us < net->fleet_tick_us ? net->due_us : net->fleet_tick_us);
}

void schedule_room(struct net_room *room)
{
    room->wake_us = room_due_us(room->room);
    schedule_at(room->net, room->wake_us);
    if (room_n_connected(room->room))
        room->empty_since_us = 0;
    else if (room->empty_since_us == 0)
        room->empty_since_us = clock_now_us();
}

void schedule_settle(struct net_room *room)
{
    (void)room_settle(room->room, clock_now_us());
    schedule_room(room);
}

void schedule_room_at(struct net_room *room, int64_t time_us)
{
    if (time_us < room->wake_us)
        room->wake_us = time_us;
    schedule_at(room->net, time_us);
}

bool schedule_is_due(const struct net *net)
{
    return net->due_us <= clock_now_us();
}

void schedule_due_rooms(struct net *net)
{
    const int64_t now_us = clock_now_us();
    net->due_us = net->looked_us ? net->looked_us : INT64_MAX;
    for (size_t i = 0; i < net->n_rooms; i++)
        if (net->rooms[i]->wake_us <= now_us)
            schedule_settle(net->rooms[i]);
        else
            schedule_at(net, net->rooms[i]->wake_us);
}

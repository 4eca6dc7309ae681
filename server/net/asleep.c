/* The list of rooms that sleep, and who waits for one. */
#include "server/net/asleep.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "core/base/mem.h"

struct asleep_room *asleep_find(const struct net *net, const char *id)
{
    for (size_t i = 0; i < net->n_asleep; i++)
        if (strcmp(net->asleep[i].facts.id, id) == 0)
            return &net->asleep[i];
    return NULL;
}

static bool is_awake(const struct net *net, const char *id)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        if (strcmp(room_id(net->rooms[i]->room), id) == 0)
            return true;
    return false;
}

/* Place for n more; false: no memory. */
static bool reserve(struct net *net, size_t n)
{
    void *more = realloc(net->asleep, (net->n_asleep + n) * sizeof net->asleep[0]);
    if (more)
        net->asleep = more;
    else
        log_error("no memory for the list of %zu rooms that sleep", net->n_asleep + n);
    return more != NULL;
}

void asleep_add(struct net *net, const struct store_summary *facts)
{
    if (!reserve(net, 1)) { /* it is found again after a restart */
        struct store_summary lost = *facts;
        store_summary_finish(&lost);
        return;
    }
    memmove(net->asleep + 1, net->asleep, net->n_asleep * sizeof net->asleep[0]);
    net->asleep[0] = (struct asleep_room){ .facts = *facts };
    net->n_asleep++;
    net->n_unchanged += !facts->is_changed;
}

void asleep_add_all(struct net *net, struct store_summary *rooms, size_t n)
{
    if (n == 0 || !reserve(net, n))
        return;
    for (size_t i = 0; i < n; i++)
        if (id_is_valid(rooms[i].id) && id_is_valid(rooms[i].plan) && !is_awake(net, rooms[i].id) &&
            !asleep_find(net, rooms[i].id)) {
            net->asleep[net->n_asleep++] = (struct asleep_room){ .facts = rooms[i] };
            rooms[i].people = rooms[i].names = rooms[i].users = NULL;
            net->n_unchanged += !rooms[i].is_changed;
        }
}

void asleep_remove(struct net *net, const char *id)
{
    struct asleep_room *room = asleep_find(net, id);
    if (!room)
        return;
    net->n_unchanged -= !room->facts.is_changed;
    store_summary_finish(&room->facts);
    net->n_asleep--;
    memmove(room, room + 1, (size_t)(net->asleep + net->n_asleep - room) * sizeof *room);
}

void asleep_wake(struct net *net, const char *id,
                 void (*done)(void *context, const char *room_id, const struct problem *problem), void *context)
{
    struct asleep_room *room = asleep_find(net, id);
    struct problem problem;
    if (room && !room->ticket && store_read(net->store, id, net->n_tickets + 1))
        room->ticket = ++net->n_tickets;
    if (room && room->ticket) {
        struct waiter *waiter = mem_new(sizeof *waiter), **at = &net->waiters;
        *waiter = (struct waiter){ .done = done, .context = context };
        (void)snprintf(waiter->room, sizeof waiter->room, "%s", id);
        while (*at)
            at = &(*at)->next;
        *at = waiter;
        return;
    }
    if (room) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the disk has too much to do to read the room now");
        problem.retry_after_ms = 1000;
    } else {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", id);
    }
    done(context, id, &problem);
}

void asleep_wake_bookmark(struct net *net, const char *token,
                          void (*done)(void *context, const char *room_id, const struct problem *problem),
                          void *context)
{
    struct problem problem;
    if (!net->store || !net->n_asleep || !store_read(net->store, token, net->n_tickets + 1)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no bookmark with this token");
        done(context, token, &problem);
        return;
    }
    struct waiter *waiter = mem_new(sizeof *waiter);
    *waiter = (struct waiter){ .next = net->waiters, .ticket = ++net->n_tickets, .done = done, .context = context };
    (void)snprintf(waiter->room, sizeof waiter->room, "%s", token);
    net->waiters = waiter;
}

const struct waiter *asleep_waiter_of_answer(const struct net *net, const struct store_answer *answer)
{
    const struct waiter *waiter = net->waiters;
    while (waiter && !(waiter->ticket && waiter->ticket == answer->ticket))
        waiter = waiter->next;
    return waiter;
}

void asleep_tell(struct net *net, const char *id, const struct problem *problem)
{
    struct waiter *told = NULL, **end = &told;
    for (struct waiter **at = &net->waiters; *at;) { /* out of the list first: done may wake another room */
        struct waiter *waiter = *at;
        if (id && strcmp(waiter->room, id) != 0) {
            at = &waiter->next;
            continue;
        }
        *at = waiter->next;
        waiter->next = NULL;
        *end = waiter;
        end = &waiter->next;
    }
    while (told) {
        struct waiter *waiter = told;
        told = waiter->next;
        waiter->done(waiter->context, waiter->room, problem);
        free(waiter);
    }
}

struct asleep_room *asleep_of_answer(const struct net *net, const struct store_answer *answer)
{
    for (size_t i = 0; i < net->n_asleep; i++)
        if (net->asleep[i].ticket && net->asleep[i].ticket == answer->ticket)
            return &net->asleep[i];
    return NULL;
}

void asleep_finish(struct net *net)
{
    for (size_t i = 0; i < net->n_asleep; i++)
        store_summary_finish(&net->asleep[i].facts);
    free(net->asleep);
    net->asleep = NULL;
    net->n_asleep = 0;
}

bool net_rooms_are_known(const struct net *net, struct problem *problem)
{
    if (!net->store || net->store_was_open)
        return true;
    problem_set(problem, PROBLEM_BUSY, "", "", "the rooms on the server's disk cannot be read yet");
    problem->retry_after_ms = 1000;
    return false;
}

/* GET /rooms/{room}/events: what changes in a room, as server-sent events without an end. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_handlers.h"
#include "server/http/feed.h"

enum {
    MAX_LISTENERS = 64,
    MAX_OF_PERSON = 16,        /* where people sign in: a quarter of the server's */
    MAX_OF_PERSON_IN_ROOM = 4, /* and of a room's */
};

struct api_listener { /* a program that listens to a room */
    struct api_listener *next;
    struct api *api;
    struct feed *feed;
    struct room *room;
    struct room_listener *listener;
    struct identity who;
    char *member;            /* as it named itself with the call; NULL: nobody */
    bool has_begun, is_over; /* it was told something; it is told nothing any more */
};

/* Tells it nothing any more; its reader comes to an end when it has taken what was told. */
static void end_telling(struct api_listener *listener)
{
    listener->is_over = true;
    feed_close_texts(listener->feed);
}

/* id "": an event that nothing goes on from. */
static void put(struct api_listener *listener, const char *name, const char *id, const char *data)
{
    static const char form[] = "%sevent: %s\n%s%s%sdata: %s\n\n", begin[] = "retry: 2000\n";
    const size_t size = sizeof form + sizeof begin + strlen(name) + strlen(id) + strlen(data) + 8;
    char *text = malloc(size);
    if (text)
        (void)snprintf(text, size, form, listener->has_begun ? "" : begin, name, id[0] ? "id: " : "", id,
                       id[0] ? "\n" : "", data);
    listener->has_begun = true;
    if (!text || !feed_put_text(listener->feed, text))
        end_telling(listener);
    free(text);
}

static void fill_id(char id[48], const char *epoch, uint64_t number)
{
    (void)snprintf(id, 48, "%s-%llu", epoch, (unsigned long long)number);
}

/* Takes the listener out of the list; its room has forgotten it. */
static void end(struct api_listener *listener)
{
    struct api_listener **at = &listener->api->listeners;
    while (*at != listener)
        at = &(*at)->next;
    *at = listener->next;
    feed_end(listener->feed);
    free(listener->member);
    free(listener);
}

/* False: its sign-in has ended, or it has no right to the room any more; it was told so. */
static bool may_listen(struct api_listener *listener)
{
    struct problem problem;
    if (net_identity_holds(listener->api->net, &listener->who) &&
        room_may(listener->room, &listener->who, listener->member, WIRE_RIGHT_LOOK, false, &problem))
        return true;
    put(listener, "bye", "", "{\"reason\":\"this room may not be looked at any more\"}");
    end_telling(listener);
    return false;
}

static void told(void *context, const char *epoch, uint64_t number, const char *name, const char *text)
{
    struct api_listener *listener = context;
    char id[48];
    if (listener->is_over)
        return;
    if (!may_listen(listener))
        return;
    fill_id(id, epoch, number);
    put(listener, name, id, text);
}

static void tell_state(void *context, const char *epoch, uint64_t number, const cJSON *state)
{
    struct api_listener *listener = context;
    char id[48], *text = json_print(state);
    fill_id(id, epoch, number);
    if (text)
        put(listener, "reset", id, text);
    else
        end_telling(listener);
    free(text);
}

static void room_ended(void *context, const char *reason)
{
    struct api_listener *listener = context;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "reason", reason);
    char *text = json_print(json);
    if (text && !listener->is_over)
        put(listener, "bye", "", text);
    cJSON_Delete(json);
    free(text);
    end(listener);
}

/* EPOCH-NUMBER, of the header Last-Event-ID; else an epoch that no room has. */
static uint64_t read_id(const char *id, char epoch[17])
{
    unsigned long long number = 0;
    int n = 0;
    if (!id || sscanf(id, "%16[0-9a-f]-%19llu%n", epoch, &number, &n) != 2 || id[n]) {
        epoch[0] = 0;
        number = 0;
    }
    return number;
}

bool api_listener_left(struct api *api, const struct feed *feed)
{
    struct api_listener *listener = api->listeners;
    while (listener && listener->feed != feed)
        listener = listener->next;
    if (!listener)
        return false;
    room_listener_remove(listener->listener);
    end(listener);
    return true;
}

/* Ends those that are told nothing any more: their readers have the reason. */
static void end_those_over(struct api *api)
{
    for (struct api_listener *listener = api->listeners, *next; listener; listener = next) {
        next = listener->next;
        if (!listener->is_over)
            continue;
        room_listener_remove(listener->listener);
        end(listener);
    }
}

void api_listeners_look(struct api *api)
{
    for (struct api_listener *listener = api->listeners; listener; listener = listener->next)
        if (!listener->is_over)
            (void)may_listen(listener);
    end_those_over(api);
}

/* Whether the listener is of the same person as the call, or of the same seat. */
static bool is_of_caller(const struct api_listener *listener, const struct call *call)
{
    if (call->identity.user[0])
        return strcmp(listener->who.user, call->identity.user) == 0;
    return call->member && listener->member && strcmp(listener->member, call->member) == 0;
}

static bool has_place(const struct api *api, const struct call *call, const struct room *room, struct problem *problem)
{
    size_t n = 0, n_of_caller = 0, n_in_room = 0;
    for (const struct api_listener *listener = api->listeners; listener; listener = listener->next) {
        const bool is_capped = call->identity.source != IDENTITY_MACHINE && is_of_caller(listener, call);
        n++;
        n_of_caller += is_capped;
        n_in_room += is_capped && listener->room == room;
    }
    bool is_free = true;
    if (n >= MAX_LISTENERS)
        is_free = problem_set(problem, PROBLEM_LIMIT, "", "", "%zu programs listen to rooms of this server already", n);
    else if (n_in_room >= MAX_OF_PERSON_IN_ROOM)
        is_free =
            problem_set(problem, PROBLEM_LIMIT, "", "", "%zu programs of yours listen to this room already", n_in_room);
    else if (n_of_caller >= MAX_OF_PERSON)
        is_free = problem_set(problem, PROBLEM_LIMIT, "", "",
                              "%zu programs of yours listen to rooms of this server already", n_of_caller);
    problem->retry_after_ms = is_free ? 0 : ROOM_DISPLAY_RETRY_MS;
    return is_free;
}

void api_room_events(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct room *room = net_room_find(api->net, call->ids[0]);
    char epoch[17];
    end_those_over(api);
    if (!room && net_room_is_asleep(api->net, call->ids[0])) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the room sleeps: its events begin when somebody enters");
        problem.retry_after_ms = ROOM_DISPLAY_RETRY_MS;
    } else if (!room) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", call->ids[0]);
    }
    if (!room || !has_place(api, call, room, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_listener *listener = mem_new(sizeof *listener);
    *listener = (struct api_listener){ .next = api->listeners,
                                       .api = api,
                                       .room = room,
                                       .who = call->identity,
                                       .feed = feed_create_of_texts(call->wake, call->wake_context),
                                       .member = call->member ? mem_copy_text(call->member) : NULL };
    struct feed *feed = listener->feed;
    api->listeners = listener;
    const struct room_listener_callbacks callbacks = { told, tell_state, room_ended, listener };
    const uint64_t number = read_id(call->last_event, epoch);
    listener->listener = room_listener_add(room, epoch, number, &callbacks, clock_now_us(), &problem);
    if (!listener->listener) {
        end(listener);
        feed_leave(feed);
        call_answer_problem(call, &problem);
        return;
    }
    call_answer_feed(call, "text/event-stream", feed);
}

/* Shows a room's view to displays, as a stream of pictures without an end. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_handlers.h"
#include "server/http/feed.h"

enum { MAX_OF_PERSON = 4 }; /* displays that look at a room, where people sign in: half of what it takes */

struct api_display { /* a screen that looks at a room */
    struct api_display *next;
    struct api *api;
    struct feed *feed;
    struct room *room;
    struct room_display *display;
    struct identity who;
    char *member; /* as it named itself with the call; NULL: nobody */
    char plan_id[64];
    bool holds_plan;
};

/* False: its sign-in has ended, or it has no right to the room any more. */
static bool may_look(const struct api_display *display)
{
    struct problem problem;
    return display->who.source == IDENTITY_MACHINE ||
           (net_identity_holds(display->api->net, &display->who) &&
            room_may(display->room, &display->who, display->member, WIRE_RIGHT_LOOK, false, &problem));
}

static void put_picture(void *context, struct frame *picture, const char *kind)
{
    const struct api_display *display = context;
    if (may_look(display)) /* else api_streams_look ends it soon */
        feed_put(display->feed, picture, kind);
}

static bool has_room(void *context)
{
    const struct api_display *display = context;
    return feed_has_room(display->feed);
}

static void tell_late(void *context, bool is_late)
{
    const struct api_display *display = context;
    feed_late(display->feed, is_late);
}

/* The room has removed its display, or has ended. */
static void end_display(void *context)
{
    struct api_display *display = context, **at = &display->api->displays;
    while (*at != display)
        at = &(*at)->next;
    *at = display->next;
    if (display->holds_plan)
        fleet_release(net_fleet(display->api->net), display->plan_id);
    feed_end(display->feed);
    free(display->member);
    free(display);
}

void api_streams_look(void *context)
{
    struct api *api = context;
    for (struct api_display *display = api->displays, *next; display; display = next) {
        next = display->next;
        if (may_look(display))
            continue;
        room_display_remove(display->display);
        end_display(display);
    }
    api_listeners_look(api);
}

void api_display_left(struct api *api, struct feed *feed)
{
    struct api_display *display = api_listener_left(api, feed) ? NULL : api->displays;
    while (display && display->feed != feed)
        display = display->next;
    if (display) {
        room_display_remove(display->display);
        end_display(display);
    }
    feed_leave(feed);
}

/* Whether the display is of the same person as the call, or of the same seat. */
static bool is_of_caller(const struct api_display *display, const struct call *call)
{
    if (call->identity.user[0])
        return strcmp(display->who.user, call->identity.user) == 0;
    return call->member && display->member && strcmp(display->member, call->member) == 0;
}

static bool has_place_for(const struct api *api, const struct call *call, const struct room *room,
                          struct problem *problem)
{
    size_t n = 0;
    for (const struct api_display *display = api->displays; display; display = display->next)
        n += display->room == room && is_of_caller(display, call);
    if (call->identity.source == IDENTITY_MACHINE || n < MAX_OF_PERSON)
        return true;
    problem_set(problem, PROBLEM_LIMIT, "", "", "%zu displays of yours look at this room already", n);
    problem->retry_after_ms = ROOM_DISPLAY_RETRY_MS;
    return false;
}

void api_room_stream(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct room *room = net_room_find(api->net, call->ids[0]);
    if (!room && net_room_is_asleep(api->net, call->ids[0])) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the room sleeps: it is shown when somebody enters");
        problem.retry_after_ms = ROOM_DISPLAY_RETRY_MS;
    } else if (!room) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", call->ids[0]);
    }
    if (!room || !has_place_for(api, call, room, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_display *display = mem_new(sizeof *display);
    *display = (struct api_display){ .next = api->displays,
                                     .api = api,
                                     .room = room,
                                     .who = call->identity,
                                     .member = call->member ? mem_copy_text(call->member) : NULL,
                                     .feed = feed_create(call->wake, call->wake_context) };
    (void)snprintf(display->plan_id, sizeof display->plan_id, "%s", room_plan_id(room));
    api->displays = display;
    const struct room_display_callbacks callbacks = { put_picture, has_room, tell_late, end_display, display };
    display->display = room_display_add(room, call_query(call, "view"), &callbacks, clock_now_us(), &problem);
    if (!display->display) {
        struct feed *feed = display->feed;
        end_display(display);
        feed_leave(feed);
        call_answer_problem(call, &problem);
        return;
    }
    display->holds_plan = fleet_hold(net_fleet(api->net), display->plan_id);
    call_add_header(call, "Beamroom-View", room_display_kind(display->display));
    call_answer_feed(call, feed_media_type, display->feed);
}

/* Listeners come and leave; the state of a room that they begin with. */
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/entry.h"
#include "server/room/items/item_list.h"
#include "server/room/log/recording.h"
#include "server/room/out/listeners.h"
#include "server/room/people/control.h"
#include "server/wire/json.h"

static cJSON *make_state(const struct room *room)
{
    cJSON *state = cJSON_CreateObject();
    json_add(state, "room", room_document(room));
    json_add(state, "scene", room->shared.scene ? cJSON_Duplicate(room->shared.scene, true) : cJSON_CreateNull());
    json_add(state, "control", control_document(room));
    json_add(state, "items", items_rows(room));
    json_add(state, "recordings", recordings_list(room));
    return state;
}

struct room_listener *room_listener_add(struct room *room, const char *epoch, uint64_t number,
                                        const struct room_listener_callbacks *callbacks, int64_t now_us,
                                        struct problem *problem)
{
    struct listeners *listeners = listeners_begin(room);
    if (listeners->n >= ROOM_MAX_LISTENERS) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "%d programs listen to this room already, at most %d may",
                    listeners->n, ROOM_MAX_LISTENERS);
        problem->retry_after_ms = ROOM_DISPLAY_RETRY_MS;
        return NULL;
    }
    room_enter(room, now_us);
    room_leave(room); /* what is due is told before */
    struct room_listener *listener = mem_new(sizeof *listener);
    *listener = (struct room_listener){ .next = listeners->first, .room = room, .callbacks = *callbacks };
    listeners->first = listener;
    listeners->n++;
    if (!listeners_tell_since(listener, epoch, number)) {
        cJSON *state = make_state(room);
        callbacks->state(callbacks->context, listeners->epoch, listeners->number, state);
        cJSON_Delete(state);
    }
    return listener;
}

void room_listener_remove(struct room_listener *listener)
{
    struct listeners *listeners = listener->room->listeners;
    struct room_listener **at = &listeners->first;
    while (*at != listener)
        at = &(*at)->next;
    *at = listener->next;
    listeners->n--;
    free(listener);
}

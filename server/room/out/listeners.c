/* Passes messages to listeners, and keeps the newest. */
#include "server/room/out/listeners.h"

#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/random.h"

struct listeners *listeners_begin(struct room *room)
{
    if (room->listeners)
        return room->listeners;
    room->listeners = mem_new(sizeof *room->listeners);
    room->listeners->oldest = 1;
    random_hex(room->listeners->epoch, 8);
    return room->listeners;
}

bool listeners_are_told(const struct room *room, enum message_type type)
{
    switch (type) {
    case MESSAGE_PLAN:
    case MESSAGE_RENDERER:
    case MESSAGE_SCENE:
    case MESSAGE_MEMBERS:
    case MESSAGE_ITEM:
    case MESSAGE_ACCEPTANCES:
    case MESSAGE_CONTROL:
    case MESSAGE_FILES:
    case MESSAGE_RECORDING: return room->listeners != NULL;
    default: return false;
    }
}

static void drop_oldest(struct listeners *listeners)
{
    char **kept = &listeners->kept[listeners->oldest % LISTENERS_KEPT].text;
    listeners->n_bytes -= strlen(*kept);
    free(*kept);
    *kept = NULL;
    listeners->oldest++;
}

static void drop_all(struct listeners *listeners)
{
    while (listeners->oldest <= listeners->number)
        drop_oldest(listeners);
}

static void keep(struct listeners *listeners, const char *name, const char *text)
{
    const size_t n = text ? strlen(text) : 0;
    char *copy = text && n <= LISTENERS_KEPT_BYTES ? strdup(text) : NULL;
    if (!copy)
        drop_all(listeners);
    while (
        copy && listeners->oldest <= listeners->number &&
        (listeners->number - listeners->oldest + 1 >= LISTENERS_KEPT || listeners->n_bytes + n > LISTENERS_KEPT_BYTES))
        drop_oldest(listeners);
    listeners->number++;
    if (!copy) {
        listeners->oldest = listeners->number + 1;
        return;
    }
    listeners->kept[listeners->number % LISTENERS_KEPT].name = name;
    listeners->kept[listeners->number % LISTENERS_KEPT].text = copy;
    listeners->n_bytes += n;
}

void listeners_tell(struct room *room, enum message_type type, const char *text)
{
    struct listeners *listeners = room->listeners;
    if (!listeners_are_told(room, type))
        return;
    const char *name = message_descriptions[type].name;
    keep(listeners, name, text);
    if (!text)
        return;
    for (struct room_listener *listener = listeners->first, *next; listener; listener = next) {
        next = listener->next; /* it may leave when it is told */
        listener->callbacks.told(listener->callbacks.context, listeners->epoch, listeners->number, name, text);
    }
}

bool listeners_tell_since(const struct room_listener *listener, const char *epoch, uint64_t number)
{
    const struct listeners *listeners = listener->room->listeners;
    if (strcmp(epoch, listeners->epoch) != 0 || number > listeners->number || number + 1 < listeners->oldest)
        return false;
    for (uint64_t k = number + 1; k <= listeners->number; k++)
        listener->callbacks.told(listener->callbacks.context, listeners->epoch, k,
                                 listeners->kept[k % LISTENERS_KEPT].name, listeners->kept[k % LISTENERS_KEPT].text);
    return true;
}

void listeners_end(struct room *room, const char *reason)
{
    struct listeners *listeners = room->listeners;
    if (!listeners)
        return;
    while (listeners->first) {
        struct room_listener *listener = listeners->first;
        listeners->first = listener->next;
        listener->callbacks.ended(listener->callbacks.context, reason);
        free(listener);
    }
    drop_all(listeners);
    free(listeners);
    room->listeners = NULL;
}

/* Keeps the packets about rooms that one renderer still has to be sent. */
#include "server/fleet/room_updates.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/fleet/watch.h"

struct room_update {
    struct room_update *next;
    uint64_t process;
    char room[64];
    uint8_t *bytes;
    size_t n_bytes;
};

static void remove_first(struct room_update **updates)
{
    struct room_update *first = *updates;
    *updates = first->next;
    free(first->bytes);
    free(first);
}

void room_updates_clear(struct room_update **updates)
{
    while (*updates)
        remove_first(updates);
}

void room_updates_put(struct room_update **updates, uint64_t process, const char *room, uint8_t *bytes, size_t n_bytes)
{
    struct room_update **at = updates;
    while (*at && strcmp((*at)->room, room) != 0)
        at = &(*at)->next;
    if (!*at)
        *at = mem_new(sizeof **at);
    struct room_update *update = *at;
    free(update->bytes);
    (void)snprintf(update->room, sizeof update->room, "%s", room);
    update->process = process;
    update->bytes = bytes;
    update->n_bytes = n_bytes;
}

bool room_updates_send(struct room_update **updates, struct watch *watch, uint64_t process)
{
    while (*updates) {
        const struct room_update *first = *updates;
        if (first->process == process && process) {
            uint8_t *copy = malloc(first->n_bytes); /* watch_send takes its bytes also when it fails */
            if (!copy)
                return false;
            memcpy(copy, first->bytes, first->n_bytes);
            if (!watch_send(watch, process, copy, first->n_bytes))
                return false;
        }
        remove_first(updates);
    }
    return true;
}

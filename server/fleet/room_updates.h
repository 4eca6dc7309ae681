#pragma once
/* Packets about rooms (a scene, or that a room is gone) that a renderer still has to be sent, because the queue of
 * orders to the watch was full: the newest per room, in the order the rooms were first put. A request is sent only when
 * none is left, so that no picture overtakes the scene it shows. Knows no plans. Net thread. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

struct watch;
struct room_update; /* a list; NULL: empty */

/* Queues a written packet for this process and replaces an earlier one about the same room. Takes bytes. */
void room_updates_put(struct room_update **updates, uint64_t process, const char *room, uint8_t *bytes, size_t n_bytes);
/* Sends the queued packets to the process. Drops packets queued for an earlier process: a new process is sent every
 * room's scene anew. Returns true when none is left. */
bool room_updates_send(struct room_update **updates, struct watch *watch, uint64_t process);
void room_updates_clear(struct room_update **updates);

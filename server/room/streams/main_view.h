#pragma once
/* The main view of a room: the shared view that its presenter works in, shown by displays and small pictures. Internal
 * to server/room. */
#include "server/room/state/room_state.h"

/* The member patched the view. A patch of size_px alone, or an empty one, is no act. */
void main_view_patched(struct member *member, int number, const cJSON *patch);
/* The member patched the scene in this view. */
void main_view_scene_patched(struct member *member, int number, const cJSON *patch);
/* The member reports that they work in the view. From then on patches change nothing of that. */
void main_view_active(struct member *member, int number);
/* Chooses room->streams.main: the presenter's view in which they acted last, as long as it is open, else the first open
 * one. While the presenter is away, or there is none, it stays what it was. Returns INT64_MAX. */
int64_t main_view_settle(struct room *room);

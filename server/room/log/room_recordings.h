#pragma once
/* Recordings of meetings in a room, and rooms that play one. Included by room.h. */
#include "server/room/log/recorded_walk.h"
#include "server/room/state/room_types.h"

const struct room_recording *room_recording(const struct room *room, const char *id); /* NULL: there is none */
/* Gives a room the facts of a recording that was kept; one that ran was cut. Takes recording->marks. Left out beyond
 * ROOM_MAX_RECORDINGS. */
void room_restore_recording(struct room *room, struct room_recording *recording);
void room_recording_finish(struct room_recording *recording); /* frees what it owns */
/* The recording on disk was lost: the one that runs goes on with a complete state. */
void room_recording_restart(struct room *room);
/* State of a recorded room at t_ms: {t_ms, revision, scene, views: [{document, by}], pointers: [{member, view,
 * point_mm}], items, members, presenter}. texts: the batches from the last one that begins with a state at or before
 * t_ms on. NULL with problem. */
NODISCARD cJSON *room_recorded_state(const char *const *texts, size_t n, int64_t t_ms, struct problem *problem);

/* Whether the plan is another one than when this was recorded, or its files are, as far as that is known. */
bool room_plan_differs(const struct room *room, const struct room_recording *recording);
bool room_replays(const struct room *room);

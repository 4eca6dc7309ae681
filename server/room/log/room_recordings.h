#pragma once
/* Recordings of meetings in a room, and rooms that play one. Included by room.h. */
#include "server/room/state/room_types.h"

/* [{id, state, started_ms, length_ms, by, by_name, n_events, n_bytes, marks}], the oldest first; NULL: no memory. */
NODISCARD cJSON *room_recordings(struct room *room, int64_t now_us);
const struct room_recording *room_recording(const struct room *room, const char *id); /* NULL: there is none */
/* Ends it first where it runs. False: there is none. */
NODISCARD bool room_recording_delete(struct room *room, const char *id, int64_t now_us);
/* Gives a room the facts of a recording that was kept; one that ran was cut. Takes recording->marks. Left out beyond
 * ROOM_MAX_RECORDINGS. */
void room_restore_recording(struct room *room, struct room_recording *recording);
void room_recording_finish(struct room_recording *recording); /* frees what it owns */
/* Ends the recording that runs: the server stops, or the room falls asleep. */
void room_recording_cut(struct room *room, int64_t now_us);
/* The recording on disk was lost: the one that runs goes on with a complete state. */
void room_recording_restart(struct room *room);
/* State of a recorded room at t_ms: {t_ms, revision, scene, views: [{document, by}], pointers: [{member, view,
 * point_mm}], items, members, presenter}. texts: the batches from the last one that begins with a state at or before
 * t_ms on. NULL with problem. */
NODISCARD cJSON *room_recorded_state(const char *const *texts, size_t n, int64_t t_ms, struct problem *problem);

/* The room plays this recording of another room from its beginning. Before its first member. n_named: of that room;
 * marks and notes of its members are nobody's here, as members of this room have later numbers. */
void room_replay_begin(struct room *room, const char *of_room, uint32_t n_named, const struct room_recording *recording,
                       int64_t now_us);
/* The answer to replay_read: n texts, and the time of the state behind them (INT64_MAX: there is none). n 0: they
 * cannot be read, and problem says why. */
void room_replay_came(struct room *room, const char *const *texts, size_t n, int64_t next_ms,
                      const struct problem *problem, int64_t now_us);
bool room_replays(const struct room *room);

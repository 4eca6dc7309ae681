#pragma once
/* Recordings of meetings, to the store and from it. Internal to server/net; net thread. */
#include "server/net/net_state.h"

struct log_batch;

/* struct room_callbacks; context is the net */
void keep_recorded(void *context, struct room *room, const struct room_recording *recording, struct log_batch *batch);
void keep_recording_deleted(void *context, struct room *room, const char *id);
bool keep_replay_read(void *context, struct room *room, const char *of_room, const char *recording, int64_t t_ms,
                      struct problem *problem);
void keep_recordings_finish(struct net_room *room); /* before it is freed */
void keep_recordings_restore(struct room *room, const struct store_room *row);
/* A part of a recording was read, or cannot be. */
void keep_part_was_read(struct net *net, const struct store_answer *answer);
/* Every reader is told that the server is stopping. */
void keep_readers_finish(struct net *net);

#pragma once
/* Plays the recording of a meeting in a room of its own: the room's clock applies the events of the log as the shared
 * scene, shared views, pointers, notes and members. Nobody presents meanwhile. Reads a part of the log at a time, from
 * one complete state to the next. Internal to server/room; what others use stands in
 * room_recordings.h and room.h. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum {
    REPLAY_EVERY_MS = 50,        /* between two states that are shown; what lies between is shown as one change */
    REPLAY_TELL_MS = 1000,       /* how often members are told the time while it plays */
    REPLAY_RETRY_MS = 2000,      /* after it could not be read from the disk; doubled each time, up to 32 times */
    REPLAY_PAGE_EVENTS = 1 << 20 /* of one part of the log */
};

/* Handlers. */
bool replay_play(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool replay_pause(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool replay_seek(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool replay_leave(struct room *room, struct member *member, const struct message *message, struct problem *problem);
/* Whether this message is allowed in a room as long as it plays. False with problem. */
NODISCARD bool replay_allows(const struct room *room, enum message_type type, struct problem *problem);

void replay_begin(struct room *room, const char *of_room, uint32_t n_named, const struct room_recording *recording);
void replay_came(struct room *room, const char *const *texts, size_t n, int64_t next_ms, const struct problem *problem);
void replay_show(struct room *room, struct member *member); /* tells a member who has just come */
void replay_plan_ready(struct room *room);                  /* the plan was loaded: what is shown is made anew for it */
/* The revision of the plan's files is this one now. */
void replay_revision_came(struct room *room, const char *revision);
/* Shows what is due; returns when something is due again. */
int64_t replay_settle(struct room *room);
void replay_free(struct room *room);

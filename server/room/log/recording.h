#pragma once
/* Records a meeting: notes what of the room has changed, and ten times a second at most writes that to a meeting log;
 * what changes twice in between is written once. Batches of events go to the room's owner every second. Internal to
 * server/room; what others use stands in room_recordings.h and room.h.
 *
 * How much two hours of a busy meeting are: the presenter turns or slides half of the time (36000 changes of 250
 * bytes: 9 MB), five others point a fifth of the time (72000 places of 100 bytes: 7 MB), 1000 changes of the scene,
 * the members and the notes (2 MB at most); states add a third (6 MB): 24 MB. A recording may have 64 MiB. */
#include "server/room/state/room_state.h"
#include "server/wire/message.h"

enum {
    RECORDING_EVERY_MS = 100, /* between two looks at what has changed */
    RECORDING_BATCH_MS = 1000
};

struct recordings {                                  /* of a room, that are kept */
    struct room_recording list[ROOM_MAX_RECORDINGS]; /* the oldest first */
    int n;
    double speed; /* how many times as fast their clock runs; > 0 */
};

void recordings_init(struct room *room, double speed); /* with the room */

/* The handlers of recording.start and recording.stop. */
bool recording_start(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool recording_stop(struct room *room, struct member *member, const struct message *message, struct problem *problem);
cJSON *recordings_list(const struct room *room);               /* room_recordings */
bool recording_delete(struct room *room, const char *id);      /* room_recording_delete */
void recording_cut(struct room *room);                         /* room_recording_cut */
void recording_show(struct room *room, struct member *member); /* tells a member who has just come */
/* Writes what is due; returns when something is due again. */
int64_t recording_settle(struct room *room);
/* Ends the recording that runs, and frees the facts of all: the room is destroyed. */
void recordings_finish(struct room *room);
/* Whether a recording runs that does not know the revision of the plan's files, and the first that is known. */
bool recording_wants_revision(const struct room *room);
void recording_revision_came(struct room *room, const char *revision);
/* Tells the same plan document from another one. False: no memory. */
NODISCARD bool recording_plan_sum(const struct room *room, char digits[20]);

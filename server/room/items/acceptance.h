#pragma once
/* Acceptances of a room: by a person's word two parts of the plan that do not fit are used together, here and for the
 * files that the person saw. They are items of the room and nothing else: no scene, saved view, permalink, new room or
 * replay holds one. What the renderer is told is room_acceptances. Internal to server/room. */
#include "server/room/items/item_list.h"

enum { ACCEPTANCE_MAX_BYTES = 4096 }; /* of a body */

/* Like note_body_read. Also reads fact, plan_revision and role, which the server adds. */
NODISCARD cJSON *acceptance_read(const struct room *room, const cJSON *body, const struct item *before,
                                 bool is_restored, struct problem *problem);
/* Whether this member may make or withdraw an acceptance now; true for other kinds. */
bool acceptance_may(const struct room *room, const struct member *member, enum wire_item_kind kind,
                    struct problem *problem);
/* Like acceptance_may, for an item that is to be made anew (before NULL) or changed; an acceptance is never changed. */
bool acceptance_may_write(const struct room *room, const struct member *member, enum wire_item_kind kind,
                          const struct item *before, struct problem *problem);
/* Making and withdrawing are recorded in the audit; nothing for other kinds. */
void acceptance_audit(struct room *room, const struct item *item, const struct member *by, bool is_withdrawn);
/* Finds out anew which acceptances count. Where that is another answer than before, it is a new revision of the scene,
 * all pictures are drawn anew, and members are told. */
void acceptances_settle(struct room *room);
/* Whether this acceptance counts for the files that are loaded. */
bool acceptance_counts(const struct room *room, const struct item *item);
/* Whether the revision of the files that the renderer has loaded is needed and not known. */
bool acceptances_want_revision(const struct room *room);
/* It is this; "": another process loads the files, so it is not known. */
void acceptances_revision(struct room *room, const char *revision);
void acceptances_init(struct room *room); /* with the room */
void acceptances_free(struct room *room);
/* Tells a member, who has just come, which count. */
void acceptances_tell(struct room *room, struct member *member);

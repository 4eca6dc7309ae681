#pragma once
/* Acts of members that are recorded in the audit (room_callbacks.audited). Acts that are equal in everything but their
 * time, as when a program repeats what it was refused, are gathered into one row, as are the steps of one gesture,
 * which change the same fields. Internal to server/room. */
#include "server/room/state/room_state.h"

struct audit_act {
    const struct member *by;    /* NULL: nobody of the room */
    const char *action;         /* a word of room.h's list */
    const char *key;            /* of a gesture: the fields that it changes; NULL: of another act */
    const char *address;        /* NULL: that of the member */
    const struct identity *who; /* NULL: that of the call or of the member */
    cJSON *detail;              /* taken; NULL: {} */
    bool is_refused;
    int64_t before, after; /* revisions of the scene; -1: does not apply */
};

struct gathered { /* acts for the audit that are one row */
    char action[24], key[64], member[64], name[161], address[46], user[IDENTITY_MAX_USER + 1], session[17];
    enum identity_source source;
    enum wire_member_role role;
    bool is_refused;
    cJSON *detail; /* of the last */
    int64_t before, after;
    int64_t first_us, last_us;
    int64_t since_ms, newest_ms; /* since 1970: of the first act that no row was made for yet, and of the last */
    unsigned n;                  /* acts that no row was made for yet */
};

/* A row that is committed together with an item, instead of by the callback audited. */
struct audit_apart {
    struct gathered act;
    char *detail;          /* owned */
    struct room_audit row; /* borrows from the two */
};
/* Until this is called with NULL, the newest row goes there. */
void audit_set_apart(struct room *room, struct audit_apart *apart);
void audit_apart_finish(struct audit_apart *apart);

/* Records it at once, and gathers the repetitions that follow: the same member, name, role, address, action, detail and
 * result. */
void audit_tell(struct room *room, const struct audit_act *act);
/* Records a step of a gesture when that is over: nothing of the same member, action and key came for
 * ROOM_AUDIT_QUIET_MS, or it has lasted for ROOM_AUDIT_AT_MOST_MS. before is that of the first step, after and detail
 * those of the last. */
void audit_gather(struct room *room, const struct audit_act *act);
/* Records what is gathered of this member; NULL: of everybody. */
void audit_flush(struct room *room, const struct member *by);
/* Records what is over; when the next is due, INT64_MAX: nothing is gathered. */
int64_t audit_settle(struct room *room);
void audit_init(struct room *room); /* with the room */
void audit_free(struct room *room);
/* False with problem storage: what is recorded cannot be stored now, so it is refused. */
bool audit_has_place(const struct room *room, struct problem *problem);

/* Audits a change of the scene, from before to the room's: weights of doses, the beam's draft. by NULL: a call of
 * nobody in the room. */
void audit_scene(struct room *room, const cJSON *before, const struct member *by);
/* Whether there is anything. */
bool audit_is_of_scene(const cJSON *before, const cJSON *after);

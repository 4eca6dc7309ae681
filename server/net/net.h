#pragma once
/* The net thread: the loop of connections, rooms, the fleet. Everything about rooms and renderers happens on it; other
 * threads hand it tasks. Joins room, fleet, store and ws. */
#include <stdint.h>

#include "server/fleet/fleet.h"
#include "server/room/room.h"
#include "server/store/store_rows.h"
#include "server/wire/handshake.h"

struct access;
struct auth;
struct plan_rights;
struct net;

struct net_audit_head { /* the newest row of the audit on disk */
    int64_t n;          /* 0: there is none */
    char hash[65];      /* 64 zeros: there is none; "": nothing is kept */
    size_t n_waiting;   /* rows that are not on disk yet */
};

enum {
    NET_MAX_AUDIT = 8192 /* rows of the audit that may wait for the disk; then what would need another is refused. What
                            happens all the same (members leave) may make them twice as many; further ones are counted
                            and the count recorded */
};

struct net_options {
    struct fleet_options fleet; /* wake, changed and context are the net's own */
    int max_rooms;              /* 0: 200 */
    int room_idle_close_s;      /* a room with nobody connected is put to sleep after this, or deleted if nobody ever
                                   used it or rooms are not kept; 0: never */
    struct room_limits room;
    const struct access *access; /* grants; outlives the net. NULL: nobody signs in */
    bool is_alone;               /* nobody signs in, and only this machine is answered */
    /* Whether the identity of a connection still holds; proved_ms is brought up to date. NULL: it does. */
    bool (*is_still)(void *context, struct identity *who);
    void *rights; /* context of it; net thread */
    /* a further Origin that may open a WebSocket, beside the request's own Host; NULL: none */
    const char *allowed_origin;
    /* the file in which rooms are kept over a restart; NULL: none are */
    const char *database;
    struct auth *auth; /* accounts are kept in that file, too; outlives the net. NULL: nobody signs in */
};

/* Starts the thread. errors ERROR_IO, ERROR_MEMORY and those of fleet_create and store_create */
NODISCARD struct net *net_create(const struct net_options *options, struct error *err);
void net_destroy(struct net *net); /* says bye to every connection, stops renderers, joins */

/* Runs task(net, argument) on the net thread soon; any thread. Every task posted before net_destroy runs (at destroy:
 * with net_is_stopping true). */
void net_post(struct net *net, void (*task)(struct net *net, void *argument), void *argument);
bool net_is_stopping(const struct net *net);
/* True once the plan folders have been listed for the first time. Any thread. */
bool net_plans_are_listed(const struct net *net);

/* Takes over a socket that starts with this WebSocket handshake; nothing of it has been read yet. Any thread. Calls
 * ended(context) once when the connection is gone, also when it never became a WebSocket; on the net thread, at the
 * latest in net_destroy. */
void net_adopt(struct net *net, int socket, const struct handshake *handshake, void (*ended)(void *context),
               void *context);

/* On the net thread only: */
/* The session or token of this name is over: its connections get bye, and members keep their seats. */
void net_session_over(struct net *net, const char *session);
/* A user was disabled, a password set, a token revoked: connections that this concerns end soon. */
void net_accounts_changed(struct net *net);
void net_grants_changed(struct net *net); /* as room_grants_changed, in each room that is awake */
struct fleet *net_fleet(struct net *net);
/* How rights on plans are found out (plan_rights.h). */
const struct plan_rights *net_plan_rights(const struct net *net);
/* Creates a room and opens its plan. bookmark: of this plan, what the room begins with (room_begin_with); NULL: with
 * the plan's own scene. NULL with problem. */
struct room *net_room_create(struct net *net, const char *plan_id, const cJSON *bookmark, struct problem *problem);
/* Nobody takes more than a quarter of the rooms there may be. user "": not looked at. False with problem. */
bool net_may_own_more(const struct net *net, const char *user, struct problem *problem);
struct room *net_room_find(struct net *net, const char *room_id);
/* For good, also of one that sleeps; records of decisions stay. reason: as in room_end_because. */
void net_room_delete(struct net *net, const char *room_id, const char *reason);
/* Each is a row of the audit; address as in net_audit. */
void net_rooms_delete_of_plan(struct net *net, const char *plan_id, const char *address, const char *reason);
/* Decisions and signatures in this room, awake or not; in all rooms of this plan. */
size_t net_n_decided(const struct net *net, const char *room_id);
size_t net_n_decided_of_plan(const struct net *net, const char *plan_id);
/* Has the plan folders listed; done is called once, when the list is one that was begun after this call. */
void net_list_plans(struct net *net, void (*done)(void *context), void *context);
/* A room that sleeps is on disk alone: net_room_find does not find it. Whoever needs it wakes it; done is called once,
 * with NULL when it is awake. */
bool net_room_is_asleep(const struct net *net, const char *room_id);
void net_room_wake(struct net *net, const char *room_id,
                   void (*done)(void *context, const char *room_id, const struct problem *problem), void *context);
/* Like net_room_wake, for the room that has the bookmark with this token; not-found when there is none. */
void net_bookmark_wake(struct net *net, const char *token,
                       void (*done)(void *context, const char *room_id, const struct problem *problem), void *context);
/* Reads one segment of a recording: from the last batch that begins with a state at or before t_ms up to the next such
 * batch, at next_ms. done is called once, later; n 0: they cannot be read, and problem says why. False with problem:
 * the disk has too much to do, and done is not called. */
typedef void net_part_read(void *context, const char *const *texts, size_t n, int64_t next_ms,
                           const struct problem *problem);
NODISCARD bool net_recording_read(struct net *net, const char *room, const char *recording, int64_t t_ms,
                                  net_part_read *done, void *context, struct problem *problem);
/* Reads records of decisions and signatures, without item and body, the newest first: those before this one ("": all);
 * id not "": this one, with both. done is called once, later; n 0 with problem: they cannot be read, or there is none.
 * False with problem: the disk has too much to do, or nothing is kept. */
struct net_record {
    const char *id, *room, *plan, *kind, *author, *author_name, *item, *body, *hash;
    const char *facts; /* of a list, as in struct store_record */
    int64_t time_ms;
    const struct store_figure *figures; /* [STORE_FIGURES], of one record alone */
    const char *signatures, *decisions; /* as in struct store_record */
};
typedef void net_records_read(void *context, const struct net_record *records, size_t n, const struct problem *problem);
NODISCARD bool net_read_records(struct net *net, const char *id, const char *before, net_records_read *done,
                                void *context, struct problem *problem);
/* Reads rows of the audit, the newest first. done is called once, later; n 0 with problem: they cannot be read. next_n:
 * rows with lower numbers were not looked at, 0: there are none. False with problem: the disk has too much to do, or
 * nothing is kept. */
typedef void net_audit_read(void *context, const struct store_audit_row *rows, size_t n, int64_t next_n,
                            const struct problem *problem);
NODISCARD bool net_read_audit(struct net *net, const struct store_audit_query *query, net_audit_read *done,
                              void *context, struct problem *problem);
/* False with problem: the disk cannot be written now, so nothing is accepted that must last. */
NODISCARD bool net_can_write(struct net *net, struct problem *problem);
/* A new room on the plan of that room, which plays this recording of it. NULL with problem. */
struct room *net_replay_create(struct net *net, const struct room *of_room, const char *recording,
                               struct problem *problem);
bool net_admits_guests(const struct net *net); /* links may let in who has not signed in */
size_t net_n_asleep(const struct net *net);
/* Whether this user may find the sleeping room of this id there. */
bool net_asleep_is_seen_by(const struct net *net, const char *room_id, const struct identity *who);
/* Like room_is_listed_to, for a sleeping room; true of each for the machine's person. */
bool net_asleep_is_listed_to(const struct net *net, size_t index, const struct identity *who);
/* False with problem busy: the database could not be opened since the start, so a room that is not found may be there.
 */
NODISCARD bool net_rooms_are_known(const struct net *net, struct problem *problem);
/* False: too many rows of the audit wait for the disk. */
bool net_audit_has_place(const struct net *net);
/* The key that rows have in the stead of a plan's id, which may be made of a patient's name: "plan-" and 16 digits of
 * its SHA-256. A row outlives what is erased. */
enum { NET_AUDIT_PLAN_KEY = 24 };
void net_audit_plan_key(const char *plan, char key[NET_AUDIT_PLAN_KEY]);
/* Records what happened in no room that is in memory. address: the client's, "" not known; room, plan: "" none; detail
 * is taken. */
void net_audit(struct net *net, const char *address, const char *room, const char *plan, const char *action,
               cJSON *detail);
/* Like net_audit, by who. */
void net_audit_by(struct net *net, const struct identity *who, const char *address, const char *room, const char *plan,
                  const char *action, cJSON *detail);
/* Like net_audit_by, for what was refused. */
void net_audit_refused(struct net *net, const struct identity *who, const char *address, const char *room,
                       const char *plan, const char *action, cJSON *detail);
/* Erases what is kept of a plan: rooms, recordings, cache and, where it lies in a folder of ours, the plan itself; the
 * words of its records are struck out. Of a plan that is listed under both its ids; plan_id is either. done is called
 * once, later, with problem where it could not be finished: then the next start goes on, if it was begun. reason: for
 * the row of the audit. False with problem: nothing is erased. */
typedef void net_erased(void *context, int64_t n_rooms, int64_t n_records, const struct problem *problem);
NODISCARD bool net_erase_plan(struct net *net, const char *plan_id, const struct identity *who, const char *address,
                              const char *reason, net_erased *done, void *context, struct problem *problem);
bool net_is_erasing(const struct net *net, const char *plan_id); /* this plan, by either id */
/* looked is called whenever sign-ins may have ended or rights gone, and every 20 s where people sign in: whoever serves
 * somebody for long asks then whether it still may. It is called from nowhere but the loop or a call. */
void net_on_identities(struct net *net, void (*looked)(void *context), void *context);
/* looked is called at this time as well, once; of several times at the earliest. */
void net_look_at(struct net *net, int64_t time_us);
/* Whether this sign-in has not ended: asked of those who stay. */
bool net_identity_holds(const struct net *net, const struct identity *who);
/* Records what may happen many times a second: the first at once, and equal ones as one row a minute. what: a word. */
void net_audit_often(struct net *net, const struct identity *who, const char *address, const char *room,
                     const char *plan, const char *action, const char *what, bool is_refused);
/* Notes whose call is being handled, for what rooms record of it; NULL: none is. */
void net_set_caller(struct net *net, const struct identity *who);
struct net_audit_head net_audit_head(const struct net *net);
size_t net_n_rooms(const struct net *net);
struct room *net_room_at(const struct net *net, size_t index);
struct net_counters {
    struct room_counters rooms; /* sum over open and closed rooms */
    uint64_t connections, connections_refused;
    size_t n_connections;
};
void net_count(const struct net *net, struct net_counters *counters);

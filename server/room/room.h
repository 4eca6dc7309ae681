#pragma once
/* Rooms: members, their views, the shared scene; who sees what, and when a picture is requested. No sockets, no
 * renderer (callbacks), no clock of its own (now_us is passed in). One thread. */
#include "server/room/items/room_items.h"
#include "server/room/log/room_recordings.h"
#include "server/room/out/room_listeners.h"
#include "server/room/people/room_links.h"
#include "server/room/people/room_moving.h"
#include "server/room/people/room_people.h"
#include "server/room/state/room_types.h"
#include "server/room/streams/room_displays.h"
#include "server/room/views/room_bookmarks.h"

/* id: URL-safe, random, not guessable. The plan and its default scene come with room_plan_ready. */
struct room *room_create(const char *id, const char *plan_id, const struct room_callbacks *callbacks,
                         const struct room_limits *limits);
void room_destroy(struct room *room); /* says bye to every connection first */
/* Sets the reason that bye gives, a sentence without its dot; else "the room is closed". */
void room_end_because(struct room *room, const char *reason);
/* Decisions and signatures in the room. */
size_t room_n_decided(const struct room *room);
/* The name of the member who makes a call, "" for nobody of the room; member: as in room_call_may. */
const char *room_caller_name(const struct room *room, const char *member);
const char *room_id(const struct room *room);
const char *room_plan_id(const struct room *room);
const char *room_name(const struct room *room); /* "": none was given */
/* Gives the room a name of at most ROOM_NAME_LETTERS letters, "": none; members are told. who, member and address: as
 * in room_audit_call. */
void room_rename(struct room *room, const char *name, const struct identity *who, const char *member,
                 const char *address, int64_t now_us);
/* Whether the user of this identity has or had a seat. */
bool room_was_in(const struct room *room, const struct identity *who);
/* Names of up to ROOM_MAX_NAMES of those who are or were in, each ended by '\n'. */
void room_names_in(const struct room *room, char names[ROOM_NAMES_BYTES]);
/* Ids of all users who are or were in, likewise, for free(); NULL: no memory. */
NODISCARD char *room_users_in(const struct room *room);
size_t room_n_notes(const struct room *room);

/* The renderer's state, sent on to all members. Pictures are requested only while it is ready. Each new renderer
 * process is reported by room_plan_ready: all pictures are requested anew, requests to the old process are forgotten.
 * Before the first one is ready the scene cannot be changed; while another one starts it can, checked against the plan
 * as it was. room_plan_ready then removes ids that the plan does not have any more from the scene, and overrides with
 * such ids from their views, whose members are told. False: no memory; members are told that it failed, and it is to be
 * reported again. */
bool room_plan_ready(struct room *room, const cJSON *plan_document, const cJSON *default_scene, const char *gl,
                     bool is_software, int64_t now_us);
void room_renderer_state(struct room *room, enum wire_renderer_state state, const char *phase, double percent,
                         const struct problem *problem, int64_t now_us);

/* Connections: opaque pointers of the caller's. A connection becomes a member with hello. */
/* Returns when room_settle is due because of the text: at once, but for the acknowledgement of a frame, of which there
 * is one for each frame and member. It is to be called once for all texts that have come together. */
int64_t room_text_came(struct room *room, void *connection, const char *text, size_t n, int64_t now_us);
void room_connection_closed(struct room *room, void *connection, int64_t now_us);
/* Like room_connection_closed, for a connection that was last heard of at heard_us: the member counts as away since
 * then. */
void room_connection_lost(struct room *room, void *connection, int64_t heard_us, int64_t now_us);
bool room_has_member(const struct room *room, void *connection); /* it has said hello */
/* True if the member at this connection follows another, who presents and is connected. */
bool room_is_followed(const struct room *room, void *connection);

/* Does what follows from all that came, and what is due with time: stills, dropping members that are away ... Each
 * entry but room_text_came ends with it. Returns when it is due again; INT64_MAX: only after another call. */
int64_t room_settle(struct room *room, int64_t now_us);
/* The time that room_settle found last. */
int64_t room_due_us(const struct room *room);

/* Answers to render. A picture that is no longer wanted (the renderer was restarted, the view closed) is dropped. */
void room_picture_came(struct room *room, uint64_t request, struct frame *picture, int64_t now_us); /* takes picture */
void room_picture_failed(struct room *room, uint64_t request, const struct problem *problem, int64_t now_us);
NODISCARD struct room_display *room_display_add(struct room *room, const char *view,
                                                const struct room_display_callbacks *callbacks, int64_t now_us,
                                                struct problem *problem);
void room_display_remove(struct room_display *display);
/* Tells from now on what changes; first what came after event `number` of this epoch, or, where that is not known, the
 * whole state. epoch "": the state. NULL with problem limit. */
NODISCARD struct room_listener *room_listener_add(struct room *room, const char *epoch, uint64_t number,
                                                  const struct room_listener_callbacks *callbacks, int64_t now_us,
                                                  struct problem *problem);
void room_listener_remove(struct room_listener *listener);

/* Answers item_first. problem NULL: the item is on disk, so it counts and all members are told. Else it will never be
 * written, and who gave it is told why. */
void room_item_written(struct room *room, uint64_t number, const struct problem *problem, int64_t now_us);

/* The shared scene, for HTTP: NULL before the plan is ready. */
const cJSON *room_scene(const struct room *room, uint32_t *revision);
/* The scene with the override of this view document, which need not belong to a view of the room. room_scene must not
 * be NULL. Returns the caller's document, or NULL with problem. */
NODISCARD cJSON *room_scene_for_view(const struct room *room, const cJSON *view, struct problem *problem);
/* caller: as member in room_call_may; address: as in room_audit_call. */
NODISCARD bool room_patch_scene(struct room *room, const cJSON *patch, const char *caller, const char *address,
                                int64_t now_us, struct problem *problem);
/* {id, plan, revision, members: [...], created_at...}: what GET /rooms/{id} gives. */
NODISCARD cJSON *room_document(const struct room *room);
struct room_facts {                          /* of a room in a list */
    const char *id, *plan_id, *name, *names; /* names: as room_names_in */
    uint32_t revision;
    enum wire_renderer_state renderer;
    int64_t created_at_s;
    size_t n_notes;
};
/* Like room_document, for a sleeping room: without members, and with asleep true. */
NODISCARD cJSON *room_document_of(const struct room_facts *facts);
/* The caller over HTTP, as the room sees it. */
struct room_caller {
    bool is_here;   /* it has a role in the room; false: it is answered as if the room were not there */
    bool is_member; /* the one whom Beamroom-Member names */
    bool is_guest;
    enum wire_member_role role;
};
/* member: as in room_call_may. With a seat of another user, or a false secret, is_here is false. */
struct room_caller room_caller_of(const struct room *room, const struct identity *who, const char *member);
/* Nobody gives a role above their own. */
bool room_caller_gives(const struct room_caller *caller, enum wire_member_role role);
/* Whether this caller has the right in the room: not-found where it has no role there, forbidden, not-presenter.
 * is_act: for room_act, whose message finds out by itself whether it takes the presenter. */
NODISCARD bool room_may(const struct room *room, const struct identity *who, const char *member, enum wire_right right,
                        bool is_act, struct problem *problem);
/* {owner, is_open, people: [{who, role}], removed: [{user, name}]} */
NODISCARD cJSON *room_people(const struct room *room);
/* Changes is_open and people. False with problem: nothing of it was applied. */
NODISCARD bool room_people_patch(struct room *room, const cJSON *patch, const struct identity *who, const char *member,
                                 const char *address, int64_t now_us, struct problem *problem);
/* Whether this user made the room, was asked into it or was in it; or may come in without a link. */
bool room_is_listed_to(const struct room *room, const struct identity *who);
/* The sign-in behind this connection is over: the member is away, and keeps its seat. */
void room_sign_in_over(struct room *room, void *connection, int64_t now_us);
/* Looks at the roles of members anew, after grants have changed: a member with another role comes in again, one without
 * is sent away. Members keep their seats. */
void room_grants_changed(struct room *room, int64_t now_us);
/* Whether a call over HTTP has the right in this room. member: "ID SECRET" of the member who makes it; NULL: of nobody
 * in the room, who then has the rights of a presenter in a room without links, else those of a reviewer who does not
 * present. False with problem forbidden or not-presenter. */
NODISCARD bool room_call_may(const struct room *room, const char *member, enum wire_right right,
                             struct problem *problem);
/* Like room_call_may, for room_act: its message finds out by itself whether it takes the presenter. */
NODISCARD bool room_act_may(const struct room *room, const char *member, enum wire_right right,
                            struct problem *problem);
/* Does this in the room, or refuses it as it would a message. An item may be written by who is no member of the room,
 * with the rights that room_call_may gives; anything else takes a member who is connected. */
void room_act(struct room *room, const struct room_act *act, int64_t now_us);
/* {presenter, locked, requests}, as in the message control. */
NODISCARD cJSON *room_control(const struct room *room);
/* The wall of this id names the patient from now on, or does not any more; as long as it is connected and the plan's
 * files are the same. Whoever asks has the right identity on the plan. False with problem not-found. caller, address:
 * as in room_audit_call. */
NODISCARD bool room_wall_name(struct room *room, const char *wall, bool is_named, const struct identity *who,
                              const char *caller, const char *address, int64_t now_us, struct problem *problem);
/* Whether the caller is a wall that names the patient. */
bool room_wall_is_naming(const struct room *room, const char *caller);
/* This member of the room has just read whom the plan is of. */
void room_identity_read(struct room *room, const char *caller, int64_t now_us);
/* [{id, role, expires_s, one_use, used}]: the links that let somebody in; id is room_link_digits of the token. */
NODISCARD cJSON *room_links(struct room *room, int64_t now_us);
/* The link lets nobody in any more; who came in by it stays. by: as member in room_call_may. False: there is no such
 * link. */
NODISCARD bool room_link_revoke(struct room *room, const char *id, const char *by, const char *address, int64_t now_us);
/* Like room_link_revoke; who came in by it is removed. */
NODISCARD bool room_link_revoke_all(struct room *room, const char *id, const char *by, const char *address,
                                    int64_t now_us);
/* Makes a link; token gets 32 digits and a final zero. False with problem limit. */
NODISCARD bool room_link_create(struct room *room, enum wire_member_role role, int64_t expires_s, bool is_one_use,
                                int64_t now_us, char token[33], struct problem *problem);
/* Records what a call over HTTP does in this room; who: NULL, not known; member as in room_call_may; address: the
 * client's, "": not known. detail is taken. */
void room_audit_call(struct room *room, const struct identity *who, const char *member, const char *address,
                     const char *action, cJSON *detail, bool is_refused, int64_t now_us);
/* The revision of the plan's files has become known, or is another one; what is written of the record from then on
 * stands under it. "": it is not known, and nothing of the record is written. */
void room_plan_revision(struct room *room, const char *revision);
/* Records what is still being gathered. */
void room_audit_flush(struct room *room, int64_t now_us);

/* Fills a row with what is kept of the room, of its parts with these; room_kept_finish frees what it holds. Times of
 * use, items, recordings and rows for the audit are its owner's business. False: no memory. */
NODISCARD bool room_keep(const struct room *room, unsigned parts, struct store_room *kept);
void room_kept_finish(struct store_room *kept);
/* Makes a room that was just created what it was when it was kept; its members are away. The scene counts once the plan
 * is ready, as after a restart of the renderer. What is not readable in kept is left out, and said in the log. */
void room_restore(struct room *room, const struct store_room *kept, int64_t now_us);

/* [{id, state, started_ms, length_ms, by, by_name, n_events, n_bytes, marks}], the oldest first; NULL: no memory. */
NODISCARD cJSON *room_recordings(struct room *room, int64_t now_us);
/* Ends it first where it runs. False: there is none. */
NODISCARD bool room_recording_delete(struct room *room, const char *id, int64_t now_us);
/* Ends the recording that runs: the server stops, or the room falls asleep. */
void room_recording_cut(struct room *room, int64_t now_us);
/* The room plays this recording of another room from its beginning. Before its first member. n_named: of that room;
 * marks and notes of its members are nobody's here, as members of this room have later numbers. */
void room_replay_begin(struct room *room, const char *of_room, uint32_t n_named, const struct room_recording *recording,
                       int64_t now_us);
/* The answer to replay_read: n texts, and the time of the state behind them (INT64_MAX: there is none). n 0: they
 * cannot be read, and problem says why. */
void room_replay_came(struct room *room, const char *const *texts, size_t n, int64_t next_ms,
                      const struct problem *problem, int64_t now_us);

/* True once a member has entered, a link was made, or the scene was changed. */
bool room_was_used(const struct room *room);
/* True once a person has changed something that is kept: the scene, an item, a link, the people, the name, a recording.
 * Where somebody looks, cameras and slices, is no change. */
bool room_was_changed(const struct room *room);
/* How many members the room has ever had. */
uint32_t room_n_named(const struct room *room);
/* Whether the room has a use for the revision of the plan's files as they are now: it plays, or records and does not
 * know it yet. */
bool room_wants_revision(const struct room *room);
/* This is the revision now; unlike that of room_plan_revision never one of files that have changed since. */
void room_revision_came(struct room *room, const char *revision, int64_t now_us);

void room_count(const struct room *room, struct room_counters *sum); /* adds to sum */

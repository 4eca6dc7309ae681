#pragma once
/* Rooms: members, their views, the shared scene; who sees what, and when a picture is requested. No sockets, no
 * renderer (callbacks), no clock of its own (now_us is passed in). One thread. */
#include <stdatomic.h>
#include <stdint.h>

#include "core/base/image_reduce.h"
#include "server/wire/document.h"
#include "server/wire/frame_header.h"
#include "wire_gen.h"

enum {
    ROOM_MAX_MEMBERS = 200,
    ROOM_MAX_VIEWS = 8,
    ROOM_WATCH = ROOM_MAX_VIEWS + 1, /* number of the small picture of the presenter in frames and messages */
    ROOM_MAX_UNSHOWN = 2,
    ROOM_STILL_AFTER_MS = 150,
    ROOM_MEMBER_KEPT_S = 300,
    ROOM_PRESENTER_KEPT_S = 30,     /* how long a presenter without a connection still presents */
    ROOM_MAX_ITEMS = 1000,          /* notes, replies and bookmarks together */
    ROOM_MAX_ITEM_BYTES = 61440,    /* of the body of a bookmark, as JSON; a note may have less (note_body.h) */
    ROOM_MAX_ITEM_FRAME = 2048,     /* of a row without its body */
    ROOM_MAX_ITEMS_BYTES = 2 << 20, /* of all rows; they are in every welcome */
    ROOM_MAX_KNOWN = 256, /* members that left and can come back as the same; beyond, the first but presenters cannot */
    ROOM_REQUEST_AGAIN_S = 10, /* after a refusal, before control can be requested again */
    ROOM_MAX_LINKS = 32,       /* valid at once */
    ROOM_LINK_MIN_S = 60,
    ROOM_LINK_MAX_S = 30 * 24 * 3600,
    ROOM_MAX_PRESENCE = 1000,      /* stays of members that are kept; of more, the first are counted only */
    ROOM_SAME_STAY_MS = 60000,     /* who comes back within this goes on with the same stay */
    ROOM_MAX_AUDIT_DETAIL = 1024,  /* bytes of the detail of a row for the audit; of a longer one only the length */
    ROOM_MAX_GATHERED = 32,        /* acts that are being gathered into a row each; the oldest is then recorded */
    ROOM_AUDIT_QUIET_MS = 1000,    /* acts further apart are rows of their own */
    ROOM_AUDIT_AT_MOST_MS = 30000, /* no row gathers acts of a longer time */
    ROOM_MAX_RECORDINGS = 16,      /* of one room, that are kept */
    ROOM_MAX_RECORDING_BYTES = 64 << 20, /* of one; two hours of a busy meeting take 30 MiB: recording.h */
    ROOM_MAX_RECORDING_EVENTS = 500000,
    ROOM_MAX_RECORDING_S = 12 * 3600,
    ROOM_RECORDING_EMPTY_S = 60, /* nobody there for so long ends it */
    ROOM_MAX_MARKS = 500,        /* of one recording */
    ROOM_MAX_DISPLAYS = 8,
    ROOM_DISPLAY_RETRY_MS = 5000
};

struct room;
struct log_batch; /* meeting_log.h */

/* A recording of a meeting in the room: its facts. The events are on disk alone. */
struct room_recording {
    char id[32], by[64], by_name[161]; /* by: the member who began it */
    char plan_mark[20];                /* of the plan's document then: the same for the same document */
    char plan_revision[65];            /* of its files then; "": not known */
    int64_t started_ms, length_ms;     /* since 1970; of the meeting */
    uint32_t n_batches, n_events;
    uint64_t n_bytes;
    enum wire_recording_state state;
    cJSON *marks; /* [[t_ms, kind, name]] of the message replay */
};

/* A request for one picture. A stream is served by one render: a member's own view, or the shared view of one kind, and
 * of one plane if oblique, for all who follow it. The room never has more than two requests of a stream outstanding. */
struct room_render {
    uint64_t request;   /* never the same twice; comes back with the picture */
    const cJSON *view;  /* complete view document */
    const cJSON *scene; /* complete scene to show when the view has an override, else NULL: the room's */
    uint32_t scene_revision;
    int scale_percent, quality;
    bool is_still, full_color, coarse; /* coarse: coarse surfaces are good enough */
    bool is_acted;                     /* of the view in which a member acts: its pictures go first */
    bool is_reduced[IMAGE_N_REDUCED];  /* the reduced pictures that are wanted beside it (size_class.h) */
    bool is_marked;                    /* also with the words for a draft, if the scene has one */
    const char *member;                /* id of the member whose own view it is; NULL: a shared view */
};

/* A picture that was drawn; reference-counted, as all followers are sent the same. Unchanged once it is given to the
 * room; held and dropped by any thread. */
struct room_picture {
    struct frame_header header; /* view, sequence, input_id, flags SHARED are filled per member by the room */
    uint8_t *bytes;
    size_t n_bytes;
    cJSON *missing; /* {n, regions: [{region, reason}]}: the regions that it leaves out because they cannot be drawn;
                       NULL: none */
    struct room_picture *reduced[IMAGE_N_REDUCED]; /* owned: the same of a half and of a quarter of the size, without
                                                      missing; NULL: not made */
    struct room_picture *marked; /* owned: the same, of the whole size, with the words for a draft; NULL: not made */
    atomic_int references;
};

/* A row for the audit. Texts are borrowed. Actions: note, bookmark, check (an item was put or deleted), open, leave (a
 * member enters, or its connection ends), link (one was used), link-made, control, weights (of a dose), draft-made,
 * draft-changed, draft-reset (of the beam), decision, signature, acceptance, withdrawal (of parts that do not fit, used
 * together by a person's word), recording (of the meeting: running, stopped, cut, ..., deleted), export (something was
 * given away as a file), refused (a message or call lacked the right), deleted (the room). */
struct room_audit {
    int64_t time_ms; /* since 1970, of the newest act */
    const char *action;
    const char *member, *name, *role; /* "": nobody of the room */
    const char *address;              /* from which it was done; "": not known */
    const char *detail; /* a JSON object; where acts were gathered, with times, their number, and since_ms, the time of
                           the oldest. Of an item it has sha256, of its row as it is kept */
    const char *result; /* "done" or "refused" */
    int64_t before, after; /* revisions of the scene; -1: does not apply */
};

struct room_saved {
    enum wire_saved_state state;
    uint32_t revision; /* of the scene on disk */
    bool is_full;      /* failing: for want of space */
};

/* An item that is to be on disk before it counts. All borrowed. */
struct room_item_write {
    const char *id, *kind, *row; /* row: as in item_changed */
    const char *author, *author_name;
    int64_t time_ms;
    const char
        *record; /* of a decision or signature: the record of the room at this moment, JSON; NULL: of another kind */
    const struct room_audit *audit; /* the row that is committed with it */
};

struct room_callbacks {
    /* requests a picture; answered later by room_picture_came or room_picture_failed with the same request number */
    void (*render)(void *context, struct room *room, const struct room_render *request);
    /* the picture is no longer wanted: it need not be drawn, and is not answered */
    void (*forget)(void *context, struct room *room, uint64_t request);
    /* the room's scene changed, or the renderer is new: it must have the scene before the next render */
    void (*scene_changed)(void *context, struct room *room, const cJSON *scene, uint32_t revision);
    /* a text message for one connection; text is borrowed */
    void (*send_text)(void *context, void *connection, const char *text);
    /* the same; a text with the same key that waits for the connection is replaced by this one */
    void (*send_latest)(void *context, void *connection, uint32_t key, const char *text);
    /* a frame for one connection, with its header; keeping the picture takes room_picture_hold */
    void (*send_frame)(void *context, void *connection, const struct frame_header *header,
                       struct room_picture *picture);
    /* close when all that was sent has gone out; room_connection_closed may follow but need not */
    void (*close)(void *context, void *connection);
    /* An item is new or was changed: row is the whole of it as JSON, borrowed. row NULL: it was deleted. A store keeps
     * the newest row of each id and gives it back with room_restore_item. NULL: nobody keeps items. */
    void (*item_changed)(void *context, struct room *room, const char *row, const char *id);
    /* An item is new or was changed, and counts only once it is on disk with its row for the audit: answered by
     * room_item_written with this number, later. False with problem: it cannot be written now. NULL: nobody keeps
     * items, and they count at once, with item_changed. */
    bool (*item_first)(void *context, struct room *room, uint64_t number, const struct room_item_write *write,
                       struct problem *problem);
    /* False with problem: nothing can be written now, so nothing is accepted that must last. NULL: always true. */
    bool (*can_write)(void *context, struct problem *problem);
    void *context;
    /* NULL, or: parts of the room (enum room_part) that are to be kept have changed; called often */
    void (*kept_changed)(void *context, struct room *room, unsigned parts);
    /* The address of the client at this connection, "": not known. NULL: no address is known. */
    const char *(*address)(void *context, void *connection);
    /* A row for the audit, to be committed with what else of the room is written, or before. NULL: there is no audit.
     */
    void (*audited)(void *context, struct room *room, const struct room_audit *row);
    /* False: so many rows wait for the disk that the room refuses what would need another. NULL: always true. */
    bool (*audit_has_place)(void *context);
    /* NULL: rooms are not kept; or: what of the room is on disk at this moment */
    void (*is_saved)(void *context, const struct room *room, struct room_saved *saved);
    /* The facts of a recording have changed, and, unless batch is NULL, this is to be added to it, under the number
     * n_batches - 1. Takes batch->text. NULL: there are no recordings. */
    void (*recorded)(void *context, struct room *room, const struct room_recording *recording, struct log_batch *batch);
    void (*recording_deleted)(void *context, struct room *room, const char *id);
    /* The room plays: the batches of the recording from the last one that begins with a state at or before t_ms, up to
     * the next such one, are to be read; answered by room_replay_came, later. False with problem: not now. */
    bool (*replay_read)(void *context, struct room *room, const char *of_room, const char *recording, int64_t t_ms,
                        struct problem *problem);
};

/* What of a room is kept on disk. */
enum room_part { ROOM_SCENE = 1, ROOM_VIEWS = 2, ROOM_MEMBERS = 4, ROOM_LINKS = 8, ROOM_PRESENCE = 16 };
enum { ROOM_ALL_PARTS = ROOM_SCENE | ROOM_VIEWS | ROOM_MEMBERS | ROOM_LINKS | ROOM_PRESENCE };

struct room_kept_member {
    char id[64], name[164], color[8], role[16];
    unsigned char secret_hash[32]; /* of server/auth/secret.h */
    bool has_left;                 /* it is not in the list of members, but may come back */
};

struct room_kept_link {
    unsigned char token_hash[32]; /* as secret_hash */
    char role[16], person[257];   /* person: who used it, if it is for one use */
    int64_t expires_ms;           /* since 1970 */
    bool is_one_use, is_used;
};

struct room_kept {
    int64_t created_at_s;
    uint32_t revision, n_named;
    char presenter[64];               /* "": nobody */
    char *scene, *views;              /* JSON; NULL: not asked for, or the plan was never loaded */
    char *presence;                   /* JSON: who was here; NULL: not asked for, or unknown */
    struct room_kept_member *members; /* NULL: not asked for */
    size_t n_members;
    bool has_links;               /* there is or was one */
    struct room_kept_link *links; /* NULL: not asked for */
    size_t n_links;
};

struct room_limits {
    int max_members;        /* at most ROOM_MAX_MEMBERS */
    double recording_speed; /* how many times as fast the clock of recordings and replays runs; 0: once */
};

/* id: URL-safe, random, not guessable. The plan and its default scene come with room_plan_ready. */
struct room *room_create(const char *id, const char *plan_id, const struct room_callbacks *callbacks,
                         const struct room_limits *limits);
void room_destroy(struct room *room); /* says bye to every connection first */
/* What bye says is the reason of the end, in a sentence without its dot; else "the room is closed". */
void room_end_because(struct room *room, const char *reason);
/* Decisions and signatures in the room. */
size_t room_n_decided(const struct room *room);
/* The name of the member who makes a call, "" for nobody of the room; member: as in room_call_may. */
const char *room_caller_name(const struct room *room, const char *member);
const char *room_id(const struct room *room);
const char *room_plan_id(const struct room *room);

/* The renderer's state, sent on to all members. Pictures are requested only while it is ready. Each new renderer
 * process is reported by room_plan_ready: all pictures are requested anew, requests to the old process are forgotten.
 * Before the first one is ready the scene cannot be changed; while another one starts it can, checked against the plan
 * as it was. room_plan_ready then removes ids that the plan does not have any more from the scene, and overrides with
 * such ids from their views, whose members are told. False: no memory; members are told that it failed, and it is to be
 * reported again. */
bool room_plan_ready(struct room *room, const cJSON *plan_document, const cJSON *default_scene, const char *gl,
                     bool is_software, int64_t now_us);
void room_renderer_state(struct room *room, enum wire_renderer_state state, const char *phase, double percent,
                         const struct problem *problem);

/* Connections: opaque pointers of the caller's. A connection becomes a member with hello. */
/* Returns when room_tick is due because of the text: at once, but for the acknowledgement of a frame, of which there is
 * one for each frame and member. */
int64_t room_text_came(struct room *room, void *connection, const char *text, size_t n, int64_t now_us);
void room_connection_closed(struct room *room, void *connection, int64_t now_us);
/* The same of a connection that was last heard of at heard_us: the member counts as away since then. */
void room_connection_lost(struct room *room, void *connection, int64_t heard_us, int64_t now_us);
bool room_has_member(const struct room *room, void *connection); /* it has said hello */

/* Answers to render. A picture that is no longer wanted (the renderer was restarted, the view closed) is dropped. */
void room_picture_came(struct room *room, uint64_t request, struct room_picture *picture,
                       int64_t now_us); /* takes picture */
void room_picture_failed(struct room *room, uint64_t request, const struct problem *problem, int64_t now_us);
struct room_picture *room_picture_hold(struct room_picture *picture);
void room_picture_drop(struct room_picture *picture);

/* Displays: screens that show a shared view and are no members. view: its kind; NULL: the room's main view, whichever
 * that is at the time. Of several views of the kind, the presenter's first, else that with the lowest number; one that
 * nobody has shown yet begins as for a member. A display neither keeps a room awake nor counts as its use. NULL with
 * problem: limit, validation, not-found. */
struct room_display;
struct room_display_callbacks {
    /* a newer picture, of a view of this kind (a constant word); keeping it takes room_picture_hold */
    void (*picture)(void *context, struct room_picture *picture, const char *kind);
    bool (*has_room)(void *context); /* the screen has taken the last one */
    /* The picture does not show what the room shows now: the newest state is slow to be drawn, or cannot be. False at
     * first, and again when it does. */
    void (*late)(void *context, bool is_late);
    void (*ended)(void *context); /* with the room: the display is gone */
    void *context;
};
NODISCARD struct room_display *room_display_add(struct room *room, const char *view,
                                                const struct room_display_callbacks *callbacks, int64_t now_us,
                                                struct problem *problem);
void room_display_remove(struct room_display *display);
const char *room_display_kind(const struct room_display *display); /* a word of the view's field kind */

/* Time-driven work: stills, dropping members that are away. Returns when it is due again; INT64_MAX: only after another
 * call. */
int64_t room_tick(struct room *room, int64_t now_us);

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
/* The same of a room that is not in memory: without members, and with asleep true. */
NODISCARD cJSON *room_document_of(const char *id, const char *plan_id, uint32_t revision,
                                  enum wire_renderer_state renderer, int64_t created_at_s);
NODISCARD cJSON *room_members(const struct room *room);
/* Whether a call over HTTP has the right in this room. member: "ID SECRET" of the member who makes it; NULL: of nobody
 * in the room, who then has the rights of a presenter in a room without links, else those of a reviewer who does not
 * present. False with problem forbidden or not-presenter. */
NODISCARD bool room_call_may(const struct room *room, const char *member, enum wire_right right,
                             struct problem *problem);
/* Makes a link; token gets 32 digits and a final zero. False with problem limit. */
NODISCARD bool room_link_create(struct room *room, enum wire_member_role role, int64_t expires_s, bool is_one_use,
                                int64_t now_us, char token[33], struct problem *problem);
/* The eight digits that name the link of this token in the audit. */
void room_link_mark(const char *token, char mark[9]);
size_t room_n_connected(const struct room *room);
/* Records what a call over HTTP does in this room; member as in room_call_may; address: the client's, "": not known.
 * detail is taken. */
void room_audit_call(struct room *room, const char *member, const char *address, const char *action, cJSON *detail,
                     bool is_refused, int64_t now_us);
/* The revision of the plan's files has become known, or is another one; what is written of the record from then on
 * stands under it. "": it is not known, and nothing of the record is written. */
void room_plan_revision(struct room *room, const char *revision);
/* The record of the review: {format, version, room, plan, plan_revision, revision, made_ms, present, n_present_dropped,
 * checklist, decisions, signatures, notes, saved_views, saved}; proto/record.json describes it. NULL: no memory. */
NODISCARD cJSON *room_record(const struct room *room);
/* Records what is still being gathered. */
void room_audit_flush(struct room *room, int64_t now_us);

/* [{thing, with, by, words}], borrowed until the next call: the acceptances of this room that count for the files of
 * its plan, which the renderer is sent with every scene of the room. NULL: there are none. */
const cJSON *room_acceptances(const struct room *room);

/* Items: notes with their replies, and bookmarks. [row] of one kind, oldest first, as in the message welcome; NULL: no
 * memory. */
NODISCARD cJSON *room_items(const struct room *room, enum wire_item_kind kind);
/* Gives a room an item that was kept: the row of item_changed. All rows of a room before its first member, in the order
 * of created_ms; neither item_changed nor a message follows. False with problem when the row is damaged, there already
 * or beyond a limit: the others can still be restored. */
NODISCARD bool room_restore_item(struct room *room, const char *row, size_t n, struct problem *problem);

/* Answers item_first. problem NULL: the item is on disk, so it counts and all members are told. Else it will never be
 * written, and who gave it is told why. */
void room_item_written(struct room *room, uint64_t number, const struct problem *problem, int64_t now_us);
/* Items whose writing was asked for and is not answered. */
size_t room_n_items_written(const struct room *room);

/* Bookmarks. The body of one by its id or by the token of its permalink, the caller's; NULL: there is none. */
NODISCARD cJSON *room_bookmark(const struct room *room, const char *id, uint32_t *version);
NODISCARD cJSON *room_bookmark_of_token(const struct room *room, const char *token);
/* What a bookmark shows of the room's plan: bookmark_open of server/wire/bookmark.h. NULL with problem: the plan is not
 * loaded, or there is no memory. */
NODISCARD cJSON *room_bookmark_open(const struct room *room, const cJSON *body, struct problem *problem);
/* The room begins with what a bookmark of its plan shows, instead of with the plan's own scene and home cameras. Before
 * its first member. False with problem: no memory. */
NODISCARD bool room_begin_with(struct room *room, const cJSON *body, struct problem *problem);
/* {name, layout, views: [{view, document}], report, n_report} of the bookmark that the room began with; the report only
 * once the plan was loaded. NULL: it began with none. */
NODISCARD cJSON *room_beginning(const struct room *room);

/* Fills kept with these parts of the room; room_kept_finish frees them. False: no memory. */
NODISCARD bool room_keep(const struct room *room, unsigned parts, struct room_kept *kept);
void room_kept_finish(struct room_kept *kept);
/* Makes a room that was just created what it was when it was kept; its members are away. The scene counts once the plan
 * is ready, as after a restart of the renderer. What is not readable in kept is left out, and said in the log. */
void room_restore(struct room *room, const struct room_kept *kept, int64_t now_us);
/* True once a member has entered, a link was made, or the scene was changed. */
bool room_was_used(const struct room *room);

/* Recordings. */
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
/* What was on disk is lost: the recording that runs goes on with a complete state. */
void room_recording_restart(struct room *room);
/* What the room of a recording was at t_ms: {t_ms, revision, scene, views: [{document, by}], pointers: [{member, view,
 * point_mm}], items, members, presenter}. texts: the batches from the last one that begins with a state at or before
 * t_ms on. NULL with problem. */
NODISCARD cJSON *room_recorded_state(const char *const *texts, size_t n, int64_t t_ms, struct problem *problem);

/* How many members the room has ever had. */
uint32_t room_n_named(const struct room *room);
/* The room plays this recording of another room from its beginning. Before its first member. n_named: of that room;
 * marks and notes of its members are nobody's here, as members of this room have later numbers. */
void room_replay_begin(struct room *room, const char *of_room, uint32_t n_named, const struct room_recording *recording,
                       int64_t now_us);
/* What replay_read asked for: n texts, and the time of the state behind them (INT64_MAX: there is none). n 0: they
 * cannot be read, and problem says why. */
void room_replay_came(struct room *room, const char *const *texts, size_t n, int64_t next_ms,
                      const struct problem *problem, int64_t now_us);
bool room_replays(const struct room *room);
/* The files of the open plan have changed on the disk since they were read: members are told, and nothing is decided or
 * signed until they are read anew. Times since 1970; changed_ms 0: they are as they were read. */
void room_files(struct room *room, int64_t changed_ms, int64_t read_ms);
/* Whether the room has a use for the revision of the plan's files as they are now: it plays, or records and does not
 * know it yet. */
bool room_wants_revision(const struct room *room);
/* This is the revision now; unlike that of room_plan_revision never one of files that have changed since. */
void room_revision_came(struct room *room, const char *revision, int64_t now_us);

/* Counters for /metrics. */
struct room_counters {
    uint64_t pictures_requested, frames_sent, frame_bytes, frames_skipped, messages_refused, stills_sent;
};
void room_count(const struct room *room, struct room_counters *sum); /* adds to sum */

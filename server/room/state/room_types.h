#pragma once
/* The interface between a room and its owner: limits, rows, requests and pictures, and the callbacks. Included by
 * room.h. */
#include <stdint.h>

#include "server/store/store_rows.h"
#include "server/wire/document.h"
#include "server/wire/frame.h"
#include "server/wire/identity.h"
#include "wire_gen.h"

enum {
    ROOM_MAX_MEMBERS = 200,
    ROOM_MAX_VIEWS = 8,
    ROOM_WATCH = ROOM_MAX_VIEWS + 1, /* number of the small picture of the presenter in frames and messages */
    ROOM_MAX_UNSHOWN = 2,
    ROOM_STILL_AFTER_MS = 150,
    ROOM_MEMBER_KEPT_S = 300,
    ROOM_SEAT_KEPT_S = 60,          /* of a wall, for which a seat was made, until it comes */
    ROOM_PRESENTER_KEPT_S = 30,     /* how long a presenter without a connection still presents */
    ROOM_MAX_ITEMS = 1000,          /* notes, replies and bookmarks together */
    ROOM_MAX_ITEM_BYTES = 61440,    /* of the body of a bookmark, as JSON; a note may have less (note_body.h) */
    ROOM_MAX_ITEM_FRAME = 2048,     /* of a row without its body */
    ROOM_MAX_ITEMS_BYTES = 2 << 20, /* of all rows; they are in every welcome */
    ROOM_MAX_KNOWN = 256, /* members that left and can come back as the same; beyond, the first but presenters cannot */
    ROOM_REQUEST_AGAIN_S = 10, /* after a refusal, before control can be requested again */
    ROOM_MAX_LINKS = 32,       /* valid at once */
    ROOM_MAX_TABS = 16,        /* connected seats of one person, where people sign in */
    ROOM_MIN_GUESTS = 8,       /* that one link lets be connected, where people sign in, or half of the room's places */
    ROOM_MAX_WALLS_IN = 8,     /* walls of one room; they take no place of a person */
    ROOM_MAX_WALLS = 4,        /* connected walls of one link, where people sign in */
    ROOM_MAX_PEOPLE = 100,     /* who may come in without a link */
    ROOM_MAX_REMOVED = 64,     /* members that were removed and are not let in again; the first is forgotten */
    ROOM_LINK_MIN_S = 60,
    ROOM_LINK_MAX_S = 30 * 24 * 3600,
    ROOM_LINK_WALL_MAX_S = 365 * 24 * 3600, /* of a link for a wall */
    ROOM_MAX_PRESENCE = 1000,               /* stays of members that are kept; of more, the first are counted only */
    ROOM_SAME_STAY_MS = 60000,              /* a member who returns within this continues the same stay */
    ROOM_MAX_AUDIT_DETAIL = 1024,  /* bytes of the detail of an audit row; a longer one is replaced by its length */
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
    ROOM_MAX_LISTENERS = 16,
    ROOM_DISPLAY_RETRY_MS = 5000
};

/* Why bye is said to those a room is closed to, as if it were not there; and to who has not signed in. */
#define ROOM_IS_CLOSED "the room is closed"
#define ROOM_SLEEPS "the room sleeps, as nobody is in it"
#define ROOM_NEEDS_SIGN_IN "sign in to enter this room"

struct message; /* wire_gen.h */
struct room;
struct log_batch; /* meeting_log.h */

/* A recording of a meeting in the room: its facts. The events are on disk alone. */
struct room_recording {
    char id[32], by[64], by_name[161]; /* by: the member who began it */
    char plan_sum[20];                 /* of the plan's document then: the same for the same document */
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
    bool is_of_wall;                   /* of a view of walls: its pictures go last */
    bool is_reduced[IMAGE_N_REDUCED];  /* the reduced pictures that are wanted beside it (size_class.h) */
    bool is_marked;                    /* also with the words for a draft, if the scene has one */
    const char *member;                /* id of the member whose own view it is; NULL: a shared view */
};

/* A row for the audit. Texts are borrowed. Actions: note, bookmark, check (an item was put or deleted), open, leave (a
 * member enters, or its connection ends), link (one was used), link-made, link-revoked, control, weights (of a dose),
 * draft-made, draft-changed, draft-reset (of the beam), decision, signature, acceptance, withdrawal (of parts that do
 * not fit, used together by a person's word), recording (of the meeting: running, stopped, cut, ..., deleted), export
 * (something was given away as a file), refused (a message or call lacked the right), deleted (the room). */
struct room_audit {
    int64_t time_ms; /* since 1970, of the newest act */
    const char *action;
    const char *member, *name, *role; /* "": nobody of the room */
    const char *address;              /* from which it was done; "": not known */
    /* who is signed in, how (identity_source_word) and in which session or by which token; NULL or "": not known */
    const char *user, *source, *session;
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

/* A link of the meeting that a room is a case of. */
struct room_meeting_link {
    unsigned char token_hash[STORE_HASH_BYTES];
    enum wire_member_role role; /* what it gives in this room */
    bool allows_guests;
    char maker[STORE_USER], name[161];
};

/* A room as the room of a case of a meeting. Each is asked of every room; of one that is in no meeting it says false or
 * does nothing. */
struct room_meeting_case {
    char meeting[64], name[321];
    size_t n, of; /* its place, from 1 on, among so many */
    bool is_over;
};
struct room_meeting_callbacks {
    /* The token is that of a link of the meeting, which opens the case of now, and this is the room of that case. */
    bool (*link)(void *context, const struct room *room, const struct identity *who, const char *token,
                 struct room_meeting_link *found);
    /* The link with these digits was one of the meeting, and was ended. */
    bool (*link_is_over)(void *context, const struct room *room, const char *digits);
    /* This user may come to the rooms of the meeting, with at most this role. */
    bool (*role)(void *context, const struct room *room, const struct identity *who, enum wire_member_role *role);
    void (*barred)(void *context, const struct room *room, const char *user,
                   const char *link); /* a member is removed */
    /* A member has come in: it is told how the meeting stands. */
    void (*entered)(void *context, struct room *room, void *connection);
    /* The member at this connection has the meeting go to a case; `to` "": the next one. from: as in meeting_is_at.
     * False with problem: nothing changes; true: answered by messages, later. */
    bool (*next)(void *context, struct room *room, void *connection, const char *to, const char *from,
                 struct problem *problem);
    /* The member at this connection goes along to the case of now. */
    bool (*go)(void *context, struct room *room, void *connection, struct problem *problem);
    /* Which case the room is in a meeting that has come to it. False: in none. */
    bool (*about)(void *context, const struct room *room, struct room_meeting_case *about);
    /* The number of another case in whose room the user at this connection presents to others; 0: of none. NULL: as 0.
     */
    size_t (*presents_case)(void *context, const struct room *room, void *connection);
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
    /* a frame for one connection, with its header; keeping the picture takes frame_ref */
    void (*send_frame)(void *context, void *connection, const struct frame_header *header, struct frame *picture);
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
    /* The identity behind this connection, valid as long as it lasts. NULL: everybody is the machine's one person. */
    const struct identity *(*identity)(void *context, void *connection);
    /* The highest role that this identity, which has signed in, may have in the room by what it may do with its plan.
     * False: none, and it enters by a link alone. NULL: as false. */
    bool (*role_of)(void *context, const struct room *room, const struct identity *who, enum wire_member_role *role);
    /* Whether who is at this connection may read whom the plan is of. NULL: nobody may. */
    bool (*sees_identity)(void *context, const struct room *room, void *connection);
    /* Like close, with the code of the end that says that a sign-in is needed. NULL: close is called. */
    void (*close_signed_out)(void *context, void *connection);
    /* The identity behind the call over HTTP that is being handled. NULL: none is, or it is not known. */
    const struct identity *(*caller)(void *context);
    /* A row for the audit, to be committed with what else of the room is written, or before. NULL: there is no audit.
     */
    void (*audited)(void *context, struct room *room, const struct room_audit *row);
    /* False: too many rows wait for the disk, so the room refuses acts that need another. NULL: always true. */
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
    const struct room_meeting_callbacks *meeting; /* NULL: there are no meetings */
};

/* An act in a room by a call over HTTP: a message of a page (proto/messages.json), as if a member had sent it.
 * Borrowed, but for context. */
struct room_act {
    const char *member;              /* as in room_call_may */
    const char *name;                /* of who does it, when member is NULL */
    const struct identity *identity; /* who makes the call; NULL: the machine's one person */
    const char *address;             /* as in room_audit_call */
    const char *key;                 /* NULL, or: the same item is not made twice for this word of the caller's */
    struct message *message;
    /* Called once: at once, or when the item is on disk. problem NULL: it is done, and row is the item that was
     * written; NULL: none was. was_sent_before: an earlier act with the same key has written it. */
    void (*done)(void *context, const char *row, bool was_sent_before, const struct problem *problem);
    void *context;
};

/* Parts of a room that are kept on disk. */
enum { ROOM_MAX_NAMES = 8, ROOM_NAMES_BYTES = ROOM_MAX_NAMES * 164 }; /* of those who were in a room, in a list */
enum { ROOM_NAME_LETTERS = 80, ROOM_NAME_BYTES = 4 * ROOM_NAME_LETTERS + 1 };

enum room_part {
    ROOM_SCENE = 1,
    ROOM_VIEWS = 2,
    ROOM_MEMBERS = 4,
    ROOM_LINKS = 8,
    ROOM_PRESENCE = 16,
    ROOM_PEOPLE = 32
};
enum { ROOM_ALL_PARTS = ROOM_SCENE | ROOM_VIEWS | ROOM_MEMBERS | ROOM_LINKS | ROOM_PRESENCE | ROOM_PEOPLE };

struct room_limits {
    int max_members;           /* at most ROOM_MAX_MEMBERS */
    double recording_speed;    /* how many times as fast the clock of recordings and replays runs; 0: once */
    bool admits_guests;        /* links may let in who has not signed in */
    bool is_open_to_everybody; /* though nobody signs in: nothing is signed */
};

/* Counters for /metrics. */
struct room_counters {
    uint64_t pictures_requested, frames_sent, frame_bytes, frames_skipped, messages_refused, stills_sent;
};

NODISCARD cJSON *room_members(const struct room *room);
size_t room_n_connected(const struct room *room);

#pragma once
/* Stored rows of rooms and accounts, as plain data: texts of JSON are opaque here. Thread: any. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum {
    STORE_HASH_BYTES = 32,
    STORE_MAX_MEMBERS = 1024,        /* of one room, those that left included */
    STORE_MAX_LINKS = 64,            /* of one room */
    STORE_MAX_ITEMS = 4096,          /* notes and bookmarks of one room */
    STORE_MAX_TEXT_BYTES = 32 << 20, /* one scene, list of views, or item */
    STORE_MAX_RECORDINGS = 64,       /* of one room */
    STORE_MAX_PART_BYTES = 64 << 20, /* of a recording, that are read at once */
    STORE_AUDIT_HASH = 65,           /* a hash of the audit as text */
    STORE_USER = 65,                 /* bytes of a user's or group's id, with the end */
    STORE_ROOM_NAME = 321,           /* of the name of a room */
    STORE_PERSON = 164,              /* of a name as people read it */
    STORE_GROUPS = 2113,             /* of a list of groups */
    STORE_MAX_ACCOUNTS = 10000,      /* users, tokens, sessions or owners that are read */
    STORE_MAX_MEETINGS = 1000,       /* that are read; a caller keeps no more */
    STORE_MAX_STATEMENTS = 4000      /* likewise */
};

struct store_member {
    char id[64], name[164], color[8], role[16];
    char user[STORE_USER];                       /* who signed in; "": nobody */
    char link[9];                                /* digits of the link it came in by; "": by none */
    unsigned char secret_hash[STORE_HASH_BYTES]; /* of auth/secret.h */
    bool has_left;                               /* it may come back */
    bool is_guest;
    bool waits_outside; /* the meeting was in a case that is not open to it */
};

struct store_link {
    unsigned char token_hash[STORE_HASH_BYTES]; /* of auth/secret.h */
    char role[16], person[257];                 /* person: who used it, if it is for one use */
    char maker[STORE_USER], name[STORE_PERSON]; /* maker: user who made it; name: what it is for. "": not known */
    int64_t expires_ms;                         /* since 1970 */
    bool is_one_use, is_used, allows_guests;
};

struct store_item { /* a note or a bookmark */
    char id[64], kind[16], author[64], author_name[164];
    int64_t version, created_ms, changed_ms; /* ms since 1970 */
    char *body;                              /* JSON; NULL in a write: the item is deleted */
};

/* Record of a decision or signature with all that was shown and said then. Its table only grows, and outlives room and
 * plan. */
enum { STORE_FIGURES = 4, STORE_MAX_FIGURE_BYTES = 8 << 20 };
struct store_figure {
    uint8_t *bytes; /* a JPEG */
    size_t n_bytes;
};
struct store_record {
    char id[64], room[64], plan[64], kind[16], author[64], author_name[164]; /* id: the item's */
    int64_t time_ms;                                                         /* since 1970 */
    char *item, *body;            /* the row of the item as it is kept; JSON */
    char *facts;                  /* of a list: records.h; JSON, else NULL */
    char hash[STORE_AUDIT_HASH];  /* SHA-256 of body; written by the store */
    char *signatures, *decisions; /* items written in its room since, JSON lists, of one decision read alone: signatures
                                     up to the next decision, and later decisions; else NULL */
    struct store_figure
        figures[STORE_FIGURES]; /* by their place; bytes NULL: there is none. Read with one record alone */
};
void store_record_finish(struct store_record *record);

/* Which rows of the audit are read. */
struct store_audit_query {
    int64_t from_ms, to_ms;            /* of the row: since 1970, both included */
    int64_t before_n;                  /* rows with lower numbers alone; INT64_MAX: all */
    char user[65], plan[64], room[64]; /* "": any */
    char action[24];
    size_t limit; /* 1 to STORE_AUDIT_AT_ONCE */
};

struct store_audit_row {
    int64_t n;
    char *text;
    bool is_json;                                          /* false: somebody has changed it so that it is not */
    char before[STORE_AUDIT_HASH], hash[STORE_AUDIT_HASH]; /* before: the hash of the row before it */
};

enum { STORE_ERASE_ID = 33, STORE_ERASE_ROW = 4096 };
struct store_erase {           /* a plan that is to be erased */
    char id[STORE_ERASE_ID];   /* of this erasing: hexadecimal digits */
    char plan[64], other[64];  /* its ids: rows may have either; other "": it is not known */
    char row[STORE_ERASE_ROW]; /* for the audit, with action erase and, in detail, erase: the id */
    char folder[1024], cache[1024], other_cache[1024]; /* trees below the database's folder, to be removed; "": none */
    int64_t n_rooms;                                   /* that were deleted before */
};
struct store_erased { /* how much it was */
    int64_t n_rooms, n_records;
};

struct store_batch { /* of the events of a recording */
    uint32_t place;
    int64_t t_ms;
    bool is_state; /* it begins with a complete state */
    char *text;
};

struct store_recording {
    char id[64];
    char *facts;                 /* JSON; NULL in a write: the recording is deleted */
    struct store_batch *batches; /* in a write: to be added; not read with the room */
    size_t n_batches;
};
void store_recording_finish(struct store_recording *recording);

/* Batches of a recording that were read. */
struct store_part {
    char **texts;
    size_t n;
    int64_t next_ms; /* time of the state behind them; INT64_MAX: there is none */
};
void store_part_free(struct store_part *part);

/* A case of a meeting: a plan and its room. body: JSON. */
struct store_meeting_case {
    char id[64], plan[64], room[64]; /* plan "": it was erased; room "": none yet */
    char *body;
};

struct store_meeting {
    char id[64], owner[STORE_USER];   /* owner "": nobody's */
    char *body;                       /* JSON; NULL in a write: the meeting is deleted */
    struct store_meeting_case *cases; /* all, in their order */
    size_t n_cases;
};
void store_meeting_free(struct store_meeting *meeting);

/* A statement of a person of whom a plan is of. body: JSON, which names the patient; NULL in a write: it is deleted.
 */
struct store_statement {
    char plan[64];
    char *body;
};
void store_statement_free(struct store_statement *statement);

/* A room as it is on disk, or a write: in a write, what is NULL or absent stays as it is. */
struct store_room {
    char id[64], plan[64], presenter[64]; /* presenter "": nobody */
    int64_t created_ms, used_ms;          /* since 1970; used: when somebody was last in it */
    uint32_t revision, n_named;           /* of the scene; members ever made */
    bool has_links;                       /* there is or was one */
    bool is_open;                         /* who may see its plan may come in without a link */
    bool is_changed;                      /* a person has changed something in it */
    char name[STORE_ROOM_NAME];           /* "": none was given */
    char owner[STORE_USER];               /* user; "": nobody's */
    char *people;                         /* JSON: who may come in without a link; NULL when read: nobody */
    char *scene, *views;                  /* JSON; NULL when read: the plan was never loaded */
    char *presence;                       /* JSON; NULL when read: not known */
    struct store_member *members;         /* all; NULL in a write: as they are */
    size_t n_members;
    struct store_link *links; /* as members */
    size_t n_links;
    struct store_item *items; /* when read: all; in a write: those that changed */
    size_t n_items;
    struct store_recording *recordings; /* as items */
    size_t n_recordings;
    struct store_record *records; /* in a write: to be added; not read */
    size_t n_records;
    struct store_meeting *meeting;     /* in a write without id: it is written, with the audit; not read */
    struct store_statement *statement; /* likewise */
    bool is_prompt; /* in a write: items, records and audit alone, now or never: where this cannot be, it is answered
                       with the error and dropped */
    char **audit;   /* in a write: rows for the audit (audit.h), committed with the rest or not at all; not read */
    size_t n_audit;
};

/* A room in a list. */
struct store_summary {
    char id[64], plan[64];
    int64_t created_ms, used_ms;
    uint32_t revision, n_members, n_decided, n_notes; /* n_decided: decisions and signatures */
    bool is_open, is_changed;
    char name[STORE_ROOM_NAME];
    char *names, *users; /* of members: names of some, ids of all who signed in; each ended by '\n'. NULL: none */
    char owner[STORE_USER];
    char *people; /* as in store_room */
};

void store_summary_finish(struct store_summary *room);
void store_summaries_free(struct store_summary *rooms, size_t n);

void store_room_free(struct store_room *room);

/* Accounts. Lists of groups and folders are texts in which each entry ends with '\n'. */
struct store_user {
    char id[STORE_USER], name[STORE_PERSON];
    char password[129]; /* as crypto_pwhash_str made it; "": none, so nobody signs in with one */
    char groups[STORE_GROUPS];
    bool is_disabled;
    int64_t n_failed;                    /* sign-ins since the last that worked */
    int64_t locked_until_ms, created_ms; /* since 1970 */
};

struct store_token {
    char id[20], user[STORE_USER], name[STORE_PERSON], scope[40], folders[1024];
    unsigned char hash[STORE_HASH_BYTES];
    int64_t created_ms, expires_ms, used_ms, revoked_ms; /* since 1970; 0: not used, not revoked */
    bool is_deleted;                                     /* in a write: it is no longer kept */
};

struct store_session {
    unsigned char hash[STORE_HASH_BYTES];
    char user[STORE_USER], name[STORE_PERSON], groups[STORE_GROUPS], source[16], address[46];
    int64_t created_ms, seen_ms, proved_ms; /* since 1970 */
    bool is_deleted;                        /* in a write: it has ended */
};

struct store_owner { /* of a plan */
    char plan[64], user[STORE_USER];
    bool is_deleted; /* in a write: the plan is gone */
};

/* All accounts, or in a write those that changed. */
struct store_accounts {
    struct store_user *users;
    struct store_token *tokens;
    struct store_session *sessions;
    struct store_owner *owners;
    size_t n_users, n_tokens, n_sessions, n_owners;
};
void store_accounts_free(struct store_accounts *accounts);

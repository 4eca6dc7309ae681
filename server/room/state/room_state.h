#pragma once
/* The state of a room, its members, their views, and the streams that serve them; shared by the files of server/room.
 * Internal to server/room; one thread. */
#include "server/auth/secret.h"
#include "server/room/state/pace.h"
#include "server/room/state/room_types.h"
#include "server/room/state/secret.h"
#include "wire_gen.h"

enum {
    MAX_WAITING_INPUTS =
        32, /* inputs of one view that no sent picture shows yet; beyond these, inputs are reported together */
    RETRY_US = 100000, /* pause after a failed picture; doubled each time */
    RETRY_AT_MOST_US = 4000000,
    /* In a room of more members, n members get the list of members at most once in n MEMBERS_EVERY_US:
     * everybody is sent a row for everybody, so 200 people who enter at once would make gigabytes of lists. */
    FEW_MEMBERS = 24,
    MEMBERS_EVERY_US = 2000,
};

struct request {      /* for one picture, outstanding */
    uint64_t number;  /* 0: free */
    uint64_t version; /* of the stream, when it was requested */
    int64_t requested_us;
    bool is_still;
    int n_outstanding; /* requests of the stream then, this one included */
};

struct stream {
    struct stream *next;
    cJSON *view;         /* the view document */
    cJSON *scene;        /* the scene with the view's override; NULL: the room's scene */
    bool scene_is_stale; /* scene is made anew before the next request */
    bool is_shared;
    bool is_of_wall;           /* follows the shared stream of its kind (wall.h) */
    uint64_t number;           /* counts streams from 1, never the same twice */
    uint64_t n_document;       /* another one for each document of any stream */
    uint64_t followed;         /* of a wall: n_document of the shared one that it shows; 0: none */
    int64_t wall_requested_us; /* of a wall: when a moving picture was last requested */
    int kind;
    char mover[64];         /* shared: id of the presenter who moved it last; "": nobody has yet */
    uint64_t version;       /* counts changes of what the picture shows */
    uint64_t scene_version; /* version after the newest change of the scene that reached it */
    bool is_reached;        /* by the newest change of the scene */
    uint64_t requested_version,
        still_requested_version; /* newest version requested, of either kind, and as a still; 0: none */
    uint64_t refused_version;    /* newest version that cannot be drawn; 0: none */
    struct problem refusal;      /* why it cannot */
    int64_t changed_us;          /* when version last went up */
    int64_t behind_us; /* since when latest is not of version and no newer one came; 0: latest is of version */
    int64_t acted_us;  /* when a member last acted in a view of it; 0: never */
    int64_t retry_us;  /* nothing is requested before */
    int n_failed;      /* pictures that failed in a row */
    struct request requests[2];
    struct frame *latest;
    uint64_t latest_number, latest_version; /* latest's request, and the version it shows; 0: none */
    bool latest_is_still;
    struct pace pace;
    struct member_view *viewers;       /* the views that show it */
    struct member_view *least_lagging; /* of them, the one whose lag_excess_us is least; NULL: not known */
    struct room_display *displays;
    bool is_of_display; /* made for a display: no member has shown it, and it is not kept */
    struct {            /* the message view as it was written last: most viewers are sent the same text */
        char *text;     /* NULL: none, or the view has changed since */
        int index;
        bool is_following, is_late;
        char by[64];
    } told;
};

struct member_view {                                   /* a pane of a member; its number is its index + 1 */
    struct stream *stream;                             /* NULL: closed */
    struct member *member;                             /* whose it is, while it is open */
    struct member_view *next_viewer, *previous_viewer; /* of the same stream */
    bool is_following, was_open;
    int size_px[2]; /* this member's own, as sent last; a shared view has the presenter's, and is
                       sent in the size class that this one needs */
    uint32_t sent_sequence, shown_sequence; /* they differ by at most ROOM_MAX_UNSHOWN */
    struct {
        int64_t sent_us;
        bool is_still;
    } sent[ROOM_MAX_UNSHOWN]; /* by sequence % ROOM_MAX_UNSHOWN */
    uint64_t sent_number;     /* request number of the newest picture sent */
    uint16_t sent_width_px;   /* of that picture as sent, perhaps reduced */
    int64_t lag_least_us,
        lag_excess_us; /* time from sending to acknowledgement: the least seen, and the newest beyond it; 0: none yet */
    struct {
        uint64_t version; /* a picture of at least this version shows it */
        uint32_t input;
    } waiting[MAX_WAITING_INPUTS];
    int n_waiting;
    uint32_t input; /* newest input that a sent picture shows */
    cJSON *missing; /* what the newest picture sent leaves out, as last sent to the member; NULL: nothing */
    bool has_moved; /* the presenter moved the shared view: the view message goes out before the next frame */
    char moved_by[64];
};

struct pointing { /* where a member points */
    bool is_on;
    bool is_due; /* it has changed since it was passed on */
    int view;    /* 0: none */
    struct vec3 point_mm;
    int64_t moved_us, passed_us;
};

struct member {
    char id[64], name[161], secret[SECRET_TEXT]; /* secret "": only its hash is known until it comes back */
    unsigned char secret_hash[SECRET_HASH_BYTES];
    char person[257];      /* who_key */
    char user[STORE_USER]; /* who has signed in; "": nobody has */
    char link[9];          /* digits of the link it came in by; "": by none */
    bool is_guest;         /* has not signed in, where others do; came by a link that allows it */
    char address[46];      /* of its connection, also when that has ended; "": not known */
    enum wire_member_role role;
    int color;          /* color_rgb(color) */
    void *connection;   /* NULL: away */
    bool is_expected;   /* a seat was made for it (moving.h), on which it has not come yet */
    bool waits_outside; /* the meeting is in a case that is not open to it */
    bool is_lost; /* a message to it found no memory and its connection was closed; its views are still to be closed */
    int64_t away_us; /* when the connection was lost */
    uint32_t number; /* counts members from 1, never the same twice */
    struct pointing pointing;
    uint32_t came_to;   /* number of the look this member has come to; 0: none */
    uint64_t request;   /* for control: the larger, the later; 0: none */
    int64_t refused_us; /* when the last one was refused; 0: none was */
    enum wire_member_lag lag;
    int64_t lag_until_us;                 /* it is told at least until then */
    struct member_view views[ROOM_WATCH]; /* the last one is that of watch */
    int active;                           /* number of the view in which it works; 0: not known */
    int worked;                           /* number of the view in which it last changed what is seen; 0: none */
    bool has_told_active;                 /* by a message of its own */
    uint64_t n_bytes;                     /* of the pictures sent in its views, without that of watch */
    bool is_naming;                       /* a wall: the patient's name is shown on it */
    int64_t read_identity_us;             /* when it last read whom the plan is of; 0: never */
    struct {                              /* the small picture of the presenter */
        bool is_wanted;
        bool is_late;      /* as it was told */
        int64_t behind_us; /* since when what was sent is not the newest state and nothing newer was sent; 0: it is */
        uint64_t n_bytes;  /* of the member when the newest one was sent */
    } watch;
};

static inline bool view_is_watch(const struct member_view *view)
{
    return view->member && view == &view->member->views[ROOM_WATCH - 1];
}

struct room_renderer { /* as members are told */
    enum wire_renderer_state state;
    char phase[160];
    double percent;
    struct problem problem; /* when failed */
    char gl[200];
    bool is_software;
};

struct members {
    struct member *list[ROOM_MAX_MEMBERS + ROOM_MAX_WALLS_IN]; /* max people, and walls */
    int n, max;
    int spoke;               /* index of the one that member_who_speaks found last */
    bool has_lost;           /* some is_lost */
    uint32_t n_named;        /* members ever made, for ids */
    int64_t sent_us, due_us; /* the list, to all; due: 0: what was sent is true */
};

struct streams {
    struct stream *first;
    struct stream
        *main; /* of them: what watch and displays show; of the last presenter when there is none; NULL: none */
    uint64_t n_requests, n_made, n_documents;
};

struct walls { /* what they show: streams/wall.h */
    enum wire_wall_layout layout;
    uint64_t told; /* key of what walls were told; 0: nothing */
};

struct shared_documents {           /* documents that all members have */
    cJSON *plan, *defaults, *scene; /* NULL before the plan is ready */
    cJSON *restored;                /* the scene as it was kept, until the plan is ready; else NULL */
    uint32_t revision;              /* of the scene */
    bool is_changed;                /* a person changed the scene, or something beside it that is told nowhere else */
};

struct beginning { /* the bookmark that the room was made from; all NULL: none */
    cJSON *bookmark, *views;
    cJSON *opened; /* without the scene; NULL before the plan is ready */
};

struct room_call {              /* while a call over HTTP acts in the room */
    const struct member *by;    /* who changes the scene; NULL: nobody of the room, or no call */
    const char *address;        /* NULL: no call */
    const struct room_act *act; /* NULL: none that is answered */
    char item[16];              /* the item that it has written; "": none yet */
    bool waits;                 /* its item is being written: it is answered by items_written */
    bool was_sent_before;       /* the item was made when the call was sent before */
};

struct plan_files {              /* of the room's plan */
    char revision[65];           /* "": not known */
    int64_t changed_ms, read_ms; /* room_files */
};

/* Each is the business of the folder and header named beside its pointer in struct room. */
struct acceptances;
struct admission;
struct audit;
struct control;
struct events;
struct items;
struct known;
struct links;
struct listeners;
struct look;
struct presences;
struct recorder;
struct recordings;
struct replay;
struct saved;

struct room {
    char id[64], plan_id[64];
    char name[ROOM_NAME_BYTES]; /* "": none was given */
    int64_t created_at_s;
    char end_reason[200]; /* "": the room is closed */
    struct room_callbacks callbacks;
    struct room_counters counters;
    int64_t now_us; /* the time last passed in: room_enter */
    int64_t due_us; /* when room_settle is due */

    bool admits_guests, is_open_to_everybody; /* as in struct room_limits */

    struct room_renderer renderer;
    struct plan_files files;
    struct shared_documents shared;
    struct beginning beginning;
    struct room_call call;
    struct streams streams;
    struct walls walls;
    struct members members;
    struct member *presenter; /* one of members, connected or away for less than ROOM_PRESENTER_KEPT_S; NULL: nobody */

    struct events *events;           /* state/event.h */
    struct presences *presences;     /* state/presence.h */
    struct audit *audit;             /* out/audit.h */
    struct saved *saved;             /* out/saved.h */
    struct listeners *listeners;     /* out/listeners.h; NULL: nobody ever listened */
    struct items *items;             /* items/item_list.h */
    struct acceptances *acceptances; /* items/acceptance.h */
    struct admission *admission;     /* people/admission.h */
    struct known *known;             /* people/known.h */
    struct control *control;         /* people/control.h */
    struct links *links;             /* people/links.h */
    struct look *look;               /* people/look.h */
    struct recordings *recordings;   /* log/recording.h */
    struct recorder *recorder;       /* NULL: no recording runs */
    struct replay *replay;           /* NULL: the room plays none */
};

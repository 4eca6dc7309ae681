#pragma once
/* What the files of this folder share; nobody else includes it.
 *   room.c     life of a room, renderer states, the table from message to handler
 *   member.c   who is there, coming back, views of a member
 *   stream.c   when a picture is asked for and who gets it
 *   say.c      messages to connections
 *   pace.c     how good moving pictures may be */
#include "server/room/pace.h"
#include "server/room/room.h"

enum {
    N_KINDS = SCENE_KIND_SAGITTAL + 1,
    MAX_WAITING_INPUTS = 32, /* inputs of one view not yet seen in a picture; more are reported together */
    SECRET_BYTES = 16,
    RETRY_US = 100000, /* after a picture failed, doubled each time */
    RETRY_AT_MOST_US = 4000000,
};

struct request {
    uint64_t number;  /* 0: free */
    uint64_t version; /* of the stream, when asked */
    int64_t asked_us;
    bool is_still;
    int n_outstanding; /* with this one */
};

struct stream {
    struct stream *next;
    cJSON *view;       /* its document */
    cJSON *scene;      /* with the view's override; NULL: the room's */
    bool scene_is_old; /* to be made again before the next request */
    bool is_shared;
    int kind;
    char mover[64];                              /* shared: member who moved it last */
    uint64_t version;                            /* counts what changes its picture */
    uint64_t asked_version, still_asked_version; /* newest asked for; 0 none */
    uint64_t refused_version;                    /* newest that cannot be drawn; 0 none */
    struct problem refusal;                      /* why */
    int64_t changed_us;                          /* when version last went up */
    int64_t retry_us;                            /* not before this */
    int n_failed;                                /* in a row */
    struct request requests[2];
    struct room_picture *latest;
    uint64_t latest_number, latest_version; /* its request and the version it shows; 0 none */
    bool latest_is_still;
    struct pace pace;
};

struct member_view {       /* a member's; number = index + 1 */
    struct stream *stream; /* NULL: closed */
    bool is_following, was_open;
    int size_px[2];                         /* what this member wants; the shared view has that of who moved it last */
    uint32_t sent_sequence, shown_sequence; /* they differ by at most ROOM_MAX_UNSHOWN */
    struct {
        int64_t sent_us;
        bool is_still;
    } sent[ROOM_MAX_UNSHOWN];            /* by sequence % ROOM_MAX_UNSHOWN */
    uint64_t sent_number;                /* request of the newest picture sent */
    int64_t lag_least_us, lag_excess_us; /* from sending to acknowledgement; 0 none yet */
    struct {
        uint64_t version; /* a picture of at least this version shows it */
        uint32_t input;
    } waiting[MAX_WAITING_INPUTS];
    int n_waiting;
    uint32_t input; /* newest that a sent picture shows */
    cJSON *missing; /* of the newest picture sent, as the member was told; NULL: nothing is missing */
    bool has_news;  /* somebody else moved the shared view; said with the next frame */
    char news_by[64];
};

struct member {
    char id[64], name[161], secret[2 * SECRET_BYTES + 1];
    void *connection; /* NULL: away */
    int64_t away_us;  /* since */
    struct member_view views[ROOM_MAX_VIEWS];
};

struct room {
    char id[64], plan_id[64];
    struct room_callbacks callbacks;
    int max_members;
    int64_t now_us; /* as last handed in */
    int64_t created_at_s;

    enum wire_renderer_state state;
    char phase[160];
    double percent;
    struct problem problem;         /* when failed */
    cJSON *plan, *defaults, *scene; /* NULL before the plan is ready */
    uint32_t revision;
    char gl[200];
    bool is_software;

    struct member *members[ROOM_MAX_MEMBERS];
    int n_members;
    uint32_t n_named; /* members ever, for ids */
    struct stream *streams;
    struct stream *shared[N_KINDS];
    uint64_t n_requests;
    struct room_counters counters;
};

/* member.c */
struct member *member_of(const struct room *room, const void *connection);
bool member_hello(struct room *room, void *connection, const struct message_hello *hello);
void member_disconnected(struct room *room, struct member *member);
int64_t members_forget(struct room *room); /* those long away; when to come again */
void members_free(struct room *room);
bool member_view_open(struct room *room, struct member *member, const struct message *message, struct problem *problem);
bool member_view_patch(struct room *room, struct member *member, const struct message *message,
                       struct problem *problem);
bool member_view_follow(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem);
bool member_view_close(struct room *room, struct member *member, const struct message *message,
                       struct problem *problem);
bool member_frame_shown(struct room *room, struct member *member, const struct message *message,
                        struct problem *problem);
/* An input of a member that changed the stream of a view (or left it as it was). */
void view_input(struct member_view *view, uint32_t input);

/* stream.c */
struct stream *stream_create(struct room *room, cJSON *view, bool is_shared); /* takes view */
void stream_destroy(struct room *room, struct stream *stream);
void stream_left(struct room *room,
                 struct stream *stream); /* a view of it was closed: the last one's pictures are not waited for */
bool stream_set_view(struct room *room, struct stream *stream, cJSON *view); /* takes view; true when it differs */
void stream_changed(struct room *room, struct stream *stream);
void streams_changed(struct room *room, bool scene_is_new);
void streams_forget_requests(struct room *room); /* the renderer they were made to is gone */
void streams_restart_pace(struct room *room);
void stream_send(struct room *room, struct member *member,
                 struct member_view *view); /* the latest picture, if it is new and there is credit */
/* A view has come to a stream whose picture cannot be drawn: its member is told. */
void stream_say_refusal(struct room *room, struct member *member, const struct member_view *view);
void stream_acknowledged(struct room *room, struct member_view *view, uint32_t sequence);
int64_t streams_pump(struct room *room); /* asks for what is due; when to come again */
bool override_is_valid(const struct room *room, const cJSON *view, struct problem *problem);
/* After a plan was loaded: an override that does not fit it is taken out of its view, and who looks is told. */
void streams_remove_bad_overrides(struct room *room);
int view_kind(const cJSON *view);

/* say.c */
void say(struct room *room, struct member *member, const struct message *message);
void say_to(struct room *room, void *connection, const struct message *message);
void say_to_all(struct room *room, const struct message *message);
void say_welcome(struct room *room, struct member *member);
void say_members(struct room *room);
void say_renderer(struct room *room, struct member *member); /* member NULL: all */
void say_plan(struct room *room);
void say_scene(struct room *room, const cJSON *patch, struct member *by, uint32_t input, bool to_all);
void say_view(struct room *room, struct member *member, int index, const char *by);
void say_problem(struct room *room, void *connection, const char *to, int64_t view, int64_t input,
                 const struct problem *problem);
void say_missing(struct room *room, struct member *member, int index, const cJSON *missing); /* NULL: nothing is */
void say_bye(struct room *room, void *connection, int retry_ms,
             const char *reason); /* and closes; retry_ms < 0: do not come back */

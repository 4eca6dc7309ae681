#pragma once
/* A room with a fake clock, fake connections and a renderer that is the test itself. */
#include "server/room/room.h"
#include "tests/check.h"

struct fake_page { /* one browser */
    char *texts[4096];
    size_t n_texts;
    uint32_t keys[4096]; /* of texts sent by send_latest: key + 1 */
    bool is_slow;        /* reads nothing: a text of send_latest replaces one with its key behind n_read */
    size_t n_read;
    struct frame_header frames[512];
    size_t n_frames, n_bytes_last;
    uint8_t first_byte_last;
    const void *last_bytes;          /* of the newest frame, only to be compared */
    bool is_closed, is_signed_out;   /* signed out: closed for want of a sign-in */
    const struct identity *identity; /* who has opened it; NULL: the machine's person */
};

struct fake_request {
    uint64_t request;
    cJSON *view, *scene;
    uint32_t scene_revision;
    int scale_percent, quality;
    bool is_still, full_color, coarse, is_acted, is_answered, is_forgotten;
    bool is_reduced[IMAGE_N_REDUCED], is_marked, is_of_wall;
};

struct fake_room {
    struct room *room;
    int64_t now_us;
    int64_t again_us; /* returned by the last tick */
    struct fake_request requests[1024];
    size_t n_requests;
    size_t n_scenes;
    uint32_t told_revision;
    char kept[8][4096];     /* rows of the newest calls of item_changed, "" for deleted ones; call n at n % 8 */
    size_t n_kept;          /* such calls */
    char audit[16][1400];   /* "action member result detail before after", row n at n % 16 */
    char addresses[16][46]; /* of the rows */
    size_t n_audited;
    bool audit_is_full;
    bool is_draft;       /* pictures drawn from now on show a draft */
    const char *missing; /* of pictures drawn from now on, as JSON; NULL: nothing */
    bool (*role_of)(const struct identity *who, enum wire_member_role *role);
    struct room_saved saved; /* what is on disk; unkept unless a test says otherwise */
};

void fake_room_start(struct fake_room *fake, int max_members); /* the plan is not ready yet */
/* Like fake_room_start, with other limits. */
void fake_room_start_with(struct fake_room *fake, const struct room_limits *limits);
/* Pages are opened by their identity from now on; roles: the highest role of who has signed in. */
void fake_sign_in(struct fake_room *fake, bool (*roles)(const struct identity *who, enum wire_member_role *role));
void fake_room_end(struct fake_room *fake);
/* A plan with an image "ct" and the regions "scalp" (opacity 0.4) and "brain". */
void fake_plan_ready(struct fake_room *fake, bool is_software);
/* Like fake_plan_ready, for a plan without "scalp", as after its files were changed. */
void fake_other_plan_ready(struct fake_room *fake);
void fake_page_end(struct fake_page *page);

void fake_say(struct fake_room *fake, struct fake_page *page, const char *format, ...) PRINTF_LIKE(3, 4);
/* hello, then view 1 of kind 3d, 800 x 600 */
void fake_join(struct fake_room *fake, struct fake_page *page, bool follow);
void fake_hello(struct fake_room *fake, struct fake_page *page);
void fake_shown(struct fake_room *fake, struct fake_page *page); /* acknowledges the newest frame of view 1 */
void fake_pass(struct fake_room *fake, int64_t ms);              /* lets time pass, and ticks the room when it is due */

size_t fake_outstanding(const struct fake_room *fake);
struct fake_request *fake_oldest(struct fake_room *fake); /* outstanding; NULL none */
struct fake_request *fake_newest(struct fake_room *fake);
void fake_draw(struct fake_room *fake, struct fake_request *request); /* answers with a picture */
void fake_draw_slow(struct fake_room *fake, struct fake_request *request, uint32_t render_us);
void fake_fail(struct fake_room *fake, struct fake_request *request);
/* Answers that this can never be drawn. */
void fake_refuse(struct fake_room *fake, struct fake_request *request);
/* Draws and shows pictures until no request is outstanding. */
void fake_settle(struct fake_room *fake, struct fake_page *const *pages, size_t n_pages);

/* The newest message of a type that a page got, as JSON to be deleted; NULL: none. */
cJSON *fake_heard(const struct fake_page *page, const char *type);
size_t fake_n_heard(const struct fake_page *page, const char *type);
/* Turns the camera of the page's first view. */
void fake_turn(struct fake_room *room, struct fake_page *page, int degrees, unsigned input);
/* x of the camera that a picture was requested with, in mm. */
double fake_camera_x(const struct fake_request *request);

#pragma once
/* Pictures of a film of a recorded meeting, one after the other: scene, view, words and how long it stands. Internal
 * to server/http; net thread. */
#include "server/http/api_state.h"

enum {
    FILM_MEETING_MAX_FPS = 15,
    FILM_MEETING_MAX_FRAMES = 3600, /* of one film: 12 min at 5 frames a second */
    FILM_MEETING_MAX_PAUSE_S = 60,
    FILM_MEETING_WORDS = 401
};

struct film_meeting_order {
    const char *room_id;
    const struct room_recording *recording;
    const cJSON *plan, *defaults; /* the plan's documents; copied */
    struct recorded_times times;
    int size_px[2];
    bool plan_differs; /* from the plan that the meeting saw */
};

struct film_meeting;
/* NULL with problem: no memory. */
NODISCARD struct film_meeting *film_meeting_create(const struct film_meeting_order *order, struct problem *problem);
void film_meeting_destroy(struct film_meeting *meeting); /* NULL is allowed */
void film_meeting_restart(struct film_meeting *meeting);

struct film_meeting_picture {
    cJSON *scene, *view; /* the receiver's */
    char words[FILM_MEETING_WORDS];
    int n_frames;
    bool is_last;
};
/* RECORDED_WANTED: film_meeting_read has to come first. */
enum recorded_next film_meeting_next(struct film_meeting *meeting, struct film_meeting_picture *picture,
                                     struct problem *problem);
/* Asks the disk for the part that is wanted; done is given to film_meeting_take. False with problem. */
NODISCARD bool film_meeting_read(const struct film_meeting *meeting, struct net *net, net_part_read *done,
                                 void *context, struct problem *problem);
NODISCARD bool film_meeting_take(struct film_meeting *meeting, const char *const *texts, size_t n, int64_t next_ms,
                                 struct problem *problem);
double film_meeting_percent(const struct film_meeting *meeting);

#pragma once
/* Walks through the recording of a meeting at the times of a film's pictures: what the room showed, in which view, who
 * presented, and how long a picture stands. Pure: no room, no clock, no disk. One thread. */
#include "server/wire/json.h"

enum recorded_next {
    RECORDED_STEP,   /* the step is filled */
    RECORDED_WANTED, /* the part of the log that holds step->t_ms has to be read first: recorded_walk_take */
    RECORDED_DAMAGED /* problem says why; there is no more */
};

struct recorded_times {
    double from_ms, to_ms; /* of the recording, from_ms < to_ms */
    double fps;            /* frames for each second of the recording */
    double pause_ms;       /* what shows no change for longer is left out; 0: nothing is left out */
};

struct recorded_step {
    double t_ms;
    int n_frames; /* that the picture stands for; at least 1, at most a second of them */
    bool is_last;
    /* borrowed until the next call */
    const cJSON *scene;    /* as recorded, complete for the plan of then; NULL: none was recorded */
    const cJSON *view;     /* the shared view that moved last, as recorded; NULL: there was none */
    const char *presenter; /* name; "": nobody presented */
};

struct recorded_walk;
/* NULL: no memory. */
NODISCARD struct recorded_walk *recorded_walk_create(const struct recorded_times *times);
void recorded_walk_destroy(struct recorded_walk *walk); /* NULL is allowed */
void recorded_walk_restart(struct recorded_walk *walk); /* from the beginning */
/* After RECORDED_WANTED: the batches from one that begins with a state up to the next such one, at next_ms (INT64_MAX:
 * there is none). False with problem: they are damaged. */
NODISCARD bool recorded_walk_take(struct recorded_walk *walk, const char *const *texts, size_t n, int64_t next_ms,
                                  struct problem *problem);
enum recorded_next recorded_walk_next(struct recorded_walk *walk, struct recorded_step *step, struct problem *problem);

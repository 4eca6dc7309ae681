/* Pictures of a recorded meeting. */
#include "server/http/film_meeting.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/mem.h"

struct film_meeting {
    struct recorded_walk *walk;
    struct recorded_times times;
    char room_id[64], recording[32];
    int64_t started_ms;
    double length_ms, at_ms; /* at_ms: of the last picture, or of the part that is wanted */
    cJSON *plan, *defaults, *size;
    bool plan_differs;
    int n_frames;
};

void film_meeting_destroy(struct film_meeting *meeting)
{
    if (!meeting)
        return;
    recorded_walk_destroy(meeting->walk);
    cJSON_Delete(meeting->plan);
    cJSON_Delete(meeting->defaults);
    cJSON_Delete(meeting->size);
    free(meeting);
}

struct film_meeting *film_meeting_create(const struct film_meeting_order *order, struct problem *problem)
{
    struct film_meeting *meeting = mem_new(sizeof *meeting);
    *meeting = (struct film_meeting){ .walk = recorded_walk_create(&order->times),
                                      .times = order->times,
                                      .started_ms = order->recording->started_ms,
                                      .length_ms = (double)order->recording->length_ms,
                                      .at_ms = order->times.from_ms,
                                      .plan = cJSON_Duplicate(order->plan, true),
                                      .defaults = cJSON_Duplicate(order->defaults, true),
                                      .size = cJSON_CreateObject(),
                                      .plan_differs = order->plan_differs };
    mem_put_text(meeting->room_id, sizeof meeting->room_id, order->room_id);
    mem_put_text(meeting->recording, sizeof meeting->recording, order->recording->id);
    cJSON *size = cJSON_CreateIntArray(order->size_px, 2);
    json_add(meeting->size, "size_px", size);
    if (meeting->walk && meeting->plan && meeting->defaults && meeting->size && size)
        return meeting;
    film_meeting_destroy(meeting);
    (void)json_no_memory(problem, "a film");
    return NULL;
}

void film_meeting_restart(struct film_meeting *meeting)
{
    recorded_walk_restart(meeting->walk);
    meeting->n_frames = 0;
}

double film_meeting_percent(const struct film_meeting *meeting)
{
    const struct recorded_times *times = &meeting->times;
    return fmin(100, fmax(0, 100 * (meeting->at_ms - times->from_ms) / (times->to_ms - times->from_ms)));
}

/* ---- words ------------------------------------------------------------------------------------------------------ */

/* h:mm:ss */
static void put_clock(char text[24], double t_ms)
{
    const unsigned s = (unsigned)fmin(t_ms / 1000, ROOM_MAX_RECORDING_S);
    (void)snprintf(text, 24, "%u:%02u:%02u", s / 3600, s / 60 % 60, s % 60);
}

static void put_words(const struct film_meeting *meeting, const struct recorded_step *step,
                      char words[FILM_MEETING_WORDS])
{
    char at[24], all[24], when[40] = "", name[121];
    const time_t now_s = (time_t)((meeting->started_ms + (int64_t)step->t_ms) / 1000);
    struct tm utc;
    put_clock(at, step->t_ms);
    put_clock(all, meeting->length_ms);
    if (!gmtime_r(&now_s, &utc) || strftime(when, sizeof when, "%Y-%m-%d %H:%M:%S UTC", &utc) == 0)
        when[0] = 0;
    mem_put_text(name, sizeof name, step->presenter);
    for (char *mark = name; *mark; mark++)
        *mark = (char)(*mark == ';' ? ',' : *mark); /* which separates the items */
    int n = snprintf(words, FILM_MEETING_WORDS, "Recorded meeting, %s, %s of %s; %s%s", when, at, all,
                     name[0] ? "presenting: " : "nobody presents", name);
    if (meeting->times.pause_ms > 0 && n > 0 && n < FILM_MEETING_WORDS)
        n += snprintf(words + n, (size_t)(FILM_MEETING_WORDS - n), "; pauses over %g s are shortened",
                      meeting->times.pause_ms / 1000);
    if (meeting->plan_differs && n > 0 && n < FILM_MEETING_WORDS)
        (void)snprintf(words + n, (size_t)(FILM_MEETING_WORDS - n), "; the plan has changed since the meeting");
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

/* The recorded view, in the film's size; one that is not valid any more gives way to the first view of a plan. */
static cJSON *make_view(const struct film_meeting *meeting, const cJSON *recorded, struct problem *problem)
{
    struct problem old = { 0 };
    cJSON *as_recorded = recorded ? view_document_patch(NULL, recorded, &old) : NULL;
    cJSON *view = view_document_patch(as_recorded, meeting->size, problem);
    cJSON_Delete(as_recorded);
    return view;
}

static bool make_documents(const struct film_meeting *meeting, const struct recorded_step *step,
                           struct film_meeting_picture *picture, struct problem *problem)
{
    struct problem old = { 0 };
    cJSON *scene =
              scene_document_renew(meeting->plan, meeting->defaults, step->scene ? step->scene : meeting->defaults),
          *view = scene ? make_view(meeting, step->view, problem) : NULL;
    if (!scene)
        (void)json_no_memory(problem, "a film");
    picture->scene = view ? scene_document_for_view(meeting->plan, meeting->defaults, scene, view, &old) : NULL;
    if (view && !picture->scene) { /* its override is of what the plan has no more */
        cJSON_DeleteItemFromObjectCaseSensitive(view, "override");
        picture->scene = scene_document_for_view(meeting->plan, meeting->defaults, scene, view, problem);
    }
    cJSON_Delete(scene);
    picture->view = view;
    if (picture->scene)
        return true;
    cJSON_Delete(view);
    picture->view = NULL;
    return false;
}

enum recorded_next film_meeting_next(struct film_meeting *meeting, struct film_meeting_picture *picture,
                                     struct problem *problem)
{
    struct recorded_step step;
    const enum recorded_next next = recorded_walk_next(meeting->walk, &step, problem);
    if (next == RECORDED_DAMAGED)
        return next;
    meeting->at_ms = step.t_ms;
    if (next == RECORDED_WANTED)
        return next;
    meeting->n_frames += step.n_frames;
    if (meeting->n_frames > FILM_MEETING_MAX_FRAMES) {
        char at[24];
        put_clock(at, step.t_ms);
        (void)
            problem_set(problem, PROBLEM_LIMIT, "", "",
                        "the film has %d frames at %s of the meeting, and more are not allowed: choose a shorter part, "
                        "fewer frames a second, or shorter pauses",
                        FILM_MEETING_MAX_FRAMES, at);
        return RECORDED_DAMAGED;
    }
    *picture = (struct film_meeting_picture){ .n_frames = step.n_frames, .is_last = step.is_last };
    put_words(meeting, &step, picture->words);
    return make_documents(meeting, &step, picture, problem) ? RECORDED_STEP : RECORDED_DAMAGED;
}

/* ---- the disk --------------------------------------------------------------------------------------------------- */

bool film_meeting_read(const struct film_meeting *meeting, struct net *net, net_part_read *done, void *context,
                       struct problem *problem)
{
    return net_recording_read(net, meeting->room_id, meeting->recording, (int64_t)meeting->at_ms, done, context,
                              problem);
}

bool film_meeting_take(struct film_meeting *meeting, const char *const *texts, size_t n, int64_t next_ms,
                       struct problem *problem)
{
    return recorded_walk_take(meeting->walk, texts, n, next_ms, problem);
}

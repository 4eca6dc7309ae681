/* The walk: a part of the log at a time, from one complete state to the next. */
#include "server/room/log/recorded_walk.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/log/meeting_log.h"
#include "server/wire/json_merge.h"

struct recorded_walk {
    struct recorded_times times;
    double t_ms, changed_ms; /* of the next picture; of the last change that can be seen */
    cJSON *events;           /* of the part */
    const cJSON *next;       /* event that was not applied yet */
    double part_ms;          /* from here on ... */
    int64_t next_ms;         /* ... to here */
    cJSON *state;
    char active[161]; /* id of the view that is shown */
};

static void forget_part(struct recorded_walk *walk)
{
    cJSON_Delete(walk->events);
    walk->events = NULL;
    walk->next = NULL;
}

void recorded_walk_restart(struct recorded_walk *walk)
{
    forget_part(walk);
    cJSON_Delete(walk->state);
    walk->state = NULL;
    walk->active[0] = 0;
    walk->t_ms = walk->changed_ms = walk->times.from_ms;
}

struct recorded_walk *recorded_walk_create(const struct recorded_times *times)
{
    struct recorded_walk *walk = mem_array(1, sizeof *walk, UINT64_MAX, NULL);
    if (!walk)
        return NULL;
    *walk = (struct recorded_walk){ .times = *times };
    recorded_walk_restart(walk);
    return walk;
}

void recorded_walk_destroy(struct recorded_walk *walk)
{
    if (!walk)
        return;
    forget_part(walk);
    cJSON_Delete(walk->state);
    free(walk);
}

/* ---- parts of the log ------------------------------------------------------------------------------------------- */

bool recorded_walk_take(struct recorded_walk *walk, const char *const *texts, size_t n, int64_t next_ms,
                        struct problem *problem)
{
    forget_part(walk);
    cJSON *events = meeting_log_read_all(texts, n, problem);
    if (!events)
        return false;
    const int64_t first_ms = log_event_ms(events->child);
    if (!log_event_is_state(events->child) || next_ms <= first_ms || (double)next_ms <= walk->t_ms) {
        cJSON_Delete(events);
        return problem_set(problem, PROBLEM_STORAGE, "", "", "its parts are not in order");
    }
    walk->events = events;
    walk->next = events->child;
    walk->part_ms = fmin((double)first_ms, walk->t_ms);
    walk->next_ms = next_ms;
    return true;
}

static bool has_part(const struct recorded_walk *walk)
{
    return walk->events && walk->t_ms >= walk->part_ms && walk->t_ms < (double)walk->next_ms;
}

/* ---- what can be seen ------------------------------------------------------------------------------------------- */

static bool is_of(const cJSON *event, enum log_part part)
{
    const char *word = json_text(event, "part");
    return word && strcmp(word, log_part_words[part]) == 0;
}

/* True if the event changes what the film shows or says: pointers and notes are not in it. */
static bool is_seen(const cJSON *event)
{
    return is_of(event, LOG_SCENE) || is_of(event, LOG_VIEWS) || is_of(event, LOG_MEMBERS);
}

static bool is_same_part(const cJSON *before, const cJSON *after, enum log_part part)
{
    return json_equal(log_state_part(before, part), log_state_part(after, part));
}

/* True if the event moves a view that was there: not where one is opened, or gets the size of another window. */
static bool moves_view(const struct recorded_walk *walk, const cJSON *event)
{
    const cJSON *patch = cJSON_GetObjectItemCaseSensitive(event, "patch"),
                *document = cJSON_GetObjectItemCaseSensitive(patch, "document"), *field;
    const char *id = json_text(event, "id");
    if (!is_of(event, LOG_VIEWS) || !id || json_flag(event, "gone", false) ||
        !cJSON_GetObjectItemCaseSensitive(log_state_part(walk->state, LOG_VIEWS), id))
        return false;
    if (!patch)
        return true;
    cJSON_ArrayForEach(field, document) if (strcmp(field->string, "size_px") != 0) return true;
    return false;
}

static const cJSON *presenter_of(const struct recorded_walk *walk)
{
    const cJSON *member;
    cJSON_ArrayForEach(member, log_state_part(walk->state, LOG_MEMBERS)) if (json_flag(member, "presenting",
                                                                                       false)) return member;
    return NULL;
}

/* The view that moved last while it is there; else one that the presenter moved, else the first. */
static const cJSON *active_view(struct recorded_walk *walk)
{
    const cJSON *views = log_state_part(walk->state, LOG_VIEWS), *presenter = presenter_of(walk), *view,
                *shown = walk->active[0] ? cJSON_GetObjectItemCaseSensitive(views, walk->active) : NULL;
    if (!shown)
        cJSON_ArrayForEach(view, views)
        {
            const char *by = json_text(view, "by");
            if (!shown && presenter && by && strcmp(by, presenter->string) == 0)
                shown = view;
        }
    if (!shown && cJSON_IsObject(views))
        shown = views->child;
    if (shown)
        (void)snprintf(walk->active, sizeof walk->active, "%s", shown->string);
    return shown;
}

/* Applies one event; *moved gets the id of a view that it moves. False with problem. */
static bool apply(struct recorded_walk *walk, const cJSON *event, const char **moved, bool *has_changed,
                  struct problem *problem)
{
    cJSON *before = log_event_is_state(event) && walk->state ? cJSON_Duplicate(walk->state, true) : NULL;
    if (moves_view(walk, event) && (!*moved || strcmp(*moved, walk->active) != 0))
        *moved = json_text(event, "id");
    const bool ok = meeting_log_apply(&walk->state, event, problem);
    if (ok && is_seen(event))
        *has_changed = true;
    else if (ok && log_event_is_state(event))
        *has_changed = *has_changed || !before || !is_same_part(before, walk->state, LOG_SCENE) ||
                       !is_same_part(before, walk->state, LOG_VIEWS) || !is_same_part(before, walk->state, LOG_MEMBERS);
    cJSON_Delete(before);
    return ok;
}

/* Brings the state to the time of the next picture. False with problem. */
static bool catch_up(struct recorded_walk *walk, struct problem *problem)
{
    const cJSON *first = walk->events->child;
    const char *moved = NULL;
    bool has_changed = false, ok = true;
    for (; ok && walk->next && ((double)log_event_ms(walk->next) <= walk->t_ms || walk->next == first);
         walk->next = walk->next->next)
        ok = apply(walk, walk->next, &moved, &has_changed, problem);
    if (moved)
        (void)snprintf(walk->active, sizeof walk->active, "%s", moved);
    if (has_changed)
        walk->changed_ms = walk->t_ms;
    return ok;
}

/* ---- time ------------------------------------------------------------------------------------------------------- */

/* When something may change next; at least the end of the part. */
static double next_change_ms(const struct recorded_walk *walk)
{
    for (const cJSON *event = walk->next; event; event = event->next)
        if (is_seen(event))
            return (double)log_event_ms(event);
    return (double)walk->next_ms;
}

/* Frames until one of these, so that the clock in the caption goes on each second. */
static int frames_until(const struct recorded_walk *walk, double next_ms)
{
    const struct recorded_times *times = &walk->times;
    double until_ms = fmin(fmin(next_ms, times->to_ms), (floor(walk->t_ms / 1000) + 1) * 1000);
    if (times->pause_ms > 0 && walk->changed_ms + times->pause_ms > walk->t_ms)
        until_ms = fmin(until_ms, walk->changed_ms + times->pause_ms);
    return (int)fmax(1, ceil((until_ms - walk->t_ms) * times->fps / 1000 - 1e-6));
}

static void fill(struct recorded_walk *walk, double next_ms, struct recorded_step *step)
{
    const struct recorded_times *times = &walk->times;
    const cJSON *scene = cJSON_GetObjectItemCaseSensitive(log_state_part(walk->state, LOG_SCENE), "scene");
    const char *name = json_text(presenter_of(walk), "name");
    *step = (struct recorded_step){ .t_ms = fmin(walk->t_ms, times->to_ms),
                                    .n_frames = frames_until(walk, next_ms),
                                    .scene = cJSON_GetObjectItemCaseSensitive(scene, "scene"),
                                    .view = cJSON_GetObjectItemCaseSensitive(active_view(walk), "document"),
                                    .presenter = name ? name : "" };
    walk->t_ms += step->n_frames * 1000 / times->fps;
    step->is_last = walk->t_ms >= times->to_ms - 1e-6;
}

enum recorded_next recorded_walk_next(struct recorded_walk *walk, struct recorded_step *step, struct problem *problem)
{
    const struct recorded_times *times = &walk->times;
    for (;;) {
        if (!has_part(walk)) {
            *step = (struct recorded_step){ .t_ms = walk->t_ms };
            return RECORDED_WANTED;
        }
        if (!catch_up(walk, problem))
            return RECORDED_DAMAGED;
        const double next_ms = next_change_ms(walk);
        const bool is_pause = times->pause_ms > 0 && walk->t_ms - walk->changed_ms >= times->pause_ms - 1e-6;
        if (!is_pause || walk->t_ms >= times->to_ms || next_ms <= walk->t_ms) {
            fill(walk, next_ms, step);
            return RECORDED_STEP;
        }
        walk->t_ms = fmin(next_ms, times->to_ms);
    }
}

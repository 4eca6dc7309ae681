/* Orders for films of recorded meetings. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_films.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/http/api_recordings.h"
#include "server/http/film_meeting.h"

struct meeting_call {
    struct film_order order;
    struct recorded_times times; /* to_ms 0: to the end */
    int size_px[2];
};

static bool read_size(const cJSON *body, int size_px[2], struct problem *problem)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(body, "size_px");
    if (!size)
        return true;
    double side[2] = { 0 };
    bool ok = cJSON_IsArray(size) && cJSON_GetArraySize(size) == 2;
    for (int i = 0; ok && i < 2; i++) {
        const cJSON *item = cJSON_GetArrayItem(size, i);
        side[i] = cJSON_IsNumber(item) ? item->valuedouble : NAN;
        ok = side[i] == floor(side[i]);
    }
    if (!ok)
        return problem_set(problem, PROBLEM_VALIDATION, "/size_px", "type", "%.60s has the wrong type", "size_px");
    if (!film_check_size(side[0], side[1], "/size_px", problem))
        return false;
    size_px[0] = (int)side[0];
    size_px[1] = (int)side[1];
    return true;
}

static bool read_body(const cJSON *body, struct meeting_call *asked, struct problem *problem)
{
    static const char *const known[] = {
        "from_ms", "to_ms", "pauses_s", "fps", "quality", "size_px", "identity", NULL
    };
    const double most_ms = ROOM_MAX_RECORDING_S * 1000.0;
    double fps = 5, pause_s = 0;
    *asked = (struct meeting_call){ .size_px = { 1280, 720 } };
    asked->order.quality = 80;
    asked->order.is_named = json_flag(body, "identity", false);
    if (!film_check_fields(body, known, problem) ||
        !film_read_number(body, "from_ms", (const double[]){ 0, most_ms }, false, &asked->times.from_ms, problem) ||
        !film_read_number(body, "to_ms", (const double[]){ 1, most_ms }, false, &asked->times.to_ms, problem) ||
        !film_read_number(body, "pauses_s", (const double[]){ 0, FILM_MEETING_MAX_PAUSE_S }, true, &pause_s, problem) ||
        !film_read_number(body, "fps", (const double[]){ 1, FILM_MEETING_MAX_FPS }, true, &fps, problem) ||
        !film_read_number(body, "quality", (const double[]){ 1, 100 }, true, &asked->order.quality, problem) ||
        !read_size(body, asked->size_px, problem))
        return false;
    asked->order.fps = asked->times.fps = fps;
    asked->times.pause_ms = pause_s * 1000;
    return true;
}

/* The part of the recording that is wanted. False with problem. */
static bool fit_times(struct recorded_times *times, const struct room_recording *recording, struct problem *problem)
{
    const double length_ms = fmax(1, (double)recording->length_ms);
    if (recording->state == WIRE_RECORDING_STATE_RUNNING)
        return problem_set(problem, PROBLEM_CONFLICT, "", "", "the meeting is still being recorded");
    times->to_ms = times->to_ms > 0 ? fmin(times->to_ms, length_ms) : length_ms;
    if (!(times->from_ms < times->to_ms))
        return problem_set(problem, PROBLEM_VALIDATION, "/from_ms", "range",
                           "from_ms is %g, expected less than %g, where the part ends", times->from_ms, times->to_ms);
    const double n_frames = ceil((times->to_ms - times->from_ms) * times->fps / 1000);
    return times->pause_ms > 0 || n_frames <= FILM_MEETING_MAX_FRAMES ||
           problem_set(problem, PROBLEM_VALIDATION, "/to_ms", "range",
                       "the film would have %.0f frames, expected %d at most: choose a shorter part, fewer frames a "
                       "second, or shorter pauses",
                       n_frames, FILM_MEETING_MAX_FRAMES);
}

static struct film_meeting *make_meeting(struct api *api, const struct call *call, struct meeting_call *asked,
                                         struct problem *problem)
{
    struct fleet_plan plan;
    const struct room *room = net_room_find(api->net, call->ids[0]);
    const struct room_recording *recording = room ? room_recording(room, call->ids[1]) : NULL;
    if (!room || !room_scene(room, NULL) || !fleet_plan_find(net_fleet(api->net), room_plan_id(room), &plan) ||
        !plan.document || !plan.default_scene) {
        (void)problem_set(problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        return NULL;
    }
    if (!recording) {
        api_recording_is_missing(call, problem);
        return NULL;
    }
    if (!fit_times(&asked->times, recording, problem))
        return NULL;
    asked->order.plan_id = room_plan_id(room);
    asked->order.room_id = room_id(room);
    const struct film_meeting_order order = { .room_id = asked->order.room_id,
                                              .recording = recording,
                                              .plan = plan.document,
                                              .defaults = plan.default_scene,
                                              .times = asked->times,
                                              .size_px = { asked->size_px[0], asked->size_px[1] },
                                              .plan_differs = room_plan_differs(room, recording) };
    return film_meeting_create(&order, problem);
}

static void when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    struct meeting_call *asked = call->context;
    struct problem problem;
    (void)answer;
    if (not_ready)
        problem = *not_ready;
    else
        asked->order.meeting = make_meeting(call->api, call, asked, &problem);
    struct film_order order = asked->order;
    free(asked);
    if (order.meeting)
        film_order(call->api, call, &order);
    else
        call_answer_problem(call, &problem);
}

void api_room_recording_film(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem;
    struct room *room = api_find_room(api, call);
    cJSON *body = NULL;
    if (!room)
        return;
    bool ok = true;
    if (!room_recording(room, call->ids[1])) {
        api_recording_is_missing(call, &problem);
        ok = false;
    }
    if (!ok || !api_may_replay(api, call, room_plan_id(room), &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    if (!call_read_object(call, media_types, &body))
        return;
    struct meeting_call *asked = mem_new(sizeof *asked);
    ok = read_body(body, asked, &problem);
    cJSON_Delete(body);
    if (!ok)
        call_answer_problem(call, &problem);
    if (!ok || !api_audit_export(api, call, asked->order.is_named ? "film-named" : "film")) {
        free(asked);
        return;
    }
    call->context = asked;
    api_when_ready(api, call, room_plan_id(room), when_ready);
}

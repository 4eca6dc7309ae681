/* Films of a turn about a plan, or of a recorded meeting: requested picture by picture, so that rooms are drawn between
 * them and a job knows how far it is. */
#include "server/http/api_films.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/film_meeting.h"

enum {
    MAX_BEGINNINGS = 3, /* a renderer that ends takes its films along: they begin anew */
    MAX_FILM_MIN = 60,
    BUSY_RETRY_MS = 500 /* where a refusal names no time */
};

struct api_film {
    struct api_film *next; /* the newest first */
    struct api *api;
    uint64_t number, request; /* request: of the fleet; 0: none is under way */
    int64_t renderer_number;  /* what the renderer calls it: another one each time it begins */
    char plan_id[64], room_id[64], user[IDENTITY_MAX_USER + 1]; /* room_id: "": of no room */
    cJSON *scene, *acceptances, *view;                          /* acceptances: NULL: none */
    struct film_meeting *meeting;                               /* which gives scene and view; NULL: a turn */
    char words[FILM_MEETING_WORDS];                             /* of the picture that is under way */
    double degrees, fps, quality;
    bool is_named, is_of_meeting;
    bool is_prepared, is_last;                      /* of the next picture, or that which is under way */
    int n_pictures, n_done, n_frames, n_beginnings; /* n_pictures 0: not known; n_frames: of the picture */
    int64_t begun_us, again_us; /* again_us: when a picture that was refused as busy is asked for again; 0: none was */
    enum api_job_state state;
    struct problem problem;
    struct call_bytes *bytes; /* when done: a reference */
};

static void free_documents(struct api_film *film)
{
    cJSON_Delete(film->scene);
    cJSON_Delete(film->acceptances);
    cJSON_Delete(film->view);
    film->scene = film->acceptances = film->view = NULL;
    film_meeting_destroy(film->meeting);
    film->meeting = NULL;
}

static void film_free(struct api_film *film)
{
    free_documents(film);
    call_bytes_unref(film->bytes);
    free(film);
}

static struct api_film *find(const struct api *api, uint64_t number)
{
    struct api_film *film = api->films;
    while (film && film->number != number)
        film = film->next;
    return film;
}

/* ---- making ----------------------------------------------------------------------------------------------------- */

static void begin(struct api_film *film);
static void request_picture(struct api_film *film);

static void start_waiting(struct api *api)
{
    size_t n = 0;
    struct api_film *next = NULL;
    for (struct api_film *film = api->films; film; film = film->next) {
        n += film->state == JOB_RUNNING;
        if (film->state == JOB_QUEUED)
            next = film; /* the oldest */
    }
    if (!next || n >= API_MAX_FILMS_AT_WORK)
        return;
    next->state = JOB_RUNNING;
    next->begun_us = clock_now_us();
    begin(next);
}

/* The film is not made, by this renderer or at all: whatever the renderer has of it goes, and the picture that is asked
 * for is not drawn. */
static void let_go(struct api_film *film)
{
    struct fleet *fleet = net_fleet(film->api->net);
    struct packet packet;
    packet_init(&packet, PACKET_DROP);
    packet.drop.id = (int64_t)film->request;
    packet.drop.film = film->renderer_number;
    if (film->renderer_number)
        (void)fleet_tell(fleet, film->plan_id, &packet); /* false when not ready: its films went with the renderer */
    if (film->request)
        fleet_forget_request(fleet, film->request);
    film->request = 0;
    film->renderer_number = 0;
    film->again_us = 0;
}

/* After PROBLEM_CANCELLED, which may say that the server is stopping, nothing more is asked of renderers. */
static void end_film(struct api_film *film, enum api_job_state state, const struct problem *problem)
{
    film->state = state;
    if (problem)
        film->problem = *problem;
    free_documents(film);
    if (state != JOB_DONE && (!problem || problem->type != PROBLEM_CANCELLED))
        let_go(film);
    if (!problem || problem->type != PROBLEM_CANCELLED)
        start_waiting(film->api);
}

static bool is_open(const struct api_film *film)
{
    struct fleet_plan plan;
    return fleet_plan_find(net_fleet(film->api->net), film->plan_id, &plan) && plan.state == FLEET_READY;
}

/* Asks again for a picture that was refused as busy. A renderer that is gone meanwhile has taken the film along. */
static void request_again(struct api_film *film)
{
    struct problem problem;
    const bool has_pictures = film->n_done > 0, is_lost = has_pictures && !is_open(film);
    film->again_us = 0;
    if (is_lost && film->n_beginnings < MAX_BEGINNINGS) {
        begin(film);
    } else if (is_lost) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan was closed meanwhile");
        end_film(film, JOB_FAILED, &problem);
    } else if (has_pictures || fleet_open(net_fleet(film->api->net), film->plan_id, &problem)) {
        request_picture(film);
    } else {
        end_film(film, JOB_FAILED, &problem);
    }
}

void api_films_go_on(struct api *api)
{
    const int64_t now_us = clock_now_us();
    for (struct api_film *film = api->films; film; film = film->next)
        if (film->again_us && now_us >= film->again_us)
            request_again(film);
        else if (film->again_us)
            net_look_at(api->net, film->again_us); /* what is looked at once was due for another film */
    start_waiting(api);
}

/* The oldest films go when all take too much memory. */
static void keep_within_limit(struct api *api)
{
    uint64_t n_bytes = 0;
    for (struct api_film *film = api->films; film; film = film->next) {
        n_bytes += film->bytes ? call_bytes_size(film->bytes) : 0;
        if (n_bytes > API_KEPT_FILM_BYTES) {
            call_bytes_unref(film->bytes); /* answers that are under way keep theirs */
            film->bytes = NULL;
        }
    }
}

static bool is_webm(const struct packet *answer)
{
    static const uint8_t head[] = { 0x1a, 0x45, 0xdf, 0xa3 }; /* EBML */
    return answer->blob && answer->n_blob > sizeof head && answer->n_blob <= API_MAX_FILM_BYTES + (1 << 20) &&
           memcmp(answer->blob, head, sizeof head) == 0;
}

static void take_film(struct api_film *film, struct packet *answer)
{
    struct problem problem;
    if (!is_webm(answer)) {
        problem_set(&problem, PROBLEM_RENDERER, "", "", "the renderer's answer has no film");
        end_film(film, JOB_FAILED, &problem);
        return;
    }
    film->bytes = call_bytes_create(answer->blob, answer->n_blob);
    answer->blob = NULL;
    keep_within_limit(film->api);
    end_film(film, JOB_DONE, NULL);
}

/* True if another renderer may make the film that this one did not. */
static bool can_begin_anew(const struct api_film *film, const struct problem *problem)
{
    return film->n_beginnings < MAX_BEGINNINGS &&
           (problem->type == PROBLEM_RENDERER || problem->type == PROBLEM_NOT_FOUND ||
            (problem->type == PROBLEM_TIMEOUT && !is_open(film))); /* it was being read all the time */
}

/* Asks again for what was refused as busy, when that said or soon. */
static void wait_again(struct api_film *film, const struct problem *busy)
{
    const int wait_ms = busy->retry_after_ms > 0 ? busy->retry_after_ms : BUSY_RETRY_MS;
    film->again_us = clock_now_us() + wait_ms * INT64_C(1000);
    net_look_at(film->api->net, film->again_us);
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct api_film *film = context;
    film->request = 0;
    if (problem && problem->type == PROBLEM_BUSY) {
        wait_again(film, problem);
    } else if (problem && can_begin_anew(film, problem)) {
        begin(film);
    } else if (problem) {
        end_film(film, JOB_FAILED, problem);
    } else if (film->is_prepared = false, film->n_done++, film->is_last) {
        take_film(film, answer);
    } else {
        request_picture(film);
    }
}

/* A whole turn ends where it began: its last picture is the one before the first. */
static double turn_deg(const struct api_film *film)
{
    const int n = film->n_pictures, n_steps = fabs(film->degrees) < 360 && n > 1 ? n - 1 : n;
    return film->degrees * film->n_done / n_steps;
}

/* ---- of a meeting ----------------------------------------------------------------------------------------------- */

/* A part of a recording that is being read, for a film that may be gone by then. */
struct film_reading {
    struct api *api;
    uint64_t number;
    int n_beginnings;
};

static void part_came(void *context, const char *const *texts, size_t n, int64_t next_ms, const struct problem *problem)
{
    const struct film_reading reading = *(struct film_reading *)context;
    struct api_film *film = find(reading.api, reading.number);
    struct problem found = problem ? *problem : (struct problem){ 0 };
    free(context);
    if (!film || film->state != JOB_RUNNING || film->n_beginnings != reading.n_beginnings)
        return;
    if (n && film_meeting_take(film->meeting, texts, n, next_ms, &found))
        request_picture(film);
    else if (found.type == PROBLEM_BUSY)
        wait_again(film, &found);
    else
        end_film(film, JOB_FAILED, &found);
}

static void read_part(struct api_film *film)
{
    struct problem problem;
    struct film_reading *reading = mem_new(sizeof *reading);
    *reading = (struct film_reading){ film->api, film->number, film->n_beginnings };
    if (film_meeting_read(film->meeting, film->api->net, part_came, reading, &problem))
        return;
    free(reading);
    if (problem.type == PROBLEM_BUSY)
        wait_again(film, &problem);
    else
        end_film(film, JOB_FAILED, &problem);
}

/* Scene, view and words of the next picture. False: they are being read, or the film has ended. */
static bool prepare_meeting(struct api_film *film)
{
    struct problem problem = { 0 };
    struct film_meeting_picture picture;
    const enum recorded_next next = film_meeting_next(film->meeting, &picture, &problem);
    if (next == RECORDED_WANTED)
        read_part(film);
    else if (next == RECORDED_DAMAGED)
        end_film(film, JOB_FAILED, &problem);
    if (next != RECORDED_STEP)
        return false;
    cJSON_Delete(film->scene);
    cJSON_Delete(film->view);
    film->scene = picture.scene;
    film->view = picture.view;
    film->n_frames = picture.n_frames;
    film->is_last = picture.is_last;
    memcpy(film->words, picture.words, sizeof film->words);
    return true;
}

static void request_picture(struct api_film *film)
{
    struct fleet *fleet = net_fleet(film->api->net);
    struct problem problem;
    struct packet packet;
    if (clock_now_us() - film->begun_us > MAX_FILM_MIN * INT64_C(60000000)) {
        problem_set(&problem, PROBLEM_TIMEOUT, "", "", "the film was not made within %d minutes", MAX_FILM_MIN);
        end_film(film, JOB_FAILED, &problem);
        return;
    }
    if (film->meeting && !film->is_prepared && !prepare_meeting(film))
        return;
    film->is_prepared = true; /* and is asked for again as it is, where it is refused as busy */
    if (!film->meeting)
        film->is_last = film->n_done + 1 == film->n_pictures;
    packet_init(&packet, PACKET_RENDER);
    packet.render.shown.scene = film->scene;
    packet.render.shown.acceptances = film->acceptances;
    packet.render.shown.view = film->view;
    packet.render.quality = (int64_t)film->quality;
    packet.render.still = true;
    packet.render.annotations = true;
    packet.render.named = film->is_named;
    packet.render.crosshair = film->is_of_meeting;
    mem_put_text(packet.render.words, sizeof packet.render.words, film->words);
    packet.render.turn_deg = film->is_of_meeting ? 0 : turn_deg(film);
    packet.render.film_times = film->n_frames;
    packet.render.film = film->renderer_number;
    packet.render.film_at = film->n_done;
    packet.render.film_fps = (int64_t)film->fps;
    packet.render.film_end = film->is_last;
    film->request = fleet_request(fleet, film->plan_id, &packet, picture_came, film);
}

/* At its first picture, for the first time or anew. */
static void begin(struct api_film *film)
{
    struct problem problem;
    let_go(film);
    film->n_done = 0;
    film->is_prepared = false;
    if (film->meeting)
        film_meeting_restart(film->meeting);
    film->n_beginnings++;
    film->renderer_number = (int64_t)(++film->api->n_film_beginnings);
    if (fleet_open(net_fleet(film->api->net), film->plan_id, &problem))
        request_picture(film);
    else
        end_film(film, JOB_FAILED, &problem);
}

/* ---- for jobs --------------------------------------------------------------------------------------------------- */

bool api_film_find(const struct api *api, uint64_t number, struct api_film_state *state)
{
    const struct api_film *film = find(api, number);
    if (film)
        *state = (struct api_film_state){ .state = film->state,
                                          .n_pictures = film->n_pictures,
                                          .n_done = film->n_done,
                                          .percent = film->state == JOB_DONE ? 100
                                                     : film->meeting         ? film_meeting_percent(film->meeting)
                                                     : film->n_pictures      ? 100.0 * film->n_done / film->n_pictures
                                                                             : 0,
                                          .problem = &film->problem,
                                          .plan_id = film->plan_id,
                                          .room_id = film->room_id,
                                          .is_named = film->is_named,
                                          .is_of_meeting = film->is_of_meeting,
                                          .bytes = film->bytes };
    return film != NULL;
}

void api_film_cancel(struct api *api, uint64_t number)
{
    struct api_film *film = find(api, number);
    if (!film || (film->state != JOB_RUNNING && film->state != JOB_QUEUED))
        return;
    end_film(film, JOB_CANCELLED, NULL);
}

void api_film_forget(struct api *api, uint64_t number)
{
    api_film_cancel(api, number);
    for (struct api_film **at = &api->films; *at; at = &(*at)->next)
        if ((*at)->number == number) {
            struct api_film *film = *at;
            *at = film->next;
            film_free(film);
            return;
        }
}

void api_films_erase(struct api *api, const char *plan_id)
{
    for (struct api_film *film = api->films; film; film = film->next) {
        if (strcmp(film->plan_id, plan_id) != 0)
            continue;
        api_film_cancel(api, film->number);
        call_bytes_unref(film->bytes);
        film->bytes = NULL;
    }
}

void api_films_destroy(struct api *api)
{
    while (api->films) {
        struct api_film *film = api->films;
        api->films = film->next;
        film_free(film);
    }
}

/* ---- from outside ---------------------------------------------------------------------------------------------- */

bool api_films_have_place(const struct api *api, const char *user, struct problem *problem)
{
    int n_waiting = 0, n_own = 0;
    for (const struct api_film *film = api->films; film; film = film->next) {
        const bool is_open = film->state == JOB_RUNNING || film->state == JOB_QUEUED;
        n_waiting += film->state == JOB_QUEUED;
        n_own += is_open && user[0] && strcmp(film->user, user) == 0;
    }
    if (n_own >= API_MAX_FILMS_OF_ONE)
        return problem_set(problem, PROBLEM_LIMIT, "", "", "%d films of yours are being made already", n_own);
    return n_waiting < API_MAX_FILMS_WAITING ||
           problem_set(problem, PROBLEM_LIMIT, "", "", "%d films wait to be made already", n_waiting);
}

uint64_t api_film_make(struct api *api, const struct film_order *order)
{
    struct api_film *film = mem_new(sizeof *film);
    *film = (struct api_film){ .next = api->films,
                               .api = api,
                               .number = ++api->n_films,
                               .scene = order->scene,
                               .acceptances = order->acceptances ? cJSON_Duplicate(order->acceptances, true) : NULL,
                               .view = order->view,
                               .degrees = order->degrees,
                               .fps = order->fps,
                               .quality = order->quality,
                               .is_named = order->is_named,
                               .meeting = order->meeting,
                               .is_of_meeting = order->meeting != NULL,
                               .n_frames = 1,
                               .n_pictures = order->meeting ? 0 : (int)fmax(1, round(order->seconds * order->fps)),
                               .state = JOB_QUEUED };
    mem_put_text(film->plan_id, sizeof film->plan_id, order->plan_id);
    mem_put_text(film->room_id, sizeof film->room_id, order->room_id);
    mem_put_text(film->user, sizeof film->user, order->user);
    api->films = film;
    start_waiting(api);
    return film->number;
}

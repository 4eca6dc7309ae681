/* Keeps the jobs, brings them up to date, and answers calls about them. */
#include "server/http/api_jobs.h"

#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/auth/auth.h"
#include "server/http/api_films.h"
#include "server/http/api_handlers.h"

static void update_upload(struct api *api, struct api_job *job)
{
    struct fleet_upload upload;
    if (!fleet_upload_find(net_fleet(api->net), job->upload, &upload)) {
        job->state = JOB_FAILED;
        problem_set(&job->problem, PROBLEM_NOT_FOUND, "", "", "the upload is forgotten");
        return;
    }
    static const int states[] = { [UPLOAD_QUEUED] = JOB_QUEUED,
                                  [UPLOAD_RUNNING] = JOB_RUNNING,
                                  [UPLOAD_DONE] = JOB_DONE,
                                  [UPLOAD_FAILED] = JOB_FAILED,
                                  [UPLOAD_CANCELLED] = JOB_CANCELLED };
    job->state = (enum api_job_state)states[upload.state];
    (void)snprintf(job->phase, sizeof job->phase, "%s", upload.phase);
    job->percent = upload.percent;
    if (upload.plan_id && !job->plan_id[0]) {
        (void)snprintf(job->plan_id, sizeof job->plan_id, "%s", upload.plan_id);
        if (api->auth && job->user[0])
            auth_set_owner(api->auth, job->plan_id, job->user);
    }
    if (upload.problem)
        job->problem = *upload.problem;
}

static void update_film(const struct api *api, struct api_job *job)
{
    struct api_film_state film;
    if (!api_film_find(api, job->film, &film))
        return;
    job->state = film.state;
    job->percent = film.percent;
    if (film.state == JOB_QUEUED)
        (void)snprintf(job->phase, sizeof job->phase, "other films are made first");
    else if (film.state == JOB_RUNNING && film.n_pictures == 0)
        (void)snprintf(job->phase, sizeof job->phase, "picture %d", film.n_done + 1);
    else if (film.state == JOB_RUNNING)
        (void)snprintf(job->phase, sizeof job->phase, "picture %d of %d", film.n_done + 1, film.n_pictures);
    else
        job->phase[0] = 0;
    if (film.state == JOB_FAILED)
        job->problem = *film.problem;
}

static cJSON *job_document(const struct api_job *job)
{
    static const char *const words[] = { "queued", "running", "done", "failed", "cancelled" };
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", job->id);
    cJSON_AddStringToObject(json, "kind", job->kind);
    cJSON_AddItemToObject(json, "plan", job->plan_id[0] ? cJSON_CreateString(job->plan_id) : cJSON_CreateNull());
    cJSON_AddStringToObject(json, "state", words[job->state]);
    cJSON_AddStringToObject(json, "phase", job->phase);
    cJSON_AddNumberToObject(json, "percent", job->percent);
    cJSON_AddNumberToObject(json, "created_ms", (double)job->created_ms);
    if (job->state == JOB_FAILED)
        cJSON_AddItemToObject(json, "problem", problem_to_json(&job->problem));
    else
        cJSON_AddNullToObject(json, "problem");
    return json;
}

static void update_job(struct api *api, struct api_job *job)
{
    struct fleet_plan plan;
    if (job->state != JOB_RUNNING && job->state != JOB_QUEUED)
        return;
    if (job->upload || job->film) {
        if (job->upload)
            update_upload(api, job);
        else
            update_film(api, job);
        return;
    }
    if (!fleet_plan_find(net_fleet(api->net), job->plan_id, &plan)) {
        job->state = JOB_FAILED;
        problem_set(&job->problem, PROBLEM_NOT_FOUND, "", "", "the plan is gone");
        return;
    }
    if (plan.ready_opening == job->opening) { /* also if the plan was closed since */
        job->state = JOB_DONE;
        job->phase[0] = 0;
        job->percent = 100;
        return;
    }
    if (plan.failed_opening == job->opening) { /* also if the plan was opened again since */
        job->state = job->is_cancel_requested ? JOB_CANCELLED : JOB_FAILED;
        job->problem = *plan.failure;
        return;
    }
    if (plan.opening != job->opening) { /* the plan was closed before it was ready, and opened again since */
        job->state = JOB_CANCELLED;
        return;
    }
    switch (plan.state) {
    case FLEET_STARTING:
    case FLEET_LOADING:
    case FLEET_RESTARTING:
        (void)snprintf(job->phase, sizeof job->phase, "%s", plan.phase ? plan.phase : "");
        job->percent = plan.percent;
        break;
    case FLEET_READY: break; /* handled above */
    case FLEET_CLOSED: job->state = JOB_CANCELLED; break;
    case FLEET_UNREADABLE:
    case FLEET_FAILED:
        job->state = job->is_cancel_requested ? JOB_CANCELLED : JOB_FAILED;
        if (plan.problem)
            job->problem = *plan.problem;
        break;
    }
}

void api_jobs_update(struct api *api)
{
    api_films_go_on(api);
    for (size_t i = 0; i < API_MAX_JOBS; i++)
        if (api->jobs[i].number)
            update_job(api, &api->jobs[i]);
}

/* How little is lost with the job: the least goes first, and of equals the oldest. */
static int worth(const struct api_job *job)
{
    const bool has_ended = job->state != JOB_RUNNING && job->state != JOB_QUEUED, is_work = job->upload || job->film;
    return !job->number ? 0 : has_ended && !is_work ? 1 : !is_work ? 2 : has_ended ? 3 : 4;
}

/* The place of the next job. It is never that of a film or an upload that goes on: there are far fewer of these
 * (API_MAX_FILMS_WAITING, FLEET_MAX_UPLOADS) than places. */
static struct api_job *find_place(struct api *api)
{
    struct api_job *place = &api->jobs[0];
    for (size_t i = 1; i < API_MAX_JOBS; i++) {
        struct api_job *job = &api->jobs[i];
        if (worth(job) < worth(place) || (worth(job) == worth(place) && job->number < place->number))
            place = job;
    }
    return place;
}

struct api_job *api_job_create(struct api *api, const struct call *call, const char *kind)
{
    struct api_job *job = find_place(api);
    if (job->film)
        api_film_forget(api, job->film);
    memset(job, 0, sizeof *job);
    job->number = ++api->n_jobs;
    job->created_ms = clock_wall_ms();
    (void)snprintf(job->id, sizeof job->id, "%s-%llu", kind, (unsigned long long)job->number);
    job->kind = kind;
    mem_put_text(job->user, sizeof job->user, call->identity.user);
    job->state = JOB_RUNNING;
    return job;
}

void api_job_answer(struct api *api, struct call *call, struct api_job *job)
{
    char location[80];
    update_job(api, job);
    (void)snprintf(location, sizeof location, "/api/v1/jobs/%s", job->id);
    call_add_header(call, "Location", location);
    call_answer_json(call, 202, job_document(job));
}

struct api_job *api_job_find(struct api *api, const char *id)
{
    for (size_t i = 0; i < API_MAX_JOBS; i++)
        if (api->jobs[i].number && strcmp(api->jobs[i].id, id) == 0)
            return &api->jobs[i];
    return NULL;
}

void api_job_answer_missing(struct call *call)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no job \"%.63s\"; the last %d are kept", call->ids[0],
                API_MAX_JOBS);
    call_answer_problem(call, &problem);
}

static struct api_job *find_job(struct api *api, struct call *call)
{
    struct api_job *job = api_job_find(api, call->ids[0]);
    if (!job)
        api_job_answer_missing(call);
    return job;
}

void api_job(struct api *api, struct call *call)
{
    struct api_job *job = find_job(api, call);
    if (job)
        call_answer_json(call, 200, job_document(job));
}

void api_job_cancel(struct api *api, struct call *call)
{
    struct api_job *job = find_job(api, call);
    if (!job)
        return;
    if (job->upload) {
        fleet_upload_cancel(net_fleet(api->net), job->upload);
        update_job(api, job);
    } else if (job->film) {
        api_film_cancel(api, job->film);
        update_job(api, job);
    } else if (job->state == JOB_RUNNING) {
        job->is_cancel_requested = true;
        fleet_close(net_fleet(api->net), job->plan_id);
        update_job(api, job);
    }
    call_answer_json(call, 200, job_document(job));
}

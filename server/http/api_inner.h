#pragma once
/* What the files of the API share: its state and the handlers. */
#include "server/http/api.h"

enum {
    API_MAX_JOBS = 500,        /* ended ones are forgotten oldest first */
    API_MAX_PICTURES = 32,     /* asked of one plan and not answered yet; more are answered with 503 */
    API_MAX_PIXELS = 32 << 20, /* of these together; one alone may be larger */
    API_MAX_FILES =
        4, /* surfaces asked for as files and not answered yet, of all plans: each may have PACKET_MAX_BLOB bytes */
    API_MAX_TIMINGS = 2 /* shapes being timed, of all plans */
};

enum api_job_state { JOB_QUEUED, JOB_RUNNING, JOB_DONE, JOB_FAILED, JOB_CANCELLED };

struct api_job {
    char id[40], plan_id[64]; /* plan: "" until an upload is done */
    const char *kind;         /* "open", "upload" */
    uint64_t upload;          /* the fleet's number of it; 0: opens a plan */
    uint32_t opening;         /* the plan's, as struct fleet_plan has it */
    enum api_job_state state;
    char phase[200];
    double percent;
    struct problem problem; /* failed */
    bool is_cancel_asked;
};

struct api {
    struct net *net;
    uint64_t max_upload_bytes;
    int64_t started_us;
    struct api_job jobs[API_MAX_JOBS];
    struct api_picture *pictures;            /* being made */
    size_t n_files, n_timings;               /* being made */
    size_t n_jobs;                           /* ever made; the job of number n is at n % API_MAX_JOBS */
    _Atomic uint64_t n_calls[6], n_calls_us; /* by status / 100; time spent, for /metrics; counted by the HTTP thread */
};

/* Brings the states of running jobs up to date with their plans'. */
void api_update_jobs(struct api *api);
void api_update_upload(struct api *api, struct api_job *job);
/* A new job; the oldest is forgotten. */
struct api_job *api_job_new(struct api *api, const char *kind);
/* 202 with the job and where it is. */
void api_job_answer(struct api *api, struct call *call, struct api_job *job);

void api_healthz(struct api *api, struct call *call);
void api_readyz(struct api *api, struct call *call);
void api_metrics(struct api *api, struct call *call);
void api_version(struct api *api, struct call *call);
void api_openapi(struct api *api, struct call *call);

void api_plans(struct api *api, struct call *call);
void api_plan(struct api *api, struct call *call);
void api_plan_upload(struct api *api, struct call *call);
void api_plan_delete(struct api *api, struct call *call);
void api_plan_open(struct api *api, struct call *call);
void api_plan_close(struct api *api, struct call *call);
void api_job(struct api *api, struct call *call);
void api_job_cancel(struct api *api, struct call *call);
void api_plan_render(struct api *api, struct call *call);
void api_plan_surface(struct api *api, struct call *call);
void api_plan_probe(struct api *api, struct call *call);
void api_plan_pick(struct api *api, struct call *call);

void api_rooms(struct api *api, struct call *call);
void api_room_new(struct api *api, struct call *call);
void api_room(struct api *api, struct call *call);
void api_room_delete(struct api *api, struct call *call);
void api_room_scene(struct api *api, struct call *call);
void api_room_scene_patch(struct api *api, struct call *call);
void api_room_members(struct api *api, struct call *call);
void api_room_snapshot(struct api *api, struct call *call);
void api_room_ws(struct api *api, struct call *call);

/* A picture for a call: asks the plan's renderer and answers the call with the bytes. scene and view are complete
 * documents, borrowed. revision: of a room's scene, said in the answer; NULL: not a room's. */
void api_render(struct api *api, struct call *call, const char *plan_id, const cJSON *scene, const uint32_t *revision,
                const cJSON *view, const char *format, double quality);
/* A query for a call: answered with the renderer's body. Takes query. */
void api_query(struct api *api, struct call *call, const char *plan_id, cJSON *query);
/* The same with another end: reply gets the call as its context, exactly once. */
void api_ask(struct api *api, struct call *call, const char *plan_id, cJSON *query, fleet_reply reply);
/* How api_query ends: answers the call with the body. */
void api_query_came(void *context, struct packet *answer, const struct problem *problem);
/* The view parameter, complete; a default view when it was not given. NULL: the call has been answered. */
NODISCARD cJSON *api_view_parameter(struct call *call);
/* {type: "query", what: what} */
NODISCARD cJSON *api_new_query(const char *what);

#pragma once
/* The API's state: its jobs, and how many pictures, files and timings are under way. Internal to server/http; net
 * thread, but for the counters of calls. */
#include <stdatomic.h>

#include "server/http/api.h"

enum {
    API_MAX_JOBS = 500,        /* kept; api_job_create says which is forgotten */
    API_MAX_PICTURES = 32,     /* requested by calls of one plan's renderer and not yet answered; then 503 */
    API_MAX_PIXELS = 32 << 20, /* of these together; a single picture may be larger */
    API_SHARED_AS_SIZE = 160,  /* bytes of what tells shared pictures apart, with the final zero */
    API_MAX_FILES = 4,         /* surfaces requested as files, of all plans: each may have PACKET_MAX_BLOB bytes */
    API_MAX_TIMINGS = 2        /* shapes being timed, of all plans */
};

enum api_job_state { JOB_QUEUED, JOB_RUNNING, JOB_DONE, JOB_FAILED, JOB_CANCELLED };

struct api_job {
    char id[40], plan_id[64]; /* plan_id: "" until an upload is done */
    uint64_t number;          /* of all that were ever made; 0: there is none in this place */
    int64_t created_ms;
    char user[IDENTITY_MAX_USER + 1]; /* who made it; "": who has not signed in */
    const char *kind;                 /* "open", "upload", "film" */
    uint64_t film;                    /* number of the film that it makes; 0: none */
    uint64_t upload;                  /* the fleet's number of the upload; 0: the job opens a plan */
    uint32_t opening;                 /* which opening of the plan: opening of struct fleet_plan */
    enum api_job_state state;
    char phase[200];
    double percent;
    struct problem problem; /* why it failed */
    bool is_cancel_requested;
};

struct api {
    struct net *net;
    uint64_t max_upload_bytes;
    struct api_doors doors;
    struct auth *auth; /* never NULL */
    struct api_rates *rates;
    const struct plan_rights *rights; /* of the net */
    int64_t started_us;
    struct api_job jobs[API_MAX_JOBS];
    struct api_film *films;              /* the newest first */
    uint64_t n_films, n_film_beginnings; /* ever made; ever begun */
    struct api_picture *pictures;        /* requested and not yet answered */
    size_t n_waiting_for_pictures;       /* calls that these answer */
    uint64_t n_pictures;                 /* ever requested */
    struct api_display *displays;        /* screens that look at rooms */
    struct api_listener *listeners;
    atomic_int n_printing;           /* PDFs under way */
    atomic_bool is_printing_stopped; /* by http_stop_printing */
    size_t n_files, n_timings;       /* under way */
    size_t n_searches;               /* of records, under way */
    uint64_t n_jobs;                 /* ever made */
    _Atomic uint64_t n_calls[6],
        n_calls_us; /* by status / 100, and time spent; counted by the HTTP thread, read by /metrics */
};

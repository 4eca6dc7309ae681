#pragma once
/* Renderer processes: one per open plan, found, started, confined, watched, restarted and talked to.
 * Everything here is called on the net thread, and calls back on it; one thread of the fleet's own does the socket and
 * process waiting, hands whole events over by a queue and calls options.wake. No rooms, no HTTP, no WebSocket here. */
#include <stdint.h>

#include "server/fleet/folders.h"
#include "server/wire/packet.h"

enum {
    FLEET_MAX_PLANS = 2000,
    FLEET_MAX_RESTARTS = 3,    /* in a row without a picture, while nobody holds the plan; then failed */
    FLEET_MAX_REQUESTS = 4096, /* unanswered ones, of all plans; more are answered with PROBLEM_BUSY */
    FLEET_MAX_WAITING_BYTES =
        64 << 20,            /* of requests that wait for a plan to be read; more are answered with PROBLEM_BUSY */
    FLEET_MAX_SCANS = 2,     /* plan folders looked at at once */
    FLEET_MAX_UPLOADS = 16,  /* archives that wait, are unpacked or looked at; more are refused with PROBLEM_LIMIT */
    FLEET_MAX_UNPACKING = 2, /* of these, unpacked at once */
    FLEET_KEPT_UPLOADS = 500 /* ended ones that can still be asked about */
};

/* How long things may take, in ms; 0: the default, in brackets. */
struct fleet_times {
    int ping;           /* a renderer that says nothing is asked whether it lives [2000] */
    int silent;         /* one that does not answer is ended and started again [6000]: its main thread only talks */
    int awaited_ping;   /* the same while a picture or an answer is due [250] ... */
    int awaited_silent; /* ... and its main thread stands still [600]; one that waits for a processor or a disk has the
                           time above */
    int stall;          /* reading a plan without getting further; then failed [120000] */
    int request;        /* an answer; a picture that is not there by then also ends the renderer [30000] */
    int scan;           /* looking at a plan folder, looking for GL [30000]: 20,000 DICOM files take most of it */
    int unpack;         /* unpacking an archive without getting further; then failed [120000] */
};

struct fleet;

enum fleet_state {
    FLEET_UNREADABLE, /* looked at and refused: reason says why */
    FLEET_CLOSED,     /* can be opened */
    FLEET_STARTING,   /* the process is being started */
    FLEET_LOADING,    /* it reads the plan */
    FLEET_READY,      /* it draws and answers */
    FLEET_RESTARTING, /* it stopped and is being started again, at once or after a pause: phase says which and why */
    FLEET_FAILED      /* it could not load the plan, or stopped too often: problem says why; fleet_open tries again */
};
const char *fleet_state_word(
    enum fleet_state state); /* "unreadable", "not-loaded", "starting", "loading", "ready", "restarting", "failed" */

struct fleet_options {
    const char *const *plan_folders; /* each: a folder of plans, or itself a plan; n_plan_folders of them */
    size_t n_plan_folders;
    const char *data_folder; /* our state; caches in data/cache/<plan id>, uploaded plans in data/plans, what is on its
                                way there in data/uploads, which is emptied at start */
    uint64_t max_unpacked_bytes; /* of one uploaded archive; 0: 8 GiB */
    const char *renderer_path;   /* beamroom-render; NULL: beside our own executable */
    const char *gl;              /* "auto", ... handed on */
    bool stub_renderer;          /* --stub: no GL at all, for tests */
    uint64_t max_cache_bytes;    /* of data/cache, all plans together; 0: 16 GiB */
    uint64_t disk_reserve_bytes; /* what caches leave free on the disk; 0: they may fill it */
    uint64_t max_renderer_bytes; /* writable memory of one renderer, its threads' stacks included; 0: no limit */
    int max_renderers; /* running at once; opening one more closes the longest unused that nobody holds, or is refused
                          with PROBLEM_BUSY */
    /* how the plan folders are listed, on a thread of its own; NULL: folders_list. For tests */
    void (*list_folders)(const char *const *given, size_t n_given, struct folder_list *list);
    int idle_close_s;            /* a ready plan nobody uses (fleet_hold) is closed after this */
    struct fleet_times times;    /* all 0: the defaults */
    int max_orders;              /* that may wait for the fleet's thread; 0: as many as ever come; for tests */
    void (*wake)(void *context); /* any thread: make the net thread call fleet_handle_events soon */
    /* what happened, on the net thread, from fleet_handle_events or fleet_tick; a new process is told before waiting
     * requests go to it */
    void (*changed)(void *context, const char *plan_id); /* state, progress, or the list itself (plan_id NULL) */
    void *context;
};

NODISCARD struct fleet *fleet_create(const struct fleet_options *options, struct error *err);
void fleet_destroy(struct fleet *fleet); /* stops every renderer, waits at most 2 s, kills */
void fleet_handle_events(struct fleet *fleet);
/* Time-driven work (idle close, restart back-off, request time-outs); call about every 250 ms. */
void fleet_tick(struct fleet *fleet);

/* A plan as the list knows it. Strings and documents are borrowed until the next call into the fleet. */
struct fleet_plan {
    const char *id, *folder, *name, *note;
    bool is_phantom, is_uploaded;
    enum fleet_state state;
    const char *phase; /* while starting, loading or restarting */
    double percent;
    const struct problem *problem; /* unreadable, failed, or waiting to be restarted; else NULL */
    const cJSON *parts;            /* array of text */
    uint64_t n_bytes;
    const cJSON *document;      /* the plan as the API gives it; NULL before ready (kept while restarting) */
    const cJSON *default_scene; /* likewise */
    uint32_t generation;        /* counts the processes started for it: a new one has forgotten rooms' scenes */
    uint32_t opening;           /* counts the times it was opened from closed or failed, ... */
    uint32_t ready_opening, failed_opening; /* ... the last of them that became ready, the last that failed */
    const struct problem *failure;          /* why that one failed */
    uint64_t memory_bytes;                  /* of its process; 0 unknown */
    int64_t load_ms;
    int pid; /* 0: none */
    const char
        *confined; /* how its process is confined, "landlock 3, seccomp, no-new-privs, no capabilities"; "" unknown */
};
/* Whether the plan folders have been listed: before that a plan that is not found is refused with PROBLEM_BUSY. */
bool fleet_is_listed(const struct fleet *fleet);
/* The problem of a plan that is not found: it is not there, or not known yet. Returns false. */
bool fleet_no_plan(const struct fleet *fleet, const char *plan_id, struct problem *problem);
size_t fleet_n_plans(const struct fleet *fleet);
bool fleet_plan_at(const struct fleet *fleet, size_t index, struct fleet_plan *plan);
bool fleet_plan_find(const struct fleet *fleet, const char *id, struct fleet_plan *plan);
void fleet_rescan(struct fleet *fleet); /* looks at the folders again, in the background */

/* Start loading if it is not loaded; true also when it is already. */
NODISCARD bool fleet_open(struct fleet *fleet, const char *plan_id, struct problem *problem);
/* Stop its process: cancels a load in progress (state back to closed) or closes a ready plan. */
void fleet_close(struct fleet *fleet, const char *plan_id);
/* Somebody is there who looks at the plan: while held it is not closed for idleness or for another, and a renderer that
 * ends is started again however often. Opens it when it is closed; when too many others are open, as soon as there is a
 * place. Not when it failed for a reason that lies in its files. Counts. false: there is no such plan, nothing is held
 */
NODISCARD bool fleet_hold(struct fleet *fleet, const char *plan_id);
void fleet_release(struct fleet *fleet, const char *plan_id);

/* Takes a plan out of the server for good: only one in data/plans. Its renderer ends, its folder and cache are gone
 * from the list at once and from the disk soon. Whoever holds it must have let go. false: PROBLEM_NOT_FOUND,
 * PROBLEM_FORBIDDEN, PROBLEM_STORAGE */
NODISCARD bool fleet_remove_plan(struct fleet *fleet, const char *plan_id, struct problem *problem);

/* An archive on its way to becoming a plan in data/plans. */
enum fleet_upload_state { UPLOAD_QUEUED, UPLOAD_RUNNING, UPLOAD_DONE, UPLOAD_FAILED, UPLOAD_CANCELLED };
struct fleet_upload {
    enum fleet_upload_state state;
    const char *phase; /* "" when it has ended */
    double percent;
    const char *plan_id;           /* done; else NULL */
    const struct problem *problem; /* failed; else NULL */
};
/* Begins to unpack. archive: a file in data/uploads, ours from now on, also on failure; name: what everybody may know
 * it by, for the plan's id; "": it is called after the day, upload-2026-07-01, with a number where there is one
 * already. Returns its number; 0 with problem. */
uint64_t fleet_upload(struct fleet *fleet, const char *archive, const char *name, struct problem *problem);
bool fleet_upload_find(const struct fleet *fleet, uint64_t number, struct fleet_upload *upload);
/* Ends it and removes what it made; nothing when it has ended. */
void fleet_upload_cancel(struct fleet *fleet, uint64_t number);

/* Tells the renderer something without an answer (scene, forget, drop). packet is borrowed. What is said of a room is
 * never lost while the process lives: where the way to it is full it is told later, and requests that follow are
 * refused until then. false: not ready. */
bool fleet_tell(struct fleet *fleet, const char *plan_id, const cJSON *packet);

/* Exactly one of answer and problem is given. answer->blob may be taken: set it to NULL. */
typedef void (*fleet_reply)(void *context, struct packet *answer, const struct problem *problem);
/* Asks the renderer (render, query); the id is ours to add. Waits for READY if the plan is starting, loading or
 * restarting (a render after a crash is repeated by asking again: pending requests get PROBLEM_RENDERER at once). reply
 * always comes, from fleet_handle_events or fleet_tick, also at fleet_destroy. 30 s time limit: PROBLEM_TIMEOUT.
 * Returns a number for fleet_forget_request. */
uint64_t fleet_request(struct fleet *fleet, const char *plan_id, const cJSON *packet, fleet_reply reply, void *context);
/* The asker is gone: no reply any more. */
void fleet_forget_request(struct fleet *fleet, uint64_t request);

/* GL facts of the newest renderer that told them: {back_end, vendor, renderer, version, is_software, confined}; NULL
 * before. A probe renderer started with the fleet (beamroom-render --probe-gl) tells them before any plan is open, for
 * /readyz. */
const cJSON *fleet_gl(const struct fleet *fleet, const struct problem **problem);

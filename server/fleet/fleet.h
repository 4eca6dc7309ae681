#pragma once
/* Plans and their renderer processes: finds plans, starts one confined renderer per open plan, watches and restarts it,
 * and sends it requests. Called on the net thread, and calls back on it. Threads of the fleet's own wait for sockets,
 * processes and disks; they pass events by queues and call options.wake. Knows no rooms, no HTTP and no WebSocket. */
#include <stdint.h>

#include "server/fleet/folders.h"
#include "server/wire/packet.h"

enum {
    FLEET_MAX_PLANS = 2000,
    FLEET_MAX_RESTARTS = 3,    /* ends in a row without a picture, while nobody holds the plan; then it fails */
    FLEET_MAX_REQUESTS = 4096, /* unanswered ones, of all plans; more are answered with PROBLEM_BUSY */
    FLEET_MAX_WAITING_BYTES = 64 << 20, /* of requests that wait for FLEET_READY; more are answered with PROBLEM_BUSY */
    FLEET_MAX_SCANS = 2,                /* plan folders scanned at once */
    FLEET_MAX_UPLOADS = 16,             /* archives waiting or being processed; more are refused with PROBLEM_LIMIT */
    FLEET_MAX_UNPACKING = 2,            /* of these, processed at once */
    FLEET_KEPT_UPLOADS = 500            /* ended uploads that fleet_upload_find still knows */
};

/* Time limits in ms; 0: the default, in brackets. */
struct fleet_times {
    int ping;   /* a renderer that sends nothing for this long is sent a ping [2000] */
    int silent; /* a renderer that does not answer a ping for this long is ended and restarted [6000]: its main thread
                   does no long work */
    int awaited_ping;   /* the same while a picture or an answer is due [250] ... */
    int awaited_silent; /* ... and its main thread is stopped or asleep [600]; a renderer that waits for a processor or
                           a disk has `silent` */
    int stall;          /* loading a plan without progress; then it fails [120000] */
    int request; /* a request without an answer; if it was for a picture, the renderer is ended as well [30000] */
    int scan;    /* a scan of a plan folder, or the GL probe [30000]: 20,000 DICOM files take most of it */
    int unpack;  /* unpacking an archive without progress; then it fails [120000] */
};

struct fleet;

enum fleet_state {
    FLEET_UNREADABLE, /* the scan refused it: problem says why */
    FLEET_CLOSED,     /* can be opened */
    FLEET_STARTING,   /* the process is being started */
    FLEET_LOADING,    /* the renderer reads the plan */
    FLEET_READY,      /* the renderer draws and answers */
    FLEET_RESTARTING, /* the renderer ended and is started again, at once or after a pause: phase says which, and why */
    FLEET_FAILED /* the plan could not be loaded, or its renderer ended too often: problem says why; fleet_open tries
                    again */
};
const char *fleet_state_word(
    enum fleet_state state); /* "unreadable", "not-loaded", "starting", "loading", "ready", "restarting", "failed" */

struct fleet_options {
    const char *const *plan_folders; /* each: a folder of plans, or itself a plan; n_plan_folders of them */
    size_t n_plan_folders;
    const char *data_folder;     /* the daemon's state: caches in data/cache/<plan id>, uploaded plans in data/plans,
                                    archives on their way there in     data/uploads, which is emptied at start */
    uint64_t max_unpacked_bytes; /* of one uploaded archive; 0: 8 GiB */
    const char *renderer_path;   /* path of beamroom-render; NULL: beside the daemon's own executable */
    const char *gl;              /* "auto", ...; passed on to the renderer */
    bool hides_folders;          /* ids of plans are hashes of their paths, and plans are not called by their folders */
    bool stub_renderer;          /* --stub: no GL at all, for tests */
    uint64_t max_cache_bytes;    /* of data/cache, all plans together; 0: 16 GiB */
    uint64_t disk_reserve_bytes; /* left free on the disk by caches; 0: they may fill it */
    uint64_t max_renderer_bytes; /* writable memory of one renderer, its threads' stacks included; 0: no limit */
    int max_renderers; /* at once; 0: no limit. Opening one more closes the longest unused plan that nobody holds, or is
                          refused with PROBLEM_BUSY */
    /* lists the plan folders, on the lister's thread; NULL: folders_list. For tests */
    void (*list_folders)(const char *const *given, size_t n_given, struct folder_list *list);
    int idle_close_s;            /* a ready plan that nobody holds or uses is closed after this; 0: never */
    struct fleet_times times;    /* all 0: the defaults */
    int max_orders;              /* that may wait for the watch's thread; 0: the default; for tests */
    void (*wake)(void *context); /* any thread: has the net thread call fleet_handle_events soon */
    /* A plan's state or progress changed, or the list (plan_id NULL). On the net thread, from fleet_handle_events or
     * fleet_tick; for a new process, before waiting requests are sent to it. */
    void (*changed)(void *context, const char *plan_id);
    /* A person's statement of whom the plan is of: {kind, revision, key, patients, by, time_ms, words, name, id,
     * birth_date, withdrawn_ms}, borrowed for the call; NULL, also for the function: nothing. On the net thread, when a
     * renderer is started, and when a plan of which it counts is described. */
    const cJSON *(*statement)(void *context, const char *plan_id);
    void *context;
};

NODISCARD struct fleet *fleet_create(const struct fleet_options *options, struct error *err);
void fleet_destroy(struct fleet *fleet); /* ends every renderer; kills those that have not ended within 2 s */
void fleet_handle_events(struct fleet *fleet);
/* Time-driven work: idle close, restarts, time limits. To be called about every 250 ms, every second
 * while nobody asks for anything. */
void fleet_tick(struct fleet *fleet);
/* How long the next tick may be put off when nothing happens meanwhile, at most longest_us; 0: not at all, something is
 * under way. */
int64_t fleet_rest_us(struct fleet *fleet, int64_t longest_us);

/* A plan of the list. Strings and documents are borrowed until the next call into the fleet. */
struct fleet_plan {
    const char *id, *folder, *name, *note;
    /* of the treatment plan and the patient that are shown first, "": the files name none, or were not looked at yet;
     * patient is masked, patient_id is never told to anybody: what people type is compared with it */
    const char *patient, *patient_id, *label, *date, *approval;
    /* the patient that a person has stated where the files name none, masked, and who did so; "": nobody, or it is not
     * known to count of these files, as before the plan was first read */
    const char *stated_patient, *stated_by;
    int64_t stated_ms;
    int n_patients, n_treatment_plans;
    bool is_phantom, is_uploaded;
    bool has_plan_file; /* the folder has a plan.json */
    enum fleet_state state;
    const char *phase; /* while starting, loading or restarting */
    double percent;
    const struct problem *problem; /* when unreadable, failed, or waiting for a restart; else NULL */
    const cJSON *parts;            /* array of text */
    uint64_t n_bytes;
    const cJSON *document;      /* the plan as the API gives it; NULL before ready (kept while restarting) */
    const cJSON *default_scene; /* likewise */
    uint32_t generation;        /* counts the processes started: a new one does not have the rooms' scenes */
    uint32_t opening;           /* counts the times the plan was opened from closed or failed */
    uint32_t ready_opening, failed_opening; /* the last opening that became ready; the last that failed */
    const struct problem *failure;          /* why failed_opening failed */
    uint64_t memory_bytes;                  /* resident, of its process; 0: unknown */
    int64_t load_ms;
    int pid;                                 /* 0: none */
    const char *revision;                    /* of its files, as fleet_revision gave it last; "": not known */
    int64_t files_read_ms, files_changed_ms; /* since 1970: when the files were as the open plan was read; when they
                                                were found to have changed since; 0: they have not */
    bool files_are_looked_at;                /* a look is due or running */
    const char *confined;      /* of its process: "landlock 3, seccomp, no-new-privs, no capabilities"; "": unknown */
    const char *patients_seen; /* a digest over whom the files of the document name; "": not known; told to nobody */
};
struct fleet_revision {
    char digest[65]; /* of the plan's files, as server/renderer/digest.h says; "": not known */
    char key[65];    /* likewise, of digest */
    uint64_t n_files;
    bool is_current;    /* no look at the files is due or running */
    const char *reason; /* why it cannot be known; "": it can; borrowed until the next call into the fleet */
};
/* The revision of the plan's files, as last looked at; looks again, in a program of its own, when that was some time
 * ago or the folder has changed. False: it is not known, yet or at all. When it becomes known, or another one,
 * options.changed is called. */
bool fleet_revision(struct fleet *fleet, const char *plan_id, struct fleet_revision *revision);
/* Has the plan's files looked at now; options.changed is called afterwards. */
void fleet_look_at_files(struct fleet *fleet, const char *plan_id);
/* True once the plan folders have been listed. Before that, a plan that is not found gives PROBLEM_BUSY. */
bool fleet_is_listed(const struct fleet *fleet);
/* Fills in the problem of a plan that is not found: there is none, or the list is not known yet. Returns false. */
bool fleet_no_plan(const struct fleet *fleet, const char *plan_id, struct problem *problem);
size_t fleet_n_plans(const struct fleet *fleet);
bool fleet_plan_at(const struct fleet *fleet, size_t index, struct fleet_plan *plan);
bool fleet_plan_find(const struct fleet *fleet, const char *id, struct fleet_plan *plan);
uint64_t fleet_n_lists(const struct fleet *fleet); /* the newest request that the list answers */
/* Has them listed, and returns from which fleet_n_lists on the list was begun after this call. */
uint64_t fleet_list_again(struct fleet *fleet);
void fleet_rescan(struct fleet *fleet); /* lists the folders again, in the background */

/* Starts the plan's renderer if it has none. True also when the plan is open already. */
NODISCARD bool fleet_open(struct fleet *fleet, const char *plan_id, struct problem *problem);
/* Ends the plan's renderer, also while it loads: FLEET_CLOSED. */
void fleet_close(struct fleet *fleet, const char *plan_id);
/* Has an open plan read anew, and its rooms told so; does nothing to one that is not open. */
void fleet_read_anew(struct fleet *fleet, const char *plan_id);
/* A viewer is there. While a plan is held it is not closed for idleness or for another plan, and its renderer is
 * restarted however often it ends. Opens a closed plan, at once or when one of max_renderers is free; not one that
 * failed for a reason that lies in its files. Counted: each hold has one release. Returns false when there is no such
 * plan. */
NODISCARD bool fleet_hold(struct fleet *fleet, const char *plan_id);
void fleet_release(struct fleet *fleet, const char *plan_id);

/* Deletes an uploaded plan for good: ends its renderer, takes it off the list at once, and removes its folder and cache
 * from the disk soon. Nobody may hold it. Problems: PROBLEM_NOT_FOUND, PROBLEM_FORBIDDEN (not an uploaded plan),
 * PROBLEM_STORAGE */
NODISCARD bool fleet_remove_plan(struct fleet *fleet, const char *plan_id, struct problem *problem);

/* How a plan that is to be erased may be called on the disk, and where it lies below the data folder. */
struct fleet_erase {
    char id[64], other_id[64]; /* the one of now; that of where people sign in, or do not; "": it is not known */
    char folder[1024];         /* "": it is not ours */
    char cache[1024], other_cache[1024]; /* by either id; "": none */
};
/* plan_id: either of them; of a plan that is not in the list any more no other is known. */
void fleet_erase_of(const struct fleet *fleet, const char *plan_id, struct fleet_erase *what);
/* Ends its renderer and throws away its caches and, where it is ours, its folder, as fleet_remove_plan does; also of a
 * plan that is not in the list any more. */
NODISCARD bool fleet_erase_plan(struct fleet *fleet, const char *plan_id, struct problem *problem);
bool fleet_is_removing(const struct fleet *fleet); /* something that was thrown away is still on the disk */

/* An archive that is becoming a plan in data/plans. */
enum fleet_upload_state { UPLOAD_QUEUED, UPLOAD_RUNNING, UPLOAD_DONE, UPLOAD_FAILED, UPLOAD_CANCELLED };
struct fleet_upload {
    enum fleet_upload_state state;
    const char *phase; /* "" after the end */
    double percent;
    const char *plan_id;           /* when done; else NULL */
    const struct problem *problem; /* when failed; else NULL */
};
/* Queues an archive for unpacking.
 *
 *   archive  a file in data/uploads; the fleet removes it, also on failure
 *   name     the plan's id is made from it; everybody sees it. "": from the day, upload-2026-07-01, numbered if taken
 *   returns  the upload's number; 0 with problem */
uint64_t fleet_upload(struct fleet *fleet, const char *archive, const char *name, struct problem *problem);
bool fleet_upload_find(const struct fleet *fleet, uint64_t number, struct fleet_upload *upload);
/* Ends the upload and removes its files; does nothing when it has ended. */
void fleet_upload_cancel(struct fleet *fleet, uint64_t number);

/* Sends the renderer a packet that has no answer (scene, forget, drop); borrowed. A packet about a room is not lost
 * while the process lives: when the queue to the watch is full it is sent later, and requests are refused until then.
 * Returns false when the plan is not ready. */
bool fleet_tell(struct fleet *fleet, const char *plan_id, const struct packet *packet);

/* Exactly one of answer and problem is not NULL. The reply may take answer->blob by setting it
 * to NULL, and documents by packet_take_document. */
typedef void (*fleet_reply)(void *context, struct packet *answer, const struct problem *problem);
/* Sends a request (render, await_ready or a question) and sets the packet's id. A field out of its range fails with
 * PROBLEM_VALIDATION. While the plan is starting, loading or restarting the request waits for FLEET_READY. When the
 * renderer ends, requests sent to it fail with PROBLEM_RENDERER at once. Calls reply exactly once, from
 * fleet_handle_events, fleet_tick or fleet_destroy; after times.request with PROBLEM_TIMEOUT. Returns a number for
 * fleet_forget_request. */
uint64_t fleet_request(struct fleet *fleet, const char *plan_id, struct packet *packet, fleet_reply reply,
                       void *context);
/* The reply is not called any more. */
void fleet_forget_request(struct fleet *fleet, uint64_t request);

/* GL facts of the newest renderer that reported them: {back_end, vendor, renderer, version, is_software, confined};
 * NULL before. The probe (beamroom-render --probe-gl) reports them before any plan is open. *problem: why there are
 * none; NULL: no problem. */
const cJSON *fleet_gl(const struct fleet *fleet, const struct problem **problem);

#pragma once
/* The fleet's shared state and one plan's entry in it: finding an entry, changing its state, killing and losing its
 * renderer. The bottom file of the fleet: it uses none of the other files that change plans. Internal to server/fleet;
 * everything on the net thread. Times are fleet_now_us's, except started_us. */
#include <stdint.h>

#include "server/fleet/fleet.h"
#include "server/fleet/room_updates.h"
#include "server/fleet/run_clock.h"

struct cache_quota;
struct lister;
struct remover;
struct request;
struct root_finder;
struct upload;
struct watch;

enum { PLAN_ID_SIZE = 64 };

struct plan_entry {
    char id[PLAN_ID_SIZE];
    char other_id[PLAN_ID_SIZE]; /* its id where folders are hidden, or where they are not; rooms and records on the
                                    disk may still have it */
    char *folder;                /* absolute, links resolved */
    char name[128], note[512];
    struct { /* as struct fleet_plan */
        char masked[64], id[130], label[65], date[9], approval[17];
        int n_patients, n_treatment_plans;
    } shown;
    struct { /* the patient of a person's statement that the document used last; masked "": it used none */
        char masked[64];
        int64_t time_ms;
        uint64_t fingerprint; /* of the folder then */
    } stated;
    bool is_phantom;
    bool has_plan_file;
    enum fleet_state state;
    bool has_changed; /* options.changed has not been called since the last change */
    char phase[200];
    double percent;
    struct problem problem; /* PROBLEM_NONE: none */
    cJSON *parts;
    uint64_t n_bytes;

    /* the folder and its scan */
    uint64_t fingerprint;   /* the folder's fingerprint (folders.h) */
    uint64_t scan;          /* process number of the running scan; 0: none */
    uint64_t failed_number; /* last process number when the plan failed: an older scan does not undo the failure */
    bool wants_scan;
    bool is_missing; /* no longer in the plan folders */
    bool is_removed; /* deleted: no longer found by id; freed when no process, scan or request refers to it */

    struct {
        char digest[65], key[65], reason[160]; /* digest "": not known; reason: why it cannot be */
        uint64_t n_files;
        uint64_t program;     /* number of the one that computes it; 0: none */
        uint64_t fingerprint; /* of the folder, when the last one was started */
        uint32_t generation;  /* likewise */
        int64_t looked_us;    /* when the last one ended */
        bool is_wanted;
        char loaded[65];               /* the first one of the process that draws the plan: what it has read */
        uint32_t loaded_generation;    /* of that process */
        int64_t loaded_ms, changed_ms; /* since 1970: when that was; when it was found to be another; 0: it is not */
    } revision;

    /* the renderer */
    uint64_t process; /* process number; 0: none */
    int pid;
    uint32_t generation; /* counts the processes started */
    uint64_t memory_bytes;
    bool was_ready;  /* since the plan was opened */
    bool has_drawn;  /* the present process delivered a picture */
    bool is_awaited; /* as last told to the watch */
    bool is_killed;  /* killed by us and not yet ended: its packets are ignored */
    char confined[96];
    char seen[65]; /* of the document: whom its files name (server/renderer/digest.h: patients_seen) */
    cJSON *document, *default_scene;
    struct room_update *room_updates; /* not yet sent to the renderer */
    int64_t load_ms;
    int64_t started_us;      /* clock_now_us when the present process was started */
    int64_t last_picture_us; /* time when the last picture came, from any process */
    int64_t progressed_us;   /* when loading last made progress */
    int64_t ready_us;        /* when the present process became ready; 0: not yet */
    int64_t used_us;         /* time of the last use of the plan */

    /* restarts */
    int64_t restart_at_us;      /* when the next process is started; 0: no start is planned */
    int64_t quick_booked_us;    /* of restarts.c */
    int n_ends_without_picture; /* in a row */
    char end_reason[160];       /* how the last process ended: "stopped (signal 11)" */

    /* openings */
    uint32_t opening;                       /* counts the times the plan was opened */
    uint32_t ready_opening, failed_opening; /* the last opening that became ready; the last that failed */
    struct problem failure;                 /* why failed_opening failed */
    bool is_failure_final;                  /* FLEET_FAILED for a reason that lies in the plan's files */
    bool waits_for_slot;                    /* FLEET_FAILED: held, but max_renderers others were in use */
    int64_t slot_retry_at_us;
    int n_holds;
};

struct fleet {
    struct fleet_options options;
    struct fleet_times times; /* with the defaults filled in */
    char **plan_folders;
    char *data_folder, *renderer_path, *gl_word;
    struct watch *watch;
    struct plan_entry **plans; /* room for FLEET_MAX_PLANS */
    size_t n_plans;
    bool list_has_changed; /* options.changed(NULL) is due */
    bool is_listing, is_listed;
    uint64_t n_list_requests, n_lists; /* the newest request of the lister; the newest that a taken list answers */
    struct lister *lister;
    struct run_clock clock; /* stepped by fleet_tick */
    int64_t rest_us;        /* how long the next tick may be put off, as fleet_rest_us said last */
    struct remover *remover;
    struct cache_quota *cache_quota;
    struct root_finder *root_finder;
    struct upload *uploads;          /* newest first */
    char *plans_home, *uploads_home; /* data/plans, data/uploads; absolute, links resolved */
    uint64_t n_trash;
    struct request *requests; /* oldest first */
    size_t n_requests;
    uint64_t n_waiting_bytes; /* of requests not yet sent */
    uint64_t last_number;     /* of processes and requests */
    int n_scans;              /* running */
    int n_revisions;          /* programs that compute one, running */
    uint64_t gl_probe;        /* process number of the running GL probe; 0: none */
    cJSON *gl;
    struct problem gl_problem;
};

/* Time while the net thread ran (run_clock): no process counts as late because the daemon stood still. */
int64_t fleet_now_us(const struct fleet *fleet);
/* The next number of a process, request or upload; never 0. */
uint64_t fleet_next_number(struct fleet *fleet);
/* A copy of words, NULL-terminated, as the watch takes it. */
char **fleet_arguments(const char *const *words);
/* True if the folder lies below data/plans, where uploaded plans are kept. */
bool fleet_owns_folder(const struct fleet *fleet, const char *folder);

/* The entry, or NULL. Deleted plans are not found by id or folder. */
struct plan_entry *plan_entry_find(const struct fleet *fleet, const char *id);
struct plan_entry *plan_entry_in_folder(const struct fleet *fleet, const char *folder);
struct plan_entry *plan_entry_of_process(const struct fleet *fleet, uint64_t process);

/* Sets the state; options.changed is called at the end of this turn or the next. */
void plan_entry_change(struct fleet *fleet, struct plan_entry *plan, enum fleet_state state);
/* Kills a renderer that hangs or breaks the protocol; its end is handled like a crash. */
void plan_entry_kill(struct fleet *fleet, struct plan_entry *plan, const char *reason);
/* Forgets the process, which has ended or is ending. */
void plan_entry_lose(struct plan_entry *plan);
void plan_entry_forget_documents(struct plan_entry *plan);
void plan_entry_destroy(struct plan_entry *plan);

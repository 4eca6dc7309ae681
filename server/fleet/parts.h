#pragma once
/* What the fleet's files share: its plans, its requests, its state. Everything on the net thread; nothing of this is
 * for others. Times are fleet_now_us's, but for asked_us. */
#include "server/fleet/cache.h"
#include "server/fleet/fleet.h"
#include "server/fleet/lister.h"
#include "server/fleet/remover.h"
#include "server/fleet/run_clock.h"
#include "server/fleet/watch.h"

enum {
    MAX_IMAGES = 64, /* in a plan document of a renderer */
    PLAN_ID_SIZE = 64
};

struct plan_entry {
    char id[PLAN_ID_SIZE];
    char *folder; /* absolute */
    char name[128], note[512];
    bool is_phantom;
    enum fleet_state state;
    bool has_changed; /* somebody is to be told */
    char phase[200];
    double percent;
    struct problem problem; /* PROBLEM_NONE: none */
    cJSON *parts;
    uint64_t n_bytes;

    /* looking at the folder */
    uint64_t fingerprint, scan; /* scan: number of the process that looks; 0 none */
    uint64_t failed_number;     /* as the numbers of processes: a look at the folder that began before does not undo the
                                   failure */
    bool wants_scan, is_gone;   /* gone: no longer in the plan folders */
    bool is_removed;            /* for good: nobody finds it any more, and it is freed when no event is about it */

    /* the renderer */
    uint64_t process; /* 0: none */
    int pid;
    uint32_t generation;
    uint64_t memory_bytes;
    bool was_ready;
    bool has_drawn;  /* its present process delivered a picture */
    bool is_awaited; /* as last told to the watch */
    bool is_dying;   /* ended by us, and not yet gone: what it still says counts for nothing */
    char confined[96];
    cJSON *document, *default_scene;
    struct fleet_owed *owed;   /* scenes its renderer is still to be told; requests.c's */
    int64_t load_ms, asked_us; /* asked: when its present process was started */
    int64_t drew_us;           /* when a picture last came */
    int64_t moved_us;          /* when loading last got further */
    int64_t ready_us;          /* when its present process became ready; 0: it did not */
    int64_t restart_at_us;     /* while it waits for its next start; 0: it does not */
    int64_t quick_booked_us;   /* restarts.c */
    int n_barren;              /* ends in a row without a picture before them */
    char ended_how[160];
    uint32_t opening, ready_opening,
        failed_opening;     /* counts the times it was opened; the last that became ready, that failed */
    struct problem failure; /* why that one failed */
    bool is_for_good;       /* failed: for a reason that lies in the plan's files */
    bool wants_place;       /* failed: held, but too many others were open */
    int64_t place_at_us;    /* when it tries again to get one */
    int n_holds;
    int64_t used_us;
};

struct fleet_ask { /* one request */
    struct fleet_ask *next;
    uint64_t number;
    struct plan_entry *plan; /* NULL when it was refused before it began */
    bool is_render, is_sent, is_failed;
    struct problem problem; /* when failed */
    uint8_t *bytes;         /* while not sent */
    size_t n_bytes;
    int64_t until_us;
    fleet_reply reply;
    void *context;
};

struct fleet {
    struct fleet_options options;
    struct fleet_times times;
    char **plan_folders;
    char *data_folder, *renderer_path, *gl_word;
    struct watch *watch;
    struct plan_entry **plans; /* FLEET_MAX_PLANS */
    size_t n_plans;
    bool list_has_changed, is_listing, is_listed;
    struct lister *lister;
    struct run_clock clock; /* runs with fleet_tick */
    struct remover *remover;
    struct cache *cache;
    struct upload *uploads;          /* newest first */
    char *plans_home, *uploads_home; /* data/plans, data/uploads; absolute, links resolved */
    uint64_t n_trash;
    struct fleet_ask *asks;
    size_t n_asks;
    uint64_t n_waiting_bytes; /* of requests that are not sent */
    uint64_t last_number;     /* of processes and requests */
    int n_scans;
    uint64_t probe;
    cJSON *gl;
    struct problem gl_problem;
};

/* plans.c: the list */
struct plan_entry *plan_entry_find(const struct fleet *fleet, const char *id);
struct plan_entry *plan_entry_of_process(const struct fleet *fleet, uint64_t process);
void plan_entry_destroy(struct plan_entry *plan);
void plans_take_folders(struct fleet *fleet, const struct folder_list *found);
void plans_start_scans(struct fleet *fleet);
/* True: the event was about a scan. */
bool plans_scan_ended(struct fleet *fleet, const struct watch_event *event);

/* What a program that looked at a folder printed; NULL with a reason when it gave nothing. */
NODISCARD cJSON *plans_scan_document(const struct watch_event *event, char reason[240]);
/* The plan whose folder this is; NULL. */
struct plan_entry *plan_entry_in_folder(const struct fleet *fleet, const char *folder);
/* Frees those that were removed. Never while somebody walks through the list. */
void plans_drop_removed(struct fleet *fleet);

/* uploads.c: archives to plans in data/plans, and away again */
NODISCARD bool uploads_begin(struct fleet *fleet,
                             struct error *err); /* makes the folders, clears what an earlier run left */
void uploads_end(struct fleet *fleet);
void uploads_go_on(struct fleet *fleet); /* starts what waits, notices that a new plan is listed */
/* True: the event was about an upload. */
bool uploads_take_event(struct fleet *fleet, const struct watch_event *event);
/* Lies below data/plans. */
bool uploads_owns(const struct fleet *fleet, const char *folder);

/* requests.c */
void owed_send(struct fleet *fleet); /* what found no room in the orders to the watch, in its order */
void owed_forget(struct plan_entry *plan);
void asks_send_waiting(struct fleet *fleet, struct plan_entry *plan);
/* plan NULL: those of every plan. only_sent: what still waits for READY goes on waiting. Delivered by
 * asks_deliver_failed. */
void asks_fail(struct fleet *fleet, const struct plan_entry *plan, bool only_sent, const struct problem *problem);
void asks_deliver_failed(struct fleet *fleet);
void asks_keep_time(struct fleet *fleet, int64_t now_us);
bool asks_has_any(const struct fleet *fleet, const struct plan_entry *plan);
bool asks_has_sent(const struct fleet *fleet,
                   const struct plan_entry *plan); /* the renderer owes a picture or an answer */
/* A frame, answer or problem came. False: it breaks the rules. */
bool asks_take_answer(struct fleet *fleet, struct plan_entry *plan, struct packet *packet);

/* fleet.c */
int64_t fleet_now_us(
    const struct fleet *fleet); /* time while the net thread ran: nobody is late because we stood still */
void plan_entry_open_held(struct fleet *fleet,
                          struct plan_entry *plan); /* without a place it fails, says so, and tries again */
void plan_entry_start(struct fleet *fleet, struct plan_entry *plan); /* a process for it; state stays */
void plan_entry_close(struct fleet *fleet, struct plan_entry *plan,
                      const char *why); /* its renderer ends, waiting requests fail */
void plan_entry_change(struct fleet *fleet, struct plan_entry *plan, enum fleet_state state);
/* A renderer that is stuck or lies: ends it; it is started again as after a crash. */
void plan_entry_kill(struct fleet *fleet, struct plan_entry *plan, const char *reason);
char **fleet_arguments(const char *const *words); /* copies; NULL-terminated */
uint64_t fleet_number(struct fleet *fleet);

/* Runs the steps of each upload: unpacks the archive beside itself, finds its root, scans it, moves it to data/plans,
 * waits until it is listed; and removes its files when it fails or is cancelled. */
#define _GNU_SOURCE
#include "server/fleet/uploads.h"

#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/path.h"
#include "server/fleet/data_folders.h"
#include "server/fleet/plan_scan.h"
#include "server/fleet/upload_root.h"
#include "server/fleet/watch.h"

enum {
    MAX_SAME_NAME = 999,      /* plans of one name; folder_make_id leaves room for the number */
    LIST_WITHIN_US = 30000000 /* how long the list may take to find a new plan */
};

static const uint64_t default_max_unpacked_bytes = UINT64_C(8) << 30;

enum stage {
    STAGE_WAITING,
    STAGE_UNPACKING, /* process unpacks */
    STAGE_FINDING,   /* the root finder looks for root */
    STAGE_SCANNING,  /* process scans root */
    STAGE_LISTING,   /* moved to data/plans; the list does not know it yet */
    STAGE_ENDED      /* ended; while process != 0 it is being killed, and its files are removed when it has ended */
};

struct upload {
    struct upload *next;
    uint64_t number, process; /* process: 0 none */
    enum fleet_upload_state state;
    enum stage stage;
    char *archive, *folder; /* both are removed in the end */
    char *root;             /* the plan's folder: folder, or the only folder inside; once adopted: in data/plans */
    char base_id[PLAN_ID_SIZE], plan_id[PLAN_ID_SIZE];
    double percent;
    bool has_reported_end; /* the program that unpacks printed "done" or a problem */
    struct problem problem;
    uint64_t n_bytes, n_files;
    int64_t began_us, list_until_us;
};

static void upload_free(struct upload *upload)
{
    free(upload->archive);
    free(upload->folder);
    free(upload->root);
    free(upload);
}

void uploads_destroy(struct fleet *fleet)
{
    while (fleet->uploads) {
        struct upload *next = fleet->uploads->next;
        upload_free(fleet->uploads);
        fleet->uploads = next;
    }
}

/* ---- one upload ------------------------------------------------------------------------------------------------- */

static bool has_ended(const struct upload *upload)
{
    return upload->stage == STAGE_ENDED;
}

static void clean(struct fleet *fleet, const struct upload *upload)
{
    if (!data_throw_away(fleet, upload->archive) && errno != ENOENT)
        log_warn("upload %llu: its archive cannot be removed: %s", (unsigned long long)upload->number, strerror(errno));
    if (!data_throw_away(fleet, upload->folder) && errno != ENOENT)
        log_warn("upload %llu: its folder cannot be removed: %s", (unsigned long long)upload->number, strerror(errno));
}

static void end(struct fleet *fleet, struct upload *upload, enum fleet_upload_state state)
{
    upload->state = state;
    upload->stage = STAGE_ENDED;
    if (upload->process)
        watch_stop(fleet->watch, upload->process, true,
                   "is no longer wanted"); /* it may still write: its files are removed after its end */
    else
        clean(fleet, upload);
    fleet->options.wake(fleet->options.context);
}

static void fail(struct fleet *fleet, struct upload *upload, const struct problem *problem)
{
    upload->problem = *problem;
    log_info("upload %llu: failed: %s", (unsigned long long)upload->number,
             problem_word(problem->type)); /* the detail may hold names of files */
    end(fleet, upload, UPLOAD_FAILED);
}

static void start_unpacking(struct fleet *fleet, struct upload *upload)
{
    char limit[32];
    struct problem problem;
    if (mkdir(upload->folder, 0700) != 0) {
        problem_set(&problem, PROBLEM_STORAGE, "", "", "no folder can be made for what is in the archive: %s",
                    strerror(errno));
        fail(fleet, upload, &problem);
        return;
    }
    (void)snprintf(limit, sizeof limit, "%llu",
                   (unsigned long long)(fleet->options.max_unpacked_bytes ? fleet->options.max_unpacked_bytes
                                                                          : default_max_unpacked_bytes));
    const char *words[] = {
        fleet->renderer_path, "--unpack", upload->archive, "--into", upload->folder, "--max-unpacked-bytes", limit, NULL
    };
    upload->state = UPLOAD_RUNNING;
    upload->stage = STAGE_UNPACKING;
    upload->process = fleet_next_number(fleet);
    if (!watch_start_with_progress(fleet->watch, upload->process, fleet_arguments(words), fleet->times.unpack)) {
        upload->process = 0;
        problem_set(&problem, PROBLEM_BUSY, "", "", "too much is waiting to be told to renderers");
        fail(fleet, upload, &problem);
    }
}

static void start_finding(struct fleet *fleet, struct upload *upload)
{
    struct problem problem;
    upload->stage = STAGE_FINDING;
    if (root_finder_find(fleet->root_finder, upload->number, upload->folder))
        return;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too many archives are being looked into");
    fail(fleet, upload, &problem);
}

static void start_scan(struct fleet *fleet, struct upload *upload)
{
    struct problem problem;
    upload->stage = STAGE_SCANNING;
    upload->process = fleet_next_number(fleet);
    char **arguments = fleet_arguments((const char *const[]){ fleet->renderer_path, "--scan", upload->root, NULL });
    if (watch_start_program(fleet->watch, upload->process, arguments, fleet->times.scan))
        return;
    upload->process = 0;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too much is waiting to be told to renderers");
    fail(fleet, upload, &problem);
}

/* Moves the root to a folder of its own in data/plans. Returns false with errno. */
static bool move_to_plans(struct fleet *fleet, struct upload *upload)
{
    for (int i = 1; i <= MAX_SAME_NAME; i++) {
        char id[PLAN_ID_SIZE];
        if (i == 1)
            (void)snprintf(id, sizeof id, "%s", upload->base_id);
        else
            (void)snprintf(id, sizeof id, "%.52s-%d", upload->base_id, i);
        if (plan_entry_find(fleet, id))
            continue;
        char *home = path_inside(fleet->plans_home, id);
        if (mkdir(home, 0700) == 0) { /* the name is ours now; rename may replace an empty folder */
            if (rename(upload->root, home) == 0) {
                free(upload->root);
                upload->root = home;
                return true;
            }
            int why = errno;
            (void)rmdir(home);
            errno = why;
        }
        free(home);
        if (errno != EEXIST)
            return false;
    }
    errno = EEXIST;
    return false;
}

static void adopt(struct fleet *fleet, struct upload *upload)
{
    struct problem problem;
    if (chmod(upload->root, 0700) == 0 && move_to_plans(fleet, upload)) {
        upload->stage = STAGE_LISTING;
        upload->list_until_us = fleet_now_us(fleet) + LIST_WITHIN_US;
        clean(fleet, upload);
        fleet_rescan(fleet);
        return;
    }
    problem_set(&problem, PROBLEM_STORAGE, "", "",
                "the plan cannot be moved to where the server keeps uploaded plans: %s", strerror(errno));
    fail(fleet, upload, &problem);
}

/* The listed plan that the upload became: its root, or for a collection a folder inside; NULL: not listed yet. */
static const struct plan_entry *find_plan(const struct fleet *fleet, const struct upload *upload)
{
    const struct plan_entry *made = plan_entry_in_folder(fleet, upload->root);
    size_t n = strlen(upload->root);
    for (size_t i = 0; i < fleet->n_plans && !made; i++) {
        const struct plan_entry *plan = fleet->plans[i];
        if (!plan->is_removed && strncmp(plan->folder, upload->root, n) == 0 && plan->folder[n] == '/')
            made = plan;
    }
    return made;
}

static void check_listed(struct fleet *fleet, struct upload *upload, int64_t now_us)
{
    const struct plan_entry *plan = find_plan(fleet, upload);
    struct problem problem;
    if (plan && (plan->wants_scan || plan->scan))
        return; /* "done" promises that the plan's parts are known */
    if (plan) {
        (void)snprintf(upload->plan_id, sizeof upload->plan_id, "%s", plan->id);
        upload->state = UPLOAD_DONE;
        upload->stage = STAGE_ENDED;
        log_info("upload %llu: plan %s: %llu files, %llu bytes in %lld ms", (unsigned long long)upload->number,
                 plan->id, (unsigned long long)upload->n_files, (unsigned long long)upload->n_bytes,
                 (long long)((now_us - upload->began_us) / 1000));
    } else if (fleet->is_listing) {
        return; /* the listing may take long: other plan folders may lie on slow disks */
    } else if (now_us > upload->list_until_us) {
        problem_set(&problem, PROBLEM_LIMIT, "", "", "the list of plans has no place for it: at most %d are listed",
                    FLEET_MAX_PLANS);
        (void)data_throw_away(fleet, upload->root);
        fail(fleet, upload, &problem);
    } else {
        fleet_rescan(fleet);
    }
}

/* ---- lines and ends of its processes ---------------------------------------------------------------------------- */

static uint64_t count_of(const cJSON *json, const char *name)
{
    double value = json_number(json, name, 0);
    return value >= 0 && value < 9e15 ? (uint64_t)value : 0;
}

static void progress_line(struct upload *upload, const char *text, size_t n)
{
    struct problem problem;
    cJSON *json = json_read(text, n, &problem);
    const cJSON *reported = cJSON_GetObjectItemCaseSensitive(json, "problem");
    double percent = json_number(json, "percent", NAN);
    if (percent >= upload->percent && percent <= 100)
        upload->percent = percent;
    if (reported) {
        (void)problem_from_json(reported, &upload->problem);
        upload->has_reported_end = true;
    } else if (json_flag(json, "done", false)) {
        upload->n_files = count_of(json, "n_files");
        upload->n_bytes = count_of(json, "n_bytes");
        upload->has_reported_end = true;
    }
    cJSON_Delete(json);
}

static void unpacking_ended(struct fleet *fleet, struct upload *upload, const struct watch_event *event)
{
    struct problem problem = upload->problem;
    if (event->is_exit && event->status == 0 && upload->has_reported_end && problem.type == PROBLEM_NONE) {
        start_finding(fleet, upload);
        return;
    }
    if (problem.type == PROBLEM_NONE && event->reason[0])
        problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "", "the program that unpacks %.180s", event->reason);
    else if (problem.type == PROBLEM_NONE && event->signal)
        problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "", "the program that unpacks stopped (signal %d)",
                    event->signal);
    else if (problem.type == PROBLEM_NONE)
        problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "",
                    "the program that unpacks ended with status %d and said nothing", event->status);
    fail(fleet, upload, &problem);
}

static void scan_ended(struct fleet *fleet, struct upload *upload, const struct watch_event *event)
{
    char reason[240] = "";
    cJSON *json = plan_scan_summary(event, reason);
    const char *given = json_text(json, "reason");
    if (json_flag(json, "readable", false)) {
        adopt(fleet, upload);
    } else {
        struct problem problem;
        problem_set(&problem, PROBLEM_PLAN_UNREADABLE, "", "", "%.250s",
                    given && given[0] ? given
                    : reason[0]       ? reason
                                      : "there is no plan in the archive");
        fail(fleet, upload, &problem);
    }
    cJSON_Delete(json);
}

bool uploads_event(struct fleet *fleet, const struct watch_event *event)
{
    struct upload *upload = fleet->uploads;
    while (upload && !(upload->process && upload->process == event->number))
        upload = upload->next;
    if (!upload)
        return false;
    if (event->type == WATCH_LINE) {
        if (upload->stage == STAGE_UNPACKING)
            progress_line(upload, event->output, event->n_output);
        return true;
    }
    upload->process = 0;
    switch (upload->stage) {
    case STAGE_UNPACKING: unpacking_ended(fleet, upload, event); break;
    case STAGE_SCANNING: scan_ended(fleet, upload, event); break;
    case STAGE_ENDED: clean(fleet, upload); break;
    case STAGE_WAITING:
    case STAGE_FINDING:
    case STAGE_LISTING: break;
    }
    return true;
}

static struct upload *find(const struct fleet *fleet, uint64_t number)
{
    struct upload *upload = fleet->uploads;
    while (upload && upload->number != number)
        upload = upload->next;
    return upload;
}

/* Scans the folders that the root finder has found, but those of uploads that were cancelled meanwhile. */
static void scan_found(struct fleet *fleet)
{
    uint64_t number;
    for (char *root; (root = root_finder_take(fleet->root_finder, &number));) {
        struct upload *upload = find(fleet, number);
        if (!upload || upload->stage != STAGE_FINDING) {
            free(root);
            continue;
        }
        upload->root = root;
        start_scan(fleet, upload);
    }
}

bool uploads_rest(const struct fleet *fleet)
{
    for (const struct upload *upload = fleet->uploads; upload; upload = upload->next)
        if (!has_ended(upload))
            return false;
    return true;
}

void uploads_tick(struct fleet *fleet)
{
    int64_t now_us = fleet_now_us(fleet);
    scan_found(fleet);
    for (;;) {
        struct upload *oldest = NULL; /* of those that wait */
        int n_unpacking = 0;
        for (struct upload *upload = fleet->uploads; upload; upload = upload->next) {
            n_unpacking += upload->stage >= STAGE_UNPACKING && upload->stage <= STAGE_SCANNING;
            if (upload->stage == STAGE_WAITING)
                oldest = upload; /* the list begins with the newest */
        }
        if (!oldest || n_unpacking >= FLEET_MAX_UNPACKING)
            break;
        start_unpacking(fleet, oldest);
    }
    for (struct upload *upload = fleet->uploads; upload; upload = upload->next)
        if (upload->stage == STAGE_LISTING)
            check_listed(fleet, upload, now_us);
}

/* ---- fleet.h ---------------------------------------------------------------------------------------------------- */

static void forget_old(struct fleet *fleet)
{
    size_t n = 0;
    for (struct upload **at = &fleet->uploads; *at;) {
        struct upload *upload = *at;
        if (++n > FLEET_KEPT_UPLOADS && has_ended(upload) && !upload->process) {
            *at = upload->next;
            upload_free(upload);
        } else {
            at = &upload->next;
        }
    }
}

/* The plan's id before numbering: "Head.tar.gz" gives "head"; without a name, the day. The archive's own file name is
 * not used: it is often a patient's name, and an id stands in addresses, lists and logs. */
static void make_base_id(const char *name, char id[PLAN_ID_SIZE])
{
    time_t now = time(NULL);
    struct tm day;
    if (!name[0] && gmtime_r(&now, &day) && strftime(id, PLAN_ID_SIZE, "upload-%Y-%m-%d", &day) > 0)
        return;
    static const char *const endings[] = { ".zip", ".tar.gz", ".tgz", ".tar", ".gz" };
    char bare[256];
    (void)snprintf(bare, sizeof bare, "%s", name);
    size_t n = strlen(bare);
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++) {
        size_t n_ending = strlen(endings[i]);
        if (n > n_ending && strcasecmp(bare + n - n_ending, endings[i]) == 0) {
            bare[n - n_ending] = 0;
            break;
        }
    }
    folder_make_id(bare, id);
}

uint64_t fleet_upload(struct fleet *fleet, const char *archive, const char *name, struct problem *problem)
{
    int n_going_on = 0;
    for (const struct upload *upload = fleet->uploads; upload; upload = upload->next)
        n_going_on += !has_ended(upload) || upload->process;
    if (n_going_on >= FLEET_MAX_UPLOADS) {
        (void)data_throw_away(fleet, archive);
        problem_set(problem, PROBLEM_LIMIT, "", "",
                    "%d archives are waiting to be unpacked already; at most so many may wait", FLEET_MAX_UPLOADS);
        problem->retry_after_ms = 10000;
        return 0;
    }
    forget_old(fleet);
    struct upload *upload = mem_new(sizeof *upload);
    upload->number = fleet_next_number(fleet);
    upload->archive = mem_copy_text(archive);
    size_t n = strlen(archive), n_ending = strlen(".part");
    upload->folder = mem_new(n + n_ending);
    bool is_part = n > n_ending && strcmp(archive + n - n_ending, ".part") == 0;
    (void)snprintf(upload->folder, n + n_ending, "%.*s%s", (int)(is_part ? n - n_ending : n), archive,
                   is_part ? "" : ".out");
    make_base_id(name, upload->base_id);
    upload->began_us = fleet_now_us(fleet);
    upload->next = fleet->uploads;
    fleet->uploads = upload;
    uploads_tick(fleet);
    return upload->number;
}

bool fleet_upload_find(const struct fleet *fleet, uint64_t number, struct fleet_upload *out)
{
    static const char *const phases[] = { "waiting for its turn", "unpacking",     "looking at it",
                                          "looking at it",        "looking at it", "" };
    const struct upload *upload = find(fleet, number);
    if (!upload)
        return false;
    *out = (struct fleet_upload){ .state = upload->state,
                                  .phase = phases[upload->stage],
                                  .percent = upload->state == UPLOAD_DONE ? 100 : upload->percent,
                                  .plan_id = upload->state == UPLOAD_DONE ? upload->plan_id : NULL,
                                  .problem = upload->state == UPLOAD_FAILED ? &upload->problem : NULL };
    return true;
}

void fleet_upload_cancel(struct fleet *fleet, uint64_t number)
{
    struct upload *upload = find(fleet, number);
    if (!upload || has_ended(upload))
        return;
    if (upload->stage == STAGE_LISTING && !data_throw_away(fleet, upload->root))
        log_warn("upload %llu: its plan cannot be removed: %s", (unsigned long long)number, strerror(errno));
    if (upload->stage == STAGE_LISTING)
        fleet_rescan(fleet);
    log_info("upload %llu: cancelled", (unsigned long long)number);
    end(fleet, upload, UPLOAD_CANCELLED);
}

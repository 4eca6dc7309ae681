/* Three threads of one plan: the first loads it and then answers slow questions, the second answers quick questions,
 * the third builds the shapes that requests wait for. */
#include "server/renderer/loader.h"

#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "core/derive/shapes.h"
#include "core/load/load.h"
#include "core/load/part_names.h"
#include "core/render/visible/visible.h"
#include "server/renderer/answers.h"
#include "server/renderer/digest.h"

enum {
    PROGRESS_EVERY_US = 50000,
    BUILD_AHEAD_US = 300000,  /* after that a first picture is drawn, whatever is built */
    WORTH_KEEPING_US = 50000, /* the default of loader_options.worth_keeping_us */
    MAX_QUESTIONS = 256,
    MAX_WAITING_REQUESTS = 2 * PIPELINE_MAX_WAITING
};

struct loader {
    char *folder, *plan_id, *cache_folder;
    uint64_t max_bytes;
    bool hides_folder;
    struct packet_statement *statement; /* NULL: none */
    int64_t worth_keeping_us;
    struct inbox *inbox;
    atomic_bool cancel;
    pthread_t load_thread, quick_thread, shapes_thread;
    struct queue *slow, *quick;     /* questions about shapes, for the load thread; about points, for the quick one */
    struct queue *waiting_requests; /* for the shapes thread */
    const struct plan *plan;        /* the load thread's; the quick one gets it with its first question */
    struct derive *derived;         /* of the plan */
    int64_t reported_us;
};

static void drop_question(void *item)
{
    question_destroy(item);
}

static void report_progress(struct loader *loader, const char *phase, double percent)
{
    int64_t now_us = clock_now_us();
    if (now_us - loader->reported_us < PROGRESS_EVERY_US)
        return;
    loader->reported_us = now_us;
    struct inbox_event event = { .type = INBOX_PROGRESS, .percent = percent };
    (void)snprintf(event.phase, sizeof event.phase, "%s", phase);
    inbox_offer(loader->inbox, &event);
}

static void loading_progressed(void *context, const char *phase, double percent)
{
    report_progress(context, phase, percent * 0.9); /* the last tenth is for building surfaces */
}

static void answer(struct loader *loader, struct question *question)
{
    struct inbox_event event = { .type = INBOX_ANSWER, .id = packet_id(&question->packet) };
    size_t n_refused = mem_n_refused(); /* of this thread: the one that writes the answer does not see it */
    event.body = answer_question(question, loader->derived, &event.problem);
    if (mem_n_refused() != n_refused && (event.body || event.problem.type == PROBLEM_NONE)) {
        cJSON_Delete(event.body);
        event.body = NULL;
        (void)problem_set(&event.problem, PROBLEM_MEMORY, "", "", "no memory for the answer");
    }
    if (event.body) {
        event.blob = question->file;
        event.n_blob = question->n_file;
        question->file = NULL;
    }
    inbox_put(loader->inbox, &event);
    question_destroy(question);
}

/* The regions that a new room shows as surfaces, in file order, and the algorithm of these. Returns how many. Other
 * shapes are built on demand. */
static size_t visible_regions(const struct plan *plan, struct subject *subjects, enum surface_algorithm *algorithm)
{
    struct scene scene;
    size_t n = 0;
    scene_for_plan(plan, &scene);
    for (size_t i = 0; i < scene.n_regions; i++) {
        const struct region *region = region_find(&plan->regions, scene.regions[i].id);
        const struct scene_region_style *style = &scene.regions[i].value;
        if (region && region->n_voxels > 0 && style->visible && style->opacity > 0 &&
            style->representation == SCENE_REPRESENTATION_SURFACE)
            subjects[n++] = subject_region((size_t)(region - plan->regions.regions));
    }
    *algorithm = visible_surface_key(&(struct snapshot){ .scene = scene }).algorithm;
    scene_finish(&scene);
    return n;
}

struct building {
    struct loader *loader;
    int64_t began_us;
    size_t n, n_begun; /* surfaces */
    bool is_reported;  /* BUILT was sent: a first picture may be drawn */
};

/* Called before each surface. After BUILT, questions are answered before the next surface is built. */
static bool before_surface(void *context)
{
    struct building *building = context;
    struct loader *loader = building->loader;
    if (!building->is_reported && clock_now_us() - building->began_us > BUILD_AHEAD_US) {
        inbox_put(loader->inbox, &(struct inbox_event){ .type = INBOX_BUILT });
        building->is_reported = true;
    }
    for (struct question *question; building->is_reported && (question = queue_try_take(loader->slow));)
        answer(loader, question);
    if (!building->is_reported)
        report_progress(loader, "building surfaces", 90 + 10.0 * (double)building->n_begun++ / (double)building->n);
    return !atomic_load(&loader->cancel);
}

/* Coarse surfaces first: pictures that move need them. */
static void build_ahead(struct loader *loader)
{
    struct subject *subjects = mem_new((loader->plan->regions.n_regions + 1) * sizeof *subjects);
    enum surface_algorithm algorithm;
    size_t n = visible_regions(loader->plan, subjects, &algorithm);
    struct building building = { loader, clock_now_us(), 2 * n + 1, 0, false };
    derive_build_surfaces(loader->derived, subjects, n, algorithm, SURFACE_COARSE, before_surface, &building);
    derive_build_surfaces(loader->derived, subjects, n, algorithm, SURFACE_FULL, before_surface, &building);
    if (!building.is_reported)
        inbox_put(loader->inbox, &(struct inbox_event){ .type = INBOX_BUILT });
    free(subjects);
}

/* Stores a plan that took long to open in the cache, as its files are: before a person's statement. A failure only
 * means that the next opening reads the folder. */
static void store_in_cache(const struct loader *loader, const struct plan *plan, const struct plan_sources *sources)
{
    struct error err = { 0 };
    if (!loader->cache_folder || plan->load_us < loader->worth_keeping_us || atomic_load(&loader->cancel))
        return;
    if (!plan_cache_store(plan, sources, loader->cache_folder, &err))
        log_warn("the opened plan is not kept: %s", err.text);
}

/* Folders may be called after patients. */
static void hide_folder(struct plan *plan, const char *folder, const char *id)
{
    char name[sizeof plan->name];
    plan_folder_name(folder, name, sizeof name);
    if (strcmp(plan->name, name) == 0)
        (void)snprintf(plan->name, sizeof plan->name, "%s", id);
}

static bool read_again(void *context, double percent)
{
    (void)percent;
    struct loader *loader = context;
    report_progress(loader, "reading the files again", 90);
    return !atomic_load(&loader->cancel);
}

/* Whether the files are those that the statement was made of. Their times and sizes say that, else they are read a
 * second time, after the plan: files that change meanwhile are not those. Also the patients are those that its author
 * had before them: files that had changed by then were not. */
static enum statement_files compare_files(struct loader *loader, const char *seen)
{
    const struct packet_statement *said = loader->statement;
    if (said->withdrawn || strcmp(said->patients, seen) != 0)
        return STATEMENT_OTHER_FILES;
    cJSON *digest =
        digest_folder(loader->folder, said->key[0] ? said->key : NULL, &(struct digest_watch){ read_again, loader });
    const char *revision = json_text(digest, "revision"), *key = json_text(digest, "key"),
               *reason = json_text(digest, "reason");
    const bool is_same = revision ? strcmp(revision, said->revision) == 0 : key && strcmp(key, said->key) == 0;
    if (!key)
        log_warn("the files were not read again for a statement: %s", reason ? reason : "no memory");
    cJSON_Delete(digest);
    return !key ? STATEMENT_FILES_UNREAD : is_same ? STATEMENT_SAME_FILES : STATEMENT_OTHER_FILES;
}

static void apply_statement(struct loader *loader, struct plan *plan, const char *seen)
{
    const struct packet_statement *said = loader->statement;
    struct plan_statement statement = { .kind = said->one_person ? STATEMENT_ONE_PERSON : STATEMENT_IDENTITY,
                                        .time_ms = said->time_ms };
    mem_put_text(statement.by, sizeof statement.by, said->by);
    mem_put_text(statement.words, sizeof statement.words, said->words);
    mem_put_text(statement.patient.name, sizeof statement.patient.name, said->name);
    mem_put_text(statement.patient.id, sizeof statement.patient.id, said->patient_id);
    mem_put_text(statement.patient.birth_date, sizeof statement.patient.birth_date, said->birth_date);
    plan_state(plan, &statement, compare_files(loader, seen));
}

static void *load_main(void *argument)
{
    struct loader *loader = argument;
    struct inbox_event event = { .type = INBOX_LOADED };
    struct plan_sources *sources = NULL;
    struct plan_load_options options = { .progress = { loading_progressed, loader, &loader->cancel },
                                         .max_bytes = loader->max_bytes,
                                         .cache_folder = loader->cache_folder,
                                         .sources = &sources };
    struct plan *plan = plan_load(loader->folder, loader->plan_id, &options, &event.error);
    if (plan && loader->hides_folder)
        hide_folder(plan, loader->folder, loader->plan_id);
    if (plan)
        patients_seen(plan->patients, plan->n_patients, event.seen);
    if (plan && loader->statement) {
        store_in_cache(loader, plan, sources);
        apply_statement(loader, plan, event.seen);
    }
    loader->plan = event.plan = plan;
    if (plan)
        loader->derived = event.derived = derive_create(plan);
    else
        event.type = INBOX_LOAD_FAILED;
    inbox_put(loader->inbox, &event);
    if (plan) {
        build_ahead(loader);
        if (!loader->statement)
            store_in_cache(loader, plan, sources);
    }
    plan_sources_destroy(sources);
    if (!plan)
        return NULL;
    for (struct question *question; (question = queue_take(loader->slow, -1));) {
        if (atomic_load(&loader->cancel))
            question_destroy(question);
        else
            answer(loader, question);
    }
    return NULL;
}

static void *quick_main(void *argument)
{
    struct loader *loader = argument;
    for (struct question *question; (question = queue_take(loader->quick, -1));) {
        if (atomic_load(&loader->cancel))
            question_destroy(question);
        else
            answer(loader, question); /* the plan is set before LOADED is sent, and questions come later */
    }
    return NULL;
}

static void *shapes_main(void *argument)
{
    struct loader *loader = argument;
    for (struct waiting_request *waiting; (waiting = queue_take(loader->waiting_requests, -1));) {
        if (atomic_load(&loader->cancel)) {
            waiting_request_destroy(waiting);
            continue;
        }
        waiting_request_build_shapes(waiting, &loader->cancel);
        inbox_put(loader->inbox, &(struct inbox_event){ .type = INBOX_SHAPES_BUILT, .waiting = waiting });
    }
    return NULL;
}

static void drop_waiting(void *item)
{
    waiting_request_destroy(item);
}

static void stop(struct loader *loader, int n_started)
{
    const pthread_t threads[] = { loader->load_thread, loader->quick_thread, loader->shapes_thread };
    atomic_store(&loader->cancel, true);
    queue_close(loader->slow);
    queue_close(loader->quick);
    queue_close(loader->waiting_requests);
    for (int i = 0; i < n_started; i++)
        pthread_join(threads[i], NULL);
    queue_destroy(loader->slow);
    queue_destroy(loader->quick);
    queue_destroy(loader->waiting_requests);
    free(loader->folder);
    free(loader->plan_id);
    free(loader->cache_folder);
    free(loader->statement);
    free(loader);
}

struct loader *loader_create(const struct loader_options *options, struct inbox *inbox, struct error *err)
{
    struct loader *loader = mem_new(sizeof *loader);
    loader->folder = mem_copy_text(options->folder);
    loader->plan_id = mem_copy_text(options->plan_id);
    loader->max_bytes = options->max_bytes;
    loader->hides_folder = options->hides_folder;
    loader->cache_folder = options->cache_folder ? mem_copy_text(options->cache_folder) : NULL;
    loader->worth_keeping_us = options->worth_keeping_us ? options->worth_keeping_us : WORTH_KEEPING_US;
    if (options->statement) {
        loader->statement = mem_new(sizeof *loader->statement);
        *loader->statement = *options->statement;
    }
    loader->inbox = inbox;
    atomic_init(&loader->cancel, false);
    loader->slow = queue_create(MAX_QUESTIONS, drop_question);
    loader->quick = queue_create(MAX_QUESTIONS, drop_question);
    loader->waiting_requests = queue_create(MAX_WAITING_REQUESTS, drop_waiting);
    int n_started = 0, failed = pthread_create(&loader->load_thread, NULL, load_main, loader);
    if (!failed && ++n_started)
        failed = pthread_create(&loader->quick_thread, NULL, quick_main, loader);
    if (!failed && ++n_started)
        failed = pthread_create(&loader->shapes_thread, NULL, shapes_main, loader);
    if (!failed)
        return loader;
    error_set(err, ERROR_IO, "a thread cannot be started: %s", strerror(failed));
    stop(loader, n_started);
    return NULL;
}

bool loader_build_shapes(struct loader *loader, struct waiting_request *waiting)
{
    return queue_try_put(loader->waiting_requests, waiting);
}

bool loader_answer(struct loader *loader, struct question *question)
{
    if (queue_try_put(question_is_slow(question) ? loader->slow : loader->quick, question))
        return true;
    question_destroy(question);
    return false;
}

void loader_destroy(struct loader *loader)
{
    if (loader)
        stop(loader, 3);
}

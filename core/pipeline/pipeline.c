#include "core/pipeline/pipeline.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/pipeline/turns.h"

/* Small pictures are compressed by one thread and large ones by another, so that a large one, which takes ten times as
 * long, holds up none. PNG takes as long as a large JPEG. */
enum { LANE_SMALL, LANE_LARGE, N_LANES, SMALL_MAX_PX = 2500000 };
/* Drawn pictures of a lane that may wait for its thread: one being compressed, one ready; more would only add delay. */
enum { MAX_DRAWN = 2 };
/* A picture that is being drawn is left for another after so long: for a moving one, which somebody waits for with a
 * hand on the mouse, or for a still, which can wait longer. */
enum { SLICE_MOVING_US = 20000, SLICE_STILL_US = 100000 };
/* Stacks count to a process's memory in full. */
enum { ENCODE_STACK_BYTES = 512 << 10 };
/* Plans to forget that may wait beside the pictures. */
enum { MAX_FORGET = 16, MAX_BEGUN = 32, MAX_JOBS = PIPELINE_MAX_WAITING + MAX_BEGUN + MAX_FORGET };

/* What travels down the pipeline: a request to draw, or a plan to forget. */
struct job {
    struct pipeline_request request;
    const struct plan *forget; /* not NULL: no request */
    struct turns_item turn;
    struct render_picture *picture; /* begun */
    struct image *image;
    struct pipeline_frame frame;
    bool is_counted; /* among those begun, with its image's memory */
    bool is_dropped;
    bool needs_all; /* there was no memory for it beside others */
};

struct lane {
    struct pipeline *pipeline;
    pthread_t thread;
    struct job *drawn[MAX_DRAWN];
    size_t n_drawn;
};

struct pipeline {
    struct pipeline_callbacks callbacks;
    enum render_back_end back_end;
    bool is_stub;
    struct turns *turns;
    pthread_t render_thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    /* all of the rest is guarded by mutex, but for the atomic ones */
    struct job *jobs[MAX_JOBS]; /* not drawn yet, oldest first */
    size_t n_jobs, n_requests, n_begun;
    struct job *current; /* of jobs: being drawn on, since */
    int64_t current_us;
    struct lane lanes[N_LANES];
    uint64_t n_image_bytes; /* of pictures begun and not delivered */
    uint64_t n_asked_to_forget, n_forgotten;
    bool is_stopping, is_drained; /* is_drained: nothing more comes to the lanes */
    atomic_llong leave_at_us;     /* the picture being drawn is left from then on */
};

static void job_destroy(struct job *job)
{
    if (!job)
        return;
    snapshot_unref(job->request.snapshot);
    image_destroy(job->image);
    free(job->frame.picture.bytes);
    free(job);
}

/* ---- which picture is next; under the mutex --------------------------------------------------------------------- */

static struct lane *lane_of(struct pipeline *pipeline, const struct job *job)
{
    const struct render_options *options = &job->request.render;
    bool is_large =
        job->request.encode.codec == ENCODE_PNG || (int64_t)options->width_px * options->height_px > SMALL_MAX_PX;
    return &pipeline->lanes[is_large ? LANE_LARGE : LANE_SMALL];
}

static uint64_t image_bytes(const struct job *job)
{
    const struct render_options *options = &job->request.render;
    return options->width_px > 0 && options->height_px > 0
               ? (uint64_t)options->width_px * (uint64_t)options->height_px * 4
               : 0;
}

static void remove_job(struct pipeline *pipeline, size_t at)
{
    pipeline->n_requests -= !pipeline->jobs[at]->forget;
    pipeline->n_jobs--;
    memmove(pipeline->jobs + at, pipeline->jobs + at + 1, (pipeline->n_jobs - at) * sizeof pipeline->jobs[0]);
}

/* Pictures are held while their lane is full, while there is no memory for them, and while one that needs all of it
 * waits for the others. */
static bool is_held(struct pipeline *pipeline, const struct job *job, bool somebody_needs_all)
{
    if (lane_of(pipeline, job)->n_drawn >= MAX_DRAWN)
        return true;
    if (job->turn.is_begun)
        return false;
    if (pipeline->n_image_bytes > 0 &&
        (somebody_needs_all || pipeline->n_image_bytes + image_bytes(job) > PIPELINE_MAX_IMAGE_BYTES))
        return true;
    return pipeline->n_begun >= MAX_BEGUN || (somebody_needs_all && !job->needs_all);
}

/* What stands behind a plan to forget stays behind it. SIZE_MAX: nothing can be done now. */
static size_t choose(struct pipeline *pipeline)
{
    struct turns_item *items[MAX_JOBS];
    size_t n = 0;
    bool somebody_needs_all = false;
    if (pipeline->n_jobs > 0 && pipeline->jobs[0]->forget)
        return 0;
    for (; n < pipeline->n_jobs && !pipeline->jobs[n]->forget; n++)
        somebody_needs_all = somebody_needs_all || (pipeline->jobs[n]->needs_all && !pipeline->jobs[n]->turn.is_begun);
    for (size_t i = 0; i < n; i++) {
        items[i] = &pipeline->jobs[i]->turn;
        items[i]->is_held = is_held(pipeline, pipeline->jobs[i], somebody_needs_all);
    }
    return turns_choose(pipeline->turns, items, n);
}

/* When the picture that is being drawn is to be left for another that waits. */
static int64_t leave_for_us(const struct pipeline *pipeline, const struct job *other)
{
    if (other == pipeline->current || other->turn.is_held ||
        !turns_may_interrupt(&pipeline->current->turn, &other->turn))
        return INT64_MAX;
    return pipeline->current_us + (other->turn.is_still ? SLICE_STILL_US : SLICE_MOVING_US);
}

static void start_slice(struct pipeline *pipeline, struct job *job)
{
    int64_t least_us = INT64_MAX;
    if (!job->is_counted) {
        job->is_counted = true;
        pipeline->n_begun++;
        pipeline->n_image_bytes += image_bytes(job);
    }
    pipeline->current = job;
    pipeline->current_us = clock_now_us();
    for (size_t i = 0; i < pipeline->n_jobs && !pipeline->jobs[i]->forget; i++) {
        int64_t at_us = leave_for_us(pipeline, pipeline->jobs[i]);
        least_us = at_us < least_us ? at_us : least_us;
    }
    atomic_store(&pipeline->leave_at_us, least_us);
}

static void forget_image(struct pipeline *pipeline, struct job *job)
{
    if (job->is_counted)
        pipeline->n_image_bytes -= image_bytes(job);
    job->is_counted = false;
}

/* ---- the render thread ------------------------------------------------------------------------------------------ */

static struct image *draw_stub(const struct job *job, struct camera *camera, struct error *err)
{
    struct image *image = image_create(job->request.render.width_px, job->request.render.height_px, err);
    camera_resolve(job->request.snapshot, camera);
    if (image)
        for (size_t i = 0, n = (size_t)image->width_px * (size_t)image->height_px * 4; i < n; i++)
            image->rgba[i] = i % 4 == 3 ? 255 : 128;
    return image;
}

static bool pause_is_due(void *context)
{
    const struct pipeline *pipeline = context;
    long long at_us = atomic_load(&pipeline->leave_at_us);
    return at_us != INT64_MAX && clock_now_us() >= at_us;
}

/* Returns false when there is more to draw. */
static bool draw(struct pipeline *pipeline, struct renderer *renderer, const struct error *why_none, struct job *job)
{
    struct pipeline_frame *frame = &job->frame;
    const struct render_options *options = &job->request.render;
    frame->id = job->request.id;
    frame->is_still = options->is_still;
    frame->width_px = options->width_px;
    frame->height_px = options->height_px;
    if (pipeline->is_stub || !renderer) {
        if (pipeline->is_stub)
            job->image = draw_stub(job, &frame->camera, &frame->error);
        else
            frame->error = *why_none;
        return true;
    }
    const struct render_pause pause = { pause_is_due, pipeline };
    if (!job->picture)
        job->picture = render_begin(renderer, job->request.snapshot, options);
    if (render_go_on(job->picture, &pause, &frame->error) == RENDER_PAUSED)
        return false;
    if (frame->error.code == ERROR_MEMORY)
        error_prefix(&frame->error, "a picture of %d x %d pixels", options->width_px, options->height_px);
    job->image = render_end(job->picture, &frame->camera, &frame->timing);
    job->picture = NULL;
    return true;
}

/* Ends a picture that is not wanted any more, or that is to be begun anew. */
static void give_up(struct job *job)
{
    if (job->picture)
        image_destroy(render_end(job->picture, &job->frame.camera, &job->frame.timing));
    job->picture = NULL;
}

/* Under the mutex. */
static void remove_dropped(struct pipeline *pipeline)
{
    for (size_t i = 0; i < pipeline->n_jobs;) {
        struct job *job = pipeline->jobs[i];
        if (!job->is_dropped) {
            i++;
            continue;
        }
        give_up(job);
        pipeline->n_begun -= job->is_counted;
        forget_image(pipeline, job);
        remove_job(pipeline, i);
        job_destroy(job);
    }
}

/* Under the mutex. Without memory for it beside others, a picture is tried once more when they are done. */
static void pass_on(struct pipeline *pipeline, struct job *job)
{
    size_t at = 0;
    bool has_others = pipeline->n_image_bytes > image_bytes(job);
    pipeline->n_begun--;
    if (job->frame.error.code == ERROR_MEMORY && has_others && !job->needs_all) {
        forget_image(pipeline, job);
        job->needs_all = true;
        job->turn.is_begun = false;
        job->frame.error = (struct error){ 0 };
        return;
    }
    while (pipeline->jobs[at] != job)
        at++;
    remove_job(pipeline, at);
    struct lane *lane = lane_of(pipeline, job);
    lane->drawn[lane->n_drawn++] = job; /* it has room: else the picture was held */
    pthread_cond_broadcast(&pipeline->changed);
}

/* Under the mutex, which it leaves. */
static void draw_slice(struct pipeline *pipeline, struct renderer *renderer, const struct error *why_none,
                       struct job *job)
{
    start_slice(pipeline, job);
    pthread_mutex_unlock(&pipeline->mutex);
    bool is_done = draw(pipeline, renderer, why_none, job);
    pthread_mutex_lock(&pipeline->mutex);
    turns_charge(pipeline->turns, job->turn.source, clock_now_us() - pipeline->current_us);
    pipeline->current = NULL;
    if (is_done)
        pass_on(pipeline, job);
}

/* Under the mutex, which it leaves. No picture is begun then: what came before is drawn, what came later waits. */
static void forget(struct pipeline *pipeline, struct renderer *renderer)
{
    struct job *job = pipeline->jobs[0];
    remove_job(pipeline, 0);
    pthread_mutex_unlock(&pipeline->mutex);
    if (renderer)
        renderer_forget(renderer, job->forget);
    job_destroy(job);
    pthread_mutex_lock(&pipeline->mutex);
    pipeline->n_forgotten++;
    pthread_cond_broadcast(&pipeline->changed);
}

static struct renderer *start_renderer(struct pipeline *pipeline, struct error *err)
{
    static const struct render_facts stub_facts = {
        .back_end = RENDER_AUTO, .vendor = "Beamroom", .renderer = "stub", .version = "none", .is_software = true
    };
    struct renderer *renderer = pipeline->is_stub ? NULL : renderer_create(pipeline->back_end, err);
    const struct render_facts *facts = pipeline->is_stub ? &stub_facts : renderer ? renderer_facts(renderer) : NULL;
    pipeline->callbacks.started(pipeline->callbacks.context, facts, err);
    return renderer;
}

static void *render_main(void *argument)
{
    struct pipeline *pipeline = argument;
    struct error err = { 0 };
    struct renderer *renderer = start_renderer(pipeline, &err);
    pthread_mutex_lock(&pipeline->mutex);
    while (!pipeline->is_stopping) {
        remove_dropped(pipeline);
        size_t at = choose(pipeline);
        if (at == SIZE_MAX)
            pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
        else if (pipeline->jobs[at]->forget)
            forget(pipeline, renderer);
        else
            draw_slice(pipeline, renderer, &err, pipeline->jobs[at]);
    }
    for (size_t i = 0; i < pipeline->n_jobs; i++) {
        give_up(pipeline->jobs[i]);
        job_destroy(pipeline->jobs[i]);
    }
    pipeline->n_jobs = 0;
    pipeline->is_drained = true;
    pthread_cond_broadcast(&pipeline->changed);
    pthread_mutex_unlock(&pipeline->mutex);
    renderer_destroy(renderer);
    return NULL;
}

/* ---- the encode threads ----------------------------------------------------------------------------------------- */

/* NULL: nothing more comes. */
static struct job *take_drawn(struct lane *lane, bool *is_wanted)
{
    struct pipeline *pipeline = lane->pipeline;
    struct job *job = NULL;
    pthread_mutex_lock(&pipeline->mutex);
    while (lane->n_drawn == 0 && !pipeline->is_drained)
        pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
    if (lane->n_drawn > 0) {
        job = lane->drawn[0];
        lane->n_drawn--;
        memmove(lane->drawn, lane->drawn + 1, lane->n_drawn * sizeof lane->drawn[0]);
        pthread_cond_broadcast(&pipeline->changed);
    }
    *is_wanted = !pipeline->is_stopping;
    pthread_mutex_unlock(&pipeline->mutex);
    return job;
}

static void deliver(struct pipeline *pipeline, struct encoder *encoder, struct job *job)
{
    struct pipeline_frame *frame = &job->frame;
    if (job->image) {
        int64_t start_us = clock_now_us();
        (void)!encode_image(encoder, job->image, &job->request.encode, &frame->picture, &frame->error);
        frame->encode_us = clock_now_us() - start_us;
    }
    image_destroy(job->image);
    job->image = NULL;
    pthread_mutex_lock(&pipeline->mutex);
    turns_charge(pipeline->turns, job->turn.source, frame->encode_us);
    forget_image(pipeline, job);
    pthread_cond_broadcast(&pipeline->changed);
    bool is_wanted = !pipeline->is_stopping;
    pthread_mutex_unlock(&pipeline->mutex);
    if (!is_wanted)
        return;
    pipeline->callbacks.deliver(pipeline->callbacks.context, frame);
    frame->picture = (struct encoded){ 0 }; /* the receiver's now */
}

static void *encode_main(void *argument)
{
    struct lane *lane = argument;
    struct encoder *encoder = encoder_create();
    bool is_wanted;
    for (struct job *job; (job = take_drawn(lane, &is_wanted));) {
        if (is_wanted)
            deliver(lane->pipeline, encoder, job);
        job_destroy(job);
    }
    encoder_destroy(encoder);
    return NULL;
}

/* ---- from outside ----------------------------------------------------------------------------------------------- */

static void stop(struct pipeline *pipeline, int n_lanes, bool has_render_thread)
{
    pthread_mutex_lock(&pipeline->mutex);
    pipeline->is_stopping = true;
    pipeline->is_drained = !has_render_thread;
    atomic_store(&pipeline->leave_at_us, 0);
    pthread_cond_broadcast(&pipeline->changed);
    pthread_mutex_unlock(&pipeline->mutex);
    if (has_render_thread)
        pthread_join(pipeline->render_thread, NULL);
    for (int i = 0; i < n_lanes; i++)
        pthread_join(pipeline->lanes[i].thread, NULL);
    turns_destroy(pipeline->turns);
    pthread_cond_destroy(&pipeline->changed);
    pthread_mutex_destroy(&pipeline->mutex);
    free(pipeline);
}

struct pipeline *pipeline_create(enum render_back_end back_end, bool stub, const struct pipeline_callbacks *callbacks,
                                 struct error *err)
{
    struct pipeline *pipeline = mem_new(sizeof *pipeline);
    pipeline->callbacks = *callbacks;
    pipeline->back_end = back_end;
    pipeline->is_stub = stub;
    pipeline->turns = turns_create();
    atomic_init(&pipeline->leave_at_us, INT64_MAX);
    pthread_mutex_init(&pipeline->mutex, NULL);
    pthread_cond_init(&pipeline->changed, NULL);
    int failed = 0, n_lanes = 0;
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, ENCODE_STACK_BYTES);
    for (; n_lanes < N_LANES && !failed; n_lanes += !failed) {
        pipeline->lanes[n_lanes].pipeline = pipeline;
        failed = pthread_create(&pipeline->lanes[n_lanes].thread, &small, encode_main, &pipeline->lanes[n_lanes]);
    }
    pthread_attr_destroy(&small);
    if (!failed)
        failed = pthread_create(&pipeline->render_thread, NULL, render_main, pipeline);
    if (!failed)
        return pipeline;
    error_set(err, ERROR_MEMORY, "cannot start a thread for drawing: %s", strerror(failed));
    stop(pipeline, n_lanes, false);
    return NULL;
}

bool pipeline_submit(struct pipeline *pipeline, const struct pipeline_request *request, struct error *err)
{
    struct job *job = mem_new(sizeof *job);
    job->request = *request;
    job->turn = (struct turns_item){ .source = request->source, .is_still = request->render.is_still };
    pthread_mutex_lock(&pipeline->mutex);
    bool fits = !pipeline->is_stopping && pipeline->n_requests - pipeline->n_begun < PIPELINE_MAX_WAITING;
    if (fits) {
        pipeline->jobs[pipeline->n_jobs++] = job;
        pipeline->n_requests++;
        job->turn.is_held = is_held(pipeline, job, false);
        int64_t leave_us = pipeline->current ? leave_for_us(pipeline, job) : INT64_MAX;
        if (leave_us < atomic_load(&pipeline->leave_at_us))
            atomic_store(&pipeline->leave_at_us, leave_us);
        pthread_cond_broadcast(&pipeline->changed);
    }
    pthread_mutex_unlock(&pipeline->mutex);
    if (fits)
        return true;
    job_destroy(job);
    return error_set(err, ERROR_LIMIT, "%d pictures are waiting to be drawn already", PIPELINE_MAX_WAITING);
}

void pipeline_drop(struct pipeline *pipeline, uint64_t id)
{
    pthread_mutex_lock(&pipeline->mutex);
    for (size_t i = 0; i < pipeline->n_jobs; i++) {
        struct job *job = pipeline->jobs[i];
        if (job->forget || job->request.id != id)
            continue;
        job->is_dropped = true;
        if (job == pipeline->current)
            atomic_store(&pipeline->leave_at_us, 0);
    }
    pthread_cond_broadcast(&pipeline->changed);
    pthread_mutex_unlock(&pipeline->mutex);
}

void pipeline_forget(struct pipeline *pipeline, const struct plan *plan)
{
    struct job *job = mem_new(sizeof *job);
    job->forget = plan;
    pthread_mutex_lock(&pipeline->mutex);
    while (pipeline->n_jobs - pipeline->n_requests >= MAX_FORGET) /* of other callers: let the render thread go on */
        pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
    pipeline->jobs[pipeline->n_jobs++] = job;
    pthread_cond_broadcast(&pipeline->changed);
    uint64_t turn = ++pipeline->n_asked_to_forget;
    while (pipeline->n_forgotten < turn)
        pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
    pthread_mutex_unlock(&pipeline->mutex);
}

void pipeline_destroy(struct pipeline *pipeline)
{
    if (pipeline)
        stop(pipeline, N_LANES, true);
}

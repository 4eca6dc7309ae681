#include "core/pipeline/pipeline.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/queue.h"

/* Drawn pictures that may wait for the encoder: one being compressed, one ready; more would only add delay. */
enum { MAX_DRAWN = 2 };

/* Stills take ten times as long as moving pictures, and somebody drags the mouse while they wait: moving pictures go first, but a still
 * lets at most this many overtake it. */
enum { MAX_OVERTAKING = 8 };

/* What travels down the pipeline: a request to draw, or a plan to forget. */
struct job {
    struct pipeline_request request;
    const struct plan *forget; /* not NULL: no request */
    struct image *image;
    struct pipeline_frame frame;
    int n_overtaken; /* still: moving pictures drawn before it although they came later */
};

struct pipeline {
    struct pipeline_callbacks callbacks;
    enum render_back_end back_end;
    bool is_stub;
    struct queue *waiting, *drawn;
    pthread_t render_thread, encode_thread;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    size_t n_waiting;  /* requests not yet taken by the render thread; guarded by mutex */
    size_t n_drawn;    /* pictures not yet taken by the encoder; guarded by mutex */
    uint64_t n_asked_to_forget, n_forgotten; /* guarded by mutex */
    uint64_t dropped[PIPELINE_MAX_WAITING]; /* newest ids that are not to be drawn, a ring; guarded by mutex */
    size_t n_dropped;                       /* ever; guarded by mutex */
    bool is_stopping;  /* guarded by mutex */
};

static void job_destroy(void *item)
{
    struct job *job = item;
    if (!job)
        return;
    snapshot_unref(job->request.snapshot);
    image_destroy(job->image);
    free(job->frame.picture.bytes);
    free(job);
}

static bool is_stopping(struct pipeline *pipeline)
{
    pthread_mutex_lock(&pipeline->mutex);
    bool stopping = pipeline->is_stopping;
    pthread_mutex_unlock(&pipeline->mutex);
    return stopping;
}

/* ---- the render thread ------------------------------------------------------------------------------------------------ */

static struct image *draw_stub(const struct job *job, struct camera *camera, struct error *err)
{
    struct image *image = image_create(job->request.render.width_px, job->request.render.height_px, err);
    camera_resolve(job->request.snapshot, camera);
    if (image)
        for (size_t i = 0, n = (size_t)image->width_px * (size_t)image->height_px * 4; i < n; i++)
            image->rgba[i] = i % 4 == 3 ? 255 : 128;
    return image;
}

static void draw(const struct pipeline *pipeline, struct renderer *renderer, const struct error *why_none, struct job *job)
{
    struct pipeline_frame *frame = &job->frame;
    const struct render_options *options = &job->request.render;
    frame->id = job->request.id;
    frame->is_still = options->is_still;
    frame->width_px = options->width_px;
    frame->height_px = options->height_px;
    if (pipeline->is_stub)
        job->image = draw_stub(job, &frame->camera, &frame->error);
    else if (renderer)
        job->image = render_snapshot(renderer, job->request.snapshot, options, &frame->camera, &frame->timing, &frame->error);
    else
        frame->error = *why_none;
}

/* Hands a drawn picture to the encoder; waits while it is busy, so the renderer runs at most MAX_DRAWN pictures ahead. */
static void pass_on(struct pipeline *pipeline, struct job *job)
{
    pthread_mutex_lock(&pipeline->mutex);
    while (pipeline->n_drawn >= MAX_DRAWN && !pipeline->is_stopping)
        pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
    pipeline->n_drawn++;
    pthread_mutex_unlock(&pipeline->mutex);
    if (!queue_try_put(pipeline->drawn, job))
        job_destroy(job); /* stopping */
}

static void forget(struct pipeline *pipeline, struct renderer *renderer, const struct plan *plan)
{
    if (renderer)
        renderer_forget(renderer, plan);
    pthread_mutex_lock(&pipeline->mutex);
    pipeline->n_forgotten++;
    pthread_cond_broadcast(&pipeline->changed);
    pthread_mutex_unlock(&pipeline->mutex);
}

/* The render thread's own list of what has come and is not drawn yet, oldest first. */
struct agenda {
    struct job *jobs[2 * PIPELINE_MAX_WAITING];
    size_t n;
};

/* Which is next: the oldest moving picture unless a still before it has waited long enough. What stands behind a plan to forget stays
 * behind it. */
static size_t choose(struct agenda *agenda)
{
    if (agenda->jobs[0]->forget || !agenda->jobs[0]->request.render.is_still || agenda->jobs[0]->n_overtaken >= MAX_OVERTAKING)
        return 0;
    for (size_t i = 1; i < agenda->n && !agenda->jobs[i]->forget; i++)
        if (!agenda->jobs[i]->request.render.is_still) {
            for (size_t earlier = 0; earlier < i; earlier++)
                agenda->jobs[earlier]->n_overtaken++;
            return i;
        }
    return 0;
}

/* Waits for something to do; NULL: the pipeline is closed and empty. */
static struct job *next_job(struct pipeline *pipeline, struct agenda *agenda)
{
    const size_t room = sizeof agenda->jobs / sizeof agenda->jobs[0];
    struct job *job = agenda->n ? queue_try_take(pipeline->waiting) : queue_take(pipeline->waiting, -1);
    for (; job; job = agenda->n < room ? queue_try_take(pipeline->waiting) : NULL)
        agenda->jobs[agenda->n++] = job;
    if (agenda->n == 0)
        return NULL;
    size_t at = choose(agenda);
    job = agenda->jobs[at];
    agenda->n--;
    memmove(agenda->jobs + at, agenda->jobs + at + 1, (agenda->n - at) * sizeof agenda->jobs[0]);
    return job;
}

/* Under the mutex. */
static bool is_dropped(const struct pipeline *pipeline, uint64_t id)
{
    size_t n = pipeline->n_dropped < PIPELINE_MAX_WAITING ? pipeline->n_dropped : PIPELINE_MAX_WAITING;
    for (size_t i = 0; i < n; i++)
        if (pipeline->dropped[i] == id)
            return true;
    return false;
}

static void *render_main(void *argument)
{
    struct pipeline *pipeline = argument;
    struct error err = { 0 };
    struct renderer *renderer = NULL;
    if (pipeline->is_stub) {
        static const struct render_facts stub_facts = { .back_end = RENDER_AUTO, .vendor = "Beamroom", .renderer = "stub",
                                                        .version = "none", .is_software = true };
        pipeline->callbacks.started(pipeline->callbacks.context, &stub_facts, &err);
    } else {
        renderer = renderer_create(pipeline->back_end, &err);
        pipeline->callbacks.started(pipeline->callbacks.context, renderer ? renderer_facts(renderer) : NULL, &err);
    }
    struct agenda agenda = { .n = 0 };
    for (struct job *job; (job = next_job(pipeline, &agenda));) {
        if (job->forget) {
            forget(pipeline, renderer, job->forget);
            job_destroy(job);
            continue;
        }
        pthread_mutex_lock(&pipeline->mutex);
        pipeline->n_waiting--;
        bool unwanted = pipeline->is_stopping || is_dropped(pipeline, job->request.id);
        pthread_mutex_unlock(&pipeline->mutex);
        if (unwanted) {
            job_destroy(job);
            continue;
        }
        draw(pipeline, renderer, &err, job);
        pass_on(pipeline, job);
    }
    renderer_destroy(renderer);
    queue_close(pipeline->drawn);
    return NULL;
}

/* ---- the encode thread ------------------------------------------------------------------------------------------------ */

static void *encode_main(void *argument)
{
    struct pipeline *pipeline = argument;
    struct encoder *encoder = encoder_create();
    for (struct job *job; (job = queue_take(pipeline->drawn, -1));) {
        pthread_mutex_lock(&pipeline->mutex);
        pipeline->n_drawn--;
        pthread_cond_broadcast(&pipeline->changed);
        pthread_mutex_unlock(&pipeline->mutex);
        struct pipeline_frame *frame = &job->frame;
        if (job->image && !is_stopping(pipeline)) {
            int64_t start_us = clock_now_us();
            (void)!encode_image(encoder, job->image, &job->request.encode, &frame->picture, &frame->error);
            frame->encode_us = clock_now_us() - start_us;
        }
        if (!is_stopping(pipeline)) {
            pipeline->callbacks.deliver(pipeline->callbacks.context, frame);
            frame->picture = (struct encoded){ 0 }; /* the receiver's now */
        }
        job_destroy(job);
    }
    encoder_destroy(encoder);
    return NULL;
}

/* ---- from outside ------------------------------------------------------------------------------------------------------- */

struct pipeline *pipeline_create(enum render_back_end back_end, bool stub, const struct pipeline_callbacks *callbacks,
                                 struct error *err)
{
    struct pipeline *pipeline = mem_new(sizeof *pipeline);
    pipeline->callbacks = *callbacks;
    pipeline->back_end = back_end;
    pipeline->is_stub = stub;
    pipeline->waiting = queue_create(2 * PIPELINE_MAX_WAITING, job_destroy); /* room for plans to forget beside the requests */
    pipeline->drawn = queue_create(MAX_DRAWN + 1, job_destroy);
    pthread_mutex_init(&pipeline->mutex, NULL);
    pthread_cond_init(&pipeline->changed, NULL);

    int failed = pthread_create(&pipeline->encode_thread, NULL, encode_main, pipeline);
    if (failed)
        goto fail;
    failed = pthread_create(&pipeline->render_thread, NULL, render_main, pipeline);
    if (!failed)
        return pipeline;
    queue_close(pipeline->drawn);
    pthread_join(pipeline->encode_thread, NULL);
fail:
    error_set(err, ERROR_MEMORY, "cannot start a thread for drawing: %s", strerror(failed));
    queue_destroy(pipeline->waiting);
    queue_destroy(pipeline->drawn);
    pthread_cond_destroy(&pipeline->changed);
    pthread_mutex_destroy(&pipeline->mutex);
    free(pipeline);
    return NULL;
}

bool pipeline_submit(struct pipeline *pipeline, const struct pipeline_request *request, struct error *err)
{
    struct job *job = mem_new(sizeof *job);
    job->request = *request;
    pthread_mutex_lock(&pipeline->mutex);
    bool fits = !pipeline->is_stopping && pipeline->n_waiting < PIPELINE_MAX_WAITING;
    fits = fits && queue_try_put(pipeline->waiting, job);
    pipeline->n_waiting += fits;
    pthread_mutex_unlock(&pipeline->mutex);
    if (fits)
        return true;
    job_destroy(job);
    return error_set(err, ERROR_LIMIT, "%d pictures are waiting to be drawn already", PIPELINE_MAX_WAITING);
}

void pipeline_drop(struct pipeline *pipeline, uint64_t id)
{
    pthread_mutex_lock(&pipeline->mutex);
    pipeline->dropped[pipeline->n_dropped++ % PIPELINE_MAX_WAITING] = id; /* no more than that can wait */
    pthread_mutex_unlock(&pipeline->mutex);
}

void pipeline_forget(struct pipeline *pipeline, const struct plan *plan)
{
    struct job *job = mem_new(sizeof *job);
    job->forget = plan;
    pthread_mutex_lock(&pipeline->mutex);
    while (!queue_try_put(pipeline->waiting, job)) /* full of other callers' plans to forget: let the render thread go on */
        pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
    uint64_t turn = ++pipeline->n_asked_to_forget;
    while (pipeline->n_forgotten < turn)
        pthread_cond_wait(&pipeline->changed, &pipeline->mutex);
    pthread_mutex_unlock(&pipeline->mutex);
}

void pipeline_destroy(struct pipeline *pipeline)
{
    if (!pipeline)
        return;
    pthread_mutex_lock(&pipeline->mutex);
    pipeline->is_stopping = true;
    pthread_cond_broadcast(&pipeline->changed);
    pthread_mutex_unlock(&pipeline->mutex);
    queue_close(pipeline->waiting);
    pthread_join(pipeline->render_thread, NULL);
    pthread_join(pipeline->encode_thread, NULL);
    queue_destroy(pipeline->waiting);
    queue_destroy(pipeline->drawn);
    pthread_cond_destroy(&pipeline->changed);
    pthread_mutex_destroy(&pipeline->mutex);
    free(pipeline);
}

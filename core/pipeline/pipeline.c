/* The render thread, which owns all requests until they are drawn, and the encode threads. Threads share nothing but
 * queues: what other threads want of the render thread comes as messages through its inbox. */
#include "core/pipeline/pipeline.h"

#include <assert.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "core/pipeline/picture.h"

/* Small pictures are compressed by one thread and large ones by another, so that a large one, which takes ten times as
 * long, holds up none. A PNG takes as long as a large JPEG, and so does a frame of a film. */
enum { ENCODE_SMALL, ENCODE_LARGE, N_ENCODE_THREADS, SMALL_MAX_PX = 2500000 };
/* Drawn pictures that may wait for an encode thread: these keep it busy after the one it compresses; more would only
 * add delay. */
enum { MAX_DRAWN = 2 };
/* Time that a picture is drawn before it is left for a request that waits: shorter when a moving picture waits, which a
 * person follows with the mouse, than when a still waits. */
enum { SLICE_MOVING_US = 20000, SLICE_STILL_US = 100000 };
/* Stacks count to a process's memory in full. */
enum { ENCODE_STACK_BYTES = 512 << 10 };
enum { MAX_BEGUN = 32, MAX_PICTURES = PIPELINE_MAX_WAITING + MAX_BEGUN };
/* Messages that may wait. Encode threads send at most two for each picture they hold; so half of the room for drops
 * leaves room for every other message. */
enum { MAX_MESSAGES = 2048, MAX_MESSAGES_BEFORE_DROP = 1024 };

enum message_kind {
    MESSAGE_REQUEST, /* picture is to be drawn */
    MESSAGE_DROP,    /* id is no longer wanted */
    MESSAGE_TAKEN,   /* an encode thread has taken a drawn picture: there is room for another */
    MESSAGE_ENCODED  /* a picture is compressed: its image is freed, its source is to be charged */
};

struct message {
    enum message_kind kind;
    struct picture *picture;  /* REQUEST: owned */
    uint64_t id;              /* DROP */
    struct encode_thread *by; /* TAKEN */
    uint64_t source;          /* ENCODED */
    uint64_t n_image_bytes;   /* ENCODED */
    int64_t cost_us;          /* ENCODED */
};

struct encode_thread {
    struct pipeline *pipeline;
    pthread_t thread;
    struct queue *drawn; /* of struct picture */
    size_t n_drawn;      /* the render thread's count of those; falls when it reads MESSAGE_TAKEN */
};

struct pipeline {
    struct pipeline_callbacks callbacks;
    enum render_back_end back_end;
    bool is_stub;
    pthread_t render_thread;
    struct encode_thread encode_threads[N_ENCODE_THREADS];
    struct queue *inbox;     /* of struct message, to the render thread */
    atomic_size_t n_waiting; /* requests that are not begun */
    atomic_bool is_called;   /* a message waits that may end the slice */
    /* The picture that is drawn now, or was drawn last; see calls_for. */
    _Atomic uint64_t drawn_id, drawn_source;
    atomic_bool drawn_is_still;
    atomic_bool is_stopping;
    /* the rest belongs to the render thread */
    struct turns *turns;
    struct picture *pictures[MAX_PICTURES]; /* not drawn yet, oldest first */
    size_t n_pictures, n_begun;
    struct picture *current; /* of pictures: being drawn since current_us; NULL: none */
    int64_t current_us;
    int64_t leave_at_us;    /* when to leave the current picture; read by the back end's threads while it draws */
    uint64_t n_image_bytes; /* of pictures begun and not compressed */
};

static void drop_picture(void *picture)
{
    picture_destroy(picture);
}

static void drop_message(void *item)
{
    struct message *message = item;
    picture_destroy(message->picture);
    free(message);
}

/* Takes what message owns when it returns true. Any thread. */
static bool send(struct pipeline *pipeline, const struct message *message)
{
    struct message *copy = mem_new(sizeof *copy);
    *copy = *message;
    if (queue_try_put(pipeline->inbox, copy))
        return true;
    free(copy);
    return false;
}

/* ---- which picture is next -------------------------------------------------------------------------------------- */

static struct encode_thread *encode_thread_of(struct pipeline *pipeline, const struct picture *picture)
{
    const struct render_options *options = &picture->request.render;
    bool is_large = picture->request.film || picture->request.encode.codec == ENCODE_PNG ||
                    (int64_t)options->width_px * options->height_px > SMALL_MAX_PX;
    return &pipeline->encode_threads[is_large ? ENCODE_LARGE : ENCODE_SMALL];
}

static uint64_t image_bytes(const struct picture *picture)
{
    const struct render_options *options = &picture->request.render;
    uint64_t width = options->width_px > 0 ? (uint64_t)options->width_px : 0,
             height = options->height_px > 0 ? (uint64_t)options->height_px : 0;
    /* an annotated picture is copied, and has a caption with masks for its text */
    if (picture->request.annotation)
        return width * (2 * height + 2 * ANNOTATE_MAX_CAPTION_PX) * 4;
    uint64_t n = width * height * 4;
    return picture->request.is_reduced[0] || picture->request.is_reduced[1] ? n + n / 2 : n;
}

/* A picture is held while its encode thread has enough drawn ones, while there is no memory for it, and while another
 * one that needs all memory waits for it. */
static bool is_held(struct pipeline *pipeline, const struct picture *picture, bool another_needs_all)
{
    if (encode_thread_of(pipeline, picture)->n_drawn >= MAX_DRAWN)
        return true;
    if (picture->turn.is_begun)
        return false;
    if (pipeline->n_image_bytes > 0 &&
        (another_needs_all || pipeline->n_image_bytes + image_bytes(picture) > PIPELINE_MAX_IMAGE_BYTES))
        return true;
    return pipeline->n_begun >= MAX_BEGUN || (another_needs_all && !picture->needs_all);
}

/* Chooses the picture to draw next. NULL: all are held, or there is none. */
static struct picture *choose(struct pipeline *pipeline)
{
    struct turns_item *items[MAX_PICTURES];
    bool one_needs_all = false;
    for (size_t i = 0; i < pipeline->n_pictures; i++)
        one_needs_all = one_needs_all || (pipeline->pictures[i]->needs_all && !pipeline->pictures[i]->turn.is_begun);
    for (size_t i = 0; i < pipeline->n_pictures; i++) {
        items[i] = &pipeline->pictures[i]->turn;
        items[i]->is_held = is_held(pipeline, pipeline->pictures[i], one_needs_all);
    }
    size_t at = turns_choose(pipeline->turns, items, pipeline->n_pictures);
    return at == SIZE_MAX ? NULL : pipeline->pictures[at];
}

/* Time when the current picture is left for the other; INT64_MAX: it is not. */
static int64_t leave_for_us(const struct pipeline *pipeline, const struct picture *other)
{
    if (other == pipeline->current || other->turn.is_held ||
        !turns_may_interrupt(&pipeline->current->turn, &other->turn))
        return INT64_MAX;
    return pipeline->current_us + (other->turn.is_still ? SLICE_STILL_US : SLICE_MOVING_US);
}

static void start_slice(struct pipeline *pipeline, struct picture *picture)
{
    if (!picture->is_counted) {
        picture->is_counted = true;
        pipeline->n_begun++;
        pipeline->n_image_bytes += image_bytes(picture);
        atomic_fetch_sub(&pipeline->n_waiting, 1);
    }
    pipeline->current = picture;
    atomic_store(&pipeline->drawn_id, picture->request.id);
    atomic_store(&pipeline->drawn_source, picture->turn.source);
    atomic_store(&pipeline->drawn_is_still, picture->turn.is_still);
    pipeline->current_us = clock_now_us();
    pipeline->leave_at_us = INT64_MAX;
    for (size_t i = 0; i < pipeline->n_pictures; i++) {
        int64_t at_us = leave_for_us(pipeline, pipeline->pictures[i]);
        pipeline->leave_at_us = at_us < pipeline->leave_at_us ? at_us : pipeline->leave_at_us;
    }
}

static void remove_picture(struct pipeline *pipeline, const struct picture *picture)
{
    size_t at = 0;
    while (pipeline->pictures[at] != picture)
        at++;
    pipeline->n_pictures--;
    memmove(pipeline->pictures + at, pipeline->pictures + at + 1,
            (pipeline->n_pictures - at) * sizeof pipeline->pictures[0]);
}

/* ---- messages to the render thread ------------------------------------------------------------------------------ */

static void add_request(struct pipeline *pipeline, struct picture *picture)
{
    assert(pipeline->n_pictures < MAX_PICTURES); /* pipeline_submit lets no more in */
    pipeline->pictures[pipeline->n_pictures++] = picture;
    picture->turn.is_held = is_held(pipeline, picture, false);
    int64_t at_us = pipeline->current ? leave_for_us(pipeline, picture) : INT64_MAX;
    if (at_us < pipeline->leave_at_us)
        pipeline->leave_at_us = at_us;
}

static void handle_message(struct pipeline *pipeline, struct message *message)
{
    switch (message->kind) {
    case MESSAGE_REQUEST:
        add_request(pipeline, message->picture);
        message->picture = NULL;
        break;
    case MESSAGE_DROP:
        for (size_t i = 0; i < pipeline->n_pictures; i++)
            if (pipeline->pictures[i]->request.id == message->id)
                pipeline->pictures[i]->is_dropped = true;
        break;
    case MESSAGE_TAKEN: message->by->n_drawn--; break;
    case MESSAGE_ENCODED:
        turns_charge(pipeline->turns, message->source, message->cost_us);
        pipeline->n_image_bytes -= message->n_image_bytes;
        break;
    }
    drop_message(message);
}

static void read_messages(struct pipeline *pipeline)
{
    atomic_store(&pipeline->is_called, false); /* stored before the queue is read: a later message calls again */
    for (struct message *message; (message = queue_try_take(pipeline->inbox));)
        handle_message(pipeline, message);
}

/* ---- drawing ---------------------------------------------------------------------------------------------------- */

static struct image *draw_stub(const struct picture *picture, struct camera *camera, struct error *err)
{
    struct image *image = image_create(picture->request.render.width_px, picture->request.render.height_px, err);
    camera_resolve(picture->request.snapshot, camera);
    if (image)
        for (size_t i = 0, n = (size_t)image->width_px * (size_t)image->height_px * 4; i < n; i++)
            image->rgba[i] = i % 4 == 3 ? 255 : 128;
    return image;
}

static bool is_time_to_leave(const struct pipeline *pipeline)
{
    return atomic_load(&pipeline->is_stopping) ||
           (pipeline->leave_at_us != INT64_MAX && clock_now_us() >= pipeline->leave_at_us);
}

/* True when the current picture is to be left, or a new request may end its slice. Called on any thread of the back
 * end. */
static bool pause_is_due(void *context)
{
    const struct pipeline *pipeline = context;
    return atomic_load(&pipeline->is_called) || is_time_to_leave(pipeline);
}

/* Draws on until it is done or a pause is due. Returns false when there is more to draw. */
static bool draw(struct pipeline *pipeline, struct renderer *renderer, const struct error *why_none,
                 struct picture *picture)
{
    struct pipeline_frame *frame = &picture->frame;
    const struct render_options *options = &picture->request.render;
    frame->id = picture->request.id;
    frame->is_still = options->is_still;
    frame->width_px = options->width_px;
    frame->height_px = options->height_px;
    if (pipeline->is_stub || !renderer) {
        if (pipeline->is_stub)
            picture->image = draw_stub(picture, &frame->camera, &frame->error);
        else
            frame->error = *why_none;
        return true;
    }
    const struct render_pause pause = { pause_is_due, pipeline };
    if (!picture->render)
        picture->render = render_begin(renderer, picture->request.snapshot, options);
    if (render_go_on(picture->render, &pause, &frame->error) == RENDER_PAUSED)
        return false;
    if (frame->error.code == ERROR_MEMORY)
        error_prefix(&frame->error, "a picture of %d x %d pixels", options->width_px, options->height_px);
    picture->image = render_end(picture->render, &frame->camera, &frame->timing);
    picture->render = NULL;
    return true;
}

/* Ends a picture that is no longer wanted, or that is to be begun anew. */
static void give_up(struct picture *picture)
{
    if (picture->render)
        image_destroy(render_end(picture->render, &picture->frame.camera, &picture->frame.timing));
    picture->render = NULL;
}

static void remove_dropped(struct pipeline *pipeline)
{
    for (size_t i = 0; i < pipeline->n_pictures;) {
        struct picture *picture = pipeline->pictures[i];
        if (!picture->is_dropped) {
            i++;
            continue;
        }
        give_up(picture);
        if (picture->is_counted) {
            pipeline->n_begun--;
            pipeline->n_image_bytes -= image_bytes(picture);
        } else {
            atomic_fetch_sub(&pipeline->n_waiting, 1);
        }
        remove_picture(pipeline, picture);
        picture_destroy(picture);
    }
}

/* Hands a drawn picture to its encode thread. One without memory beside others is tried once more when they are done.
 */
static void pass_on(struct pipeline *pipeline, struct picture *picture)
{
    bool has_others = pipeline->n_image_bytes > image_bytes(picture);
    pipeline->n_begun--;
    if (picture->frame.error.code == ERROR_MEMORY && has_others && !picture->needs_all) {
        pipeline->n_image_bytes -= image_bytes(picture);
        atomic_fetch_add(&pipeline->n_waiting, 1);
        picture->is_counted = false;
        picture->needs_all = true;
        picture->turn.is_begun = false;
        picture->frame.error = (struct error){ 0 };
        return;
    }
    remove_picture(pipeline, picture);
    struct encode_thread *thread = encode_thread_of(pipeline, picture);
    thread->n_drawn++;
    bool has_room = queue_try_put(thread->drawn, picture);
    assert(has_room); /* else the picture was held */
    (void)has_room;
}

/* Draws on one picture until it is done, dropped, or left for another. */
static void draw_slice(struct pipeline *pipeline, struct renderer *renderer, const struct error *why_none,
                       struct picture *picture)
{
    bool is_done = false;
    start_slice(pipeline, picture);
    read_messages(pipeline); /* their senders may not have seen which picture is drawn */
    while (!is_done && !picture->is_dropped && !is_time_to_leave(pipeline)) {
        is_done = draw(pipeline, renderer, why_none, picture);
        read_messages(pipeline);
    }
    turns_charge(pipeline->turns, picture->turn.source, clock_now_us() - pipeline->current_us);
    pipeline->current = NULL;
    if (is_done)
        pass_on(pipeline, picture);
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
    while (!atomic_load(&pipeline->is_stopping)) {
        read_messages(pipeline);
        remove_dropped(pipeline);
        struct picture *picture = choose(pipeline);
        struct message *message = picture ? NULL : queue_take(pipeline->inbox, -1);
        if (picture)
            draw_slice(pipeline, renderer, &err, picture);
        else if (message)
            handle_message(pipeline, message);
    }
    for (size_t i = 0; i < pipeline->n_pictures; i++) {
        give_up(pipeline->pictures[i]);
        picture_destroy(pipeline->pictures[i]);
    }
    renderer_destroy(renderer);
    return NULL;
}

/* ---- the encode threads ----------------------------------------------------------------------------------------- */

static void encode(struct pipeline *pipeline, struct encoder *encoder, struct picture *picture)
{
    struct pipeline_frame *frame = &picture->frame;
    if (picture->image) {
        int64_t start_us = clock_now_us();
        picture_compress(encoder, picture);
        frame->encode_us = clock_now_us() - start_us;
    }
    image_destroy(picture->image);
    picture->image = NULL;
    (void)send(pipeline, &(struct message){ .kind = MESSAGE_ENCODED,
                                            .source = picture->turn.source,
                                            .n_image_bytes = image_bytes(picture),
                                            .cost_us = frame->encode_us });
    if (atomic_load(&pipeline->is_stopping))
        return;
    pipeline->callbacks.deliver(pipeline->callbacks.context, frame);
    frame->picture = (struct encoded){ 0 }; /* the receiver's now */
    memset(frame->reduced, 0, sizeof frame->reduced);
    frame->marked = (struct encoded){ 0 };
}

static void *encode_main(void *argument)
{
    struct encode_thread *thread = argument;
    struct pipeline *pipeline = thread->pipeline;
    struct encoder *encoder = encoder_create();
    for (struct picture *picture; (picture = queue_take(thread->drawn, -1));) {
        (void)send(pipeline, &(struct message){ .kind = MESSAGE_TAKEN, .by = thread });
        if (!atomic_load(&pipeline->is_stopping))
            encode(pipeline, encoder, picture);
        picture_destroy(picture);
    }
    encoder_destroy(encoder);
    return NULL;
}

/* ---- from outside ----------------------------------------------------------------------------------------------- */

static void stop(struct pipeline *pipeline, int n_encode_threads, bool has_render_thread)
{
    atomic_store(&pipeline->is_stopping, true);
    queue_close(pipeline->inbox);
    if (has_render_thread)
        pthread_join(pipeline->render_thread, NULL);
    for (int i = 0; i < N_ENCODE_THREADS; i++)
        queue_close(pipeline->encode_threads[i].drawn);
    for (int i = 0; i < n_encode_threads; i++)
        pthread_join(pipeline->encode_threads[i].thread, NULL);
    for (int i = 0; i < N_ENCODE_THREADS; i++)
        queue_destroy(pipeline->encode_threads[i].drawn);
    queue_destroy(pipeline->inbox);
    turns_destroy(pipeline->turns);
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
    pipeline->inbox = queue_create(MAX_MESSAGES, drop_message);
    for (int i = 0; i < N_ENCODE_THREADS; i++)
        pipeline->encode_threads[i] =
            (struct encode_thread){ .pipeline = pipeline, .drawn = queue_create(MAX_DRAWN, drop_picture) };
    int failed = 0, n_started = 0;
    pthread_attr_t small;
    pthread_attr_init(&small);
    pthread_attr_setstacksize(&small, ENCODE_STACK_BYTES);
    for (; n_started < N_ENCODE_THREADS && !failed; n_started += !failed) {
        struct encode_thread *thread = &pipeline->encode_threads[n_started];
        failed = pthread_create(&thread->thread, &small, encode_main, thread);
    }
    pthread_attr_destroy(&small);
    if (!failed)
        failed = pthread_create(&pipeline->render_thread, NULL, render_main, pipeline);
    if (!failed)
        return pipeline;
    error_set(err, ERROR_MEMORY, "cannot start a thread for drawing: %s", strerror(failed));
    stop(pipeline, n_started, false);
    return NULL;
}

/* True if a new request may end the slice of the picture that is drawn: the request is of another source, or it is a
 * moving picture while a still is drawn (turns_may_interrupt). If the render thread begins another picture meanwhile,
 * it reads its messages after it has stored which picture it draws. */
static bool calls_for(struct pipeline *pipeline, const struct pipeline_request *request)
{
    return request->source != atomic_load(&pipeline->drawn_source) ||
           (atomic_load(&pipeline->drawn_is_still) && !request->render.is_still && !request->is_last);
}

bool pipeline_submit(struct pipeline *pipeline, const struct pipeline_request *request, struct error *err)
{
    struct picture *picture = mem_new(sizeof *picture);
    picture->request = *request;
    picture->turn = (struct turns_item){ .source = request->source,
                                         .is_still = request->render.is_still || request->is_last,
                                         .is_acted = request->is_acted };
    if (atomic_fetch_add(&pipeline->n_waiting, 1) < PIPELINE_MAX_WAITING &&
        send(pipeline, &(struct message){ .kind = MESSAGE_REQUEST, .picture = picture })) {
        if (calls_for(pipeline, request))
            atomic_store(&pipeline->is_called, true);
        return true;
    }
    atomic_fetch_sub(&pipeline->n_waiting, 1);
    picture_destroy(picture);
    return error_set(err, ERROR_LIMIT, "%d pictures are waiting to be drawn already", PIPELINE_MAX_WAITING);
}

void pipeline_drop(struct pipeline *pipeline, uint64_t id)
{
    if (queue_length(pipeline->inbox) >= MAX_MESSAGES_BEFORE_DROP)
        return; /* the picture is drawn all the same */
    if (send(pipeline, &(struct message){ .kind = MESSAGE_DROP, .id = id }) && id == atomic_load(&pipeline->drawn_id))
        atomic_store(&pipeline->is_called, true);
}

void pipeline_destroy(struct pipeline *pipeline)
{
    if (pipeline)
        stop(pipeline, N_ENCODE_THREADS, true);
}

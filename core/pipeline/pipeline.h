#pragma once
/* Snapshots in, compressed frames out: owns the render thread and an encode thread, so that one frame is compressed while the
 * next is drawn. Knows no sockets and no JSON. */
#include "core/encode/encode.h"
#include "core/render/render.h"

struct pipeline;

struct pipeline_request {
    uint64_t id;               /* comes back */
    struct snapshot *snapshot; /* one reference, taken */
    struct render_options render;
    struct encode_options encode;
};

struct pipeline_frame {
    uint64_t id;
    struct error error;     /* code ERROR_NONE: a picture */
    struct encoded picture; /* the receiver's to free */
    int width_px, height_px;
    struct camera camera;
    struct render_timing timing;
    int64_t encode_us;
    bool is_still;
};

struct pipeline_callbacks {
    void (*started)(void *context, const struct render_facts *facts, const struct error *err); /* facts NULL: no back end works */
    void (*deliver)(void *context, struct pipeline_frame *frame); /* from a pipeline thread; frame is borrowed, its picture given */
    void *context;
};

/* Starts both threads; the back end comes up while the caller goes on (started tells). stub: draws nothing and delivers grey
 * pictures of the right size with the right camera, for tests and sanitizers that do not get on with the GL driver. */
NODISCARD struct pipeline *pipeline_create(enum render_back_end back_end, bool stub, const struct pipeline_callbacks *callbacks,
                                           struct error *err);
/* Takes request->snapshot always. false (ERROR_LIMIT) when more than PIPELINE_MAX_WAITING requests wait. Any thread; never blocks.
 * Moving pictures are drawn in order, and before stills, which let at most eight overtake them; nothing is dropped, so the caller
 * decides what is worth asking for. */
enum { PIPELINE_MAX_WAITING = 64 };
NODISCARD bool pipeline_submit(struct pipeline *pipeline, const struct pipeline_request *request, struct error *err);
/* Nobody wants this one any more: it is not drawn unless it is being drawn already, and then it is delivered all the same. Any
 * thread. */
void pipeline_drop(struct pipeline *pipeline, uint64_t id);
/* Waits for both threads; requests still waiting are dropped undelivered. */
void pipeline_destroy(struct pipeline *pipeline);
/* Before the render thread draws again: forget what is kept for a plan; returns when done. */
void pipeline_forget(struct pipeline *pipeline, const struct plan *plan);

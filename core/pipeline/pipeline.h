#pragma once
/* Snapshots in, compressed frames out: owns the render thread and two encode threads, for small and for large pictures,
 * so that one frame is compressed while the next is drawn. Sources share the render thread by time (turns.h); a picture
 * that takes long is left between its parts for others. Knows no sockets and no JSON. */
#include "core/encode/encode.h"
#include "core/render/render.h"

struct pipeline;

struct pipeline_request {
    uint64_t id;               /* comes back */
    uint64_t source;           /* whose pictures it is counted with (turns.h) */
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
    void (*started)(void *context, const struct render_facts *facts,
                    const struct error *err); /* facts NULL: no back end works */
    void (*deliver)(void *context,
                    struct pipeline_frame *frame); /* from either encode thread; frame is borrowed, its picture given */
    void *context;
};

/* Starts both threads; the back end comes up while the caller goes on (started tells). stub: draws nothing and delivers
 * grey pictures of the right size with the right camera, for tests and sanitizers that do not get on with the GL
 * driver. */
NODISCARD struct pipeline *pipeline_create(enum render_back_end back_end, bool stub,
                                           const struct pipeline_callbacks *callbacks, struct error *err);
/* What the images of pictures begun and not yet compressed take together; a single one may take more. */
#define PIPELINE_MAX_IMAGE_BYTES ((uint64_t)256 << 20)
enum { PIPELINE_MAX_WAITING = 64 };
/* Takes request->snapshot always. false (ERROR_LIMIT) when more than PIPELINE_MAX_WAITING requests wait. Any thread;
 * never blocks. Which is drawn next: turns.h. Pictures of a source that are alike in size and codec, and all moving or
 * all stills, come back in order. Nothing is dropped, so the caller decides what is worth asking for. */
NODISCARD bool pipeline_submit(struct pipeline *pipeline, const struct pipeline_request *request, struct error *err);
/* Nobody wants this one any more: it is not drawn, or no further; one that is drawn is delivered all the same. Any
 * thread. */
void pipeline_drop(struct pipeline *pipeline, uint64_t id);
/* Waits for the threads; requests still waiting and pictures half drawn are dropped undelivered. */
void pipeline_destroy(struct pipeline *pipeline);
/* Before the render thread draws again: forget what is kept for a plan; returns when done. */
void pipeline_forget(struct pipeline *pipeline, const struct plan *plan);

#pragma once
/* Requests for pictures in, compressed frames out: owns the render thread and two encode threads, for small and for
 * large pictures, so that one frame is compressed while the next is drawn. Sources share the render thread by time
 * (turns.h); a picture that takes long is left between its parts for others. All pictures are of plans that outlive the
 * pipeline. Knows no sockets and no JSON. */
#include "core/annotate/describe.h"
#include "core/base/image_reduce.h"
#include "core/encode/encode.h"
#include "core/encode/film.h"
#include "core/render/render.h"

struct pipeline;

/* A picture for a report: core/annotate. */
struct pipeline_annotation {
    char date[ANNOTATE_DATE_SIZE];
    const char *keyword;   /* of the text in a PNG; borrowed, a constant */
    char *text;            /* owned: kept in a PNG; JPEGs carry none */
    bool is_caption_apart; /* letters and scale bar alone */
    bool is_named;         /* the caption has the patient in full */
    bool has_crosshair;    /* on a slice */
    char *words;           /* owned: of annotations_add_words; NULL: none */
};
void pipeline_annotation_destroy(struct pipeline_annotation *annotation);

struct pipeline_request {
    uint64_t id;               /* the caller's; stands in the frame */
    uint64_t source;           /* the pictures of one source share its time on the render thread (turns.h) */
    bool is_last;              /* of a wall: moving pictures of its source that are none go before it */
    bool is_acted;             /* of the view in which a person acts: goes before other moving ones of its source */
    struct snapshot *snapshot; /* one reference, taken */
    struct render_options render;
    struct encode_options encode;           /* of the reduced pictures, too */
    bool is_reduced[IMAGE_N_REDUCED];       /* the reduced pictures that are wanted; of an annotated one none is made */
    struct pipeline_annotation *annotation; /* owned, taken with the snapshot; NULL: a plain picture */
    struct film *film; /* one reference, taken with the snapshot: the picture is added to it and not compressed; NULL: a
                          picture by itself. One picture of a film at a time */
    int n_film_times;  /* frames of the film that the picture stands for */
    bool ends_film;    /* frame.picture is the film, WebM; before its end it is empty */
    const char *mark;  /* words for a further copy of the picture (annotate_mark); a constant; NULL: no such copy */
};

struct pipeline_frame {
    uint64_t id;
    struct error error;                      /* ERROR_NONE: there is a picture */
    struct encoded picture;                  /* the receiver's to free */
    struct encoded reduced[IMAGE_N_REDUCED]; /* likewise; without bytes: not wanted, or no memory beside the picture */
    struct encoded marked;                   /* likewise, of the whole size: with request.mark */
    int width_px, height_px;                 /* as drawn; the caption of an annotated picture comes below */
    struct camera camera;
    struct render_timing timing;
    int64_t encode_us; /* with the reduced ones */
    bool is_still;
};

/* Called by the pipeline's threads; must not call the pipeline. context is the caller's. */
struct pipeline_callbacks {
    /* The back end is up, or none works: facts NULL and err filled. Once, on the render thread. */
    void (*started)(void *context, const struct render_facts *facts, const struct error *err);
    /* A request is done, or failed. On either encode thread; frame is borrowed, its picture is given away. */
    void (*deliver)(void *context, struct pipeline_frame *frame);
    void *context;
};

/* Starts the threads; the back end starts while the caller goes on. stub: draws nothing and delivers grey pictures of
 * the right size with the right camera, for tests under sanitizers, which do not work with GL drivers.
 *
 *   errors   ERROR_MEMORY  a thread cannot be started */
NODISCARD struct pipeline *pipeline_create(enum render_back_end back_end, bool stub,
                                           const struct pipeline_callbacks *callbacks, struct error *err);
/* Limit on the images of all pictures that are begun and not yet compressed; a single image may be larger. */
#define PIPELINE_MAX_IMAGE_BYTES ((uint64_t)256 << 20)
enum { PIPELINE_MAX_WAITING = 448 }; /* two of each of 200 people, and some */
/* Takes request->snapshot, request->annotation and request->film, on failure too. Pictures of one source that are alike
 * in size and codec, and all moving or all stills, are delivered in order. Nothing is dropped, so the caller decides
 * what is worth a request.
 *
 *   errors   ERROR_LIMIT  PIPELINE_MAX_WAITING requests are not begun yet
 *   thread   any; never blocks */
NODISCARD bool pipeline_submit(struct pipeline *pipeline, const struct pipeline_request *request, struct error *err);
/* The request is no longer wanted: it is not drawn, or no further. A picture that is drawn already is delivered all the
 * same, and so may be one that is dropped while very many requests are dropped at once. Any thread; never blocks. */
void pipeline_drop(struct pipeline *pipeline, uint64_t id);
/* Waits for the threads. Requests that wait and pictures half drawn are dropped without a frame. */
void pipeline_destroy(struct pipeline *pipeline);

#pragma once
/* A request on its way through the pipeline: first with its render, then with its image, last with its frame. Knows no
 * threads. */
#include "core/pipeline/pipeline.h"
#include "core/pipeline/turns.h"

/* A request on its way through the pipeline. Owned by the render thread, then by an encode thread. */
struct picture {
    struct pipeline_request request;
    struct turns_item turn;
    struct render_picture *render; /* begun and not done; else NULL */
    struct image *image;           /* drawn and not compressed; else NULL */
    struct pipeline_frame frame;
    bool is_counted; /* in n_begun or with an encode thread, and with its image in n_image_bytes */
    bool is_dropped;
    bool needs_all; /* there was no memory for it beside others */
};
void picture_destroy(struct picture *picture);

/* Makes the frame of the image: its picture, with letters where they are asked for, then the reduced and the marked
 * ones. What fails is in the frame's error; the image is changed. */
void picture_compress(struct encoder *encoder, struct picture *picture);

#pragma once
/* Pictures from the render packet to the frame packet: builds the shapes, draws, compresses, sends. Thread: the main
 * thread. */
#include "server/renderer/link.h"
#include "server/renderer/loader.h"
#include "server/renderer/scenes.h"

struct pictures;

/* All are borrowed. Call pictures_destroy after loader and pipeline have ended: their threads read memory that it
 * frees. */
struct pictures_options {
    struct link *link;
    struct pipeline *pipeline;
    struct loader *loader;
    const struct scenes *scenes;
};
struct pictures *pictures_create(const struct pictures_options *options);
void pictures_destroy(struct pictures *pictures);
/* Graphics did not start: every picture is answered with this. */
void pictures_refuse_all(struct pictures *pictures, const struct problem *problem);
/* Draws a tiny picture that is sent to nobody, so that shaders are compiled and coarse meshes on the device before the
 * first request. */
void pictures_warm_up(struct pictures *pictures);
/* Starts a picture, which is answered with a frame or a problem. */
void pictures_start(struct pictures *pictures, const struct packet_render *render);
/* The picture, or the film, is no longer wanted. */
void pictures_drop(struct pictures *pictures, const struct packet_drop *drop);
/* The shapes of a picture are built: hands it to the render thread. Takes waiting. */
void pictures_shapes_built(struct pictures *pictures, struct waiting_request *waiting);
/* A picture is drawn and compressed, or failed: answers its request. */
void pictures_send_frame(struct pictures *pictures, const struct pipeline_frame *frame);

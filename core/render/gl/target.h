#pragma once
/* The framebuffers that a band of a picture is drawn into: the target, and the layers of translucent shapes. */
#include "core/render/gl/table.h"

struct gl_target {
    int width_px, height_px;
    GLuint framebuffer; /* colour and depth */
    GLuint over;        /* colour alone: for compositions, which read the depth */
    GLuint color;       /* renderbuffer */
    GLuint depth;       /* texture */
};

/* Makes the target unless it has this size. errors ERROR_LIMIT more than the driver takes, ERROR_GL */
NODISCARD bool gl_target_resize(const struct gl *gl, struct gl_target *target, int width_px, int height_px,
                                struct error *err);
void gl_target_destroy(const struct gl *gl, struct gl_target *target);

/* Colour and depth of the nearest sheet of each translucent shape. */
struct gl_layers {
    int width_px, height_px, n;
    GLuint framebuffer;
    GLuint color, depth; /* array textures */
};
enum {
    GL_LAYERS_MAX = 64, /* in one composition */
    GL_LAYERS_MAX_SAMPLES =
        16 << 20 /* of all layers together, 8 bytes each; beyond it a picture is drawn in more bands */
};

/* Makes at least n layers of the target's size. errors ERROR_GL */
NODISCARD bool gl_layers_resize(const struct gl *gl, struct gl_layers *layers, const struct gl_target *target, int n,
                                struct error *err);
/* Binds layer i for drawing, and clears it. */
void gl_layers_bind(const struct gl *gl, const struct gl_layers *layers, int i);
void gl_layers_destroy(const struct gl *gl, struct gl_layers *layers);

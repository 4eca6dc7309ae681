#pragma once
/* What is drawn into: colour and depth, and the layers of translucent regions. */
#include "core/render/gl/table.h"

struct gl_target {
    int width_px, height_px;
    GLuint framebuffer; /* colour and depth */
    GLuint over;        /* colour alone, while the depth is read */
    GLuint color;       /* renderbuffer */
    GLuint depth;       /* texture */
};

/* Makes the target this large; keeps it when it is so already. errors ERROR_LIMIT, ERROR_GL */
NODISCARD bool gl_target_resize(const struct gl *gl, struct gl_target *target, int width_px, int height_px,
                                struct error *err);
void gl_target_destroy(const struct gl *gl, struct gl_target *target);

/* One picture's worth of colour and depth for every translucent region: what each shows nearest to the viewer. */
struct gl_layers {
    int width_px, height_px, n;
    GLuint framebuffer;
    GLuint color, depth; /* array textures */
};
enum {
    GL_LAYERS_MAX = 64,              /* regions in one composition */
    GL_LAYERS_MAX_SAMPLES = 16 << 20 /* of all layers together, 8 bytes each: larger pictures are drawn in bands */
};

/* As large as the target, n of them or more. errors ERROR_GL */
NODISCARD bool gl_layers_resize(const struct gl *gl, struct gl_layers *layers, const struct gl_target *target, int n,
                                struct error *err);
/* From now on layer i is drawn into; it is clear. */
void gl_layers_bind(const struct gl *gl, const struct gl_layers *layers, int i);
void gl_layers_destroy(const struct gl *gl, struct gl_layers *layers);

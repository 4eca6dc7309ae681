#pragma once
/* What is drawn into: colour and depth. */
#include "core/render/gl/table.h"

struct gl_target {
    int width_px, height_px;
    GLuint framebuffer;
    GLuint color, depth; /* renderbuffers */
};

/* Makes the target this large; keeps it when it is so already. errors ERROR_LIMIT, ERROR_GL */
NODISCARD bool gl_target_resize(const struct gl *gl, struct gl_target *target, int width_px, int height_px, struct error *err);
void gl_target_destroy(const struct gl *gl, struct gl_target *target);

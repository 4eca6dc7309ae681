#pragma once
/* An OpenGL 3.3 core context without a window, from EGL or OSMesa, current on the thread that opened it. */
#include "core/render/gl/table.h"
#include "core/render/visible/back_end.h"

struct gl_context {
    enum render_back_end back_end;
    void *display, *context; /* EGL's, or OSMesa's context alone */
    void *pixels;            /* OSMesa wants a picture of its own to be current; nothing is drawn into it */
};

enum gl_device_wish { GL_DEVICE_ANY, GL_DEVICE_HARDWARE };

/* Opens the context, makes it current and fills the table. back_end is not RENDER_AUTO; wish is for RENDER_EGL_DEVICE:
 * real devices come first, and with GL_DEVICE_HARDWARE software ones are left out. errors ERROR_GL with what the back
 * end said */
NODISCARD bool gl_context_open(struct gl_context *context, enum render_back_end back_end, enum gl_device_wish wish,
                               struct gl *gl, struct error *err);
void gl_context_close(struct gl_context *context);

/* the two kinds, for context.c */
NODISCARD bool gl_egl_open(struct gl_context *context, enum gl_device_wish wish, struct gl *gl, struct error *err);
void gl_egl_close(struct gl_context *context);
NODISCARD bool gl_osmesa_open(struct gl_context *context, struct gl *gl, struct error *err);
void gl_osmesa_close(struct gl_context *context);

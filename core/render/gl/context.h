#pragma once
/* An OpenGL 3.3 core context without a window, from EGL or OSMesa, current on the thread that opened it. */
#include "core/render/gl/table.h"
#include "core/render/visible/back_end.h"

struct gl_context {
    enum render_back_end back_end;
    void *display, *context; /* of EGL; OSMesa has a context alone */
    void *pixels;            /* the buffer that OSMesa needs to make a context current; nothing is drawn into it */
};

enum gl_device_wish { GL_DEVICE_ANY, GL_DEVICE_HARDWARE };

/* Opens the context, makes it current and fills the table.
 *   back_end  not RENDER_AUTO
 *   wish      of RENDER_EGL_DEVICE, which tries graphics cards first: GL_DEVICE_HARDWARE leaves out software devices
 *   errors    ERROR_GL with the back end's message */
NODISCARD bool gl_context_open(struct gl_context *context, enum render_back_end back_end, enum gl_device_wish wish,
                               struct gl *gl, struct error *err);
void gl_context_close(struct gl_context *context);

/* Inside core/render/gl: the parts of context.c for each library. */
NODISCARD bool gl_egl_open(struct gl_context *context, enum gl_device_wish wish, struct gl *gl, struct error *err);
void gl_egl_close(struct gl_context *context);
NODISCARD bool gl_osmesa_open(struct gl_context *context, struct gl *gl, struct error *err);
void gl_osmesa_close(struct gl_context *context);

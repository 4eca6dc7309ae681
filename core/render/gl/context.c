/* Opens an OpenGL context by EGL or OSMesa, whichever the back end is. */
#include "core/render/gl/context.h"

bool gl_context_open(struct gl_context *context, enum render_back_end back_end, enum gl_device_wish wish, struct gl *gl,
                     struct error *err)
{
    *context = (struct gl_context){ .back_end = back_end };
    if (back_end == RENDER_OSMESA)
        return gl_osmesa_open(context, gl, err);
    return gl_egl_open(context, wish, gl, err);
}

void gl_context_close(struct gl_context *context)
{
    if (!context->context)
        return;
    if (context->back_end == RENDER_OSMESA)
        gl_osmesa_close(context);
    else
        gl_egl_close(context);
    *context = (struct gl_context){ 0 };
}

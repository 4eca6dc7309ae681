/* The table of OpenGL functions: filled from a library, and the driver's errors. */
#include "core/render/gl/table.h"

#include <dlfcn.h>
#include <string.h>

/* C defines no conversion from object to function pointers; POSIX guarantees equal representations. */
gl_function gl_symbol(void *library, const char *name)
{
    void *symbol = dlsym(library, name);
    gl_function function = NULL;
    memcpy(&function, &symbol, sizeof function);
    return function;
}

bool gl_load(struct gl *gl, gl_function (*get)(const char *name), struct error *err)
{
#define GL_GET(type, name) \
    if (!(gl->name = (type)get("gl" #name))) \
        return error_set(err, ERROR_GL, "the driver has no gl" #name);
    GL_FUNCTIONS(GL_GET)
#undef GL_GET
    return true;
}

static const char *gl_error_words(GLenum code)
{
    switch (code) {
    case GL_INVALID_ENUM: return "invalid enum";
    case GL_INVALID_VALUE: return "invalid value";
    case GL_INVALID_OPERATION: return "invalid operation";
    case GL_INVALID_FRAMEBUFFER_OPERATION: return "invalid framebuffer operation";
    case GL_OUT_OF_MEMORY: return "out of memory";
    default: return "unknown error";
    }
}

bool gl_check(const struct gl *gl, const char *during, struct error *err)
{
    GLenum first = gl->GetError();
    if (first == GL_NO_ERROR)
        return true;
    for (int i = 0; i < 16 && gl->GetError() != GL_NO_ERROR; i++)
        ; /* at most 16: a lost context reports errors for ever */
    return error_set(err, ERROR_GL, "%s: the graphics driver says %s (0x%04x)", during, gl_error_words(first), first);
}

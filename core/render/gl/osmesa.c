/* OpenGL contexts by OSMesa, Mesa's software renderer without a display. The library is opened at run time. */
#include <dlfcn.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/gl/context.h"

/* Copied from GL/osmesa.h, which newer distributions no longer have; the library's interface is frozen. */
enum {
    OSMESA_FORMAT = 0x22,
    OSMESA_DEPTH_BITS = 0x30,
    OSMESA_PROFILE = 0x33,
    OSMESA_CORE_PROFILE = 0x34,
    OSMESA_CONTEXT_MAJOR_VERSION = 0x36,
    OSMESA_CONTEXT_MINOR_VERSION = 0x37,
    OWN_PICTURE_SIDE_PX = 16
};

static struct {
    bool is_loaded;
    char why_not[160];
    void *(*create_context)(const int *attributes, void *share);
    unsigned char (*make_current)(void *context, void *pixels, GLenum type, int width, int height);
    gl_function (*get_function)(const char *name);
    void (*destroy_context)(void *context);
} osmesa;

static void keep_why_not(const char *text)
{
    strncpy(osmesa.why_not, text ? text : "unknown", sizeof osmesa.why_not - 1);
}

/* RTLD_LOCAL: its 1300 gl* symbols must not replace those of other libraries. The library is never closed. */
static void load_osmesa(void)
{
    void *library = dlopen("libOSMesa.so.8", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        keep_why_not(dlerror());
        return;
    }
    osmesa.create_context = (void *(*)(const int *, void *))gl_symbol(library, "OSMesaCreateContextAttribs");
    osmesa.make_current = (unsigned char (*)(void *, void *, GLenum, int, int))gl_symbol(library, "OSMesaMakeCurrent");
    osmesa.get_function = (gl_function(*)(const char *))gl_symbol(library, "OSMesaGetProcAddress");
    osmesa.destroy_context = (void (*)(void *))gl_symbol(library, "OSMesaDestroyContext");
    osmesa.is_loaded = osmesa.create_context && osmesa.make_current && osmesa.get_function && osmesa.destroy_context;
    if (!osmesa.is_loaded)
        keep_why_not("libOSMesa.so.8 lacks OSMesaCreateContextAttribs");
}

bool gl_osmesa_open(struct gl_context *context, struct gl *gl, struct error *err)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, load_osmesa);
    if (!osmesa.is_loaded)
        return error_set(err, ERROR_GL, "%s", osmesa.why_not);
    const int attributes[] = { OSMESA_FORMAT,
                               GL_RGBA,
                               OSMESA_DEPTH_BITS,
                               24,
                               OSMESA_PROFILE,
                               OSMESA_CORE_PROFILE,
                               OSMESA_CONTEXT_MAJOR_VERSION,
                               3,
                               OSMESA_CONTEXT_MINOR_VERSION,
                               3,
                               0 };
    void *made = osmesa.create_context(attributes, NULL);
    if (!made)
        return error_set(err, ERROR_GL, "no OpenGL 3.3 core context");
    context->context = made;
    context->pixels = mem_new((size_t)OWN_PICTURE_SIDE_PX * OWN_PICTURE_SIDE_PX * 4);
    if (osmesa.make_current(made, context->pixels, GL_UNSIGNED_BYTE, OWN_PICTURE_SIDE_PX, OWN_PICTURE_SIDE_PX)) {
        if (gl_load(gl, osmesa.get_function, err))
            return true;
    } else
        error_set(err, ERROR_GL, "the context cannot be made current");
    gl_osmesa_close(context);
    context->context = NULL;
    return false;
}

void gl_osmesa_close(struct gl_context *context)
{
    osmesa.make_current(NULL, NULL, 0, 0, 0);
    osmesa.destroy_context(context->context);
    free(context->pixels);
    context->pixels = NULL;
}

/* OpenGL contexts by EGL: on a device, or surfaceless. The library is opened at run time. */
#include <dlfcn.h>
#include <pthread.h>
#include <string.h>

#include <EGL/egl.h>
#include <EGL/eglext.h>

#include "core/render/gl/context.h"

#define EGL_FUNCTIONS(X) \
    X(PFNEGLBINDAPIPROC, BindAPI) \
    X(PFNEGLCHOOSECONFIGPROC, ChooseConfig) \
    X(PFNEGLCREATECONTEXTPROC, CreateContext) \
    X(PFNEGLDESTROYCONTEXTPROC, DestroyContext) \
    X(PFNEGLGETERRORPROC, GetError) \
    X(PFNEGLGETPROCADDRESSPROC, GetProcAddress) \
    X(PFNEGLINITIALIZEPROC, Initialize) \
    X(PFNEGLMAKECURRENTPROC, MakeCurrent) \
    X(PFNEGLQUERYSTRINGPROC, QueryString)

enum { MAX_DEVICES = 16 };

static struct {
    bool is_loaded;
    char why_not[160];
#define EGL_MEMBER(type, name) type name;
    EGL_FUNCTIONS(EGL_MEMBER)
#undef EGL_MEMBER
    PFNEGLGETPLATFORMDISPLAYEXTPROC GetPlatformDisplayEXT;
    PFNEGLQUERYDEVICESEXTPROC QueryDevicesEXT;           /* may be missing */
    PFNEGLQUERYDEVICESTRINGEXTPROC QueryDeviceStringEXT; /* may be missing */
} egl;

static void keep_why_not(const char *text)
{
    strncpy(egl.why_not, text ? text : "unknown", sizeof egl.why_not - 1);
}

/* Called once in a process. The library is never closed: drivers do not survive being unloaded. */
static void load_egl(void)
{
    void *library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library) {
        keep_why_not(dlerror());
        return;
    }
#define EGL_GET(type, name) \
    if (!(egl.name = (type)gl_symbol(library, "egl" #name))) { \
        keep_why_not("libEGL.so.1 has no egl" #name); \
        return; \
    }
    EGL_FUNCTIONS(EGL_GET)
#undef EGL_GET
    egl.GetPlatformDisplayEXT = (PFNEGLGETPLATFORMDISPLAYEXTPROC)egl.GetProcAddress("eglGetPlatformDisplayEXT");
    egl.QueryDevicesEXT = (PFNEGLQUERYDEVICESEXTPROC)egl.GetProcAddress("eglQueryDevicesEXT");
    egl.QueryDeviceStringEXT = (PFNEGLQUERYDEVICESTRINGEXTPROC)egl.GetProcAddress("eglQueryDeviceStringEXT");
    if (!egl.GetPlatformDisplayEXT)
        keep_why_not("no EGL_EXT_platform_base");
    else
        egl.is_loaded = true;
}

static bool has_word(const char *list, const char *word)
{
    size_t length = strlen(word);
    for (const char *at = list; at && (at = strstr(at, word)); at += length)
        if ((at == list || at[-1] == ' ') && (at[length] == ' ' || at[length] == 0))
            return true;
    return false;
}

static gl_function get_function(const char *name)
{
    return (gl_function)egl.GetProcAddress(name);
}

/* Opens a context on a display. The process shares displays and keeps them initialised, as another renderer may use the
 * same one. */
static bool open_display(struct gl_context *context, EGLDisplay display, struct gl *gl, struct error *err)
{
    if (display == EGL_NO_DISPLAY || !egl.Initialize(display, NULL, NULL))
        return error_set(err, ERROR_GL, "no display (0x%04x)", (unsigned)egl.GetError());
    const char *extensions = egl.QueryString(display, EGL_EXTENSIONS);
    if (!has_word(extensions, "EGL_KHR_surfaceless_context"))
        return error_set(err, ERROR_GL, "the display has no EGL_KHR_surfaceless_context");

    EGLConfig config = NULL; /* EGL_NO_CONFIG_KHR */
    if (!has_word(extensions, "EGL_KHR_no_config_context")) {
        const EGLint wanted[] = { EGL_SURFACE_TYPE, EGL_DONT_CARE, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE };
        EGLint n_configs = 0;
        if (!egl.ChooseConfig(display, wanted, &config, 1, &n_configs) || n_configs < 1)
            return error_set(err, ERROR_GL, "no configuration for OpenGL (0x%04x)", (unsigned)egl.GetError());
    }
    const EGLint attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           3,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE
    };
    if (!egl.BindAPI(EGL_OPENGL_API))
        return error_set(err, ERROR_GL, "no OpenGL, only OpenGL ES");
    EGLContext made = egl.CreateContext(display, config, EGL_NO_CONTEXT, attributes);
    if (made == EGL_NO_CONTEXT)
        return error_set(err, ERROR_GL, "no OpenGL 3.3 core context (0x%04x)", (unsigned)egl.GetError());
    if (!egl.MakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, made)) {
        error_set(err, ERROR_GL, "the context cannot be made current (0x%04x)", (unsigned)egl.GetError());
        egl.DestroyContext(display, made);
        return false;
    }
    context->display = display;
    context->context = made;
    if (gl_load(gl, get_function, err))
        return true;
    gl_egl_close(context);
    context->context = NULL;
    return false;
}

static bool open_device(struct gl_context *context, enum gl_device_wish wish, struct gl *gl, struct error *err)
{
    EGLDeviceEXT devices[MAX_DEVICES];
    EGLint n_devices = 0;
    if (!egl.QueryDevicesEXT || !egl.QueryDeviceStringEXT)
        return error_set(err, ERROR_GL, "no EGL_EXT_device_base");
    if (!egl.QueryDevicesEXT(MAX_DEVICES, devices, &n_devices) || n_devices < 1)
        return error_set(err, ERROR_GL, "no device");
    error_set(err, ERROR_GL, "no graphics device among %d", n_devices);
    for (int is_software = 0; is_software <= (wish == GL_DEVICE_ANY); is_software++)
        for (EGLint i = 0; i < n_devices; i++) {
            if (has_word(egl.QueryDeviceStringEXT(devices[i], EGL_EXTENSIONS), "EGL_MESA_device_software") !=
                is_software)
                continue;
            EGLDisplay display = egl.GetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], NULL);
            if (open_display(context, display, gl, err))
                return true;
            error_prefix(err, "device %d", i);
        }
    return false;
}

bool gl_egl_open(struct gl_context *context, enum gl_device_wish wish, struct gl *gl, struct error *err)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, load_egl);
    if (!egl.is_loaded)
        return error_set(err, ERROR_GL, "%s", egl.why_not);
    if (context->back_end == RENDER_EGL_DEVICE)
        return open_device(context, wish, gl, err);
    if (!has_word(egl.QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS), "EGL_MESA_platform_surfaceless"))
        return error_set(err, ERROR_GL, "no EGL_MESA_platform_surfaceless");
    return open_display(context, egl.GetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL),
                        gl, err);
}

void gl_egl_close(struct gl_context *context)
{
    egl.MakeCurrent(context->display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    egl.DestroyContext(context->display, context->context);
}

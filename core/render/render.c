/* A snapshot to an image: the draw list, the back end that executes it, the overlay. */
#include "core/render/render.h"

#include <assert.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/render/gl/renderer.h"
#include "core/render/soft/soft.h"
#include "core/render/visible/cap_cache.h"
#include "core/render/visible/draw_list.h"
#include "core/render/visible/isoline_cache.h"
#include "core/render/visible/occlusion.h"
#include "core/render/visible/overlay.h"

/* One of gl and soft; the other is NULL. */
struct renderer {
    pthread_t thread;
    struct gl_renderer *gl;
    struct soft_renderer *soft;
    struct draw_cache *cache; /* what the back end made of shapes and grids */
    struct cap_cache *caps;
    struct isoline_cache *isolines;
    struct overlay *overlay;
};

static const char *const words[RENDER_N_BACK_ENDS] = {
    [RENDER_AUTO] = "auto",
    [RENDER_EGL_DEVICE] = "egl-device",
    [RENDER_EGL_SURFACELESS] = "egl-surfaceless",
    [RENDER_OSMESA] = "osmesa",
    [RENDER_SOFT] = "soft",
};

const char *render_back_end_word(enum render_back_end back_end)
{
    return words[back_end];
}

bool render_back_end_from_word(const char *word, enum render_back_end *back_end)
{
    for (int i = 0; i < RENDER_N_BACK_ENDS; i++)
        if (strcmp(word, words[i]) == 0) {
            *back_end = (enum render_back_end)i;
            return true;
        }
    return false;
}

static void assert_thread(const struct renderer *renderer)
{
    assert(pthread_equal(renderer->thread, pthread_self()));
}

/* True if the system has a device file of a graphics card. Starting a driver only to learn that it renders in software
 * takes longer than many pictures. Checks names alone, which a confined process may. */
static bool has_graphics_device(void)
{
    static const char *const names[] = { "/dev/nvidiactl", "/dev/nvidia0", "/dev/dxg" };
    char name[32];
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        if (access(names[i], F_OK) == 0)
            return true;
    for (int i = 0; i < 64; i++) {
        snprintf(name, sizeof name, "/dev/dri/card%d", i);
        if (access(name, F_OK) == 0)
            return true;
        snprintf(name, sizeof name, "/dev/dri/renderD%d", 128 + i);
        if (access(name, F_OK) == 0)
            return true;
    }
    return false;
}

/* OpenGL on a graphics card, or NULL. */
static struct gl_renderer *create_hardware(void)
{
    static const enum render_back_end order[] = { RENDER_EGL_DEVICE, RENDER_EGL_SURFACELESS };
    for (size_t i = 0; has_graphics_device() && i < sizeof order / sizeof order[0]; i++) {
        struct error why = { 0 };
        struct gl_renderer *gl = gl_renderer_create(order[i], true, &why);
        if (gl && !gl_renderer_facts(gl)->is_software)
            return gl;
        gl_renderer_destroy(gl);
    }
    return NULL;
}

struct renderer *renderer_create(enum render_back_end back_end, struct error *err)
{
    struct renderer *renderer = mem_new(sizeof *renderer);
    renderer->thread = pthread_self();
    if (back_end == RENDER_AUTO)
        renderer->gl = create_hardware();
    else if (back_end != RENDER_SOFT) {
        renderer->gl = gl_renderer_create(back_end, false, err);
        if (!renderer->gl)
            error_prefix(err, "%s", words[back_end]);
    }
    if (!renderer->gl && (back_end == RENDER_AUTO || back_end == RENDER_SOFT))
        renderer->soft = soft_renderer_create();
    if (!renderer->gl && !renderer->soft) {
        free(renderer);
        return NULL;
    }
    struct drawable_maker maker = renderer->gl ? gl_renderer_maker(renderer->gl) : soft_renderer_maker();
    renderer->cache = draw_cache_create(&maker);
    renderer->caps = cap_cache_create();
    renderer->isolines = isoline_cache_create();
    renderer->overlay = overlay_create();
    return renderer;
}

void renderer_destroy(struct renderer *renderer)
{
    if (!renderer)
        return;
    assert_thread(renderer);
    draw_cache_destroy(renderer->cache); /* before the back end, which frees its drawables */
    gl_renderer_destroy(renderer->gl);
    soft_renderer_destroy(renderer->soft);
    cap_cache_destroy(renderer->caps);
    isoline_cache_destroy(renderer->isolines);
    overlay_destroy(renderer->overlay);
    free(renderer);
}

void renderer_tune(struct renderer *renderer, int n_threads, bool is_portable)
{
    assert_thread(renderer);
    if (renderer->soft)
        soft_renderer_tune(renderer->soft, n_threads, is_portable);
}

const struct render_facts *renderer_facts(const struct renderer *renderer)
{
    return renderer->gl ? gl_renderer_facts(renderer->gl) : soft_renderer_facts(renderer->soft);
}

void renderer_forget(struct renderer *renderer, const struct plan *plan)
{
    assert_thread(renderer);
    cap_cache_forget(renderer->caps, plan);
    isoline_cache_forget(renderer->isolines, plan);
    overlay_forget(renderer->overlay, plan);
    draw_cache_forget(renderer->cache, plan);
    if (renderer->soft)
        soft_renderer_forget(renderer->soft);
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

struct render_picture {
    struct renderer *renderer;
    struct draw_scope scope;
    struct render_options options;
    struct draw_list *list; /* NULL: drawing has not begun */
    struct gl_picture *gl;
    struct soft_frame *soft;
    struct camera camera;
    struct render_timing timing;
    struct image *image; /* as the back end drew it; NULL: not finished */
    bool is_done;        /* the overlay is painted too */
};

struct render_picture *render_begin(struct renderer *renderer, const struct snapshot *snapshot,
                                    const struct render_options *options)
{
    assert_thread(renderer);
    struct render_picture *picture = mem_new(sizeof *picture);
    picture->renderer = renderer;
    picture->options = *options;
    picture->scope =
        (struct draw_scope){ snapshot,          &picture->camera, options->detail,    renderer->cache,
                             options->is_still, renderer->caps,   renderer->isolines, renderer->soft != NULL };
    camera_resolve(snapshot, &picture->camera);
    return picture;
}

static bool make_list(struct render_picture *picture, struct error *err)
{
    struct renderer *renderer = picture->renderer;
    int64_t start_us = clock_now_us();
    picture->list = draw_list_create(&picture->scope, &picture->options, err);
    picture->timing.draw_us += clock_now_us() - start_us;
    if (!picture->list)
        return false;
    picture->timing.n_triangles = picture->list->n_triangles;
    picture->timing.is_coarse = picture->list->is_coarse;
    if (renderer->gl)
        picture->gl = gl_picture_begin(renderer->gl, &picture->scope, picture->list, &picture->options);
    else
        picture->soft = soft_picture_begin(renderer->soft, &picture->scope, picture->list, &picture->options);
    return true;
}

static struct image *end_back_end(struct render_picture *picture)
{
    struct image *image = picture->gl     ? gl_picture_end(picture->gl)
                          : picture->soft ? soft_picture_end(picture->soft)
                                          : NULL;
    picture->gl = NULL;
    picture->soft = NULL;
    return image;
}

/* Once, even if the overlay fails and is tried again. */
static bool darken_hollows(struct render_picture *picture, struct error *err)
{
    const struct box3 *box = &picture->scope.snapshot->plan->bounds_lps_mm;
    double diagonal_mm = box3_is_empty(box) ? 0 : vec3_length(vec3_sub(box->high, box->low));
    bool is_good = occlusion_darken(picture->image, picture->list->depth, &picture->camera,
                                    OCCLUSION_RADIUS_PART * diagonal_mm, err);
    free(picture->list->depth);
    picture->list->depth = NULL;
    return is_good;
}

enum render_state render_go_on(struct render_picture *picture, const struct render_pause *pause, struct error *err)
{
    assert_thread(picture->renderer);
    if (!picture->list && !make_list(picture, err))
        return RENDER_FAILED;
    if (!picture->image) {
        enum render_state state = picture->gl ? gl_picture_go_on(picture->gl, pause, &picture->timing, err)
                                              : soft_picture_go_on(picture->soft, pause, &picture->timing, err);
        if (state != RENDER_DONE)
            return state;
        picture->image = end_back_end(picture);
        if (pause && pause->is_due(pause->context))
            return RENDER_PAUSED;
    }
    int64_t start_us = clock_now_us();
    if (picture->list->depth && !darken_hollows(picture, err))
        return RENDER_FAILED;
    struct check_counts check;
    if (!overlay_draw(picture->renderer->overlay, &picture->scope, picture->list, picture->image, &check, err))
        return RENDER_FAILED;
    picture->timing.n_added_px = check.n_added;
    picture->timing.n_left_out_px = check.n_left_out;
    picture->timing.draw_us += clock_now_us() - start_us;
    picture->is_done = true;
    return RENDER_DONE;
}

struct image *render_end(struct render_picture *picture, struct camera *camera, struct render_timing *timing)
{
    assert_thread(picture->renderer);
    struct image *unfinished = end_back_end(picture), *image = picture->image;
    image_destroy(unfinished);
    if (!picture->is_done) {
        image_destroy(image);
        image = NULL;
    }
    *camera = picture->camera;
    *timing = picture->timing;
    draw_list_destroy(picture->list);
    free(picture);
    return image;
}

struct image *render_snapshot(struct renderer *renderer, const struct snapshot *snapshot,
                              const struct render_options *options, struct camera *camera, struct render_timing *timing,
                              struct error *err)
{
    struct render_picture *picture = render_begin(renderer, snapshot, options);
    (void)!render_go_on(picture, NULL, err); /* a failed picture has no image */
    return render_end(picture, camera, timing);
}

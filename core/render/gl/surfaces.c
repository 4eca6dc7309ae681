#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/gl/draw.h"
#include "core/render/visible.h"

/* One surface to draw. */
struct item {
    const struct gl_surface *surface;
    const struct scene_region_style *style;
};

static const struct gl_surface *surface_of(const struct gl_frame *frame, size_t region, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    return gl_cache_surface(frame->gl, frame->cache, snapshot->plan, region, visible_algorithm(snapshot), frame->detail, err);
}

static const struct box3 *bounds(void *context, size_t region, struct error *err)
{
    const struct gl_frame *frame = context;
    const struct gl_surface *surface = surface_of(frame, region, err);
    return surface ? &surface->bounds_lps_mm : NULL;
}

/* The surfaces that are wanted and can be seen, back to front; is_opaque picks the kind. Gives NULL on failure. */
static struct item *collect(const struct gl_frame *frame, bool is_opaque, size_t *n_items, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    struct gl_frame context = *frame;
    struct mat4 clip_from_lps_mm;
    for (int i = 0; i < 16; i++)
        clip_from_lps_mm.m[i] = (double)frame->clip_from_lps[i];
    struct visible_surface *visible =
        visible_surfaces(snapshot, frame->camera, &clip_from_lps_mm, is_opaque, bounds, &context, n_items, err);
    struct item *items = visible ? mem_array(*n_items, sizeof *items, UINT64_MAX, err) : NULL;
    for (size_t i = 0; items && i < *n_items; i++) {
        const struct gl_surface *surface = surface_of(frame, visible[i].region, err);
        if (!surface) { /* it was there a moment ago, so this does not come about */
            free(items);
            items = NULL;
            break;
        }
        items[i] = (struct item){ surface, visible[i].style };
    }
    free(visible);
    return items;
}

static void use_culling(const struct gl *gl)
{
    gl->FrontFace(GL_CW); /* counter-clockwise, in a picture drawn upside down */
    gl->CullFace(GL_BACK);
    gl->Enable(GL_CULL_FACE);
    gl->Enable(GL_DEPTH_TEST);
}

static void use_surface_program(const struct gl_frame *frame)
{
    const struct gl *gl = frame->gl;
    const struct camera *camera = frame->camera;
    const struct scene_surface_style *style = &frame->snapshot->scene.surface;
    const struct gl_program *program = style->normals == SCENE_NORMALS_FACE ? &frame->programs->faceted : &frame->programs->smooth;
    const struct vec3 *r = &camera->right, *u = &camera->up, *f = &camera->forward, *e = &camera->eye_lps_mm;
    const float eye_from_lps[9] = { (float)r->x, (float)u->x, (float)-f->x, (float)r->y, (float)u->y,
                                    (float)-f->y, (float)r->z, (float)u->z, (float)-f->z };
    gl->UseProgram(program->name);
    gl->UniformMatrix4fv(program->clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->UniformMatrix3fv(program->eye_from_lps, 1, GL_FALSE, eye_from_lps);
    if (camera->is_parallel)
        gl->Uniform4f(program->viewer, (float)-f->x, (float)-f->y, (float)-f->z, 0);
    else
        gl->Uniform4f(program->viewer, (float)e->x, (float)e->y, (float)e->z, 1);
}

static void draw_item(const struct gl_frame *frame, const struct item *item)
{
    const struct gl *gl = frame->gl;
    const struct scene_surface_style *style = &frame->snapshot->scene.surface;
    const struct gl_program *program = style->normals == SCENE_NORMALS_FACE ? &frame->programs->faceted : &frame->programs->smooth;
    uint32_t rgb = item->style->color_rgb;
    bool is_rim = item->style->opacity < 1 && style->translucency == SCENE_TRANSLUCENCY_RIM;
    gl->Uniform4f(program->color, (float)(rgb >> 16 & 255) / 255.0f, (float)(rgb >> 8 & 255) / 255.0f, (float)(rgb & 255) / 255.0f, 1);
    gl->Uniform1f(program->opacity, (float)item->style->opacity);
    gl->Uniform1i(program->is_rim, is_rim);
    gl->BindVertexArray(item->surface->vertex_array);
    gl->DrawElements(GL_TRIANGLES, item->surface->n_indices, GL_UNSIGNED_INT, NULL);
    frame->timing->n_triangles += item->surface->n_triangles;
    frame->timing->is_light |= item->surface->is_light;
}

bool gl_draw_opaque_surfaces(const struct gl_frame *frame, struct error *err)
{
    size_t n;
    struct item *items = collect(frame, true, &n, err);
    if (!items)
        return false;
    use_culling(frame->gl);
    use_surface_program(frame);
    for (size_t i = n; i-- > 0;)
        draw_item(frame, &items[i]);
    frame->gl->Disable(GL_CULL_FACE);
    free(items);
    return gl_check(frame->gl, "drawing opaque surfaces", err);
}

/* The layers over the picture. */
static void compose(const struct gl_frame *frame, int n)
{
    const struct gl *gl = frame->gl;
    const struct gl_program *program = &frame->programs->compose;
    bool is_exact = frame->snapshot->scene.surface.translucent_order == SCENE_TRANSLUCENT_ORDER_EXACT;
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->over);
    gl->Disable(GL_CULL_FACE);
    gl->Disable(GL_DEPTH_TEST);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_ONE, GL_SRC_ALPHA, GL_ZERO, GL_ONE);
    gl->UseProgram(program->name);
    gl->Uniform1i(program->source, 0);
    gl->Uniform1i(program->depths, 1);
    gl->Uniform1i(program->before, 2);
    gl->Uniform1i(program->n_layers, n);
    gl->Uniform1f(program->rank_depth, is_exact ? (float)VISIBLE_RANK_DEPTH : 0);
    gl->ActiveTexture(GL_TEXTURE2);
    gl->BindTexture(GL_TEXTURE_2D, frame->target->depth);
    gl->ActiveTexture(GL_TEXTURE1);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, frame->layers->depth);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, frame->layers->color);
    gl->BindVertexArray(frame->no_vertices);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl->ActiveTexture(GL_TEXTURE1);
    gl->BindTexture(GL_TEXTURE_2D_ARRAY, 0);
    gl->ActiveTexture(GL_TEXTURE2);
    gl->BindTexture(GL_TEXTURE_2D, 0);
    gl->ActiveTexture(GL_TEXTURE0);
    gl->Disable(GL_BLEND);
    gl->BindFramebuffer(GL_FRAMEBUFFER, frame->target->framebuffer);
}

bool gl_draw_translucent_surfaces(const struct gl_frame *frame, struct error *err)
{
    size_t n;
    struct item *items = collect(frame, false, &n, err);
    if (!items)
        return false;
    bool is_good = n == 0 || gl_layers_resize(frame->gl, frame->layers, frame->target, n < GL_LAYERS_MAX ? (int)n : GL_LAYERS_MAX, err);
    for (size_t first = 0; is_good && first < n; first += GL_LAYERS_MAX) {
        int n_here = n - first < GL_LAYERS_MAX ? (int)(n - first) : GL_LAYERS_MAX;
        use_culling(frame->gl);
        use_surface_program(frame);
        for (int i = 0; i < n_here; i++) {
            gl_layers_bind(frame->gl, frame->layers, i);
            draw_item(frame, &items[first + (size_t)i]);
        }
        compose(frame, n_here);
    }
    free(items);
    return is_good && gl_check(frame->gl, "drawing translucent surfaces", err);
}

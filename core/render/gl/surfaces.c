#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/render/gl/draw.h"

/* One surface to draw. */
struct item {
    const struct gl_surface *surface;
    const struct scene_region_style *style;
    double distance_mm; /* from the eye to the nearest point of its box */
    int depth;          /* in the hierarchy */
    uint64_t n_voxels;
};

static double nearest_mm(const struct camera *camera, const struct box3 *box)
{
    if (camera->is_parallel) {
        struct vec3 f = camera->forward;
        struct vec3 corner = vec3(f.x > 0 ? box->low.x : box->high.x, f.y > 0 ? box->low.y : box->high.y, f.z > 0 ? box->low.z : box->high.z);
        return vec3_dot(vec3_sub(corner, camera->eye_lps_mm), f);
    }
    struct vec3 e = camera->eye_lps_mm;
    struct vec3 p = vec3(fmin(fmax(e.x, box->low.x), box->high.x), fmin(fmax(e.y, box->low.y), box->high.y),
                         fmin(fmax(e.z, box->low.z), box->high.z));
    return vec3_length(vec3_sub(p, e));
}

/* Nearest depth of a box along the line of sight: beyond near, nothing of it is cut away. */
static bool is_wholly_ahead(const struct camera *camera, const struct box3 *box)
{
    struct vec3 f = camera->forward;
    struct vec3 corner = vec3(f.x > 0 ? box->low.x : box->high.x, f.y > 0 ? box->low.y : box->high.y, f.z > 0 ? box->low.z : box->high.z);
    return vec3_dot(vec3_sub(corner, camera->eye_lps_mm), f) > camera->near_mm;
}

/* Whether a box lies beyond one side of the picture (or of the band being drawn). */
static bool is_out_of_sight(const struct gl_frame *frame, const struct box3 *box)
{
    const float *m = frame->clip_from_lps;
    int n_beyond[6] = { 0 };
    for (int corner = 0; corner < 8; corner++) {
        double x = corner & 1 ? box->high.x : box->low.x, y = corner & 2 ? box->high.y : box->low.y, z = corner & 4 ? box->high.z : box->low.z;
        double clip[4];
        for (int row = 0; row < 4; row++)
            clip[row] = m[row] * x + m[4 + row] * y + m[8 + row] * z + m[12 + row];
        for (int axis = 0; axis < 3; axis++) {
            n_beyond[2 * axis] += clip[axis] < -clip[3];
            n_beyond[2 * axis + 1] += clip[axis] > clip[3];
        }
    }
    for (int side = 0; side < 6; side++)
        if (n_beyond[side] == 8)
            return true;
    return false;
}

static bool is_drawn(const struct snapshot *snapshot, size_t region)
{
    const struct scene_region_style *style = &snapshot->styles[region];
    return style->visible && style->opacity > 0 && snapshot->plan->regions.regions[region].n_voxels > 0;
}

/* A region inside an opaque one, in the same label layer, cannot be seen: the outer surface is closed and encloses it. Unless the
 * eye is within the outer one's box, or the near plane cuts it open. */
static bool is_hidden(const struct gl_frame *frame, size_t region, bool *is_good, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    const struct region *regions = snapshot->plan->regions.regions;
    for (int outer = regions[region].parent; outer >= 0; outer = regions[outer].parent) {
        if (!is_drawn(snapshot, (size_t)outer) || snapshot->styles[outer].opacity < 1 || regions[outer].layer != regions[region].layer)
            continue;
        const struct gl_surface *surface =
            gl_cache_surface(frame->gl, frame->cache, snapshot->plan, (size_t)outer, frame->detail, err);
        *is_good = surface != NULL;
        if (!surface || is_wholly_ahead(frame->camera, &surface->bounds_lps_mm))
            return surface != NULL;
    }
    return false;
}

/* The surfaces that are wanted and can be seen; is_opaque picks the kind. Gives NULL on failure. */
static struct item *collect(const struct gl_frame *frame, bool is_opaque, size_t *n_items, struct error *err)
{
    const struct snapshot *snapshot = frame->snapshot;
    const struct region_set *set = &snapshot->plan->regions;
    struct item *items = mem_array(set->n_regions, sizeof *items, UINT64_MAX, err);
    *n_items = 0;
    for (size_t i = 0; items && i < set->n_regions; i++) {
        bool is_good = true;
        if (!is_drawn(snapshot, i) || (snapshot->styles[i].opacity >= 1) != is_opaque || is_hidden(frame, i, &is_good, err))
            continue;
        const struct gl_surface *surface =
            is_good ? gl_cache_surface(frame->gl, frame->cache, snapshot->plan, i, frame->detail, err) : NULL;
        if (!surface) {
            free(items);
            return NULL;
        }
        if (is_out_of_sight(frame, &surface->bounds_lps_mm))
            continue;
        items[(*n_items)++] = (struct item){ surface, &snapshot->styles[i], nearest_mm(frame->camera, &surface->bounds_lps_mm),
                                             region_depth(set, i), set->regions[i].n_voxels };
    }
    return items;
}

/* Back to front. What encloses another is never farther away, so at equal distances the inner one comes first. */
static int compare_back_to_front(const void *left, const void *right)
{
    const struct item *a = left, *b = right;
    if (a->distance_mm != b->distance_mm)
        return a->distance_mm > b->distance_mm ? -1 : 1;
    if (a->depth != b->depth)
        return a->depth > b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels < b->n_voxels ? -1 : 1;
    return a->style < b->style ? -1 : a->style > b->style;
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
    qsort(items, n, sizeof *items, compare_back_to_front);
    use_culling(frame->gl);
    use_surface_program(frame);
    for (size_t i = n; i-- > 0;)
        draw_item(frame, &items[i]);
    frame->gl->Disable(GL_CULL_FACE);
    free(items);
    return gl_check(frame->gl, "drawing opaque surfaces", err);
}

/* First its depth alone, then its colour where it is nearest: of a surface with folds only the front sheet blends. */
static void draw_front_sheet(const struct gl_frame *frame, const struct item *item)
{
    const struct gl *gl = frame->gl;
    gl->UseProgram(frame->programs->depth.name);
    gl->UniformMatrix4fv(frame->programs->depth.clip_from_lps, 1, GL_FALSE, frame->clip_from_lps);
    gl->ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    gl->BindVertexArray(item->surface->vertex_array);
    gl->DrawElements(GL_TRIANGLES, item->surface->n_indices, GL_UNSIGNED_INT, NULL);
    gl->ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);

    use_surface_program(frame);
    gl->DepthFunc(GL_EQUAL);
    gl->DepthMask(GL_FALSE);
    gl->Enable(GL_BLEND);
    gl->BlendFuncSeparate(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ZERO, GL_ONE);
    draw_item(frame, item);
    gl->Disable(GL_BLEND);
    gl->DepthMask(GL_TRUE);
    gl->DepthFunc(GL_LESS);
}

bool gl_draw_translucent_surfaces(const struct gl_frame *frame, struct error *err)
{
    size_t n;
    struct item *items = collect(frame, false, &n, err);
    if (!items)
        return false;
    qsort(items, n, sizeof *items, compare_back_to_front);
    use_culling(frame->gl);
    for (size_t i = 0; i < n; i++)
        draw_front_sheet(frame, &items[i]);
    frame->gl->Disable(GL_CULL_FACE);
    free(items);
    return gl_check(frame->gl, "drawing translucent surfaces", err);
}

#include "core/render/visible/overlay.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/render/visible/check.h"
#include "core/render/visible/cut.h"
#include "core/render/visible/paint.h"
#include "core/render/visible/visible.h"

/* Kept at most: three panes of all regions a plan can have, if their lines are not too many. */
enum { MAX_ENTRIES = 3 * REGION_MAX + 512, MAX_LINES = 2 << 20 }; /* 48 bytes each */
static const uint32_t grid_rgb = 0xf4f6f8, univel_rgb = 0xffffff;

enum lines_of { LINES_OF_OUTLINE, LINES_OF_BORDER, LINES_OF_SHAPE };

struct entry {
    const struct plan *plan;
    size_t region;
    enum lines_of what;
    enum outline_method method;
    struct shape_key key; /* of a shape */
    struct plane plane;
    struct cut_lines lines;
    bool is_open;   /* a shape that encloses nothing */
    bool is_absent; /* the region cannot be shown in this way */
    struct entry *next;
};

struct overlay {
    struct entry *first; /* newest first */
};

struct overlay *overlay_create(void)
{
    return mem_new(sizeof(struct overlay));
}

static void entry_destroy(struct entry *entry)
{
    cut_lines_finish(&entry->lines);
    free(entry);
}

void overlay_forget(struct overlay *overlay, const struct plan *plan)
{
    for (struct entry **at = &overlay->first; *at;) {
        struct entry *entry = *at;
        if (plan && entry->plan != plan) {
            at = &entry->next;
            continue;
        }
        *at = entry->next;
        entry_destroy(entry);
    }
}

void overlay_destroy(struct overlay *overlay)
{
    if (!overlay)
        return;
    overlay_forget(overlay, NULL);
    free(overlay);
}

/* ---- lines, made and kept --------------------------------------------------------------------------------------- */

static bool is_same(const struct entry *a, const struct entry *b)
{
    return a->plan == b->plan && a->region == b->region && a->what == b->what && a->method == b->method &&
           shape_key_equal(&a->key, &b->key) && plane_equal(&a->plane, &b->plane);
}

static bool fill_univels(struct entry *entry, struct error *err)
{
    struct cut_region cut;
    struct mask *mask;
    if (!cut_region_init(&cut, &entry->plan->regions, entry->region, err))
        return false;
    bool is_good = cut_univels(&cut, &entry->plane, &mask, err);
    if (is_good && mask)
        is_good = entry->what == LINES_OF_BORDER ? cut_borders(mask, &entry->lines, err)
                                                 : cut_outlines(mask, entry->method, &entry->lines, err);
    mask_destroy(mask);
    cut_region_finish(&cut);
    return is_good;
}

static bool fill_shape(struct entry *entry, struct derive *derived, struct error *err)
{
    struct error why = { 0 };
    struct shape *shape =
        derive_shape(derived, &(struct shape_want){ subject_region(entry->region), entry->key, SURFACE_FULL }, NULL,
                     &why);
    entry->is_absent = !shape && derive_is_refusal(why.code);
    entry->is_open = entry->key.representation == REPRESENTATION_FAN;
    bool is_good = shape ? cut_mesh(shape->mesh, &entry->plane, &entry->lines, &why) : entry->is_absent;
    shape_unref(shape);
    if (!is_good && err)
        *err = why;
    return is_good;
}

/* Drops the oldest beyond what is kept. */
static void trim(struct overlay *overlay)
{
    struct entry **at = &overlay->first;
    size_t n_lines = 0;
    for (size_t i = 0; *at && i < MAX_ENTRIES && (n_lines += (*at)->lines.n) <= MAX_LINES; i++)
        at = &(*at)->next;
    while (*at) {
        struct entry *entry = *at;
        *at = entry->next;
        entry_destroy(entry);
    }
}

/* Borrowed until the next picture. */
static const struct entry *lines_of(struct overlay *overlay, struct derive *derived, const struct entry *wanted,
                                    struct error *err)
{
    for (struct entry **at = &overlay->first; *at; at = &(*at)->next)
        if (is_same(*at, wanted)) {
            struct entry *entry = *at;
            *at = entry->next;
            entry->next = overlay->first;
            overlay->first = entry;
            return entry;
        }
    struct entry *made = mem_new(sizeof *made);
    *made = *wanted;
    if (!(made->what == LINES_OF_SHAPE ? fill_shape(made, derived, err) : fill_univels(made, err))) {
        entry_destroy(made);
        return NULL;
    }
    made->next = overlay->first;
    overlay->first = made;
    return made;
}

/* ---- painting --------------------------------------------------------------------------------------------------- */

struct job {
    struct overlay *overlay;
    const struct snapshot *snapshot;
    const struct camera *camera;
    struct image *image;
    struct paint *paint;
    double scale; /* pixels of this picture to one of the full one */
};

static struct paint_point project(const struct job *job, const double p[3])
{
    struct vec3 clip = mat4_project(&job->camera->clip_from_lps_mm, vec3(p[0], p[1], p[2]));
    return (struct paint_point){ (clip.x + 1) / 2 * job->image->width_px, (1 - clip.y) / 2 * job->image->height_px };
}

static void paint_lines(const struct job *job, const struct cut_lines *lines, double width_px, uint32_t rgb)
{
    for (size_t i = 0; i < lines->n; i++)
        paint_line(job->paint, project(job, lines->ends_lps_mm[i][0]), project(job, lines->ends_lps_mm[i][1]),
                   fmax(1, width_px * job->scale));
    paint_flush(job->paint, rgb, 1);
}

static bool paint_outline(const struct job *job, size_t region, struct error *err)
{
    const struct snapshot *snapshot = job->snapshot;
    const struct scene_outline_style *style = &snapshot->scene.outline;
    struct entry wanted = { .plan = snapshot->plan,
                            .region = region,
                            .what = LINES_OF_OUTLINE,
                            .plane = snapshot->pane,
                            .method = style->method == SCENE_OUTLINE_METHOD_TRACED ? OUTLINE_TRACED
                                                                                   : OUTLINE_MARCHING_SQUARES };
    const struct entry *found = lines_of(job->overlay, snapshot->derived, &wanted, err);
    if (found)
        paint_lines(job, &found->lines, style->width_px, snapshot->styles[region].color_rgb);
    return found != NULL;
}

static bool paint_check(const struct job *job, size_t region, struct check_counts *check, struct error *err)
{
    const struct snapshot *snapshot = job->snapshot;
    struct entry wanted = {
        .plan = snapshot->plan, .region = region, .what = LINES_OF_SHAPE, .key = visible_checked_key(snapshot, region)
    };
    const struct grid *grid = &snapshot->plan->regions.layers[snapshot->plan->regions.regions[region].layer]->grid;
    struct vec3 spacing = grid_spacing_mm(grid);
    /* never along faces of voxels */
    wanted.plane = plane_moved(&snapshot->pane, CHECK_NUDGE * fmin(fmin(spacing.x, spacing.y), spacing.z));
    const struct entry *surface = lines_of(job->overlay, snapshot->derived, &wanted, err);
    struct cut_region cut;
    if (!surface || !cut_region_init(&cut, &snapshot->plan->regions, region, err))
        return false;
    bool is_good = surface->is_open || surface->is_absent ||
                   check_paint(&cut, &surface->lines, job->camera, &wanted.plane, job->image, job->scale, check, err);
    cut_region_finish(&cut);
    struct entry border = { .plan = snapshot->plan, .region = region, .what = LINES_OF_BORDER, .plane = wanted.plane };
    const struct entry *univels = is_good ? lines_of(job->overlay, snapshot->derived, &border, err) : NULL;
    if (!univels)
        return false;
    paint_lines(job, &univels->lines, 1, univel_rgb);
    paint_lines(job, &surface->lines, snapshot->scene.outline.width_px, snapshot->styles[region].color_rgb);
    return true;
}

struct ranked {
    size_t region;
    int order, depth;
    uint64_t n_voxels;
};

/* What is on top comes last: the higher order, the inner, the smaller. */
static int compare_ranks(const void *left, const void *right)
{
    const struct ranked *a = left, *b = right;
    if (a->order != b->order)
        return a->order < b->order ? -1 : 1;
    if (a->depth != b->depth)
        return a->depth < b->depth ? -1 : 1;
    if (a->n_voxels != b->n_voxels)
        return a->n_voxels > b->n_voxels ? -1 : 1;
    return a->region < b->region ? -1 : 1;
}

static bool paint_regions(const struct job *job, struct check_counts *check, struct error *err)
{
    const struct snapshot *snapshot = job->snapshot;
    const struct region_set *set = &snapshot->plan->regions;
    struct ranked *ranks = mem_array(set->n_regions, sizeof *ranks, UINT64_MAX, err);
    size_t n = 0;
    bool is_good = ranks != NULL;
    for (size_t i = 0; is_good && i < set->n_regions; i++)
        if (snapshot->styles[i].visible && snapshot->styles[i].opacity > 0 && set->regions[i].n_voxels > 0)
            ranks[n++] =
                (struct ranked){ i, (int)snapshot->styles[i].order, region_depth(set, i), set->regions[i].n_voxels };
    if (is_good)
        qsort(ranks, n, sizeof *ranks, compare_ranks);
    for (size_t i = 0; is_good && i < n; i++) {
        size_t region = ranks[i].region;
        if (visible_is_checked(snapshot, region))
            is_good = paint_check(job, region, check, err);
        else if (snapshot->scene.outline.on_slices)
            is_good = paint_outline(job, region, err);
    }
    free(ranks);
    return is_good;
}

/* ---- the dose's grid -------------------------------------------------------------------------------------------- */

/* The part of an edge before the eye; false: none. */
static bool cut_before_eye(const struct camera *camera, double a[3], double b[3])
{
    const double *m = camera->clip_from_lps_mm.m, least = fmax(1e-3, camera->near_mm / 10);
    double wa = m[3] * a[0] + m[7] * a[1] + m[11] * a[2] + m[15], wb = m[3] * b[0] + m[7] * b[1] + m[11] * b[2] + m[15];
    if (camera->is_parallel || (wa >= least && wb >= least))
        return true;
    if (wa < least && wb < least)
        return false;
    double t = (least - wa) / (wb - wa), *cut = wa < least ? a : b;
    for (int i = 0; i < 3; i++)
        cut[i] = a[i] + t * (b[i] - a[i]);
    return true;
}

static void paint_box(const struct job *job, const struct grid *grid)
{
    struct vec3 corners[8];
    cut_grid_corners(grid, corners);
    for (int corner = 0; corner < 8; corner++)
        for (int axis = 1; axis < 8; axis *= 2) {
            const struct vec3 *p = &corners[corner & ~axis], *q = &corners[corner | axis];
            double a[3] = { p->x, p->y, p->z }, b[3] = { q->x, q->y, q->z };
            if (!(corner & axis) && cut_before_eye(job->camera, a, b))
                paint_line(job->paint, project(job, a), project(job, b), fmax(1, 1.5 * job->scale));
        }
}

/* Components of a dose may have grids of their own. */
static bool paint_dose_grid(const struct job *job, struct error *err)
{
    const struct dose *dose = &job->snapshot->plan->doses[job->snapshot->dose];
    bool is_good = true;
    for (size_t i = 0; is_good && i < dose->n_components; i++) {
        const struct grid *grid = &dose->components[i].values->grid;
        if (!snapshot_is_pane(job->snapshot)) {
            paint_box(job, grid);
            continue;
        }
        struct cut_lines lines = { 0 };
        is_good = cut_grid(grid, &job->snapshot->pane, &lines, err);
        for (size_t l = 0; l < lines.n; l++)
            paint_line(job->paint, project(job, lines.ends_lps_mm[l][0]), project(job, lines.ends_lps_mm[l][1]),
                       fmax(1, 1.5 * job->scale));
        cut_lines_finish(&lines);
    }
    paint_flush(job->paint, grid_rgb, 1);
    return is_good;
}

bool overlay_draw(struct overlay *overlay, const struct snapshot *snapshot, const struct camera *camera,
                  struct image *image, struct check_counts *check, struct error *err)
{
    struct check_counts unwanted;
    bool has_lines = snapshot_is_pane(snapshot) && (snapshot->scene.outline.on_slices || snapshot->scene.check.visible);
    bool has_grid = snapshot->scene.dose.grid && snapshot->dose >= 0;
    check = check ? check : &unwanted;
    *check = (struct check_counts){ 0, 0 };
    if (!has_lines && !has_grid)
        return true;
    struct job job = {
        overlay, snapshot, camera, image, paint_create(image, err), (double)image->width_px / snapshot->view.size_px[0]
    };
    bool is_good =
        job.paint && (!has_lines || paint_regions(&job, check, err)) && (!has_grid || paint_dose_grid(&job, err));
    paint_destroy(job.paint);
    trim(overlay);
    return is_good;
}

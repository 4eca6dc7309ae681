/* Executes the overlay of a draw list: computes where planes cut regions and grids, keeps these lines, paints them. */
#include "core/render/visible/overlay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/derive/shape_slabs.h"
#include "core/render/visible/axes_paint.h"
#include "core/render/visible/beam_eye_marks.h"
#include "core/render/visible/check.h"
#include "core/render/visible/cut.h"
#include "core/render/visible/paint.h"
#include "core/render/visible/space_pen.h"

/* Limits of what is kept: the lines of three panes of all regions that a plan can have, and 96 MiB of lines and strokes
 * when a picture is done; while it is drawn, no strokes are added after the first 96 MiB of them. */
enum { MAX_ENTRIES = 3 * REGION_MAX + 512, MAX_BYTES = 96 << 20 };
static const uint32_t univel_rgb = 0xffffff;
/* Under outlines, to keep light lines readable on bone. */
static const uint32_t halo_rgb = 0x07080a;
static const double halo_px = 1;
/* How strong lines are in the strip at the foot of a slice, and the part of its height in which they fade to that. */
static const double foot_strength = 0.3, foot_fading = 0.2;

enum lines_of { LINES_OF_OUTLINE, LINES_OF_BORDER, LINES_OF_SHAPE };

/* Maps a pane's patient coordinates to pixels: x = p . x + x[3]. A parallel view has no division. */
struct pane_pixels {
    double x[4], y[4];
};

/* Lines as pixels, kept while a pane shows them in the same place: another beam or dose over it leaves them alone. */
struct stroked {
    struct pane_pixels pixels;
    double width_px;
    int32_t size_px[2];            /* of the picture */
    struct paint_strokes *strokes; /* NULL: these lines were painted so only once */
};

enum stroke_of { STROKE_OF_HALO, STROKE_OF_LINE, N_STROKES };

struct entry {
    const struct plan *plan;
    struct subject subject; /* a region */
    enum lines_of what;
    enum outline_method method;
    struct shape_key key; /* LINES_OF_SHAPE */
    struct plane plane;
    struct cut_lines lines;
    bool is_open;   /* LINES_OF_SHAPE: its lines enclose nothing */
    bool is_absent; /* LINES_OF_SHAPE: the region has no such shape */
    struct stroked stroked[N_STROKES];
    struct entry *next;
};

struct overlay {
    struct entry *first; /* most recently used first */
};

struct overlay *overlay_create(void)
{
    return mem_new(sizeof(struct overlay));
}

static void entry_destroy(struct entry *entry)
{
    cut_lines_finish(&entry->lines);
    for (size_t i = 0; i < N_STROKES; i++)
        paint_strokes_destroy(entry->stroked[i].strokes);
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
    return a->plan == b->plan && subject_equal(a->subject, b->subject) && a->what == b->what &&
           a->method == b->method && shape_key_equal(&a->key, &b->key) && plane_equal(&a->plane, &b->plane);
}

static bool fill_univels(struct entry *entry, struct error *err)
{
    struct cut_region cut;
    struct mask *mask;
    if (!cut_region_init(&cut, &entry->plan->regions, entry->subject.index, err))
        return false;
    bool is_good = cut_univels(&cut, &entry->plane, &mask, err);
    if (is_good && mask)
        is_good = entry->what == LINES_OF_BORDER ? cut_borders(mask, &entry->lines, err)
                                                 : cut_outlines(mask, entry->method, &entry->lines, err);
    mask_destroy(mask);
    cut_region_finish(&cut);
    return is_good;
}

/* With fewer triangles a search of all of them takes no time. */
enum { MIN_INDEXED_TRIANGLES = 4096 };

static bool cut_shape(struct entry *entry, struct derive *derived, const struct shape *shape, struct error *err)
{
    int axis = cut_axis(&entry->plane);
    struct shape_slabs *slabs = NULL;
    if (axis >= 0 && shape->mesh->n_triangles >= MIN_INDEXED_TRIANGLES) {
        slabs = shape_slabs_get(derived, &(struct shape_want){ entry->subject, entry->key, SURFACE_FULL }, shape, axis,
                                err);
        if (!slabs)
            return false;
    }
    bool is_good = cut_mesh(shape->mesh, slabs ? slabs->slabs : NULL, &entry->plane, &entry->lines, err);
    derive_result_unref(slabs ? &slabs->base : NULL);
    return is_good;
}

static bool fill_shape(struct entry *entry, struct derive *derived, struct error *err)
{
    struct error why = { 0 };
    struct shape *shape =
        derive_shape(derived, &(struct shape_want){ entry->subject, entry->key, SURFACE_FULL }, NULL, &why);
    entry->is_absent = !shape && derive_is_refusal(why.code);
    entry->is_open = entry->key.representation == REPRESENTATION_FAN;
    bool is_good = shape ? cut_shape(entry, derived, shape, &why) : entry->is_absent;
    shape_unref(shape);
    if (!is_good && err)
        *err = why;
    return is_good;
}

static size_t entry_bytes(const struct entry *entry)
{
    size_t n = entry->lines.n * sizeof *entry->lines.ends_lps_mm;
    for (size_t i = 0; i < N_STROKES; i++)
        n += paint_strokes_bytes(entry->stroked[i].strokes);
    return n;
}

/* Drops the least recently used beyond the limits. */
static void trim(struct overlay *overlay)
{
    struct entry **at = &overlay->first;
    size_t n_bytes = 0;
    for (size_t i = 0; *at && i < MAX_ENTRIES && (n_bytes += entry_bytes(*at)) <= MAX_BYTES; i++)
        at = &(*at)->next;
    while (*at) {
        struct entry *entry = *at;
        *at = entry->next;
        entry_destroy(entry);
    }
}

/* The lines that are wanted, kept or computed now; borrowed until trim. NULL on failure. */
static struct entry *lines_of(struct overlay *overlay, struct derive *derived, const struct entry *wanted,
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

/* The picture that is painted over. */
struct target {
    struct overlay *overlay;
    const struct draw_scope *scope;
    struct image *image;
    struct paint *paint;
    struct paint *alone; /* as large, for the lines of one entry; NULL: not needed yet */
    size_t n_kept_bytes; /* of strokes that were kept for this picture */
    double scale;        /* pixels of this picture to one of the full one */
    struct check_counts *check;
};

static struct paint_point project(const struct target *target, const double p[3])
{
    struct vec3 clip = mat4_project(&target->scope->camera->clip_from_lps_mm, vec3(p[0], p[1], p[2]));
    return (struct paint_point){ (clip.x + 1) / 2 * target->image->width_px,
                                 (1 - clip.y) / 2 * target->image->height_px };
}

static struct pane_pixels pane_pixels(const struct target *target)
{
    const double *m = target->scope->camera->clip_from_lps_mm.m;
    double half_width = target->image->width_px / 2.0, half_height = target->image->height_px / 2.0;
    struct pane_pixels pixels;
    for (size_t i = 0; i < 4; i++) {
        pixels.x[i] = m[4 * i] * half_width + (i == 3 ? half_width : 0);
        pixels.y[i] = -m[4 * i + 1] * half_height + (i == 3 ? half_height : 0);
    }
    return pixels;
}

static inline struct paint_point on_pane(const struct pane_pixels *pixels, const double p[3])
{
    const double *x = pixels->x, *y = pixels->y;
    return (struct paint_point){ x[0] * p[0] + x[1] * p[1] + x[2] * p[2] + x[3],
                                 y[0] * p[0] + y[1] * p[1] + y[2] * p[2] + y[3] };
}

static void stroke_into(struct paint *paint, const struct cut_lines *lines, const struct pane_pixels *pixels,
                        double width_px)
{
    for (size_t i = 0; i < lines->n; i++)
        paint_line(paint, on_pane(pixels, lines->ends_lps_mm[i][0]), on_pane(pixels, lines->ends_lps_mm[i][1]),
                   width_px);
}

/* Strokes lines of a slice pane. */
static void stroke(const struct target *target, const struct cut_lines *lines, double width_px)
{
    const struct pane_pixels pixels = pane_pixels(target);
    stroke_into(target->paint, lines, &pixels, fmax(1, width_px * target->scale));
}

static bool is_stroked_so(const struct stroked *a, const struct stroked *b)
{
    return memcmp(&a->pixels, &b->pixels, sizeof a->pixels) == 0 && a->width_px == b->width_px &&
           a->size_px[0] == b->size_px[0] && a->size_px[1] == b->size_px[1];
}

/* Keeps the lines as pixels if memory and limit allow; else they are painted anew each time. */
static void keep_strokes(struct target *target, const struct entry *entry, struct stroked *kept)
{
    if (target->n_kept_bytes > MAX_BYTES)
        return;
    target->alone = target->alone ? target->alone : paint_create(target->image, NULL);
    if (!target->alone)
        return;
    stroke_into(target->alone, &entry->lines, &kept->pixels, kept->width_px);
    kept->strokes = paint_take(target->alone, NULL);
    if (!kept->strokes) {
        paint_destroy(target->alone); /* with what is queued in it */
        target->alone = NULL;
    }
    target->n_kept_bytes += paint_strokes_bytes(kept->strokes);
}

/* Like stroke(), for cached lines: once painted twice in the same place, they are kept as pixels. */
static void stroke_entry(struct target *target, struct entry *entry, enum stroke_of of, double width_px)
{
    struct stroked *kept = &entry->stroked[of];
    const struct stroked wanted = { .pixels = pane_pixels(target),
                                    .width_px = fmax(1, width_px * target->scale),
                                    .size_px = { target->image->width_px, target->image->height_px } };
    if (!is_stroked_so(kept, &wanted)) {
        paint_strokes_destroy(kept->strokes);
        *kept = wanted;
    } else if (!kept->strokes)
        keep_strokes(target, entry, kept);
    if (kept->strokes)
        paint_queue(target->paint, kept->strokes);
    else
        stroke_into(target->paint, &entry->lines, &wanted.pixels, wanted.width_px);
}

static void paint_lines(const struct target *target, const struct cut_lines *lines, double width_px, uint32_t rgb)
{
    stroke(target, lines, width_px);
    paint_flush(target->paint, rgb, 1);
}

static void paint_strokes(const struct target *target, const struct draw *draw)
{
    stroke(target, draw->strokes.lines, draw->strokes.width_px);
    paint_flush(target->paint, draw->color_rgb, draw->opacity);
}

/* The lines of an outline, borrowed until trim: of the surface; of univels if these are wanted, if the surface is not
 * built and must not be waited for, or if the region cannot have it. NULL on failure. */
static struct entry *outline_lines(const struct target *target, const struct draw *draw, struct error *err)
{
    struct derive *derived = target->scope->snapshot->derived;
    const struct shape_want want = { draw->subject, draw->lines.key, SURFACE_FULL };
    struct entry wanted = { .plan = target->scope->snapshot->plan, .subject = draw->subject, .plane = draw->plane };
    if (draw->lines.is_of_surface && (!draw->lines.may_be_univels || derive_shape_is_ready(derived, &want))) {
        wanted.what = LINES_OF_SHAPE;
        wanted.key = draw->lines.key;
        struct entry *found = lines_of(target->overlay, derived, &wanted, err);
        if (!found || !found->is_absent)
            return found;
        wanted.key = (struct shape_key){ 0 };
    }
    wanted.what = LINES_OF_OUTLINE;
    wanted.method = draw->lines.method;
    return lines_of(target->overlay, derived, &wanted, err);
}

/* Strokes outlines with dark lines a pixel wider to each side, all before the first outline is painted, so that none
 * covers another's line. */
static bool paint_halos(struct target *target, const struct draw_list *list, struct error *err)
{
    for (size_t i = list->n_in_image; i < list->n; i++) {
        const struct draw *draw = &list->draws[i];
        if (draw->kind == DRAW_ISOLINES)
            stroke(target, draw->isolines.lines, draw->isolines.width_px + 2 * halo_px);
        else if (draw->kind == DRAW_STROKES && draw->opacity >= 1)
            stroke(target, draw->strokes.lines, draw->strokes.width_px + 2 * halo_px);
        else if (draw->kind == DRAW_OUTLINE) {
            struct entry *entry = outline_lines(target, draw, err);
            if (!entry)
                return false;
            stroke_entry(target, entry, STROKE_OF_HALO, draw->lines.width_px + 2 * halo_px);
        }
    }
    paint_flush(target->paint, halo_rgb, 1);
    return true;
}

static bool paint_outline(struct target *target, const struct draw *draw, struct error *err)
{
    struct entry *entry = outline_lines(target, draw, err);
    if (!entry)
        return false;
    stroke_entry(target, entry, STROKE_OF_LINE, draw->lines.width_px);
    paint_flush(target->paint, draw->color_rgb, 1);
    return true;
}

static bool paint_check(const struct target *target, const struct draw *draw, struct error *err)
{
    const struct plan *plan = target->scope->snapshot->plan;
    struct derive *derived = target->scope->snapshot->derived;
    size_t region = draw->subject.index;
    struct vec3 spacing = grid_spacing_mm(&plan->regions.layers[plan->regions.regions[region].layer]->grid);
    /* beside the plane, so that it never runs along faces of voxels */
    struct plane plane = plane_moved(&draw->plane, CHECK_NUDGE * fmin(fmin(spacing.x, spacing.y), spacing.z));
    const struct entry wanted = {
        .plan = plan, .subject = draw->subject, .what = LINES_OF_SHAPE, .plane = plane, .key = draw->lines.key
    };
    const struct entry border = { .plan = plan, .subject = draw->subject, .what = LINES_OF_BORDER, .plane = plane };
    const struct entry *surface = lines_of(target->overlay, derived, &wanted, err);
    struct cut_region cut;
    if (!surface || !cut_region_init(&cut, &plan->regions, region, err))
        return false;
    bool is_good = surface->is_open || surface->is_absent ||
                   check_paint(&cut, &surface->lines, target->scope->camera, &plane, target->image, target->scale,
                               target->check, err);
    cut_region_finish(&cut);
    const struct entry *univels = is_good ? lines_of(target->overlay, derived, &border, err) : NULL;
    if (!univels)
        return false;
    paint_lines(target, &univels->lines, 1, univel_rgb);
    paint_lines(target, &surface->lines, draw->lines.width_px, draw->color_rgb);
    return true;
}

/* ---- the dose's grid -------------------------------------------------------------------------------------------- */

static struct space_pen pen_of(const struct target *target)
{
    return (struct space_pen){ target->scope->snapshot, target->scope->camera,    target->paint,
                               target->image->width_px, target->image->height_px, target->scale };
}

static void add_box(const struct target *target, const struct grid *grid, double width_px)
{
    const struct space_pen pen = pen_of(target);
    struct vec3 corners[8];
    cut_grid_corners(grid, corners);
    for (int corner = 0; corner < 8; corner++)
        for (int axis = 1; axis < 8; axis *= 2) {
            const struct vec3 *p = &corners[corner & ~axis], *q = &corners[corner | axis];
            if (!(corner & axis))
                space_pen_line(&pen, *p, *q, width_px);
        }
}

/* Components of a dose may have grids of their own. */
static bool paint_dose_grid(const struct target *target, const struct draw *draw, struct error *err)
{
    const struct dose *dose = &target->scope->snapshot->plan->doses[draw->subject.index];
    double width_px = fmax(1, draw->lines.width_px * target->scale);
    bool is_good = true;
    for (size_t i = 0; is_good && i < dose->n_components; i++) {
        const struct grid *grid = &dose->components[i].values->grid;
        if (draw->kind == DRAW_GRID_BOX) {
            add_box(target, grid, width_px);
            continue;
        }
        struct cut_lines lines = { 0 };
        is_good = cut_grid(grid, &draw->plane, &lines, err);
        for (size_t l = 0; l < lines.n; l++)
            paint_line(target->paint, project(target, lines.ends_lps_mm[l][0]),
                       project(target, lines.ends_lps_mm[l][1]), width_px);
        cut_lines_finish(&lines);
    }
    paint_flush(target->paint, draw->color_rgb, 1);
    return is_good;
}

static void paint_beam_eye(const struct target *target)
{
    struct beam_eye_marks marks;
    if (beam_eye_marks_of(target->scope->snapshot, target->scope->camera, &marks))
        beam_eye_paint(&marks, target->scope->camera, target->scale, target->paint);
}

static bool paint_draw(struct target *target, const struct draw *draw, struct error *err)
{
    switch (draw->kind) {
    case DRAW_OUTLINE: return paint_outline(target, draw, err);
    case DRAW_ISOLINES: paint_lines(target, draw->isolines.lines, draw->isolines.width_px, draw->color_rgb); break;
    case DRAW_CHECK: return paint_check(target, draw, err);
    case DRAW_GRID_CUT:
    case DRAW_GRID_BOX: return paint_dose_grid(target, draw, err);
    case DRAW_STROKES: paint_strokes(target, draw); break;
    case DRAW_AXES: {
        const struct space_pen pen = pen_of(target);
        axes_paint(&pen, draw->color_rgb, draw->lines.width_px);
        break;
    }
    case DRAW_BEAM_EYE: paint_beam_eye(target); break;
    case DRAW_SHAPE:
    case DRAW_IMAGE:
    case DRAW_LABELS:
    case DRAW_CAP:
    case DRAW_VOLUME:
    case DRAW_TRACKS:
    case DRAW_WASH:
    case DRAW_MARKS: break; /* a back end's */
    }
    return true;
}

/* ---- the strip at the foot of a slice ---------------------------------------------------------------------------- */

/* Its rows as they are before lines are painted. */
struct foot {
    int n_rows; /* 0: there is no strip */
    uint8_t *rgba;
};

static size_t foot_first(const struct foot *foot, const struct image *image)
{
    return 4 * (size_t)image->width_px * (size_t)(image->height_px - foot->n_rows);
}

static bool foot_keep(const struct target *target, struct foot *foot, struct error *err)
{
    const struct image *image = target->image;
    const struct snapshot *snapshot = target->scope->snapshot;
    const double height_px = snapshot_is_pane(snapshot) ? snapshot->view.foot_px * target->scale : 0;
    foot->n_rows = (int)lround(fmin(height_px, image->height_px));
    if (foot->n_rows == 0)
        return true;
    const size_t n = 4 * (size_t)image->width_px * (size_t)foot->n_rows;
    foot->rgba = mem_array(n, 1, UINT64_MAX, err);
    if (foot->rgba)
        memcpy(foot->rgba, image->rgba + foot_first(foot, image), n);
    return foot->rgba != NULL;
}

/* Lets the lines that were painted over the strip fade. */
static void foot_fade(const struct foot *foot, struct image *image)
{
    const size_t row_bytes = 4 * (size_t)image->width_px;
    for (int row = 0; row < foot->n_rows; row++) {
        const double faded = fmin((row + 0.5) / (foot_fading * foot->n_rows), 1);
        const int strength = (int)lround(256 * (1 - (1 - foot_strength) * faded));
        const uint8_t *before = foot->rgba + row_bytes * (size_t)row;
        uint8_t *now = image->rgba + foot_first(foot, image) + row_bytes * (size_t)row;
        for (size_t i = 0; i < row_bytes; i++)
            now[i] = (uint8_t)((now[i] * strength + before[i] * (256 - strength) + 128) / 256);
    }
}

bool overlay_draw(struct overlay *overlay, const struct draw_scope *scope, const struct draw_list *list,
                  struct image *image, struct check_counts *check, struct error *err)
{
    *check = (struct check_counts){ 0, 0 };
    if (list->n_in_image == list->n)
        return true;
    struct target target = { .overlay = overlay,
                             .scope = scope,
                             .image = image,
                             .paint = paint_create(image, err),
                             .scale = image->width_px / snapshot_line_width(scope->snapshot),
                             .check = check };
    struct foot foot = { 0, NULL };
    bool is_good = target.paint && foot_keep(&target, &foot, err) && paint_halos(&target, list, err);
    for (size_t i = list->n_in_image; is_good && i < list->n; i++)
        is_good = paint_draw(&target, &list->draws[i], err);
    if (is_good)
        foot_fade(&foot, image);
    free(foot.rgba);
    paint_destroy(target.paint);
    paint_destroy(target.alone);
    trim(overlay);
    return is_good;
}

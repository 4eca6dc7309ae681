/* Labels of isodose lines: traces the lines of a pane, and finds places on them. */
#include "core/render/visible/isoline_labels.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/region/target.h"
#include "core/render/visible/cut.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"

enum { MAX_USUAL = 96 }; /* labels of a picture that are all drawn */

void isoline_text(char text[ISOLINE_TEXT_SIZE], const struct scene_dose_level *level, const char *unit)
{
    bool is_percent = level->unit == SCENE_DOSE_UNIT_PERCENT;
    (void)snprintf(text, ISOLINE_TEXT_SIZE, "%.4g%s%.32s", level->value, is_percent || unit[0] ? " " : "",
                   is_percent ? "%" : unit);
}

double isoline_text_width_px(const char *text, double text_px)
{
    double width = 0;
    for (; *text; text++)
        if ((*text & 0xc0) != 0x80) /* a character of UTF-8 */
            width += *text == '%'                   ? 0.95
                     : *text == ' ' || *text == '.' ? 0.33
                     : *text == '(' || *text == ')' ? 0.4
                                                    : 0.7;
    return width * text_px;
}

/* All lines of a picture, in pixels. */
struct lines_px {
    struct label_line lines[4096];
    double (*points)[2];
    size_t n_lines, n_points, capacity;
};

static bool reserve(struct lines_px *all, size_t n_points, struct error *err)
{
    if (all->n_points + n_points <= all->capacity)
        return true;
    size_t capacity = 2 * (all->n_points + n_points);
    double(*grown)[2] = realloc(all->points, capacity * sizeof *grown);
    if (!grown)
        return error_set(err, ERROR_MEMORY, "no memory for %zu points of isodose lines", capacity);
    all->points = grown;
    all->capacity = capacity;
    return true;
}

/* Appends a level's lines. Those beyond the room for lines have no labels. */
static bool add_level(struct lines_px *all, const struct isolines *traced, const struct mat4 *px_from_uv, int group,
                      double width_px, struct error *err)
{
    if (!reserve(all, traced->n_points, err))
        return false;
    for (size_t l = 0, at = 0; l < traced->n_lines; at = traced->ends[l++]) {
        if (all->n_lines == sizeof all->lines / sizeof all->lines[0])
            break;
        all->lines[all->n_lines++] =
            (struct label_line){ .n_points = traced->ends[l] - at, .group = group, .width_px = width_px };
        for (size_t i = at; i < traced->ends[l]; i++) {
            struct vec3 p = mat4_project(px_from_uv, vec3(traced->points[i][0], traced->points[i][1], 0));
            all->points[all->n_points][0] = p.x;
            all->points[all->n_points++][1] = p.y;
        }
    }
    return true;
}

/* Maps lattice coordinates to pixels of the full-size picture. */
static struct mat4 pixels_of(const struct snapshot *snapshot, const struct camera *camera, const struct affine *map)
{
    double width = snapshot->view.size_px[0], height = snapshot->view.size_px[1];
    struct mat4 lps_from_uv = { { map->columns[0].x, map->columns[0].y, map->columns[0].z, 0, map->columns[1].x,
                                  map->columns[1].y, map->columns[1].z, 0, 0, 0, 0, 0, map->origin.x, map->origin.y,
                                  map->origin.z, 1 } },
                px_from_clip = { { width / 2, 0, 0, 0, 0, -height / 2, 0, 0, 0, 0, 1, 0, width / 2, height / 2, 0,
                                   1 } };
    struct mat4 clip_from_uv = mat4_multiply(&camera->clip_from_lps_mm, &lps_from_uv);
    return mat4_multiply(&px_from_clip, &clip_from_uv);
}

static bool trace_levels(struct lines_px *all, const struct snapshot *snapshot, const struct isoline_scene *lines,
                         const struct dose_plane *plane, const struct mat4 *px_from_uv, double text_px,
                         struct error *err)
{
    struct isolines traced = { 0 };
    bool is_good = true;
    for (size_t i = lines->n_levels; is_good && i-- > 0;) {
        char text[ISOLINE_TEXT_SIZE];
        const struct scene_dose_level *level = &snapshot->scene.dose.levels[lines->levels[i].index].value;
        isoline_text(text, level, lines->doses[0].field->unit);
        is_good = dose_plane_trace(plane, lines->doses[0].field, lines->levels[i].value, &traced, err) &&
                  add_level(all, &traced, px_from_uv, (int)i, isoline_text_width_px(text, text_px), err);
    }
    isolines_finish(&traced);
    return is_good;
}

/* Appends the outline of a region, as lines that no label may lie over. */
static bool add_outline(struct lines_px *all, const struct snapshot *snapshot, const struct camera *camera,
                        size_t region, struct error *err)
{
    struct cut_region cut;
    struct mask *mask = NULL;
    struct cut_lines outline = { 0 };
    if (!cut_region_init(&cut, &snapshot->plan->regions, region, err))
        return false;
    bool is_good = cut_univels(&cut, &snapshot->pane, &mask, err) &&
                   (!mask || cut_outlines(mask, OUTLINE_MARCHING_SQUARES, &outline, err)) &&
                   reserve(all, 2 * outline.n, err);
    bool has_room = is_good && all->n_lines < sizeof all->lines / sizeof all->lines[0];
    if (has_room)
        all->lines[all->n_lines++] = (struct label_line){ .n_points = 2 * outline.n, .group = LABEL_KEPT_FREE };
    for (size_t i = 0; has_room && i < outline.n; i++)
        for (int end = 0; end < 2; end++) {
            const double *p = outline.ends_lps_mm[i][end];
            struct vec3 clip = mat4_project(&camera->clip_from_lps_mm, vec3(p[0], p[1], p[2]));
            all->points[all->n_points][0] = (clip.x + 1) / 2 * snapshot->view.size_px[0];
            all->points[all->n_points++][1] = (1 - clip.y) / 2 * snapshot->view.size_px[1];
        }
    cut_lines_finish(&outline);
    mask_destroy(mask);
    cut_region_finish(&cut);
    return is_good;
}

static bool add_targets(struct lines_px *all, const struct snapshot *snapshot, const struct camera *camera,
                        struct error *err)
{
    const struct region_set *set = &snapshot->plan->regions;
    bool is_good = true;
    for (size_t i = 0; is_good && i < set->n_regions; i++)
        if (region_is_target(&set->regions[i]) && visible_is_drawn(snapshot, i))
            is_good = add_outline(all, snapshot, camera, i, err);
    return is_good;
}

static bool place(struct isoline_labels *labels, const struct snapshot *snapshot, const struct isoline_scene *lines,
                  struct lines_px *all, double text_px, enum isoline_labels_for what, struct error *err)
{
    struct label_place places[ISOLINE_MAX_LABELS];
    const struct label_style style = { .height_px = 1.2 * text_px,
                                       .is_upright = what == ISOLINE_LABELS_UPRIGHT,
                                       .is_choice = what == ISOLINE_LABELS_CHOICE };
    size_t at = 0;
    for (size_t i = 0; i < all->n_lines; at += all->lines[i++].n_points)
        all->lines[i].points_px = (const double(*)[2])all->points + at;
    int n = label_places_find(all->lines, all->n_lines, snapshot->view.size_px[0], snapshot->view.size_px[1], &style,
                              places, style.is_choice ? ISOLINE_MAX_LABELS : MAX_USUAL, err);
    for (int i = 0; i < n; i++)
        labels->labels[labels->n++] =
            (struct isoline_label){ lines->levels[all->lines[places[i].line].group].index, places[i] };
    return n >= 0;
}

bool isoline_labels_place(struct isoline_labels *labels, const struct snapshot *snapshot,
                          const struct isoline_scene *lines, double text_px, enum isoline_labels_for what,
                          struct error *err)
{
    struct camera camera;
    struct isoline_lattice lattice;
    labels->n = 0;
    if (!lines->is_drawn[0] || !snapshot_is_pane(snapshot) || snapshot->view.size_px[1] < ISOLINE_LABELS_MIN_PX)
        return true;
    camera_resolve(snapshot, &camera);
    struct isoline_window window = isoline_window_of_pane(&snapshot->pane, &camera);
    if (!isoline_lattice_of(&lines->doses[0].field->rows[0]->grid, &snapshot->pane, &window, 1 / camera.pixels_per_mm,
                            &lattice))
        return true;
    lattice.is_by_slice = snapshot->scene.dose.interpolation == SCENE_DOSE_INTERPOLATION_SLICE;
    struct dose_lattice samples = isoline_lattice_samples(&lattice);
    struct lines_px *all = mem_array(1, sizeof *all, UINT64_MAX, err);
    struct dose_plane *plane = all ? dose_plane_create(lines->doses[0].field, &samples, err) : NULL;
    struct mat4 px_from_uv = pixels_of(snapshot, &camera, &samples.lps_mm_from_uv);
    bool is_good = plane && trace_levels(all, snapshot, lines, plane, &px_from_uv, text_px, err) &&
                   (what != ISOLINE_LABELS_CHOICE || add_targets(all, snapshot, &camera, err)) &&
                   place(labels, snapshot, lines, all, text_px, what, err);
    dose_plane_destroy(plane);
    if (all)
        free(all->points);
    free(all);
    return is_good;
}

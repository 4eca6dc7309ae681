/* Finds where axes and measures are in a picture, and what stands beside them. */
#include "core/annotate/marks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/annotate/words.h"
#include "core/base/mem.h"
#include "core/scene/axes.h"
#include "core/volume/ellipse.h"

enum { ELLIPSE_LINES = 72, CROSSHAIR_LINES = 4 };
static const uint32_t measure_rgb = 0xffd84d, crosshair_rgb = 0xc9ced6;
/* Free parts of the crosshair: around its middle, of the picture's shorter side; at the edges, where letters stand, of
 * width and height. */
static const double crosshair_gap = 0.025, crosshair_margin = 0.06;

struct marks {
    struct annotations *annotations;
    const struct snapshot *snapshot;
    const struct camera *camera;
};

/* ---- places ----------------------------------------------------------------------------------------------------- */

/* In parts of the picture's width and height, y down; false: not in front of the eye. */
static bool place_of(const struct marks *marks, struct vec3 p, double place[2])
{
    const double *m = marks->camera->clip_from_lps_mm.m;
    double w = m[3] * p.x + m[7] * p.y + m[11] * p.z + m[15];
    if (!marks->camera->is_parallel && w < fmax(1e-3, marks->camera->near_mm / 10))
        return false;
    bool has_eye = marks->snapshot->view.kind == SCENE_KIND_BEAM && snapshot_beam(marks->snapshot);
    if (has_eye &&
        vec3_dot(vec3_sub(p, marks->camera->eye_lps_mm), marks->camera->forward) < fmin(0, marks->camera->near_mm))
        return false;
    struct vec3 clip = mat4_project(&marks->camera->clip_from_lps_mm, p);
    place[0] = (clip.x + 1) / 2;
    place[1] = (1 - clip.y) / 2;
    return true;
}

static void add_line(const struct marks *marks, struct vec3 a, struct vec3 b)
{
    struct annotation_line line = { .rgb = measure_rgb };
    if (place_of(marks, a, line.from) && place_of(marks, b, line.to))
        marks->annotations->lines[marks->annotations->n_lines++] = line;
}

static struct annotation_label *add_label(const struct marks *marks, struct vec3 p, bool is_centred)
{
    struct annotation_label label = { .is_centred = is_centred };
    if (!place_of(marks, p, label.at))
        return NULL;
    marks->annotations->labels[marks->annotations->n_labels] = label;
    return &marks->annotations->labels[marks->annotations->n_labels++];
}

/* The letters of the axes in the corner, which has no place in the patient. */
static void add_corner(const struct marks *marks)
{
    const int *size_px = marks->snapshot->view.size_px;
    struct axes_corner corner;
    axes_in_corner(marks->camera, size_px[0], size_px[1], &corner);
    for (int i = 0; i < AXES_N_ARMS; i++) {
        struct annotation_label label = { .is_centred = true, .text = { "LPS"[i] } };
        for (int side = 0; side < 2; side++)
            label.at[side] = (corner.at[side] + corner.letter[i][side]) / size_px[side];
        marks->annotations->labels[marks->annotations->n_labels++] = label;
    }
}

static void add_axes(const struct marks *marks)
{
    struct vec3 middle;
    struct axis_end ends[AXES_N_ENDS];
    const struct scene *scene = &marks->snapshot->scene;
    if (!scene->axes.visible || !scene->axes.letters || snapshot_is_pane(marks->snapshot))
        return;
    if (scene->axes.form == SCENE_AXES_FORM_CORNER) {
        add_corner(marks);
        return;
    }
    if (!axes_of_scene(marks->snapshot->plan, scene, &middle, ends))
        return;
    for (int i = 0; i < AXES_N_ENDS; i++) {
        struct annotation_label *label = add_label(marks, ends[i].at_lps_mm, true);
        if (label)
            label->text[0] = ends[i].letter;
    }
}

/* ---- measures --------------------------------------------------------------------------------------------------- */

static size_t points_needed(enum scene_measure_kind kind)
{
    return kind == SCENE_MEASURE_KIND_ANGLE || kind == SCENE_MEASURE_KIND_ELLIPSE ? 3 : 2;
}

/* Half of what a voxel of the image shown reaches along a direction. */
static double half_voxel_mm(const struct snapshot *snapshot, struct vec3 direction)
{
    double sum = 0;
    if (snapshot->image < 0)
        return 0.5;
    const struct affine *map = &snapshot->plan->images[snapshot->image].volume->grid.lps_mm_from_ijk;
    for (int axis = 0; axis < 3; axis++)
        sum += fabs(vec3_dot(map->columns[axis], direction));
    return sum / 2;
}

static bool is_in_picture(const struct snapshot *snapshot, const struct scene_measure *measure)
{
    if (!measure->visible || measure->n_points < points_needed(measure->kind))
        return false;
    const double slack_mm = 1e-3; /* points are kept in thousandths */
    double most_mm = half_voxel_mm(snapshot, snapshot->pane.normal) + slack_mm;
    for (size_t i = 0; snapshot_is_pane(snapshot) && i < measure->n_points; i++)
        if (fabs(plane_height_mm(&snapshot->pane, measure->points[i].at_mm)) > most_mm)
            return false;
    return true;
}

static double distance_mm(struct vec3 a, struct vec3 b)
{
    return vec3_length(vec3_sub(a, b));
}

static double angle_deg(struct vec3 a, struct vec3 corner, struct vec3 b)
{
    struct vec3 p = vec3_sub(a, corner), q = vec3_sub(b, corner);
    return vec3_length(p) > 0 && vec3_length(q) > 0
               ? atan2(vec3_length(vec3_cross(p, q)), vec3_dot(p, q)) * 180 / MATH_PI
               : (double)NAN;
}

/* The image that an ellipse is measured in: its own, else the one shown; -1: none. */
static int image_of(const struct snapshot *snapshot, const struct scene_measure *measure)
{
    for (size_t i = 0; i < snapshot->plan->n_images; i++)
        if (measure->image[0] && strcmp(snapshot->plan->images[i].id, measure->image) == 0)
            return (int)i;
    return snapshot->image;
}

/* "38.0 +- 12.0 HU"; "" without an image or a value. */
static void write_mean(char text[96], const struct snapshot *snapshot, const struct scene_measure *measure)
{
    int index = image_of(snapshot, measure);
    struct ellipse_values values;
    char mean[40], sd[40];
    text[0] = 0;
    if (index < 0 ||
        !ellipse_values(snapshot->plan->images[index].volume, measure->points[0].at_mm, measure->points[1].at_mm,
                        measure->points[2].at_mm, &values) ||
        values.n == 0)
        return;
    char quoted[WORDS_UNIT_SIZE];
    const char *unit = words_unit(snapshot->plan->images[index].unit, quoted);
    words_significant(mean, values.mean);
    words_significant(sd, values.sd);
    (void)snprintf(text, 96, "%.24s \u00b1 %.24s%s%.24s", mean, sd, *unit ? " " : "", unit);
}

static void write_value(char text[96], const struct scene_measure *measure)
{
    const struct scene_measure_point *p = measure->points;
    char number[40];
    double sum = 0;
    switch (measure->kind) {
    case SCENE_MEASURE_KIND_ANGLE: {
        double angle = angle_deg(p[0].at_mm, p[1].at_mm, p[2].at_mm);
        words_number(number, isnan(angle) ? 0 : angle, 1);
        (void)snprintf(text, 96, isnan(angle) ? "\u2013" : "%s\u00b0", number);
        return;
    }
    case SCENE_MEASURE_KIND_ELLIPSE:
        words_number(number,
                     MATH_PI / 100 *
                         vec3_length(vec3_cross(vec3_sub(p[1].at_mm, p[0].at_mm), vec3_sub(p[2].at_mm, p[0].at_mm))),
                     2);
        (void)snprintf(text, 96, "%s cm\u00b2", number);
        return;
    case SCENE_MEASURE_KIND_DISTANCE:
    case SCENE_MEASURE_KIND_POLYLINE: break;
    }
    size_t n = measure->kind == SCENE_MEASURE_KIND_DISTANCE ? 2 : measure->n_points;
    for (size_t i = 1; i < n; i++)
        sum += distance_mm(p[i - 1].at_mm, p[i].at_mm);
    words_number(number, sum, 1);
    (void)snprintf(text, 96, "%s mm", number);
}

static void add_lines(const struct marks *marks, const struct scene_measure *measure)
{
    const struct scene_measure_point *p = measure->points;
    if (measure->kind != SCENE_MEASURE_KIND_ELLIPSE) {
        size_t n = measure->kind == SCENE_MEASURE_KIND_POLYLINE ? measure->n_points : points_needed(measure->kind);
        for (size_t i = 1; i < n; i++)
            add_line(marks, p[i - 1].at_mm, p[i].at_mm);
        return;
    }
    struct vec3 a = vec3_sub(p[1].at_mm, p[0].at_mm), b = vec3_sub(p[2].at_mm, p[0].at_mm), before = p[1].at_mm;
    for (int i = 1; i <= ELLIPSE_LINES; i++) {
        double turn = 2 * MATH_PI * i / ELLIPSE_LINES;
        struct vec3 at = vec3_add(p[0].at_mm, vec3_add(vec3_scale(a, cos(turn)), vec3_scale(b, sin(turn))));
        add_line(marks, before, at);
        before = at;
    }
}

static struct vec3 label_place(const struct scene_measure *measure)
{
    const struct scene_measure_point *p = measure->points;
    if (measure->kind == SCENE_MEASURE_KIND_DISTANCE)
        return vec3_scale(vec3_add(p[0].at_mm, p[1].at_mm), 0.5);
    return measure->kind == SCENE_MEASURE_KIND_POLYLINE ? p[measure->n_points - 1].at_mm : p[1].at_mm;
}

static void add_measure(const struct marks *marks, const struct scene_measure *measure)
{
    char value[96], mean[96] = "";
    if (!is_in_picture(marks->snapshot, measure))
        return;
    add_lines(marks, measure);
    struct annotation_label *label = add_label(marks, label_place(measure), false);
    if (!label)
        return;
    write_value(value, measure);
    if (measure->kind == SCENE_MEASURE_KIND_ELLIPSE)
        write_mean(mean, marks->snapshot, measure);
    (void)snprintf(label->text, sizeof label->text, "%.162s%s%.95s%s%.95s", measure->name, measure->name[0] ? " " : "",
                   value, mean[0] ? ", " : "", mean);
}

bool marks_describe(struct annotations *annotations, const struct snapshot *snapshot, const struct camera *camera,
                    struct error *err)
{
    const struct scene *scene = &snapshot->scene;
    const struct marks marks = { annotations, snapshot, camera };
    size_t n_lines = 0;
    for (size_t i = 0; i < scene->n_measures; i++)
        n_lines += scene->measures[i].value.n_points + ELLIPSE_LINES;
    annotations->n_lines = annotations->n_labels = 0;
    annotations->lines = mem_array(n_lines + CROSSHAIR_LINES, sizeof *annotations->lines, UINT64_MAX, err);
    annotations->labels = annotations->lines
                              ? mem_array(scene->n_measures + AXES_N_ENDS, sizeof *annotations->labels, UINT64_MAX, err)
                              : NULL;
    if (!annotations->labels)
        return false;
    add_axes(&marks);
    for (size_t i = 0; i < scene->n_measures; i++)
        add_measure(&marks, &scene->measures[i].value);
    return true;
}

/* ---- crosshair -------------------------------------------------------------------------------------------------- */

static void add_arm(const struct marks *marks, const double at[2], const double along[2], double from, double to)
{
    struct annotation_line line = { .rgb = crosshair_rgb };
    if (!(from < to))
        return;
    for (int side = 0; side < 2; side++) {
        line.from[side] = at[side] + from * along[side];
        line.to[side] = at[side] + to * along[side];
    }
    marks->annotations->lines[marks->annotations->n_lines++] = line;
}

/* Two arms along the line from `at` towards `to`, as far as the margins of the picture. */
static void add_arms(const struct marks *marks, const double at[2], const double to[2])
{
    const int *size_px = marks->snapshot->view.size_px;
    const double along[2] = { to[0] - at[0], to[1] - at[1] },
                 length_px = hypot(along[0] * size_px[0], along[1] * size_px[1]),
                 gap = crosshair_gap * fmin(size_px[0], size_px[1]) / length_px;
    double first = -INFINITY, last = INFINITY;
    if (!(length_px > 0) || !isfinite(at[0] + at[1] + length_px))
        return;
    for (int side = 0; side < 2; side++) {
        const double low = (crosshair_margin - at[side]) / along[side],
                     high = (1 - crosshair_margin - at[side]) / along[side];
        if (fabs(along[side]) * size_px[side] > 1e-6 * length_px) {
            first = fmax(first, fmin(low, high));
            last = fmin(last, fmax(low, high));
        } else if (at[side] < crosshair_margin || at[side] > 1 - crosshair_margin) {
            return;
        }
    }
    add_arm(marks, at, along, first, fmin(last, -gap));
    add_arm(marks, at, along, fmax(first, gap), last);
}

void marks_add_crosshair(struct annotations *annotations, const struct snapshot *snapshot)
{
    static const struct vec3 axes[3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
    const struct scene_slices *slices = &snapshot->scene.image.slices;
    const struct vec3 point =
        vec3(slices->sagittal.position_mm, slices->coronal.position_mm, slices->axial.position_mm);
    const enum scene_kind kind = snapshot->view.kind;
    const int across = kind == SCENE_KIND_SAGITTAL ? 0 : kind == SCENE_KIND_CORONAL ? 1 : 2;
    struct camera camera;
    double at[2], to[2];
    if (kind != SCENE_KIND_SAGITTAL && kind != SCENE_KIND_CORONAL && kind != SCENE_KIND_AXIAL)
        return;
    camera_resolve(snapshot, &camera);
    const struct marks marks = { annotations, snapshot, &camera };
    for (int axis = 0; axis < 3; axis++)
        if (axis != across && place_of(&marks, point, at) && place_of(&marks, vec3_add(point, axes[axis]), to))
            add_arms(&marks, at, to);
}

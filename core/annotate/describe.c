/* Words for plan, pane, regions and methods of a snapshot. */
#include "core/annotate/describe.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "core/annotate/describe_beam.h"
#include "core/annotate/describe_dose.h"
#include "core/annotate/describe_fits.h"
#include "core/annotate/marks.h"
#include "core/annotate/words.h"
#include "core/base/mem.h"
#include "core/plan/identity.h"
#include "core/render/visible/visible.h"

enum { MAX_OTHER_ITEMS = 97 }; /* beside regions */

void annotate_date(int64_t unix_s, char date[ANNOTATE_DATE_SIZE])
{
    struct tm utc;
    time_t seconds = (time_t)unix_s;
    if (!gmtime_r(&seconds, &utc) || strftime(date, ANNOTATE_DATE_SIZE, "%Y-%m-%d %H:%M UTC", &utc) == 0)
        date[0] = '\0';
}

static void add_words(struct annotations *annotations, enum annotation_row row, const char *words)
{
    (void)snprintf(annotation_add(annotations, row)->text, ANNOTATION_TEXT_SIZE, "%s", words);
}

/* ---- the pane --------------------------------------------------------------------------------------------------- */

/* A view of a beam that there is not shows what it falls back to. */
static const char *kind_words(const struct snapshot *snapshot)
{
    static const char *const words[] = { [SCENE_KIND_3D] = "3-D",
                                         [SCENE_KIND_AXIAL] = "Axial",
                                         [SCENE_KIND_CORONAL] = "Coronal",
                                         [SCENE_KIND_SAGITTAL] = "Sagittal",
                                         [SCENE_KIND_OBLIQUE] = "Oblique",
                                         [SCENE_KIND_BEAM] = "Beam's eye",
                                         [SCENE_KIND_BEAM_SLICE] = "Beam slice" };
    enum scene_kind kind = snapshot->view.kind;
    if (!snapshot_beam(snapshot) && kind == SCENE_KIND_BEAM)
        kind = SCENE_KIND_3D;
    if (!snapshot_beam(snapshot) && kind == SCENE_KIND_BEAM_SLICE)
        kind = SCENE_KIND_AXIAL;
    return words[kind];
}

static void add_plane(struct annotations *annotations, const char *before, const struct scene *scene,
                      const struct plane *plane)
{
    const char *name = words_plane_name(scene, plane);
    char place[WORDS_SIZE], normal[WORDS_SIZE];
    words_plane(place, scene, plane);
    words_normal(normal, plane);
    if (*name)
        (void)snprintf(annotation_add(annotations, ANNOTATION_PANE)->text, ANNOTATION_TEXT_SIZE, "%s%.240s", before,
                       name);
    (void)snprintf(annotation_add(annotations, ANNOTATION_PANE)->text, ANNOTATION_TEXT_SIZE, "%s%.240s",
                   *name ? "" : before, place);
    if (*normal)
        add_words(annotations, ANNOTATION_PANE, normal);
}

/* A slice in space; the beam slice is the last one. */
static void add_slice(struct annotations *annotations, const struct snapshot *snapshot, size_t index)
{
    const struct scene_beam_style *style = &snapshot->scene.beam;
    char beam[WORDS_SIZE], place[WORDS_SIZE];
    if (index + 1 < snapshot->n_slices || !style->slice.visible || !snapshot->has_beam) {
        add_plane(annotations, "slice ", &snapshot->scene, &snapshot->slices[index]);
        return;
    }
    beam_words(beam, snapshot, &snapshot->beam);
    beam_place_words(place, style->slice.along_mm);
    (void)snprintf(annotation_add(annotations, ANNOTATION_PANE)->text, ANNOTATION_TEXT_SIZE,
                   "beam slice of %.160s, %.60s", beam, place);
}

static void add_image(struct annotations *annotations, const struct snapshot *snapshot)
{
    const struct scene_image_style *style = &snapshot->scene.image;
    words_image(annotation_add(annotations, ANNOTATION_PANE)->text, snapshot->plan, (size_t)snapshot->image);
    words_window(annotation_add(annotations, ANNOTATION_PANE)->text, &style->window,
                 snapshot->plan->images[snapshot->image].unit);
    if (style->color_map != SCENE_COLOR_MAP_GREY)
        add_words(annotations, ANNOTATION_PANE, words_color_map(style->color_map));
    if (snapshot_is_low_white(snapshot))
        add_words(annotations, ANNOTATION_PANE, "low values white");
    if (style->interpolation == SCENE_INTERPOLATION_NEAREST)
        add_words(annotations, ANNOTATION_PANE, "nearest voxel");
    if (snapshot->blend >= 0 && style->blend.opacity > 0)
        words_blend(annotation_add(annotations, ANNOTATION_PANE)->text, snapshot);
}

static bool has_volume(const struct snapshot *snapshot)
{
    return !snapshot_is_pane(snapshot) && snapshot->image >= 0 && snapshot->scene.image.volume.visible;
}

static bool has_caps(const struct snapshot *snapshot)
{
    for (size_t i = 0; i < snapshot->n_clips; i++)
        if (snapshot->clips[i].is_capped)
            return true;
    return false;
}

static bool has_image_caps(const struct snapshot *snapshot)
{
    return has_caps(snapshot) && snapshot->scene.clip.cap.image;
}

static void add_pane(struct annotations *annotations, const struct snapshot *snapshot, const struct camera *camera)
{
    bool is_pane = snapshot_is_pane(snapshot);
    add_words(annotations, ANNOTATION_PANE, kind_words(snapshot));
    if (is_pane)
        add_plane(annotations, "", &snapshot->scene, &snapshot->pane);
    else
        add_words(annotations, ANNOTATION_PANE, camera->is_parallel ? "parallel projection" : "perspective, no scale");
    for (size_t i = 0; !is_pane && snapshot->image >= 0 && i < snapshot->n_slices; i++)
        add_slice(annotations, snapshot, i);
    if (snapshot->image >= 0 && (is_pane || snapshot->n_slices > 0 || has_volume(snapshot) || has_image_caps(snapshot)))
        add_image(annotations, snapshot);
}

/* ---- regions ---------------------------------------------------------------------------------------------------- */

/* True if the plane of a slice pane meets the box of the region or of one inside it. inside: room for n_regions. */
static bool reaches_pane(const struct snapshot *snapshot, size_t index, size_t *inside)
{
    const struct region_set *set = &snapshot->plan->regions;
    size_t n = region_with_descendants(set, index, inside);
    for (size_t i = 0; i < n; i++) {
        const struct region *region = &set->regions[inside[i]];
        struct box3 box = box3_empty();
        for (int corner = 0; region->n_voxels > 0 && corner < 8; corner++) {
            double ijk[3];
            for (int axis = 0; axis < 3; axis++)
                ijk[axis] = corner >> axis & 1 ? region->high_ijk[axis] + 0.5 : region->low_ijk[axis] - 0.5;
            box3_add(&box,
                     affine_point(&set->layers[region->layer]->grid.lps_mm_from_ijk, vec3(ijk[0], ijk[1], ijk[2])));
        }
        if (box3_is_empty(&box))
            continue;
        struct plane_reach reach = plane_reach(&snapshot->pane, &box);
        if (plane_meets(&reach))
            return true;
    }
    return false;
}

static bool is_missing(const struct visible_missing *missing, size_t n, size_t region)
{
    for (size_t i = 0; i < n && i < VISIBLE_MAX_MISSING; i++)
        if (missing[i].subject.kind == SUBJECT_REGION && missing[i].subject.index == region)
            return true;
    return false;
}

static void add_region(struct annotations *annotations, const struct snapshot *snapshot, size_t index)
{
    const struct scene_region_style *style = &snapshot->styles[index];
    const struct region *region = &snapshot->plan->regions.regions[index];
    enum region_representation kind = visible_shape_key(snapshot, index).representation;
    struct annotation_item *item = annotation_add(annotations, ANNOTATION_REGIONS);
    char opacity[48] = "";
    bool is_pane = snapshot_is_pane(snapshot);
    item->has_chip = true;
    for (int channel = 0; channel < 3; channel++)
        item->rgb[channel] = (uint8_t)(style->color_rgb >> (16 - 8 * channel));
    if (!is_pane && style->opacity < 1) {
        char percent[40];
        words_number(percent, 100 * style->opacity, 0);
        (void)snprintf(opacity, sizeof opacity, " %s %%", percent);
    }
    (void)snprintf(item->text, sizeof item->text, "%s%s%s%s", region->name[0] ? region->name : region->id, opacity,
                   is_pane || kind == REPRESENTATION_SURFACE ? "" : ", ",
                   is_pane || kind == REPRESENTATION_SURFACE ? "" : region_representation_word(kind));
}

/* True if the picture shows regions at all: a slice pane with an image draws them only as outlines. */
static bool has_regions(const struct snapshot *snapshot)
{
    return !snapshot_is_pane(snapshot) || snapshot->image < 0 || snapshot->scene.outline.on_slices;
}

static bool add_regions(struct annotations *annotations, const struct snapshot *snapshot,
                        const struct visible_missing *missing, size_t n_missing, struct error *err)
{
    size_t n_regions = snapshot->plan->regions.n_regions;
    size_t *inside = mem_array(n_regions, sizeof *inside, UINT64_MAX, err);
    if (!inside)
        return false;
    for (size_t i = 0; has_regions(snapshot) && i < n_regions; i++)
        if (visible_is_drawn(snapshot, i) && !is_missing(missing, n_missing, i) &&
            (!snapshot_is_pane(snapshot) || reaches_pane(snapshot, i, inside)))
            add_region(annotations, snapshot, i);
    free(inside);
    return true;
}

static void add_missing(struct annotations *annotations, const struct snapshot *snapshot,
                        const struct visible_missing *missing, size_t n_missing)
{
    enum { MAX_NAMED = 8 };
    for (size_t i = 0; i < n_missing && i < MAX_NAMED; i++) {
        const struct subject subject = missing[i].subject;
        const char *name = subject.kind == SUBJECT_REGION ? snapshot->plan->regions.regions[subject.index].name
                                                          : subject_id(snapshot->plan, subject);
        (void)snprintf(annotation_add(annotations, ANNOTATION_MISSING)->text, ANNOTATION_TEXT_SIZE, "%s%s",
                       i == 0 ? "Not drawn: " : "", name);
    }
    if (n_missing > MAX_NAMED)
        (void)snprintf(annotation_add(annotations, ANNOTATION_MISSING)->text, ANNOTATION_TEXT_SIZE, "and %zu more",
                       n_missing - MAX_NAMED);
}

/* ---- methods ---------------------------------------------------------------------------------------------------- */

static const char *outline_words(enum scene_outline_method method)
{
    if (method == SCENE_OUTLINE_METHOD_TRACED)
        return "Outlines: along the univels' centres";
    return method == SCENE_OUTLINE_METHOD_MARCHING_SQUARES ? "Outlines: midway between univels"
                                                           : "Outlines: of the surfaces";
}

/* "superior to S 12.0 mm": what a clip plane cuts off. */
static void cut_words(char text[ANNOTATION_TEXT_SIZE], const struct snapshot *snapshot, const struct clip_plane *clip)
{
    static const char *const sides[] = {
        [CLIP_AXIAL_LOW] = "inferior to",       [CLIP_AXIAL_HIGH] = "superior to", [CLIP_CORONAL_LOW] = "anterior to",
        [CLIP_CORONAL_HIGH] = "posterior to",   [CLIP_SAGITTAL_LOW] = "right of",  [CLIP_SAGITTAL_HIGH] = "left of",
        [CLIP_BEAM] = "before the plane along", [CLIP_FREE] = "above the plane",
    };
    char place[WORDS_SIZE], normal[WORDS_SIZE] = "", along[40], name[WORDS_SIZE];
    const struct scene_clip_beam *style = &snapshot->scene.clip.beam;
    struct beam_shown beam;
    if (clip->name == CLIP_BEAM && beam_shown_of(snapshot->plan, &snapshot->scene, style->id, &snapshot->fits, &beam)) {
        words_number(along, style->along_mm, 1);
        beam_words(name, snapshot, &beam);
        (void)snprintf(place, sizeof place, "%.200s at %s mm", name, along);
    } else {
        struct plane plane = clip->plane;
        if (clip->name != CLIP_FREE && vec3_dot(plane.normal, vec3(1, 1, 1)) < 0)
            plane.normal = vec3_scale(plane.normal, -1); /* the position counts along the positive patient axis */
        words_plane(place, &snapshot->scene, &plane);
        words_normal(normal, &plane);
    }
    (void)snprintf(text, ANNOTATION_TEXT_SIZE, "%s %.100s%s%.100s%s", sides[clip->name], place, *normal ? ", " : "",
                   normal, clip->is_capped ? "" : ", without cap");
}

/* Adds an item that begins with `before` if it is the first of its list. */
static void add_listed(struct annotations *annotations, const char *before, bool is_first, const char *words)
{
    (void)snprintf(annotation_add(annotations, ANNOTATION_METHODS)->text, ANNOTATION_TEXT_SIZE, "%s%.200s",
                   is_first ? before : "", words);
}

/* Lists drawn things that the clip planes do not cut. */
static void add_exempt(struct annotations *annotations, const struct snapshot *snapshot)
{
    enum { MAX_NAMED = 8 };
    const struct region_set *set = &snapshot->plan->regions;
    const struct scene_image_style *image = &snapshot->scene.image;
    size_t n = 0;
    for (size_t i = 0; i < set->n_regions; i++)
        if (visible_is_drawn(snapshot, i) && !snapshot->styles[i].clipped && n++ < MAX_NAMED)
            add_listed(annotations, "Not cut: ", n == 1,
                       set->regions[i].name[0] ? set->regions[i].name : set->regions[i].id);
    if (n > MAX_NAMED) {
        char more[40];
        (void)snprintf(more, sizeof more, "%zu more regions", n - MAX_NAMED);
        add_listed(annotations, "", false, more);
    }
    if (snapshot->image >= 0 && snapshot->n_slices > 0 && !image->clipped)
        add_listed(annotations, "Not cut: ", n++ == 0, "slices");
    if (has_volume(snapshot) && !image->volume.clipped)
        add_listed(annotations, "Not cut: ", n == 0, "volume");
}

static void add_cuts(struct annotations *annotations, const struct snapshot *snapshot)
{
    char words[ANNOTATION_TEXT_SIZE];
    for (size_t i = 0; i < snapshot->n_clips; i++) {
        cut_words(words, snapshot, &snapshot->clips[i]);
        add_listed(annotations, "Cut off: ", i == 0, words);
    }
    if (snapshot->n_clips > 0)
        add_exempt(annotations, snapshot);
    const struct scene_cap_style *cap = &snapshot->scene.clip.cap;
    if (has_caps(snapshot)) {
        bool has_image = cap->image && snapshot->image >= 0;
        (void)snprintf(words, sizeof words, "%s%s%s", has_image ? "image" : "plain",
                       cap->regions ? ", colours of regions" : "", cap->outlines ? ", outlines" : "");
        add_listed(annotations, "Caps: ", true, words);
    }
}

static void add_volume(struct annotations *annotations, const struct snapshot *snapshot)
{
    const struct scene_volume_style *volume = &snapshot->scene.image.volume;
    char words[64];
    switch (volume->method) {
    case SCENE_VOLUME_METHOD_RAY:
        (void)snprintf(words, sizeof words, "by rays%s", volume->shaded ? ", shaded" : "");
        break;
    case SCENE_VOLUME_METHOD_SLICES: (void)snprintf(words, sizeof words, "by %d slices", (int)volume->steps); break;
    case SCENE_VOLUME_METHOD_MIP: (void)snprintf(words, sizeof words, "largest value along each ray"); break;
    case SCENE_VOLUME_METHOD_AVERAGE: (void)snprintf(words, sizeof words, "mean along each ray"); break;
    }
    add_listed(annotations, "Volume: ", true, words);
}

static void add_methods(struct annotations *annotations, const struct snapshot *snapshot)
{
    bool has_surface = false, has_outline = snapshot_is_pane(snapshot) && snapshot->scene.outline.on_slices;
    for (size_t i = 0; !snapshot_is_pane(snapshot) && i < snapshot->plan->regions.n_regions; i++) {
        enum region_representation kind = visible_shape_key(snapshot, i).representation;
        has_surface = has_surface || (visible_is_drawn(snapshot, i) && kind == REPRESENTATION_SURFACE);
        has_outline = has_outline || (visible_is_drawn(snapshot, i) && kind == REPRESENTATION_OUTLINE);
    }
    if (has_surface)
        (void)snprintf(annotation_add(annotations, ANNOTATION_METHODS)->text, ANNOTATION_TEXT_SIZE, "Surfaces: %s",
                       surface_algorithm_word(visible_surface_key(snapshot).algorithm));
    if (has_volume(snapshot))
        add_volume(annotations, snapshot);
    add_cuts(annotations, snapshot);
    if (has_outline && snapshot->plan->regions.n_regions > 0)
        add_words(annotations, ANNOTATION_METHODS, outline_words(snapshot->scene.outline.method));
    if (snapshot_is_pane(snapshot) && snapshot->scene.check.visible)
        add_words(annotations, ANNOTATION_METHODS, "Check of the segmentation: differences are marked");
    if (snapshot->scene.dose.grid && snapshot->dose >= 0 && fit_is_used(&snapshot->fits.doses[snapshot->dose])) {
        const struct dose *dose = &snapshot->plan->doses[snapshot->dose];
        (void)snprintf(annotation_add(annotations, ANNOTATION_METHODS)->text, ANNOTATION_TEXT_SIZE,
                       "Grid of the dose %s%s%s%s%s", dose->name[0] ? dose->name : dose->id, dose->unit[0] ? ", " : "",
                       dose->unit,
                       dose->per[0] == 0                    ? ""
                       : strncmp(dose->per, "per ", 4) == 0 ? " "
                                                            : " per ",
                       dose->per);
    }
}

static void add_origin(struct annotations *annotations, const struct snapshot *snapshot, const char *date)
{
    add_words(annotations, ANNOTATION_ORIGIN, date);
    if (snapshot->scene_revision > 0)
        (void)snprintf(annotation_add(annotations, ANNOTATION_ORIGIN)->text, ANNOTATION_TEXT_SIZE, "revision %u",
                       (unsigned)snapshot->scene_revision);
    add_words(annotations, ANNOTATION_ORIGIN, "Beamroom " BEAMROOM_VERSION);
    add_words(annotations, ANNOTATION_USE, "For research and plan review.");
    add_words(annotations, ANNOTATION_USE, "Not a medical device.");
}

static void add_patient(struct annotations *annotations, const struct plan *plan)
{
    char masked[IDENTITY_MASK_SIZE], day[WORDS_DAY_SIZE];
    const int shown = plan_shown_patient(plan);
    if (shown < 0)
        return;
    identity_mask(&plan->patients[shown], masked);
    add_words(annotations, ANNOTATION_TITLE, masked);
    annotations->patient = annotations->n_items;
    if (plan->statement.kind == STATEMENT_IDENTITY && plan->statement.state == STATEMENT_USED)
        (void)snprintf(annotation_add(annotations, ANNOTATION_TITLE)->text, ANNOTATION_TEXT_SIZE,
                       "stated by %.163s, %s", plan->statement.by, words_day(plan->statement.time_ms, day));
}

void annotations_name_patient(struct annotations *annotations, const struct plan *plan)
{
    char words[IDENTITY_WORDS_SIZE];
    const int shown = plan_shown_patient(plan);
    if (annotations->patient == 0 || shown < 0)
        return;
    identity_words(&plan->patients[shown], words);
    (void)snprintf(annotations->items[annotations->patient - 1].text, ANNOTATION_TEXT_SIZE, "%s", words);
}

bool annotations_add_words(struct annotations *annotations, const char *words, struct error *err)
{
    size_t at = 0, n = 0;
    struct annotation_item *items =
        mem_array(annotations->n_items + ANNOTATE_MAX_WORDS, sizeof items[0], UINT64_MAX, err);
    if (!items)
        return false;
    while (at < annotations->n_items && annotations->items[at].row == ANNOTATION_TITLE)
        at++;
    if (at > 0)
        memcpy(items, annotations->items, at * sizeof items[0]);
    for (const char *end; *words && n < ANNOTATE_MAX_WORDS; words = end) {
        const char *mark = n + 1 < ANNOTATE_MAX_WORDS ? strstr(words, "; ") : NULL;
        const size_t length = mark ? (size_t)(mark - words) : strlen(words);
        end = mark ? mark + 2 : words + length;
        items[at + n] = (struct annotation_item){ .row = ANNOTATION_WORDS };
        (void)snprintf(items[at + n].text, ANNOTATION_TEXT_SIZE, "%.*s", (int)length, words);
        n++;
    }
    if (annotations->n_items > at)
        memcpy(items + at + n, annotations->items + at, (annotations->n_items - at) * sizeof items[0]);
    free(annotations->items);
    annotations->items = items;
    annotations->n_items += n;
    return true;
}

bool annotations_describe(struct annotations *annotations, const struct snapshot *snapshot, int width_px,
                          const char *date, struct error *err)
{
    const struct plan *plan = snapshot->plan;
    struct visible_missing missing[VISIBLE_MAX_MISSING];
    struct camera camera;
    size_t n_missing = visible_missing(snapshot, SURFACE_FULL, missing);
    *annotations = (struct annotations){ .n_items = 0 };
    annotations->items = mem_array(plan->regions.n_regions + MAX_OTHER_ITEMS + DESCRIBE_BEAM_MAX_ITEMS +
                                       DESCRIBE_DOSE_MAX_ITEMS + DESCRIBE_FITS_MAX_ITEMS,
                                   sizeof annotations->items[0], UINT64_MAX, err);
    if (!annotations->items)
        return false;
    camera_resolve(snapshot, &camera);
    annotations->letters = letters_of_edges(camera.right, camera.up);
    annotations->is_on_light = visible_ground_is_light(snapshot);
    if (!marks_describe(annotations, snapshot, &camera, err) || !dose_label(annotations, snapshot, width_px, err) ||
        !beam_label(annotations, snapshot, &camera, width_px, err))
        return false;
    annotations->pixels_per_mm = camera.pixels_per_mm * width_px / snapshot->view.size_px[0];

    add_words(annotations, ANNOTATION_TITLE, plan->name[0] ? plan->name : plan->id);
    if (plan->is_phantom && !strstr(plan->name, "hantom"))
        add_words(annotations, ANNOTATION_TITLE, "(phantom)");
    add_patient(annotations, plan);
    add_pane(annotations, snapshot, &camera);
    beam_describe(annotations, snapshot);
    if (!add_regions(annotations, snapshot, missing, n_missing, err))
        return false;
    dose_describe(annotations, snapshot);
    add_methods(annotations, snapshot);
    add_missing(annotations, snapshot, missing, n_missing);
    fits_describe(annotations, snapshot);
    add_origin(annotations, snapshot, date);
    return true;
}

/* Freezes plan, scene and view as a snapshot, checked against the plan; makes the scene that a new room starts with. */
#include "core/scene/snapshot.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/region/target.h"
#include "core/scene/beams_drawn.h"
#include "core/scene/first_dose.h"
#include "core/volume/window.h"
#include "volume_presets.h" /* generated from proto/volume_presets.json */

/* Index of the plan's image; -1: it has none of that id. */
static int image_index(const struct plan *plan, const char *id)
{
    for (size_t i = 0; i < plan->n_images; i++)
        if (strcmp(plan->images[i].id, id) == 0)
            return (int)i;
    return -1;
}

int scene_image_index(const struct plan *plan, const struct scene *scene)
{
    if (scene->image.id[0] == 0)
        return plan->n_images ? fit_first_image(plan) : -1;
    return image_index(plan, scene->image.id);
}

bool snapshot_is_low_white(const struct snapshot *snapshot)
{
    enum scene_low_values wanted = snapshot->scene.image.low_values;
    return wanted == SCENE_LOW_VALUES_OWN ? snapshot->plan->images[snapshot->image].is_inverted
                                          : wanted == SCENE_LOW_VALUES_WHITE;
}

struct scene_image_look snapshot_look_of(const struct snapshot *snapshot, size_t image)
{
    const struct scene_image_style *style = &snapshot->scene.image;
    const struct plan_image *own = &snapshot->plan->images[image];
    for (size_t i = 0; i < style->n_looks; i++)
        if (strcmp(style->looks[i].id, own->id) == 0)
            return style->looks[i].value;
    struct scene_image_look look = scene_image_look_default;
    look.window.center = own->window_center;
    look.window.width = own->window_width;
    return look;
}

/* Fills the styles by region index. A region that the scene does not name has the default style. */
static bool resolve_styles(struct snapshot *snapshot, char field[128], struct error *err)
{
    const struct region_set *set = &snapshot->plan->regions;
    snapshot->styles = mem_array(set->n_regions, sizeof *snapshot->styles, UINT64_MAX, err);
    if (!snapshot->styles)
        return false;
    for (size_t i = 0; i < set->n_regions; i++)
        snapshot->styles[i] = scene_region_style_default;
    for (size_t i = 0; i < snapshot->scene.n_regions; i++) {
        const struct scene_region_style_entry *entry = &snapshot->scene.regions[i];
        const struct region *region = region_find(set, entry->id);
        if (!region) {
            snprintf(field, 128, "/regions/%s", entry->id);
            return error_set(err, ERROR_NOT_FOUND, "the plan has no region '%s'", entry->id);
        }
        snapshot->styles[region - set->regions] = entry->value;
    }
    return true;
}

/* Finds the image and the dose that the scene names; checks the region that is to be checked. */
static bool find_references(struct snapshot *snapshot, char field[128], struct error *err)
{
    const struct plan *plan = snapshot->plan;
    const struct scene *scene = &snapshot->scene;
    snapshot->image = scene_image_index(plan, scene);
    snapshot->blend = scene->image.blend.id[0] ? image_index(plan, scene->image.blend.id) : -1;
    snapshot->dose = scene_dose_index(plan, scene);
    if (snapshot->image < 0 && scene->image.id[0]) {
        snprintf(field, 128, "/image/id");
        return error_set(err, ERROR_NOT_FOUND, "the plan has no image '%s'", scene->image.id);
    }
    if (snapshot->dose < 0 && scene->dose.id[0]) {
        snprintf(field, 128, "/dose/id");
        return error_set(err, ERROR_NOT_FOUND, "the plan has no dose '%s'", scene->dose.id);
    }
    if (scene->image.blend.id[0] && snapshot->blend < 0) {
        snprintf(field, 128, "/image/blend/id");
        return error_set(err, ERROR_NOT_FOUND, "the plan has no image '%s'", scene->image.blend.id);
    }
    if (scene->beam.id[0] && !beam_shown_of(plan, scene, scene->beam.id, NULL, &snapshot->beam)) {
        snprintf(field, 128, "/beam/id");
        return error_set(err, ERROR_NOT_FOUND, "the plan has no beam '%s'", scene->beam.id);
    }
    if (scene->check.region[0] && !region_find(&plan->regions, scene->check.region)) {
        snprintf(field, 128, "/check/region");
        return error_set(err, ERROR_NOT_FOUND, "the plan has no region '%s'", scene->check.region);
    }
    return true;
}

/* A dose that cannot be shown leaves the picture without dose, and is no error of the scene. */
static void choose_dose(struct snapshot *snapshot)
{
    if (snapshot->dose < 0)
        (void)error_set(&snapshot->dose_why, ERROR_NOT_FOUND, "the plan has no dose");
    else
        snapshot->has_dose_choice = dose_choice_of(snapshot, (size_t)snapshot->dose, snapshot->scene.dose.quantity,
                                                   &snapshot->dose_choice, &snapshot->dose_why);
}

/* Decides what is used, and takes out of the snapshot what is not: nothing else of it may be drawn or read. */
static bool resolve_fits(struct snapshot *snapshot, const struct acceptances *acceptances, struct error *err)
{
    if (!scene_fits_of(snapshot->plan, snapshot->image, snapshot->blend, snapshot->dose, acceptances, &snapshot->fits,
                       err))
        return false;
    if (snapshot->image >= 0 && !fit_is_used(&snapshot->fits.images[snapshot->image]))
        snapshot->image = -1;
    if (snapshot->blend >= 0 && !fit_is_used(&snapshot->fits.beside[snapshot->blend]))
        snapshot->blend = -1;
    for (size_t r = 0; r < snapshot->plan->regions.n_regions; r++)
        snapshot->styles[r].visible &= fit_is_used(region_use(&snapshot->fits, r));
    return true;
}

struct snapshot *snapshot_create(struct derive *derived, struct scene *scene, struct view *view,
                                 uint32_t scene_revision, char field[128], struct error *err)
{
    return snapshot_create_accepted(derived, scene, view, NULL, scene_revision, field, err);
}

struct snapshot *snapshot_create_accepted(struct derive *derived, struct scene *scene, struct view *view,
                                          const struct acceptances *acceptances, uint32_t scene_revision,
                                          char field[128], struct error *err)
{
    struct snapshot *snapshot = mem_new(sizeof *snapshot);
    *snapshot = (struct snapshot){ .plan = derive_plan(derived),
                                   .derived = derived,
                                   .scene = *scene,
                                   .view = *view,
                                   .scene_revision = scene_revision,
                                   .references = 1 };
    *scene = scene_default;
    *view = view_default;
    field[0] = 0;

    if (!resolve_styles(snapshot, field, err))
        goto fail;
    if (!find_references(snapshot, field, err) || !resolve_fits(snapshot, acceptances, err))
        goto fail;
    choose_dose(snapshot);
    const struct plan *plan = snapshot->plan;
    const struct scene_fits *fits = &snapshot->fits;
    snapshot->has_beam = beam_shown_of(plan, &snapshot->scene, "", fits, &snapshot->beam);
    snapshot->pane = plane_of_view(plan, &snapshot->scene, fits, &snapshot->view);
    snapshot->n_slices = planes_of_slices(plan, &snapshot->scene, fits, snapshot->slices);
    snapshot->beyond_lps_mm = snapshot_is_pane(snapshot) ? box3_empty() : beams_box(plan, &snapshot->scene, fits);
    if (!snapshot_is_pane(snapshot))
        snapshot->n_clips = clip_planes(plan, &snapshot->scene, fits, snapshot->clips);
    if (!camera_check(snapshot->plan, &snapshot->view, &snapshot->pane, snapshot_beam(snapshot), field, err))
        goto fail;
    return snapshot;
fail:
    snapshot_unref(snapshot);
    return NULL;
}

struct snapshot *snapshot_ref(const struct snapshot *snapshot)
{
    struct snapshot *shared = (struct snapshot *)(uintptr_t)snapshot; /* frozen except for its counter */
    atomic_fetch_add(&shared->references, 1);
    return shared;
}

void snapshot_unref(const struct snapshot *snapshot)
{
    if (!snapshot)
        return;
    struct snapshot *shared = (struct snapshot *)(uintptr_t)snapshot;
    if (atomic_fetch_sub(&shared->references, 1) != 1)
        return;
    scene_finish(&shared->scene);
    view_finish(&shared->view);
    scene_fits_finish(&shared->fits);
    free(shared->styles);
    free(shared);
}

static bool region_has_children(const struct region_set *set, size_t index)
{
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].parent == (int)index)
            return true;
    return false;
}

/* The first target that is used with the first image and dose; -1: none. */
static int first_target(const struct plan *plan, int image)
{
    struct scene_fits *fits = mem_new(sizeof *fits);
    struct error err = { 0 };
    int target = scene_fits_of(plan, image, -1, plan->n_doses ? 0 : -1, NULL, fits, &err)
                     ? region_first_target(&fits->used)
                     : -1;
    scene_fits_finish(fits);
    free(fits);
    return target;
}

/* In the first target, else the image's centre, else the plan's; on the centre of a voxel of the first image. */
static struct vec3 first_crosshair_lps_mm(const struct plan *plan, int image)
{
    const struct grid *grid = image >= 0 ? &plan->images[image].volume->grid : NULL;
    int target = first_target(plan, image);
    struct vec3 at = vec3(0, 0, 0);
    if (target >= 0)
        at = region_middle_lps_mm(&plan->regions, (size_t)target);
    else if (grid || !box3_is_empty(&plan->bounds_lps_mm)) {
        struct box3 box = grid ? grid_bounds_lps_mm(grid) : plan->bounds_lps_mm;
        at = vec3_scale(vec3_add(box.low, box.high), 0.5);
    }
    return grid ? grid_nearest_centre_lps_mm(grid, at) : at;
}

/* The first transfer function that fits the image, in the image's own values. */
static void first_transfer_function(const struct plan_image *image, struct scene_volume_style *style)
{
    const struct volume_preset *preset = volume_presets;
    while (preset->is_hu != (strcmp(image->unit, "HU") == 0))
        preset++;
    double low = image->window_center - image->window_width / 2;
    style->points = mem_new(preset->n_points * sizeof *style->points);
    style->n_points = preset->n_points;
    for (size_t i = 0; i < preset->n_points; i++) {
        style->points[i] = preset->points[i];
        if (!preset->is_hu)
            style->points[i].value =
                fmin(fmax(low + preset->points[i].value * image->window_width, -WINDOW_CENTER_FARTHEST),
                     WINDOW_CENTER_FARTHEST);
    }
}

void scene_for_plan(const struct plan *plan, struct scene *scene)
{
    const struct region_set *set = &plan->regions;
    *scene = scene_default;
    scene->regions = set->n_regions ? mem_new(set->n_regions * sizeof *scene->regions) : NULL; /* at most REGION_MAX */
    scene->n_regions = set->n_regions;
    for (size_t i = 0; i < set->n_regions; i++) {
        const struct region *region = &set->regions[i];
        struct scene_region_style_entry *entry = &scene->regions[i];
        memcpy(entry->id, region->id, sizeof entry->id);
        entry->value = scene_region_style_default;
        entry->value.color_rgb = (uint32_t)region->rgb[0] << 16 | (uint32_t)region->rgb[1] << 8 | region->rgb[2];
        if (region_has_children(set, i))
            entry->value.opacity = region->parent < 0 ? 0.35 : 0.45;
        if (region->file_opacity > 0 &&
            region->file_opacity < 1) /* SERA's preferences hold 100 % for regions that nobody set */
            entry->value.opacity = region->file_opacity;
    }
    scene_first_dose(plan, &scene->dose);
    int first = plan->n_images ? fit_first_image(plan) : -1;
    struct vec3 at = first_crosshair_lps_mm(plan, first);
    scene->image.slices.sagittal.position_mm = at.x;
    scene->image.slices.coronal.position_mm = at.y;
    scene->image.slices.axial.position_mm = at.z;
    if (first >= 0) {
        const struct plan_image *image = &plan->images[first];
        if (first > 0) /* those before it are of another patient: it is named, so that nobody takes the first one */
            snprintf(scene->image.id, sizeof scene->image.id, "%s", image->id);
        scene->image.slices.axial.visible = true;
        scene->image.slices.coronal.visible = scene->image.slices.sagittal.visible = set->n_regions == 0;
        scene->image.window.center = image->window_center;
        scene->image.window.width = image->window_width;
        first_transfer_function(image, &scene->image.volume);
        const struct scene_window *window = &scene->image.window;
        if (strcmp(image->unit, "HU") == 0)
            scene->image.cull_below = -500;
        else if (!image->is_inverted) /* in an inverted image low values are bright and not air */
            scene->image.cull_below = fmax(window->center - 0.45 * window->width, -WINDOW_CENTER_FARTHEST);
    }
}

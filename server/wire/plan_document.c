/* One function for each part of the plan document: plan_document.h. */
#include "server/wire/plan_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/mem.h"
#include "core/plan/fit.h"
#include "core/region/target.h"
#include "core/scene/camera.h"
#include "core/scene/snapshot.h"
#include "server/wire/document.h"
#include "server/wire/plan_fits.h"
#include "server/wire/plan_origins.h"
#include "server/wire/sentence_json.h"

static cJSON *point(struct vec3 p)
{
    cJSON *array = cJSON_CreateArray();
    json_append(array, json_finite(p.x));
    json_append(array, json_finite(p.y));
    json_append(array, json_finite(p.z));
    return array;
}

static cJSON *box(const struct box3 *bounds)
{
    if (!(bounds->low.x <= bounds->high.x))
        return cJSON_CreateNull();
    cJSON *object = cJSON_CreateObject();
    json_add(object, "low", point(bounds->low));
    json_add(object, "high", point(bounds->high));
    return object;
}

static cJSON *matrix(const struct affine *map)
{
    const struct vec3 *c = map->columns;
    const double rows[3][4] = { { c[0].x, c[1].x, c[2].x, map->origin.x },
                                { c[0].y, c[1].y, c[2].y, map->origin.y },
                                { c[0].z, c[1].z, c[2].z, map->origin.z } };
    cJSON *array = cJSON_CreateArray();
    for (int row = 0; row < 3; row++)
        json_append(array, cJSON_CreateDoubleArray(rows[row], 4));
    return array;
}

static cJSON *grid_object(const struct grid *grid)
{
    char letters[4];
    grid_letters(grid, letters);
    struct box3 bounds = grid_bounds_lps_mm(grid);
    cJSON *object = cJSON_CreateObject(), *size = cJSON_CreateArray();
    for (int axis = 0; axis < 3; axis++)
        json_append(size, cJSON_CreateNumber(grid->size[axis]));
    json_add(object, "size", size);
    json_add(object, "spacing_mm", point(grid_spacing_mm(grid)));
    json_add(object, "orientation", cJSON_CreateString(letters));
    json_add(object, "lps_mm_from_ijk", matrix(&grid->lps_mm_from_ijk));
    json_add(object, "bounds_mm", box(&bounds));
    return object;
}

static cJSON *image_object(const struct plan_image *image)
{
    cJSON *object = cJSON_CreateObject(), *window = cJSON_CreateObject();
    json_add(object, "id", cJSON_CreateString(image->id));
    json_add(object, "name", cJSON_CreateString(image->name));
    json_add(object, "modality", cJSON_CreateString(image->modality));
    json_add(object, "unit", cJSON_CreateString(image->unit));
    json_add(object, "grid", grid_object(&image->volume->grid));
    json_add_finite(object, "low", image->volume->low);
    json_add_finite(object, "high", image->volume->high);
    json_add_finite(window, "center", image->window_center);
    json_add_finite(window, "width", image->window_width);
    json_add(object, "window", window);
    json_add(object, "is_inverted", cJSON_CreateBool(image->is_inverted));
    return object;
}

/* Box in patient space around the outer faces of the region's outermost voxels. */
static struct box3 region_bounds(const struct region *region, const struct grid *grid)
{
    struct box3 bounds = box3_empty();
    for (int corner = 0; corner < 8; corner++) {
        double ijk[3];
        for (int axis = 0; axis < 3; axis++)
            ijk[axis] = corner >> axis & 1 ? region->high_ijk[axis] + 0.5 : region->low_ijk[axis] - 0.5;
        box3_add(&bounds, affine_point(&grid->lps_mm_from_ijk, vec3(ijk[0], ijk[1], ijk[2])));
    }
    return bounds;
}

static cJSON *tissue_object(const struct region *region)
{
    cJSON *object = cJSON_CreateObject();
    json_add_finite(object, "boron_ratio", region->boron_ratio);
    json_add_finite(object, "cbe_boron", region->cbe_boron);
    json_add_finite(object, "rbe_nitrogen", region->rbe_nitrogen);
    json_add_finite(object, "rbe_fast", region->rbe_fast);
    json_add_finite(object, "rbe_gamma", region->rbe_gamma);
    return object;
}

static cJSON *region_object(const struct region_set *set, size_t index)
{
    const struct region *region = &set->regions[index];
    const struct grid *grid = &set->layers[region->layer]->grid;
    bool has_voxels = region->n_voxels > 0;
    struct box3 bounds = has_voxels ? region_bounds(region, grid) : box3_empty();
    char color[8];
    snprintf(color, sizeof color, "#%02x%02x%02x", region->rgb[0], region->rgb[1], region->rgb[2]);
    cJSON *object = cJSON_CreateObject();
    json_add(object, "id", cJSON_CreateString(region->id));
    json_add(object, "name", cJSON_CreateString(region->name));
    json_add(object, "color", cJSON_CreateString(color));
    json_add(object, "is_target", cJSON_CreateBool(region_is_target(region)));
    json_add(object, "color_from_file", cJSON_CreateBool(region->has_file_color));
    json_add(object, "parent",
             region->parent >= 0 ? cJSON_CreateString(set->regions[region->parent].id) : cJSON_CreateNull());
    json_add(object, "depth", cJSON_CreateNumber(region_depth(set, index)));
    json_add(object, "grid", grid_object(grid));
    json_add(object, "label", cJSON_CreateNumber(region->label));
    json_add_finite(object, "voxels", (double)region->n_voxels);
    json_add_finite(object, "volume_cm3", region->volume_cm3);
    json_add(object, "center_mm", has_voxels ? point(region->centre_lps_mm) : cJSON_CreateNull());
    json_add(object, "bounds_mm", box(&bounds));
    json_add(object, "touches_edge", cJSON_CreateBool(region->touches_edge));
    json_add(object, "tissue", tissue_object(region));
    return object;
}

/* 0 stands for a value that is not known. */
static cJSON *known(double value)
{
    return value > 0 ? json_finite(value) : cJSON_CreateNull();
}

/* "same" or "differs" where the files give both frames, or plan.json says so; else what the dose says, null if nothing.
 */
static cJSON *frame_word(const struct plan *plan, size_t index, int image, const struct fit *fit)
{
    const struct dose *dose = &plan->doses[index];
    bool is_known = image >= 0 && plan->dose_origins[index].frame_uid[0] && plan->image_origins[image].frame_uid[0];
    enum dose_frame frame = fit->reasons >> FIT_FRAME & 1 ? DOSE_FRAME_DIFFERS
                            : is_known                    ? DOSE_FRAME_SAME
                                                          : dose->frame;
    bool is_said = dose->has_frame || is_known || fit->reasons >> FIT_FRAME & 1;
    return is_said ? cJSON_CreateString(dose_frame_word(frame)) : cJSON_CreateNull();
}

static cJSON *dose_object(const struct plan *plan, size_t index)
{
    const struct dose *dose = &plan->doses[index];
    cJSON *object = cJSON_CreateObject(), *components = cJSON_CreateArray();
    json_add(object, "id", cJSON_CreateString(dose->id));
    json_add(object, "name", cJSON_CreateString(dose->name));
    json_add(object, "unit", cJSON_CreateString(dose->unit));
    json_add(object, "per", cJSON_CreateString(dose->per));
    json_add(object, "beam", known((double)plan->dose_origins[index].beam));
    char why[FIT_WHY_SIZE];
    struct fit_words words;
    int image = fit_first_image(plan);
    struct fit_part part = { FIT_DOSE, index }, with = { FIT_IMAGE, (size_t)(image < 0 ? 0 : image) };
    struct fit fit = image < 0 ? fit_alone(plan, part) : fit_of(plan, part, with);
    fit_describe(plan, part, image < 0 ? part : with, fit.relation, false, why, &words);
    json_add(object, "frame_of_reference", frame_word(plan, index, image, &fit));
    json_add(object, "fit", cJSON_CreateString(fit_relation_word(fit.relation)));
    json_add(object, "fit_reason", cJSON_CreateString(why));
    fit_words_add_json(object, "fit_reason", &words);
    json_add(object, "masked", cJSON_CreateBool(dose->mask != NULL));
    for (size_t i = 0; i < dose->n_components; i++) {
        const struct dose_component *component = &dose->components[i];
        char unit[DOSE_UNIT_SIZE];
        dose_unit_of(dose, component->quantity, unit);
        cJSON *entry = cJSON_CreateObject();
        json_add(entry, "quantity", cJSON_CreateString(dose_quantity_word(component->quantity)));
        json_add(entry, "unit", cJSON_CreateString(unit));
        json_add(entry, "per_ppm", cJSON_CreateBool(component->is_per_ppm));
        json_add(entry, "boron_ppm", component->has_boron_ppm ? json_finite(component->boron_ppm) : cJSON_CreateNull());
        json_add(entry, "grid", grid_object(&component->values->grid));
        json_add_finite(entry, "low", component->values->low);
        json_add_finite(entry, "high", component->values->high);
        json_add(entry, "reference", known(dose->reference[component->quantity]));
        json_add(entry, "body_high", known(dose->body_high[component->quantity]));
        json_append(components, entry);
    }
    json_add(object, "components", components);
    return object;
}

static cJSON *span(const double edges[2])
{
    if (!isfinite(edges[0]) || !isfinite(edges[1]))
        return cJSON_CreateNull();
    return cJSON_CreateDoubleArray(edges, 2);
}

cJSON *beam_outline_object(const struct beam_outline *outline)
{
    if (outline->n_polygons == 0)
        return cJSON_CreateNull();
    cJSON *object = cJSON_CreateObject(), *polygons = cJSON_CreateArray();
    json_add(object, "kind", cJSON_CreateString(beam_outline_word(outline->kind)));
    for (size_t i = 0; i < outline->n_polygons; i++) {
        cJSON *polygon = cJSON_CreateArray();
        for (size_t at = beam_outline_begin(outline, i); at < outline->ends[i]; at++) {
            double xy[2];
            for (int axis = 0; axis < 2; axis++) /* to 0.1 um: a float's digits beyond are no part of the file */
                xy[axis] = round((double)outline->points_mm[at][axis] * 1e4) / 1e4;
            json_append(polygon, cJSON_CreateDoubleArray(xy, 2));
        }
        json_append(polygons, polygon);
    }
    json_add(object, "polygons_mm", polygons);
    return object;
}

static cJSON *delivery_object(const struct beam_delivery *delivery)
{
    cJSON *object = cJSON_CreateObject();
    json_add_finite(object, "number", (double)delivery->number);
    json_add(object, "radiation", cJSON_CreateString(delivery->radiation));
    json_add(object, "machine", cJSON_CreateString(delivery->machine));
    json_add(object, "patient_position", cJSON_CreateString(patient_position_word(delivery->patient_position)));
    json_add_finite(object, "gantry_deg", delivery->gantry_deg);
    json_add_finite(object, "gantry_stop_deg", delivery->gantry_stop_deg);
    json_add_finite(object, "gantry_travel_deg", delivery->gantry_travel_deg);
    json_add_finite(object, "collimator_deg", delivery->collimator_deg);
    json_add_finite(object, "couch_deg", delivery->couch_deg);
    json_add_finite(object, "energy_mev", delivery->energy_mev);
    json_add_finite(object, "sad_mm", delivery->sad_mm);
    json_add_finite(object, "ssd_mm", delivery->ssd_mm);
    json_add(object, "jaws_x_mm", span(delivery->jaws_x_mm));
    json_add(object, "jaws_y_mm", span(delivery->jaws_y_mm));
    json_add(object, "opening_x_mm", span(delivery->opening_x_mm));
    json_add(object, "opening_y_mm", span(delivery->opening_y_mm));
    json_add_finite(object, "opening_cm2", delivery->opening_cm2);
    json_add(object, "outline", beam_outline_object(&delivery->outline));
    json_add_finite(object, "control_points", (double)delivery->n_control_points);
    json_add_finite(object, "dose_gy", delivery->dose_gy);
    json_add_finite(object, "meterset", delivery->meterset);
    json_add(object, "meterset_unit", cJSON_CreateString(delivery->meterset_unit));
    json_add_finite(object, "fractions", (double)delivery->n_fractions);
    return object;
}

static cJSON *beam_object(const struct beam *beam)
{
    cJSON *object = cJSON_CreateObject();
    json_add(object, "id", cJSON_CreateString(beam->id));
    json_add(object, "entry_mm", point(beam->entry_lps_mm));
    json_add(object, "target_mm", point(beam->target_lps_mm));
    json_add_finite(object, "aperture_mm", beam->aperture_mm);
    json_add(object, "name", cJSON_CreateString(beam->name));
    json_add(object, "delivery", beam->has_delivery ? delivery_object(&beam->delivery) : cJSON_CreateNull());
    return object;
}

static cJSON *color_text(const uint8_t rgb[3])
{
    char color[8];
    (void)snprintf(color, sizeof color, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    return cJSON_CreateString(color);
}

static cJSON *track_color(enum track_class class)
{
    uint32_t rgb = track_class_look(class).color_rgb;
    const uint8_t bytes[3] = { (uint8_t)(rgb >> 16), (uint8_t)(rgb >> 8), (uint8_t)rgb };
    return color_text(bytes);
}

static cJSON *track_looks(const struct track_set *tracks)
{
    cJSON *looks = cJSON_CreateArray();
    for (int class = 0; class < TRACK_N_CLASSES; class ++) {
        if (tracks->n_of_class[class] == 0)
            continue;
        const struct track_look look = track_class_look((enum track_class) class);
        const double dash_px[2] = { look.on_px, look.off_px };
        cJSON *object = cJSON_CreateObject();
        json_add(object, "class", cJSON_CreateString(track_class_word((enum track_class) class)));
        json_add(object, "color", track_color((enum track_class) class));
        json_add(object, "dash_px", look.off_px > 0 ? cJSON_CreateDoubleArray(dash_px, 2) : cJSON_CreateNull());
        json_add(object, "has_cross", cJSON_CreateBool(look.has_cross));
        json_append(looks, object);
    }
    return looks;
}

static cJSON *tracks_object(const struct track_set *tracks)
{
    cJSON *object = cJSON_CreateObject(), *classes = cJSON_CreateObject(), *colors = cJSON_CreateObject();
    json_add_finite(object, "segments", (double)tracks->n_segments);
    for (int class = 0; class < TRACK_N_CLASSES; class ++) {
        const char *word = track_class_word((enum track_class) class);
        json_add(classes, word, json_finite((double)tracks->n_of_class[class]));
        json_add(colors, word, track_color((enum track_class) class));
    }
    json_add(object, "classes", classes);
    json_add(object, "looks", track_looks(tracks));
    json_add(object, "colors", colors);
    return object;
}

static cJSON *curve_object(const struct dose_curve *curve)
{
    cJSON *object = cJSON_CreateObject(), *quantities = cJSON_CreateArray();
    json_add(object, "id", cJSON_CreateString(curve->id));
    json_add(object, "name", cJSON_CreateString(curve->name));
    json_add(object, "unit", cJSON_CreateString(curve->unit));
    json_add(object, "per", cJSON_CreateString(curve->per));
    const double ends[4] = { curve->depths_mm[0], curve->depths_mm[curve->n_depths - 1], curve->radii_mm[0],
                             curve->radii_mm[curve->n_radii - 1] };
    json_add(object, "depth_mm", cJSON_CreateDoubleArray(ends, 2));
    json_add(object, "radius_mm", cJSON_CreateDoubleArray(ends + 2, 2));
    for (size_t c = 0; c < curve->n_columns; c++) {
        cJSON *entry = cJSON_CreateObject();
        char unit[DOSE_UNIT_SIZE];
        double depth = NAN, value = NAN;
        dose_quantity_unit(curve->unit, curve->quantities[c], unit);
        bool has_peak = dose_curve_peak(curve, c, &depth, &value);
        json_add(entry, "quantity", cJSON_CreateString(dose_quantity_word(curve->quantities[c])));
        json_add(entry, "unit", cJSON_CreateString(unit));
        json_add(entry, "per_ppm", cJSON_CreateBool(curve->is_per_ppm[c]));
        json_add(entry, "peak", has_peak ? json_finite(value) : cJSON_CreateNull());
        json_add(entry, "peak_depth_mm", has_peak ? json_finite(depth) : cJSON_CreateNull());
        json_append(quantities, entry);
    }
    json_add(object, "quantities", quantities);
    return object;
}

static cJSON *preferences_object(const struct plan_preferences *preferences)
{
    cJSON *object = cJSON_CreateObject(), *levels = cJSON_CreateArray(), *colors = cJSON_CreateArray();
    for (size_t i = 0; i < preferences->n_levels; i++) {
        cJSON *level = cJSON_CreateObject();
        json_add_finite(level, "percent", preferences->levels[i].percent);
        json_add(level, "color", color_text(preferences->levels[i].rgb));
        json_append(levels, level);
    }
    for (size_t i = 0; i < preferences->n_colors; i++)
        json_append(colors, color_text(preferences->colors[i]));
    json_add(object, "levels", levels);
    json_add(object, "colors", colors);
    return object;
}

static cJSON *report_object(const struct report *report)
{
    cJSON *object = cJSON_CreateObject(), *lines = cJSON_CreateArray();
    for (size_t i = 0; i < report->n_lines; i++) {
        const struct report_line *line = &report->lines[i];
        cJSON *entry = cJSON_CreateObject();
        json_add(entry, "severity", cJSON_CreateString(report_severity_word(line->severity)));
        json_add(entry, "code", cJSON_CreateString(line->code));
        json_add(entry, "where", cJSON_CreateString(line->where));
        json_add(entry, "sentence", cJSON_CreateString(line->sentence));
        sentence_add_json(entry, "sentence", &line->facts);
        json_append(lines, entry);
    }
    json_add(object, "lines", lines);
    json_add_finite(object, "dropped", (double)report->n_dropped);
    return object;
}

static cJSON *home_object(const struct plan *plan)
{
    cJSON *object = cJSON_CreateObject();
    for (size_t kind = 0; kind < scene_kind_words.n; kind++) {
        struct scene_camera camera;
        camera_home(plan, (enum scene_kind)kind, &camera);
        json_add(object, scene_kind_words.words[kind], camera_write(&camera));
    }
    return object;
}

/* Without memory for a part, that part is missing. */
static cJSON *write_plan(const struct plan *plan)
{
    static const char *const hierarchy_words[] = {
        [HIERARCHY_NONE] = "none", [HIERARCHY_FILE] = "file", [HIERARCHY_DERIVED] = "derived"
    };
    cJSON *object = cJSON_CreateObject(), *images = cJSON_CreateArray(), *regions = cJSON_CreateArray();
    cJSON *doses = cJSON_CreateArray(), *beams = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_images; i++)
        json_append(images, image_object(&plan->images[i]));
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        json_append(regions, region_object(&plan->regions, i));
    for (size_t i = 0; i < plan->n_doses; i++)
        json_append(doses, dose_object(plan, i));
    for (size_t i = 0; i < plan->n_beams; i++)
        json_append(beams, beam_object(&plan->beams[i]));
    json_add(object, "id", cJSON_CreateString(plan->id));
    json_add(object, "name", cJSON_CreateString(plan->name));
    json_add(object, "note", cJSON_CreateString(plan->note));
    json_add(object, "is_phantom", cJSON_CreateBool(plan->is_phantom));
    json_add_finite(object, "load_ms", (double)plan->load_us / 1000);
    json_add(object, "bounds_mm", box(&plan->bounds_lps_mm));
    json_add(object, "home", home_object(plan));
    json_add(object, "images", images);
    json_add(object, "regions", regions);
    json_add(object, "hierarchy", cJSON_CreateString(hierarchy_words[plan->regions.hierarchy]));
    json_add(object, "doses", doses);
    json_add(object, "beams", beams);
    json_add(object, "tracks", tracks_object(&plan->tracks));
    cJSON *curves = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_curves; i++)
        json_append(curves, curve_object(&plan->curves[i]));
    json_add(object, "curves", curves);
    json_add(object, "fits", plan_fits_array(plan));
    json_add(object, "preferences", preferences_object(&plan->preferences));
    json_add(object, "report", report_object(&plan->report));
    plan_origins_add(object, plan);
    return object;
}

cJSON *plan_document(const struct plan *plan)
{
    size_t before = mem_n_refused();
    cJSON *document = write_plan(plan);
    if (mem_n_refused() == before)
        return document;
    cJSON_Delete(document);
    return NULL;
}

/* One function for each part of the plan document: plan_document.h. */
#include "server/wire/plan_document.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/scene/snapshot.h"
#include "server/wire/document.h"

static void add(cJSON *object, const char *name, cJSON *value) /* takes value */
{
    if (!value || !cJSON_AddItemToObject(object, name, value))
        abort(); /* no memory: as mem_new */
}

static void append(cJSON *array, cJSON *value) /* takes value */
{
    if (!value || !cJSON_AddItemToArray(array, value))
        abort();
}

static cJSON *number(double value)
{
    return isfinite(value) ? cJSON_CreateNumber(value) : cJSON_CreateNull();
}

static cJSON *point(struct vec3 p)
{
    cJSON *array = cJSON_CreateArray();
    append(array, number(p.x));
    append(array, number(p.y));
    append(array, number(p.z));
    return array;
}

static cJSON *box(const struct box3 *bounds)
{
    if (!(bounds->low.x <= bounds->high.x))
        return cJSON_CreateNull();
    cJSON *object = cJSON_CreateObject();
    add(object, "low", point(bounds->low));
    add(object, "high", point(bounds->high));
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
        append(array, cJSON_CreateDoubleArray(rows[row], 4));
    return array;
}

static cJSON *grid_object(const struct grid *grid)
{
    char letters[4];
    grid_letters(grid, letters);
    struct box3 bounds = grid_bounds_lps_mm(grid);
    cJSON *object = cJSON_CreateObject(), *size = cJSON_CreateArray();
    for (int axis = 0; axis < 3; axis++)
        append(size, cJSON_CreateNumber(grid->size[axis]));
    add(object, "size", size);
    add(object, "spacing_mm", point(grid_spacing_mm(grid)));
    add(object, "orientation", cJSON_CreateString(letters));
    add(object, "lps_mm_from_ijk", matrix(&grid->lps_mm_from_ijk));
    add(object, "bounds_mm", box(&bounds));
    return object;
}

static cJSON *image_object(const struct plan_image *image)
{
    cJSON *object = cJSON_CreateObject(), *window = cJSON_CreateObject();
    add(object, "id", cJSON_CreateString(image->id));
    add(object, "name", cJSON_CreateString(image->name));
    add(object, "modality", cJSON_CreateString(image->modality));
    add(object, "unit", cJSON_CreateString(image->unit));
    add(object, "grid", grid_object(&image->volume->grid));
    add(object, "low", number(image->volume->low));
    add(object, "high", number(image->volume->high));
    add(window, "center", number(image->window_center));
    add(window, "width", number(image->window_width));
    add(object, "window", window);
    add(object, "is_inverted", cJSON_CreateBool(image->is_inverted));
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
    add(object, "boron_ratio", number(region->boron_ratio));
    add(object, "cbe_boron", number(region->cbe_boron));
    add(object, "rbe_nitrogen", number(region->rbe_nitrogen));
    add(object, "rbe_fast", number(region->rbe_fast));
    add(object, "rbe_gamma", number(region->rbe_gamma));
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
    add(object, "id", cJSON_CreateString(region->id));
    add(object, "name", cJSON_CreateString(region->name));
    add(object, "color", cJSON_CreateString(color));
    add(object, "color_from_file", cJSON_CreateBool(region->has_file_color));
    add(object, "parent",
        region->parent >= 0 ? cJSON_CreateString(set->regions[region->parent].id) : cJSON_CreateNull());
    add(object, "depth", cJSON_CreateNumber(region_depth(set, index)));
    add(object, "grid", grid_object(grid));
    add(object, "label", cJSON_CreateNumber(region->label));
    add(object, "voxels", number((double)region->n_voxels));
    add(object, "volume_cm3", number(region->volume_cm3));
    add(object, "center_mm", has_voxels ? point(region->centre_lps_mm) : cJSON_CreateNull());
    add(object, "bounds_mm", box(&bounds));
    add(object, "touches_edge", cJSON_CreateBool(region->touches_edge));
    add(object, "tissue", tissue_object(region));
    return object;
}

/* 0 stands for a value that is not known. */
static cJSON *known(double value)
{
    return value > 0 ? number(value) : cJSON_CreateNull();
}

static cJSON *dose_object(const struct dose *dose)
{
    cJSON *object = cJSON_CreateObject(), *components = cJSON_CreateArray();
    add(object, "id", cJSON_CreateString(dose->id));
    add(object, "name", cJSON_CreateString(dose->name));
    add(object, "unit", cJSON_CreateString(dose->unit));
    add(object, "per", cJSON_CreateString(dose->per));
    add(object, "frame_of_reference",
        dose->has_frame ? cJSON_CreateString(dose_frame_word(dose->frame)) : cJSON_CreateNull());
    add(object, "masked", cJSON_CreateBool(dose->mask != NULL));
    for (size_t i = 0; i < dose->n_components; i++) {
        const struct dose_component *component = &dose->components[i];
        char unit[DOSE_UNIT_SIZE];
        dose_unit_of(dose, component->quantity, unit);
        cJSON *entry = cJSON_CreateObject();
        add(entry, "quantity", cJSON_CreateString(dose_quantity_word(component->quantity)));
        add(entry, "unit", cJSON_CreateString(unit));
        add(entry, "per_ppm", cJSON_CreateBool(component->is_per_ppm));
        add(entry, "boron_ppm", component->has_boron_ppm ? number(component->boron_ppm) : cJSON_CreateNull());
        add(entry, "grid", grid_object(&component->values->grid));
        add(entry, "low", number(component->values->low));
        add(entry, "high", number(component->values->high));
        add(entry, "reference", known(dose->reference[component->quantity]));
        add(entry, "body_high", known(dose->body_high[component->quantity]));
        append(components, entry);
    }
    add(object, "components", components);
    return object;
}

static cJSON *span(const double edges[2])
{
    if (!isfinite(edges[0]) || !isfinite(edges[1]))
        return cJSON_CreateNull();
    return cJSON_CreateDoubleArray(edges, 2);
}

static cJSON *delivery_object(const struct beam_delivery *delivery)
{
    cJSON *object = cJSON_CreateObject();
    add(object, "number", number((double)delivery->number));
    add(object, "radiation", cJSON_CreateString(delivery->radiation));
    add(object, "machine", cJSON_CreateString(delivery->machine));
    add(object, "patient_position", cJSON_CreateString(patient_position_word(delivery->patient_position)));
    add(object, "gantry_deg", number(delivery->gantry_deg));
    add(object, "gantry_stop_deg", number(delivery->gantry_stop_deg));
    add(object, "gantry_travel_deg", number(delivery->gantry_travel_deg));
    add(object, "collimator_deg", number(delivery->collimator_deg));
    add(object, "couch_deg", number(delivery->couch_deg));
    add(object, "energy_mev", number(delivery->energy_mev));
    add(object, "sad_mm", number(delivery->sad_mm));
    add(object, "ssd_mm", number(delivery->ssd_mm));
    add(object, "jaws_x_mm", span(delivery->jaws_x_mm));
    add(object, "jaws_y_mm", span(delivery->jaws_y_mm));
    add(object, "opening_x_mm", span(delivery->opening_x_mm));
    add(object, "opening_y_mm", span(delivery->opening_y_mm));
    add(object, "opening_cm2", number(delivery->opening_cm2));
    add(object, "control_points", number((double)delivery->n_control_points));
    add(object, "dose_gy", number(delivery->dose_gy));
    add(object, "meterset", number(delivery->meterset));
    add(object, "meterset_unit", cJSON_CreateString(delivery->meterset_unit));
    add(object, "fractions", number((double)delivery->n_fractions));
    return object;
}

static cJSON *beam_object(const struct beam *beam)
{
    cJSON *object = cJSON_CreateObject();
    add(object, "id", cJSON_CreateString(beam->id));
    add(object, "entry_mm", point(beam->entry_lps_mm));
    add(object, "target_mm", point(beam->target_lps_mm));
    add(object, "aperture_mm", number(beam->aperture_mm));
    add(object, "name", cJSON_CreateString(beam->name));
    add(object, "delivery", beam->has_delivery ? delivery_object(&beam->delivery) : cJSON_CreateNull());
    return object;
}

static cJSON *tracks_object(const struct track_set *tracks)
{
    cJSON *object = cJSON_CreateObject(), *classes = cJSON_CreateObject();
    add(object, "segments", number((double)tracks->n_segments));
    for (int class = 0; class < TRACK_N_CLASSES; class ++)
        add(classes, track_class_word((enum track_class) class), number((double)tracks->n_of_class[class]));
    add(object, "classes", classes);
    return object;
}

static cJSON *curve_object(const struct dose_curve *curve)
{
    cJSON *object = cJSON_CreateObject(), *quantities = cJSON_CreateArray();
    add(object, "id", cJSON_CreateString(curve->id));
    add(object, "name", cJSON_CreateString(curve->name));
    add(object, "unit", cJSON_CreateString(curve->unit));
    add(object, "per", cJSON_CreateString(curve->per));
    const double ends[4] = { curve->depths_mm[0], curve->depths_mm[curve->n_depths - 1], curve->radii_mm[0],
                             curve->radii_mm[curve->n_radii - 1] };
    add(object, "depth_mm", cJSON_CreateDoubleArray(ends, 2));
    add(object, "radius_mm", cJSON_CreateDoubleArray(ends + 2, 2));
    for (size_t c = 0; c < curve->n_columns; c++) {
        cJSON *entry = cJSON_CreateObject();
        char unit[DOSE_UNIT_SIZE];
        double depth = NAN, value = NAN;
        dose_quantity_unit(curve->unit, curve->quantities[c], unit);
        bool has_peak = dose_curve_peak(curve, c, &depth, &value);
        add(entry, "quantity", cJSON_CreateString(dose_quantity_word(curve->quantities[c])));
        add(entry, "unit", cJSON_CreateString(unit));
        add(entry, "per_ppm", cJSON_CreateBool(curve->is_per_ppm[c]));
        add(entry, "peak", has_peak ? number(value) : cJSON_CreateNull());
        add(entry, "peak_depth_mm", has_peak ? number(depth) : cJSON_CreateNull());
        append(quantities, entry);
    }
    add(object, "quantities", quantities);
    return object;
}

static cJSON *color_text(const uint8_t rgb[3])
{
    char color[8];
    snprintf(color, sizeof color, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    return cJSON_CreateString(color);
}

static cJSON *preferences_object(const struct plan_preferences *preferences)
{
    cJSON *object = cJSON_CreateObject(), *levels = cJSON_CreateArray(), *colors = cJSON_CreateArray();
    for (size_t i = 0; i < preferences->n_levels; i++) {
        cJSON *level = cJSON_CreateObject();
        add(level, "percent", number(preferences->levels[i].percent));
        add(level, "color", color_text(preferences->levels[i].rgb));
        append(levels, level);
    }
    for (size_t i = 0; i < preferences->n_colors; i++)
        append(colors, color_text(preferences->colors[i]));
    add(object, "levels", levels);
    add(object, "colors", colors);
    return object;
}

static cJSON *report_object(const struct report *report)
{
    cJSON *object = cJSON_CreateObject(), *lines = cJSON_CreateArray();
    for (size_t i = 0; i < report->n_lines; i++) {
        const struct report_line *line = &report->lines[i];
        cJSON *entry = cJSON_CreateObject();
        add(entry, "severity", cJSON_CreateString(report_severity_word(line->severity)));
        add(entry, "code", cJSON_CreateString(line->code));
        add(entry, "where", cJSON_CreateString(line->where));
        add(entry, "sentence", cJSON_CreateString(line->sentence));
        append(lines, entry);
    }
    add(object, "lines", lines);
    add(object, "dropped", number((double)report->n_dropped));
    return object;
}

static cJSON *home_object(const struct plan *plan)
{
    cJSON *object = cJSON_CreateObject();
    for (size_t kind = 0; kind < scene_kind_words.n; kind++) {
        struct scene_camera camera;
        camera_home(plan, (enum scene_kind)kind, &camera);
        add(object, scene_kind_words.words[kind], camera_write(&camera));
    }
    return object;
}

cJSON *plan_document(const struct plan *plan)
{
    static const char *const hierarchy_words[] = {
        [HIERARCHY_NONE] = "none", [HIERARCHY_FILE] = "file", [HIERARCHY_DERIVED] = "derived"
    };
    cJSON *object = cJSON_CreateObject(), *images = cJSON_CreateArray(), *regions = cJSON_CreateArray();
    cJSON *doses = cJSON_CreateArray(), *beams = cJSON_CreateArray();
    if (!object || !images || !regions || !doses || !beams)
        abort();
    for (size_t i = 0; i < plan->n_images; i++)
        append(images, image_object(&plan->images[i]));
    for (size_t i = 0; i < plan->regions.n_regions; i++)
        append(regions, region_object(&plan->regions, i));
    for (size_t i = 0; i < plan->n_doses; i++)
        append(doses, dose_object(&plan->doses[i]));
    for (size_t i = 0; i < plan->n_beams; i++)
        append(beams, beam_object(&plan->beams[i]));
    add(object, "id", cJSON_CreateString(plan->id));
    add(object, "name", cJSON_CreateString(plan->name));
    add(object, "note", cJSON_CreateString(plan->note));
    add(object, "is_phantom", cJSON_CreateBool(plan->is_phantom));
    add(object, "load_ms", number((double)plan->load_us / 1000));
    add(object, "bounds_mm", box(&plan->bounds_lps_mm));
    add(object, "home", home_object(plan));
    add(object, "images", images);
    add(object, "regions", regions);
    add(object, "hierarchy", cJSON_CreateString(hierarchy_words[plan->regions.hierarchy]));
    add(object, "doses", doses);
    add(object, "beams", beams);
    add(object, "tracks", tracks_object(&plan->tracks));
    cJSON *curves = cJSON_CreateArray();
    for (size_t i = 0; i < plan->n_curves; i++)
        append(curves, curve_object(&plan->curves[i]));
    add(object, "curves", curves);
    add(object, "preferences", preferences_object(&plan->preferences));
    add(object, "report", report_object(&plan->report));
    return object;
}

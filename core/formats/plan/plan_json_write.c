/* Writes plan.json and lists of label names. */
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/formats/plan/plan_json.h"
#include "core/formats/plan/plan_json_delivery.h"

/* Without memory these return and go on with less: print() then gives no text (error_n_memory). */
static bool add(cJSON *object, const char *key, cJSON *value) /* consumes value */
{
    bool is_added = value && cJSON_AddItemToObject(object, key, value);
    if (!is_added)
        cJSON_Delete(value);
    return is_added;
}

static cJSON *append(cJSON *list, cJSON *value) /* consumes value; NULL: it is not there */
{
    if (value && cJSON_AddItemToArray(list, value))
        return value;
    cJSON_Delete(value);
    return NULL;
}

static cJSON *add_list(cJSON *object, const char *key)
{
    cJSON *list = cJSON_CreateArray();
    return add(object, key, list) ? list : NULL;
}

static void add_text(cJSON *object, const char *key, const char *text)
{
    if (text[0])
        add(object, key, cJSON_CreateString(text));
}

/* Prints the fewest digits that read back to the same double; cJSON's own printing may differ in the last bit. */
static cJSON *exact_number(double value)
{
    char text[32];
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, value);
        if (strtod(text, NULL) == value)
            break;
    }
    return cJSON_CreateRaw(text);
}

static void add_number(cJSON *object, const char *key, double value)
{
    if (isfinite(value))
        add(object, key, exact_number(value));
}

static void add_point(cJSON *object, const char *key, struct vec3 p)
{
    cJSON *list = add_list(object, key);
    append(list, exact_number(p.x));
    append(list, exact_number(p.y));
    append(list, exact_number(p.z));
}

static void add_color(cJSON *object, const uint8_t rgb[3])
{
    char color[8];
    snprintf(color, sizeof color, "#%02x%02x%02x", rgb[0], rgb[1], rgb[2]);
    add_text(object, "color", color);
}

/* Consumes root. n_lacked: error_n_memory() before it was begun. */
static char *print(cJSON *root, size_t n_lacked, struct error *err)
{
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    if (text && error_n_memory() == n_lacked)
        return text;
    free(text);
    error_set(err, ERROR_MEMORY, "no memory for the text of a plan");
    return NULL;
}

static void add_images(cJSON *root, const struct plan_file *file)
{
    cJSON *list = file->n_images ? add_list(root, "images") : NULL;
    for (size_t i = 0; i < file->n_images; i++) {
        const struct plan_file_image *image = &file->images[i];
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "id", image->id);
        add_text(entry, "name", image->name);
        add_text(entry, "modality", image->modality);
        add_text(entry, "path", image->path);
        add_text(entry, "header", image->header);
        add_text(entry, "value_unit", image->value_unit);
        if (image->is_inverted)
            add(entry, "inverted", cJSON_CreateTrue());
        if (!(image->window_width > 0))
            continue;
        cJSON *window = cJSON_CreateObject();
        if (!add(entry, "window", window))
            continue;
        add_number(window, "center", image->window_center);
        add_number(window, "width", image->window_width);
    }
}

static void add_regions(cJSON *root, const struct plan_file *file)
{
    cJSON *list = file->n_regions ? add_list(root, "regions") : NULL;
    for (size_t i = 0; i < file->n_regions; i++) {
        const struct plan_file_region *region = &file->regions[i];
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "path", region->path);
        add_text(entry, "name", region->name);
        add_text(entry, "names", region->names);
        if (region->has_color)
            add_color(entry, region->rgb);
    }
}

static void add_hierarchy(cJSON *root, const struct plan_file *file)
{
    add_text(root, "hierarchy", file->hierarchy);
    if (file->hierarchy[0] || file->n_pairs == 0)
        return;
    cJSON *tree = cJSON_CreateObject();
    if (!add(root, "hierarchy", tree))
        return;
    for (size_t i = 0; i < file->n_pairs; i++) {
        cJSON *inside = cJSON_GetObjectItemCaseSensitive(tree, file->pairs[i].outer);
        append(inside ? inside : add_list(tree, file->pairs[i].outer), cJSON_CreateString(file->pairs[i].inner));
    }
}

static void add_doses(cJSON *root, const struct plan_file *file)
{
    cJSON *list = file->n_doses ? add_list(root, "doses") : NULL;
    for (size_t i = 0; i < file->n_doses; i++) {
        const struct plan_file_dose *dose = &file->doses[i];
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "id", dose->id);
        add_text(entry, "name", dose->name);
        add_text(entry, "unit", dose->unit);
        add_text(entry, "per", dose->per);
        add_text(entry, "mask", dose->mask);
        add_text(entry, "frame_of_reference", dose->has_frame ? dose_frame_word(dose->frame) : "");
        cJSON *components = add_list(entry, "components");
        for (size_t c = 0; c < dose->n_components; c++) {
            cJSON *component = append(components, cJSON_CreateObject());
            add_text(component, "quantity", dose_quantity_word(dose->components[c].quantity));
            if (dose->components[c].is_per_ppm)
                add(component, "per_ppm", cJSON_CreateTrue());
            if (dose->components[c].has_boron_ppm)
                add_number(component, "boron_ppm", dose->components[c].boron_ppm);
            if (dose->components[c].reference > 0)
                add_number(component, "reference", dose->components[c].reference);
            add_text(component, "path", dose->components[c].path);
            add_text(component, "error", dose->components[c].error);
        }
    }
}

static void add_outline(cJSON *delivery, const struct beam_outline *outline)
{
    cJSON *entry = outline->n_polygons ? cJSON_CreateObject() : NULL;
    if (!entry || !add(delivery, "outline", entry))
        return;
    add_text(entry, "kind", beam_outline_word(outline->kind));
    cJSON *polygons = add_list(entry, "polygons_mm");
    for (size_t i = 0; i < outline->n_polygons; i++) {
        cJSON *polygon = append(polygons, cJSON_CreateArray());
        for (size_t at = beam_outline_begin(outline, i); at < outline->ends[i]; at++) {
            cJSON *point = append(polygon, cJSON_CreateArray());
            append(point, exact_number((double)outline->points_mm[at][0]));
            append(point, exact_number((double)outline->points_mm[at][1]));
        }
    }
}

static void add_delivery(cJSON *beam, const struct beam_delivery *delivery)
{
    cJSON *entry = cJSON_CreateObject();
    if (!add(beam, "delivery", entry))
        return;
    add_number(entry, "number", (double)delivery->number);
    add_text(entry, "radiation", delivery->radiation);
    add_text(entry, "machine", delivery->machine);
    add_text(entry, "patient_position", patient_position_word(delivery->patient_position));
    for (int i = 0; i < N_DELIVERY_NUMBERS; i++)
        add_number(entry, delivery_numbers[i].key, *(const double *)((const char *)delivery + delivery_numbers[i].at));
    for (int i = 0; i < N_DELIVERY_LISTS; i++) {
        const double *values = (const double *)((const char *)delivery + delivery_lists[i].at);
        int n_known = 0;
        for (int v = 0; v < delivery_lists[i].n; v++)
            n_known += isfinite(values[v]);
        cJSON *list = n_known > 0 ? add_list(entry, delivery_lists[i].key) : NULL;
        for (int v = 0; list && v < delivery_lists[i].n; v++)
            append(list, isfinite(values[v]) ? exact_number(values[v]) : cJSON_CreateNull());
    }
    add_outline(entry, &delivery->outline);
    add_number(entry, "n_control_points", (double)delivery->n_control_points);
    add_text(entry, "meterset_unit", delivery->meterset_unit);
    add_number(entry, "n_fractions", (double)delivery->n_fractions);
}

static void add_beams(cJSON *root, const struct plan_file *file)
{
    cJSON *list = file->n_beams ? add_list(root, "beams") : NULL;
    for (size_t i = 0; i < file->n_beams; i++) {
        const struct beam *beam = &file->beams[i];
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "id", beam->id);
        add_point(entry, "entry_mm", beam->entry_lps_mm);
        add_point(entry, "target_mm", beam->target_lps_mm);
        add_number(entry, "aperture_mm", beam->aperture_mm);
        add_text(entry, "name", beam->name);
        if (beam->has_delivery)
            add_delivery(entry, &beam->delivery);
    }
}

static void add_tracks(cJSON *root, const struct plan_file *file)
{
    cJSON *list = file->n_tracks ? add_list(root, "tracks") : NULL;
    for (size_t i = 0; i < file->n_tracks; i++) {
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "path", file->tracks[i].path);
        if (file->tracks[i].mm > 0)
            add_text(entry, "unit", file->tracks[i].mm > 1 ? "cm" : "mm");
    }
}

static void add_curves(cJSON *root, const struct plan_file *file)
{
    cJSON *list = file->n_curves ? add_list(root, "curves") : NULL;
    for (size_t i = 0; i < file->n_curves; i++) {
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "id", file->curves[i].id);
        add_text(entry, "name", file->curves[i].name);
        add_text(entry, "per", file->curves[i].per);
        add_text(entry, "path", file->curves[i].path);
    }
    list = file->n_preferences ? add_list(root, "preferences") : NULL;
    for (size_t i = 0; i < file->n_preferences; i++) {
        cJSON *entry = append(list, cJSON_CreateObject());
        add_text(entry, "path", file->preferences[i]);
    }
}

char *plan_file_text(const struct plan_file *file, struct error *err)
{
    size_t n_lacked = error_n_memory();
    cJSON *root = cJSON_CreateObject();
    add(root, "format", cJSON_CreateString("beamroom-plan"));
    add(root, "version", cJSON_CreateNumber(1));
    add_text(root, "name", file->name);
    if (file->is_phantom)
        add(root, "phantom", cJSON_CreateTrue());
    add_text(root, "note", file->note);
    add_images(root, file);
    add_regions(root, file);
    add_hierarchy(root, file);
    add_doses(root, file);
    add_beams(root, file);
    add_tracks(root, file);
    add_curves(root, file);
    return print(root, n_lacked, err);
}

char *label_names_text(const struct label_names *names, struct error *err)
{
    size_t n_lacked = error_n_memory();
    cJSON *root = cJSON_CreateObject(), *list = add_list(root, "labels");
    for (size_t i = 0; i < names->n; i++) {
        const struct label_name *label = &names->labels[i];
        cJSON *entry = append(list, cJSON_CreateObject());
        add(entry, "value", cJSON_CreateNumber(label->value));
        add_text(entry, "name", label->name);
        add_text(entry, "id", label->id);
        if (label->place > 0)
            add(entry, "place", cJSON_CreateNumber(label->place));
        if (label->has_color)
            add_color(entry, label->rgb);
        if (label->opacity > 0)
            add_number(entry, "opacity", label->opacity);
        if (label->is_target)
            add(entry, "target", cJSON_CreateTrue());
        add_text(entry, "parent", label->parent);
        if (!label->has_tissue)
            continue;
        cJSON *tissue = cJSON_CreateObject();
        if (!add(entry, "tissue", tissue))
            continue;
        add_number(tissue, "boron_ratio", label->tissue.boron_ratio);
        add_number(tissue, "cbe_boron", label->tissue.cbe_boron);
        add_number(tissue, "rbe_nitrogen", label->tissue.rbe_nitrogen);
        add_number(tissue, "rbe_fast", label->tissue.rbe_fast);
        add_number(tissue, "rbe_gamma", label->tissue.rbe_gamma);
    }
    return print(root, n_lacked, err);
}

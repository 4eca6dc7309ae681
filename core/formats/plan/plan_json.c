/* Reads plan.json. */
#include "core/formats/plan/plan_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/plan/plan_json_beams.h"
#include "core/formats/plan/plan_json_place.h"
#include "core/formats/text.h"
#include "core/volume/window.h"

/* Reads "unit", the unit of lengths for a file that does not give it, or gives a wrong one. 0: the plan does not
 * either. */
static bool get_unit(const struct json_place *place, const cJSON *object, double *mm)
{
    char unit[16];
    if (!place_text(place, object, "unit", unit, sizeof unit))
        return false;
    if (unit[0] && !text_equal(unit, "mm") && !text_equal(unit, "cm"))
        return place_fail(place, ERROR_RANGE, "unit", "expected mm or cm");
    *mm = text_equal(unit, "mm") ? 1 : text_equal(unit, "cm") ? 10 : 0;
    return true;
}

/* Reads "window": {"center": 40, "width": 400}. */
static bool get_window(const struct json_place *place, const cJSON *object, struct plan_file_image *image)
{
    const cJSON *window = cJSON_GetObjectItemCaseSensitive(object, "window");
    if (!window || cJSON_IsNull(window))
        return true;
    const cJSON *center = cJSON_GetObjectItemCaseSensitive(window, "center"),
                *width = cJSON_GetObjectItemCaseSensitive(window, "width");
    if (!cJSON_IsNumber(center) || !cJSON_IsNumber(width) || !(fabs(center->valuedouble) <= WINDOW_CENTER_FARTHEST) ||
        !(width->valuedouble >= WINDOW_NARROWEST && width->valuedouble <= WINDOW_WIDEST))
        return place_fail(place, ERROR_RANGE, "window",
                          "expected a center within 1e12 of 0, and a width from 1e-15 to 2e12");
    image->window_center = center->valuedouble;
    image->window_width = width->valuedouble;
    return true;
}

static bool parse_images(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id",   "path",       "header", "modality", "name",
                                         "unit", "value_unit", "window", "inverted", NULL };
    const cJSON *list;
    if (!place_list(top, root, "images", PLAN_FILE_MAX_IMAGES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "images", (int)file->n_images);
        struct plan_file_image *image = &file->images[file->n_images++];
        place_note_keys(&at, entry, known);
        if (!place_text(&at, entry, "id", image->id, sizeof image->id) ||
            !place_path(&at, entry, "path", true, image->path) ||
            !place_path(&at, entry, "header", false, image->header) ||
            !place_text(&at, entry, "modality", image->modality, sizeof image->modality) ||
            !place_text(&at, entry, "name", image->name, sizeof image->name) || !get_unit(&at, entry, &image->mm) ||
            !place_text(&at, entry, "value_unit", image->value_unit, sizeof image->value_unit) ||
            !place_bool(&at, entry, "inverted", &image->is_inverted) || !get_window(&at, entry, image))
            return false;
    }
    return true;
}

static bool parse_regions(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "path", "names", "name", "color", "unit", NULL };
    const cJSON *list;
    if (!place_list(top, root, "regions", PLAN_FILE_MAX_PARTS, &list))
        return false;
    file->regions = mem_new(((list ? (size_t)cJSON_GetArraySize(list) : 0) + 1) * sizeof *file->regions);
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "regions", (int)file->n_regions);
        struct plan_file_region *region = &file->regions[file->n_regions++];
        place_note_keys(&at, entry, known);
        if (!place_path(&at, entry, "path", true, region->path) ||
            !place_path(&at, entry, "names", false, region->names) ||
            !place_text(&at, entry, "name", region->name, sizeof region->name) ||
            !place_color(&at, entry, &region->has_color, region->rgb) || !get_unit(&at, entry, &region->mm))
            return false;
        if (region->name[0] && region->names[0])
            return place_fail(&at, ERROR_FORMAT, "name",
                              "either \"name\" (a mask) or \"names\" (a label map), not both");
    }
    return true;
}

static bool parse_component(const struct json_place *at, const cJSON *entry, struct plan_file_dose *dose)
{
    struct plan_file_component *component = &dose->components[dose->n_components];
    char word[32];
    if (!place_path(at, entry, "path", true, component->path) ||
        !place_path(at, entry, "error", false, component->error) ||
        !place_text(at, entry, "quantity", word, sizeof word) ||
        !place_bool(at, entry, "per_ppm", &component->is_per_ppm))
        return false;
    const cJSON *reference = cJSON_GetObjectItemCaseSensitive(entry, "reference");
    if (reference && !cJSON_IsNull(reference)) {
        if (!cJSON_IsNumber(reference) || !(reference->valuedouble > 0 && reference->valuedouble <= 1e30))
            return place_fail(at, ERROR_RANGE, "reference",
                              "expected a number above 0, the value that counts as 100 %");
        component->reference = reference->valuedouble;
    }
    const cJSON *ppm = cJSON_GetObjectItemCaseSensitive(entry, "boron_ppm");
    if (ppm && !cJSON_IsNull(ppm)) {
        if (!cJSON_IsNumber(ppm) || !(ppm->valuedouble >= 0 && ppm->valuedouble <= PLAN_FILE_MAX_PPM))
            return place_fail(at, ERROR_RANGE, "boron_ppm",
                              "expected the ppm of boron-10 in blood that is in a total, 0 to 1e6");
        component->has_boron_ppm = true;
        component->boron_ppm = ppm->valuedouble;
    }
    component->quantity = DOSE_TOTAL;
    if (word[0] && !dose_quantity_from_word(word, &component->quantity))
        return place_fail(at, ERROR_RANGE, "quantity",
                          "expected total, boron, nitrogen, fast, gamma, other, fast-fluence, epithermal-fluence, "
                          "thermal-fluence, blood-boron or weighted-total");
    if (component->is_per_ppm && component->quantity != DOSE_BORON && component->quantity != DOSE_BLOOD_BORON)
        return place_fail(at, ERROR_RANGE, "per_ppm", "only boron is given per ppm");
    if (component->has_boron_ppm && component->quantity != DOSE_TOTAL && component->quantity != DOSE_WEIGHTED_TOTAL)
        return place_fail(at, ERROR_RANGE, "boron_ppm", "only a total holds boron at some ppm");
    for (size_t i = 0; i < dose->n_components; i++)
        if (dose->components[i].quantity == component->quantity)
            return place_fail(at, ERROR_RANGE, "quantity", "is there twice");
    dose->n_components++;
    return true;
}

static bool parse_doses(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id",        "name", "path", "quantity", "per_ppm",    "boron_ppm",
                                         "reference", "unit", "per",  "mask",     "components", "frame_of_reference",
                                         "error",     NULL };
    static const char *const known_inside[] = {
        "path", "quantity", "per_ppm", "boron_ppm", "reference", "error", NULL
    };
    const cJSON *list, *components;
    if (!place_list(top, root, "doses", PLAN_FILE_MAX_DOSES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "doses", (int)file->n_doses);
        struct plan_file_dose *dose = &file->doses[file->n_doses++];
        place_note_keys(&at, entry, known);
        if (!place_text(&at, entry, "id", dose->id, sizeof dose->id) ||
            !place_text(&at, entry, "name", dose->name, sizeof dose->name) ||
            !place_text(&at, entry, "unit", dose->unit, sizeof dose->unit) ||
            !place_text(&at, entry, "per", dose->per, sizeof dose->per) ||
            !place_path(&at, entry, "mask", false, dose->mask) ||
            !place_list(&at, entry, "components", DOSE_N_QUANTITIES, &components))
            return false;
        char word[32];
        if (!place_text(&at, entry, "frame_of_reference", word, sizeof word))
            return false;
        dose->has_frame = word[0] != 0;
        if (dose->has_frame && !dose_frame_from_word(word, &dose->frame))
            return place_fail(&at, ERROR_RANGE, "frame_of_reference", "expected same, unknown or differs");
        if (!components) {
            if (!parse_component(&at, entry, dose))
                return false;
            continue;
        }
        if (!components->child)
            return place_fail(&at, ERROR_FORMAT, "components", "is empty");
        for (const cJSON *component = components->child; component; component = component->next) {
            struct json_place inside = place_at(&at, "components", (int)dose->n_components);
            place_note_keys(&inside, component, known_inside);
            if (!parse_component(&inside, component, dose))
                return false;
        }
    }
    return true;
}

static bool parse_tracks(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "path", "unit", NULL };
    const cJSON *list;
    if (!place_list(top, root, "tracks", PLAN_FILE_MAX_TRACKS, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "tracks", (int)file->n_tracks);
        struct plan_file_tracks *tracks = &file->tracks[file->n_tracks++];
        place_note_keys(&at, entry, known);
        if (!place_path(&at, entry, "path", true, tracks->path) || !get_unit(&at, entry, &tracks->mm))
            return false;
    }
    return true;
}

static bool parse_curves(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id", "name", "path", "per", NULL };
    const cJSON *list;
    if (!place_list(top, root, "curves", PLAN_FILE_MAX_CURVES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "curves", (int)file->n_curves);
        struct plan_file_curve *curve = &file->curves[file->n_curves++];
        place_note_keys(&at, entry, known);
        if (!place_text(&at, entry, "id", curve->id, sizeof curve->id) ||
            !place_text(&at, entry, "name", curve->name, sizeof curve->name) ||
            !place_path(&at, entry, "path", true, curve->path) ||
            !place_text(&at, entry, "per", curve->per, sizeof curve->per))
            return false;
    }
    return true;
}

static bool parse_preferences(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "path", NULL };
    const cJSON *list;
    if (!place_list(top, root, "preferences", PLAN_FILE_MAX_PREFERENCES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct json_place at = place_at(top, "preferences", (int)file->n_preferences);
        place_note_keys(&at, entry, known);
        if (!place_path(&at, entry, "path", true, file->preferences[file->n_preferences++]))
            return false;
    }
    return true;
}

static bool parse_hierarchy(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "hierarchy");
    if (!item || cJSON_IsNull(item))
        return true;
    if (cJSON_IsString(item))
        return place_path(top, root, "hierarchy", true, file->hierarchy);
    if (!cJSON_IsObject(item))
        return place_fail(top, ERROR_FORMAT, "hierarchy", "expected a file name or an object of lists");
    size_t n = 0;
    for (const cJSON *outer = item->child; outer; outer = outer->next) {
        if (!cJSON_IsArray(outer))
            return place_fail(top, ERROR_FORMAT, "hierarchy", "expected lists of names: {\"scalp\": [\"brain\"]}");
        n += (size_t)cJSON_GetArraySize(outer);
    }
    if (n > PLAN_FILE_MAX_PAIRS)
        return place_fail(top, ERROR_LIMIT, "hierarchy", "more than 1024 entries");
    file->pairs = mem_new((n + 1) * sizeof *file->pairs);
    for (const cJSON *outer = item->child; outer; outer = outer->next)
        for (const cJSON *inner = outer->child; inner; inner = inner->next) {
            struct plan_file_pair *pair = &file->pairs[file->n_pairs++];
            if (!cJSON_IsString(inner))
                return place_fail(top, ERROR_FORMAT, "hierarchy", "expected lists of names: {\"scalp\": [\"brain\"]}");
            text_clean(outer->string, pair->outer, sizeof pair->outer);
            text_clean(inner->valuestring, pair->inner, sizeof pair->inner);
        }
    return true;
}

static bool parse_plan(const struct json_place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "format",    "version", "name",  "note",   "phantom", "images",      "regions",
                                         "hierarchy", "doses",   "beams", "tracks", "curves",  "preferences", NULL };
    char format[32];
    if (!place_text(top, root, "format", format, sizeof format))
        return false;
    if (strcmp(format, "beamroom-plan") != 0)
        return place_fail(top, ERROR_FORMAT, "format", "expected \"beamroom-plan\"");
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(root, "version");
    if (!cJSON_IsNumber(version))
        return place_fail(top, ERROR_FORMAT, "version", "expected 1");
    if (version->valuedouble != 1)
        return place_fail(top, ERROR_UNSUPPORTED, "version", "this version of the program reads version 1");
    place_note_keys(top, root, known);
    if (!place_text(top, root, "name", file->name, sizeof file->name) ||
        !place_text(top, root, "note", file->note, sizeof file->note) ||
        !place_bool(top, root, "phantom", &file->is_phantom) || !parse_images(top, root, file) ||
        !parse_regions(top, root, file) || !parse_hierarchy(top, root, file) || !parse_doses(top, root, file) ||
        !plan_json_beams(top, root, file) || !parse_tracks(top, root, file) || !parse_curves(top, root, file) ||
        !parse_preferences(top, root, file))
        return false;
    if (file->n_images + file->n_regions + file->n_doses + file->n_beams + file->n_beam_files == 0)
        return place_fail(top, ERROR_FORMAT, "",
                          "names no image, no region, no dose and no beam; one part is required");
    return true;
}

struct plan_file *plan_file_parse(const uint8_t *data, size_t size, struct report *report, struct error *err)
{
    cJSON *root = place_document(data, size, "plan.json", err);
    if (!root)
        return NULL;
    struct json_place top = { .file = "plan.json", .report = report, .err = err };
    struct plan_file *file = mem_new(sizeof *file);
    bool is_read = parse_plan(&top, root, file);
    cJSON_Delete(root);
    if (!is_read) {
        plan_file_destroy(file);
        return NULL;
    }
    return file;
}

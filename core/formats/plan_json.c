#include "core/formats/plan_json.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"

/* Where we are in the document, for sentences. */
struct place {
    const char *file;
    char path[120];
    struct report *report;
    struct error *err;
};

static struct place place_at(const struct place *up, const char *list, int index)
{
    struct place place = { .file = up->file, .report = up->report, .err = up->err };
    snprintf(place.path, sizeof place.path, "%.60s%s%.30s[%d]", up->path, up->path[0] ? "." : "", list, index);
    return place;
}

static bool fail(const struct place *place, enum error_code code, const char *key, const char *what)
{
    return error_set(place->err, code, "%s: %s%s%s: %s", place->file, place->path, place->path[0] && key[0] ? "." : "", key, what);
}

static cJSON *parse_document(const uint8_t *data, size_t size, const char *file, struct error *err)
{
    const char *stopped = NULL;
    if (size >= 3 && memcmp(data, "\xef\xbb\xbf", 3) == 0) {
        data += 3;
        size -= 3;
    }
    cJSON *root = cJSON_ParseWithLengthOpts((const char *)data, size, &stopped, false);
    if (!root) {
        size_t line = 1;
        for (const char *c = (const char *)data; stopped && c < stopped; c++)
            line += *c == '\n';
        error_set(err, ERROR_FORMAT, "%s: line %zu: not valid JSON", file, line);
        return NULL;
    }
    if (!cJSON_IsObject(root)) {
        error_set(err, ERROR_FORMAT, "%s: expected an object, {...}", file);
        cJSON_Delete(root);
        return NULL;
    }
    return root;
}

/* A text, "" when it is absent. */
static bool get_text(const struct place *place, const cJSON *object, const char *key, char *out, size_t size)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    out[0] = 0;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsString(item))
        return fail(place, ERROR_FORMAT, key, "expected a text");
    text_clean(item->valuestring, out, size);
    return true;
}

/* Cutting a path short would name another file, so a long one is refused. */
static bool get_path(const struct place *place, const cJSON *object, const char *key, bool is_required, char out[FOLDER_NAME_SIZE])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    out[0] = 0;
    if (!item && !is_required)
        return true;
    if (!cJSON_IsString(item))
        return fail(place, ERROR_FORMAT, key, item ? "expected a text" : "is missing");
    char clean[FOLDER_NAME_SIZE];
    text_clean(item->valuestring, clean, sizeof clean);
    if (strlen(item->valuestring) < sizeof clean && strcmp(item->valuestring, clean) != 0)
        return fail(place, ERROR_RANGE, key, "a path must be UTF-8 without control characters");
    if (!folder_check_name(item->valuestring, place->err)) {
        if (place->err)
            error_prefix(place->err, "%s: %s.%s", place->file, place->path, key);
        return false;
    }
    memcpy(out, item->valuestring, strlen(item->valuestring) + 1);
    return true;
}

static bool get_bool(const struct place *place, const cJSON *object, const char *key, bool *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *out = false;
    if (!item)
        return true;
    if (!cJSON_IsBool(item))
        return fail(place, ERROR_FORMAT, key, "expected true or false");
    *out = cJSON_IsTrue(item);
    return true;
}

static bool get_point(const struct place *place, const cJSON *object, const char *key, struct vec3 *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    double v[3] = { 0 };
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != 3)
        return fail(place, ERROR_FORMAT, key, "expected three numbers, millimetres");
    for (int i = 0; i < 3; i++) {
        const cJSON *number = cJSON_GetArrayItem(item, i);
        if (!cJSON_IsNumber(number) || !(fabs(number->valuedouble) <= 1e5))
            return fail(place, ERROR_RANGE, key, "expected three numbers of at most 100000 mm");
        v[i] = number->valuedouble;
    }
    *out = vec3(v[0], v[1], v[2]);
    return true;
}

static bool get_list(const struct place *place, const cJSON *object, const char *key, size_t most, const cJSON **list)
{
    *list = cJSON_GetObjectItemCaseSensitive(object, key);
    if (!*list)
        return true;
    if (!cJSON_IsArray(*list))
        return fail(place, ERROR_FORMAT, key, "expected a list, [...]");
    if ((size_t)cJSON_GetArraySize(*list) > most) {
        char what[64];
        snprintf(what, sizeof what, "%d entries; at most %zu are read", cJSON_GetArraySize(*list), most);
        return fail(place, ERROR_LIMIT, key, what);
    }
    for (const cJSON *entry = (*list)->child; entry; entry = entry->next)
        if (!cJSON_IsObject(entry))
            return fail(place, ERROR_FORMAT, key, "every entry must be an object, {...}");
    return true;
}

static void note_unknown_keys(const struct place *place, const cJSON *object, const char *const *known)
{
    for (const cJSON *item = object->child; item; item = item->next) {
        bool is_known = false;
        for (size_t i = 0; known[i]; i++)
            is_known |= strcmp(item->string, known[i]) == 0;
        char key[64];
        text_clean(item->string, key, sizeof key);
        if (!is_known)
            report_add(place->report, REPORT_NOTE, "plan.unknown-key", place->file, "%s%s%s is not a key that is known; it was ignored.",
                       place->path, place->path[0] ? "." : "", key);
    }
}

/* "#rrggbb" or three numbers. */
static bool get_color(const struct place *place, const cJSON *object, bool *has_color, uint8_t rgb[3])
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "color");
    *has_color = false;
    if (!item || cJSON_IsNull(item))
        return true;
    unsigned value = 0;
    if (cJSON_IsString(item)) {
        const char *text = item->valuestring;
        if (strlen(text) != 7 || text[0] != '#' || strspn(text + 1, "0123456789abcdefABCDEF") != 6)
            return fail(place, ERROR_FORMAT, "color", "expected \"#rrggbb\"");
        value = (unsigned)strtoul(text + 1, NULL, 16);
    } else {
        double v[3], most = 0;
        for (int i = 0; i < 3; i++) {
            const cJSON *number = cJSON_IsArray(item) && cJSON_GetArraySize(item) == 3 ? cJSON_GetArrayItem(item, i) : NULL;
            if (!cJSON_IsNumber(number) || !(number->valuedouble >= 0 && number->valuedouble <= 255))
                return fail(place, ERROR_FORMAT, "color", "expected \"#rrggbb\" or three numbers of 0 to 1 or 0 to 255");
            v[i] = number->valuedouble;
            most = fmax(most, v[i]);
        }
        double scale = most <= 1 ? 255 : 1;
        for (int i = 0; i < 3; i++)
            value = value << 8 | (unsigned)(v[i] * scale + 0.5);
    }
    rgb[0] = (uint8_t)(value >> 16);
    rgb[1] = (uint8_t)(value >> 8);
    rgb[2] = (uint8_t)value;
    *has_color = true;
    return true;
}

/* Of lengths, where a file does not say it, or not rightly; 0 when the plan does not either. */
static bool get_unit(const struct place *place, const cJSON *object, double *mm)
{
    char unit[16];
    if (!get_text(place, object, "unit", unit, sizeof unit))
        return false;
    if (unit[0] && !text_equal(unit, "mm") && !text_equal(unit, "cm"))
        return fail(place, ERROR_RANGE, "unit", "expected mm or cm");
    *mm = text_equal(unit, "mm") ? 1 : text_equal(unit, "cm") ? 10 : 0;
    return true;
}

static bool parse_images(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id", "path", "header", "modality", "name", "unit", NULL };
    const cJSON *list;
    if (!get_list(top, root, "images", PLAN_MAX_IMAGES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "images", (int)file->n_images);
        struct plan_file_image *image = &file->images[file->n_images++];
        note_unknown_keys(&at, entry, known);
        if (!get_text(&at, entry, "id", image->id, sizeof image->id) || !get_path(&at, entry, "path", true, image->path) ||
            !get_path(&at, entry, "header", false, image->header) ||
            !get_text(&at, entry, "modality", image->modality, sizeof image->modality) ||
            !get_text(&at, entry, "name", image->name, sizeof image->name) || !get_unit(&at, entry, &image->mm))
            return false;
    }
    return true;
}

static bool parse_regions(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "path", "names", "name", "color", "unit", NULL };
    const cJSON *list;
    if (!get_list(top, root, "regions", PLAN_FILE_MAX_PARTS, &list))
        return false;
    file->regions = mem_new(((list ? (size_t)cJSON_GetArraySize(list) : 0) + 1) * sizeof *file->regions);
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "regions", (int)file->n_regions);
        struct plan_file_region *region = &file->regions[file->n_regions++];
        note_unknown_keys(&at, entry, known);
        if (!get_path(&at, entry, "path", true, region->path) || !get_path(&at, entry, "names", false, region->names) ||
            !get_text(&at, entry, "name", region->name, sizeof region->name) ||
            !get_color(&at, entry, &region->has_color, region->rgb) || !get_unit(&at, entry, &region->mm))
            return false;
        if (region->name[0] && region->names[0])
            return fail(&at, ERROR_FORMAT, "name", "either \"name\" (a mask) or \"names\" (a label map), not both");
    }
    return true;
}

static bool parse_component(const struct place *at, const cJSON *entry, struct plan_file_dose *dose)
{
    struct plan_file_component *component = &dose->components[dose->n_components];
    char word[32];
    if (!get_path(at, entry, "path", true, component->path) || !get_text(at, entry, "quantity", word, sizeof word) ||
        !get_bool(at, entry, "per_ppm", &component->is_per_ppm))
        return false;
    const cJSON *reference = cJSON_GetObjectItemCaseSensitive(entry, "reference");
    if (reference && !cJSON_IsNull(reference)) {
        if (!cJSON_IsNumber(reference) || !(reference->valuedouble > 0 && reference->valuedouble <= 1e30))
            return fail(at, ERROR_RANGE, "reference", "expected a number above 0, the value that counts as 100 %");
        component->reference = reference->valuedouble;
    }
    component->quantity = DOSE_TOTAL;
    if (word[0] && !dose_quantity_from_word(word, &component->quantity))
        return fail(at, ERROR_RANGE, "quantity", "expected total, boron, nitrogen, fast, gamma, other, fast-fluence, epithermal-fluence, "
                    "thermal-fluence, blood-boron or weighted-total");
    if (component->is_per_ppm && component->quantity != DOSE_BORON && component->quantity != DOSE_BLOOD_BORON)
        return fail(at, ERROR_RANGE, "per_ppm", "only boron is given per ppm");
    for (size_t i = 0; i < dose->n_components; i++)
        if (dose->components[i].quantity == component->quantity)
            return fail(at, ERROR_RANGE, "quantity", "is there twice");
    dose->n_components++;
    return true;
}

static bool parse_doses(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id", "path", "quantity", "per_ppm", "reference", "unit", "per", "mask", "components", NULL };
    static const char *const known_inside[] = { "path", "quantity", "per_ppm", "reference", NULL };
    const cJSON *list, *components;
    if (!get_list(top, root, "doses", PLAN_MAX_DOSES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "doses", (int)file->n_doses);
        struct plan_file_dose *dose = &file->doses[file->n_doses++];
        note_unknown_keys(&at, entry, known);
        if (!get_text(&at, entry, "id", dose->id, sizeof dose->id) || !get_text(&at, entry, "unit", dose->unit, sizeof dose->unit) ||
            !get_text(&at, entry, "per", dose->per, sizeof dose->per) || !get_path(&at, entry, "mask", false, dose->mask) ||
            !get_list(&at, entry, "components", DOSE_N_QUANTITIES, &components))
            return false;
        if (!components) {
            if (!parse_component(&at, entry, dose))
                return false;
            continue;
        }
        if (!components->child)
            return fail(&at, ERROR_FORMAT, "components", "is empty");
        for (const cJSON *component = components->child; component; component = component->next) {
            struct place inside = place_at(&at, "components", (int)dose->n_components);
            note_unknown_keys(&inside, component, known_inside);
            if (!parse_component(&inside, component, dose))
                return false;
        }
    }
    return true;
}

static bool parse_beams(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id", "entry_mm", "target_mm", "aperture_mm", NULL };
    const cJSON *list;
    if (!get_list(top, root, "beams", PLAN_MAX_BEAMS, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "beams", (int)file->n_beams);
        struct beam *beam = &file->beams[file->n_beams++];
        note_unknown_keys(&at, entry, known);
        if (!get_text(&at, entry, "id", beam->id, sizeof beam->id) || !get_point(&at, entry, "entry_mm", &beam->entry_lps_mm) ||
            !get_point(&at, entry, "target_mm", &beam->target_lps_mm))
            return false;
        if (vec3_length(vec3_sub(beam->entry_lps_mm, beam->target_lps_mm)) < 1e-6)
            return fail(&at, ERROR_RANGE, "target_mm", "is the same point as entry_mm");
        const cJSON *aperture = cJSON_GetObjectItemCaseSensitive(entry, "aperture_mm");
        beam->aperture_mm = NAN;
        if (aperture && !cJSON_IsNull(aperture)) {
            if (!cJSON_IsNumber(aperture) || !(aperture->valuedouble > 0 && aperture->valuedouble <= 2000))
                return fail(&at, ERROR_RANGE, "aperture_mm", "expected a diameter above 0 and at most 2000 mm");
            beam->aperture_mm = aperture->valuedouble;
        }
    }
    return true;
}

static bool parse_tracks(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "path", "unit", NULL };
    const cJSON *list;
    if (!get_list(top, root, "tracks", PLAN_FILE_MAX_TRACKS, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "tracks", (int)file->n_tracks);
        struct plan_file_tracks *tracks = &file->tracks[file->n_tracks++];
        note_unknown_keys(&at, entry, known);
        if (!get_path(&at, entry, "path", true, tracks->path) || !get_unit(&at, entry, &tracks->mm))
            return false;
    }
    return true;
}

static bool parse_curves(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "id", "name", "path", "per", NULL };
    const cJSON *list;
    if (!get_list(top, root, "curves", PLAN_MAX_CURVES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "curves", (int)file->n_curves);
        struct plan_file_curve *curve = &file->curves[file->n_curves++];
        note_unknown_keys(&at, entry, known);
        if (!get_text(&at, entry, "id", curve->id, sizeof curve->id) || !get_text(&at, entry, "name", curve->name, sizeof curve->name) ||
            !get_path(&at, entry, "path", true, curve->path) || !get_text(&at, entry, "per", curve->per, sizeof curve->per))
            return false;
    }
    return true;
}

static bool parse_preferences(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "path", NULL };
    const cJSON *list;
    if (!get_list(top, root, "preferences", PLAN_FILE_MAX_PREFERENCES, &list))
        return false;
    for (const cJSON *entry = list ? list->child : NULL; entry; entry = entry->next) {
        struct place at = place_at(top, "preferences", (int)file->n_preferences);
        note_unknown_keys(&at, entry, known);
        if (!get_path(&at, entry, "path", true, file->preferences[file->n_preferences++]))
            return false;
    }
    return true;
}

static bool parse_hierarchy(const struct place *top, const cJSON *root, struct plan_file *file)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "hierarchy");
    if (!item || cJSON_IsNull(item))
        return true;
    if (cJSON_IsString(item))
        return get_path(top, root, "hierarchy", true, file->hierarchy);
    if (!cJSON_IsObject(item))
        return fail(top, ERROR_FORMAT, "hierarchy", "expected a file name or an object of lists");
    size_t n = 0;
    for (const cJSON *outer = item->child; outer; outer = outer->next) {
        if (!cJSON_IsArray(outer))
            return fail(top, ERROR_FORMAT, "hierarchy", "expected lists of names: {\"scalp\": [\"brain\"]}");
        n += (size_t)cJSON_GetArraySize(outer);
    }
    if (n > PLAN_FILE_MAX_PAIRS)
        return fail(top, ERROR_LIMIT, "hierarchy", "more than 1024 entries");
    file->pairs = mem_new((n + 1) * sizeof *file->pairs);
    for (const cJSON *outer = item->child; outer; outer = outer->next)
        for (const cJSON *inner = outer->child; inner; inner = inner->next) {
            struct plan_file_pair *pair = &file->pairs[file->n_pairs++];
            if (!cJSON_IsString(inner))
                return fail(top, ERROR_FORMAT, "hierarchy", "expected lists of names: {\"scalp\": [\"brain\"]}");
            text_clean(outer->string, pair->outer, sizeof pair->outer);
            text_clean(inner->valuestring, pair->inner, sizeof pair->inner);
        }
    return true;
}

static bool parse_plan(const struct place *top, const cJSON *root, struct plan_file *file)
{
    static const char *const known[] = { "format", "version", "name",      "note",  "phantom", "images",
                                         "regions", "hierarchy", "doses", "beams", "tracks", "curves", "preferences", NULL };
    char format[32];
    if (!get_text(top, root, "format", format, sizeof format))
        return false;
    if (strcmp(format, "beamroom-plan") != 0)
        return fail(top, ERROR_FORMAT, "format", "expected \"beamroom-plan\"");
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(root, "version");
    if (!cJSON_IsNumber(version))
        return fail(top, ERROR_FORMAT, "version", "expected 1");
    if (version->valuedouble != 1)
        return fail(top, ERROR_UNSUPPORTED, "version", "this version of the program reads version 1");
    note_unknown_keys(top, root, known);
    if (!get_text(top, root, "name", file->name, sizeof file->name) || !get_text(top, root, "note", file->note, sizeof file->note) ||
        !get_bool(top, root, "phantom", &file->is_phantom) || !parse_images(top, root, file) || !parse_regions(top, root, file) ||
        !parse_hierarchy(top, root, file) || !parse_doses(top, root, file) || !parse_beams(top, root, file) ||
        !parse_tracks(top, root, file) || !parse_curves(top, root, file) || !parse_preferences(top, root, file))
        return false;
    if (file->n_images + file->n_regions + file->n_doses == 0)
        return fail(top, ERROR_FORMAT, "", "names no image, no region and no dose; one part is required");
    return true;
}

struct plan_file *plan_file_parse(const uint8_t *data, size_t size, struct report *report, struct error *err)
{
    cJSON *root = parse_document(data, size, "plan.json", err);
    if (!root)
        return NULL;
    struct place top = { .file = "plan.json", .report = report, .err = err };
    struct plan_file *file = mem_new(sizeof *file);
    bool is_read = parse_plan(&top, root, file);
    cJSON_Delete(root);
    if (!is_read) {
        plan_file_destroy(file);
        return NULL;
    }
    return file;
}

void plan_file_destroy(struct plan_file *file)
{
    if (!file)
        return;
    free(file->regions);
    free(file->pairs);
    free(file);
}

static bool get_weight(const struct place *place, const cJSON *object, const char *key, double *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *out = NAN;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsNumber(item) || !(item->valuedouble >= 0 && item->valuedouble <= 1000))
        return fail(place, ERROR_RANGE, key, "expected a number from 0 to 1000");
    *out = item->valuedouble;
    return true;
}

static bool get_tissue(const struct place *at, const cJSON *entry, struct label_name *label)
{
    struct label_tissue *tissue = &label->tissue;
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, "tissue");
    if (item && !cJSON_IsNull(item) && !cJSON_IsObject(item))
        return fail(at, ERROR_FORMAT, "tissue", "expected an object, {...}");
    label->has_tissue = cJSON_IsObject(item);
    return get_weight(at, item, "boron_ratio", &tissue->boron_ratio) && get_weight(at, item, "cbe_boron", &tissue->cbe_boron) &&
           get_weight(at, item, "rbe_nitrogen", &tissue->rbe_nitrogen) && get_weight(at, item, "rbe_fast", &tissue->rbe_fast) &&
           get_weight(at, item, "rbe_gamma", &tissue->rbe_gamma);
}

/* A whole number from 1 to most; 0 when the key is absent. */
static bool get_whole(const struct place *at, const cJSON *entry, const char *key, int most, int *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(entry, key);
    *out = 0;
    if (!item || cJSON_IsNull(item))
        return true;
    if (!cJSON_IsNumber(item) || item->valuedouble != floor(item->valuedouble) || !(item->valuedouble >= 1 && item->valuedouble <= most)) {
        char what[64];
        snprintf(what, sizeof what, "expected a whole number from 1 to %d", most);
        return fail(at, ERROR_RANGE, key, what);
    }
    *out = (int)item->valuedouble;
    return true;
}

static bool parse_label(const struct place *at, const cJSON *entry, struct label_name *label)
{
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(entry, "value");
    if (!cJSON_IsNumber(value) || value->valuedouble != floor(value->valuedouble) ||
        !(value->valuedouble >= 0 && value->valuedouble <= UINT16_MAX))
        return fail(at, ERROR_RANGE, "value", "expected a whole number from 0 to 65535");
    label->value = (uint16_t)value->valuedouble;
    return get_text(at, entry, "name", label->name, sizeof label->name) &&
           get_text(at, entry, "parent", label->parent, sizeof label->parent) &&
           get_text(at, entry, "id", label->id, sizeof label->id) && get_whole(at, entry, "place", REGION_MAX, &label->place) &&
           get_color(at, entry, &label->has_color, label->rgb) && get_tissue(at, entry, label);
}

bool label_names_parse(const uint8_t *data, size_t size, const char *name, struct label_names *names, struct error *err)
{
    *names = (struct label_names){ 0 };
    cJSON *root = parse_document(data, size, name, err);
    if (!root)
        return false;
    struct place top = { .file = name, .err = err };
    const cJSON *list;
    bool is_read = get_list(&top, root, "labels", PLAN_FILE_MAX_LABELS, &list);
    if (is_read && !list)
        is_read = fail(&top, ERROR_FORMAT, "labels", "is missing");
    if (is_read)
        names->labels = mem_new(((size_t)cJSON_GetArraySize(list) + 1) * sizeof *names->labels);
    for (const cJSON *entry = is_read ? list->child : NULL; is_read && entry; entry = entry->next) {
        struct place at = place_at(&top, "labels", (int)names->n);
        is_read = parse_label(&at, entry, &names->labels[names->n++]);
    }
    cJSON_Delete(root);
    if (!is_read)
        label_names_finish(names);
    return is_read;
}

void label_names_finish(struct label_names *names)
{
    free(names->labels);
    *names = (struct label_names){ 0 };
}

/* Reads a beam file. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/beam/beam.h"
#include "core/formats/plan/beam_file.h"
#include "core/formats/plan/plan_json_place.h"
#include "core/formats/text.h"

/* A number in a range; an absent one gives `otherwise`, or is refused where that is not a number. */
static bool get_number(const struct json_place *place, const cJSON *object, const char *key, double low, double high,
                       double otherwise, double *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    *out = otherwise;
    if (!item && !isnan(otherwise))
        return true;
    if (!item || !cJSON_IsNumber(item) || !(item->valuedouble >= low && item->valuedouble <= high)) {
        char what[80];
        snprintf(what, sizeof what, "expected a number from %g to %g", low, high);
        return place_fail(place, ERROR_RANGE, key, what);
    }
    *out = item->valuedouble;
    return true;
}

static struct json_place inside(const struct json_place *up, const char *key)
{
    struct json_place place = { .file = up->file, .report = up->report, .err = up->err };
    snprintf(place.path, sizeof place.path, "%.60s%s%.40s", up->path, up->path[0] ? "." : "", key);
    return place;
}

/* A list of n numbers in a range; n 0: as many as there are, up to most. */
static bool get_numbers(const struct json_place *place, const cJSON *object, const char *key, double low, double high,
                        size_t n, size_t most, double *out, size_t *n_out)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(object, key);
    size_t there = cJSON_IsArray(list) ? (size_t)cJSON_GetArraySize(list) : 0;
    char what[96];
    snprintf(what, sizeof what, "expected a list of %s%zu numbers from %g to %g", n ? "" : "1 to ", n ? n : most, low,
             high);
    if (there == 0 || there > most || (n > 0 && there != n))
        return place_fail(place, ERROR_FORMAT, key, what);
    size_t i = 0;
    for (const cJSON *item = list->child; item; item = item->next) {
        if (!cJSON_IsNumber(item) || !(item->valuedouble >= low && item->valuedouble <= high))
            return place_fail(place, ERROR_RANGE, key, what);
        out[i++] = item->valuedouble;
    }
    *n_out = there;
    return true;
}

static bool falls(const struct json_place *place, const char *key, const double *values, size_t n)
{
    for (size_t i = 1; i < n; i++)
        if (!(values[i] < values[i - 1]))
            return place_fail(place, ERROR_RANGE, key, "the numbers must fall");
    return true;
}

/* The groups of one kind of particles; cosines are those of all groups. */
static bool get_spectrum(const struct json_place *place, const cJSON *object, const double *cosines, size_t n_cuts,
                         struct beam_spectrum *spectrum)
{
    size_t n_bounds, n_shares;
    if (!get_numbers(place, object, "energy_ev", 1e-6, 1e9, 0, SOURCE_MAX_GROUPS + 1, spectrum->bounds_ev, &n_bounds) ||
        !falls(place, "energy_ev", spectrum->bounds_ev, n_bounds))
        return false;
    if (n_bounds < 2)
        return place_fail(place, ERROR_RANGE, "energy_ev", "expected two energies or more, falling");
    if (!get_numbers(place, object, "share", 0, SOURCE_MAX_PER_CM2, n_bounds - 1, SOURCE_MAX_GROUPS, spectrum->share,
                     &n_shares) ||
        !get_number(place, object, "per_cm2", 1e-30, SOURCE_MAX_PER_CM2, NAN, &spectrum->per_cm2) ||
        !place_bool(place, object, "by_lethargy", &spectrum->is_by_lethargy))
        return false;
    double sum = 0;
    for (size_t i = 0; i < n_shares; i++) {
        sum += spectrum->share[i];
        memcpy(spectrum->cuts[i], cosines, n_cuts * sizeof *cosines);
    }
    spectrum->n_groups = n_shares;
    static const char *const known[] = { "energy_ev", "share", "per_cm2", "by_lethargy", NULL };
    place_note_keys(place, object, known);
    return sum > 0 || place_fail(place, ERROR_RANGE, "share", "the groups' shares are all 0");
}

static bool get_source(const struct json_place *up, const cJSON *object, struct beam_source *source)
{
    struct json_place place = inside(up, "spectrum");
    double radius_mm, distance_mm, cosines[SOURCE_MAX_CUTS] = { 1 };
    source->n_cuts = 1;
    if (!cJSON_IsObject(object))
        return place_fail(&place, ERROR_FORMAT, "", "expected an object, {...}");
    if (!get_number(&place, object, "radius_mm", .01, 10 * SOURCE_MAX_CM, NAN, &radius_mm) ||
        !get_number(&place, object, "distance_mm", .01, 10 * SOURCE_MAX_CM, .01, &distance_mm))
        return false;
    source->radius_cm = radius_mm / 10;
    source->to_aperture_cm = distance_mm / 10;
    if (cJSON_GetObjectItemCaseSensitive(object, "cosines") &&
        (!get_numbers(&place, object, "cosines", 0, 1, 0, SOURCE_MAX_CUTS, cosines, &source->n_cuts) ||
         !falls(&place, "cosines", cosines, source->n_cuts)))
        return false;
    const cJSON *neutrons = cJSON_GetObjectItemCaseSensitive(object, "neutrons"),
                *photons = cJSON_GetObjectItemCaseSensitive(object, "photons");
    struct json_place at_neutrons = inside(&place, "neutrons"), at_photons = inside(&place, "photons");
    static const char *const known[] = { "radius_mm", "distance_mm", "cosines", "neutrons", "photons", NULL };
    place_note_keys(&place, object, known);
    return get_spectrum(&at_neutrons, neutrons, cosines, source->n_cuts, &source->neutrons) &&
           (!photons || get_spectrum(&at_photons, photons, cosines, source->n_cuts, &source->photons));
}

static bool get_delimiter(const struct json_place *up, const cJSON *object, struct beam_delimiter *delimiter)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, "delimiter");
    if (!item || cJSON_IsNull(item))
        return true;
    struct json_place place = inside(up, "delimiter");
    if (!cJSON_IsObject(item))
        return place_fail(&place, ERROR_FORMAT, "", "expected an object, {...}");
    const double most_mm = 10 * SOURCE_MAX_CM;
    struct beam_delimiter mm;
    if (!get_number(&place, item, "length_mm", .1, most_mm, NAN, &mm.length_cm) ||
        !get_number(&place, item, "exit_radius_mm", .1, most_mm, NAN, &mm.exit_radius_cm) ||
        !get_number(&place, item, "entrance_radius_mm", .1, most_mm, mm.exit_radius_cm, &mm.entrance_radius_cm) ||
        !get_number(&place, item, "natural_lithium_from_radius_mm", 0, most_mm, most_mm, &mm.natural_lithium_from_cm))
        return false;
    *delimiter = (struct beam_delimiter){ mm.length_cm / 10, mm.exit_radius_cm / 10, mm.entrance_radius_cm / 10,
                                          mm.natural_lithium_from_cm / 10 };
    static const char *const known[] = { "length_mm", "exit_radius_mm", "entrance_radius_mm",
                                         "natural_lithium_from_radius_mm", NULL };
    place_note_keys(&place, item, known);
    return true;
}

/* Without its distance the disk would lie at the exit of the delimiter, and nothing would pass that. */
static bool check_distance(const struct json_place *up, const cJSON *spectrum, const struct beam_source *source)
{
    struct json_place place = inside(up, "spectrum");
    return source->delimiter.length_cm <= 0 || cJSON_GetObjectItemCaseSensitive(spectrum, "distance_mm") ||
           place_fail(&place, ERROR_RANGE, "distance_mm", "is needed with a delimiter: from the disk to its exit");
}

struct beam_file_particles beam_file_particles_of(const char *path)
{
    struct beam_file_particles particles = { .direction = { 0, 0, 1 }, .across = { 1, 0, 0 } };
    snprintf(particles.path, sizeof particles.path, "%s", path);
    return particles;
}

/* A point or direction that may be absent. */
static bool get_vector(const struct json_place *place, const cJSON *object, const char *key, struct vec3 *out)
{
    return !cJSON_GetObjectItemCaseSensitive(object, key) || place_point(place, object, key, out);
}

static bool get_particles(const struct json_place *up, const cJSON *object, struct beam_file_particles *particles)
{
    struct json_place place = inside(up, "particles");
    if (!cJSON_IsObject(object))
        return place_fail(&place, ERROR_FORMAT, "", "expected an object, {...}");
    static const char *const known[] = { "file",      "neutrons_per_unit", "histories_per_unit",
                                         "histories", "origin_mm",         "direction",
                                         "across",    "across_lps",        NULL };
    place_note_keys(&place, object, known);
    *particles = beam_file_particles_of("");
    particles->has_across_lps = cJSON_GetObjectItemCaseSensitive(object, "across_lps") != NULL;
    if (!place_path(&place, object, "file", true, particles->path) ||
        !get_number(&place, object, "neutrons_per_unit", 1e-30, SOURCE_MAX_PER_CM2, 0, &particles->neutrons_per_unit) ||
        !get_number(&place, object, "histories_per_unit", 1e-30, SOURCE_MAX_PER_CM2, 0,
                    &particles->histories_per_unit) ||
        !get_number(&place, object, "histories", 1, 1e19, 0, &particles->histories) ||
        !get_vector(&place, object, "origin_mm", &particles->origin_mm) ||
        !get_vector(&place, object, "direction", &particles->direction) ||
        !get_vector(&place, object, "across", &particles->across) ||
        !get_vector(&place, object, "across_lps", &particles->across_lps))
        return false;
    return (particles->neutrons_per_unit > 0) != (particles->histories_per_unit > 0) ||
           place_fail(&place, ERROR_FORMAT, "neutrons_per_unit",
                      "expected either \"neutrons_per_unit\" or \"histories_per_unit\": the file does not say how many "
                      "real neutrons it stands for");
}

static bool get_elements(const struct json_place *place, const cJSON *object, struct beam_file_material *material)
{
    const cJSON *weights = cJSON_GetObjectItemCaseSensitive(object, "weights");
    if (!cJSON_IsObject(weights))
        return place_fail(place, ERROR_FORMAT, "weights", "expected \"icru46\", or an object of weight fractions");
    for (const cJSON *item = weights->child; item; item = item->next) {
        if (material->n_elements == BEAM_FILE_MAX_ELEMENTS || !item->string || strlen(item->string) > 3 ||
            !cJSON_IsNumber(item) || !(item->valuedouble >= 0 && item->valuedouble <= 1))
            return place_fail(place, ERROR_RANGE, "weights", "expected at most 16 elements, each from 0 to 1");
        text_clean(item->string, material->elements[material->n_elements].symbol, 4);
        material->elements[material->n_elements++].fraction = item->valuedouble;
    }
    return get_number(place, object, "g_cm3", 1e-4, 20, NAN, &material->g_cm3);
}

static bool get_material(const struct json_place *up, const cJSON *item, struct beam_file_material *material)
{
    char key[128];
    text_clean(item->string ? item->string : "", key, sizeof key);
    struct json_place place = inside(up, key);
    *material = (struct beam_file_material){ 0 };
    memcpy(material->region, key, sizeof key);
    if (!cJSON_IsObject(item))
        return place_fail(&place, ERROR_FORMAT, "", "expected an object, {...}");
    static const char *const known[] = { "icru46", "ppm", "g_cm3", "weights", NULL };
    place_note_keys(&place, item, known);
    return place_text(&place, item, "icru46", material->word, sizeof material->word) &&
           get_number(&place, item, "ppm", 0, 1e6, 0, &material->boron_ppm) &&
           (material->word[0] || get_elements(&place, item, material));
}

static bool get_materials(const struct json_place *up, const cJSON *object, struct beam_file *file)
{
    const cJSON *list = cJSON_GetObjectItemCaseSensitive(object, "materials");
    struct json_place place = inside(up, "materials");
    if (!list || cJSON_IsNull(list))
        return true;
    if (!cJSON_IsObject(list))
        return place_fail(&place, ERROR_FORMAT, "", "expected an object, {...}");
    if (cJSON_GetArraySize(list) > BEAM_FILE_MAX_MATERIALS)
        return place_fail(&place, ERROR_LIMIT, "", "at most 32 regions are read");
    for (const cJSON *item = list->child; item; item = item->next)
        if (!get_material(&place, item, &file->materials[file->n_materials++]))
            return false;
    return true;
}

static bool get_pose(const struct json_place *place, const cJSON *object, struct beam_file *file)
{
    if (!cJSON_GetObjectItemCaseSensitive(object, "entry_mm") && !cJSON_GetObjectItemCaseSensitive(object, "target_mm"))
        return true;
    file->has_pose = true;
    if (!place_point(place, object, "entry_mm", &file->entry_lps_mm) ||
        !place_point(place, object, "target_mm", &file->target_lps_mm))
        return false;
    return vec3_length(vec3_sub(file->target_lps_mm, file->entry_lps_mm)) > BEAM_MIN_LENGTH_MM ||
           place_fail(place, ERROR_RANGE, "target_mm", "is the same point as entry_mm");
}

static bool read(const struct json_place *place, const cJSON *root, struct beam_file *file)
{
    char format[32];
    double version;
    if (!place_text(place, root, "format", format, sizeof format))
        return false;
    if (strcmp(format, "beamroom-beam") != 0)
        return place_fail(place, ERROR_FORMAT, "format", "expected \"beamroom-beam\"");
    if (!get_number(place, root, "version", 0, 1e6, NAN, &version))
        return false;
    if (version != 1)
        return place_fail(place, ERROR_UNSUPPORTED, "version", "this program reads version 1");
    static const char *const known[] = { "format",    "version",   "name",      "note",      "source",
                                         "spectrum",  "per",       "delimiter", "particles", "entry_mm",
                                         "target_mm", "materials", NULL };
    place_note_keys(place, root, known);
    const cJSON *spectrum = cJSON_GetObjectItemCaseSensitive(root, "spectrum"),
                *particles = cJSON_GetObjectItemCaseSensitive(root, "particles");
    if (!!spectrum + !!particles + !!cJSON_GetObjectItemCaseSensitive(root, "source") != 1)
        return place_fail(place, ERROR_FORMAT, "source", "expected one of \"source\", \"spectrum\" and \"particles\"");
    if (particles && cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(root, "delimiter")))
        return place_fail(place, ERROR_FORMAT, "delimiter",
                          "particles of a file are followed from the aperture plane on, with no delimiter before it");
    return place_text(place, root, "name", file->name, sizeof file->name) &&
           place_text(place, root, "per", file->per, sizeof file->per) &&
           (spectrum    ? get_source(place, spectrum, &file->source)
            : particles ? get_particles(place, particles, &file->particles)
                        : place_path(place, root, "source", true, file->source_path)) &&
           get_delimiter(place, root, &file->source.delimiter) &&
           (!spectrum || check_distance(place, spectrum, &file->source)) && get_pose(place, root, file) &&
           get_materials(place, root, file);
}

bool beam_file_parse(const uint8_t *data, size_t size, const char *name, struct beam_file *file, struct report *report,
                     struct error *err)
{
    *file = (struct beam_file){ 0 };
    if (size > BEAM_FILE_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %d expected", name, size, BEAM_FILE_MAX_BYTES);
    cJSON *root = place_document(data, size, name, err);
    if (!root)
        return false;
    struct json_place place = { .file = name, .report = report, .err = err };
    bool is_read = read(&place, root, file);
    if (is_read && !file->source_path[0])
        memcpy(file->source.name, file->name, sizeof file->source.name);
    cJSON_Delete(root);
    return is_read;
}

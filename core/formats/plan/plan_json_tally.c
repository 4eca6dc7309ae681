/* Reads a tally file. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/plan/plan_json_place.h"
#include "core/formats/plan/tally_file.h"

/* A whole number from 1 on; an absent one is 0. */
static bool get_whole(const struct json_place *place, const cJSON *object, const char *key, long most, long *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(object, key);
    char what[64];
    *out = 0;
    if (!item || cJSON_IsNull(item))
        return true;
    snprintf(what, sizeof what, "expected a whole number from 1 to %ld", most);
    if (!cJSON_IsNumber(item) || !(item->valuedouble >= 1 && item->valuedouble <= (double)most) ||
        item->valuedouble != floor(item->valuedouble))
        return place_fail(place, ERROR_RANGE, key, what);
    *out = (long)item->valuedouble;
    return true;
}

static bool get_energy(const struct json_place *place, const cJSON *root, long *energy)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(root, "energy");
    if (cJSON_IsString(item) && strcmp(item->valuestring, "total") == 0) {
        *energy = TALLY_ENERGY_TOTAL;
        return true;
    }
    return get_whole(place, root, "energy", TALLY_MAX_ENERGIES, energy);
}

/* None of these has a default: a wrong guess is a dose that is wrong by a factor or lies on the other side. */
static bool get_placing(const struct json_place *place, const cJSON *root, struct tally_placing *placing)
{
    const cJSON *factor = cJSON_GetObjectItemCaseSensitive(root, "factor");
    char axes[8];
    if (!cJSON_IsNumber(factor) || !(factor->valuedouble >= 1e-30 && factor->valuedouble <= 1e30))
        return place_fail(place, ERROR_RANGE, "factor",
                          "expected a number from 1e-30 to 1e30, which every value is multiplied by");
    placing->factor = factor->valuedouble;
    if (!place_text(place, root, "axes", axes, sizeof axes))
        return false;
    if (strlen(axes) != 3)
        return place_fail(
            place, ERROR_RANGE, "axes",
            "expected the patient's sides to which x, y and z grow: one of L R, of P A and of S I, as \"LPS\"");
    memcpy(placing->axes, axes, 4);
    return place_point(place, root, "origin_mm", &placing->origin_mm);
}

static bool read(const struct json_place *place, const cJSON *root, struct tally_file *file)
{
    char format[32];
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(root, "version");
    if (!place_text(place, root, "format", format, sizeof format))
        return false;
    if (strcmp(format, "beamroom-tally") != 0)
        return place_fail(place, ERROR_FORMAT, "format", "expected \"beamroom-tally\"");
    if (!cJSON_IsNumber(version) || version->valuedouble != 1)
        return place_fail(place, ERROR_UNSUPPORTED, "version", "this program reads version 1");
    static const char *const known[] = { "format", "version", "file",          "errors",    "tally", "energy",
                                         "factor", "axes",    "normalisation", "origin_mm", "note",  NULL };
    if (place->report)
        place_note_keys(place, root, known);
    return place_path(place, root, "file", true, file->path) &&
           place_path(place, root, "errors", false, file->errors) &&
           place_text(place, root, "normalisation", file->normalisation, sizeof file->normalisation) &&
           get_whole(place, root, "tally", 99999999, &file->choice.number) &&
           get_energy(place, root, &file->choice.energy) && get_placing(place, root, &file->placing);
}

bool tally_file_parse(const uint8_t *data, size_t size, const char *name, struct tally_file *file,
                      struct report *report, struct error *err)
{
    *file = (struct tally_file){ 0 };
    if (size > TALLY_FILE_MAX_BYTES)
        return error_set(err, ERROR_LIMIT, "%s: %zu bytes, at most %d expected", name, size, TALLY_FILE_MAX_BYTES);
    cJSON *root = place_document(data, size, name, err);
    if (!root)
        return false;
    struct json_place place = { .file = name, .report = report, .err = err };
    bool is_read = read(&place, root, file);
    cJSON_Delete(root);
    return is_read;
}

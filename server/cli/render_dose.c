/* Turns the options of `beamroom render` about dose into a merge patch on a scene. */
#include "server/cli/render_dose.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/cli/render_words.h"

/* Cuts "NAME=REST" in two; rest NULL: there is no "=". False: the name is empty or too long. */
static bool split(const char *text, char name[RENDER_WORD_SIZE], const char **rest)
{
    size_t n = strcspn(text, "=");
    if (n == 0 || n >= RENDER_WORD_SIZE)
        return false;
    memcpy(name, text, n);
    name[n] = 0;
    *rest = text[n] ? text + n + 1 : NULL;
    return true;
}

static bool is_word(const char *word, const char *a, const char *b)
{
    return strcmp(word, a) == 0 || strcmp(word, b) == 0;
}

static bool add_reference(const char *text, cJSON *dose, struct error *err)
{
    char kind[RENDER_WORD_SIZE], *end;
    const char *rest;
    double value[3];
    cJSON *reference = render_member(dose, "reference");
    if (split(text, kind, &rest)) {
        cJSON_AddStringToObject(reference, "kind", kind);
        if (!rest && !is_word(kind, "value", "point"))
            return true; /* body, file, or of the first target */
        if (rest && is_word(kind, "region-max", "region-mean"))
            return cJSON_AddStringToObject(reference, "region", rest) != NULL;
        if (rest && strcmp(kind, "value") == 0 && render_number(rest, value))
            return cJSON_AddNumberToObject(reference, "value", value[0]) != NULL;
        int n = 0;
        for (const char *at = rest; at && strcmp(kind, "point") == 0 && n < 3; at = *end == ',' ? end + 1 : NULL) {
            value[n++] = strtod(at, &end);
            if (end == at || !isfinite(value[n - 1]) || *end != (n < 3 ? ',' : 0))
                break;
            if (n == 3)
                return cJSON_AddItemToObject(reference, "point_mm", cJSON_CreateDoubleArray(value, 3));
        }
    }
    return error_set(err, ERROR_RANGE,
                     "--reference '%s' is not body, file, value=NUMBER, region-max or region-mean with or without =ID, "
                     "or point=X,Y,Z",
                     text);
}

static bool add_level(const char *text, cJSON *levels, struct error *err)
{
    char number[RENDER_WORD_SIZE], id[RENDER_WORD_SIZE + 8], *unit;
    const char *color;
    if (split(text, number, &color)) {
        double value = strtod(number, &unit);
        bool is_percent = *unit == 0 || strcmp(unit, "%") == 0;
        if (unit != number && isfinite(value) && (is_percent || strncmp(unit, "Gy", 2) == 0)) {
            (void)snprintf(id, sizeof id, "at-%.9g%s", value, is_percent ? "" : "-gy");
            for (char *c = id; *c; c++)
                *c = *c == '.' || *c == '+' ? '-' : *c;
            cJSON *level = render_member(levels, id);
            cJSON_AddNumberToObject(level, "value", value);
            cJSON_AddStringToObject(level, "unit", is_percent ? "percent" : "dose");
            cJSON_AddTrueToObject(level, "visible");
            if (color)
                cJSON_AddStringToObject(level, "color", color);
            return true;
        }
    }
    return error_set(err, ERROR_RANGE, "--level '%s' is not a number, perhaps with %% or Gy and =#rrggbb behind", text);
}

/* The colour of the scene's level of the same percentage, for a level without a colour of its own. */
static void add_color(cJSON *level, const cJSON *known)
{
    const cJSON *one;
    cJSON_ArrayForEach(one, known) if (!render_field(level, "color") &&
                                       strcmp(json_text(one, "unit"), json_text(level, "unit")) == 0 &&
                                       fabs(json_number(one, "value", -1) - json_number(level, "value", -2)) < 1e-9)
        cJSON_AddStringToObject(level, "color", json_text(one, "color"));
}

static bool add_levels(const struct render_dose *options, const cJSON *scene, cJSON *dose, struct error *err)
{
    const cJSON *known = render_field(render_field(scene, "dose"), "levels"), *one;
    cJSON *levels = render_member(dose, "levels");
    for (int i = 0; i < options->n_levels; i++)
        if (!add_level(options->levels[i], levels, err))
            return false;
    for (cJSON *level = levels->child; level; level = level->next)
        add_color(level, known);
    cJSON_ArrayForEach(one, known) if (options->n_levels > 0 && !render_field(levels, one->string))
        cJSON_AddFalseToObject(render_member(levels, one->string), "visible");
    else if (options->isodoses && options->n_levels == 0)
        cJSON_AddTrueToObject(render_member(levels, one->string), "surface");
    for (cJSON *level = levels->child; options->isodoses && level; level = level->next)
        if (!render_field(level, "surface") && cJSON_IsTrue(render_field(level, "visible")))
            cJSON_AddTrueToObject(level, "surface");
    return true;
}

static bool add_wash(const char *text, cJSON *dose, struct error *err)
{
    char style[RENDER_WORD_SIZE];
    const char *rest;
    double opacity = 0;
    if (!split(text, style, &rest) || !is_word(style, "bands", "smooth") || (rest && !render_number(rest, &opacity)))
        return error_set(err, ERROR_RANGE, "--wash '%s' is not bands or smooth, perhaps with =OPACITY", text);
    cJSON *wash = render_member(dose, "wash");
    cJSON_AddTrueToObject(wash, "visible");
    cJSON_AddStringToObject(wash, "style", style);
    if (rest)
        cJSON_AddNumberToObject(wash, "opacity", opacity);
    return true;
}

static void add_texture(const char *texture, const cJSON *scene, cJSON *patch)
{
    const cJSON *region;
    cJSON_ArrayForEach(region, render_field(scene, "regions")) if (cJSON_IsTrue(render_field(region, "visible")))
        cJSON_AddStringToObject(render_member(render_member(patch, "regions"), region->string), "texture", texture);
}

/* The dose alone: a plan whose beams have doses each begins with their sum. */
static void add_dose(const char *id, const cJSON *sum, cJSON *dose)
{
    const cJSON *part;
    cJSON_AddStringToObject(dose, "id", id);
    cJSON_ArrayForEach(part, sum) cJSON_AddNullToObject(render_member(dose, "sum"), part->string);
}

static bool add_plain(const struct render_dose *options, const cJSON *sum, cJSON *dose, struct error *err)
{
    double ppm;
    if (options->dose)
        add_dose(options->dose, sum, dose);
    if (options->quantity)
        cJSON_AddStringToObject(dose, "quantity", options->quantity);
    if (options->tissue)
        cJSON_AddStringToObject(dose, "tissue", options->tissue);
    if (options->ppm) {
        if (!render_number(options->ppm, &ppm))
            return error_set(err, ERROR_RANGE, "--ppm '%s' is not a number", options->ppm);
        cJSON_AddNumberToObject(dose, "blood_ppm", ppm);
    }
    if (options->has_lines)
        cJSON_AddTrueToObject(render_member(dose, "lines"), "visible");
    if (options->isodoses) {
        cJSON_AddTrueToObject(render_member(dose, "surfaces"), "visible");
        cJSON_AddStringToObject(render_member(dose, "surfaces"), "grid", options->isodoses);
    }
    return true;
}

cJSON *render_dose_patch(const struct render_dose *options, const cJSON *scene, const cJSON *sum, struct error *err)
{
    cJSON *patch = cJSON_CreateObject(), *dose = cJSON_CreateObject();
    bool is_good = add_plain(options, sum, dose, err) &&
                   (!options->reference || add_reference(options->reference, dose, err)) &&
                   (!options->wash || add_wash(options->wash, dose, err)) &&
                   (!(options->n_levels > 0 || options->isodoses) || add_levels(options, scene, dose, err));
    if (options->texture)
        add_texture(options->texture, scene, patch);
    if (dose->child)
        cJSON_AddItemToObject(patch, "dose", dose);
    else
        cJSON_Delete(dose);
    if (is_good)
        return patch;
    cJSON_Delete(patch);
    return NULL;
}

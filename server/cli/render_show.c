/* Turns the short options of `beamroom render` into a merge patch on a scene. */
#include "server/cli/render_show.h"

#include <string.h>

#include "server/cli/render_words.h"

/* Cuts "NAME=NUMBER" in two; without "=" has_value is false. False: what follows "=" is no number. */
static bool split_value(char *word, bool *has_value, double *value)
{
    char *equals = strchr(word, '=');
    *has_value = equals != NULL;
    if (!equals)
        return true;
    *equals = 0;
    return render_number(equals + 1, value);
}

static bool is_one_of(const char *word, const char *const *words, size_t n)
{
    for (size_t i = 0; i < n; i++)
        if (strcmp(word, words[i]) == 0)
            return true;
    return false;
}

static bool add_regions(const char *text, const cJSON *scene, cJSON *patch, struct error *err)
{
    cJSON *regions = render_member(patch, "regions");
    const cJSON *known;
    cJSON_ArrayForEach(known, cJSON_GetObjectItemCaseSensitive(scene, "regions"))
        cJSON_AddFalseToObject(render_member(regions, known->string), "visible");
    if (strcmp(text, "none") == 0)
        return true;
    for (const char *at = text; *at || at == text;) {
        char id[RENDER_WORD_SIZE];
        bool has_opacity;
        double opacity = 1;
        if (!render_next_word(&at, ',', id) || !split_value(id, &has_opacity, &opacity))
            return error_set(
                err, ERROR_RANGE,
                "--show '%s' is not none or ids of regions with commas between, each perhaps with =OPACITY", text);
        cJSON *region = render_member(regions, id);
        cJSON_DeleteItemFromObjectCaseSensitive(region, "visible");
        cJSON_DeleteItemFromObjectCaseSensitive(region, "opacity");
        cJSON_AddTrueToObject(region, "visible");
        cJSON_AddNumberToObject(region, "opacity", opacity);
    }
    return true;
}

static bool add_slices(const char *text, cJSON *patch, struct error *err)
{
    static const char *const kinds[] = { "axial", "coronal", "sagittal" };
    cJSON *slices = render_member(render_member(patch, "image"), "slices");
    for (size_t i = 0; i < 3; i++)
        cJSON_AddFalseToObject(render_member(slices, kinds[i]), "visible");
    if (strcmp(text, "none") == 0)
        return true;
    for (const char *at = text; *at || at == text;) {
        char word[RENDER_WORD_SIZE];
        bool has_position;
        double position_mm;
        if (!render_next_word(&at, ',', word) || !split_value(word, &has_position, &position_mm) ||
            !is_one_of(word, kinds, 3))
            return error_set(err, ERROR_RANGE,
                             "--slices '%s' is not none or some of axial, coronal, sagittal with commas between, each "
                             "perhaps with =MM",
                             text);
        cJSON *slice = render_member(slices, word);
        cJSON_ReplaceItemInObjectCaseSensitive(slice, "visible", cJSON_CreateTrue());
        if (has_position)
            cJSON_AddNumberToObject(slice, "position_mm", position_mm);
    }
    return true;
}

static bool add_volume(const char *text, const cJSON *scene, cJSON *patch, struct error *err)
{
    static const char *const methods[] = { "ray", "slices", "mip", "average" };
    char word[RENDER_WORD_SIZE];
    bool has_cull;
    double cull;
    if (!render_next_word(&text, 0, word) || !split_value(word, &has_cull, &cull) || !is_one_of(word, methods, 4))
        return error_set(err, ERROR_RANGE, "--volume is ray, slices, mip or average, perhaps with =VALUE");
    cJSON *image = render_member(patch, "image"), *volume = render_member(image, "volume");
    cJSON_AddTrueToObject(volume, "visible");
    cJSON_AddStringToObject(volume, "method", word);
    if (has_cull)
        cJSON_AddNumberToObject(volume, "cull_below", cull);
    else if (strcmp(word, "slices") == 0) /* opaque wherever it is not culled: as slices, so that air hides nothing */
        cJSON_AddItemToObject(volume, "cull_below",
                              cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(
                                                  cJSON_GetObjectItemCaseSensitive(scene, "image"), "cull_below"),
                                              true));
    return true;
}

/* Where the three slices meet. */
static void read_crosshair(const cJSON *scene, double point[3])
{
    static const char *const kinds[] = { "sagittal", "coronal", "axial" };
    const cJSON *image = cJSON_GetObjectItemCaseSensitive(scene, "image"),
                *slices = cJSON_GetObjectItemCaseSensitive(image, "slices");
    for (int i = 0; i < 3; i++)
        point[i] = json_number(cJSON_GetObjectItemCaseSensitive(slices, kinds[i]), "position_mm", 0);
}

static bool add_plane(const char *text, const cJSON *scene, cJSON *patch, struct error *err)
{
    double normal[3], point[3];
    const char *at = text;
    bool is_good = render_next_point(&at, '@', normal);
    if (is_good && *at)
        is_good = render_next_point(&at, '@', point) && *at == 0;
    else
        read_crosshair(scene, point);
    if (!is_good || (normal[0] == 0 && normal[1] == 0 && normal[2] == 0))
        return error_set(err, ERROR_RANGE,
                         "--plane '%s' is not a direction X,Y,Z in the patient, perhaps with a point @X,Y,Z in mm",
                         text);
    cJSON *plane = render_member(render_member(render_member(patch, "image"), "obliques"), RENDER_SHOW_PLANE);
    cJSON_AddTrueToObject(plane, "visible");
    cJSON_AddItemToObject(plane, "normal", cJSON_CreateDoubleArray(normal, 3));
    cJSON_AddItemToObject(plane, "origin_mm", cJSON_CreateDoubleArray(point, 3));
    return true;
}

static bool add_clip(const char *text, bool is_capped, cJSON *patch, struct error *err)
{
    static const char *const planes[] = { "axial-low",    "axial-high",    "coronal-low", "coronal-high",
                                          "sagittal-low", "sagittal-high", "beam" };
    char word[RENDER_WORD_SIZE];
    bool has_position;
    double position_mm;
    const char *at = text;
    if (!render_next_word(&at, 0, word) || !split_value(word, &has_position, &position_mm) || !has_position ||
        !is_one_of(word, planes, sizeof planes / sizeof planes[0]))
        return error_set(err, ERROR_RANGE,
                         "--clip '%s' is not axial-low=MM, axial-high=MM or the same with coronal or sagittal, or "
                         "beam=MM",
                         text);
    const char *position = strcmp(word, "beam") == 0 ? "along_mm" : "position_mm";
    char *hyphen = strchr(word, '-');
    if (hyphen)
        *hyphen = '_';
    cJSON *plane = render_member(render_member(patch, "clip"), word);
    cJSON_DeleteItemFromObjectCaseSensitive(plane, position); /* named twice: the last one counts */
    cJSON_AddNumberToObject(plane, position, position_mm);
    if (!cJSON_GetObjectItemCaseSensitive(plane, "enabled")) {
        cJSON_AddTrueToObject(plane, "enabled");
        cJSON_AddBoolToObject(plane, "cap", is_capped);
    }
    return true;
}

static bool add_window(const char *text, cJSON *patch, struct error *err)
{
    char words[3][RENDER_WORD_SIZE] = { "", "", "1" };
    double center, width, gamma;
    const char *at = text;
    bool is_good = render_next_word(&at, '/', words[0]) && render_next_word(&at, '/', words[1]) &&
                   (!*at || (render_next_word(&at, '/', words[2]) && !*at));
    if (!is_good || !render_number(words[0], &center) || !render_number(words[1], &width) ||
        !render_number(words[2], &gamma))
        return error_set(err, ERROR_RANGE, "--window '%s' is not of the form 40/400, or 40/400/1.4 with a gamma", text);
    cJSON *window = render_member(render_member(patch, "image"), "window");
    cJSON_AddNumberToObject(window, "center", center);
    cJSON_AddNumberToObject(window, "width", width);
    cJSON_AddNumberToObject(window, "gamma", gamma);
    return true;
}

/* "A,E[,INTENSITY]", before it "patient:" */
static bool add_light(const char *text, cJSON *patch, struct error *err)
{
    static const char of_patient[] = "patient:";
    static const char *const names[] = { "azimuth_deg", "elevation_deg", "intensity" };
    bool is_of_patient = strncmp(text, of_patient, sizeof of_patient - 1) == 0;
    const char *at = text + (is_of_patient ? sizeof of_patient - 1 : 0);
    cJSON *lights = render_member(patch, "lights");
    cJSON_AddStringToObject(lights, "frame", is_of_patient ? "patient" : "viewer");
    bool is_good = true;
    int n = 0;
    for (double number; is_good && *at && n < 3; n++) {
        char word[RENDER_WORD_SIZE];
        is_good = render_next_word(&at, ',', word) && render_number(word, &number);
        if (is_good)
            cJSON_AddNumberToObject(lights, names[n], number);
    }
    return (is_good && n >= 2 && !*at) ||
           error_set(err, ERROR_RANGE,
                     "--light '%s' is not of the form 31,35 or 31,35,1, perhaps with patient: before it", text);
}

static bool add_ambient(const char *text, cJSON *patch, struct error *err)
{
    double ambient;
    if (!render_number(text, &ambient))
        return error_set(err, ERROR_RANGE, "--ambient '%s' is not a number", text);
    cJSON_AddNumberToObject(render_member(patch, "lights"), "ambient", ambient);
    return true;
}

static bool add_background(const char *text, cJSON *patch, struct error *err)
{
    const char *color = strcmp(text, "white") == 0 ? "#ffffff" : strcmp(text, "black") == 0 ? "#000000" : text;
    if (strlen(color) != 7 || color[0] != '#' || strspn(color + 1, "0123456789abcdefABCDEF") != 6)
        return error_set(err, ERROR_RANGE, "--background '%s' is not white, black, or of the form #rrggbb", text);
    char lower[8] = "";
    for (size_t i = 0; color[i]; i++)
        lower[i] = (char)(color[i] >= 'A' && color[i] <= 'F' ? color[i] - 'A' + 'a' : color[i]);
    cJSON_AddStringToObject(render_member(patch, "space"), "background", lower);
    return true;
}

cJSON *render_show_patch(const struct render_show *show, const cJSON *scene, struct error *err)
{
    cJSON *patch = cJSON_CreateObject();
    bool is_good = (!show->regions || add_regions(show->regions, scene, patch, err)) &&
                   (!show->slices || add_slices(show->slices, patch, err)) &&
                   (!show->volume || add_volume(show->volume, scene, patch, err)) &&
                   (!show->window || add_window(show->window, patch, err)) &&
                   (!show->light || add_light(show->light, patch, err)) &&
                   (!show->ambient || add_ambient(show->ambient, patch, err)) &&
                   (!show->background || add_background(show->background, patch, err)) &&
                   (!show->plane || add_plane(show->plane, scene, patch, err));
    for (int i = 0; is_good && i < show->n_clips; i++)
        is_good = add_clip(show->clips[i], !show->is_uncapped, patch, err);
    if (is_good && show->colors)
        cJSON_AddStringToObject(render_member(patch, "image"), "color_map", show->colors);
    if (is_good)
        return patch;
    cJSON_Delete(patch);
    return NULL;
}

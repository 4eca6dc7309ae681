/* Writes the words of a caption for numbers, planes and images. */
#include "core/annotate/words.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

static const char minus[] = "\u2212";

void words_number(char text[40], double value, int digits)
{
    char plain[36];
    double size = fabs(value), scale = pow(10, digits), product = size * scale;
    bool is_between = fma(size, scale, -product) == 0 && product - floor(product) == 0.5;
    (void)snprintf(plain, sizeof plain, "%.*f", digits, is_between ? (floor(product) + 1) / scale : size);
    bool is_zero = strspn(plain, "0.") == strlen(plain);
    (void)snprintf(text, 40, "%s%s", value < 0 && !is_zero ? minus : "", plain);
}

void words_significant(char text[40], double value)
{
    char rounded[32];
    (void)snprintf(rounded, sizeof rounded, "%.2e", fabs(value)); /* rounds first: 9.996 has the size of 10 */
    const char *e = strchr(rounded, 'e');
    int size = e ? (int)strtol(e + 1, NULL, 10) : 0;
    if (!(fabs(value) > 0))
        (void)snprintf(text, 40, "0");
    else if (e && (size < -4 || size > 6))
        (void)snprintf(text, 40, "%s%s", value < 0 ? minus : "", rounded);
    else
        words_number(text, value, size < 2 ? 2 - size : 0);
}

const char *words_day(int64_t ms, char text[WORDS_DAY_SIZE])
{
    static const char *const months[] = { "Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                          "Jul", "Aug", "Sep", "Oct", "Nov", "Dec" };
    const time_t seconds = (time_t)(ms / 1000);
    struct tm utc;
    text[0] = 0;
    if (ms >= 0 && gmtime_r(&seconds, &utc) && utc.tm_year < 8100)
        (void)snprintf(text, WORDS_DAY_SIZE, "%d %s %d UTC", utc.tm_mday, months[utc.tm_mon], utc.tm_year + 1900);
    return text;
}

/* ---- planes ----------------------------------------------------------------------------------------------------- */

/* "L 1.0  P 2.0  S 3.0" */
static void write_vector(char text[120], struct vec3 v, int digits)
{
    char x[40], y[40], z[40];
    words_number(x, v.x, digits);
    words_number(y, v.y, digits);
    words_number(z, v.z, digits);
    (void)snprintf(text, 120, "L %.36s  P %.36s  S %.36s", x, y, z);
}

static const struct scene_oblique_entry *find_oblique(const struct scene *scene, const struct plane *plane)
{
    for (size_t i = 0; i < scene->image.n_obliques; i++) {
        const struct scene_oblique *oblique = &scene->image.obliques[i].value;
        struct plane of_it = plane_of_normal(oblique->origin_mm, oblique->normal);
        if (plane_equal(&of_it, plane))
            return &scene->image.obliques[i];
    }
    return NULL;
}

/* The patient axis that the plane is square to; -1: none. */
static int square_axis(const struct plane *plane)
{
    const double cosines[3] = { plane->normal.x, plane->normal.y, plane->normal.z };
    for (int axis = 0; axis < 3; axis++)
        if (cosines[axis] > 1 - 1e-12)
            return axis;
    return -1;
}

void words_plane(char text[WORDS_SIZE], const struct scene *scene, const struct plane *plane)
{
    const struct scene_oblique_entry *oblique = find_oblique(scene, plane);
    int axis = square_axis(plane);
    char words[120];
    if (axis >= 0) {
        words_number(words, plane_position_mm(plane), 1);
        (void)snprintf(text, WORDS_SIZE, "%c %s mm", "LPS"[axis], words);
        return;
    }
    write_vector(words, oblique ? oblique->value.origin_mm : plane->origin_lps_mm, 1);
    (void)snprintf(text, WORDS_SIZE, "through %s mm", words);
}

void words_normal(char text[WORDS_SIZE], const struct plane *plane)
{
    char words[120];
    write_vector(words, plane->normal, 2);
    (void)snprintf(text, WORDS_SIZE, "%s%s", square_axis(plane) < 0 ? "normal " : "",
                   square_axis(plane) < 0 ? words : "");
}

const char *words_plane_name(const struct scene *scene, const struct plane *plane)
{
    const struct scene_oblique_entry *oblique = find_oblique(scene, plane);
    return !oblique ? "" : oblique->value.name[0] ? oblique->value.name : oblique->id;
}

/* ---- images ----------------------------------------------------------------------------------------------------- */

void words_image(char text[WORDS_SIZE], const struct plan *plan, size_t index)
{
    const struct plan_image *image = &plan->images[index];
    bool is_only = plan->n_images == 1 && image->modality[0];
    const char *name = image->name[0] ? image->name : is_only ? image->modality : image->id;
    bool has_modality = image->modality[0] && !strstr(name, image->modality) && strcasecmp(name, image->modality) != 0;
    (void)snprintf(text, WORDS_SIZE, "%s%s%s", name, has_modality ? ", " : "", has_modality ? image->modality : "");
}

/* Digits that tell the greys of a narrow window apart; the page has the same rule. */
static int window_digits(double width)
{
    const int most = 20;
    if (width >= 10)
        return 0;
    int digits = width > 0 ? 2 - (int)floor(log10(width)) : most;
    return digits < most ? digits : most;
}

const char *words_unit(const char *unit, char quoted[WORDS_UNIT_SIZE])
{
    /* DICOM PS3.3 C.8.9.1 (Units), C.11.1.1.2 (Rescale Type). parts/format.js has the same table;
     * tests/data/unit_words.json holds both. */
    static const struct {
        const char *code, *words;
    } units[] = { { "CNTS", "counts" },
                  { "CPS", "counts/s" },
                  { "PROPCNTS", "relative counts" },
                  { "PROPCPS", "relative counts/s" },
                  { "NONE", "" },
                  { "CM2", "cm\u00b2" },
                  { "CM2ML", "cm\u00b2/mL (SUV)" },
                  { "PCNT", "%" },
                  { "PCT", "%" },
                  { "BQML", "Bq/mL" },
                  { "GML", "g/mL (SUV)" },
                  { "MGML", "mg/mL" },
                  { "MGMINML", "mg/min/mL" },
                  { "UMOLML", "\u00b5mol/mL" },
                  { "UMOLMINML", "\u00b5mol/min/mL" },
                  { "MLG", "mL/g" },
                  { "MLML", "mL/mL" },
                  { "MLMING", "mL/min/g" },
                  { "MLMINML", "mL/min/mL" },
                  { "1CM", "1/cm" },
                  { "STDDEV", "standard deviations" },
                  { "HU_MOD", "HU (modified)" },
                  { "SUV", "SUV" } };
    for (size_t i = 0; i < sizeof units / sizeof *units; i++)
        if (strcmp(unit, units[i].code) == 0)
            return units[i].words;
    size_t n = strlen(unit);
    if (n < 3 || n != strspn(unit, "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_"))
        return unit;
    (void)snprintf(quoted, WORDS_UNIT_SIZE, "\u201c%.*s\u201d", WORDS_UNIT_SIZE - 8, unit);
    return quoted;
}

void words_window(char text[WORDS_SIZE], const struct scene_window *window, const char *unit)
{
    char width[40], center[40], gamma[24] = "", quoted[WORDS_UNIT_SIZE];
    const char *words = words_unit(unit, quoted);
    int digits = window_digits(window->width);
    words_number(center, window->center, digits);
    words_number(width, window->width, digits);
    if (window->gamma != 1)
        (void)snprintf(gamma, sizeof gamma, "  gamma %.3g", window->gamma);
    (void)snprintf(text, WORDS_SIZE, "C %s  W %s%s%s%s", center, width, *words ? " " : "", words, gamma);
}

const char *words_color_map(enum scene_color_map map)
{
    static const char *const words[] = { [SCENE_COLOR_MAP_GREY] = "",
                                         [SCENE_COLOR_MAP_HOT_IRON] = "in hot iron",
                                         [SCENE_COLOR_MAP_RAINBOW] = "in rainbow colours",
                                         [SCENE_COLOR_MAP_VIRIDIS] = "in viridis",
                                         [SCENE_COLOR_MAP_MAGMA] = "in magma",
                                         [SCENE_COLOR_MAP_INFERNO] = "in inferno",
                                         [SCENE_COLOR_MAP_PLASMA] = "in plasma",
                                         [SCENE_COLOR_MAP_CIVIDIS] = "in cividis",
                                         [SCENE_COLOR_MAP_TURBO] = "in turbo" };
    return words[map];
}

void words_blend(char text[WORDS_SIZE], const struct snapshot *snapshot)
{
    size_t index = (size_t)snapshot->blend;
    struct scene_image_look look = snapshot_look_of(snapshot, index);
    const char *colors = words_color_map(look.color_map);
    char name[WORDS_SIZE], window[WORDS_SIZE], percent[40];
    words_image(name, snapshot->plan, index);
    words_window(window, &look.window, snapshot->plan->images[index].unit);
    words_number(percent, 100 * snapshot->scene.image.blend.opacity, 0);
    (void)snprintf(text, WORDS_SIZE, "%.20s %% %.100s over it: %.90s%s%s", percent, name, window, *colors ? ", " : "",
                   colors);
}

/* Writes tracks, reference curves and preferences of a plan in SERA's formats; tracks with energies as a table. */
#include "core/load/write_sera_texts.h"

#include <limits.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/file_write.h"

/* A text in memory that becomes a file when it is closed; lack of memory is reported then. */
struct text_file {
    FILE *out;
    char *text;
    size_t n_bytes;
    bool is_cut; /* no memory for something that was printed: such a stream does not remember it itself */
};

static void print(struct text_file *text_file, const char *format, ...) PRINTF_LIKE(2, 3);
static void print(struct text_file *text_file, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    text_file->is_cut = vfprintf(text_file->out, format, args) < 0 || text_file->is_cut;
    va_end(args);
}

static bool text_file_close(struct text_file *text_file, const char *folder, const char *name, struct error *err)
{
    char path[PATH_MAX];
    bool is_whole = text_file->out && !text_file->is_cut;
    is_whole = text_file->out && fclose(text_file->out) == 0 && text_file->text && is_whole;
    int n = snprintf(path, sizeof path, "%s/%s", folder, name);
    bool is_written = is_whole && n > 0 && n < (int)sizeof path
                          ? file_write(path, text_file->text, text_file->n_bytes, err)
                          : error_set(err, ERROR_MEMORY, "%s: no memory for its text", name);
    free(text_file->text);
    return is_written;
}

/* SERA's columns, in its axes (RL, PA, IS) = (L, -P, S). */
static void print_pp(struct text_file *text_file, const struct track_set *tracks)
{
    static const int codes[TRACK_N_CLASSES][2] = {
        [TRACK_NEUTRON_HIGH] = { 0, 1 }, [TRACK_NEUTRON_MEDIUM] = { 0, 2 }, [TRACK_NEUTRON_LOW] = { 0, 3 },
        [TRACK_GAMMA_HIGH] = { 1, 1 },   [TRACK_GAMMA_MEDIUM] = { 1, 2 },   [TRACK_GAMMA_LOW] = { 1, 3 },
        [TRACK_LOST] = { 3, 0 },         [TRACK_BEAM_LINE] = { 2, 0 }
    };
    for (size_t i = 0; text_file->out && i < tracks->n_segments; i++) {
        const struct track_segment *segment = &tracks->segments[i];
        const float *a = segment->from_lps_mm, *b = segment->to_lps_mm;
        print(text_file, "%.9g %.9g %.9g %.9g %.9g %.9g %d %d\n", (double)a[0], -(double)a[1], (double)a[2],
              (double)b[0], -(double)b[1], (double)b[2], codes[segment->class][0], codes[segment->class][1]);
    }
}

/* The table of core/formats/track_csv.h. */
static void print_table(struct text_file *text_file, const struct track_set *tracks)
{
    if (text_file->out)
        print(text_file, "x0_mm,y0_mm,z0_mm,x1_mm,y1_mm,z1_mm,class,energy_mev\n");
    for (size_t i = 0; text_file->out && i < tracks->n_segments; i++) {
        const struct track_segment *segment = &tracks->segments[i];
        const float *a = segment->from_lps_mm, *b = segment->to_lps_mm;
        print(text_file, "%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%s,", (double)a[0], (double)a[1], (double)a[2], (double)b[0],
              (double)b[1], (double)b[2], track_class_word((enum track_class)segment->class));
        if (isnan(segment->energy_mev))
            print(text_file, "\n");
        else
            print(text_file, "%.9g\n", (double)segment->energy_mev);
    }
}

/* Writes SERA's file, or a table when there are energies, which SERA's does not hold. Nine digits keep every float
 * exactly. */
static bool write_tracks(const struct track_set *tracks, const char *folder, struct plan_file *file, struct error *err)
{
    if (tracks->n_segments == 0)
        return true;
    bool has_energies = false;
    for (size_t i = 0; i < tracks->n_segments; i++)
        has_energies = has_energies || !isnan(tracks->segments[i].energy_mev);
    struct plan_file_tracks *entry = &file->tracks[0];
    snprintf(entry->path, sizeof entry->path, has_energies ? "tracks.csv" : "tracks.pp");
    entry->mm = 1;
    file->n_tracks = 1;
    struct text_file text_file = { 0 };
    text_file.out = open_memstream(&text_file.text, &text_file.n_bytes);
    (has_energies ? print_table : print_pp)(&text_file, tracks);
    return text_file_close(&text_file, folder, entry->path, err);
}

/* The centimetres that give exactly these millimetres when multiplied by ten: mm / 10 or a double next to it. */
static double cm_of(double mm)
{
    double cm = mm / 10;
    for (int step = -2; step <= 2; step++) {
        double near = mm / 10;
        for (int i = 0; i < abs(step); i++)
            near = nextafter(near, step < 0 ? -INFINITY : INFINITY);
        if (near * 10 == mm)
            cm = near;
    }
    return cm;
}

/* Prints not-a-number as SERA's Fortran prints a value too wide for its column, and a point without any value as zeros,
 * which means outside the mesh. All values have the same width, so that no line is as long as one in SERA's own column
 * layout, which readers recognise by length. */
static void print_point(struct text_file *text_file, const struct dose_curve *curve, size_t point)
{
    bool is_nothing = true;
    for (size_t c = 0; c < curve->n_columns; c++)
        is_nothing = is_nothing && isnan(curve->values[c][point]);
    print(text_file, "%.17g %.17g 0 0", cm_of(curve->depths_mm[point / curve->n_radii]),
          cm_of(curve->radii_mm[point % curve->n_radii]));
    for (size_t c = 0; c < curve->n_columns; c++)
        if (is_nothing)
            print(text_file, " 0.00000000E+00");
        else if (isnan(curve->values[c][point]))
            print(text_file, " **************");
        else
            print(text_file, " %.8E", (double)curve->values[c][point]);
    print(text_file, "\n");
}

static bool write_curve(const struct dose_curve *curve, const char *folder, struct plan_file_curve *entry,
                        struct error *err)
{
    memcpy(entry->id, curve->id, sizeof entry->id);
    memcpy(entry->name, curve->name, sizeof entry->name);
    memcpy(entry->per, curve->per, sizeof entry->per);
    snprintf(entry->path, sizeof entry->path, "curves/%s.dose", curve->id);
    struct text_file text_file = { 0 };
    text_file.out = open_memstream(&text_file.text, &text_file.n_bytes);
    struct vec3 center = curve->center_lps_mm; /* the file's order is (PA, RL, IS), in cm */
    if (text_file.out)
        print(&text_file, "Center Point %.17g %.17g %.17g\nno. d,r points used %zu\n", -cm_of(center.y),
              cm_of(center.x), cm_of(center.z), curve->n_depths);
    for (size_t point = 0; text_file.out && point < curve->n_depths * curve->n_radii; point++)
        print_point(&text_file, curve, point);
    return text_file_close(&text_file, folder, entry->path, err);
}

static bool write_preferences(const struct plan_preferences *preferences, const char *folder, struct plan_file *file,
                              struct error *err)
{
    enum { TO_16_BITS = 257 };
    bool is_written = true;
    if (preferences->n_levels > 0) {
        struct text_file text_file = { 0 };
        text_file.out = open_memstream(&text_file.text, &text_file.n_bytes);
        for (size_t i = 0; text_file.out && i < preferences->n_levels; i++) {
            const struct plan_level *level = &preferences->levels[i];
            print(&text_file, "contour_level: %.17g %d %d %d\n", level->percent, level->rgb[0] * TO_16_BITS,
                  level->rgb[1] * TO_16_BITS, level->rgb[2] * TO_16_BITS);
        }
        char *name = file->preferences[file->n_preferences++];
        snprintf(name, FOLDER_NAME_SIZE, "preferences.rsc");
        is_written = text_file_close(&text_file, folder, name, err);
    }
    if (preferences->n_colors > 0 && is_written) {
        struct text_file text_file = { 0 };
        text_file.out = open_memstream(&text_file.text, &text_file.n_bytes);
        for (size_t i = 0; text_file.out && i < preferences->n_colors; i++)
            print(&text_file, "%d %d %d\n", preferences->colors[i][0], preferences->colors[i][1],
                  preferences->colors[i][2]);
        char *name = file->preferences[file->n_preferences++];
        snprintf(name, FOLDER_NAME_SIZE, "colors.cmap");
        is_written = text_file_close(&text_file, folder, name, err);
    }
    return is_written;
}

bool plan_write_texts(const struct plan *plan, const char *folder, struct plan_file *file, struct error *err)
{
    bool is_written = write_tracks(&plan->tracks, folder, file, err);
    for (size_t i = 0; is_written && i < plan->n_curves; i++)
        is_written = write_curve(&plan->curves[i], folder, &file->curves[file->n_curves++], err);
    return is_written && write_preferences(&plan->preferences, folder, file, err);
}

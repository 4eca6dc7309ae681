/* Reads fields of Monte Carlo codes: a tally file, and the code's file that it names. */
#include <stdio.h>
#include <string.h>

#include "core/formats/plan/tally_file.h"
#include "core/formats/tally/meshtal.h"
#include "core/formats/tally/phits_tally.h"
#include "core/load/loading.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"

enum { HEAD_BYTES = 1 << 16 };

static bool read_description(const struct folder *folder, const char *name, struct tally_file *file,
                             struct report *report, struct error *err)
{
    struct bytes bytes;
    if (!folder_read(folder, name, TALLY_FILE_MAX_BYTES, UINT64_MAX, &bytes, err))
        return false;
    bool is_read = tally_file_parse(bytes.data, bytes.size, name, file, report, err);
    bytes_free(&bytes);
    return is_read;
}

/* The path of a file that a tally file names, from the plan's folder. */
static bool beside(const char *name, const char *other, char path[FOLDER_NAME_SIZE], struct error *err)
{
    int up = (int)(part_base_name(name) - name), n = snprintf(path, FOLDER_NAME_SIZE, "%.*s%s", up, name, other);
    return (n > 0 && n < FOLDER_NAME_SIZE) || error_set(err, ERROR_RANGE, "%s: the path of its file is too long", name);
}

static bool read_file(const struct folder *folder, const char *path, struct bytes *bytes, struct error *err)
{
    if (folder_look(folder, path, NULL) == FOLDER_ABSENT)
        return error_set(err, ERROR_NOT_FOUND, "%s: the tally file names it, and it is not there", path);
    return folder_read(folder, path, TALLY_MAX_BYTES, UINT64_MAX, bytes, err);
}

static bool read_code(const struct bytes *bytes, const char *path, const struct tally_choice *choice,
                      struct tally *tally, struct error *err)
{
    if (meshtal_is(bytes->data, bytes->size))
        return meshtal_read(bytes->data, bytes->size, path, choice, tally, err);
    if (phits_tally_is(bytes->data, bytes->size))
        return phits_tally_read(bytes->data, bytes->size, path, choice, tally, err);
    return error_set(err, ERROR_UNSUPPORTED, "%s: neither a mesh tally of MCNP nor [T-Deposit] or [T-Track] of PHITS",
                     path);
}

static bool read_errors(const struct folder *folder, const char *name, const struct tally_file *file,
                        struct tally *tally, struct error *err)
{
    char path[FOLDER_NAME_SIZE];
    struct bytes bytes;
    if (!file->errors[0])
        return true;
    if (!beside(name, file->errors, path, err) || !read_file(folder, path, &bytes, err))
        return false;
    bool is_read = phits_tally_is(bytes.data, bytes.size)
                       ? phits_tally_read_errors(bytes.data, bytes.size, path, &file->choice, tally, err)
                       : error_set(err, ERROR_UNSUPPORTED, "%s: not the errors of a tally of PHITS", path);
    bytes_free(&bytes);
    return is_read;
}

static bool read_tally(const struct folder *folder, const char *name, struct tally_file *file, struct tally *tally,
                       struct report *report, struct error *err)
{
    char path[FOLDER_NAME_SIZE];
    struct bytes bytes;
    *tally = (struct tally){ 0 };
    if (!read_description(folder, name, file, report, err) || !beside(name, file->path, path, err) ||
        !read_file(folder, path, &bytes, err))
        return false;
    bool is_read = read_code(&bytes, path, &file->choice, tally, err);
    bytes_free(&bytes);
    if (is_read && !read_errors(folder, name, file, tally, err)) {
        tally_finish(tally);
        is_read = false;
    }
    return is_read;
}

/* ---- what the report says of it ------------------------------------------------------------------------------------- */

/* Sum over boxes of value times volume, and the box with the largest value. */
static void report_field(const struct tally *tally, const struct tally_file *file, const struct volume *volume,
                         const char *name, struct report *report)
{
    const struct grid *grid = &volume->grid;
    const float *values = volume->voxels;
    size_t n = grid_n_voxels(grid), most = 0;
    double sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum += (double)values[i];
        most = values[i] > values[most] ? i : most;
    }
    struct vec3 at = affine_point(&grid->lps_mm_from_ijk,
                                  vec3((double)(most % grid->size[0]), (double)(most / grid->size[0] % grid->size[1]),
                                       (double)(most / grid->size[0] / grid->size[1])));
    struct vec3 spacing = grid_spacing_mm(grid), origin = file->placing.origin_mm;
    const char *axes = file->placing.axes;
    char sides[16], place[96], box[96];
    snprintf(sides, sizeof sides, "%c, %c, %c", axes[0], axes[1], axes[2]);
    snprintf(place, sizeof place, "%g, %g, %g", origin.x, origin.y, origin.z);
    report_add(report, REPORT_NOTE, "dose.tally", name,
               "%s: x, y, z were taken as cm towards %s, with 0 at %s mm, and each value multiplied by %g (%s).",
               tally->words, sides, place, file->placing.factor,
               file->normalisation[0] ? file->normalisation : "nothing says of what");
    snprintf(place, sizeof place, "%.1f, %.1f, %.1f", at.x, at.y, at.z);
    snprintf(box, sizeof box, "%.4g x %.4g x %.4g", spacing.x, spacing.y, spacing.z);
    report_add(
        report, REPORT_NOTE, "dose.tally", name,
        "Largest value %g at %s mm; times volume the values add up to %g (in the unit times cm3), in boxes of %s mm; %s.",
        volume->high, place, sum * grid_voxel_mm3(grid) / 1000, box, tally->errors ? "with errors" : "without errors");
}

static struct volume *read_field(const struct folder *folder, const char *name, bool is_error, struct report *report,
                                 struct error *err)
{
    struct tally_file file;
    struct tally tally;
    if (!read_tally(folder, name, &file, &tally, is_error ? NULL : report, err))
        return NULL;
    struct volume *volume = tally_volume(&tally, &file.placing, is_error, name, err);
    if (volume && !is_error)
        report_field(&tally, &file, volume, name, report);
    tally_finish(&tally);
    return volume;
}

static struct volume *read_grid(const struct folder *folder, const char *name, enum raw_use use, struct report *report,
                                struct error *err)
{
    (void)use;
    return read_field(folder, name, false, report, err);
}

static struct volume *read_error(const struct folder *folder, const char *name, struct error *err)
{
    return read_field(folder, name, true, NULL, err);
}

/* Looks at the first bytes: planes of PHITS hold their errors in a second file. */
static bool has_error(const struct folder *folder, const char *name)
{
    struct tally_file file;
    struct bytes head;
    char path[FOLDER_NAME_SIZE];
    if (!read_description(folder, name, &file, NULL, NULL) || !beside(name, file.path, path, NULL) ||
        !folder_read(folder, path, UINT64_MAX, HEAD_BYTES, &head, NULL))
        return false;
    bool is_there = file.errors[0] || meshtal_is(head.data, head.size) || phits_tally_has_errors(head.data, head.size);
    bytes_free(&head);
    return is_there;
}

static bool peek(const struct folder *folder, const char *name, struct grid_facts *facts, struct error *err)
{
    struct tally_file file;
    struct tally tally;
    *facts = (struct grid_facts){ .n_layers = 1 };
    if (!read_tally(folder, name, &file, &tally, NULL, err))
        return false;
    bool is_good = tally_grid(&tally, &file.placing, name, &facts->grid, err);
    tally_finish(&tally);
    return is_good;
}

/* ---- the format's reader -------------------------------------------------------------------------------------------- */

static bool find_file(const struct folder *folder, const char *name, char path[FOLDER_NAME_SIZE])
{
    struct tally_file file;
    path[0] = '\0';
    return read_description(folder, name, &file, NULL, NULL) && beside(name, file.path, path, NULL);
}

/* A box takes 8 bytes of text or more: its value, its error, blanks. */
static struct part_need estimate(const struct loading *loading, const struct part_reading *reading, enum raw_use use)
{
    char path[FOLDER_NAME_SIZE];
    uint64_t bytes = 0;
    (void)use;
    if (find_file(&loading->folder, reading->path, path))
        folder_look(&loading->folder, path, &bytes);
    return (struct part_need){ bytes / 2 + reading->bytes, 2 * bytes + (1 << 20) };
}

static bool summarise(const struct folder *folder, const char *name, struct part_summary *summary, struct error *err)
{
    struct tally_file file;
    if (!read_description(folder, name, &file, NULL, err) || !beside(name, file.path, summary->data, err))
        return false;
    return folder_look(folder, summary->data, NULL) == FOLDER_FILE ||
           error_set(err, ERROR_NOT_FOUND, "%s: the tally file names it, and it is not there", summary->data);
}

static void find_companion(const struct folder *folder, const char *name, char other[FOLDER_NAME_SIZE])
{
    if (!find_file(folder, name, other))
        other[0] = '\0';
}

static const char *const names[] = { ".tally.json", NULL };
static const struct grid_reader grids = {
    .peek = peek, .read = read_grid, .has_error = has_error, .read_error = read_error
};
const struct part_reader part_tally = { .word = "a tally of a Monte Carlo code",
                                        .names = names,
                                        .reads = PART_READS_DOSES,
                                        .grid = &grids,
                                        .estimate = estimate,
                                        .summarise = summarise,
                                        .find_companion = find_companion };

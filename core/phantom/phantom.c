/* Writes the phantom's folder: fills volumes, compresses them side by side, then renames the finished folder into
 * place. */
#include "core/phantom/phantom.h"

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/file_write.h"
#include "core/base/parallel.h"
#include "core/formats/nifti_write.h"
#include "core/phantom/depth_dose.h"
#include "core/phantom/head.h"
#include "core/phantom/plan_text.h"
#include "core/phantom/tracks.h"

const struct phantom_options phantom_defaults = { { 256, 256, 128 }, 1 };

/* All files of a phantom's folder; a folder with any other file is not ours to replace. */
static const char *const files[] = { "plan.json",         "README.txt",           "labels.json",
                                     "ct.nii.gz",         "labels.nii.gz",        "tracks.pp",
                                     "dose/boron.nii.gz", "dose/nitrogen.nii.gz", "dose/fast.nii.gz",
                                     "dose/gamma.nii.gz", "dose/valid.nii.gz" };
enum { N_FILES = sizeof files / sizeof *files };

static bool join(char path[PATH_MAX], const char *folder, const char *name)
{
    int n = snprintf(path, PATH_MAX, "%s/%s", folder, name);
    return n > 0 && n < PATH_MAX;
}

/* ---- files of the folder ---------------------------------------------------------------------------------------- */

/* Volumes are compressed in parallel; each part has its own error, and the first one is reported. */
enum { N_VOLUMES = 3 + PHANTOM_N_COMPONENTS };
struct volume_job {
    char path[PATH_MAX];
    struct volume *volume;
    const char *description;
    struct error err;
    bool is_written;
};

static void write_volumes(void *context, int part, int n_parts)
{
    struct volume_job *jobs = context;
    for (int i = part; i < N_VOLUMES; i += n_parts)
        jobs[i].is_written = nifti_write(jobs[i].path, jobs[i].volume, jobs[i].description, &jobs[i].err);
}

static bool make_volumes(struct volume_job jobs[N_VOLUMES], const char *folder, const struct phantom_options *options,
                         struct error *err)
{
    struct grid image_grid, dose_grid;
    if (!phantom_image_grid(options->size, &image_grid, err) || !phantom_dose_grid(&dose_grid, err) ||
        !phantom_fill_head(&image_grid, options->seed, &jobs[0].volume, &jobs[1].volume, err))
        return false;
    jobs[0].description = "Beamroom phantom: HU";
    jobs[1].description = "Beamroom phantom: 1 scalp 2 cranium 3 brain 4 target 5 tumour";
    jobs[2].description = "Beamroom phantom: 1 where the dose is valid";
    jobs[2].volume = phantom_dose_mask(&dose_grid, err);
    bool is_named = join(jobs[0].path, folder, "ct.nii.gz") && join(jobs[1].path, folder, "labels.nii.gz") &&
                    join(jobs[2].path, folder, "dose/valid.nii.gz");
    for (int i = 0; i < PHANTOM_N_COMPONENTS; i++) {
        const struct phantom_component *component = &phantom_components[i];
        struct volume_job *job = &jobs[3 + i];
        char name[64];
        snprintf(name, sizeof name, "dose/%s.nii.gz", dose_quantity_word(component->quantity));
        is_named = is_named && join(job->path, folder, name);
        job->description =
            component->is_per_ppm ? "Beamroom phantom: Gy per minute per ppm" : "Beamroom phantom: Gy per minute";
        job->volume = jobs[2].volume ? phantom_dose_volume(component, &dose_grid, err) : NULL;
        if (!job->volume)
            return false;
    }
    return is_named || error_set(err, ERROR_LIMIT, "%s: the path is too long", folder);
}

static bool write_grids(const char *folder, const struct phantom_options *options, struct error *err)
{
    struct volume_job *jobs = calloc(N_VOLUMES, sizeof *jobs);
    if (!jobs)
        return error_set(err, ERROR_MEMORY, "no memory for the phantom's volumes");
    bool is_written = make_volumes(jobs, folder, options, err);
    if (is_written) {
        parallel_run(parallel_cores(), write_volumes, jobs);
        for (int i = 0; i < N_VOLUMES && is_written; i++) {
            is_written = jobs[i].is_written;
            if (!is_written)
                error_set(err, jobs[i].err.code, "%s", jobs[i].err.text);
        }
    }
    for (int i = 0; i < N_VOLUMES; i++)
        volume_unref(jobs[i].volume);
    free(jobs);
    return is_written;
}

static bool write_text(const char *folder, const char *name, char *text, struct error *err) /* consumes text */
{
    char path[PATH_MAX];
    bool is_written = text &&
                      (join(path, folder, name) || error_set(err, ERROR_LIMIT, "%s: the path is too long", folder)) &&
                      file_write(path, text, strlen(text), err);
    free(text);
    return is_written;
}

static bool write_tracks(const char *folder, uint64_t seed, struct error *err)
{
    struct track_segment segments[PHANTOM_MAX_TRACKS];
    size_t n_bytes, n_segments = phantom_make_tracks(seed, segments);
    return write_text(folder, "tracks.pp", phantom_tracks_text(segments, n_segments, &n_bytes, err), err);
}

static bool write_contents(const char *folder, const struct phantom_options *options, struct error *err)
{
    char dose[PATH_MAX];
    if (!join(dose, folder, "dose") || mkdir(dose, 0777) != 0)
        return error_set(err, ERROR_IO, "%s/dose: cannot be created: %s", folder, strerror(errno));
    return write_grids(folder, options, err) && write_tracks(folder, options->seed, err) &&
           write_text(folder, "labels.json", phantom_labels_json(err), err) &&
           write_text(folder, "README.txt", phantom_readme(options, err), err) &&
           write_text(folder, "plan.json", phantom_plan_json(options, err), err);
}

/* ---- creating and replacing the folder -------------------------------------------------------------------------- */

static void remove_phantom(const char *folder)
{
    char path[PATH_MAX];
    for (int i = 0; i < N_FILES; i++)
        if (join(path, folder, files[i]))
            unlink(path);
    if (join(path, folder, "dose"))
        rmdir(path);
    rmdir(folder);
}

static bool is_ours(const char *name)
{
    for (int i = 0; i < N_FILES; i++)
        if (strcmp(name, files[i]) == 0)
            return true;
    return strcmp(name, "dose") == 0;
}

/* Counts the entries of folder/below ("" or "dose"); false if one is not a phantom's file. */
static bool count_entries(const char *folder, const char *below, size_t *n_entries, struct error *err)
{
    char path[PATH_MAX];
    if (!join(path, folder, below))
        return error_set(err, ERROR_LIMIT, "%s: the path is too long", folder);
    DIR *dir = opendir(path);
    if (!dir)
        return errno == ENOENT && *below ? true
                                         : error_set(err, ERROR_IO, "%s: cannot be read: %s", path, strerror(errno));
    bool is_clean = true;
    for (struct dirent *entry; is_clean && (entry = readdir(dir));) {
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        char name[512];
        snprintf(name, sizeof name, "%s%s%s", below, *below ? "/" : "", entry->d_name);
        ++*n_entries;
        if (!is_ours(name))
            is_clean = error_set(err, ERROR_STATE, "%s holds %s, which is no part of a phantom: it is left as it is",
                                 folder, name);
    }
    closedir(dir);
    return is_clean;
}

/* Checks that a phantom may be written to folder. is_filled: a phantom is already there. */
static bool check_folder(const char *folder, bool replace, bool *is_filled, struct error *err)
{
    struct stat what;
    *is_filled = false;
    if (lstat(folder, &what) != 0)
        return errno == ENOENT ? true : error_set(err, ERROR_IO, "%s: %s", folder, strerror(errno));
    if (!S_ISDIR(what.st_mode))
        return error_set(err, ERROR_STATE, "%s is there and is no folder", folder);
    size_t n_entries = 0;
    struct error reason = { 0 };
    bool is_clean =
        count_entries(folder, "", &n_entries, &reason) && count_entries(folder, "dose", &n_entries, &reason);
    if (is_clean && n_entries == 0)
        return true;
    if (!replace)
        return error_set(err, ERROR_STATE, "%s is there already and is not empty", folder);
    if (!is_clean)
        return error_set(err, reason.code, "%s", reason.text);
    *is_filled = true;
    return true;
}

/* Renames the finished folder to its place. */
static bool move_into_place(const char *partial, const char *folder, bool is_filled, struct error *err)
{
    char old[PATH_MAX];
    snprintf(old, sizeof old, "%s.old-%ld", folder, (long)getpid());
    if (is_filled && rename(folder, old) != 0)
        return error_set(err, ERROR_IO, "%s: cannot be replaced: %s", folder, strerror(errno));
    if (rename(partial, folder) != 0) {
        int reason = errno;
        if (is_filled && rename(old, folder) != 0)
            return error_set(err, ERROR_IO, "%s: %s; the phantom that was there is now %s", folder, strerror(reason),
                             old);
        return error_set(err, ERROR_IO, "%s: cannot be created: %s", folder, strerror(reason));
    }
    if (is_filled)
        remove_phantom(old);
    return true;
}

static bool check_options(const struct phantom_options *options, struct error *err)
{
    const uint32_t *size = options->size;
    uint64_t n_voxels = 1;
    for (int axis = 0; axis < 3; axis++) {
        if (size[axis] < PHANTOM_MIN_SIDE || size[axis] > PHANTOM_MAX_SIDE)
            return error_set(err, ERROR_RANGE, "a phantom of %u x %u x %u voxels: each side must be %d to %d", size[0],
                             size[1], size[2], PHANTOM_MIN_SIDE, PHANTOM_MAX_SIDE);
        n_voxels *= size[axis];
    }
    if (n_voxels > PHANTOM_MAX_VOXELS)
        return error_set(err, ERROR_LIMIT, "a phantom of %u x %u x %u is %" PRIu64 " voxels: more than %" PRIu64,
                         size[0], size[1], size[2], n_voxels, PHANTOM_MAX_VOXELS);
    return true;
}

bool phantom_write(const char *folder, const struct phantom_options *options, bool replace, struct error *err)
{
    char place[FILE_FOLDER_SIZE], partial[PATH_MAX];
    bool is_filled;
    if (!file_folder_paths(folder, place, partial, err) || !check_options(options, err) ||
        !check_folder(place, replace, &is_filled, err))
        return false;
    if (mkdir(partial, 0777) != 0)
        return error_set(err, ERROR_IO, "%s: cannot be created: %s", place, strerror(errno));
    if (!write_contents(partial, options, err) || !move_into_place(partial, place, is_filled, err)) {
        remove_phantom(partial);
        return false;
    }
    return true;
}

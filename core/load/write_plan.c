/* Writes a plan as a plan folder of our own. */
#include "core/load/write_plan.h"

#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/file_write.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/formats/nifti_write.h"
#include "core/formats/plan/plan_json.h"
#include "core/load/write_sera_texts.h"
#include "core/plan/fit.h"

static const char *const folders[] = { "images", "regions", "doses", "curves" };
enum {
    N_FOLDERS = sizeof folders / sizeof folders[0],
    MAX_FILES = PLAN_MAX_IMAGES + REGION_MAX_LAYERS + PLAN_MAX_DOSES * (2 * DOSE_N_QUANTITIES + 1)
};

/* One file of voxels to write; written by one thread. */
struct voxel_file {
    char name[FOLDER_NAME_SIZE];
    const struct volume *volume;
    const bool *is_kept; /* [65536] labels of a label layer to write, others become 0; NULL: write all voxels */
    uint64_t n_cleared;  /* voxels whose label became 0 */
    bool is_failed;
    struct error err;
};

struct plan_writing {
    const struct plan *plan;
    char folder[PATH_MAX]; /* temporary folder where the plan is built */
    struct voxel_file *outputs;
    size_t n_outputs;
    atomic_size_t next;
    atomic_bool is_failed; /* one output failed; the others need not start */
    struct plan_file *file;
};

static void join(char out[PATH_MAX], const char *folder, const char *name)
{
    int n = snprintf(out, PATH_MAX, "%s/%s", folder, name);
    if (n < 0 || n >= PATH_MAX)
        out[0] = 0; /* opening "" fails, with an error that is reported */
}

static struct voxel_file *add_output(struct plan_writing *writing, const struct volume *volume, const char *name)
{
    struct voxel_file *output = &writing->outputs[writing->n_outputs++];
    output->volume = volume;
    snprintf(output->name, sizeof output->name, "%s", name);
    return output;
}

/* ---- lists of files to write ------------------------------------------------------------------------------------ */

/* A part of another patient, or, unless plan.json can say so, of another frame of reference than the first image, would
 * lie on it without a word in the new folder. */
static bool is_carried(const struct plan_writing *writing, struct fit_part part)
{
    const struct plan *plan = writing->plan;
    int image = fit_first_image(plan);
    struct fit fit =
        image < 0 ? fit_alone(plan, part) : fit_of(plan, part, (struct fit_part){ FIT_IMAGE, (size_t)image });
    bool is_frame = part.kind != FIT_DOSE && fit.reasons >> FIT_FRAME & 1;
    return !is_frame && !(fit.reasons >> FIT_PATIENT & 1);
}

static bool is_region_carried(const struct plan_writing *writing, size_t region)
{
    return is_carried(writing, fit_part_of_region(writing->plan, region));
}

static void report_part(const struct plan_writing *writing, struct report *lost, struct fit_part part,
                        const char *where)
{
    char why[FIT_WHY_SIZE];
    int image = fit_first_image(writing->plan);
    struct fit_part with = image < 0 ? part : (struct fit_part){ FIT_IMAGE, (size_t)image };
    if (is_carried(writing, part))
        return;
    struct fit fit = image < 0 ? fit_alone(writing->plan, part) : fit_of(writing->plan, part, with);
    fit_sentence(writing->plan, part, with, fit.relation, why);
    report_add(lost, REPORT_WARNING, "write.does-not-fit", where, "%s", why);
}

static void report_left_out(const struct plan_writing *writing, struct report *lost)
{
    const struct plan *plan = writing->plan;
    for (size_t i = 0; i < plan->n_images; i++)
        report_part(writing, lost, (struct fit_part){ FIT_IMAGE, i }, plan->images[i].id);
    for (size_t i = 0; i < plan->n_doses; i++)
        report_part(writing, lost, (struct fit_part){ FIT_DOSE, i }, plan->doses[i].id);
    for (size_t i = 0; i < plan->n_beams; i++)
        report_part(writing, lost, (struct fit_part){ FIT_BEAM, i }, plan->beams[i].id);
    for (size_t r = 0; r < plan->regions.n_regions; r++)
        report_part(writing, lost, fit_part_of_region(plan, r), plan->regions.regions[r].id);
}

static void list_images(struct plan_writing *writing)
{
    const struct plan *plan = writing->plan;
    for (size_t i = 0; i < plan->n_images; i++) {
        if (!is_carried(writing, (struct fit_part){ FIT_IMAGE, i }))
            continue;
        struct plan_file_image *image = &writing->file->images[writing->file->n_images++];
        memcpy(image->id, plan->images[i].id, sizeof image->id);
        memcpy(image->name, plan->images[i].name, sizeof image->name);
        memcpy(image->modality, plan->images[i].modality, sizeof image->modality);
        memcpy(image->value_unit, plan->images[i].unit, sizeof image->value_unit);
        image->is_inverted = plan->images[i].is_inverted;
        image->window_center = plan->images[i].window_center;
        image->window_width = plan->images[i].window_width;
        snprintf(image->path, sizeof image->path, "images/%s.nii.gz", plan->images[i].id);
        add_output(writing, plan->images[i].volume, image->path);
    }
}

static bool write_names(const struct plan_writing *writing, uint32_t layer, const char *name, bool *is_kept,
                        struct error *err)
{
    const struct region_set *set = &writing->plan->regions;
    struct label_names names = { .labels = mem_new(set->n_regions * sizeof *names.labels) };
    char path[PATH_MAX];
    for (size_t r = 0; r < set->n_regions; r++) {
        const struct region *region = &set->regions[r];
        if (region->layer != layer || !is_region_carried(writing, r))
            continue;
        struct label_name *label = &names.labels[names.n++];
        label->value = region->label;
        label->has_color = region->has_file_color;
        label->opacity = region->file_opacity;
        label->is_target = region->is_target;
        memcpy(label->rgb, region->rgb, sizeof label->rgb);
        memcpy(label->name, region->name, sizeof label->name);
        memcpy(label->id, region->id, sizeof label->id);
        label->place = (int)r + 1;
        label->has_tissue = true;
        label->tissue = (struct label_tissue){ region->boron_ratio, region->cbe_boron, region->rbe_nitrogen,
                                               region->rbe_fast, region->rbe_gamma };
        is_kept[region->label] = true;
    }
    char *text = label_names_text(&names, err);
    join(path, writing->folder, name);
    bool is_written = text && file_write(path, text, strlen(text), err);
    free(text);
    label_names_finish(&names);
    return is_written;
}

static bool list_regions(struct plan_writing *writing, bool (*is_kept)[65536], struct error *err)
{
    const struct region_set *set = &writing->plan->regions;
    struct plan_file *file = writing->file;
    for (uint32_t layer = 0; layer < set->n_layers; layer++) {
        bool is_used = false;
        for (size_t r = 0; r < set->n_regions; r++)
            is_used |= set->regions[r].layer == layer && is_region_carried(writing, r);
        if (!is_used)
            continue;
        struct plan_file_region *region = &file->regions[file->n_regions++];
        snprintf(region->path, sizeof region->path, "regions/labels-%zu.nii.gz", file->n_regions);
        snprintf(region->names, sizeof region->names, "regions/labels-%zu.json", file->n_regions);
        if (!write_names(writing, layer, region->names, is_kept[layer], err))
            return false;
        add_output(writing, set->layers[layer], region->path)->is_kept = is_kept[layer];
    }
    for (size_t r = 0; set->hierarchy == HIERARCHY_FILE && r < set->n_regions; r++) {
        int parent = set->regions[r].parent;
        if (parent < 0 || file->n_pairs >= PLAN_FILE_MAX_PAIRS || !is_region_carried(writing, r) ||
            !is_region_carried(writing, (size_t)parent))
            continue;
        struct plan_file_pair *pair = &file->pairs[file->n_pairs++];
        snprintf(pair->outer, sizeof pair->outer, "%s", set->regions[parent].id);
        snprintf(pair->inner, sizeof pair->inner, "%s", set->regions[r].id);
    }
    return true;
}

/* Whether the dose lies on the first image; the frames of reference themselves are not written. */
static void state_frame(const struct plan *plan, size_t dose, struct plan_file_dose *entry)
{
    int image = fit_first_image(plan);
    struct fit_part part = { FIT_DOSE, dose };
    struct fit fit =
        image < 0 ? fit_alone(plan, part) : fit_of(plan, part, (struct fit_part){ FIT_IMAGE, (size_t)image });
    bool is_known = image >= 0 && plan->dose_origins[dose].frame_uid[0] && plan->image_origins[image].frame_uid[0];
    entry->has_frame = plan->doses[dose].has_frame;
    entry->frame = plan->doses[dose].frame;
    if (fit.reasons >> FIT_FRAME & 1 || is_known) {
        entry->has_frame = true;
        entry->frame = fit.reasons >> FIT_FRAME & 1 ? DOSE_FRAME_DIFFERS : DOSE_FRAME_SAME;
    }
}

/* Files are called id_quantity; ids have no '_', so no two are called the same. */
static void list_doses(struct plan_writing *writing)
{
    const struct plan *plan = writing->plan;
    for (size_t i = 0; i < plan->n_doses; i++) {
        const struct dose *dose = &plan->doses[i];
        if (!is_carried(writing, (struct fit_part){ FIT_DOSE, i }))
            continue;
        struct plan_file_dose *entry = &writing->file->doses[writing->file->n_doses++];
        memcpy(entry->id, dose->id, sizeof entry->id);
        memcpy(entry->name, dose->name, sizeof entry->name);
        memcpy(entry->unit, dose->unit, sizeof entry->unit);
        memcpy(entry->per, dose->per, sizeof entry->per);
        state_frame(plan, i, entry);
        for (size_t c = 0; c < dose->n_components; c++) {
            struct plan_file_component *component = &entry->components[entry->n_components++];
            component->quantity = dose->components[c].quantity;
            component->is_per_ppm = dose->components[c].is_per_ppm;
            component->has_boron_ppm = dose->components[c].has_boron_ppm;
            component->boron_ppm = dose->components[c].boron_ppm;
            component->reference = dose->reference[component->quantity];
            snprintf(component->path, sizeof component->path, "doses/%s_%s.nii.gz", dose->id,
                     dose_quantity_word(component->quantity));
            add_output(writing, dose->components[c].values, component->path);
            if (dose->components[c].error) {
                snprintf(component->error, sizeof component->error, "doses/%s_%s-error.nii.gz", dose->id,
                         dose_quantity_word(component->quantity));
                add_output(writing, dose->components[c].error, component->error);
            }
        }
        if (dose->mask) {
            snprintf(entry->mask, sizeof entry->mask, "doses/%s_valid.nii.gz", dose->id);
            add_output(writing, dose->mask, entry->mask);
        }
    }
}

/* ---- writing ---------------------------------------------------------------------------------------------------- */

/* Copies a label layer; voxels whose label is not kept become 0. */
static struct volume *copy_kept(const struct volume *layer, const bool *is_kept, uint64_t *n_cleared, struct error *err)
{
    struct volume *copy = volume_create(&layer->grid, layer->type, err);
    size_t n = grid_n_voxels(&layer->grid);
    *n_cleared = 0;
    for (size_t i = 0; copy && i < n; i++) {
        if (layer->type == VOXEL_U8) {
            uint8_t label = ((const uint8_t *)layer->voxels)[i];
            ((uint8_t *)copy->voxels)[i] = is_kept[label] ? label : 0;
            *n_cleared += label != 0 && !is_kept[label];
        } else {
            uint16_t label = ((const uint16_t *)layer->voxels)[i];
            ((uint16_t *)copy->voxels)[i] = is_kept[label] ? label : 0;
            *n_cleared += label != 0 && !is_kept[label];
        }
    }
    return copy;
}

static bool write_output(const struct plan_writing *writing, struct voxel_file *output)
{
    char path[PATH_MAX];
    join(path, writing->folder, output->name);
    if (!output->is_kept)
        return nifti_write_exact(path, output->volume, NULL, &output->err);
    struct volume *kept = copy_kept(output->volume, output->is_kept, &output->n_cleared, &output->err);
    bool is_written = kept && nifti_write_exact(path, kept, NULL, &output->err);
    volume_unref(kept);
    return is_written;
}

static void write_some(void *context, int part, int n_parts)
{
    (void)part;
    (void)n_parts;
    struct plan_writing *writing = context;
    for (size_t at;
         !atomic_load(&writing->is_failed) && (at = atomic_fetch_add(&writing->next, 1)) < writing->n_outputs;) {
        writing->outputs[at].is_failed = !write_output(writing, &writing->outputs[at]);
        if (writing->outputs[at].is_failed)
            atomic_store(&writing->is_failed, true);
    }
}

static bool write_volumes(struct plan_writing *writing, struct error *err)
{
    atomic_init(&writing->next, 0);
    atomic_init(&writing->is_failed, false);
    parallel_run(parallel_cores(), write_some, writing);
    for (size_t i = 0; i < writing->n_outputs; i++)
        if (writing->outputs[i].is_failed) {
            if (err)
                *err = writing->outputs[i].err;
            return false;
        }
    return true;
}

static bool write_plan_json(const struct plan_writing *writing, struct error *err)
{
    char path[PATH_MAX];
    char *text = plan_file_text(writing->file, err);
    if (!text)
        return false;
    size_t n = strlen(text);
    struct plan_file *again = plan_file_parse((const uint8_t *)text, n, NULL,
                                              err); /* read back: a plan.json that cannot be opened is not written */
    join(path, writing->folder, "plan.json");
    bool is_written = again && file_write(path, text, n, err);
    plan_file_destroy(again);
    free(text);
    return is_written;
}

static bool write_contents(struct plan_writing *writing, struct error *err)
{
    const struct plan *plan = writing->plan;
    bool(*is_kept)[65536] = mem_new((plan->regions.n_layers + 1) * sizeof *is_kept);
    struct plan_file *file = writing->file;
    memcpy(file->name, plan->name, sizeof file->name);
    memcpy(file->note, plan->note, sizeof file->note);
    file->is_phantom = plan->is_phantom;
    list_images(writing);
    bool is_written = list_regions(writing, is_kept, err);
    list_doses(writing);
    for (size_t i = 0; i < plan->n_beams; i++)
        if (is_carried(writing, (struct fit_part){ FIT_BEAM, i }))
            file->beams[file->n_beams++] = plan->beams[i];
    is_written = is_written && write_volumes(writing, err) && plan_write_texts(plan, writing->folder, file, err) &&
                 write_plan_json(writing, err);
    free(is_kept);
    return is_written;
}

/* ---- the folder ------------------------------------------------------------------------------------------------- */

static bool is_empty(const char *folder)
{
    DIR *directory = opendir(folder);
    size_t n = 0;
    for (struct dirent *entry; directory && (entry = readdir(directory));)
        n += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0;
    if (directory)
        closedir(directory);
    return directory && n == 0;
}

static bool check_target(const char *folder, struct error *err)
{
    struct stat about;
    if (lstat(folder, &about) != 0)
        return errno == ENOENT ? true : error_set(err, ERROR_IO, "%.180s: %s", folder, strerror(errno));
    if (!S_ISDIR(about.st_mode))
        return error_set(err, ERROR_STATE, "%s is there and is no folder", folder);
    return is_empty(folder) || error_set(err, ERROR_STATE, "%s is there already and is not empty", folder);
}

static bool make_folder(const char *folder, const char *final_folder, struct error *err)
{
    return mkdir(folder, 0777) == 0 ||
           error_set(err, ERROR_IO, "%.180s: cannot be created: %s", final_folder, strerror(errno));
}

static bool make_inner_folders(const char *folder, const char *final_folder, struct error *err)
{
    char path[PATH_MAX];
    for (int i = 0; i < N_FOLDERS; i++) {
        join(path, folder, folders[i]);
        if (!make_folder(path, final_folder, err))
            return false;
    }
    return true;
}

/* Removes the folders that stayed empty. */
static void remove_empty(const char *folder)
{
    char path[PATH_MAX];
    for (int i = 0; i < N_FOLDERS; i++) {
        join(path, folder, folders[i]);
        (void)rmdir(path);
    }
}

static void remove_files(const char *folder)
{
    DIR *directory = opendir(folder);
    char path[PATH_MAX];
    for (struct dirent *entry; directory && (entry = readdir(directory));) {
        join(path, folder, entry->d_name);
        (void)unlink(path); /* fails for folders, which are removed later */
    }
    if (directory)
        closedir(directory);
}

static void remove_all(const char *folder)
{
    char path[PATH_MAX];
    for (int i = 0; i < N_FOLDERS; i++) {
        join(path, folder, folders[i]);
        remove_files(path);
    }
    remove_files(folder);
    remove_empty(folder);
    (void)rmdir(folder);
}

/* Replaces the temporary folder in an error sentence by the folder that was asked for, as the first no longer exists.
 */
static void name_final_folder(const char *folder, const char *final_folder, struct error *err)
{
    size_t n = strlen(folder);
    char rest[sizeof err->text];
    if (!err || strncmp(err->text, folder, n) != 0)
        return;
    memcpy(rest, err->text + n, strlen(err->text + n) + 1);
    error_set(err, err->code, "%.180s%s", final_folder, rest);
}

static void report_cleared(const struct plan_writing *writing, struct report *lost)
{
    for (size_t i = 0; i < writing->n_outputs; i++)
        if (writing->outputs[i].n_cleared > 0)
            report_add(
                lost, REPORT_NOTE, "write.labels-cleared", writing->outputs[i].name,
                "%llu voxels that carry a label of no region, such as the filling around the patient, are written as 0.",
                (unsigned long long)writing->outputs[i].n_cleared);
}

bool plan_write(const struct plan *plan, const char *folder, struct report *lost, struct error *err)
{
    struct plan_writing writing = { .plan = plan };
    char place[FILE_FOLDER_SIZE];
    if (!file_folder_paths(folder, place, writing.folder, err) || !check_target(place, err) ||
        !make_folder(writing.folder, place, err))
        return false;
    writing.outputs = mem_new(MAX_FILES * sizeof *writing.outputs);
    writing.file = mem_new(sizeof *writing.file);
    writing.file->regions = mem_new((REGION_MAX_LAYERS + 1) * sizeof *writing.file->regions);
    writing.file->pairs = mem_new(PLAN_FILE_MAX_PAIRS * sizeof *writing.file->pairs);
    bool is_written = make_inner_folders(writing.folder, place, err) && write_contents(&writing, err);
    if (is_written) {
        remove_empty(writing.folder);
        if (rename(writing.folder, place) != 0)
            is_written = error_set(err, ERROR_IO, "%.180s: cannot be created: %s", place, strerror(errno));
    }
    if (is_written) {
        report_left_out(&writing, lost);
        report_cleared(&writing, lost);
    } else {
        remove_all(writing.folder);
        name_final_folder(writing.folder, place, err);
    }
    plan_file_destroy(writing.file);
    free(writing.outputs);
    return is_written;
}

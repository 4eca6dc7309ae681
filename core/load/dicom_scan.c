/* Reads the headers of the DICOM files of a plan's folder, and makes parts of them where there is no plan.json. */
#include "core/load/dicom_scan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/load/reader_table.h"
#include "core/plan/plan.h"

/* ---- notes on the folder as a whole ----------------------------------------------------------------------------- */

static int compare_texts(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

static size_t count_studies(const struct dicom_index *index)
{
    const char **studies = mem_new((index->n_objects + 1) * sizeof *studies);
    size_t n = 0, n_different = 0;
    for (size_t i = 0; i < index->n_objects; i++)
        if (index->objects[i].kind != DICOM_KIND_OTHER && index->objects[i].study[0])
            studies[n++] = index->objects[i].study;
    qsort(studies, n, sizeof *studies, compare_texts);
    for (size_t i = 0; i < n; i++)
        n_different += i == 0 || strcmp(studies[i], studies[i - 1]) != 0;
    free(studies);
    return n_different;
}

static void report_studies(const struct dicom_index *index, struct report *report)
{
    size_t n_studies = count_studies(index);
    if (n_studies > 1)
        report_add(report, REPORT_NOTE, "dicom.several-studies", "",
                   "The DICOM files are of %zu studies; all of them are shown together.", n_studies);
}

/* ---- a folder without plan.json --------------------------------------------------------------------------------- */

static void name_image(const struct dicom_stack *stack, struct plan_file_image *image)
{
    const char *modality = text_equal(stack->modality, "PT") ? "PET" : stack->modality;
    snprintf(image->modality, sizeof image->modality, "%.15s", modality);
    snprintf(image->name, sizeof image->name, "%.15s%s%.100s", modality, stack->description[0] ? " " : "",
             stack->description);
    snprintf(image->id, sizeof image->id, "%.15s%s%.40s", modality, stack->description[0] ? "-" : "",
             stack->description);
}

/* Puts CT series first: regions and doses are mostly made on them. */
static void recognise_images(const struct dicom_index *index, struct plan_file *file, struct report *report)
{
    struct plan_file_image *named = mem_new(PLAN_MAX_IMAGES * sizeof *named);
    size_t n_named = file->n_images, n_left = 0;
    memcpy(named, file->images, n_named * sizeof *named);
    memset(file->images, 0, n_named * sizeof *named);
    file->n_images = 0;
    for (int turn = 0; turn < 2; turn++)
        for (size_t s = 0; s < index->n_stacks; s++) {
            const struct dicom_stack *stack = &index->stacks[s];
            if (text_equal(stack->modality, "CT") != (turn == 0))
                continue;
            if (file->n_images >= PLAN_MAX_IMAGES) {
                n_left++;
                continue;
            }
            struct plan_file_image *image = &file->images[file->n_images++];
            name_image(stack, image);
            snprintf(image->path, sizeof image->path, "%s", index->objects[stack->objects[0]].path);
        }
    for (size_t i = 0; i < n_named; i++) {
        n_left += file->n_images >= PLAN_MAX_IMAGES;
        if (file->n_images < PLAN_MAX_IMAGES)
            file->images[file->n_images++] = named[i];
    }
    free(named);
    if (n_left > 0)
        report_add(report, REPORT_WARNING, "plan.ignored-file", "",
                   "More than %d images; %zu of the smaller ones were not read.", PLAN_MAX_IMAGES, n_left);
}

static void recognise_structs(const struct dicom_index *index, struct plan_file *file, struct report *report)
{
    for (size_t i = 0; i < index->n_objects; i++) {
        const struct dicom_object *object = &index->objects[i];
        if (object->kind != DICOM_KIND_STRUCT && object->kind != DICOM_KIND_SEGMENTATION)
            continue;
        if (file->n_regions < PLAN_FILE_MAX_PARTS)
            snprintf(file->regions[file->n_regions++].path, FOLDER_NAME_SIZE, "%s", object->path);
        else
            report_add(report, REPORT_WARNING, "plan.ignored-file", object->path,
                       "More than %d files of regions; this one was not read.", PLAN_FILE_MAX_PARTS);
    }
}

bool plan_dicom_recognise(const struct folder *folder, char *const *names, size_t n_names, struct plan_parts *parts,
                          const struct dicom_progress *progress, struct report *report, struct error *err)
{
    if (n_names == 0)
        return true;
    parts->dicom = dicom_index_scan(folder, names, n_names, progress, report, err);
    if (!parts->dicom)
        return false;
    parts->is_all_dicom = true;
    recognise_images(parts->dicom, parts->file, report);
    recognise_structs(parts->dicom, parts->file, report);
    report_studies(parts->dicom, report);
    return true;
}

/* ---- DICOM that plan.json names --------------------------------------------------------------------------------- */

struct named_files {
    const struct folder *folder;
    char **names;
    size_t n;
};

static void add_named(struct named_files *named, char *path)
{
    if (path[0] && part_reader_of(named->folder, path) == &part_dicom)
        named->names[named->n++] = path;
}

bool plan_dicom_scan_named(const struct folder *folder, struct plan_parts *parts, const struct dicom_progress *progress,
                           struct report *report, struct error *err)
{
    struct plan_file *file = parts->file;
    size_t most = file->n_images + file->n_regions + file->n_doses * DOSE_N_QUANTITIES + file->n_beam_files;
    struct named_files named = { folder, mem_new((most + 1) * sizeof(char *)), 0 };
    for (size_t i = 0; i < file->n_images; i++)
        add_named(&named, file->images[i].path);
    for (size_t i = 0; i < file->n_regions; i++)
        add_named(&named, file->regions[i].path);
    for (size_t i = 0; i < file->n_doses; i++)
        for (size_t c = 0; c < file->doses[i].n_components; c++)
            add_named(&named, file->doses[i].components[c].path);
    for (size_t i = 0; i < file->n_beam_files; i++)
        add_named(&named, file->beam_files[i].path);
    if (named.n > 0) {
        parts->dicom = dicom_index_scan(folder, named.names, named.n, progress, report, err);
        if (parts->dicom)
            report_studies(parts->dicom, report);
    }
    free(named.names);
    return named.n == 0 || parts->dicom;
}

/* Lists the files to read for a plan: one part_reading each. */
#include "core/load/part_list.h"

#include "core/base/mem.h"
#include "core/load/dicom_parts.h"
#include "core/load/nifti_parts.h"
#include "core/load/reader_table.h"

static bool refuse_format(const char *path, const struct part_reader *reader, struct error *err)
{
    if (reader == &part_absent)
        return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
    if (reader == &part_unknown)
        return error_set(err, ERROR_UNSUPPORTED, "%s: the format is not one that this version reads", path);
    return error_set(err, ERROR_UNSUPPORTED, "%s: %s is not read here by this version", path, reader->word);
}

static struct part_reading *list_part(struct loading *loading, enum part_kind kind, size_t index, size_t component,
                                      const char *path, const struct part_reader *reader)
{
    struct part_reading *reading = &loading->readings[loading->n_readings++];
    reading->kind = kind;
    reading->index = index;
    reading->component = component;
    reading->path = path;
    reading->loading = loading;
    reading->reader = reader;
    char voxels[FOLDER_NAME_SIZE];
    plan_nifti_voxels(&loading->folder, path, voxels);
    folder_look(&loading->folder, voxels[0] ? voxels : path, &reading->bytes);
    return reading;
}

/* Lists every object of the kind at or below the path; returns how many. */
static size_t list_dicom(struct loading *loading, enum part_kind kind, enum dicom_kind of, size_t index,
                         size_t component, const char *path, size_t most)
{
    const struct dicom_object *object;
    size_t n = 0;
    for (; n < most && (object = plan_dicom_object(loading->parts.dicom, of, path, n)); n++)
        list_part(loading, kind, index, component, object->path, &part_dicom); /* whatever the file is called */
    return n;
}

static bool refuse_dicom(const struct loading *loading, const char *path, const char *what, struct error *err)
{
    const struct dicom_object *other = plan_dicom_object(loading->parts.dicom, DICOM_KIND_OTHER, path, 0);
    return error_set(err, ERROR_UNSUPPORTED, "%s: no DICOM %s that can be used%s%s", path, what, other ? ": " : "",
                     other ? other->reason : "");
}

static bool list_image(struct loading *loading, size_t i, struct error *err)
{
    const char *path = loading->file->images[i].path;
    const struct part_reader *reader = part_reader_of(&loading->folder, path);
    if (!(reader->reads & PART_READS_IMAGES))
        return refuse_format(path, reader, err);
    struct part_reading *reading = list_part(loading, PART_KIND_IMAGE, i, 0, path, reader);
    if (reader != &part_dicom)
        return true;
    reading->stack = plan_dicom_stack(loading->parts.dicom, path);
    if (reading->stack < 0)
        return refuse_dicom(loading, path, "image series", err);
    const struct dicom_stack *stack = &loading->parts.dicom->stacks[reading->stack];
    reading->bytes = 0;
    for (size_t at = 0; at < stack->n_objects; at++)
        reading->bytes += loading->parts.dicom->objects[stack->objects[at]].n_bytes;
    return true;
}

static bool list_regions(struct loading *loading, size_t i, struct error *err)
{
    const char *path = loading->file->regions[i].path;
    const struct part_reader *reader = part_reader_of(&loading->folder, path);
    if (reader == &part_dicom)
        return list_dicom(loading, PART_KIND_REGION, DICOM_KIND_STRUCT, i, 0, path, PLAN_FILE_MAX_PARTS) +
                       list_dicom(loading, PART_KIND_REGION, DICOM_KIND_SEGMENTATION, i, 0, path, PLAN_FILE_MAX_PARTS) >
                   0 ||
               refuse_dicom(loading, path, "structure set or segmentation", err);
    if (!(reader->reads & PART_READS_REGIONS))
        return refuse_format(path, reader, err);
    list_part(loading, PART_KIND_REGION, i, 0, path, reader);
    return true;
}

/* Reports a dose in a format that is not read; the plan is shown without it. An image or regions in such a format are
 * refused instead. */
static bool dose_is_readable(struct loading *loading, const struct plan_file_dose *dose, bool *is_readable,
                             struct error *err)
{
    *is_readable = true;
    for (size_t c = 0; c < dose->n_components; c++) {
        const char *path = dose->components[c].path;
        const struct part_reader *reader = part_reader_of(&loading->folder, path);
        if (reader == &part_absent)
            return refuse_format(path, reader, err);
        if (reader->reads & PART_READS_DOSES)
            continue;
        report_add(&loading->plan->report, REPORT_WARNING, "dose.unsupported", path,
                   "The dose \"%s\" is in a format (%s) that this version does not read; the plan is shown without it.",
                   dose->id, reader->word);
        *is_readable = false;
        return true;
    }
    return true;
}

/* The error of a component: in a file of its own, or in that of the values. */
static void list_dose_error(struct loading *loading, const struct plan_file_component *component, size_t i, size_t c)
{
    const struct part_reader *reader = part_reader_of(&loading->folder, component->path);
    if (component->error[0])
        list_part(loading, PART_KIND_DOSE_ERROR, i, c, component->error,
                  part_reader_of(&loading->folder, component->error));
    else if (reader->grid && reader->grid->has_error && reader->grid->has_error(&loading->folder, component->path))
        list_part(loading, PART_KIND_DOSE_ERROR, i, c, component->path, reader);
}

static bool list_dose(struct loading *loading, size_t i, struct error *err)
{
    const struct plan_file_dose *dose = &loading->file->doses[i];
    bool is_readable;
    if (!dose_is_readable(loading, dose, &is_readable, err))
        return false;
    for (size_t c = 0; is_readable && c < dose->n_components; c++) {
        const char *path = dose->components[c].path;
        size_t most = dose->n_components > 1 ? 1 : PLAN_DICOM_MAX_DOSES; /* a component stands for one object */
        const struct part_reader *reader = part_reader_of(&loading->folder, path);
        if (reader != &part_dicom)
            list_part(loading, PART_KIND_DOSE, i, c, path, reader);
        else if (list_dicom(loading, PART_KIND_DOSE, DICOM_KIND_DOSE, i, c, path, most) == 0)
            return refuse_dicom(loading, path, "dose", err);
    }
    for (size_t c = 0; is_readable && c < dose->n_components; c++)
        list_dose_error(loading, &dose->components[c], i, c);
    if (is_readable && dose->mask[0])
        list_part(loading, PART_KIND_DOSE_MASK, i, 0, dose->mask, part_reader_of(&loading->folder, dose->mask));
    return true;
}

/* Lists the files of the ith entry of one list of the plan file. */
typedef bool (*list_entry)(struct loading *loading, size_t i, struct error *err);

/* Lists an entry. When that fails it is reported and left out, unless the fault is not its own. */
static bool list_or_leave_out(struct loading *loading, list_entry list, size_t i, const char *path, struct error *err)
{
    struct error why = { 0 };
    size_t n_before = loading->n_readings;
    if (list(loading, i, &why))
        return true;
    while (loading->n_readings > n_before)
        loading->readings[--loading->n_readings] = (struct part_reading){ 0 };
    if (loading_may_leave_out(&why)) {
        loading_leave_out(loading, "part.unreadable", path, &why);
        return true;
    }
    if (err)
        *err = why;
    return false;
}

static bool list_beams(struct loading *loading, size_t i, struct error *err)
{
    const char *path = loading->file->beam_files[i].path;
    return list_dicom(loading, PART_KIND_BEAMS, DICOM_KIND_PLAN, i, 0, path, PLAN_DICOM_MAX_PLANS) > 0 ||
           refuse_dicom(loading, path, "treatment plan", err);
}

bool plan_list_parts(struct loading *loading, struct error *err)
{
    const struct plan_file *file = loading->file;
    const struct plan_parts *parts = &loading->parts;
    size_t n_objects = parts->dicom ? parts->dicom->n_objects : 0;
    /* upper bound: an entry that names a folder may stand for many files, and two entries may name the same files */
    size_t most = file->n_images + file->n_regions * (2 + n_objects) +
                  file->n_doses * (2 * DOSE_N_QUANTITIES + 1 + PLAN_DICOM_MAX_DOSES) + PLAN_DICOM_MAX_DOSES +
                  (file->n_beam_files + 1) * PLAN_DICOM_MAX_PLANS;
    bool is_made = true;
    loading->readings = mem_array(most + 1, sizeof *loading->readings, UINT32_MAX, err);
    if (!loading->readings)
        return false;
    for (size_t i = 0; is_made && i < file->n_images; i++)
        is_made = list_or_leave_out(loading, list_image, i, file->images[i].path, err);
    for (size_t i = 0; is_made && i < file->n_regions; i++)
        is_made = list_or_leave_out(loading, list_regions, i, file->regions[i].path, err);
    for (size_t i = 0; is_made && i < file->n_doses; i++)
        is_made = list_or_leave_out(loading, list_dose, i, file->doses[i].components[0].path, err);
    for (size_t i = 0; is_made && i < file->n_beam_files; i++)
        is_made = list_or_leave_out(loading, list_beams, i, file->beam_files[i].path, err);
    if (is_made && parts->is_all_dicom) {
        list_dicom(loading, PART_KIND_DOSE, DICOM_KIND_DOSE, PART_WITHOUT_ENTRY, 0, "", PLAN_DICOM_MAX_DOSES);
        list_dicom(loading, PART_KIND_BEAMS, DICOM_KIND_PLAN, PART_WITHOUT_ENTRY, 0, "", PLAN_DICOM_MAX_PLANS);
    }
    for (size_t i = 0; i < loading->n_readings; i++)
        loading->n_bytes += loading->readings[i].bytes;
    return is_made;
}

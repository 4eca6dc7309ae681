/* Summarises a plan folder from names and headers alone. */
#include "core/load/summary.h"

#include <stdio.h>
#include <string.h>

#include "core/formats/dicom/dicom_rtplan.h"
#include "core/formats/plan/plan_json.h"
#include "core/load/dicom_parts.h"
#include "core/load/find_parts.h"
#include "core/load/origins.h"
#include "core/load/part_names.h"
#include "core/load/reader_table.h"
#include "core/plan/identity.h"

enum { NAMES_MAX_BYTES = 16 << 20 };

static void add_part(struct plan_summary *summary, size_t n, const char *one, const char *many)
{
    if (n == 0 || summary->n_parts >= sizeof summary->parts / sizeof summary->parts[0])
        return;
    char *part = summary->parts[summary->n_parts++];
    if (n == 1 && !many)
        snprintf(part, sizeof summary->parts[0], "%s", one);
    else
        snprintf(part, sizeof summary->parts[0], "%zu %s", n, n == 1 || !many ? one : many);
}

static void count_bytes(const struct folder *folder, const char *name, struct plan_summary *summary)
{
    uint64_t bytes = 0;
    if (name[0] && folder_look(folder, name, &bytes) == FOLDER_FILE)
        summary->n_bytes += bytes;
}

/* Checks that the files exist and that the header is valid, and counts the file of voxels. */
static bool check_part(const struct folder *folder, const char *path, const struct part_reader *reader, unsigned reads,
                       struct plan_summary *summary, struct part_summary *part, struct error *err)
{
    *part = (struct part_summary){ 0 };
    if (reader == &part_absent)
        return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
    if (!(reader->reads & reads) || !reader->summarise)
        return error_set(err, ERROR_UNSUPPORTED, "%s: %s: not read by this version", path, reader->word);
    bool is_good = reader->summarise(folder, path, part, err);
    count_bytes(folder, part->data, summary);
    return is_good;
}

static size_t count_names(const struct folder *folder, const char *path)
{
    struct bytes bytes;
    struct label_names names;
    if (!path[0] || !folder_read(folder, path, NAMES_MAX_BYTES, UINT64_MAX, &bytes, NULL))
        return 0;
    size_t n = label_names_parse(bytes.data, bytes.size, path, &names, NULL) ? names.n : 0;
    label_names_finish(&names);
    bytes_free(&bytes);
    return n;
}

/* Adds "CT, 100 slices" for a DICOM series. For other images adds their number at the first of each modality. */
static void add_image_part(struct plan_summary *summary, const struct plan_parts *parts, size_t index, int stack)
{
    const struct plan_file *file = parts->file;
    const struct plan_file_image *image = &file->images[index];
    char part[64];
    if (stack >= 0) {
        const struct dicom_stack *of = &parts->dicom->stacks[stack];
        snprintf(part, sizeof part, "%.16s, %u slice%s", image->modality[0] ? image->modality : of->modality,
                 of->n_slices, of->n_slices == 1 ? "" : "s");
        add_part(summary, 1, part, NULL);
        return;
    }
    size_t n = 0;
    bool is_first = true;
    for (size_t other = 0; other < file->n_images; other++) {
        bool is_same = strcmp(file->images[other].modality, image->modality) == 0 &&
                       plan_dicom_stack(parts->dicom, file->images[other].path) < 0;
        n += is_same;
        is_first = is_first && !(is_same && other < index);
    }
    if (is_first && image->modality[0])
        add_part(summary, n, image->modality, NULL);
    else if (is_first)
        add_part(summary, n, "image", "images");
}

/* Returns the number of images whose headers are valid; err: why the first of the others is not. */
static size_t check_images(const struct folder *folder, const struct plan_parts *parts, struct plan_summary *summary,
                           struct error *err)
{
    size_t n_good = 0;
    for (size_t i = 0; i < parts->file->n_images; i++) {
        const struct plan_file_image *image = &parts->file->images[i];
        struct part_summary part;
        int stack = plan_dicom_stack(parts->dicom, image->path);
        count_bytes(folder, image->path, summary);
        n_good += stack >= 0 || check_part(folder, image->path, part_reader_of(folder, image->path), PART_READS_IMAGES,
                                           summary, &part, err->text[0] ? NULL : err);
        add_image_part(summary, parts, i, stack);
    }
    return n_good;
}

/* Number of items in a sequence of a DICOM object, or of items that have the inner sequence. */
static size_t count_items(const struct folder *folder, const char *path, uint32_t sequence, uint32_t inner)
{
    struct plan_dicom_file opened;
    if (!plan_dicom_open(folder, path, &opened, NULL))
        return 0;
    const struct dicom_item *root = dicom_root(opened.file);
    size_t n = dicom_n_items(root, sequence), n_filled = 0;
    for (size_t i = 0; i < n; i++)
        n_filled += !inner || dicom_n_items(dicom_item_at(root, sequence, i), inner) > 0;
    plan_dicom_close(&opened);
    return n_filled;
}

/* Number of such items in all objects of a kind at or below a path. */
static size_t count_objects(const struct folder *folder, const struct dicom_index *index, enum dicom_kind kind,
                            const char *path, struct plan_summary *summary)
{
    const struct dicom_object *object;
    size_t n = 0;
    for (size_t i = 0; (object = plan_dicom_object(index, kind, path, i)); i++) {
        if (kind == DICOM_KIND_STRUCT)
            n += count_items(folder, object->path, DICOM_TAG(0x3006, 0x0039), DICOM_TAG(0x3006, 0x0040));
        else if (kind == DICOM_KIND_SEGMENTATION)
            n += count_items(folder, object->path, DICOM_TAG(0x0062, 0x0002), 0);
        else if (kind == DICOM_KIND_PLAN)
            n += count_items(folder, object->path, DICOM_TAG(0x300a, 0x00b0), 0) +
                 count_items(folder, object->path, DICOM_TAG(0x300a, 0x03a2), 0); /* ions */
        else
            n++;
        if (kind == DICOM_KIND_DOSE || !path[0])
            count_bytes(folder, object->path, summary);
    }
    return n;
}

/* Returns the number of files of regions whose headers are valid; err: why the first of the others is not, unless it
 * holds an error already. */
static size_t check_regions(const struct folder *folder, const struct plan_parts *parts, struct plan_summary *summary,
                            struct error *err)
{
    const struct plan_file *file = parts->file;
    size_t n_regions = 0, n_names = 0, n_maps = 0, n_good = 0;
    for (size_t i = 0; i < file->n_regions; i++) {
        const struct plan_file_region *region = &file->regions[i];
        const struct part_reader *reader = part_reader_of(folder, region->path);
        struct part_summary part;
        bool is_good = true;
        count_bytes(folder, region->path, summary);
        if (reader == &part_dicom) {
            size_t n = count_objects(folder, parts->dicom, DICOM_KIND_STRUCT, region->path, summary) +
                       count_objects(folder, parts->dicom, DICOM_KIND_SEGMENTATION, region->path, summary);
            n_regions += region->name[0] && n > 1 ? 1 : n;
        } else {
            is_good =
                check_part(folder, region->path, reader, PART_READS_REGIONS, summary, &part, err->text[0] ? NULL : err);
            n_regions += part.n_regions;
        }
        if (reader->grid) {
            size_t n = count_names(folder, region->names);
            if (n == 0 && !region->name[0])
                n = part.n_segments;
            n_regions += region->name[0] != 0;
            n_names += n;
            n_maps += !region->name[0] && n == 0;
        }
        n_good += is_good;
    }
    add_part(summary, n_regions, "region", "regions");
    add_part(summary, n_names, "named label", "named labels");
    add_part(summary, n_maps, "label map", "label maps");
    return n_good;
}

/* Returns the number of doses, or components, that are read. */
static size_t count_doses(const struct folder *folder, const struct plan_parts *parts, struct plan_summary *summary)
{
    const struct plan_file *file = parts->file;
    size_t n_components = 0, n_unread = 0, n_objects = 0;
    for (size_t i = 0; i < file->n_doses; i++) {
        const struct plan_file_dose *dose = &file->doses[i];
        bool is_read = true;
        size_t n_more = 0; /* a file of SERA holds several components */
        if (dose->n_components == 1 && part_reader_of(folder, dose->components[0].path) == &part_dicom) {
            n_objects += count_objects(folder, parts->dicom, DICOM_KIND_DOSE, dose->components[0].path, summary);
            continue;
        }
        for (size_t c = 0; c < dose->n_components; c++) {
            count_bytes(folder, dose->components[c].path, summary);
            const struct part_reader *reader = part_reader_of(folder, dose->components[c].path);
            is_read = is_read && (reader->reads & PART_READS_DOSES);
            if (part_is_sera_dose(reader) && dose->components[c].quantity == DOSE_TOTAL)
                n_more += reader->n_doses - dose->n_components;
        }
        n_components += is_read ? dose->n_components + n_more : 0;
        n_unread += !is_read;
    }
    if (parts->is_all_dicom)
        n_objects += count_objects(folder, parts->dicom, DICOM_KIND_DOSE, "", summary);
    add_part(summary, n_objects, "dose", "doses");
    add_part(summary, n_components, "dose component", "dose components");
    add_part(summary, n_unread, "dose not read by this version", "doses not read by this version");
    return n_objects + n_components;
}

static size_t count_beams(const struct folder *folder, const struct plan_parts *parts, struct plan_summary *summary)
{
    size_t n = parts->file->n_beams;
    for (size_t i = 0; i < parts->file->n_beam_files; i++)
        n += count_objects(folder, parts->dicom, DICOM_KIND_PLAN, parts->file->beam_files[i].path, summary);
    return parts->is_all_dicom ? n + count_objects(folder, parts->dicom, DICOM_KIND_PLAN, "", summary) : n;
}

/* Adds the bytes of the image series, which have many files. */
static void count_series_bytes(const struct dicom_index *index, struct plan_summary *summary)
{
    for (size_t s = 0; index && s < index->n_stacks; s++)
        for (size_t i = 1; i < index->stacks[s].n_objects; i++) /* the first file is counted by the path of the part */
            summary->n_bytes += index->objects[index->stacks[s].objects[i]].n_bytes;
}

/* Adds the treatment plans at or below a path to those found. */
static size_t find_treatment_plans(const struct folder *folder, const struct dicom_index *index, const char *path,
                                   struct treatment_plan *found, size_t n)
{
    const struct dicom_object *object;
    for (size_t i = 0; n < ORIGIN_MAX_TREATMENT_PLANS && (object = plan_dicom_object(index, DICOM_KIND_PLAN, path, i));
         i++) {
        struct plan_dicom_file opened;
        struct report report = { 0 };
        if (!plan_dicom_open(folder, object->path, &opened, NULL))
            continue;
        struct rtplan *plan = rtplan_read(opened.file, object->path, &report, NULL);
        if (plan)
            origin_treatment_plan(plan, object->patient, &found[n++]);
        rtplan_destroy(plan);
        report_finish(&report);
        plan_dicom_close(&opened);
    }
    return n;
}

/* Chooses as plan_shown_patient does. */
static void add_patient(const struct folder *folder, const struct plan_parts *parts, struct plan_summary *summary)
{
    const struct dicom_index *index = parts->dicom;
    struct treatment_plan found[ORIGIN_MAX_TREATMENT_PLANS];
    size_t n = 0;
    if (!index)
        return;
    for (size_t i = 0; i < parts->file->n_beam_files; i++)
        n = find_treatment_plans(folder, index, parts->file->beam_files[i].path, found, n);
    if (parts->is_all_dicom)
        n = find_treatment_plans(folder, index, "", found, n);
    const int shown = identity_first_treatment_plan(found, n);
    int patient = shown >= 0 ? found[shown].patient : -1;
    if (patient < 0 && index->n_stacks > 0)
        patient = index->stacks[0].patient;
    if (patient < 0 && index->n_patients > 0)
        patient = 0;
    summary->n_patients = index->n_patients;
    summary->n_treatment_plans = n;
    if (shown >= 0) {
        memcpy(summary->label, found[shown].label, sizeof summary->label);
        memcpy(summary->date, found[shown].date, sizeof summary->date);
        memcpy(summary->approval, found[shown].approval, sizeof summary->approval);
    }
    if (patient >= 0 && (size_t)patient < index->n_patients) {
        struct plan_patient named;
        _Static_assert(sizeof summary->patient == IDENTITY_MASK_SIZE, "a masked patient fits");
        origin_patient(&index->patients[patient], &named);
        identity_mask(&named, summary->patient);
        memcpy(summary->patient_id, named.id, sizeof summary->patient_id);
    }
}

void plan_summarize(const char *path, struct plan_summary *summary)
{
    struct folder folder = { .fd = -1 };
    struct error err = { 0 };
    struct plan_parts parts = { 0 };
    *summary = (struct plan_summary){ 0 };
    plan_folder_name(path, summary->name, sizeof summary->name);
    bool is_open = folder_open(&folder, path, &err);
    summary->has_plan_file = is_open && folder_look(&folder, "plan.json", NULL) == FOLDER_FILE;
    if (is_open && plan_find_parts(&folder, NULL, &parts, NULL, &err)) {
        const struct plan_file *file = parts.file;
        memcpy(summary->name, file->name, sizeof summary->name);
        memcpy(summary->note, file->note, sizeof summary->note);
        summary->is_phantom = file->is_phantom;
        size_t n_good = check_images(&folder, &parts, summary, &err);
        n_good += check_regions(&folder, &parts, summary, &err);
        add_patient(&folder, &parts, summary);
        count_series_bytes(parts.dicom, summary);
        n_good += count_doses(&folder, &parts, summary);
        size_t n_beams = count_beams(&folder, &parts, summary);
        add_part(summary, n_beams, "beam", "beams");
        summary->is_readable = n_good + n_beams > 0 || !err.text[0]; /* one bad part keeps no other from being shown */
        for (size_t i = 0; i < file->n_tracks; i++)
            count_bytes(&folder, file->tracks[i].path, summary);
        add_part(summary, file->n_tracks, "file of tracks", "files of tracks");
        for (size_t i = 0; i < file->n_curves; i++)
            count_bytes(&folder, file->curves[i].path, summary);
        add_part(summary, file->n_curves, "reference curve", "reference curves");
    }
    snprintf(summary->reason, sizeof summary->reason, "%s", summary->is_readable ? "" : err.text);
    plan_parts_finish(&parts);
    folder_close(&folder);
}

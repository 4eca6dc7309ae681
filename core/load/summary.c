/* Summarises a plan folder from names and headers alone. */
#include "core/load/summary.h"

#include <stdio.h>
#include <string.h>

#include "core/formats/plan/plan_json.h"
#include "core/formats/sera/sera_chd.h"
#include "core/formats/sera/sera_rst.h"
#include "core/formats/sera/sera_uvh.h"
#include "core/formats/text.h"
#include "core/load/dicom_parts.h"
#include "core/load/find_parts.h"
#include "core/load/nifti_parts.h"
#include "core/load/nrrd_parts.h"
#include "core/load/part_format.h"
#include "core/load/part_names.h"

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

/* Checks that the files exist and that the header is valid. */
static bool check_nifti(const struct folder *folder, const char *name, struct plan_summary *summary, struct error *err)
{
    struct nifti_header header;
    char voxels[FOLDER_NAME_SIZE];
    plan_nifti_voxels(folder, name, voxels);
    if (strcmp(voxels, name) != 0)
        count_bytes(folder, voxels, summary);
    return plan_nifti_peek(folder, name, &header, err);
}

static bool check_nrrd(const struct folder *folder, const char *name, struct plan_summary *summary, size_t *n_segments,
                       struct error *err)
{
    struct nrrd_header header;
    bool is_good = plan_nrrd_peek(folder, name, &header, err);
    for (size_t i = 0; is_good && n_segments && i < header.n_segments; i++)
        *n_segments += header.segments[i].is_present;
    if (is_good && header.data_file[0])
        count_bytes(folder, header.data_file, summary);
    nrrd_header_finish(&header);
    return is_good;
}

static size_t count_bodies(const struct uvh *uvh)
{
    size_t n = 0;
    for (size_t i = 0; i < uvh->n_bodies; i++) {
        const struct uvh_body *body = &uvh->bodies[i];
        n += body->uvval != 0 && !text_equal(body->name, "buffer") && !text_equal(body->name, "void") &&
             !strstr(body->name, "ABSENT");
    }
    return n;
}

static bool check_univels(const struct folder *folder, const char *name, struct plan_summary *summary,
                          size_t *n_regions, struct error *err)
{
    struct bytes header;
    struct uvh uvh;
    char data[FOLDER_NAME_SIZE];
    if (!folder_read(folder, name, UVH_MAX_BYTES, UINT64_MAX, &header, err))
        return false;
    bool is_good = uvh_parse(header.data, header.size, name, &uvh, NULL, err);
    bytes_free(&header);
    if (!is_good)
        return false;
    *n_regions += count_bodies(&uvh);
    uvh_finish(&uvh);
    if (!part_find_data(folder, name, ".uv", data))
        return error_set(err, ERROR_NOT_FOUND, "%s: the univels, a .uv or .uv.gz file beside it, are missing", name);
    count_bytes(folder, data, summary);
    return true;
}

static bool refuse(const char *path, enum part_format format, struct error *err)
{
    if (format == PART_ABSENT)
        return error_set(err, ERROR_NOT_FOUND, "%s: there is no such file in the plan's folder", path);
    return error_set(err, ERROR_UNSUPPORTED, "%s: %s: not read by this version", path, part_format_word(format));
}

static bool check_image(const struct folder *folder, const struct plan_file_image *image, struct plan_summary *summary,
                        struct error *err)
{
    enum part_format format = part_format_of(folder, image->path);
    if (format == PART_NIFTI)
        return check_nifti(folder, image->path, summary, err);
    if (format == PART_NRRD)
        return check_nrrd(folder, image->path, summary, NULL, err);
    return format == PART_QSH || refuse(image->path, format, err);
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
        int stack = plan_dicom_stack(parts->dicom, image->path);
        count_bytes(folder, image->path, summary);
        n_good += stack >= 0 || check_image(folder, image, summary, err->text[0] ? NULL : err);
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
        enum part_format format = part_format_of(folder, region->path);
        struct error *why = err->text[0] ? NULL : err;
        bool is_good = true;
        count_bytes(folder, region->path, summary);
        if (format == PART_UVH) {
            is_good = check_univels(folder, region->path, summary, &n_regions, why);
        } else if (format == PART_DICOM) {
            size_t n = count_objects(folder, parts->dicom, DICOM_KIND_STRUCT, region->path, summary) +
                       count_objects(folder, parts->dicom, DICOM_KIND_SEGMENTATION, region->path, summary);
            n_regions += region->name[0] && n > 1 ? 1 : n;
        } else if (format != PART_NIFTI && format != PART_NRRD) {
            is_good = refuse(region->path, format, why);
        } else {
            size_t n = count_names(folder, region->names), n_segments = 0;
            if (format == PART_NIFTI)
                is_good = check_nifti(folder, region->path, summary, why);
            else
                is_good = check_nrrd(folder, region->path, summary, &n_segments, why);
            if (n == 0 && !region->name[0])
                n = n_segments;
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
        enum part_format first = part_format_of(folder, dose->components[0].path);
        bool is_read = true;
        size_t n_more = 0; /* a file of SERA holds several components */
        if (dose->n_components == 1 && first == PART_DICOM) {
            n_objects += count_objects(folder, parts->dicom, DICOM_KIND_DOSE, dose->components[0].path, summary);
            continue;
        }
        for (size_t c = 0; c < dose->n_components; c++) {
            count_bytes(folder, dose->components[c].path, summary);
            enum part_format format = part_format_of(folder, dose->components[c].path);
            is_read = is_read && (format == PART_NIFTI || format == PART_NRRD || part_is_sera_dose(format) ||
                                  format == PART_DICOM);
            if (part_is_sera_dose(format) && dose->components[c].quantity == DOSE_TOTAL)
                n_more += (format == PART_SERA_RST ? RST_N_DOSES : CHD_N_COLUMNS) - dose->n_components;
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

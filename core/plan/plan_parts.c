#include "core/plan/plan_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/gzip.h"
#include "core/formats/nifti.h"
#include "core/formats/sera_rst.h"
#include "core/formats/text.h"
#include "core/plan/plan_nrrd.h"

static bool is_dicom_file(const struct folder *folder, const char *name)
{
    struct bytes head;
    if (!folder_read(folder, name, UINT64_MAX, 132, &head, NULL))
        return false;
    bool is_dicom = head.size == 132 && memcmp(head.data + 128, "DICM", 4) == 0;
    bytes_free(&head);
    return is_dicom;
}

enum part_format part_format_of(const struct folder *folder, const char *name)
{
    static const struct {
        const char *ending;
        enum part_format format;
    } endings[] = { { ".nii", PART_NIFTI },     { ".nii.gz", PART_NIFTI },    { ".uvh", PART_UVH },        { ".qim", PART_QSH },
                    { ".qim.gz", PART_QSH },    { ".qhd", PART_QSH },         { ".pp", PART_PP },          { ".dcm", PART_DICOM },
                    { ".nrrd", PART_NRRD },     { ".nhdr", PART_NRRD },       { ".rst", PART_SERA_RST },  { ".rst.gz", PART_SERA_RST },
                    { ".rstb", PART_SERA_RST }, { ".rstb.gz", PART_SERA_RST }, { ".chd", PART_SERA_DOSE } };
    enum folder_kind kind = folder_look(folder, name, NULL);
    if (kind == FOLDER_ABSENT)
        return PART_ABSENT;
    if (kind == FOLDER_DIRECTORY)
        return PART_DICOM;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (text_has_ending(name, endings[i].ending))
            return endings[i].format;
    return is_dicom_file(folder, name) ? PART_DICOM : PART_UNKNOWN;
}

const char *part_format_word(enum part_format format)
{
    switch (format) {
    case PART_ABSENT: return "a file that is not there";
    case PART_NIFTI: return "NIfTI";
    case PART_UVH: return "SERA univels";
    case PART_QSH: return "SERA image";
    case PART_PP: return "SERA tracks";
    case PART_DICOM: return "DICOM";
    case PART_NRRD: return "NRRD";
    case PART_SERA_RST: return "SERA dose";
    case PART_SERA_DOSE: return "SERA dose contours";
    case PART_UNKNOWN: break;
    }
    return "an unknown format";
}

/* Length of name without the last ending. */
static size_t stem_length(const char *name)
{
    const char *dot = strrchr(name, '.'), *slash = strrchr(name, '/');
    return dot && (!slash || dot > slash) ? (size_t)(dot - name) : strlen(name);
}

bool part_find_data(const struct folder *folder, const char *header, const char *ending, char data[FOLDER_NAME_SIZE])
{
    static const char *const packings[] = { ".gz", "" };
    for (int i = 0; i < 2; i++) {
        int n = snprintf(data, FOLDER_NAME_SIZE, "%.*s%s%s", (int)stem_length(header), header, ending, packings[i]);
        if (n > 0 && n < FOLDER_NAME_SIZE && folder_look(folder, data, NULL) == FOLDER_FILE)
            return true;
    }
    return false;
}

static bool nifti_is_whole(const struct folder *folder, const char *name)
{
    struct bytes head;
    struct nifti_header header;
    if (!folder_read(folder, name, UINT64_MAX, 1 << 16, &head, NULL))
        return false;
    bool is_read = nifti_peek(&head, name, &header, NULL, NULL);
    bytes_free(&head);
    return is_read && header.type != RAW_F32 && header.type != RAW_F64;
}

static bool nrrd_is_whole(const struct folder *folder, const char *name, bool *has_segments)
{
    struct nrrd_header header;
    bool is_read = plan_nrrd_peek(folder, name, &header, NULL);
    *has_segments = is_read && header.n_segments > 0;
    nrrd_header_finish(&header);
    return is_read && header.type != RAW_F32 && header.type != RAW_F64;
}

/* A file whose voxels are whole numbers and whose name speaks of labels, or that names segments itself. */
static bool is_label_map(const struct folder *folder, const char *name, enum part_format format)
{
    bool has_segments = false;
    if (!(format == PART_NIFTI ? nifti_is_whole(folder, name) : nrrd_is_whole(folder, name, &has_segments)))
        return false;
    char low[FOLDER_NAME_SIZE];
    size_t n = strlen(name);
    for (size_t i = 0; i <= n; i++)
        low[i] = name[i] >= 'A' && name[i] <= 'Z' ? (char)(name[i] - 'A' + 'a') : name[i];
    return has_segments || strstr(low, "label") || strstr(low, "seg") || strstr(low, "univel") || strstr(low, "mask");
}

static bool is_rst(const struct folder *folder, const char *name)
{
    struct bytes head;
    uint8_t text[RST_HEAD_BYTES];
    struct rst_header header;
    if (!folder_read(folder, name, UINT64_MAX, sizeof text, &head, NULL))
        return false;
    size_t n = head.size;
    if (gzip_is(head.data, head.size))
        n = gzip_head(head.data, head.size, text, sizeof text);
    else
        memcpy(text, head.data, n);
    bytes_free(&head);
    return rst_parse_header(text, n, name, &header, NULL);
}

static void set_name(char *out, size_t size, const char *name)
{
    text_clean(name, out, size);
}

static void recognise_file(const struct folder *folder, const char *name, struct plan_file *file, struct report *report,
                           size_t *n_foreign)
{
    char data[FOLDER_NAME_SIZE];
    enum part_format format = part_format_of(folder, name);
    switch (format) {
    case PART_NIFTI:
    case PART_NRRD:
        if (is_label_map(folder, name, format)) {
            if (file->n_regions < PLAN_FILE_MAX_PARTS)
                set_name(file->regions[file->n_regions++].path, FOLDER_NAME_SIZE, name);
        } else if (file->n_images < PLAN_MAX_IMAGES) {
            set_name(file->images[file->n_images++].path, FOLDER_NAME_SIZE, name);
        } else {
            report_add(report, REPORT_WARNING, "plan.ignored-file", name, "More than %d images; this one was not read.", PLAN_MAX_IMAGES);
        }
        break;
    case PART_UVH:
        if (!part_find_data(folder, name, ".uv", data))
            report_add(report, REPORT_NOTE, "plan.ignored-file", name, "There is no file of univels beside it.");
        else if (file->n_regions < PLAN_FILE_MAX_PARTS)
            set_name(file->regions[file->n_regions++].path, FOLDER_NAME_SIZE, name);
        break;
    case PART_QSH:
        if (!text_has_ending(name, ".qhd"))
            break;
        if (!part_find_data(folder, name, ".qim", data)) {
            report_add(report, REPORT_NOTE, "plan.ignored-file", name, "There is no file of pixels beside it.");
        } else if (file->n_images < PLAN_MAX_IMAGES) {
            struct plan_file_image *image = &file->images[file->n_images++];
            set_name(image->path, sizeof image->path, data);
            set_name(image->header, sizeof image->header, name);
        }
        break;
    case PART_PP:
        if (file->n_tracks < PLAN_FILE_MAX_TRACKS)
            set_name(file->tracks[file->n_tracks++].path, FOLDER_NAME_SIZE, name);
        break;
    case PART_SERA_RST:
        if (!is_rst(folder, name))
            report_add(report, REPORT_NOTE, "plan.ignored-file", name, "Named like a dose of SERA, but its header is another one's.");
        else if (file->n_doses < PLAN_MAX_DOSES) {
            struct plan_file_dose *dose = &file->doses[file->n_doses++];
            set_name(dose->components[0].path, FOLDER_NAME_SIZE, name);
            dose->components[0].quantity = DOSE_TOTAL;
            dose->n_components = 1;
        }
        break;
    case PART_SERA_DOSE:
        report_add(report, REPORT_NOTE, "plan.ignored-file", name, "Dose contours of SERA; this version does not read them.");
        break;
    case PART_DICOM: (*n_foreign)++; break;
    default:
        if (text_has_ending(name, ".info") && !file->hierarchy[0])
            set_name(file->hierarchy, sizeof file->hierarchy, name);
    }
}

void plan_folder_name(const char *path, char *out, size_t size)
{
    size_t end = strlen(path), from;
    while (end > 1 && path[end - 1] == '/')
        end--;
    for (from = end; from > 0 && path[from - 1] != '/'; from--) {
    }
    char name[256];
    snprintf(name, sizeof name, "%.*s", (int)(end - from < 255 ? end - from : 255), path + from);
    set_name(out, size, name);
}

/* Why nothing was recognised, as far as the names tell. */
static void explain_nothing(const struct folder *folder, char *const *names, size_t n_names, struct error *err)
{
    static const char *const archives[] = { ".tar", ".tar.gz", ".tgz", ".tar.xz", ".zip" };
    for (size_t i = 0; i < n_names; i++) {
        for (size_t a = 0; a < sizeof archives / sizeof archives[0]; a++)
            if (text_has_ending(names[i], archives[a])) {
                error_set(err, ERROR_UNSUPPORTED, "%s is an archive: unpack it first; nothing else in the folder is a plan", names[i]);
                return;
            }
        char inner[FOLDER_NAME_SIZE];
        int n = snprintf(inner, sizeof inner, "%s/plan.json", names[i]);
        if (n > 0 && n < (int)sizeof inner && folder_look(folder, inner, NULL) == FOLDER_FILE) {
            error_set(err, ERROR_NOT_FOUND, "no plan itself, but the folder %s in it is one", names[i]);
            return;
        }
    }
    error_set(err, ERROR_NOT_FOUND, "no plan.json, and no file in the folder is an image or regions that this version reads");
}

static struct plan_file *recognise(const struct folder *folder, struct report *report, struct error *err)
{
    char **names;
    size_t n_names, n_foreign = 0;
    if (!folder_list(folder, &names, &n_names, err))
        return NULL;
    struct plan_file *file = mem_new(sizeof *file);
    file->regions = mem_new(PLAN_FILE_MAX_PARTS * sizeof *file->regions);
    for (size_t i = 0; i < n_names; i++) {
        if (folder_look(folder, names[i], NULL) == FOLDER_FILE)
            recognise_file(folder, names[i], file, report, &n_foreign);
    }
    plan_folder_name(folder->path, file->name, sizeof file->name);
    if (file->n_images + file->n_regions == 0) {
        if (n_foreign > 0)
            error_set(err, ERROR_UNSUPPORTED, "%zu DICOM files: DICOM is not read by this version", n_foreign);
        else
            explain_nothing(folder, names, n_names, err);
        folder_free_names(names, n_names);
        plan_file_destroy(file);
        return NULL;
    }
    folder_free_names(names, n_names);
    report_add(report, REPORT_NOTE, "plan.recognised", "", "The folder has no plan.json; %zu images and %zu files of regions were found "
               "by their names.", file->n_images, file->n_regions);
    return file;
}

struct plan_file *plan_describe(const struct folder *folder, struct report *report, struct error *err)
{
    if (folder_look(folder, "plan.json", NULL) == FOLDER_ABSENT)
        return recognise(folder, report, err);
    struct bytes text;
    if (!folder_read(folder, "plan.json", PLAN_FILE_MAX_BYTES, UINT64_MAX, &text, err))
        return NULL;
    struct plan_file *file = plan_file_parse(text.data, text.size, report, err);
    bytes_free(&text);
    if (file && !file->name[0])
        plan_folder_name(folder->path, file->name, sizeof file->name);
    return file;
}

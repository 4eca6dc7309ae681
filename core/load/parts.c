#include "core/load/parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/formats/text.h"
#include "core/load/dicom_parts.h"
#include "core/load/nifti_parts.h"

static bool is_dicom_file(const struct folder *folder, const char *name)
{
    struct bytes head;
    if (!folder_read(folder, name, UINT64_MAX, 140, &head, NULL))
        return false;
    bool is_dicom = dicom_looks_like(head.data, head.size);
    bytes_free(&head);
    return is_dicom;
}

enum part_format part_format_of(const struct folder *folder, const char *name)
{
    static const struct {
        const char *ending;
        enum part_format format;
    } endings[] = { { ".nii", PART_NIFTI },
                    { ".nii.gz", PART_NIFTI },
                    { ".uvh", PART_UVH },
                    { ".qim", PART_QSH },
                    { ".qim.gz", PART_QSH },
                    { ".qim.sz", PART_QSH },
                    { ".qhd", PART_QSH },
                    { ".pp", PART_PP },
                    { ".dcm", PART_DICOM },
                    { ".nrrd", PART_NRRD },
                    { ".nhdr", PART_NRRD },
                    { ".rst", PART_SERA_RST },
                    { ".rst.gz", PART_SERA_RST },
                    { ".rstb", PART_SERA_RST },
                    { ".rstb.gz", PART_SERA_RST },
                    { ".chd", PART_SERA_DOSE },
                    { ".dose", PART_SERA_CURVE },
                    { ".dose.gz", PART_SERA_CURVE },
                    { ".rsc", PART_SERA_PREFERENCES },
                    { ".cmap", PART_SERA_PREFERENCES } };
    enum folder_kind kind = folder_look(folder, name, NULL);
    if (kind == FOLDER_ABSENT)
        return PART_ABSENT;
    if (kind == FOLDER_DIRECTORY)
        return PART_DICOM;
    if (plan_nifti_is_pair(name)) /* slices are called .img, too */
        return is_dicom_file(folder, name) ? PART_DICOM : PART_NIFTI;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (text_has_ending(name, endings[i].ending))
            return endings[i].format;
    if (text_equal(part_base_name(name), "body_data.txt"))
        return PART_SERA_PREFERENCES;
    return is_dicom_file(folder, name) ? PART_DICOM : PART_UNKNOWN;
}

bool part_is_sera_dose(enum part_format format)
{
    return format == PART_SERA_RST || format == PART_SERA_DOSE;
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
    case PART_SERA_CURVE: return "SERA dose over depth";
    case PART_SERA_PREFERENCES: return "SERA preferences";
    case PART_UNKNOWN: break;
    }
    return "an unknown format";
}

const char *part_base_name(const char *name)
{
    const char *slash = strrchr(name, '/');
    return slash ? slash + 1 : name;
}

bool part_is_spoken_of(const char *name, const char *const *words, size_t n_words)
{
    char low[FOLDER_NAME_SIZE];
    size_t n = strlen(name);
    n = n < sizeof low ? n : sizeof low - 1;
    for (size_t i = 0; i < n; i++)
        low[i] = name[i] >= 'A' && name[i] <= 'Z' ? (char)(name[i] - 'A' + 'a') : name[i];
    low[n] = 0;
    for (size_t i = 0; i < n_words; i++)
        if (strstr(low, words[i]))
            return true;
    return false;
}

/* Length of name without the last ending. */
static size_t stem_length(const char *name)
{
    const char *dot = strrchr(name, '.'), *slash = strrchr(name, '/');
    return dot && (!slash || dot > slash) ? (size_t)(dot - name) : strlen(name);
}

bool part_find_data(const struct folder *folder, const char *header, const char *ending, char data[FOLDER_NAME_SIZE])
{
    static const char *const packings[] = { ".gz", ".sz", "" };
    for (int i = 0; i < 3; i++) {
        int n = snprintf(data, FOLDER_NAME_SIZE, "%.*s%s%s", (int)stem_length(header), header, ending, packings[i]);
        if (n > 0 && n < FOLDER_NAME_SIZE && folder_look(folder, data, NULL) == FOLDER_FILE)
            return true;
    }
    return false;
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
    text_clean(name, out, size);
}

bool plan_describe(const struct folder *folder, const struct dicom_progress *progress, struct plan_parts *parts,
                   struct report *report, struct error *err)
{
    *parts = (struct plan_parts){ 0 };
    if (folder_look(folder, "plan.json", NULL) == FOLDER_ABSENT)
        return plan_recognise(folder, progress, parts, report, err);
    struct bytes text;
    if (!folder_read(folder, "plan.json", PLAN_FILE_MAX_BYTES, UINT64_MAX, &text, err))
        return false;
    parts->file = plan_file_parse(text.data, text.size, report, err);
    bytes_free(&text);
    if (!parts->file)
        return false;
    if (!parts->file->name[0])
        plan_folder_name(folder->path, parts->file->name, sizeof parts->file->name);
    return plan_dicom_scan_named(folder, parts, progress, report, err);
}

void plan_parts_finish(struct plan_parts *parts)
{
    plan_file_destroy(parts->file);
    dicom_index_destroy(parts->dicom);
    *parts = (struct plan_parts){ 0 };
}

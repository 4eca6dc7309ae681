/* Recognises the format of a file in a plan's folder. */
#include "core/load/part_format.h"

#include "core/formats/dicom/dicom_index.h"
#include "core/formats/text.h"
#include "core/formats/track_csv.h"
#include "core/load/nifti_parts.h"
#include "core/load/part_names.h"

static bool is_dicom_file(const struct folder *folder, const char *name, struct error *err)
{
    uint8_t head[140];
    struct folder_part part;
    if (!folder_open_part(folder, name, &part, err))
        return false;
    size_t n = part.n_bytes < sizeof head ? (size_t)part.n_bytes : sizeof head;
    bool is_read = folder_read_part(&part, name, 0, head, n, err);
    folder_close_part(&part);
    return !is_read || dicom_looks_like(head, n); /* the scan reports a file that the disk does not give */
}

static bool is_track_table(const struct folder *folder, const char *name, struct error *err)
{
    uint8_t head[1024];
    struct folder_part part;
    if (!text_has_ending(name, ".csv") || !folder_open_part(folder, name, &part, err))
        return false;
    size_t n = part.n_bytes < sizeof head ? (size_t)part.n_bytes : sizeof head;
    bool is_read = folder_read_part(&part, name, 0, head, n, err);
    folder_close_part(&part);
    return is_read && track_csv_looks_like(head, n);
}

enum part_format part_format_read(const struct folder *folder, const char *name, struct error *err)
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
    if (plan_nifti_is_pair(name)) /* DICOM slices may end in .img, too */
        return is_dicom_file(folder, name, err) ? PART_DICOM : PART_NIFTI;
    for (size_t i = 0; i < sizeof endings / sizeof endings[0]; i++)
        if (text_has_ending(name, endings[i].ending))
            return endings[i].format;
    if (text_equal(part_base_name(name), "body_data.txt"))
        return PART_SERA_PREFERENCES;
    if (is_track_table(folder, name, err))
        return PART_TRACK_CSV;
    return is_dicom_file(folder, name, err) ? PART_DICOM : PART_UNKNOWN;
}

enum part_format part_format_of(const struct folder *folder, const char *name)
{
    return part_format_read(folder, name, NULL);
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
    case PART_TRACK_CSV: return "a table of tracks";
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

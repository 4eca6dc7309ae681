#pragma once
/* Inside core/load: what a folder holds, as plan.json says it or as its files suggest, before any voxel is read. */
#include "core/formats/dicom/dicom_index.h"
#include "core/formats/plan_json.h"
#include "core/plan/plan.h"

enum part_format {
    PART_ABSENT,
    PART_NIFTI,
    PART_UVH,
    PART_QSH, /* .qim with its .qhd */
    PART_PP,
    PART_DICOM,
    PART_NRRD,
    PART_SERA_RST,         /* dose on a mesh */
    PART_SERA_DOSE,        /* .chd: dose on planes */
    PART_SERA_CURVE,       /* .dose: depth and radius along a beam */
    PART_SERA_PREFERENCES, /* .rsc, .cmap, body_data.txt */
    PART_UNKNOWN
};
/* By the name's ending; a folder and a file without a known ending are looked into for DICOM. */
enum part_format part_format_of(const struct folder *folder, const char *name);
bool part_is_sera_dose(enum part_format format);       /* of several quantities */
const char *part_format_word(enum part_format format); /* "NIfTI", "DICOM", ... */

/* The name behind the last slash, and whether any of the words, in lower case, is in a name. */
const char *part_base_name(const char *name);
bool part_is_spoken_of(const char *name, const char *const *words, size_t n_words);

/* What belongs to the plan. */
struct plan_parts {
    struct plan_file *file;
    struct dicom_index *dicom; /* heads of the DICOM files among the parts; NULL without one */
    bool is_recognised;        /* no plan.json: nobody said what the parts are */
    bool is_all_dicom;         /* no plan.json: all doses and treatment plans of the index are parts, too */
};
void plan_parts_finish(struct plan_parts *parts);

/* plan.json when it is there, else the files that can be told by names and contents. The caller finishes parts, after a
 * failure too. errors as plan_load */
NODISCARD bool plan_describe(const struct folder *folder, const struct dicom_progress *progress,
                             struct plan_parts *parts, struct report *report, struct error *err);

/* What the files of a folder without a plan.json are, those in folders below included (but folders that are plans of
 * their own). errors as plan_load */
NODISCARD bool plan_recognise(const struct folder *folder, const struct dicom_progress *progress,
                              struct plan_parts *parts, struct report *report, struct error *err);

/* The file of univels beside a .uvh, or of pixels beside a .qhd: stem + ".uv.gz", ".uv.sz", ".uv"; a packed one wins.
 * false when there is none. */
bool part_find_data(const struct folder *folder, const char *header, const char *ending, char data[FOLDER_NAME_SIZE]);

/* The last part of a path, for a plan that has no name of its own. */
void plan_folder_name(const char *path, char *out, size_t size);

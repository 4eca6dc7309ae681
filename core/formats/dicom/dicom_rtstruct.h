#pragma once
/* RT Structure Set: named regions as contours. Knows nothing of voxels but for what it says about their making. */
#include "core/formats/dicom/dicom_file.h"
#include "core/region/contour.h"
#include "core/report/report.h"

enum {
    RTSTRUCT_MAX_ROIS = REGION_MAX, /* more are refused */
    RTSTRUCT_MAX_POINTS = 10000000, /* of a file; more are refused */
    RTSTRUCT_MAX_CONTOURS = 1000000 /* of a file; more are refused */
};

struct rtstruct_roi {
    int64_t number;
    char name[REGION_NAME_SIZE]; /* UTF-8; "ROI 7" where the file gives none */
    char kind[20]; /* RT ROI Interpreted Type: "EXTERNAL", "GTV", "ORGAN", ...; "" when the file does not say */
    bool has_color;
    uint8_t rgb[3];
    char frame_uid[DICOM_UID_SIZE]; /* "" when the file does not say */
    struct contour_set contours;    /* closed ones, at least one */
};

struct rtstruct {
    char label[REGION_NAME_SIZE];
    char uid[DICOM_UID_SIZE];        /* of this object */
    char series_uid[DICOM_UID_SIZE]; /* of the image series it was drawn on; "" when the file does not say */
    struct rtstruct_roi *rois; /* those with something to fill, in the order of the file; others are in the report */
    size_t n_rois;
};

/* Joins names, contours and observations by ROI number. Regions without a closed contour are reported and left out;
 * POINT and OPEN contours are reported; a file without any region to fill is read, with n_rois 0. where   the file's
 * name, for report and errors errors  ERROR_UNSUPPORTED another kind of object; ERROR_FORMAT no ROI sequence;
 * ERROR_LIMIT; ERROR_MEMORY */
NODISCARD struct rtstruct *rtstruct_read(const struct dicom_file *file, const char *where, struct report *report,
                                         struct error *err);
void rtstruct_destroy(struct rtstruct *set);

/* The regions are shown on the image whatever their frame of reference says; what it says against that is reported.
 * image_frame_uid "" or NULL: unknown. */
void rtstruct_check_frame(const struct rtstruct *set, const char *image_frame_uid, const char *where,
                          struct report *report);
/* Which regions reach beyond the image they were filled on. only: the one region that is wanted, by its name; "" all of
 * them. */
void rtstruct_report_reach(const struct rtstruct *set, const struct contour_choice *choices, const char *only,
                           const char *image, const char *where, struct report *report);
/* How the region was filled: the method with its figures, and everything that was left out or is doubtful. */
void rtstruct_report_fill(const struct rtstruct_roi *roi, const struct contour_choice *choice,
                          const struct contour_facts *facts, const char *where, struct report *report);

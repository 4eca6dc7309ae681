#pragma once
/* Reads RT Structure Set objects: named regions as contours. Does not fill them; it only words the report about
 * filling. */
#include "core/formats/dicom/dicom_file.h"
#include "core/region/contour/contour.h"
#include "core/report/report.h"

enum {
    RTSTRUCT_MAX_ROIS = REGION_MAX, /* with contours; further ones are reported and left out */
    RTSTRUCT_MAX_DESCRIBED = 8192,  /* with or without contours; likewise */
    RTSTRUCT_MAX_POINTS = 10000000, /* per file; a region that would exceed it is reported and left out */
    RTSTRUCT_MAX_CONTOURS = 1000000 /* per file; likewise */
};

struct rtstruct_roi {
    int64_t number;
    char name[REGION_NAME_SIZE]; /* UTF-8; "ROI 7" if not given */
    char kind[20];               /* RT ROI Interpreted Type: "EXTERNAL", "GTV", "ORGAN", ...; "" if not given */
    bool has_color;
    uint8_t rgb[3];
    char frame_uid[DICOM_UID_SIZE]; /* "" if not given */
    struct contour_set contours;    /* the closed contours; at least one */
};

struct rtstruct {
    char label[REGION_NAME_SIZE];
    char uid[DICOM_UID_SIZE];        /* SOP Instance UID */
    char series_uid[DICOM_UID_SIZE]; /* image series that it was drawn on; "" if not given */
    struct rtstruct_roi *rois;       /* in file order, only those with a closed contour; the others are in the report */
    size_t n_rois;
};

/* Joins names, contours and observations by ROI number. Regions without a closed contour are reported and left out;
 * POINT and OPEN contours are reported; a file without any region to fill has n_rois 0.
 *
 *   where   name of the file, for report and errors
 *   errors  ERROR_UNSUPPORTED another kind of object; ERROR_FORMAT no ROI sequence; ERROR_MEMORY
 *   thread  any
 *   source  DICOM PS3.3 C.8.8.5 (structure set) */
NODISCARD struct rtstruct *rtstruct_read(const struct dicom_file *file, const char *where, struct report *report,
                                         struct error *err);
void rtstruct_destroy(struct rtstruct *set);

/* Reports regions whose frame of reference is not the image's. They are shown on the image all the same.
 * image_frame_uid "" or NULL: unknown. */
void rtstruct_check_frame(const struct rtstruct *set, const char *image_frame_uid, const char *where,
                          struct report *report);
/* Reports regions that reach beyond the image they were filled on. only: the name of a single region to look at; "" for
 * all. */
void rtstruct_report_reach(const struct rtstruct *set, const struct contour_choice *choices, const char *only,
                           const char *image, const char *where, struct report *report);
/* Reports how a region was filled: the method with its figures, and everything that was left out or is doubtful. */
void rtstruct_report_fill(const struct rtstruct_roi *roi, const struct contour_choice *choice,
                          const struct contour_facts *facts, const char *where, struct report *report);

#pragma once
/* Reads RT Plan objects: beams as lines in the patient, and the prescription. */
#include "core/beam/beam.h"
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

enum {
    RTPLAN_MAX_BEAMS = 64,           /* further ones are reported and left out */
    RTPLAN_MAX_CONTROL_POINTS = 5000 /* per beam; more are an error */
};

struct rtplan {
    char label[65], name[65], description[129], prescription[257];
    char uid[DICOM_UID_SIZE], frame_uid[DICOM_UID_SIZE], struct_uid[DICOM_UID_SIZE];
    char intent[17], geometry[17];
    char date[9], time[15];            /* RT Plan Date, YYYYMMDD, and Time; "" if not given */
    char approval[17];                 /* Approval Status: "APPROVED", "UNAPPROVED", "REJECTED"; "" if not given */
    char review_date[9], reviewer[65]; /* "" if not given */
    int64_t n_fractions;               /* 0 if not given */
    double target_dose_gy;             /* the largest target prescription; NaN if there is none */
    struct beam *beams;
    size_t n_beams;
    /* Numbers of all beams for treatment in the file's order, also of those that cannot be placed. 0: none, more than
     * RTPLAN_MAX_BEAMS, or two of one number. */
    int64_t treating[RTPLAN_MAX_BEAMS];
    size_t n_treating;
};

/* Reads a plan for photons, electrons or ions. A beam that cannot be placed (no isocentre, no control point, a
 * radiation source inside the patient) is reported and left out; a plan without beams has n_beams 0.
 *
 *   where   name of the file, for report and errors
 *   errors  ERROR_UNSUPPORTED another kind of object; ERROR_LIMIT; ERROR_MEMORY
 *   thread  any
 *   source  DICOM PS3.3 C.8.8.9 (RT plan) */
NODISCARD struct rtplan *rtplan_read(const struct dicom_file *file, const char *where, struct report *report,
                                     struct error *err);
void rtplan_destroy(struct rtplan *plan);
const char *rtplan_beam_name(void *plan, int64_t number); /* an rtdose_beam_name; plan is a struct rtplan */

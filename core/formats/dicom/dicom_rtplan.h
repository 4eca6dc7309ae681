#pragma once
/* RT Plan: beams as lines in the patient, and what the plan prescribes. */
#include "core/beam/beam.h"
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

enum {
    RTPLAN_MAX_BEAMS = 64,            /* further ones are reported and left out */
    RTPLAN_MAX_CONTROL_POINTS = 5000, /* of a beam; more are refused */
    RTPLAN_MAX_LEAVES = 400           /* positions of one device; more are refused */
};

struct rtplan {
    char label[65], name[65], description[129], prescription[257];
    char uid[DICOM_UID_SIZE], frame_uid[DICOM_UID_SIZE], struct_uid[DICOM_UID_SIZE];
    char intent[17], geometry[17];
    int64_t n_fractions;   /* 0 when the file does not say */
    double target_dose_gy; /* the largest target prescription; not-a-number without one */
    struct beam *beams;
    size_t n_beams;
};

/*   where   the file's name, for report and errors
 *   errors  ERROR_UNSUPPORTED another kind of object; ERROR_LIMIT; ERROR_MEMORY. A beam that cannot be placed (no
 * isocentre, no control point, a radiation source in the patient) is reported and left out; a plan without beams has
 * n_beams 0 */
NODISCARD struct rtplan *rtplan_read(const struct dicom_file *file, const char *where, struct report *report,
                                     struct error *err);
void rtplan_destroy(struct rtplan *plan);
const char *rtplan_beam_name(void *plan, int64_t number); /* an rtdose_beam_name */

#pragma once
/* RT Dose: one object is one grid of values; several may be the components of one dose. Never adds doses. */
#include "core/dose/dose.h"
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

enum {
    RTDOSE_MAX_BEAMS = 64,   /* that one object may refer to; further ones are not kept */
    RTDOSE_MAX_OBJECTS = 256 /* that rtdose_group takes */
};

struct rtdose {
    struct volume *values; /* U16 or I16 with the scaling as its slope, else F32; on its own uniform grid */
    char type[17];         /* "PHYSICAL", "EFFECTIVE", "ERROR", ... as the file says it */
    char summation[17];    /* "PLAN", "FRACTION", "BEAM", ... */
    char units[17];        /* "GY", "RELATIVE", ... */
    char description[65], comment[65];
    char uid[DICOM_UID_SIZE], frame_uid[DICOM_UID_SIZE], plan_uid[DICOM_UID_SIZE];
    bool has_frame; /* by rtdose_check_frame */
    enum dose_frame frame;
    bool is_component; /* description or comment says which, or a word in them suggests it */
    bool is_stated;    /* by the grammar of rtdose_component_from_text, not by a word that happens to be there */
    enum dose_quantity quantity; /* DOSE_TOTAL unless is_component */
    double ppm; /* boron-10 concentration the values hold for; not-a-number when the file does not say */
    bool is_all_zero;
    int64_t beams[RTDOSE_MAX_BEAMS]; /* numbers of the plan's beams it refers to */
    size_t n_beams;
};

/* Values and geometry of one object. Offsets of the frames may be relative or absolute, ascending or descending; where
 * they are uneven the values are interpolated linearly onto even planes of the smallest distance, and the report says
 * so. errors  ERROR_UNSUPPORTED another kind of object, 8-bit pixels, an encoding; ERROR_FORMAT; ERROR_RANGE geometry
 * that is singular or not finite, offsets that repeat or turn; ERROR_LIMIT; ERROR_MEMORY; dose is untouched then */
NODISCARD bool rtdose_read(const struct dicom_file *file, const char *where, struct rtdose *dose, struct report *report,
                           struct error *err);
void rtdose_finish(struct rtdose *dose);

/* The component words of a description: the grammar "BNCT:boron;ppm=1" (a quantity's word, fields behind ';' in any
 * order), else single words in English as planning systems write them ("B-10", "Boron dose", "fast neutron", "proton
 * recoil", "photon", "N-14", "total", "15 ppm"). false when no word or words of two components are found. ppm is
 * not-a-number when not given. */
bool rtdose_component_from_text(const char *text, enum dose_quantity *quantity, double *ppm, bool *is_stated);

/* Which plan's beam a number is, for naming; NULL when unknown. */
typedef const char *(*rtdose_beam_name)(void *context, int64_t number);

/* From objects to doses. Objects whose descriptions state components, or by their words suggest at least two different
 * ones, and that agree in plan, type, summation, units, frame of reference and beams become one dose; any other object
 * a dose of its own, named by description and beam. Nothing is ever added. Boron for a known ppm becomes boron per ppm.
 * All-zero objects are left out. Takes the volumes of the objects. doses   room for most; id holds a name for people,
 * unique, not yet an id; unit "Gy", "relative" or ""; per from the summation type; EFFECTIVE dose is
 * DOSE_WEIGHTED_TOTAL report  what was joined, left out, is not the sum of its beams returns how many */
size_t rtdose_group(struct rtdose *objects, size_t n_objects, rtdose_beam_name beam_name, void *context,
                    const char *where, struct dose *doses, size_t most, struct report *report);
/* As rtstruct_check_frame. */
void rtdose_check_frame(struct rtdose *dose, const char *image_frame_uid, const char *where, struct report *report);

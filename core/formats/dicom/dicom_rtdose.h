#pragma once
/* Reads RT Dose objects, and groups several into the components of one dose. One object is one grid of values. Never
 * adds doses. */
#include "core/dose/dose.h"
#include "core/formats/dicom/dicom_file.h"
#include "core/report/report.h"

enum {
    RTDOSE_MAX_BEAMS = 64,   /* referenced by one object; further ones are dropped */
    RTDOSE_MAX_OBJECTS = 256 /* most objects that rtdose_group takes */
};

struct rtdose {
    struct volume *values; /* on its own uniform grid: U16 or I16 with the grid scaling as slope, F32 for 32-bit pixels
                              and interpolated planes */
    char type[17];         /* DoseType: "PHYSICAL", "EFFECTIVE", "ERROR", ... as in the file */
    char summation[17];    /* DoseSummationType: "PLAN", "FRACTION", "BEAM", ... */
    char units[17];        /* DoseUnits: "GY", "RELATIVE", ... */
    char description[65], comment[65];
    char uid[DICOM_UID_SIZE], frame_uid[DICOM_UID_SIZE], plan_uid[DICOM_UID_SIZE];
    bool has_frame; /* frame is valid: set by rtdose_check_frame */
    enum dose_frame frame;
    bool is_component;           /* description or comment names a component, or a word in them suggests one */
    bool is_stated;              /* named by the grammar of rtdose_component_from_text, not by a word in free text */
    enum dose_quantity quantity; /* DOSE_TOTAL unless is_component */
    double ppm;                  /* boron-10 concentration that the values apply to; NaN if the file does not say */
    bool is_all_zero;
    int64_t beams[RTDOSE_MAX_BEAMS]; /* numbers of the plan's beams that the object refers to */
    size_t n_beams;
    char structs_uid[DICOM_UID_SIZE]; /* structure set of the stored histograms; "" if not given */
    struct dose_stated *stated;       /* [n_stated] of stored histograms, by ROI number; owned, as values; NULL: none */
    size_t n_stated;
    const char *where; /* borrowed: the file's name in the report; NULL: the group's */
};

/* Reads values and geometry of one object. Frame offsets may be relative or absolute, ascending or descending. If they
 * are uneven, the values are interpolated linearly onto even planes at the smallest distance, and the report says so.
 *
 *   dose    untouched on failure; rtdose_finish frees what it owns
 *   errors  ERROR_UNSUPPORTED another kind of object, 8-bit pixels, an encoding; ERROR_FORMAT; ERROR_RANGE geometry
 *           that is singular or not finite, offsets that repeat or change direction; ERROR_LIMIT; ERROR_MEMORY
 *   thread  any
 *   source  DICOM PS3.3 C.8.8.3 (RT Dose) */
NODISCARD bool rtdose_read(const struct dicom_file *file, const char *where, struct rtdose *dose, struct report *report,
                           struct error *err);
void rtdose_finish(struct rtdose *dose);

/* Finds the component that a description names. Two forms: the grammar "BNCT:boron;ppm=1" (the word of a quantity, then
 * fields separated by ';' in any order), or single English words as planning systems write them ("B-10", "Boron dose",
 * "fast neutron", "proton recoil", "photon", "N-14", "total", "15 ppm").
 *
 *   ppm        NaN when not given
 *   is_stated  true for the first form
 *   returns    false when no component is named, or words of two components are */
bool rtdose_component_from_text(const char *text, enum dose_quantity *quantity, double *ppm, bool *is_stated);

/* Gives the name of a beam of the plan by its number; NULL when unknown. */
typedef const char *(*rtdose_beam_name)(void *context, int64_t number);

/* Turns objects into doses. Objects become the components of one dose if they agree in plan, type, summation, units,
 * frame of reference and beams, and their descriptions state components, or suggest at least two different ones by
 * their words (dose_words.h): boron or nitrogen among them, and all on one grid. Every other object becomes a dose of
 * its own, named by description and beam. Nothing is ever added up. Boron for a known ppm is divided by it (boron per
 * ppm). All-zero objects are left out.
 *
 *   objects  consumed: their volumes move into the doses or are released
 *   from     NULL, or room for `most`: of each dose the index of its first object
 *   doses    room for `most`. id holds a unique name for people, not yet an id; unit is "Gy", "relative" or ""; per
 *            comes from the summation type; EFFECTIVE dose becomes DOSE_WEIGHTED_TOTAL
 *   report   what was combined or left out, and doses of single beams that no plan dose sums up
 *   returns  the number of doses */
size_t rtdose_group(struct rtdose *objects, size_t n_objects, rtdose_beam_name beam_name, void *context,
                    const char *where, struct dose *doses, size_t *from, size_t most, struct report *report);
/* Compares the frames of reference of dose and image, like rtstruct_check_frame, and sets dose->frame. */
void rtdose_check_frame(struct rtdose *dose, const char *image_frame_uid, const char *where, struct report *report);

#pragma once
/* Makes RT Plans with one beam, and beam limiting devices, for tests. */
#include "core/formats/dicom/dicom_rtplan.h"
#include "tests/unit/rt_files.h"

#define MADE_RTPLAN "1.2.840.10008.5.1.4.1.1.481.5" /* SOP class */

struct made_rtplan {
    const char *position; /* patient position of setup 2; NULL: no setups */
    const char *radiation;
    const char *sad, *iso, *gantry;
    bool is_setup;
    void (*devices)(struct made_dicom *made);
    void (*positions)(struct made_dicom *made, int point);
    int n_points;
    const char *gantries[4], *directions[4];
    const char *collimator, *table; /* at the first control point */
};

/* made: the caller's to finish */
void made_rtplan_put(struct made_dicom *made, const struct made_rtplan *plan);
/* Makes the plan and reads it; fails the test when it is refused. report may be NULL. */
struct rtplan *made_rtplan_read(const struct made_rtplan *plan, struct report *report);

/* Items of the sequences of beam limiting devices (300A,00B6) and of their positions (300A,011A), as DS. pairs (IS) and
 * boundaries may be NULL. */
void made_rt_device(struct made_dicom *made, const char *type, const char *pairs, const char *boundaries);
void made_rt_position(struct made_dicom *made, const char *type, const char *positions);

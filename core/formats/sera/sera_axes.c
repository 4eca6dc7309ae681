/* Turns SERA's patient axes into patient LPS. */
#include "core/formats/sera/sera_axes.h"

#include <math.h>

#include "core/formats/text.h"

/* A patient with the couch is not wider, along RL or PA; a whole-body scan is longer along IS only. */
static const double widest_patient_mm = 1000;
static const double smallest_patient_mm = 40;

bool sera_direction_from_word(const char *word, struct sera_direction *direction)
{
    static const char *const words[3][2] = { { "RL+", "RL-" }, { "PA+", "PA-" }, { "IS+", "IS-" } };
    for (int axis = 0; axis < 3; axis++)
        for (int minus = 0; minus < 2; minus++)
            if (text_equal(word, words[axis][minus])) {
                *direction = (struct sera_direction){ (enum sera_axis)axis, minus ? -1 : 1 };
                return true;
            }
    return false;
}

struct vec3 sera_lps_from_rpi(double rl, double pa, double is)
{
    return vec3(rl, -pa, is);
}

static double checked_unit(const struct sera_grid *sera, const char *name, struct report *report)
{
    double across = 0, largest = 0;
    if (sera->given_mm > 0) {
        if (sera->given_mm != sera->mm)
            report_add(report, REPORT_NOTE, "geometry.unit-given", name,
                       "The header's unit is %g mm, but the plan says that its numbers count %g mm, and that was used.",
                       sera->mm, sera->given_mm);
        return sera->given_mm;
    }
    for (int a = 0; a < 3; a++) {
        double extent = sera->size[a] * sera->step[a];
        largest = fmax(largest, extent);
        if (sera->along[a].axis != SERA_IS)
            across = fmax(across, extent);
    }
    if (sera->mm > 1 && across * sera->mm > widest_patient_mm) {
        report_add(report, REPORT_WARNING, "geometry.unit-assumed", name,
                   "The header's unit makes the patient %.2f m wide; its numbers were taken as millimetres.",
                   across * sera->mm / 1000);
        return 1;
    }
    if (largest * sera->mm < smallest_patient_mm)
        report_add(report, REPORT_WARNING, "geometry.unit-doubtful", name,
                   "The whole grid is %.1f mm at its longest; the numbers may be centimetres.", largest * sera->mm);
    return sera->mm;
}

bool sera_grid_resolve(const struct sera_grid *sera, const char *name, struct grid *grid, struct report *report,
                       struct error *err)
{
    static const char *const words[] = { "RL", "PA", "IS" };
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < a; b++)
            if (sera->along[a].axis == sera->along[b].axis)
                return error_set(err, ERROR_FORMAT, "%s: the axis %s is named for two of columns, rows and slices",
                                 name, words[sera->along[a].axis]);
    double mm = checked_unit(sera, name, report);
    struct affine lps;
    double origin[3] = { 0 };
    for (int a = 0; a < 3; a++) {
        enum sera_axis axis = sera->along[a].axis;
        double sign = sera->along[a].sign, step = sera->step[a] * mm;
        double low = sera->low[axis] * mm, high = sera->high[axis] * mm;
        double extent = sera->size[a] * step;
        if (fabs(extent - (high - low)) > 0.5 * step)
            report_add(
                report, REPORT_WARNING, "geometry.extent-differs", name,
                "%u univels of %.4g mm along %s are %.2f mm, but the faces are %.2f mm apart; the univel size was used.",
                sera->size[a], step, words[axis], extent, high - low);
        origin[axis] = sign > 0 ? low + step / 2 : high - step / 2;
        lps.columns[a] = sera_lps_from_rpi(axis == SERA_RL ? sign * step : 0, axis == SERA_PA ? sign * step : 0,
                                           axis == SERA_IS ? sign * step : 0);
    }
    lps.origin = sera_lps_from_rpi(origin[SERA_RL], origin[SERA_PA], origin[SERA_IS]);
    if (!grid_init(grid, sera->size, &lps, err)) {
        error_prefix(err, "%s", name);
        return false;
    }
    return true;
}

#pragma once
/* Depths along a line through the patient, and what is read off curves of dose over them. Knows regions and numbers, no
 * scene. Any thread. */
#include "core/region/ray.h"

struct profile_line {
    struct ray ray;
    size_t n; /* depths, equally far apart; at least 2 */
};
static inline double profile_depth(const struct profile_line *line, size_t i)
{
    return line->ray.low_mm + (line->ray.high_mm - line->ray.low_mm) * (double)i / (double)(line->n - 1);
}

/* The largest of n values; false if none is a number. */
bool profile_peak(const double *values, size_t n, size_t *at);

/* Advantage depth: the depth beyond which the dose to tumour is below the greatest dose to normal tissue. Linear
 * between the depths of the line; NaN: no value. Returns false if the dose to tumour never falls below it, or never
 * reaches it, along the line.
 *
 *   tumour_values  what a tumour would have at each depth of the line, weighted
 *   source         R. G. Zamenhof et al., Boron neutron capture therapy for the treatment of cerebral gliomas, Med.
 *                  Phys. 2 (1975) 47; IAEA-TECDOC-1223, Current status of neutron capture therapy (2001): depth at
 * which the total therapeutic dose in tumour equals the maximum total dose in normal tissue. */
bool profile_advantage_depth(const struct profile_line *line, const double *tumour_values, double normal_high,
                             double *depth_mm);

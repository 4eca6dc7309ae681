/* Reads a dose-volume histogram: the univels from a value on, and the value that n univels reach. */
#include "core/dose/dvh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "core/dose/dvh_kernels.h"

void dvh_finish(struct dvh *dvh)
{
    free(dvh->bins);
    *dvh = (struct dvh){ 0 };
}

bool dvh_add(struct dvh *dvh, const struct dvh *other, struct error *err)
{
    if (!dvh->bins && other->bins) {
        dvh->first = other->first;
        dvh->low = other->low;
        dvh->high = other->high;
    }
    if (other->bins) {
        uint32_t first = dvh->first < other->first ? dvh->first : other->first, end = dvh->first + dvh->n_bins,
                 other_end = other->first + other->n_bins;
        end = end > other_end ? end : other_end;
        double *bins = mem_array(end - first, sizeof *bins, UINT64_MAX, err);
        if (!bins)
            return false;
        for (uint32_t i = 0; i < dvh->n_bins; i++)
            bins[dvh->first - first + i] = dvh->bins[i];
        for (uint32_t i = 0; i < other->n_bins; i++)
            bins[other->first - first + i] += other->bins[i];
        free(dvh->bins);
        dvh->bins = bins;
        dvh->first = first;
        dvh->n_bins = end - first;
        dvh->low = fmin(dvh->low, other->low);
        dvh->high = fmax(dvh->high, other->high);
    }
    dvh->univel_cm3 = other->univel_cm3;
    dvh->n += other->n;
    dvh->n_missing += other->n_missing;
    dvh->sum += other->sum;
    return true;
}

double dvh_edge(uint32_t bin)
{
    uint32_t bits = bin << DVH_KEY_SHIFT;
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

/* Where the values of one of its bins, the i-th, can be. */
static void span_of(const struct dvh *dvh, uint32_t i, double *from, double *to)
{
    *from = i == 0 ? dvh->low : dvh_edge(dvh->first + i);
    *to = i + 1 == dvh->n_bins ? dvh->high : dvh_edge(dvh->first + i + 1);
}

double dvh_univels_from(const struct dvh *dvh, double value)
{
    double n = 0;
    if (!dvh->bins || value > dvh->high)
        return 0;
    if (value <= dvh->low)
        return dvh->n;
    for (uint32_t i = dvh->n_bins; i-- > 0;) {
        double from, to;
        span_of(dvh, i, &from, &to);
        if (value >= to && i + 1 < dvh->n_bins)
            break;
        n += value <= from ? dvh->bins[i] : to > from ? dvh->bins[i] * (to - value) / (to - from) : 0;
        if (value > from)
            break;
    }
    return n;
}

double dvh_value_of_hottest(const struct dvh *dvh, double n_univels)
{
    if (!dvh->bins)
        return NAN;
    double n = 0;
    for (uint32_t i = dvh->n_bins; i-- > 0; n += dvh->bins[i]) {
        if (n + dvh->bins[i] < n_univels || dvh->bins[i] == 0)
            continue;
        double from, to;
        span_of(dvh, i, &from, &to);
        return to - (to - from) * fmax(n_univels - n, 0) / dvh->bins[i];
    }
    return dvh->low;
}

void dvh_counts(const struct dvh *dvh, double from, double width, size_t n, double *counts)
{
    memset(counts, 0, n * sizeof *counts);
    for (uint32_t i = 0; i < dvh->n_bins; i++) {
        double low, high;
        if (dvh->bins[i] == 0)
            continue;
        span_of(dvh, i, &low, &high);
        double at = (low - from) / width, end = (high - from) / width;
        if (!(end > at)) { /* all have one value; that of the last bin's upper edge belongs to it */
            double bin = at == (double)n ? (double)n - 1 : floor(at);
            if (bin >= 0 && bin < (double)n)
                counts[(size_t)bin] += dvh->bins[i];
            continue;
        }
        for (double bin = fmax(floor(at), 0); bin < end && bin < (double)n; bin++) {
            double part = (fmin(end, bin + 1) - fmax(at, bin)) / (end - at);
            counts[(size_t)bin] += dvh->bins[i] * fmax(part, 0);
        }
    }
}

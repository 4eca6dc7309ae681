/* Reads seraMC's particle tracks, .pp. */
#include "core/formats/sera/sera_pp.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/formats/sera/sera_axes.h"
#include "core/formats/text.h"

enum { N_FIELDS = 8 };

/* Counts of what the report names once, at the end. */
struct counts {
    size_t n_segments, n_bad, first_bad_line, n_zero_length, n_no_energy;
};

static bool split_numbers(char *line, double numbers[N_FIELDS])
{
    char *rest = line;
    for (int i = 0; i < N_FIELDS; i++) {
        char *word = strtok_r(i == 0 ? line : NULL, " \t", &rest);
        if (!word || !text_number(word, &numbers[i]) || fabs(numbers[i]) > 1e6)
            return false;
    }
    return strtok_r(NULL, " \t", &rest) == NULL;
}

static bool find_class(double type, double energy, uint8_t *class, struct counts *counts)
{
    static const uint8_t neutrons[] = { TRACK_NEUTRON_HIGH, TRACK_NEUTRON_MEDIUM, TRACK_NEUTRON_LOW };
    static const uint8_t gammas[] = { TRACK_GAMMA_HIGH, TRACK_GAMMA_MEDIUM, TRACK_GAMMA_LOW };
    bool has_energy = energy == 1 || energy == 2 || energy == 3;
    if (type == 2 || type == 3) {
        *class = type == 2 ? TRACK_BEAM_LINE : TRACK_LOST;
        return true;
    }
    if (type != 0 && type != 1)
        return false;
    counts->n_no_energy += !has_energy;
    *class = (type == 0 ? neutrons : gammas)[has_energy ? (int)energy - 1 : 0];
    return true;
}

static void put_point(float out[3], double rl, double pa, double is)
{
    struct vec3 lps = sera_lps_from_rpi(rl, pa, is);
    out[0] = (float)lps.x;
    out[1] = (float)lps.y;
    out[2] = (float)lps.z;
}

static void report_counts(const struct counts *counts, const char *name, struct report *report)
{
    if (counts->n_bad > 0)
        report_add(report, REPORT_WARNING, "tracks.bad-lines", name,
                   "%zu lines are not segments, the first is line %zu.", counts->n_bad, counts->first_bad_line);
    if (counts->n_zero_length > 0)
        report_add(report, REPORT_NOTE, "tracks.zero-length", name, "%zu segments of no length were left out.",
                   counts->n_zero_length);
    if (counts->n_no_energy > 0)
        report_add(report, REPORT_NOTE, "tracks.no-energy", name,
                   "%zu segments have no energy class (SERA gives gammas none) and are listed as high.",
                   counts->n_no_energy);
}

bool pp_parse(const uint8_t *data, size_t size, const char *name, struct track_set *set, struct report *report,
              struct error *err)
{
    struct text text;
    struct counts counts = { 0 };
    char line[TEXT_LINE_SIZE];
    size_t capacity = set->n_segments;
    text_start(&text, data, size);
    text.most_lines = SIZE_MAX;
    while (text_line(&text, line)) {
        double v[N_FIELDS];
        uint8_t class;
        if (line[0] == 0)
            continue;
        if (!split_numbers(line, v) || !find_class(v[6], v[7], &class, &counts)) {
            counts.first_bad_line = counts.n_bad++ == 0 ? text.line : counts.first_bad_line;
            continue;
        }
        counts.n_segments++;
        if (!track_set_make_room(set, &capacity, name, err))
            return false;
        struct track_segment *segment = &set->segments[set->n_segments];
        put_point(segment->from_lps_mm, v[0], v[1], v[2]);
        put_point(segment->to_lps_mm, v[3], v[4], v[5]);
        if (track_segment_is_point(segment)) {
            counts.n_zero_length++;
            continue;
        }
        set->n_segments++;
        segment->class = class;
        segment->energy_mev = NAN;
        set->n_of_class[class]++;
    }
    if (counts.n_segments == 0)
        return error_set(err, ERROR_FORMAT, "%s: not one of %zu lines is a segment: six coordinates, a type, an energy",
                         name, text.line);
    report_counts(&counts, name, report);
    return true;
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

/* Distance between the 5th and the 95th percentile of all end points along an axis, so that single far tracks do not
 * count. */
static double spread(const struct track_set *set, size_t first, int axis, float *room)
{
    size_t n = 0;
    for (size_t i = first; i < set->n_segments; i++) {
        room[n++] = set->segments[i].from_lps_mm[axis];
        room[n++] = set->segments[i].to_lps_mm[axis];
    }
    qsort(room, n, sizeof *room, compare_floats);
    return (double)room[(n - 1) - (n - 1) / 20] - (double)room[(n - 1) / 20];
}

double pp_unit_mm(const struct track_set *set, size_t first, double given_mm, const struct box3 *patient_lps_mm,
                  const char *name, struct report *report)
{
    if (box3_is_empty(patient_lps_mm) || set->n_segments <= first)
        return given_mm > 0 ? given_mm : 1;
    float *room = malloc(2 * (set->n_segments - first) * sizeof *room);
    if (!room)
        return given_mm > 0 ? given_mm : 0;
    double length = 0;
    for (int axis = 0; axis < 3; axis++) {
        double along = spread(set, first, axis, room);
        length += along * along;
    }
    free(room);
    double patient_mm = vec3_length(vec3_sub(patient_lps_mm->high, patient_lps_mm->low));
    /* a patient 10 times as large as the tracks' spread means cm, as large means mm; the border is the root of 10 */
    double likely_mm = sqrt(length) > 0 && patient_mm / sqrt(length) > sqrt(10.0) ? 10 : 1;
    if (given_mm > 0) {
        if (given_mm != likely_mm)
            report_add(report, REPORT_WARNING, "tracks.unit-doubtful", name,
                       "The plan says the tracks are in %s, but beside a patient of %.0f mm they would suit %s.",
                       given_mm > 1 ? "cm" : "mm", patient_mm, likely_mm > 1 ? "cm" : "mm");
        return given_mm;
    }
    report_add(report, REPORT_NOTE, "tracks.unit-assumed", name,
               "The file does not say its unit; beside the patient it is taken as %s.", likely_mm > 1 ? "cm" : "mm");
    return likely_mm;
}

static bool scale_point(float point[3], double mm)
{
    bool is_near = true;
    for (int axis = 0; axis < 3; axis++) {
        double at_mm = (double)point[axis] * mm;
        point[axis] = (float)at_mm;
        is_near = is_near && fabs(at_mm) <= PP_MAX_PLACE_MM;
    }
    return is_near;
}

void pp_scale(struct track_set *set, size_t first, double mm, const char *name, struct report *report)
{
    size_t n_kept = first, n_read = set->n_segments - first;
    for (size_t i = first; i < set->n_segments; i++) {
        struct track_segment *segment = &set->segments[i];
        bool is_from_near = scale_point(segment->from_lps_mm, mm), is_to_near = scale_point(segment->to_lps_mm, mm);
        if (is_from_near && is_to_near)
            set->segments[n_kept++] = *segment;
        else
            set->n_of_class[segment->class]--;
    }
    set->n_segments = n_kept;
    if (n_kept - first < n_read)
        report_add(report, REPORT_WARNING, "tracks.far", name,
                   "%zu of %zu segments end more than %g m away and were left out.", n_read - (n_kept - first), n_read,
                   PP_MAX_PLACE_MM / 1000);
}

#include "server/renderer/profile_line.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static bool read_point(const char *text, struct vec3 *point)
{
    double values[3];
    for (int i = 0; i < 3; i++) {
        char *end;
        values[i] = strtod(text, &end);
        if (end == text || *end != (i < 2 ? ',' : 0) || !(fabs(values[i]) <= 100000))
            return false;
        text = end + 1;
    }
    *point = vec3(values[0], values[1], values[2]);
    return true;
}

static bool has_regions(const struct region_set *regions, size_t layer)
{
    for (size_t r = 0; r < regions->n_regions; r++)
        if (regions->regions[r].n_voxels > 0 && regions->regions[r].layer == layer)
            return true;
    return false;
}

/* Follows the beam from its entry through its target to where the dose's grid or the used regions end. */
static bool follow_beam(const struct region_set *regions, const struct beam *beam, const struct dose *dose,
                        struct profile_line *line, struct problem *problem)
{
    struct vec3 way = vec3_sub(beam->target_lps_mm, beam->entry_lps_mm);
    double low = INFINITY, high = -INFINITY;
    line->ray.from_lps_mm = beam->entry_lps_mm;
    line->ray.direction = vec3_normalize(way);
    for (size_t i = 0; i < dose->n_components + regions->n_layers; i++) {
        if (i >= dose->n_components && !has_regions(regions, i - dose->n_components))
            continue;
        const struct volume *volume =
            i < dose->n_components ? dose->components[i].values : regions->layers[i - dose->n_components];
        double from = 0, to = 4 * GRID_FARTHEST_MM;
        if (vec3_length(way) > 0 && ray_clip(&line->ray, &volume->grid, &from, &to)) {
            low = fmin(low, from);
            high = fmax(high, to);
        }
    }
    line->ray.low_mm = low;
    line->ray.high_mm = high;
    return low < high || problem_set(problem, PROBLEM_VALIDATION, "/beam", "range",
                                     "beam \"%.64s\" does not meet the dose's grid or a region", beam->id);
}

/* Leaves out what lies more than a margin before the first and behind the last region. */
static bool narrow(const struct region_set *regions, struct profile_line *line, struct problem *problem)
{
    const double margin_mm = 10;
    struct ray_band *bands;
    size_t n;
    struct error err = { 0 };
    if (!ray_bands(regions, &line->ray, &bands, &n, &err))
        return problem_set(problem, PROBLEM_MEMORY, "", "", "%s", err.text);
    if (n > 0) {
        line->ray.low_mm = fmax(line->ray.low_mm, bands[0].from_mm - margin_mm);
        line->ray.high_mm = fmin(line->ray.high_mm, bands[n - 1].to_mm + margin_mm);
    }
    free(bands);
    return true;
}

static bool is_used(const struct snapshot *snapshot, size_t beam, struct problem *problem)
{
    const struct fit_use *use = &snapshot->fits.beams[beam];
    char why[FIT_WHY_SIZE];
    fit_use_sentence(&snapshot->fits, (struct fit_part){ FIT_BEAM, beam }, use, why);
    return fit_is_used(use) || problem_set(problem, PROBLEM_VALIDATION, "/beam", "not-used", "%s", why);
}

bool profile_line_find(const struct snapshot *snapshot, const struct dose *dose, const struct packet_profile *asked,
                       struct profile_line *line, struct problem *problem)
{
    const struct plan *plan = snapshot->plan;
    line->n = (size_t)asked->samples;
    if (asked->has_beam) {
        for (size_t i = 0; i < plan->n_beams; i++)
            if (strcmp(plan->beams[i].id, asked->beam) == 0)
                return is_used(snapshot, i, problem) &&
                       follow_beam(&snapshot->fits.used, &plan->beams[i], dose, line, problem) &&
                       narrow(&snapshot->fits.used, line, problem);
        return problem_set(problem, PROBLEM_NOT_FOUND, "/beam", "", "the plan has no beam \"%.64s\"", asked->beam);
    }
    struct vec3 to;
    if (!asked->has_from || !read_point(asked->from, &line->ray.from_lps_mm))
        return problem_set(problem, PROBLEM_VALIDATION, "/from", "range",
                           "a line needs a beam, or from and to, each three numbers in mm: x,y,z");
    if (!asked->has_to || !read_point(asked->to, &to))
        return problem_set(problem, PROBLEM_VALIDATION, "/to", "range", "\"to\" needs three numbers in mm: x,y,z");
    struct vec3 way = vec3_sub(to, line->ray.from_lps_mm);
    line->ray.low_mm = 0;
    line->ray.high_mm = vec3_length(way);
    line->ray.direction = vec3_normalize(way);
    return line->ray.high_mm > 1e-6 ||
           problem_set(problem, PROBLEM_VALIDATION, "/to", "range", "from and to are the same point");
}

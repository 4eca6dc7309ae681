/* Chooses the extraction algorithm, and names it. */
#include "core/surface/surface.h"

#include <string.h>

const struct surface_options surface_defaults = { .n_threads = 0, .max_triangles = 40000000, .close_at_border = true };

const char *surface_algorithm_word(enum surface_algorithm algorithm)
{
    static const char *const words[SURFACE_N_ALGORITHMS] = { "marching-cubes", "eight-cell", "smooth" };
    return words[algorithm];
}

bool surface_algorithm_from_word(const char *word, enum surface_algorithm *algorithm)
{
    for (enum surface_algorithm a = 0; a < SURFACE_N_ALGORITHMS; a++)
        if (strcmp(word, surface_algorithm_word(a)) == 0) {
            *algorithm = a;
            return true;
        }
    return false;
}

struct mesh *surface_make(enum surface_algorithm algorithm, const struct mask *mask,
                          const struct surface_options *options, struct error *err)
{
    switch (algorithm) {
    case SURFACE_EIGHT_CELL: return surface_eight_cell(mask, options, err);
    case SURFACE_SMOOTH: return surface_smooth(mask, options, err);
    default: return surface_marching_cubes(mask, options, err);
    }
}

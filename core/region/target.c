/* Finds the first target among regions by type and name, and the point in the middle of a region. */
#include "core/region/target.h"

#include <math.h>
#include <string.h>

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? (char)(c - 'A' + 'a') : c;
}

static bool is_same_word(const char *text, size_t n, const char *word)
{
    if (n != strlen(word))
        return false;
    for (size_t i = 0; i < n; i++)
        if (lower(text[i]) != word[i])
            return false;
    return true;
}

/* GTV, CTV or PTV in capitals, then the classifier: primary, nodal, vascular, parenchymal, surgical bed. */
static bool is_classified(const char *text, size_t n)
{
    static const char *const classifiers[] = { "p", "n", "v", "vas", "par", "sb" };
    if (n < 4 || (strncmp(text, "GTV", 3) != 0 && strncmp(text, "CTV", 3) != 0 && strncmp(text, "PTV", 3) != 0))
        return false;
    for (size_t i = 0; i < sizeof classifiers / sizeof classifiers[0]; i++)
        if (n - 3 == strlen(classifiers[i]) && strncmp(text + 3, classifiers[i], n - 3) == 0)
            return true;
    return false;
}

static bool is_target_word(const char *text, size_t n)
{
    static const char *const words[] = { "gtv", "ctv", "ptv", "tumor", "tumour", "target", "lesion" };
    bool is_plural = n > 1 && lower(text[n - 1]) == 's';
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (is_same_word(text, n, words[i]) || (is_plural && is_same_word(text, n - 1, words[i])))
            return true;
    return is_classified(text, n);
}

/* A structure made around a target or without it, to shape the dose. */
static bool is_helper_word(const char *text, size_t n)
{
    static const char *const words[] = { "ring", "shell", "not", "minus", "without", "outside" };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (is_same_word(text, n, words[i]))
            return true;
    return false;
}

/* True for the volume that a name takes away from what stands before it: the PTV of "Lungs-PTV". */
static bool is_taken_away(const char *name, const char *word)
{
    return word - name >= 2 && word[-1] == '-' && word[-2] != ' ' && lower(word[1]) == 't' && lower(word[2]) == 'v';
}

bool region_name_is_target(const char *name)
{
    bool is_target = false;
    for (const char *at = name; *at;) {
        size_t n = 0;
        while (is_letter(at[n]))
            n++;
        if (is_helper_word(at, n))
            return false;
        is_target |= is_target_word(at, n) && !is_taken_away(name, at);
        at += n > 0 ? n : 1;
    }
    return is_target;
}

bool region_is_target(const struct region *region)
{
    return region->is_target || region_name_is_target(region->name);
}

static bool is_inside(const struct region_set *set, size_t index, size_t outer)
{
    for (int at = (int)index; at >= 0; at = set->regions[at].parent)
        if (at == (int)outer)
            return true;
    return false;
}

static uint64_t count_voxels(const struct region_set *set, size_t index)
{
    uint64_t n = 0;
    for (size_t i = 0; i < set->n_regions; i++)
        if (is_inside(set, i, index))
            n += set->regions[i].n_voxels;
    return n;
}

int region_first_target(const struct region_set *set)
{
    for (size_t i = 0; i < set->n_regions; i++) {
        const struct region *region = &set->regions[i];
        if (region_is_target(region) && count_voxels(set, i) > 0)
            return (int)i;
    }
    return -1;
}

static struct vec3 centroid(const struct region_set *set, size_t index)
{
    struct vec3 sum = vec3(0, 0, 0);
    double n = 0;
    for (size_t i = 0; i < set->n_regions; i++) {
        const struct region *region = &set->regions[i];
        if (region->n_voxels == 0 || !is_inside(set, i, index))
            continue;
        double volume = (double)region->n_voxels * grid_voxel_mm3(&set->layers[region->layer]->grid);
        sum = vec3_add(sum, vec3_scale(region->centre_lps_mm, volume));
        n += volume;
    }
    return vec3_scale(sum, 1 / n);
}

static bool holds(const struct region_set *set, const struct region *region, struct vec3 point_lps_mm)
{
    const struct volume *layer = set->layers[region->layer];
    uint32_t ijk[3];
    return volume_voxel_at(layer, point_lps_mm, ijk) && volume_label(layer, ijk[0], ijk[1], ijk[2]) == region->label;
}

/* Replaces *nearest by the centre of the region's univel that is nearer to the point than *square_mm2, if any is. */
static void find_nearest(const struct region_set *set, const struct region *region, struct vec3 point_lps_mm,
                         struct vec3 *nearest, double *square_mm2)
{
    const struct volume *layer = set->layers[region->layer];
    for (uint32_t k = region->low_ijk[2]; k <= region->high_ijk[2]; k++)
        for (uint32_t j = region->low_ijk[1]; j <= region->high_ijk[1]; j++)
            for (uint32_t i = region->low_ijk[0]; i <= region->high_ijk[0]; i++) {
                if (volume_label(layer, i, j, k) != region->label)
                    continue;
                struct vec3 centre = affine_point(&layer->grid.lps_mm_from_ijk, vec3(i, j, k)),
                            away = vec3_sub(centre, point_lps_mm);
                double square = vec3_dot(away, away);
                if (square < *square_mm2) {
                    *square_mm2 = square;
                    *nearest = centre;
                }
            }
}

struct vec3 region_middle_lps_mm(const struct region_set *set, size_t index)
{
    struct vec3 middle = centroid(set, index), nearest = middle;
    double square_mm2 = INFINITY;
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].n_voxels > 0 && is_inside(set, i, index) && holds(set, &set->regions[i], middle))
            return middle;
    for (size_t i = 0; i < set->n_regions; i++)
        if (set->regions[i].n_voxels > 0 && is_inside(set, i, index))
            find_nearest(set, &set->regions[i], middle, &nearest, &square_mm2);
    return nearest;
}

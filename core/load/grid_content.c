/* Tells labels, grey values and doses apart by the values of a grid. */
#include "core/load/grid_content.h"

#include <math.h>
#include <stdlib.h>

#include "core/base/mem.h"

enum {
    MOST_LABEL = 65535,
    FEW_VALUES = 16,  /* values that a file named as labels may hold in any arrangement */
    MOST_UNNAMED = 64 /* more values are not taken for labels without a name */
};
#define LEAST_ALIKE 0.5         /* of a file named as labels */
#define LEAST_ALIKE_UNNAMED 0.8 /* of any other */
#define MOST_NEGATIVE 0.1       /* of the largest value: what noise and interpolation leave below 0 in a dose */

/* The value as a label; -1: none. */
static int label_of(double value)
{
    double whole = floor(value + 0.5);
    return fabs(value - whole) <= 1e-3 && whole >= 0 && whole <= MOST_LABEL ? (int)whole : -1;
}

/* Counts so far. */
struct counting {
    const struct volume *volume;
    uint8_t *is_seen; /* [MOST_LABEL + 1] */
    size_t n_values, most_values, n_pairs, n_alike;
};

/* Counts a row; false at a value that is no label. */
static bool count_row(struct counting *counting, uint32_t j, uint32_t k)
{
    const struct volume *volume = counting->volume;
    uint32_t n = volume->grid.size[0];
    size_t at = ((size_t)k * volume->grid.size[1] + j) * n;
    bool is_plain = volume->slope == 1 && volume->offset == 0;
    int before = 0;
#define COUNT(type, is_label) \
    do { \
        const type *in = (const type *)volume->voxels + at; \
        for (uint32_t i = 0; i < n; i++) { \
            int label = \
                (is_label) && is_plain ? (int)in[i] : label_of((double)in[i] * volume->slope + volume->offset); \
            if (label < 0) \
                return false; \
            counting->n_values += label > 0 && !counting->is_seen[label]; \
            counting->is_seen[label] = 1; \
            counting->n_pairs += label > 0 && before > 0; \
            counting->n_alike += label > 0 && before == label; \
            before = label; \
        } \
    } while (0)
    switch (volume->type) {
    case VOXEL_U8: COUNT(uint8_t, true); break;
    case VOXEL_I16: COUNT(int16_t, true); break;
    case VOXEL_U16: COUNT(uint16_t, true); break;
    case VOXEL_F32: COUNT(float, false); break;
    }
#undef COUNT
    return true;
}

void grid_content_measure(const struct volume *volume, bool is_named, struct grid_content *content)
{
    *content = (struct grid_content){ 0 };
    if (volume->low < 0 || volume->high > MOST_LABEL)
        return;
    struct counting counting = { .volume = volume,
                                 .is_seen = mem_new(MOST_LABEL + 1),
                                 .most_values = is_named ? MOST_LABEL : MOST_UNNAMED };
    const uint32_t *size = volume->grid.size;
    bool is_whole = true;
    for (uint32_t k = 0; is_whole && counting.n_values <= counting.most_values && k < size[2]; k++)
        for (uint32_t j = 0; is_whole && counting.n_values <= counting.most_values && j < size[1]; j++)
            is_whole = count_row(&counting, j, k);
    content->is_whole = is_whole;
    content->n_values = counting.n_values;
    content->alike = counting.n_pairs > 0 ? (double)counting.n_alike / (double)counting.n_pairs : 1;
    free(counting.is_seen);
}

bool grid_content_is_labels(const struct grid_content *content, bool is_named)
{
    if (!content->is_whole)
        return false;
    if (is_named)
        return content->n_values <= FEW_VALUES || content->alike >= LEAST_ALIKE;
    return content->n_values > 0 && content->n_values <= MOST_UNNAMED && content->alike >= LEAST_ALIKE_UNNAMED;
}

bool grid_content_may_be_dose(const struct volume *volume)
{
    return volume->low >= -MOST_NEGATIVE * fmax(volume->high, 0);
}

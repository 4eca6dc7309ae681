/* Words, keys and lifetime of shapes. */
#include "core/surface/shape.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

static const char *const representation_words[REPRESENTATION_N] = { "surface", "outline", "points", "univels",
                                                                    "solid",   "nurbs",   "fan" };

const char *region_representation_word(enum region_representation representation)
{
    return representation_words[representation];
}

bool region_representation_from_word(const char *word, enum region_representation *representation)
{
    for (enum region_representation r = 0; r < REPRESENTATION_N; r++)
        if (strcmp(word, representation_words[r]) == 0) {
            *representation = r;
            return true;
        }
    return false;
}

void shape_key_normalise(struct shape_key *key)
{
    struct shape_key plain = { .representation = key->representation };
    switch (key->representation) {
    case REPRESENTATION_SURFACE: plain.algorithm = key->algorithm; break;
    case REPRESENTATION_OUTLINE: plain.outline = key->outline; break;
    case REPRESENTATION_POINTS:
    case REPRESENTATION_SOLID: plain.has_inner_boundary = key->has_inner_boundary; break;
    case REPRESENTATION_NURBS:
        plain.nurbs_order = key->nurbs_order;
        plain.nurbs_sampling = key->nurbs_sampling;
        plain.nurbs_bins = key->nurbs_bins;
        break;
    default: break;
    }
    *key = plain;
}

bool shape_key_equal(const struct shape_key *a, const struct shape_key *b)
{
    return a->representation == b->representation && a->algorithm == b->algorithm && a->outline == b->outline &&
           a->has_inner_boundary == b->has_inner_boundary && a->nurbs_order == b->nurbs_order &&
           a->nurbs_sampling == b->nurbs_sampling && a->nurbs_bins == b->nurbs_bins;
}

struct shape *shape_ref(const struct shape *shape)
{
    struct shape *shared = (struct shape *)shape;
    atomic_fetch_add(&shared->references, 1);
    return shared;
}

void shape_unref(const struct shape *shape)
{
    struct shape *shared = (struct shape *)shape;
    if (!shared || atomic_fetch_sub(&shared->references, 1) != 1)
        return;
    mesh_unref(shared->mesh);
    if (shared->lines) {
        free(shared->lines->positions_lps_mm);
        free(shared->lines->indices);
        free(shared->lines);
    }
    if (shared->points) {
        free(shared->points->positions_lps_mm);
        free(shared->points->normals);
        free(shared->points->shade);
        free(shared->points);
    }
    free(shared);
}

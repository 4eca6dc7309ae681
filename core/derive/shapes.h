#pragma once
/* Shapes of regions for pictures, statistics and export, by level of detail; and many of them built ahead. */
#include "core/derive/derive.h"
#include "core/derive/shape_facts.h"

/* Detail of a surface: FULL is every univel; COARSE is for moving pictures: made from the mask reduced until all
 * surfaces of the plan by the same algorithm stay together under COARSE_MAX_TRIANGLES, or the reduction is 8. */
enum surface_detail { SURFACE_FULL, SURFACE_COARSE };

/* A wanted shape: its subject, representation and detail. */
struct shape_want {
    struct subject subject;
    struct shape_key key;       /* need not be normalised */
    enum surface_detail detail; /* of a surface; other representations have their full shape only */
};

bool shape_want_equal(const struct shape_want *a, const struct shape_want *b); /* of normalised keys */

/* The shape of a region, built on first use and kept (derive_get); triangles of a surface have vertex normals. By
 * SURFACE_EIGHT_CELL there may be no triangle.
 *
 *   facts    NULL: not wanted
 *   returns  one reference, the caller's; NULL on failure
 *   errors   ERROR_RANGE no such region, or one without a voxel; those of surface_make and shape_make
 *   thread   any; the first builds, others wait */
NODISCARD struct shape *derive_shape(struct derive *derive, const struct shape_want *want, struct shape_facts *facts,
                                     struct error *err);
/* True if derive_shape of a want in full detail would not build or wait now: it is kept, or was refused. */
bool derive_shape_is_ready(struct derive *derive, const struct shape_want *want);
/* True if the shape was tried before and refused (derive_is_refusal); fills why. */
bool derive_shape_is_refused(struct derive *derive, const struct shape_want *want, struct error *why);
/* Fills the distances in facts: from the shape's vertices to the border of the univels that it was made from. The
 * shape's own facts lack them, as measuring takes about as long as building. errors those of shape_distance */
NODISCARD bool derive_shape_distance(const struct derive *derive, const struct shape_want *want,
                                     const struct shape *shape, struct shape_facts *facts, struct error *err);

/* Builds several shapes ahead, one thread each, in this order; logs failures. Calls go_on at the beginning and before
 * each shape that the calling thread builds, and stops when it returns false; NULL: never stops. */
void derive_build_shapes(struct derive *derive, const struct shape_want *wants, size_t n, bool (*go_on)(void *context),
                         void *context);
/* Builds the surfaces of regions likewise, the largest region first. */
void derive_build_surfaces(struct derive *derive, const struct subject *subjects, size_t n,
                           enum surface_algorithm algorithm, enum surface_detail detail, bool (*go_on)(void *context),
                           void *context);

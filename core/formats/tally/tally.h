#pragma once
/* One field that a Monte Carlo code added up on a mesh of boxes: values and errors as the code gives them, per particle
 * of its source, in its own axes. Plain data; volumes of it are made by tally_volume. */
#include "core/report/report.h"
#include "core/volume/volume.h"

#define TALLY_MAX_BYTES (UINT64_C(1) << 30) /* of a file */
enum { TALLY_MAX_ENERGIES = 4096, TALLY_WORDS_SIZE = 160 };

/* Which of the fields of a file. */
enum { TALLY_ENERGY_UNSAID = 0, TALLY_ENERGY_TOTAL = -1 };
struct tally_choice {
    long number; /* of the tally; 0: the only one of the file */
    long energy; /* a bin from 1, or one of the above */
};
struct tally {
    uint32_t size[3]; /* boxes along x, y, z of the code */
    double low_cm[3], step_cm[3];
    float *values,
        *errors;      /* [z][y][x], owned; errors: one standard deviation, in the unit of the values; NULL: none */
    double histories; /* 0: the file does not say */
    char words[TALLY_WORDS_SIZE]; /* what it is, as the file says it */
};
void tally_finish(struct tally *tally);

/* Sets low and step from edges that are evenly spaced, within what their print shows.
 * errors  ERROR_UNSUPPORTED uneven ones; ERROR_RANGE; the text names file and axis */
NODISCARD bool tally_take_edges(struct tally *tally, int axis, const double *edges_cm, size_t n_edges, const char *name,
                                struct error *err);
/* Room for values, and for errors if wanted, of tally->size. most: cells that the file can hold, by its size.
 * errors  ERROR_FORMAT more cells than that; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD bool tally_make_room(struct tally *tally, uint64_t most, bool has_errors, const char *name,
                               struct error *err);

/* How a person places and normalises a tally. */
struct tally_placing {
    char axes[4];          /* the patient's side to which x, y, z of the code grow: "LPS", "RAS" */
    struct vec3 origin_mm; /* where 0, 0, 0 of the code lies, in patient LPS */
    double factor;         /* every value is multiplied by it */
};
/* The field, or its errors, as floats. errors  ERROR_RANGE axes that are none, values that overflow, a grid that
 * cannot be; ERROR_NOT_FOUND no errors; ERROR_LIMIT; ERROR_MEMORY */
NODISCARD struct volume *tally_volume(const struct tally *tally, const struct tally_placing *placing, bool is_error,
                                      const char *name, struct error *err);
/* The grid alone. */
NODISCARD bool tally_grid(const struct tally *tally, const struct tally_placing *placing, const char *name,
                          struct grid *grid, struct error *err);

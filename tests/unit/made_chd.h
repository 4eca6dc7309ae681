#pragma once
/* Small sets of SERA's dose contours, laid out as seraMC (fixed columns, numbers that touch) and seraPlan (blanks,
 * another order of columns) write them, for tests that read them. */
#include "core/formats/sera/sera_chd.h"
#include "tests/check.h"

enum { CHD_TEXT_SIZE = 1 << 16, CHD_COLS = 3, CHD_ROWS = 2 };

extern const char *const chd_sera_mc[9], *const chd_sera_plan[9]; /* the names of columns, in each writer's order */

/* Contents of a set; the defaults are seraMC's. */
struct made_chd {
    const char *version, *const *names;
    double fov;
    size_t n_planes;
    double z[4];         /* as the header lists them */
    size_t order[4];     /* which of them the table gives when */
    double ppm, weight;  /* of boron */
    double other_weight; /* of gamma, nitrogen, fast and other */
    double ratio;        /* tissue to blood, of region 7 alone */
    bool is_plan;        /* seraPlan's layout of a line */
    const char *more;    /* a further line of the header */
    const char *special; /* a word instead of the gamma of the first point */
};
extern const struct made_chd chd_plain;

struct chd_text {
    char *at;
    size_t n;
};
void chd_put(struct chd_text *text, const char *format, ...) PRINTF_LIKE(2, 3);
/* The physical value at a point: each quantity its own, growing with the point's number. */
double chd_physical(enum dose_quantity quantity, size_t point);
double chd_printed(const struct made_chd *made, const char *name, size_t point,
                   int region); /* what a file prints there */
/* Both are the caller's to free. */
struct chd_text chd_make_header(const struct made_chd *made);
struct chd_text chd_make_table(const struct made_chd *made);

struct chd_result {
    struct chd chd;
    struct sera_doses doses;
    struct report report;
    struct error err;
};
bool chd_read_both(const struct chd_text *header, const struct chd_text *table, const struct bytes *mask,
                   struct chd_result *result);
void chd_result_finish(struct chd_result *result);
struct chd_result chd_read_made(const struct made_chd *made);
const struct volume *chd_volume_of(const struct sera_doses *doses, enum dose_quantity quantity);
void chd_check_quantity(const struct sera_doses *doses,
                        enum dose_quantity quantity); /* against chd_physical; four digits are printed */

#pragma once
/* Reads SERA univels: a text header .uvh (versions 2.0 and 1.0) and its bytes, .uv, .uv.gz or .uv.sz. Works on bytes in
 * memory. */
#include "core/formats/folder.h"
#include "core/region/region.h"
#include "core/report/report.h"

enum { UVH_MAX_BYTES = 1 << 20, UVH_MAX_BODIES = 256 };

struct uvh_body {
    char name[REGION_NAME_SIZE];
    int uvval; /* 0..255 */
    bool has_color;
    uint8_t rgb[3];
    double boron_ratio, cbe_boron, rbe_nitrogen, rbe_fast, rbe_gamma; /* not-a-number: not given */
};

struct uvh {
    struct grid grid;
    struct uvh_body *bodies;
    size_t n_bodies;
};
void uvh_finish(struct uvh *uvh);

/* Reads the header.
 *   errors  ERROR_FORMAT, ERROR_UNSUPPORTED (oblique), ERROR_RANGE, ERROR_LIMIT; the text names line and key */
NODISCARD bool uvh_parse(const uint8_t *data, size_t size, const char *name, struct uvh *uvh, struct report *report,
                         struct error *err);

/* Like uvh_parse, but one unit has the length that the plan gives; 0: the header's own. */
NODISCARD bool uvh_parse_in(const uint8_t *data, size_t size, const char *name, double given_mm, struct uvh *uvh,
                            struct report *report, struct error *err);

/* Reads the univels as a U8 volume. data may be gzip, or zlib when name ends with .sz.
 * errors ERROR_FORMAT another number of bytes than the header has univels; ERROR_MEMORY */
NODISCARD struct volume *uvh_read_univels(const struct uvh *uvh, const struct bytes *data, const char *name,
                                          struct error *err);

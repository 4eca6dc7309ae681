#pragma once
/* Reads seraMC's restart file, .rst: the dose on its cubic mesh, text in fixed Fortran columns. Gives the physical dose
 * components in cGy and the fluences for one unit of the source; boron per 1 ppm of boron-10. Works on unpacked text in
 * memory.
 *   source   the layout as seraMC 1C0 writes it and the absolute scale as seraPlan 1C0 applies it */
#include "core/formats/folder.h"
#include "core/formats/sera/sera_doses.h"
#include "core/report/report.h"

enum {
    RST_MAX_SETS = 99,
    RST_MAX_CELLS = 128, /* cells along an edge; seraMC makes at most 120 */
    RST_MAX_GROUPS = 1000,
    RST_HEAD_BYTES = 1 << 16 /* enough for any header */
};
#define RST_MAX_BYTES ((uint64_t)512 << 20) /* of the text; 128^3 cells of 14 values are 450 MB */

struct rst_set {
    char directive;          /* N neutrons, F fast neutrons, G gammas, ... */
    uint32_t n_histories[3]; /* neutron, gamma, fast */
    double strength;         /* particles per unit of the source */
    double gamma_fraction;   /* fraction of them that are gammas */
};

struct rst_header {
    char version[13], title[81];
    struct rst_set sets[RST_MAX_SETS];
    size_t n_sets;
    uint32_t n_cells; /* along each edge */
    double cell_cm;
    struct grid grid;          /* i toward left, j toward anterior, k toward superior */
    size_t data_at, data_line; /* offset and line where the array begins */
};

/* Reads the header. errors ERROR_FORMAT with the line, ERROR_LIMIT, ERROR_RANGE (geometry) */
NODISCARD bool rst_parse_header(const uint8_t *text, size_t size, const char *name, struct rst_header *header,
                                struct error *err);

enum { RST_N_DOSES = 8 };
/* Reads boron (per ppm), nitrogen, fast (hydrogen), gamma and other doses, then fast, epithermal and thermal fluence in
 * 1/cm2, in this order. Values too wide to be printed ("***") or no numbers become not-a-number and are reported.
 *   errors  as rst_parse_header, ERROR_MEMORY; doses is then empty */
NODISCARD bool rst_read(const struct bytes *text, const char *name, struct sera_doses *doses, struct report *report,
                        struct error *err);

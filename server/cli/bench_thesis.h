#pragma once
/* `beamroom bench --thesis`: measures every way of showing every region of a plan, and writes the figures beside those
 * of the thesis on Sera3d. */
#include "core/derive/shapes.h"
#include "core/render/render.h"

enum { BENCH_MAX_METHODS = 24, BENCH_SIZE_PX = 650 }; /* Sera3d's window */

/* How the image alone is shown: Table 2 of the thesis, and the ways it had not. */
enum bench_image_way {
    BENCH_SLICE,
    BENCH_VOLUME_NEAREST, /* 256 slices, as the thesis */
    BENCH_VOLUME_LINEAR,
    BENCH_RAY,       /* the transfer function of a new room */
    BENCH_RAY_PLAIN, /* not lit */
    BENCH_N_IMAGE_WAYS,
    BENCH_NO_IMAGE
};

/* One region by one method. */
struct bench_row {
    char region[REGION_NAME_SIZE];
    const char *method; /* borrowed: a constant */
    struct shape_facts facts;
    double made_ms;    /* median */
    double draw_ms;    /* median, the region alone, full detail, turning; not-a-number when it was not drawn */
    char refusal[240]; /* why there is no such shape; "": there is one */
};

struct bench_plan {
    char name[128];
    bool is_phantom;
    struct bench_row *rows; /* [n_rows] */
    size_t n_rows;
    /* Table 1 of the thesis, on the plan's scalp, else on its largest region */
    char scalp[REGION_NAME_SIZE];
    struct bench_row table1[3];           /* 8-cell with face normals, 8-cell with vertex normals, marching cubes */
    double image_fps[BENCH_N_IMAGE_WAYS]; /* Table 2: pictures a second; not-a-number without an image */
};

struct bench_machine {
    char processor[128], system[128], back_end[160];
    int n_cores;
};
void bench_machine_look(struct bench_machine *machine, const struct render_facts *facts);

/* Measures the plan that derived is of: each shape is built n_repeats times and drawn 5 n_repeats times.
 * errors those of rendering */
NODISCARD bool bench_measure(struct derive *derived, struct renderer *renderer, int n_repeats,
                             struct bench_plan *result, struct error *err);
void bench_plan_finish(struct bench_plan *result);

/* The page as Markdown, to free(). */
NODISCARD char *bench_page(const struct bench_machine *machine, const struct bench_plan *plans, size_t n_plans);

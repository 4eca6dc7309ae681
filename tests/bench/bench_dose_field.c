/* The weighted field of four components of 256^3 at another boron concentration: combined as a whole, in one tissue and
 * in four, everywhere or each where its univels are; and only where an axial, a coronal and a sagittal pane read it.
 * Beside it, reading the components once from memory with as many threads: the fastest that anything can be that looks
 * at them. */
#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "core/base/parallel.h"
#include "core/derive/dose_field.h"

enum { SIDE = 256, REPEATS = 15, N_COMPONENTS = 4 };

static struct plan *plan;
static struct derive *derived;

static int compare(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

static double median(double values[REPEATS])
{
    qsort(values, REPEATS, sizeof values[0], compare);
    return values[REPEATS / 2];
}

static void stop(const struct error *err)
{
    fprintf(stderr, "bench_dose_field: %s\n", err->text);
    exit(1);
}

/* A box of four tissues, a quarter each, and four components. */
static void make_plan(void)
{
    static const enum dose_quantity quantities[] = { DOSE_BORON, DOSE_NITROGEN, DOSE_FAST, DOSE_GAMMA };
    const uint32_t size[3] = { SIDE, SIDE, SIDE };
    const struct affine map = { { vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 1) }, vec3(-128, -128, -128) };
    struct grid grid;
    struct error err = { 0 };
    plan = plan_create("bench");
    if (!grid_init(&grid, size, &map, &err))
        stop(&err);
    struct volume *labels = volume_create(&grid, VOXEL_U8, &err);
    if (!labels)
        stop(&err);
    for (uint32_t k = 0; k < SIDE; k++)
        for (uint32_t j = 0; j < SIDE; j++)
            for (uint32_t i = 0; i < SIDE; i++)
                ((uint8_t *)labels->voxels)[i + SIDE * (j + (size_t)SIDE * k)] =
                    (uint8_t)(1 + (i >= SIDE / 2) + 2 * (k >= SIDE / 2));
    volume_measure(labels);
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    plan->regions.layers[0] = labels;
    plan->regions.n_layers = 1;
    plan->regions.regions = mem_new(4 * sizeof(struct region));
    plan->regions.n_regions = 4;
    for (size_t r = 0; r < 4; r++) {
        snprintf(plan->regions.regions[r].id, sizeof plan->regions.regions[r].id, "r%zu", r);
        plan->regions.regions[r].parent = -1;
        plan->regions.regions[r].label = (uint16_t)(r + 1);
    }
    region_set_measure(&plan->regions);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "d");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    for (size_t q = 0; q < N_COMPONENTS; q++) {
        struct volume *volume = volume_create_unset(&grid, VOXEL_F32, &err);
        if (!volume)
            stop(&err);
        for (size_t i = 0; i < grid_n_voxels(&grid); i++)
            ((float *)volume->voxels)[i] = (float)((i * 2654435761u >> 20 & 1023) + q);
        volume_measure(volume);
        dose->components[dose->n_components++] =
            (struct dose_component){ .quantity = quantities[q], .is_per_ppm = q == 0, .values = volume };
    }
}

static struct dose_choice choice_of(double blood_ppm, bool is_one_tissue)
{
    struct dose_choice choice;
    memset(&choice, 0, sizeof choice);
    choice.parts[0].factor = 1;
    choice.n_parts = 1;
    choice.shown = DOSE_SHOWN_WEIGHTED;
    choice.quantity = DOSE_TOTAL;
    choice.blood_ppm = blood_ppm;
    choice.n_rows = is_one_tissue ? 1 : 4;
    choice.is_everywhere = is_one_tissue;
    memset(choice.row_of_region, DOSE_NO_ROW, sizeof choice.row_of_region);
    for (size_t r = 0; r < choice.n_rows; r++) {
        choice.rows[r] = (struct tissue_weights){ 1 + (double)r, 1.3 + (double)r, 3.2, 3.2, 1, 1 };
        if (!is_one_tissue)
            choice.row_of_region[r] = (uint8_t)r;
    }
    return choice;
}

static _Atomic float total;

static void read_some(void *context, int part, int n_parts)
{
    (void)context;
    enum { LANES = 16 };
    float sums[LANES] = { 0 };
    const size_t n = (size_t)SIDE * SIDE * SIDE / (size_t)n_parts;
    for (size_t q = 0; q < N_COMPONENTS; q++) {
        const float *from = (const float *)plan->doses[0].components[q].values->voxels + n * (size_t)part;
        for (size_t i = 0; i < n; i += LANES)
            for (size_t l = 0; l < LANES; l++)
                sums[l] += from[i + l];
    }
    for (size_t l = 0; l < LANES; l++)
        atomic_store(&total, atomic_load(&total) + sums[l]);
}

static double read_ms(void)
{
    int64_t began_us = clock_now_us();
    parallel_run(parallel_cores(), read_some, NULL);
    return (double)(clock_now_us() - began_us) / 1e3;
}

/* Parts of a field that are read. */
enum what { ALL, ALL_TISSUES, READ, AXIAL, CORONAL, SAGITTAL };

static double combine_ms(enum what what, int step)
{
    static const struct vec3 normals[] = { [AXIAL] = { 0, 0, 1 }, [CORONAL] = { 0, 1, 0 }, [SAGITTAL] = { 1, 0, 0 } };
    struct dose_choice choice = choice_of(15 + 0.01 * step + 10 * (int)what, what == ALL);
    struct error err = { 0 };
    int64_t began_us = clock_now_us();
    struct dose_field *field =
        what <= ALL_TISSUES ? dose_field_get(derived, &choice, &err) : dose_field_begin(derived, &choice, &err);
    if (!field)
        stop(&err);
    if (what == READ)
        dose_field_need_box(field, &plan->bounds_lps_mm);
    if (what > READ)
        dose_field_need_plane(field, vec3(3.3, 2.2, 1.1), normals[what]);
    double ms = (double)(clock_now_us() - began_us) / 1e3;
    derive_result_unref(&field->base);
    return ms;
}

static void bench(const char *name, enum what what)
{
    double ms[REPEATS], peer_ms[REPEATS];
    for (int i = -3; i < 0; i++) /* the tissues; memory that is used again */
        (void)combine_ms(what, i);
    for (int i = 0; i < REPEATS; i++) {
        peer_ms[i] = read_ms();
        ms[i] = combine_ms(what, i);
    }
    double ours = median(ms), reading_ms = median(peer_ms);
    printf("{\"name\":\"dose field, %s\",\"value\":%.2f,\"unit\":\"ms\",\"peer\":\"reading the components once\","
           "\"peer_value\":%.2f,\"ratio\":%.2f,\"note\":\"4 components of %d^3, %d threads; median of %d\"}\n",
           name, ours, reading_ms, reading_ms / ours, SIDE, parallel_cores(), REPEATS);
}

int main(void)
{
    make_plan();
    derived = derive_create(plan);
    bench("another ppm, one tissue", ALL);
    bench("another ppm, all of four tissues", ALL_TISSUES);
    bench("another ppm, four tissues, each where its univels are", READ);
    bench("another ppm, four tissues, an axial pane", AXIAL);
    bench("another ppm, four tissues, a coronal pane", CORONAL);
    bench("another ppm, four tissues, a sagittal pane", SAGITTAL);
    derive_destroy(derived);
    plan_destroy(plan);
    return 0;
}

/* Isosurfaces of 128^3 and 256^3 floats, with normals, against vtkFlyingEdges3D: the two take turns on the same field,
 * thread for thread, and the median of each counts. Then isodoses out of the store, while a level or a weight is moved.
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/parallel.h"
#include "core/derive/isodose_shape.h"
#include "core/phantom/head.h"
#include "core/surface/isosurface.h"
#include "tests/bench/peer.h"
#include "tests/made_plan.h"

enum { REPEATS = 15, N_LEVELS = 3, DRAG_STEPS = 100 };
static const double levels[N_LEVELS] = { 20, 50, 80 }; /* % of the largest */

static _Noreturn void die(const char *what, const struct error *err)
{
    fprintf(stderr, "bench_isosurface: %s: %s\n", what, err ? err->text : "failed");
    exit(1);
}

/* A dose that rises behind the skin and falls off with depth, in a field of 10 cm; noisy: every voxel with the
 * statistical error of a Monte Carlo calculation, 2 %. */
static struct volume *make_field(uint32_t side, bool is_noisy)
{
    struct error err = { 0 };
    struct grid grid;
    double h = 256.0 / side, half = (side - 1) / 2.0 * h;
    struct affine map = { { { h, 0, 0 }, { 0, h, 0 }, { 0, 0, h } }, { -half, -half, -half } };
    if (!grid_init(&grid, (uint32_t[3]){ side, side, side }, &map, &err))
        die("grid", &err);
    struct volume *field = volume_create(&grid, VOXEL_F32, &err);
    if (!field)
        die("field", &err);
    float *value = field->voxels;
    uint64_t n = 0;
    for (uint32_t k = 0; k < side; k++)
        for (uint32_t j = 0; j < side; j++)
            for (uint32_t i = 0; i < side; i++, n++) {
                struct vec3 p = affine_point(&map, vec3(i, j, k));
                double depth = p.z + 110, across = p.x * p.x + p.y * p.y, width = 60 + 0.15 * depth;
                double dose = depth < 0 ? 0 : 100 * exp(1 - depth / 28) * depth / 28 * exp(-across / (width * width));
                double error = (double)(phantom_mix(n) >> 11) / (double)((uint64_t)1 << 53) * 2 - 1;
                *value++ = (float)(dose * (is_noisy ? 1 + 0.035 * error : 1)); /* even, so its deviation is 2 % */
            }
    return field;
}

static double since_ms(int64_t began_us)
{
    return (double)(clock_now_us() - began_us) / 1e3;
}

static double make_ms(const struct volume *field, const struct iso_bricks *bricks, double level, int n_threads,
                      bool with_normals, size_t *n_triangles)
{
    struct error err = { 0 };
    struct surface_options options = surface_defaults;
    options.n_threads = n_threads;
    options.without_normals = !with_normals;
    int64_t began = clock_now_us();
    struct mesh *mesh = isosurface_make(SURFACE_MARCHING_CUBES, field, bricks, level, &options, &err);
    double ms = since_ms(began);
    if (!mesh)
        die("surface", &err);
    *n_triangles = mesh->n_triangles;
    mesh_unref(mesh);
    return ms;
}

static double vtk_ms(struct peer *vtk, double level, bool with_normals, size_t n_triangles)
{
    char question[64], line[128];
    double ms;
    size_t n_theirs;
    snprintf(question, sizeof question, "%.17g %d\n", level, with_normals);
    if (!peer_ask(vtk, question, line, sizeof line) || sscanf(line, "%lf %zu", &ms, &n_theirs) != 2)
        die("the VTK side", NULL);
    if (n_theirs != n_triangles)
        die("not the same number of triangles as VTK", NULL);
    return ms;
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values)
{
    qsort(values, REPEATS, sizeof *values, compare_doubles);
    return values[REPEATS / 2];
}

static void print_result(const char *name, double ours, const char *peer, double theirs, size_t n_triangles)
{
    printf("{\"name\":\"%s\",\"value\":%.3f,\"unit\":\"ms\"", name, ours);
    if (peer)
        printf(",\"peer\":\"%s\",\"peer_value\":%.3f,\"ratio\":%.2f", peer, theirs, theirs / ours);
    printf(",\"note\":\"%zu triangles\"}\n", n_triangles);
    fflush(stdout);
}

static void bench_level(const char *what, const struct volume *field, const struct iso_bricks *bricks, double level,
                        struct peer *vtk, const char *peer)
{
    double moved[REPEATS], first[REPEATS], plain[REPEATS], theirs[REPEATS], theirs_plain[REPEATS];
    size_t n_triangles = 0;
    char name[128];
    for (int r = -1; r < REPEATS; r++) { /* the first warms up and does not count */
        int at = r < 0 ? 0 : r;
        moved[at] = make_ms(field, bricks, level, 1, true, &n_triangles);
        theirs[at] = peer ? vtk_ms(vtk, level, true, n_triangles) : 0;
        first[at] = make_ms(field, NULL, level, 1, true, &n_triangles);
        plain[at] = make_ms(field, bricks, level, 1, false, &n_triangles);
        theirs_plain[at] = peer ? vtk_ms(vtk, level, false, n_triangles) : 0;
    }
    double vtk_median = median(theirs);
    snprintf(name, sizeof name, "isosurface with normals, %s, %.0f %%, 1 thread", what, level);
    print_result(name, median(moved), peer, vtk_median, n_triangles);
    snprintf(name, sizeof name, "isosurface with normals, %s, %.0f %%, 1 thread, no bricks kept", what, level);
    print_result(name, median(first), peer, vtk_median, n_triangles);
    snprintf(name, sizeof name, "isosurface, %s, %.0f %%, 1 thread", what, level);
    print_result(name, median(plain), peer, median(theirs_plain), n_triangles);
}

/* ---- through the store ------------------------------------------------------------------------------------------- */

static double two_tissues(struct vec3 p)
{
    return p.x < 0 ? 1 : 2;
}

/* A plan with the field as its photon dose, and univels of two tissues. */
static struct plan *make_plan(const struct volume *field)
{
    static const struct made_region regions[2] = { { "left", -1, 0xff0000 }, { "right", -1, 0x00ff00 } };
    struct grid univels = made_cube_grid(256);
    struct plan *plan = made_plan(&univels, two_tissues, regions, 2);
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "dose");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_GAMMA, .values = volume_ref(field) };
    return plan;
}

static struct isodose_choice choice_of(double value, double weight)
{
    struct isodose_choice choice;
    memset(&choice, 0, sizeof choice);
    choice.dose.n_parts = 1;
    choice.dose.parts[0].factor = 1;
    choice.dose.shown = DOSE_SHOWN_WEIGHTED;
    choice.dose.n_rows = 2;
    memset(choice.dose.row_of_region, DOSE_NO_ROW, sizeof choice.dose.row_of_region);
    for (uint8_t r = 0; r < 2; r++) {
        choice.dose.row_of_region[r] = r;
        choice.dose.rows[r] = (struct tissue_weights){ 1, 1, 1, 1, r ? weight : 1, 1 };
    }
    choice.grid = ISODOSE_ON_DOSE;
    choice.value = value;
    return choice;
}

static double isodose_ms(struct derive *derive, double value, double weight, size_t *most)
{
    struct error err = { 0 };
    struct isodose_choice choice = choice_of(value, weight);
    int64_t began = clock_now_us();
    struct isodose_shape *made = isodose_shape_get(derive, &choice, SURFACE_FULL, &err);
    double ms = since_ms(began);
    if (!made)
        die("isodose", &err);
    *most = made->facts.n_triangles > *most ? made->facts.n_triangles : *most;
    derive_result_unref(&made->base);
    return ms;
}

/* A level moved from 10 to 90 %, then a weight: the time that 95 of 100 surfaces keep, as a picture asks for them. */
static void bench_drag(const char *what, const struct volume *field)
{
    struct plan *plan = make_plan(field);
    struct derive *derive = derive_create(plan);
    for (int by_weight = 0; by_weight < 2; by_weight++) {
        int n_steps = by_weight ? DRAG_STEPS / 5 : DRAG_STEPS;
        double ms[DRAG_STEPS];
        size_t most = 0;
        char name[128];
        (void)isodose_ms(derive, 5, 1, &most); /* makes what all levels have in common */
        for (int step = 0; step < n_steps; step++)
            ms[step] = by_weight ? isodose_ms(derive, 50, 1 + 0.01 * (step + 1), &most)
                                 : isodose_ms(derive, 10 + 80.0 * step / n_steps, 1, &most);
        qsort(ms, (size_t)n_steps, sizeof *ms, compare_doubles);
        snprintf(name, sizeof name, "isodose of a %s being moved, %s, %d threads, p95", by_weight ? "weight" : "level",
                 what, parallel_cores());
        print_result(name, ms[n_steps * 95 / 100 - 1], NULL, 0, most);
    }
    derive_destroy(derive);
    plan_destroy(plan);
}

static void bench_field(uint32_t side, bool is_noisy)
{
    struct error err = { 0 };
    struct volume *field = make_field(side, is_noisy);
    struct peer vtk;
    char what[64], path[PEER_PATH_SIZE], number[16], line[64], version[16], peer[64];
    double bricks_ms[2][REPEATS];
    struct iso_bricks *bricks = NULL;
    snprintf(what, sizeof what, "%u^3%s", side, is_noisy ? " with noise" : "");
    snprintf(number, sizeof number, "%u", side);
    if (!peer_write_file(path, field->voxels, grid_n_voxels(&field->grid) * sizeof(float)))
        die("temporary file", NULL);
    const char *arguments[] = { peer_python(), "tests/bench/vtk_isosurface.py", path, number, NULL };
    bool has_vtk = peer_start(&vtk, arguments, line, sizeof line) && sscanf(line, "%15s", version) == 1;
    if (has_vtk)
        snprintf(peer, sizeof peer, "vtkFlyingEdges3D %s, 1 thread", version);
    else
        fprintf(stderr, "bench_isosurface: no VTK for Python here: our times only\n");
    for (int r = 0; r < REPEATS; r++)
        for (int two = 0; two < 2; two++) {
            iso_bricks_destroy(bricks);
            int64_t began = clock_now_us();
            bricks = iso_bricks_create(field, 1 + two, &err);
            bricks_ms[two][r] = since_ms(began);
            if (!bricks)
                die("bricks", &err);
        }
    for (int two = 0; two < 2; two++) {
        char name[128];
        snprintf(name, sizeof name, "bricks of a field, kept for all levels, %s, %d thread%s", what, 1 + two,
                 two ? "s" : "");
        print_result(name, median(bricks_ms[two]), NULL, 0, 0);
    }
    for (int level = 0; level < N_LEVELS; level++)
        bench_level(what, field, bricks, levels[level], &vtk, has_vtk ? peer : NULL);
    bench_drag(what, field);
    (void)peer_end(&vtk);
    unlink(path);
    iso_bricks_destroy(bricks);
    volume_unref(field);
}

int main(void)
{
    for (int is_noisy = 0; is_noisy < 2; is_noisy++) {
        bench_field(128, is_noisy);
        bench_field(256, is_noisy);
    }
    return 0;
}

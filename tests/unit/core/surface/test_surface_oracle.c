/* Marching cubes compared with VTK's on the same voxels, and both algorithms with the counts known for SERA's sample
 * head. */
#include <fcntl.h>
#include <unistd.h>

#include "core/region/mask.h"
#include "tests/check.h"
#include "tests/unit/made_mask.h"
#include "tests/unit/oracle.h"
#include "tests/unit/sera_head.h"

struct label_set {
    const char *text; /* in the script's syntax */
    uint16_t labels[4];
    size_t n;
};

static struct mesh *extract(enum surface_algorithm algorithm, const struct volume *layer, const struct label_set *set,
                            bool close_at_border)
{
    struct error err = { 0 };
    struct mask *mask = mask_from_labels(layer, set->labels, set->n, 2, &err);
    assert_non_null(mask);
    struct mesh *mesh = made_surface(algorithm, mask, 2, close_at_border);
    if (close_at_border)
        assert_int_equal(mesh_open_edges(mesh), 0);
    mask_destroy(mask);
    return mesh;
}

static size_t count_triangles(const struct volume *layer, const struct label_set *set, bool close_at_border)
{
    struct mesh *mesh = extract(SURFACE_MARCHING_CUBES, layer, set, close_at_border);
    size_t n = mesh->n_triangles;
    mesh_unref(mesh);
    return n;
}

/* Runs the script on the layer; returns its exit status, and its output in out. */
static int run_vtk(const struct volume *layer, const struct label_set *sets, size_t n_sets, char *out, size_t out_size)
{
    char path[] = "/tmp/beamroom-oracle-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    size_t n = grid_n_voxels(&layer->grid);
    for (size_t done = 0; done < n;) {
        ssize_t written = write(file, (const uint8_t *)layer->voxels + done, n - done);
        assert_true(written > 0);
        done += (size_t)written;
    }
    close(file);

    char sizes[3][16],
        *arguments[16] = { oracle_python(), "tests/oracle/vtk_counts.py", path, sizes[0], sizes[1], sizes[2] };
    for (size_t axis = 0; axis < 3; axis++)
        snprintf(sizes[axis], sizeof sizes[axis], "%u", layer->grid.size[axis]);
    for (size_t s = 0; s < n_sets; s++)
        arguments[6 + s] = (char *)sets[s].text;

    int status = oracle_run(arguments, out, out_size);
    unlink(path);
    return status;
}

static void assert_equals_vtk(const struct volume *layer, const struct label_set *sets, size_t n_sets)
{
    char out[512], *at = out;
    int status = run_vtk(layer, sets, n_sets, out, sizeof out);
    if (status == ORACLE_MISSING) {
        print_message("no VTK for Python here\n");
        volume_unref(layer); /* skip does not return */
        skip();
    }
    assert_int_equal(status, 0);
    for (size_t s = 0; s < n_sets; s++)
        for (int closed = 0; closed < 2; closed++) {
            unsigned long long expected = strtoull(at, &at, 10);
            assert_int_equal(count_triangles(layer, &sets[s], closed), expected);
        }
}

static uint32_t hash(uint32_t x, uint32_t y, uint32_t z)
{
    uint32_t h = x * 374761393u + y * 668265263u + z * 2246822519u;
    h = (h ^ h >> 13) * 1274126177u;
    return h ^ h >> 16;
}

static void triangle_counts_equal_vtk_on_a_noisy_phantom(void **state)
{
    (void)state;
    struct volume *layer = layer_make(107, 90, 61, VOXEL_U8, &unit_map);
    uint8_t *voxels = layer->voxels;
    for (uint32_t k = 0; k < 61; k++)
        for (uint32_t j = 0; j < 90; j++)
            for (uint32_t i = 0; i < 107; i++) {
                /* nested ellipsoids, the outer one cut by the grid, with ragged borders: every ambiguous case occurs */
                double r = sqrt(pow((i - 50.0) / 52, 2) + pow((j - 45.0) / 47, 2) + pow((k - 25.0) / 30, 2));
                r += (hash(i, j, k) % 1000 / 1000.0 - 0.5) * 0.12;
                *voxels++ = r < 0.3 ? 3 : r < 0.7 ? 2 : r < 1 ? 1 : 0;
            }
    static const struct label_set sets[] = { { "1,2,3", { 1, 2, 3 }, 3 }, { "2,3", { 2, 3 }, 2 }, { "3", { 3 }, 1 } };
    assert_equals_vtk(layer, sets, 3);
    volume_unref(layer);
}

static const struct label_set sera_sets[] = { { "2,3,4", { 2, 3, 4 }, 3 }, { "3,4", { 3, 4 }, 2 }, { "4", { 4 }, 1 } };

static struct volume *read_sera_head(void)
{
    struct volume *layer = sera_head_read();
    if (!layer)
        skip();
    return layer;
}

/* Sera3d's counts for its own head, open where the scan cuts it. Its table connects a few ambiguous cells differently:
 * two triangles per cell. Our counts equal VTK's to the triangle, see below. */
static void seras_own_head_has_the_counts_and_volumes_it_should(void **state)
{
    (void)state;
    static const double original[] = { 189092, 108558, 13028 };
    struct volume *layer = read_sera_head();
    for (size_t s = 0; s < 3; s++) {
        assert_near(count_triangles(layer, &sera_sets[s], false), original[s], 5e-5);
        /* cutting every crossed edge in the middle takes from convex places what it adds to concave ones, except for
         * the overall curvature: within 1 % for bodies of some ten voxels and more */
        struct error err = { 0 };
        struct mask *mask = mask_from_labels(layer, sera_sets[s].labels, sera_sets[s].n, 2, &err);
        assert_non_null(mask);
        struct mesh *mesh = extract(SURFACE_MARCHING_CUBES, layer, &sera_sets[s], true);
        assert_near(mesh_volume_mm3(mesh), (double)mask_count(mask) * 1.01562 * 1.01562 * 5.49991, 0.01);
        mask_destroy(mask);
        mesh_unref(mesh);
    }
    volume_unref(layer);
}

/* Sera3d at full quality, which adds no empty layer around the data: open where the scan cuts the body. */
static void eight_cell_counts_equal_the_original_sera3d_on_its_own_head(void **state)
{
    (void)state;
    static const size_t expected[] = { 137132, 85240, 10236 };
    struct volume *layer = read_sera_head();
    for (size_t s = 0; s < 3; s++) {
        struct mesh *mesh = extract(SURFACE_EIGHT_CELL, layer, &sera_sets[s], false);
        assert_int_equal(mesh->n_triangles, expected[s]);
        mesh_unref(mesh);
    }
    volume_unref(layer);
}

static void triangle_counts_equal_vtk_on_seras_own_head(void **state)
{
    (void)state;
    struct volume *layer = read_sera_head();
    assert_equals_vtk(layer, sera_sets, 3);
    volume_unref(layer);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(triangle_counts_equal_vtk_on_a_noisy_phantom),
        cmocka_unit_test(seras_own_head_has_the_counts_and_volumes_it_should),
        cmocka_unit_test(eight_cell_counts_equal_the_original_sera3d_on_its_own_head),
        cmocka_unit_test(triangle_counts_equal_vtk_on_seras_own_head),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Mesh files: byte for byte by the formats' specifications, and as VTK reads them. */
#include <unistd.h>

#include "core/base/file_write.h"
#include "core/region/mask.h"
#include "core/surface/mesh_export.h"
#include "core/surface/surface.h"
#include "tests/check.h"
#include "tests/unit/oracle.h"

#define NO_LIMIT UINT64_MAX

static const struct mesh_export_about about = { "head-3", "brain", "marching-cubes", true, false, { 255, 0, 188 } };

/* A corner of a box, 3 mm left, 4 mm posterior, 12 mm superior: its slanted side has the normal (4 3 1) / sqrt(26). */
static struct mesh *make_corner(void)
{
    static const float positions[] = { 0, 0, 0, 3, 0, 0, 0, 4, 0, 0, 0, 12 };
    static const uint32_t indices[] = { 0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3 };
    struct error err = { 0 };
    struct mesh *mesh = mesh_create(4, 4, &err);
    assert_non_null(mesh);
    memcpy(mesh->positions_lps_mm, positions, sizeof positions);
    memcpy(mesh->indices, indices, sizeof indices);
    assert_true(mesh_make_normals(mesh, 1, &err));
    return mesh;
}

static uint8_t *export_of(const struct mesh *mesh, enum mesh_format format, const struct mesh_export_about *what,
                          size_t *n)
{
    struct error err = { 0 };
    uint8_t *bytes = mesh_export(mesh, format, what, NO_LIMIT, n, &err);
    assert_string_equal(err.text, "");
    assert_non_null(bytes);
    return bytes;
}

static uint32_t u32_at(const uint8_t *at)
{
    return (uint32_t)at[0] | (uint32_t)at[1] << 8 | (uint32_t)at[2] << 16 | (uint32_t)at[3] << 24;
}

static double float_at(const uint8_t *at)
{
    uint32_t bits = u32_at(at);
    float value;
    memcpy(&value, &bits, sizeof value);
    return (double)value;
}

static void stl_is_eighty_bytes_a_count_and_fifty_bytes_a_triangle(void **state)
{
    (void)state;
    struct mesh *mesh = make_corner();
    size_t n;
    uint8_t *bytes = export_of(mesh, MESH_STL, &about, &n);
    assert_int_equal(n, 84 + 50 * 4);
    assert_string_equal((char *)bytes, "Beamroom mm LPS brain"); /* padded with zeros */
    assert_int_equal(u32_at(bytes + 80), 4);
    const uint8_t *last = bytes + 84 + 3 * 50;
    static const double expected[12] = { 4, 3, 1, 3, 0, 0, 0, 4, 0, 0, 0, 12 }; /* normal, then corners 1, 2, 3 */
    for (size_t i = 0; i < 12; i++)
        assert_close(float_at(last + 4 * i), i < 3 ? expected[i] / sqrt(26) : expected[i], 1e-7);
    assert_int_equal(last[48] | last[49], 0);
    free(bytes);

    char id[64];
    memset(id, 'x', 63);
    id[63] = 0;
    struct mesh_export_about longest = about;
    longest.region_id = id;
    bytes = export_of(mesh, MESH_STL, &longest, &n);
    assert_memory_equal(bytes, "Beamroom mm LPS xxxxxxxx", 24);
    assert_int_equal(bytes[78], 'x');
    assert_int_equal(bytes[79], 0);
    assert_int_equal(u32_at(bytes + 80), 4);
    free(bytes);
    mesh_unref(mesh);
}

static void a_triangle_without_area_has_the_normal_zero_in_stl(void **state)
{
    (void)state;
    struct mesh *mesh = make_corner();
    mesh->indices[2] = mesh->indices[1];
    size_t n;
    uint8_t *bytes = export_of(mesh, MESH_STL, &about, &n);
    for (size_t axis = 0; axis < 3; axis++)
        assert_close(float_at(bytes + 84 + 4 * axis), 0, 0);
    free(bytes);
    mesh_unref(mesh);
}

static void ply_states_unit_space_and_origin_and_holds_points_normals_and_faces(void **state)
{
    (void)state;
    struct mesh *mesh = make_corner();
    struct mesh_export_about what = about;
    for (int faceted = 0; faceted < 2; faceted++) {
        size_t n;
        what.is_faceted = faceted;
        uint8_t *bytes = export_of(mesh, MESH_PLY, &what, &n);
        char head[2048];
        snprintf(head, sizeof head,
                 "ply\nformat binary_little_endian 1.0\n"
                 "comment Beamroom surface, for research and plan review, not for treatment\n"
                 "comment a phantom, not a patient\n"
                 "comment unit mm\n"
                 "comment space DICOM LPS: x to the patient's left, y to posterior, z to superior\n"
                 "comment plan head-3\ncomment region brain\ncomment algorithm marching-cubes\n"
                 "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n%s"
                 "element face 4\nproperty list uchar int vertex_indices\nend_header\n",
                 faceted ? "" : "property float nx\nproperty float ny\nproperty float nz\n");
        size_t n_head = strlen(head), row = faceted ? 12 : 24;
        assert_int_equal(n, n_head + 4 * row + 4 * 13);
        assert_memory_equal(bytes, head, n_head);
        assert_close(float_at(bytes + n_head + 3 * row + 8), 12, 0); /* z of the last vertex */
        if (!faceted) {
            double square = 0;
            for (size_t axis = 0; axis < 3; axis++)
                square += pow(float_at(bytes + n_head + 12 + 4 * axis), 2);
            assert_close(square, 1, 1e-6);
        }
        const uint8_t *face = bytes + n_head + 4 * row + 3 * 13;
        assert_int_equal(face[0], 3);
        for (uint32_t c = 0; c < 3; c++)
            assert_int_equal(u32_at(face + 1 + 4 * c), c + 1);
        free(bytes);
    }
    mesh_unref(mesh);
}

/* Checks a GLB: header, JSON chunk, BIN chunk, each a multiple of four bytes, lengths that add up (glTF 2.0, 4.4).
 * Returns the JSON; free it. */
static char *check_glb(const uint8_t *bytes, size_t n, uint32_t n_expected_data)
{
    assert_memory_equal(bytes, "glTF", 4);
    assert_int_equal(u32_at(bytes + 4), 2);
    assert_int_equal(u32_at(bytes + 8), n);
    uint32_t n_json = u32_at(bytes + 12);
    assert_memory_equal(bytes + 16, "JSON", 4);
    assert_int_equal(n_json % 4, 0);
    const uint8_t *data = bytes + 20 + n_json;
    assert_int_equal(u32_at(data), n_expected_data);
    assert_memory_equal(data + 4, "BIN\0", 4);
    assert_int_equal(n, 20 + n_json + 8 + n_expected_data);
    assert_int_equal(n % 4, 0);
    return strndup((const char *)bytes + 20, n_json);
}

static void glb_holds_mm_lps_below_a_node_that_turns_them_to_metres_with_the_top_up(void **state)
{
    (void)state;
    struct mesh *mesh = make_corner();
    struct mesh_export_about what = about;
    size_t n;
    uint8_t *bytes = export_of(mesh, MESH_GLB, &what, &n);
    char *json = check_glb(bytes, n, 4 * 12 + 4 * 12 + 4 * 12);
    const uint8_t *data = bytes + n - 144;
    assert_close(float_at(data + 3 * 12 + 8), 12, 0); /* the vertex positions stay in mm LPS */
    assert_int_equal(u32_at(data + 48 + 4), 2);       /* second index */
    for (const char *const *part =
             (const char *const[]){
                 "\"matrix\":[0.001,0,0,0,0,0,-0.001,0,0,0.001,0,0,0,0,0,1]", "\"min\":[0,0,0],\"max\":[3,4,12]",
                 "\"unit\":\"mm\"", "DICOM LPS",
                 "\"plan\":\"head-3\",\"region\":\"brain\",\"algorithm\":\"marching-cubes\",\"phantom\":true",
                 "\"NORMAL\":2", "\"buffers\":[{\"byteLength\":144}]",
                 "\"baseColorFactor\":[1.0000,0.0000,0.5029,1]", /* sRGB 188 is half the linear intensity */
                 NULL };
         *part; part++)
        if (!strstr(json, *part))
            fail_msg("%s is not in %s", *part, json);
    free(json);
    free(bytes);

    what.is_faceted = true;
    bytes = export_of(mesh, MESH_GLB, &what, &n);
    json = check_glb(bytes, n, 4 * 12 + 4 * 12);
    assert_null(strstr(json, "NORMAL"));
    free(json);
    free(bytes);
    mesh_unref(mesh);
}

static void what_ids_hold_cannot_break_a_head(void **state)
{
    (void)state;
    struct mesh *mesh = make_corner();
    char wild[400];
    memset(wild, 1, sizeof wild - 1);
    wild[sizeof wild - 1] = 0;
    const struct mesh_export_about worst = {
        wild, wild, wild, true, false, { 0 }
    }; /* 63 bytes each, six characters per byte */
    const struct mesh_export_about quotes = { "a\"b\\c\nend_header\n", "x", "y", false, false, { 0 } };
    size_t n;
    uint8_t *bytes = export_of(mesh, MESH_GLB, &worst, &n);
    free(check_glb(bytes, n, 144));
    free(bytes);
    bytes = export_of(mesh, MESH_GLB, &quotes, &n);
    char *json = check_glb(bytes, n, 144);
    assert_non_null(strstr(json, "\"plan\":\"a\\\"b\\\\c\\u000aend_header\\u000a\","));
    free(json);
    free(bytes);
    bytes = export_of(mesh, MESH_PLY, &quotes, &n);
    char *head = strndup((char *)bytes, n);
    assert_non_null(strstr(head, "comment plan a\"b\\c?end_header?\ncomment region x\n"));
    free(head);
    free(bytes);
    mesh_unref(mesh);
}

static void more_bytes_than_allowed_and_an_empty_surface_are_refused(void **state)
{
    (void)state;
    struct mesh *mesh = make_corner();
    struct error err = { 0 };
    for (enum mesh_format format = MESH_STL; format <= MESH_GLB; format++) {
        size_t n, again;
        uint8_t *bytes = export_of(mesh, format, &about, &n);
        free(bytes);
        bytes = mesh_export(mesh, format, &about, n, &again, &err);
        assert_non_null(bytes);
        assert_int_equal(again, n);
        free(bytes);
        assert_null(mesh_export(mesh, format, &about, n - 1, &again, &err));
        assert_int_equal(err.code, ERROR_LIMIT);
        assert_non_null(strstr(err.text, mesh_format_word(format)));
    }
    mesh->n_triangles = 0;
    size_t n;
    for (enum mesh_format format = MESH_STL; format <= MESH_GLB; format++) {
        assert_null(mesh_export(mesh, format, &about, NO_LIMIT, &n, &err));
        assert_int_equal(err.code, ERROR_RANGE);
    }
    mesh_unref(mesh);
}

static void what_a_format_cannot_count_is_refused_before_anything_is_read(void **state)
{
    (void)state;
    float point[3] = { 0 };
    uint32_t index[3] = { 0 };
    struct error err = { 0 };
    size_t n;
    struct mesh large = {
        .positions_lps_mm = point, .normals = point, .indices = index, .n_vertices = 1, .n_triangles = (size_t)1 << 33
    };
    assert_null(mesh_export(&large, MESH_STL, &about, NO_LIMIT, &n, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    err = (struct error){ 0 };
    assert_null(mesh_export(&large, MESH_PLY, &about, NO_LIMIT, &n, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    large.n_triangles = (size_t)1 << 29; /* 6 GiB of indices: a GLB's length has 32 bits */
    err = (struct error){ 0 };
    assert_null(mesh_export(&large, MESH_GLB, &about, NO_LIMIT, &n, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
}

static void words_and_formats_name_each_other(void **state)
{
    (void)state;
    for (enum mesh_format format = MESH_STL; format <= MESH_GLB; format++) {
        enum mesh_format other = MESH_STL;
        assert_true(mesh_format_from_word(mesh_format_word(format), &other));
        assert_int_equal(other, format);
    }
    enum mesh_format kept = MESH_GLB;
    assert_false(mesh_format_from_word("obj", &kept));
    assert_int_equal(kept, MESH_GLB);
}

/* ---- as VTK reads them ------------------------------------------------------------------------------------------ */

/* An ellipsoid off the centre of a rotated grid with unequal spacing, so that no two axes can be confused. */
static struct mesh *make_ellipsoid(enum surface_algorithm algorithm)
{
    const double c = cos(0.3), s = sin(0.3);
    struct affine map = { { { 1.5 * c, -2 * s, 0 }, { 1.5 * s, 2 * c, 0 }, { 0, 0, 3 } }, { 40, -70, 110 } };
    struct grid grid;
    struct error err = { 0 };
    assert_true(grid_init(&grid, (uint32_t[3]){ 40, 36, 30 }, &map, &err));
    struct volume *layer = volume_create(&grid, VOXEL_U8, &err);
    assert_non_null(layer);
    uint8_t *voxel = layer->voxels;
    for (uint32_t k = 0; k < 30; k++)
        for (uint32_t j = 0; j < 36; j++)
            for (uint32_t i = 0; i < 40; i++)
                *voxel++ = pow((i - 20.0) / 15, 2) + pow((j - 16.0) / 14, 2) + pow((k - 14.0) / 12, 2) < 1;
    struct mask *mask = mask_from_labels(layer, (uint16_t[]){ 1 }, 1, 1, &err);
    assert_non_null(mask);
    struct mesh *mesh = surface_make(algorithm, mask, &surface_defaults, &err);
    assert_non_null(mesh);
    assert_true(mesh_make_normals(mesh, 1, &err));
    mesh_measure_bounds(mesh);
    mask_destroy(mask);
    volume_unref(layer);
    return mesh;
}

static void assert_vtk_reads_the_same(enum surface_algorithm algorithm)
{
    struct mesh *mesh = make_ellipsoid(algorithm);
    struct error err = { 0 };
    char folder[] = "/tmp/beamroom-export-XXXXXX", paths[3][64], out[2048], *at = out;
    assert_non_null(mkdtemp(folder));
    for (enum mesh_format format = MESH_STL; format <= MESH_GLB; format++) {
        size_t n;
        uint8_t *bytes = export_of(mesh, format, &about, &n);
        snprintf(paths[format], sizeof paths[format], "%s/surface.%s", folder, mesh_format_word(format));
        assert_true(file_write(paths[format], bytes, n, &err));
        free(bytes);
    }
    char *arguments[] = { oracle_python(), "tests/oracle/mesh_vtk.py", paths[0], paths[1], paths[2], NULL };
    int status = oracle_run(arguments, out, sizeof out);
    for (int i = 0; i < 3; i++)
        unlink(paths[i]);
    rmdir(folder);
    struct box3 box = mesh->bounds_lps_mm;
    double area = mesh_area_mm2(mesh), volume = mesh_volume_mm3(mesh);
    size_t n_triangles = mesh->n_triangles;
    mesh_unref(mesh);
    if (status == ORACLE_MISSING) {
        print_message("no VTK for Python here\n");
        skip();
    }
    assert_int_equal(status, 0);
    for (enum mesh_format format = MESH_STL; format <= MESH_GLB; format++) {
        double values[9];
        for (int i = 0; i < 9; i++)
            values[i] = strtod(at, &at);
        bool is_glb = format == MESH_GLB;
        double scale = is_glb ? 1e-3 : 1,
               tolerance = 1e-4 * scale; /* floats of some 200 mm: 1e-5 mm, times their differences */
        assert_int_equal(values[0], n_triangles);
        assert_near(values[1], area * scale * scale, 1e-4);
        assert_near(values[2], volume * scale * scale * scale, 1e-4);
        /* the bounds; for GLB as x left, y superior, z anterior */
        double low[3] = { box.low.x, box.low.y, box.low.z }, high[3] = { box.high.x, box.high.y, box.high.z };
        if (is_glb) {
            low[1] = box.low.z, high[1] = box.high.z;
            low[2] = -box.high.y, high[2] = -box.low.y;
        }
        for (int axis = 0; axis < 3; axis++) {
            assert_close(values[3 + axis], low[axis] * scale, tolerance);
            assert_close(values[6 + axis], high[axis] * scale, tolerance);
        }
    }
}

static void vtk_reads_the_same_triangles_area_volume_and_places_from_every_format(void **state)
{
    (void)state;
    for (enum surface_algorithm algorithm = 0; algorithm < SURFACE_N_ALGORITHMS; algorithm++)
        assert_vtk_reads_the_same(algorithm);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stl_is_eighty_bytes_a_count_and_fifty_bytes_a_triangle),
        cmocka_unit_test(a_triangle_without_area_has_the_normal_zero_in_stl),
        cmocka_unit_test(ply_states_unit_space_and_origin_and_holds_points_normals_and_faces),
        cmocka_unit_test(glb_holds_mm_lps_below_a_node_that_turns_them_to_metres_with_the_top_up),
        cmocka_unit_test(what_ids_hold_cannot_break_a_head),
        cmocka_unit_test(more_bytes_than_allowed_and_an_empty_surface_are_refused),
        cmocka_unit_test(what_a_format_cannot_count_is_refused_before_anything_is_read),
        cmocka_unit_test(words_and_formats_name_each_other),
        cmocka_unit_test(vtk_reads_the_same_triangles_area_volume_and_places_from_every_format),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

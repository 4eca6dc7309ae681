/* Images on planes against numpy's own resampling (tests/oracle/plane_values.py): panes and inlays at random planes. */
#include "core/render/visible/visible.h"
#include "tests/render/shots.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/oracle.h"

enum { WIDTH = 240, HEIGHT = 180, N_GRIDS = 3, N_TYPES = 4, N_PLANES = 2, N_CASES = N_GRIDS * N_TYPES * N_PLANES * 2 };
static const double pixels_per_mm = 4;

static struct resample_case {
    struct plan *plan; /* of the grid and type; shared by its cases */
    struct plane plane;
    struct vec3 normal;
    bool is_linear;
} cases[N_CASES];
static struct plan *plans[N_GRIDS * N_TYPES];
static char folder[256];
static bool is_missing;

/* ---- made-up grids ---------------------------------------------------------------------------------------------- */

static uint64_t seed = 20260701;
/* 0 .. 1. Source: G. Steele, D. Lea, C. Flood, Fast Splittable Pseudorandom Number Generators, OOPSLA 2014. */
static double any(void)
{
    seed += 0x9e3779b97f4a7c15u;
    uint64_t z = seed;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static struct vec3 any_direction(void)
{
    double rise = asin(2 * any() - 1), turn = 2 * MATH_PI * any();
    return vec3(cos(rise) * cos(turn), cos(rise) * sin(turn), sin(rise));
}

/* Thick slices along the patient's axes; a turned grid whose second axis runs backwards; one whose slices are sheared
 * as by a tilted gantry. About 40 mm a side. */
static struct grid grid_of(int kind)
{
    static const uint32_t sizes[N_GRIDS][3] = { { 40, 50, 10 }, { 24, 18, 30 }, { 30, 36, 14 } };
    const uint32_t *size = sizes[kind];
    const struct vec3 middle = vec3(5.3, -7.1, 11.9);
    double c = cos(0.4), s = sin(0.4);
    if (kind == 0)
        return made_grid(size[0], size[1], size[2],
                         made_affine(vec3(1, 0, 0), vec3(0, 0.8, 0), vec3(0, 0, 4), size, middle));
    if (kind == 1)
        return made_grid(size[0], size[1], size[2],
                         made_affine(vec3(1.6 * c, 0.9 * s, 1.3 * s), vec3(0.3, -2.1 * c, 0.2), vec3(-1.3 * s, 0, c),
                                     size, middle));
    return made_grid(size[0], size[1], size[2],
                     made_affine(vec3(1.3, 0, 0), vec3(0, 1.1, 0), vec3(0, 0.9, 2.8), size, middle));
}

/* Neighbouring voxels have nothing to do with each other: steps between them are as large as there are. */
static struct plan *plan_of(int kind, enum voxel_type type)
{
    struct error err = { 0 };
    struct grid grid = grid_of(kind);
    struct volume *volume = volume_create(&grid, type, &err);
    assert_non_null(volume);
    size_t n = grid_n_voxels(&grid);
    for (size_t i = 0; i < n; i++) {
        double part = any();
        switch (type) {
        case VOXEL_U8: ((uint8_t *)volume->voxels)[i] = (uint8_t)(256 * part); break;
        case VOXEL_I16: ((int16_t *)volume->voxels)[i] = (int16_t)(-32768 + 65536 * part); break;
        case VOXEL_U16: ((uint16_t *)volume->voxels)[i] = (uint16_t)(65536 * part); break;
        case VOXEL_F32: ((float *)volume->voxels)[i] = part < 0.01 ? NAN : (float)(1e-3 * part); break;
        }
    }
    volume->slope = type == VOXEL_I16 ? 0.25 : 1;
    volume->offset = type == VOXEL_I16 ? -100 : 0;
    volume_measure(volume);
    struct plan *plan = plan_create("made");
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    (void)snprintf(plan->images[0].id, sizeof plan->images[0].id, "image");
    plan->images[0].volume = volume;
    plan->n_images = 1;
    return plan;
}

/* ---- numpy's part ----------------------------------------------------------------------------------------------- */

static void put_numbers(FILE *out, struct vec3 v)
{
    (void)fprintf(out, " %.17g %.17g %.17g", v.x, v.y, v.z);
}

static void write_case(int number)
{
    static const char *const words[] = {
        [VOXEL_U8] = "uint8", [VOXEL_I16] = "int16", [VOXEL_U16] = "uint16", [VOXEL_F32] = "float32"
    };
    const struct resample_case *c = &cases[number];
    const struct volume *volume = c->plan->images[0].volume;
    const struct affine *map = &volume->grid.lps_mm_from_ijk;
    char name[32], *text = NULL;
    size_t length;
    FILE *out = open_memstream(&text, &length);
    assert_non_null(out);
    (void)fprintf(out, "%s %u %u %u %.17g %.17g", words[volume->type], volume->grid.size[0], volume->grid.size[1],
                  volume->grid.size[2], volume->slope, volume->offset);
    for (int i = 0; i < 3; i++)
        put_numbers(out, map->columns[i]);
    put_numbers(out, map->origin);
    put_numbers(out, c->plane.origin_lps_mm);
    put_numbers(out, c->plane.right);
    put_numbers(out, c->plane.up);
    (void)fprintf(out, " %d %d %.17g %d\n", WIDTH, HEIGHT, pixels_per_mm, c->is_linear);
    (void)fclose(out);
    (void)snprintf(name, sizeof name, "%d.case", number);
    folder_put(folder, name, text, length);
    (void)snprintf(name, sizeof name, "%d.raw", number);
    folder_put(folder, name, volume->voxels, grid_n_voxels(&volume->grid) * voxel_size(volume->type));
    free(text);
}

static void make_cases(void)
{
    int n = 0;
    for (int i = 0; i < N_GRIDS * N_TYPES; i++) {
        plans[i] = plan_of(i / N_TYPES, (enum voxel_type)(i % N_TYPES));
        for (int p = 0; p < N_PLANES; p++) {
            struct vec3 origin = vec3(5.3 + 8 * (any() - 0.5), -7.1 + 8 * (any() - 0.5), 11.9 + 8 * (any() - 0.5)),
                        normal = vec3_scale(any_direction(), 1 + 4 * any());
            struct plane plane = plane_of_normal(origin, normal);
            for (int linear = 0; linear < 2; linear++)
                cases[n++] = (struct resample_case){ plans[i], plane, normal, linear };
        }
    }
}

static void *read_part(int number, const char *ending, size_t size)
{
    char path[300];
    size_t found;
    (void)snprintf(path, sizeof path, "%s/%d.%s", folder, number, ending);
    void *bytes = file_bytes(path, &found);
    assert_int_equal(found, size);
    return bytes;
}

/* ---- pictures --------------------------------------------------------------------------------------------------- */

static struct image *draw(const struct resample_case *c, bool is_inlay, double *low, double *width)
{
    const struct volume *volume = c->plan->images[0].volume;
    struct scene scene = shots_scene(c->plan);
    struct view view = shots_view(SCENE_KIND_OBLIQUE, c->plane.origin_lps_mm, pixels_per_mm);
    *low = volume->low - 0.1 * (volume->high - volume->low);
    *width = 1.1 * (volume->high - volume->low);
    scene.image.window.center = *low + *width / 2;
    scene.image.window.width = *width;
    scene.image.interpolation = c->is_linear ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
    scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    scene.image.obliques = mem_new(sizeof *scene.image.obliques);
    scene.image.n_obliques = 1;
    scene.image.obliques[0] = (struct scene_oblique_entry){ .id = "a", .value = scene_oblique_default };
    scene.image.obliques[0].value.visible = is_inlay;
    scene.image.obliques[0].value.origin_mm = c->plane.origin_lps_mm;
    scene.image.obliques[0].value.normal = c->normal;
    (void)snprintf(view.plane, sizeof view.plane, "a");
    if (is_inlay) /* seen square on, from where right x up points */
        view = shots_view_from(c->plane.origin_lps_mm, vec3_cross(c->plane.right, c->plane.up), c->plane.up,
                               pixels_per_mm);
    view.size_px[0] = WIDTH;
    view.size_px[1] = HEIGHT;
    view.camera.height_mm = HEIGHT / pixels_per_mm;
    return shots_plain(c->plan, scene, view);
}

/* Rounding to a byte is half a grey level; one level is what the eye is promised. */
static void compare(int number, bool is_inlay)
{
    const struct resample_case *c = &cases[number];
    double low, width;
    struct image *image = draw(c, is_inlay, &low, &width);
    double *values = read_part(number, "values", sizeof *values * WIDTH * HEIGHT);
    uint8_t *sure = read_part(number, "sure", WIDTH * HEIGHT);
    size_t n_inside = 0, n_outside = 0;
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) {
            double value = values[y * WIDTH + x];
            const uint8_t *pixel = shots_pixel(image, x, y);
            if (!sure[y * WIDTH + x])
                continue;
            for (int channel = 0; channel < 3; channel++) {
                double grey = isnan(value) ? 0 : 255 * (value - low) / width;
                if (fabs(pixel[channel] - fmax(grey, shots_background[channel])) > 1)
                    fail_msg("case %d%s at %d, %d: %d, numpy says %.3f", number, is_inlay ? " in space" : "", x, y,
                             pixel[channel], grey);
            }
            *(isnan(value) ? &n_outside : &n_inside) += 1;
        }
    assert_true(n_inside > WIDTH * HEIGHT / 10);
    assert_true(n_inside + n_outside > WIDTH * HEIGHT * 9 / 10);
    free(values);
    free(sure);
    image_destroy(image);
}

static void panes_at_random_planes_show_what_numpy_resamples(void **state)
{
    (void)state;
    if (is_missing)
        skip();
    for (int i = 0; i < N_CASES; i++)
        compare(i, false);
}

static void inlays_at_random_planes_show_what_numpy_resamples(void **state)
{
    (void)state;
    if (is_missing)
        skip();
    for (int i = 0; i < N_CASES; i++)
        compare(i, true);
}

/* ---- thick slices ----------------------------------------------------------------------------------------------- */

static double ramp(struct vec3 p)
{
    return 5 * p.z + 100; /* 0 .. 200 from -20 to 20 mm */
}

/* Slices of 4 mm with a value that is linear across them: between their centres every row of a pane has its own value,
 * to the byte's rounding; with nearest there are steps of 20. */
static void thick_slices_show_no_steps_with_linear_interpolation(void **state)
{
    (void)state;
    const uint32_t size[3] = { 30, 30, 10 };
    struct grid grid = made_grid(size[0], size[1], size[2],
                                 made_affine(vec3(1, 0, 0), vec3(0, 1, 0), vec3(0, 0, 4), size, vec3(0, 0, 0)));
    struct plan *plan = plan_create("made");
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    made_plan_add_image(plan, &grid, VOXEL_F32, ramp);
    for (int kind = SCENE_KIND_CORONAL; kind <= SCENE_KIND_SAGITTAL; kind++)
        for (int linear = 0; linear < 2; linear++) {
            struct scene scene = shots_scene(plan);
            scene.image.window.center = 127.5;
            scene.image.window.width = 255;
            scene.image.interpolation = linear ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
            struct image *image = shots_plain(plan, scene, shots_view((enum scene_kind)kind, vec3(0, 0, 0), 7));
            int largest = 0, before = -1;
            for (int y = 0; y < SHOTS_HEIGHT; y++) {
                double z = (SHOTS_HEIGHT / 2.0 - y - 0.5) / 7;
                int level = shots_pixel(image, SHOTS_WIDTH / 2, y)[0];
                if (fabs(z) > 18 || (!linear && fabs(z) > 17.9))
                    continue;
                if (linear)
                    assert_close(level, ramp(vec3(0, 0, z)), 0.51);
                if (before >= 0 && before - level > largest)
                    largest = before - level;
                before = level;
            }
            assert_int_equal(largest, linear ? 1 : 20);
            image_destroy(image);
        }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(panes_at_random_planes_show_what_numpy_resamples),
        cmocka_unit_test(inlays_at_random_planes_show_what_numpy_resamples),
        cmocka_unit_test(thick_slices_show_no_steps_with_linear_interpolation),
    };
    char out[4096], script[] = "tests/oracle/plane_values.py";
    folder_make(folder);
    make_cases();
    for (int i = 0; i < N_CASES; i++)
        write_case(i);
    int status = oracle_run((char *[]){ oracle_python(), script, folder, NULL }, out, sizeof out);
    is_missing = status == ORACLE_MISSING;
    if (status != 0 && !is_missing) {
        printf("%s: status %d: %s\n", script, status, out);
        return 1;
    }
    int failed = shots_run("resample", tests, sizeof tests / sizeof tests[0]);
    for (size_t i = 0; i < sizeof plans / sizeof plans[0]; i++)
        plan_and_derived_destroy(plans[i]);
    folder_remove(folder);
    return failed;
}

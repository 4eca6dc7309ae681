/* Slice panes: outlines of regions, the check of a segmentation and the grid of a dose, on grids square to the patient
 * and on oblique ones; images on grids of their own; low values white. */
#include "core/derive/region_shape.h"
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 };
static const enum scene_kind kinds[3] = { SCENE_KIND_AXIAL, SCENE_KIND_CORONAL, SCENE_KIND_SAGITTAL };

/* Turned about two axes, voxels of 1.2 x 0.9 x 1.5 mm, the third axis backwards. */
static struct grid oblique_grid(uint32_t side)
{
    const uint32_t size[3] = { side, side, side };
    double c = cos(0.4), s = sin(0.4), d = cos(0.25), e = sin(0.25);
    return made_grid(side, side, side,
                     made_affine(vec3(1.2 * c, 1.2 * s, 0), vec3(-0.9 * s * d, 0.9 * c * d, 0.9 * e),
                                 vec3(-1.5 * s * e, 1.5 * c * e, -1.5 * d), size, origin));
}

/* Position of a patient point on a pane. Right is patient left on axial and coronal panes, posterior on sagittal ones;
 * up is anterior on axial panes, superior on the others. */
static void on_pane(enum scene_kind kind, struct vec3 p, double pixels_per_mm, double *x, double *y)
{
    double right = kind == SCENE_KIND_SAGITTAL ? p.y : p.x, up = kind == SCENE_KIND_AXIAL ? -p.y : p.z;
    *x = SHOTS_WIDTH / 2.0 + right * pixels_per_mm;
    *y = SHOTS_HEIGHT / 2.0 - up * pixels_per_mm;
}

static void set_slices(struct scene *scene, struct vec3 at)
{
    scene->image.slices.sagittal.position_mm = at.x;
    scene->image.slices.coronal.position_mm = at.y;
    scene->image.slices.axial.position_mm = at.z;
}

static double no_value(struct vec3 p)
{
    return p.x > 1e9;
} /* a black image */

/* ---- outlines --------------------------------------------------------------------------------------------------- */

/* A box off the middle, a different length along each axis; voxel centres at halves. */
static const struct vec3 box_low = { -8, -3, 2 }, box_high = { 10, 9, 16 };
static double box_label(struct vec3 p)
{
    return p.x > box_low.x && p.x < box_high.x && p.y > box_low.y && p.y < box_high.y && p.z > box_low.z &&
                   p.z < box_high.z
               ? 1
               : 0;
}
static const struct made_region box[] = { { "box", -1, 0x30ff60 } };

static bool is_green(const uint8_t *pixel)
{
    return pixel[1] > 200 && pixel[0] < 80;
}

/* Distance outside a rectangle; negative inside. */
static double beyond(double x, double y, const double low[2], const double high[2])
{
    return fmax(fmax(low[0] - x, x - high[0]), fmax(low[1] - y, y - high[1]));
}

static void outlines_lie_on_the_regions_border(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    for (int method = 0; method < 2; method++)
        for (int k = 0; k < 3; k++) {
            struct plan *plan = made_plan(&grid, box_label, box, 1);
            made_plan_add_image(plan, &grid, VOXEL_U8, no_value);
            struct scene scene = shots_scene(plan);
            scene.outline.method = method ? SCENE_OUTLINE_METHOD_MARCHING_SQUARES : SCENE_OUTLINE_METHOD_TRACED;
            scene.outline.width_px = 3;
            set_slices(&scene, vec3(1.3, 2.2, 7.6));
            struct image *image = shots_plain(plan, scene, shots_view(kinds[k], origin, 7));
            /* a traced outline runs through the centres of border voxels, marching squares along the border */
            double inset = method ? 0 : 0.5, x[2], y[2];
            on_pane(kinds[k], vec3_add(box_low, vec3(inset, inset, inset)), 7, &x[0], &y[0]);
            on_pane(kinds[k], vec3_sub(box_high, vec3(inset, inset, inset)), 7, &x[1], &y[1]);
            const double low[2] = { fmin(x[0], x[1]), fmin(y[0], y[1]) },
                         high[2] = { fmax(x[0], x[1]), fmax(y[0], y[1]) };
            size_t n = 0;
            for (int row = 0; row < SHOTS_HEIGHT; row++)
                for (int column = 0; column < SHOTS_WIDTH; column++) {
                    double off = beyond(column + 0.5, row + 0.5, low, high);
                    bool is_corner = method && fmin(fabs(column + 0.5 - low[0]), fabs(column + 0.5 - high[0])) < 7 &&
                                     fmin(fabs(row + 0.5 - low[1]), fabs(row + 0.5 - high[1])) < 7; /* cut off there */
                    if (fabs(off) < 0.9 && !is_corner) { /* half of 3 px, minus half a pixel of anti-aliasing */
                        assert_true(is_green(shots_pixel(image, column, row)));
                        n++;
                    } else if (fabs(off) > 2.1 && !is_corner)
                        assert_false(is_green(shots_pixel(image, column, row)));
                }
            assert_true(n > 200);
            image_destroy(image);
            shots_forget(plan);
        }
}

static double ball_label(struct vec3 p)
{
    return vec3_length(vec3_sub(p, vec3(3, -2, 4))) < 12 ? 1 : 0;
}

static void outlines_of_oblique_grids_are_within_a_voxel_of_the_truth(void **state)
{
    (void)state;
    struct grid grid = oblique_grid(48);
    for (int k = 0; k < 3; k++) {
        struct plan *plan = made_plan(&grid, ball_label, box, 1);
        made_plan_add_image(plan, &grid, VOXEL_U8, no_value);
        struct scene scene = shots_scene(plan);
        scene.outline.method = SCENE_OUTLINE_METHOD_MARCHING_SQUARES;
        set_slices(&scene, vec3(3, -2, 4));
        struct image *image = shots_plain(plan, scene, shots_view(kinds[k], origin, 7));
        double x, y, least = INFINITY, most = 0;
        on_pane(kinds[k], vec3(3, -2, 4), 7, &x, &y);
        size_t n = 0;
        for (int row = 0; row < SHOTS_HEIGHT; row++)
            for (int column = 0; column < SHOTS_WIDTH; column++)
                if (is_green(shots_pixel(image, column, row))) {
                    double radius_mm = hypot(column + 0.5 - x, row + 0.5 - y) / 7;
                    least = fmin(least, radius_mm);
                    most = fmax(most, radius_mm);
                    n++;
                }
        assert_true(n > 300);
        assert_true(least > 12 - 1.4 && most < 12 + 1.4); /* half a voxel's diagonal of 2.1 mm, and the line */
        image_destroy(image);
        shots_forget(plan);
    }
}

static double nested_label(struct vec3 p)
{
    double r = fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z)));
    return r < 5 ? 3 : r < 10 ? 2 : r < 15 ? 1 : 0;
}
static const struct made_region nested[] = { { "outer", -1, 0xff3030 },
                                             { "middle", 0, 0x30ff60 },
                                             { "inner", 1, 0x3030ff } };

static void only_visible_regions_have_outlines_and_the_higher_order_is_on_top(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, nested_label, nested, 3);
    made_plan_add_image(plan, &grid, VOXEL_U8, no_value);
    struct scene scene = shots_scene(plan);
    scene.outline.method = SCENE_OUTLINE_METHOD_MARCHING_SQUARES;
    scene.outline.width_px = 3;
    set_slices(&scene, vec3(0.5, 0.5, 0.5));
    shots_style(&scene, "middle")->visible = false;
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 8));
    assert_true(shots_pixel(image, 200 + 15 * 8, 150)[0] > 200);
    assert_false(is_green(shots_pixel(image, 200 + 10 * 8, 150)));
    assert_true(shots_pixel(image, 200 + 5 * 8, 150)[2] > 200);
    image_destroy(image);

    scene = shots_scene(plan);
    scene.outline.on_slices = false;
    scene.image.window.center = 100;
    set_slices(&scene, vec3(0.5, 0.5, 0.5));
    image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 8));
    for (int x = 0; x < SHOTS_WIDTH; x++) /* nothing but the black image */
        assert_true(shots_pixel(image, x, 150)[0] < 20 && shots_pixel(image, x, 150)[2] < 20);
    image_destroy(image);
    shots_forget(plan);
}

static double all_label(struct vec3 p)
{
    return fabs(p.x) < 10 && fabs(p.y) < 10 && fabs(p.z) < 10 ? 1 : 0;
}
static const struct made_region equals[] = { { "red", -1, 0xff3030 }, { "green", -1, 0x30ff60 } };

static void the_order_decides_between_outlines_that_coincide(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    for (int top = 0; top < 2; top++) {
        struct plan *plan = made_plan(&grid, all_label, equals, 2);
        made_plan_add_image(plan, &grid, VOXEL_U8, no_value);
        plan->regions.layers[1] = made_volume(&grid, VOXEL_U8, all_label);
        plan->regions.n_layers = 2;
        plan->regions.regions[1].layer = 1;
        plan->regions.regions[1].label = 1;
        region_set_measure(&plan->regions);
        struct scene scene = shots_scene(plan);
        scene.outline.method = SCENE_OUTLINE_METHOD_MARCHING_SQUARES;
        scene.outline.width_px = 3;
        shots_style(&scene, top ? "green" : "red")->order = 1;
        struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 8));
        assert_int_equal(is_green(shots_pixel(image, 200 + 80, 150)), top);
        image_destroy(image);
        shots_forget(plan);
    }
}

/* ---- the check -------------------------------------------------------------------------------------------------- */

static void the_check_marks_what_the_surface_leaves_out(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40);
    struct plan *plan = made_plan(&grid, box_label, box, 1);
    made_plan_add_image(plan, &grid, VOXEL_U8, no_value);
    struct scene scene = shots_scene(plan);
    scene.check.visible = true;
    set_slices(&scene, vec3(1.5, 2.5, 7.5));
    struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, false };
    struct render_timing timing;
    struct image *image = shots_take(plan, scene, shots_view(SCENE_KIND_AXIAL, vec3(1, 3, 0), 16), &options, &timing);
    /* marching cubes cuts a triangle with legs of half a voxel off each of four corners: 4 x 1/8 mm2, 256 pixels a mm2
     */
    assert_int_equal(timing.n_added_px, 0);
    assert_close((double)timing.n_left_out_px, 4 * 256 / 8.0,
                 40); /* a row of 8 pixels each way at every corner's long side */
    image_destroy(image);

    /* only where it is asked for, and not in space */
    scene = shots_scene(plan);
    image = shots_take(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 16), &options, &timing);
    assert_int_equal(timing.n_left_out_px, 0);
    image_destroy(image);
    shots_forget(plan);
}

/* Replaces the region's own shape by a box of triangles that is `grown` larger than the voxels on every side. */
static void put_box(struct plan *plan, enum region_representation representation, double grown, bool is_faceted)
{
    static const uint32_t quads[6][4] = { { 0, 4, 6, 2 }, { 1, 3, 7, 5 }, { 0, 1, 5, 4 },
                                          { 2, 6, 7, 3 }, { 0, 2, 3, 1 }, { 4, 5, 7, 6 } };
    struct error err = { 0 };
    struct shape *shape = mem_new(sizeof *shape);
    const struct shape_key key = { .representation = representation, .nurbs_order = 4, .nurbs_bins = 36 };
    const struct region_shape_recipe recipe = region_shape_recipe(subject_region(0), &key, 1);
    struct shape_facts facts = { .reduction = 1 };
    shape->kind = SHAPE_TRIANGLES;
    shape->is_faceted = is_faceted;
    shape->references = 1;
    shape->mesh = mesh_create(8, 12, &err);
    for (size_t v = 0; v < 8; v++) {
        shape->mesh->positions_lps_mm[3 * v] = (float)(v & 1 ? box_high.x + grown : box_low.x - grown);
        shape->mesh->positions_lps_mm[3 * v + 1] = (float)(v & 2 ? box_high.y + grown : box_low.y - grown);
        shape->mesh->positions_lps_mm[3 * v + 2] = (float)(v & 4 ? box_high.z + grown : box_low.z - grown);
    }
    for (size_t q = 0; q < 6; q++)
        for (size_t c = 0; c < 3; c++) {
            shape->mesh->indices[6 * q + c] = quads[q][c];
            shape->mesh->indices[6 * q + 3 + c] = quads[q][c == 0 ? 0 : c + 1];
        }
    assert_true(mesh_make_normals(shape->mesh, 1, &err));
    mesh_measure_bounds(shape->mesh);
    shape->bounds_lps_mm = shape->mesh->bounds_lps_mm;
    region_shape_offer(derived_of(plan), &recipe, shape, &facts);
    shape_unref(shape);
}

/* A surface exactly on the border of the voxels differs nowhere, at any zoom, with the plane inside a voxel or on its
 * face. One that is half a millimetre larger or smaller differs by a frame of that width. An open surface encloses
 * nothing, so it is not checked. */
static void the_check_finds_exactly_what_differs(void **state)
{
    (void)state;
    static const double positions[] = { 3, 4.25, 5.5, 8 }, zooms[] = { 3, 7, 16 };
    static const double faces[] = { 16, 9,
                                    -8 }; /* of the region itself, by kind: all of it or nothing, for both alike */
    const uint32_t size[3] = { 40, 40, 40 };
    struct grid grids[2] = { made_cube_grid(40),
                             made_grid(40, 40, 40,
                                       made_affine(vec3(-1, 0, 0), vec3(0, -1, 0), vec3(0, 0, -1), size, origin)) };
    for (int grown = -1; grown <= 1; grown++)
        for (int way = 0; way < 4; way++) {
            bool fan = way & 1;
            const struct grid *grid = &grids[way / 2]; /* indices that grow the other way put faces into other voxels */
            struct plan *plan = made_plan(grid, box_label, box, 1);
            put_box(plan, fan ? REPRESENTATION_FAN : REPRESENTATION_UNIVELS, 0.5 * grown, true);
            for (int i = 0; i < 36; i++) {
                struct scene scene = shots_scene(plan);
                scene.check.visible = true;
                snprintf(scene.check.region, sizeof scene.check.region, "box");
                shots_style(&scene, "box")->representation =
                    fan ? SCENE_REPRESENTATION_FAN : SCENE_REPRESENTATION_UNIVELS;
                double at = grown == 0 && i % 4 == 0 ? faces[i / 12] : positions[i % 4], zoom = zooms[i / 4 % 3];
                enum scene_kind kind = kinds[i / 12];
                set_slices(&scene, vec3(at, at, at));
                struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, false };
                struct render_timing timing;
                struct image *image = shots_take(plan, scene, shots_view(kind, vec3(1, 3, 9), zoom), &options, &timing);
                double width = kind == SCENE_KIND_SAGITTAL ? 12 : 18, height = kind == SCENE_KIND_AXIAL ? 12 : 14;
                double frame = ((width + grown) * (height + grown) - width * height) * zoom * zoom;
                double border = 2 * (width + height + 2) * zoom; /* a pixel around */
                if (fan || grown == 0) {
                    assert_int_equal(timing.n_added_px, 0);
                    assert_int_equal(timing.n_left_out_px, 0);
                } else {
                    assert_close((double)(grown > 0 ? timing.n_added_px : timing.n_left_out_px), fabs(frame), border);
                    assert_int_equal(grown > 0 ? timing.n_left_out_px : timing.n_added_px, 0);
                }
                if (!fan && grown && kind == SCENE_KIND_AXIAL &&
                    zoom > 10) { /* two colours, told apart by brightness as well */
                    const uint8_t *pixel = shots_pixel(image, 200 + (int)((9 + 0.25 * grown) * zoom), 150);
                    assert_true(grown > 0 ? pixel[0] > pixel[2] + 50 : pixel[2] > pixel[0] + 50);
                }
                image_destroy(image);
            }
            shots_forget(plan);
        }
}

/* ---- grids of doses --------------------------------------------------------------------------------------------- */

static void give_dose(struct plan *plan, const struct grid *grid)
{
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "dose-%zu", plan->n_doses);
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->components[0].values = made_volume(grid, VOXEL_U8, no_value);
    dose->n_components = 1;
}

/* Half covered at least. */
static bool is_white(const uint8_t *pixel)
{
    return pixel[0] > 120 && pixel[1] > 120 && pixel[2] > 120;
}

static void a_doses_grid_is_where_its_voxels_are(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(40), doses[2] = { oblique_grid(20), made_cube_grid(10) };
    struct plan *plan = made_plan(&grid, box_label, box, 1);
    give_dose(plan, &doses[0]);
    give_dose(plan, &doses[1]);
    for (int dose = 0; dose < 2; dose++) {
        struct scene scene = shots_scene(plan);
        shots_style(&scene, "box")->visible = false;
        scene.dose.grid = true;
        snprintf(scene.dose.id, sizeof scene.dose.id, dose ? "dose-2" : "");
        struct view view = shots_view_from(origin, vec3(0, -1, 0), vec3(0, 0, 1), 8);
        struct image *image = shots_plain(plan, scene, view);
        for (int corner = 0; corner < 8; corner++) /* from the front: right is patient left, up is superior */
            for (int axis = 1; axis < 8; axis *= 2)
                for (double t = 0.05; t < 1; t += 0.1) { /* along all twelve edges */
                    const double half = doses[dose].size[0] / 2.0;
                    double ijk[3];
                    for (int a = 0; a < 3; a++)
                        ijk[a] = half - 0.5 + half * (1 << a == axis ? 2 * t - 1 : corner >> a & 1 ? 1 : -1);
                    struct vec3 p = affine_point(&doses[dose].lps_mm_from_ijk, vec3(ijk[0], ijk[1], ijk[2]));
                    assert_true(is_white(shots_pixel(image, (int)(200 + 8 * p.x), (int)(150 - 8 * p.z))));
                }
        image_destroy(image);
    }
    /* on a pane: the square of 10 mm alone */
    struct scene scene = shots_scene(plan);
    shots_style(&scene, "box")->visible = false;
    scene.dose.grid = true;
    snprintf(scene.dose.id, sizeof scene.dose.id, "dose-2");
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 10));
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            double off = fabs(fmax(fabs(x + 0.5 - 200), fabs(y + 0.5 - 150)) - 50);
            if (off < 0.3 || off > 2)
                assert_int_equal(is_white(shots_pixel(image, x, y)), off < 0.3);
        }
    image_destroy(image);
    shots_forget(plan);
}

/* ---- images on grids of their own ------------------------------------------------------------------------------- */

static const struct vec3 bright_at = { 7, -5, 6 };
static double bright_ball(struct vec3 p)
{
    return vec3_length(vec3_sub(p, bright_at)) < 5 ? 200 : 0;
}

static void slices_of_every_image_land_where_they_belong(void **state)
{
    (void)state;
    struct grid grids[3] = { made_cube_grid(40), oblique_grid(48), made_cube_grid(60) };
    struct plan *plan = made_plan(&grids[0], box_label, box, 1);
    for (int i = 0; i < 3; i++)
        made_plan_add_image(plan, &grids[i], i == 1 ? VOXEL_I16 : VOXEL_U8, bright_ball);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            struct scene scene = shots_scene(plan);
            snprintf(scene.image.id, sizeof scene.image.id, "image-%d", i + 1);
            scene.outline.on_slices = false;
            scene.image.window.center = 100;
            scene.image.window.width = 200;
            set_slices(&scene, bright_at);
            struct image *image = shots_plain(plan, scene, shots_view(kinds[k], origin, 8));
            double x, y, sum_x = 0, sum_y = 0, n = 0;
            on_pane(kinds[k], bright_at, 8, &x, &y);
            for (int row = 0; row < SHOTS_HEIGHT; row++)
                for (int column = 0; column < SHOTS_WIDTH; column++)
                    if (shots_pixel(image, column, row)[0] > 128) {
                        n++;
                        sum_x += column + 0.5;
                        sum_y += row + 0.5;
                    }
            assert_close(sum_x / n, x, 2.5); /* a third of a voxel: it is 10 voxels across */
            assert_close(sum_y / n, y, 2.5);
            assert_close(n, MATH_PI * 25 * 64, 0.12 * MATH_PI * 25 * 64);
            image_destroy(image);
        }
    shots_forget(plan);
}

/* ---- low values white ------------------------------------------------------------------------------------------- */

static double ramp(struct vec3 p)
{
    return 100 + 5 * p.x;
}

/* 0 to 255 of a value, and the other way round; a level for rounding. */
static void expect_ramp(struct plan *plan, enum scene_low_values low_values, bool is_low_white)
{
    struct scene scene = shots_scene(plan);
    scene.outline.on_slices = false;
    scene.image.window.center = 100;
    scene.image.window.width = 200;
    scene.image.low_values = low_values;
    set_slices(&scene, origin);
    struct image *image = shots_plain(plan, scene, shots_view(SCENE_KIND_AXIAL, origin, 5));
    for (double x_mm = -24; x_mm <= 24; x_mm += 4) {
        double x, y, share = fmin(fmax(ramp(vec3(x_mm, 0, 0)) / 200, 0), 1);
        on_pane(SCENE_KIND_AXIAL, vec3(x_mm, 0, 0), 5, &x, &y);
        const uint8_t *pixel = shots_pixel(image, (int)(x - 0.5), (int)y);
        double grey = 255 * (is_low_white ? 1 - share : share);
        for (int c = 0; c < 3; c++) /* no darker than the background */
            assert_close(pixel[c], fmax(grey, shots_background[c]), 1.5);
        if (grey < 6)
            assert_memory_equal(pixel, shots_background, 3);
    }
    assert_memory_equal(shots_pixel(image, 2, 2), shots_background, 3); /* beside the image it is dark either way */
    image_destroy(image);
}

/* A black image, in a pane and as a slice in space: no pixel differs from the background, at the box's edges neither.
 */
static void the_box_of_an_image_of_air_does_not_show(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(20);
    struct plan *plan = made_plan(&grid, box_label, box, 1);
    made_plan_add_image(plan, &grid, VOXEL_U8, no_value);
    for (int is_pane = 0; is_pane < 2; is_pane++)
        for (int is_linear = 0; is_linear < 2; is_linear++) {
            struct scene scene = shots_scene(plan);
            shots_style(&scene, "box")->visible = false;
            scene.image.window.center = 100;
            scene.image.slices.axial.visible = true;
            scene.image.interpolation = is_linear ? SCENE_INTERPOLATION_LINEAR : SCENE_INTERPOLATION_NEAREST;
            set_slices(&scene, origin);
            struct view view = is_pane ? shots_view(SCENE_KIND_AXIAL, origin, 5)
                                       : shots_view_from(origin, vec3(1, -1, 1), vec3(0, 0, 1), 5);
            struct render_options still = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, true };
            struct image *image = shots_take(plan, scene, view, &still, NULL);
            for (int y = 0; y < SHOTS_HEIGHT; y++)
                for (int x = 0; x < SHOTS_WIDTH; x++)
                    assert_memory_equal(shots_pixel(image, x, y), shots_background, 3);
            image_destroy(image);
        }
    shots_forget(plan);
}

static void low_values_are_white_where_image_or_scene_say_so(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(50);
    struct plan *plan = made_plan(&grid, box_label, box, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, ramp);
    for (int is_inverted = 0; is_inverted < 2; is_inverted++) {
        plan->images[0].is_inverted = is_inverted;
        expect_ramp(plan, SCENE_LOW_VALUES_OWN, is_inverted);
        expect_ramp(plan, SCENE_LOW_VALUES_BLACK, false);
        expect_ramp(plan, SCENE_LOW_VALUES_WHITE, true);
    }
    shots_forget(plan);
}

/* In space the left half, whose values are below cull_below, is not drawn, whether low values are black or white. */
static void what_is_left_out_goes_by_values_and_not_by_greys(void **state)
{
    (void)state;
    struct grid grid = made_cube_grid(50);
    struct plan *plan = made_plan(&grid, box_label, box, 1);
    made_plan_add_image(plan, &grid, VOXEL_F32, ramp);
    for (int i = 0; i < 2; i++) {
        struct scene scene = shots_scene(plan);
        shots_style(&scene, "box")->visible = false;
        scene.image.window.center = 100;
        scene.image.window.width = 200;
        scene.image.cull_below = 100;
        scene.image.low_values = i ? SCENE_LOW_VALUES_WHITE : SCENE_LOW_VALUES_BLACK;
        scene.image.slices.axial.visible = true;
        set_slices(&scene, origin);
        struct image *image =
            shots_plain(plan, scene,
                        shots_view_from(origin, vec3(0, 0, -1), vec3(0, -1, 0), 5)); /* as the axial pane */
        assert_memory_equal(shots_pixel(image, SHOTS_WIDTH / 2 - 50, SHOTS_HEIGHT / 2), shots_background,
                            3); /* 10 mm to either side */
        assert_close(shots_pixel(image, SHOTS_WIDTH / 2 + 49, SHOTS_HEIGHT / 2)[0], i ? 255 * 0.25 : 255 * 0.75, 2);
        image_destroy(image);
    }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(outlines_lie_on_the_regions_border),
        cmocka_unit_test(outlines_of_oblique_grids_are_within_a_voxel_of_the_truth),
        cmocka_unit_test(only_visible_regions_have_outlines_and_the_higher_order_is_on_top),
        cmocka_unit_test(the_order_decides_between_outlines_that_coincide),
        cmocka_unit_test(the_check_marks_what_the_surface_leaves_out),
        cmocka_unit_test(the_check_finds_exactly_what_differs),
        cmocka_unit_test(a_doses_grid_is_where_its_voxels_are),
        cmocka_unit_test(slices_of_every_image_land_where_they_belong),
        cmocka_unit_test(the_box_of_an_image_of_air_does_not_show),
        cmocka_unit_test(low_values_are_white_where_image_or_scene_say_so),
        cmocka_unit_test(what_is_left_out_goes_by_values_and_not_by_greys),
    };
    return shots_run("panes", tests, sizeof tests / sizeof tests[0]);
}

/* Left is left: a plan with marks on the patient's left, front and top is drawn from known directions. Where each mark
 * must appear follows from the definitions of patient axes and views. */
#include "core/annotate/describe.h"
#include "tests/render/shots.h"

static const struct vec3 centre = { 5, -7, 11 }; /* off the origin, so that a mirrored axis cannot go unnoticed */
enum { LEFT_MM = 18, FRONT_MM = 22, TOP_MM = 20, MARK_RADIUS_MM = 7, PIXELS_PER_MM = 4 };

static bool is_near(struct vec3 p, double x, double y, double z)
{
    return vec3_length(vec3_sub(p, vec3_add(centre, vec3(x, y, z)))) <= MARK_RADIUS_MM;
}

/* 1 left (red), 2 front (green), 3 top (blue) */
static double mark_label(struct vec3 p)
{
    return is_near(p, LEFT_MM, 0, 0) ? 1 : is_near(p, 0, -FRONT_MM, 0) ? 2 : is_near(p, 0, 0, TOP_MM) ? 3 : 0;
}

/* The marks as grey values; -1000 elsewhere */
static double mark_value(struct vec3 p)
{
    return is_near(p, LEFT_MM, 0, 0)     ? 1000
           : is_near(p, 0, -FRONT_MM, 0) ? 500
           : is_near(p, 0, 0, TOP_MM)    ? 250
                                         : -1000;
}

static const struct made_region marks[] = { { "left", -1, 0xff0000 },
                                            { "front", -1, 0x00ff00 },
                                            { "top", -1, 0x0000ff } };

/* Anisotropic voxels in three orders: the patient's own axes, left-handed (to the Left, Anterior, Superior), and
 * oblique. */
static struct grid marked_grid(int kind)
{
    const uint32_t size[3] = { 80, 50, 40 };
    double c = cos(0.5), s = sin(0.5);
    struct affine map = made_affine(vec3(1, 0, 0), vec3(0, 1.5, 0), vec3(0, 0, 2), size, centre);
    if (kind == 1)
        map = made_affine(vec3(1, 0, 0), vec3(0, -1.5, 0), vec3(0, 0, 2), size, centre);
    if (kind == 2)
        map = made_affine(vec3(c, s, 0), vec3(-1.5 * s * c, 1.5 * c * c, 1.5 * s), vec3(2 * s * s, -2 * s * c, 2 * c),
                          size, centre);
    return made_grid(size[0], size[1], size[2], map);
}

/* The mark's mean position must be where its middle projects. Voxels of up to 2 mm move it by less than half a voxel.
 */
static void expect_mark(const struct image *image, int channel, double right_mm, double up_mm)
{
    double x, y;
    size_t n = shots_centroid(image, channel, &x, &y);
    double disc_px = MATH_PI * MARK_RADIUS_MM * MARK_RADIUS_MM * PIXELS_PER_MM * PIXELS_PER_MM;
    assert_near(n, disc_px, 0.25);
    assert_close(x, SHOTS_WIDTH / 2.0 + right_mm * PIXELS_PER_MM, PIXELS_PER_MM);
    assert_close(y, SHOTS_HEIGHT / 2.0 - up_mm * PIXELS_PER_MM, PIXELS_PER_MM);
}

static void surfaces_from_the_front_have_the_patients_left_on_screen_right(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        struct image *image =
            shots_plain(plan, shots_scene(plan), shots_view_from(centre, vec3(0, -1, 0), vec3(0, 0, 1), PIXELS_PER_MM));
        expect_mark(image, 0, LEFT_MM, 0);
        expect_mark(image, 1, 0, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

static void surfaces_from_the_left_have_the_front_on_screen_left(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        struct image *image =
            shots_plain(plan, shots_scene(plan), shots_view_from(centre, vec3(1, 0, 0), vec3(0, 0, 1), PIXELS_PER_MM));
        expect_mark(image, 0, 0, 0);
        expect_mark(image, 1, -FRONT_MM, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

static void a_view_without_camera_is_from_the_front_with_the_head_up(void **state)
{
    (void)state;
    struct grid grid = marked_grid(0);
    struct plan *plan = made_plan(&grid, mark_label, marks, 3);
    struct view view = view_default;
    struct image *image = shots_plain(plan, shots_scene(plan), view);
    double x, y;
    assert_true(shots_centroid(image, 0, &x, &y) > 0);
    assert_true(x > 512 + 50);
    assert_close(y, 384, 20);
    assert_true(shots_centroid(image, 2, &x, &y) > 0);
    assert_true(y < 384 - 50);
    assert_close(x, 512, 20);
    image_destroy(image);
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

static struct scene centred_scene(const struct plan *plan)
{
    struct scene scene = shots_scene(plan);
    scene.image.slices.axial.position_mm = centre.z;
    scene.image.slices.coronal.position_mm = centre.y;
    scene.image.slices.sagittal.position_mm = centre.x;
    return scene;
}

static void cross_sections_of_regions_lie_as_the_panes_say(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        struct image *image =
            shots_plain(plan, centred_scene(plan), shots_view(SCENE_KIND_AXIAL, centre, PIXELS_PER_MM));
        expect_mark(image, 0, LEFT_MM, 0);
        expect_mark(image, 1, 0, FRONT_MM);
        image_destroy(image);
        image = shots_plain(plan, centred_scene(plan), shots_view(SCENE_KIND_CORONAL, centre, PIXELS_PER_MM));
        expect_mark(image, 0, LEFT_MM, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        image = shots_plain(plan, centred_scene(plan), shots_view(SCENE_KIND_SAGITTAL, centre, PIXELS_PER_MM));
        expect_mark(image, 1, -FRONT_MM, 0);
        expect_mark(image, 2, 0, TOP_MM);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

/* Image panes are grey: window 500 +- 500 shows the left mark white, the front mark mid grey, the top mark at 250 of
 * 1000. */
static void expect_grey(const struct image *image, double right_mm, double up_mm, int grey)
{
    int x = (int)floor(SHOTS_WIDTH / 2.0 + right_mm * PIXELS_PER_MM),
        y = (int)floor(SHOTS_HEIGHT / 2.0 - up_mm * PIXELS_PER_MM);
    const uint8_t *p = shots_pixel(image, x, y);
    for (int c = 0; c < 3; c++)
        assert_close(p[c], fmax(grey, shots_background[c]), 1); /* black is the background */
    assert_int_equal(p[3], 255);
}

static struct image *image_pane(struct plan *plan, enum scene_kind kind)
{
    struct scene scene = centred_scene(plan);
    scene.image.window.center = 500;
    scene.image.window.width = 1000;
    return shots_plain(plan, scene, shots_view(kind, centre, PIXELS_PER_MM));
}

static void image_slices_lie_as_the_panes_say(void **state)
{
    (void)state;
    for (int kind = 0; kind < 3; kind++) {
        struct grid grid = marked_grid(kind);
        struct plan *plan = made_plan(&grid, mark_label, marks, 3);
        made_plan_add_image(plan, &grid, VOXEL_I16, mark_value);
        struct image *image = image_pane(plan, SCENE_KIND_AXIAL);
        expect_grey(image, LEFT_MM, 0, 255);
        expect_grey(image, -LEFT_MM, 0, 0);
        expect_grey(image, 0, FRONT_MM, 128);
        expect_grey(image, 0, -FRONT_MM, 0);
        image_destroy(image);
        image = image_pane(plan, SCENE_KIND_CORONAL);
        expect_grey(image, LEFT_MM, 0, 255);
        expect_grey(image, 0, TOP_MM, 64);
        expect_grey(image, 0, -TOP_MM, 0);
        image_destroy(image);
        image = image_pane(plan, SCENE_KIND_SAGITTAL);
        expect_grey(image, -FRONT_MM, 0, 128);
        expect_grey(image, FRONT_MM, 0, 0);
        expect_grey(image, 0, TOP_MM, 64);
        image_destroy(image);
        renderer_forget(shots_renderer, plan);
        plan_and_derived_destroy(plan);
    }
}

static void an_axial_slice_in_space_seen_from_above_has_the_left_on_screen_left(void **state)
{
    (void)state;
    struct grid grid = marked_grid(1);
    struct plan *plan = made_plan(&grid, mark_label, marks, 0);
    made_plan_add_image(plan, &grid, VOXEL_I16, mark_value);
    struct scene scene = centred_scene(plan);
    scene.image.slices.axial.visible = true;
    scene.image.window.center = 500;
    scene.image.window.width = 1000;
    struct image *image =
        shots_plain(plan, scene, shots_view_from(centre, vec3(0, 0, 1), vec3(0, -1, 0), PIXELS_PER_MM));
    expect_grey(image, -LEFT_MM, 0, 255);
    expect_grey(image, LEFT_MM, 0, 0);
    expect_grey(image, 0, FRONT_MM, 128);
    expect_grey(image, 0, -FRONT_MM, 0);
    image_destroy(image);
    renderer_forget(shots_renderer, plan);
    plan_and_derived_destroy(plan);
}

/* Seen from the front L and S run right and up, P away from the viewer; the box is 80 mm wide and 80 high, so the ends
 * are 48 mm from the middle, and from 40 mm on the lines are plain. */
static void patient_axes_are_lines_through_the_middle_of_the_plan(void **state)
{
    (void)state;
    enum { SCALE = 2 };
    struct grid grid = marked_grid(0);
    struct plan *plan = made_plan(&grid, mark_label, marks, 0);
    struct image *with, *without;
    for (int is_pane = 0; is_pane < 2; is_pane++) {
        struct view view = is_pane ? shots_view(SCENE_KIND_CORONAL, centre, SCALE)
                                   : shots_view_from(centre, vec3(0, -1, 0), vec3(0, 0, 1), SCALE);
        struct scene scene = shots_scene(plan);
        without = shots_plain(plan, scene, view);
        scene = shots_scene(plan);
        scene.axes.visible = true;
        with = shots_plain(plan, scene, view);
        size_t n_different = 0;
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                double right = x + 0.5 - SHOTS_WIDTH / 2.0, up = SHOTS_HEIGHT / 2.0 - y - 0.5;
                bool is_different = memcmp(shots_pixel(with, x, y), shots_pixel(without, x, y), 4) != 0,
                     is_near = (fabs(right) < 3 && fabs(up) < 48 * SCALE + 3) ||
                               (fabs(up) < 3 && fabs(right) < 48 * SCALE + 3);
                assert_false(is_different && (is_pane || !is_near));
                n_different += is_different ? 1 : 0;
                if (!is_pane && fabs(up) < 0.6 && fabs(right) > 41 * SCALE && fabs(right) < 47 * SCALE)
                    assert_true(shots_pixel(with, x, y)[1] > 90); /* 3/4 covered; from the back half 0.55 of it */
                if (!is_pane && fabs(up) < 0.6 && fabs(right) > 5 && fabs(right) < 38 * SCALE)
                    assert_in_range(shots_pixel(with, x, y)[1], 25, 70); /* faint within the box */
            }
        assert_true(is_pane ? n_different == 0 : n_different > 2 * 96 * SCALE);
        image_destroy(with);
        image_destroy(without);
    }
    shots_forget(plan);
}

/* Whether a picture with these axes differs from one without, within 2 pixels of a place in mm right and up. */
static bool is_painted(const struct image *with, const struct image *without, double right_mm, double up_mm, int scale)
{
    const int x = (int)floor(SHOTS_WIDTH / 2.0 + right_mm * scale), y = (int)floor(SHOTS_HEIGHT / 2.0 - up_mm * scale);
    for (int dy = -1; dy <= 1; dy++)
        for (int dx = -1; dx <= 1; dx++)
            if (memcmp(shots_pixel(with, x + dx, y + dy), shots_pixel(without, x + dx, y + dy), 4) != 0)
                return true;
    return false;
}

/* The box is 80 mm wide and high, seen from the front: its edges are 40 mm from the middle, lines through the crosshair
 * end at 48 mm, ticks are every 10 mm and 3 pixels to either side, 6 every 50 mm. */
static void axes_stand_through_the_crosshair_as_a_box_or_in_the_corner(void **state)
{
    (void)state;
    enum { SCALE = 2 };
    struct grid grid = marked_grid(0);
    struct plan *plan = made_plan(&grid, mark_label, marks, 0);
    struct image *images[SCENE_AXES_FORM_CORNER + 1], *ticks[2];
    const struct view view = shots_view_from(centre, vec3(0, -1, 0), vec3(0, 0, 1), SCALE);
    struct image *without = shots_plain(plan, shots_scene(plan), view);
    for (int i = 0; i <= SCENE_AXES_FORM_CORNER + 2; i++) {
        struct scene scene = shots_scene(plan);
        scene.axes.visible = true;
        scene.axes.ticks = i > SCENE_AXES_FORM_CORNER;
        scene.axes.form = i <= SCENE_AXES_FORM_CORNER       ? (enum scene_axes_form)i
                          : i == SCENE_AXES_FORM_CORNER + 1 ? SCENE_AXES_FORM_MIDDLE
                                                            : SCENE_AXES_FORM_BOX;
        scene.image.slices.sagittal.position_mm = centre.x + 20;
        scene.image.slices.coronal.position_mm = centre.y;
        scene.image.slices.axial.position_mm = centre.z - 15;
        struct image *image = shots_plain(plan, scene, view);
        if (i <= SCENE_AXES_FORM_CORNER)
            images[i] = image;
        else
            ticks[i - SCENE_AXES_FORM_CORNER - 1] = image;
    }
    const struct image *crosshair = images[SCENE_AXES_FORM_CROSSHAIR], *box = images[SCENE_AXES_FORM_BOX],
                       *corner = images[SCENE_AXES_FORM_CORNER];
    assert_true(is_painted(crosshair, without, 20, 45, SCALE) && is_painted(crosshair, without, -45, -15, SCALE));
    assert_true(is_painted(crosshair, without, 20, 0, SCALE) && is_painted(crosshair, without, 0, -15, SCALE));
    assert_false(is_painted(crosshair, without, 0, 30, SCALE) || is_painted(crosshair, without, 20, 52, SCALE));
    assert_true(is_painted(box, without, 40, 0, SCALE) && is_painted(box, without, 0, -40, SCALE) &&
                is_painted(box, without, -40, 40, SCALE));
    assert_false(is_painted(box, without, 0, 0, SCALE) || is_painted(box, without, 46, 0, SCALE));
    /* in the corner: 0.15 of 300 pixels from the left, 0.2 from below, arms of 0.075: L to the right, S up */
    const double left = (0.15 * 300 - SHOTS_WIDTH / 2.0) / SCALE, low = (0.2 * 300 - SHOTS_HEIGHT / 2.0) / SCALE;
    assert_true(is_painted(corner, without, left + 12 / SCALE, low, SCALE));
    assert_true(is_painted(corner, without, left, low + 12 / SCALE, SCALE));
    assert_false(is_painted(corner, without, left - 6, low, SCALE) ||
                 is_painted(corner, without, left, low - 6, SCALE) || is_painted(corner, without, 0, 0, SCALE));
    /* ticks: at 10 and 30 mm from the middle short ones, none between; on the box's edge from the right at 50 mm */
    const double aside = 3.0 / SCALE;
    assert_true(is_painted(ticks[0], images[SCENE_AXES_FORM_MIDDLE], 10, aside, SCALE) &&
                is_painted(ticks[0], images[SCENE_AXES_FORM_MIDDLE], -30, aside, SCALE));
    assert_false(is_painted(ticks[0], images[SCENE_AXES_FORM_MIDDLE], 15, aside, SCALE));
    assert_true(is_painted(ticks[1], box, 10, 40 + 6.0 / SCALE, SCALE)); /* -40 + 50 */
    assert_false(is_painted(ticks[1], box, 0, 40 + 6.0 / SCALE, SCALE)); /* -40 + 40: a short one */
    assert_true(is_painted(ticks[1], box, 0, 40 + 2.0 / SCALE, SCALE));
    for (int i = 0; i <= SCENE_AXES_FORM_CORNER; i++)
        image_destroy(images[i]);
    image_destroy(ticks[0]);
    image_destroy(ticks[1]);
    image_destroy(without);
    shots_forget(plan);
}

/* ---- the 48 orders in which the voxels of an image can be stored ------------------------------------------------ */

enum { N_ORDERS = 48, ORDER_WIDTH = 200, ORDER_HEIGHT = 160 };
static const uint32_t order_size[3] = { 20, 16, 12 }; /* along L, P, S */
static const double order_mm[3] = { 1, 1.5, 2 };

/* Which stored axis runs along each patient axis, and whether backwards. */
static void order_of(int order, int axis_of[3], bool is_backwards[3])
{
    static const int permutations[6][3] = {
        { 0, 1, 2 }, { 0, 2, 1 }, { 1, 0, 2 }, { 1, 2, 0 }, { 2, 0, 1 }, { 2, 1, 0 }
    };
    for (int a = 0; a < 3; a++) {
        axis_of[a] = permutations[order / 8][a];
        is_backwards[a] = order >> a & 1;
    }
}

/* The value of the voxel at a place counted towards L, P and S: greys that differ from voxel to voxel, and white in the
 * corner at the left, back and top. */
static uint8_t value_at(const uint32_t lps[3])
{
    if (lps[0] == order_size[0] - 1 && lps[1] == order_size[1] - 1 && lps[2] == order_size[2] - 1)
        return 255;
    return (uint8_t)(20 + (lps[0] * 73 + lps[1] * 131 + lps[2] * 197) % 160);
}

static struct plan *stored_plan(int order)
{
    int axis_of[3];
    bool is_backwards[3];
    uint32_t size[3];
    struct vec3 steps[3] = { { 0, 0, 0 } };
    order_of(order, axis_of, is_backwards);
    for (int a = 0; a < 3; a++) {
        double mm = is_backwards[a] ? -order_mm[a] : order_mm[a];
        size[axis_of[a]] = order_size[a];
        steps[axis_of[a]] = vec3(a == 0 ? mm : 0, a == 1 ? mm : 0, a == 2 ? mm : 0);
    }
    struct grid grid = made_grid(size[0], size[1], size[2], made_affine(steps[0], steps[1], steps[2], size, centre));
    struct error err = { 0 };
    struct volume *volume = volume_create(&grid, VOXEL_U8, &err);
    assert_non_null(volume);
    for (uint32_t k = 0; k < size[2]; k++)
        for (uint32_t j = 0; j < size[1]; j++)
            for (uint32_t i = 0; i < size[0]; i++) {
                const uint32_t stored[3] = { i, j, k };
                uint32_t lps[3];
                for (int a = 0; a < 3; a++)
                    lps[a] = is_backwards[a] ? order_size[a] - 1 - stored[axis_of[a]] : stored[axis_of[a]];
                ((uint8_t *)volume->voxels)[(k * size[1] + j) * size[0] + i] = value_at(lps);
            }
    volume_measure(volume);
    struct plan *plan = plan_create("made");
    plan->bounds_lps_mm = grid_bounds_lps_mm(&grid);
    (void)snprintf(plan->images[0].id, sizeof plan->images[0].id, "image");
    plan->images[0].volume = volume;
    plan->n_images = 1;
    return plan;
}

enum { SHOW_AXIAL, SHOW_CORONAL, SHOW_SAGITTAL, SHOW_OBLIQUE, SHOW_SPACE, N_SHOWN };

/* Through the marked corner: half a voxel from the three outer faces. */
static struct snapshot *order_snapshot(struct plan *plan, int shown)
{
    static const enum scene_kind kinds[N_SHOWN] = { SCENE_KIND_AXIAL, SCENE_KIND_CORONAL, SCENE_KIND_SAGITTAL,
                                                    SCENE_KIND_OBLIQUE, SCENE_KIND_3D };
    const struct vec3 corner = vec3(centre.x + 9.5, centre.y + 11.25, centre.z + 11);
    struct scene scene = shots_scene(plan);
    struct error err = { 0 };
    char field[128];
    scene.image.window.center = 127.5;
    scene.image.window.width = 255;
    scene.image.slices.sagittal.position_mm = corner.x;
    scene.image.slices.coronal.position_mm = corner.y;
    scene.image.slices.axial.position_mm = corner.z;
    scene.image.slices.axial.visible = scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = true;
    scene.image.obliques = mem_new(sizeof *scene.image.obliques);
    scene.image.n_obliques = 1;
    scene.image.obliques[0] = (struct scene_oblique_entry){ .id = "a", .value = scene_oblique_default };
    scene.image.obliques[0].value.visible = true;
    scene.image.obliques[0].value.origin_mm = corner;
    scene.image.obliques[0].value.normal = vec3(1, 1.2, -2);
    /* a shift that lays no edge of a voxel on the middle of a pixel */
    const struct vec3 target = vec3(centre.x + 0.03, centre.y + 0.07, centre.z + 0.05);
    struct view view = shown == SHOW_SPACE ? shots_view_from(target, vec3(0.9, 0.7, 0.8), vec3(0, 0, 1), 4.1)
                                           : shots_view(kinds[shown], target, 5.3);
    (void)snprintf(view.plane, sizeof view.plane, "a");
    view.size_px[0] = ORDER_WIDTH;
    view.size_px[1] = ORDER_HEIGHT;
    view.camera.height_mm = ORDER_HEIGHT / (shown == SHOW_SPACE ? 4.1 : 5.3);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &scene, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    return snapshot;
}

static struct image *order_picture(const struct snapshot *snapshot)
{
    struct error err = { 0 };
    struct camera camera;
    struct render_timing timing;
    struct render_options options = { ORDER_WIDTH, ORDER_HEIGHT, SURFACE_FULL, false };
    struct image *image = render_snapshot(shots_renderer, snapshot, &options, &camera, &timing, &err);
    assert_string_equal(err.text, "");
    return image;
}

/* The brightest pixels lie towards the edges that say L, P and S. */
static void expect_corner_at_letters(const struct image *image, const struct edge_letters *letters)
{
    double x = 0, y = 0;
    int n = 0;
    for (int py = 0; py < image->height_px; py++)
        for (int px = 0; px < image->width_px; px++)
            if (shots_pixel(image, px, py)[0] > 225) {
                x += px + 0.5;
                y += py + 0.5;
                n++;
            }
    assert_true(n > 4);
    x = x / n - image->width_px / 2.0;
    y = y / n - image->height_px / 2.0;
    const char *horizontal = x > 0 ? letters->right : letters->left, *vertical = y > 0 ? letters->bottom : letters->top;
    assert_true(strchr("LPS", horizontal[0]) != NULL);
    assert_true(strchr("LPS", vertical[0]) != NULL);
    assert_true(fabs(x) > 20 && fabs(y) > 20);
}

/* Which index of a file runs where is the file's matter: no picture, and no letter, depends on it. */
static void all_48_orders_of_the_voxels_give_the_same_pictures(void **state)
{
    (void)state;
    struct image *first[N_SHOWN] = { NULL }, *burnt[N_SHOWN] = { NULL };
    for (int order = 0; order < N_ORDERS; order++) {
        struct plan *plan = stored_plan(order);
        for (int shown = 0; shown < N_SHOWN; shown++) {
            struct snapshot *snapshot = order_snapshot(plan, shown);
            struct image *image = order_picture(snapshot);
            struct annotations words;
            struct error err = { 0 };
            assert_true(annotations_describe(&words, snapshot, ORDER_WIDTH, "", &err));
            struct image *annotated = annotate_image(image, &words, &err);
            assert_non_null(annotated);
            if (order == 0) {
                if (shown <= SHOW_SAGITTAL)
                    expect_corner_at_letters(image, &words.letters);
                first[shown] = image;
                burnt[shown] = annotated;
            } else {
                for (int i = 0; i < 4 * ORDER_WIDTH * ORDER_HEIGHT; i++)
                    if (abs(image->rgba[i] - first[shown]->rgba[i]) > 1)
                        fail_msg("order %d, picture %d: %d instead of %d at %d, %d", order, shown, image->rgba[i],
                                 first[shown]->rgba[i], i / 4 % ORDER_WIDTH, i / 4 / ORDER_WIDTH);
                assert_int_equal(annotated->height_px, burnt[shown]->height_px);
                for (int i = 0; i < 4 * annotated->width_px * annotated->height_px; i++)
                    assert_in_range(annotated->rgba[i] + 1, burnt[shown]->rgba[i], burnt[shown]->rgba[i] + 2);
                image_destroy(image);
                image_destroy(annotated);
            }
            annotations_finish(&words);
            snapshot_unref(snapshot);
        }
        shots_forget(plan);
    }
    for (int shown = 0; shown < N_SHOWN; shown++) {
        image_destroy(first[shown]);
        image_destroy(burnt[shown]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(surfaces_from_the_front_have_the_patients_left_on_screen_right),
        cmocka_unit_test(surfaces_from_the_left_have_the_front_on_screen_left),
        cmocka_unit_test(a_view_without_camera_is_from_the_front_with_the_head_up),
        cmocka_unit_test(cross_sections_of_regions_lie_as_the_panes_say),
        cmocka_unit_test(image_slices_lie_as_the_panes_say),
        cmocka_unit_test(an_axial_slice_in_space_seen_from_above_has_the_left_on_screen_left),
        cmocka_unit_test(patient_axes_are_lines_through_the_middle_of_the_plan),
        cmocka_unit_test(axes_stand_through_the_crosshair_as_a_box_or_in_the_corner),
        cmocka_unit_test(all_48_orders_of_the_voxels_give_the_same_pictures),
    };
    return shots_run("orientation", tests, sizeof tests / sizeof tests[0]);
}

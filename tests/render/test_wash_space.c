/* Colourwash on caps, surfaces and volumes, and the textures of regions: each pixel has the colour of the dose, or of
 * the image, at the point that is seen, by closed forms. */
#include "core/scene/clip.h"
#include "tests/render/wash_scene.h"

static const struct vec3 up = { 0, 0, 1 };

/* Three views onto the box; the third in perspective. */
static struct view view_of(int number)
{
    static const struct vec3 from[] = { { 0.6, -1, 0.5 }, { 0.2, -1, 0.15 }, { 0.5, -0.8, 0.6 } };
    struct view view = shots_view_from(vec3(1, 0, 0.5), from[number], up, 4.6);
    if (number == 2) {
        view.camera.projection = SCENE_PROJECTION_PERSPECTIVE;
        view.camera.has_height_mm = false;
        view.camera.fov_deg = 40;
        view.camera.position_mm = vec3_add(view.camera.target_mm, vec3_scale(vec3_normalize(from[number]), 95));
    }
    return view;
}

static void resolve(struct plan *plan, const struct scene *scene, struct view view, struct camera *camera)
{
    struct error err = { 0 };
    char field[128];
    struct scene copy;
    scene_copy(&copy, scene);
    struct snapshot *snapshot = snapshot_create(derived_of(plan), &copy, &view, 1, field, &err);
    assert_string_equal(err.text, "");
    camera_resolve(snapshot, camera);
    snapshot_unref(snapshot);
}

static const struct wash_field fields[] = { { { 1.1, -0.4, 0.9 }, 50 },
                                            { { -0.3, 1.2, 0.8 }, 47 },
                                            { { 0.5, 0.6, -1.3 }, 55 } };

static void show_as_univels(struct scene *scene, enum scene_texture texture, double opacity)
{
    for (size_t i = 0; i < scene->n_regions; i++) {
        scene->regions[i].value.representation = SCENE_REPRESENTATION_UNIVELS;
        scene->regions[i].value.texture = texture;
        scene->regions[i].value.opacity = opacity;
    }
}

/* ---- surfaces --------------------------------------------------------------------------------------------------- */

/* Colours of a translucent box are compared where they are known: the box's share of the picture is its opacity. */
static void the_surface_of_univels_has_the_dose_of_its_points(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct grid grid = wash_random_grid(i);
        struct plan *plan = wash_plan(&grid, &fields[i % 3]);
        struct wash_dose dose = { wash_dose_linear, &grid, &fields[i % 3], false };
        struct scene scene = wash_scene(plan, i % 2, i < 3 ? 1 : 0.4);
        show_as_univels(&scene, SCENE_TEXTURE_DOSE, 1);
        /* corners are rounded to 1/256 of a sample: 0.003 mm where a face is seen askew, 10 levels per Gy */
        struct wash_places places = { .point = wash_on_box, .slack = 0.04 };
        struct view view = view_of(i % 3);
        resolve(plan, &scene, view, &places.camera);
        wash_expect(plan, scene, view, places, &dose, 8000, "univels");
        shots_forget(plan);
    }
}

static double ball(struct vec3 p)
{
    return vec3_length(p) < 25 ? 1 : 0;
}
static double image_value(struct vec3 p)
{
    return 10000 + 200 * p.x;
}

/* A dose that grows along an axis in the picture: its levels are straight lines on a ball, whatever its surface is made
 * of. Values 20, 40, 60 and 80 at -20, -6.67, 6.67 and 20 mm. */
static void bands_on_a_ball_end_at_the_same_height_all_around(void **state)
{
    (void)state;
    static const struct made_region regions[] = { { "ball", -1, 0xd0d0d0 } };
    static const struct wash_field field = { { 0, 0, 1.5 }, 50 };
    struct grid grid = made_cube_grid(64), dose_grid = made_cube_grid(60);
    struct plan *made = wash_plan(&dose_grid, &field), *plan = made_plan(&grid, ball, regions, 1);
    plan->doses[plan->n_doses++] = made->doses[0];
    made->n_doses = 0;
    struct scene scene = wash_scene(plan, false, 1);
    scene.regions[0].value.texture = SCENE_TEXTURE_DOSE;
    struct image *image = shots_plain(plan, scene, shots_view_from(vec3(0, 0, 0), vec3(0.4, -1, 0), up, 5));
    static const double edges_mm[] = { -18, -20.0 / 3, 20.0 / 3, 20 }; /* 23 Gy: nothing below */
    for (int x = SHOTS_WIDTH / 2 - 40; x <= SHOTS_WIDTH / 2 + 40; x += 5)
        for (int i = 0; i < 4; i++) {
            double row = SHOTS_HEIGHT / 2.0 - 5 * edges_mm[i];
            const uint8_t *above = shots_pixel(image, x, (int)floor(row - 1)),
                          *beneath = shots_pixel(image, x, (int)ceil(row));
            for (int c = 0; c < 3; c++) {
                assert_int_equal(above[c], wash_colors[i] >> (16 - 8 * c) & 255);
                if (i > 0)
                    assert_int_equal(beneath[c], wash_colors[i - 1] >> (16 - 8 * c) & 255);
            }
            assert_true(i > 0 || beneath[0] == beneath[2]); /* grey */
        }
    image_destroy(image);
    shots_forget(plan);
    plan_and_derived_destroy(made);
}

/* Faces of univels run along the border to where no weights hold, or those of the other region: 25 Gy are 50 in a and
 * 25 in b, all over their faces. */
static void a_surface_has_the_dose_of_its_own_tissue(void **state)
{
    (void)state;
    static const struct wash_field everywhere_25 = { { 0, 0, 0 }, 25 };
    for (int i = 0; i < 3; i++) {
        struct grid grid = made_cube_grid(60);
        struct plan *plan = wash_plan(&grid, &everywhere_25);
        plan->doses[0].components[0].quantity = DOSE_NITROGEN;
        struct scene scene = wash_scene(plan, false, 1);
        show_as_univels(&scene, SCENE_TEXTURE_DOSE, 1);
        free(scene.dose.weights);
        scene.dose.weights = mem_new(2 * sizeof *scene.dose.weights);
        scene.dose.n_weights = 2;
        for (int r = 0; r < 2; r++) {
            snprintf(scene.dose.weights[r].id, sizeof scene.dose.weights[r].id, r ? "b" : "a");
            scene.dose.weights[r].value = scene_tissue_weights_default;
            scene.dose.weights[r].value.nitrogen = r ? 1 : 2;
        }
        scene.dose.quantity = SCENE_DOSE_QUANTITY_WEIGHTED;
        struct wash_places places = { .point = wash_on_box };
        struct view view = view_of(i);
        resolve(plan, &scene, view, &places.camera);
        struct image *image = shots_plain(plan, scene, view);
        size_t n[2] = { 0 };
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                struct vec3 p, beside;
                if (!places.point(&places, x, y, &p) || fabs(p.x - 4) < 0.5 ||
                    !places.point(&places, x + 1, y, &beside) || !places.point(&places, x - 1, y, &beside))
                    continue;
                bool is_b = p.x > 4;
                uint32_t rgb = wash_colors[is_b ? 0 : 1];
                const uint8_t *pixel = shots_pixel(image, x, y);
                n[is_b]++;
                for (int c = 0; c < 3; c++)
                    assert_close(pixel[c], rgb >> (16 - 8 * c) & 255, 1);
            }
        assert_true(n[0] > 2000 && n[1] > 1000);
        image_destroy(image);
        shots_forget(plan);
    }
}

/* Over black, a translucent shape's pixel is its opacity times its colour: the wash changes the colour alone. */
static void a_translucent_surface_keeps_its_opacity(void **state)
{
    (void)state;
    struct grid grid = wash_random_grid(0);
    static const struct wash_field everywhere_90 = { { 0, 0, 0 }, 90 };
    struct plan *plan = wash_plan(&grid, &everywhere_90);
    struct scene scene = wash_scene(plan, false, 1);
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    show_as_univels(&scene, SCENE_TEXTURE_DOSE, 0.5);
    struct image *image = shots_plain(plan, scene, shots_view_from(vec3(-5, 0, 0), vec3(0, -1, 0), up, 4));
    const uint8_t *pixel = shots_pixel(image, SHOTS_WIDTH / 2, SHOTS_HEIGHT / 2);
    for (int c = 0; c < 3; c++) /* level 80: #ff2010 */
        assert_close(pixel[c], 0.5 * (wash_colors[3] >> (16 - 8 * c) & 255) + 0.5 * shots_background[c], 1.5);
    image_destroy(image);
    shots_forget(plan);
}

/* The lit white box, channel by channel times the grey of the image: 10000 + 200 x in the window 0..20000. */
static void the_texture_of_an_image_multiplies_the_light(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        const uint32_t size[3] = { 30, 40, 50 };
        struct grid grid = made_grid(30, 40, 50,
                                     made_affine(vec3(2.1, 0, 0), vec3(0.3, 1.6, 0), vec3(0, 0, 0.7), size,
                                                 vec3(0, 0, 10))); /* z: -7.5 .. 27.5 */
        struct grid dose_grid = wash_random_grid(0);
        struct plan *plan = wash_plan(&dose_grid, &fields[0]);
        volume_unref(plan->images[0].volume);
        plan->images[0].volume = made_volume(&grid, i == 1 ? VOXEL_F32 : VOXEL_I16, image_value);
        struct scene scene = wash_scene(plan, false, 1), white;
        scene.image.window = (struct scene_window){ 10000, 20000, 1 };
        for (size_t r = 0; r < scene.n_regions; r++)
            scene.regions[r].value.color_rgb = 0xffffff;
        show_as_univels(&scene, SCENE_TEXTURE_NONE, 1);
        scene_copy(&white, &scene);
        for (size_t r = 0; r < scene.n_regions; r++) {
            scene.regions[r].value.texture = SCENE_TEXTURE_IMAGE;
            scene.regions[r].value.color_rgb = 0x3366cc;
        }
        struct wash_places places = { .point = wash_on_box };
        struct view view = view_of(i);
        resolve(plan, &scene, view, &places.camera);
        struct image *lit = shots_plain(plan, white, view), *image = shots_plain(plan, scene, view);
        size_t n[2] = { 0 };
        for (int y = 0; y < SHOTS_HEIGHT; y++)
            for (int x = 0; x < SHOTS_WIDTH; x++) {
                struct vec3 p;
                if (!places.point(&places, x, y, &p))
                    continue;
                struct vec3 at = affine_point(&grid.ijk_from_lps_mm, p);
                const double index[3] = { at.x, at.y, at.z };
                double inside = INFINITY, clamped[3];
                for (int axis = 0; axis < 3; axis++) {
                    inside = fmin(inside, fmin(index[axis] + 0.5, grid.size[axis] - 0.5 - index[axis]));
                    clamped[axis] = fmin(fmax(index[axis], 0), grid.size[axis] - 1.0);
                }
                if (fabs(inside) < 1e-3)
                    continue;
                struct vec3 q = affine_point(&grid.lps_mm_from_ijk, vec3(clamped[0], clamped[1], clamped[2]));
                double grey = image_value(q) / 20000;
                const uint8_t *a = shots_pixel(lit, x, y), *b = shots_pixel(image, x, y);
                n[inside > 0]++;
                for (int c = 0; c < 3; c++) /* light, grey and result are rounded */
                    assert_close(b[c], a[c] * (inside > 0 ? grey : (0x3366cc >> (16 - 8 * c) & 255) / 255.0), 1.55);
            }
        assert_true(n[0] > 3000 && n[1] > 5000);
        image_destroy(lit);
        image_destroy(image);
        shots_forget(plan);
    }
}

/* ---- caps and volumes ------------------------------------------------------------------------------------------- */

/* Points of the clip plane within the box, and not seen through another part of it. */
static bool on_cut(const struct wash_places *places, int x, int y, struct vec3 *p)
{
    (void)wash_on_plane(places, x, y, p);
    return wash_is_in_box(vec3_scale(*p, 1.02)) && wash_is_in_box(vec3_scale(*p, 1 / 0.98));
}

static void set_cut(struct scene *scene, struct vec3 normal, struct plane *plane)
{
    scene->clip.free.enabled = true;
    scene->clip.free.cap = true;
    scene->clip.free.normal = normal;
    scene->clip.free.origin_mm = vec3(0.4, -1.3, 0.7);
    *plane = plane_of_normal(scene->clip.free.origin_mm, normal);
}

/* With the image, with the regions' tint over it, with neither. */
static void a_cap_shows_the_dose_in_its_plane(void **state)
{
    (void)state;
    for (int i = 0; i < 6; i++) {
        struct grid grid = wash_random_grid(i);
        struct plan *plan = wash_plan(&grid, &fields[i % 3]);
        struct wash_dose dose = { wash_dose_linear, &grid, &fields[i % 3], false };
        struct scene scene = wash_scene(plan, i % 2, 0.4);
        struct wash_places places = { .point = on_cut };
        show_as_univels(&scene, SCENE_TEXTURE_NONE, 1);
        set_cut(&scene, vec3(0.5, -1, 0.6), &places.plane);
        scene.clip.cap.image = i % 3 != 1;
        scene.clip.cap.regions = i % 3 > 0;
        scene.clip.cap.outlines = false;
        struct view view = view_of(i % 3);
        resolve(plan, &scene, view, &places.camera);
        wash_expect(plan, scene, view, places, &dose, 6000, "a cap");
        shots_forget(plan);
    }
}

static void fill_volume(struct scene *scene, enum scene_volume_method method)
{
    struct scene_volume_style *style = &scene->image.volume;
    free(style->points);
    style->points = mem_new(sizeof *style->points);
    style->points[0] = (struct scene_transfer_point){ 0, 0x808080, 0.999 };
    style->n_points = 1;
    style->visible = true;
    style->shaded = false;
    style->method = method;
    for (size_t i = 0; i < scene->n_regions; i++)
        scene->regions[i].value.visible = false;
}

static void the_cut_face_of_a_volume_shows_the_dose_in_its_plane(void **state)
{
    (void)state;
    for (int i = 0; i < 3; i++) {
        struct grid grid = wash_random_grid(i);
        struct plan *plan = wash_plan(&grid, &fields[i]);
        struct wash_dose dose = { wash_dose_linear, &grid, &fields[i], false };
        struct scene scene = wash_scene(plan, i % 2, 0.4);
        struct wash_places places = { .point = on_cut };
        fill_volume(&scene, SCENE_VOLUME_METHOD_RAY);
        set_cut(&scene, vec3(0.5, -1, 0.6), &places.plane);
        struct view view = view_of(i);
        resolve(plan, &scene, view, &places.camera);
        wash_expect(plan, scene, view, places, &dose, 6000, "a cut face");
        shots_forget(plan);
    }
}

/* A dose that does not change along the line of sight: what rays and slices show has the dose's bands, where the dose's
 * grid is; the first sample of a ray lies within a voxel of the image's faces. */
static bool value_along_sight(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure)
{
    struct vec3 at = affine_point(&dose->grid->ijk_from_lps_mm, p);
    *value = wash_linear(dose->field, p);
    *is_sure = fabs(at.x + 0.5) > 0.01 && fabs(at.z + 0.5) > 0.01; /* the grid is longer than the image along y */
    return fmin(fmin(at.x + 0.5, dose->grid->size[0] - 0.5 - at.x),
                fmin(at.z + 0.5, dose->grid->size[2] - 0.5 - at.z)) > 0;
}
static bool within_image(const struct wash_places *places, int x, int y, struct vec3 *p)
{
    (void)wash_on_plane(places, x, y, p);
    return fabs(p->x) < 27 && fabs(p->z) < 27;
}

static void what_a_volume_shows_has_the_dose_where_the_scene_says_so(void **state)
{
    (void)state;
    static const enum scene_volume_method methods[] = { SCENE_VOLUME_METHOD_RAY, SCENE_VOLUME_METHOD_SLICES };
    static const struct wash_field field = { { 1.2, 0, 0.9 }, 50 };
    const uint32_t size[3] = { 36, 40, 30 };
    struct grid grid =
        made_grid(36, 40, 30, made_affine(vec3(2, 0, 0), vec3(0, 2, 0), vec3(0, 0, 2.5), size, vec3(0.3, 0, 0.2)));
    for (int i = 0; i < 4; i++) {
        struct plan *plan = wash_plan(&grid, &field);
        struct wash_dose dose = { value_along_sight, &grid, &field, false };
        struct scene scene = wash_scene(plan, i % 2, 0.4);
        /* the picture without the wash is rounded; and light that passes the sample that is hit */
        struct wash_places places = { .point = within_image,
                                      .slack = 0.6,
                                      .plane = plane_of_kind(SCENE_KIND_CORONAL, 0) };
        struct view view = shots_view_from(vec3(0, 0, 0), vec3(0, -1, 0), up, 5);
        fill_volume(&scene, methods[i / 2]);
        scene.dose.wash.volume = true;
        resolve(plan, &scene, view, &places.camera);
        struct scene off;
        scene_copy(&off, &scene);
        wash_expect(plan, scene, view, places, &dose, 8000, i / 2 ? "slices" : "rays");
        struct scene none;
        off.dose.wash.volume = false;
        scene_copy(&none, &off);
        none.dose.wash.visible = false;
        struct image *a = shots_plain(plan, off, view), *b = shots_plain(plan, none, view);
        assert_memory_equal(a->rgba, b->rgba, SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(a);
        image_destroy(b);
        shots_forget(plan);
    }
}

/* ---- the same bytes --------------------------------------------------------------------------------------------- */

/* Everything at once: own tissues, a still, caps, slices, textures of opaque and translucent regions, a volume. */
static struct scene full_scene(struct plan *plan, int number)
{
    struct scene scene = wash_scene(plan, number % 2, 0.45);
    struct plane plane;
    free(scene.dose.weights);
    scene.dose.weights = mem_new(2 * sizeof *scene.dose.weights);
    scene.dose.n_weights = 2;
    for (size_t i = 0; i < 2; i++) {
        snprintf(scene.dose.weights[i].id, sizeof scene.dose.weights[i].id, "%s", i ? "b" : "a");
        scene.dose.weights[i].value = scene_tissue_weights_default;
        scene.dose.weights[i].value.nitrogen = i ? 1 : 1.7;
        scene.regions[i].value.texture = (number + (int)i) % 3 ? SCENE_TEXTURE_DOSE : SCENE_TEXTURE_IMAGE;
        scene.regions[i].value.opacity = i && number % 2 ? 0.6 : 1;
    }
    scene.dose.quantity = SCENE_DOSE_QUANTITY_WEIGHTED;
    scene.dose.wash.volume = true;
    scene.dose.interpolation = number == 2 ? SCENE_DOSE_INTERPOLATION_SLICE : SCENE_DOSE_INTERPOLATION_LINEAR;
    scene.image.slices.axial.visible = scene.image.slices.sagittal.visible = true;
    if (number < 3)
        set_cut(&scene, vec3(0.3, -1, 0.6), &plane);
    scene.image.volume.visible = number % 2;
    return scene;
}

static void any_processor_and_number_of_threads_gives_the_same_bytes(void **state)
{
    (void)state;
    static const struct {
        int n_threads;
        bool is_portable;
    } ways[] = { { 1, true }, { 1, false }, { 3, false } };
    struct grid grid = wash_random_grid(1);
    struct plan *plan = wash_plan(&grid, &fields[0]);
    struct renderer *kept = shots_renderer;
    plan->doses[0].components[0].quantity = DOSE_NITROGEN;
    for (int i = 0; i < 4; i++) {
        struct image *first = NULL;
        for (int way = 0; way < 3; way++) {
            struct render_options options = { SHOTS_WIDTH, SHOTS_HEIGHT, SURFACE_FULL, i > 1 };
            shots_renderer = renderer_create(RENDER_SOFT, NULL);
            renderer_tune(shots_renderer, ways[way].n_threads, ways[way].is_portable);
            struct image *image = shots_take(plan, full_scene(plan, i), view_of(2), &options, NULL);
            for (size_t at = 3; at < SHOTS_WIDTH * SHOTS_HEIGHT * 4; at += 4)
                assert_int_equal(image->rgba[at], 255);
            if (first) {
                assert_memory_equal(image->rgba, first->rgba, SHOTS_WIDTH * SHOTS_HEIGHT * 4);
                image_destroy(image);
            } else
                first = image;
            renderer_destroy(shots_renderer);
        }
        image_destroy(first);
    }
    shots_renderer = kept;
    shots_forget(plan);
}

/* Weights change from picture to picture, and each picture looks at another part of the dose: it is the one of a store
 * whose field is whole. */
static void a_picture_while_weights_are_dragged_is_that_of_the_whole_field(void **state)
{
    (void)state;
    struct grid grid = wash_random_grid(1);
    struct plan *dragged = wash_plan(&grid, &fields[0]), *whole = wash_plan(&grid, &fields[0]);
    dragged->doses[0].components[0].quantity = whole->doses[0].components[0].quantity = DOSE_NITROGEN;
    for (int i = 0; i < 8; i++) {
        struct plan *plans[] = { dragged, whole };
        struct image *images[2];
        for (int p = 0; p < 2; p++) {
            struct scene scene = full_scene(plans[p], i % 4);
            struct view view =
                i % 4 < 2 ? shots_view((enum scene_kind)(SCENE_KIND_AXIAL + i % 2), vec3(1, 2, 3), 4) : view_of(2);
            scene.dose.weights[0].value.nitrogen = 1 + 0.1 * (i / 2);
            struct error err = { 0 };
            char field_name[128];
            struct scene copy;
            scene_copy(&copy, &scene);
            struct view view_copy = view;
            struct snapshot *snapshot = snapshot_create(derived_of(plans[p]), &copy, &view_copy, 1, field_name, &err);
            assert_string_equal(err.text, "");
            struct dose_field *field = p == 1 ? dose_field_get(snapshot->derived, &snapshot->dose_choice, &err) : NULL;
            assert_true(p == 0 || field);
            images[p] = shots_plain(plans[p], scene, view);
            if (field)
                derive_result_unref(&field->base);
            snapshot_unref(snapshot);
        }
        assert_memory_equal(images[0]->rgba, images[1]->rgba, SHOTS_WIDTH * SHOTS_HEIGHT * 4);
        image_destroy(images[0]);
        image_destroy(images[1]);
    }
    shots_forget(dragged);
    shots_forget(whole);
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_surface_of_univels_has_the_dose_of_its_points),
        cmocka_unit_test(bands_on_a_ball_end_at_the_same_height_all_around),
        cmocka_unit_test(a_surface_has_the_dose_of_its_own_tissue),
        cmocka_unit_test(a_translucent_surface_keeps_its_opacity),
        cmocka_unit_test(the_texture_of_an_image_multiplies_the_light),
        cmocka_unit_test(a_cap_shows_the_dose_in_its_plane),
        cmocka_unit_test(the_cut_face_of_a_volume_shows_the_dose_in_its_plane),
        cmocka_unit_test(what_a_volume_shows_has_the_dose_where_the_scene_says_so),
        cmocka_unit_test(a_picture_while_weights_are_dragged_is_that_of_the_whole_field),
        cmocka_unit_test(any_processor_and_number_of_threads_gives_the_same_bytes),
    };
    return shots_run_drivers("wash in space", tests, sizeof tests / sizeof tests[0]);
}

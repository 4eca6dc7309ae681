/* The lights of the scene: colours of a flat face by hand, for lights fixed to the viewer and to the patient. */
#include "tests/render/shots.h"

static const struct vec3 origin = { 0, 0, 0 }, up = { 0, 0, 1 };
static const struct vec3 from_front = { 0, -1, 0 }, from_front_left = { 1, -1, 0 };
static const struct made_region green[] = { { "green", -1, 0x408060 } };
static const double rgb[3] = { 0x40 / 255.0, 0x80 / 255.0, 0x60 / 255.0 };

/* A plate whose front face is at -5 mm along P. */
static double plate(struct vec3 p)
{
    return fabs(p.z) < 25 && fabs(p.x) < 30 && p.y > -5 && p.y < 5 ? 1 : 0;
}

static struct plan *plate_plan(void)
{
    struct grid grid = made_cube_grid(70);
    return made_plan(&grid, plate, green, 1);
}

/* The face's normal is anterior. The rule of core/render/visible/lights.h: fill light from (-0.741, 0.106, 0.663) at
 * 0.18, key at 0.58 and gloss 0.07 of its cosine to the 16th, rim 0.24. */
static void expect_face(const struct image *image, const struct scene_light_style *lights, struct vec3 from,
                        bool is_translucent)
{
    const double radians = MATH_PI / 180, azimuth = lights->azimuth_deg * radians,
                 elevation = lights->elevation_deg * radians;
    struct vec3 towards = vec3_scale(from, 1 / vec3_length(from)), right = vec3(-towards.y, towards.x, 0);
    struct vec3 normal = vec3(-right.y, -up.y, -towards.y); /* of -P */
    struct vec3 key = vec3(cos(elevation) * sin(azimuth), sin(elevation), cos(elevation) * cos(azimuth));
    if (lights->frame == SCENE_LIGHT_FRAME_PATIENT) { /* left, superior, anterior */
        struct vec3 lps = vec3(key.x, -key.z, key.y);
        key = vec3(vec3_dot(lps, right), lps.z, vec3_dot(lps, towards));
    }
    double cosine = fmax(vec3_dot(normal, key), 0), fill = fmax(-0.741 * normal.x + 0.663 * normal.z, 0),
           edge = 1 - normal.z, gloss = 0.07 * lights->intensity * pow(cosine, 16);
    double lit = lights->ambient + (is_translucent ? 0.2 : 0) + lights->intensity * (0.58 * cosine + 0.18 * fill) +
                 0.24 * edge * edge;
    for (int c = 0; c < 3; c++) {
        double expected = fmin(rgb[c] * lit + gloss, 1);
        if (is_translucent)
            expected = 0.5 * expected + 0.5 * shots_background[c] / 255;
        /* shading and storing round once each; the direction of the light to a thousandth */
        assert_close(shots_pixel(image, SHOTS_WIDTH / 2, SHOTS_HEIGHT / 2)[c], 255 * expected, 2);
    }
}

static void light_the_plate(struct plan *plan, struct scene_light_style lights, struct vec3 from, bool is_translucent)
{
    struct scene scene = shots_scene(plan);
    scene.lights = lights;
    scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
    if (is_translucent)
        shots_style(&scene, "green")->opacity = 0.5;
    struct image *image = shots_plain(plan, scene, shots_view_from(origin, from, up, 4));
    expect_face(image, &lights, from, is_translucent);
    image_destroy(image);
}

static struct scene_light_style lights_of(enum scene_light_frame frame, double azimuth_deg, double elevation_deg)
{
    struct scene_light_style lights = scene_light_style_default;
    lights.frame = frame;
    lights.azimuth_deg = azimuth_deg;
    lights.elevation_deg = elevation_deg;
    return lights;
}

static void a_light_fixed_to_the_viewer_comes_from_its_angles_in_the_picture(void **state)
{
    (void)state;
    static const double angles[][2] = { { 31.2, 34.6 }, { 0, 0 },    { -60, 20 }, { 90, 0 },
                                        { 180, 0 },     { 10, -80 }, { 0, 90 } };
    struct plan *plan = plate_plan();
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        light_the_plate(plan, lights_of(SCENE_LIGHT_FRAME_VIEWER, angles[i][0], angles[i][1]), from_front, false);
        light_the_plate(plan, lights_of(SCENE_LIGHT_FRAME_VIEWER, angles[i][0], angles[i][1]), from_front_left, false);
    }
    shots_forget(plan);
}

static void a_light_fixed_to_the_patient_stays_when_the_camera_turns(void **state)
{
    (void)state;
    /* from anterior, from the patient's left, from the right and above, from superior */
    static const double angles[][2] = { { 0, 0 }, { 90, 0 }, { -45, 30 }, { 0, 90 } };
    struct plan *plan = plate_plan();
    for (size_t i = 0; i < sizeof angles / sizeof angles[0]; i++) {
        light_the_plate(plan, lights_of(SCENE_LIGHT_FRAME_PATIENT, angles[i][0], angles[i][1]), from_front, false);
        light_the_plate(plan, lights_of(SCENE_LIGHT_FRAME_PATIENT, angles[i][0], angles[i][1]), from_front_left, false);
    }
    shots_forget(plan);
}

static void intensity_and_ambient_light_add_up_as_their_numbers_say(void **state)
{
    (void)state;
    static const double numbers[][2] = { { 0, 1 }, { 0, 0 }, { 0.5, 0.1 }, { 2, 0.3 }, { 1, 0.6 } };
    struct plan *plan = plate_plan();
    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        struct scene_light_style lights = scene_light_style_default;
        lights.intensity = numbers[i][0];
        lights.ambient = numbers[i][1];
        light_the_plate(plan, lights, from_front, false);
        light_the_plate(plan, lights, from_front, true);
    }
    shots_forget(plan);
}

/* ---- the background --------------------------------------------------------------------------------------------- */

static void the_background_is_the_scenes_in_3d_alone_and_lies_behind_what_is_translucent(void **state)
{
    (void)state;
    static const uint32_t grounds[] = { 0x08090b, 0x808080, 0x336699, 0xffffff };
    struct plan *plan = plate_plan();
    for (size_t i = 0; i < sizeof grounds / sizeof grounds[0]; i++)
        for (int is_slice = 0; is_slice < 2; is_slice++) {
            struct scene scene = shots_scene(plan);
            scene.space.background_rgb = grounds[i];
            scene.lights.intensity = 0;
            scene.lights.ambient = 0.5;
            scene.surface.translucency = SCENE_TRANSLUCENCY_PLAIN;
            shots_style(&scene, "green")->opacity = 0.5;
            struct image *image = shots_plain(plan, scene,
                                              is_slice ? shots_view(SCENE_KIND_AXIAL, origin, 4)
                                                       : shots_view_from(origin, from_front, up, 4));
            for (int c = 0; c < 3; c++) {
                const int ground = is_slice ? shots_background[c] : (int)(grounds[i] >> (16 - 8 * c) & 255);
                assert_int_equal(shots_pixel(image, 1, 1)[c], ground);
                if (!is_slice) /* lit by 0.7 of its colour: ambient and the 0.2 of translucent ones */
                    assert_close(shots_pixel(image, SHOTS_WIDTH / 2, SHOTS_HEIGHT / 2)[c],
                                 0.5 * 255 * 0.7 * rgb[c] + 0.5 * ground, 2);
            }
            image_destroy(image);
        }
    shots_forget(plan);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_light_fixed_to_the_viewer_comes_from_its_angles_in_the_picture),
        cmocka_unit_test(a_light_fixed_to_the_patient_stays_when_the_camera_turns),
        cmocka_unit_test(intensity_and_ambient_light_add_up_as_their_numbers_say),
        cmocka_unit_test(the_background_is_the_scenes_in_3d_alone_and_lies_behind_what_is_translucent),
    };
    return shots_run("lights", tests, sizeof tests / sizeof tests[0]);
}

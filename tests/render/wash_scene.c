/* Scenes and expectations of the tests of the colourwash. */
#include "tests/render/wash_scene.h"

static struct wash_field made_field; /* of the volume being made */

double wash_linear(const struct wash_field *field, struct vec3 p)
{
    return field->at_origin + vec3_dot(field->gradient, p);
}

static double made_dose(struct vec3 p)
{
    return wash_linear(&made_field, p);
}

static double flat_image(struct vec3 p)
{
    (void)p;
    return 100;
}

bool wash_is_in_box(struct vec3 p)
{
    return fabs(p.x) < wash_box_mm.x && fabs(p.y) < wash_box_mm.y && fabs(p.z) < wash_box_mm.z;
}

static double label(struct vec3 p)
{
    return !wash_is_in_box(p) ? 0 : p.x < 4 ? 1 : 2;
}

struct plan *wash_plan(const struct grid *dose_grid, const struct wash_field *field)
{
    static const struct made_region regions[] = { { "a", -1, 0xc8b090 }, { "b", -1, 0x90b0c8 } };
    struct grid grid = made_cube_grid(64);
    struct plan *plan = made_plan(&grid, label, regions, 2);
    made_plan_add_image(plan, &grid, VOXEL_I16, flat_image);
    made_field = *field;
    struct dose *dose = &plan->doses[plan->n_doses++];
    snprintf(dose->id, sizeof dose->id, "dose");
    snprintf(dose->unit, sizeof dose->unit, "Gy");
    dose->has_frame = true;
    dose->frame = DOSE_FRAME_SAME;
    dose->components[dose->n_components++] =
        (struct dose_component){ .quantity = DOSE_TOTAL, .values = made_volume(dose_grid, VOXEL_F32, made_dose) };
    return plan;
}

double wash_random(void)
{
    static uint32_t states[RENDER_N_BACK_ENDS]; /* of each back end, so that all get the same pictures */
    uint32_t *state = &states[renderer_facts(shots_renderer)->back_end];
    *state = (*state ? *state : 12345) * 1664525u + 1013904223u;
    return (double)(*state >> 8) / (1 << 24);
}

static struct vec3 any_vector(double half)
{
    return vec3(half * (2 * wash_random() - 1), half * (2 * wash_random() - 1), half * (2 * wash_random() - 1));
}

struct grid wash_random_grid(int number)
{
    struct vec3 i, j, k, sheared = any_vector(0.3);
    do
        i = any_vector(1);
    while (vec3_length(i) < 0.3);
    i = vec3_normalize(i);
    do
        j = vec3_cross(i, any_vector(1));
    while (vec3_length(j) < 0.2);
    j = vec3_normalize(j);
    k = vec3_cross(i, j);
    if (number % 2)
        j = vec3_add(j, sheared);
    if (number % 3 == 2)
        k = vec3_scale(k, -1);
    double mm[3] = { 1.5 + 3 * wash_random(), 1 + 2 * wash_random(), 2 + 4 * wash_random() };
    uint32_t size[3];
    for (int axis = 0; axis < 3; axis++)
        size[axis] = (uint32_t)(50 / mm[axis]);
    return made_grid(size[0], size[1], size[2],
                     made_affine(vec3_scale(i, mm[0]), vec3_scale(j, mm[1]), vec3_scale(k, mm[2]), size,
                                 any_vector(3)));
}

const uint32_t wash_colors[WASH_LEVELS] = { 0x2040ff, 0x20e040, 0xf0e020, 0xff2010 };
static const double levels[WASH_LEVELS] = { 20, 40, 60, 80 };
static const double below = 23;

struct scene wash_scene(const struct plan *plan, bool is_smooth, double opacity)
{
    struct scene scene = shots_scene(plan);
    struct scene_dose_style *style = &scene.dose;
    free(style->levels);
    style->n_levels = WASH_LEVELS;
    style->levels = mem_new(WASH_LEVELS * sizeof *style->levels);
    for (size_t i = 0; i < WASH_LEVELS; i++) {
        struct scene_dose_level_entry *entry = &style->levels[i];
        snprintf(entry->id, sizeof entry->id, "%zu", i);
        entry->value = scene_dose_level_default;
        entry->value.value = levels[i];
        entry->value.unit = SCENE_DOSE_UNIT_DOSE;
        entry->value.color_rgb = wash_colors[i];
    }
    style->quantity = SCENE_DOSE_QUANTITY_TOTAL;
    style->reference.kind = SCENE_DOSE_REFERENCE_KIND_VALUE;
    style->reference.value = 100;
    style->wash = (struct scene_dose_wash){
        .visible = true,
        .opacity = opacity,
        .style = is_smooth ? SCENE_WASH_STYLE_SMOOTH : SCENE_WASH_STYLE_BANDS,
        .below_percent = below,
    };
    scene.outline.on_slices = false;
    scene.image.slices.axial.visible = scene.image.slices.coronal.visible = scene.image.slices.sagittal.visible = false;
    return scene;
}

/* ---- by geometry ------------------------------------------------------------------------------------------------ */

bool wash_value(const struct grid *grid, const struct wash_field *field, bool is_per_slice, struct vec3 p,
                double *value, bool *is_sure)
{
    struct vec3 at = affine_point(&grid->ijk_from_lps_mm, p);
    double index[3] = { at.x, at.y, at.z };
    bool is_in = true;
    *is_sure = true;
    for (int axis = 0; axis < 3; axis++) {
        double last = grid->size[axis] - 1.0, inside = fmin(index[axis] + 0.5, last + 0.5 - index[axis]);
        is_in &= inside > 0;
        *is_sure &= fabs(inside) > 2e-4;
        index[axis] = fmin(fmax(index[axis], 0), last);
    }
    if (is_per_slice) {
        *is_sure &= fabs(index[2] - floor(index[2]) - 0.5) > 2e-4;
        index[2] = floor(index[2] + 0.5);
    }
    *value = wash_linear(field, affine_point(&grid->lps_mm_from_ijk, vec3(index[0], index[1], index[2])));
    return is_in;
}

bool wash_dose_linear(const struct wash_dose *dose, struct vec3 p, double *value, bool *is_sure)
{
    return wash_value(dose->grid, dose->field, dose->is_per_slice, p, value, is_sure);
}

/* The ray through the middle of a pixel: two of its points. */
static void ray(const struct camera *camera, int x, int y, struct vec3 *near, struct vec3 *far)
{
    double right = 2 * (x + 0.5) / SHOTS_WIDTH - 1, up = 1 - 2 * (y + 0.5) / SHOTS_HEIGHT;
    *near = mat4_project(&camera->lps_mm_from_clip, vec3(right, up, -1));
    *far = mat4_project(&camera->lps_mm_from_clip, vec3(right, up, 1));
}

static struct vec3 part_of(struct vec3 a, struct vec3 b, double t)
{
    return vec3_add(vec3_scale(a, 1 - t), vec3_scale(b, t));
}

bool wash_on_plane(const struct wash_places *places, int x, int y, struct vec3 *p)
{
    struct vec3 near, far;
    ray(&places->camera, x, y, &near, &far);
    double a = plane_height_mm(&places->plane, near), b = plane_height_mm(&places->plane, far);
    *p = part_of(near, far, a / (a - b));
    return true;
}

/* Where a ray enters the box, shrunk or grown by a margin. */
static bool enter_box(const struct vec3 *near, const struct vec3 *far, double margin_mm, double *first)
{
    const double o[3] = { near->x, near->y, near->z }, d[3] = { far->x - near->x, far->y - near->y, far->z - near->z },
                 half[3] = { wash_box_mm.x + margin_mm, wash_box_mm.y + margin_mm, wash_box_mm.z + margin_mm };
    double last = INFINITY;
    *first = -INFINITY;
    for (int axis = 0; axis < 3; axis++) {
        double a = (-half[axis] - o[axis]) / d[axis], b = (half[axis] - o[axis]) / d[axis];
        *first = fmax(*first, fmin(a, b));
        last = fmin(last, fmax(a, b));
    }
    return *first < last;
}

bool wash_on_box(const struct wash_places *places, int x, int y, struct vec3 *p)
{
    struct vec3 near, far;
    double first, ignored;
    ray(&places->camera, x, y, &near, &far);
    if (!enter_box(&near, &far, -0.3, &ignored) || !enter_box(&near, &far, 0, &first))
        return false; /* the silhouette */
    *p = part_of(near, far, first);
    double off[3] = { fabs(fabs(p->x) - wash_box_mm.x), fabs(fabs(p->y) - wash_box_mm.y),
                      fabs(fabs(p->z) - wash_box_mm.z) };
    int n_near = (off[0] < 0.3) + (off[1] < 0.3) + (off[2] < 0.3);
    return n_near == 1; /* not at an edge */
}

/* The colour of a value, 0..255. False: none. */
static bool color_of(const struct scene *scene, double value, double color[3])
{
    int i = WASH_LEVELS - 1;
    if (!(value >= below))
        return false;
    while (value < levels[i])
        i--;
    double t = scene->dose.wash.style == SCENE_WASH_STYLE_SMOOTH && i + 1 < WASH_LEVELS
                   ? (value - levels[i]) / (levels[i + 1] - levels[i])
                   : 0;
    for (int c = 0; c < 3; c++) {
        double low = wash_colors[i] >> (16 - 8 * c) & 255,
               high = i + 1 < WASH_LEVELS ? wash_colors[i + 1] >> (16 - 8 * c) & 255 : 0;
        color[c] = low + t * (high - low);
    }
    return true;
}

static bool is_at_level(double value, double margin)
{
    bool is_near = fabs(value - below) < margin;
    for (int i = 0; i < WASH_LEVELS; i++)
        is_near |= fabs(value - levels[i]) < margin;
    return is_near;
}

void wash_expect(struct plan *plan, struct scene scene, struct view view, struct wash_places places,
                 const struct wash_dose *dose, size_t n_least, const char *what)
{
    struct scene plain;
    scene_copy(&plain, &scene);
    plain.dose.wash.visible = false;
    const double opacity = scene.dose.wash.opacity;
    /* half a level, and single precision; OpenGL may blend in whole levels */
    const double tolerance = renderer_facts(shots_renderer)->back_end == RENDER_SOFT ? 0.52 : 1.02;
    struct scene kept = scene; /* its wash, for color_of */
    struct image *under = shots_plain(plan, plain, view), *image = shots_plain(plan, scene, view);
    size_t n_colored = 0, n_left_out = 0;
    for (int y = 0; y < SHOTS_HEIGHT; y++)
        for (int x = 0; x < SHOTS_WIDTH; x++) {
            struct vec3 p;
            double value, color[3];
            bool is_sure;
            const uint8_t *a = shots_pixel(under, x, y), *b = shots_pixel(image, x, y);
            assert_int_equal(b[3], 255);
            if (!places.point(&places, x, y, &p))
                continue;
            bool has_value = dose->value(dose, p, &value, &is_sure) &&
                             (places.is_over_background || memcmp(a, shots_background, 3) != 0);
            /* 0.02 pixels of at most 0.25 mm */
            if (!is_sure || (has_value && is_at_level(value, 0.005 * vec3_length(dose->field->gradient)))) {
                n_left_out++;
                continue;
            }
            if (!has_value || !color_of(&kept, value, color)) {
                if (memcmp(a, b, 3) != 0)
                    fail_msg("%s: pixel %d %d has a colour, and no value", what, x, y);
                continue;
            }
            n_colored++;
            for (int c = 0; c < 3; c++) {
                double expected = (1 - opacity) * a[c] + opacity * color[c];
                if (fabs(b[c] - expected) > tolerance + places.slack)
                    fail_msg("%s: pixel %d %d is %d %d %d, of %g Gy; expected %g in channel %d", what, x, y, b[0], b[1],
                             b[2], value, expected, c);
            }
        }
    if (n_colored < n_least || n_left_out > SHOTS_WIDTH * SHOTS_HEIGHT / 20)
        fail_msg("%s: %zu pixels with a colour, %zu left out", what, n_colored, n_left_out);
    image_destroy(under);
    image_destroy(image);
}

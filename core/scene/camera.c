/* The home camera of a plan, and a view's camera resolved to axes and matrices. */
#include "core/scene/camera.h"

#include <math.h>
#include <stdio.h>

#include "core/plan/fit.h"

/* Extent of the home picture over that of the plan. */
static const double home_margin = 1.08;
/* The home camera of 3-D looks from the front, turned towards the patient's left, from above. web/js/room/home.js has
 * the same numbers. */
static const double home_turn_deg = 30, home_rise_deg = 12;

static void box_corners(const struct box3 *box, struct vec3 corners[8])
{
    for (int i = 0; i < 8; i++)
        corners[i] =
            vec3(i & 1 ? box->high.x : box->low.x, i & 2 ? box->high.y : box->low.y, i & 4 ? box->high.z : box->low.z);
}

static struct box3 plan_box(const struct plan *plan)
{
    struct box3 box = plan->bounds_lps_mm;
    if (box3_is_empty(&box) || !vec3_is_finite(box.low) || !vec3_is_finite(box.high))
        box = (struct box3){ vec3(-100, -100, -100), vec3(100, 100, 100) };
    return box;
}

static struct box3 box_union(struct box3 a, const struct box3 *b)
{
    box3_add(&a, b->low);
    box3_add(&a, b->high);
    return a;
}

static struct vec3 box_centre(const struct box3 *box)
{
    return vec3_scale(vec3_add(box->low, box->high), 0.5);
}

static struct box3 image_box(const struct plan *plan)
{
    int image = fit_first_image(plan);
    return image >= 0 ? grid_bounds_lps_mm(&plan->images[image].volume->grid) : plan_box(plan);
}

/* The box that slices show at first: the body's. */
static struct box3 pane_box(const struct plan *plan)
{
    return box3_is_empty(&plan->body_lps_mm) ? image_box(plan) : plan->body_lps_mm;
}

static double box_diagonal(const struct box3 *box)
{
    return vec3_length(vec3_sub(box->high, box->low));
}

/* Length of a box of this size, projected on a unit axis. */
static double box_extent(struct vec3 size, struct vec3 axis)
{
    return fabs(axis.x) * size.x + fabs(axis.y) * size.y + fabs(axis.z) * size.z;
}

/* The box that the first 3-D picture frames: that of the regions. If it is less than half as long as the image (a
 * lesion without the head around it), the image's, which shows where in the body the regions are. */
static struct box3 home_box(const struct plan *plan)
{
    struct box3 regions = plan_box(plan), image = image_box(plan);
    return box_diagonal(&regions) < 0.5 * box_diagonal(&image) ? image : regions;
}

/* An oblique pane is as high as the highest of the three others, so that turning its plane changes no scale. */
static double pane_height_mm(const struct box3 *box, enum scene_kind kind, const struct plane *plane)
{
    struct vec3 size = vec3_sub(box->high, box->low);
    if (kind == SCENE_KIND_OBLIQUE || kind == SCENE_KIND_BEAM_SLICE)
        return fmax(home_margin * fmax(fmax(size.x, size.y), size.z), 0.1);
    return fmax(home_margin * fmax(box_extent(size, plane->right), box_extent(size, plane->up)), 0.1);
}

/* Unit vector from the target to the eye of the 3-D home camera. */
static struct vec3 home_direction(void)
{
    double turn = home_turn_deg * MATH_PI / 180, rise = home_rise_deg * MATH_PI / 180;
    return vec3(cos(rise) * sin(turn), -cos(rise) * cos(turn), sin(rise));
}

/* Distance of the eye from a point, towards back, at which every corner of the box lies within the opening angle.
 * right, up, back: orthonormal. */
static double distance_to_see_mm(const struct box3 *box, struct vec3 point, struct vec3 right, struct vec3 up,
                                 struct vec3 back, double fov_deg)
{
    double slope = tan(fov_deg / 2 * MATH_PI / 180) / home_margin, distance = 0;
    struct vec3 corners[8];
    box_corners(box, corners);
    for (int i = 0; i < 8; i++) {
        struct vec3 d = vec3_sub(corners[i], point);
        double across = fmax(fabs(vec3_dot(d, right)), fabs(vec3_dot(d, up)));
        distance = fmax(distance, across / slope + vec3_dot(d, back));
    }
    return fmax(distance, 1);
}

/* Distance from the box's centre to the eye of the 3-D home camera. */
static double home_distance_mm(const struct box3 *box, double fov_deg)
{
    struct vec3 back = home_direction();
    struct vec3 right = vec3_normalize(vec3_cross(vec3(0, 0, 1), back)), up = vec3_cross(back, right);
    return distance_to_see_mm(box, box_centre(box), right, up, back, fov_deg);
}

void camera_home(const struct plan *plan, enum scene_kind kind, struct scene_camera *camera)
{
    double fov_deg = scene_camera_default.fov_deg;
    bool is_pane = camera_is_of_pane(kind);
    struct box3 box = is_pane ? pane_box(plan) : home_box(plan);
    struct plane plane = plane_of_kind(kind, 0);

    *camera = scene_camera_default;
    camera->has_position_mm = camera->has_target_mm = camera->has_up = true;
    camera->target_mm = box_centre(&box);
    camera->up = plane.up;
    if (!is_pane) {
        camera->position_mm =
            vec3_add(camera->target_mm, vec3_scale(home_direction(), home_distance_mm(&box, fov_deg)));
    } else {
        camera->position_mm = vec3_sub(camera->target_mm, vec3_scale(plane_forward(&plane), 1000));
        camera->projection = SCENE_PROJECTION_PARALLEL;
        camera->has_height_mm = true;
        camera->height_mm = pane_height_mm(&box, kind, &plane);
    }
}

static struct vec3 turned(struct vec3 from, double angle)
{
    return vec3(from.x * cos(angle) - from.y * sin(angle), from.x * sin(angle) + from.y * cos(angle), from.z);
}

void camera_turn(const struct plan *plan, struct view *view, double turn_deg)
{
    struct scene_camera home, *camera = &view->camera;
    camera_home(plan, SCENE_KIND_3D, &home);
    const double angle = turn_deg * MATH_PI / 180;
    const struct vec3 eye = camera->has_position_mm ? camera->position_mm : home.position_mm;
    if (!camera->has_target_mm)
        camera->target_mm = home.target_mm;
    camera->position_mm = vec3_add(camera->target_mm, turned(vec3_sub(eye, camera->target_mm), angle));
    camera->up = turned(camera->has_up ? camera->up : home.up, angle);
    camera->has_position_mm = camera->has_target_mm = camera->has_up = true;
}

/* A slice pane: parallel projection at right angles to its plane, the target on the plane. Returns millimetres across
 * the smaller side of the picture. */
static double resolve_pane(const struct plan *plan, const struct view *view, const struct plane *plane,
                           struct camera *camera)
{
    const struct scene_camera *given = &view->camera;
    struct box3 box = pane_box(plan);

    camera->right = plane->right;
    camera->up = plane->up;
    camera->forward = plane_forward(plane);
    camera->is_parallel = true;
    camera->target_lps_mm = plane_nearest(plane, given->has_target_mm ? given->target_mm : box_centre(&box));
    camera->eye_lps_mm = vec3_sub(camera->target_lps_mm, vec3_scale(camera->forward, 1000));
    return given->has_height_mm ? given->height_mm : pane_height_mm(&box, view->kind, plane);
}

static double resolve_space(const struct plan *plan, const struct view *view, struct camera *camera)
{
    const struct scene_camera *given = &view->camera;
    struct box3 box = home_box(plan);

    camera->target_lps_mm = given->has_target_mm ? given->target_mm : box_centre(&box);
    camera->eye_lps_mm =
        given->has_position_mm
            ? given->position_mm
            : vec3_add(camera->target_lps_mm, vec3_scale(home_direction(), home_distance_mm(&box, given->fov_deg)));
    camera->is_parallel = given->projection == SCENE_PROJECTION_PARALLEL;
    struct vec3 sight = vec3_sub(camera->target_lps_mm, camera->eye_lps_mm);
    camera->forward = vec3_normalize(sight);
    struct vec3 up = given->has_up ? given->up : vec3(0, 0, 1);
    if (vec3_length(vec3_cross(camera->forward, vec3_normalize(up))) <
        1e-6) /* the default up lies along the line of sight */
        up = fabs(camera->forward.z) < 0.9 ? vec3(0, 0, 1) : vec3(0, -1, 0);
    camera->right = vec3_normalize(vec3_cross(camera->forward, up));
    camera->up = vec3_cross(camera->right, camera->forward);
    double at_target = 2 * vec3_length(sight) * tan(given->fov_deg / 2 * MATH_PI / 180);
    return given->has_height_mm && camera->is_parallel ? given->height_mm : fmax(at_target, 1e-3);
}

static double resolve_beam(const struct plan *plan, const struct view *view, const struct beam_shown *beam,
                           struct camera *camera)
{
    const struct scene_camera *given = &view->camera;
    struct box3 box = home_box(plan);
    struct plane plane = beam_plane(beam, beam->length_mm);
    camera->right = plane.right;
    camera->up = plane.up;
    camera->forward = beam->direction;
    camera->target_lps_mm = beam->target_lps_mm;
    camera->is_parallel = view->beam.has_aperture_mm || given->projection == SCENE_PROJECTION_PARALLEL;
    double home_mm = distance_to_see_mm(&box, beam->target_lps_mm, plane.right, plane.up, plane.normal, given->fov_deg);
    camera->eye_lps_mm = beam_point(beam, view->beam.has_along_mm ? view->beam.along_mm : beam->length_mm - home_mm);
    double at_target = 2 * home_mm * tan(given->fov_deg / 2 * MATH_PI / 180);
    return given->has_height_mm && camera->is_parallel ? given->height_mm : fmax(at_target, 1e-3);
}

/* How far behind the eye of a parallel beam's-eye view things still are in the picture: a slice at the eye is, however
 * its place is rounded, in 32 bits too. */
static const double at_eye_mm = 0.02;

/* Near and far enclose the regions, all images and what is drawn beyond them tightly, so that 24 bits of depth are
 * enough. */
static void resolve_depth(const struct plan *plan, const struct box3 *beyond, bool is_cut_at_eye, struct camera *camera)
{
    struct box3 box = plan_box(plan);
    if (beyond && !box3_is_empty(beyond))
        box = box_union(box, beyond);
    struct vec3 corners[8];
    for (size_t i = 0; i < plan->n_images; i++) {
        struct box3 image = grid_bounds_lps_mm(&plan->images[i].volume->grid);
        box = box_union(box, &image);
    }
    box_corners(&box, corners);
    double near_mm = INFINITY, far_mm = -INFINITY;
    for (int i = 0; i < 8; i++) {
        double depth = vec3_dot(vec3_sub(corners[i], camera->eye_lps_mm), camera->forward);
        near_mm = fmin(near_mm, depth);
        far_mm = fmax(far_mm, depth);
    }
    double slack = fmax(1, 0.01 * (far_mm - near_mm));
    near_mm -= slack;
    far_mm += slack;
    if (camera->is_parallel && is_cut_at_eye) {
        near_mm = fmax(near_mm, -at_eye_mm);
        far_mm = fmax(far_mm, near_mm + 10);
    }
    if (!camera->is_parallel) {
        far_mm = fmax(far_mm, 10);
        near_mm = fmax(near_mm, far_mm / 2000); /* the eye is inside or just before the plan: at 2000 : 1 the depth
                                                   still resolves 0.1 mm at the far end */
    }
    camera->near_mm = near_mm;
    camera->far_mm = far_mm;
}

static struct mat4 eye_matrix(const struct camera *camera)
{
    const struct vec3 *r = &camera->right, *u = &camera->up, *f = &camera->forward, e = camera->eye_lps_mm;
    return (struct mat4){ { r->x, u->x, -f->x, 0, r->y, u->y, -f->y, 0, r->z, u->z, -f->z, 0, -vec3_dot(*r, e),
                            -vec3_dot(*u, e), vec3_dot(*f, e), 1 } };
}

static struct mat4 projection_matrix(const struct camera *camera, double half_width, double half_height)
{
    double n = camera->near_mm, f = camera->far_mm;
    struct mat4 m = { { 0 } };
    m.m[0] = 1 / half_width;
    m.m[5] = 1 / half_height;
    if (camera->is_parallel) {
        m.m[10] = -2 / (f - n);
        m.m[14] = -(f + n) / (f - n);
        m.m[15] = 1;
    } else {
        m.m[10] = -(f + n) / (f - n);
        m.m[11] = -1;
        m.m[14] = -2 * f * n / (f - n);
    }
    return m;
}

void camera_of_view(const struct plan *plan, const struct view *view, const struct plane *pane,
                    const struct beam_shown *beam, struct camera *camera)
{
    camera_of_view_beyond(plan, view, pane, beam, NULL, camera);
}

void camera_of_view_beyond(const struct plan *plan, const struct view *view, const struct plane *pane,
                           const struct beam_shown *beam, const struct box3 *beyond, struct camera *camera)
{
    bool is_beam = view->kind == SCENE_KIND_BEAM && beam;
    double width = view->size_px[0], height = view->size_px[1], smaller = fmin(width, height);
    *camera = (struct camera){ 0 };
    double across_mm = camera_is_of_pane(view->kind) ? resolve_pane(plan, view, pane, camera)
                       : is_beam                     ? resolve_beam(plan, view, beam, camera)
                                                     : resolve_space(plan, view, camera);
    resolve_depth(plan, beyond, is_beam && view->beam.has_along_mm, camera);

    double half = camera->is_parallel ? across_mm / 2 : tan(view->camera.fov_deg / 2 * MATH_PI / 180);
    camera->pixels_per_mm = camera->is_parallel ? smaller / across_mm : 0;
    struct mat4 eye = eye_matrix(camera),
                projection = projection_matrix(camera, half * width / smaller, half * height / smaller);
    camera->clip_from_lps_mm = mat4_multiply(&projection, &eye);
    if (!mat4_invert(&camera->clip_from_lps_mm, &camera->lps_mm_from_clip)) /* camera_check refuses such cameras */
        camera->lps_mm_from_clip = (struct mat4){ { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 } };
}

/* Checks the fields of a view that can be checked without the plan. */
static bool check_fields(const struct view *view, char field[128], struct error *err)
{
    const struct scene_camera *camera = &view->camera;
    if (camera_is_of_pane(view->kind))
        return true;
    struct vec3 up = camera->has_up ? camera->up : vec3(0, 0, 1);
    if (camera->has_up && !(vec3_length(up) > 1e-9)) {
        snprintf(field, 128, "/camera/up");
        return error_set(err, ERROR_RANGE, "the camera's up direction has no length");
    }
    if (!camera->has_position_mm || !camera->has_target_mm)
        return true;
    struct vec3 sight = vec3_sub(camera->target_mm, camera->position_mm);
    if (!(vec3_length(sight) > 1e-6)) {
        snprintf(field, 128, "/camera/position_mm");
        return error_set(err, ERROR_RANGE, "the camera's position and target are the same point");
    }
    if (camera->has_up && vec3_length(vec3_cross(vec3_normalize(sight), vec3_normalize(up))) < 1e-6) {
        snprintf(field, 128, "/camera/up");
        return error_set(err, ERROR_RANGE, "the camera looks along its own up direction");
    }
    return true;
}

bool camera_check(const struct plan *plan, const struct view *view, const struct plane *pane,
                  const struct beam_shown *beam, char field[128], struct error *err)
{
    struct camera camera;
    if (!check_fields(view, field, err))
        return false;
    /* without a target the camera looks at the plan's centre, so its position must not be there */
    camera_of_view(plan, view, pane, beam, &camera);
    if (vec3_length(camera.forward) > 0.5)
        return true;
    snprintf(field, 128, "/camera/position_mm");
    return error_set(err, ERROR_RANGE, "the camera's position and target are the same point");
}

/* `beamroom render`: draws a picture of a plan, or a film of a turn about it. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/annotate/describe.h"
#include "core/base/clock.h"
#include "core/base/file_write.h"
#include "core/base/mem.h"
#include "core/encode/film.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"
#include "server/cli/render_arguments.h"
#include "server/cli/render_words.h"
#include "server/cli/text.h"
#include "server/wire/document.h"
#include "server/wire/plan_document.h"
#include "server/wire/snapshot_record.h"

enum { DOCUMENT_MAX_BYTES = 1 << 20 };

/* False with err: a part that the plan does not have, or no memory. */
static bool list_acceptances(const struct render_arguments *arguments, const struct plan *plan,
                             struct acceptances *accepted, struct error *err)
{
    *accepted = (struct acceptances){ 0 };
    accepted->items = mem_array(arguments->n_accepted + 1, sizeof *accepted->items, UINT64_MAX, err);
    if (!accepted->items)
        return false;
    for (size_t i = 0; i < arguments->n_accepted; i++) {
        struct acceptance *item = &accepted->items[accepted->n++];
        struct fit_part part;
        const char *pair = arguments->accepted[i], *equals = strchr(pair, '=');
        snprintf(item->thing, sizeof item->thing, "%.*s", (int)(equals - pair), pair);
        snprintf(item->with, sizeof item->with, "%s", equals + 1);
        snprintf(item->by, sizeof item->by, "the command line");
        if (!fit_part_read(plan, item->thing, &part) || !fit_part_read(plan, item->with, &part))
            return error_set(err, ERROR_NOT_FOUND, "--accept '%.100s' names a part that the plan does not have", pair);
    }
    return true;
}

/* ---- what to draw ----------------------------------------------------------------------------------------------- */

static bool is_json(const char *argument)
{
    return argument[0] == '{';
}

/* err becomes "FILE: /the/field is 3, expected 0 to 1". A detail that starts with the name of the field gets the whole
 * pointer in its place. */
static bool refuse_problem(const char *path, const struct problem *problem, struct error *err)
{
    const char *detail = problem->detail;
    if (is_json(path))
        path = "the JSON given";
    bool has_place = detail[0] == '/';
    if (has_place)
        detail += strcspn(detail, " ");
    else if (*problem->pointer)
        return error_set(err, ERROR_FORMAT, "%s: %s: %s", path, problem->pointer, detail);
    return error_set(err, ERROR_FORMAT, "%s: %s%s", path, has_place ? problem->pointer : "", detail);
}

/* A JSON document from an argument that is one, or from the file it names, at most DOCUMENT_MAX_BYTES. NULL with err.
 */
static cJSON *read_document(const char *path, struct error *err)
{
    cJSON *json = NULL;
    if (is_json(path)) {
        struct problem problem = { 0 };
        if (!(json = json_read(path, strlen(path), &problem)))
            refuse_problem(path, &problem, err);
        return json;
    }
    char *bytes = malloc(DOCUMENT_MAX_BYTES + 1);
    FILE *in = bytes ? fopen(path, "rb") : NULL;
    if (!in) {
        error_set(err, bytes ? ERROR_IO : ERROR_MEMORY, "%s: %s", path, strerror(errno));
    } else {
        size_t n = fread(bytes, 1, DOCUMENT_MAX_BYTES + 1, in);
        struct problem problem = { 0 };
        if (ferror(in))
            error_set(err, ERROR_IO, "%s: cannot be read", path);
        else if (n > DOCUMENT_MAX_BYTES)
            error_set(err, ERROR_LIMIT, "%s: is longer than %d bytes", path, DOCUMENT_MAX_BYTES);
        else if (!(json = json_read(bytes, n, &problem)))
            refuse_problem(path, &problem, err);
        fclose(in);
    }
    free(bytes);
    return json;
}

/* The scene that a new room of the plan starts with, patched by --scene, then by the short options. NULL with err. */
static cJSON *make_scene(const cJSON *document, const cJSON *defaults, const struct render_arguments *arguments,
                         struct error *err)
{
    struct problem problem = { 0 };
    cJSON *patch = arguments->scene ? read_document(arguments->scene, err) : cJSON_CreateObject();
    if (!patch)
        return NULL;
    cJSON *scene = scene_document_patch(document, defaults, defaults, patch, &problem);
    const bool says_sum = render_field(render_field(patch, "dose"), "sum") != NULL;
    cJSON_Delete(patch);
    if (!scene) {
        refuse_problem(arguments->scene ? arguments->scene : "scene", &problem, err);
        return NULL;
    }
    cJSON *shown = NULL;
    patch = render_show_patch(&arguments->show, scene, err);
    if (patch && !(shown = scene_document_patch(document, defaults, scene, patch, &problem)))
        refuse_problem("--show, --slices, --volume, --window, --colors, --light, --ambient, --plane or --clip",
                       &problem, err);
    cJSON_Delete(patch);
    cJSON_Delete(scene);
    if (!shown)
        return NULL;
    cJSON *dosed = NULL, *whole = NULL;
    const cJSON *sum = says_sum ? NULL : render_field(render_field(shown, "dose"), "sum");
    patch = render_dose_patch(&arguments->dose, shown, sum, err);
    if (patch && !(dosed = scene_document_patch(document, defaults, shown, patch, &problem)))
        refuse_problem("an option about dose", &problem, err);
    cJSON_Delete(patch);
    cJSON_Delete(shown);
    if (!dosed)
        return NULL;
    patch = render_beam_patch(&arguments->beam, document, dosed, err);
    if (patch && !(whole = scene_document_patch(document, defaults, dosed, patch, &problem)))
        refuse_problem("--beam, --draft, --beam-slice or --tracks", &problem, err);
    cJSON_Delete(patch);
    cJSON_Delete(dosed);
    return whole;
}

/* Adds to a view's patch the home camera, turned to look from a direction. */
static void add_from(cJSON *patch, const struct plan *plan, const double from_deg[2])
{
    struct scene_camera home;
    camera_home(plan, SCENE_KIND_3D, &home);
    double around = from_deg[0] * MATH_PI / 180, above = from_deg[1] * MATH_PI / 180;
    double distance_mm = vec3_length(vec3_sub(home.position_mm, home.target_mm));
    struct vec3 from = vec3(sin(around) * cos(above), -cos(around) * cos(above), sin(above));
    struct vec3 eye = vec3_add(home.target_mm, vec3_scale(from, distance_mm));
    /* what is up from the front, turned as the eye: from straight above too */
    struct vec3 up = vec3(-sin(around) * sin(above), cos(around) * sin(above), cos(above));
    cJSON *camera = cJSON_AddObjectToObject(patch, "camera");
    json_add(camera, "position_mm", cJSON_CreateDoubleArray((double[]){ eye.x, eye.y, eye.z }, 3));
    json_add(camera, "target_mm",
             cJSON_CreateDoubleArray((double[]){ home.target_mm.x, home.target_mm.y, home.target_mm.z }, 3));
    json_add(camera, "up", cJSON_CreateDoubleArray((double[]){ up.x, up.y, up.z }, 3));
}

/* The view that a new room starts with, patched by --view, then by the short options. NULL with err. */
static cJSON *make_view(const struct plan *plan, const struct render_arguments *arguments, struct error *err)
{
    struct problem problem = { 0 };
    const char *path = arguments->view;
    const int *size_px = arguments->size_px;
    cJSON *patch = path ? read_document(path, err) : cJSON_CreateObject();
    if (!patch)
        return NULL;
    if (arguments->show.plane && cJSON_IsObject(patch) && !cJSON_GetObjectItemCaseSensitive(patch, "kind")) {
        cJSON_AddStringToObject(patch, "kind", "oblique");
        cJSON_AddStringToObject(patch, "plane", RENDER_SHOW_PLANE);
    }
    cJSON *view = view_document_patch(NULL, patch, &problem);
    cJSON_Delete(patch);
    if (!view) {
        refuse_problem(path ? path : "view", &problem, err);
        return NULL;
    }
    patch = cJSON_CreateObject();
    bool is_read = render_beam_add_view(&arguments->beam, patch, err);
    if (size_px[0])
        json_add(patch, "size_px", cJSON_CreateIntArray(size_px, 2));
    if (arguments->has_from)
        add_from(patch, plan, arguments->from_deg);
    cJSON *changed = is_read ? view_document_patch(view, patch, &problem) : NULL;
    cJSON_Delete(patch);
    cJSON_Delete(view);
    if (is_read && !changed)
        refuse_problem("--kind, --along, --ring, --from or --size", &problem, err);
    return changed;
}

/* Drawing one or more pictures of a command line. */
struct drawing {
    const struct render_arguments *arguments;
    struct derive *derived;
    cJSON *document, *defaults, *scene, *view; /* of the plan; of a new room; as the arguments say */
    struct renderer *renderer;
    struct render_timing timing; /* of the last picture */
};

static void drawing_finish(struct drawing *drawing)
{
    if (drawing->renderer)
        renderer_forget(drawing->renderer, derive_plan(drawing->derived));
    renderer_destroy(drawing->renderer);
    cJSON_Delete(drawing->document);
    cJSON_Delete(drawing->defaults);
    cJSON_Delete(drawing->scene);
    cJSON_Delete(drawing->view);
}

static bool drawing_begin(struct drawing *drawing, const struct render_arguments *arguments, struct derive *derived,
                          struct error *err)
{
    struct scene scene = { 0 };
    *drawing = (struct drawing){ .arguments = arguments, .derived = derived };
    scene_for_plan(derive_plan(derived), &scene);
    drawing->document = plan_document(derive_plan(derived));
    drawing->defaults = scene_write(&scene);
    scene_finish(&scene);
    return (drawing->scene = make_scene(drawing->document, drawing->defaults, arguments, err)) &&
           (drawing->view = make_view(derive_plan(derived), arguments, err)) &&
           (drawing->renderer = renderer_create(arguments->back_end, err));
}

/* The snapshot of the scene in this view. NULL with err. */
static struct snapshot *make_snapshot(const struct drawing *drawing, const cJSON *view_json, struct error *err)
{
    const char *named = drawing->arguments->view ? drawing->arguments->view : "view";
    struct scene scene = { 0 };
    struct view view = { 0 };
    struct problem problem = { 0 };
    struct snapshot *snapshot = NULL;
    struct acceptances accepted = { 0 };
    char field[128] = "";
    cJSON *shown = scene_document_for_view(drawing->document, drawing->defaults, drawing->scene, view_json, &problem);
    if (!shown)
        return refuse_problem(named, &problem, err), NULL;
    if (!scene_read(shown, &scene, &problem)) {
        refuse_problem("scene", &problem, err);
    } else if (!view_read(view_json, &view, &problem)) {
        scene_finish(&scene);
        refuse_problem("view", &problem, err);
    } else if (!list_acceptances(drawing->arguments, derive_plan(drawing->derived), &accepted, err)) {
        scene_finish(&scene);
        view_finish(&view);
    } else {
        snapshot = snapshot_create_accepted(drawing->derived, &scene, &view, &accepted, 0, field, err);
        if (!snapshot && *field)
            error_prefix(err, "%s", field);
    }
    acceptances_finish(&accepted);
    cJSON_Delete(shown);
    return snapshot;
}

/* ---- the picture ------------------------------------------------------------------------------------------------ */

/* The picture with letters, scale bar and caption; text: what a PNG of it carries. */
static struct image *annotate(const struct image *image, const struct snapshot *snapshot, const cJSON *view,
                              char **text, struct error *err)
{
    struct annotations annotations = { .n_items = 0 };
    struct image *annotated = NULL;
    char date[ANNOTATE_DATE_SIZE];
    int64_t now_s = (int64_t)time(NULL);
    annotate_date(now_s, date);
    if (!(*text = snapshot_record(snapshot, view, now_s)))
        error_set(err, ERROR_MEMORY, "no memory for the picture's record");
    else if (annotations_describe(&annotations, snapshot, image->width_px, date, err))
        annotated = annotate_image(image, &annotations, err);
    annotations_finish(&annotations);
    return annotated;
}

/* text: NULL: none */
static bool write_picture(const struct image *image, const char *text, const struct render_arguments *arguments,
                          struct error *err)
{
    const struct encode_options options = { arguments->codec, arguments->quality, true };
    struct encoded encoded = { 0 };
    struct encoder *encoder = encoder_create();
    bool is_encoded = text && arguments->codec == ENCODE_PNG
                          ? encode_png_with_text(image, SNAPSHOT_RECORD_KEYWORD, text, &encoded, err)
                          : encode_image(encoder, image, &options, &encoded, err);
    bool is_written = is_encoded && file_write(arguments->out, encoded.bytes, encoded.n_bytes, err);
    free(encoded.bytes);
    encoder_destroy(encoder);
    return is_written;
}

static void print_missing(const struct snapshot *snapshot)
{
    struct visible_missing missing[VISIBLE_MAX_MISSING];
    size_t n = visible_missing(snapshot, SURFACE_FULL, missing);
    for (size_t i = 0; i < n && i < VISIBLE_MAX_MISSING; i++) {
        fprintf(stderr, "beamroom render: not in the picture: ");
        text_print(stderr, missing[i].why.text, 0);
        fputc('\n', stderr);
    }
    if (n > VISIBLE_MAX_MISSING)
        fprintf(stderr, "beamroom render: not in the picture: %zu more regions\n", n - VISIBLE_MAX_MISSING);
}

/* The picture, with its caption where the arguments want one; text as in annotate. NULL with err. */
static struct image *draw_picture(struct drawing *drawing, const struct snapshot *snapshot, const cJSON *view,
                                  char **text, struct error *err)
{
    const struct render_options options = { snapshot->view.size_px[0], snapshot->view.size_px[1], SURFACE_FULL, true };
    struct camera camera;
    struct image *image = render_snapshot(drawing->renderer, snapshot, &options, &camera, &drawing->timing, err);
    if (!image || !drawing->arguments->has_annotations)
        return image;
    struct image *annotated = annotate(image, snapshot, view, text, err);
    image_destroy(image);
    return annotated;
}

static void print_done(const struct drawing *drawing, int width_px, int height_px, const char *what, int64_t start_us)
{
    text_print(stdout, drawing->arguments->out, 0);
    printf(": %d x %d, %s%zu triangles, %.0f ms, %s\n", width_px, height_px, what, drawing->timing.n_triangles,
           (double)(clock_now_us() - start_us) / 1000,
           render_back_end_word(renderer_facts(drawing->renderer)->back_end));
}

static bool draw_one(struct drawing *drawing, struct error *err)
{
    const int64_t start_us = clock_now_us();
    char *text = NULL;
    struct snapshot *snapshot = make_snapshot(drawing, drawing->view, err);
    struct image *image = snapshot ? draw_picture(drawing, snapshot, drawing->view, &text, err) : NULL;
    const bool is_drawn = image && write_picture(image, text, drawing->arguments, err);
    if (is_drawn) {
        print_done(drawing, image->width_px, image->height_px, "", start_us);
        print_missing(snapshot);
    }
    free(text);
    image_destroy(image);
    snapshot_unref(snapshot);
    return is_drawn;
}

/* ---- a film ----------------------------------------------------------------------------------------------------- */

/* Adds the picture after a part of the turn about the axis to superior through what the view looks at. */
static bool add_picture(struct drawing *drawing, double part, struct film *film, struct error *err)
{
    char *text = NULL;
    struct snapshot *snapshot = make_snapshot(drawing, drawing->view, err);
    bool is_added = snapshot && (snapshot->view.kind == SCENE_KIND_3D ||
                                 error_set(err, ERROR_RANGE, "--orbit turns a view of the kind 3d"));
    if (is_added)
        camera_turn(snapshot->plan, &snapshot->view, 360 * part);
    struct image *image = is_added ? draw_picture(drawing, snapshot, drawing->view, &text, err) : NULL;
    if (image && film_n_pictures(film) == 0)
        print_missing(snapshot);
    is_added = image && film_add(film, image, 1, err);
    image_destroy(image);
    snapshot_unref(snapshot);
    free(text);
    return is_added;
}

static bool draw_orbit(struct drawing *drawing, struct error *err)
{
    const int64_t start_us = clock_now_us();
    const int n = (int)fmax(1, round(drawing->arguments->orbit_s * drawing->arguments->fps));
    const struct film_options options = { .fps = drawing->arguments->fps, .quality = drawing->arguments->quality };
    struct film *film = film_create(&options, err);
    struct encoded encoded = { 0 };
    int size_px[2] = { 0, 0 };
    bool ok = film != NULL;
    for (int i = 0; ok && i < n; i++)
        ok = add_picture(drawing, (double)i / n, film, err);
    ok = ok && film_finish(film, &encoded, size_px, err) &&
         file_write(drawing->arguments->out, encoded.bytes, encoded.n_bytes, err);
    if (ok) {
        char words[64];
        snprintf(words, sizeof words, "%d pictures, ", n);
        print_done(drawing, size_px[0], size_px[1], words, start_us);
    }
    free(encoded.bytes);
    film_unref(film);
    return ok;
}

static bool draw(struct derive *derived, const struct render_arguments *arguments, struct error *err)
{
    struct drawing drawing;
    const bool is_drawn = drawing_begin(&drawing, arguments, derived, err) &&
                          (arguments->orbit_s > 0 ? draw_orbit(&drawing, err) : draw_one(&drawing, err));
    drawing_finish(&drawing);
    return is_drawn;
}

int command_render(int argc, char **argv)
{
    struct render_arguments arguments;
    struct error err = { 0 };
    int code;
    if (!render_arguments_parse(argc, argv, &arguments, &code))
        return code;
    struct plan *plan = command_open_plan("render", arguments.folder);
    if (!plan)
        return EXIT_REFUSED;
    struct derive *derived = derive_create(plan);
    code = draw(derived, &arguments, &err) ? EXIT_DONE : command_refused("render", &err);
    derive_destroy(derived);
    plan_destroy(plan);
    return code;
}

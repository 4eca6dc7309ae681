/* `beamroom render`: draws one picture of a plan. */
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <time.h>

#include "core/annotate/describe.h"
#include "core/base/clock.h"
#include "core/base/file_write.h"
#include "core/base/mem.h"
#include "core/encode/encode.h"
#include "core/render/render.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"
#include "server/cli/open_plan.h"
#include "server/cli/render_beam.h"
#include "server/cli/render_dose.h"
#include "server/cli/render_show.h"
#include "server/cli/text.h"
#include "server/wire/document.h"
#include "server/wire/plan_document.h"
#include "server/wire/snapshot_record.h"

enum { DOCUMENT_MAX_BYTES = 1 << 20, DEFAULT_QUALITY = 92 };

struct render_arguments {
    const char *folder, *out;
    const char *scene, *view; /* a file's name, or JSON, which begins with "{" */
    struct render_show show;
    struct render_dose dose;
    struct render_beam beam;
    enum encode_codec codec;
    enum render_back_end back_end;
    int size_px[2]; /* 0: that of the view */
    bool has_from;  /* from_deg is given: towards the patient's left from the front; up from the horizontal */
    double from_deg[2];
    int quality;
    bool has_annotations;
    const char *accepted[ACCEPTANCES_MAX]; /* "THING=WITH" */
    size_t n_accepted;
};

/* False: that is one too many, or has no '='. */
static bool add_acceptance(struct render_arguments *arguments, const char *pair)
{
    const char *equals = strchr(pair, '=');
    if (arguments->n_accepted == ACCEPTANCES_MAX || !equals || equals == pair || !equals[1]) {
        fprintf(stderr, "beamroom render: --accept '%.100s' is not THING=WITH, such as dose:plan=image:ct\n", pair);
        return false;
    }
    arguments->accepted[arguments->n_accepted++] = pair;
    return true;
}

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

static void print_help(void)
{
    printf(
        "usage: beamroom render DIR -o OUT.png|OUT.jpg [OPTION]...\n"
        "Draws one picture of the plan in the folder DIR, the same that the daemon shows for the same scene and view.\n\n"
        "  -o, --output OUT  the picture; its ending says whether PNG or JPEG\n"
        "  --scene JSON      what differs from the scene a new room starts with (a merge patch, RFC 7396): JSON in { }, or the\n"
        "                    name of a file of it\n"
        "  --view JSON       what differs from the view a new room starts with, 1024x768: camera, kind, size, override\n"
        "  --show REGIONS    ids with commas between: these regions alone, opaque or with the opacity in ID=0.3; none: no region\n"
        "  --slices SLICES   axial, coronal, sagittal, with commas between and perhaps =MM behind: these slices alone; none\n"
        "  --volume METHOD   the image as a volume: ray, slices, mip or average; METHOD=VALUE: without what is below VALUE\n"
        "  --plane N[@P]     an oblique plane with the direction N through the point P, else through where the slices meet,\n"
        "                    each X,Y,Z towards L, P and S: its own picture, or a slice in one whose kind is said\n"
        "  --clip PLANE=MM   cuts off what lies beyond: axial-low, axial-high, coronal-low, coronal-high, sagittal-low or\n"
        "                    sagittal-high, each at a position along S, P or L, or beam, across the beam at a distance from\n"
        "                    its entry, and what lies before; given again: one more plane\n"
        "  --no-caps         leaves cuts of --clip open, so that they show what is hollow\n"
        "  --window C/W      the image's window: centre and width, in its unit\n"
        "  --dose ID         the dose that is shown\n"
        "  --accept A=B      uses two parts though they do not fit, such as dose:plan=image:ct; the caption says so; given\n"
        "                    again: one more pair\n"
        "  --quantity WORD   weighted, total, boron, nitrogen, fast, gamma, isoeffective and others of the scene\n"
        "  --ppm N           boron in blood; --tissue ID: the weights of this region everywhere\n"
        "  --reference R     what 100 %% is: body, file, value=N, region-max=ID, region-mean=ID or point=X,Y,Z\n"
        "  --level V[=COLOR] an isodose level, 95%% or 20Gy, alone; given again: one more\n"
        "  --wash STYLE      dose as colour on slices, caps and textures: bands or smooth, =OPACITY behind\n"
        "  --lines           isodose lines on slices and caps\n"
        "  --isodoses GRID   isodose surfaces of all levels, made in the grid of the dose or of the univels\n"
        "  --texture WHAT    what colours the regions shown: none, image or dose (of --wash)\n"
        "  --beam[=ID]       draws this beam, without ID the first, with its aperture, and chooses it; given again: one more is\n"
        "                    drawn\n"
        "  --draft E:T       a draft of a beam in its place, from an entry to a target, each X,Y,Z in mm towards L, P and S\n"
        "  --beam-slice MM   the image on the plane across the chosen beam, at this distance from its entry\n"
        "  --tracks[=LIST]   particle tracks, of these classes alone: neutron-low, neutron-medium, neutron-high, gamma-low,\n"
        "                    gamma-medium, gamma-high, lost, beam-line, with commas between; neutron, gamma: three each\n"
        "  --kind KIND       3d, axial, coronal, sagittal, oblique; beam: along the chosen beam; beam-slice: across it\n"
        "  --along MM        in a beam's-eye view: the eye's distance from the beam's entry; else the whole plan is seen\n"
        "  --ring MM         in a beam's-eye view: a ring of this diameter about its axis, in parallel projection\n"
        "  --from A,E        looks at the plan from A degrees off the front, towards the patient's left, and E degrees up\n"
        "  --size WxH        pixels, each 16 to 4096; before what --view says\n"
        "  --gl BACKEND      auto (default), egl-device, egl-surfaceless, osmesa or soft\n"
        "  --quality N       of a JPEG, 1 to 100 (default %d)\n"
        "  --annotations     letters, scale bar and a caption below the picture, which makes the file higher; a PNG then\n"
        "                    carries scene and view, so that the page can show them again\n"
        "  --help            this text\n\n"
        "The fields of scene and view are those of the daemon's API. Equal plans, scenes and views give equal pictures on the\n"
        "same back end.\n",
        DEFAULT_QUALITY);
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
    cJSON_Delete(patch);
    if (!scene) {
        refuse_problem(arguments->scene ? arguments->scene : "scene", &problem, err);
        return NULL;
    }
    cJSON *shown = NULL;
    patch = render_show_patch(&arguments->show, scene, err);
    if (patch && !(shown = scene_document_patch(document, defaults, scene, patch, &problem)))
        refuse_problem("--show, --slices, --volume, --window, --plane or --clip", &problem, err);
    cJSON_Delete(patch);
    cJSON_Delete(scene);
    if (!shown)
        return NULL;
    cJSON *dosed = NULL, *whole = NULL;
    patch = render_dose_patch(&arguments->dose, shown, err);
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

/* The snapshot of the scene and view that the arguments name. NULL with err. view_document: the view, the caller's;
 * NULL on failure. */
static struct snapshot *make_snapshot(struct derive *derived, const struct render_arguments *arguments,
                                      cJSON **view_document, struct error *err)
{
    const struct plan *plan = derive_plan(derived);
    struct scene scene = { 0 };
    struct view view = { 0 };
    struct problem problem = { 0 };
    struct snapshot *snapshot = NULL;
    struct acceptances accepted = { 0 };
    char field[128] = "";

    scene_for_plan(plan, &scene);
    cJSON *document = plan_document(plan), *defaults = scene_write(&scene);
    cJSON *scene_json = NULL, *shown_json = NULL, *view_json = NULL;
    scene_finish(&scene);
    if (!(scene_json = make_scene(document, defaults, arguments, err)) ||
        !(view_json = make_view(plan, arguments, err)))
        goto done;
    if (!(shown_json = scene_document_for_view(document, defaults, scene_json, view_json, &problem))) {
        refuse_problem(arguments->view ? arguments->view : "view", &problem, err);
        goto done;
    }
    if (!scene_read(shown_json, &scene, &problem)) {
        refuse_problem("scene", &problem, err);
        goto done;
    }
    if (!view_read(view_json, &view, &problem)) {
        scene_finish(&scene);
        refuse_problem("view", &problem, err);
        goto done;
    }
    if (!list_acceptances(arguments, plan, &accepted, err)) {
        scene_finish(&scene);
        view_finish(&view);
        goto done;
    }
    snapshot = snapshot_create_accepted(derived, &scene, &view, &accepted, 0, field, err);
    if (!snapshot && *field)
        error_prefix(err, "%s", field);
done:
    acceptances_finish(&accepted);
    cJSON_Delete(document);
    cJSON_Delete(defaults);
    cJSON_Delete(scene_json);
    cJSON_Delete(shown_json);
    *view_document = snapshot ? view_json : NULL;
    if (!snapshot)
        cJSON_Delete(view_json);
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

static bool draw(struct derive *derived, const struct render_arguments *arguments, struct error *err)
{
    cJSON *view = NULL;
    char *text = NULL;
    struct snapshot *snapshot = make_snapshot(derived, arguments, &view, err);
    if (!snapshot)
        return false;
    bool is_drawn = false;
    struct image *image = NULL;
    struct renderer *renderer = renderer_create(arguments->back_end, err);
    if (renderer) {
        const struct render_options options = { snapshot->view.size_px[0], snapshot->view.size_px[1], SURFACE_FULL,
                                                true };
        struct camera camera;
        struct render_timing timing = { 0 };
        int64_t start_us = clock_now_us();
        image = render_snapshot(renderer, snapshot, &options, &camera, &timing, err);
        if (image && arguments->has_annotations) {
            struct image *annotated = annotate(image, snapshot, view, &text, err);
            image_destroy(image);
            image = annotated;
        }
        is_drawn = image && write_picture(image, text, arguments, err);
        if (is_drawn) {
            text_print(stdout, arguments->out, 0);
            printf(": %d x %d, %zu triangles, %.0f ms, %s\n", image->width_px, image->height_px, timing.n_triangles,
                   (double)(clock_now_us() - start_us) / 1000,
                   render_back_end_word(renderer_facts(renderer)->back_end));
        }
        if (is_drawn)
            print_missing(snapshot);
        renderer_forget(renderer, derive_plan(derived));
    }
    free(text);
    cJSON_Delete(view);
    image_destroy(image);
    renderer_destroy(renderer);
    snapshot_unref(snapshot);
    return is_drawn;
}

/* ---- the command line ------------------------------------------------------------------------------------------- */

static bool parse_between(const char **at, int low, int high, int *number)
{
    if (**at < '0' || **at > '9')
        return false;
    char *end;
    errno = 0;
    long value = strtol(*at, &end, 10);
    *at = end;
    *number = (int)value;
    return errno == 0 && value >= low && value <= high;
}

static bool parse_size(const char *text, int size_px[2])
{
    return parse_between(&text, 16, 4096, &size_px[0]) && *text++ == 'x' &&
           parse_between(&text, 16, 4096, &size_px[1]) && *text == 0;
}

static bool parse_from(const char *text, double from_deg[2])
{
    char *end;
    from_deg[0] = strtod(text, &end);
    if (end == text || *end++ != ',')
        return false;
    from_deg[1] = strtod(text = end, &end);
    return end != text && *end == 0 && fabs(from_deg[0]) <= 360 && fabs(from_deg[1]) <= 90;
}

static bool parse_quality(const char *text, int *quality)
{
    return parse_between(&text, 1, 100, quality) && *text == 0;
}

static bool codec_from_path(const char *path, enum encode_codec *codec)
{
    const char *dot = strrchr(path, '.');
    if (!dot)
        return false;
    *codec = strcasecmp(dot, ".png") == 0 ? ENCODE_PNG : ENCODE_JPEG;
    return *codec == ENCODE_PNG || strcasecmp(dot, ".jpg") == 0 || strcasecmp(dot, ".jpeg") == 0;
}

/* Checks the words of the options, before the plan is open. */
static bool check_words(const struct render_arguments *arguments, struct error *err)
{
    cJSON *nothing = cJSON_CreateObject(), *view = cJSON_CreateObject();
    cJSON *shown = render_show_patch(&arguments->show, nothing, err);
    cJSON *dosed = shown ? render_dose_patch(&arguments->dose, nothing, err) : NULL;
    cJSON *beam = dosed ? render_beam_patch(&arguments->beam, NULL, nothing, err) : NULL;
    bool is_good = beam && render_beam_add_view(&arguments->beam, view, err);
    cJSON_Delete(shown);
    cJSON_Delete(dosed);
    cJSON_Delete(beam);
    cJSON_Delete(view);
    cJSON_Delete(nothing);
    return is_good;
}

/* False when there is nothing to draw; *code is then the exit code. */
static bool parse_arguments(int argc, char **argv, struct render_arguments *arguments, int *code)
{
    static const struct option long_options[] = {
        { "output", required_argument, NULL, 'o' },
        { "scene", required_argument, NULL, 's' },
        { "view", required_argument, NULL, 'v' },
        { "size", required_argument, NULL, 'z' },
        { "show", required_argument, NULL, 'r' },
        { "slices", required_argument, NULL, 'l' },
        { "volume", required_argument, NULL, 'u' },
        { "plane", required_argument, NULL, 'p' },
        { "window", required_argument, NULL, 'w' },
        { "from", required_argument, NULL, 'f' },
        { "clip", required_argument, NULL, 'c' },
        { "no-caps", no_argument, NULL, 'n' },
        { "dose", required_argument, NULL, 'd' },
        { "accept", required_argument, NULL, 'A' },
        { "quantity", required_argument, NULL, 'Q' },
        { "ppm", required_argument, NULL, 'P' },
        { "tissue", required_argument, NULL, 'T' },
        { "reference", required_argument, NULL, 'R' },
        { "level", required_argument, NULL, 'L' },
        { "wash", required_argument, NULL, 'W' },
        { "lines", no_argument, NULL, 'I' },
        { "isodoses", required_argument, NULL, 'S' },
        { "texture", required_argument, NULL, 'X' },
        { "beam", optional_argument, NULL, 'b' },
        { "draft", required_argument, NULL, 'D' },
        { "beam-slice", required_argument, NULL, 'B' },
        { "tracks", optional_argument, NULL, 't' },
        { "kind", required_argument, NULL, 'k' },
        { "along", required_argument, NULL, 'E' },
        { "ring", required_argument, NULL, 'G' },
        { "gl", required_argument, NULL, 'g' },
        { "quality", required_argument, NULL, 'q' },
        { "annotations", no_argument, NULL, 'a' },
        { "help", no_argument, NULL, 'h' },
        { NULL, 0, NULL, 0 },
    };
    *code = EXIT_USAGE;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "ho:", long_options, NULL)) != -1;) {
        switch (option) {
        case 'o': arguments->out = optarg; break;
        case 's': arguments->scene = optarg; break;
        case 'v': arguments->view = optarg; break;
        case 'r': arguments->show.regions = optarg; break;
        case 'l': arguments->show.slices = optarg; break;
        case 'u': arguments->show.volume = optarg; break;
        case 'p': arguments->show.plane = optarg; break;
        case 'w': arguments->show.window = optarg; break;
        case 'f':
            arguments->has_from = true;
            if (!parse_from(optarg, arguments->from_deg))
                return command_usage_error("render", "--from '%s' is not of the form 30,12: degrees up to 360 and 90",
                                           optarg),
                       false;
            break;
        case 'c':
            if (arguments->show.n_clips == RENDER_SHOW_MAX_CLIPS)
                return command_usage_error("render", "--clip is given more than %d times", RENDER_SHOW_MAX_CLIPS),
                       false;
            arguments->show.clips[arguments->show.n_clips++] = optarg;
            arguments->beam.has_clip = arguments->beam.has_clip || strncmp(optarg, "beam", 4) == 0;
            break;
        case 'n': arguments->show.is_uncapped = true; break;
        case 'd': arguments->dose.dose = optarg; break;
        case 'A':
            if (!add_acceptance(arguments, optarg))
                return false;
            break;
        case 'Q': arguments->dose.quantity = optarg; break;
        case 'P': arguments->dose.ppm = optarg; break;
        case 'T': arguments->dose.tissue = optarg; break;
        case 'R': arguments->dose.reference = optarg; break;
        case 'W': arguments->dose.wash = optarg; break;
        case 'I': arguments->dose.has_lines = true; break;
        case 'S': arguments->dose.isodoses = optarg; break;
        case 'X': arguments->dose.texture = optarg; break;
        case 'b':
            if (arguments->beam.n_beams == RENDER_BEAM_MAX)
                return command_usage_error("render", "--beam is given more than %d times", RENDER_BEAM_MAX), false;
            arguments->beam.beams[arguments->beam.n_beams++] = optarg ? optarg : "";
            break;
        case 'D': arguments->beam.draft = optarg; break;
        case 'B': arguments->beam.slice = optarg; break;
        case 't': arguments->beam.tracks = optarg ? optarg : ""; break;
        case 'k': arguments->beam.kind = optarg; break;
        case 'E': arguments->beam.along = optarg; break;
        case 'G': arguments->beam.ring = optarg; break;
        case 'L':
            if (arguments->dose.n_levels == RENDER_DOSE_MAX_LEVELS)
                return command_usage_error("render", "--level is given more than %d times", RENDER_DOSE_MAX_LEVELS),
                       false;
            arguments->dose.levels[arguments->dose.n_levels++] = optarg;
            break;
        case 'z':
            if (!parse_size(optarg, arguments->size_px))
                return command_usage_error("render", "--size '%s' is not of the form 1024x768, each 16 to 4096",
                                           optarg),
                       false;
            break;
        case 'g':
            if (!render_back_end_from_word(optarg, &arguments->back_end))
                return command_usage_error("render",
                                           "--gl '%s' is not auto, egl-device, egl-surfaceless, osmesa or soft",
                                           optarg),
                       false;
            break;
        case 'q':
            if (!parse_quality(optarg, &arguments->quality))
                return command_usage_error("render", "--quality '%s' is not 1 to 100", optarg), false;
            break;
        case 'a': arguments->has_annotations = true; break;
        case 'h':
            print_help();
            *code = EXIT_DONE;
            return false;
        default:
            return command_usage_error("render", "'%s' is not an option or lacks its value", argv[optind - 1]), false;
        }
    }
    struct error err = { 0 };
    if (!check_words(arguments, &err))
        return command_usage_error("render", "%s", err.text), false;
    if (argc - optind != 1)
        return command_usage_error("render", "one folder is needed, %d are given", argc - optind), false;
    if (!arguments->out)
        return command_usage_error("render", "where to write is needed: -o OUT.png or -o OUT.jpg"), false;
    if (!codec_from_path(arguments->out, &arguments->codec))
        return command_usage_error("render", "-o '%s' does not end in .png, .jpg or .jpeg", arguments->out), false;
    arguments->folder = argv[optind];
    return true;
}

int command_render(int argc, char **argv)
{
    struct render_arguments arguments = { .back_end = RENDER_AUTO, .quality = DEFAULT_QUALITY };
    struct error err = { 0 };
    int code;
    if (!parse_arguments(argc, argv, &arguments, &code))
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

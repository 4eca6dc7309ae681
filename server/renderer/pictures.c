/* Pictures from the render packet to the frame packet. */
#include "server/renderer/pictures.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/annotate/describe.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/render/visible/visible.h"
#include "core/scene/camera.h"
#include "server/renderer/films.h"
#include "server/wire/document.h"
#include "server/wire/snapshot_record.h"

enum { WARM_UP_PX = 64, MAX_REQUESTS = 2 * PIPELINE_MAX_WAITING, MAX_CAPTION_ITEMS = 100 };
#define WARM_UP_ID UINT64_MAX       /* never the id of a packet, so its picture is dropped */
#define NO_REQUEST (UINT64_MAX - 1) /* likewise */

struct picture_request {
    _Atomic uint64_t id; /* of the render packet; NO_REQUEST: free. Written by the main thread alone; the thread that
                            builds the shapes reads whether the picture is still wanted */
    uint32_t scene_revision;
    struct snapshot *snapshot; /* a reference */
    enum surface_detail detail;
    bool is_caption_apart, ends_film;
    int64_t film; /* number of the film that the picture is added to; 0: none */
};

struct pictures {
    struct pictures_options options;
    struct picture_request requests[MAX_REQUESTS]; /* not answered yet */
    struct built_shapes *built_shapes;
    struct films *films;
    struct problem gl_problem; /* when graphics did not start */
};

struct pictures *pictures_create(const struct pictures_options *options)
{
    struct pictures *pictures = mem_new(sizeof *pictures);
    pictures->options = *options;
    for (size_t i = 0; i < MAX_REQUESTS; i++)
        atomic_init(&pictures->requests[i].id, NO_REQUEST);
    pictures->built_shapes = built_shapes_create();
    pictures->films = films_create();
    return pictures;
}

void pictures_destroy(struct pictures *pictures)
{
    if (!pictures)
        return;
    built_shapes_destroy(pictures->built_shapes);
    films_destroy(pictures->films);
    for (size_t i = 0; i < MAX_REQUESTS; i++)
        snapshot_unref(pictures->requests[i].snapshot);
    free(pictures);
}

void pictures_refuse_all(struct pictures *pictures, const struct problem *problem)
{
    pictures->gl_problem = *problem;
}

/* ---- requests --------------------------------------------------------------------------------------------------- */

static void refuse_busy(const struct pictures *pictures, int64_t id)
{
    struct problem problem;
    problem_set(&problem, PROBLEM_BUSY, "", "", "too many pictures wait to be drawn");
    problem.retry_after_ms = 200;
    link_send_problem(pictures->options.link, id, &problem);
}

static void free_request(struct picture_request *request)
{
    atomic_store(&request->id, NO_REQUEST);
    snapshot_unref(request->snapshot);
    request->snapshot = NULL;
}

static void end_request(struct pictures *pictures, struct picture_request *request, bool is_made)
{
    films_end_picture(pictures->films, request->film, is_made, request->ends_film);
    free_request(request);
}

static struct picture_request *find_request(struct pictures *pictures, uint64_t id)
{
    for (size_t i = 0; i < MAX_REQUESTS; i++)
        if (atomic_load(&pictures->requests[i].id) == id)
            return &pictures->requests[i];
    return NULL;
}

void pictures_drop(struct pictures *pictures, const struct packet_drop *drop)
{
    struct picture_request *request = drop->id ? find_request(pictures, (uint64_t)drop->id) : NULL;
    if (request) {
        end_request(pictures, request, false);
        pipeline_drop(pictures->options.pipeline, (uint64_t)drop->id);
    }
    films_drop(pictures->films, drop->film);
}

static void submit(struct pictures *pictures, struct waiting_request *waiting)
{
    struct error err = { 0 };
    struct pipeline_request drawn = waiting->request;
    struct picture_request *request = find_request(pictures, drawn.id);
    if (request) {
        snapshot_ref(drawn.snapshot);
        waiting->request.annotation = NULL; /* goes on with the request */
        waiting->request.film = NULL;       /* likewise */
    }
    waiting_request_destroy(waiting);
    if (!request || pipeline_submit(pictures->options.pipeline, &drawn, &err)) /* none: dropped meanwhile */
        return;
    films_put_off_picture(pictures->films, request->film);
    free_request(request);
    refuse_busy(pictures, (int64_t)drawn.id);
}

void pictures_shapes_built(struct pictures *pictures, struct waiting_request *waiting)
{
    if (waiting->is_built)
        built_shapes_add(pictures->built_shapes, waiting);
    submit(pictures, waiting);
}

/* Number of the source whose turn a picture takes. Two sources with one number would share a turn, nothing worse.
 * FNV-1a, 64 bits */
static uint64_t source_number(const char *source)
{
    uint64_t number = UINT64_C(14695981039346656037);
    for (; *source; source++)
        number = (number ^ (uint8_t)*source) * UINT64_C(1099511628211);
    return number;
}

/* has_text: false of a frame of a film, which carries none. NULL: there is no memory for it. */
static struct pipeline_annotation *make_annotation(const struct snapshot *snapshot, const cJSON *view, bool has_text)
{
    int64_t now_s = (int64_t)time(NULL);
    char *text = has_text ? snapshot_record(snapshot, view, now_s) : NULL;
    if (has_text && !text)
        return NULL;
    struct pipeline_annotation *annotation = mem_new(sizeof *annotation);
    annotate_date(now_s, annotation->date);
    annotation->keyword = SNAPSHOT_RECORD_KEYWORD;
    annotation->text = text;
    return annotation;
}

/* True if the picture is of a draft: server/room/streams/display.c waits for a marked picture by the same rule. */
static bool is_of_draft(const struct snapshot *snapshot)
{
    const struct scene_beam_draft *draft = &snapshot->scene.beam.draft;
    return draft->enabled && !(draft->shows_planned && snapshot->plan->n_beams > 0);
}

void pictures_start(struct pictures *pictures, const struct packet_render *render)
{
    struct problem problem;
    uint32_t scene_revision;
    if (pictures->gl_problem.type != PROBLEM_NONE) {
        link_send_problem(pictures->options.link, render->id, &pictures->gl_problem);
        return;
    }
    struct snapshot *snapshot = scenes_snapshot(pictures->options.scenes, &render->shown, &scene_revision, &problem);
    if (!snapshot) {
        link_send_problem(pictures->options.link, render->id, &problem);
        return;
    }
    if (render->turn_deg != 0 && snapshot->view.kind == SCENE_KIND_3D)
        camera_turn(snapshot->plan, &snapshot->view, render->turn_deg);
    int width = (int)lround(snapshot->view.size_px[0] * render->scale_percent / 100),
        height = (int)lround(snapshot->view.size_px[1] * render->scale_percent / 100);
    bool is_coarse = render->detail == PACKET_DETAIL_COARSE, is_png = render->codec == PACKET_CODEC_PNG;
    struct pipeline_request drawn = {
        .id = (uint64_t)render->id,
        .source = source_number(render->source),
        .is_acted = render->acted,
        .is_last = render->last,
        .snapshot = snapshot,
        .render = { width > 1 ? width : 1, height > 1 ? height : 1, is_coarse ? SURFACE_COARSE : SURFACE_FULL,
                    render->still },
        .encode = { is_png ? ENCODE_PNG : ENCODE_JPEG, (int)render->quality, render->full_color },
        .is_reduced = { render->half, render->quarter },
        .mark = render->marked && is_of_draft(snapshot) ? "Draft beam" : NULL,
    };
    struct picture_request *request = find_request(pictures, NO_REQUEST);
    if (!request) {
        snapshot_unref(snapshot);
        refuse_busy(pictures, render->id);
        return;
    }
    if (render->annotations && !(drawn.annotation = make_annotation(snapshot, render->shown.view, render->film == 0))) {
        snapshot_unref(snapshot);
        (void)json_no_memory(&problem, "the picture's record");
        link_send_problem(pictures->options.link, render->id, &problem);
        return;
    }
    if (drawn.annotation) {
        drawn.annotation->is_caption_apart = render->caption_apart;
        drawn.annotation->is_named = render->named;
        drawn.annotation->has_crosshair = render->crosshair;
        drawn.annotation->words = render->words[0] ? mem_copy_text(render->words) : NULL;
    }
    if (render->film && !(drawn.film = films_begin_picture(pictures->films, render, &problem))) {
        snapshot_unref(snapshot);
        pipeline_annotation_destroy(drawn.annotation);
        link_send_problem(pictures->options.link, render->id, &problem);
        return;
    }
    drawn.n_film_times = (int)render->film_times;
    drawn.ends_film = request->ends_film = render->film && render->film_end;
    request->film = render->film;
    request->is_caption_apart = render->annotations && render->caption_apart;
    request->scene_revision = scene_revision;
    request->snapshot = snapshot_ref(snapshot);
    request->detail = drawn.render.detail;
    atomic_store(&request->id, drawn.id);
    struct waiting_request *waiting = waiting_request_create(&drawn);
    waiting->wanted = &request->id;
    if (built_shapes_has_all(pictures->built_shapes, waiting) ||
        !loader_build_shapes(pictures->options.loader, waiting))
        submit(pictures, waiting);
}

void pictures_warm_up(struct pictures *pictures)
{
    struct problem problem;
    uint32_t scene_revision;
    if (pictures->gl_problem.type != PROBLEM_NONE)
        return;
    cJSON *view = cJSON_CreateObject(), *size = cJSON_AddArrayToObject(view, "size_px");
    for (int i = 0; i < 2; i++)
        cJSON_AddItemToArray(size, cJSON_CreateNumber(WARM_UP_PX));
    const struct packet_snapshot shown = { .view = view }; /* of the plan's own scene */
    struct pipeline_request drawn = {
        .id = WARM_UP_ID,
        .snapshot = scenes_snapshot(pictures->options.scenes, &shown, &scene_revision, &problem),
        .render = { WARM_UP_PX, WARM_UP_PX, SURFACE_COARSE, false },
        .encode = { ENCODE_JPEG, 50, false },
    };
    cJSON_Delete(view);
    struct error err = { 0 };
    if (drawn.snapshot && !pipeline_submit(pictures->options.pipeline, &drawn, &err))
        log_warn("nothing could be drawn ahead: %s", err.text);
}

/* ---- frames ----------------------------------------------------------------------------------------------------- */

/* {n, regions: [{region, reason}]}; NULL: nothing is missing. */
static cJSON *missing_of(const struct picture_request *request)
{
    struct visible_missing missing[VISIBLE_MAX_MISSING];
    size_t n = visible_missing(request->snapshot, request->detail, missing);
    if (n == 0)
        return NULL;
    cJSON *json = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(json, "regions");
    cJSON_AddNumberToObject(json, "n", (double)n);
    for (size_t i = 0; i < n && i < VISIBLE_MAX_MISSING; i++) {
        cJSON *region = cJSON_CreateObject();
        cJSON_AddStringToObject(region, "region", subject_id(request->snapshot->plan, missing[i].subject));
        cJSON_AddStringToObject(region, "reason", missing[i].why.text);
        cJSON_AddItemToArray(list, region);
    }
    return json;
}

static const char *const row_words[ANNOTATION_N_ROWS] = {
    [ANNOTATION_TITLE] = "title",   [ANNOTATION_WORDS] = "words",     [ANNOTATION_PANE] = "pane",
    [ANNOTATION_BEAM] = "beam",     [ANNOTATION_REGIONS] = "regions", [ANNOTATION_DOSE] = "dose",
    [ANNOTATION_LEVELS] = "levels", [ANNOTATION_METHODS] = "methods", [ANNOTATION_MISSING] = "missing",
    [ANNOTATION_ORIGIN] = "origin", [ANNOTATION_USE] = "use"
};

/* The caption as [{row, rgb, text}], at most MAX_CAPTION_ITEMS. NULL: no memory for it. */
static cJSON *caption_of(const struct picture_request *request, int width_px)
{
    struct annotations annotations;
    struct error err = { 0 };
    cJSON *list = cJSON_CreateArray();
    if (!annotations_describe(&annotations, request->snapshot, width_px, "", &err))
        annotations.n_items = 0;
    for (size_t i = 0; i < annotations.n_items && i < MAX_CAPTION_ITEMS; i++) {
        struct annotation_item *item = &annotations.items[i];
        char rgb[8];
        cJSON *row = cJSON_CreateObject();
        for (char *at = item->text; *at; at++) /* so that each byte stays at most two in JSON */
            if ((unsigned char)*at < 0x20)
                *at = ' ';
        (void)snprintf(rgb, sizeof rgb, "#%02x%02x%02x", item->rgb[0], item->rgb[1], item->rgb[2]);
        cJSON_AddStringToObject(row, "row", row_words[item->row]);
        cJSON_AddStringToObject(row, "rgb", item->has_chip ? rgb : "");
        cJSON_AddStringToObject(row, "text", item->text);
        cJSON_AddItemToArray(list, row);
    }
    annotations_finish(&annotations);
    return list;
}

static void append(uint8_t *bytes, size_t *n_bytes, const struct encoded *picture)
{
    if (picture->n_bytes)
        memcpy(bytes + *n_bytes, picture->bytes, picture->n_bytes);
    *n_bytes += picture->n_bytes;
}

/* The picture, the reduced ones and the marked one behind each other. NULL: no memory, or there is only the picture.
 * The caller's. */
static uint8_t *join_all(const struct pipeline_frame *frame, size_t *n_bytes)
{
    struct error err = { 0 };
    size_t n = frame->picture.n_bytes + frame->marked.n_bytes;
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        n += frame->reduced[i].n_bytes;
    uint8_t *bytes = n > frame->picture.n_bytes ? mem_array(n, 1, UINT64_MAX, &err) : NULL;
    if (!bytes)
        return NULL;
    append(bytes, n_bytes, &frame->picture);
    for (int i = 0; i < IMAGE_N_REDUCED; i++)
        append(bytes, n_bytes, &frame->reduced[i]);
    append(bytes, n_bytes, &frame->marked);
    return bytes;
}

static void send_all(const struct pictures *pictures, struct packet *packet, const struct pipeline_frame *frame)
{
    size_t n_bytes = 0;
    uint8_t *bytes = join_all(frame, &n_bytes);
    if (bytes) {
        packet->frame.half_bytes = (int64_t)frame->reduced[0].n_bytes;
        packet->frame.quarter_bytes = (int64_t)frame->reduced[1].n_bytes;
        packet->frame.marked_bytes = (int64_t)frame->marked.n_bytes;
        link_send(pictures->options.link, packet, bytes, n_bytes);
    } else {
        link_send(pictures->options.link, packet, frame->picture.bytes, frame->picture.n_bytes);
    }
    free(bytes);
}

void pictures_send_frame(struct pictures *pictures, const struct pipeline_frame *frame)
{
    struct picture_request *request = find_request(pictures, frame->id);
    if (!request)
        return;
    if (frame->error.code != ERROR_NONE) {
        end_request(pictures, request, false);
        struct problem problem;
        problem_from_error(&problem, &frame->error);
        link_send_problem(pictures->options.link, (int64_t)frame->id, &problem);
        return;
    }
    cJSON *missing = missing_of(request);
    struct packet packet;
    packet_init(&packet, PACKET_FRAME);
    struct packet_frame *fields = &packet.frame;
    fields->id = (int64_t)frame->id;
    fields->width_px = frame->width_px;
    fields->height_px = frame->height_px;
    fields->scene_revision = request->scene_revision;
    fields->render_us = (int64_t)(frame->timing.draw_us + frame->timing.read_us);
    fields->encode_us = frame->encode_us;
    fields->pixels_per_mm = frame->camera.pixels_per_mm;
    for (int i = 0; i < 16; i++)
        fields->clip_from_lps_mm[i] = (float)frame->camera.clip_from_lps_mm.m[i];
    fields->is_coarse = frame->timing.is_coarse;
    fields->n_triangles = (int64_t)frame->timing.n_triangles;
    fields->missing = missing;
    cJSON *caption = request->is_caption_apart ? caption_of(request, frame->width_px) : NULL;
    fields->caption = caption;
    static const uint8_t no_picture[1] = { 0 };
    const bool is_of_film = request->film && !frame->picture.n_bytes;
    end_request(pictures, request, true);
    if (is_of_film)
        link_send(pictures->options.link, &packet, no_picture, sizeof no_picture);
    else
        send_all(pictures, &packet, frame);
    cJSON_Delete(caption);
    cJSON_Delete(missing);
}

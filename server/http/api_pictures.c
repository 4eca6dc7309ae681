/* Requests pictures for calls, within a limit per plan, and answers with their bytes. */
#include "server/http/api_pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/missing.h"

struct sharer {
    struct sharer *next;
    struct call *call;
};

struct api_picture {
    struct api_picture *next;
    struct api *api;
    struct sharer *sharers; /* the calls that it answers, the first of them first */
    char plan_id[64], shared_as[API_SHARED_AS_SIZE];
    double n_pixels;
    bool has_revision; /* the picture shows a room's scene: its revision is sent along */
};

static double pixels_of(const cJSON *view)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    return cJSON_GetNumberValue(cJSON_GetArrayItem(size, 0)) * cJSON_GetNumberValue(cJSON_GetArrayItem(size, 1));
}

/* The call waits for the picture, too. */
static void add_sharer(struct api_picture *picture, struct call *call)
{
    struct sharer *sharer = mem_new(sizeof *sharer), **at = &picture->sharers;
    *sharer = (struct sharer){ .call = call };
    while (*at)
        at = &(*at)->next;
    *at = sharer;
    picture->api->n_waiting_for_pictures++;
}

/* True: the same picture is being drawn already, and answers this call, too. */
static bool is_shared(struct api *api, struct call *call, const char *plan_id, const char *shared_as)
{
    for (struct api_picture *picture = api->pictures; picture && shared_as; picture = picture->next)
        if (strcmp(picture->plan_id, plan_id) == 0 && strcmp(picture->shared_as, shared_as) == 0) {
            add_sharer(picture, call);
            return true;
        }
    return false;
}

/* Notes a picture under way; answers the call with 503 and returns NULL when the plan has too many. Scripts and rooms
 * share a plan's renderer: without a limit a script could keep it from the rooms. */
static struct api_picture *start_picture(struct api *api, struct call *call, const char *plan_id, const cJSON *view)
{
    size_t n = 0;
    double n_pixels = pixels_of(view), n_before = 0;
    for (const struct api_picture *picture = api->pictures; picture; picture = picture->next)
        if (strcmp(picture->plan_id, plan_id) == 0) {
            n++;
            n_before += picture->n_pixels;
        }
    if (n >= API_MAX_PICTURES || (n > 0 && n_before + n_pixels > API_MAX_PIXELS)) {
        struct problem problem;
        problem_set(&problem, PROBLEM_BUSY, "", "",
                    "%zu pictures of this plan are being made already, of %.0f million pixels", n, n_before / 1e6);
        problem.retry_after_ms = 1000;
        call_answer_problem(call, &problem);
        return NULL;
    }
    struct api_picture *picture = mem_new(sizeof *picture);
    *picture = (struct api_picture){ .next = api->pictures, .api = api, .n_pixels = n_pixels };
    (void)snprintf(picture->plan_id, sizeof picture->plan_id, "%s", plan_id);
    add_sharer(picture, call);
    api->pictures = picture;
    api->n_pictures++;
    return picture;
}

/* Answers with the bytes, which are taken. */
static void answer_picture(struct call *call, const struct packet *answer, bool has_revision, uint8_t *bytes)
{
    char timing[96], revision[24];
    (void)snprintf(timing, sizeof timing, "render;dur=%.1f, encode;dur=%.1f", (double)answer->frame.render_us / 1000,
                   (double)answer->frame.encode_us / 1000);
    (void)snprintf(revision, sizeof revision, "%lld", (long long)answer->frame.scene_revision);
    call_add_header(call, "Server-Timing", timing);
    if (has_revision)
        call_add_header(call, "Beamroom-Revision", revision);
    cJSON *missing = missing_read(answer->json);
    char words[MISSING_MAX_REGIONS * 66 + 32];
    missing_words(missing, words, sizeof words);
    if (missing)
        call_add_header(call, "Beamroom-Missing", words);
    cJSON_Delete(missing);
    call_answer_bytes(call, 200, bytes[0] == 0xff ? "image/jpeg" : "image/png", bytes, answer->n_blob);
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct api_picture *picture = context, **at = &picture->api->pictures;
    struct problem broken;
    while (*at != picture)
        at = &(*at)->next;
    *at = picture->next;
    if (!problem && (!answer->blob || answer->n_blob < 4)) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer has no picture");
        problem = &broken;
    }
    while (picture->sharers) {
        struct sharer *sharer = picture->sharers;
        uint8_t *bytes = !problem && sharer->next ? malloc(answer->n_blob) : NULL;
        picture->sharers = sharer->next;
        picture->api->n_waiting_for_pictures--;
        if (bytes) {
            memcpy(bytes, answer->blob, answer->n_blob);
        } else if (!problem && !sharer->next) {
            bytes = answer->blob;
            answer->blob = NULL;
        }
        if (bytes) {
            answer_picture(sharer->call, answer, picture->has_revision, bytes);
        } else {
            struct problem memory;
            problem_set(&memory, PROBLEM_MEMORY, "", "", "there is no memory for the picture");
            call_answer_problem(sharer->call, problem ? problem : &memory);
        }
        free(sharer);
    }
    free(picture);
}

void api_picture_request(struct api *api, struct call *call, const char *plan_id, const cJSON *scene,
                         const cJSON *acceptances, const uint32_t *revision, const cJSON *view, const char *format,
                         double quality, struct api_marking marking, const char *shared_as)
{
    struct problem problem;
    bool is_jpeg = format && strcmp(format, "jpeg") == 0;
    if (format && !is_jpeg && strcmp(format, "png") != 0) {
        problem_set(&problem, PROBLEM_VALIDATION, "/format", "enum", "format is \"%.20s\", expected png or jpeg",
                    format);
        call_answer_problem(call, &problem);
        return;
    }
    if (!(quality >= 1 && quality <= 100) || quality != (int)quality) {
        problem_set(&problem, PROBLEM_VALIDATION, "/quality", "range",
                    "quality is %g, expected a whole number from 1 to 100", quality);
        call_answer_problem(call, &problem);
        return;
    }
    if (is_shared(api, call, plan_id, shared_as))
        return;
    struct api_picture *picture = start_picture(api, call, plan_id, view);
    if (!picture)
        return;
    picture->has_revision = revision != NULL;
    (void)snprintf(picture->shared_as, sizeof picture->shared_as, "%s", shared_as ? shared_as : "");
    struct packet packet;
    packet_init(&packet, PACKET_RENDER);
    packet.render.shown.scene = scene;
    packet.render.shown.acceptances = acceptances;
    packet.render.shown.has_scene_revision = revision != NULL;
    packet.render.shown.scene_revision = revision ? *revision : 0;
    packet.render.shown.view = view;
    packet.render.quality = (int64_t)quality;
    packet.render.codec = is_jpeg ? PACKET_CODEC_JPEG : PACKET_CODEC_PNG;
    packet.render.full_color = true;
    packet.render.still = true;
    packet.render.annotations = marking.has_caption;
    packet.render.named = marking.is_named;
    packet.render.crosshair = marking.has_crosshair;
    (void)fleet_request(net_fleet(api->net), plan_id, &packet, picture_came, picture);
}

cJSON *api_view_parameter(struct call *call)
{
    struct problem problem;
    const char *text = call_query(call, "view");
    cJSON *patch = text ? json_read(text, strlen(text), &problem) : cJSON_CreateObject();
    cJSON *view = patch ? view_document_patch(NULL, patch, &problem) : NULL;
    cJSON_Delete(patch);
    if (!view) {
        problem_below(&problem, "/view");
        call_answer_problem(call, &problem);
    }
    return view;
}

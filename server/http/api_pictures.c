/* Requests pictures for calls, within a limit per plan, and answers with their bytes. */
#include "server/http/api_pictures.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/wire/missing.h"

struct api_picture {
    struct api_picture *next;
    struct call *call;
    char plan_id[64];
    double n_pixels;
    bool has_revision; /* the picture shows a room's scene: its revision is sent along */
};

static double pixels_of(const cJSON *view)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    return cJSON_GetNumberValue(cJSON_GetArrayItem(size, 0)) * cJSON_GetNumberValue(cJSON_GetArrayItem(size, 1));
}

/* Notes a picture under way; answers the call with 503 and returns false when the plan has too many. Scripts and rooms
 * share a plan's renderer: without a limit a script could keep it from the rooms. */
static bool start_picture(struct api *api, struct call *call, const char *plan_id, const cJSON *view, bool has_revision)
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
        return false;
    }
    struct api_picture *picture = mem_new(sizeof *picture);
    picture->next = api->pictures;
    picture->call = call;
    picture->n_pixels = n_pixels;
    picture->has_revision = has_revision;
    (void)snprintf(picture->plan_id, sizeof picture->plan_id, "%s", plan_id);
    api->pictures = picture;
    return true;
}

/* The picture is answered. Returns true when it showed a room's scene. */
static bool end_picture(struct api *api, const struct call *call)
{
    for (struct api_picture **at = &api->pictures; *at; at = &(*at)->next)
        if ((*at)->call == call) {
            struct api_picture *picture = *at;
            bool has_revision = picture->has_revision;
            *at = picture->next;
            free(picture);
            return has_revision;
        }
    return false;
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    struct problem broken;
    bool has_revision = end_picture(call->api, call);
    if (problem) {
        call_answer_problem(call, problem);
        return;
    }
    if (!answer->blob || answer->n_blob < 4) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer has no picture");
        call_answer_problem(call, &broken);
        return;
    }
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
    uint8_t *bytes = answer->blob;
    answer->blob = NULL;
    call_answer_bytes(call, 200, bytes[0] == 0xff ? "image/jpeg" : "image/png", bytes, answer->n_blob);
}

void api_picture_request(struct api *api, struct call *call, const char *plan_id, const cJSON *scene,
                         const uint32_t *revision, const cJSON *view, const char *format, double quality,
                         bool annotations)
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
    if (!start_picture(api, call, plan_id, view, revision != NULL))
        return;
    struct packet packet;
    packet_init(&packet, PACKET_RENDER);
    packet.render.shown.scene = scene;
    packet.render.shown.has_scene_revision = revision != NULL;
    packet.render.shown.scene_revision = revision ? *revision : 0;
    packet.render.shown.view = view;
    packet.render.quality = (int64_t)quality;
    packet.render.codec = is_jpeg ? PACKET_CODEC_JPEG : PACKET_CODEC_PNG;
    packet.render.full_color = true;
    packet.render.still = true;
    packet.render.annotations = annotations;
    (void)fleet_request(net_fleet(api->net), plan_id, &packet, picture_came, call);
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

#include "server/http/api.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_inner.h"
#include "server/wire/missing.h"

const struct api_route api_routes[] = {
    { "GET", "/healthz", api_healthz },
    { "GET", "/readyz", api_readyz },
    { "GET", "/metrics", api_metrics },
    { "GET", "/api/v1/version", api_version },
    { "GET", "/api/v1/openapi.json", api_openapi },
    { "GET", "/api/v1/plans", api_plans },
    { "POST", "/api/v1/plans", api_plan_upload },
    { "GET", "/api/v1/plans/{plan}", api_plan },
    { "DELETE", "/api/v1/plans/{plan}", api_plan_delete },
    { "POST", "/api/v1/plans/{plan}/open", api_plan_open },
    { "POST", "/api/v1/plans/{plan}/close", api_plan_close },
    { "GET", "/api/v1/jobs/{job}", api_job },
    { "DELETE", "/api/v1/jobs/{job}", api_job_cancel },
    { "POST", "/api/v1/plans/{plan}/render", api_plan_render },
    { "GET", "/api/v1/plans/{plan}/regions/{region}/surface", api_plan_surface },
    { "GET", "/api/v1/plans/{plan}/probe", api_plan_probe },
    { "GET", "/api/v1/plans/{plan}/pick", api_plan_pick },
    { "GET", "/api/v1/rooms", api_rooms },
    { "POST", "/api/v1/rooms", api_room_new },
    { "GET", "/api/v1/rooms/{room}", api_room },
    { "DELETE", "/api/v1/rooms/{room}", api_room_delete },
    { "GET", "/api/v1/rooms/{room}/scene", api_room_scene },
    { "PATCH", "/api/v1/rooms/{room}/scene", api_room_scene_patch },
    { "GET", "/api/v1/rooms/{room}/members", api_room_members },
    { "GET", "/api/v1/rooms/{room}/snapshot", api_room_snapshot },
    { "GET", "/api/v1/rooms/{room}/ws", api_room_ws },
};
const size_t api_n_routes = sizeof api_routes / sizeof api_routes[0];

struct api *api_create(struct net *net, uint64_t max_upload_bytes)
{
    struct api *api = mem_new(sizeof *api);
    api->net = net;
    api->max_upload_bytes = max_upload_bytes;
    api->started_us = clock_now_us();
    return api;
}

void api_destroy(struct api *api)
{
    free(api);
}

void api_count(struct api *api, int status, int64_t took_us)
{
    if (status >= 100 && status < 600)
        api->n_calls[status / 100]++;
    if (took_us > 0)
        api->n_calls_us += (uint64_t)took_us;
}

/* Whether the call's path is the route's; fills call->ids with what stands for {...}. */
static bool path_matches(struct call *call, const char *route)
{
    size_t at = 0, n_ids = 0;
    while (*route == '/') {
        const char *part = ++route;
        size_t n = strcspn(part, "/");
        route += n;
        if (at == call->n_segments)
            return false;
        const char *segment = call->segments[at++];
        if (part[0] == '{')
            call->ids[n_ids++] = segment;
        else if (strlen(segment) != n || strncmp(segment, part, n) != 0)
            return false;
    }
    return at == call->n_segments;
}

static const char *method_word(enum call_method method)
{
    static const char *const words[] = {
        "GET", "GET", "POST", "PATCH", "DELETE", ""
    }; /* HEAD is GET without the body */
    return words[method];
}

void api_handle(struct api *api, struct call *call)
{
    struct problem problem;
    char allowed[64] = "";
    bool is_known = false;
    call->api = api;
    api_update_jobs(api);
    if (call->early.type != PROBLEM_NONE) {
        call_answer_problem(call, &call->early);
        return;
    }
    if (!call_origin_is_own(call, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    for (size_t i = 0; i < api_n_routes; i++) {
        const struct api_route *route = &api_routes[i];
        if (!path_matches(call, route->path))
            continue;
        if (strcmp(route->method, method_word(call->method)) == 0) {
            for (size_t k = 0; k < CALL_MAX_SEGMENTS && call->ids[k]; k++)
                if (!id_is_valid(call->ids[k])) {
                    problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "\"%.60s\" is not an id", call->ids[k]);
                    call_answer_problem(call, &problem);
                    return;
                }
            call->route = route->path;
            route->handle(api, call);
            return;
        }
        is_known = true;
        size_t used = strlen(allowed);
        (void)snprintf(allowed + used, sizeof allowed - used, "%s%s", used ? ", " : "", route->method);
    }
    if (is_known) {
        call_add_header(call, "Allow", allowed);
        problem_set(&problem, PROBLEM_METHOD, "", "", "this address takes %s", allowed);
    } else {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "nothing is at %.200s", call->path);
    }
    call_answer_problem(call, &problem);
}

cJSON *api_new_query(const char *what)
{
    cJSON *query = cJSON_CreateObject();
    cJSON_AddStringToObject(query, "type", "query");
    cJSON_AddStringToObject(query, "what", what);
    return query;
}

void api_query_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    if (problem) {
        call_answer_problem(call, problem);
        return;
    }
    cJSON *body = cJSON_DetachItemFromObjectCaseSensitive(answer->json, "body");
    struct problem broken;
    if (!body) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer has no body");
        call_answer_problem(call, &broken);
        return;
    }
    call_answer_json(call, 200, body);
}

void api_query(struct api *api, struct call *call, const char *plan_id, cJSON *query)
{
    api_ask(api, call, plan_id, query, api_query_came);
}

void api_ask(struct api *api, struct call *call, const char *plan_id, cJSON *query, fleet_reply reply)
{
    struct problem problem;
    if (fleet_open(net_fleet(api->net), plan_id, &problem))
        (void)fleet_request(net_fleet(api->net), plan_id, query, reply, call);
    else
        reply(call, NULL, &problem);
    cJSON_Delete(query);
}

struct api_picture {
    struct api_picture *next;
    struct call *call;
    char plan_id[64];
    double n_pixels;
    bool has_revision; /* of a room's scene */
};

static double pixels_of(const cJSON *view)
{
    const cJSON *size = cJSON_GetObjectItemCaseSensitive(view, "size_px");
    return cJSON_GetNumberValue(cJSON_GetArrayItem(size, 0)) * cJSON_GetNumberValue(cJSON_GetArrayItem(size, 1));
}

/* Scripts and rooms share a plan's renderer: how much a script may put before the others has an end. */
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

/* Whether it was of a room's scene. */
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
    (void)snprintf(timing, sizeof timing, "render;dur=%.1f, encode;dur=%.1f",
                   json_number(answer->json, "render_us", 0) / 1000, json_number(answer->json, "encode_us", 0) / 1000);
    (void)snprintf(revision, sizeof revision, "%.0f", json_number(answer->json, "scene_revision", 0));
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

void api_render(struct api *api, struct call *call, const char *plan_id, const cJSON *scene, const uint32_t *revision,
                const cJSON *view, const char *format, double quality)
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
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "render");
    cJSON_AddItemToObject(packet, "scene", cJSON_Duplicate(scene, true));
    if (revision)
        cJSON_AddNumberToObject(packet, "scene_revision", *revision);
    cJSON_AddItemToObject(packet, "view", cJSON_Duplicate(view, true));
    cJSON_AddNumberToObject(packet, "scale_percent", 100);
    cJSON_AddNumberToObject(packet, "quality", quality);
    cJSON_AddStringToObject(packet, "codec", is_jpeg ? "jpeg" : "png");
    cJSON_AddBoolToObject(packet, "full_color", true);
    cJSON_AddStringToObject(packet, "detail", "full");
    cJSON_AddBoolToObject(packet, "still", true);
    (void)fleet_request(net_fleet(api->net), plan_id, packet, picture_came, call);
    cJSON_Delete(packet);
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

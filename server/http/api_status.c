/* The state of the server: /healthz, /readyz, /metrics, /version, and the OpenAPI document. */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/http/api_handlers.h"

extern const unsigned char openapi_json[]; /* generated from proto/http.json */
extern const size_t openapi_json_bytes;

void api_healthz(struct api *api, struct call *call)
{
    (void)api;
    call_answer_text(call, 200, "text/plain; charset=utf-8", "ok\n");
}

void api_readyz(struct api *api, struct call *call)
{
    const struct problem *problem = NULL;
    const cJSON *gl = fleet_gl(net_fleet(api->net), &problem);
    struct problem waiting;
    if (!fleet_is_listed(net_fleet(api->net))) {
        problem_set(&waiting, PROBLEM_BUSY, "", "", "the plan folders are still being listed");
        waiting.retry_after_ms = 500;
        call_answer_problem(call, &waiting);
        return;
    }
    if (gl) {
        cJSON *answer = cJSON_CreateObject();
        cJSON_AddItemToObject(answer, "gl", cJSON_Duplicate(gl, true));
        call_answer_json(call, 200, answer);
        return;
    }
    if (!problem) {
        problem_set(&waiting, PROBLEM_BUSY, "", "", "still looking for a way to draw");
        waiting.retry_after_ms = 500;
        problem = &waiting;
    }
    call_answer_problem(call, problem);
}

void api_version(struct api *api, struct call *call)
{
    const struct problem *problem = NULL;
    const cJSON *gl = fleet_gl(net_fleet(api->net), &problem);
    cJSON *answer = cJSON_CreateObject();
    cJSON_AddStringToObject(answer, "name", "Beamroom");
    cJSON_AddStringToObject(answer, "version", BEAMROOM_VERSION);
    cJSON_AddNumberToObject(answer, "api", 1);
    cJSON_AddNumberToObject(answer, "protocol", WIRE_PROTOCOL);
    cJSON_AddItemToObject(answer, "gl", gl ? cJSON_Duplicate(gl, true) : cJSON_CreateNull());
    cJSON_AddItemToObject(answer, "problem", problem ? problem_to_json(problem) : cJSON_CreateNull());
    cJSON_AddNumberToObject(answer, "max_upload_bytes", (double)api->max_upload_bytes);
    cJSON_AddBoolToObject(answer, "open_to_everybody", api->doors.is_open);
    cJSON_AddStringToObject(answer, "intended_use", "Research and plan review. Not a medical device.");
    call_answer_json(call, 200, answer);
}

void api_openapi(struct api *api, struct call *call)
{
    (void)api;
    uint8_t *copy = mem_new(openapi_json_bytes);
    memcpy(copy, openapi_json, openapi_json_bytes);
    call_answer_bytes(call, 200, "application/json", copy, openapi_json_bytes);
}

struct text {
    char *bytes;
    size_t used, room;
};

static void text_add(struct text *text, const char *format, ...) PRINTF_LIKE(2, 3);
static void text_add(struct text *text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text->bytes + text->used, text->room - text->used, format, args);
    va_end(args);
    if (n > 0 && (size_t)n < text->room - text->used)
        text->used += (size_t)n; /* a line that does not fit is left out */
    else
        text->bytes[text->used] = 0;
}

static void add_metric(struct text *text, const char *name, const char *type, const char *help, double value)
{
    text_add(text, "# HELP beamroom_%s %s\n# TYPE beamroom_%s %s\nbeamroom_%s %.17g\n", name, help, name, type, name,
             value);
}

/* Holds no plan ids and members' names: readers of the metrics may not be allowed to see patients. */
void api_metrics(struct api *api, struct call *call)
{
    struct fleet *fleet = net_fleet(api->net);
    struct net_counters n = { 0 };
    struct text text = { mem_new(16384), 0, 16384 };
    size_t plans[FLEET_FAILED + 1] = { 0 };
    double memory_bytes = 0;
    struct fleet_plan plan;
    net_count(api->net, &n);
    for (size_t i = 0; i < fleet_n_plans(fleet); i++)
        if (fleet_plan_at(fleet, i, &plan)) {
            plans[plan.state]++;
            memory_bytes += (double)plan.memory_bytes;
        }
    add_metric(&text, "uptime_seconds", "gauge", "Since the start.", (double)(clock_now_us() - api->started_us) / 1e6);
    text_add(&text, "# HELP beamroom_plans Plans by state.\n# TYPE beamroom_plans gauge\n");
    for (int state = 0; state <= FLEET_FAILED; state++)
        text_add(&text, "beamroom_plans{state=\"%s\"} %zu\n", fleet_state_word((enum fleet_state)state), plans[state]);
    add_metric(&text, "renderer_memory_bytes", "gauge", "Resident memory of all renderers.", memory_bytes);
    add_metric(&text, "rooms", "gauge", "Rooms in memory.", (double)net_n_rooms(api->net));
    add_metric(&text, "rooms_asleep", "gauge", "Rooms that are kept on disk alone.", (double)net_n_asleep(api->net));
    add_metric(&text, "websocket_connections", "gauge", "Open WebSockets.", (double)n.n_connections);
    add_metric(&text, "websocket_connections_total", "counter", "WebSockets ever opened.", (double)n.connections);
    add_metric(&text, "websocket_refused_total", "counter", "WebSockets refused.", (double)n.connections_refused);
    add_metric(&text, "renders_total", "counter", "Pictures asked for by rooms.", (double)n.rooms.pictures_requested);
    add_metric(&text, "frames_sent_total", "counter", "Frames sent to browsers.", (double)n.rooms.frames_sent);
    add_metric(&text, "frame_bytes_total", "counter", "Bytes of them.", (double)n.rooms.frame_bytes);
    add_metric(&text, "frames_skipped_total", "counter",
               "Frames a member did not get because it had not shown the last ones yet.",
               (double)n.rooms.frames_skipped);
    add_metric(&text, "stills_sent_total", "counter", "Full pictures sent.", (double)n.rooms.stills_sent);
    add_metric(&text, "messages_refused_total", "counter", "Messages of browsers answered with a problem.",
               (double)n.rooms.messages_refused);
    text_add(
        &text,
        "# HELP beamroom_http_requests_total Requests by class of status.\n# TYPE beamroom_http_requests_total counter\n");
    for (int class = 1; class < 6; class ++)
        text_add(&text, "beamroom_http_requests_total{code=\"%dxx\"} %" PRIu64 "\n", class, api->n_calls[class]);
    add_metric(&text, "http_pictures_total", "counter", "Pictures asked for by them.", (double)api->n_pictures);
    add_metric(&text, "http_pictures_waiting", "gauge", "Requests that wait for a picture.",
               (double)api->n_waiting_for_pictures);
    add_metric(&text, "http_seconds_total", "counter", "Time spent on them.", (double)api->n_calls_us / 1e6);
    const struct problem *problem = NULL;
    const cJSON *gl = fleet_gl(fleet, &problem);
    const char *back_end = json_text(gl, "back_end");
    text_add(
        &text,
        "# HELP beamroom_gl_info What draws.\n# TYPE beamroom_gl_info gauge\nbeamroom_gl_info{back_end=\"%s\",software=\"%s\"} %d\n",
        back_end ? back_end : "none", json_flag(gl, "is_software", false) ? "yes" : "no", gl ? 1 : 0);
    call_answer_bytes(call, 200, "text/plain; version=0.0.4; charset=utf-8", (uint8_t *)text.bytes, text.used);
}

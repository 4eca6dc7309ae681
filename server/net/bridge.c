/* Rooms and the fleet: what rooms ask for becomes packets, what renderers answer becomes pictures, and what happens to
 * a plan is told to its rooms. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/net/parts.h"
#include "server/wire/missing.h"

/* ---- rooms to the fleet ----------------------------------------------------------------------------------------- */

static void unlink_asked(struct asked *asked)
{
    struct asked **at = &asked->place->asked;
    while (*at != asked)
        at = &(*at)->next;
    *at = asked->next;
}

/* The renderer may be in the hands of a hostile file: what it says is checked as if it came from outside. */
static bool read_frame(const struct asked *asked, const struct packet *answer, struct frame_header *header)
{
    struct packet_frame frame;
    if (!packet_frame_read(answer, &frame))
        return false;
    *header =
        (struct frame_header){ .codec = 1,
                               .flags = asked->flags,
                               .quality = asked->quality,
                               .scale_percent = asked->scale_percent,
                               .scene_revision = asked->is_override ? asked->scene_revision : frame.scene_revision,
                               .width_px = frame.width_px,
                               .height_px = frame.height_px,
                               .render_us = frame.render_us,
                               .encode_us = frame.encode_us,
                               .payload_bytes = (uint32_t)answer->n_blob,
                               .pixels_per_mm_1000 = (uint32_t)llround(frame.pixels_per_mm * 1000) };
    memcpy(header->clip_from_lps_mm, frame.clip_from_lps_mm, sizeof header->clip_from_lps_mm);
    if (frame.is_light)
        header->flags |= FRAME_LIGHT; /* the renderer knows whether it really drew the lighter meshes */
    return true;
}

static void picture_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct asked *asked = context;
    struct place *place = asked->place;
    struct problem broken;
    struct frame_header header;
    unlink_asked(asked);
    if (answer && !read_frame(asked, answer, &header)) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer is not a frame");
        answer = NULL;
        problem = &broken;
    }
    if (answer) {
        struct room_picture *picture = mem_new(sizeof *picture);
        *picture = (struct room_picture){ .header = header,
                                          .bytes = answer->blob,
                                          .n_bytes = answer->n_blob,
                                          .references = 1,
                                          .missing = missing_read(answer->json) };
        answer->blob = NULL; /* taken */
        room_picture_came(place->room, asked->room_request, picture, clock_now_us());
    } else {
        room_picture_failed(place->room, asked->room_request, problem, clock_now_us());
    }
    free(asked);
    net_touch(place);
    net_plan_next_call(place->net);
}

static struct place *place_with(struct net *net, const struct room *room)
{
    for (size_t i = 0; i < net->n_places; i++)
        if (net->places[i]->room == room)
            return net->places[i];
    return NULL;
}

/* Tells the renderer the scene of a room if it does not have it yet. False: it could not be told. */
static bool tell_scene(struct place *place)
{
    uint32_t revision;
    const cJSON *scene = room_scene(place->room, &revision);
    if (place->is_scene_told)
        return true;
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "scene");
    cJSON_AddStringToObject(packet, "room", room_id(place->room));
    cJSON_AddNumberToObject(packet, "revision", revision);
    cJSON_AddItemReferenceToObject(packet, "scene", (cJSON *)(uintptr_t)scene);
    place->is_scene_told = fleet_tell(place->net->fleet, room_plan_id(place->room), packet);
    cJSON_Delete(packet);
    return place->is_scene_told;
}

void bridge_render(void *context, struct room *room, const struct room_render *request)
{
    struct net *net = context;
    struct place *place = place_with(net, room);
    const cJSON *scene = request->scene;
    if (!scene && !tell_scene(place))
        scene = room_scene(room, NULL); /* goes along with the picture */
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "render");
    if (scene)
        cJSON_AddItemReferenceToObject(packet, "scene", (cJSON *)(uintptr_t)scene);
    else
        cJSON_AddStringToObject(packet, "room", room_id(room));
    cJSON_AddItemReferenceToObject(packet, "view", (cJSON *)(uintptr_t)request->view);
    char source[144]; /* whose pictures are counted together: a member's own, or those a room shares */
    (void)snprintf(source, sizeof source, "%s/%s", room_id(room), request->member ? request->member : "");
    cJSON_AddStringToObject(packet, "source", source);
    cJSON_AddNumberToObject(packet, "scale_percent", request->scale_percent);
    cJSON_AddNumberToObject(packet, "quality", request->quality);
    cJSON_AddStringToObject(packet, "codec", "jpeg");
    cJSON_AddBoolToObject(packet, "full_color", request->full_color);
    cJSON_AddStringToObject(packet, "detail", request->light ? "light" : "full");
    cJSON_AddBoolToObject(packet, "still", request->is_still);

    struct asked *asked = mem_new(sizeof *asked);
    *asked = (struct asked){ .next = place->asked,
                             .place = place,
                             .room_request = request->request,
                             .scene_revision = request->scene_revision,
                             .flags = (uint8_t)((request->is_still ? FRAME_STILL : 0) |
                                                (request->full_color ? FRAME_FULL_COLOR : 0)),
                             .quality = (uint8_t)request->quality,
                             .scale_percent = (uint8_t)request->scale_percent,
                             .is_override = scene != NULL };
    place->asked = asked;
    asked->fleet_request = fleet_request(net->fleet, room_plan_id(room), packet, picture_came, asked);
    cJSON_Delete(packet);
}

void bridge_forget(void *context, struct room *room, uint64_t request)
{
    struct net *net = context;
    struct place *place = place_with(net, room);
    struct asked *asked =
        place ? place->asked : NULL; /* no place: the room is being closed, and all of it forgotten already */
    while (asked && asked->room_request != request)
        asked = asked->next;
    if (!asked)
        return;
    cJSON *packet = cJSON_CreateObject();
    cJSON_AddStringToObject(packet, "type", "drop");
    cJSON_AddNumberToObject(packet, "id", (double)asked->fleet_request);
    (void)fleet_tell(net->fleet, room_plan_id(room), packet); /* not ready: it was never sent */
    cJSON_Delete(packet);
    fleet_forget_request(net->fleet, asked->fleet_request);
    unlink_asked(asked);
    free(asked);
}

/* It is told with the next picture that needs it: rooms nobody looks into cost the renderer nothing, also after a
 * restart. */
void bridge_scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision)
{
    struct place *place = place_with(context, room);
    (void)scene;
    (void)revision;
    if (place)
        place->is_scene_told = false;
}

/* ---- the fleet to rooms ----------------------------------------------------------------------------------------- */

static void tell_ready(struct place *place, const struct fleet_plan *plan)
{
    const cJSON *gl = fleet_gl(place->net->fleet, NULL);
    const char *back_end = json_text(gl, "back_end"), *renderer = json_text(gl, "renderer");
    char words[200];
    (void)snprintf(words, sizeof words, "%s%s%s", back_end ? back_end : "", back_end && renderer ? ", " : "",
                   renderer ? renderer : "");
    place->generation = plan->generation;
    room_plan_ready(place->room, plan->document, plan->default_scene, words, json_flag(gl, "is_software", true),
                    clock_now_us());
}

static void tell_state(struct place *place, const struct fleet_plan *plan)
{
    enum wire_renderer_state state = WIRE_RENDERER_STATE_STARTING;
    struct problem closed;
    const struct problem *problem = NULL;
    switch (plan->state) {
    case FLEET_STARTING: state = WIRE_RENDERER_STATE_STARTING; break;
    case FLEET_LOADING: state = WIRE_RENDERER_STATE_LOADING; break;
    case FLEET_READY: state = WIRE_RENDERER_STATE_READY; break;
    case FLEET_RESTARTING:
        state = WIRE_RENDERER_STATE_RESTARTING;
        problem = plan->problem; /* while there is a pause */
        break;
    case FLEET_UNREADABLE:
    case FLEET_FAILED:
        state = WIRE_RENDERER_STATE_FAILED;
        problem = plan->problem;
        break;
    case FLEET_CLOSED: /* while nobody was there; or somebody closed it: then opening it or entering again helps */
        state = WIRE_RENDERER_STATE_CLOSED;
        problem_set(&closed, PROBLEM_CANCELLED, "", "", "the plan was closed");
        problem = &closed;
        break;
    }
    room_renderer_state(place->room, state, plan->phase, plan->percent, problem);
}

void bridge_tell_plan(struct place *place)
{
    struct fleet_plan plan;
    if (!fleet_plan_find(place->net->fleet, room_plan_id(place->room),
                         &plan)) { /* while nobody was there its folder was taken away */
        struct problem gone;
        problem_set(&gone, PROBLEM_NOT_FOUND, "", "", "the plan of this room is gone");
        place->state = FLEET_UNREADABLE;
        room_renderer_state(place->room, WIRE_RENDERER_STATE_FAILED, "", 0, &gone);
        return;
    }
    const char *phase = plan.phase ? plan.phase : "";
    bool is_same = plan.state == place->state && strcmp(phase, place->phase) == 0 && plan.percent == place->percent;
    if (plan.state == FLEET_READY ? place->state == FLEET_READY && place->generation == plan.generation : is_same)
        return;
    place->state = plan.state;
    place->percent = plan.percent;
    (void)snprintf(place->phase, sizeof place->phase, "%s", phase);
    if (plan.state == FLEET_READY && plan.document && plan.default_scene)
        tell_ready(place, &plan);
    else
        tell_state(place, &plan);
    net_touch(place);
}

void bridge_enter(struct visitor *visitor)
{
    struct place *place = visitor->place;
    visitor->is_holding = fleet_hold(place->net->fleet, room_plan_id(place->room));
    bridge_tell_plan(place); /* before it says hello, so that it is not welcomed with what was */
}

void bridge_leave(struct visitor *visitor)
{
    if (visitor->is_holding)
        fleet_release(visitor->place->net->fleet, room_plan_id(visitor->place->room));
    visitor->is_holding = false;
}

void bridge_fleet_changed(void *context, const char *plan_id)
{
    struct net *net = context;
    char id[64];
    if (!plan_id) { /* rooms live on plans, not on the list */
        atomic_store(&net->is_listed, fleet_is_listed(net->fleet));
        return;
    }
    (void)snprintf(id, sizeof id, "%s", plan_id); /* borrowed until the next call into the fleet */
    for (size_t i = 0; i < net->n_places; i++)
        if (strcmp(room_plan_id(net->places[i]->room), id) == 0)
            bridge_tell_plan(net->places[i]);
    net_plan_next_call(net);
}

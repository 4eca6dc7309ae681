/* Turns picture requests of rooms into packets, answers into pictures, and states of plans into reports to their rooms.
 */
#include "server/net/bridge.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/net/schedule.h"
#include "server/net/statements.h"
#include "server/wire/missing.h"

/* ---- rooms to the fleet ----------------------------------------------------------------------------------------- */

static void unlink_request(struct picture_request *request)
{
    struct picture_request **at = &request->room->requests;
    while (*at != request)
        at = &(*at)->next;
    *at = request->next;
}

/* The answer's frame, whose fields are checked, as a header for members. Returns false when it is another packet. */
static bool read_frame(const struct picture_request *request, const struct packet *answer, struct frame_header *header)
{
    const struct packet_frame *frame = &answer->frame;
    const int64_t n_more = frame->half_bytes + frame->quarter_bytes + frame->marked_bytes; /* each at most 81 MiB */
    if (answer->type != PACKET_FRAME || n_more >= (int64_t)answer->n_blob)
        return false;
    *header = (struct frame_header){ .codec = 1,
                                     .flags = request->flags,
                                     .quality = request->quality,
                                     .scale_percent = request->scale_percent,
                                     .scene_revision = request->is_override ? request->scene_revision
                                                                            : (uint32_t)frame->scene_revision,
                                     .width_px = (uint16_t)frame->width_px,
                                     .height_px = (uint16_t)frame->height_px,
                                     .render_us = (uint32_t)frame->render_us,
                                     .encode_us = (uint32_t)frame->encode_us,
                                     .payload_bytes = (uint32_t)(answer->n_blob - (size_t)n_more),
                                     .pixels_per_mm_1000 = (uint32_t)llround(frame->pixels_per_mm * 1000) };
    memcpy(header->clip_from_lps_mm, frame->clip_from_lps_mm, sizeof header->clip_from_lps_mm);
    if (frame->is_coarse)
        header->flags |= FRAME_COARSE; /* the renderer reports whether it did draw coarse meshes */
    return true;
}

/* A further picture with this header, whose n bytes are copied. NULL: there is none, or no memory for it. */
static struct frame *further_picture(struct frame_header header, const uint8_t *bytes, size_t n)
{
    uint8_t *copy = n ? malloc(n) : NULL;
    if (!copy)
        return NULL;
    memcpy(copy, bytes, n);
    struct frame *picture = mem_new(sizeof *picture);
    *picture = (struct frame){ .header = header, .bytes = copy, .n_bytes = n, .references = 1 };
    picture->header.payload_bytes = (uint32_t)n;
    return picture;
}

/* Takes the blob of a frame that read_frame has read. */
static struct frame *take_picture(struct packet *answer, const struct frame_header *header)
{
    const size_t n[IMAGE_N_REDUCED] = { (size_t)answer->frame.half_bytes, (size_t)answer->frame.quarter_bytes };
    const uint8_t *at = answer->blob + header->payload_bytes;
    struct frame *picture = mem_new(sizeof *picture);
    *picture = (struct frame){ .header = *header,
                               .bytes = answer->blob,
                               .n_bytes = header->payload_bytes,
                               .references = 1,
                               .missing = missing_read(answer->json) };
    for (int i = 0; i < IMAGE_N_REDUCED; at += n[i++])
        picture->reduced[i] = further_picture(frame_header_reduced(header, image_divisor(i)), at, n[i]);
    picture->marked = further_picture(*header, at, (size_t)answer->frame.marked_bytes);
    if (picture->marked && picture->missing)
        picture->marked->missing = cJSON_Duplicate(picture->missing, true);
    answer->blob = NULL;
    return picture;
}

static void picture_answered(void *context, struct packet *answer, const struct problem *problem)
{
    struct picture_request *request = context;
    struct net_room *entry = request->room;
    struct problem broken;
    struct frame_header header;
    unlink_request(request);
    if (answer && !read_frame(request, answer, &header)) {
        problem_set(&broken, PROBLEM_RENDERER, "", "", "the renderer's answer is not a frame");
        answer = NULL;
        problem = &broken;
    }
    if (answer) {
        room_picture_came(entry->room, request->room_request, take_picture(answer, &header), clock_now_us());
    } else {
        room_picture_failed(entry->room, request->room_request, problem, clock_now_us());
    }
    free(request);
    schedule_room(entry);
}

static struct net_room *find_entry(struct net *net, const struct room *room)
{
    for (size_t i = 0; i < net->n_rooms; i++)
        if (net->rooms[i]->room == room)
            return net->rooms[i];
    return NULL;
}

/* Sends the room's scene to the renderer if it does not have it. Returns false when it could not be sent. */
static bool send_scene(struct net_room *entry)
{
    uint32_t revision;
    const cJSON *scene = room_scene(entry->room, &revision);
    if (entry->renderer_has_scene)
        return true;
    struct packet packet;
    packet_init(&packet, PACKET_SCENE);
    (void)snprintf(packet.scene.room, sizeof packet.scene.room, "%s", room_id(entry->room));
    packet.scene.revision = revision;
    packet.scene.scene = scene;
    packet.scene.acceptances = room_acceptances(entry->room);
    entry->renderer_has_scene = fleet_tell(entry->net->fleet, room_plan_id(entry->room), &packet);
    return entry->renderer_has_scene;
}

void bridge_render(void *context, struct room *room, const struct room_render *request)
{
    struct net *net = context;
    struct net_room *entry = find_entry(net, room);
    const cJSON *scene = request->scene;
    if (!scene && !send_scene(entry))
        scene = room_scene(room, NULL); /* then the request carries the scene */
    struct packet packet;
    packet_init(&packet, PACKET_RENDER);
    struct packet_render *render = &packet.render;
    render->shown.scene = scene;
    if (scene)
        render->shown.acceptances = room_acceptances(room);
    else
        (void)snprintf(render->shown.room, sizeof render->shown.room, "%s", room_id(room));
    render->shown.view = request->view;
    /* the renderer serves sources in turn: one member's own pictures, or a room's shared ones */
    (void)snprintf(render->source, sizeof render->source, "%s/%s", room_id(room),
                   request->member ? request->member : "");
    render->scale_percent = request->scale_percent;
    render->quality = request->quality;
    render->full_color = request->full_color;
    render->detail = request->coarse ? PACKET_DETAIL_COARSE : PACKET_DETAIL_FULL;
    render->still = request->is_still;
    render->acted = request->is_acted;
    render->last = request->is_of_wall;
    render->half = request->is_reduced[0];
    render->quarter = request->is_reduced[1];
    render->marked = request->is_marked;

    struct picture_request *sent = mem_new(sizeof *sent);
    *sent = (struct picture_request){ .next = entry->requests,
                                      .room = entry,
                                      .room_request = request->request,
                                      .scene_revision = request->scene_revision,
                                      .flags = (uint8_t)((request->is_still ? FRAME_STILL : 0) |
                                                         (request->full_color ? FRAME_FULL_COLOR : 0)),
                                      .quality = (uint8_t)request->quality,
                                      .scale_percent = (uint8_t)request->scale_percent,
                                      .is_override = scene != NULL };
    entry->requests = sent;
    sent->fleet_request = fleet_request(net->fleet, room_plan_id(room), &packet, picture_answered, sent);
}

void bridge_forget(void *context, struct room *room, uint64_t request)
{
    struct net *net = context;
    struct net_room *entry = find_entry(net, room);
    struct picture_request *sent =
        entry ? entry->requests : NULL; /* NULL while the room is being closed: bridge_close_room forgot its requests */
    while (sent && sent->room_request != request)
        sent = sent->next;
    if (!sent)
        return;
    struct packet packet;
    packet_init(&packet, PACKET_DROP);
    packet.drop.id = (int64_t)sent->fleet_request;
    (void)fleet_tell(net->fleet, room_plan_id(room), &packet); /* false when not ready: the request was never sent */
    fleet_forget_request(net->fleet, sent->fleet_request);
    unlink_request(sent);
    free(sent);
}

/* The scene is sent with the next picture request that needs it: rooms without viewers cost the renderer nothing, also
 * after a restart. */
void bridge_scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision)
{
    struct net_room *entry = find_entry(context, room);
    (void)scene;
    (void)revision;
    if (entry)
        entry->renderer_has_scene = false;
}

/* ---- the fleet to rooms ----------------------------------------------------------------------------------------- */

static void report_ready(struct net_room *entry, const struct fleet_plan *plan)
{
    const cJSON *gl = fleet_gl(entry->net->fleet, NULL);
    const char *back_end = json_text(gl, "back_end"), *renderer = json_text(gl, "renderer");
    char words[200];
    (void)snprintf(words, sizeof words, "%s%s%s", back_end ? back_end : "", back_end && renderer ? ", " : "",
                   renderer ? renderer : "");
    entry->generation = plan->generation;
    if (!room_plan_ready(entry->room, plan->document, plan->default_scene, words, json_flag(gl, "is_software", true),
                         clock_now_us()))
        entry->generation = 0; /* reported again with the next change, and when somebody enters */
}

static void report_state(struct net_room *entry, const struct fleet_plan *plan)
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
        problem = plan->problem; /* set while the restart waits */
        break;
    case FLEET_UNREADABLE:
    case FLEET_FAILED:
        state = WIRE_RENDERER_STATE_FAILED;
        problem = plan->problem;
        break;
    case FLEET_CLOSED: /* idle, or closed by a call: entering the room or opening the plan starts it again */
        state = WIRE_RENDERER_STATE_CLOSED;
        problem_set(&closed, PROBLEM_CANCELLED, "", "", "the plan was closed");
        problem = &closed;
        break;
    }
    room_renderer_state(entry->room, state, plan->phase, plan->percent, problem, clock_now_us());
}

void bridge_tell_revision(struct net_room *entry)
{
    struct fleet_revision revision;
    if (!room_wants_revision(entry->room) || !fleet_revision(entry->net->fleet, room_plan_id(entry->room), &revision) ||
        !revision.is_current)
        return;
    room_revision_came(entry->room, revision.digest, clock_now_us());
    schedule_room(entry);
}

void bridge_report_plan(struct net_room *entry)
{
    struct fleet_plan plan;
    if (!fleet_plan_find(entry->net->fleet, room_plan_id(entry->room), &plan)) {
        struct problem gone;
        if (!fleet_is_listed(entry->net->fleet))
            return; /* not yet known */
        /* its folder was removed while nobody held it, or while the daemon did not run */
        problem_set(&gone, PROBLEM_NOT_FOUND, "", "", "the plan of this room is gone");
        entry->state = FLEET_UNREADABLE;
        room_renderer_state(entry->room, WIRE_RENDERER_STATE_FAILED, "", 0, &gone, clock_now_us());
        return;
    }
    room_plan_revision(entry->room, plan.revision);
    room_files(entry->room, plan.files_changed_ms, plan.files_read_ms);
    entry->net->files_looked(entry, &plan);
    bridge_tell_revision(entry);
    const char *phase = plan.phase ? plan.phase : "";
    bool is_same = plan.state == entry->state && strcmp(phase, entry->phase) == 0 && plan.percent == entry->percent;
    if (plan.state == FLEET_READY ? entry->state == FLEET_READY && entry->generation == plan.generation : is_same)
        return;
    entry->state = plan.state;
    entry->percent = plan.percent;
    (void)snprintf(entry->phase, sizeof entry->phase, "%s", phase);
    if (plan.state == FLEET_READY && plan.document && plan.default_scene) {
        report_ready(entry, &plan);
        bridge_tell_revision(entry); /* of what this process has loaded */
    } else {
        report_state(entry, &plan);
    }
    schedule_room(entry);
}

void bridge_enter(struct visitor *visitor)
{
    struct net_room *entry = visitor->room;
    visitor->holds_plan = fleet_hold(entry->net->fleet, room_plan_id(entry->room));
    bridge_report_plan(entry); /* before the member's hello, so that the welcome holds the present state */
}

void bridge_leave(struct visitor *visitor)
{
    if (visitor->holds_plan)
        fleet_release(visitor->room->net->fleet, room_plan_id(visitor->room->room));
    visitor->holds_plan = false;
}

/* The list of plans has changed: it may have the plan of a room that was entered while it was missing. */
static void enter_again(struct net *net)
{
    struct fleet_plan plan;
    for (struct visitor *visitor = net->visitors; visitor; visitor = visitor->next)
        if (visitor->room && !visitor->holds_plan && !visitor->waits &&
            fleet_plan_find(net->fleet, room_plan_id(visitor->room->room), &plan))
            bridge_enter(visitor);
}

void bridge_fleet_changed(void *context, const char *plan_id)
{
    struct net *net = context;
    char id[64];
    if (!plan_id) {
        atomic_store(&net->is_listed, fleet_is_listed(net->fleet));
        enter_again(net);
        return;
    }
    (void)snprintf(id, sizeof id, "%s", plan_id); /* borrowed until the next call into the fleet */
    for (size_t i = 0; i < net->n_rooms; i++)
        if (strcmp(room_plan_id(net->rooms[i]->room), id) == 0)
            bridge_report_plan(net->rooms[i]);
    statements_plan_changed(net, id);
}

void bridge_look_at_files(struct net *net, int64_t now_us)
{
    struct fleet_revision revision;
    if (now_us < net->look_us)
        return;
    net->look_us = now_us + LOOK_AT_FILES_S * INT64_C(1000000);
    for (size_t i = 0; i < net->n_rooms; i++)
        if (!net->rooms[i]->empty_since_us && net->rooms[i]->state == FLEET_READY)
            (void)fleet_revision(net->fleet, room_plan_id(net->rooms[i]->room), &revision);
}

void bridge_close_room(struct net_room *entry)
{
    struct fleet *fleet = entry->net->fleet;
    while (entry->requests) {
        struct picture_request *request = entry->requests;
        entry->requests = request->next;
        fleet_forget_request(fleet, request->fleet_request);
        free(request);
    }
    struct packet packet;
    packet_init(&packet, PACKET_FORGET);
    (void)snprintf(packet.forget.room, sizeof packet.forget.room, "%s", room_id(entry->room));
    (void)fleet_tell(fleet, room_plan_id(entry->room), &packet);
}

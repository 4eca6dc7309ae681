/* Rooms, WebSocket and wire, while a call of the system fails: what is said is said whole or refused, and a room keeps
 * its scene or has the new one. */
#include <unistd.h>

#include "core/base/mem.h"
#include "core/scene/snapshot.h"
#include "server/wire/document.h"
#include "server/wire/message.h"
#include "server/wire/packet.h"
#include "server/wire/plan_document.h"
#include "server/ws/parser.h"
#include "tests/check.h"
#include "tests/faults/walk.h"
#include "tests/made_ragged.h"
#include "tests/unit/room_fake.h"

static void add_json(struct outcome *outcome, const cJSON *json)
{
    faults_pause();
    (void)json_no_memory(NULL, "what the fake renderer keeps");
    char *text = json_write(json);
    outcome_add_text(outcome, text);
    free(text);
    faults_go_on();
}

/* ---- rooms -------------------------------------------------------------------------------------------------------- */

struct room_world {
    struct fake_room fake;
    struct fake_page page, other;
};

static struct room_world *world_make(void)
{
    struct room_world *world = mem_new(sizeof *world);
    fake_room_start(&world->fake, 8);
    fake_plan_ready(&world->fake, true);
    fake_join(&world->fake, &world->other, true);
    return world;
}

static void world_end(struct room_world *world)
{
    fake_room_end(&world->fake);
    fake_page_end(&world->page);
    fake_page_end(&world->other);
    free(world);
}

/* Adds the messages that the page received, without random values; a refusal or a bye is a clear answer. */
static void add_page(struct outcome *outcome, const struct fake_page *page)
{
    for (size_t i = 0; i < page->n_texts; i++) {
        cJSON *json = json_read(page->texts[i], strlen(page->texts[i]), NULL);
        if (!json) { /* half a document: a finding */
            outcome_note(outcome, page->texts[i]);
            outcome_add_text(outcome, "half");
            continue;
        }
        const char *type = json_text(json, "type");
        outcome_add_text(outcome, type);
        outcome_note(outcome, type);
        outcome_add_number(outcome, cJSON_GetArraySize(json));
        const char *state = json_text(json, "state"); /* of the renderer */
        outcome->is_told |=
            strcmp(type, "problem") == 0 || strcmp(type, "bye") == 0 || (state && strcmp(state, "failed") == 0);
        cJSON_Delete(json);
    }
    outcome->is_told |= page->is_closed;
    outcome_note(outcome, page->is_closed ? "closed" : "open");
}

static void join(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    faults_go_on();
    static const char hello[] = "{\"type\":\"hello\",\"protocol\":2}",
                      open[] =
                          "{\"type\":\"view.open\",\"view\":1,\"document\":{\"size_px\":[800,600]},\"follow\":true}",
                      patch[] = "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.25}}}}";
    struct room *room = world->fake.room;
    uint32_t before, after;
    double opacity = 0.4;
    (void)room_scene(room, &before);
    room_text_came(room, &world->page, hello, sizeof hello - 1, world->fake.now_us);
    if (!world->page.is_closed)
        room_text_came(room, &world->page, open, sizeof open - 1, world->fake.now_us);
    if (!world->other.is_closed) /* who was there first presents */
        room_text_came(room, &world->other, patch, sizeof patch - 1, world->fake.now_us);
    (void)room_settle(room, world->fake.now_us);
    faults_pause();
    const cJSON *scene = room_scene(room, &after), *regions = cJSON_GetObjectItem(scene, "regions");
    opacity = json_number(cJSON_GetObjectItem(regions, "scalp"), "opacity", 0.4);
    outcome->is_done = true;
    add_page(outcome, &world->page);
    add_page(outcome, &world->other);
    if (!(after == before ? opacity == 0.4 : opacity == 0.25 && after == before + 1)) {
        outcome->is_told = false;
        outcome_note(outcome, "the scene is neither the old one nor the new one");
    }
    if (!outcome->is_told)
        add_json(outcome, scene);
    outcome_add_number(outcome, (double)room_n_connected(room));
    world_end(world);
    faults_go_on();
}

static void patch_scene(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    static const char words[] =
        "{\"regions\":{\"brain\":{\"opacity\":0.5,\"color\":\"#102030\"}},\"image\":{\"interpolation\":\"nearest\"}}";
    cJSON *patch = json_read(words, sizeof words - 1, NULL);
    uint32_t before, after;
    char *old = json_write(room_scene(world->fake.room, &before));
    faults_go_on();
    outcome->is_done = room_patch_scene(world->fake.room, patch, NULL, "", world->fake.now_us, &outcome->problem);
    faults_pause();
    (void)json_no_memory(NULL, "what the fake renderer keeps");
    char *now = json_write(room_scene(world->fake.room, &after));
    outcome_add_text(outcome, now);
    outcome_add_number(outcome, after);
    if (!outcome->is_done && (strcmp(old, now) != 0 || before != after)) {
        outcome->is_done = true;
        outcome->digest = 1;
        outcome_note(outcome, "refused, and half applied");
    }
    free(old);
    free(now);
    cJSON_Delete(patch);
    world_end(world);
    faults_go_on();
}

/* A member leaves and looks elsewhere; then the presenter loses the link for good. */
static void leave(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    fake_join(&world->fake, &world->page, true);
    static const char
        away[] = "{\"type\":\"follow\",\"follow\":false}",
        look[] = "{\"type\":\"view.patch\",\"view\":1,\"patch\":{\"size_px\":[640,480],\"camera\":{\"height_mm\":66},"
                 "\"override\":{\"image\":{\"slices\":{\"axial\":{\"position_mm\":21}}}}}}";
    struct room *room = world->fake.room;
    int64_t now_us = world->fake.now_us;
    faults_go_on();
    room_text_came(room, &world->page, away, sizeof away - 1, now_us);
    if (!world->page.is_closed)
        room_text_came(room, &world->page, look, sizeof look - 1, now_us);
    room_connection_closed(room, &world->other, now_us);
    now_us += ROOM_PRESENTER_KEPT_S * INT64_C(1000000);
    for (int i = 0; i < 2; i++) /* a second time where there was no memory */
        now_us = room_settle(room, now_us) < INT64_MAX ? now_us + 200000 : now_us;
    faults_pause();
    outcome->is_done = true;
    struct outcome heard = { 0 }; /* how often it is told the state on the way is no matter */
    add_page(&heard, &world->page);
    outcome->is_told = heard.is_told;
    outcome_note(outcome, heard.notes);
    cJSON *members = room_members(room);
    const cJSON *page = cJSON_GetArrayItem(members, 1);
    outcome->is_told |= !json_flag(page, "presenting", false); /* it is tried again and again */
    for (cJSON *row = members->child; row; row = row->next)
        cJSON_DeleteItemFromObject(row, "lag"); /* whether the picture is late depends on when it was tried again */
    add_json(outcome, members);
    add_json(outcome, room_scene(room, NULL));
    cJSON_Delete(members);
    world_end(world);
    faults_go_on();
}

/* A note is written, changed and deleted: the room and who keeps its items know the same of it, whatever fails. */
static void write_note(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    struct room *room = world->fake.room;
    static const char put[] = "{\"type\":\"item.put\",\"kind\":\"note\",\"body\":{\"text\":\"Edge?\",\"anchor\":{"
                              "\"point_mm\":[1,2,3],\"region\":\"brain\"},\"mentions\":[{\"member\":\"m1\","
                              "\"name\":\"Ann\"}]}}";
    char change[200], remove[100];
    faults_go_on();
    room_text_came(room, &world->other, put, sizeof put - 1, world->fake.now_us);
    faults_pause();
    cJSON *row = world->fake.n_kept ? cJSON_Parse(world->fake.kept[0]) : NULL;
    const char *id = json_text(row, "id");
    (void)
        snprintf(change, sizeof change,
                 "{\"type\":\"item.put\",\"item\":\"%s\",\"version\":1,\"kind\":\"note\",\"body\":{\"text\":\"Rim.\"}}",
                 id ? id : "i-0");
    (void)snprintf(remove, sizeof remove, "{\"type\":\"item.delete\",\"item\":\"%s\"}", id ? id : "i-0");
    faults_go_on();
    if (!world->other.is_closed)
        room_text_came(room, &world->other, change, strlen(change), world->fake.now_us);
    faults_pause();
    const size_t n_kept = world->fake.n_kept;
    char *newest = n_kept ? mem_copy_text(world->fake.kept[n_kept - 1]) : NULL;
    (void)json_no_memory(NULL, "what the fake renderer keeps");
    cJSON *rows = room_items(room, WIRE_ITEM_KIND_NOTE);
    char *first = cJSON_GetArraySize(rows) ? json_print(cJSON_GetArrayItem(rows, 0)) : NULL;
    const bool is_same = newest && first ? strcmp(newest, first) == 0 : !newest && !first;
    faults_go_on();
    if (!world->other.is_closed)
        room_text_came(room, &world->other, remove, strlen(remove), world->fake.now_us);
    faults_pause();
    (void)json_no_memory(NULL, "what the fake renderer keeps");
    outcome->is_done = true;
    outcome_add_number(outcome, (double)world->fake.n_kept);
    add_page(outcome, &world->other);
    if (!is_same) {
        outcome->is_told = false;
        outcome->digest = 1;
        outcome_note(outcome, "the room has another note than who keeps it");
    }
    free(first);
    free(newest);
    cJSON_Delete(rows);
    cJSON_Delete(row);
    world_end(world);
    faults_go_on();
}

static void draw_frame(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    faults_go_on();
    for (int i = 0; i < 3 && fake_oldest(&world->fake); i++) {
        fake_draw(&world->fake, fake_oldest(&world->fake));
        if (!world->other.is_closed && world->other.n_frames)
            fake_shown(&world->fake, &world->other);
    }
    faults_pause();
    outcome->is_done = true;
    outcome_add_number(outcome, (double)world->other.n_frames);
    add_page(outcome, &world->other);
    world_end(world);
    faults_go_on();
}

static void ready_again(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    static const char words[] = "{\"id\":\"head\",\"images\":[],\"regions\":[{\"id\":\"brain\"}]}";
    cJSON *plan = json_read(words, sizeof words - 1, NULL);
    struct scene scene = scene_default;
    struct scene_region_style_entry entry = { .id = "brain", .value = scene_region_style_default };
    scene.regions = &entry;
    scene.n_regions = 1;
    cJSON *defaults = scene_write(&scene);
    faults_go_on();
    (void)room_plan_ready(world->fake.room, plan, defaults, "made up", true, world->fake.now_us);
    faults_pause();
    outcome->is_done = true;
    add_page(outcome, &world->other);
    add_json(outcome, room_scene(world->fake.room, NULL));
    cJSON_Delete(plan);
    cJSON_Delete(defaults);
    world_end(world);
    faults_go_on();
}

static void describe_room(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct room_world *world = world_make();
    faults_go_on();
    cJSON *document = room_document(world->fake.room);
    char *text = document ? json_print(document) : NULL;
    if (text) {
        outcome->is_done = true;
        outcome_add_number(outcome, (double)strlen(text));
        outcome_note(outcome, text);
    } else {
        json_no_memory(&outcome->problem, "the document of a room");
    }
    free(text);
    cJSON_Delete(document);
    faults_pause();
    world_end(world);
    faults_go_on();
}

/* ---- WebSocket ---------------------------------------------------------------------------------------------------- */

static void parse_frames(void *context, struct outcome *outcome)
{
    (void)context;
    struct ws_parser parser;
    struct ws_event event = { 0 };
    uint8_t frame[8 + 6000] = { 0x01, 0xfe, 6000 >> 8, 6000 & 0xff, 0, 0, 0, 0 };
    static const uint8_t rest[] = { 0x80, 0x85, 0, 0, 0, 0, 'h', 'e', 'l', 'l', 'o' };
    memset(frame + 8, 'x', 6000);
    ws_parser_init(&parser, 65536, false);
    (void)ws_parser_take(&parser, frame, sizeof frame, &event);
    if (event.type == WS_EVENT_NONE)
        (void)ws_parser_take(&parser, rest, sizeof rest, &event);
    if (event.type == WS_EVENT_MESSAGE) {
        outcome->is_done = true;
        outcome_add(outcome, event.bytes, event.n);
    } else if (event.type == WS_EVENT_BROKEN && event.code == WS_CLOSE_INTERNAL) {
        problem_set(&outcome->problem, PROBLEM_INTERNAL, "", "", "%s", event.reason);
    }
    ws_parser_finish(&parser);
}

/* ---- wire --------------------------------------------------------------------------------------------------------- */

static void read_messages(void *context, struct outcome *outcome)
{
    struct message message;
    const char *text = context;
    outcome->is_done = message_read(text, strlen(text), true, &message, &outcome->problem);
    if (!outcome->is_done)
        return;
    char *again = message_write(&message);
    if (again) {
        outcome_add_text(outcome, again);
    } else {
        outcome->is_done = false;
        json_no_memory(&outcome->problem, "a message");
    }
    free(again);
    message_finish(&message);
}

static void scene_both_ways(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct plan *plan = ragged_plan();
    struct scene scene, again;
    scene_for_plan(plan, &scene);
    faults_go_on();
    cJSON *json = scene_write(&scene);
    char *text = json ? json_print(json) : NULL;
    if (!text)
        json_no_memory(&outcome->problem, "a scene");
    else if (scene_read(json, &again, &outcome->problem)) {
        outcome->is_done = true;
        outcome_add_text(outcome, text);
        outcome_add_number(outcome, (double)again.n_regions);
        scene_finish(&again);
    }
    free(text);
    cJSON_Delete(json);
    scene_finish(&scene);
    plan_destroy(plan);
}

static void describe_plan(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct plan *plan = ragged_plan();
    faults_go_on();
    cJSON *json = plan_document(plan);
    char *text = json ? json_print(json) : NULL;
    if (text) {
        outcome->is_done = true;
        outcome_add_text(outcome, text);
    } else {
        json_no_memory(&outcome->problem, "the document of a plan");
    }
    free(text);
    cJSON_Delete(json);
    plan_destroy(plan);
}

/* Written at one end, read at the other. */
static void packets(void *context, struct outcome *outcome)
{
    (void)context;
    size_t n, room;
    uint8_t blob[3000];
    struct packet packet;
    memset(blob, 7, sizeof blob);
    faults_pause();
    static const char words[] = "{\"n_triangles\":12}";
    cJSON *body = json_read(words, sizeof words - 1, NULL);
    struct packet written;
    packet_init(&written, PACKET_ANSWER);
    written.answer.id = 7;
    written.answer.body = body;
    faults_go_on();
    uint8_t *bytes = packet_encode(&written, blob, sizeof blob, &n, &outcome->problem);
    struct packet_reader *reader = packet_reader_create(PACKET_TO_DAEMON);
    int state = bytes ? 0 : -1;
    for (size_t at = 0; state == 0 && at < n;) {
        uint8_t *space = packet_reader_space(reader, &room, &outcome->err);
        if (!space) {
            state = -1;
            break;
        }
        size_t step = room < 700 ? room : 700;
        step = step < n - at ? step : n - at;
        memcpy(space, bytes + at, step);
        packet_reader_added(reader, step);
        at += step;
        state = packet_reader_take(reader, &packet, &outcome->err);
    }
    if (state == 1) {
        outcome->is_done = true;
        outcome_add(outcome, packet.blob, packet.n_blob);
        add_json(outcome, packet.json);
        packet_finish(&packet);
    }
    packet_reader_destroy(reader);
    free(bytes);
    cJSON_Delete(body);
}

int main(void)
{
    static char patch
        [] = "{\"type\":\"scene.patch\",\"patch\":{\"regions\":{\"scalp\":{\"opacity\":0.25}}}}",
   open[] =
        "{\"type\":\"view.open\",\"view\":1,\"document\":{\"size_px\":[800,600],\"override\":{\"regions\":{\"a\":null}}},"
        "\"follow\":false}";
    const struct walk walks[] = {
        { .name = "somebody joins a room, opens a view and changes the scene", .run = join },
        { .name = "a member leaves, and then presents because nobody else does", .run = leave },
        { .name = "a scene is changed", .run = patch_scene },
        { .name = "a note is written, changed and deleted", .run = write_note },
        { .name = "pictures are drawn and shown", .run = draw_frame },
        { .name = "a renderer comes back with another plan", .run = ready_again },
        { .name = "a room is described", .run = describe_room },
        { .name = "frames of a WebSocket are read", .run = parse_frames },
        { .name = "a patch of a scene is read and written", .run = read_messages, .context = patch },
        { .name = "a new view is read and written", .run = read_messages, .context = open },
        { .name = "a scene is written and read", .run = scene_both_ways },
        { .name = "a plan is described", .run = describe_plan },
        { .name = "a packet is written and read", .run = packets },
    };
    for (size_t i = 0; i < sizeof walks / sizeof walks[0]; i++) {
        struct walk walk = walks[i];
        walk.kinds[FAULT_MEMORY] = true;
        walk_run(&walk);
    }
    return walks_end();
}

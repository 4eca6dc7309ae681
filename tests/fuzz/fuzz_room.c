/* A room with two browsers: each line of the input is a message or an event. Invariants: at most two frames
 * unacknowledged, sequence numbers count up, the scene's revision never decreases, no timer is set in the past, at most
 * one member presents, and who is alone does. */
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/room/room.h"
#include "tests/fuzz/fuzz.h"
#include "tests/fuzz/kept_plan.h"

enum { N_PAGES = 2, MAX_REQUESTS = 4096 };

static struct page {
    uint32_t sent[ROOM_WATCH + 1], shown[ROOM_WATCH + 1];
    bool is_closed;
} pages[N_PAGES];
static uint64_t requests[MAX_REQUESTS];
static size_t n_requests, n_answered;

static void render(void *context, struct room *room, const struct room_render *request)
{
    (void)context;
    (void)room;
    REQUIRE(request->view != NULL && request->scale_percent >= 10 && request->scale_percent <= 100);
    REQUIRE(!request->is_still || (request->scale_percent == 100 && request->full_color && !request->coarse));
    if (n_requests < MAX_REQUESTS)
        requests[n_requests++] = request->request;
}

static void forget(void *context, struct room *room, uint64_t request)
{
    bool was_requested = false;
    (void)context;
    (void)room;
    for (size_t i = 0; i < n_requests; i++)
        was_requested = was_requested || requests[i] == request;
    REQUIRE(was_requested || n_requests == MAX_REQUESTS);
}

static void scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision)
{
    static uint32_t last;
    (void)context;
    (void)room;
    REQUIRE(scene != NULL && (revision >= last || revision == 1));
    last = revision;
}

static void send_text(void *context, void *connection, const char *text)
{
    (void)context;
    REQUIRE(!((struct page *)connection)->is_closed);
    cJSON *json = json_read(text, strlen(text), NULL);
    REQUIRE(json != NULL && json_text(json, "type") != NULL);
    cJSON_Delete(json);
}

static void send_latest(void *context, void *connection, uint32_t key, const char *text)
{
    (void)key;
    send_text(context, connection, text);
}

static void send_frame(void *context, void *connection, const struct frame_header *header, struct frame *picture)
{
    struct page *page = connection;
    (void)context;
    REQUIRE(!page->is_closed && picture->references > 0);
    REQUIRE(header->view >= 1 && header->view <= ROOM_WATCH);
    REQUIRE(header->sequence == page->sent[header->view] + 1);
    page->sent[header->view] = header->sequence;
    REQUIRE(header->sequence - page->shown[header->view] <= ROOM_MAX_UNSHOWN);
}

static void close_connection(void *context, void *connection)
{
    (void)context;
    ((struct page *)connection)->is_closed = true;
}

static void answer(struct room *room, bool has_failed, int64_t now_us)
{
    if (n_answered == n_requests)
        return;
    uint64_t request = requests[n_answered++];
    if (has_failed) {
        struct problem problem = { .type = PROBLEM_RENDERER };
        room_picture_failed(room, request, &problem, now_us);
        return;
    }
    struct frame *picture = mem_new(sizeof *picture);
    *picture = (struct frame){ .header = { .codec = 1, .render_us = (uint32_t)(request * 7919 % 90000) },
                               .bytes = mem_new(8),
                               .n_bytes = 8,
                               .references = 1 };
    room_picture_came(room, request, picture, now_us);
}

/* Counts an acknowledgement as the room must: only if that frame was sent and none after it is acknowledged yet. */
static void follow_acknowledgement(struct page *page, const char *text, size_t n)
{
    cJSON *json = json_read(text, n, NULL);
    const char *type = json_text(json, "type");
    double view = json_number(json, "view", 0), sequence = json_number(json, "sequence", -1);
    if (type && strcmp(type, "frame.shown") == 0 && view >= 1 && view <= ROOM_WATCH && sequence >= 0 &&
        sequence <= page->sent[(int)view] && sequence > page->shown[(int)view])
        page->shown[(int)view] = (uint32_t)sequence;
    cJSON_Delete(json);
}

static void play_line(struct room *room, const char *line, size_t n, int64_t *now_us)
{
    switch (line[0]) {
    case '{': /* a message of the first page; with a blank in front, of the second */
    case ' ': {
        struct page *page = &pages[line[0] == ' '];
        if (page->is_closed)
            break;
        follow_acknowledgement(page, line, n);
        room_text_came(room, page, line, n, *now_us);
        break;
    }
    case 'd': answer(room, false, *now_us); break;
    case 'f': answer(room, true, *now_us); break;
    case 't': *now_us += n > 1 ? (int64_t)(unsigned char)line[1] * 1000 : 20000; break;
    case 'T': /* longer than a presenter without a connection presents */
        *now_us += (ROOM_PRESENTER_KEPT_S + 1) * INT64_C(1000000);
        (void)room_settle(room, *now_us);
        break;
    case 'r': room_renderer_state(room, WIRE_RENDERER_STATE_RESTARTING, "again", 10, NULL, *now_us); break;
    case 'p': kept_plan_ready(room, *now_us); break;
    case 'x': {
        struct page *page = &pages[n > 1 && line[1] == '1'];
        room_connection_closed(room, page, *now_us);
        *page = (struct page){ 0 };
        break;
    }
    default: break;
    }
}

static void check_presenter(const struct room *room)
{
    cJSON *members = room_members(room);
    const cJSON *member;
    int n_presenting = 0;
    bool has_connected_presenter = false;
    cJSON_ArrayForEach(member, members)
    {
        bool presents = json_flag(member, "presenting", false);
        n_presenting += presents;
        has_connected_presenter |= presents && json_flag(member, "connected", false);
        REQUIRE(!presents || !json_flag(member, "following", false));
    }
    REQUIRE(n_presenting <= 1);
    REQUIRE(cJSON_GetArraySize(members) != 1 || room_n_connected(room) != 1 || has_connected_presenter);
    cJSON_Delete(members);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    const struct room_callbacks callbacks = { .render = render,
                                              .forget = forget,
                                              .scene_changed = scene_changed,
                                              .send_text = send_text,
                                              .send_latest = send_latest,
                                              .send_frame = send_frame,
                                              .close = close_connection };
    struct room *room = room_create("7q4k-m2wz", "head", &callbacks, NULL);
    int64_t now_us = 1000000;
    log_start("fuzz", LOG_ERROR); /* failing pictures are normal here */
    memset(pages, 0, sizeof pages);
    n_requests = n_answered = 0;
    kept_plan_ready(room, now_us);
    for (size_t at = 0, end; at < n; at = end + 1) {
        for (end = at; end < n && data[end] != '\n'; end++) {
        }
        if (end > at)
            play_line(room, (const char *)data + at, end - at, &now_us);
        int64_t again_us = room_settle(room, now_us);
        REQUIRE(again_us > now_us);
        check_presenter(room);
    }
    room_destroy(room);
    return 0;
}

/* The callbacks of a fake room: they record what the room requests and sends. */
#include "tests/unit/room_fake.h"

#include <math.h>

#include "core/base/mem.h"
#include "server/room/state/room_state.h"

static void render(void *context, struct room *room, const struct room_render *request)
{
    struct fake_room *fake = context;
    (void)room;
    assert_true(fake->n_requests < sizeof fake->requests / sizeof fake->requests[0]);
    fake->requests[fake->n_requests++] =
        (struct fake_request){ .request = request->request,
                               .view = cJSON_Duplicate(request->view, true),
                               .scene = request->scene ? cJSON_Duplicate(request->scene, true) : NULL,
                               .scene_revision = request->scene_revision,
                               .scale_percent = request->scale_percent,
                               .quality = request->quality,
                               .is_still = request->is_still,
                               .full_color = request->full_color,
                               .coarse = request->coarse,
                               .is_acted = request->is_acted,
                               .is_reduced = { request->is_reduced[0], request->is_reduced[1] },
                               .is_marked = request->is_marked,
                               .is_of_wall = request->is_of_wall };
}

static void forget(void *context, struct room *room, uint64_t request)
{
    struct fake_room *fake = context;
    (void)room;
    for (size_t i = 0; i < fake->n_requests; i++)
        if (fake->requests[i].request == request) {
            assert_false(fake->requests[i].is_answered);
            fake->requests[i].is_forgotten = true; /* the answer may be on its way all the same */
        }
}

static void scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision)
{
    struct fake_room *fake = context;
    (void)room;
    assert_non_null(scene);
    fake->n_scenes++;
    fake->told_revision = revision;
}

static void send_text(void *context, void *connection, const char *text)
{
    struct fake_page *page = connection;
    (void)context;
    assert_false(page->is_closed);
    assert_true(page->n_texts < sizeof page->texts / sizeof page->texts[0]);
    page->texts[page->n_texts++] = mem_copy_text(text);
}

static void send_latest(void *context, void *connection, uint32_t key, const char *text)
{
    struct fake_page *page = connection;
    for (size_t i = page->n_texts; i-- > page->n_read;)
        if (page->keys[i] == key + 1) {
            free(page->texts[i]);
            page->texts[i] = mem_copy_text(text);
            return;
        }
    page->keys[page->n_texts] = key + 1;
    send_text(context, connection, text);
    if (!page->is_slow)
        page->n_read = page->n_texts;
}

static void send_frame(void *context, void *connection, const struct frame_header *header, struct frame *picture)
{
    struct fake_page *page = connection;
    (void)context;
    assert_false(page->is_closed);
    assert_true(page->n_frames < sizeof page->frames / sizeof page->frames[0]);
    page->frames[page->n_frames++] = *header;
    page->n_bytes_last = picture->n_bytes;
    page->first_byte_last = picture->bytes[0];
    page->last_bytes = picture->bytes;
}

static void close_page(void *context, void *connection)
{
    (void)context;
    ((struct fake_page *)connection)->is_closed = true;
}

static void close_signed_out(void *context, void *connection)
{
    close_page(context, connection);
    ((struct fake_page *)connection)->is_signed_out = true;
}

static const struct identity *identity(void *context, void *connection)
{
    static const struct identity machine = { .source = IDENTITY_MACHINE };
    const struct fake_page *page = connection;
    (void)context;
    return page->identity ? page->identity : &machine;
}

static bool role_of(void *context, const struct room *room, const struct identity *who, enum wire_member_role *role)
{
    const struct fake_room *fake = context;
    (void)room;
    return fake->role_of && fake->role_of(who, role);
}

static void item_changed(void *context, struct room *room, const char *row, const char *id)
{
    struct fake_room *fake = context;
    (void)room;
    assert_true(id_is_valid(id));
    (void)snprintf(fake->kept[fake->n_kept++ % 8], sizeof fake->kept[0], "%s", row ? row : "");
}

static void audited(void *context, struct room *room, const struct room_audit *row)
{
    struct fake_room *fake = context;
    (void)snprintf(fake->addresses[fake->n_audited % 16], 46, "%s", row->address);
    char *text = fake->audit[fake->n_audited++ % 16];
    (void)room;
    (void)snprintf(text, sizeof fake->audit[0], "%s %s %s %s %lld %lld", row->action, row->member, row->result,
                   row->detail, (long long)row->before, (long long)row->after);
}

static bool audit_has_place(void *context)
{
    return !((struct fake_room *)context)->audit_is_full;
}

static void is_saved(void *context, const struct room *room, struct room_saved *saved)
{
    const struct fake_room *fake = context;
    (void)room;
    *saved = fake->saved;
}

void fake_room_start(struct fake_room *fake, int max_members)
{
    fake_room_start_with(fake, &(struct room_limits){ .max_members = max_members });
}

void fake_room_start_with(struct fake_room *fake, const struct room_limits *limits)
{
    struct room_callbacks callbacks = { .render = render,
                                        .forget = forget,
                                        .scene_changed = scene_changed,
                                        .send_text = send_text,
                                        .send_latest = send_latest,
                                        .send_frame = send_frame,
                                        .close = close_page,
                                        .item_changed = item_changed,
                                        .context = fake,
                                        .audited = audited,
                                        .audit_has_place = audit_has_place,
                                        .is_saved = is_saved };
    memset(fake, 0, sizeof *fake);
    fake->now_us = 1000000000;
    fake->again_us = INT64_MAX;
    fake->room = room_create("7q4k-m2wz", "head", &callbacks, limits);
}

void fake_sign_in(struct fake_room *fake, bool (*roles)(const struct identity *who, enum wire_member_role *role))
{
    fake->role_of = roles;
    fake->room->callbacks.identity = identity;
    fake->room->callbacks.role_of = role_of;
    fake->room->callbacks.close_signed_out = close_signed_out;
}

void fake_room_end(struct fake_room *fake)
{
    room_destroy(fake->room);
    for (size_t i = 0; i < fake->n_requests; i++) {
        cJSON_Delete(fake->requests[i].view);
        cJSON_Delete(fake->requests[i].scene);
    }
}

void fake_page_end(struct fake_page *page)
{
    for (size_t i = 0; i < page->n_texts; i++)
        free(page->texts[i]);
    memset(page, 0, sizeof *page);
}

static void tick(struct fake_room *fake)
{
    fake->again_us = room_settle(fake->room, fake->now_us);
}

/* A plan document and default scene of a plan with these regions. */
static void ready(struct fake_room *fake, const char *const *region_ids, bool is_software)
{
    struct scene scene = scene_default;
    struct scene_region_style_entry entries[4] = { { .id = "" } };
    cJSON *plan = cJSON_CreateObject();
    cJSON_AddStringToObject(plan, "id", "head");
    cJSON *images = cJSON_AddArrayToObject(plan, "images"), *regions = cJSON_AddArrayToObject(plan, "regions");
    cJSON *image = cJSON_CreateObject();
    cJSON_AddStringToObject(image, "id", "ct");
    cJSON_AddItemToArray(images, image);
    for (; *region_ids; region_ids++) {
        struct scene_region_style_entry *entry = &entries[scene.n_regions++];
        entry->value = scene_region_style_default;
        entry->value.opacity = scene.n_regions == 1 ? 0.4 : 1;
        (void)snprintf(entry->id, sizeof entry->id, "%s", *region_ids);
        cJSON *region = cJSON_CreateObject();
        cJSON_AddStringToObject(region, "id", *region_ids);
        cJSON_AddItemToArray(regions, region);
    }
    scene.regions = entries;
    cJSON *complete = scene_write(&scene);
    (void)room_plan_ready(fake->room, plan, complete, "osmesa llvmpipe", is_software, fake->now_us);
    cJSON_Delete(complete);
    cJSON_Delete(plan);
    tick(fake);
}

void fake_plan_ready(struct fake_room *fake, bool is_software)
{
    ready(fake, (const char *const[]){ "scalp", "brain", NULL }, is_software);
}

void fake_other_plan_ready(struct fake_room *fake)
{
    ready(fake, (const char *const[]){ "brain", NULL }, true);
}

void fake_say(struct fake_room *fake, struct fake_page *page, const char *format, ...)
{
    char text[WIRE_MAX_CLIENT_BYTES];
    va_list args;
    va_start(args, format);
    int n = vsnprintf(text, sizeof text, format, args);
    va_end(args);
    assert_true(n > 0 && (size_t)n < sizeof text);
    room_text_came(fake->room, page, text, (size_t)n, fake->now_us);
    tick(fake);
}

void fake_hello(struct fake_room *fake, struct fake_page *page)
{
    fake_say(fake, page, "{\"type\":\"hello\",\"protocol\":2}");
}

void fake_join(struct fake_room *fake, struct fake_page *page, bool follow)
{
    fake_hello(fake, page);
    fake_say(fake, page, "{\"type\":\"view.open\",\"view\":1,\"document\":{\"size_px\":[800,600]},\"follow\":%s}",
             follow ? "true" : "false");
}

void fake_shown(struct fake_room *fake, struct fake_page *page)
{
    for (size_t i = page->n_frames; i-- > 0;)
        if (page->frames[i].view == 1) {
            fake_say(fake, page, "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":%u}", page->frames[i].sequence);
            return;
        }
    fail_msg("no frame to show");
}

void fake_pass(struct fake_room *fake, int64_t ms)
{
    int64_t end_us = fake->now_us + ms * 1000;
    while (fake->again_us <= end_us) {
        fake->now_us = fake->again_us > fake->now_us ? fake->again_us : fake->now_us;
        tick(fake);
        assert_true(fake->again_us > fake->now_us); /* else it would be called in a circle */
    }
    fake->now_us = end_us;
}

static bool is_outstanding(const struct fake_request *request)
{
    return !request->is_answered && !request->is_forgotten;
}

size_t fake_outstanding(const struct fake_room *fake)
{
    size_t n = 0;
    for (size_t i = 0; i < fake->n_requests; i++)
        n += is_outstanding(&fake->requests[i]);
    return n;
}

struct fake_request *fake_oldest(struct fake_room *fake)
{
    for (size_t i = 0; i < fake->n_requests; i++)
        if (is_outstanding(&fake->requests[i]))
            return &fake->requests[i];
    return NULL;
}

struct fake_request *fake_newest(struct fake_room *fake)
{
    for (size_t i = fake->n_requests; i-- > 0;)
        if (is_outstanding(&fake->requests[i]))
            return &fake->requests[i];
    return NULL;
}

static int side_px(const struct fake_request *request, int i)
{
    const cJSON *size = cJSON_GetObjectItem(request->view, "size_px");
    return (int)lround(cJSON_GetArrayItem(size, i)->valuedouble * request->scale_percent / 100);
}

/* Adds reduced pictures as the renderer does; of 100 / 2 or 100 / 4 bytes. */
static void add_reduced(struct frame *picture, const struct fake_request *request)
{
    for (int i = 0; i < IMAGE_N_REDUCED; i++) {
        if (!request->is_reduced[i])
            continue;
        struct frame *reduced = mem_new(sizeof *reduced);
        reduced->references = 1;
        reduced->n_bytes = 100 / (size_t)image_divisor(i);
        reduced->bytes = mem_new(reduced->n_bytes);
        reduced->bytes[0] = (uint8_t)request->request;
        reduced->header = frame_header_reduced(&picture->header, image_divisor(i));
        reduced->header.payload_bytes = (uint32_t)reduced->n_bytes;
        picture->reduced[i] = reduced;
    }
}

void fake_draw_slow(struct fake_room *fake, struct fake_request *request, uint32_t render_us)
{
    assert_non_null(request);
    assert_false(request->is_answered);
    request->is_answered = true;
    struct frame *picture = mem_new(sizeof *picture);
    picture->references = 1;
    picture->n_bytes = 100;
    picture->bytes = mem_new(100);
    picture->bytes[0] = (uint8_t)request->request;
    picture->missing = fake->missing ? json_read(fake->missing, strlen(fake->missing), NULL) : NULL;
    picture->header = (struct frame_header){ .codec = 1,
                                             .flags = (uint8_t)((request->is_still ? FRAME_STILL : 0) |
                                                                (request->coarse ? FRAME_COARSE : 0)),
                                             .quality = (uint8_t)request->quality,
                                             .scale_percent = (uint8_t)request->scale_percent,
                                             .scene_revision = request->scene_revision,
                                             .width_px = (uint16_t)side_px(request, 0),
                                             .height_px = (uint16_t)side_px(request, 1),
                                             .render_us = render_us,
                                             .encode_us = 2000,
                                             .payload_bytes = 100 };
    add_reduced(picture, request);
    if (request->is_marked && fake->is_draft) {
        picture->marked = mem_new(sizeof *picture->marked);
        picture->marked->references = 1;
        picture->marked->n_bytes = 120;
        picture->marked->bytes = mem_new(120);
        picture->marked->header = picture->header;
    }
    room_picture_came(fake->room, request->request, picture, fake->now_us);
    tick(fake);
}

void fake_draw(struct fake_room *fake, struct fake_request *request)
{
    fake_draw_slow(fake, request, 10000);
}

void fake_fail(struct fake_room *fake, struct fake_request *request)
{
    struct problem problem = { 0 };
    problem_set(&problem, PROBLEM_RENDERER, "", "", "made up");
    request->is_answered = true;
    room_picture_failed(fake->room, request->request, &problem, fake->now_us);
    tick(fake);
}

void fake_refuse(struct fake_room *fake, struct fake_request *request)
{
    struct problem problem = { 0 };
    problem_set(&problem, PROBLEM_VALIDATION, "", "range", "made up: there is no such picture");
    request->is_answered = true;
    room_picture_failed(fake->room, request->request, &problem, fake->now_us);
    tick(fake);
}

void fake_settle(struct fake_room *fake, struct fake_page *const *pages, size_t n_pages)
{
    for (int turn = 0; turn < 20; turn++) {
        for (struct fake_request *request; (request = fake_oldest(fake));) {
            size_t before = fake->n_requests;
            fake_draw(fake, request);
            for (size_t i = 0; i < n_pages; i++)
                if (pages[i]->n_frames)
                    fake_shown(fake, pages[i]);
            assert_true(fake->n_requests < before + 20);
        }
        fake_pass(fake, 200);
    }
    assert_int_equal(fake_outstanding(fake), 0);
}

cJSON *fake_heard(const struct fake_page *page, const char *type)
{
    for (size_t i = page->n_texts; i-- > 0;) {
        cJSON *json = json_read(page->texts[i], strlen(page->texts[i]), NULL);
        assert_non_null(json);
        if (strcmp(json_text(json, "type"), type) == 0)
            return json;
        cJSON_Delete(json);
    }
    return NULL;
}

size_t fake_n_heard(const struct fake_page *page, const char *type)
{
    size_t n = 0;
    for (size_t i = 0; i < page->n_texts; i++) {
        cJSON *json = json_read(page->texts[i], strlen(page->texts[i]), NULL);
        n += strcmp(json_text(json, "type"), type) == 0;
        cJSON_Delete(json);
    }
    return n;
}

void fake_turn(struct fake_room *room, struct fake_page *page, int degrees, unsigned input)
{
    fake_say(
        room, page,
        "{\"type\":\"view.patch\",\"view\":1,\"input\":%u,\"patch\":{\"camera\":{\"position_mm\":[%d,-900,0],\"target_mm\":[0,0,0],"
        "\"up\":[0,0,1]}}}",
        input, degrees);
}

double fake_camera_x(const struct fake_request *request)
{
    const cJSON *camera = cJSON_GetObjectItem(request->view, "camera");
    return cJSON_GetArrayItem(cJSON_GetObjectItem(camera, "position_mm"), 0)->valuedouble;
}

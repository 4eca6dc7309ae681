#include "tests/fuzz/kept_plan.h"

#include "tests/fuzz/fuzz.h"

void kept_plan_ready(struct room *room, int64_t now_us)
{
    static const char text[] = "{\"regions\":{\"scalp\":{\"visible\":true},\"brain\":{\"opacity\":0.5}}}";
    static const char document[] =
        "{\"id\":\"head\",\"images\":[{\"id\":\"ct\"}],\"regions\":[{\"id\":\"scalp\"},{\"id\":\"brain\"}]}";
    struct scene scene;
    cJSON *said = json_read(text, strlen(text), NULL), *plan = json_read(document, strlen(document), NULL);
    REQUIRE(scene_read(said, &scene, NULL));
    cJSON *defaults = scene_write(&scene);
    (void)room_plan_ready(room, plan, defaults, "fuzz", true, now_us);
    scene_finish(&scene);
    cJSON_Delete(said);
    cJSON_Delete(plan);
    cJSON_Delete(defaults);
}

static void render(void *context, struct room *room, const struct room_render *request)
{
    (void)context;
    (void)room;
    REQUIRE(request->view != NULL);
}

static void forget(void *context, struct room *room, uint64_t request)
{
    (void)context;
    (void)room;
    (void)request;
}

static void scene_changed(void *context, struct room *room, const cJSON *scene, uint32_t revision)
{
    struct scene read;
    (void)context;
    (void)room;
    (void)revision;
    REQUIRE(scene_read(scene, &read, NULL)); /* what a renderer is given */
    scene_finish(&read);
}

static void send_text(void *context, void *connection, const char *text)
{
    (void)context;
    (void)connection;
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
    (void)context;
    (void)connection;
    (void)header;
    (void)picture;
    REQUIRE(false); /* no picture is drawn */
}

static void close_connection(void *context, void *connection)
{
    (void)context;
    (void)connection;
}

const struct room_callbacks kept_plan_callbacks = { .render = render,
                                                    .forget = forget,
                                                    .scene_changed = scene_changed,
                                                    .send_text = send_text,
                                                    .send_latest = send_latest,
                                                    .send_frame = send_frame,
                                                    .close = close_connection };

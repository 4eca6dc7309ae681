/* The fleet with the real beamroom-render on a small demo plan: --stub, so that sanitizers can watch, and GL where
 * there is one. */
#include <errno.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/phantom/phantom.h"
#include "server/wire/document.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/fleet_world.h"

#define PLAN "head"

#if defined(__has_feature)
#if __has_feature(thread_sanitizer) || __has_feature(address_sanitizer)
#define IS_SANITIZED 1
#endif
#endif
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
#define IS_SANITIZED 1
#endif

static char renderer_path[512];

/* False: this variant's beamroom-render is not built. */
static bool has_renderer(void)
{
    const char *folder = getenv("BEAMROOM_BIN");
    char self[512];
    ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
    assert_true(n > 0);
    self[n] = 0;
    *strrchr(self, '/') = 0;
    snprintf(renderer_path, sizeof renderer_path, "%.400s/../beamroom-render", self);
    if (access(renderer_path, X_OK) != 0 && folder)
        snprintf(renderer_path, sizeof renderer_path, "%.400s/beamroom-render", folder);
    return access(renderer_path, X_OK) == 0;
}

static void begin_head(struct world *world, bool is_stub, const uint32_t size[3])
{
    if (!has_renderer())
        skip();
    world_begin(world);
    char path[512];
    struct error err = { 0 };
    struct phantom_options options = { { size[0], size[1], size[2] }, 1 };
    snprintf(path, sizeof path, "%s/%s", world->plans, PLAN);
    assert_true(phantom_write(path, &options, false, &err));
    world->options.renderer_path = renderer_path;
    world->options.stub_renderer = is_stub;
    world->options.times.scan = 20000; /* sanitizers start slowly */
}

static const uint32_t small[3] = { 64, 64, 32 };

static cJSON *parse(const char *text)
{
    cJSON *json = cJSON_Parse(text);
    assert_non_null(json);
    return json;
}

static void ask(struct world *world, const char *packet, struct reply *reply)
{
    reply_finish(reply);
    world_ask_packet(world, PLAN, parse(packet), reply);
    world_wait_for_reply(world, reply);
}

/* Width and height from a baseline JPEG's frame header (ITU T.81, B.2.2); false when the markers do not follow each
 * other to the end. */
static bool jpeg_size(const uint8_t *bytes, size_t n, int *width, int *height)
{
    *width = *height = 0;
    if (n < 4 || bytes[0] != 0xff || bytes[1] != 0xd8 || bytes[n - 2] != 0xff || bytes[n - 1] != 0xd9)
        return false;
    for (size_t at = 2; at + 9 < n && bytes[at] == 0xff && bytes[at + 1] != 0xda;
         at += 2 + ((size_t)bytes[at + 2] << 8 | bytes[at + 3]))
        if (bytes[at + 1] == 0xc0) {
            *height = bytes[at + 5] << 8 | bytes[at + 6];
            *width = bytes[at + 7] << 8 | bytes[at + 8];
        }
    return *width > 0;
}

static void assert_frame(const struct reply *reply, int width, int height)
{
    int w, h;
    assert_string_equal(reply->problem.detail, "");
    assert_true(jpeg_size(reply->blob, reply->n_blob, &w, &h));
    assert_int_equal(w, width);
    assert_int_equal(h, height);
    assert_int_equal(json_number(reply->json, "width_px", 0), width);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(reply->json, "clip_from_lps_mm")), 16);
}

static void a_plan_is_read_and_drawn_and_drawn_again_after_a_kill(void **state)
{
    (void)state;
    struct world world;
    struct reply reply = { 0 };
    begin_head(&world, true, small);
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    world_wait_for_state(&world, PLAN, FLEET_READY);
    struct fleet_plan plan = world_plan_of(&world, PLAN);
    assert_string_equal(json_text(plan.document, "id"), PLAN);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(plan.document, "regions")), 5);
    assert_non_null(cJSON_GetObjectItem(cJSON_GetObjectItem(plan.document, "home"), "coronal"));
    assert_string_equal(json_text(cJSON_GetArrayItem(cJSON_GetObjectItem(plan.document, "images"), 0), "id"), "ct");
    assert_non_null(strstr(plan.confined, "seccomp"));
    assert_string_equal(json_text(fleet_gl(world.fleet, NULL), "back_end"), "stub");
    assert_true(plan.is_phantom);

    ask(&world, "{\"type\":\"render\",\"view\":{\"size_px\":[320,200]}}", &reply);
    assert_frame(&reply, 320, 200);
    ask(&world, "{\"type\":\"render\",\"scale_percent\":50,\"detail\":\"coarse\",\"view\":{\"size_px\":[320,200]}}",
        &reply);
    assert_frame(&reply, 160, 100);

    cJSON *scene = cJSON_CreateObject();
    cJSON_AddStringToObject(scene, "type", "scene");
    cJSON_AddStringToObject(scene, "room", "r1");
    cJSON_AddNumberToObject(scene, "revision", 41);
    cJSON_AddItemToObject(scene, "scene", cJSON_Duplicate(plan.default_scene, true));
    assert_true(world_tell(&world, PLAN, cJSON_Duplicate(scene, true)));
    ask(&world, "{\"type\":\"render\",\"room\":\"r1\",\"view\":{\"size_px\":[64,64]}}", &reply);
    assert_frame(&reply, 64, 64);
    assert_int_equal(json_number(reply.json, "scene_revision", 0), 41);

    kill(plan.pid, SIGKILL);
    world_wait_for_state(&world, PLAN, FLEET_RESTARTING);
    reply_finish(&reply);
    world_ask_packet(&world, PLAN, parse("{\"type\":\"render\",\"view\":{\"size_px\":[320,200]}}"), &reply);
    world_wait_for_reply(&world, &reply);
    assert_frame(&reply, 320, 200);
    assert_int_equal(world_plan_of(&world, PLAN).generation, 2);
    /* the new one has forgotten the room */
    ask(&world, "{\"type\":\"render\",\"room\":\"r1\",\"view\":{}}", &reply);
    assert_int_equal(reply.problem.type, PROBLEM_NOT_FOUND);
    assert_true(world_tell(&world, PLAN, scene));
    ask(&world, "{\"type\":\"render\",\"room\":\"r1\",\"view\":{\"size_px\":[64,64]}}", &reply);
    assert_frame(&reply, 64, 64);
    reply_finish(&reply);
    world_end(&world);
}

static const cJSON *body(const struct reply *reply)
{
    assert_string_equal(reply->problem.detail, "");
    const cJSON *json = cJSON_GetObjectItem(reply->json, "body");
    assert_non_null(json);
    return json;
}

static void numbers_are_answered(void **state)
{
    (void)state;
    struct world world;
    struct reply reply = { 0 };
    begin_head(&world, true, small);
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    /* modified Snyder head: the middle of the brain, (0, 0, 10) mm in the paper's frame, is inside brain, cranium and
     * scalp */
    ask(&world, "{\"type\":\"probe\",\"point_lps_mm\":[30,0,-10]}", &reply);
    const cJSON *json = body(&reply);
    assert_true(cJSON_GetArraySize(cJSON_GetObjectItem(json, "regions")) >= 1);
    assert_string_equal(cJSON_GetArrayItem(cJSON_GetObjectItem(json, "regions"), 0)->valuestring, "brain");
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "images")), 1);
    assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItem(json, "doses")), 4);

    ask(&world, "{\"type\":\"surface\",\"region\":\"brain\",\"algorithm\":\"marching-cubes\"}", &reply);
    json = body(&reply);
    double univels = json_number(json, "n_univels", 0), volume = json_number(json, "univel_volume_mm3", 0);
    assert_close(volume, univels * 4 * 4 * 6.4, 0.5); /* 256 x 256 x 204.8 mm in 64 x 64 x 32 voxels */
    /* the mesh cuts half a voxel off every edge of the staircase */
    assert_near(json_number(json, "volume_mm3", 0), volume, 0.03);
    double n_cubes = json_number(json, "triangles", 0);
    assert_true(n_cubes > 1000);
    assert_string_equal(json_text(json, "algorithm"), "marching-cubes");

    ask(&world, "{\"type\":\"surface\",\"region\":\"brain\",\"algorithm\":\"eight-cell\"}", &reply);
    json = body(&reply);
    assert_string_equal(json_text(json, "algorithm"), "eight-cell");
    /* a mesh has twice as many triangles as vertices: those of marching cubes are |n.x| + |n.y| + |n.z| a univel's
     * face, mean 1.5 over all directions, those here at least the largest of the three, mean 0.83: not below 0.55, and
     * stairs bring it towards 1 */
    assert_true(json_number(json, "triangles", 0) < n_cubes * 0.85);
    assert_true(json_number(json, "triangles", 0) > n_cubes * 0.5);
    assert_close(json_number(json, "n_univels", 0), univels, 0);

    ask(&world, "{\"type\":\"surface\",\"region\":\"brain\",\"format\":\"stl\"}", &reply);
    assert_close(json_number(body(&reply), "triangles", 0), n_cubes, 0);
    assert_close((double)reply.n_blob, 84 + 50 * n_cubes, 0);

    ask(&world, "{\"type\":\"pick\",\"view\":{\"size_px\":[200,200]},\"px\":100.5,\"py\":100.5}", &reply);
    const cJSON *hits = cJSON_GetObjectItem(body(&reply), "hits");
    assert_true(cJSON_GetArraySize(hits) >= 1);
    assert_string_equal(json_text(cJSON_GetArrayItem(hits, 0), "region"),
                        "scalp"); /* from the front the skin comes first */
    ask(&world, "{\"type\":\"await_ready\"}", &reply);
    assert_int_equal(cJSON_GetArraySize(body(&reply)), 0);
    reply_finish(&reply);
    world_end(&world);
}

static void what_is_asked_wrongly_is_refused_with_its_place(void **state)
{
    (void)state;
    static const struct {
        const char *packet;
        enum problem_type type;
        const char *pointer;
    } wrong[] = {
        { "{\"type\":\"render\",\"view\":{\"size_px\":[1,1]}}", PROBLEM_VALIDATION, "/view/size_px/0" },
        { "{\"type\":\"render\",\"view\":{\"kind\":\"4d\"}}", PROBLEM_VALIDATION, "/view/kind" },
        { "{\"type\":\"render\",\"scene\":{\"regions\":{\"liver\":{}}}}", PROBLEM_VALIDATION, "/scene/regions/liver" },
        { "{\"type\":\"render\",\"scene\":{\"image\":{\"id\":\"pet\"}}}", PROBLEM_VALIDATION, "/scene/image/id" },
        { "{\"type\":\"render\",\"view\":{\"camera\":{\"position_mm\":[1,1,1],\"target_mm\":[1,1,1],\"up\":[0,0,1]}}}",
          PROBLEM_VALIDATION, "/view/camera/position_mm" },
        { "{\"type\":\"render\",\"room\":\"nowhere\"}", PROBLEM_NOT_FOUND, "/room" },
        { "{\"type\":\"surface\",\"region\":\"liver\"}", PROBLEM_NOT_FOUND, "/region" },
        { "{\"type\":\"surface\",\"region\":\"brain\",\"algorithm\":\"magic\"}", PROBLEM_VALIDATION, "/algorithm" },
        { "{\"type\":\"surface\",\"region\":\"brain\",\"format\":\"obj\"}", PROBLEM_VALIDATION, "/format" },
    };
    struct world world;
    struct reply reply = { 0 };
    begin_head(&world, true, small);
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        ask(&world, wrong[i].packet, &reply);
        if (reply.problem.type != wrong[i].type || strcmp(reply.problem.pointer, wrong[i].pointer) != 0)
            fail_msg("%s: %s at %s, expected %s", wrong[i].packet, reply.problem.detail, reply.problem.pointer,
                     wrong[i].pointer);
    }
    assert_int_equal(world_plan_of(&world, PLAN).generation, 1);
    reply_finish(&reply);
    world_end(&world);
}

static void tell_scene(struct world *world, int room)
{
    char text[160];
    (void)
        snprintf(text, sizeof text,
                 "{\"type\":\"scene\",\"room\":\"r%d\",\"revision\":%d,\"scene\":{\"surface\":{\"normals\":\"face\"}}}",
                 room, room);
    WORLD_UNTIL(world, world_tell(world, PLAN, parse(text))); /* waits while too much is on the way */
}

static void draw_room(struct world *world, int room, struct reply *reply)
{
    char text[120];
    (void)snprintf(text, sizeof text, "{\"type\":\"render\",\"room\":\"r%d\",\"view\":{\"size_px\":[64,48]}}", room);
    ask(world, text, reply);
}

static void a_scene_is_kept_for_as_many_rooms_as_a_daemon_may_have_and_no_more(void **state)
{
    (void)state;
    struct world world;
    struct reply reply = { 0 };
    begin_head(&world, true, small);
    world.options.times.silent = 60000; /* under the thread sanitizer it reads so many scenes for seconds */
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    for (int room = 1; room <= SCENE_MAX_ROOMS + 1; room++)
        tell_scene(&world, room);
    draw_room(&world, SCENE_MAX_ROOMS, &reply);
    assert_frame(&reply, 64, 48);
    assert_int_equal(json_number(reply.json, "scene_revision", 0), SCENE_MAX_ROOMS);
    draw_room(&world, SCENE_MAX_ROOMS + 1, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_NOT_FOUND);
    /* a room that is gone makes place for another */
    assert_true(world_tell(&world, PLAN, parse("{\"type\":\"forget\",\"room\":\"r1\"}")));
    tell_scene(&world, SCENE_MAX_ROOMS + 1);
    draw_room(&world, SCENE_MAX_ROOMS + 1, &reply);
    assert_frame(&reply, 64, 48);
    draw_room(&world, 1, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_NOT_FOUND);
    assert_int_equal(world_plan_of(&world, PLAN).generation, 1);
    reply_finish(&reply);
    world_end(&world);
}

/* One more picture of the film. True if it is added, else the renderer must not know a film with as many pictures. */
static bool adds_to_film(struct world *world, int film, int at, struct reply *reply)
{
    char packet[160];
    snprintf(packet, sizeof packet,
             "{\"type\":\"render\",\"annotations\":true,\"film\":%d,\"film_at\":%d,\"view\":{\"size_px\":[64,64]}}",
             film, at);
    ask(world, packet, reply);
    if (reply->problem.type == PROBLEM_NONE)
        return true;
    assert_int_equal(reply->problem.type, PROBLEM_NOT_FOUND);
    return false;
}

static void films_that_nobody_goes_on_with_do_not_use_up_the_places(void **state)
{
    (void)state;
    enum { N_PLACES = 4 /* "film" of "render" in proto/packets.json */ };
    struct world world;
    struct reply reply = { 0 };
    begin_head(&world, true, small);
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    world_wait_for_state(&world, PLAN, FLEET_READY);
    for (int film = 1; film <= N_PLACES; film++)
        assert_true(adds_to_film(&world, film, 0, &reply));
    assert_true(world_tell(&world, PLAN, parse("{\"type\":\"drop\",\"id\":0,\"film\":2}")));
    assert_true(adds_to_film(&world, 5, 0, &reply)); /* in the place of the dropped one */
    assert_true(adds_to_film(&world, 1, 1, &reply));
    assert_false(adds_to_film(&world, 2, 1, &reply));
    assert_true(adds_to_film(&world, 6, 0, &reply)); /* in that of 3, which waits longest */
    assert_false(adds_to_film(&world, 3, 1, &reply));
    assert_true(adds_to_film(&world, 4, 1, &reply));
    assert_true(adds_to_film(&world, 1, 2, &reply));
    for (int film = 7; film < 7 + 2 * N_PLACES; film++)
        assert_true(adds_to_film(&world, film, 0, &reply));
    reply_finish(&reply);
    world_end(&world);
}

static void a_plan_that_cannot_be_read_fails_with_the_loaders_sentence(void **state)
{
    (void)state;
    struct world world;
    begin_head(&world, true, small);
    folder_put_text(world.plans, "lone/labels.nii.gz", "no image at all"); /* beside other parts it would be left out */
    world_start(&world, 2);
    struct fleet_plan plan = world_plan_of(&world, "lone");
    if (plan.state == FLEET_CLOSED) { /* seen only when it is read */
        world_open_plan(&world, "lone");
        world_wait_for_state(&world, "lone", FLEET_FAILED);
        plan = world_plan_of(&world, "lone");
    }
    assert_int_equal(plan.problem->type, PROBLEM_PLAN_UNREADABLE);
    assert_non_null(strstr(plan.problem->detail, "labels.nii.gz"));
    world_end(&world);
}

/* A name in another encoding, long enough to be cut in every sentence: still a plan that says what is wrong, not a
 * renderer that lies. */
static void a_file_name_that_is_no_utf8_comes_out_readable(void **state)
{
    (void)state;
    struct world world;
    char text[400], name[3 * 90 + 1] = "";
    begin_head(&world, true, small);
    for (size_t i = 0; i < 90; i++)
        memcpy(name + 3 * i, "\xe2\x82\xac", 4); /* the euro sign, three bytes */
    snprintf(text, sizeof text, "{\"format\":\"beamroom-plan\",\"version\":1,\"regions\":[{\"path\":\"%s.nii\"}]}",
             name);
    folder_put_text(world.plans, PLAN "/plan.json", text);
    folder_put_text(world.plans, "latin1/K\xf6pf.nii", "no image");
    world_start(&world, 2);
    static const char *const ids[] = { PLAN, "latin1" };
    for (int i = 0; i < 2; i++) {
        struct fleet_plan plan = world_plan_of(&world, ids[i]);
        if (plan.state == FLEET_CLOSED) {
            world_open_plan(&world, ids[i]);
            world_wait_for_state(&world, ids[i], FLEET_FAILED);
            plan = world_plan_of(&world, ids[i]);
        }
        assert_int_equal(plan.problem->type, PROBLEM_PLAN_UNREADABLE);
        assert_non_null(strstr(plan.problem->detail, i == 0 ? "\xe2\x82\xac" : "K?pf.nii"));
        assert_null(strstr(plan.problem->detail, "no packet"));
    }
    world_end(&world);
}

static void a_plan_larger_than_the_memory_limit_fails_and_says_so(void **state)
{
    (void)state;
#ifdef IS_SANITIZED
    skip(); /* sanitizers map more than any limit */
#endif
    struct world world;
    /* The image alone is 384 x 384 x 160 x 2 bytes, 45 MiB; with labels and doses the estimate is over the limit. */
    const uint32_t large[3] = { 384, 384, 160 };
    begin_head(&world, true, large);
    world.options.max_renderer_bytes = 80 << 20;
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    world_wait_for_state(&world, PLAN, FLEET_FAILED);
    printf("%s\n", world_plan_of(&world, PLAN).problem->detail);
    assert_non_null(strstr(world_plan_of(&world, PLAN).problem->detail,
                           "of memory, and 80 MiB are allowed; the largest part is ct.nii.gz"));
    world_end(&world);
}

static void the_running_renderer_is_filtered(void **state)
{
    (void)state;
    struct world world;
    begin_head(&world, true, small);
    world_start(&world, 1);
    world_open_plan(&world, PLAN);
    world_wait_for_state(&world, PLAN, FLEET_READY);
    char path[64], line[256];
    bool has_filter = false, has_no_privileges = false;
    snprintf(path, sizeof path, "/proc/%d/status", world_plan_of(&world, PLAN).pid);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fgets(line, sizeof line, file)) {
        has_filter |= strcmp(line, "Seccomp:\t2\n") == 0;
        has_no_privileges |= strcmp(line, "NoNewPrivs:\t1\n") == 0;
    }
    fclose(file);
    assert_true(has_no_privileges);
    assert_true(has_filter);
    world_end(&world);
}

static void with_gl_a_frame_of_the_demo_plan_comes_and_comes_again(void **state)
{
    (void)state;
#ifdef IS_SANITIZED
    skip(); /* the graphics driver is not built for sanitizers */
#endif
    struct world world;
    struct reply reply = { 0 };
    begin_head(&world, false, phantom_defaults.size);
    world_start(&world, 1);
    const struct problem *problem = NULL;
    WORLD_UNTIL(&world, fleet_gl(world.fleet, &problem) || problem);
    if (!fleet_gl(world.fleet, NULL)) {
        world_end(&world);
        skip(); /* nothing here can draw */
    }
    int64_t began_us = clock_now_us();
    world_open_plan(&world, PLAN);
    world_wait_for_state(&world, PLAN, FLEET_READY);
    int64_t ready_us = clock_now_us();
    ask(&world, "{\"type\":\"render\",\"detail\":\"coarse\",\"view\":{\"size_px\":[1024,768]}}", &reply);
    int64_t drawn_us = clock_now_us();
    assert_frame(&reply, 1024, 768);
    assert_true(json_number(reply.json, "n_triangles", 0) > 1000);
    assert_true(reply.n_blob > 8000); /* a flat grey picture takes less */
    printf("process start to ready %.0f ms, first picture %.0f ms later, ", (double)(ready_us - began_us) / 1000,
           (double)(drawn_us - ready_us) / 1000);
    ask(&world, "{\"type\":\"render\",\"still\":true,\"view\":{\"size_px\":[1024,768]}}", &reply);
    printf("a still %.0f ms, ", (double)(clock_now_us() - drawn_us) / 1000);
    for (int64_t until_us = clock_now_us() + 1500000; clock_now_us() < until_us;)
        world_step(&world);
    drawn_us = clock_now_us();
    ask(&world, "{\"type\":\"render\",\"detail\":\"coarse\",\"view\":{\"size_px\":[1024,768]}}", &reply);
    printf("the next %.0f ms, ", (double)(clock_now_us() - drawn_us) / 1000);
    printf("resident %.0f MB; %s\n", (double)world_plan_of(&world, PLAN).memory_bytes / 1e6,
           world_plan_of(&world, PLAN).confined);

    kill(world_plan_of(&world, PLAN).pid, SIGKILL);
    world_wait_for_state(&world, PLAN, FLEET_RESTARTING);
    int64_t killed_us = clock_now_us();
    ask(&world, "{\"type\":\"render\",\"detail\":\"coarse\",\"view\":{\"size_px\":[1024,768]}}", &reply);
    assert_frame(&reply, 1024, 768);
    printf("picture %.0f ms after a kill\n", (double)(clock_now_us() - killed_us) / 1000);
    reply_finish(&reply);
    world_end(&world);
}

/* Real plans, as they lie: whatever is not read must say why, and none may bring the renderer down. */
static void each_real_plan_becomes_ready_or_says_why_not(void **state)
{
    (void)state;
    const char *data = getenv("BEAMROOM_DATA") ? getenv("BEAMROOM_DATA") : "../shared/data";
    struct world world;
    struct reply reply = { 0 };
    if (access(data, R_OK) != 0)
        skip();
    begin_head(&world, true, small);
    world.folders[0] = data;
    world_start(&world, 15);
    char ids[64][64];
    size_t n = 0;
    struct fleet_plan plan;
    for (; n < 64 && fleet_plan_at(world.fleet, n, &plan); n++)
        snprintf(ids[n], sizeof ids[n], "%s", plan.id);
    for (size_t i = 0; i < n; i++) {
        plan = world_plan_of(&world, ids[i]);
        if (plan.state == FLEET_UNREADABLE) {
            assert_non_null(plan.problem);
            assert_true(strlen(plan.problem->detail) > 10);
            continue;
        }
#ifdef IS_SANITIZED
        if (plan.n_bytes > 3000000)
            continue; /* twenty times slower: the smaller ones do */
#endif
        int64_t began_us = clock_now_us();
        world_open_plan(&world, ids[i]);
        world_ask_packet(&world, ids[i], parse("{\"type\":\"render\",\"view\":{\"size_px\":[64,64]}}"), &reply);
        world_wait_for_reply(&world, &reply);
        plan = world_plan_of(&world, ids[i]);
        printf("%-24s %-7s %6.0f ms  %s\n", ids[i], fleet_state_word(plan.state),
               (double)(clock_now_us() - began_us) / 1000, plan.problem ? plan.problem->detail : "");
        if (plan.state == FLEET_READY)
            assert_frame(&reply, 64, 64);
        else
            assert_int_equal(plan.problem->type, PROBLEM_PLAN_UNREADABLE);
        reply_finish(&reply);
        fleet_close(world.fleet, ids[i]);
    }
    world_end(&world);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_is_read_and_drawn_and_drawn_again_after_a_kill),
        cmocka_unit_test(numbers_are_answered),
        cmocka_unit_test(what_is_asked_wrongly_is_refused_with_its_place),
        cmocka_unit_test(a_scene_is_kept_for_as_many_rooms_as_a_daemon_may_have_and_no_more),
        cmocka_unit_test(films_that_nobody_goes_on_with_do_not_use_up_the_places),
        cmocka_unit_test(a_plan_that_cannot_be_read_fails_with_the_loaders_sentence),
        cmocka_unit_test(a_file_name_that_is_no_utf8_comes_out_readable),
        cmocka_unit_test(a_plan_larger_than_the_memory_limit_fails_and_says_so),
        cmocka_unit_test(the_running_renderer_is_filtered),
        cmocka_unit_test(each_real_plan_becomes_ready_or_says_why_not),
        cmocka_unit_test(with_gl_a_frame_of_the_demo_plan_comes_and_comes_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Renderers that break the rules: wrong packets, too much of everything, nothing read. A hostile plan file may have
 * taken them over. */
#include <sys/stat.h>
#include <time.h>

#include "tests/check.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/fleet_world.h"

/* A scene of a room that holds nothing but an unknown field, which nobody reads before a picture is drawn. */
static cJSON *scene_packet(const char *room, int revision, const char *text)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", "scene");
    cJSON_AddStringToObject(json, "room", room);
    cJSON_AddNumberToObject(json, "revision", revision);
    cJSON_AddStringToObject(cJSON_AddObjectToObject(json, "scene"), "text", text);
    return json;
}

static void garbage_ends_that_plan_only(void **state)
{
    (void)state;
    static const char *const kinds[] = { "garbage",  "huge-head",   "large-frame", "no-type",
                                         "other-id", "wrong-scene", "image-id",    "65-images" };
    enum { N_KINDS = sizeof kinds / sizeof kinds[0] };
    struct world world;
    world_begin(&world);
    world.options.max_renderers = N_KINDS + 2;
    world_add_plan(&world, "good", "64-images"); /* the most that are allowed */
    for (int i = 0; i < N_KINDS; i++)
        world_add_plan(&world, kinds[i], kinds[i]);
    world_start(&world, N_KINDS + 1);
    world_open_plan(&world, "good");
    world_wait_for_state(&world, "good", FLEET_READY);
    for (int i = 0; i < N_KINDS; i++) {
        world_open_plan(&world, kinds[i]);
        world_wait_for_state(&world, kinds[i], FLEET_FAILED);
        if (!strstr(world_plan_of(&world, kinds[i]).problem->detail, "was ended because it s"))
            fail_msg("%s: %s", kinds[i], world_plan_of(&world, kinds[i]).problem->detail);
    }
    struct fleet_plan good = world_plan_of(&world, "good");
    assert_int_equal(good.state, FLEET_READY);
    assert_int_equal(good.generation, 1);
    world_end(&world);
}

static void a_frame_with_impossible_numbers_is_not_handed_on(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "liar");
    world_start(&world, 1);
    struct reply reply = { 0 };
    world_open_plan(&world, "a");
    world_ask(&world, "a", "render", &reply);
    world_wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
    world_end(&world);
}

static void a_flood_of_packets_does_not_fill_the_memory(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "floods");
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    assert_true(world_tell(&world, "a", scene_packet("r", 1, "")));
    nanosleep(&(struct timespec){ .tv_nsec = 700000000 }, NULL); /* nobody listens meanwhile */
    /* progress after ready is against the rules */
    world_wait_for_state(&world, "a", FLEET_RESTARTING);
    world_end(&world);
}

static void one_that_reads_nothing_is_ended_before_memory_fills(void **state)
{
    (void)state;
    struct world world;
    world_begin(&world);
    world_add_plan(&world, "a", "deaf");
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    char *text = calloc(1, (1 << 20) + 1);
    assert_non_null(text);
    memset(text, 'x', 1 << 20);
    for (int i = 0; i < 70; i++) /* the limit is 64 MB */
        assert_true(world_tell(&world, "a", scene_packet("r", i, text)));
    world_wait_for_state(&world, "a", FLEET_RESTARTING);
    free(text);
    world_end(&world);
}

/* 300 rooms send three scenes each at once, while only four orders fit into the queue to the watch. The renderer must
 * have the last scene of each room before it draws the room's picture. Every third room is closed meanwhile. */
static void no_scene_is_lost_when_the_way_to_the_renderer_is_full(void **state)
{
    (void)state;
    enum { N_ROOMS = 300 };
    struct world world;
    world_begin(&world);
    world.options.max_orders = 4;
    world_add_plan(&world, "a", "remembers-scenes");
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_READY);
    for (int revision = 1; revision <= 3; revision++)
        for (int i = 0; i < N_ROOMS; i++) {
            char room[32];
            snprintf(room, sizeof room, "room-%d", i);
            bool is_closed = revision == 3 && i % 3 == 0;
            cJSON *forget = cJSON_CreateObject();
            cJSON_AddStringToObject(forget, "type", "forget");
            cJSON_AddStringToObject(forget, "room", room);
            (void)world_tell(&world, "a", is_closed ? forget : scene_packet(room, revision, ""));
            if (!is_closed)
                cJSON_Delete(forget);
        }
    /* a request is refused while scenes wait, and answered after them */
    struct reply reply = { 0 };
    WORLD_UNTIL(&world, (reply_finish(&reply), world_ask(&world, "a", "probe", &reply),
                         world_wait_for_reply(&world, &reply), reply.problem.type != PROBLEM_BUSY));
    assert_int_equal(reply.problem.type, PROBLEM_NONE);
    cJSON *body = cJSON_GetObjectItemCaseSensitive(reply.json, "body");
    for (int i = 0; i < N_ROOMS; i++) {
        char room[32];
        snprintf(room, sizeof room, "room-%d", i);
        double revision = json_number(body, room, -1);
        if (revision != (i % 3 == 0 ? -1 : 3))
            fail_msg("%s is at revision %g", room, revision);
    }
    reply_finish(&reply);
    world_end(&world);
}

static void one_that_fills_its_cache_is_ended_and_the_cache_emptied(void **state)
{
    (void)state;
    struct world world;
    struct stat facts;
    char path[512];
    world_begin(&world);
    world.options.max_cache_bytes = 4 << 20; /* and 64 MiB of slack; it writes 80 */
    world_add_plan(&world, "a", "fills-its-cache");
    world_start(&world, 1);
    world_open_plan(&world, "a");
    world_wait_for_state(&world, "a", FLEET_FAILED); /* three more starts do the same */
    struct fleet_plan plan = world_plan_of(&world, "a");
    assert_non_null(plan.problem);
    assert_non_null(strstr(plan.problem->detail, "wrote more to its cache"));
    snprintf(path, sizeof path, "%s/cache/a/large", world.data);
    WORLD_UNTIL(&world, stat(path, &facts) != 0);
    assert_int_not_equal(stat(path, &facts), 0);
    world_end(&world);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(garbage_ends_that_plan_only),
        cmocka_unit_test(a_frame_with_impossible_numbers_is_not_handed_on),
        cmocka_unit_test(a_flood_of_packets_does_not_fill_the_memory),
        cmocka_unit_test(one_that_reads_nothing_is_ended_before_memory_fills),
        cmocka_unit_test(no_scene_is_lost_when_the_way_to_the_renderer_is_full),
        cmocka_unit_test(one_that_fills_its_cache_is_ended_and_the_cache_emptied),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

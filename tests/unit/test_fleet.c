/* The fleet against a made-up renderer: this program itself, started by the fleet, which behaves as the file "behave" in the plan's
 * folder says. What a renderer may do wrong is done here. */
#include <dirent.h>
#include <signal.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "server/fleet/fleet.h"
#include "tests/check.h"

/* ---- the made-up renderer ---- */

static char behaviour[64];

static bool behaves(const char *word) { return strcmp(behaviour, word) == 0; }

static const char *argument(int argc, char **argv, const char *flag)
{
    for (int i = 1; i + 1 < argc; i++)
        if (strcmp(argv[i], flag) == 0)
            return argv[i + 1];
    return NULL;
}

static void read_behaviour(const char *folder)
{
    char path[512];
    snprintf(path, sizeof path, "%s/behave", folder);
    FILE *file = fopen(path, "r");
    if (file && !fgets(behaviour, sizeof behaviour, file))
        behaviour[0] = 0;
    if (file)
        fclose(file);
}

static void write_all(const void *bytes, size_t n)
{
    for (const char *at = bytes; n > 0;) {
        ssize_t wrote = write(3, at, n);
        if (wrote <= 0)
            _exit(0);
        at += wrote;
        n -= (size_t)wrote;
    }
}

static void say(cJSON *json, const void *blob, size_t n_blob)
{
    size_t n;
    uint8_t *bytes = packet_write(json, blob, n_blob, &n);
    write_all(bytes, n);
    free(bytes);
    cJSON_Delete(json);
}

static cJSON *word(const char *type)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", type);
    return json;
}

static void say_progress(double percent)
{
    cJSON *json = word("progress");
    cJSON_AddStringToObject(json, "phase", "reading");
    cJSON_AddNumberToObject(json, "percent", percent);
    say(json, NULL, 0);
}

static void say_ready(const char *id)
{
    cJSON *json = word("ready"), *plan = cJSON_AddObjectToObject(json, "plan");
    cJSON_AddStringToObject(plan, "id", behaves("other-id") ? "another" : id);
    cJSON *image = cJSON_CreateObject();
    cJSON_AddStringToObject(image, "id", "ct");
    cJSON_AddItemToArray(cJSON_AddArrayToObject(plan, "images"), image);
    cJSON *scene = cJSON_AddObjectToObject(json, "scene");
    if (behaves("wrong-scene"))
        cJSON_AddNumberToObject(scene, "regions", 7);
    cJSON_AddStringToObject(json, "confined", "not at all");
    cJSON_AddNumberToObject(json, "load_ms", 12);
    say(json, NULL, 0);
}

static void say_frame(const cJSON *asked)
{
    cJSON *json = word("frame");
    cJSON_AddNumberToObject(json, "id", json_number(asked, "id", 0));
    cJSON_AddNumberToObject(json, "width_px", behaves("liar") ? -5 : 64);
    static const char *const others[] = { "height_px", "scene_revision", "render_us", "encode_us", "pixels_per_mm" };
    for (size_t i = 0; i < 5; i++)
        cJSON_AddNumberToObject(json, others[i], 48);
    cJSON *matrix = cJSON_AddArrayToObject(json, "clip_from_lps_mm");
    for (int i = 0; i < 16; i++)
        cJSON_AddItemToArray(matrix, cJSON_CreateNumber(i));
    say(json, "picture", 7);
}

static void die(void)
{
    kill(getpid(), SIGKILL);
    pause();
}

static void handle(const cJSON *packet, const char *folder)
{
    const char *type = json_text(packet, "type");
    char mark[512];
    snprintf(mark, sizeof mark, "%s/crashed", folder);
    if (strcmp(type, "ping") == 0) {
        say(word("pong"), NULL, 0);
    } else if (strcmp(type, "render") == 0) {
        if (behaves("crash-on-render") || (behaves("crash-once") && access(mark, F_OK) != 0 && mkdir(mark, 0700) == 0))
            die();
        if (!behaves("never-draws"))
            say_frame(packet);
    } else if (strcmp(type, "query") == 0) {
        cJSON *json = word("answer");
        cJSON_AddNumberToObject(json, "id", json_number(packet, "id", 0));
        cJSON_AddItemToObject(json, "body", cJSON_Duplicate(packet, true));
        say(json, NULL, 0);
    } else if (strcmp(type, "scene") == 0 && behaves("floods")) {
        for (;;)
            say_progress(1);
    }
}

static int renderer_main(const char *folder, const char *id)
{
    read_behaviour(folder);
    if (behaves("crash-loading"))
        die();
    if (behaves("huge-head")) {
        uint32_t head[3] = { 0x4b505242u, 0xffffffffu, 0xffffffffu };
        write_all(head, sizeof head);
    }
    if (behaves("garbage"))
        write_all("HTTP/1.1 200 OK\r\n\r\n", 19);
    if (behaves("no-type"))
        say(cJSON_CreateObject(), NULL, 0);
    if (behaves("fails")) {
        struct problem problem;
        problem_set(&problem, PROBLEM_VALIDATION, "", "format", "ct.nii: byte 40: 9 axes, expected 3");
        cJSON *json = word("failed");
        cJSON_AddItemToObject(json, "problem", problem_to_json(&problem));
        say(json, NULL, 0);
        return 3;
    }
    cJSON *gl = word("gl");
    cJSON_AddStringToObject(gl, "back_end", "made-up");
    say(gl, NULL, 0);
    say_progress(10);
    for (double percent = 20; behaves("loads-for-ever"); percent = percent < 90 ? percent + 0.01 : 20) {
        say_progress(percent);
        nanosleep(&(struct timespec){ .tv_nsec = 20000000 }, NULL);
    }
    while (behaves("stalls"))
        pause();
    say_ready(id);
    if (behaves("deaf"))
        raise(SIGSTOP);
    struct packet_reader *reader = packet_reader_create();
    for (;;) {
        size_t room;
        struct packet packet;
        uint8_t *space = packet_reader_space(reader, &room, NULL);
        ssize_t n = space ? read(3, space, room) : 0;
        if (n <= 0)
            break;
        packet_reader_added(reader, (size_t)n);
        while (packet_reader_take(reader, &packet, NULL) == 1) {
            handle(packet.json, folder);
            packet_finish(&packet);
        }
    }
    packet_reader_destroy(reader);
    return 0;
}

static int scan_main(const char *folder)
{
    read_behaviour(folder);
    if (behaves("scan-crashes"))
        die();
    while (behaves("scan-hangs"))
        pause();
    if (behaves("scan-babbles"))
        for (;;)
            puts("more and more");
    printf("{\"name\":\"A plan\",\"note\":\"n\",\"phantom\":true,\"readable\":%s,\"reason\":\"a DICOM folder\",\"parts\":[\"CT\"],\"n_bytes\":77}\n",
           behaves("unreadable") ? "false" : "true");
    return 0;
}

/* ---- the tests' own side ---- */

struct world {
    char folder[64];
    struct fleet *fleet;
    atomic_int n_wakes;
    int n_changes;
    struct fleet_options options;
    const char *folders[1];
    char data[80], plans[80], self[512];
};

static void wake(void *context) { atomic_fetch_add(&((struct world *)context)->n_wakes, 1); }

static void changed(void *context, const char *plan_id)
{
    struct world *world = context;
    world->n_changes += plan_id != NULL;
}

static void add_plan(struct world *world, const char *name, const char *behave)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", world->plans, name);
    assert_int_equal(mkdir(path, 0700), 0);
    snprintf(path, sizeof path, "%s/%s/behave", world->plans, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(behave, file);
    fclose(file);
}

static void begin(struct world *world)
{
    memset(world, 0, sizeof *world);
    snprintf(world->folder, sizeof world->folder, "/tmp/beamroom-fleet-XXXXXX");
    assert_non_null(mkdtemp(world->folder));
    snprintf(world->data, sizeof world->data, "%s/data", world->folder);
    snprintf(world->plans, sizeof world->plans, "%s/plans", world->folder);
    assert_int_equal(mkdir(world->data, 0700), 0);
    assert_int_equal(mkdir(world->plans, 0700), 0);
    ssize_t n = readlink("/proc/self/exe", world->self, sizeof world->self - 1);
    assert_true(n > 0);
    world->folders[0] = world->plans;
    world->options = (struct fleet_options){
        .plan_folders = world->folders, .n_plan_folders = 1, .data_folder = world->data, .renderer_path = world->self, .gl = "auto",
        .max_renderers = 4, .wake = wake, .changed = changed, .context = world,
    };
}

static void step(struct world *world)
{
    fleet_handle_events(world->fleet);
    fleet_tick(world->fleet);
    nanosleep(&(struct timespec){ .tv_nsec = 2000000 }, NULL);
}

static struct fleet_plan plan_of(struct world *world, const char *id)
{
    struct fleet_plan plan = { 0 };
    assert_true(fleet_plan_find(world->fleet, id, &plan));
    return plan;
}

static void wait_for_state(struct world *world, const char *id, enum fleet_state state)
{
    struct fleet_plan plan = { 0 };
    for (int64_t until_us = clock_now_us() + 20000000; clock_now_us() < until_us; step(world))
        if (fleet_plan_find(world->fleet, id, &plan) && plan.state == state)
            return;
    fail_msg("%s is %s, expected %s (%s)", id, fleet_state_word(plan.state), fleet_state_word(state), plan.problem ? plan.problem->detail : "");
}

static void start(struct world *world, size_t n_plans)
{
    struct error err = { 0 };
    world->fleet = fleet_create(&world->options, &err);
    assert_string_equal(err.text, "");
    for (int64_t until_us = clock_now_us() + 20000000; clock_now_us() < until_us; step(world)) {
        size_t n_looked_at = 0;
        struct fleet_plan plan;
        for (size_t i = 0; fleet_plan_at(world->fleet, i, &plan); i++)
            n_looked_at += plan.state == FLEET_UNREADABLE || cJSON_GetArraySize(plan.parts) > 0;
        if (n_looked_at == n_plans)
            return;
    }
    fail_msg("%zu plans were not listed", n_plans);
}

static void remove_folder(const char *path)
{
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        char inner[1024];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (unlink(inner) != 0)
            remove_folder(inner);
    }
    if (folder)
        closedir(folder);
    rmdir(path);
}

static void end(struct world *world)
{
    fleet_destroy(world->fleet);
    remove_folder(world->folder);
}

static void open_plan(struct world *world, const char *id)
{
    struct problem problem = { 0 };
    assert_true(fleet_open(world->fleet, id, &problem));
}

struct reply {
    int n;
    bool is_frame;
    struct problem problem;
    char what[32];
};

static void take_reply(void *context, struct packet *answer, const struct problem *problem)
{
    struct reply *reply = context;
    reply->n++;
    if (problem) {
        reply->problem = *problem;
        return;
    }
    reply->is_frame = answer->n_blob == 7 && memcmp(answer->blob, "picture", 7) == 0;
    const char *what = json_text(cJSON_GetObjectItemCaseSensitive(answer->json, "body"), "what");
    snprintf(reply->what, sizeof reply->what, "%s", what ? what : "");
}

static uint64_t ask(struct world *world, const char *id, const char *type, struct reply *reply)
{
    cJSON *packet = word(type);
    cJSON_AddStringToObject(packet, "what", "probe");
    uint64_t number = fleet_request(world->fleet, id, packet, take_reply, reply);
    cJSON_Delete(packet);
    return number;
}

static void wait_for_reply(struct world *world, struct reply *reply)
{
    for (int64_t until_us = clock_now_us() + 20000000; reply->n == 0 && clock_now_us() < until_us;)
        step(world);
    assert_int_equal(reply->n, 1);
}

/* ---- the tests ---- */

static void a_plan_is_listed_opened_drawn_and_closed(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "Head of Mr. X", "");
    add_plan(&world, "head-of-mr-x", "");
    start(&world, 2);
    assert_int_equal(fleet_n_plans(world.fleet), 2);
    struct fleet_plan plan = plan_of(&world, "head-of-mr-x");
    assert_string_equal(plan.name, "A plan");
    assert_true(plan.is_phantom);
    assert_int_equal(plan.n_bytes, 77);
    assert_int_equal(plan.state, FLEET_CLOSED);
    plan_of(&world, "head-of-mr-x-2");

    struct reply frame = { 0 }, answer = { 0 }, forgotten = { 0 };
    open_plan(&world, "head-of-mr-x");
    ask(&world, "head-of-mr-x", "render", &frame); /* waits for ready */
    wait_for_reply(&world, &frame);
    assert_true(frame.is_frame);
    plan = plan_of(&world, "head-of-mr-x");
    assert_int_equal(plan.state, FLEET_READY);
    assert_int_equal(plan.generation, 1);
    assert_non_null(plan.document);
    assert_string_equal(plan.image_ids[0], "ct");
    assert_null(plan.image_ids[1]);
    assert_string_equal(plan.confined, "not at all");
    assert_true(plan.pid > 0);
    assert_non_null(fleet_gl(world.fleet, NULL));
    fleet_forget_request(world.fleet, ask(&world, "head-of-mr-x", "query", &forgotten));
    ask(&world, "head-of-mr-x", "query", &answer);
    wait_for_reply(&world, &answer);
    assert_string_equal(answer.what, "probe");
    assert_int_equal(forgotten.n, 0);
    assert_true(world.n_changes >= 2);
    assert_true(atomic_load(&world.n_wakes) > 0);

    pid_t pid = plan.pid;
    fleet_close(world.fleet, "head-of-mr-x");
    assert_int_equal(plan_of(&world, "head-of-mr-x").state, FLEET_CLOSED);
    for (int i = 0; i < 1000 && kill(pid, 0) == 0; i++)
        step(&world);
    assert_int_equal(kill(pid, 0), -1);
    end(&world);
}

static void what_cannot_be_read_is_listed_with_the_reason_and_not_opened(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "unreadable");
    add_plan(&world, "b", "scan-crashes");
    add_plan(&world, "c", "scan-hangs");
    add_plan(&world, "d", "scan-babbles");
    world.options.times.scan = 1000;
    start(&world, 4);
    static const char *const expected[4] = { "a DICOM folder", "the program that looks at plans stopped (signal 9)",
                                             "looking at the plan took longer than it may", "looking at the plan printed more than it may" };
    for (int i = 0; i < 4; i++) {
        char id[2] = { (char)('a' + i), 0 };
        struct fleet_plan plan = plan_of(&world, id);
        assert_int_equal(plan.state, FLEET_UNREADABLE);
        assert_string_equal(plan.problem->detail, expected[i]);
        struct problem problem = { 0 };
        assert_false(fleet_open(world.fleet, id, &problem));
        assert_int_equal(problem.type, PROBLEM_PLAN_UNREADABLE);
    }
    end(&world);
}

static void a_folder_that_changes_is_looked_at_again(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "unreadable");
    add_plan(&world, "b", "");
    start(&world, 2);
    char path[512];
    snprintf(path, sizeof path, "%s/a/behave", world.plans);
    assert_int_equal(unlink(path), 0);
    snprintf(path, sizeof path, "%s/b", world.plans);
    remove_folder(path);
    add_plan(&world, "c", "");
    fleet_rescan(world.fleet);
    wait_for_state(&world, "a", FLEET_CLOSED);
    wait_for_state(&world, "c", FLEET_CLOSED);
    struct fleet_plan plan;
    assert_false(fleet_plan_find(world.fleet, "b", &plan));
    end(&world);
}

static void a_crash_while_loading_fails_the_plan_and_says_how(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "crash-loading");
    add_plan(&world, "b", "fails");
    start(&world, 2);
    struct reply reply = { 0 };
    open_plan(&world, "a");
    open_plan(&world, "b");
    ask(&world, "a", "render", &reply);
    wait_for_state(&world, "a", FLEET_FAILED);
    wait_for_state(&world, "b", FLEET_FAILED);
    assert_string_equal(plan_of(&world, "a").problem->detail, "the renderer stopped while reading the plan (signal 9)");
    assert_string_equal(plan_of(&world, "b").problem->detail, "ct.nii: byte 40: 9 axes, expected 3");
    assert_int_equal(plan_of(&world, "b").problem->type, PROBLEM_PLAN_UNREADABLE);
    wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
    open_plan(&world, "a"); /* tries again */
    assert_int_equal(plan_of(&world, "a").state, FLEET_STARTING);
    wait_for_state(&world, "a", FLEET_FAILED);
    end(&world);
}

static void a_crash_answers_what_waits_and_the_next_process_draws(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "crash-once");
    start(&world, 1);
    struct reply first = { 0 }, second = { 0 };
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_READY);
    ask(&world, "a", "render", &first);
    wait_for_reply(&world, &first);
    assert_int_equal(first.problem.type, PROBLEM_RENDERER);
    assert_int_equal(plan_of(&world, "a").state, FLEET_RESTARTING);
    assert_non_null(plan_of(&world, "a").document); /* kept */
    ask(&world, "a", "render", &second);            /* waits for the new one */
    int64_t asked_us = clock_now_us();
    wait_for_reply(&world, &second);
    assert_true(second.is_frame);
    assert_true(clock_now_us() - asked_us < 2000000); /* the first restart waits for nothing */
    assert_int_equal(plan_of(&world, "a").generation, 2);
    end(&world);
}

static void restarts_back_off_and_end_after_the_third(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "crash-on-render");
    start(&world, 1);
    open_plan(&world, "a");
    int64_t began_us = clock_now_us();
    for (int i = 0; i < FLEET_MAX_RESTARTS + 1; i++) {
        struct reply reply = { 0 };
        wait_for_state(&world, "a", FLEET_READY);
        ask(&world, "a", "render", &reply);
        wait_for_reply(&world, &reply);
        assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
    }
    assert_int_equal(plan_of(&world, "a").state, FLEET_FAILED);
    assert_int_equal(plan_of(&world, "a").generation, FLEET_MAX_RESTARTS + 1);
    assert_string_equal(plan_of(&world, "a").problem->detail,
                        "the renderer stopped 4 times within a minute; the last time it stopped (signal 9)");
    assert_true(clock_now_us() - began_us >= 2500000); /* 0 + 0.5 + 2 s of waiting */
    end(&world);
}

static void garbage_ends_that_plan_only(void **state)
{
    (void)state;
    static const char *const kinds[] = { "garbage", "huge-head", "no-type", "other-id", "wrong-scene" };
    struct world world;
    begin(&world);
    world.options.max_renderers = 10;
    add_plan(&world, "good", "");
    for (int i = 0; i < 5; i++)
        add_plan(&world, kinds[i], kinds[i]);
    start(&world, 6);
    open_plan(&world, "good");
    wait_for_state(&world, "good", FLEET_READY);
    for (int i = 0; i < 5; i++) {
        open_plan(&world, kinds[i]);
        wait_for_state(&world, kinds[i], FLEET_FAILED);
        if (!strstr(plan_of(&world, kinds[i]).problem->detail, "was ended because it s"))
            fail_msg("%s: %s", kinds[i], plan_of(&world, kinds[i]).problem->detail);
    }
    struct fleet_plan good = plan_of(&world, "good");
    assert_int_equal(good.state, FLEET_READY);
    assert_int_equal(good.generation, 1);
    end(&world);
}

static void a_frame_with_impossible_numbers_is_not_handed_on(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "liar");
    start(&world, 1);
    struct reply reply = { 0 };
    open_plan(&world, "a");
    ask(&world, "a", "render", &reply);
    wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_RENDERER);
    end(&world);
}

static void one_that_hears_nothing_is_ended_and_started_again(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "deaf");
    world.options.times.ping = 100;
    world.options.times.silent = 600;
    start(&world, 1);
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_READY);
    wait_for_state(&world, "a", FLEET_RESTARTING);
    assert_true(plan_of(&world, "a").generation >= 1);
    end(&world);
}

static void one_that_answers_pings_lives_on(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "");
    world.options.times.ping = 50;
    world.options.times.silent = 700;
    start(&world, 1);
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_READY);
    for (int64_t until_us = clock_now_us() + 1500000; clock_now_us() < until_us;)
        step(&world);
    assert_int_equal(plan_of(&world, "a").state, FLEET_READY);
    assert_int_equal(plan_of(&world, "a").generation, 1);
    assert_true(plan_of(&world, "a").memory_bytes > 100000);
    end(&world);
}

static void a_load_that_gets_no_further_fails(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "stalls");
    world.options.times.stall = 300;
    start(&world, 1);
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_FAILED);
    assert_non_null(strstr(plan_of(&world, "a").problem->detail, "got no further"));
    end(&world);
}

static void a_picture_that_never_comes_is_a_timeout_and_a_restart(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "never-draws");
    world.options.times.request = 1000;
    start(&world, 1);
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_READY);
    struct reply reply = { 0 };
    ask(&world, "a", "render", &reply);
    wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_TIMEOUT);
    wait_for_state(&world, "a", FLEET_RESTARTING);
    end(&world);
}

static void closing_cancels_a_load(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "loads-for-ever");
    start(&world, 1);
    struct reply reply = { 0 };
    open_plan(&world, "a");
    ask(&world, "a", "render", &reply);
    wait_for_state(&world, "a", FLEET_LOADING);
    assert_string_equal(plan_of(&world, "a").phase, "reading");
    fleet_close(world.fleet, "a");
    assert_int_equal(plan_of(&world, "a").state, FLEET_CLOSED);
    wait_for_reply(&world, &reply);
    assert_int_equal(reply.problem.type, PROBLEM_CANCELLED);
    end(&world);
}

static void the_longest_unused_plan_makes_room_but_never_a_held_one(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "");
    add_plan(&world, "b", "");
    add_plan(&world, "c", "");
    add_plan(&world, "d", "");
    world.options.max_renderers = 2;
    start(&world, 4);
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_READY);
    open_plan(&world, "b");
    wait_for_state(&world, "b", FLEET_READY);
    fleet_hold(world.fleet, "a");
    open_plan(&world, "c");
    assert_int_equal(plan_of(&world, "a").state, FLEET_READY);
    assert_int_equal(plan_of(&world, "b").state, FLEET_CLOSED);
    wait_for_state(&world, "c", FLEET_READY);
    fleet_hold(world.fleet, "c");
    struct problem problem = { 0 };
    assert_false(fleet_open(world.fleet, "d", &problem));
    assert_int_equal(problem.type, PROBLEM_BUSY);
    fleet_release(world.fleet, "a");
    open_plan(&world, "d");
    assert_int_equal(plan_of(&world, "a").state, FLEET_CLOSED);
    end(&world);
}

static void an_idle_plan_is_closed_unless_held(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "");
    add_plan(&world, "b", "");
    world.options.idle_close_s = 1;
    start(&world, 2);
    open_plan(&world, "a");
    open_plan(&world, "b");
    fleet_hold(world.fleet, "b");
    wait_for_state(&world, "a", FLEET_READY);
    wait_for_state(&world, "b", FLEET_READY);
    wait_for_state(&world, "a", FLEET_CLOSED);
    assert_int_equal(plan_of(&world, "b").state, FLEET_READY);
    end(&world);
}

static void a_flood_of_packets_does_not_fill_the_memory(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "floods");
    start(&world, 1);
    open_plan(&world, "a");
    wait_for_state(&world, "a", FLEET_READY);
    cJSON *scene = word("scene");
    assert_true(fleet_tell(world.fleet, "a", scene));
    cJSON_Delete(scene);
    nanosleep(&(struct timespec){ .tv_nsec = 700000000 }, NULL); /* nobody listens meanwhile */
    /* progress after ready is against the rules */
    wait_for_state(&world, "a", FLEET_RESTARTING);
    end(&world);
}

static void what_is_asked_of_no_plan_or_a_closed_one_is_refused(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "");
    start(&world, 1);
    struct reply unknown = { 0 }, closed = { 0 };
    struct problem problem = { 0 };
    assert_false(fleet_open(world.fleet, "nobody", &problem));
    assert_int_equal(problem.type, PROBLEM_NOT_FOUND);
    ask(&world, "nobody", "query", &unknown);
    ask(&world, "a", "query", &closed);
    assert_int_equal(unknown.n, 0); /* only from fleet_handle_events */
    wait_for_reply(&world, &unknown);
    wait_for_reply(&world, &closed);
    assert_int_equal(unknown.problem.type, PROBLEM_NOT_FOUND);
    assert_int_equal(closed.problem.type, PROBLEM_BUSY);
    end(&world);
}

static void the_end_answers_everybody_and_leaves_no_process(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    add_plan(&world, "a", "never-draws");
    add_plan(&world, "b", "deaf");
    start(&world, 2);
    struct reply reply = { 0 };
    open_plan(&world, "a");
    open_plan(&world, "b");
    wait_for_state(&world, "a", FLEET_READY);
    wait_for_state(&world, "b", FLEET_READY);
    ask(&world, "a", "render", &reply);
    pid_t pids[2] = { plan_of(&world, "a").pid, plan_of(&world, "b").pid };
    int64_t began_us = clock_now_us();
    end(&world);
    assert_true(clock_now_us() - began_us < 4000000);
    assert_int_equal(reply.n, 1);
    assert_int_equal(reply.problem.type, PROBLEM_CANCELLED);
    for (int i = 0; i < 2; i++)
        assert_int_equal(kill(pids[i], 0), -1);
}

static void a_renderer_that_is_not_there_is_said_at_once(void **state)
{
    (void)state;
    struct world world;
    begin(&world);
    world.options.renderer_path = "/nowhere/beamroom-render";
    struct error err = { 0 };
    assert_null(fleet_create(&world.options, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    remove_folder(world.folder);
}

int main(int argc, char **argv)
{
    const char *folder = argument(argc, argv, "--plan-folder"), *id = argument(argc, argv, "--plan-id");
    if (folder && id)
        return renderer_main(folder, id);
    if (argument(argc, argv, "--scan"))
        return scan_main(argument(argc, argv, "--scan"));
    if (argc > 1 && strcmp(argv[1], "--probe-gl") == 0)
        return puts("{\"back_end\":\"made-up\",\"is_software\":true}") < 0;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_plan_is_listed_opened_drawn_and_closed),
        cmocka_unit_test(what_cannot_be_read_is_listed_with_the_reason_and_not_opened),
        cmocka_unit_test(a_folder_that_changes_is_looked_at_again),
        cmocka_unit_test(a_crash_while_loading_fails_the_plan_and_says_how),
        cmocka_unit_test(a_crash_answers_what_waits_and_the_next_process_draws),
        cmocka_unit_test(restarts_back_off_and_end_after_the_third),
        cmocka_unit_test(garbage_ends_that_plan_only),
        cmocka_unit_test(a_frame_with_impossible_numbers_is_not_handed_on),
        cmocka_unit_test(one_that_hears_nothing_is_ended_and_started_again),
        cmocka_unit_test(one_that_answers_pings_lives_on),
        cmocka_unit_test(a_load_that_gets_no_further_fails),
        cmocka_unit_test(a_picture_that_never_comes_is_a_timeout_and_a_restart),
        cmocka_unit_test(closing_cancels_a_load),
        cmocka_unit_test(the_longest_unused_plan_makes_room_but_never_a_held_one),
        cmocka_unit_test(an_idle_plan_is_closed_unless_held),
        cmocka_unit_test(a_flood_of_packets_does_not_fill_the_memory),
        cmocka_unit_test(what_is_asked_of_no_plan_or_a_closed_one_is_refused),
        cmocka_unit_test(the_end_answers_everybody_and_leaves_no_process),
        cmocka_unit_test(a_renderer_that_is_not_there_is_said_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

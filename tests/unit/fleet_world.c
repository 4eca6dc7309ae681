/* Makes a fleet on a folder of its own, and steps it as the net thread does. */
#include "tests/unit/fleet_world.h"

#include <dirent.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "tests/check.h"

static void wake(void *context)
{
    atomic_fetch_add(&((struct world *)context)->n_wakes, 1);
}

static void changed(void *context, const char *plan_id)
{
    struct world *world = context;
    world->n_changes += plan_id != NULL;
}

void world_add_plan(struct world *world, const char *name, const char *behave)
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

void world_begin(struct world *world)
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
        .plan_folders = world->folders,
        .n_plan_folders = 1,
        .data_folder = world->data,
        .renderer_path = world->self,
        .gl = "auto",
        .max_renderers = 4,
        .wake = wake,
        .changed = changed,
        .context = world,
    };
}

void world_step(struct world *world)
{
    fleet_handle_events(world->fleet);
    fleet_tick(world->fleet);
    nanosleep(&(struct timespec){ .tv_nsec = 2000000 }, NULL);
}

struct fleet_plan world_plan_of(struct world *world, const char *id)
{
    struct fleet_plan plan = { 0 };
    assert_true(fleet_plan_find(world->fleet, id, &plan));
    return plan;
}

void world_wait_for_state(struct world *world, const char *id, enum fleet_state state)
{
    struct fleet_plan plan = { 0 };
    WORLD_UNTIL(world, fleet_plan_find(world->fleet, id, &plan) && plan.state == state);
    if (plan.state != state)
        fail_msg("%s is %s, expected %s (%s)", id, fleet_state_word(plan.state), fleet_state_word(state),
                 plan.problem ? plan.problem->detail : "");
}

static size_t n_looked_at(const struct world *world)
{
    size_t n = 0;
    struct fleet_plan plan;
    for (size_t i = 0; fleet_plan_at(world->fleet, i, &plan); i++)
        n += plan.state == FLEET_UNREADABLE || cJSON_GetArraySize(plan.parts) > 0;
    return n;
}

void world_start(struct world *world, size_t n_plans)
{
    struct error err = { 0 };
    world->fleet = fleet_create(&world->options, &err);
    assert_string_equal(err.text, "");
    WORLD_UNTIL(world, n_looked_at(world) >= n_plans);
    if (n_looked_at(world) < n_plans)
        fail_msg("%zu plans were not listed", n_plans);
}

void world_remove_folder(const char *path)
{
    DIR *folder = opendir(path);
    for (const struct dirent *entry; folder && (entry = readdir(folder));) {
        char inner[1024];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0)
            continue;
        snprintf(inner, sizeof inner, "%s/%s", path, entry->d_name);
        if (unlink(inner) != 0)
            world_remove_folder(inner);
    }
    if (folder)
        closedir(folder);
    rmdir(path);
}

void world_end(struct world *world)
{
    fleet_destroy(world->fleet);
    world_remove_folder(world->folder);
}

void world_open_plan(struct world *world, const char *id)
{
    struct problem problem = { 0 };
    assert_true(fleet_open(world->fleet, id, &problem));
}

static void take_reply(void *context, struct packet *answer, const struct problem *problem)
{
    struct reply *reply = context;
    reply->n++;
    if (problem) {
        reply->problem = *problem;
        return;
    }
    reply->is_frame = answer->n_blob == 7 && memcmp(answer->blob, "picture", 7) == 0;
    const char *type = answer->type == PACKET_ANSWER ? json_text(answer->answer.body, "type") : NULL;
    snprintf(reply->type, sizeof reply->type, "%s", type ? type : "");
    reply->json = cJSON_Duplicate(answer->json, true);
    reply->blob = answer->blob;
    reply->n_blob = answer->n_blob;
    answer->blob = NULL;
}

static struct packet packet_of(cJSON *json)
{
    struct packet packet;
    struct problem problem = { 0 };
    if (!packet_from_json(json, PACKET_TO_RENDERER, 0, &packet, &problem))
        fail_msg("%s", problem.detail);
    return packet;
}

uint64_t world_ask_packet(struct world *world, const char *id, cJSON *json, struct reply *reply)
{
    cJSON_AddNumberToObject(json, "id", 0); /* the fleet's to set */
    struct packet packet = packet_of(json);
    uint64_t number = fleet_request(world->fleet, id, &packet, take_reply, reply);
    packet_finish(&packet);
    return number;
}

uint64_t world_ask(struct world *world, const char *id, const char *type, struct reply *reply)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "type", type);
    if (strcmp(type, "probe") == 0)
        cJSON_AddItemToObject(json, "point_lps_mm", cJSON_CreateDoubleArray((const double[]){ 1, 2, 3 }, 3));
    return world_ask_packet(world, id, json, reply);
}

bool world_tell(struct world *world, const char *id, cJSON *json)
{
    struct packet packet = packet_of(json);
    bool is_sent = fleet_tell(world->fleet, id, &packet);
    packet_finish(&packet);
    return is_sent;
}

void world_wait_for_reply(struct world *world, struct reply *reply)
{
    WORLD_UNTIL(world, reply->n > 0);
    assert_int_equal(reply->n, 1);
}

void reply_finish(struct reply *reply)
{
    cJSON_Delete(reply->json);
    free(reply->blob);
    *reply = (struct reply){ 0 };
}

void world_begin_with_plan(struct world *world, const char *behave)
{
    world_begin(world);
    world_add_plan(world, "a", behave);
}

void world_step_for_ms(struct world *world, int ms)
{
    for (int64_t end_us = clock_now_us() + ms * 1000LL; clock_now_us() < end_us;)
        world_step(world);
}

void world_draw(struct world *world, const char *id)
{
    struct reply reply = { 0 };
    world_wait_for_state(world, id, FLEET_READY);
    world_ask(world, id, "render", &reply);
    world_wait_for_reply(world, &reply);
    assert_true(reply.is_frame);
    reply_finish(&reply);
}

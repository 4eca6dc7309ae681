#pragma once
/* A fleet on a folder of plans of its own, for tests. */
#include <stdatomic.h>
#include <stddef.h>

#include "core/base/clock.h"
#include "server/fleet/fleet.h"

struct world {
    char folder[64];
    struct fleet *fleet;
    atomic_int n_wakes;
    int n_changes;
    struct fleet_options options;
    const char *folders[1];
    char data[80], plans[80], self[512];
};

struct reply {
    int n;         /* replies so far */
    bool is_frame; /* with the made-up renderer's picture */
    struct problem problem;
    char type[32]; /* the made-up renderer answers a question with the packet that asked it: its type */
    cJSON *json;   /* the answer; reply_finish frees it */
    uint8_t *blob;
    size_t n_blob;
};

/* Makes a folder below /tmp with an empty folder of plans, and fills in options, which the test may change. The
 * renderer is this test program. */
void world_begin(struct world *world);
/* A plan for the made-up renderer. */
void world_add_plan(struct world *world, const char *name, const char *behave);
/* world_begin with a plan "a" for the made-up renderer. */
void world_begin_with_plan(struct world *world, const char *behave);
/* Starts the fleet and waits until n_plans or more have been looked at. */
void world_start(struct world *world, size_t n_plans);
void world_end(struct world *world);
void world_remove_folder(const char *path);
void world_step(struct world *world); /* one turn of what the net thread does */
/* Steps until the condition holds; gives up after a minute, which is long enough for busy machines. */
#define WORLD_UNTIL(world, condition) \
    for (int64_t until_us_ = clock_now_us() + 60000000; !(condition) && clock_now_us() < until_us_;) \
    world_step(world)
void world_step_for_ms(struct world *world, int ms);
struct fleet_plan world_plan_of(struct world *world, const char *id);
void world_wait_for_state(struct world *world, const char *id, enum fleet_state state);
void world_open_plan(struct world *world, const char *id);
/* Sends a request of this type: "render", or "probe" of one point. reply must outlive the answer. */
uint64_t world_ask(struct world *world, const char *id, const char *type, struct reply *reply);
/* Sends a request: the JSON of a packet without its id, which is deleted. */
uint64_t world_ask_packet(struct world *world, const char *id, cJSON *packet, struct reply *reply);
/* Sends a packet that has no answer: its JSON, which is deleted. False: the plan is not ready. */
bool world_tell(struct world *world, const char *id, cJSON *packet);
void world_wait_for_reply(struct world *world, struct reply *reply);
/* Waits until the plan is ready, requests a picture and fails the test when none comes. */
void world_draw(struct world *world, const char *id);
void reply_finish(struct reply *reply); /* empties it too */

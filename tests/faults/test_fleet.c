/* Processes that are started, and plans that are opened by them, while a call of the system fails. */
#include <sys/wait.h>
#include <unistd.h>

#include "server/fleet/spawn.h"
#include "tests/check.h"
#include "tests/faults/walk.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/fleet_world.h"

static void start_process(void *context, struct outcome *outcome)
{
    static char program[] = "/bin/true";
    char *arguments[] = { program, NULL };
    struct child child;
    (void)context;
    outcome->is_done = spawn_child(arguments, SPAWN_SOCKET, &child, &outcome->err);
    if (!outcome->is_done)
        return;
    faults_pause();
    int status = 0;
    (void)waitpid(child.pid, &status, 0);
    outcome_add_number(outcome, status);
    close(child.channel);
    if (child.pid_file >= 0)
        close(child.pid_file);
    faults_go_on();
}

static bool is_settled(struct world *world, struct fleet_plan *plan)
{
    return fleet_plan_find(world->fleet, "head", plan) && (plan->state == FLEET_READY || plan->state == FLEET_FAILED);
}

/* A plan that could not be opened says why, and opens the next time. */
static void open_plan(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct world world;
    struct fleet_plan plan = { 0 };
    world_begin(&world);
    world_add_plan(&world, "head", "");
    world_start(&world, 1);
    faults_go_on();
    if (fleet_open(world.fleet, "head", &outcome->problem))
        WORLD_UNTIL(&world, is_settled(&world, &plan));
    faults_pause();
    outcome->is_done = plan.state == FLEET_READY;
    if (!outcome->is_done) {
        if (plan.problem)
            outcome->problem = *plan.problem;
        struct problem again = { 0 };
        if (fleet_open(world.fleet, "head", &again))
            WORLD_UNTIL(&world, is_settled(&world, &plan));
        if (plan.state != FLEET_READY) { /* a finding */
            outcome->problem = (struct problem){ 0 };
            outcome_note(outcome, "it does not open the next time");
        }
    }
    outcome_add_text(outcome, fleet_state_word(plan.state));
    world_end(&world);
    faults_go_on();
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct walk start = { .name = "a process is started",
                                .run = start_process,
                                .kinds = { [FAULT_MEMORY] = true, [FAULT_OPEN] = true, [FAULT_START] = true } };
    walk_run(&start);
    const struct walk open = { .name = "a renderer is started and opens its plan",
                               .run = open_plan,
                               .is_short = true,
                               .kinds = { [FAULT_OPEN] = true, [FAULT_START] = true } };
    walk_run(&open);
    return walks_end();
}

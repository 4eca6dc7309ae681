/* The probe program at start, and the GL facts that it or a renderer reported. */
#include "server/fleet/gl_probe.h"

#include <stdio.h>

#include "core/base/log.h"
#include "server/fleet/watch.h"

void gl_probe_start(struct fleet *fleet)
{
    const char *words[] = {
        fleet->renderer_path, "--probe-gl", "--gl", fleet->gl_word, fleet->options.stub_renderer ? "--stub" : NULL, NULL
    };
    fleet->gl_probe = fleet_next_number(fleet);
    if (!watch_start_program(fleet->watch, fleet->gl_probe, fleet_arguments(words), fleet->times.scan))
        fleet->gl_probe = 0;
}

/* A copy with only the known members, each cut to 199 bytes; NULL when json holds no GL facts. */
static cJSON *copy_facts(const cJSON *json)
{
    static const char *const texts[] = { "back_end", "vendor", "renderer", "version", "confined" };
    if (!json_text(json, "back_end"))
        return NULL;
    cJSON *facts = cJSON_CreateObject();
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        char text[200];
        const char *given = json_text(json, texts[i]);
        (void)snprintf(text, sizeof text, "%s", given ? given : "");
        cJSON_AddStringToObject(facts, texts[i], text);
    }
    cJSON_AddBoolToObject(facts, "is_software", json_flag(json, "is_software", false));
    return facts;
}

bool gl_facts_received(struct fleet *fleet, const cJSON *json)
{
    const cJSON *reported = cJSON_GetObjectItemCaseSensitive(json, "problem");
    if (reported) {
        struct problem problem;
        if (!problem_from_json(reported, &problem))
            return false;
        fleet->gl_problem = problem;
        cJSON_Delete(fleet->gl);
        fleet->gl = NULL;
        return true;
    }
    cJSON *facts = copy_facts(json);
    if (!facts)
        return false;
    cJSON_Delete(fleet->gl);
    fleet->gl = facts;
    fleet->gl_problem = (struct problem){ 0 };
    return true;
}

bool gl_probe_ended(struct fleet *fleet, const struct watch_event *event)
{
    struct problem problem;
    char how[240];
    if (event->number != fleet->gl_probe)
        return false;
    fleet->gl_probe = 0;
    if (fleet->gl)
        return true; /* a renderer reported meanwhile */
    cJSON *json = event->is_exit ? json_read(event->output ? event->output : "", event->n_output, &problem) : NULL;
    if (!json || !gl_facts_received(fleet, json)) {
        watch_event_describe_end(event, how, sizeof how);
        problem_set(&fleet->gl_problem, PROBLEM_GL_UNAVAILABLE, "", "",
                    "looking for a way to draw failed: the renderer %.180s", how);
    }
    cJSON_Delete(json);
    if (fleet->gl_problem.type != PROBLEM_NONE)
        log_warn("%s", fleet->gl_problem.detail);
    else
        log_info("drawing: %s, %s", json_text(fleet->gl, "back_end"), json_text(fleet->gl, "renderer"));
    fleet->list_has_changed = true;
    return true;
}

const cJSON *fleet_gl(const struct fleet *fleet, const struct problem **problem)
{
    if (problem)
        *problem = fleet->gl_problem.type != PROBLEM_NONE ? &fleet->gl_problem : NULL;
    return fleet->gl;
}

/* Runs the probe program at start, and keeps the GL facts that it or a renderer reported. */
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

bool gl_facts_received(struct fleet *fleet, const struct packet_gl *gl)
{
    bool has_failed = gl->problem.type != PROBLEM_NONE;
    if (!has_failed && !gl->back_end[0])
        return false;
    cJSON_Delete(fleet->gl);
    fleet->gl = NULL;
    fleet->gl_problem = gl->problem;
    if (has_failed)
        return true;
    cJSON *facts = fleet->gl = cJSON_CreateObject();
    cJSON_AddStringToObject(facts, "back_end", gl->back_end);
    cJSON_AddStringToObject(facts, "vendor", gl->vendor);
    cJSON_AddStringToObject(facts, "renderer", gl->renderer);
    cJSON_AddStringToObject(facts, "version", gl->version);
    cJSON_AddStringToObject(facts, "confined", gl->confined);
    cJSON_AddBoolToObject(facts, "is_software", gl->is_software);
    return true;
}

/* The probe prints the fields of a "gl" packet. Returns false when it printed something else. */
static bool read_output(struct fleet *fleet, const struct watch_event *event)
{
    struct packet packet;
    struct problem problem;
    cJSON *json = event->is_exit ? json_read(event->output ? event->output : "", event->n_output, &problem) : NULL;
    cJSON_AddStringToObject(json, "type", "gl");
    if (!packet_from_json(json, PACKET_TO_DAEMON, 0, &packet, &problem))
        return false;
    bool is_good = gl_facts_received(fleet, &packet.gl);
    packet_finish(&packet);
    return is_good;
}

bool gl_probe_ended(struct fleet *fleet, const struct watch_event *event)
{
    char how[240];
    if (event->number != fleet->gl_probe)
        return false;
    fleet->gl_probe = 0;
    if (fleet->gl)
        return true; /* a renderer reported meanwhile */
    if (!read_output(fleet, event)) {
        watch_event_describe_end(event, how, sizeof how);
        problem_set(&fleet->gl_problem, PROBLEM_GL_UNAVAILABLE, "", "",
                    "looking for a way to draw failed: the renderer %.180s", how);
    }
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

/* Answers calls over HTTP: what they may do in a room, its documents, the scene. */
#include "server/room/entry.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/room/log/replay.h"
#include "server/room/out/audit.h"
#include "server/room/people/admission.h"
#include "server/room/people/control.h"
#include "server/room/people/links.h"
#include "server/room/people/naming.h"
#include "server/room/people/removal.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"
#include "server/room/views/shared_scene.h"
#include "server/wire/json.h"
#include "server/wire/message.h"

struct member *room_caller(const struct room *room, const char *member)
{
    char id[64];
    const size_t n = member ? strcspn(member, " ") : 0;
    (void)snprintf(id, sizeof id, "%.*s", (int)(n < sizeof id ? n : 0), member ? member : "");
    for (int i = 0; i < room->members.n && member && member[n] == ' '; i++)
        if (strcmp(room->members.list[i]->id, id) == 0 &&
            secret_matches(member + n + 1, room->members.list[i]->secret_hash))
            return room->members.list[i];
    return NULL;
}

const char *room_caller_name(const struct room *room, const char *member)
{
    const struct member *caller = room_caller(room, member);
    return caller ? caller->name : "";
}

const cJSON *room_scene(const struct room *room, uint32_t *revision)
{
    if (revision)
        *revision = room->shared.revision;
    return room->shared.scene;
}

cJSON *room_scene_for_view(const struct room *room, const cJSON *view, struct problem *problem)
{
    return scene_document_for_view(room->shared.plan, room->shared.defaults, room->shared.scene, view, problem);
}

bool room_patch_scene(struct room *room, const cJSON *patch, const char *caller, const char *address, int64_t now_us,
                      struct problem *problem)
{
    room_enter(room, now_us);
    room->call.by = room_caller(room, caller);
    room->call.address = address;
    const bool ok =
        replay_allows(room, MESSAGE_SCENE_PATCH, problem) && scene_apply_patch(room, patch, NULL, 0, problem);
    room->call.address = NULL;
    room->call.by = NULL;
    room_leave(room);
    return ok;
}

void room_audit_call(struct room *room, const struct identity *who, const char *member, const char *address,
                     const char *action, cJSON *detail, bool is_refused, int64_t now_us)
{
    if (strcmp(action, "export") == 0 && room->files.revision[0])
        cJSON_AddStringToObject(detail, "plan_revision", room->files.revision);
    const struct audit_act act = { .by = room_caller(room, member),
                                   .action = action,
                                   .address = address,
                                   .who = who,
                                   .detail = detail,
                                   .is_refused = is_refused,
                                   .before = -1,
                                   .after = room->shared.revision };
    room_enter(room, now_us);
    audit_tell(room, &act);
    room_leave(room);
}

struct room_caller room_caller_of(const struct room *room, const struct identity *who, const char *member)
{
    const struct member *caller = room_caller(room, member);
    struct room_caller found = { .role = WIRE_MEMBER_ROLE_OBSERVER };
    if (member && !(caller && who_has_seat(who, caller->user, caller->is_guest, caller->role)))
        return found;
    if (caller)
        return (struct room_caller){
            .is_here = true, .is_member = true, .is_guest = caller->is_guest, .role = who_holds(who, caller->role)
        };
    found.is_here = true;
    if (who_is_machine(who))
        found.role = links_were_made(room) ? WIRE_MEMBER_ROLE_REVIEWER : WIRE_MEMBER_ROLE_PRESENTER;
    else
        found.is_here = admission_role(room, who, &found.role);
    found.role = who_holds(who, found.role);
    return found;
}

bool room_caller_gives(const struct room_caller *caller, enum wire_member_role role)
{
    return role_rank(role) <= role_rank(caller->role);
}

bool room_may(const struct room *room, const struct identity *who, const char *member, enum wire_right right,
              bool is_act, struct problem *problem)
{
    if (who_is_machine(who))
        return is_act ? room_act_may(room, member, right, problem) : room_call_may(room, member, right, problem);
    const struct room_caller caller = room_caller_of(room, who, member);
    const struct member as = { .role = caller.role, .is_guest = caller.is_guest };
    if (!caller.is_here) /* in the words of a room that is not there */
        return problem_set(problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", room->id);
    if (!member_check(&as, right, problem))
        return false;
    const bool is_free = is_act || right != WIRE_RIGHT_SCENE || member_presents(room, room_caller(room, member)) ||
                         (!caller.is_member && role_has_right(caller.role, WIRE_RIGHT_CONTROL));
    return is_free || refuse_not_presenter(room, problem, "change the scene");
}

void room_rename(struct room *room, const char *name, const struct identity *who, const char *member,
                 const char *address, int64_t now_us)
{
    room_enter(room, now_us);
    name_set(room, name, who, room_caller(room, member), address);
    room_leave(room);
}

cJSON *room_people(const struct room *room)
{
    return admission_document(room);
}

bool room_people_patch(struct room *room, const cJSON *patch, const struct identity *who, const char *member,
                       const char *address, int64_t now_us, struct problem *problem)
{
    const struct room_caller caller = room_caller_of(room, who, member);
    room_enter(room, now_us);
    const bool is_done = admission_patch(room, patch, caller.role, problem);
    const struct audit_act act = { .by = room_caller(room, member),
                                   .action = "people",
                                   .address = address,
                                   .detail = is_done ? admission_document(room) : NULL,
                                   .before = -1,
                                   .after = -1 };
    if (is_done)
        audit_tell(room, &act);
    room_leave(room);
    return is_done;
}

bool room_is_listed_to(const struct room *room, const struct identity *who)
{
    struct store_room kept = { .people = NULL };
    enum wire_member_role role;
    admission_facts(room, &kept);
    bool is_listed = admission_role(room, who, &role);
    if (!is_listed && admission_write(room, &kept)) /* else by a link alone */
        is_listed = room_people_name("", kept.people, who, false);
    free(kept.people);
    return is_listed;
}

bool room_call_may(const struct room *room, const char *member, enum wire_right right, struct problem *problem)
{
    const struct member *caller = room_caller(room, member);
    if (caller && right == WIRE_RIGHT_SCENE && member_has_right(caller, right) && !member_presents(room, caller))
        return refuse_not_presenter(room, problem, "change the scene");
    return room_act_may(room, member, right, problem);
}

bool room_act_may(const struct room *room, const char *member, enum wire_right right, struct problem *problem)
{
    const struct member *caller = room_caller(room, member);
    if (caller)
        return member_check(caller, right, problem);
    if (member)
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "member",
                           "Beamroom-Member names no member of this room, or not with its secret");
    if (links_were_made(room) && (right == WIRE_RIGHT_SCENE || !role_has_right(WIRE_MEMBER_ROLE_REVIEWER, right)))
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "role",
                           "this room has links, so only its members may do this: send Beamroom-Member");
    return true;
}

static cJSON *read_lines(const char *lines)
{
    cJSON *list = cJSON_CreateArray();
    for (size_t n; (n = strcspn(lines, "\n")) > 0; lines += n + (lines[n] == '\n')) {
        char line[STORE_PERSON];
        (void)snprintf(line, sizeof line, "%.*s", (int)(n < sizeof line ? n : sizeof line - 1), lines);
        json_append(list, cJSON_CreateString(line));
    }
    return list;
}

static cJSON *make_document(const struct room_facts *facts, bool is_asleep, cJSON *members)
{
    char created[32];
    struct tm utc;
    time_t seconds = (time_t)facts->created_at_s;
    gmtime_r(&seconds, &utc);
    (void)strftime(created, sizeof created, "%Y-%m-%dT%H:%M:%SZ", &utc);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", facts->id);
    cJSON_AddStringToObject(json, "name", facts->name);
    cJSON_AddStringToObject(json, "plan", facts->plan_id);
    cJSON_AddNumberToObject(json, "revision", facts->revision);
    cJSON_AddStringToObject(json, "renderer", wire_renderer_state_words.words[facts->renderer]);
    cJSON_AddStringToObject(json, "created_at", created);
    cJSON_AddBoolToObject(json, "asleep", is_asleep);
    cJSON_AddNumberToObject(json, "n_notes", (double)facts->n_notes);
    json_add(json, "were_in", read_lines(facts->names));
    json_add(json, "members", members);
    return json;
}

cJSON *room_control(const struct room *room)
{
    return control_document(room);
}

cJSON *room_links(struct room *room, int64_t now_us)
{
    room_enter(room, now_us);
    cJSON *list = links_list(room);
    room_leave(room);
    return list;
}

bool room_link_revoke_all(struct room *room, const char *id, const char *by, const char *address, int64_t now_us)
{
    room_enter(room, now_us);
    const bool was_there = link_revoke(room, id, room_caller(room, by), address);
    if (was_there)
        members_remove_of_link(room, id, room_caller(room, by));
    room_leave(room);
    return was_there;
}

bool room_link_revoke(struct room *room, const char *id, const char *by, const char *address, int64_t now_us)
{
    room_enter(room, now_us);
    const bool was_there = link_revoke(room, id, room_caller(room, by), address);
    room_leave(room);
    return was_there;
}

cJSON *room_document(const struct room *room)
{
    char names[ROOM_NAMES_BYTES];
    room_names_in(room, names);
    const struct room_facts facts = { .id = room->id,
                                      .plan_id = room->plan_id,
                                      .name = room->name,
                                      .names = names,
                                      .revision = room->shared.revision,
                                      .renderer = room->renderer.state,
                                      .created_at_s = room->created_at_s,
                                      .n_notes = room_n_notes(room) };
    return make_document(&facts, false, room_members(room));
}

cJSON *room_document_of(const struct room_facts *facts)
{
    return make_document(facts, true, cJSON_CreateArray());
}

void room_audit_flush(struct room *room, int64_t now_us)
{
    room_enter(room, now_us);
    audit_flush(room, NULL);
}

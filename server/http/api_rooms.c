/* Rooms: creating and deleting them, their documents, the shared scene with its ETag, snapshots. */
#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_pictures.h"
#include "server/http/api_queries.h"
#include "server/http/api_recordings.h"
#include "server/http/etag.h"
#include "server/net/listed.h"
#include "server/room/state/body_check.h"

enum { MAX_ASLEEP = 100 }; /* rooms that sleep, in the list of rooms */

void api_rooms(struct api *api, struct call *call)
{
    cJSON *answer = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(answer, "rooms");
    struct net_listed row;
    size_t n_asleep = 0;
    for (size_t i = 0; i < net_n_listed(api->net); i++)
        if (net_listed_at(api->net, i, &call->identity, &row) && (i < net_n_rooms(api->net) || n_asleep++ < MAX_ASLEEP))
            json_append(list, net_listed_document(api->net, i, &row));
    cJSON_AddNumberToObject(answer, "n_asleep", (double)n_asleep);
    call_answer_json(call, 200, answer);
}

/* The bookmark under this token and its plan's id, borrowed from it. NULL with problem. */
static cJSON *find_bookmark(struct api *api, const struct call *call, const cJSON *token, const char **plan_id,
                            struct problem *problem)
{
    if (!cJSON_IsString(token) || !id_is_valid(token->valuestring)) {
        problem_set(problem, PROBLEM_VALIDATION, "/saved", "pattern", "\"saved\" must be the token of a bookmark");
        return NULL;
    }
    cJSON *bookmark = api_bookmark_of_token(api, token->valuestring);
    *plan_id = json_text(bookmark, "plan");
    if (bookmark && !api_access_to_plan(api, call, ACCESS_MEET, *plan_id)) {
        cJSON_Delete(bookmark);
        bookmark = NULL;
        *plan_id = NULL;
    }
    if (!bookmark)
        problem_set(problem, PROBLEM_NOT_FOUND, "/saved", "",
                    "nothing is saved under this link: the bookmark was deleted, or the link is not complete");
    return bookmark;
}

/* The room with what it began with, where it was made from a bookmark. */
static cJSON *document_of(const struct room *room)
{
    cJSON *document = room_document(room);
    json_add(document, "saved", room_beginning(room));
    if (room_replays(room))
        cJSON_AddTrueToObject(document, "replay");
    return document;
}

static void answer_new(struct call *call, struct room *room)
{
    if (call->identity.user[0])
        room_set_owner(room, call->identity.user);
    char location[96];
    (void)snprintf(location, sizeof location, "/api/v1/rooms/%s", room_id(room));
    call_add_header(call, "Location", location);
    call_answer_json(call, 201, document_of(room));
}

/* The body has a recording. Takes body. */
static void new_replay(struct api *api, struct call *call, cJSON *body)
{
    struct problem problem = { 0 };
    const cJSON *asked = cJSON_GetObjectItemCaseSensitive(body, "recording"), *item;
    cJSON_ArrayForEach(item, body) if (strcmp(item->string, "plan") != 0 && strcmp(item->string, "recording") != 0)
        problem_set(&problem, PROBLEM_VALIDATION, "/recording", "unknown-field",
                    "%.60s is not a field of a room that plays a recording", item->string);
    if (problem.type == PROBLEM_NONE && api_recording_sleeps(api, call, asked, api_room_new)) {
        cJSON_Delete(body);
        return;
    }
    const bool may = problem.type == PROBLEM_NONE && net_may_own_more(api->net, call->identity.user, &problem);
    struct room *room = may ? api_replay_new(api, call, asked, json_text(body, "plan"), &problem) : NULL;
    cJSON_Delete(body);
    if (room)
        answer_new(call, room);
    else
        call_answer_problem(call, &problem);
}

void api_room_new(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/json", NULL };
    struct problem problem = { 0 };
    cJSON *body;
    if (!call_read_object(call, media_types, &body))
        return;
    if (cJSON_GetObjectItemCaseSensitive(body, "recording")) {
        new_replay(api, call, body);
        return;
    }
    const cJSON *plan = cJSON_GetObjectItemCaseSensitive(body, "plan"),
                *token = cJSON_GetObjectItemCaseSensitive(body, "saved");
    const cJSON *item;
    cJSON *bookmark = NULL;
    const char *plan_id = cJSON_GetStringValue(plan);
    cJSON_ArrayForEach(item, body)
    {
        char pointer[64];
        (void)snprintf(pointer, sizeof pointer, "/%.60s", item->string);
        if (strcmp(item->string, "plan") != 0 && strcmp(item->string, "saved") != 0)
            problem_set(&problem, PROBLEM_VALIDATION, pointer, "unknown-field", "%.60s is not a field of a room",
                        item->string);
    }
    if (!plan == !token)
        problem_set(&problem, PROBLEM_VALIDATION, "/plan", "required",
                    "which plan? give either \"plan\", or \"saved\", the token of a bookmark");
    else if (plan && (!plan_id || !id_is_valid(plan_id)))
        problem_set(&problem, PROBLEM_VALIDATION, "/plan", "pattern", "\"plan\" must be the id of a plan");
    else if (token && problem.type == PROBLEM_NONE)
        bookmark = find_bookmark(api, call, token, &plan_id, &problem);
    if (problem.type == PROBLEM_NOT_FOUND && net_rooms_are_known(api->net, &problem) &&
        api_bookmark_sleeps(api, call, token->valuestring, api_room_new)) {
        cJSON_Delete(body);
        return;
    }
    bool may = problem.type == PROBLEM_NONE;
    if (may && !api_access_makes_room(api, call, plan_id, &problem))
        may = call->identity.source == IDENTITY_MACHINE; /* net_room_create says it, after what else there is to say */
    if (problem.type == PROBLEM_NOT_FOUND && plan_id && api_lists_first(api, call, api_room_new)) {
        cJSON_Delete(bookmark);
        cJSON_Delete(body);
        return;
    }
    may = may && net_may_own_more(api->net, call->identity.user, &problem);
    struct room *room = may ? net_room_create(api->net, plan_id, bookmark, &problem) : NULL;
    cJSON_Delete(bookmark);
    cJSON_Delete(body);
    if (!room) {
        call_answer_problem(call, &problem);
        return;
    }
    answer_new(call, room);
}

void api_room(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    if (room)
        call_answer_json(call, 200, document_of(room));
}

/* The name that is asked for, borrowed from the body; "": none, as of a new room. */
static bool read_name(const cJSON *body, const char **name, struct problem *problem)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(body, "name"), *other;
    cJSON_ArrayForEach(other, body)
    {
        if (other != item)
            return problem_set(problem, PROBLEM_VALIDATION, "/", "unknown-field", "%.60s is not a field of a room",
                               other->string);
    }
    *name = "";
    if (!item)
        return problem_set(problem, PROBLEM_VALIDATION, "/name", "required", "which name? \"name\" is missing");
    if (cJSON_IsNull(item))
        return true;
    if (!body_check_text(item, "/name", ROOM_NAME_LETTERS, problem))
        return false;
    *name = item->valuestring;
    return strpbrk(*name, "\r\n\t") == NULL ||
           problem_set(problem, PROBLEM_VALIDATION, "/name", "pattern", "the name of a room is one line");
}

void api_room_patch(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/merge-patch+json", "application/json", NULL };
    struct problem problem = { 0 };
    struct room *room = api_find_room(api, call);
    const char *name;
    cJSON *body;
    if (!room || !call_read_object(call, media_types, &body))
        return;
    const bool ok = read_name(body, &name, &problem) && net_can_write(api->net, &problem);
    if (ok)
        room_rename(room, name, &call->identity, call->member, call->client, clock_now_us());
    cJSON_Delete(body);
    if (ok)
        call_answer_json(call, 200, document_of(room));
    else
        call_answer_problem(call, &problem);
}

void api_room_delete(struct api *api, struct call *call)
{
    if (!net_room_is_asleep(api->net, call->ids[0]) && !api_find_room(api, call))
        return;
    struct room *room = net_room_find(api->net, call->ids[0]);
    char reason[200] = "the room was deleted";
    if (!api_may_delete(call, net_n_decided(api->net, call->ids[0]), "this room"))
        return;
    if (room && room_caller_name(room, call->member)[0])
        (void)snprintf(reason, sizeof reason, "the room was ended by %.160s", room_caller_name(room, call->member));
    if (room)
        room_audit_call(room, &call->identity, call->member, call->client, "deleted", NULL, false, clock_now_us());
    else
        net_audit_by(api->net, &call->identity, call->client, call->ids[0], "", "deleted", NULL);
    net_room_delete(api->net, call->ids[0], reason);
    call_answer_nothing(call, 204);
}

void api_room_members(struct api *api, struct call *call)
{
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    cJSON *answer = cJSON_CreateObject();
    cJSON_AddItemToObject(answer, "members", room_members(room));
    call_answer_json(call, 200, answer);
}

static void answer_items(struct api *api, struct call *call, enum wire_item_kind kind, const char *name)
{
    struct room *room = api_find_room(api, call);
    if (!room)
        return;
    cJSON *answer = cJSON_CreateObject();
    json_add(answer, name, room_items(room, kind));
    call_answer_json(call, 200, answer);
}

void api_room_notes(struct api *api, struct call *call)
{
    answer_items(api, call, WIRE_ITEM_KIND_NOTE, "notes");
}

void api_room_bookmarks(struct api *api, struct call *call)
{
    answer_items(api, call, WIRE_ITEM_KIND_BOOKMARK, "bookmarks");
}

void api_room_acceptances(struct api *api, struct call *call)
{
    answer_items(api, call, WIRE_ITEM_KIND_ACCEPTANCE, "acceptances");
}

void api_room_control(struct api *api, struct call *call)
{
    const struct room *room = api_find_room(api, call);
    if (room)
        call_answer_json(call, 200, room_control(room));
}

static void write_etag(char etag[24], uint32_t revision)
{
    (void)snprintf(etag, 24, "\"%u\"", revision);
}

/* The scene of the call's room; NULL: the call was answered. */
static const cJSON *find_scene(struct api *api, struct call *call, struct room **room, uint32_t *revision)
{
    *room = api_find_room(api, call);
    if (!*room)
        return NULL;
    const cJSON *scene = room_scene(*room, revision);
    if (!scene) {
        struct problem problem;
        /* a room that was woken for this call: nobody is in it who would have opened the plan */
        if (fleet_open(net_fleet(api->net), room_plan_id(*room), &problem)) {
            problem_set(&problem, PROBLEM_BUSY, "", "", "the plan of this room is not loaded yet");
            problem.retry_after_ms = 500;
        }
        call_answer_problem(call, &problem);
    }
    return scene;
}

void api_room_scene(struct api *api, struct call *call)
{
    struct room *room;
    uint32_t revision;
    const cJSON *scene = find_scene(api, call, &room, &revision);
    if (!scene)
        return;
    char etag[24];
    write_etag(etag, revision);
    call_add_header(call, "ETag", etag);
    if (call->if_none_match && etag_is_listed(call->if_none_match, etag, true))
        call_answer_nothing(call, 304);
    else
        call_answer_json(call, 200, cJSON_Duplicate(scene, true));
}

void api_room_scene_patch(struct api *api, struct call *call)
{
    static const char *const media_types[] = { "application/merge-patch+json", "application/json", NULL };
    struct problem problem;
    struct room *room;
    uint32_t revision;
    cJSON *patch;
    char etag[24];
    if (!find_scene(api, call, &room, &revision))
        return;
    write_etag(etag, revision);
    if (!call->if_match) {
        problem_set(&problem, PROBLEM_REVISION_NEEDED, "", "",
                    "send If-Match with the ETag of the scene you changed; it is %s now", etag);
        call_answer_problem(call, &problem);
        return;
    }
    if (!etag_is_listed(call->if_match, etag, false)) {
        call_add_header(call, "ETag", etag);
        problem_set(&problem, PROBLEM_STALE_REVISION, "", "",
                    "the scene is at %s now, If-Match says %.40s; get it and try again", etag, call->if_match);
        call_answer_problem(call, &problem);
        return;
    }
    if (!call_read_object(call, media_types, &patch))
        return;
    bool ok = room_patch_scene(room, patch, call->member, call->client, clock_now_us(), &problem);
    cJSON_Delete(patch);
    if (!ok) {
        call_answer_problem(call, &problem);
        return;
    }
    const cJSON *scene = room_scene(room, &revision);
    write_etag(etag, revision);
    call_add_header(call, "ETag", etag);
    call_answer_json(call, 200, cJSON_Duplicate(scene, true));
}

static void snapshot_when_ready(void *context, struct packet *answer, const struct problem *not_ready)
{
    struct call *call = context;
    (void)answer;
    if (not_ready)
        call_answer_problem(call, not_ready);
    else
        api_room_snapshot(call->api, call);
}

static bool query_flag(const struct call *call, const char *name, bool *flag, struct problem *problem)
{
    const char *word = call_query(call, name);
    char where[32];
    *flag = word && strcmp(word, "true") == 0;
    (void)snprintf(where, sizeof where, "/%s", name);
    return !word || *flag || strcmp(word, "false") == 0 ||
           problem_set(problem, PROBLEM_VALIDATION, where, "type", "%s is \"%.20s\", expected true or false", name,
                       word);
}

/* False with problem: the call is wrong, or has no right to the patient's name. */
static bool read_marking(const struct api *api, const struct call *call, const struct room *room,
                         struct api_marking *marking, struct problem *problem)
{
    if (!query_flag(call, "annotations", &marking->has_caption, problem) ||
        !query_flag(call, "identity", &marking->is_named, problem) ||
        !query_flag(call, "crosshair", &marking->has_crosshair, problem))
        return false;
    if (marking->has_crosshair && !marking->has_caption)
        return problem_set(problem, PROBLEM_VALIDATION, "/crosshair", "annotations",
                           "the crosshair belongs to letters and caption: annotations has to be true");
    if (marking->is_named && !marking->has_caption)
        return problem_set(problem, PROBLEM_VALIDATION, "/identity", "annotations",
                           "the patient is named in the caption: annotations has to be true");
    return !marking->is_named || api_may_name(api, call, room_plan_id(room), problem);
}

void api_room_snapshot(struct api *api, struct call *call)
{
    struct problem problem;
    struct room *room;
    uint32_t revision;
    const cJSON *scene = find_scene(api, call, &room, &revision);
    if (!scene)
        return;
    double quality = 92;
    if (!call_query_number(call, "quality", false, &quality, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct api_marking marking;
    if (!read_marking(api, call, room, &marking, &problem)) {
        call_answer_problem(call, &problem);
        return;
    }
    struct fleet_plan plan;
    const char *plan_id = room_plan_id(room);
    if (!fleet_plan_find(net_fleet(api->net), plan_id, &plan)) {
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "the plan of this room is gone");
        call_answer_problem(call, &problem);
        return;
    }
    if (!plan.default_scene) { /* the plan was closed while nobody was in the room: it is loaded for this picture */
        api_when_ready(api, call, plan_id, snapshot_when_ready);
        return;
    }
    cJSON *view = api_view_parameter(call);
    if (!view)
        return;
    if (!api_audit_export(api, call, marking.is_named ? "snapshot-named" : "snapshot")) {
        cJSON_Delete(view);
        return;
    }
    cJSON *shown = room_scene_for_view(room, view, &problem);
    if (shown) {
        api_picture_request(api, call, plan_id, shown, room_acceptances(room), &revision, view,
                            call_query(call, "format"), quality, marking, NULL);
    } else {
        problem_below(&problem, "/view");
        call_answer_problem(call, &problem);
    }
    cJSON_Delete(shown);
    cJSON_Delete(view);
}

void api_room_ws(struct api *api, struct call *call)
{
    (void)api;
    struct problem problem;
    problem_set(
        &problem, PROBLEM_UPGRADE, "", "",
        "the WebSocket is opened by GET with Upgrade: websocket, sent when the requests before it were answered");
    call_add_header(call, "Upgrade", "websocket");
    call_add_header(call, "Connection", "close");
    call_answer_problem(call, &problem);
}

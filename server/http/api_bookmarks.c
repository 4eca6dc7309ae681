/* Bookmarks of rooms: what one shows, its picture, and the permalink that leads to it. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/http/api_access.h"
#include "server/http/api_handlers.h"
#include "server/http/api_pictures.h"
#include "server/wire/bookmark.h"

enum { PICTURE_WIDTH_PX = 240, PICTURE_HEIGHT_PX = 150, PICTURE_QUALITY = 80 };

/* The room and the bookmark that the call's address names; the body is the caller's. NULL: the call was answered. */
static cJSON *find_bookmark(struct api *api, struct call *call, struct room **room, uint32_t *version)
{
    struct problem problem;
    *room = net_room_find(api->net, call->ids[0]);
    cJSON *body = *room ? room_bookmark(*room, call->ids[1], version) : NULL;
    if (!*room)
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "there is no room \"%.63s\"", call->ids[0]);
    else if (!body)
        problem_set(&problem, PROBLEM_NOT_FOUND, "", "", "the room has no bookmark \"%.63s\"", call->ids[1]);
    if (!body)
        call_answer_problem(call, &problem);
    return body;
}

void api_room_bookmark(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct room *room;
    uint32_t version;
    cJSON *body = find_bookmark(api, call, &room, &version);
    if (!body)
        return;
    cJSON *opened = room_bookmark_open(room, body, &problem);
    cJSON_Delete(body);
    if (!opened) {
        call_answer_problem(call, &problem);
        return;
    }
    cJSON_AddStringToObject(opened, "id", call->ids[1]);
    cJSON_AddNumberToObject(opened, "item_version", version);
    call_answer_json(call, 200, opened);
}

/* The view that was active when the bookmark was saved, else the first, else 3-D; in the size of the list's pictures.
 * NULL: no memory. */
static cJSON *pictured(const cJSON *opened, struct problem *problem)
{
    const cJSON *views = cJSON_GetObjectItemCaseSensitive(opened, "views"), *entry,
                *chosen = cJSON_GetArrayItem(views, 0);
    double active = json_number(cJSON_GetObjectItemCaseSensitive(opened, "layout"), "active", 0);
    cJSON_ArrayForEach(entry, views)
    {
        if (json_number(entry, "view", 0) == active)
            chosen = entry;
    }
    cJSON *size = cJSON_CreateObject(), *list = cJSON_AddArrayToObject(size, "size_px");
    json_append(list, cJSON_CreateNumber(PICTURE_WIDTH_PX));
    json_append(list, cJSON_CreateNumber(PICTURE_HEIGHT_PX));
    cJSON *view = view_document_patch(cJSON_GetObjectItemCaseSensitive(chosen, "document"), size, problem);
    cJSON_Delete(size);
    return view;
}

void api_room_bookmark_picture(struct api *api, struct call *call)
{
    struct problem problem = { 0 };
    struct fleet_plan plan;
    struct room *room;
    uint32_t version;
    char shared_as[API_SHARED_AS_SIZE];
    cJSON *body = find_bookmark(api, call, &room, &version);
    if (!body)
        return;
    cJSON *opened = NULL, *view = NULL;
    if (!fleet_plan_find(net_fleet(api->net), room_plan_id(room), &plan) || plan.state != FLEET_READY) {
        problem_set(&problem, PROBLEM_BUSY, "", "", "the plan is not loaded, and no picture of a bookmark loads it");
        problem.retry_after_ms = 2000;
    } else {
        opened = room_bookmark_open(room, body, &problem);
        view = opened ? pictured(opened, &problem) : NULL;
    }
    (void)snprintf(shared_as, sizeof shared_as, "bookmark %.63s %.63s %u", call->ids[0], call->ids[1], version);
    if (view)
        api_picture_request(api, call, room_plan_id(room), cJSON_GetObjectItemCaseSensitive(opened, "scene"), NULL,
                            NULL, view, "jpeg", PICTURE_QUALITY, (struct api_marking){ .has_caption = false },
                            shared_as);
    else
        call_answer_problem(call, &problem);
    cJSON_Delete(view);
    cJSON_Delete(opened);
    cJSON_Delete(body);
}

cJSON *api_bookmark_of_token(struct api *api, const char *token)
{
    cJSON *body = NULL;
    for (size_t i = 0; !body && i < net_n_rooms(api->net); i++)
        body = room_bookmark_of_token(net_room_at(api->net, i), token);
    return body;
}

struct bookmark_search {
    struct call *call;
    void (*handle)(struct api *api, struct call *call);
};

/* The room of the bookmark was looked for on the disk: it is awake, or there is none. */
static void bookmark_awoke(void *context, const char *token, const struct problem *problem)
{
    struct bookmark_search search = *(struct bookmark_search *)context;
    (void)token;
    free(context);
    search.call->context = search.call; /* looked for already */
    if (problem && problem->type != PROBLEM_NOT_FOUND)
        call_answer_problem(search.call, problem);
    else
        search.handle(search.call->api, search.call);
}

bool api_bookmark_sleeps(struct api *api, struct call *call, const char *token,
                         void (*handle)(struct api *api, struct call *call))
{
    if (call->context || !net_n_asleep(api->net) || strlen(token) != BOOKMARK_TOKEN_CHARS)
        return false;
    struct bookmark_search *search = mem_new(sizeof *search);
    *search = (struct bookmark_search){ call, handle };
    net_bookmark_wake(api->net, token, bookmark_awoke, search);
    return true;
}

void api_permalink(struct api *api, struct call *call)
{
    static const char nothing[] =
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\">"
        "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
        "<meta name=\"color-scheme\" content=\"dark\"><title>Nothing here – Beamroom</title></head><body><main>"
        "<h1>Nothing is saved under this link</h1><p>The saved view was deleted, or the link is not complete. Who sent "
        "it can make a new one.</p><p><a href=\"../\">All plans on this server</a></p></main></body></html>\n";
    char location[96];
    cJSON *body = api_bookmark_of_token(api, call->ids[0]);
    if (!body && api_bookmark_sleeps(api, call, call->ids[0], api_permalink))
        return;
    if (!body || !api_access_to_plan(api, call, ACCESS_LOOK, json_text(body, "plan"))) {
        cJSON_Delete(body);
        call_answer_text(call, 404, "text/html; charset=utf-8", nothing);
        return;
    }
    cJSON_Delete(body);
    (void)snprintf(location, sizeof location, "/#/p/%s", call->ids[0]);
    call_add_header(call, "Location", location);
    call_answer_nothing(call, 303);
}

/* Completes bookmarks: bookmark_body.h. */
#include "server/room/items/bookmark_body.h"

#include <string.h>

#include "server/wire/document.h"

cJSON *bookmark_body_of(const struct item *item)
{
    cJSON *row = json_read(item->row, strlen(item->row), NULL);
    cJSON *body = cJSON_DetachItemFromObjectCaseSensitive(row, "body");
    cJSON_Delete(row);
    return body;
}

static bool refuse(struct problem *problem, const char *pointer, const char *code, const char *sentence)
{
    return problem_set(problem, PROBLEM_VALIDATION, pointer, code, "%s", sentence);
}

/* The token of the bookmark as it was before, else a new one. */
static bool give_token(const struct item *before, cJSON *read, struct problem *problem)
{
    char token[BOOKMARK_TOKEN_CHARS + 1] = "";
    cJSON *body = before ? bookmark_body_of(before) : NULL;
    const char *kept = json_text(body, "token"), *given = json_text(read, "token");
    bool has_one = cJSON_HasObjectItem(read, "token"), is_right = !has_one || (kept && given && !strcmp(kept, given));
    if (kept && strlen(kept) == BOOKMARK_TOKEN_CHARS)
        memcpy(token, kept, sizeof token);
    cJSON_Delete(body);
    if (!is_right)
        return refuse(problem, "/token", "enum", "a token is given by the room, and stays");
    if (!token[0] && !bookmark_make_token(token))
        return problem_set(problem, PROBLEM_INTERNAL, "", "", "the system gave no random numbers");
    cJSON_DeleteItemFromObjectCaseSensitive(read, "token");
    cJSON_AddStringToObject(read, "token", token);
    return true;
}

/* Adds the fields that a page may leave out of a new bookmark. */
static void give_form(cJSON *read)
{
    if (!cJSON_HasObjectItem(read, "format"))
        cJSON_AddStringToObject(read, "format", BOOKMARK_FORMAT);
    if (!cJSON_HasObjectItem(read, "version"))
        cJSON_AddNumberToObject(read, "version", BOOKMARK_VERSION);
    if (!cJSON_HasObjectItem(read, "views"))
        json_add(read, "views", cJSON_CreateArray());
}

static bool give_plan(const struct room *room, cJSON *read, struct problem *problem)
{
    const char *plan = json_text(read, "plan");
    if (!cJSON_HasObjectItem(read, "plan"))
        cJSON_AddStringToObject(read, "plan", room->plan_id);
    else if (!plan || strcmp(plan, room->plan_id) != 0)
        return problem_set(problem, PROBLEM_VALIDATION, "/plan", "enum", "plan must be \"%s\", the room's",
                           room->plan_id);
    return true;
}

/* The room's scene as a patch on the plan's own, where the page gave none. */
static bool give_scene(const struct room *room, cJSON *read, struct problem *problem)
{
    cJSON *override = cJSON_DetachItemFromObjectCaseSensitive(read, "override");
    bool is_given = cJSON_IsObject(cJSON_GetObjectItemCaseSensitive(read, "scene")), ok = false;
    cJSON *shown = NULL, *patch = NULL;
    if (is_given) {
        ok = !override || refuse(problem, "/override", "unknown-field", "override goes with a bookmark without scene");
    } else if (override && !cJSON_IsObject(override)) {
        (void)refuse(problem, "/override", "type", "override must be a merge patch on the scene");
    } else if (!room->shared.scene) {
        problem_set(problem, PROBLEM_BUSY, "", "", "the plan is not loaded yet");
        problem->retry_after_ms = 500;
    } else {
        if (override) {
            shown =
                scene_document_patch(room->shared.plan, room->shared.defaults, room->shared.scene, override, problem);
            if (!shown)
                problem_below(problem, "/override");
        }
        if (!override || shown)
            patch = bookmark_difference(room->shared.defaults, shown ? shown : room->shared.scene);
        if (patch) {
            cJSON_DeleteItemFromObjectCaseSensitive(read, "scene");
            json_add(read, "scene", patch);
            ok = true;
        } else if (!override || shown) {
            json_no_memory(problem, "a bookmark");
        }
    }
    cJSON_Delete(shown);
    cJSON_Delete(override);
    return ok;
}

cJSON *bookmark_body_read(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                          struct problem *problem)
{
    cJSON *read = cJSON_Duplicate(body, true);
    bool ok = read || json_no_memory(problem, "a bookmark");
    if (ok && !is_restored && !before)
        give_form(read);
    if (ok && !is_restored)
        ok = give_plan(room, read, problem) && give_token(before, read, problem) && give_scene(room, read, problem);
    if (ok && bookmark_check(read, problem))
        return read;
    cJSON_Delete(read);
    if (problem->type == PROBLEM_VALIDATION || problem->type == PROBLEM_TOO_LARGE)
        problem_below(problem, "/body");
    return NULL;
}

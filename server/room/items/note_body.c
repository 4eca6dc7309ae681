/* Checks the body of a note field by field: note_body.h. */
#include "server/room/items/note_body.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/room/items/item_list.h"
#include "server/room/state/body_check.h"

static bool plan_has_region(const cJSON *plan, const char *id)
{
    const cJSON *region, *regions = cJSON_GetObjectItemCaseSensitive(plan, "regions");
    cJSON_ArrayForEach(region, regions)
    {
        const char *found = json_text(region, "id");
        if (found && strcmp(found, id) == 0)
            return true;
    }
    return false;
}

static cJSON *read_point(const cJSON *point, struct problem *problem)
{
    static const char where[] = "/body/anchor/point_mm";
    if (!cJSON_IsArray(point) || cJSON_GetArraySize(point) != 3) {
        (void)body_refuse_type(problem, where, "a list of three numbers");
        return NULL;
    }
    double at_lps_mm[3];
    for (int k = 0; k < 3; k++) {
        const cJSON *value = cJSON_GetArrayItem(point, k);
        if (!cJSON_IsNumber(value)) {
            (void)body_refuse_type(problem, where, "a list of three numbers");
            return NULL;
        }
        at_lps_mm[k] = value->valuedouble;
        if (!isfinite(at_lps_mm[k]) || fabs(at_lps_mm[k]) > NOTE_MAX_MM) {
            problem_set(problem, PROBLEM_VALIDATION, where, "range", "%s has %g mm, expected %d to %d", where,
                        at_lps_mm[k], -NOTE_MAX_MM, NOTE_MAX_MM);
            return NULL;
        }
    }
    return cJSON_CreateDoubleArray(at_lps_mm, 3);
}

/* anchor NULL or null gives null: the note is about the plan as a whole. NULL with problem. */
static cJSON *read_anchor(const cJSON *anchor, const cJSON *plan, struct problem *problem)
{
    static const char *const names[] = { "point_mm", "region", NULL };
    static const char where_region[] = "/body/anchor/region";
    if (!anchor || cJSON_IsNull(anchor))
        return cJSON_CreateNull();
    if (!cJSON_IsObject(anchor)) {
        (void)body_refuse_type(problem, "/body/anchor", "an object");
        return NULL;
    }
    if (!body_names_are(anchor, names, "/body/anchor", problem))
        return NULL;
    const cJSON *point = cJSON_GetObjectItemCaseSensitive(anchor, "point_mm");
    const cJSON *region = cJSON_GetObjectItemCaseSensitive(anchor, "region");
    if (!point && !region) {
        problem_set(problem, PROBLEM_VALIDATION, "/body/anchor", "required",
                    "/body/anchor has neither point_mm nor region");
        return NULL;
    }
    if (region && !body_check_id(region, where_region, problem))
        return NULL;
    if (region && plan && !plan_has_region(plan, region->valuestring)) {
        problem_set(problem, PROBLEM_VALIDATION, where_region, "unknown-id", "the plan has no region \"%.63s\"",
                    region->valuestring);
        return NULL;
    }
    cJSON *read = cJSON_CreateObject(), *place = point ? read_point(point, problem) : NULL;
    if (point && !place) {
        cJSON_Delete(read);
        return NULL;
    }
    json_add(read, "point_mm", place);
    if (region)
        cJSON_AddStringToObject(read, "region", region->valuestring);
    return read;
}

static cJSON *read_mentions(const cJSON *mentions, struct problem *problem)
{
    static const char *const names[] = { "member", "name", NULL };
    static const char where[] = "/body/mentions";
    cJSON *read = cJSON_CreateArray();
    if (!mentions)
        return read;
    bool is_read = cJSON_IsArray(mentions) || body_refuse_type(problem, where, "a list");
    const int n = cJSON_GetArraySize(mentions);
    if (is_read && n > NOTE_MAX_MENTIONS)
        is_read = problem_set(problem, PROBLEM_VALIDATION, where, "count", "%s has %d entries, at most %d are allowed",
                              where, n, NOTE_MAX_MENTIONS);
    int at = 0;
    for (const cJSON *mention = mentions->child; is_read && mention; mention = mention->next, at++) {
        char pointer[64], of_member[80], of_name[80];
        (void)snprintf(pointer, sizeof pointer, "%s/%d", where, at);
        (void)snprintf(of_member, sizeof of_member, "%s/member", pointer);
        (void)snprintf(of_name, sizeof of_name, "%s/name", pointer);
        const cJSON *member = cJSON_GetObjectItemCaseSensitive(mention, "member");
        const cJSON *name = cJSON_GetObjectItemCaseSensitive(mention, "name");
        is_read = (cJSON_IsObject(mention) || body_refuse_type(problem, pointer, "an object")) &&
                  body_names_are(mention, names, pointer, problem) && body_check_id(member, of_member, problem) &&
                  body_check_text(name, of_name, NOTE_MAX_NAME, problem);
        if (!is_read)
            break;
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddStringToObject(entry, "member", member->valuestring);
        cJSON_AddStringToObject(entry, "name", name->valuestring);
        json_append(read, entry);
    }
    if (is_read)
        return read;
    cJSON_Delete(read);
    return NULL;
}

static bool check_parent(const struct room *room, const cJSON *parent, const struct item *before, bool is_restored,
                         struct problem *problem)
{
    static const char where[] = "/body/parent";
    const char *id = cJSON_IsString(parent) ? parent->valuestring : "";
    if (parent && !cJSON_IsString(parent))
        return body_refuse_type(problem, where, "an id");
    if (id[0] && !body_check_id(parent, where, problem))
        return false;
    if (before && strcmp(before->parent, id) != 0)
        return problem_set(problem, PROBLEM_VALIDATION, where, "enum",
                           "%s is \"%s\", expected \"%s\" as before: a reply stays with its note", where, id,
                           before->parent);
    if (!id[0] || before || is_restored)
        return true;
    const struct item *note = items_find(room, id);
    if (!note || note->kind != WIRE_ITEM_KIND_NOTE)
        return problem_set(problem, PROBLEM_VALIDATION, where, "unknown-id",
                           "there is no note \"%s\" to reply to; it may have been deleted", id);
    if (note->parent[0])
        return problem_set(problem, PROBLEM_VALIDATION, where, "unknown-id",
                           "\"%s\" is a reply itself; reply to its note, \"%s\"", id, note->parent);
    return true;
}

cJSON *note_body_read(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                      struct problem *problem)
{
    static const char *const names[] = { "text", "anchor", "resolved", "mentions", "parent", NULL };
    const cJSON *text = cJSON_GetObjectItemCaseSensitive(body, "text");
    const cJSON *anchor = cJSON_GetObjectItemCaseSensitive(body, "anchor");
    const cJSON *resolved = cJSON_GetObjectItemCaseSensitive(body, "resolved");
    const cJSON *parent = cJSON_GetObjectItemCaseSensitive(body, "parent");
    if (!body_names_are(body, names, "/body", problem) ||
        !body_check_text(text, "/body/text", NOTE_MAX_TEXT, problem) ||
        !check_parent(room, parent, before, is_restored, problem))
        return NULL;
    const bool is_reply = parent && parent->valuestring[0];
    if (resolved && !cJSON_IsBool(resolved)) {
        (void)body_refuse_type(problem, "/body/resolved", "true or false");
        return NULL;
    }
    if (is_reply && (cJSON_IsTrue(resolved) || (anchor && !cJSON_IsNull(anchor)))) {
        problem_set(problem, PROBLEM_VALIDATION, cJSON_IsTrue(resolved) ? "/body/resolved" : "/body/anchor", "enum",
                    "a reply has the place of its note, and only the note is resolved");
        return NULL;
    }
    cJSON *place = read_anchor(anchor, is_restored ? NULL : room->shared.plan, problem);
    cJSON *mentions = place ? read_mentions(cJSON_GetObjectItemCaseSensitive(body, "mentions"), problem) : NULL;
    if (!mentions) {
        cJSON_Delete(place);
        return NULL;
    }
    cJSON *read = cJSON_CreateObject();
    cJSON_AddStringToObject(read, "text", text->valuestring);
    json_add(read, "anchor", place);
    cJSON_AddBoolToObject(read, "resolved", cJSON_IsTrue(resolved));
    json_add(read, "mentions", mentions);
    cJSON_AddStringToObject(read, "parent", is_reply ? parent->valuestring : "");
    return read;
}

/* Checks which marks of the scene a member changes, and writes their author down. */
#include "server/room/views/marks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/room/state/member_list.h"

static const char *const kinds[] = { "measures", "probes", "constraints" };
enum {
    N_KINDS = sizeof kinds / sizeof kinds[0],
    MAX_NUMBER = 500000 /* an id that ends with a greater one is no reason to count from there */
};

static bool is_kind(const char *name)
{
    for (int i = 0; i < N_KINDS; i++)
        if (strcmp(name, kinds[i]) == 0)
            return true;
    return false;
}

/* True if the id is "SOMETHING-MEMBER". */
static bool is_of(const char *id, const struct member *member)
{
    const size_t n = strlen(id), n_member = strlen(member->id);
    return n > n_member + 1 && id[n - n_member - 1] == '-' && strcmp(id + n - n_member, member->id) == 0;
}

bool marks_are_own(const struct room *room, const struct member *member, const cJSON *patch, struct problem *problem)
{
    const cJSON *kind, *mark;
    if (!cJSON_IsObject(patch) || !patch->child)
        return refuse_not_presenter(room, problem, "change the scene");
    cJSON_ArrayForEach(kind, patch)
    {
        if (!is_kind(kind->string) || !cJSON_IsObject(kind))
            return refuse_not_presenter(room, problem, "change the scene");
        cJSON_ArrayForEach(mark, kind)
        {
            if (is_of(mark->string, member))
                continue;
            char pointer[96];
            (void)snprintf(pointer, sizeof pointer, "/%s/%.63s", kind->string, mark->string);
            return problem_set(problem, PROBLEM_FORBIDDEN, pointer, "author",
                               "only the presenter changes marks of others; the ids of your own end with \"-%s\"",
                               member->id);
        }
    }
    return true;
}

/* The number of the member that an id ends with; 0: it ends with none. */
static uint32_t number_of(const char *id)
{
    const char *end = strrchr(id, '-');
    if (!end || end[1] != 'm' || end[2] < '1' || end[2] > '9' || strlen(end) > 9)
        return 0;
    char *rest;
    const unsigned long number = strtoul(end + 2, &rest, 10);
    return *rest || number > MAX_NUMBER ? 0 : (uint32_t)number;
}

uint32_t marks_next_number(const struct room *room)
{
    const cJSON *scene = room->shared.scene ? room->shared.scene : room->shared.restored, *mark;
    uint32_t greatest = room->members.n_named;
    if (!scene)
        scene = cJSON_GetObjectItemCaseSensitive(room->beginning.bookmark, "scene");
    for (int i = 0; i < N_KINDS; i++)
        cJSON_ArrayForEach(mark, cJSON_GetObjectItemCaseSensitive(scene, kinds[i]))
        {
            const uint32_t number = number_of(mark->string ? mark->string : "");
            greatest = number > greatest ? number : greatest;
        }
    return greatest + 1;
}

/* Writes the member's name into a mark of the patch where it belongs. */
static bool sign(const struct member *member, bool presents, const cJSON *before, cJSON *mark)
{
    if (presents && (before || json_text(mark, "author"))) /* "" is given, too: a mark that nobody has signed */
        return true;
    while (cJSON_HasObjectItem(mark, "author")) /* also one that is there twice */
        cJSON_DeleteItemFromObject(mark, "author");
    return cJSON_AddStringToObject(mark, "author", member->name) != NULL;
}

cJSON *marks_authored(const struct room *room, const struct member *member, const cJSON *patch)
{
    const bool presents = member_presents(room, member);
    cJSON *authored = cJSON_Duplicate(patch, true), *kind, *mark;
    bool is_whole = authored != NULL;
    cJSON_ArrayForEach(kind, authored)
    {
        if (!cJSON_IsObject(authored) || !is_kind(kind->string))
            continue;
        const cJSON *before = cJSON_GetObjectItemCaseSensitive(room->shared.scene, kind->string);
        cJSON_ArrayForEach(mark, kind)
        {
            if (cJSON_IsObject(kind) && cJSON_IsObject(mark))
                is_whole =
                    sign(member, presents, cJSON_GetObjectItemCaseSensitive(before, mark->string), mark) && is_whole;
        }
    }
    if (is_whole)
        return authored;
    cJSON_Delete(authored);
    return NULL;
}

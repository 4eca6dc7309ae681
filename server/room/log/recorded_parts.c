/* Writes and reads the documents of a meeting log. */
#include "server/room/log/recorded_parts.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/items/item_list.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/room_recordings.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"

/* ---- of a room -------------------------------------------------------------------------------------------------- */

cJSON *recorded_members(const struct room *room)
{
    cJSON *entries = cJSON_CreateObject();
    for (int i = 0; i < room->members.n; i++) {
        const struct member *member = room->members.list[i];
        cJSON *entry = cJSON_CreateObject();
        char color[8];
        (void)snprintf(color, sizeof color, "#%06x", color_rgb(member->color) & 0xffffffU);
        cJSON_AddStringToObject(entry, "name", member->name);
        cJSON_AddStringToObject(entry, "color", color);
        cJSON_AddStringToObject(entry, "role", wire_member_role_words.words[member->role]);
        cJSON_AddBoolToObject(entry, "connected", member->connection != NULL);
        cJSON_AddBoolToObject(entry, "following", member_follows(room, member));
        cJSON_AddBoolToObject(entry, "presenting", member_presents(room, member));
        member_say_who(member, entry);
        json_add(entries, member->id, entry);
    }
    return entries;
}

cJSON *recorded_views(const struct room *room)
{
    cJSON *entries = cJSON_CreateObject();
    for (const struct stream *stream = room->streams.first; stream; stream = stream->next) {
        const char *kind = json_text(stream->view, "kind"), *plane = json_text(stream->view, "plane");
        const bool is_oblique = stream->kind == SCENE_KIND_OBLIQUE;
        char id[160];
        if (!stream->is_shared)
            continue;
        (void)snprintf(id, sizeof id, "%.20s-%d%s%.64s", kind ? kind : "3d",
                       (int)json_number(stream->view, "number", 1), is_oblique ? "-" : "",
                       is_oblique && plane ? plane : "");
        cJSON *entry = cJSON_CreateObject();
        json_add(entry, "document", cJSON_Duplicate(stream->view, true));
        cJSON_AddStringToObject(entry, "by", stream->mover);
        json_add(entries, id, entry);
    }
    return entries;
}

cJSON *recorded_pointers(const struct room *room)
{
    cJSON *entries = cJSON_CreateObject();
    for (int i = 0; i < room->members.n; i++) {
        const struct pointing *pointing = &room->members.list[i]->pointing;
        if (!pointing->is_on)
            continue;
        const double point_mm[] = { pointing->point_mm.x, pointing->point_mm.y, pointing->point_mm.z };
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddNumberToObject(entry, "view", pointing->view);
        json_add(entry, "point_mm", cJSON_CreateDoubleArray(point_mm, 3));
        json_add(entries, room->members.list[i]->id, entry);
    }
    return entries;
}

cJSON *recorded_items(const struct room *room)
{
    cJSON *entries = cJSON_CreateObject();
    for (const struct item *item = room->items->first; item; item = item->next)
        json_add(entries, item->id, json_read(item->row, strlen(item->row), NULL));
    return entries;
}

cJSON *recorded_scene(const struct room *room)
{
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddNumberToObject(entry, "revision", room->shared.revision);
    json_add(entry, "scene", cJSON_Duplicate(room->shared.scene, true));
    return entry;
}

cJSON *recorded_state(const struct room *room)
{
    struct meeting_log *log = meeting_log_create();
    if (!log)
        return NULL;
    if (room->shared.scene)
        meeting_log_put(log, 0, LOG_SCENE, "scene", recorded_scene(room));
    meeting_log_put_all(log, 0, LOG_VIEWS, recorded_views(room));
    meeting_log_put_all(log, 0, LOG_POINTERS, recorded_pointers(room));
    meeting_log_put_all(log, 0, LOG_ITEMS, recorded_items(room));
    meeting_log_put_all(log, 0, LOG_MEMBERS, recorded_members(room));
    cJSON *state = cJSON_Duplicate(meeting_log_state(log), true);
    meeting_log_destroy(log);
    return state;
}

/* ---- for clients ------------------------------------------------------------------------------------------------ */

static int compare_items(const void *a, const void *b)
{
    const cJSON *x = *(const cJSON *const *)a, *y = *(const cJSON *const *)b;
    const double of_x = json_number(x, "created_ms", 0), of_y = json_number(y, "created_ms", 0);
    return of_x < of_y ? -1 : of_x > of_y ? 1 : strcmp(x->string, y->string);
}

cJSON *recorded_item_list(const cJSON *state)
{
    const cJSON *entries = log_state_part(state, LOG_ITEMS), *entry;
    size_t n = 0;
    cJSON *list = cJSON_CreateArray();
    const cJSON **rows = mem_array((size_t)cJSON_GetArraySize(entries), sizeof *rows, 1 << 20, NULL);
    if (!rows)
        return list;
    cJSON_ArrayForEach(entry, entries) rows[n++] = entry;
    qsort(rows, n, sizeof *rows, compare_items);
    for (size_t i = 0; i < n; i++) {
        cJSON *reference = cJSON_CreateObject();
        if (reference) {
            reference->type |= cJSON_IsReference;
            reference->child = rows[i]->child;
            json_append(list, reference);
        }
    }
    free(rows);
    return list;
}

/* The entries of a part as a list, each with its id as the field `name` (NULL: without). */
static cJSON *list_of(const cJSON *state, enum log_part part, const char *name)
{
    cJSON *list = cJSON_CreateArray();
    const cJSON *entry;
    cJSON_ArrayForEach(entry, log_state_part(state, part))
    {
        cJSON *row = cJSON_CreateObject();
        if (name)
            cJSON_AddStringToObject(row, name, entry->string);
        for (const cJSON *field = entry->child; field; field = field->next)
            json_add(row, field->string, cJSON_Duplicate(field, true));
        json_append(list, row);
    }
    return list;
}

static const char *presenter_of(const cJSON *state)
{
    const cJSON *entry;
    cJSON_ArrayForEach(entry, log_state_part(state, LOG_MEMBERS)) if (json_flag(entry, "presenting",
                                                                                false)) return entry->string;
    return "";
}

static cJSON *document_of(const cJSON *state, int64_t t_ms)
{
    const cJSON *scene = cJSON_GetObjectItemCaseSensitive(log_state_part(state, LOG_SCENE), "scene");
    cJSON *document = cJSON_CreateObject(), *items = recorded_item_list(state);
    cJSON_AddNumberToObject(document, "t_ms", (double)t_ms);
    cJSON_AddNumberToObject(document, "revision", json_number(scene, "revision", 0));
    json_add(document, "scene", cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(scene, "scene"), true));
    json_add(document, "views", list_of(state, LOG_VIEWS, NULL));
    json_add(document, "pointers", list_of(state, LOG_POINTERS, "member"));
    json_add(document, "items", cJSON_Duplicate(items, true));
    json_add(document, "members", list_of(state, LOG_MEMBERS, "id"));
    cJSON_AddStringToObject(document, "presenter", presenter_of(state));
    cJSON_Delete(items);
    return document;
}

cJSON *room_recorded_state(const char *const *texts, size_t n, int64_t t_ms, struct problem *problem)
{
    cJSON *state = NULL;
    bool ok = true, is_before = true;
    for (size_t i = 0; ok && is_before && i < n; i++) {
        cJSON *events = meeting_log_read(texts[i], strlen(texts[i]), problem);
        ok = events != NULL;
        for (const cJSON *event = ok ? events->child : NULL; ok && event; event = event->next) {
            is_before = log_event_ms(event) <= t_ms || !state;
            if (!is_before)
                break;
            ok = meeting_log_apply(&state, event, problem);
        }
        cJSON_Delete(events);
    }
    if (ok && !state)
        ok = problem_set(problem, PROBLEM_NOT_FOUND, "", "", "nothing of this recording is on the disk");
    cJSON *document = ok ? document_of(state, t_ms) : NULL;
    cJSON_Delete(state);
    return document;
}

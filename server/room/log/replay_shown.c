/* Turns the documents of a meeting log into scene, views, items, pointers and members. */
#include "server/room/log/replay_shown.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/log.h"
#include "server/room/items/item_list.h"
#include "server/room/items/room_items.h"
#include "server/room/log/meeting_log.h"
#include "server/room/log/recorded_parts.h"
#include "server/room/out/send.h"
#include "server/room/streams/stream.h"
#include "server/room/views/shared_scene.h"
#include "server/wire/bookmark.h"
#include "server/wire/document.h"
#include "server/wire/json_merge.h"

enum { POINTER_KEYS = 1 << 20 }; /* of send_latest: beyond the numbers of members */

/* ---- scene ------------------------------------------------------------------------------------------------------ */

/* The recorded scene for a plan that is another one now; *report gets what is left out of it. */
static cJSON *scene_of_changed_plan(const struct room *room, const cJSON *recorded, cJSON **report)
{
    cJSON *body = cJSON_CreateObject();
    cJSON_AddStringToObject(body, "name", "");
    json_add(body, "scene", bookmark_difference(room->shared.defaults, recorded));
    cJSON *opened = bookmark_open(body, room->shared.plan, room->shared.defaults, NULL);
    cJSON *scene = cJSON_DetachItemFromObjectCaseSensitive(opened, "scene");
    cJSON_Delete(*report);
    *report = cJSON_DetachItemFromObjectCaseSensitive(opened, "report");
    cJSON_Delete(opened);
    cJSON_Delete(body);
    return scene;
}

bool shown_scene(struct room *room, const cJSON *state, cJSON **report)
{
    const cJSON *entry = cJSON_GetObjectItemCaseSensitive(log_state_part(state, LOG_SCENE), "scene"),
                *recorded = cJSON_GetObjectItemCaseSensitive(entry, "scene");
    if (!cJSON_IsObject(recorded))
        return true;
    cJSON *scene = report ? scene_of_changed_plan(room, recorded, report)
                          : scene_document_renew(room->shared.plan, room->shared.defaults, recorded);
    return scene && scene_show(room, scene);
}

/* ---- views ------------------------------------------------------------------------------------------------------ */

/* Takes document. Returns its stream when that has changed, else NULL. */
static struct stream *show_view(struct room *room, cJSON *document)
{
    struct stream *stream = stream_shared(room, document);
    if (!stream)
        return stream_create(room, document, true);
    if (!stream_set_view(room, stream, document))
        return NULL;
    for (struct member_view *view = stream->viewers; view; view = view->next_viewer) {
        view->has_moved = true;
        view->moved_by[0] = 0;
    }
    return stream;
}

void shown_views(struct room *room, const cJSON *state)
{
    const cJSON *entry;
    struct stream *moved = NULL;
    int n_moved = 0;
    cJSON_ArrayForEach(entry, log_state_part(state, LOG_VIEWS))
    {
        const cJSON *recorded = cJSON_GetObjectItemCaseSensitive(entry, "document");
        struct problem problem = { 0 };
        cJSON *document = recorded ? view_document_patch(NULL, recorded, &problem) : NULL;
        if (document && !override_is_valid(room, document, &problem))
            cJSON_DeleteItemFromObjectCaseSensitive(document, "override");
        struct stream *stream = document ? show_view(room, document) : NULL;
        moved = stream ? stream : moved;
        n_moved += stream != NULL;
        if (!document)
            log_error("room %s: a recorded view is left out: %s", room->id, problem.detail);
    }
    if (n_moved == 1) /* somebody moved this one; where all are shown anew, nobody did */
        room->streams.main = moved;
}

/* ---- items ------------------------------------------------------------------------------------------------------ */

static void tell_item(struct room *room, const char *id, const char *row)
{
    struct message message = { .type = MESSAGE_ITEM, .item = { .item = row ? cJSON_CreateRaw(row) : NULL } };
    (void)snprintf(message.item.id, sizeof message.item.id, "%s", id);
    send_to_all(room, &message);
    message_finish(&message);
}

static const struct item *find_in(const struct item *list, const char *id)
{
    while (list && strcmp(list->id, id) != 0)
        list = list->next;
    return list;
}

/* All are read again: so they stand in the order of their time, whatever has changed. */
void shown_items(struct room *room, const cJSON *state)
{
    struct item *before = items_take_all(room);
    cJSON *list = recorded_item_list(state);
    const cJSON *entry;
    cJSON_ArrayForEach(entry, list)
    {
        struct problem problem = { 0 };
        const char *kind = json_text(entry, "kind");
        if (kind && strcmp(kind, wire_item_kind_words.words[WIRE_ITEM_KIND_ACCEPTANCE]) == 0)
            continue; /* said in another room, and not for the pictures of this one */
        char *row = json_print(entry);
        if (!row || !room_restore_item(room, row, strlen(row), &problem))
            log_error("room %s: a recorded item is left out: %s", room->id, problem.detail);
        free(row);
    }
    cJSON_Delete(list);
    for (const struct item *item = before; item; item = item->next)
        if (!items_find(room, item->id))
            tell_item(room, item->id, NULL);
    for (const struct item *item = room->items->first; item; item = item->next) {
        const struct item *old = find_in(before, item->id);
        if (!old || strcmp(old->row, item->row) != 0)
            tell_item(room, item->id, item->row);
    }
    while (before) {
        struct item *next = before->next;
        free(before->row);
        free(before);
        before = next;
    }
}

/* ---- pointers and members --------------------------------------------------------------------------------------- */

/* entry NULL: the member points no more. */
static void fill_in(const char *id, const cJSON *entry, struct message *message)
{
    const cJSON *point = cJSON_GetObjectItemCaseSensitive(entry, "point_mm");
    double mm[3] = { 0 };
    for (int i = 0; i < 3 && point; i++) {
        const cJSON *number = cJSON_GetArrayItem(point, i);
        mm[i] = cJSON_IsNumber(number) ? number->valuedouble : 0;
    }
    *message = (struct message){ .type = MESSAGE_POINTER_AT };
    (void)snprintf(message->pointer_at.member, sizeof message->pointer_at.member, "r-%.60s", id);
    message->pointer_at.has_point_mm = entry != NULL;
    message->pointer_at.point_mm = (struct vec3){ mm[0], mm[1], mm[2] };
}

static uint32_t key_of(const char *id)
{
    return POINTER_KEYS + (uint32_t)(strtoul(id + (id[0] == 'm'), NULL, 10) % POINTER_KEYS);
}

static void send_pointer(struct room *room, const char *id, const cJSON *entry)
{
    struct message message;
    fill_in(id, entry, &message);
    send_latest_to_others(room, NULL, key_of(id), &message);
}

void shown_pointers(struct room *room, const cJSON *before, const cJSON *state)
{
    const cJSON *old = before ? log_state_part(before, LOG_POINTERS) : NULL,
                *new = state ? log_state_part(state, LOG_POINTERS) : NULL, *entry;
    cJSON_ArrayForEach(entry, old) if (!cJSON_GetObjectItemCaseSensitive(new, entry->string))
        send_pointer(room, entry->string, NULL);
    cJSON_ArrayForEach(entry, new) if (!json_equal(cJSON_GetObjectItemCaseSensitive(old, entry->string), entry))
        send_pointer(room, entry->string, entry);
}

void shown_pointers_to(struct room *room, struct member *member, const cJSON *state)
{
    const cJSON *entry;
    cJSON_ArrayForEach(entry, log_state_part(state, LOG_POINTERS))
    {
        struct message message;
        fill_in(entry->string, entry, &message);
        send_latest(room, member, key_of(entry->string), &message);
    }
}

void shown_members(struct room *room, struct member *only, const cJSON *state)
{
    struct message message = { .type = MESSAGE_REPLAY_MEMBERS };
    cJSON *list = cJSON_CreateArray();
    const cJSON *members = state ? log_state_part(state, LOG_MEMBERS) : NULL, *entry;
    cJSON_ArrayForEach(entry, members)
    {
        char id[64];
        cJSON *row = cJSON_CreateObject();
        (void)snprintf(id, sizeof id, "r-%.60s", entry->string);
        cJSON_AddStringToObject(row, "id", id);
        for (const cJSON *field = entry->child; field; field = field->next)
            json_add(row, field->string, cJSON_Duplicate(field, true));
        json_append(list, row);
    }
    message.replay_members.members = list;
    if (only)
        send_to_member(room, only, &message);
    else
        send_to_all(room, &message);
    message_finish(&message);
}

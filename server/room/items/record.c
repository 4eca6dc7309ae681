/* Puts the record of a review together. */
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/room/items/acceptance.h"
#include "server/room/items/record_body.h"
#include "server/room/items/room_items.h"
#include "server/room/out/send.h"
#include "server/room/state/presence.h"
#include "server/room/streams/stream.h"
#include "server/wire/json.h"
#include "server/wire/message.h"

/* The rows of one kind, each as {..., body...}: what a record holds of an item. */
static cJSON *rows_of(const struct room *room, enum wire_item_kind kind)
{
    cJSON *list = cJSON_CreateArray();
    for (const struct item *item = room->items->first; item; item = item->next) {
        if (item->kind != kind)
            continue;
        cJSON *row = json_read(item->row, strlen(item->row), NULL);
        cJSON *body = cJSON_DetachItemFromObjectCaseSensitive(row, "body"), *field;
        cJSON_DeleteItemFromObjectCaseSensitive(row, "kind");
        cJSON_DeleteItemFromObjectCaseSensitive(row, "author_color");
        if (kind == WIRE_ITEM_KIND_BOOKMARK) { /* what it shows is the room's own business */
            cJSON_AddStringToObject(row, "name", json_text(body, "name") ? json_text(body, "name") : "");
        } else {
            while (body && (field = body->child)) {
                cJSON *taken = cJSON_DetachItemViaPointer(body, field);
                json_add(row, taken->string, taken);
            }
        }
        cJSON_Delete(body);
        if (kind == WIRE_ITEM_KIND_ACCEPTANCE)
            cJSON_AddBoolToObject(row, "counts", acceptance_counts(room, item));
        json_append(list, row);
    }
    return list;
}

/* To be finished. */
static void fill_files(const struct room *room, struct message *message)
{
    *message = (struct message){ .type = MESSAGE_FILES };
    message->files.changed_ms = (double)room->files.changed_ms;
    message->files.read_ms = (double)room->files.read_ms;
}

void room_files(struct room *room, int64_t changed_ms, int64_t read_ms)
{
    struct message message;
    if (room->files.changed_ms == changed_ms)
        return;
    room->files.changed_ms = changed_ms;
    room->files.read_ms = read_ms;
    fill_files(room, &message);
    send_to_all(room, &message);
    message_finish(&message);
}

void files_show(struct room *room, struct member *member)
{
    struct message message;
    if (!room->files.changed_ms)
        return;
    fill_files(room, &message);
    send_to_member(room, member, &message);
    message_finish(&message);
}

bool record_is_wanted(enum wire_item_kind kind)
{
    return kind == WIRE_ITEM_KIND_DECISION || kind == WIRE_ITEM_KIND_SIGNATURE;
}

/* State of the room on the server's disk. */
static cJSON *describe_saved(const struct room *room)
{
    struct room_saved saved = { .state = WIRE_SAVED_STATE_UNKEPT };
    cJSON *json = cJSON_CreateObject();
    if (room->callbacks.is_saved)
        room->callbacks.is_saved(room->callbacks.context, room, &saved);
    cJSON_AddStringToObject(json, "state", wire_saved_state_words.words[saved.state]);
    cJSON_AddNumberToObject(json, "revision", saved.revision);
    return json;
}

char *record_of(const struct room *room, const struct item *item, struct problem *problem)
{
    const cJSON *scene = room->shared.scene ? room->shared.scene : room->shared.restored;
    if (!record_is_wanted(item->kind))
        return NULL;
    char *scene_text = scene ? json_print(scene) : NULL, *views_text = streams_write(room);
    if ((scene && !scene_text) || !views_text) {
        free(scene_text);
        free(views_text);
        json_no_memory(problem, "a record");
        return NULL;
    }
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "format", "beamroom-kept-record");
    cJSON_AddNumberToObject(json, "version", 1);
    json_add(json, "item", cJSON_CreateRaw(item->row));
    json_add(json, "record", room_record(room));
    json_add(json, "scene", scene_text ? cJSON_CreateRaw(scene_text) : cJSON_CreateNull());
    json_add(json, "views", cJSON_CreateRaw(views_text));
    char *text = json_print(json);
    cJSON_Delete(json);
    free(scene_text);
    free(views_text);
    if (!text)
        json_no_memory(problem, "a record");
    return text;
}

/* Which case of a meeting the room is; NULL: of none that has come to it. */
static cJSON *describe_meeting(const struct room *room)
{
    const struct room_meeting_callbacks *meeting = room->callbacks.meeting;
    struct room_meeting_case about;
    if (!meeting || !meeting->about || !meeting->about(room->callbacks.context, room, &about))
        return NULL;
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "id", about.meeting);
    cJSON_AddStringToObject(json, "name", about.name);
    cJSON_AddNumberToObject(json, "n", (double)about.n);
    cJSON_AddNumberToObject(json, "of", (double)about.of);
    cJSON_AddBoolToObject(json, "is_over", about.is_over);
    return json;
}

cJSON *room_record(const struct room *room)
{
    cJSON *meeting = describe_meeting(room);
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "format", "beamroom-record");
    cJSON_AddNumberToObject(json, "version", 1);
    cJSON_AddStringToObject(json, "room", room->id);
    if (room->name[0])
        cJSON_AddStringToObject(json, "room_name", room->name);
    cJSON_AddStringToObject(json, "plan", room->plan_id);
    cJSON_AddStringToObject(json, "plan_revision", room->files.revision);
    if (record_statement_ms(room) > 0)
        cJSON_AddNumberToObject(json, "statement_ms", record_statement_ms(room));
    cJSON_AddNumberToObject(json, "revision", room->shared.revision);
    cJSON_AddNumberToObject(json, "made_ms", (double)clock_wall_ms());
    cJSON_AddNumberToObject(json, "created_ms", (double)room->created_at_s * 1000);
    if (meeting)
        json_add(json, "meeting", meeting);
    json_add(json, "present", presence_list(room));
    cJSON_AddNumberToObject(json, "n_present_dropped", presence_n_dropped(room));
    json_add(json, "checklist", rows_of(room, WIRE_ITEM_KIND_CHECK));
    json_add(json, "decisions", rows_of(room, WIRE_ITEM_KIND_DECISION));
    json_add(json, "signatures", rows_of(room, WIRE_ITEM_KIND_SIGNATURE));
    json_add(json, "acceptances", rows_of(room, WIRE_ITEM_KIND_ACCEPTANCE));
    json_add(json, "notes", rows_of(room, WIRE_ITEM_KIND_NOTE));
    json_add(json, "saved_views", rows_of(room, WIRE_ITEM_KIND_BOOKMARK));
    json_add(json, "saved", describe_saved(room));
    return json;
}

/* Turns items into the texts of their rows and back: item_row.h. */
#include "server/room/items/item_row.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/items/acceptance.h"
#include "server/room/items/bookmark_body.h"
#include "server/room/items/item_list.h"
#include "server/room/items/note_body.h"
#include "server/room/items/record_body.h"
#include "server/room/items/room_items.h"

/* ---- kinds ------------------------------------------------------------------------------------------------------ */

/* Limits and readers of bodies, by kind. read returns the body, checked and complete, as a new document, like
 * note_body_read. */
static const struct {
    size_t max_bytes;
    cJSON *(*read)(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                   struct problem *problem);
} kinds[] = {
    [WIRE_ITEM_KIND_NOTE] = { NOTE_MAX_BYTES, note_body_read },
    [WIRE_ITEM_KIND_BOOKMARK] = { ROOM_MAX_ITEM_BYTES, bookmark_body_read },
    [WIRE_ITEM_KIND_CHECK] = { RECORD_MAX_BYTES, record_read_check },
    [WIRE_ITEM_KIND_DECISION] = { RECORD_MAX_BYTES, record_read_decision },
    [WIRE_ITEM_KIND_SIGNATURE] = { RECORD_MAX_BYTES, record_read_signature },
    [WIRE_ITEM_KIND_ACCEPTANCE] = { ACCEPTANCE_MAX_BYTES, acceptance_read },
};

const char *item_word(enum wire_item_kind kind)
{
    return wire_item_kind_words.words[kind];
}

char *item_body_text(const struct room *room, enum wire_item_kind kind, const cJSON *body, const struct item *before,
                     bool is_restored, struct problem *problem)
{
    if (!cJSON_IsObject(body)) {
        problem_set(problem, PROBLEM_VALIDATION, "/body", "type", "/body is not an object");
        return NULL;
    }
    *problem = (struct problem){ 0 };
    cJSON *read = kinds[kind].read(room, body, before, is_restored, problem);
    if (!read && problem->type != PROBLEM_NONE)
        return NULL;
    char *text = json_print(read);
    cJSON_Delete(read);
    if (!text) {
        json_no_memory(problem, "an item");
    } else if (strlen(text) > kinds[kind].max_bytes) {
        problem_set(problem, PROBLEM_TOO_LARGE, "/body", "", "the body has %zu bytes, a %s may have %zu", strlen(text),
                    item_word(kind), kinds[kind].max_bytes);
        free(text);
        return NULL;
    }
    return text;
}

/* ---- rows ------------------------------------------------------------------------------------------------------- */

char *item_row_text(const struct item *item, const char *body)
{
    cJSON *row = cJSON_CreateObject();
    cJSON_AddStringToObject(row, "id", item->id);
    cJSON_AddStringToObject(row, "kind", item_word(item->kind));
    cJSON_AddNumberToObject(row, "version", item->version);
    cJSON_AddStringToObject(row, "author", item->author);
    cJSON_AddStringToObject(row, "author_name", item->author_name);
    cJSON_AddStringToObject(row, "author_color", item->author_color);
    if (item->author_user[0])
        cJSON_AddStringToObject(row, "author_user", item->author_user);
    if (item->is_guest)
        cJSON_AddTrueToObject(row, "is_guest");
    cJSON_AddStringToObject(row, "changed_name", item->changed_name);
    if (item->hidden_by[0])
        cJSON_AddStringToObject(row, "hidden_by", item->hidden_by);
    cJSON_AddNumberToObject(row, "created_ms", (double)item->created_ms);
    cJSON_AddNumberToObject(row, "changed_ms", (double)item->changed_ms);
    json_add(row, "body", cJSON_CreateRaw(body));
    char *text = json_print(row);
    cJSON_Delete(row);
    return text;
}

/* ---- from the store --------------------------------------------------------------------------------------------- */

static bool take_text(const cJSON *row, const char *name, char *to, size_t size, struct problem *problem)
{
    const char *text = json_text(row, name);
    if (!text || strlen(text) >= size)
        return problem_set(problem, PROBLEM_VALIDATION, name, "type", "%s of a kept item is not a text of %zu bytes",
                           name, size - 1);
    memcpy(to, text, strlen(text) + 1);
    return true;
}

/* A text that may be left out. */
static bool take_optional(const cJSON *row, const char *name, char *to, size_t size, struct problem *problem)
{
    to[0] = 0;
    return !cJSON_GetObjectItemCaseSensitive(row, name) || take_text(row, name, to, size, problem);
}

static bool take_number(const cJSON *row, const char *name, double most, int64_t *to, struct problem *problem)
{
    const double number = json_number(row, name, -1);
    if (!(number >= 0 && number <= most))
        return problem_set(problem, PROBLEM_VALIDATION, name, "range", "%s of a kept item is not 0 to %g", name, most);
    *to = (int64_t)number;
    return true;
}

static bool take_kind(const cJSON *row, enum wire_item_kind *kind, struct problem *problem)
{
    const char *word = json_text(row, "kind");
    for (size_t i = 0; word && i < wire_item_kind_words.n; i++)
        if (strcmp(word, wire_item_kind_words.words[i]) == 0) {
            *kind = (enum wire_item_kind)i;
            return true;
        }
    return problem_set(problem, PROBLEM_VALIDATION, "kind", "enum", "kind of a kept item is none of ours");
}

/* Members who come are not given the id of an item's author. */
static void pass_id(struct room *room, const char *author)
{
    unsigned number;
    if (sscanf(author, "m%9u", &number) == 1 && number > room->members.n_named)
        room->members.n_named = number;
}

bool room_restore_item(struct room *room, const char *bytes, size_t n, struct problem *problem)
{
    struct item *item = NULL, read = { .version = 0 };
    char *body = NULL, *text = NULL;
    int64_t version = 0;
    if (n > ROOM_MAX_ITEM_BYTES + ROOM_MAX_ITEM_FRAME)
        return problem_set(problem, PROBLEM_TOO_LARGE, "", "", "a kept item has %zu bytes, at most %d are allowed", n,
                           ROOM_MAX_ITEM_BYTES + ROOM_MAX_ITEM_FRAME);
    cJSON *row = json_read(bytes, n, problem);
    if (!row)
        return false;
    const char *parent = json_text(cJSON_GetObjectItemCaseSensitive(row, "body"), "parent");
    if (take_kind(row, &read.kind, problem) && take_text(row, "id", read.id, sizeof read.id, problem) &&
        take_text(row, "author", read.author, sizeof read.author, problem) &&
        take_text(row, "author_name", read.author_name, sizeof read.author_name, problem) &&
        take_text(row, "author_color", read.author_color, sizeof read.author_color, problem) &&
        take_text(row, "changed_name", read.changed_name, sizeof read.changed_name, problem) &&
        take_optional(row, "author_user", read.author_user, sizeof read.author_user, problem) &&
        take_optional(row, "hidden_by", read.hidden_by, sizeof read.hidden_by, problem) &&
        take_number(row, "version", UINT32_MAX - 1.0, &version, problem) &&
        take_number(row, "created_ms", 9007199254740991.0, &read.created_ms, problem) &&
        take_number(row, "changed_ms", 9007199254740991.0, &read.changed_ms, problem))
        body = item_body_text(room, read.kind, cJSON_GetObjectItemCaseSensitive(row, "body"), NULL, true, problem);
    read.is_guest = json_flag(row, "is_guest", false);
    if (body && (!id_is_valid(read.id) || version == 0 || items_find(room, read.id))) {
        problem_set(problem, PROBLEM_VALIDATION, "id", "duplicate", "a kept item has no id or version of its own");
    } else if (body) {
        read.version = (uint32_t)version;
        (void)snprintf(read.parent, sizeof read.parent, "%s",
                       read.kind == WIRE_ITEM_KIND_NOTE && parent && strlen(parent) < sizeof read.parent ? parent : "");
        text = item_row_text(&read, body);
        if (!text)
            json_no_memory(problem, "an item");
    }
    if (text && items_have_place(room, NULL, strlen(text), problem)) {
        item = mem_new(sizeof *item);
        *item = read;
        items_keep(room, item, text);
        pass_id(room, item->author);
        text = NULL;
    }
    free(text);
    free(body);
    cJSON_Delete(row);
    return item != NULL;
}

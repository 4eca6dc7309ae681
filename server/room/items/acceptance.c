/* Keeps track of the acceptances of a room that count: acceptance.h. */
#include "server/room/items/acceptance.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/room/items/acceptance_body.h"
#include "server/room/items/item_list.h"
#include "server/room/items/room_items.h"
#include "server/room/out/audit.h"
#include "server/room/out/send.h"
#include "server/room/state/body_check.h"
#include "server/room/state/event.h"
#include "server/room/state/member_list.h"
#include "server/room/state/roles.h"
#include "server/room/streams/stream.h"
#include "server/wire/json_merge.h"

struct acceptances {
    cJSON *list, *ids; /* of those that count: for the renderer, and the items' ids; NULL: not known, or none */
    char revision[65]; /* of the files that the present renderer has loaded; "": not known */
    bool is_known;     /* as members were told last: revision is */
};

void acceptances_init(struct room *room)
{
    room->acceptances = mem_new(sizeof *room->acceptances);
}

/* ---- bodies ----------------------------------------------------------------------------------------------------- */

static cJSON *body_of(const struct item *item, cJSON **row)
{
    *row = json_read(item->row, strlen(item->row), NULL);
    return cJSON_GetObjectItemCaseSensitive(*row, "body");
}

static bool names_pair(const cJSON *body, const char *thing, const char *with)
{
    const char *first = json_text(body, "thing"), *second = json_text(body, "with");
    return first && second &&
           ((strcmp(first, thing) == 0 && strcmp(second, with) == 0) ||
            (strcmp(first, with) == 0 && strcmp(second, thing) == 0));
}

static bool is_of_these_files(const struct room *room, const cJSON *body)
{
    const char *revision = json_text(body, "plan_revision");
    return revision && revision[0] && strcmp(revision, room->acceptances->revision) == 0;
}

/* Refuses a second acceptance of a pair, and one more than are counted. */
static bool check_others(const struct room *room, const cJSON *body, struct problem *problem)
{
    size_t n = 0;
    bool is_there = false;
    for (const struct item *item = room->items->first; item && !is_there; item = item->next) {
        if (item->kind != WIRE_ITEM_KIND_ACCEPTANCE)
            continue;
        cJSON *row, *other = body_of(item, &row);
        if (is_of_these_files(room, other)) {
            n++;
            is_there = names_pair(other, json_text(body, "thing"), json_text(body, "with"));
        }
        cJSON_Delete(row);
    }
    if (is_there)
        return problem_set(problem, PROBLEM_CONFLICT, "/body/thing", "", "these are accepted in this room already");
    return n < ACCEPTANCE_MAX ||
           problem_set(problem, PROBLEM_LIMIT, "", "",
                       "the room has %zu acceptances, at most %d are allowed; withdraw some", n, ACCEPTANCE_MAX);
}

cJSON *acceptance_read(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                       struct problem *problem)
{
    static const char *const names[] = { "thing", "with", "reason", "words", "fact", "plan_revision", "role", NULL };
    (void)before; /* never changed */
    if (!body_names_are(body, names, "/body", problem) ||
        !acceptance_check(is_restored ? NULL : room->shared.plan, body, "/body", problem) ||
        (!is_restored && !check_others(room, body, problem)))
        return NULL;
    const cJSON *fit =
        is_restored ? NULL : acceptance_fit(room->shared.plan, json_text(body, "thing"), json_text(body, "with"));
    const char *revision = is_restored ? json_text(body, "plan_revision") : room->acceptances->revision;
    const char *role = is_restored           ? json_text(body, "role")
                       : room->items->writer ? wire_member_role_words.words[room->items->writer->role]
                                             : NULL;
    cJSON *read = cJSON_CreateObject();
    json_copy_text(read, body, "thing");
    json_copy_text(read, body, "with");
    json_copy_text(read, body, "reason");
    json_copy_text(read, body, "words");
    if (is_restored)
        json_copy_text(read, body, "fact");
    else
        cJSON_AddStringToObject(read, "fact", json_text(fit, "reason") ? json_text(fit, "reason") : "");
    cJSON_AddStringToObject(read, "plan_revision", revision && strlen(revision) <= 64 ? revision : "");
    cJSON_AddStringToObject(read, "role", role && strlen(role) < 16 ? role : "");
    return read;
}

/* ---- rights ----------------------------------------------------------------------------------------------------- */

bool acceptance_may(const struct room *room, const struct member *member, enum wire_item_kind kind,
                    struct problem *problem)
{
    if (kind != WIRE_ITEM_KIND_ACCEPTANCE)
        return true;
    if (!member_check(member, WIRE_RIGHT_SCENE, problem))
        return false;
    if (!member_presents(room, member))
        return refuse_not_presenter(room, problem, "say what is used though it does not fit");
    return audit_has_place(room, problem);
}

bool acceptance_may_write(const struct room *room, const struct member *member, enum wire_item_kind kind,
                          const struct item *before, struct problem *problem)
{
    if (kind != WIRE_ITEM_KIND_ACCEPTANCE)
        return true;
    if (before)
        return problem_set(problem, PROBLEM_FORBIDDEN, "/item", "append-only",
                           "an acceptance stays as it was made: withdraw it and make another");
    if (!acceptance_may(room, member, kind, problem))
        return false;
    if (room->acceptances->revision[0] && room->shared.plan)
        return true;
    problem_set(problem, PROBLEM_BUSY, "", "",
                "the revision of the plan's files is not known yet: GET /api/v1/plans/%s/revision", room->plan_id);
    problem->retry_after_ms = 1000;
    return false;
}

void acceptance_audit(struct room *room, const struct item *item, const struct member *by, bool is_withdrawn)
{
    if (item->kind != WIRE_ITEM_KIND_ACCEPTANCE)
        return;
    cJSON *row, *body = body_of(item, &row);
    struct audit_act act = { .by = by,
                             .action = is_withdrawn ? "withdrawal" : "acceptance",
                             .detail = cJSON_CreateObject(),
                             .before = -1,
                             .after = room->shared.revision };
    const char *words = json_text(body, "words");
    char hex[DIGEST_TEXT];
    digest_text(item->row, hex);
    cJSON_AddStringToObject(act.detail, "item", item->id);
    cJSON_AddNumberToObject(act.detail, "version", item->version);
    cJSON_AddStringToObject(act.detail, "sha256", hex);
    json_copy_text(act.detail, body, "thing");
    json_copy_text(act.detail, body, "with");
    json_copy_text(act.detail, body, "reason");
    json_copy_text(act.detail, body, "plan_revision");
    if (words && strlen(words) <= ROOM_MAX_AUDIT_DETAIL / 3) /* else the whole row would be left out */
        json_copy_text(act.detail, body, "words");
    cJSON_Delete(row);
    audit_tell(room, &act);
}

/* ---- which count ------------------------------------------------------------------------------------------------ */

/* [{thing, with, by, words}] for the renderer; ids gets the items'. */
static cJSON *find_counting(const struct room *room, cJSON *ids)
{
    cJSON *list = cJSON_CreateArray();
    int n = 0;
    for (const struct item *item = room->items->first; item && !room->replay && n < ACCEPTANCE_MAX; item = item->next) {
        if (item->kind != WIRE_ITEM_KIND_ACCEPTANCE)
            continue;
        cJSON *row, *body = body_of(item, &row);
        if (is_of_these_files(room, body)) {
            cJSON *entry = cJSON_CreateObject();
            json_copy_text(entry, body, "thing");
            json_copy_text(entry, body, "with");
            cJSON_AddStringToObject(entry, "by", item->author_name);
            json_copy_text(entry, body, "words");
            json_append(list, entry);
            json_append(ids, cJSON_CreateString(item->id));
            n++;
        }
        cJSON_Delete(row);
    }
    return list;
}

bool acceptance_counts(const struct room *room, const struct item *item)
{
    const cJSON *id;
    cJSON_ArrayForEach(id, room->acceptances->ids)
    {
        if (strcmp(id->valuestring, item->id) == 0)
            return true;
    }
    return false;
}

void acceptances_tell(struct room *room, struct member *member)
{
    struct message message = { .type = MESSAGE_ACCEPTANCES };
    cJSON *none = cJSON_CreateArray();
    message.acceptances.known = room->acceptances->revision[0] != 0;
    message.acceptances.items = room->acceptances->ids ? room->acceptances->ids : none;
    if (member)
        send_to_member(room, member, &message);
    else
        send_to_all(room, &message);
    cJSON_Delete(none);
}

void acceptances_settle(struct room *room)
{
    const size_t refused = mem_n_refused();
    const bool is_known = room->acceptances->revision[0] != 0;
    cJSON *ids = cJSON_CreateArray(), *list = find_counting(room, ids);
    if (mem_n_refused() != refused) { /* better none than a part of them */
        cJSON_Delete(ids);
        cJSON_Delete(list);
        ids = list = NULL;
    }
    const bool had_none = !room->acceptances->list || !room->acceptances->list->child, has_none = !list || !list->child;
    const bool has_changed = had_none != has_none || (!has_none && !json_equal(list, room->acceptances->list));
    const bool is_news = has_changed || is_known != room->acceptances->is_known;
    cJSON_Delete(room->acceptances->list);
    cJSON_Delete(room->acceptances->ids);
    room->acceptances->list = list;
    room->acceptances->ids = ids;
    room->acceptances->is_known = is_known;
    if (has_changed && room->shared.scene) {
        room->shared.revision++;
        room_event(room, ROOM_SCENE, NULL);
        streams_changed(room, false);
        room->callbacks.scene_changed(room->callbacks.context, room, room->shared.scene, room->shared.revision);
        send_scene_patch(room, cJSON_CreateObject(), NULL, 0, true);
    }
    if (is_news)
        acceptances_tell(room, NULL);
}

bool acceptances_want_revision(const struct room *room)
{
    const cJSON *fit;
    if (room->acceptances->revision[0] || room->replay || !room->shared.plan)
        return false;
    cJSON_ArrayForEach(fit, cJSON_GetObjectItemCaseSensitive(room->shared.plan, "fits"))
    {
        const char *needs = json_text(fit, "needs");
        if (needs && strcmp(needs, "acceptance") == 0)
            return true;
    }
    return items_has(room, WIRE_ITEM_KIND_ACCEPTANCE);
}

void acceptances_revision(struct room *room, const char *revision)
{
    if (revision[0] && room->acceptances->revision[0])
        return; /* the files may have changed; what is loaded has not */
    (void)snprintf(room->acceptances->revision, sizeof room->acceptances->revision, "%s", revision);
    acceptances_settle(room);
}

void acceptances_free(struct room *room)
{
    cJSON_Delete(room->acceptances->list);
    cJSON_Delete(room->acceptances->ids);
    free(room->acceptances);
}

const cJSON *room_acceptances(const struct room *room)
{
    return room->acceptances->list && room->acceptances->list->child ? room->acceptances->list : NULL;
}

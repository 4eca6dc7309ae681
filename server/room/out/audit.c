/* Gathers acts, and hands rows for the audit to the room's owner. */
#include "server/room/out/audit.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/room/state/who.h"
#include "server/wire/json_merge.h"

struct audit {
    struct gathered gathered[ROOM_MAX_GATHERED]; /* the oldest first */
    int n_gathered;
    struct audit_apart *apart; /* NULL: rows go to the room's owner */
};

void audit_init(struct room *room)
{
    room->audit = mem_new(sizeof *room->audit);
}

static const int64_t quiet_us = ROOM_AUDIT_QUIET_MS * INT64_C(1000), at_most_us = ROOM_AUDIT_AT_MOST_MS * INT64_C(1000);

bool audit_has_place(const struct room *room, struct problem *problem)
{
    if (!room->callbacks.audit_has_place || room->callbacks.audit_has_place(room->callbacks.context))
        return true;
    problem_set(problem, PROBLEM_STORAGE, "", "audit",
                "what happens here is recorded, and the server's disk takes no more records now");
    if (problem)
        problem->retry_after_ms = 10000;
    return false;
}

/* ---- rows ------------------------------------------------------------------------------------------------------- */

/* The text of the detail, for free(); one that is too long is named by its length and its SHA-256. */
static char *write_detail(const struct gathered *act)
{
    char *text = NULL, hex[DIGEST_TEXT];
    if (act->n > 1) {
        cJSON_AddNumberToObject(act->detail, "times", act->n);
        cJSON_AddNumberToObject(act->detail, "since_ms", (double)act->since_ms);
    }
    text = act->detail ? json_print(act->detail) : NULL;
    if (act->n > 1) { /* later acts are compared with it */
        cJSON_DeleteItemFromObjectCaseSensitive(act->detail, "times");
        cJSON_DeleteItemFromObjectCaseSensitive(act->detail, "since_ms");
    }
    if (text && strlen(text) > ROOM_MAX_AUDIT_DETAIL) {
        const size_t n = strlen(text);
        digest_text(text, hex);
        (void)snprintf(text, n, "{\"left_out_bytes\":%zu,\"sha256\":\"%s\"}", n, hex);
    }
    return text;
}

static struct room_audit row_of(const struct gathered *act, const char *detail)
{
    return (struct room_audit){ .time_ms = act->newest_ms,
                                .action = act->action,
                                .member = act->member,
                                .name = act->name,
                                .role = act->member[0] ? wire_member_role_words.words[act->role] : "",
                                .address = act->address,
                                .user = act->user,
                                .source = identity_source_word(act->source),
                                .session = act->session,
                                .detail = detail ? detail : "{}",
                                .result = act->is_refused ? "refused" : "done",
                                .before = act->before,
                                .after = act->after };
}

static void write_row(struct room *room, struct gathered *act)
{
    char *detail = write_detail(act);
    const struct room_audit row = row_of(act, detail);
    if (room->callbacks.audited && act->n > 0)
        room->callbacks.audited(room->callbacks.context, room, &row);
    act->n = 0;
    free(detail);
}

/* ---- gathering -------------------------------------------------------------------------------------------------- */

static void drop(struct room *room, int index)
{
    cJSON_Delete(room->audit->gathered[index].detail);
    room->audit->n_gathered--;
    memmove(&room->audit->gathered[index], &room->audit->gathered[index + 1],
            (size_t)(room->audit->n_gathered - index) * sizeof room->audit->gathered[0]);
}

static void end(struct room *room, int index)
{
    write_row(room, &room->audit->gathered[index]);
    drop(room, index);
}

static const char *address_of(const struct room *room, const struct audit_act *act)
{
    if (act->address)
        return act->address;
    if (act->by && room->call.act)
        return room->call.act->address;
    return act->by ? act->by->address : "";
}

static const struct identity *who_of(const struct room *room, const struct audit_act *act)
{
    static const struct identity nobody;
    const struct identity *caller =
        act->address && room->callbacks.caller ? room->callbacks.caller(room->callbacks.context) : NULL;
    if (act->who || caller)
        return act->who ? act->who : caller;
    if (act->by)
        return who_acts(room, act->by);
    if (room->call.act && room->call.act->identity)
        return room->call.act->identity;
    return room->callbacks.identity ? &nobody : who_connects(room, NULL);
}

static enum wire_member_role role_of(const struct audit_act *act)
{
    return act->by ? act->by->role : WIRE_MEMBER_ROLE_OBSERVER;
}

/* A member whose sign-in is over keeps the seat, under the name of its user. */
static const char *user_of(const struct identity *who, const struct audit_act *act)
{
    return who->user[0] || !act->by ? who->user : act->by->user;
}

/* Whether this act may share a row with what is gathered. Steps of a gesture (a key) may differ in their values; other
 * acts must be equal in everything but their time. */
static bool is_same_act(const struct room *room, const struct gathered *found, const struct audit_act *act,
                        const cJSON *detail)
{
    if (strcmp(found->action, act->action) != 0 || strcmp(found->key, act->key ? act->key : "") != 0 ||
        strcmp(found->member, act->by ? act->by->id : "") != 0 ||
        strcmp(found->name, act->by ? act->by->name : "") != 0 || strcmp(found->address, address_of(room, act)) != 0 ||
        found->role != role_of(act) || found->is_refused != act->is_refused)
        return false;
    const struct identity *who = who_of(room, act);
    if (found->source != who->source || strcmp(found->session, who->session) != 0 ||
        strcmp(found->user, user_of(who, act)) != 0)
        return false;
    return act->key ||
           (found->before == act->before && found->after == act->after && json_equal(found->detail, detail));
}

static struct gathered *find(struct room *room, const struct audit_act *act, const cJSON *detail)
{
    for (int i = 0; i < room->audit->n_gathered; i++)
        if (is_same_act(room, &room->audit->gathered[i], act, detail))
            return &room->audit->gathered[i];
    return NULL;
}

static void fill(const struct room *room, const struct audit_act *act, struct gathered *found)
{
    *found = (struct gathered){ .is_refused = act->is_refused, .first_us = room->now_us, .before = act->before };
    (void)snprintf(found->action, sizeof found->action, "%s", act->action);
    (void)snprintf(found->key, sizeof found->key, "%s", act->key ? act->key : "");
    (void)snprintf(found->member, sizeof found->member, "%s", act->by ? act->by->id : "");
    (void)snprintf(found->name, sizeof found->name, "%s", act->by ? act->by->name : "");
    (void)snprintf(found->address, sizeof found->address, "%s", address_of(room, act));
    found->role = role_of(act);
    const struct identity *who = who_of(room, act);
    found->source = who->source;
    (void)snprintf(found->user, sizeof found->user, "%s", user_of(who, act));
    (void)snprintf(found->session, sizeof found->session, "%s", who->session);
}

static struct gathered *begin(struct room *room, const struct audit_act *act)
{
    if (room->audit->n_gathered == ROOM_MAX_GATHERED)
        end(room, 0);
    struct gathered *found = &room->audit->gathered[room->audit->n_gathered++];
    fill(room, act, found);
    return found;
}

/* The place for this act; is_new: nothing of the same is gathered yet. */
static struct gathered *place(struct room *room, const struct audit_act *act, bool *is_new)
{
    cJSON *detail = act->detail ? act->detail : cJSON_CreateObject();
    struct gathered *found = find(room, act, detail);
    if (found && (room->now_us - found->last_us >= quiet_us || room->now_us - found->first_us >= at_most_us)) {
        end(room, (int)(found - room->audit->gathered));
        found = NULL;
    }
    *is_new = !found;
    if (!found)
        found = begin(room, act);
    found->newest_ms = clock_wall_ms();
    if (found->n == 0) {
        found->before = act->before;
        found->since_ms = found->newest_ms;
    }
    cJSON_Delete(found->detail);
    found->detail = detail;
    found->after = act->after;
    found->last_us = room->now_us;
    found->n++;
    return found;
}

static void fill_apart(const struct room *room, const struct audit_act *act, struct audit_apart *apart)
{
    fill(room, act, &apart->act);
    apart->act.newest_ms = clock_wall_ms();
    apart->act.after = act->after;
    apart->act.n = 1;
    apart->act.detail = act->detail ? act->detail : cJSON_CreateObject();
    apart->detail = write_detail(&apart->act);
    apart->row = row_of(&apart->act, apart->detail);
}

void audit_apart_finish(struct audit_apart *apart)
{
    cJSON_Delete(apart->act.detail);
    free(apart->detail);
}

void audit_set_apart(struct room *room, struct audit_apart *apart)
{
    room->audit->apart = apart;
}

void audit_tell(struct room *room, const struct audit_act *act)
{
    bool is_new;
    if (room->audit->apart) {
        audit_apart_finish(room->audit->apart);
        fill_apart(room, act, room->audit->apart);
        return;
    }
    struct gathered *gathered = place(room, act, &is_new);
    if (is_new)
        write_row(room, gathered);
}

void audit_gather(struct room *room, const struct audit_act *act)
{
    bool is_new;
    (void)place(room, act, &is_new);
}

void audit_flush(struct room *room, const struct member *by)
{
    for (int i = 0; i < room->audit->n_gathered;)
        if (!by || strcmp(room->audit->gathered[i].member, by->id) == 0)
            end(room, i);
        else
            i++;
}

int64_t audit_settle(struct room *room)
{
    int64_t due_us = INT64_MAX;
    for (int i = 0; i < room->audit->n_gathered;) {
        const struct gathered *act = &room->audit->gathered[i];
        int64_t own_us = act->last_us + quiet_us;
        if (act->first_us + at_most_us < own_us)
            own_us = act->first_us + at_most_us;
        if (room->now_us >= own_us) {
            end(room, i);
            continue;
        }
        due_us = own_us < due_us ? own_us : due_us;
        i++;
    }
    return due_us;
}

void audit_free(struct room *room)
{
    while (room->audit->n_gathered)
        drop(room, 0);
    free(room->audit);
    room->audit = NULL;
}

/* ---- the scene -------------------------------------------------------------------------------------------------- */

static const cJSON *draft_of(const cJSON *scene)
{
    return cJSON_GetObjectItemCaseSensitive(cJSON_GetObjectItemCaseSensitive(scene, "beam"), "draft");
}

/* Present and absent alike. */
static bool is_same(const cJSON *a, const cJSON *b)
{
    return (!a && !b) || json_equal(a, b);
}

static bool is_drafted(const cJSON *draft)
{
    return json_flag(draft, "enabled", false);
}

static bool draft_changed(const cJSON *before, const cJSON *after)
{
    return is_drafted(before) != is_drafted(after) ||
           (is_drafted(after) && !is_same(cJSON_GetObjectItemCaseSensitive(before, "line"),
                                          cJSON_GetObjectItemCaseSensitive(after, "line")));
}

/* The fields that weigh a dose and differ, with their new values; maps with the entries that differ. NULL: none. */
static cJSON *weights_changed(const cJSON *before, const cJSON *after)
{
    static const char *const names[] = { "id",  "factor",  "blood_ppm",    "irradiation_min", "tissue",
                                         "sum", "weights", "weights_name", "accepted" };
    const cJSON *old = cJSON_GetObjectItemCaseSensitive(before, "dose"),
                *new = cJSON_GetObjectItemCaseSensitive(after, "dose");
    cJSON *changed = NULL;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        const cJSON *was = cJSON_GetObjectItemCaseSensitive(old, names[i]),
                    *is = cJSON_GetObjectItemCaseSensitive(new, names[i]), *entry;
        if (is_same(was, is))
            continue;
        if (!changed)
            changed = cJSON_CreateObject();
        if (!cJSON_IsObject(is)) {
            json_add(changed, names[i], is ? cJSON_Duplicate(is, true) : cJSON_CreateNull());
            continue;
        }
        cJSON *entries = cJSON_AddObjectToObject(changed, names[i]);
        cJSON_ArrayForEach(entry, is) if (!is_same(cJSON_GetObjectItemCaseSensitive(was, entry->string), entry))
            json_add(entries, entry->string, cJSON_Duplicate(entry, true));
        cJSON_ArrayForEach(entry, was) if (!cJSON_GetObjectItemCaseSensitive(is, entry->string))
            json_add(entries, entry->string, cJSON_CreateNull());
    }
    return changed;
}

/* The names of the fields that changed, with those inside maps, as the key of a gesture: changes of other fields are
 * other rows. Names too long for a key are named by their SHA-256. */
static void name_fields(const cJSON *changed, char *key, size_t size)
{
    cJSON *names = cJSON_CreateArray();
    const cJSON *field, *entry;
    char hex[DIGEST_TEXT];
    cJSON_ArrayForEach(field, changed)
    {
        json_append(names, cJSON_CreateString(field->string));
        const cJSON *map = cJSON_IsObject(field) ? field : NULL;
        cJSON_ArrayForEach(entry, map) json_append(names, cJSON_CreateString(entry->string));
    }
    char *text = json_print(names);
    digest_text(text ? text : "", hex);
    (void)snprintf(key, size, "%.63s", text && strlen(text) < size ? text : hex);
    cJSON_Delete(names);
    free(text);
}

bool audit_is_of_scene(const cJSON *before, const cJSON *after)
{
    cJSON *weights = weights_changed(before, after);
    const bool is_weighed = weights != NULL;
    cJSON_Delete(weights);
    return is_weighed || draft_changed(draft_of(before), draft_of(after));
}

void audit_scene(struct room *room, const cJSON *before, const struct member *by)
{
    const cJSON *old = draft_of(before), *new = draft_of(room->shared.scene);
    struct audit_act act = { .by = by,
                             .address = room->call.address,
                             .before = (int64_t)room->shared.revision - 1,
                             .after = room->shared.revision,
                             .action = "weights" };
    char key[sizeof room->audit->gathered[0].key];
    if (!room->callbacks.audited)
        return;
    act.detail = weights_changed(before, room->shared.scene);
    if (act.detail) {
        name_fields(act.detail, key, sizeof key);
        act.key = key;
        audit_gather(room, &act);
    }
    if (!draft_changed(old, new))
        return;
    act.detail = is_drafted(new) ? cJSON_Duplicate(cJSON_GetObjectItemCaseSensitive(new, "line"), true) : NULL;
    if (is_drafted(old) && is_drafted(new)) {
        act.action = "draft-changed";
        act.key = "line";
        audit_gather(room, &act);
    } else {
        if (by)
            audit_flush(room, by);
        act.action = is_drafted(new) ? "draft-made" : "draft-reset";
        act.key = NULL;
        audit_tell(room, &act);
    }
}

/* Checks what is written of the record of a review: record_body.h. */
#include "server/room/items/record_body.h"

#include <stdio.h>
#include <string.h>

#include "core/base/clock.h"
#include "server/auth/digest.h"
#include "server/room/items/item_list.h"
#include "server/room/out/audit.h"
#include "server/room/state/body_check.h"
#include "server/room/state/roles.h"
#include "server/room/state/who.h"

static bool is_of_record(enum wire_item_kind kind)
{
    return kind == WIRE_ITEM_KIND_CHECK || kind == WIRE_ITEM_KIND_DECISION || kind == WIRE_ITEM_KIND_SIGNATURE;
}

static bool is_append_only(enum wire_item_kind kind)
{
    return kind == WIRE_ITEM_KIND_DECISION || kind == WIRE_ITEM_KIND_SIGNATURE;
}

static cJSON *body_of(const struct item *item, cJSON **row)
{
    *row = json_read(item->row, strlen(item->row), NULL);
    return cJSON_GetObjectItemCaseSensitive(*row, "body");
}

/* ---- fields ----------------------------------------------------------------------------------------------------- */

static bool check_word(const cJSON *body, const char *name, const struct field_words *words, struct problem *problem)
{
    char where[64], expected[160] = "";
    const char *word = json_text(body, name);
    (void)snprintf(where, sizeof where, "/body/%s", name);
    for (size_t i = 0; i < words->n; i++) {
        if (word && strcmp(word, words->words[i]) == 0)
            return true;
        (void)snprintf(expected + strlen(expected), sizeof expected - strlen(expected), "%s%s", i ? ", " : "",
                       words->words[i]);
    }
    return problem_set(problem, PROBLEM_VALIDATION, where, word ? "enum" : "required", "%s is \"%.40s\", expected %s",
                       where, word ? word : "", expected);
}

/* Text that may be empty or left out. */
static bool check_optional(const cJSON *body, const char *name, size_t most, struct problem *problem)
{
    char where[64];
    const cJSON *value = cJSON_GetObjectItemCaseSensitive(body, name);
    (void)snprintf(where, sizeof where, "/body/%s", name);
    return !value || (cJSON_IsString(value) && !value->valuestring[0]) || body_check_text(value, where, most, problem);
}

double record_statement_ms(const struct room *room)
{
    const cJSON *statement = cJSON_GetObjectItemCaseSensitive(room->shared.plan, "statement");
    const char *state = json_text(statement, "state");
    return state && strcmp(state, "used") == 0 ? json_number(statement, "time_ms", 0) : 0;
}

/* Whether it was written of the files that the room has read, and of the same patient. */
static bool is_of_now(const struct room *room, const cJSON *body)
{
    const char *revision = json_text(body, "plan_revision");
    const double statement_ms = json_number(body, "statement_ms", 0); /* of before there were statements: none */
    return revision && strcmp(revision, room->files.revision) == 0 && !(statement_ms < record_statement_ms(room)) &&
           !(statement_ms > record_statement_ms(room));
}

/* Revision, statement and role: as they were kept, else those of now. */
static void give_place(const struct room *room, const cJSON *body, bool is_restored, cJSON *read)
{
    const char *revision = is_restored ? json_text(body, "plan_revision") : room->files.revision;
    const char *role = is_restored ? json_text(body, "role") : NULL;
    if (!is_restored && room->items->writer)
        role = wire_member_role_words.words[room->items->writer->role];
    cJSON_AddStringToObject(read, "plan_revision", revision && strlen(revision) <= 64 ? revision : "");
    const double statement_ms = is_restored ? json_number(body, "statement_ms", 0) : record_statement_ms(room);
    if (statement_ms > 0)
        cJSON_AddNumberToObject(read, "statement_ms", statement_ms);
    cJSON_AddStringToObject(read, "role", role && strlen(role) < 16 ? role : "");
}

/* corrects: "", or an earlier item of the same kind. */
static bool check_corrects(const struct room *room, const cJSON *body, enum wire_item_kind kind, bool is_restored,
                           struct problem *problem)
{
    static const char where[] = "/body/corrects";
    const cJSON *corrects = cJSON_GetObjectItemCaseSensitive(body, "corrects");
    if (!corrects || (cJSON_IsString(corrects) && !corrects->valuestring[0]))
        return true;
    if (!body_check_id(corrects, where, problem))
        return false;
    const struct item *item = items_find(room, corrects->valuestring);
    return is_restored || (item && item->kind == kind) ||
           problem_set(problem, PROBLEM_VALIDATION, where, "unknown-id", "there is no %s \"%s\" to correct",
                       wire_item_kind_words.words[kind], corrects->valuestring);
}

/* ---- kinds ------------------------------------------------------------------------------------------------------ */

static bool is_of_entry(const struct room *room, const struct item *item, const char *entry)
{
    if (item->kind != WIRE_ITEM_KIND_CHECK)
        return false;
    cJSON *row, *body = body_of(item, &row);
    const char *found = json_text(body, "entry");
    const bool is_of = found && strcmp(found, entry) == 0 && is_of_now(room, body);
    cJSON_Delete(row);
    return is_of;
}

/* Whether another check of the same entry stands under the same revision, or is being kept. */
static bool entry_is_there(const struct room *room, const char *entry, const struct item *before)
{
    for (const struct item *item = room->items->first; item; item = item->next)
        if (item != before && is_of_entry(room, item, entry))
            return true;
    for (const struct keeping *keeping = room->items->keeping; keeping; keeping = keeping->next)
        if (!(before && strcmp(keeping->item.id, before->id) == 0) && is_of_entry(room, &keeping->item, entry))
            return true;
    return false;
}

static bool check_entry(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                        struct problem *problem)
{
    static const char where[] = "/body/entry";
    const cJSON *entry = cJSON_GetObjectItemCaseSensitive(body, "entry");
    const char *id = cJSON_IsString(entry) ? entry->valuestring : "";
    if (entry && !cJSON_IsString(entry))
        return body_refuse_type(problem, where, "an id");
    if (id[0] && !body_check_id(entry, where, problem))
        return false;
    if (before) {
        cJSON *row, *old = body_of(before, &row);
        const char *was = json_text(old, "entry");
        const bool is_same = was && strcmp(was, id) == 0;
        cJSON_Delete(row);
        if (!is_same)
            return problem_set(problem, PROBLEM_VALIDATION, where, "enum",
                               "an entry of the checklist stays what it is");
    }
    if (id[0] && !is_restored && entry_is_there(room, id, before))
        return problem_set(problem, PROBLEM_CONFLICT, where, "",
                           "somebody has marked this entry of the checklist meanwhile: change that");
    return true;
}

static bool is_ok(const cJSON *body)
{
    const char *state = json_text(body, "state");
    return state && strcmp(state, "ok") == 0;
}

/* The patient that the plan document shows, masked; NULL: the files name nobody. */
static const char *patient_of(const struct room *room)
{
    const cJSON *patients = cJSON_GetObjectItemCaseSensitive(room->shared.plan, "patients");
    const int shown = (int)json_number(room->shared.plan, "shown_patient", 0);
    return json_text(cJSON_GetArrayItem(patients, shown), "masked");
}

static bool has_read_identity(const struct room *room)
{
    const struct member *writer = room->items->writer;
    return writer && writer->read_identity_us &&
           room->now_us - writer->read_identity_us <= RECORD_IDENTITY_MS * INT64_C(1000);
}

/* Gives the patient that the entry "identity" keeps, masked, a text for cJSON_Delete; NULL: none. False with problem:
 * the entry is OK by the word of who has just read whom the plan is of, or of a phantom. */
static bool check_seen(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                       cJSON **seen, struct problem *problem)
{
    const char *entry = json_text(body, "entry"), *patient = patient_of(room);
    *seen = NULL;
    if (!entry || strcmp(entry, "identity") != 0 || !is_ok(body))
        return true;
    cJSON *row = NULL, *old = before && !is_restored ? body_of(before, &row) : NULL;
    const cJSON *kept = is_restored ? body : is_ok(old) ? old : NULL;
    if (kept && json_text(kept, "seen"))
        *seen = cJSON_CreateString(json_text(kept, "seen"));
    cJSON_Delete(row);
    if (kept || json_flag(room->shared.plan, "is_phantom", false))
        return true;
    if (!patient)
        return problem_set(problem, PROBLEM_FORBIDDEN, "/body/state", "identity",
                           "the files do not say whom the plan is of: this entry is open or an issue");
    if (!has_read_identity(room))
        return problem_set(problem, PROBLEM_FORBIDDEN, "/body/state", "identity",
                           "whom the plan is of is OK by the word of who has it shown in this room: show it to "
                           "yourself first");
    *seen = cJSON_CreateString(patient);
    return true;
}

/* Copies the fields before the plan's revision; that and the role are given. */
static cJSON *read_fields(const struct room *room, const cJSON *body, const char *const *names, bool is_restored)
{
    cJSON *read = cJSON_CreateObject();
    for (; strcmp(*names, "plan_revision") != 0; names++)
        json_copy_text(read, body, *names);
    give_place(room, body, is_restored, read);
    return read;
}

cJSON *record_read_check(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                         struct problem *problem)
{
    static const char *const names[] = { "entry", "text", "state",        "comment", "plan_revision",
                                         "role",  "seen", "statement_ms", NULL };
    cJSON *seen;
    if (!body_names_are(body, names, "/body", problem) ||
        !body_check_text(cJSON_GetObjectItemCaseSensitive(body, "text"), "/body/text", RECORD_MAX_ENTRY, problem) ||
        !check_word(body, "state", &wire_check_state_words, problem) ||
        !check_optional(body, "comment", RECORD_MAX_TEXT, problem) ||
        !check_entry(room, body, before, is_restored, problem) ||
        !check_seen(room, body, before, is_restored, &seen, problem))
        return NULL;
    cJSON *read = read_fields(room, body, names, is_restored);
    if (seen)
        json_add(read, "seen", seen);
    return read;
}

cJSON *record_read_decision(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                            struct problem *problem)
{
    static const char *const names[] = {
        "decision", "text", "corrects", "plan_revision", "role", "statement_ms", NULL
    };
    (void)before; /* never changed */
    if (!body_names_are(body, names, "/body", problem) ||
        !check_word(body, "decision", &wire_decision_words, problem) ||
        !check_optional(body, "text", RECORD_MAX_TEXT, problem) ||
        !check_corrects(room, body, WIRE_ITEM_KIND_DECISION, is_restored, problem))
        return NULL;
    return read_fields(room, body, names, is_restored);
}

/* The proof of a signature: as it was kept, else that of who writes. */
static void give_proof(const struct identity *who, const cJSON *kept, cJSON *read)
{
    const bool is_user = who ? who_is_user(who) : json_flag(kept, "signed_in", false);
    if (!who && !cJSON_HasObjectItem(kept, "signed_in")) /* of before there was sign-in: it stays as it is */
        return;
    cJSON_AddBoolToObject(read, "signed_in", is_user);
    if (!is_user)
        return;
    if (who) {
        cJSON_AddStringToObject(read, "user", who->user);
        cJSON_AddNumberToObject(read, "proved_ms", (double)who->proved_ms);
        return;
    }
    json_copy_text(read, kept, "user");
    cJSON_AddNumberToObject(read, "proved_ms", json_number(kept, "proved_ms", 0));
}

cJSON *record_read_signature(const struct room *room, const cJSON *body, const struct item *before, bool is_restored,
                             struct problem *problem)
{
    static const char *const names[] = { "name",      "meaning", "corrects",  "plan_revision", "role",
                                         "signed_in", "user",    "proved_ms", "statement_ms",  NULL };
    const struct identity *who = is_restored || !room->items->writer ? NULL : who_acts(room, room->items->writer);
    const bool is_user = who && who_is_user(who); /* who signs then with the name of the sign-in */
    (void)before;                                 /* never changed */
    if (!body_names_are(body, names, "/body", problem) ||
        (!is_user &&
         !body_check_text(cJSON_GetObjectItemCaseSensitive(body, "name"), "/body/name", RECORD_MAX_NAME, problem)) ||
        !check_word(body, "meaning", &wire_meaning_words, problem) ||
        !check_corrects(room, body, WIRE_ITEM_KIND_SIGNATURE, is_restored, problem))
        return NULL;
    cJSON *given = cJSON_Duplicate(body, true);
    if (is_user) {
        cJSON_DeleteItemFromObjectCaseSensitive(given, "name");
        cJSON_AddStringToObject(given, "name", who->name[0] ? who->name : who->user);
    }
    cJSON *read = read_fields(room, given, names, is_restored);
    cJSON_Delete(given);
    give_proof(who, body, read);
    return read;
}

/* ---- rights ----------------------------------------------------------------------------------------------------- */

/* Guests look, point and, by their link, write notes; a record is of people who are known. */
static bool is_no_guest(const struct member *member, const char *where, struct problem *problem)
{
    return !member->is_guest ||
           problem_set(problem, PROBLEM_FORBIDDEN, where, "role", "a guest writes nothing into the record of a review");
}

/* Without sign-in, where a name is no more than a word, presenters alone decide. */
static bool may_decide(const struct room *room, const struct member *member, struct problem *problem)
{
    const bool is_machine = who_is_machine(who_acts(room, member));
    const enum wire_member_role least = is_machine ? WIRE_MEMBER_ROLE_PRESENTER : WIRE_MEMBER_ROLE_REVIEWER;
    if (role_rank(member->role) >= role_rank(least))
        return true;
    return problem_set(problem, PROBLEM_FORBIDDEN, "/kind", "role",
                       "only a member of role presenter writes down what was decided");
}

/* A signature is of a person who has proved just now who they are; without sign-in it says that it is not. */
static bool may_sign(const struct room *room, const struct member *member, struct problem *problem)
{
    const struct identity *who = who_acts(room, member);
    const int64_t age_ms = clock_wall_ms() - who->proved_ms;
    if (who_is_machine(who))
        return !room->is_open_to_everybody ||
               problem_set(problem, PROBLEM_FORBIDDEN, "/kind", "open",
                           "this server is open to everybody who reaches it: nothing can be signed");
    if (!who_is_user(who))
        return problem_set(problem, PROBLEM_FORBIDDEN, "/kind", "role", "only who has signed in signs");
    if (who->source == IDENTITY_TOKEN || who->proved_ms <= 0)
        return problem_set(problem, PROBLEM_FORBIDDEN, "/kind", "unproved",
                           "this sign-in does not say when the person proved who they are, so nothing can be signed");
    return (age_ms >= -RECORD_PROOF_MS && age_ms <= RECORD_PROOF_MS) ||
           problem_set(problem, PROBLEM_FORBIDDEN, "/kind", "confirm", "who signs confirms first who they are");
}

bool record_may_write(const struct room *room, const struct member *member, enum wire_item_kind kind,
                      struct problem *problem)
{
    if (!is_of_record(kind))
        return true;
    if (!is_no_guest(member, "/kind", problem))
        return false;
    if (kind == WIRE_ITEM_KIND_DECISION && !may_decide(room, member, problem))
        return false;
    if (kind == WIRE_ITEM_KIND_SIGNATURE && !may_sign(room, member, problem))
        return false;
    if (!room->files.revision[0]) {
        problem_set(problem, PROBLEM_BUSY, "", "",
                    "the revision of the plan's files is not known yet: GET /api/v1/plans/%s/revision", room->plan_id);
        problem->retry_after_ms = 1000;
        return false;
    }
    if (is_append_only(kind) && room->files.changed_ms)
        return problem_set(
            problem, PROBLEM_CONFLICT, "", "files",
            "the plan's files have changed on the disk since they were read: nothing is decided or signed "
            "until they are read anew");
    return !is_append_only(kind) || audit_has_place(room, problem);
}

bool record_may_change(const struct room *room, const struct member *member, const struct item *item,
                       struct problem *problem)
{
    if (is_of_record(item->kind) && !is_no_guest(member, "/item", problem))
        return false;
    if (is_append_only(item->kind))
        return problem_set(problem, PROBLEM_FORBIDDEN, "/item", "append-only",
                           "a %s is never changed or deleted: write another one that corrects it",
                           wire_item_kind_words.words[item->kind]);
    if (item->kind != WIRE_ITEM_KIND_CHECK)
        return true;
    cJSON *row, *body = body_of(item, &row);
    const bool is_now = is_of_now(room, body);
    cJSON_Delete(row);
    return is_now ||
           problem_set(problem, PROBLEM_FORBIDDEN, "/item", "append-only",
                       "this entry was written of other files, or before it was stated otherwise whom the plan is "
                       "of, and stays");
}

/* The act without its words. */
static struct audit_act act_of(const struct room *room, const struct item *item, const struct member *by)
{
    const struct audit_act act = { .by = by,
                                   .action = wire_item_kind_words.words[item->kind],
                                   .detail = cJSON_CreateObject(),
                                   .before = -1,
                                   .after = room->shared.revision };
    cJSON_AddStringToObject(act.detail, "item", item->id);
    cJSON_AddNumberToObject(act.detail, "version", item->version);
    return act;
}

void record_audit(struct room *room, const struct item *item, const struct member *by, const char *record)
{
    char hex[DIGEST_TEXT];
    if (item->kind == WIRE_ITEM_KIND_ACCEPTANCE) /* acceptance.h */
        return;
    const struct audit_act act = act_of(room, item, by);
    digest_text(item->row, hex);
    cJSON_AddStringToObject(act.detail, "sha256", hex);
    if (item->hidden_by[0])
        cJSON_AddTrueToObject(act.detail, "hidden");
    if (is_append_only(item->kind)) {
        cJSON *row, *body = body_of(item, &row);
        json_copy_text(act.detail, body, item->kind == WIRE_ITEM_KIND_DECISION ? "decision" : "meaning");
        if (item->kind == WIRE_ITEM_KIND_SIGNATURE)
            json_copy_text(act.detail, body, "name");
        json_copy_text(act.detail, body, "corrects");
        json_copy_text(act.detail, body, "plan_revision");
        if (json_number(body, "statement_ms", 0) > 0)
            cJSON_AddNumberToObject(act.detail, "statement_ms", json_number(body, "statement_ms", 0));
        cJSON_Delete(row);
    }
    if (record) {
        digest_text(record, hex);
        cJSON_AddStringToObject(act.detail, "record_sha256", hex);
    }
    audit_tell(room, &act);
}

void record_audit_deleted(struct room *room, const struct item *item, const struct member *by)
{
    const struct audit_act act = act_of(room, item, by);
    cJSON_AddBoolToObject(act.detail, "deleted", true);
    audit_tell(room, &act);
}

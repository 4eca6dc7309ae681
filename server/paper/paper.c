/* Puts the paper of a record together: head, foot, and the blocks of front.c and parts.c. */
#include "server/paper/paper.h"

#include <stdio.h>
#include <string.h>

#include "server/paper/blocks.h"

static const char research[] = "Research use only. Not a medical device; not for diagnosis or treatment decisions.";
static const char open_words[] =
    "This server is open to everybody who reaches it. Anybody sees every plan here, under any name. Nothing can be signed.";

static int shown_patient(const struct paper *paper)
{
    const char *image = json_text(cJSON_GetObjectItemCaseSensitive(paper->kept, "fits"), "image");
    double index = json_number(paper->plan, "shown_patient", -1);
    if (!(index >= 0))
        index = json_number(paper_shown_dose(paper), "patient", -1);
    if (!(index >= 0))
        index = json_number(paper_part_of(paper, "images", image), "patient", 0);
    return index >= 0 && index < 1e6 ? (int)index : 0;
}

static void add_field(cJSON *fields, const char *label, cJSON *text, cJSON *more)
{
    cJSON *field = cJSON_CreateObject();
    cJSON_AddStringToObject(field, "label", label);
    json_add(field, "text", text);
    json_add(field, "more", more);
    json_append(fields, field);
}

/* "Approved 12 Nov 2026" as the plan's file says it. */
static cJSON *approval_of(const cJSON *treatment)
{
    static const char *const words[][2] = { { "APPROVED", "Approved" },
                                            { "UNAPPROVED", "Unapproved" },
                                            { "REJECTED", "Rejected" } };
    const char *state = json_text(treatment, "approval"), *date = json_text(treatment, "review_date");
    if (!state || !state[0])
        return written("approval not stated");
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strcmp(state, words[i][0]) == 0)
            state = words[i][1];
    return written_format("%.40s%s%.20s", state, date && date[0] ? " " : "", date ? date : "");
}

static const char *plan_label(const struct paper *paper, const cJSON *treatment)
{
    const char *label = json_text(treatment, "label"), *name = json_text(paper->plan, "name");
    return label && label[0] ? label : name && name[0] ? name : paper->source->plan;
}

/* "stated by Anna Weiss, 27 Nov 2026, 14:18", or why files of several patients count as of one; "" where nobody said.
 */
static cJSON *stated_of(const struct paper *paper)
{
    const cJSON *statement = cJSON_GetObjectItemCaseSensitive(paper->plan, "statement");
    const char *kind = json_text(statement, "kind"), *state = json_text(statement, "state"),
               *by = json_text(statement, "by"), *words = json_text(statement, "words");
    char time[PAPER_TIME];
    if (!kind || !state || strcmp(state, "used") != 0)
        return written("");
    (void)written_time(paper, json_number(statement, "time_ms", 0), time);
    if (strcmp(kind, "one-person") != 0)
        return written_format("stated by %.160s, %s", by ? by : "", time);
    return written_format("the files of %d patients count as of one person, stated by %.160s, %s: %.300s",
                          cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(paper->plan, "patients")), by ? by : "",
                          time, words ? words : "");
}

static void add_identity(struct paper *paper)
{
    cJSON *identity = cJSON_AddObjectToObject(paper->json, "identity"),
          *fields = cJSON_AddArrayToObject(identity, "fields");
    const int index = shown_patient(paper);
    const cJSON *patient = cJSON_GetArrayItem(cJSON_GetObjectItemCaseSensitive(paper->plan, "patients"), index),
                *treatment = paper_treatment(paper);
    const bool is_phantom = json_flag(paper->plan, "is_phantom", false);
    const char *masked = json_text(patient, "masked"), *label = plan_label(paper, treatment),
               *who = masked && masked[0] ? masked
                      : is_phantom        ? "PHANTOM"
                                          : "identity unknown";
    add_field(fields, "Patient", written(who), stated_of(paper));
    add_field(fields, "Id, issuer", written(masked && masked[0] ? "masked" : "\xe2\x80\x93"), written(""));
    add_field(fields, "Born", written(masked && masked[0] ? "masked" : "\xe2\x80\x93"), written(""));
    add_field(fields, "Plan, approval", written(label), approval_of(treatment));
    json_add(identity, "line", written_format("%.200s \xc2\xb7 plan %.200s", who, label));
    json_add(identity, "plan", written(label));
    cJSON_AddBoolToObject(identity, "is_masked", true);
    cJSON_AddNumberToObject(identity, "patient", index);
    if (paper->source->is_open)
        cJSON_AddStringToObject(paper->json, "strip", open_words);
}

void paper_name_patient(cJSON *paper, const cJSON *patient)
{
    static const char *const fields[] = { "name", "id", "birth_date" };
    cJSON *identity = cJSON_GetObjectItemCaseSensitive(paper, "identity"),
          *list = cJSON_GetObjectItemCaseSensitive(identity, "fields");
    const char *plan = json_text(identity, "plan"), *issuer = json_text(patient, "issuer");
    for (int i = 0; i < 3; i++) {
        cJSON *field = cJSON_GetArrayItem(list, i);
        const char *text = json_text(patient, fields[i]);
        cJSON_DeleteItemFromObjectCaseSensitive(field, "text");
        json_add(field, "text", written(text && text[0] ? text : "not stated"));
        if (i == 1) {
            cJSON_DeleteItemFromObjectCaseSensitive(field, "more");
            json_add(field, "more", written(issuer));
        }
    }
    const char *name = json_text(patient, "name"), *id = json_text(patient, "id"),
               *born = json_text(patient, "birth_date");
    cJSON *line = written_format("%.200s \xc2\xb7 %.80s \xc2\xb7 %.20s \xc2\xb7 plan %.200s", name ? name : "",
                                 id ? id : "", born ? born : "", plan ? plan : "");
    cJSON_DeleteItemFromObjectCaseSensitive(identity, "line");
    json_add(identity, "line", line);
    cJSON_DeleteItemFromObjectCaseSensitive(identity, "is_masked");
    cJSON_AddBoolToObject(identity, "is_masked", false);
}

static void read_zone(struct paper *paper)
{
    const cJSON *zone = cJSON_GetObjectItemCaseSensitive(paper->kept, "zone");
    const char *name = json_text(zone, "name");
    const double offset = json_number(zone, "offset_min", 0);
    paper->offset_min = offset > -24 * 60 && offset < 24 * 60 ? (int)offset : 0;
    (void)snprintf(paper->zone, sizeof paper->zone, "%.20s", name ? name : "UTC");
}

/* With the name that the room had when it was decided, where it had one. */
static cJSON *title_of(const struct paper *paper)
{
    const char *name = json_text(paper->record, "room_name");
    return name && name[0] ? written_format("Record of a plan review \xc2\xb7 %.320s", name)
                           : written("Record of a plan review");
}

cJSON *paper_of_record(const struct paper_source *source)
{
    struct paper paper = { .json = cJSON_CreateObject(), .blocks = cJSON_CreateArray(), .source = source };
    char time[PAPER_TIME];
    paper.record = cJSON_GetObjectItemCaseSensitive(source->body, "record");
    paper.kept = cJSON_GetObjectItemCaseSensitive(source->body, "kept");
    paper.scene = cJSON_GetObjectItemCaseSensitive(source->body, "scene");
    paper.plan = cJSON_GetObjectItemCaseSensitive(paper.kept, "plan");
    read_zone(&paper);
    cJSON_AddStringToObject(paper.json, "format", "beamroom-paper");
    cJSON_AddNumberToObject(paper.json, "version", 1);
    json_add(paper.json, "title", title_of(&paper));
    json_add(paper.json, "under",
             written_format("State of the decision, %s",
                            written_exact((double)source->time_ms, paper.offset_min, paper.zone, time)));
    add_identity(&paper);
    json_add(paper.json, "foot", written_format("record %.63s of room %.63s", source->id, source->room));
    cJSON_AddStringToObject(paper.json, "use", research);
    json_add(paper.json, "printed",
             written_format("printed %s",
                            written_exact((double)source->now_ms, source->now_offset_min, source->now_zone, time)));
    cJSON_AddNumberToObject(paper.json, "time_ms", (double)source->time_ms);
    front_add(&paper);
    parts_add(&paper);
    json_add(paper.json, "blocks", paper.blocks);
    return paper.json;
}

/* The paper of a kept decision: as blocks for the page, masked or with the patient's name for who may read that. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/clock.h"
#include "core/base/mem.h"
#include "server/auth/digest.h"
#include "server/http/api_access.h"
#include "server/http/api_audit.h"
#include "server/http/api_handlers.h"
#include "server/http/api_queries.h"
#include "server/http/printing.h"
#include "server/paper/paper.h"

struct paper_call { /* while the patient is asked for */
    cJSON *paper;
    struct printing *printing;       /* with the pictures, of a call for the PDF; else NULL */
    char identity_hash[DIGEST_TEXT]; /* as it was kept; "": none was */
    char plan[64];
};

static cJSON *read_text(const char *text)
{
    return text ? json_read(text, strlen(text), NULL) : NULL;
}

static cJSON *make_paper(const struct api *api, const struct net_record *record, const cJSON *body)
{
    cJSON *item = read_text(record->item), *signatures = read_text(record->signatures),
          *decisions = read_text(record->decisions);
    const int64_t now_ms = clock_wall_ms();
    const time_t now = (time_t)(now_ms / 1000);
    struct tm local = { 0 };
    const bool is_known = localtime_r(&now, &local) != NULL;
    const struct paper_source source = { .id = record->id,
                                         .room = record->room,
                                         .plan = record->plan,
                                         .hash = record->hash,
                                         .time_ms = record->time_ms,
                                         .now_ms = now_ms,
                                         .now_offset_min = is_known ? (int)(local.tm_gmtoff / 60) : 0,
                                         .now_zone = is_known && local.tm_zone ? local.tm_zone : "UTC",
                                         .item = item,
                                         .body = body,
                                         .signatures = signatures,
                                         .decisions = decisions,
                                         .is_open = api->doors.is_open };
    cJSON *paper = paper_of_record(&source);
    cJSON_Delete(item);
    cJSON_Delete(signatures);
    cJSON_Delete(decisions);
    return paper;
}

static void paper_call_destroy(struct paper_call *paper)
{
    cJSON_Delete(paper->paper);
    printing_destroy(paper->printing);
    free(paper);
}

/* Answers the call with the paper, which is taken. */
static void answer_paper(struct call *call, struct paper_call *paper)
{
    call->context = NULL;
    if (paper->printing) {
        struct printing *printing = paper->printing;
        paper->printing = NULL;
        printing_start(call->api, call, printing, paper->paper);
    } else {
        call_answer_json(call, 200, paper->paper);
        paper->paper = NULL;
    }
    paper_call_destroy(paper);
}

/* The patient is named only where the files still name the one of the decision. */
static void patient_came(void *context, struct packet *answer, const struct problem *problem)
{
    struct call *call = context;
    struct paper_call *paper = call->context;
    struct problem other;
    const cJSON *patients = answer ? cJSON_GetObjectItemCaseSensitive(answer->answer.body, "patients") : NULL;
    char hash[DIGEST_TEXT] = "";
    char *text = patients && cJSON_GetArraySize(patients) ? json_print(patients) : NULL;
    if (text)
        digest_text(text, hash);
    free(text);
    if (!problem && strcmp(hash, paper->identity_hash) != 0) {
        problem_set(&other, PROBLEM_CONFLICT, "/identity", "identity",
                    "the plan's files name another patient than at the decision: it is printed masked alone");
        problem = &other;
    }
    if (problem) {
        call->context = NULL;
        call_answer_problem(call, problem);
        paper_call_destroy(paper);
        return;
    }
    const cJSON *patient =
        cJSON_GetArrayItem(patients,
                           (int)json_number(cJSON_GetObjectItemCaseSensitive(paper->paper, "identity"), "patient", 0));
    if (patient)
        paper_name_patient(paper->paper, patient);
    net_audit_by(((struct api *)call->api)->net, &call->identity, call->client, "", paper->plan, "identity",
                 cJSON_CreateObject());
    answer_paper(call, paper);
}

static bool wants_identity(const struct call *call, bool *is_wanted, struct problem *problem)
{
    const char *word = call_query(call, "identity");
    *is_wanted = word && strcmp(word, "true") == 0;
    return !word || *is_wanted || strcmp(word, "false") == 0 ||
           problem_set(problem, PROBLEM_VALIDATION, "/identity", "type",
                       "identity is \"%.20s\", expected true or false", word);
}

/* Asks for the patient, or answers without. */
static void name_patient(struct api *api, struct call *call, struct paper_call *paper, bool is_wanted)
{
    struct problem problem;
    struct packet question;
    if (!is_wanted) {
        answer_paper(call, paper);
        return;
    }
    if (api_may_name(api, call, paper->plan, &problem)) {
        call->context = paper;
        packet_init(&question, PACKET_IDENTITY);
        api_query_send(api, call, paper->plan, &question, patient_came);
        return;
    }
    call_answer_problem(call, &problem);
    paper_call_destroy(paper);
}

/* Reads the paper's size and copies the pictures for a call for the PDF. False with problem. */
static bool begin_printing(const struct call *call, const struct net_record *record, struct printing **printing,
                           struct problem *problem)
{
    const char *word = call_query(call, "paper");
    const bool is_letter = word && strcmp(word, "letter") == 0;
    *printing = NULL;
    if (!strstr(call->route, "record.pdf"))
        return true;
    if (word && !is_letter && strcmp(word, "a4") != 0)
        return problem_set(problem, PROBLEM_VALIDATION, "/paper", "enum", "paper is \"%.20s\", expected a4 or letter",
                           word);
    *printing = printing_create(record, is_letter, problem);
    return *printing != NULL;
}

static void record_was_read(void *context, const struct net_record *records, size_t n, const struct problem *problem)
{
    struct call *call = context;
    struct problem other;
    bool is_wanted;
    struct printing *printing = NULL;
    if (!api_record_may_be_seen(call, records, n, problem))
        return;
    if (strcmp(records[0].kind, "decision") != 0)
        problem_set(&other, PROBLEM_CONFLICT, "", "kind",
                    "a %.20s stands on the paper of the decision that it was written under", records[0].kind);
    else if (wants_identity(call, &is_wanted, &other) && begin_printing(call, &records[0], &printing, &other)) {
        struct paper_call *paper = mem_new(sizeof *paper);
        cJSON *body = read_text(records[0].body);
        const cJSON *kept = cJSON_GetObjectItemCaseSensitive(body, "kept");
        const char *hash = json_text(kept, "identity_sha256");
        *paper = (struct paper_call){ .paper = make_paper(call->api, &records[0], body), .printing = printing };
        (void)snprintf(paper->identity_hash, sizeof paper->identity_hash, "%.64s", hash ? hash : "");
        (void)snprintf(paper->plan, sizeof paper->plan, "%.63s", records[0].plan);
        cJSON_Delete(body);
        name_patient(call->api, call, paper, is_wanted);
        return;
    }
    call_answer_problem(call, &other);
}

void api_record_paper(struct api *api, struct call *call)
{
    struct problem problem;
    if (api_audit_export(api, call, "record") &&
        !net_read_records(api->net, call->ids[0], "", record_was_read, call, &problem))
        call_answer_problem(call, &problem);
}

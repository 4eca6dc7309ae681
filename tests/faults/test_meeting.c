/* Meetings, while an allocation fails: a copy, what is written of one and what is read of it is whole, or there is
 * none. */
#include "core/base/mem.h"
#include "server/meeting/meeting.h"
#include "tests/check.h"
#include "tests/faults/walk.h"

/* A meeting in its second case, with all that one has. */
static struct meeting *make(void)
{
    static const char people[] = "[{\"who\":\"rae\"},{\"who\":\"@physics\",\"role\":\"observer\"}]",
                      stays[] = "[{\"member\":\"m1\",\"name\":\"Rae\",\"entered_ms\":12,\"left_ms\":19}]";
    struct problem problem = { 0 };
    char token[MEETING_TOKEN];
    struct meeting *meeting = meeting_create("m-1", "pat", 1);
    struct meeting_case *cases[3];
    mem_put_text(meeting->name, sizeof meeting->name, "Board");
    for (int i = 0; i < 3; i++) {
        const char *const plans[] = { "a", "b", "c" }, *const rooms[] = { "r-1", "r-2", "" };
        cases[i] = meeting_add(meeting, plans[i], rooms[i], NULL, &problem);
        assert_non_null(cases[i]);
    }
    cJSON *list = json_read(people, sizeof people - 1, &problem);
    assert_true(meeting_set_people(meeting, list, &problem));
    cJSON_Delete(list);
    assert_true(meeting_add_link(meeting, &(struct meeting_link){ .role = WIRE_MEMBER_ROLE_REVIEWER, .expires_ms = 99 },
                                 token, &problem));
    memset(meeting->links[0].token_hash, 0xab, sizeof meeting->links[0].token_hash); /* the same in each run */
    meeting_came(meeting, "zoe");
    meeting_bar(meeting, "mia", "");
    meeting_go(meeting, cases[0], 10);
    cases[0]->stays = json_read(stays, sizeof stays - 1, &problem);
    mem_put_text(cases[0]->decision, sizeof cases[0]->decision, "accept");
    cases[0]->decided_ms = 15;
    meeting_go(meeting, cases[1], 20);
    return meeting;
}

static void add_meeting(struct outcome *outcome, const struct meeting *meeting)
{
    outcome_add_text(outcome, meeting->name);
    outcome_add_text(outcome, meeting->now);
    outcome_add_number(outcome, (double)meeting->since_ms);
    for (size_t i = 0; i < meeting->n_people; i++)
        outcome_add_text(outcome, meeting->people[i].who);
    for (size_t i = 0; i < meeting->n_links; i++)
        outcome_add(outcome, meeting->links[i].token_hash, sizeof meeting->links[i].token_hash);
    outcome_add_number(outcome, (double)(100 * meeting->n_came + meeting->n_barred));
    for (size_t i = 0; i < meeting->n_cases; i++) {
        const struct meeting_case *one = meeting->cases[i];
        outcome_add_text(outcome, one->plan);
        outcome_add_text(outcome, one->room);
        outcome_add_text(outcome, one->decision);
        outcome_add_number(outcome, (double)one->decided_ms + 100 * (double)one->n_visits);
        const char *stays = json_text(cJSON_GetArrayItem(one->stays, 0), "name");
        outcome_add_text(outcome, stays ? stays : "nobody");
    }
}

static void refuse(struct outcome *outcome)
{
    (void)json_no_memory(&outcome->problem, "a meeting");
}

static void copy(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct meeting *meeting = make();
    faults_go_on();
    struct meeting *made = meeting_copy(meeting);
    faults_pause();
    outcome->is_done = made != NULL;
    if (made)
        add_meeting(outcome, made);
    else
        refuse(outcome);
    meeting_free(made);
    meeting_free(meeting);
    faults_go_on();
}

static void write_and_read(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct meeting *meeting = make();
    (void)json_no_memory(NULL, "what came before");
    faults_go_on();
    struct store_meeting *row = meeting_write(meeting);
    struct meeting *again = row ? meeting_read(row) : NULL;
    faults_pause();
    outcome->is_done = again != NULL;
    if (again)
        add_meeting(outcome, again);
    else
        refuse(outcome);
    meeting_free(again);
    store_meeting_free(row);
    meeting_free(meeting);
    faults_go_on();
}

static void describe_people(void *context, struct outcome *outcome)
{
    (void)context;
    faults_pause();
    struct meeting *meeting = make();
    (void)json_no_memory(NULL, "what came before");
    faults_go_on();
    cJSON *list = meeting_people(meeting);
    char *text = json_print(list);
    faults_pause();
    outcome->is_done = text != NULL;
    if (text)
        outcome_add_text(outcome, text);
    else
        refuse(outcome);
    free(text);
    cJSON_Delete(list);
    meeting_free(meeting);
    faults_go_on();
}

int main(void)
{
    const struct walk walks[] = {
        { .name = "a meeting is copied", .run = copy },
        { .name = "a meeting is written and read", .run = write_and_read },
        { .name = "its people are described", .run = describe_people },
    };
    for (size_t i = 0; i < sizeof walks / sizeof walks[0]; i++) {
        struct walk walk = walks[i];
        walk.kinds[FAULT_MEMORY] = true;
        walk_run(&walk);
    }
    return walks_end();
}

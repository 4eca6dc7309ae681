/* The agenda: meeting.h. */
#include "server/meeting/meeting.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"

enum meeting_state meeting_state(const struct meeting *meeting)
{
    return meeting->ended_ms ? MEETING_OVER : meeting->now[0] ? MEETING_RUNNING : MEETING_PLANNED;
}

const char *meeting_state_word(enum meeting_state state)
{
    static const char *const words[] = { "planned", "running", "over" };
    return words[state];
}

struct meeting *meeting_create(const char *id, const char *owner, int64_t now_ms)
{
    struct meeting *meeting = mem_new(sizeof *meeting);
    mem_put_text(meeting->id, sizeof meeting->id, id);
    mem_put_text(meeting->owner, sizeof meeting->owner, owner);
    meeting->created_ms = now_ms;
    return meeting;
}

void meeting_free(struct meeting *meeting)
{
    for (size_t i = 0; meeting && i < meeting->n_cases; i++) {
        cJSON_Delete(meeting->cases[i]->stays);
        free(meeting->cases[i]);
    }
    free(meeting);
}

struct meeting *meeting_copy(const struct meeting *meeting)
{
    struct meeting *copy = mem_new(sizeof *copy);
    *copy = *meeting;
    copy->n_cases = 0;
    for (size_t i = 0; i < meeting->n_cases; i++) {
        const struct meeting_case *from = meeting->cases[i];
        struct meeting_case *to = mem_new(sizeof *to);
        *to = *from;
        to->stays = from->stays ? cJSON_Duplicate(from->stays, true) : NULL;
        copy->cases[copy->n_cases++] = to;
        if (from->stays && !to->stays) {
            meeting_free(copy);
            return NULL;
        }
    }
    return copy;
}

/* ---- the agenda ------------------------------------------------------------------------------------------------- */

struct meeting_case *meeting_find(const struct meeting *meeting, const char *case_id)
{
    for (size_t i = 0; case_id[0] && i < meeting->n_cases; i++)
        if (strcmp(meeting->cases[i]->id, case_id) == 0)
            return meeting->cases[i];
    return NULL;
}

struct meeting_case *meeting_of_room(const struct meeting *meeting, const char *room)
{
    for (size_t i = 0; room[0] && i < meeting->n_cases; i++)
        if (strcmp(meeting->cases[i]->room, room) == 0)
            return meeting->cases[i];
    return NULL;
}

size_t meeting_place(const struct meeting *meeting, const struct meeting_case *of)
{
    size_t place = 0;
    while (place < meeting->n_cases && meeting->cases[place] != of)
        place++;
    return place;
}

static bool no_case(const char *case_id, const char *pointer, struct problem *problem)
{
    return problem_set(problem, PROBLEM_NOT_FOUND, pointer, "", "the meeting has no case \"%.23s\"", case_id);
}

static bool refuse_over(const struct meeting *meeting, struct problem *problem)
{
    return !meeting->ended_ms || problem_set(problem, PROBLEM_CONFLICT, "", "over", "the meeting is over");
}

/* The place before this case, or the end. False with problem: there is no such case. */
static bool find_place(const struct meeting *meeting, const char *before, size_t *place, struct problem *problem)
{
    const struct meeting_case *behind = before && before[0] ? meeting_find(meeting, before) : NULL;
    if (before && before[0] && !behind)
        return no_case(before, "/before", problem);
    *place = behind ? meeting_place(meeting, behind) : meeting->n_cases;
    return true;
}

static void insert(struct meeting *meeting, size_t place, struct meeting_case *one)
{
    memmove(&meeting->cases[place + 1], &meeting->cases[place], (meeting->n_cases - place) * sizeof meeting->cases[0]);
    meeting->cases[place] = one;
    meeting->n_cases++;
}

static void take_out(struct meeting *meeting, size_t place)
{
    meeting->n_cases--;
    memmove(&meeting->cases[place], &meeting->cases[place + 1], (meeting->n_cases - place) * sizeof meeting->cases[0]);
}

struct meeting_case *meeting_add(struct meeting *meeting, const char *plan, const char *room, const char *before,
                                 struct problem *problem)
{
    size_t place;
    if (!refuse_over(meeting, problem) || !find_place(meeting, before, &place, problem))
        return NULL;
    if (meeting->n_cases == MEETING_MAX_CASES) {
        problem_set(problem, PROBLEM_LIMIT, "", "", "the meeting has %d cases, more are not allowed",
                    MEETING_MAX_CASES);
        return NULL;
    }
    if (room[0] && meeting_of_room(meeting, room)) {
        problem_set(problem, PROBLEM_CONFLICT, "/room", "", "this room is that of another case of the meeting");
        return NULL;
    }
    struct meeting_case *one = mem_new(sizeof *one);
    (void)snprintf(one->id, sizeof one->id, "c%u", ++meeting->n_made);
    mem_put_text(one->plan, sizeof one->plan, plan);
    mem_put_text(one->room, sizeof one->room, room);
    insert(meeting, place, one);
    return one;
}

bool meeting_order(struct meeting *meeting, const char *case_id, const char *before, struct problem *problem)
{
    size_t place;
    struct meeting_case *one = meeting_find(meeting, case_id);
    if (!refuse_over(meeting, problem))
        return false;
    if (!one)
        return no_case(case_id, "", problem);
    if (before && strcmp(before, case_id) == 0)
        return true;
    if (!find_place(meeting, before, &place, problem))
        return false;
    const size_t was = meeting_place(meeting, one);
    take_out(meeting, was);
    insert(meeting, place > was ? place - 1 : place, one);
    return true;
}

bool meeting_remove(struct meeting *meeting, const char *case_id, struct problem *problem)
{
    struct meeting_case *one = meeting_find(meeting, case_id);
    if (!refuse_over(meeting, problem))
        return false;
    if (!one)
        return no_case(case_id, "", problem);
    if (meeting_was_entered(meeting, one))
        return problem_set(problem, PROBLEM_CONFLICT, "", "entered",
                           "the meeting was in this case: it stays in the minutes");
    take_out(meeting, meeting_place(meeting, one));
    cJSON_Delete(one->stays);
    free(one);
    return true;
}

struct meeting_case *meeting_next(const struct meeting *meeting, struct problem *problem)
{
    const struct meeting_case *now = meeting_find(meeting, meeting->now);
    const size_t place = now ? meeting_place(meeting, now) + 1 : 0;
    if (!refuse_over(meeting, problem))
        return NULL;
    if (place < meeting->n_cases)
        return meeting->cases[place];
    problem_set(problem, PROBLEM_CONFLICT, "/case", "last",
                meeting->n_cases ? "this is the last case of the meeting" : "the meeting has no cases");
    return NULL;
}

bool meeting_is_at(const struct meeting *meeting, const char *from, struct problem *problem)
{
    return strcmp(from ? from : "", meeting->now) == 0 ||
           problem_set(problem, PROBLEM_CONFLICT, "/from", "from", "the meeting has moved on meanwhile");
}

/* The visit of the case of now ends. */
static void leave(struct meeting *meeting, int64_t now_ms)
{
    struct meeting_case *now = meeting_find(meeting, meeting->now);
    const int64_t to_ms = now_ms > meeting->since_ms ? now_ms : meeting->since_ms; /* the clock may have been set */
    if (!now)
        return;
    if (now->n_visits < MEETING_MAX_VISITS)
        now->visits[now->n_visits++] = (struct meeting_visit){ meeting->since_ms, to_ms };
    else
        now->visits[MEETING_MAX_VISITS - 1].to_ms += to_ms - meeting->since_ms;
    meeting->now[0] = 0;
    now->opens = false;
}

void meeting_go(struct meeting *meeting, struct meeting_case *to, int64_t now_ms)
{
    assert(!meeting->ended_ms);
    if (strcmp(meeting->now, to->id) == 0)
        return;
    leave(meeting, now_ms);
    to->opens = !meeting_was_entered(meeting, to);
    mem_put_text(meeting->now, sizeof meeting->now, to->id);
    meeting->since_ms = now_ms;
}

void meeting_end(struct meeting *meeting, int64_t now_ms)
{
    leave(meeting, now_ms);
    if (!meeting->ended_ms)
        meeting->ended_ms = now_ms > 0 ? now_ms : 1;
}

int64_t meeting_spent_ms(const struct meeting *meeting, const struct meeting_case *of, int64_t now_ms)
{
    int64_t spent_ms = 0;
    for (size_t i = 0; i < of->n_visits; i++)
        spent_ms += of->visits[i].to_ms - of->visits[i].from_ms;
    if (strcmp(meeting->now, of->id) == 0 && now_ms > meeting->since_ms)
        spent_ms += now_ms - meeting->since_ms;
    return spent_ms;
}

bool meeting_was_entered(const struct meeting *meeting, const struct meeting_case *of)
{
    return of->n_visits > 0 || strcmp(meeting->now, of->id) == 0;
}

int64_t meeting_first_ms(const struct meeting *meeting, const struct meeting_case *of)
{
    return of->n_visits ? of->visits[0].from_ms : strcmp(meeting->now, of->id) == 0 ? meeting->since_ms : 0;
}

bool meeting_erase(struct meeting *meeting, const char *plan, const char *other)
{
    bool has_any = false;
    for (size_t i = 0; i < meeting->n_cases; i++) {
        struct meeting_case *one = meeting->cases[i];
        if (!one->plan[0] || (strcmp(one->plan, plan) != 0 && strcmp(one->plan, other) != 0))
            continue;
        one->plan[0] = one->room[0] = one->patient[0] = one->label[0] = one->approval[0] = 0;
        has_any = true;
    }
    return has_any;
}

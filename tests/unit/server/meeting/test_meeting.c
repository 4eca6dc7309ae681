/* Meetings: random moves agree with a model that is written another way, also over the disk; who may come; limits. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/meeting/meeting.h"
#include "tests/check.h"

enum { N_MEETINGS = 150, N_MOVES = 120, MOST = MEETING_MAX_CASES };

/* ---- the model: what happened, as a list; each answer is found by going through it --------------------------------- */

struct stretch { /* of time in one case */
    unsigned of;
    int64_t from_ms, to_ms; /* to_ms 0: it lasts */
};

struct model {
    unsigned agenda[MOST]; /* numbers of cases, in their order */
    size_t n;
    unsigned n_made;
    struct stretch list[N_MOVES + 1];
    size_t n_stretches;
    bool is_over;
};

static unsigned model_now(const struct model *model)
{
    const struct stretch *last = model->n_stretches ? &model->list[model->n_stretches - 1] : NULL;
    return last && !last->to_ms ? last->of : 0;
}

static bool model_was_entered(const struct model *model, unsigned of)
{
    for (size_t i = 0; i < model->n_stretches; i++)
        if (model->list[i].of == of)
            return true;
    return false;
}

static int64_t model_spent(const struct model *model, unsigned of, int64_t now_ms)
{
    int64_t ms = 0;
    for (size_t i = 0; i < model->n_stretches; i++)
        if (model->list[i].of == of)
            ms += (model->list[i].to_ms ? model->list[i].to_ms : now_ms) - model->list[i].from_ms;
    return ms;
}

static size_t model_place(const struct model *model, unsigned of)
{
    size_t place = 0;
    while (place < model->n && model->agenda[place] != of)
        place++;
    return place;
}

static void model_insert(struct model *model, unsigned of, unsigned before)
{
    const size_t place = before ? model_place(model, before) : model->n;
    for (size_t i = model->n; i > place; i--)
        model->agenda[i] = model->agenda[i - 1];
    model->agenda[place] = of;
    model->n++;
}

static void model_take_out(struct model *model, unsigned of)
{
    const size_t place = model_place(model, of);
    model->n--;
    for (size_t i = place; i < model->n; i++)
        model->agenda[i] = model->agenda[i + 1];
}

static void model_leave(struct model *model, int64_t now_ms)
{
    if (model_now(model))
        model->list[model->n_stretches - 1].to_ms = now_ms;
}

static void model_go(struct model *model, unsigned to, int64_t now_ms)
{
    if (model_now(model) == to)
        return;
    model_leave(model, now_ms);
    model->list[model->n_stretches++] = (struct stretch){ to, now_ms, 0 };
}

/* ---- both ----------------------------------------------------------------------------------------------------------- */

static uint32_t seed;

static unsigned random_below(unsigned n)
{
    seed = seed * 1664525u + 1013904223u;
    return (seed >> 8) % n;
}

static const char *id_of(unsigned of, char id[16])
{
    (void)snprintf(id, 16, "c%u", of);
    return of ? id : "";
}

/* A case of the agenda, or one that is not there; 0: none. */
static unsigned any_case(const struct model *model)
{
    return model->n && random_below(8) ? model->agenda[random_below((unsigned)model->n)] : random_below(3) * 1000;
}

static void agree(const struct meeting *meeting, const struct model *model, int64_t now_ms)
{
    char id[16];
    assert_string_equal(meeting->now, id_of(model_now(model), id));
    assert_int_equal(meeting->n_cases, model->n);
    assert_int_equal(meeting_state(meeting), model->is_over     ? MEETING_OVER
                                             : model_now(model) ? MEETING_RUNNING
                                                                : MEETING_PLANNED);
    for (size_t i = 0; i < model->n; i++) {
        const struct meeting_case *one = meeting->cases[i];
        assert_string_equal(one->id, id_of(model->agenda[i], id));
        assert_int_equal(meeting_was_entered(meeting, one), model_was_entered(model, model->agenda[i]));
        assert_int_equal(meeting_spent_ms(meeting, one, now_ms), model_spent(model, model->agenda[i], now_ms));
    }
}

static void add(struct meeting *meeting, struct model *model)
{
    struct problem problem = { 0 };
    char id[16];
    const unsigned before = any_case(model);
    const bool may = !model->is_over && model->n < 12 && (before < 1000 || !before);
    if (model->n >= 12)
        return;
    const struct meeting_case *one = meeting_add(meeting, "plan", "", id_of(before, id), &problem);
    assert_int_equal(one != NULL, may);
    if (!one)
        return;
    model_insert(model, ++model->n_made, before);
    assert_string_equal(one->id, id_of(model->n_made, id));
}

static void order(struct meeting *meeting, struct model *model)
{
    struct problem problem = { 0 };
    char id[16], at[16];
    const unsigned of = any_case(model), before = any_case(model);
    const bool may = !model->is_over && of && of < 1000 && before < 1000;
    assert_int_equal(meeting_order(meeting, id_of(of, id), id_of(before, at), &problem), may);
    if (!may || of == before)
        return;
    model_take_out(model, of);
    model_insert(model, of, before);
}

static void take_off(struct meeting *meeting, struct model *model)
{
    struct problem problem = { 0 };
    char id[16];
    const unsigned of = any_case(model);
    const bool may = !model->is_over && of && of < 1000 && !model_was_entered(model, of);
    assert_int_equal(meeting_remove(meeting, id_of(of, id), &problem), may);
    if (may)
        model_take_out(model, of);
}

/* Somebody presses "next", or two at once, who both believe that `from` is now: one of them moves the meeting. */
static void go_next(struct meeting *meeting, struct model *model, int64_t now_ms)
{
    struct problem problem = { 0 };
    char from[16];
    const unsigned now = model_now(model);
    const size_t place = now ? model_place(model, now) + 1 : 0;
    const bool may = !model->is_over && place < model->n;
    (void)id_of(now, from);
    for (unsigned i = 0; i <= random_below(2); i++) {
        const bool is_at = meeting_is_at(meeting, now ? from : NULL, &problem);
        assert_int_equal(is_at, i == 0 || !may);
        struct meeting_case *to = is_at ? meeting_next(meeting, &problem) : NULL;
        assert_int_equal(to != NULL, i == 0 && may);
        if (to) {
            const unsigned next = model->agenda[place];
            meeting_go(meeting, to, now_ms);
            model_go(model, next, now_ms);
        }
    }
}

static void go_to(struct meeting *meeting, struct model *model, int64_t now_ms)
{
    char id[16];
    const unsigned of = any_case(model);
    struct meeting_case *to = meeting_find(meeting, id_of(of, id));
    assert_int_equal(to != NULL, of && of < 1000);
    if (!to || model->is_over)
        return;
    meeting_go(meeting, to, now_ms);
    model_go(model, of, now_ms);
}

/* The daemon is started again. */
static struct meeting *restart(struct meeting *meeting)
{
    struct store_meeting *row = meeting_write(meeting);
    assert_non_null(row);
    struct meeting *again = meeting_read(row);
    assert_non_null(again);
    store_meeting_free(row);
    meeting_free(meeting);
    return again;
}

static void random_moves_agree_with_the_model(void **state)
{
    (void)state;
    for (uint32_t round = 1; round <= N_MEETINGS; round++) {
        struct meeting *meeting = meeting_create("m-1", "ann", 1000);
        struct model model = { .n = 0 };
        int64_t now_ms = 1767225600000;
        seed = round;
        for (int i = 0; i < N_MOVES; i++) {
            now_ms += random_below(100000);
            switch (random_below(12)) {
            case 0:
            case 1:
            case 2: add(meeting, &model); break;
            case 3: order(meeting, &model); break;
            case 4: take_off(meeting, &model); break;
            case 5:
            case 6:
            case 7: go_next(meeting, &model, now_ms); break;
            case 8: go_to(meeting, &model, now_ms); break;
            case 9: meeting = restart(meeting); break;
            case 10: {
                struct meeting *copy = meeting_copy(meeting);
                meeting_free(meeting);
                meeting = copy;
                break;
            }
            default:
                if (random_below(N_MOVES / 4) == 0) {
                    meeting_end(meeting, now_ms);
                    model_leave(&model, now_ms);
                    model.is_over = true;
                }
            }
            agree(meeting, &model, now_ms + 5);
        }
        meeting_free(meeting);
    }
}

/* ---- time ----------------------------------------------------------------------------------------------------------- */

static void a_case_takes_the_sum_of_its_visits(void **state)
{
    struct problem problem = { 0 };
    struct meeting *meeting = meeting_create("m-1", "", 0);
    struct meeting_case *one = meeting_add(meeting, "a", "", NULL, &problem),
                        *two = meeting_add(meeting, "b", "", NULL, &problem);
    (void)state;
    meeting_go(meeting, one, 1000);
    meeting_go(meeting, two, 61000); /* 60 s in the first */
    meeting_go(meeting, one, 91000); /* 30 s in the second */
    meeting_go(meeting, one, 95000); /* nothing happens */
    assert_int_equal(meeting_spent_ms(meeting, one, 101000), 60000 + 10000);
    meeting_end(meeting, 111000);
    assert_int_equal(meeting_spent_ms(meeting, one, 999000), 60000 + 20000);
    assert_int_equal(meeting_spent_ms(meeting, two, 999000), 30000);
    assert_int_equal(meeting_first_ms(meeting, one), 1000);
    meeting_free(meeting);
}

static void a_case_opens_when_it_is_entered_first_and_not_when_it_is_returned_to(void **state)
{
    struct problem problem;
    struct meeting *meeting = meeting_create("m-1", "", 1);
    struct meeting_case *one = meeting_add(meeting, "a", "", NULL, &problem),
                        *two = meeting_add(meeting, "b", "", NULL, &problem);
    (void)state;
    assert_false(one->opens);
    meeting_go(meeting, one, 10);
    assert_true(one->opens);
    assert_false(two->opens);
    one->opens = false; /* it was shown */
    meeting_go(meeting, one, 11);
    assert_false(one->opens);
    meeting_go(meeting, two, 20);
    meeting_go(meeting, one, 30);
    assert_false(one->opens);
    assert_false(two->opens); /* nobody has shown it while the case was now */
    meeting_free(meeting);
}

static void a_clock_that_is_set_back_takes_no_time_away(void **state)
{
    struct problem problem = { 0 };
    struct meeting *meeting = meeting_create("m-1", "", 0);
    struct meeting_case *one = meeting_add(meeting, "a", "", NULL, &problem),
                        *two = meeting_add(meeting, "b", "", NULL, &problem);
    (void)state;
    meeting_go(meeting, one, 100000);
    assert_int_equal(meeting_spent_ms(meeting, one, 40000), 0);
    meeting_go(meeting, two, 40000);
    assert_int_equal(meeting_spent_ms(meeting, one, 40000), 0);
    meeting_free(meeting);
}

static void more_visits_than_are_told_apart_still_count(void **state)
{
    struct problem problem = { 0 };
    struct meeting *meeting = meeting_create("m-1", "", 0);
    struct meeting_case *one = meeting_add(meeting, "a", "", NULL, &problem),
                        *two = meeting_add(meeting, "b", "", NULL, &problem);
    (void)state;
    for (int64_t i = 0; i < 2 * MEETING_MAX_VISITS; i++) { /* 10 ms in the one, 5 in the other */
        meeting_go(meeting, one, 1000 + 15 * i);
        meeting_go(meeting, two, 1010 + 15 * i);
    }
    assert_int_equal(one->n_visits, MEETING_MAX_VISITS);
    assert_int_equal(meeting_spent_ms(meeting, one, 0), 2 * MEETING_MAX_VISITS * 10);
    meeting_free(meeting);
}

/* ---- people and links ----------------------------------------------------------------------------------------------- */

static struct identity person(const char *user, const char *group)
{
    struct identity who = { .source = IDENTITY_PASSWORD };
    mem_put_text(who.user, sizeof who.user, user);
    mem_put_text(who.groups[0], sizeof who.groups[0], group);
    who.n_groups = group[0] != 0;
    return who;
}

static void set_people(struct meeting *meeting, const char *text)
{
    struct problem problem = { 0 };
    cJSON *list = json_read(text, strlen(text), &problem);
    assert_true(meeting_set_people(meeting, list, &problem));
    cJSON_Delete(list);
}

static void who_is_named_may_come_with_at_most_their_role(void **state)
{
    struct meeting *meeting = meeting_create("m-1", "ann", 0);
    const struct identity ann = person("ann", ""), bob = person("bob", "physics"), cid = person("cid", "physics"),
                          eve = person("eve", ""), nobody = { .source = IDENTITY_NOBODY };
    enum wire_member_role role;
    (void)state;
    set_people(meeting, "[{\"who\":\"bob\",\"role\":\"observer\"},{\"who\":\"@physics\",\"role\":\"presenter\"}]");
    assert_true(meeting_allows(meeting, &ann, &role) && role == WIRE_MEMBER_ROLE_PLANNER);
    assert_true(meeting_allows(meeting, &bob, &role) && role == WIRE_MEMBER_ROLE_OBSERVER);
    assert_true(meeting_allows(meeting, &cid, &role) && role == WIRE_MEMBER_ROLE_PRESENTER);
    assert_false(meeting_allows(meeting, &eve, &role));
    assert_false(meeting_allows(meeting, &nobody, &role));
    meeting_came(meeting, "eve");
    assert_true(meeting_allows(meeting, &eve, &role));
    assert_false(meeting_names(meeting, &eve));
    meeting = restart(meeting);
    assert_true(meeting_allows(meeting, &eve, &role));
    assert_true(meeting_allows(meeting, &bob, &role) && role == WIRE_MEMBER_ROLE_OBSERVER);
    meeting_free(meeting);
}

static void who_was_removed_comes_again_once_they_are_named_anew(void **state)
{
    struct meeting *meeting = meeting_create("m-1", "ann", 0);
    const struct identity bob = person("bob", "physics");
    enum wire_member_role role;
    (void)state;
    set_people(meeting, "[{\"who\":\"bob\"},{\"who\":\"@physics\"}]");
    meeting_bar(meeting, "bob", "");
    assert_false(meeting_allows(meeting, &bob, &role)); /* nor by the group */
    meeting = restart(meeting);
    assert_false(meeting_allows(meeting, &bob, &role));
    set_people(meeting, "[{\"who\":\"@physics\"}]");
    assert_false(meeting_allows(meeting, &bob, &role));
    set_people(meeting, "[{\"who\":\"bob\"}]");
    assert_true(meeting_allows(meeting, &bob, &role));
    meeting_free(meeting);
}

static void a_link_opens_until_it_ends(void **state)
{
    struct meeting *meeting = meeting_create("m-1", "ann", 0);
    struct problem problem = { 0 };
    const struct meeting_link wanted = { .role = WIRE_MEMBER_ROLE_REVIEWER, .expires_ms = 5000, .allows_guests = true };
    char token[MEETING_TOKEN], other[MEETING_TOKEN], digits[9];
    (void)state;
    assert_true(meeting_add_link(meeting, &wanted, token, &problem));
    assert_true(meeting_add_link(meeting, &wanted, other, &problem));
    meeting = restart(meeting); /* the token itself is not kept */
    const struct meeting_link *link = meeting_link_of(meeting, token, 4999);
    assert_non_null(link);
    assert_int_equal(link->role, WIRE_MEMBER_ROLE_REVIEWER);
    assert_true(link->allows_guests);
    assert_null(meeting_link_of(meeting, token, 5000));
    assert_null(meeting_link_of(meeting, "", 0));
    assert_null(meeting_link_of(meeting, "00000000000000000000000000000000", 0));
    meeting_link_digits(link, digits);
    meeting_link_find(meeting, digits)->is_ended = true;
    meeting = restart(meeting);
    assert_null(meeting_link_of(meeting, token, 0));
    assert_non_null(meeting_link_of(meeting, other, 0));
    meeting_bar(meeting, "", digits); /* of a guest */
    for (size_t i = meeting->n_links; i < MEETING_MAX_LINKS; i++)
        assert_true(meeting_add_link(meeting, &wanted, token, &problem));
    assert_false(meeting_add_link(meeting, &wanted, token, &problem));
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    meeting_free(meeting);
}

static void an_erased_plan_leaves_the_case_without_it(void **state)
{
    struct problem problem = { 0 };
    struct meeting *meeting = meeting_create("m-1", "ann", 0);
    struct meeting_case *one = meeting_add(meeting, "head", "room-1", NULL, &problem);
    (void)state;
    assert_non_null(meeting_add(meeting, "neck", "room-2", NULL, &problem));
    assert_null(meeting_add(meeting, "neck", "room-2", NULL, &problem)); /* a room is that of one case */
    mem_put_text(one->patient, sizeof one->patient, "A. V. 417");
    assert_false(meeting_erase(meeting, "lung", ""));
    assert_true(meeting_erase(meeting, "0123", "head"));
    assert_string_equal(one->plan, "");
    assert_string_equal(one->room, "");
    assert_string_equal(one->patient, "");
    assert_string_equal(meeting->cases[1]->plan, "neck");
    meeting_free(meeting);
}

static void rows_that_are_no_good_are_left_out(void **state)
{
    struct store_meeting_case cases[] = {
        { .id = "c1", .plan = "head", .body = "{\"cap\":\"king\",\"visits\":[[5,1],3]}" },
        { .id = "c1", .plan = "again", .body = "{}" },
        { .id = "C 2", .plan = "x", .body = "{}" },
        { .id = "c3", .plan = "../x", .body = "{}" },
        { .id = "c4", .plan = "neck", .body = "not JSON" }
    };
    struct store_meeting row = { .id = "m-1",
                                 .body = "{\"name\":7,\"now\":\"c9\",\"n_made\":-3,\"links\":[{}],\"people\":3}",
                                 .cases = cases,
                                 .n_cases = 5 };
    (void)state;
    struct meeting *meeting = meeting_read(&row);
    assert_non_null(meeting);
    assert_int_equal(meeting->n_cases, 2);
    assert_int_equal(meeting->cases[0]->cap, WIRE_MEMBER_ROLE_OBSERVER);
    assert_int_equal(meeting->cases[0]->n_visits, 0);
    assert_string_equal(meeting->cases[1]->plan, "neck");
    assert_string_equal(meeting->now, "");
    assert_int_equal(meeting->n_links, 0);
    meeting_free(meeting);
    row.body = "[]";
    assert_null(meeting_read(&row));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_moves_agree_with_the_model),
        cmocka_unit_test(a_case_takes_the_sum_of_its_visits),
        cmocka_unit_test(a_case_opens_when_it_is_entered_first_and_not_when_it_is_returned_to),
        cmocka_unit_test(a_clock_that_is_set_back_takes_no_time_away),
        cmocka_unit_test(more_visits_than_are_told_apart_still_count),
        cmocka_unit_test(who_is_named_may_come_with_at_most_their_role),
        cmocka_unit_test(who_was_removed_comes_again_once_they_are_named_anew),
        cmocka_unit_test(a_link_opens_until_it_ends),
        cmocka_unit_test(an_erased_plan_leaves_the_case_without_it),
        cmocka_unit_test(rows_that_are_no_good_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Turns of sources: costs are made up, and nothing runs. */
#include "core/pipeline/turns.h"
#include "tests/check.h"

enum { ORBIT = 1, HOG, SCRIPTS, LATE, MAX_SOURCES = 5, MS = 1000 };

/* Sources that always have a picture waiting, drawn in slices; what each got. */
struct world {
    struct turns *turns;
    struct turns_item items[MAX_SOURCES]; /* [source] */
    int64_t cost_us[MAX_SOURCES];         /* of a picture; 0: the source has no request */
    int64_t left_us[MAX_SOURCES], got_us[MAX_SOURCES], waited_us[MAX_SOURCES], worst_wait_us[MAX_SOURCES];
    int n_pictures[MAX_SOURCES];
};
enum { SLICE_US = 20 * MS };

static void add_pictures(struct world *world, int source, int64_t cost_us, bool is_still)
{
    world->items[source] = (struct turns_item){ .source = (uint64_t)source, .is_still = is_still };
    world->cost_us[source] = world->left_us[source] = cost_us;
}

static void run(struct world *world, int64_t duration_us)
{
    for (int64_t now_us = 0; now_us < duration_us;) {
        struct turns_item *items[MAX_SOURCES];
        int sources[MAX_SOURCES];
        size_t n = 0;
        for (int s = 1; s < MAX_SOURCES; s++)
            if (world->cost_us[s]) {
                sources[n] = s;
                items[n++] = &world->items[s];
            }
        int s = sources[turns_choose(world->turns, items, n)];
        int64_t step_us = world->left_us[s] < SLICE_US ? world->left_us[s] : SLICE_US;
        turns_charge(world->turns, (uint64_t)s, step_us);
        now_us += step_us;
        world->got_us[s] += step_us;
        world->waited_us[s] = 0;
        for (int other = 1; other < MAX_SOURCES; other++)
            if (other != s && world->cost_us[other]) {
                world->waited_us[other] += step_us;
                world->worst_wait_us[other] = world->waited_us[other] > world->worst_wait_us[other]
                                                  ? world->waited_us[other]
                                                  : world->worst_wait_us[other];
            }
        if ((world->left_us[s] -= step_us) == 0) {
            world->n_pictures[s]++;
            add_pictures(world, s, world->cost_us[s], world->items[s].is_still);
        }
    }
}

static void sources_get_the_same_time_whatever_their_pictures_cost(void **state)
{
    (void)state;
    struct world world = { .turns = turns_create() };
    add_pictures(&world, ORBIT, 10 * MS, false);
    add_pictures(&world, HOG, 2000 * MS, false);
    add_pictures(&world, SCRIPTS, 300 * MS, false);
    run(&world, 60000 * MS);
    for (int s = ORBIT; s <= SCRIPTS; s++)
        assert_close((double)world.got_us[s], 20000.0 * MS, 200.0 * MS); /* a third, but for credits and a slice */
    assert_true(world.n_pictures[ORBIT] > 1900);
    turns_destroy(world.turns);
}

static void a_moving_picture_waits_for_no_more_than_a_few_slices(void **state)
{
    (void)state;
    struct world world = { .turns = turns_create() };
    add_pictures(&world, ORBIT, 15 * MS, false);
    add_pictures(&world, HOG, 3000 * MS, true);
    add_pictures(&world, SCRIPTS, 1000 * MS, true);
    run(&world, 60000 * MS);
    assert_true(world.worst_wait_us[ORBIT] <= 3 * SLICE_US); /* a slice of each other, and one for what it was ahead */
    assert_close((double)world.got_us[ORBIT], 20000.0 * MS, 300.0 * MS);
    turns_destroy(world.turns);
}

/* An hour in which nobody else asked is worth no more than the credit. */
static void a_newcomer_gets_no_credit_for_the_time_before(void **state)
{
    (void)state;
    struct world world = { .turns = turns_create() };
    add_pictures(&world, HOG, 30 * MS, false);
    run(&world, 3600000ll * MS);
    int64_t hog_us = world.got_us[HOG];
    add_pictures(&world, LATE, 30 * MS, false);
    run(&world, 1000 * MS);
    assert_close((double)(world.got_us[HOG] - hog_us), 450.0 * MS, 60.0 * MS); /* 500, less half of the credit */
    /* nor for a rest */
    world.cost_us[LATE] = 0;
    run(&world, 600000 * MS);
    hog_us = world.got_us[HOG];
    add_pictures(&world, LATE, 30 * MS, false);
    run(&world, 1000 * MS);
    assert_close((double)(world.got_us[HOG] - hog_us), 450.0 * MS, 60.0 * MS);
    turns_destroy(world.turns);
}

/* A debt is not lost by asking for nothing for a moment: who used more waits until the others had as much. */
static void asking_for_nothing_for_a_moment_forgives_nothing(void **state)
{
    (void)state;
    struct turns *turns = turns_create();
    struct turns_item orbit = { .source = ORBIT }, hog = { .source = HOG };
    struct turns_item *both[] = { &orbit, &hog }, *only_orbit[] = { &orbit };
    (void)turns_choose(turns, both, 2);
    turns_charge(turns, HOG, 1000 * MS);
    assert_int_equal(turns_choose(turns, only_orbit, 1), 0);
    for (int n = 0; n < 9; n++) {
        turns_charge(turns, ORBIT, 100 * MS);
        assert_int_equal(turns_choose(turns, both, 2), 0);
    }
    turns_charge(turns, ORBIT, 101 * MS);
    assert_int_equal(turns_choose(turns, both, 2), 1);
    turns_destroy(turns);
}

/* The still of somebody who was there is next when each of those who come later has had about one picture, not the
 * seven that credit and preference would be worth to a single newcomer. */
static void many_newcomers_who_move_do_not_keep_a_still_waiting(void **state)
{
    enum { N = 200, PICTURE_US = 30 * MS };
    (void)state;
    struct turns *turns = turns_create();
    struct turns_item still = { .source = 1000, .is_still = true }, moving[N];
    struct turns_item *items[N + 1] = { &still };
    assert_int_equal(turns_choose(turns, items, 1), 0); /* it was there before, and drawn before */
    turns_charge(turns, still.source, PICTURE_US);
    still.is_begun = false;
    for (size_t i = 0; i < N; i++) {
        moving[i] = (struct turns_item){ .source = i + 1 };
        items[i + 1] = &moving[i];
    }
    int n_before = 0;
    for (size_t at; (at = turns_choose(turns, items, N + 1)) != 0; n_before++) {
        turns_charge(turns, items[at]->source, PICTURE_US);
        moving[at - 1] = (struct turns_item){ .source = at };
        assert_true(n_before < 10 * N);
    }
    assert_in_range(n_before, 0, 2 * N);
    turns_destroy(turns);
}

static void of_one_source_stills_let_eight_moving_pictures_pass(void **state)
{
    (void)state;
    struct turns *turns = turns_create();
    struct turns_item still = { .source = ORBIT, .is_still = true }, moving[10];
    for (int n = 0; n < 10; n++) {
        moving[n] = (struct turns_item){ .source = ORBIT };
        struct turns_item *items[] = { &still, &moving[n] };
        assert_int_equal(turns_choose(turns, items, 2), n < TURNS_MAX_OVERTAKING);
    }
    assert_int_equal(still.n_overtaken, TURNS_MAX_OVERTAKING);
    /* a moving picture that is paused and taken up again counts once */
    struct turns_item other = { .source = ORBIT, .is_still = true }, one = { .source = ORBIT };
    struct turns_item *items[] = { &other, &one };
    for (int n = 0; n < 20; n++)
        assert_int_equal(turns_choose(turns, items, 2), 1);
    assert_int_equal(other.n_overtaken, 1);
    turns_destroy(turns);
}

static void where_a_person_acts_two_pictures_are_drawn_to_one_of_another_view(void **state)
{
    (void)state;
    struct turns *turns = turns_create();
    struct turns_item others[3] = { { .source = ORBIT }, { .source = ORBIT }, { .source = ORBIT } };
    struct turns_item acted[5], *items[4];
    size_t n = 0, n_acted = 0;
    for (; n < 3; n++)
        items[n] = &others[n];
    /* whoever is drawn is asked for again behind those that wait: two of the acted view to one of another, in their
     * order */
    const int expected[] = { -1, -1, 0, -1, -1, 1, -1 };
    for (size_t turn = 0; turn < 7; turn++) {
        if (n == 3 && n_acted < 5) {
            acted[n_acted] = (struct turns_item){ .source = ORBIT, .is_acted = true };
            items[n++] = &acted[n_acted++];
        }
        size_t at = turns_choose(turns, items, n);
        assert_true(at < n);
        if (expected[turn] < 0)
            assert_true(items[at]->is_acted);
        else
            assert_ptr_equal(items[at], &others[expected[turn]]);
        struct turns_item *drawn = items[at];
        for (n--; at < n; at++)
            items[at] = items[at + 1];
        if (!drawn->is_acted) {
            *drawn = (struct turns_item){ .source = ORBIT };
            items[n++] = drawn;
        }
    }
    /* it does not end a moving picture of its source that is being drawn, nor does it wait behind a still */
    assert_false(turns_may_interrupt(&(struct turns_item){ .source = ORBIT },
                                     &(struct turns_item){ .source = ORBIT, .is_acted = true }));
    assert_true(turns_may_interrupt(&(struct turns_item){ .source = ORBIT, .is_still = true },
                                    &(struct turns_item){ .source = ORBIT, .is_acted = true }));
    turns_destroy(turns);
}

static void what_is_held_is_passed_over(void **state)
{
    (void)state;
    struct turns *turns = turns_create();
    struct turns_item hog = { .source = HOG, .is_held = true }, orbit = { .source = ORBIT };
    struct turns_item *items[] = { &hog, &orbit };
    turns_charge(turns, ORBIT, 5000 * MS);
    assert_int_equal(turns_choose(turns, items, 2), 1);
    orbit.is_held = true;
    assert_true(turns_choose(turns, items, 2) == SIZE_MAX);
    hog.is_held = false;
    assert_int_equal(turns_choose(turns, items, 2), 0);
    assert_true(turns_choose(turns, items, 0) == SIZE_MAX);
    turns_destroy(turns);
}

/* More sources than are remembered, each with one picture: nobody is lost, and those who came first are next. */
static void more_sources_than_are_remembered_are_served_too(void **state)
{
    (void)state;
    struct turns *turns = turns_create();
    for (uint64_t source = 1; source <= 5000; source++) {
        struct turns_item one = { .source = source }, *items[] = { &one };
        assert_int_equal(turns_choose(turns, items, 1), 0);
        turns_charge(turns, source, 10 * MS);
    }
    struct turns_item item[100], *items[100];
    for (uint64_t n = 0; n < 100; n++) {
        item[n] = (struct turns_item){ .source = 10000 + n };
        items[n] = &item[n];
    }
    for (size_t n = 0; n < 100; n++) {
        assert_int_equal(turns_choose(turns, items, 100), n);
        turns_charge(turns, 10000 + n, 50 * MS);
    }
    turns_destroy(turns);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sources_get_the_same_time_whatever_their_pictures_cost),
        cmocka_unit_test(a_moving_picture_waits_for_no_more_than_a_few_slices),
        cmocka_unit_test(a_newcomer_gets_no_credit_for_the_time_before),
        cmocka_unit_test(asking_for_nothing_for_a_moment_forgives_nothing),
        cmocka_unit_test(many_newcomers_who_move_do_not_keep_a_still_waiting),
        cmocka_unit_test(of_one_source_stills_let_eight_moving_pictures_pass),
        cmocka_unit_test(where_a_person_acts_two_pictures_are_drawn_to_one_of_another_view),
        cmocka_unit_test(what_is_held_is_passed_over),
        cmocka_unit_test(more_sources_than_are_remembered_are_served_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

/* Meetings in the store: they come back as they were, also from a backup and after their plan was erased; a database of
 * the version before. */
#include "core/base/mem.h"
#include "server/store/backup.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/store_files.h"
#include "tests/unit/store_world.h"

static struct store_world world;

static int set_up(void **state)
{
    (void)state;
    store_world_begin(&world);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    store_world_end(&world);
    return 0;
}

/* A write of a meeting of these many cases, the n-th of plan "plan-N". body NULL: of its end. */
static struct store_room *write_of(const char *id, const char *body, size_t n_cases)
{
    struct store_room *write = mem_new(sizeof *write);
    write->meeting = mem_new(sizeof *write->meeting);
    struct store_meeting *meeting = write->meeting;
    mem_put_text(meeting->id, sizeof meeting->id, id);
    mem_put_text(meeting->owner, sizeof meeting->owner, "ann");
    meeting->body = body ? mem_copy_text(body) : NULL;
    meeting->cases = mem_array(n_cases + 1, sizeof meeting->cases[0], 1 << 20, NULL);
    for (size_t i = 0; i < n_cases; i++) {
        struct store_meeting_case *one = &meeting->cases[meeting->n_cases++];
        one->body = mem_copy_text("{}");
        (void)snprintf(one->id, sizeof one->id, "c%zu", i + 1);
        (void)snprintf(one->plan, sizeof one->plan, "plan-%zu", i + 1);
        (void)snprintf(one->room, sizeof one->room, "room-%zu", i + 1);
    }
    return write;
}

static void write_meeting(struct store_room *write)
{
    assert_true(store_write(world.store, write, 21));
    struct store_answer *written = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(written->ticket, 21);
    assert_string_equal(written->error.text, "");
    store_answer_free(written);
}

static void a_meeting_comes_back_with_its_cases_in_their_order(void **state)
{
    (void)state;
    write_meeting(write_of("m-1", "{\"name\":\"Board\"}", 3));
    write_meeting(write_of("m-2", "{}", 0));
    struct store_answer *opened = store_world_reopen(&world);
    assert_int_equal(opened->n_meetings, 2);
    const struct store_meeting *meeting = opened->meetings[0];
    assert_string_equal(meeting->id, "m-1");
    assert_string_equal(meeting->owner, "ann");
    assert_string_equal(meeting->body, "{\"name\":\"Board\"}");
    assert_int_equal(meeting->n_cases, 3);
    assert_string_equal(meeting->cases[2].id, "c3");
    assert_string_equal(meeting->cases[2].plan, "plan-3");
    assert_string_equal(meeting->cases[2].room, "room-3");
    assert_int_equal(opened->meetings[1]->n_cases, 0);
    store_answer_free(opened);
}

static void it_changes_and_ends(void **state)
{
    (void)state;
    write_meeting(write_of("m-1", "{\"n\":1}", 3));
    write_meeting(write_of("m-1", "{\"n\":2}", 1));
    struct store_answer *opened = store_world_reopen(&world);
    assert_int_equal(opened->n_meetings, 1);
    assert_string_equal(opened->meetings[0]->body, "{\"n\":2}");
    assert_int_equal(opened->meetings[0]->n_cases, 1);
    store_answer_free(opened);
    write_meeting(write_of("m-1", NULL, 0));
    opened = store_world_reopen(&world);
    assert_int_equal(opened->n_meetings, 0);
    store_answer_free(opened);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM meeting_cases"), 0);
}

static void an_erased_plan_is_struck_out_of_its_cases(void **state)
{
    const struct store_erase what = { .id = "0123456789abcdef0123456789abcdef",
                                      .plan = "plan-2",
                                      .other = "plan-3",
                                      .row = "{\"action\":\"erase\",\"detail\":"
                                             "{\"erase\":\"0123456789abcdef0123456789abcdef\"}}" };
    (void)state;
    write_meeting(write_of("m-1", "{}", 3));
    for (int is_begin = 1; is_begin >= 0; is_begin--) {
        assert_true(store_erase(world.store, &what, is_begin, 22));
        struct store_answer *erased = store_world_await(&world, STORE_ERASE);
        assert_string_equal(erased->error.text, "");
        store_answer_free(erased);
    }
    struct store_answer *opened = store_world_reopen(&world);
    const struct store_meeting *meeting = opened->meetings[0];
    assert_int_equal(meeting->n_cases, 3);
    assert_string_equal(meeting->cases[0].plan, "plan-1");
    for (size_t i = 1; i < 3; i++) {
        assert_string_equal(meeting->cases[i].plan, "");
        assert_string_equal(meeting->cases[i].room, "");
    }
    store_answer_free(opened);
}

static void a_database_of_version_7_keeps_its_rooms_and_gets_meetings(void **state)
{
    (void)state;
    store_world_close(&world);
    folder_remove(world.folder);
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, "tests/data/store/version7.sql");
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->n_rooms, 2);
    assert_int_equal(opened->n_meetings, 0);
    assert_int_equal(opened->accounts->n_users, 1);
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_string_equal(read->owner, "ann");
    assert_non_null(strstr(read->people, "bob"));
    assert_string_equal(read->members[0].user, "ann");
    assert_string_equal(read->links[0].name, "surgery");
    assert_true(read->links[0].allows_guests);
    assert_false(read->members[0].waits_outside);
    read->members[0].waits_outside = true;
    assert_true(store_write(world.store, read, 23)); /* takes it */
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    read = store_world_read(&world, "7q4k-m2wz");
    assert_true(read->members[0].waits_outside);
    store_room_free(read);
    store_answer_free(opened);
    write_meeting(write_of("m-1", "{}", 1));
    opened = store_world_reopen(&world);
    assert_int_equal(opened->n_meetings, 1);
    store_answer_free(opened);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(a_meeting_comes_back_with_its_cases_in_their_order),
        TEST(it_changes_and_ends),
        TEST(an_erased_plan_is_struck_out_of_its_cases),
        TEST(a_database_of_version_7_keeps_its_rooms_and_gets_meetings),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

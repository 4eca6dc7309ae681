/* Erasing a plan: the rows and files of both its ids go and those of other plans stay; a note that cannot be made to
 * last is taken back; the next start goes on from a note, also of a version before. */
#include <dirent.h>
#include <errno.h>
#include <stdatomic.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/store_files.h"
#include "tests/unit/store_world.h"

static const char hidden_id[] = "0123456789abcdef", folder_id[] = "smith-john";

static struct store_world world;
static atomic_bool folders_do_not_flush;

/* Stands in for libc's, also in libraries. */
int fsync(int file)
{
    struct stat facts;
    if (atomic_load(&folders_do_not_flush) && fstat(file, &facts) == 0 && S_ISDIR(facts.st_mode)) {
        errno = EIO;
        return -1;
    }
    return (int)syscall(SYS_fsync, file);
}

/* A room on the plan, with a decision; the plan's cache and owner. */
static void put_plan(const char *plan, const char *room_id, const char *record_id)
{
    char text[200];
    struct store_room *room = store_made_room(room_id, 1, 10, 1);
    (void)snprintf(room->plan, sizeof room->plan, "%s", plan);
    store_world_write(&world, room);
    room = mem_new(sizeof *room); /* decisions are written for themselves */
    *room = (struct store_room){ .is_prompt = true, .n_records = 1 };
    (void)snprintf(room->id, sizeof room->id, "%s", room_id);
    (void)snprintf(room->plan, sizeof room->plan, "%s", plan);
    room->records = mem_array(1, sizeof room->records[0], 1 << 20, NULL);
    room->records[0] = (struct store_record){ .kind = "decision", .author_name = "Ann", .time_ms = 7 };
    (void)snprintf(room->records[0].id, sizeof room->records[0].id, "%s", record_id);
    (void)snprintf(room->records[0].room, sizeof room->records[0].room, "%s", room_id);
    (void)snprintf(room->records[0].plan, sizeof room->records[0].plan, "%s", plan);
    (void)snprintf(text, sizeof text, "{\"body\":{\"decision\":\"accept\",\"text\":\"of %s\"}}", plan);
    room->records[0].item = mem_copy_text(text);
    room->records[0].body = mem_copy_text(text);
    room->records[0].figures[2] = (struct store_figure){ mem_array(4, 1, 4, NULL), 4 };
    store_world_write(&world, room);
    (void)snprintf(text, sizeof text, "INSERT INTO owners VALUES('%s', 'ann')", plan);
    store_file_run(world.path, text);
    (void)snprintf(text, sizeof text, "cache/%s/mesh", plan);
    folder_put_text(world.folder, text, plan);
}

static int set_up(void **state)
{
    (void)state;
    store_world_begin(&world);
    folder_put_text(world.folder, "cache/all", "");
    put_plan(hidden_id, "7q4k-m2wz", "i-1");
    put_plan(folder_id, "8nvg-ytgm", "i-2");
    put_plan("other", "9abc-defg", "i-3");
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    atomic_store(&folders_do_not_flush, false);
    store_world_end(&world);
    return 0;
}

static struct store_erase both_ids(void)
{
    struct store_erase what = { .id = "00ff", .row = "{\"action\":\"erase\",\"detail\":{\"erase\":\"00ff\"}}" };
    (void)snprintf(what.plan, sizeof what.plan, "%s", hidden_id);
    (void)snprintf(what.other, sizeof what.other, "%s", folder_id);
    (void)snprintf(what.cache, sizeof what.cache, "cache/%s", hidden_id);
    (void)snprintf(what.other_cache, sizeof what.other_cache, "cache/%s", folder_id);
    return what;
}

static struct store_answer *erase(const struct store_erase *what, bool is_begin)
{
    assert_true(store_erase(world.store, what, is_begin, 8));
    return store_world_await(&world, STORE_ERASE);
}

static int n_notes(void)
{
    int n = 0;
    DIR *entries = opendir(world.folder);
    assert_non_null(entries);
    for (const struct dirent *entry; (entry = readdir(entries));)
        n += strstr(entry->d_name, "-erase-") != NULL;
    (void)closedir(entries);
    return n;
}

static bool has_cache(const char *plan)
{
    char path[400];
    (void)snprintf(path, sizeof path, "%s/cache/%s", world.folder, plan);
    return access(path, F_OK) == 0;
}

static int64_t count(const char *sql)
{
    return store_file_number(world.path, sql);
}

/* Rows and files of this many of the plan's ids are gone, and no others. */
static void assert_erased(int n)
{
    assert_int_equal(count("SELECT count(*) FROM rooms"), 3 - n);
    assert_int_equal(count("SELECT count(*) FROM owners"), 3 - n);
    assert_int_equal(count("SELECT count(*) FROM records WHERE plan = ''"), n);
    assert_int_equal(count(
                         "SELECT count(*) FROM records WHERE item LIKE '%of smith-john%' OR body LIKE '%of smith-john%'"
                         " OR plan = 'smith-john'"),
                     n == 2 ? 0 : 1);
    assert_int_equal(count("SELECT count(*) FROM records WHERE plan = 'other' AND body LIKE '%of other%'"), 1);
    assert_int_equal(count("SELECT count(*) FROM rooms WHERE plan = 'other'"), 1);
    assert_int_equal(count("SELECT count(*) FROM record_figures"), 3 - n); /* pictures go with the words */
    assert_int_equal(count("SELECT count(*) FROM sqlite_schema WHERE type = 'trigger' AND name LIKE 'record%'"), 4);
    assert_false(has_cache(hidden_id));
    assert_int_equal(has_cache(folder_id), n < 2);
    assert_true(has_cache("other"));
    assert_int_equal(n_notes(), 0);
}

static void records_and_rooms_of_both_ids_are_erased(void **state)
{
    (void)state;
    const struct store_erase what = both_ids();
    struct store_answer *begun = erase(&what, true);
    assert_string_equal(begun->error.text, "");
    assert_int_equal(n_notes(), 1);
    store_answer_free(begun);
    struct store_answer *done = erase(&what, false);
    assert_string_equal(done->error.text, "");
    assert_int_equal(done->erased.n_rooms, 2);
    assert_int_equal(done->erased.n_records, 2);
    store_answer_free(done);
    assert_erased(2);
    assert_int_equal(count("SELECT json_extract(row, '$.detail.records') FROM audit WHERE row LIKE '%\"erase\"%'"), 2);
}

/* Records that were struck before have no plan any more, which is no id of a plan. */
static void of_a_plan_with_one_id_the_others_stay(void **state)
{
    (void)state;
    struct store_erase what = both_ids();
    what.other[0] = what.other_cache[0] = 0;
    for (int i = 0; i < 2; i++) {
        what.id[0] = (char)('0' + i); /* again, of what is not there any more */
        store_answer_free(erase(&what, true));
        struct store_answer *done = erase(&what, false);
        assert_string_equal(done->error.text, "");
        assert_int_equal(done->erased.n_records, 1 - i);
        store_answer_free(done);
    }
    assert_erased(1);
}

static void the_next_start_goes_on_with_both_ids(void **state)
{
    (void)state;
    const struct store_erase what = both_ids();
    store_answer_free(erase(&what, true));
    store_world_close(&world);
    store_erase_resume(world.path);
    assert_erased(2);
}

static void the_next_start_goes_on_from_a_note_of_the_version_before(void **state)
{
    (void)state;
    store_world_close(&world);
    folder_put_text(world.folder, "beamroom.db-erase-00ff",
                    "beamroom erase 1\n0123456789abcdef\n{\"action\":\"erase\",\"detail\":{\"erase\":\"00ff\"}}\n\n"
                    "cache/0123456789abcdef\n");
    store_erase_resume(world.path);
    assert_erased(1);
}

static void what_cannot_be_noted_for_good_is_not_erased_by_the_next_start(void **state)
{
    (void)state;
    const struct store_erase what = both_ids();
    atomic_store(&folders_do_not_flush, true);
    struct store_answer *begun = erase(&what, true);
    assert_int_equal(begun->error.code, ERROR_IO);
    store_answer_free(begun);
    atomic_store(&folders_do_not_flush, false);
    assert_int_equal(n_notes(), 0);
    store_world_close(&world);
    store_erase_resume(world.path);
    assert_int_equal(count("SELECT count(*) FROM rooms"), 3);
    assert_int_equal(count("SELECT count(*) FROM records WHERE plan = ''"), 0);
    assert_true(has_cache(hidden_id));
}

int main(void)
{
    log_start("test_store_erase", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(records_and_rooms_of_both_ids_are_erased),
        TEST(of_a_plan_with_one_id_the_others_stay),
        TEST(the_next_start_goes_on_with_both_ids),
        TEST(the_next_start_goes_on_from_a_note_of_the_version_before),
        TEST(what_cannot_be_noted_for_good_is_not_erased_by_the_next_start),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

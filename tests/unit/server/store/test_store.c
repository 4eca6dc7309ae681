/* The store: rooms on disk and back, older schemas, damage, full disks, a copy while it is in use. */
#include <glob.h>
#include <signal.h>
#include <sys/resource.h>

#include "core/base/log.h"
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
    world = (struct store_world){ 0 };
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->n_rooms, 0);
    store_answer_free(opened);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    store_world_end(&world);
    return 0;
}

static struct store_item *made_items(size_t n)
{
    struct store_item *items = mem_array(n, sizeof *items, 1 << 20, NULL);
    for (size_t i = 0; i < n; i++) {
        (void)snprintf(items[i].id, sizeof items[i].id, "note-%zu", i + 1);
        (void)snprintf(items[i].kind, sizeof items[i].kind, "note");
        (void)snprintf(items[i].author, sizeof items[i].author, "m1");
        (void)snprintf(items[i].author_name, sizeof items[i].author_name, "Ann");
        items[i].version = 1;
        items[i].created_ms = items[i].changed_ms = 1767225600000 + (int64_t)i;
        items[i].body = mem_copy_text("{\"text\":\"here\"}");
    }
    return items;
}

static struct store_link *made_links(size_t n)
{
    struct store_link *links = mem_array(n, sizeof *links, 1 << 20, NULL);
    for (size_t i = 0; i < n; i++) {
        memset(links[i].token_hash, (int)i + 1, STORE_HASH_BYTES);
        (void)snprintf(links[i].role, sizeof links[i].role, i % 2 ? "observer" : "reviewer");
        links[i].expires_ms = 1767225600000 + (int64_t)i;
    }
    return links;
}

static void what_was_written_is_read_after_opening_again(void **state)
{
    (void)state;
    struct store_room *written = store_made_room("7q4k-m2wz", 12, 100, 3);
    written->members[2].has_left = true;
    (void)snprintf(written->members[0].color, sizeof written->members[0].color, "#0072b2");
    (void)snprintf(written->members[0].role, sizeof written->members[0].role, "presenter");
    (void)snprintf(written->presenter, sizeof written->presenter, "m1");
    written->items = made_items(2);
    written->n_items = 2;
    written->has_links = true;
    written->links = made_links(2);
    written->n_links = 2;
    written->links[1].is_one_use = written->links[1].is_used = true;
    (void)snprintf(written->links[1].person, sizeof written->links[1].person, "0123abcd");
    store_world_write(&world, written);
    struct store_answer *opened = store_world_reopen(&world);
    assert_int_equal(opened->n_rooms, 1);
    assert_string_equal(opened->rooms[0].id, "7q4k-m2wz");
    assert_string_equal(opened->rooms[0].plan, "head");
    assert_int_equal(opened->rooms[0].revision, 12);
    assert_int_equal(opened->rooms[0].n_members, 3);
    assert_int_equal(opened->rooms[0].created_ms, 1767225600000);
    assert_false(opened->is_new);
    store_answer_free(opened);

    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_string_equal(read->plan, "head");
    assert_string_equal(read->presenter, "m1");
    assert_int_equal(read->revision, 12);
    assert_int_equal(read->n_named, 3);
    assert_int_equal(strlen(read->scene), 102);
    assert_string_equal(read->views, "[]");
    assert_int_equal(read->n_members, 3);
    assert_string_equal(read->members[0].id, "m1");
    assert_string_equal(read->members[0].color, "#0072b2");
    assert_string_equal(read->members[0].role, "presenter");
    assert_false(read->members[0].has_left);
    assert_true(read->members[2].has_left);
    assert_string_equal(read->members[1].name, "Member 2");
    assert_int_equal(read->members[1].secret_hash[31], 2);
    assert_int_equal(read->n_items, 2);
    assert_string_equal(read->items[1].id, "note-2");
    assert_string_equal(read->items[1].author_name, "Ann");
    assert_string_equal(read->items[1].body, "{\"text\":\"here\"}");
    assert_true(read->has_links);
    assert_int_equal(read->n_links, 2);
    assert_int_equal(read->links[0].token_hash[31], 1);
    assert_string_equal(read->links[0].role, "reviewer");
    assert_false(read->links[0].is_one_use || read->links[0].is_used);
    assert_int_equal(read->links[1].expires_ms, 1767225600001);
    assert_true(read->links[1].is_one_use && read->links[1].is_used);
    assert_string_equal(read->links[1].person, "0123abcd");
    store_room_free(read);
    assert_null(store_world_read(&world, "aaaa-bbbb"));
}

static void what_a_write_leaves_out_stays_and_an_item_without_a_body_goes(void **state)
{
    (void)state;
    struct store_room *whole = store_made_room("7q4k-m2wz", 1, 10, 2), *part = mem_new(sizeof *part);
    whole->items = made_items(3);
    whole->n_items = 3;
    whole->links = made_links(2);
    whole->n_links = 2;
    store_world_write(&world, whole);
    (void)snprintf(part->id, sizeof part->id, "7q4k-m2wz");
    part->revision = 1;
    part->views = mem_copy_text("[1]");
    part->items = made_items(2);
    part->n_items = 2;
    part->items[0].version = 2;
    free(part->items[1].body);
    part->items[1].body = NULL;
    store_world_write(&world, part);
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(strlen(read->scene), 12);
    assert_string_equal(read->views, "[1]");
    assert_string_equal(read->plan, "head");
    assert_int_equal(read->n_members, 2);
    assert_int_equal(read->n_items, 2);
    assert_int_equal(read->items[0].version, 2);
    assert_string_equal(read->items[1].id, "note-3");
    assert_int_equal(read->n_links, 2);
    store_room_free(read);
    part = mem_new(sizeof *part);
    (void)snprintf(part->id, sizeof part->id, "7q4k-m2wz");
    part->links = made_links(0); /* none is another thing than not asked for */
    store_world_write(&world, part);
    read = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(read->n_links, 0);
    store_room_free(read);
}

static void a_deleted_room_takes_its_members_and_items_along(void **state)
{
    (void)state;
    struct store_room *room = store_made_room("7q4k-m2wz", 1, 10, 2);
    room->items = made_items(1);
    room->n_items = 1;
    room->links = made_links(1);
    room->n_links = 1;
    store_world_write(&world, room);
    assert_true(store_delete(world.store, "7q4k-m2wz", 8));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    assert_null(store_world_read(&world, "7q4k-m2wz"));
    store_world_close(&world);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM members"), 0);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM items"), 0);
    assert_int_equal(store_file_number(world.path, "SELECT count(*) FROM links"), 0);
}

static void many_writes_that_wait_are_answered_in_their_order(void **state)
{
    (void)state;
    enum { N = 1000 };
    for (uint32_t i = 1; i <= N; i++)
        assert_true(store_write(world.store, store_made_room("7q4k-m2wz", i, 10, 1), i));
    for (uint32_t i = 1; i <= N; i++) {
        struct store_answer *answer = store_world_await(&world, STORE_WRITTEN);
        assert_int_equal(answer->ticket, i);
        store_answer_free(answer);
    }
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(read->revision, N);
    store_room_free(read);
}

static void what_was_handed_over_is_written_before_it_closes(void **state)
{
    (void)state;
    for (uint32_t i = 1; i <= 300; i++)
        assert_true(store_write(world.store, store_made_room("7q4k-m2wz", i, 10, 1), i));
    store_answer_free(store_world_reopen(&world));
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(read->revision, 300);
    store_room_free(read);
}

/* ---- older, newer, damaged ---------------------------------------------------------------------------------------- */

/* Opens a database made by this file of SQL, in place of the one there is. */
static struct store_answer *open_made(const char *sql_file)
{
    store_world_close(&world);
    folder_remove(world.folder);
    world.folder[0] = 0;
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, sql_file);
    store_world_open(&world);
    return store_world_await(&world, STORE_OPENED);
}

static void a_database_of_version_1_is_brought_up_to_date(void **state)
{
    (void)state;
    struct store_answer *opened = open_made("tests/data/store/version1.sql");
    assert_int_equal(opened->n_rooms, 2);
    assert_string_equal(opened->rooms[0].id, "aaaa-bbbb"); /* made later, so last used */
    assert_int_equal(opened->rooms[0].used_ms, 1767225700000);
    store_answer_free(opened);
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(read->revision, 42);
    assert_string_equal(read->scene, "{\"image\":{\"id\":\"ct\"}}");
    assert_int_equal(read->n_members, 2);
    assert_string_equal(read->members[1].name, "Özlem Ünal");
    assert_int_equal(read->members[1].secret_hash[0], 0x20);
    assert_string_equal(read->members[1].role, "");
    assert_false(read->members[1].has_left);
    assert_int_equal(read->n_items, 0);
    store_room_free(read);
    read = store_world_read(&world, "aaaa-bbbb");
    assert_null(read->scene);
    store_room_free(read);
    struct store_room *room = store_made_room("7q4k-m2wz", 43, 10, 1); /* and can be written */
    room->items = made_items(1);
    room->n_items = 1;
    store_world_write(&world, room);
}

static void a_database_of_version_2_is_brought_up_to_date(void **state)
{
    (void)state;
    struct store_answer *opened = open_made("tests/data/store/version2.sql");
    assert_int_equal(opened->n_rooms, 2);
    assert_string_equal(opened->rooms[0].id, "7q4k-m2wz"); /* last used */
    store_answer_free(opened);
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_string_equal(read->presenter, "m1");
    assert_string_equal(read->members[0].role, "presenter");
    assert_true(read->members[1].has_left);
    assert_int_equal(read->n_items, 1);
    assert_int_equal(read->items[0].version, 2);
    assert_false(read->has_links);
    assert_int_equal(read->n_links, 0);
    store_room_free(read);
    struct store_room *room = store_made_room("7q4k-m2wz", 43, 10, 1); /* and can be written */
    room->has_links = true;
    room->links = made_links(1);
    room->n_links = 1;
    store_world_write(&world, room);
    read = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(read->n_links, 1);
    store_room_free(read);
}

static void a_database_of_a_newer_program_is_left_alone(void **state)
{
    (void)state;
    struct error err = { 0 };
    const struct store_options options = { world.path, NULL, NULL };
    store_world_close(&world);
    store_file_run(world.path, "PRAGMA user_version = 1000");
    assert_null(store_create(&options, &err));
    assert_int_equal(err.code, ERROR_UNSUPPORTED);
    assert_non_null(strstr(err.text, "its version is 1000, this program knows versions up to"));
    assert_int_equal(store_file_number(world.path, "PRAGMA user_version"), 1000);
}

static void assert_moved_aside(void)
{
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->n_rooms, 0);
    store_answer_free(opened);
    store_world_write(&world, store_made_room("aaaa-bbbb", 1, 10, 1));
    char pattern[400];
    glob_t found;
    (void)snprintf(pattern, sizeof pattern, "%s/beamroom.db.damaged-*[0-9]", world.folder);
    assert_int_equal(glob(pattern, 0, NULL, &found), 0);
    assert_int_equal(found.gl_pathc, 1);
    globfree(&found);
}

static void a_damaged_database_is_moved_aside(void **state)
{
    (void)state;
    for (uint32_t i = 0; i < 40; i++) {
        char id[16];
        (void)snprintf(id, sizeof id, "room-%u", i);
        store_world_write(&world, store_made_room(id, i, 3000, 2));
    }
    store_world_close(&world);
    FILE *file = fopen(world.path, "r+b");
    assert_non_null(file);
    for (long at = 8192; at < 60000; at += 512) {
        assert_int_equal(fseek(file, at, SEEK_SET), 0);
        assert_int_equal(fwrite("damage", 6, 1, file), 1);
    }
    assert_int_equal(fclose(file), 0);
    store_world_open(&world);
    assert_moved_aside();
}

static void a_file_that_is_no_database_is_moved_aside(void **state)
{
    (void)state;
    store_world_close(&world);
    folder_put_text(world.folder, "beamroom.db",
                    "This was once a shopping list, and is longer than a header of SQLite, "
                    "which takes one hundred bytes of a file.");
    store_world_open(&world);
    assert_moved_aside();
}

static void a_database_of_another_program_is_moved_aside(void **state)
{
    (void)state;
    store_world_close(&world);
    store_file_run(world.path, "PRAGMA application_id = 7");
    store_world_open(&world);
    assert_moved_aside();
}

/* ---- full disks ------------------------------------------------------------------------------------------------- */

static void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

static void a_full_disk_is_reported_and_storing_goes_on_when_there_is_room(void **state)
{
    (void)state;
    store_world_write(&world, store_made_room("7q4k-m2wz", 1, 1000, 1));
    limit_files(200000);
    assert_true(store_write(world.store, store_made_room("7q4k-m2wz", 2, 900000, 1), 2));
    struct store_answer *failing = store_world_await(&world, STORE_FAILING);
    limit_files(RLIM_INFINITY); /* before an assertion can fail: its message may go to a file */
    limit_files(200000);
    int code = (int)failing->error.code;
    char text[240];
    (void)snprintf(text, sizeof text, "%s", failing->error.text);
    store_answer_free(failing);
    struct store_room *before = store_world_read(&world, "7q4k-m2wz");
    limit_files(RLIM_INFINITY);
    if (code != ERROR_LIMIT) /* SQLite knows a full disk, but not a limit on the size of files */
        assert_int_equal(code, ERROR_IO);
    assert_non_null(strstr(text, "disk"));
    assert_int_equal(before->revision, 1); /* the old content, whole */
    assert_int_equal(strlen(before->scene), 1002);
    store_room_free(before);
    struct store_answer *written = store_world_await(&world, STORE_WRITTEN); /* without being asked again */
    assert_int_equal(written->ticket, 2);
    assert_string_equal(written->error.text, "");
    store_answer_free(written);
    store_answer_free(store_world_await(&world, STORE_FINE));
    struct store_room *after = store_world_read(&world, "7q4k-m2wz");
    assert_int_equal(after->revision, 2);
    assert_int_equal(strlen(after->scene), 900002);
    store_room_free(after);
}

static void a_folder_that_is_missing_at_the_start_is_waited_for(void **state)
{
    (void)state;
    store_world_close(&world);
    folder_remove(world.folder);
    store_world_open(&world);
    struct store_answer *failing = store_world_await(&world, STORE_FAILING);
    assert_int_equal(failing->error.code, ERROR_IO);
    assert_non_null(strstr(failing->error.text, "No such file or directory"));
    store_answer_free(failing);
    assert_true(store_write(world.store, store_made_room("7q4k-m2wz", 1, 10, 1), 1));
    folder_put_text(world.folder, "here", "again");
    store_answer_free(store_world_await(&world, STORE_OPENED));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    store_answer_free(store_world_await(&world, STORE_FINE));
}

static void a_write_that_can_never_work_does_not_hold_up_others(void **state)
{
    (void)state;
    struct store_room *twice = store_made_room("aaaa-bbbb", 1, 10, 2);
    memcpy(twice->members[1].id, twice->members[0].id, sizeof twice->members[0].id);
    assert_true(store_write(world.store, twice, 1));
    assert_true(store_write(world.store, store_made_room("7q4k-m2wz", 1, 10, 1), 2));
    struct store_answer *answer = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(answer->ticket, 1);
    assert_int_equal(answer->error.code, ERROR_STATE);
    store_answer_free(answer);
    answer = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(answer->ticket, 2);
    assert_int_equal(answer->error.code, ERROR_NONE);
    store_answer_free(answer);
    assert_null(store_world_read(&world, "aaaa-bbbb"));
}

/* ---- copies ----------------------------------------------------------------------------------------------------- */

static void a_copy_made_while_it_is_written_is_whole(void **state)
{
    (void)state;
    char copy[320];
    struct error err = { 0 };
    (void)snprintf(copy, sizeof copy, "%s/copy.db", world.folder);
    for (uint32_t i = 1; i <= 300; i++)
        assert_true(store_write(world.store, store_made_room(i % 2 ? "7q4k-m2wz" : "aaaa-bbbb", i, 20000, 2), i));
    store_answer_free(store_world_await(&world, STORE_WRITTEN));
    assert_true(store_backup(world.path, copy, &err));
    assert_string_equal(err.text, "");
    assert_true(store_file_number(copy, "SELECT max(revision) FROM rooms") >= 1);
    assert_int_equal(store_file_number(copy, "SELECT count(*) FROM rooms WHERE length(scene) != 20002"), 0);
    assert_int_equal(store_file_number(copy, "PRAGMA user_version"),
                     store_file_number(world.path, "PRAGMA user_version"));
    assert_false(store_backup("/nowhere/at.db", copy, &err));
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    assert_false(store_backup(world.path, "/nowhere/copy.db", &err));
    assert_true(store_file_number(copy, "SELECT count(*) FROM rooms") >= 1); /* as it was */
}

int main(void)
{
    (void)signal(SIGXFSZ, SIG_IGN);
    log_start("test_store", LOG_ERROR + 1);
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(what_was_written_is_read_after_opening_again),
        TEST(what_a_write_leaves_out_stays_and_an_item_without_a_body_goes),
        TEST(a_deleted_room_takes_its_members_and_items_along),
        TEST(many_writes_that_wait_are_answered_in_their_order),
        TEST(what_was_handed_over_is_written_before_it_closes),
        TEST(a_database_of_version_1_is_brought_up_to_date),
        TEST(a_database_of_version_2_is_brought_up_to_date),
        TEST(a_database_of_a_newer_program_is_left_alone),
        TEST(a_damaged_database_is_moved_aside),
        TEST(a_file_that_is_no_database_is_moved_aside),
        TEST(a_database_of_another_program_is_moved_aside),
        TEST(a_full_disk_is_reported_and_storing_goes_on_when_there_is_room),
        TEST(a_folder_that_is_missing_at_the_start_is_waited_for),
        TEST(a_write_that_can_never_work_does_not_hold_up_others),
        TEST(a_copy_made_while_it_is_written_is_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

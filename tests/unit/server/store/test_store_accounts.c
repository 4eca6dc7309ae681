/* Accounts in the store: users, tokens, sessions, owners of plans; who owns a room and may enter it; a database of the
 * version before. */
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

static void write_accounts(struct store_accounts *accounts)
{
    assert_true(store_write_accounts(world.store, accounts, 11));
    struct store_answer *written = store_world_await(&world, STORE_WRITTEN);
    assert_int_equal(written->ticket, 11);
    assert_string_equal(written->error.text, "");
    store_answer_free(written);
}

static struct store_accounts *one_of_each(void)
{
    struct store_accounts *all = mem_new(sizeof *all);
    all->users = mem_array(1, sizeof *all->users, 1 << 20, NULL);
    all->tokens = mem_array(1, sizeof *all->tokens, 1 << 20, NULL);
    all->sessions = mem_array(1, sizeof *all->sessions, 1 << 20, NULL);
    all->owners = mem_array(1, sizeof *all->owners, 1 << 20, NULL);
    all->n_users = all->n_tokens = all->n_sessions = all->n_owners = 1;
    all->users[0] = (struct store_user){ .id = "ann",
                                         .name = "Ann Example",
                                         .password = "$argon2id$x",
                                         .groups = "physics\nboard\n",
                                         .n_failed = 2,
                                         .locked_until_ms = 1767225600001,
                                         .created_ms = 1767225600000 };
    all->tokens[0] = (struct store_token){ .id = "0a1b",
                                           .user = "ann",
                                           .name = "nightly",
                                           .scope = "read plan",
                                           .folders = "/plans/a\n",
                                           .created_ms = 1767225600000,
                                           .expires_ms = 1767325600000 };
    all->sessions[0] = (struct store_session){ .user = "ann",
                                               .name = "Ann Example",
                                               .groups = "board\nphysics\n",
                                               .source = "password",
                                               .address = "192.0.2.7",
                                               .created_ms = 1767225600000,
                                               .seen_ms = 1767225600000,
                                               .proved_ms = 1767225600000 };
    memset(all->tokens[0].hash, 0x70, STORE_HASH_BYTES);
    memset(all->sessions[0].hash, 0x50, STORE_HASH_BYTES);
    all->owners[0] = (struct store_owner){ .plan = "head", .user = "ann" };
    return all;
}

static void accounts_come_back_as_they_were(void **state)
{
    (void)state;
    write_accounts(one_of_each());
    struct store_answer *opened = store_world_reopen(&world);
    const struct store_accounts *read = opened->accounts;
    assert_int_equal(read->n_users, 1);
    assert_string_equal(read->users[0].id, "ann");
    assert_string_equal(read->users[0].name, "Ann Example");
    assert_string_equal(read->users[0].password, "$argon2id$x");
    assert_string_equal(read->users[0].groups, "board\nphysics\n"); /* by name */
    assert_int_equal(read->users[0].n_failed, 2);
    assert_int_equal(read->users[0].locked_until_ms, 1767225600001);
    assert_false(read->users[0].is_disabled);
    assert_int_equal(read->n_tokens, 1);
    assert_string_equal(read->tokens[0].scope, "read plan");
    assert_string_equal(read->tokens[0].folders, "/plans/a\n");
    assert_int_equal(read->tokens[0].hash[31], 0x70);
    assert_int_equal(read->tokens[0].expires_ms, 1767325600000);
    assert_int_equal(read->n_sessions, 1);
    assert_string_equal(read->sessions[0].groups, "board\nphysics\n");
    assert_string_equal(read->sessions[0].address, "192.0.2.7");
    assert_int_equal(read->sessions[0].hash[31], 0x50);
    assert_int_equal(read->n_owners, 1);
    assert_string_equal(read->owners[0].user, "ann");
    store_answer_free(opened);
}

static void accounts_change_and_end(void **state)
{
    (void)state;
    write_accounts(one_of_each());
    struct store_accounts *change = one_of_each();
    change->users[0].is_disabled = true;
    (void)snprintf(change->users[0].groups, sizeof change->users[0].groups, "board\n");
    change->tokens[0].revoked_ms = 1767225600009;
    change->sessions[0].is_deleted = true;
    change->owners[0].is_deleted = true;
    write_accounts(change);
    struct store_answer *opened = store_world_reopen(&world);
    assert_int_equal(opened->accounts->n_users, 1);
    assert_true(opened->accounts->users[0].is_disabled);
    assert_string_equal(opened->accounts->users[0].groups, "board\n");
    assert_int_equal(opened->accounts->tokens[0].revoked_ms, 1767225600009);
    assert_int_equal(opened->accounts->n_sessions, 0);
    assert_int_equal(opened->accounts->n_owners, 0);
    store_answer_free(opened);
}

static void a_backup_holds_the_accounts(void **state)
{
    (void)state;
    char copy[400];
    struct error err = { 0 };
    write_accounts(one_of_each());
    (void)snprintf(copy, sizeof copy, "%s/copy.db", world.folder);
    assert_true(store_backup(world.path, copy, &err));
    assert_int_equal(store_file_number(copy, "SELECT count(*) FROM users JOIN user_groups ON user = id"), 2);
    assert_int_equal(store_file_number(copy, "SELECT count(*) FROM tokens"), 1);
    assert_int_equal(store_file_number(copy, "SELECT count(*) FROM owners"), 1);
}

static void a_room_keeps_its_owner_people_and_guests(void **state)
{
    (void)state;
    struct store_room *room = store_made_room("7q4k-m2wz", 1, 10, 1);
    (void)snprintf(room->owner, sizeof room->owner, "ann");
    room->people = mem_copy_text("[\"bob\"]");
    room->is_open = true;
    (void)snprintf(room->members[0].user, sizeof room->members[0].user, "ann");
    room->members[0].is_guest = true;
    room->links = mem_array(1, sizeof *room->links, 1 << 20, NULL);
    room->n_links = 1;
    room->links[0] =
        (struct store_link){ .role = "observer", .maker = "ann", .name = "for the board", .allows_guests = true };
    store_world_write(&world, room);
    struct store_room *read = store_world_read(&world, "7q4k-m2wz");
    assert_string_equal(read->owner, "ann");
    assert_string_equal(read->people, "[\"bob\"]");
    assert_true(read->is_open);
    assert_string_equal(read->members[0].user, "ann");
    assert_true(read->members[0].is_guest);
    assert_string_equal(read->links[0].maker, "ann");
    assert_string_equal(read->links[0].name, "for the board");
    assert_true(read->links[0].allows_guests);
    store_room_free(read);
    room = store_made_room("7q4k-m2wz", 2, 10, 1); /* a write without people leaves them */
    store_world_write(&world, room);
    read = store_world_read(&world, "7q4k-m2wz");
    assert_string_equal(read->people, "[\"bob\"]");
    assert_false(read->is_open);
    store_room_free(read);
}

static void a_database_of_version_6_gets_accounts(void **state)
{
    (void)state;
    store_world_close(&world);
    folder_remove(world.folder);
    folder_make(world.folder);
    (void)snprintf(world.path, sizeof world.path, "%s/beamroom.db", world.folder);
    store_file_run_file(world.path, "tests/data/store/version6.sql");
    const int64_t n_rooms = store_file_number(world.path, "SELECT count(*) FROM rooms");
    assert_true(n_rooms > 0);
    store_world_open(&world);
    struct store_answer *opened = store_world_await(&world, STORE_OPENED);
    assert_int_equal(opened->n_rooms, n_rooms);
    assert_int_equal(opened->accounts->n_users, 0);
    struct store_room *read = store_world_read(&world, opened->rooms[0].id);
    assert_string_equal(read->owner, "");
    assert_null(read->people);
    assert_false(read->is_open);
    assert_true(read->n_members > 0);
    assert_string_equal(read->members[0].user, "");
    assert_false(read->members[0].is_guest);
    store_room_free(read);
    store_answer_free(opened);
    write_accounts(one_of_each());
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, set_up, tear_down)
    const struct CMUnitTest tests[] = {
        TEST(accounts_come_back_as_they_were),       TEST(accounts_change_and_end),
        TEST(a_backup_holds_the_accounts),           TEST(a_room_keeps_its_owner_people_and_guests),
        TEST(a_database_of_version_6_gets_accounts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

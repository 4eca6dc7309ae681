/* Opens stores for tests and waits for their answers. */
#include "tests/unit/store_world.h"

#include "core/base/mem.h"
#include "core/base/queue.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

enum { WAIT_MS = 60000 };

static void drop(void *answer)
{
    store_answer_free(answer);
}

static void answered(void *context, struct store_answer *answer)
{
    struct store_world *world = context;
    if (!queue_try_put(world->answers, answer))
        store_answer_free(answer);
}

void store_world_open(struct store_world *world)
{
    struct error err = { 0 };
    if (!world->folder[0])
        folder_make(world->folder);
    (void)snprintf(world->path, sizeof world->path, "%s/beamroom.db", world->folder);
    if (!world->answers)
        world->answers = queue_create(8192, drop);
    const struct store_options options = { world->path, answered, world };
    world->store = store_create(&options, &err);
    assert_string_equal(err.text, "");
}

void store_world_close(struct store_world *world)
{
    store_destroy(world->store);
    world->store = NULL;
    for (struct store_answer *answer; (answer = queue_try_take(world->answers));)
        store_answer_free(answer);
}

void store_world_end(struct store_world *world)
{
    store_world_close(world);
    queue_destroy(world->answers);
    folder_remove(world->folder);
    *world = (struct store_world){ 0 };
}

struct store_answer *store_world_answer(struct store_world *world)
{
    struct store_answer *answer = queue_take(world->answers, WAIT_MS);
    assert_non_null(answer);
    return answer;
}

struct store_answer *store_world_await(struct store_world *world, enum store_event event)
{
    struct store_answer *answer = store_world_answer(world);
    if (answer->event != event)
        fail_msg("event %d came, expected %d: %s", (int)answer->event, (int)event, answer->error.text);
    return answer;
}

void store_world_begin(struct store_world *world)
{
    *world = (struct store_world){ 0 };
    store_world_open(world);
    store_answer_free(store_world_await(world, STORE_OPENED));
}

struct store_answer *store_world_reopen(struct store_world *world)
{
    store_world_close(world);
    store_world_open(world);
    return store_world_await(world, STORE_OPENED);
}

struct store_room *store_world_read(struct store_world *world, const char *id)
{
    assert_true(store_read(world->store, id, 99));
    struct store_answer *answer = store_world_await(world, STORE_READ);
    struct store_room *room = answer->room;
    assert_int_equal(answer->ticket, 99);
    if (!room)
        assert_int_equal(answer->error.code, ERROR_NOT_FOUND);
    answer->room = NULL;
    store_answer_free(answer);
    return room;
}

struct store_room *store_made_room(const char *id, uint32_t revision, size_t n, size_t n_members)
{
    struct store_room *room = mem_new(sizeof *room);
    (void)snprintf(room->id, sizeof room->id, "%s", id);
    (void)snprintf(room->plan, sizeof room->plan, "head");
    room->created_ms = 1767225600000;
    room->used_ms = 1767225600000 + revision;
    room->revision = revision;
    room->n_named = (uint32_t)n_members;
    room->scene = malloc(n + 3);
    memset(room->scene, ' ', n + 3);
    room->scene[0] = '{';
    room->scene[n + 1] = '}';
    room->scene[n + 2] = 0;
    room->views = mem_copy_text("[]");
    room->members = mem_array(n_members, sizeof room->members[0], 1 << 20, NULL);
    room->n_members = n_members;
    for (size_t i = 0; i < n_members; i++) {
        (void)snprintf(room->members[i].id, sizeof room->members[i].id, "m%zu", i + 1);
        (void)snprintf(room->members[i].name, sizeof room->members[i].name, "Member %zu", i + 1);
        memset(room->members[i].secret_hash, (int)i + 1, STORE_HASH_BYTES);
    }
    return room;
}

void store_world_write(struct store_world *world, struct store_room *room)
{
    assert_true(store_write(world->store, room, 7));
    struct store_answer *answer = store_world_await(world, STORE_WRITTEN);
    assert_int_equal(answer->ticket, 7);
    assert_string_equal(answer->error.text, "");
    store_answer_free(answer);
}

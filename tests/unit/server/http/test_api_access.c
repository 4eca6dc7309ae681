/* The check of rights in front of every route: each route of the API is called by somebody who has not signed in, by
 * somebody to whom nothing is granted and by one to whom one of two folders is. Records and rooms on the disk, some of
 * which have the id that their plan had before. */
#include <pthread.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/auth/digest.h"
#include "server/http/api.h"
#include "server/http/api_rates.h"
#include "server/http/call.h"
#include "server/net/net.h"
#include "server/net/plan_rights.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"
#include "tests/unit/fake_renderer.h"
#include "tests/unit/store_world.h"

static struct {
    char folder[256], plans[300], data[300], database[300];
    char hidden_two[20]; /* the other id of the plan that is not granted */
    struct net *net;
    struct api *api;
    struct access *access;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
} world = { .mutex = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER };

struct asked { /* a call, and what came back */
    struct call *call;
    bool is_answered;
};

static void finished(struct call *call)
{
    struct asked *asked = call->connection;
    pthread_mutex_lock(&world.mutex);
    asked->is_answered = true;
    pthread_cond_broadcast(&world.changed);
    pthread_mutex_unlock(&world.mutex);
}

static void handle(struct net *net, void *argument)
{
    (void)net;
    api_handle(world.api, argument);
}

static enum call_method method_of(const char *word)
{
    return strcmp(word, "GET") == 0     ? CALL_GET
           : strcmp(word, "POST") == 0  ? CALL_POST
           : strcmp(word, "PATCH") == 0 ? CALL_PATCH
                                        : CALL_DELETE;
}

/* The answered call, for call_destroy. before: NULL, or that query parameter. */
static struct call *ask_before(const struct identity *who, const char *method, const char *path, const char *before,
                               const char *body)
{
    struct call *call = call_create();
    struct asked asked = { .call = call };
    call->method = method_of(method);
    call_set_path(call, path);
    if (before)
        call->query[call->n_query++] = (struct call_pair){ mem_copy_text("before"), mem_copy_text(before) };
    call->identity = *who;
    call->content_type = strdup("application/json");
    call->body = body ? strdup(body) : NULL;
    call->n_body = body ? strlen(body) : 0;
    mem_put_text(call->client, sizeof call->client, "192.0.2.7");
    call->finished = finished;
    call->connection = &asked;
    net_post(world.net, handle, call);
    pthread_mutex_lock(&world.mutex);
    while (!asked.is_answered)
        pthread_cond_wait(&world.changed, &world.mutex);
    pthread_mutex_unlock(&world.mutex);
    return call;
}

static struct call *ask(const struct identity *who, const char *method, const char *path, const char *body)
{
    return ask_before(who, method, path, NULL, body);
}

static struct identity person(const char *user)
{
    struct identity identity = { .source = IDENTITY_PASSWORD, .scopes = IDENTITY_SCOPE_ALL };
    mem_put_text(identity.user, sizeof identity.user, user);
    return identity;
}

static const struct identity nobody = { .source = IDENTITY_NOBODY }, machine = { .source = IDENTITY_MACHINE };

/* A folder of plans, a plan in it, and the folder that plans stand in. */
static void put_plan(const char *folder, const char *plan)
{
    char path[600];
    (void)snprintf(path, sizeof path, "%s/%s", world.plans, folder);
    assert_int_equal(mkdir(path, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/%s/%s", world.plans, folder, plan);
    assert_int_equal(mkdir(path, 0700), 0);
    folder_put_text(path, "plan.json", "{}");
}

/* A record on disk, and a room on its plan. */
static void put_record(struct store_world *store, const char *id, const char *plan)
{
    char text[100];
    (void)snprintf(text, sizeof text, "r-%s", id);
    struct store_room *room = store_made_room(text, 1, 10, 1);
    mem_put_text(room->plan, sizeof room->plan, plan);
    store_world_write(store, room);
    room = mem_new(sizeof *room);
    *room = (struct store_room){ .is_prompt = true, .n_records = 1 };
    mem_put_text(room->id, sizeof room->id, text);
    mem_put_text(room->plan, sizeof room->plan, plan);
    room->records = mem_array(1, sizeof room->records[0], 1 << 20, NULL);
    room->records[0] = (struct store_record){ .kind = "decision", .author_name = "Ann", .time_ms = 7 };
    mem_put_text(room->records[0].id, sizeof room->records[0].id, id);
    mem_put_text(room->records[0].room, sizeof room->records[0].room, text);
    mem_put_text(room->records[0].plan, sizeof room->records[0].plan, plan);
    room->records[0].item = mem_copy_text("{\"body\":{\"decision\":\"accept\"}}");
    room->records[0].body = mem_copy_text("{}");
    store_world_write(store, room);
}

static void put_records(void)
{
    char digest[DIGEST_TEXT], path[600], *real;
    struct store_world store = { 0 };
    (void)snprintf(path, sizeof path, "%s/other/two", world.plans);
    assert_non_null(real = realpath(path, NULL));
    digest_text(real, digest);
    free(real);
    (void)snprintf(world.hidden_two, sizeof world.hidden_two, "%.16s", digest);
    mem_put_text(store.folder, sizeof store.folder, world.data);
    store_world_open(&store);
    store_answer_free(store_world_await(&store, STORE_OPENED));
    put_record(&store, "i-1", "granted-one");
    put_record(&store, "i-2", "other-two");
    put_record(&store, "i-3", "granted-one");
    put_record(&store, "i-4", world.hidden_two);
    put_record(&store, "i-5", "gone");
    mem_put_text(world.database, sizeof world.database, store.path);
    store_world_close(&store); /* the folder stays */
    queue_destroy(store.answers);
}

static int begin(void **state)
{
    (void)state;
    static char line[400], self[512];
    assert_true(readlink("/proc/self/exe", self, sizeof self - 1) > 0);
    struct error err = { 0 };
    folder_make(world.folder);
    (void)snprintf(world.plans, sizeof world.plans, "%s/plans", world.folder);
    assert_int_equal(mkdir(world.plans, 0700), 0);
    put_plan("granted", "one");
    put_plan("other", "two");
    (void)snprintf(world.data, sizeof world.data, "%s/data", world.folder);
    (void)mkdir(world.data, 0700);
    (void)snprintf(line, sizeof line, "%s/granted olga observer", world.plans);
    world.access = access_create();
    assert_true(access_set(world.access,
                           (struct access_line[]){
                               { line, "m", 1 }, { "uploads paul planner", "m", 2 }, { "* adam admin", "m", 3 } },
                           3, &err));
    put_records();
    const char *const plans[] = { world.plans };
    const struct net_options options = {
        .fleet = { .plan_folders = plans,
                   .n_plan_folders = 1,
                   .data_folder = world.data,
                   .gl = "auto",
                   .stub_renderer = true,
                   .renderer_path = self },
        .access = world.access,
        .database = world.database,
    };
    world.net = net_create(&options, &err);
    if (!world.net)
        fail_msg("%s", err.text);
    world.api = api_create(world.net, NULL, 1 << 20, &(struct api_doors){ .is_alone = true });
    for (int i = 0; i < 600 && !net_plans_are_listed(world.net); i++)
        usleep(100000);
    return 0;
}

static int end(void **state)
{
    (void)state;
    net_destroy(world.net);
    api_destroy(world.api);
    access_destroy(world.access);
    folder_remove(world.folder);
    return 0;
}

/* The path with ids in it: the plan that is not granted, rooms and jobs that are not there. */
static void path_of(const char *route, const char *plan, char path[200])
{
    size_t n = 0;
    while (*route) {
        if (*route != '{') {
            path[n++] = *route++;
            continue;
        }
        n += (size_t)snprintf(path + n, 200 - n, "%s", strncmp(route, "{plan}", 6) == 0 ? plan : "x");
        route += strcspn(route, "}") + 1;
    }
    path[n] = 0;
}

static void nobody_gets_nothing_but_what_is_free(void **state)
{
    (void)state;
    struct api_route route;
    size_t n_refused = 0;
    for (size_t i = 0; api_route_at(i, &route); i++) {
        const struct access_route *need = access_route_find(route.method, route.path);
        char path[200];
        path_of(route.path, "granted-one", path);
        assert_non_null(need);
        if (need->right == ACCESS_FREE)
            continue;
        struct call *call = ask(&nobody, route.method, path, "{}");
        const int expected = strcmp(route.path, "/p/{saved}") == 0 ? 303 : 401;
        if (call->status != expected)
            fail_msg("%s %s: %d, expected %d", route.method, path, call->status, expected);
        n_refused++;
        call_destroy(call);
    }
    assert_true(n_refused > 80);
}

static bool is_same_answer(const struct call *a, const struct call *b)
{
    bool is_same = a->status == b->status && a->n_bytes == b->n_bytes && memcmp(a->bytes, b->bytes, a->n_bytes) == 0 &&
                   a->n_headers == b->n_headers && strcmp(a->media_type, b->media_type) == 0;
    for (size_t i = 0; is_same && i < a->n_headers; i++)
        is_same = strcmp(a->headers[i].name, b->headers[i].name) == 0 &&
                  strcmp(a->headers[i].value, b->headers[i].value) == 0;
    return is_same;
}

/* The bytes of the answer with the id, wherever it stands, as the other id of the same length. */
static void put_id(struct call *call, const char *from, const char *to)
{
    const size_t n = strlen(from);
    for (size_t i = 0; i + n <= call->n_bytes; i++)
        if (memcmp(call->bytes + i, from, n) == 0)
            memcpy(call->bytes + i, to, n);
}

static void a_plan_that_is_not_granted_is_as_one_that_is_not_there(void **state)
{
    (void)state;
    const struct identity olga = person("olga");
    struct api_route route;
    for (size_t i = 0; api_route_at(i, &route); i++) {
        char foreign[200], absent[200];
        if (!strstr(route.path, "/{plan}"))
            continue;
        path_of(route.path, "other-two", foreign);
        path_of(route.path, "other-owt", absent);
        struct call *a = ask(&olga, route.method, foreign, "{}"), *b = ask(&olga, route.method, absent, "{}");
        put_id(b, "other-owt", "other-two");
        if (a->status != 404 || !is_same_answer(a, b))
            fail_msg("%s %s: %d %.*s and %d %.*s", route.method, foreign, a->status, (int)a->n_bytes, (char *)a->bytes,
                     b->status, (int)b->n_bytes, (char *)b->bytes);
        call_destroy(a);
        call_destroy(b);
    }
}

static void rooms_jobs_and_plans_of_a_body_are_not_there_either(void **state)
{
    (void)state;
    const struct identity olga = person("olga");
    struct call *made = ask(&machine, "POST", "/api/v1/rooms", "{\"plan\":\"granted-one\"}");
    struct problem problem;
    assert_int_equal(made->status, 201);
    cJSON *room = json_read((const char *)made->bytes, made->n_bytes, &problem);
    char path[200], other[200];
    (void)snprintf(path, sizeof path, "/api/v1/rooms/%s", json_text(room, "id"));
    (void)snprintf(other, sizeof other, "/api/v1/rooms/0000-0000");
    struct call *a = ask(&olga, "GET", path, NULL), *b = ask(&olga, "GET", other, NULL);
    put_id(b, "0000-0000", json_text(room, "id"));
    assert_int_equal(a->status, 404);
    assert_true(is_same_answer(a, b));
    call_destroy(a);
    call_destroy(b);
    a = ask(&olga, "POST", "/api/v1/rooms", "{\"plan\":\"other-two\"}");
    b = ask(&olga, "POST", "/api/v1/rooms", "{\"plan\":\"other-owt\"}");
    put_id(b, "other-owt", "other-two");
    assert_int_equal(a->status, 404);
    assert_true(is_same_answer(a, b));
    call_destroy(a);
    call_destroy(b);
    a = ask(&olga, "POST", "/api/v1/rooms", "{\"plan\":\"granted-one\"}"); /* she sees it, and may not make rooms */
    assert_int_equal(a->status, 403);
    call_destroy(a);
    call_destroy(made);
    made = ask(&machine, "POST", "/api/v1/plans/granted-one/open", "");
    a = ask(&olga, "GET", "/api/v1/jobs/open-1", NULL);
    b = ask(&olga, "GET", "/api/v1/jobs/open-9", NULL);
    put_id(b, "open-9", "open-1");
    assert_int_equal(a->status, 404);
    assert_true(is_same_answer(a, b));
    call_destroy(a);
    call_destroy(b);
    call_destroy(made);
    cJSON_Delete(room);
}

static void lists_have_what_may_be_looked_at(void **state)
{
    (void)state;
    const struct identity who[] = { person("olga"), person("eve"), machine };
    static const size_t n_plans[] = { 1, 0, 2 };
    for (size_t i = 0; i < 3; i++) {
        struct problem problem;
        struct call *call = ask(&who[i], "GET", "/api/v1/plans", NULL);
        cJSON *json = json_read((const char *)call->bytes, call->n_bytes, &problem);
        assert_int_equal(cJSON_GetArraySize(cJSON_GetObjectItemCaseSensitive(json, "plans")), n_plans[i]);
        cJSON_Delete(json);
        call_destroy(call);
    }
    struct call *call = ask(&who[0], "GET", "/api/v1/plans/granted-one", NULL);
    assert_int_equal(call->status, 200);
    call_destroy(call);
    call = ask(&who[0], "POST", "/api/v1/plans/granted-one/close", NULL); /* seen, so the refusal is told */
    assert_int_equal(call->status, 403);
    call_destroy(call);
    call = ask(&who[0], "GET", "/metrics", NULL);
    assert_int_equal(call->status, 403);
    call_destroy(call);
}

/* The ids of the records before this one, with a space behind each. */
static void ids_before(const struct identity *who, const char *id, char ids[100])
{
    struct problem problem;
    struct call *call = ask_before(who, "GET", "/api/v1/records", id, NULL);
    assert_int_equal(call->status, 200);
    cJSON *json = json_read((const char *)call->bytes, call->n_bytes, &problem), *record;
    size_t n = 0;
    ids[0] = 0;
    cJSON_ArrayForEach(record, cJSON_GetObjectItemCaseSensitive(json, "records")) n +=
        (size_t)snprintf(ids + n, 100 - n, "%s ", json_text(record, "id"));
    cJSON_Delete(json);
    call_destroy(call);
}

static void records_before_one_that_may_not_be_seen_are_those_before_one_that_is_not_there(void **state)
{
    (void)state;
    const struct identity olga = person("olga");
    char ids[100];
    ids_before(&machine, "i-4", ids);
    assert_string_equal(ids, "i-3 i-2 i-1 ");
    ids_before(&machine, "i-2", ids);
    assert_string_equal(ids, "i-1 ");
    ids_before(&olga, "i-3", ids);
    assert_string_equal(ids, "i-1 ");
    ids_before(&olga, "i-2", ids);
    assert_string_equal(ids, "");
    ids_before(&olga, "i-9", ids);
    assert_string_equal(ids, "");
}

static void assert_answers(const struct identity *who, const char *plan, const char *reason, int status,
                           const char *expected)
{
    char path[100], body[100], text[600];
    (void)snprintf(path, sizeof path, "/api/v1/plans/%s/erase", plan);
    (void)snprintf(body, sizeof body, "{\"reason\":\"%s\"}", reason);
    struct call *call = ask(who, "POST", path, body);
    (void)snprintf(text, sizeof text, "%.*s", (int)call->n_bytes, (const char *)call->bytes);
    if (call->status != status || !strstr(text, expected))
        fail_msg("%s: %d %s", path, call->status, text);
    call_destroy(call);
}

static void a_plan_is_erased_by_either_id_under_both_and_one_that_is_gone_by_its_own(void **state)
{
    (void)state;
    const struct identity olga = person("olga"), adam = person("adam");
    char path[100];
    (void)snprintf(path, sizeof path, "/api/v1/plans/%s", world.hidden_two);
    struct call *call = ask(&machine, "GET", path, NULL); /* only erasing goes by the other id */
    assert_int_equal(call->status, 404);
    call_destroy(call);
    assert_answers(&olga, world.hidden_two, "asked", 404, "there is no plan");
    assert_answers(&olga, "gone", "asked", 404, "there is no plan");
    assert_answers(&adam, world.hidden_two, "of other-TWO", 422, "/reason");
    assert_answers(&adam, "other-two", world.hidden_two, 422, "/reason");
    assert_answers(&adam, world.hidden_two, "asked", 200, "{\"rooms\":2,\"records\":2}");
    assert_answers(&adam, "gone", "asked", 200, "{\"rooms\":1,\"records\":1}");
    assert_answers(&adam, "granted-one", "asked", 200, "\"records\":2}");
}

static void who_calls_too_often_is_told_when_to_come_back_and_others_are_not_held_up(void **state)
{
    (void)state;
    struct api_rates *rates = api_rates_create();
    struct call *mallory = call_create(), *anna = call_create();
    struct problem problem = { 0 };
    int n = 0;
    mem_put_text(mallory->client, sizeof mallory->client, "192.0.2.66");
    mem_put_text(anna->identity.user, sizeof anna->identity.user, "192.0.2.66"); /* a user is no address */
    const int64_t start_us = 1000000;
    while (n < 1000 && api_rates_take(rates, mallory, API_RATE_ROOMS, start_us, &problem))
        n++;
    assert_int_equal(n, 40);
    assert_int_equal(problem.type, PROBLEM_LIMIT);
    assert_in_range(problem.retry_after_ms, 1900, 2100); /* 0.5 a second */
    assert_true(api_rates_take(rates, anna, API_RATE_ROOMS, start_us, &problem));
    assert_true(api_rates_take(rates, mallory, API_RATE_CALLS, start_us, &problem));
    assert_false(api_rates_take(rates, mallory, API_RATE_ROOMS, start_us + 1900000, &problem));
    assert_true(api_rates_take(rates, mallory, API_RATE_ROOMS, start_us + 2100000, &problem));
    assert_false(api_rates_take(rates, mallory, API_RATE_ROOMS, start_us + 2100000, &problem));
    call_destroy(mallory);
    call_destroy(anna);
    api_rates_destroy(rates);
}

int main(int argc, char **argv)
{
    if (argc > 1)
        return fake_renderer_main(argc, argv);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nobody_gets_nothing_but_what_is_free),
        cmocka_unit_test(a_plan_that_is_not_granted_is_as_one_that_is_not_there),
        cmocka_unit_test(lists_have_what_may_be_looked_at),
        cmocka_unit_test(who_calls_too_often_is_told_when_to_come_back_and_others_are_not_held_up),
        cmocka_unit_test(rooms_jobs_and_plans_of_a_body_are_not_there_either),
        cmocka_unit_test(records_before_one_that_may_not_be_seen_are_those_before_one_that_is_not_there),
        cmocka_unit_test(a_plan_is_erased_by_either_id_under_both_and_one_that_is_gone_by_its_own),
    };
    return cmocka_run_group_tests(tests, begin, end);
}

/* The API's table of routes against proto/http.json, and the page's files. */
#include "server/http/api.h"
#include "server/http/call.h"
#include "server/http/files.h"
#include "tests/check.h"

extern const unsigned char openapi_json[];
extern const size_t openapi_json_bytes;

static void every_route_is_described_and_every_description_is_a_route(void **state)
{
    (void)state;
    struct problem problem;
    cJSON *description = json_read((const char *)openapi_json, openapi_json_bytes, &problem);
    assert_non_null(description);
    const cJSON *paths = cJSON_GetObjectItemCaseSensitive(description, "paths"), *path;
    size_t n_described = 0;
    cJSON_ArrayForEach(path, paths)
    {
        n_described += (size_t)cJSON_GetArraySize(path);
    }
    struct api_route route;
    size_t n_routes = 0;
    for (; api_route_at(n_routes, &route); n_routes++) {
        char method[8] = "";
        for (size_t k = 0; route.method[k]; k++)
            method[k] = (char)(route.method[k] | 0x20);
        path = cJSON_GetObjectItemCaseSensitive(paths, route.path);
        if (!path || !cJSON_GetObjectItemCaseSensitive(path, method))
            fail_msg("%s %s is neither in proto/http.json nor a question of proto/packets.json", route.method,
                     route.path);
    }
    assert_int_equal(n_described, n_routes);
    cJSON_Delete(description);
}

static void a_path_is_split_within_its_limits(void **state)
{
    (void)state;
    struct call *call = call_create();
    call_set_path(call, "/api/v1/plans/phantom/");
    assert_int_equal(call->n_segments, 4);
    assert_string_equal(call->segments[3], "phantom");
    assert_int_equal(call->early.type, PROBLEM_NONE);
    call_destroy(call);
    call = call_create();
    call_set_path(call, "/1/2/3/4/5/6/7/8/9");
    assert_int_equal(call->early.type, PROBLEM_NOT_FOUND);
    call_destroy(call);
    char longer[CALL_MAX_PATH + 1];
    memset(longer, 'x', sizeof longer);
    longer[0] = '/';
    longer[sizeof longer - 1] = 0;
    call = call_create();
    call_set_path(call, longer);
    assert_int_equal(call->early.type, PROBLEM_NOT_FOUND);
    call_destroy(call);
}

static void a_number_in_a_query_is_a_finite_decimal(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool is_good;
        double value;
    } cases[] = { { "1.5", true, 1.5 }, { "-2e1", true, -20 }, { "", false, 0 },
                  { "1x", false, 0 },   { "0x10", false, 0 },  { "nan", false, 0 },
                  { "inf", false, 0 },  { "1e999", false, 0 }, { "1 2", false, 0 } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        struct call *call = call_create();
        struct problem problem = { 0 };
        double value = 7;
        call->query[call->n_query++] = (struct call_pair){ strdup("x"), strdup(cases[i].text) };
        bool ok = call_query_number(call, "x", true, &value, &problem);
        if (ok != cases[i].is_good)
            fail_msg("\"%s\" was %s", cases[i].text, ok ? "accepted" : "refused");
        assert_close(value, ok ? cases[i].value : 7, 0);
        assert_string_equal(problem.pointer, ok ? "" : "/x");
        call_destroy(call);
    }
}

static void a_folder_that_is_no_page_is_refused(void **state)
{
    (void)state;
    struct error err = { 0 };
    assert_null(files_create("proto", &err)); /* has files, but no index.html */
    assert_int_equal(err.code, ERROR_NOT_FOUND);
    assert_null(files_create("no/such/folder", &err));
    assert_int_equal(err.code, ERROR_IO);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_route_is_described_and_every_description_is_a_route),
        cmocka_unit_test(a_path_is_split_within_its_limits),
        cmocka_unit_test(a_number_in_a_query_is_a_finite_decimal),
        cmocka_unit_test(a_folder_that_is_no_page_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

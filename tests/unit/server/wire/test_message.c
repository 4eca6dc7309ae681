/* proto/fixtures: every good example decodes and encodes to itself, every bad one is refused with the error it names.
 */
#include <dirent.h>

#include "server/wire/message.h"
#include "tests/check.h"

static cJSON *read_file(const char *folder, const char *name)
{
    static char text[65536];
    char path[512];
    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    size_t n = fread(text, 1, sizeof text, file);
    fclose(file);
    struct problem problem = { 0 };
    cJSON *json = json_read(text, n, &problem);
    if (!json)
        fail_msg("%s: %s", path, problem.detail);
    return json;
}

static int for_each_fixture(const char *folder,
                            void (*check)(const char *name, const cJSON *fixture, const char *text, bool from_client))
{
    DIR *dir = opendir(folder);
    assert_non_null(dir);
    int n = 0;
    for (struct dirent *entry; (entry = readdir(dir));) {
        if (!strstr(entry->d_name, ".json"))
            continue;
        cJSON *fixture = read_file(folder, entry->d_name);
        char *text = json_write(cJSON_GetObjectItemCaseSensitive(fixture, "message"));
        check(entry->d_name, fixture, text, strcmp(json_text(fixture, "from"), "client") == 0);
        free(text);
        cJSON_Delete(fixture);
        n++;
    }
    closedir(dir);
    return n;
}

static void check_good(const char *name, const cJSON *fixture, const char *text, bool from_client)
{
    struct message message;
    struct problem problem = { 0 };
    if (!message_read(text, strlen(text), from_client, &message, &problem))
        fail_msg("%s was refused: %s", name, problem.detail);
    char *again = message_write(&message);
    cJSON *json = cJSON_Parse(again);
    if (!cJSON_Compare(json, cJSON_GetObjectItemCaseSensitive(fixture, "message"), true))
        fail_msg("%s came back as %s", name, again);
    cJSON_Delete(json);
    free(again);
    message_finish(&message);
}

static void check_bad(const char *name, const cJSON *fixture, const char *text, bool from_client)
{
    struct message message;
    struct problem problem = { 0 };
    if (message_read(text, strlen(text), from_client, &message, &problem))
        fail_msg("%s was accepted", name);
    const cJSON *error = cJSON_GetObjectItemCaseSensitive(fixture, "error");
    assert_string_equal(problem_word(problem.type), json_text(error, "type"));
    assert_string_equal(problem.code, json_text(error, "code"));
    assert_string_equal(problem.pointer, json_text(error, "pointer"));
    assert_true(problem.detail[0] != 0);
}

static void every_good_message_decodes_and_encodes_to_itself(void **state)
{
    (void)state;
    assert_true(for_each_fixture("proto/fixtures/good", check_good) >= MESSAGE_N_TYPES);
}

static void every_bad_message_is_refused_with_the_error_it_names(void **state)
{
    (void)state;
    assert_true(for_each_fixture("proto/fixtures/bad", check_bad) >= 15);
}

static void refuse(const char *text, size_t n, enum problem_type type)
{
    struct message message;
    struct problem problem = { 0 };
    assert_false(message_read(text, n, true, &message, &problem));
    assert_int_equal(problem.type, type);
}

static void bytes_that_are_no_json_are_refused(void **state)
{
    (void)state;
    static char large[WIRE_MAX_CLIENT_BYTES + 1];
    memset(large, ' ', sizeof large);
    refuse(large, sizeof large, PROBLEM_TOO_LARGE);
    refuse("", 0, PROBLEM_JSON);
    refuse("{\"type\":\"ping\"", 14, PROBLEM_JSON);
    refuse("{\"type\":\"ping\",\"time_ms\":1} x", 29, PROBLEM_JSON);
    refuse("{\"type\":\"\xff\"}", 12, PROBLEM_JSON);
    refuse("{\"type\":\"\xed\xa0\x80\"}", 14, PROBLEM_JSON); /* a lone surrogate */
    refuse("{\"type\":\"ping\",\"time_ms\":1e999}", 31, PROBLEM_VALIDATION);
    refuse("{\"type\":\"view.close\",\"view\":1,\"view\":2}", 39, PROBLEM_VALIDATION); /* twice the same field */
    char deep[200];
    memset(deep, '[', sizeof deep);
    refuse(deep, sizeof deep, PROBLEM_JSON);
}

static void a_problem_survives_the_way_through_json(void **state)
{
    (void)state;
    struct problem problem = { 0 }, back = { 0 };
    assert_false(
        problem_set(&problem, PROBLEM_STALE_REVISION, "/regions/brain", "", "the scene is at revision %d", 43));
    problem.retry_after_ms = 250;
    cJSON *json = problem_to_json(&problem);
    assert_string_equal(json_text(json, "type"), "/problems/stale-revision");
    assert_int_equal((int)json_number(json, "status", 0), 412); /* RFC 9110 15.5.13 */
    assert_true(problem_from_json(json, &back));
    assert_memory_equal(&problem, &back, sizeof problem);
    cJSON_Delete(json);
    json = cJSON_CreateObject();
    assert_false(problem_from_json(json, &back));
    cJSON_Delete(json);
}

static void a_text_that_names_nul_is_refused_and_a_backslash_before_u0000_is_not(void **state)
{
    (void)state;
    static const char named[] = "{\"plan\":\"phantom\\u0000x\"}", spelled[] = "{\"plan\":\"phantom\\\\u0000\"}";
    struct problem problem = { 0 };
    assert_null(json_read(named, sizeof named - 1, &problem));
    assert_int_equal(problem.type, PROBLEM_JSON);
    cJSON *json = json_read(spelled, sizeof spelled - 1, &problem);
    assert_non_null(json);
    assert_string_equal(json_text(json, "plan"), "phantom\\u0000");
    cJSON_Delete(json);
}

/* The short way of message_read and the general reader give the same result. */
static void an_acknowledgement_is_read_alike_however_it_is_written(void **state)
{
    static const struct {
        const char *text;
        int64_t view, sequence; /* view 0: refused */
    } cases[] = {
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":0}", 1, 0 },
        { "{\"type\":\"frame.shown\",\"view\":8,\"sequence\":4294967295}", 8, 4294967295 },
        { " {\"type\": \"frame.shown\", \"view\": 3, \"sequence\": 77}\n", 3, 77 },
        { "{\"sequence\":77,\"view\":3,\"type\":\"frame.shown\"}", 3, 77 },
        { "{\"type\":\"frame.shown\",\"view\":3,\"sequence\":77.0}", 3, 77 },
        { "{\"type\":\"frame.shown\",\"view\":3,\"sequence\":77} ", 3, 77 },
        { "{\"type\":\"frame.shown\",\"view\":0,\"sequence\":1}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":10,\"sequence\":1}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":4294967296}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":-1}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":18446744073709551617}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":,\"sequence\":1}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":1", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":1}}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1,\"sequence\":1,\"more\":1}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":1}", 0, 0 },
        { "{\"type\":\"frame.shown\",\"view\":", 0, 0 },
    };
    (void)state;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        /* no byte behind it, so that a checker of memory finds what is read too far */
        size_t n = strlen(cases[i].text);
        char *exact = malloc(n);
        assert_non_null(exact);
        memcpy(exact, cases[i].text, n);
        struct message message;
        struct problem problem = { 0 };
        bool ok = message_read(exact, n, true, &message, &problem);
        free(exact);
        if (ok != (cases[i].view > 0))
            fail_msg("%s: %s", cases[i].text, ok ? "taken" : problem.detail);
        if (!ok)
            continue;
        assert_int_equal(message.type, MESSAGE_FRAME_SHOWN);
        assert_int_equal(message.frame_shown.view, cases[i].view);
        assert_int_equal(message.frame_shown.sequence, cases[i].sequence);
        message_finish(&message);
    }
    struct message message;
    struct problem problem = { 0 };
    assert_false(message_read(cases[0].text, strlen(cases[0].text), false, &message, &problem)); /* not the server's */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_text_that_names_nul_is_refused_and_a_backslash_before_u0000_is_not),
        cmocka_unit_test(every_good_message_decodes_and_encodes_to_itself),
        cmocka_unit_test(every_bad_message_is_refused_with_the_error_it_names),
        cmocka_unit_test(bytes_that_are_no_json_are_refused),
        cmocka_unit_test(an_acknowledgement_is_read_alike_however_it_is_written),
        cmocka_unit_test(a_problem_survives_the_way_through_json),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

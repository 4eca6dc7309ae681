/* Where the body of a request ends; entity tags; origins. */
#include "server/front/body.h"
#include "server/http/etag.h"
#include "server/wire/origin.h"
#include "tests/check.h"

static void a_body_of_a_length_ends_there(void **state)
{
    (void)state;
    struct body body;
    struct problem problem = { 0 };
    size_t n;
    body_begin(&body, false, 0);
    assert_true(body_is_ended(&body));
    body_begin(&body, false, 5);
    assert_true(body_take(&body, "hel", 3, &n, &problem));
    assert_int_equal(n, 3);
    assert_false(body_is_ended(&body));
    assert_true(body_take(&body, "loGET /", 7, &n, &problem));
    assert_int_equal(n, 2);
    assert_true(body_is_ended(&body));
}

/* RFC 9112 7.1; what follows the body in each is "GET /", cut at every place. */
static void chunks_end_with_the_empty_line_after_the_last_however_they_are_cut(void **state)
{
    (void)state;
    static const char *const list[] = { "0\r\n\r\n",
                                        "5\r\nhello\r\n0\r\n\r\n",
                                        "A\r\n0123456789\r\n0a\r\n0123456789\r\n000\r\n\r\n",
                                        "1;name=\"value\"\r\nx\r\n0;last\r\n\r\n",
                                        "2\r\n\r\n\r\n0\r\n\r\n",
                                        "0\r\nContent-Length: 100\r\nX: y\r\n\r\n" };
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        char bytes[200];
        size_t n = strlen(list[i]);
        (void)snprintf(bytes, sizeof bytes, "%sGET /", list[i]);
        for (size_t cut = 0; cut <= n; cut++) {
            struct body body;
            struct problem problem = { 0 };
            size_t n_first, n_second;
            body_begin(&body, true, 0);
            assert_true(body_take(&body, bytes, cut, &n_first, &problem));
            assert_int_equal(n_first, cut);
            assert_int_equal(body_is_ended(&body), cut == n);
            assert_true(body_take(&body, bytes + cut, n + 5 - cut, &n_second, &problem));
            assert_int_equal(n_first + n_second, n);
            assert_true(body_is_ended(&body));
        }
    }
}

static void chunks_that_another_reader_may_read_otherwise_are_refused(void **state)
{
    (void)state;
    static const char *const list[] = { "-2\r\n{}\r\n",
                                        "0x2\r\n{}\r\n",
                                        " 2\r\n{}\r\n",
                                        "2 \r\n{}\r\n",
                                        "\r\n",
                                        ";a\r\n",
                                        "2\n{}\n",
                                        "2\r{}",
                                        "1\r\n{}\r\n",
                                        "2\r\n{}\n0",
                                        "2\r\n{}\r0",
                                        "0\r\nX: y\n\r\n",
                                        "0\r\nX\ry: z\r\n\r\n",
                                        "1;a\rb\r\n",
                                        "1;a\nb\r\n",
                                        "1000000000000000\r\n",
                                        "g\r\n" };
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        struct body body;
        struct problem problem = { 0 };
        size_t n;
        body_begin(&body, true, 0);
        if (body_take(&body, list[i], strlen(list[i]), &n, &problem))
            fail_msg("\"%s\" was taken", list[i]);
        assert_int_equal(problem_status(problem.type), 400);
        assert_true(strlen(problem.detail) > 20);
    }
}

static void lines_of_chunks_and_trailers_have_their_limits_to_the_byte(void **state)
{
    (void)state;
    static char bytes[BODY_MAX_TRAILERS + 100];
    for (int more = 0; more < 2; more++) {
        struct body body;
        struct problem problem = { 0 };
        size_t n, n_line = BODY_MAX_CHUNK_LINE + (size_t)more;
        memset(bytes, 'a', sizeof bytes);
        memcpy(bytes, "1;", 2);
        memcpy(bytes + n_line - 2, "\r\n", 2);
        body_begin(&body, true, 0);
        assert_int_equal(body_take(&body, bytes, n_line, &n, &problem), !more);
        memset(bytes, 'a', sizeof bytes);
        memcpy(bytes, "0\r\n", 3);
        memcpy(bytes + 3 + BODY_MAX_TRAILERS + more - 4, "\r\n\r\n", 4);
        body_begin(&body, true, 0);
        assert_int_equal(body_take(&body, bytes, (size_t)(3 + BODY_MAX_TRAILERS + more), &n, &problem), !more);
        assert_int_equal(body_is_ended(&body), !more);
    }
}

static void a_condition_names_each_tag_of_its_list(void **state)
{
    (void)state;
    static const struct {
        const char *list;
        bool is_strong, is_weak; /* whether it names "17": with strong and with weak comparison (RFC 9110 8.8.3.2) */
    } cases[] = { { "\"17\"", true, true },
                  { "*", true, true },
                  { " * ", true, true },
                  { "W/\"17\"", false, true },
                  { "\"16\", \"17\"", true, true },
                  { "\"1,7\",W/\"17\"", false, true },
                  { ",, \"17\"", true, true },
                  { "\"16\"", false, false },
                  { "", false, false },
                  { "17", false, false },
                  { "\"17", false, false },
                  { "\"x, \"17\"", false, false },
                  { "w/\"17\"", false, false },
                  { "x, \"17\"", true, true },
                  { "*, \"16\"", false, false },
                  { "\"17\" \"18\"", true, true } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        if (etag_is_listed(cases[i].list, "\"17\"", false) != cases[i].is_strong ||
            etag_is_listed(cases[i].list, "\"17\"", true) != cases[i].is_weak)
            fail_msg("%s", cases[i].list);
    }
}

static void only_http_and_https_with_the_own_name_are_the_own_origin(void **state)
{
    (void)state;
    static const struct {
        const char *origin, *host;
        bool is_own;
    } cases[] = { { "http://beamroom.example", "beamroom.example", true },
                  { "https://Beamroom.Example:8443", "beamroom.example:8443", true },
                  { "evil://beamroom.example", "beamroom.example", false },
                  { "http://evil.example/http://beamroom.example", "beamroom.example", false },
                  { "http://beamroom.example:81", "beamroom.example", false },
                  { "http://", "", false },
                  { "null", "null", false },
                  { "beamroom.example", "beamroom.example", false },
                  { NULL, "beamroom.example", false },
                  { "http://beamroom.example", NULL, false } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        assert_int_equal(origin_is_of_host(cases[i].origin, cases[i].host, false), cases[i].is_own);
}

static void behind_our_own_tls_http_is_another_origin(void **state)
{
    (void)state;
    assert_true(origin_is_of_host("https://beamroom.example", "beamroom.example", true));
    assert_false(origin_is_of_host("http://beamroom.example", "beamroom.example", true));
    assert_false(origin_is_of_host("https://evil.example", "beamroom.example", true));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_body_of_a_length_ends_there),
        cmocka_unit_test(chunks_end_with_the_empty_line_after_the_last_however_they_are_cut),
        cmocka_unit_test(chunks_that_another_reader_may_read_otherwise_are_refused),
        cmocka_unit_test(lines_of_chunks_and_trailers_have_their_limits_to_the_byte),
        cmocka_unit_test(a_condition_names_each_tag_of_its_list),
        cmocka_unit_test(only_http_and_https_with_the_own_name_are_the_own_origin),
        cmocka_unit_test(behind_our_own_tls_http_is_another_origin),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

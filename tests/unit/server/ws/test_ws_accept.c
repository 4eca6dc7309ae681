/* The answer to the key of a handshake: the example of RFC 6455 1.3, and answers that Python's hashlib and base64 give.
 */
#include "server/ws/accept.h"
#include "tests/check.h"

static void the_answer_is_the_one_that_clients_compute(void **state)
{
    static const char *const pairs[][2] = {
        { "dGhlIHNhbXBsZSBub25jZQ==", "s3pPLMBiTxaQ9kYGzzhZRbK+xOo=" }, /* RFC 6455 1.3 */
        { "AAAAAAAAAAAAAAAAAAAAAA==", "ICX+Yqv66kxgM0FcWaLWlFLwTAI=" },
        { "/////////////////////w==", "XXpj4jYzLM2yUE0C7TIgMwTQh2g=" },
        { "x3JJHMbDL1EzLkh9GBhXDw==", "HSmrc0sMlYUkAGmm5OPpG2HaGWk=" },
        { "Iv8io/9s+lYFgZWcXczP8Q==", "hsBlbuDTkk24srzEOTBUlZAlC2g=" },
    };
    (void)state;
    for (size_t i = 0; i < sizeof pairs / sizeof pairs[0]; i++) {
        char accept[WS_ACCEPT_SIZE];
        ws_accept_of(pairs[i][0], accept);
        assert_string_equal(accept, pairs[i][1]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = { cmocka_unit_test(the_answer_is_the_one_that_clients_compute) };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

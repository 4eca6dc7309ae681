/* Parts that a picture leaves out, as told by a renderer, which is not trusted. */
#include "server/wire/missing.h"
#include "tests/check.h"

static cJSON *read_frame(const char *text)
{
    cJSON *frame = json_read(text, strlen(text), NULL);
    assert_non_null(frame);
    cJSON *missing = missing_read(frame);
    cJSON_Delete(frame);
    return missing;
}

static void regions_are_taken_with_their_reasons_and_nothing_else(void **state)
{
    (void)state;
    char words[200];
    cJSON *missing =
        read_frame("{\"missing\":{\"n\":9,\"x\":1,\"regions\":[{\"region\":\"liver\",\"reason\":\"too fine\",\"y\":2},"
                   "{\"region\":\"colon\",\"reason\":\"\"}]}}");
    char *text = json_write(missing);
    assert_string_equal(
        text,
        "{\"n\":9,\"regions\":[{\"region\":\"liver\",\"reason\":\"too fine\"},{\"region\":\"colon\",\"reason\":\"\"}]}");
    missing_words(missing, words, sizeof words);
    assert_string_equal(words, "liver, colon, and 7 more");
    missing_words(NULL, words, sizeof words);
    assert_string_equal(words, "");
    free(text);
    cJSON_Delete(missing);
}

static void what_is_no_such_list_is_nothing(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "{}",
        "{\"missing\":3}",
        "{\"missing\":{\"n\":1}}",
        "{\"missing\":{\"n\":0,\"regions\":[]}}",
        "{\"missing\":{\"n\":0,\"regions\":[{\"region\":\"a\",\"reason\":\"b\"}]}}",
        "{\"missing\":{\"n\":1e300,\"regions\":[{\"region\":\"a\",\"reason\":\"b\"}]}}",
        "{\"missing\":{\"n\":1,\"regions\":[{\"region\":\"A\\r\\nSet-Cookie\",\"reason\":\"b\"}]}}",
        "{\"missing\":{\"n\":1,\"regions\":[{\"region\":\"a\"}]}}",
        "{\"missing\":{\"n\":1,\"regions\":[7]}}",
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        if (read_frame(bad[i]))
            fail_msg("%s was taken", bad[i]);
    char text[4096] = "{\"missing\":{\"n\":33,\"regions\":[";
    for (int i = 0; i <= MISSING_MAX_REGIONS; i++)
        (void)snprintf(text + strlen(text), sizeof text - strlen(text), "%s{\"region\":\"r%d\",\"reason\":\"b\"}",
                       i ? "," : "", i);
    (void)snprintf(text + strlen(text), sizeof text - strlen(text), "]}}");
    assert_null(read_frame(text));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(regions_are_taken_with_their_reasons_and_nothing_else),
        cmocka_unit_test(what_is_no_such_list_is_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

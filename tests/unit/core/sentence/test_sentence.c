/* Codes and values of sentences: found by the format, cut where they do not fit, the same after a way through JSON. */
#include "core/sentence/sentence.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/wire/json.h"
#include "server/wire/sentence_json.h"
#include "tests/check.h"

static struct sentence_facts PRINTF_LIKE(1, 2) describe(const char *format, ...)
{
    struct sentence_facts facts;
    va_list args;
    va_start(args, format);
    sentence_describe(&facts, format, args);
    va_end(args);
    return facts;
}

static void each_sentence_is_found_by_its_code_and_has_its_number_of_places(void **state)
{
    (void)state;
    for (size_t i = 0; i < n_sentences; i++) {
        const struct sentence *sentence = &sentences[i];
        assert_non_null(sentence_find(sentence->code));
        assert_true(strlen(sentence->code) < SENTENCE_CODE_SIZE);
        int n = 0;
        for (const char *at = strchr(sentence->format, '%'); at; at = strchr(at + 1 + (at[1] == '%'), '%'))
            n += at[1] != '%';
        assert_int_equal(n, sentence->n_places);
    }
    assert_null(sentence_find("no-such-sentence"));
    assert_null(sentence_find(""));
}

static void numbers_and_texts_are_kept_as_english_shows_them(void **state)
{
    (void)state;
    struct sentence_facts facts = describe("view %d is not open", -3);
    assert_string_equal(facts.code, "view-not-open");
    assert_string_equal(facts.values, "-3");
    facts = describe("the parameter %s is \"%.40s\", expected a number", "x",
                     "0123456789012345678901234567890123456789abc");
    assert_string_equal(facts.code, "parameter-no-number");
    assert_string_equal(facts.values, "x\x1f"
                                      "0123456789012345678901234567890123456789");
    facts = describe("Slices are %.4g mm apart and %.4g mm thick.", 2.50001, 123456.0);
    assert_string_equal(facts.values, "2.5\x1f"
                                      "1.235e+05");
    facts = describe("%s is %g, expected %g to %g", "x", (double)NAN, 0.1, 7.0);
    assert_string_equal(facts.values, "x\x1f\x1f"
                                      "0.1\x1f"
                                      "7");
    facts = describe("there is no room \"%.63s\"", "a\x1f"
                                                   "b"); /* the break is no part of a text */
    assert_string_equal(facts.values, "a b");
}

static void a_text_is_cut_between_characters(void **state)
{
    (void)state;
    char name[80];
    memset(name, 'a', 62);
    memcpy(name + 62, "\xc3\xbc!", 4); /* an u with two dots, of two bytes, at the end of 63 */
    struct sentence_facts facts = describe("there is no room \"%.63s\"", name);
    assert_int_equal(strlen(facts.values), 62);
}

/* Sanitizers see a byte that is read behind it. */
static void a_text_of_so_many_bytes_needs_no_end(void **state)
{
    (void)state;
    static const char *const texts[] = { "2.0", "\xe2\x82\xac", "a\xc3\xa4", "ab\xc3", "a\xe2\x82" };
    static const char *const kept[] = { "2.0", "\xe2\x82\xac", "a\xc3\xa4", "ab", "a" };
    for (size_t i = 0; i < sizeof texts / sizeof texts[0]; i++) {
        char *open = malloc(3);
        assert_non_null(open);
        memcpy(open, texts[i], 3);
        struct sentence_facts facts = describe("the request is of HTTP/%.3s; expected is HTTP/1.1 or HTTP/1.0", open);
        free(open);
        assert_string_equal(facts.code, "http-version-unknown");
        assert_string_equal(facts.values, kept[i]);
    }
}

static void a_sentence_that_is_not_listed_or_too_long_has_no_facts(void **state)
{
    (void)state;
    char long_text[SENTENCE_VALUES_SIZE + 1];
    memset(long_text, 'a', sizeof long_text - 1);
    long_text[sizeof long_text - 1] = '\0';
    static const struct sentence_facts none;
    struct sentence_facts facts = describe("nobody says this %d", 1);
    assert_memory_equal(&facts, &none, sizeof none);
    facts = describe("Not used: %s.", long_text);
    assert_memory_equal(&facts, &none, sizeof none);
}

static void facts_are_the_same_after_a_way_through_json(void **state)
{
    (void)state;
    const struct sentence_facts all[] = {
        describe("view %d is not open", 3),
        describe("the server is stopping"),
        describe("%s is %g, expected %g to %g", "width \"x\"", (double)INFINITY, -1e-7, 1e21),
        describe("%s presents: request control, or take it when %s has been away for %d s", "m1", "m1", 30),
        describe("there is no room \"%.63s\"", ""),
    };
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        assert_true(all[i].code[0]);
        cJSON *json = cJSON_CreateObject();
        sentence_add_json(json, "reason", &all[i]);
        char *text = cJSON_PrintUnformatted(json);
        cJSON *back = cJSON_Parse(text);
        struct sentence_facts read;
        sentence_read_json(back, "reason", &read);
        assert_memory_equal(&read, &all[i], sizeof read);
        sentence_read_json(back, "detail", &read);
        assert_string_equal(read.code, "");
        cJSON_Delete(json);
        cJSON_Delete(back);
        cJSON_free(text);
    }
}

static void facts_in_json_that_are_not_as_listed_are_left_out(void **state)
{
    (void)state;
    static const char *const bad[] = {
        "{\"reason_code\":\"no-such-sentence\"}",
        "{\"reason_code\":7}",
        "{\"reason_code\":\"view-not-open\"}",
        "{\"reason_code\":\"view-not-open\",\"reason_values\":{\"view\":\"3\"}}",
        "{\"reason_code\":\"no-such-room\",\"reason_values\":{\"id\":3}}",
        "{\"reason_code\":\"no-such-room\",\"reason_values\":[1]}",
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        struct sentence_facts read;
        cJSON *json = cJSON_Parse(bad[i]);
        assert_non_null(json);
        sentence_read_json(json, "reason", &read);
        assert_string_equal(read.code, "");
        assert_string_equal(read.values, "");
        cJSON_Delete(json);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_sentence_is_found_by_its_code_and_has_its_number_of_places),
        cmocka_unit_test(numbers_and_texts_are_kept_as_english_shows_them),
        cmocka_unit_test(a_text_is_cut_between_characters),
        cmocka_unit_test(a_text_of_so_many_bytes_needs_no_end),
        cmocka_unit_test(a_sentence_that_is_not_listed_or_too_long_has_no_facts),
        cmocka_unit_test(facts_are_the_same_after_a_way_through_json),
        cmocka_unit_test(facts_in_json_that_are_not_as_listed_are_left_out),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

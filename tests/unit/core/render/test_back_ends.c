/* The words for back ends, and back to them. */
#include "core/render/render.h"
#include "tests/check.h"

static void every_back_end_has_a_word_that_leads_back_to_it(void **state)
{
    (void)state;
    static const char *const words[] = { "auto", "egl-device", "egl-surfaceless", "osmesa", "soft" };
    for (int i = 0; i < RENDER_N_BACK_ENDS; i++) {
        enum render_back_end back_end = RENDER_N_BACK_ENDS;
        assert_string_equal(render_back_end_word((enum render_back_end)i), words[i]);
        assert_true(render_back_end_from_word(words[i], &back_end));
        assert_int_equal(back_end, i);
    }
}

static void other_words_are_no_back_end(void **state)
{
    (void)state;
    enum render_back_end back_end = RENDER_OSMESA;
    assert_false(render_back_end_from_word("", &back_end));
    assert_false(render_back_end_from_word("EGL-device", &back_end));
    assert_false(render_back_end_from_word("egl", &back_end));
    assert_int_equal(back_end, RENDER_OSMESA);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_back_end_has_a_word_that_leads_back_to_it),
        cmocka_unit_test(other_words_are_no_back_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

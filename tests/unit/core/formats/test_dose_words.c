/* The words for the components of a BNCT dose, in descriptions and in names of files. */
#include <math.h>

#include "core/formats/dose_words.h"
#include "tests/check.h"

struct expected {
    const char *text;
    int quantity; /* -1: none */
    bool says_dose, is_error;
    const char *rest; /* NULL: any */
};

static void check(const struct expected *cases, size_t n, void (*read)(const char *, struct dose_words *))
{
    for (size_t i = 0; i < n; i++) {
        struct dose_words words;
        read(cases[i].text, &words);
        if (words.has_quantity != (cases[i].quantity >= 0) ||
            (words.has_quantity && (int)words.quantity != cases[i].quantity))
            fail_msg("\"%s\" is %s", cases[i].text,
                     words.has_quantity ? dose_quantity_word(words.quantity) : "nothing");
        if (words.says_dose != cases[i].says_dose || words.is_error != cases[i].is_error)
            fail_msg("\"%s\": dose %d, error %d", cases[i].text, words.says_dose, words.is_error);
        if (cases[i].rest && strcmp(words.rest, cases[i].rest) != 0)
            fail_msg("\"%s\" leaves \"%s\"", cases[i].text, words.rest);
    }
}

static void names_of_files_say_their_component(void **state)
{
    (void)state;
    static const struct expected cases[] = {
        { "dose_boron", DOSE_BORON, true, false, "" },
        { "dose_nitrogen", DOSE_NITROGEN, true, false, "" },
        { "dose_fast", DOSE_FAST, true, false, "" },
        { "dose_gamma", DOSE_GAMMA, true, false, "" },
        { "dose_total", DOSE_TOTAL, true, false, "" },
        { "head_B10", DOSE_BORON, false, false, "head" },
        { "head_N14", DOSE_NITROGEN, false, false, "head" },
        { "head_n", DOSE_FAST, false, false, "head" },
        { "head_g", DOSE_GAMMA, false, false, "head" },
        { "head_B10_sigma", DOSE_BORON, false, true, "head" },
        { "head_n_sigma", DOSE_FAST, false, true, "head" },
        { "sigma_dose_gamma", DOSE_GAMMA, true, true, "" },
        { "case7.dose.total", DOSE_TOTAL, true, false, "case7" },
        { "BoronDose", DOSE_BORON, true, false, "" },
        { "gammadose_v2", DOSE_GAMMA, true, false, "v2" },
        { "head_CT", -1, false, false, "head ct" },
        { "sub-10_b0", -1, false, false, NULL },
        { "n", -1, false, false, "n" },
        { "brain-n", -1, false, false, NULL },
        { "ホウ素線量", DOSE_BORON, true, false, "" },
        { "患者_窒素線量", DOSE_NITROGEN, true, false, NULL },
    };
    check(cases, sizeof cases / sizeof cases[0], dose_words_read_name);
}

static void descriptions_say_their_component_in_several_languages(void **state)
{
    (void)state;
    static const struct expected cases[] = {
        { "ホウ素線量 15ppm", DOSE_BORON, true, false, "" },
        { "Ｂ－１０", DOSE_BORON, false, false, "" },
        { "硼素", DOSE_BORON, false, false, "" },
        { "窒素線量", DOSE_NITROGEN, true, false, "" },
        { "熱中性子線量", DOSE_NITROGEN, true, false, "" },
        { "速中性子線量", DOSE_FAST, true, false, "" },
        { "高速中性子", DOSE_FAST, false, false, "" },
        { "反跳陽子", DOSE_FAST, false, false, "" },
        { "γ線線量", DOSE_GAMMA, true, false, "" },
        { "ガンマ線", DOSE_GAMMA, false, false, "" },
        { "ｶﾞﾝﾏ線", DOSE_GAMMA, false, false, "" },
        { "総線量", DOSE_TOTAL, true, false, "" },
        { "ホウ素とガンマ線", -1, false, false, NULL },
        { "快中子剂量", DOSE_FAST, true, false, "" },
        { "Breakfast", -1, false, false, "breakfast" },
    };
    struct dose_words words;
    check(cases, sizeof cases / sizeof cases[0], dose_words_read);
    dose_words_read("ホウ素線量 １５．５ｐｐｍ", &words);
    assert_close(words.ppm, 15.5, 0);
    dose_words_read("boron per ppm", &words);
    assert_true(words.is_per_ppm && isnan(words.ppm));
}

static void any_bytes_are_read_within_bounds(void **state)
{
    (void)state;
    char text[2000];
    uint64_t random = 88172645463325252u;
    for (int round = 0; round < 2000; round++) {
        static const char some[] = "ab Bb10n14_-.\xef\xbc\x90\xe3\x83\x9b\xce\xb3 dose";
        size_t n = 0;
        for (; n < sizeof text - 1 && n < (size_t)round; n++) {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            text[n] = some[random % (sizeof some - 1)];
        }
        text[n] = 0;
        struct dose_words words;
        dose_words_read(text, &words);
        dose_words_read_name(text, &words);
        assert_true(strlen(words.rest) < sizeof words.rest);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_of_files_say_their_component),
        cmocka_unit_test(descriptions_say_their_component_in_several_languages),
        cmocka_unit_test(any_bytes_are_read_within_bounds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

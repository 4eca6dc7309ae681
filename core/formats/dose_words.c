/* Finds the words for components of a BNCT dose in descriptions and file names. */
#include "core/formats/dose_words.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/formats/text.h"

enum { MOST_WORDS = 32, WORD_SIZE = 24, PLAIN_SIZE = 600 };

struct words {
    char words[MOST_WORDS][WORD_SIZE]; /* lower case; letters, or a number */
    bool is_joined[MOST_WORDS];        /* nothing but a hyphen lies between this word and the one before */
    bool is_touching[MOST_WORDS];      /* nothing lies between them */
    bool is_used[MOST_WORDS];          /* says something of the dose */
    size_t n;
};

/* Words of languages without blanks between words, and their English; a longer one before one that it contains. */
static const struct {
    const char *other, *english;
} translations[] = { { "ホウ素", "boron" },
                     { "ほう素", "boron" },
                     { "硼素", "boron" },
                     { "ボロン", "boron" },
                     { "ﾎｳ素", "boron" },
                     { "ﾎﾞﾛﾝ", "boron" },
                     { "硼", "boron" },
                     { "窒素", "nitrogen" },
                     { "氮", "nitrogen" },
                     { "高速中性子", "fast neutron" },
                     { "速中性子", "fast neutron" },
                     { "熱外中性子", "epithermal neutron" },
                     { "熱中性子", "thermal neutron" },
                     { "中性子", "neutron" },
                     { "快中子", "fast neutron" },
                     { "热中子", "thermal neutron" },
                     { "中子", "neutron" },
                     { "反跳陽子", "recoil" },
                     { "反跳", "recoil" },
                     { "水素", "hydrogen" },
                     { "ガンマ線", "gamma" },
                     { "ガンマ", "gamma" },
                     { "ｶﾞﾝﾏ線", "gamma" },
                     { "ｶﾞﾝﾏ", "gamma" },
                     { "伽马", "gamma" },
                     { "γ線", "gamma" },
                     { "γ", "gamma" },
                     { "光子", "photon" },
                     { "総線量", "total dose" },
                     { "全線量", "total dose" },
                     { "総剂量", "total dose" },
                     { "总剂量", "total dose" },
                     { "合計", "total" },
                     { "合算", "total" },
                     { "標準偏差", "sigma" },
                     { "統計誤差", "sigma" },
                     { "相対誤差", "relative sigma" },
                     { "誤差", "sigma" },
                     { "不確かさ", "sigma" },
                     { "線量", "dose" },
                     { "剂量", "dose" } };

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

static bool is_upper(char c)
{
    return c >= 'A' && c <= 'Z';
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Copies text with the words of other languages in English and full-width letters as plain ones. */
static void translate(const char *text, char plain[PLAIN_SIZE])
{
    size_t n = 0;
    while (*text && n + WORD_SIZE < PLAIN_SIZE) {
        const unsigned char *c = (const unsigned char *)text;
        if (c[0] == 0xef && (c[1] == 0xbc || c[1] == 0xbd) && c[2]) { /* U+FF01 to U+FF5E are ASCII 0x21 to 0x7e */
            int code = 0xf000 + ((c[1] & 0x3f) << 6) + (c[2] & 0x3f);
            if (code >= 0xff01 && code <= 0xff5e) {
                plain[n++] = (char)(code - 0xff01 + 0x21);
                text += 3;
                continue;
            }
        }
        bool is_translated = false;
        for (size_t i = 0; !is_translated && i < sizeof translations / sizeof translations[0]; i++) {
            size_t length = strlen(translations[i].other);
            if (strncmp(text, translations[i].other, length) != 0)
                continue;
            n += (size_t)snprintf(plain + n, PLAIN_SIZE - n, " %s ", translations[i].english);
            text += length;
            is_translated = true;
        }
        if (!is_translated)
            plain[n++] = *text++;
    }
    plain[n] = 0;
}

/* Adds a word in lower case. "boronDose", "borondose" and "doseboron" are two words. */
static void add_word(struct words *words, const char *from, size_t n, bool is_joined, bool is_touching)
{
    static const char dose[] = "dose";
    char low[WORD_SIZE];
    if (n == 0 || words->n >= MOST_WORDS)
        return;
    n = n < WORD_SIZE - 1 ? n : WORD_SIZE - 1;
    for (size_t i = 0; i < n; i++)
        low[i] = is_upper(from[i]) ? (char)(from[i] - 'A' + 'a') : from[i];
    low[n] = 0;
    size_t cut = n > 4 && strncmp(low, dose, 4) == 0 ? 4 : n > 4 && strcmp(low + n - 4, dose) == 0 ? n - 4 : 0;
    if (cut > 0 && strcmp(low, "doses") != 0) {
        add_word(words, low, cut, is_joined, is_touching);
        add_word(words, low + cut, n - cut, true, false);
        return;
    }
    memcpy(words->words[words->n], low, n + 1);
    words->is_touching[words->n] = is_touching;
    words->is_joined[words->n++] = is_joined;
}

/* Splits into letter groups and numbers, lower case: "B-10 dose (15.5ppm)" gives b 10 dose 15.5 ppm. A capital letter
 * after a small one begins a word. */
static void split_words(const char *text, struct words *words)
{
    const char *end = NULL; /* of the word before */
    words->n = 0;
    memset(words->is_used, 0, sizeof words->is_used);
    for (const char *c = text; *c && words->n < MOST_WORDS;) {
        const char *from = c;
        if (is_digit(*c)) {
            while (is_digit(*c) || (*c == '.' && is_digit(c[1])))
                c++;
        } else {
            while (is_letter(*c) && (c == from || !is_upper(*c) || is_upper(c[-1])))
                c++;
        }
        if (c == from) {
            c++;
            continue;
        }
        bool is_touching = end == from;
        add_word(words, from, (size_t)(c - from), is_touching || (end && end + 1 == from && *end == '-'), is_touching);
        end = c;
    }
}

/* Marks every word that is one of the list, which ends with NULL; returns true if there is any. */
static bool use_words(struct words *words, const char *const *list)
{
    bool is_found = false;
    for (size_t i = 0; i < words->n; i++)
        for (size_t w = 0; list[w]; w++)
            if (strcmp(words->words[i], list[w]) == 0)
                is_found = words->is_used[i] = true;
    return is_found;
}

static bool use_word(struct words *words, const char *word)
{
    return use_words(words, (const char *const[]){ word, NULL });
}

/* Two neighbouring words in either order: B-10, 10B. is_strict: they must touch. */
static bool use_pair(struct words *words, const char *one, const char *other, bool is_strict)
{
    for (size_t i = 0; i + 1 < words->n; i++)
        if ((!is_strict || words->is_joined[i + 1]) &&
            ((strcmp(words->words[i], one) == 0 && strcmp(words->words[i + 1], other) == 0) ||
             (strcmp(words->words[i], other) == 0 && strcmp(words->words[i + 1], one) == 0)))
            return words->is_used[i] = words->is_used[i + 1] = true;
    return false;
}

/* Finds the only component that the words name. A neutron dose without another word counts as fast: the part that comes
 * from neither boron nor gammas. */
static bool find_quantity(struct words *words, bool is_strict, enum dose_quantity *quantity)
{
    static const char *const neutron[] = { "neutron", "neutrons", NULL };
    static const char *const fast[] = { "fast", "recoil", "hydrogen", NULL };
    static const char *const gamma[] = { "gamma", "gammas", "photon", "photons", NULL };
    bool is_found[DOSE_N_QUANTITIES] = { false };
    bool is_neutron = use_words(words, neutron), is_boron = use_word(words, "boron");
    bool is_nitrogen = use_word(words, "nitrogen");
    is_found[DOSE_BORON] = use_pair(words, "b", "10", is_strict) || is_boron;
    is_found[DOSE_NITROGEN] =
        use_pair(words, "n", "14", is_strict) || is_nitrogen || (is_neutron && use_word(words, "thermal"));
    is_found[DOSE_FAST] = use_words(words, fast) || (is_neutron && !is_found[DOSE_NITROGEN] && !is_found[DOSE_BORON] &&
                                                     !use_word(words, "capture"));
    is_found[DOSE_GAMMA] = use_words(words, gamma);
    size_t n = 0;
    for (int i = 0; i < DOSE_N_QUANTITIES; i++)
        if (is_found[i]) {
            *quantity = (enum dose_quantity)i;
            n++;
        }
    if (n == 0 && use_word(words, "total")) {
        *quantity = DOSE_TOTAL;
        n = 1;
    }
    return n == 1;
}

static void find_ppm(struct words *words, struct dose_words *found)
{
    found->ppm = NAN;
    for (size_t i = 1; i < words->n; i++) {
        double ppm;
        if (strcmp(words->words[i], "ppm") != 0)
            continue;
        bool is_number = text_number(words->words[i - 1], &ppm) && ppm > 0;
        found->ppm = is_number ? ppm : found->ppm;
        found->is_per_ppm |= strcmp(words->words[i - 1], "per") == 0;
        words->is_used[i] = true;
        words->is_used[i - 1] |= is_number || strcmp(words->words[i - 1], "per") == 0;
    }
}

/* A last "n" or "g", as OpenPINT ends the names of neutron and gamma doses. */
static void find_letter(struct words *words, struct dose_words *found)
{
    size_t last = words->n;
    while (last > 0 && words->is_used[last - 1])
        last--;
    if (last < 2 || found->has_quantity)
        return;
    const char *word = words->words[last - 1];
    if (words->is_joined[last - 1] || (strcmp(word, "n") != 0 && strcmp(word, "g") != 0))
        return;
    found->has_quantity = found->is_letter = words->is_used[last - 1] = true;
    found->quantity = word[0] == 'n' ? DOSE_FAST : DOSE_GAMMA;
}

static void keep_rest(const struct words *words, char rest[DOSE_WORDS_REST_SIZE])
{
    size_t n = 0;
    rest[0] = 0;
    for (size_t i = 0; i < words->n; i++)
        if (!words->is_used[i] && n + WORD_SIZE + 1 < DOSE_WORDS_REST_SIZE)
            n += (size_t)snprintf(rest + n, DOSE_WORDS_REST_SIZE - n, "%s%s", n && !words->is_touching[i] ? " " : "",
                                  words->words[i]);
}

static void read_words(const char *text, bool is_name, struct dose_words *found)
{
    static const char *const dose[] = { "dose", "doses", "rtdose", NULL };
    static const char *const error[] = { "sigma", "uncertainty", "error", "err", "std", "stdev", "stddev", "sd", NULL };
    static const char *const relative[] = { "relative", "rel", "percent", NULL };
    char plain[PLAIN_SIZE];
    struct words words = { .n = 0 };
    *found = (struct dose_words){ 0 };
    translate(text, plain);
    split_words(plain, &words);
    found->is_error = use_words(&words, error);
    found->is_relative = found->is_error && use_words(&words, relative);
    found->says_dose = use_words(&words, dose);
    found->has_quantity = find_quantity(&words, is_name, &found->quantity);
    find_ppm(&words, found);
    if (is_name)
        find_letter(&words, found);
    keep_rest(&words, found->rest);
}

void dose_words_read(const char *text, struct dose_words *words)
{
    read_words(text, false, words);
}

void dose_words_read_name(const char *name, struct dose_words *words)
{
    read_words(name, true, words);
}

/* Masks patients, and chooses the treatment plan that is shown first. */
#include "core/plan/identity.h"

#include <stdio.h>
#include <string.h>

/* Reads one character of UTF-8; a byte that begins none counts as U+FFFD. Returns its length, 0 at the end. */
static size_t read_character(const char *text, uint32_t *code)
{
    const unsigned char *at = (const unsigned char *)text;
    size_t n = at[0] < 0x80 ? 1 : at[0] >> 5 == 6 ? 2 : at[0] >> 4 == 14 ? 3 : at[0] >> 3 == 30 ? 4 : 0;
    if (at[0] == 0)
        return 0;
    *code = n == 1 ? at[0] : at[0] & (0x7fu >> n);
    for (size_t i = 1; i < n; i++) {
        if (at[i] >> 6 != 2)
            n = 0;
        else
            *code = *code << 6 | (at[i] & 0x3f);
    }
    if (n == 0)
        *code = 0xfffd;
    return n ? n : 1;
}

static bool is_within(uint32_t code, uint32_t low, uint32_t high)
{
    return code >= low && code <= high;
}

/* Control characters, marks of writing direction, invisible characters and marks that combine with a letter. */
static bool is_hidden(uint32_t code)
{
    return code < 0x20 || is_within(code, 0x7f, 0x9f) || code == 0xad || is_within(code, 0x300, 0x36f) ||
           code == 0x61c || is_within(code, 0x200b, 0x200f) || is_within(code, 0x2028, 0x202e) ||
           is_within(code, 0x2060, 0x206f) || is_within(code, 0xfe00, 0xfe0f) || code == 0xfeff || code == 0xfffd ||
           is_within(code, 0xe0000, 0xe0fff);
}

static bool is_letter_or_digit(uint32_t code)
{
    if (code < 0x80)
        return is_within(code, '0', '9') || is_within(code | 0x20, 'a', 'z');
    return !is_hidden(code) && !is_within(code, 0xa0, 0xbf) && code != 0xd7 && code != 0xf7 &&
           !is_within(code, 0x2000, 0x2bff) && !is_within(code, 0x3000, 0x303f);
}

static uint32_t upper(uint32_t code)
{
    bool is_lower = is_within(code, 'a', 'z') || (is_within(code, 0xe0, 0xfe) && code != 0xf7) ||
                    (is_within(code, 0x3b1, 0x3c9) && code != 0x3c2) || is_within(code, 0x430, 0x44f);
    return is_lower ? code - 0x20 : code;
}

static void append_character(char *out, size_t size, uint32_t code)
{
    char bytes[5] = "";
    if (code < 0x80)
        bytes[0] = (char)code;
    else if (code < 0x800)
        snprintf(bytes, sizeof bytes, "%c%c", (int)(0xc0 | code >> 6), (int)(0x80 | (code & 0x3f)));
    else if (code < 0x10000)
        snprintf(bytes, sizeof bytes, "%c%c%c", (int)(0xe0 | code >> 12), (int)(0x80 | (code >> 6 & 0x3f)),
                 (int)(0x80 | (code & 0x3f)));
    else
        snprintf(bytes, sizeof bytes, "%c%c%c%c", (int)(0xf0 | code >> 18), (int)(0x80 | (code >> 12 & 0x3f)),
                 (int)(0x80 | (code >> 6 & 0x3f)), (int)(0x80 | (code & 0x3f)));
    size_t n = strlen(out);
    snprintf(out + n, size - n, "%s", bytes);
}

/* Adds "A. " for the first letter or digit of a text of n bytes; nothing without one. */
static void append_initial(char *out, size_t size, const char *text, size_t n)
{
    uint32_t code;
    for (size_t at = 0, step; at < n && (step = read_character(text + at, &code)) > 0; at += step)
        if (is_letter_or_digit(code)) {
            append_character(out, size, upper(code));
            size_t end = strlen(out);
            snprintf(out + end, size - end, ". ");
            return;
        }
}

/* A component of a group of a name: family, given, middle; n 0 if absent. */
struct component {
    const char *text;
    size_t n;
};

static struct component component_of(const char *group, size_t n, int index)
{
    const char *end = group + n;
    while (index-- > 0 && group < end) {
        const char *next = memchr(group, '^', (size_t)(end - group));
        group = next ? next + 1 : end;
    }
    const char *next = group < end ? memchr(group, '^', (size_t)(end - group)) : NULL;
    return (struct component){ group, (size_t)((next ? next : end) - group) };
}

/* The initials of a group of n bytes. */
static void append_initials(char *out, size_t size, const char *group, size_t n, bool is_family_first)
{
    struct component family = component_of(group, n, 0), given = component_of(group, n, 1),
                     middle = component_of(group, n, 2);
    if (family.n == n) { /* no '^' */
        size_t last = n;
        while (last > 0 && group[last - 1] == ' ')
            last--;
        size_t word = last;
        while (word > 0 && group[word - 1] != ' ')
            word--;
        if (word > 0)
            append_initial(out, size, group, word);
        append_initial(out, size, group + word, last - word);
        return;
    }
    if (is_family_first)
        append_initial(out, size, family.text, family.n);
    append_initial(out, size, given.text, given.n);
    append_initial(out, size, middle.text, middle.n);
    if (!is_family_first)
        append_initial(out, size, family.text, family.n);
}

/* Adds the end of the ID: of the characters that can be seen. */
static void append_id(char *out, size_t size, const char *id)
{
    uint32_t code, last[3] = { 0 };
    size_t n = 0;
    for (size_t step; (step = read_character(id, &code)) > 0; id += step)
        if (!is_hidden(code)) {
            last[n % 3] = code;
            n++;
        }
    if (n == 0)
        return;
    size_t shown = n < 6 ? 1 : 3, end = strlen(out);
    snprintf(out + end, size - end, "\u2026");
    for (size_t i = n - shown; i < n; i++)
        append_character(out, size, last[i % 3]);
}

void identity_mask(const struct plan_patient *patient, char out[IDENTITY_MASK_SIZE])
{
    const char *group = patient->name;
    out[0] = 0;
    for (int i = 0; i < 3 && !out[0]; i++) {
        size_t n = strcspn(group, "=");
        append_initials(out, IDENTITY_MASK_SIZE, group, n, i > 0);
        group += n + (group[n] == '=');
    }
    append_id(out, IDENTITY_MASK_SIZE, patient->id);
    size_t n = strlen(out);
    if (n > 0 && out[n - 1] == ' ')
        out[n - 1] = 0;
    if (!out[0])
        snprintf(out, IDENTITY_MASK_SIZE, "\u2026");
}

static int approval_rank(const struct treatment_plan *treatment)
{
    return strcmp(treatment->approval, "APPROVED") == 0   ? 0
           : treatment->approval[0] == 0                  ? 1
           : strcmp(treatment->approval, "REJECTED") == 0 ? 3
                                                          : 2;
}

static bool is_shown_before(const struct treatment_plan *a, const struct treatment_plan *b)
{
    int by_approval = approval_rank(a) - approval_rank(b), by_date = strcmp(a->date, b->date);
    return by_approval ? by_approval < 0 : by_date ? by_date > 0 : strcmp(a->time, b->time) > 0;
}

/* Adds text, cut at a whole character where there is no room. */
static void append_text(char *out, const char *text, size_t n, bool is_upper)
{
    uint32_t code;
    for (size_t at = 0, step;
         at < n && strlen(out) + 5 < IDENTITY_WORDS_SIZE && (step = read_character(text + at, &code)) > 0; at += step)
        append_character(out, IDENTITY_WORDS_SIZE, is_upper ? upper(code) : code);
}

static void append_words(char *out, const char *text)
{
    append_text(out, text, strlen(text), false);
}

static void append_part(char *out, const char *label, const char *text)
{
    if (!text[0])
        return;
    append_words(out, out[0] ? ", " : "");
    append_words(out, label);
    append_words(out, text);
}

void identity_words(const struct plan_patient *patient, char out[IDENTITY_WORDS_SIZE])
{
    const size_t n = strcspn(patient->name, "=");
    const struct component family = component_of(patient->name, n, 0);
    const char *birth = patient->birth_date;
    char born[sizeof patient->birth_date + 2];
    if (strlen(birth) == 8)
        (void)snprintf(born, sizeof born, "%.4s-%.2s-%.2s", birth, birth + 4, birth + 6);
    else
        (void)snprintf(born, sizeof born, "%s", birth);
    out[0] = 0;
    append_text(out, family.text, family.n, family.n < n);
    for (int i = 1; i <= 2; i++) {
        const struct component given = component_of(patient->name, n, i);
        if (given.n && out[0])
            append_words(out, strchr(out, ',') ? " " : ", ");
        append_text(out, given.text, given.n, false);
    }
    append_part(out, "id ", patient->id);
    append_part(out, "born ", born);
}

int identity_first_treatment_plan(const struct treatment_plan *plans, size_t n)
{
    int best = n > 0 ? 0 : -1;
    for (size_t i = 1; i < n; i++)
        if (is_shown_before(&plans[i], &plans[best]))
            best = (int)i;
    return best;
}

int plan_shown_treatment_plan(const struct plan *plan)
{
    return identity_first_treatment_plan(plan->treatment_plans, plan->n_treatment_plans);
}

int plan_shown_patient(const struct plan *plan)
{
    int treatment = plan_shown_treatment_plan(plan), shown = -1;
    uint32_t most = 0;
    if (treatment >= 0 && plan->treatment_plans[treatment].patient >= 0)
        return plan->treatment_plans[treatment].patient;
    for (size_t i = 0; i < plan->n_images; i++) {
        uint32_t n = plan->images[i].volume->grid.size[2];
        if (plan->image_origins[i].patient >= 0 && n > most) {
            most = n;
            shown = plan->image_origins[i].patient;
        }
    }
    return shown < 0 && plan->n_patients > 0 ? 0 : shown;
}

/* Text for a terminal, letter by letter. */
#include "server/cli/text.h"

#include <string.h>

#include "core/base/invisible.h"

/* Returns the bytes of the UTF-8 letter at text; *shown is the letter, or "?" for a control character or broken UTF-8.
 */
static size_t letter(const unsigned char *text, const char **shown)
{
    static const unsigned char lead_low[5] = { 0, 0, 0xc2, 0xe0, 0xf0 }, lead_high[5] = { 0, 0x7f, 0xdf, 0xef, 0xf4 };
    *shown = "?";
    if (text[0] < 0x20 || text[0] == 0x7f)
        return 1;
    for (size_t n = 1; n <= 4; n++) {
        if (text[0] < lead_low[n] || text[0] > lead_high[n])
            continue;
        for (size_t i = 1; i < n; i++)
            if ((text[i] & 0xc0) != 0x80)
                return 1;
        if (n == 2 && text[0] == 0xc2 && text[1] < 0xa0)
            return 2; /* control characters U+0080 to U+009F */
        *shown = (const char *)text;
        return n;
    }
    return 1;
}

/* The character that n bytes of UTF-8 are. */
static uint32_t character_of(const unsigned char *text, size_t n)
{
    uint32_t c = n == 1 ? text[0] : text[0] & (0x7fU >> n);
    for (size_t i = 1; i < n; i++)
        c = c << 6 | (text[i] & 0x3fU);
    return c;
}

/* Prints letters and returns how many there are. out: NULL only counts them. */
static int print_letters(FILE *out, const char *text, size_t n_bytes)
{
    int n_letters = 0;
    for (size_t at = 0; at < n_bytes;) {
        const unsigned char *from = (const unsigned char *)text + at;
        const char *shown;
        size_t n = letter(from, &shown);
        const char *tag = *shown == '?' ? NULL : invisible_tag(character_of(from, n));
        n_letters += tag ? (int)strlen(tag) + 2 : 1;
        if (out && tag)
            fprintf(out, "«%s»", tag);
        else if (out)
            fwrite(shown, 1, *shown == '?' ? 1 : n, out);
        at += n;
    }
    return n_letters;
}

void text_print(FILE *out, const char *text, int width)
{
    int n_letters = print_letters(out, text, strlen(text));
    if (n_letters < width)
        fprintf(out, "%*s", width - n_letters, "");
}

void text_print_wrapped(FILE *out, const char *text, int indent, int width)
{
    int column = 0;
    while (*text) {
        text += strspn(text, " ");
        size_t n_bytes = strcspn(text, " ");
        if (n_bytes == 0)
            break;
        int n_letters = print_letters(NULL, text, n_bytes);
        if (column > 0 && column + 1 + n_letters > width) {
            fputc('\n', out);
            column = 0;
        }
        fprintf(out, "%*s", column == 0 ? indent : 1, "");
        column += (column > 0) + print_letters(out, text, n_bytes);
        text += n_bytes;
    }
    if (column > 0)
        fputc('\n', out);
}

void text_print_count(FILE *out, unsigned long long count, int width)
{
    char digits[24], grouped[32];
    int n = snprintf(digits, sizeof digits, "%llu", count), at = 0;
    for (int i = 0; i < n; i++) {
        if (i > 0 && (n - i) % 3 == 0)
            grouped[at++] = ' ';
        grouped[at++] = digits[i];
    }
    grouped[at] = 0;
    fprintf(out, "%*s", width, grouped);
}

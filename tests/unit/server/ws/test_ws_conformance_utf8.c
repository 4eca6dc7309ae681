/* Group 6 of the cases of RFC 6455 (ws_cases.h): text that is UTF-8, and text that is not. */
#include "tests/check.h"
#include "tests/unit/ws_cases.h"

/* Groups 6.5 to 6.23, each of single texts in order; "-" in front: not UTF-8. Hexadecimal; 6.12.8, 6.13 and 6.22 are
 * made below. */
static const struct {
    int group;
    const char *texts;
} utf8_table[] = {
    { 5,
      "68656c6c6f24776f726c64 68656c6c6fc2a2776f726c64 68656c6c6fe282ac776f726c64 68656c6c6ff0a4ada2776f726c64 cebae1bdb9cf83cebcceb5" },
    { 6,
      "-ce ceba -cebae1 -cebae1bd cebae1bdb9 -cebae1bdb9cf cebae1bdb9cf83 -cebae1bdb9cf83ce cebae1bdb9cf83cebc -cebae1bdb9cf83cebcce cebae1bdb9cf83cebcceb5" },
    { 7, "00 c280 e0a080 f0908080" },
    { 8, "-f888808080 -fc8480808080" },
    { 9, "7f dfbf efbfbf f48fbfbf" },
    { 10, "-f7bfbfbf -fbbfbfbfbf -fdbfbfbfbfbf" },
    { 11, "ed9fbf ee8080 efbfbd f48fbfbf -f4908080" },
    { 12, "-80 -bf -80bf -80bf80 -80bf80bf -80bf80bf80 -80bf80bf80bf -*" },
    { 13, "-* -* -* -* -*" },
    { 14, "-c0 -e080 -f08080 -f8808080 -fc80808080 -df -efbf -f7bfbf -fbbfbfbf -fdbfbfbfbf" },
    { 15, "-c0e080f08080f8808080fc80808080dfefbff7bfbffbbfbfbffdbfbfbfbf" },
    { 16, "-fe -ff -fefeffff" },
    { 17, "-c0af -e080af -f08080af -f8808080af -fc80808080af" },
    { 18, "-c1bf -e09fbf -f08fbfbf -f887bfbfbf -fc83bfbfbfbf" },
    { 19, "-c080 -e08080 -f0808080 -f880808080 -fc8080808080" },
    { 20, "-eda080 -edadbf -edae80 -edafbf -edb080 -edbe80 -edbfbf" },
    { 21,
      "-eda080edb080 -eda080edbfbf -edadbfedb080 -edadbfedbfbf -edae80edb080 -edae80edbfbf -edafbfedb080 -edafbfedbfbf" },
    { 22, "* * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * * *" },
    { 23, "efbfb9 efbfba efbfbb efbfbc efbfbd efbfbe efbfbf" },
};

static size_t from_hexadecimal(const char *digits, uint8_t bytes[200])
{
    size_t n = 0;
    for (unsigned value; sscanf(digits + 2 * n, "%2x", &value) == 1 && digits[2 * n] > ' '; n++)
        bytes[n] = (uint8_t)value;
    return n;
}

/* Texts that a line of the table is too short for. */
static size_t make_text(int group, int c, uint8_t bytes[200])
{
    static const unsigned first[] = { 0xc0, 0xe0, 0xf0, 0xf8, 0xfc, 0xfe };
    size_t n = 0;
    if (group == 12) { /* all 64 continuation bytes */
        for (unsigned byte = 0x80; byte <= 0xbf; byte++)
            bytes[n++] = (uint8_t)byte;
    } else if (group == 13) { /* all first bytes of sequences of 2, 3 ... 6 bytes, each before a blank */
        for (unsigned byte = first[c - 1]; byte < first[c]; byte++) {
            bytes[n++] = (uint8_t)byte;
            bytes[n++] = ' ';
        }
    } else { /* the last two code points of each plane, which are no characters but may be sent */
        unsigned code = (unsigned)(c - 1) / 2 << 16 | 0xfffe | (unsigned)(c - 1) % 2;
        if (code > 0xffff) {
            bytes[n++] = (uint8_t)(0xf0 | code >> 18);
            bytes[n++] = (uint8_t)(0x80 | (code >> 12 & 63));
        } else {
            bytes[n++] = (uint8_t)(0xe0 | code >> 12);
        }
        bytes[n++] = (uint8_t)(0x80 | (code >> 6 & 63));
        bytes[n++] = (uint8_t)(0x80 | (code & 63));
    }
    return n;
}

static void utf8_texts(void **state)
{
    const struct ws_case *number = *state;
    const char *text = utf8_table[number->b - 5].texts;
    uint8_t bytes[200];
    for (int i = 1; i < number->c; i++)
        text = strchr(text, ' ') + 1;
    bool is_wrong = *text == '-';
    text += is_wrong;
    size_t n = *text == '*' ? make_text(number->b, number->c, bytes) : from_hexadecimal(text, bytes);
    assert_true(n > 0);
    ws_client_send(&client, TEXT, bytes, n);
    if (is_wrong) {
        ws_client_expect_end(&client, CODE_NOT_UTF8);
    } else {
        ws_client_expect(&client, TEXT, bytes, n);
        ends_well();
    }
}

static void send_by_octet_fragments(const uint8_t *bytes, size_t n)
{
    for (size_t i = 0; i < n; i++)
        ws_client_add(&client, (i == 0 ? 1U : 0U) | (i + 1 == n ? FIN : 0U), bytes + i, 1);
    ws_client_flush(&client, 0);
}

static void utf8_fragments(void **state)
{
    static const char valid[] = "Hello-\xc2\xb5@\xc3\x9f\xc3\xb6\xc3\xa4\xc3\xbc\xc3\xa0\xc3\xa1-UTF-8!!",
                      greek[] = "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5";
    static const char wrong[] = "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5\xed\xa0\x80"
                                "edited";
    const struct ws_case *number = *state;
    const char *text = number->b == 2 && number->c == 4 ? greek : valid;
    if (number->b == 1) {
        text = number->c == 3 ? "middle frame payload" : "";
        add_text(number->c == 1 ? TEXT : 1, "");
        if (number->c > 1) {
            add_text(0, text);
            add_text(CONTINUED, "");
        }
        ws_client_flush(&client, 0);
    } else if (number->b == 2 && number->c == 1) {
        ws_client_send(&client, TEXT, valid, strlen(valid));
    } else if (number->b == 2 && number->c == 2) { /* between two characters */
        ws_client_add(&client, 1, valid, 12);
        ws_client_send(&client, CONTINUED, valid + 12, strlen(valid) - 12);
    } else if (number->b == 2) {
        send_by_octet_fragments((const uint8_t *)text, strlen(text));
    } else {
        if (number->c == 1)
            ws_client_send(&client, TEXT, wrong, strlen(wrong));
        else
            send_by_octet_fragments((const uint8_t *)wrong, strlen(wrong));
        ws_client_expect_end(&client, CODE_NOT_UTF8);
        return;
    }
    expect_text(text);
    ends_well();
}

/* Refused at the byte that shows it, although the message, and in .3 and .4 the frame, is not whole. */
static void utf8_at_once(void **state)
{
    static const char text[] = "\xce\xba\xe1\xbd\xb9\xcf\x83\xce\xbc\xce\xb5\xf4\x90\x80\x80"
                               "edited";
    const struct ws_case *number = *state;
    size_t n_first = number->c % 2 ? 11 : 12, n_until = 13; /* after f4 only 80 to 8f may come */
    struct ws_answer answer;
    if (number->c <= 2) {
        ws_client_send(&client, 1, text, n_first);
        ws_client_add(&client, 0, text + n_first, number->c == 1 ? 4 : 1);
        ws_client_flush(&client, 0);
    } else {
        ws_client_add(&client, TEXT, text, strlen(text));
        size_t n_head = client.n_out - strlen(text);
        client.n_out = n_head + n_first;
        ws_client_flush(&client, 0);
        ws_client_serve(&client);
        assert_int_equal(client.n_in, 0);
        assert_false(client.has_ended);
        ws_client_add(&client, TEXT, text, strlen(text));
        memmove(client.out, client.out + n_head + n_first, client.n_out - n_head - n_first);
        client.n_out = n_until - n_first;
        ws_client_flush(&client, 0);
    }
    ws_client_expect_end(&client, CODE_NOT_UTF8);
    assert_false(ws_client_next(&client, &answer));
}

int main(void)
{
    static const struct ws_group groups[] = {
        { 6, 1, 3, utf8_fragments }, { 6, 2, 4, utf8_fragments }, { 6, 3, 2, utf8_fragments },
        { 6, 4, 4, utf8_at_once },   { 6, 5, 5, utf8_texts },     { 6, 6, 11, utf8_texts },
        { 6, 7, 4, utf8_texts },     { 6, 8, 2, utf8_texts },     { 6, 9, 4, utf8_texts },
        { 6, 10, 3, utf8_texts },    { 6, 11, 5, utf8_texts },    { 6, 12, 8, utf8_texts },
        { 6, 13, 5, utf8_texts },    { 6, 14, 10, utf8_texts },   { 6, 15, 1, utf8_texts },
        { 6, 16, 3, utf8_texts },    { 6, 17, 5, utf8_texts },    { 6, 18, 5, utf8_texts },
        { 6, 19, 5, utf8_texts },    { 6, 20, 7, utf8_texts },    { 6, 21, 8, utf8_texts },
        { 6, 22, 34, utf8_texts },   { 6, 23, 7, utf8_texts },
    };
    return ws_cases_run(groups, sizeof groups / sizeof groups[0], 145);
}

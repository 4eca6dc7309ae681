// Decodes ISO/IEC 2022 as DICOM restricts it; single characters are converted by the C library's iconv.
#include "core/formats/dicom/dicom_charset.hh"

#include <cstdio>
#include <cstring>
#include <map>

#include <iconv.h>

size_t utf8_length(const unsigned char *p, size_t left)
{
    // Source: RFC 3629, table 3-7 of the Unicode standard.
    if (p[0] < 0x80)
        return 1;
    size_t n = p[0] >= 0xC2 && p[0] <= 0xDF ? 2 : (p[0] & 0xF0) == 0xE0 ? 3 : p[0] >= 0xF0 && p[0] <= 0xF4 ? 4 : 0;
    if (n == 0 || n > left)
        return 0;
    unsigned low = p[0] == 0xE0   ? 0xA0
                   : p[0] == 0xF0 ? 0x90
                                  : 0x80,
             high = p[0] == 0xED   ? 0x9F
                    : p[0] == 0xF4 ? 0x8F
                                   : 0xBF;
    for (size_t i = 1; i < n; i++, low = 0x80, high = 0xBF)
        if (p[i] < low || p[i] > high)
            return 0;
    return n;
}

bool is_utf8(const std::string &text)
{
    for (size_t at = 0, n; at < text.size(); at += n)
        if ((n = utf8_length(reinterpret_cast<const unsigned char *>(text.data()) + at, text.size() - at)) == 0)
            return false;
    return true;
}

namespace {

// A set of graphic characters. escape: what designates it after ESC.
struct graphic_set {
    int registration; // number of ISO-IR
    const char *escape;
    bool is_g1;           // bytes 0xA1 to 0xFE (G1), else 0x21 to 0x7E (G0)
    size_t n_bytes;       // of a character
    const char *encoding; // of iconv; nullptr: the bytes are ASCII
    unsigned char shift;  // byte that the encoding wants before each character; 0: none
};

const graphic_set graphic_sets[] = {
    { 6, "(B", false, 1, nullptr, 0 },
    { 14, "(J", false, 1, nullptr, 0 }, // 0x5C is the yen sign; DICOM takes it as the delimiter
    { 87, "$B", false, 2, "EUC-JP", 0 },
    { 42, "$@", false, 2, "EUC-JP", 0 }, // the edition of 1978
    { 159, "$(D", false, 2, "EUC-JP", 0x8F },
    { 13, ")I", true, 1, "EUC-JP", 0x8E },
    { 149, "$)C", true, 2, "EUC-KR", 0 },
    { 58, "$)A", true, 2, "EUC-CN", 0 },
    { 100, "-A", true, 1, "ISO-8859-1", 0 },
    { 101, "-B", true, 1, "ISO-8859-2", 0 },
    { 109, "-C", true, 1, "ISO-8859-3", 0 },
    { 110, "-D", true, 1, "ISO-8859-4", 0 },
    { 144, "-L", true, 1, "ISO-8859-5", 0 },
    { 127, "-G", true, 1, "ISO-8859-6", 0 },
    { 126, "-F", true, 1, "ISO-8859-7", 0 },
    { 138, "-H", true, 1, "ISO-8859-8", 0 },
    { 148, "-M", true, 1, "ISO-8859-9", 0 },
    { 203, "-b", true, 1, "ISO-8859-15", 0 },
    { 166, "-T", true, 1, "TIS-620", 0 },
};

const graphic_set *set_of(int registration)
{
    for (const graphic_set &set : graphic_sets)
        if (set.registration == registration)
            return &set;
    return nullptr;
}

// The converters that one text needs, each opened once.
class converters {
  public:
    converters() = default;
    converters(const converters &) = delete;
    converters &operator=(const converters &) = delete;
    ~converters()
    {
        for (auto &[encoding, converter] : opened)
            if (converter != none())
                iconv_close(converter);
    }
    // Appends one character. False if the bytes are not one character of the encoding.
    bool add(const char *encoding, const char *bytes, size_t n, std::string &out)
    {
        auto found = opened.find(encoding);
        if (found == opened.end())
            found = opened.emplace(encoding, iconv_open("UTF-8", encoding)).first;
        if (found->second == none())
            return false;
        char in[4], utf8[16], *from = in, *to = utf8;
        std::memcpy(in, bytes, n);
        size_t in_left = n, out_left = sizeof utf8;
        iconv(found->second, nullptr, nullptr, nullptr, nullptr);
        if (iconv(found->second, &from, &in_left, &to, &out_left) != 0 || in_left > 0 || to == utf8)
            return false;
        std::string character(utf8, sizeof utf8 - out_left);
        if (!is_utf8(character))
            return false;
        out += character;
        return true;
    }

  private:
    static iconv_t none()
    {
        return reinterpret_cast<iconv_t>(-1);
    }
    std::map<std::string, iconv_t> opened;
};

void add_escaped(unsigned char byte, std::string &out, bool *is_whole)
{
    char escaped[8];
    (void)snprintf(escaped, sizeof escaped, "<0x%02X>", unsigned(byte));
    out += escaped;
    *is_whole = false;
}

std::string from_utf8(const std::string &text, bool *is_whole)
{
    std::string out;
    for (size_t at = 0, n; at < text.size(); at += n) {
        n = utf8_length(reinterpret_cast<const unsigned char *>(text.data()) + at, text.size() - at);
        if (n > 0)
            out.append(text, at, n);
        else
            add_escaped(static_cast<unsigned char>(text[at]), out, is_whole), n = 1;
    }
    return out;
}

// GBK and GB18030: characters of 1, 2 or 4 bytes. A second byte may be a backslash.
std::string from_gb(const std::string &text, const char *encoding, bool *is_whole)
{
    converters all;
    std::string out;
    for (size_t at = 0; at < text.size();) {
        size_t n = 1, left = text.size() - at;
        if (static_cast<unsigned char>(text[at]) < 0x80)
            out += text[at];
        else if (left >= 2 && all.add(encoding, &text[at], 2, out))
            n = 2;
        else if (left >= 4 && all.add(encoding, &text[at], 4, out))
            n = 4;
        else
            add_escaped(static_cast<unsigned char>(text[at]), out, is_whole);
        at += n;
    }
    return out;
}

// Text of ISO/IEC 2022 while it is decoded.
struct decoding {
    const std::string &text;
    const graphic_set *g0, *g1; // g1 may be nullptr: no set is designated
    converters all;
    std::string out;
};

// Takes over the set of the escape sequence at `at`. Returns the length of the sequence, 0 for an unknown one.
size_t designate(decoding &state, size_t at)
{
    for (const graphic_set &set : graphic_sets) {
        size_t n = std::strlen(set.escape);
        if (state.text.compare(at + 1, n, set.escape) == 0) {
            (set.is_g1 ? state.g1 : state.g0) = &set;
            return 1 + n;
        }
    }
    return 0;
}

// Decodes the graphic character at `at`. Returns its length, 0 if the bytes have no meaning.
size_t decode_character(decoding &state, size_t at)
{
    auto byte = static_cast<unsigned char>(state.text[at]);
    const graphic_set *set = byte < 0x80 ? state.g0 : state.g1;
    if (!set || (byte >= 0x80 && byte < 0xA0) || at + set->n_bytes > state.text.size())
        return 0;
    if (!set->encoding) {
        state.out += set->registration == 14 && byte == 0x7E ? "\xE2\x80\xBE" : std::string(1, state.text[at]);
        return 1;
    }
    char bytes[4];
    size_t n = 0;
    if (set->shift)
        bytes[n++] = static_cast<char>(set->shift);
    for (size_t i = 0; i < set->n_bytes; i++) {
        auto part = static_cast<unsigned char>(state.text[at + i]);
        if ((part < 0x80) != (byte < 0x80) || (part & 0x7F) < 0x20)
            return 0;
        bytes[n++] = static_cast<char>(part | 0x80);
    }
    return state.all.add(set->encoding, bytes, n, state.out) ? set->n_bytes : 0;
}

std::string from_iso2022(const graphic_set *first, const std::string &text, const char *delimiters, bool *is_whole)
{
    const graphic_set *g0 = first && first->registration == 13 ? set_of(14) : set_of(6),
                      *g1 = first && first->is_g1 ? first : nullptr;
    decoding state{ text, g0, g1, {}, {} };
    for (size_t at = 0, n; at < text.size(); at += n) {
        auto byte = static_cast<unsigned char>(text[at]);
        bool is_end = byte == '\r' || byte == '\n' || byte == '\f' || byte == '\t' ||
                      (byte && state.g0->n_bytes == 1 && std::strchr(delimiters, byte));
        if (byte == 0x1B) {
            n = designate(state, at);
        } else if (is_end || byte <= ' ' || byte == 0x7F) {
            state.out += text[at];
            n = 1;
        } else {
            n = decode_character(state, at);
        }
        if (is_end)
            state.g0 = g0, state.g1 = g1;
        if (n == 0) {
            add_escaped(byte, state.out, is_whole);
            n = 1;
        }
    }
    return state.out;
}

std::string first_term(const std::string &sets)
{
    size_t end = sets.find('\\');
    std::string term = sets.substr(0, end);
    size_t from = term.find_first_not_of(" "), last = term.find_last_not_of(std::string(" \0", 2));
    return from == std::string::npos || last == std::string::npos || last < from ? ""
                                                                                 : term.substr(from, last + 1 - from);
}

// The number in "ISO_IR 100", "ISO 2022 IR 100"; 0 for any other term.
int registration_of(const std::string &term)
{
    int number = 0, n = 0;
    bool is_one = (std::sscanf(term.c_str(), "ISO_IR %3d%n", &number, &n) == 1 ||
                   std::sscanf(term.c_str(), "ISO 2022 IR %3d%n", &number, &n) == 1) &&
                  size_t(n) == term.size();
    return is_one ? number : 0;
}

} // namespace

std::string dicom_charset_to_utf8(const std::string &sets, const std::string &text, const char *delimiters,
                                  bool *is_whole)
{
    std::string term = first_term(sets);
    int registration = registration_of(term);
    if (registration == 192)
        return from_utf8(text, is_whole);
    if (term == "GB18030" || term == "GBK")
        return from_gb(text, term.c_str(), is_whole);
    const graphic_set *first = set_of(registration);
    bool has_escapes = text.find('\x1B') != std::string::npos;
    if ((!first || registration == 6) && !has_escapes && is_utf8(text))
        return text;
    bool is_without = first_term(sets).empty() && sets.find('\\') == std::string::npos;
    return from_iso2022(is_without && !has_escapes ? set_of(100) : first, text, delimiters, is_whole);
}

// Converts text of any DICOM character set to UTF-8, and decimal strings to numbers.
#include "core/formats/dicom/dicom_text.hh"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include <iconv.h>

bool dicom_text_is_ascii(const char *text, size_t size)
{
    return std::all_of(text, text + size, [](char c) { return static_cast<unsigned char>(c) < 128 && c != 27; });
}

namespace {

// Length of the UTF-8 character at p; 0 if it is not UTF-8. Source: RFC 3629, table 3-7 of the Unicode standard.
size_t utf8_length(const unsigned char *p, size_t left)
{
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

std::string from_latin1(const std::string &text)
{
    std::string out;
    for (char c : text) {
        auto byte = static_cast<unsigned char>(c);
        if (byte < 128) {
            out += c;
        } else {
            out += static_cast<char>(0xC0 | byte >> 6);
            out += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return out;
}

// Converts the escape sequences of Japanese sets (ISO-IR 6, 14, 87, 159), which DCMTK over the C library's iconv does
// not know by their own names.
bool from_iso2022(const std::string &text, std::string &out)
{
    iconv_t converter = iconv_open("UTF-8", "ISO-2022-JP-2");
    if (converter == reinterpret_cast<iconv_t>(-1))
        return false;
    std::string from = text;
    out.resize(4 * text.size() + 16);
    char *in = from.data(), *to = out.data();
    size_t in_left = from.size(), out_left = out.size();
    bool is_converted = iconv(converter, &in, &in_left, &to, &out_left) != static_cast<size_t>(-1);
    iconv_close(converter);
    out.resize(out.size() - out_left);
    return is_converted && is_utf8(out);
}

bool is_padding(char c)
{
    return c == ' ' || c == 0 || c == '\t' || c == '\r' || c == '\n';
}

} // namespace

std::string dicom_text_to_utf8(DcmSpecificCharacterSet *converter, std::string text)
{
    OFString converted;
    if (converter && converter->convertString(text.data(), text.size(), converted, "\\^=").good()) {
        std::string out(converted.c_str(), converted.size());
        if (is_utf8(out))
            return out;
    }
    std::string out;
    if (text.find('\x1B') != std::string::npos && from_iso2022(text, out))
        return out;
    return is_utf8(text) ? text : from_latin1(text);
}

bool dicom_text_put(const std::string &text, char *out, size_t size)
{
    size_t from = 0, end = text.size();
    while (end > from && is_padding(text[end - 1]))
        end--;
    while (from < end && is_padding(text[from]))
        from++;
    size_t n = 0;
    while (from < end) {
        auto *p = reinterpret_cast<const unsigned char *>(text.data()) + from;
        size_t length = utf8_length(p, end - from);
        if (length == 0 || n + length >= size)
            break;
        bool is_control = p[0] < 32 || p[0] == 127 || (p[0] == 0xC2 && length == 2 && p[1] < 0xA0);
        if (is_control) {
            out[n++] = ' ';
        } else {
            std::memcpy(out + n, p, length);
            n += length;
        }
        from += length;
    }
    out[n] = 0;
    return n > 0;
}

namespace {

// Converts "-123.45" and the like, up to 15 digits: the digits and the power of ten are exact, so their quotient is
// rounded once and correct. Returns false for any other form. Source: W. D. Clinger, How to Read Floating Point Numbers
// Accurately, PLDI 1990.
bool short_decimal(const char *from, const char *end, double *value)
{
    static const double tens[] = { 1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15 };
    bool is_negative = from < end && *from == '-';
    from += is_negative;
    unsigned long long digits = 0;
    int n = 0, n_behind = -1;
    for (; from < end; from++) {
        if (*from == '.' && n_behind < 0) {
            n_behind = 0;
        } else if (*from >= '0' && *from <= '9' && n < 15) {
            digits = 10 * digits + static_cast<unsigned>(*from - '0');
            n++;
            n_behind += n_behind >= 0;
        } else {
            return false;
        }
    }
    if (n == 0)
        return false;
    *value = static_cast<double>(digits) / tens[n_behind > 0 ? n_behind : 0];
    if (is_negative)
        *value = -*value;
    return true;
}

// Parses a decimal string as people write them: blanks around it, a leading plus. Malformed: NaN. Independent of the
// locale.
double number_from(const char *from, const char *end)
{
    while (from < end && is_padding(*from))
        from++;
    while (end > from && is_padding(end[-1]))
        end--;
    if (end - from > 1 && *from == '+' && from[1] != '-')
        from++;
    double value;
    if (short_decimal(from, end, &value))
        return value;
    auto [stop, error] = std::from_chars(from, end, value);
    bool is_digits =
        from < end && (*from == '-' || *from == '.' || (*from >= '0' && *from <= '9')); // excludes "inf" and "nan"
    if (stop != end || !is_digits || error != std::errc() || !std::isfinite(value))
        return std::numeric_limits<double>::quiet_NaN();
    return value;
}

} // namespace

size_t dicom_text_numbers(const char *text, size_t size, double *out, size_t most)
{
    while (size > 0 && is_padding(text[size - 1]))
        size--;
    if (size == 0)
        return 0;
    size_t n = 0;
    const char *end = text + size;
    for (const char *from = text;; n++) {
        auto *stop = static_cast<const char *>(std::memchr(from, '\\', size_t(end - from)));
        if (n < most)
            out[n] = number_from(from, stop ? stop : end);
        if (!stop)
            return n + 1;
        from = stop + 1;
    }
}

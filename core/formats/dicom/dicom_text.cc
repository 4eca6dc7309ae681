// Copies text without padding, and reads decimal strings as numbers.
#include "core/formats/dicom/dicom_text.hh"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/formats/dicom/dicom_charset.hh"

bool dicom_text_is_ascii(const char *text, size_t size)
{
    return std::all_of(text, text + size, [](char c) { return static_cast<unsigned char>(c) < 128 && c != 27; });
}

namespace {

bool is_padding(char c)
{
    return c == ' ' || c == 0 || c == '\t' || c == '\r' || c == '\n';
}

} // namespace

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

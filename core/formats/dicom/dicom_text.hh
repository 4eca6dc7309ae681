#pragma once
// Values of text elements: characters to UTF-8, digits to numbers. Knows no elements.
#include <cstddef>
#include <string>

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dcspchrs.h>

// Neither a byte above 127 nor an escape sequence: the same in every character set.
bool dicom_text_is_ascii(const char *text, size_t size);
// What cannot be converted by what the file says (converter; nullptr: it says nothing that is known) is taken for UTF-8 when it is that,
// else for Latin-1: files without a word on their characters are common, and a readable name is better than none.
std::string dicom_text_to_utf8(DcmSpecificCharacterSet *converter, std::string text);
// Without padding, control characters as blanks, cut at a whole character; false when nothing is left.
bool dicom_text_put(const std::string &text, char *out, size_t size);
// Numbers between backslashes; fills at most most of them and returns how many there are. What is no number becomes not-a-number.
size_t dicom_text_numbers(const char *text, size_t size, double *out, size_t most);

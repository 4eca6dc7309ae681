#pragma once
// Copies the values of text elements without padding, and reads digits as numbers. Knows no elements and no character
// sets.
#include <cstddef>
#include <string>

// Returns true if text has no byte above 127 and no escape sequence, so that it is the same in every character set.
bool dicom_text_is_ascii(const char *text, size_t size);
// Copies text without padding, with control characters as blanks, truncated at a whole character; false if nothing is
// left.
bool dicom_text_put(const std::string &text, char *out, size_t size);
// Parses numbers separated by backslashes; a malformed one becomes NaN. Stores at most `most` and returns how many
// there are.
size_t dicom_text_numbers(const char *text, size_t size, double *out, size_t most);

#pragma once
// Converts the values of text elements: characters to UTF-8, digits to numbers. Knows no elements.
#include <cstddef>
#include <string>

#include <dcmtk/config/osconfig.h>

#include <dcmtk/dcmdata/dcspchrs.h>

// Returns true if text has no byte above 127 and no escape sequence, so that it is the same in every character set.
bool dicom_text_is_ascii(const char *text, size_t size);
// Converts to UTF-8 by the file's character set (converter; nullptr: none, or an unknown one). Text that cannot be
// converted is taken as UTF-8 if it is valid UTF-8, else as Latin-1: files without a character set are common, and a
// readable name is better than none.
std::string dicom_text_to_utf8(DcmSpecificCharacterSet *converter, std::string text);
// Copies text without padding, with control characters as blanks, truncated at a whole character; false if nothing is
// left.
bool dicom_text_put(const std::string &text, char *out, size_t size);
// Parses numbers separated by backslashes; a malformed one becomes NaN. Stores at most `most` and returns how many
// there are.
size_t dicom_text_numbers(const char *text, size_t size, double *out, size_t most);

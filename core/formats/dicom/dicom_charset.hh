#pragma once
// Converts text of DICOM's character sets, with code extensions, to UTF-8. Knows no elements.
#include <cstddef>
#include <string>

// Length of the UTF-8 character at p; 0 if it is not UTF-8.
size_t utf8_length(const unsigned char *p, size_t left);
bool is_utf8(const std::string &text);

// Converts text to UTF-8. Bytes without a meaning become "<0x8E>".
//
//   sets        value of SpecificCharacterSet: terms separated by backslashes; "" when the file states none
//   delimiters  characters after which the sets of value 1 are in force again, beside control characters: "\\^=" for
//               names of persons, "\\" for other elements with several values
//   is_whole    set to false if a byte had no meaning; else left as it is
//   differs     escape sequences of sets that `sets` does not list count, too. Without a set, or with an unknown one,
//               text that is valid UTF-8 is taken as UTF-8. Without a set other text is taken as Latin-1: files without
//               a set are common.
//   source      DICOM PS3.5, 6.1.2 and annexes H to K; ISO/IEC 2022; JIS X 0201
std::string dicom_charset_to_utf8(const std::string &sets, const std::string &text, const char *delimiters,
                                  bool *is_whole);

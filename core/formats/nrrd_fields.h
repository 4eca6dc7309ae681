#pragma once
/* Splits an NRRD header into fields, and their values into words, numbers and vectors. Only nrrd_header.c uses it. */
#include "core/formats/nrrd.h"
#include "core/math/vec.h"

enum { NRRD_WORD_SIZE = 64 };

enum nrrd_field {
    NRRD_TYPE,
    NRRD_DIMENSION,
    NRRD_SIZES,
    NRRD_ENCODING,
    NRRD_ENDIAN,
    NRRD_SPACE,
    NRRD_SPACE_DIMENSION,
    NRRD_SPACE_DIRECTIONS,
    NRRD_SPACE_ORIGIN,
    NRRD_SPACE_UNITS,
    NRRD_SPACINGS,
    NRRD_KINDS,
    NRRD_DATA_FILE,
    NRRD_LINE_SKIP,
    NRRD_BYTE_SKIP,
    NRRD_N_FIELDS
};
/* The value of a field and its line in the header; line 0 and at "" when the field is absent. */
struct nrrd_value {
    const char *at;
    size_t n, line;
};

struct nrrd_fields {
    const char *at, *start, *end;
    size_t line;
    const char *name;
    struct nrrd_value values[NRRD_N_FIELDS];
    struct report *report;
    struct error *err;
};

/* Finds the fields of the lines up to the empty one that ends the header; hands "key:=value" lines to nrrd_segment_key.
 * is_cut: there may be more bytes than head holds. errors ERROR_FORMAT, ERROR_LIMIT */
NODISCARD bool nrrd_fields_read(struct nrrd_fields *head, struct nrrd_header *header, bool is_cut);

/* Set the error for a line, or for a field with a wrong value; return false. */
bool nrrd_refuse(const struct nrrd_fields *head, size_t line, enum error_code code, const char *format, ...)
    PRINTF_LIKE(4, 5);
bool nrrd_refuse_value(const struct nrrd_fields *head, enum nrrd_field field, enum error_code code,
                       const char *expected);

/* Reads the next word up to a separator: blanks, or commas within brackets; "" at the end. A longer word is cut, and is
 * then no number. */
void nrrd_next_word(struct nrrd_value *rest, const char *separators, char word[NRRD_WORD_SIZE]);
/* Reads the next vector, "(1,0,0)". */
NODISCARD bool nrrd_next_vector(struct nrrd_value *rest, struct vec3 *vector);
/* Reads a field that is a whole number from least to most. errors ERROR_FORMAT; ERROR_LIMIT above most */
NODISCARD bool nrrd_get_whole(const struct nrrd_fields *head, enum nrrd_field field, double least, double most,
                              int64_t *out);
/* True if the field is this word, in any case. */
bool nrrd_value_is(const struct nrrd_fields *head, enum nrrd_field field, const char *word);
/* Copies n characters to out, cut at size, with a NUL. */
void nrrd_copy(const char *at, size_t n, char *out, size_t size);

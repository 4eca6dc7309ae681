#pragma once
/* Reads a tally file, "beamroom-tally": which field of a Monte Carlo code's file is meant, and what that file does not
 * say: its normalisation, and where its axes lie in the patient. Its keys are told in docs/plan-folder.md. */
#include "core/formats/folder.h"
#include "core/formats/tally/tally.h"

enum { TALLY_FILE_MAX_BYTES = 1 << 16 };

struct tally_file {
    char path[FOLDER_NAME_SIZE];   /* of the code's file, relative to the tally file's folder */
    char errors[FOLDER_NAME_SIZE]; /* of a second file with relative errors; "" none */
    char normalisation[128];       /* in words, for people */
    struct tally_choice choice;
    struct tally_placing placing;
};

/* report gets a note for each key that is not known; NULL: none.
 * errors  ERROR_FORMAT, ERROR_RANGE, ERROR_LIMIT, ERROR_UNSUPPORTED another version; ERROR_MEMORY */
NODISCARD bool tally_file_parse(const uint8_t *data, size_t size, const char *name, struct tally_file *file,
                                struct report *report, struct error *err);

#pragma once
/* Names the likely kind of a file that is not read, for the report. */
#include "core/formats/folder.h"

/* "a surface mesh", "an MCNP mesh tally", "a text", ...: by its name, else by its first bytes. */
const char *file_kind_words(const struct folder *folder, const char *name);

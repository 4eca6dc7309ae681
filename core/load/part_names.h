#pragma once
/* Names of files in a plan's folder: the last part of a path, words in a name, the data file beside a header. */
#include "core/formats/folder.h"

const char *part_base_name(const char *name); /* the name after the last slash */
/* True if the name contains one of the words, whatever its case. words: in lower case. */
bool part_name_has_word(const char *name, const char *const *words, size_t n_words);

/* True if the name contains the word with no letter before or behind it, whatever its case. word: in lower case. */
bool part_name_has_whole_word(const char *name, const char *word);

/* Finds the data file beside a header: the header's stem with the ending (".uv", ".qim", ".cdf") and ".gz", ".sz" or
 * nothing, in that order. Returns false when there is none. */
bool part_find_data(const struct folder *folder, const char *header, const char *ending, char data[FOLDER_NAME_SIZE]);

/* True if the folder below the plan's has a plan.json, so that it is a plan of its own. */
bool part_is_plan_folder(const struct folder *folder, const char *name);

/* The last part of a folder's path, as the name of a plan that gives no name. */
void plan_folder_name(const char *path, char *out, size_t size);

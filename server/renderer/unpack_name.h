#pragma once
/* Names of an archive's entries: the rules of unpack.h, the safe name, and the set of names seen so far. Touches no
 * files. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "core/formats/folder.h"
#include "server/wire/problem.h"

enum { UNPACK_SHOWN_SIZE = 72 };
/* Makes a name, or a library's message, fit for a sentence: UTF-8, '?' for control characters, cut when it is long. */
void unpack_show(const char *raw, char shown[UNPACK_SHOWN_SIZE]);

/* The name under which an entry is written; "" for the archive's own "./". False with problem. */
NODISCARD bool unpack_name(const char *raw, bool is_folder, char name[FOLDER_NAME_SIZE], struct problem *problem);
/* True for metadata files of other systems, which are not unpacked. */
bool unpack_is_litter(const char *name);

struct unpack_names {
    void *tree;
    uint32_t n;
};
enum unpack_known { UNPACK_NEW, UNPACK_KNOWN, UNPACK_REFUSED };
/* Adds the first n bytes of name to the set. UNPACK_KNOWN: a folder that was added before; UNPACK_REFUSED: with
 * problem. */
enum unpack_known unpack_names_add(struct unpack_names *names, const char *name, size_t n, bool is_folder,
                                   struct problem *problem);
void unpack_names_finish(struct unpack_names *names);

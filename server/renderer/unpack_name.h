#pragma once
/* Names of an archive's entries: which are let in, what they become, and which have been before. Touches no files. */
#include "server/renderer/unpack.h"

enum { UNPACK_SHOWN_SIZE = 72 };
/* A name or another program's words as a sentence can carry them: UTF-8, no control characters, cut where it is long.
 */
void unpack_show(const char *raw, char shown[UNPACK_SHOWN_SIZE]);

/* The name as it is written, "" for the archive's own "./". False: why in problem. */
NODISCARD bool unpack_name(const char *raw, bool is_folder, char name[FOLDER_NAME_SIZE], struct problem *problem);
/* Left behind by the systems archives come from. */
bool unpack_is_litter(const char *name);

struct unpack_names {
    void *tree;
    uint32_t n;
};
enum unpack_known { UNPACK_NEW, UNPACK_KNOWN, UNPACK_REFUSED };
/* Notes a name, the first n bytes of it. UNPACK_KNOWN: a folder that is there already. */
enum unpack_known unpack_names_add(struct unpack_names *names, const char *name, size_t n, bool is_folder,
                                   struct problem *problem);
void unpack_names_finish(struct unpack_names *names);

#pragma once
/* Makes files and folders below one open folder and nowhere else: every step goes through an open folder, follows no
 * link and opens no file that is there already. Names are checked (unpack_name). */
#include "server/renderer/unpack.h"

struct unpack_writer {
    int folder; /* -1: nothing is written */
    int parent; /* the folder that the last name was in; -1: none */
    char parent_name[FOLDER_NAME_SIZE];
};
void unpack_writer_init(struct unpack_writer *writer, int folder);
void unpack_writer_finish(struct unpack_writer *writer);

/* Whether there is nothing in it. */
NODISCARD bool unpack_is_empty(int folder, struct problem *problem);
NODISCARD bool unpack_make_folder(struct unpack_writer *writer, const char *name, size_t n, struct problem *problem);
/* file: -1 where nothing is written */
NODISCARD bool unpack_make_file(struct unpack_writer *writer, const char *name, int *file, struct problem *problem);
NODISCARD bool unpack_write(int file, const char *name, const void *data, size_t n, struct problem *problem);
/* All that is in the folder top comes up, and top goes. */
NODISCARD bool unpack_lift(struct unpack_writer *writer, const char *top, struct problem *problem);
/* Removes all that is in the folder. False: something stayed. */
bool unpack_clear(int folder);

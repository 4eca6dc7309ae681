#pragma once
/* Makes files and folders below one open folder and nowhere else: every step of a path is opened relative to its
 * parent, links are not followed, and existing files are not opened. Names must have passed unpack_name. */
#include <stdbool.h>
#include <stddef.h>

#include "core/formats/folder.h"
#include "server/wire/problem.h"

struct unpack_writer {
    int folder; /* -1: nothing is written */
    int parent; /* the open folder of the last name; -1: none */
    char parent_name[FOLDER_NAME_SIZE];
};
void unpack_writer_init(struct unpack_writer *writer, int folder);
void unpack_writer_finish(struct unpack_writer *writer);

/* False with problem when the folder is not empty or cannot be read. */
NODISCARD bool unpack_is_empty(int folder, struct problem *problem);
NODISCARD bool unpack_make_folder(struct unpack_writer *writer, const char *name, size_t n, struct problem *problem);
/* *file: -1 when nothing is written */
NODISCARD bool unpack_make_file(struct unpack_writer *writer, const char *name, int *file, struct problem *problem);
NODISCARD bool unpack_write(int file, const char *name, const void *data, size_t n, struct problem *problem);
/* Moves the contents of the folder top one level up and removes top. */
NODISCARD bool unpack_lift(struct unpack_writer *writer, const char *top, struct problem *problem);
/* Removes everything in the folder. False: something could not be removed. */
bool unpack_clear(int folder);

#pragma once
/* Opens, lists and reads files of a plan's folder; all bytes of a plan come through here. Names are relative and never
 * lead out of the folder, by "..", by an absolute name or by a symbolic link. Knows nothing of what the bytes mean. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum {
    FOLDER_NAME_SIZE = 512,    /* longest relative name, with its NUL */
    FOLDER_MAX_ENTRIES = 4096, /* most entries that folder_list returns */
    FOLDER_MAX_FILES = 65536,  /* most files that folder_walk returns */
    FOLDER_MAX_DEPTH = 8       /* levels of folders that folder_walk enters */
};

struct folder {
    int fd;
    char path[4096]; /* absolute, without symbolic links */
};

/* Bytes in memory; bytes_free frees data. */
struct bytes {
    uint8_t *data;
    size_t size;
};
void bytes_free(struct bytes *bytes);

/* errors ERROR_NOT_FOUND, ERROR_IO, ERROR_MEMORY */
NODISCARD bool folder_open(struct folder *folder, const char *path, struct error *err);
void folder_close(struct folder *folder);

/* Checks the form of a name: relative, without "..", without control characters, not too long. errors ERROR_RANGE */
NODISCARD bool folder_check_name(const char *name, struct error *err);

enum folder_kind { FOLDER_ABSENT, FOLDER_FILE, FOLDER_DIRECTORY, FOLDER_OTHER };
/* The kind of a name, and the size of a file. A link that leads out of the folder is FOLDER_OTHER. bytes may be NULL.
 * Without memory or descriptors FOLDER_OTHER, and error_n_memory counts it. */
enum folder_kind folder_look(const struct folder *folder, const char *name, uint64_t *bytes);

/* Reads the whole file, or only its first most bytes when it is longer.
 *   limit   refuse a file that is larger
 *   errors  ERROR_RANGE a name that leaves the folder, ERROR_NOT_FOUND, ERROR_LIMIT, ERROR_MEMORY, ERROR_IO */
NODISCARD bool folder_read(const struct folder *folder, const char *name, uint64_t limit, uint64_t most,
                           struct bytes *bytes, struct error *err);

/* A file kept open, to read parts of it. */
struct folder_part {
    int fd;
    uint64_t n_bytes; /* of the file */
};
/* errors as folder_read, without ERROR_LIMIT; ERROR_MEMORY also without descriptors */
NODISCARD bool folder_open_part(const struct folder *folder, const char *name, struct folder_part *part,
                                struct error *err);
/* Reads n bytes from offset at. errors ERROR_IO, also when the file ends earlier */
NODISCARD bool folder_read_part(const struct folder_part *part, const char *name, uint64_t at, void *out, size_t n,
                                struct error *err);
void folder_close_part(struct folder_part *part);

/* Names of files and folders directly inside, without those that begin with a dot, sorted by byte value.
 * The array and its names are the caller's: folder_free_names. errors ERROR_IO, ERROR_MEMORY */
NODISCARD bool folder_list(const struct folder *folder, char ***names, size_t *n_names, struct error *err);
void folder_free_names(char **names, size_t n_names);

/* A file below the folder, with what tells whether it has changed. */
struct folder_file {
    char *name; /* relative to the folder, "series-1/IM0001" */
    uint64_t bytes, inode;
    int64_t modified_ns; /* since 1970 */
};
struct folder_tree {
    struct folder_file *files; /* sorted by the bytes of their names */
    size_t n_files;
    size_t n_passed;  /* names that were left out, other than hidden ones: links that lead out of the folder, to nothing
                         or  to folders, what is no plain file, and names that folder_check_name refuses */
    char passed[160]; /* the first of them */
    bool is_cut;      /* there are more files than FOLDER_MAX_FILES, or deeper ones than FOLDER_MAX_DEPTH */
};
/* Lists all plain files below a folder inside, under, or below the whole folder for "". Leaves out names that begin
 * with a dot and folders for which is_skipped (may be NULL) returns true. Follows links to files that stay inside, and
 * no links to folders. errors as folder_list; the caller calls folder_tree_finish, also after a failure */
NODISCARD bool folder_walk(const struct folder *folder, const char *under,
                           bool (*is_skipped)(const struct folder *folder, const char *name), struct folder_tree *tree,
                           struct error *err);
void folder_tree_finish(struct folder_tree *tree);

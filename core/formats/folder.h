#pragma once
/* A plan's folder: the one way bytes of a plan come off the disk. Names are relative and never lead out of it, by "..",
 * by an absolute name or by a symbolic link. Knows nothing of what the bytes mean. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"

enum {
    FOLDER_NAME_SIZE = 512,    /* longest relative name, with its end */
    FOLDER_MAX_ENTRIES = 4096, /* a listing ends here */
    FOLDER_MAX_FILES = 65536,  /* folder_walk ends here */
    FOLDER_MAX_DEPTH = 8       /* folders in folders that folder_walk enters */
};

struct folder {
    int fd;
    char path[4096]; /* resolved */
};

/* Bytes in memory; data is freed with bytes_free. */
struct bytes {
    uint8_t *data;
    size_t size;
};
void bytes_free(struct bytes *bytes);

/* errors ERROR_NOT_FOUND, ERROR_IO */
NODISCARD bool folder_open(struct folder *folder, const char *path, struct error *err);
void folder_close(struct folder *folder);

/* Whether a name may be asked for at all: relative, no "..", no control characters, not too long. */
NODISCARD bool folder_check_name(const char *name, struct error *err);

enum folder_kind { FOLDER_ABSENT, FOLDER_FILE, FOLDER_DIRECTORY, FOLDER_OTHER };
/* What the name is; a link that leads out of the folder is FOLDER_OTHER. bytes may be NULL. */
enum folder_kind folder_look(const struct folder *folder, const char *name, uint64_t *bytes);

/* The whole file, or its first most bytes when most is less (then no error).
 *   limit   refuse a file that is larger
 *   errors  ERROR_RANGE a name that leaves the folder, ERROR_NOT_FOUND, ERROR_LIMIT, ERROR_MEMORY, ERROR_IO */
NODISCARD bool folder_read(const struct folder *folder, const char *name, uint64_t limit, uint64_t most,
                           struct bytes *bytes, struct error *err);

/* One file kept open, to read parts of it. */
struct folder_part {
    int fd;
    uint64_t n_bytes; /* of the file */
};
/* errors as folder_read, without ERROR_LIMIT and ERROR_MEMORY */
NODISCARD bool folder_open_part(const struct folder *folder, const char *name, struct folder_part *part,
                                struct error *err);
/* n bytes from at on. errors ERROR_IO, also when the file ends before */
NODISCARD bool folder_read_part(const struct folder_part *part, const char *name, uint64_t at, void *out, size_t n,
                                struct error *err);
void folder_close_part(struct folder_part *part);

/* Names of files and folders right inside, without those that begin with a dot, sorted by byte value.
 * The array and its names are the caller's: folder_free_names. errors ERROR_IO, ERROR_MEMORY */
NODISCARD bool folder_list(const struct folder *folder, char ***names, size_t *n_names, struct error *err);
void folder_free_names(char **names, size_t n_names);

/* One file below the folder, and what tells whether it has changed. */
struct folder_file {
    char *name; /* relative to the folder, "series-1/IM0001" */
    uint64_t bytes, inode;
    int64_t modified_ns; /* since 1970 */
};
struct folder_tree {
    struct folder_file *files; /* sorted by the bytes of their names */
    size_t n_files;
    bool is_cut; /* there was more than FOLDER_MAX_FILES or deeper than FOLDER_MAX_DEPTH */
};
/* All plain files below a part of the folder ("" for all of it), without names that begin with a dot; links to folders
 * are not followed, links to files are when they stay inside. Folders that is_skipped says yes to are left out (NULL:
 * none). errors as folder_list; the caller calls folder_tree_finish, after a failure too */
NODISCARD bool folder_walk(const struct folder *folder, const char *under,
                           bool (*is_skipped)(const struct folder *folder, const char *name), struct folder_tree *tree,
                           struct error *err);
void folder_tree_finish(struct folder_tree *tree);

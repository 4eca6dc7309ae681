#pragma once
/* Unpacks an uploaded archive (zip, or tar plain or compressed with gzip, bzip2, xz or zstd) into an empty folder. The
 * archive is treated as hostile: the first entry that breaks a rule or a limit (unpack_limits.h) refuses the whole
 * archive and removes what was written. The sentence names the entry, its number, in a tar its byte, what was found and
 * what is expected. Knows nothing of plans.
 *
 * Names: relative, parts separated by '/' ('\' counts as '/'); parts "." are dropped. Refused: absolute names, drive
 * letters, "..", empty parts, control characters, names or parts that are too long, the same name twice (also in
 * another case). A byte that is not valid UTF-8 becomes '_' and its two hexadecimal digits ("M\374ller" becomes
 * "M_FCller"). Kinds: files and folders. Refused: hard and symbolic links, devices, pipes, sockets, sparse files,
 * encrypted entries. An archive inside the archive is unpacked as a plain file. Metadata of other systems (__MACOSX,
 * ._*, .DS_Store, Thumbs.db, desktop.ini) is not written, but counts as read. When all entries lie in one top folder,
 * its contents are moved up (not on kernels before 5.19, which do not let a confined process move files). Files get
 * mode 0640, folders 0750; owners, times and modes of the archive are ignored. */
#include <stdbool.h>
#include <stdint.h>

#include "core/formats/folder.h"
#include "server/renderer/unpack_limits.h"
#include "server/wire/problem.h"

struct unpack_options {
    uint64_t max_bytes;                  /* of all files together, counted while they are unpacked */
    bool (*is_cancelled)(void *context); /* called at every block; NULL: never cancelled */
    /* percent of the archive's bytes, never less than before; NULL: not reported */
    void (*progress)(void *context, double percent);
    void *context;
};

struct unpack_result {
    uint64_t n_files, n_bytes;
};

/* The processor time that unpacking may take in all, in seconds. */
uint64_t unpack_cpu_seconds(uint64_t archive_bytes, uint64_t max_bytes);

/* Unpacks an archive into a folder.
 *
 *   archive  an open file, read from its beginning
 *   folder   an open, empty folder; -1: everything is read and checked and nothing is written
 *   errors   PROBLEM_MEDIA_TYPE  it is none of these archives
 *            PROBLEM_TOO_LARGE   a limit is exceeded
 *            PROBLEM_VALIDATION  a rule is broken or bytes are damaged
 *            PROBLEM_TIMEOUT, PROBLEM_CANCELLED, PROBLEM_STORAGE, PROBLEM_INTERNAL (a system call failed)
 *            the folder is empty after each of them
 *   thread   any; one call per folder at a time */
NODISCARD bool unpack(int archive, int folder, const struct unpack_options *options, struct unpack_result *result,
                      struct problem *problem);

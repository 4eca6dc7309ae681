#pragma once
/* Unpacks an archive somebody sent into an empty folder: zip, or tar as it is or within gzip, bzip2, xz or zstd. The
 * archive is hostile until it is read: what it may hold and how much of it is written down here, and the first thing
 * that breaks a rule refuses all of it with a sentence that names the entry, its number and in a tar the byte it begins
 * at, what was found and what is expected. Then nothing of it stays behind. Knows nothing of plans.
 *
 * Names. Relative, parts parted by '/' ('\' counts as one); parts that are "." are left out. Refused: absolute names,
 * drive letters,
 * "..", empty parts, control characters, a part or a name too long, the same name twice, also in another case. A byte
 * that is not of UTF-8 becomes '_' and its two hexadecimal digits ("M\374ller" becomes "M_FCller"). Kinds. Files and
 * folders. Refused: links of both kinds, devices, pipes, sockets, sparse files, encrypted entries. An archive within
 * the archive is a file like others.
 * Litter of other systems is left out (__MACOSX, ._*, .DS_Store, Thumbs.db, desktop.ini) but counts as read. Where all
 * lies in one folder, what is in that folder comes out (not where a kernel of before 5.19 keeps a confined process from
 * moving files). Files are made with mode 0640, folders with 0750; owners, times and rights of the archive are not
 * taken over. */
#include <stdbool.h>
#include <stdint.h>

#include "core/formats/folder.h"
#include "server/wire/problem.h"

enum {
    UNPACK_MAX_ENTRIES = 100000,          /* of the archive, and files and folders made of it */
    UNPACK_MAX_DEPTH = 16,                /* parts of a name */
    UNPACK_PART_SIZE = 255,               /* bytes of one part; all together FOLDER_NAME_SIZE - 1 */
    UNPACK_MAX_RATIO = 200,               /* bytes unpacked for each byte of the archive ... */
    UNPACK_FREE_BYTES = 64 * 1024 * 1024, /* ... where it is more than this */
    UNPACK_CPU_S = 30,                    /* processor time: these seconds ... */
    UNPACK_CPU_BYTES_PER_S = 4 << 20,     /* ... and one for each so many bytes read or unpacked */
    UNPACK_MEMORY_BYTES = 512 << 20,      /* of its own the process may take, where nothing else is said */
    UNPACK_PERCENT_MS = 100               /* between two words on how far it is */
};

struct unpack_options {
    uint64_t max_bytes;                  /* of all files together, counted as they are unpacked */
    bool (*is_cancelled)(void *context); /* NULL: never; asked at every block */
    void (*progress)(void *context,
                     double percent); /* NULL: to nobody; of the archive's bytes, never less than before */
    void *context;
};

struct unpack_result {
    uint64_t n_files, n_bytes;
};

/* Seconds of processor time that unpacking may take in all. */
uint64_t unpack_cpu_seconds(uint64_t archive_bytes, uint64_t max_bytes);

/*   archive  an open file, read from its beginning
 *   folder   an open, empty folder; -1: everything is read and checked and nothing written
 *   errors   PROBLEM_MEDIA_TYPE it is none of these archives, PROBLEM_TOO_LARGE more than a limit, PROBLEM_VALIDATION a
 * rule broken or bytes damaged, PROBLEM_TIMEOUT, PROBLEM_CANCELLED, PROBLEM_INTERNAL the system refused; the folder is
 * empty then thread   any, one call for a folder at a time */
NODISCARD bool unpack(int archive, int folder, const struct unpack_options *options, struct unpack_result *result,
                      struct problem *problem);

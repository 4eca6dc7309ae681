#pragma once
/* The limits of an archive that is unpacked: entries, names, sizes, time, memory. */

enum {
    UNPACK_MAX_ENTRIES = 100000,          /* entries of the archive; likewise files and folders made from it */
    UNPACK_MAX_DEPTH = 16,                /* parts of a name */
    UNPACK_PART_SIZE = 255,               /* bytes of one part of a name; the whole name: FOLDER_NAME_SIZE - 1 */
    UNPACK_MAX_RATIO = 200,               /* unpacked bytes per byte of the archive, ... */
    UNPACK_FREE_BYTES = 64 * 1024 * 1024, /* ... once more than this is unpacked */
    UNPACK_CPU_S = 30,                    /* seconds of processor time: this many, ... */
    UNPACK_CPU_BYTES_PER_S = 4 << 20,     /* ... and one more for every so many bytes read or unpacked */
    UNPACK_MEMORY_BYTES = 512 << 20,      /* writable memory of the process, unless its caller gives a limit */
    UNPACK_PERCENT_MS = 100               /* least time between two reports of progress */
};

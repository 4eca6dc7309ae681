#pragma once
/* The command --unpack: confines the process, unpacks an archive, and reports on standard output, one JSON object a
 * line:
 * {"percent": 12.5}, and last {"done": true, "n_files": 12, "n_bytes": 345} or {"problem": {...}}. */
#include <stdint.h>

/* max_bytes: writable memory of the process; 0: UNPACK_MEMORY_BYTES. Returns the exit status: 0 done; 1 standard output
 * cannot be written; 3 refused, or ended by SIGTERM, SIGINT or SIGHUP. The folder is empty unless it returns 0. */
int unpack_run(const char *archive, const char *folder, uint64_t max_unpacked_bytes, uint64_t max_bytes);

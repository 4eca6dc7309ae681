#pragma once
/* --unpack: confines the process, unpacks, and says on standard output how far it is, one JSON object a line:
 * {"percent": 12.5}, and last {"done": true, "n_files": 12, "n_bytes": 345} or {"problem": {...}}. */
#include <stdint.h>

/* max_bytes: memory of its own, 0 UNPACK_MEMORY_BYTES. Returns the exit status: 0 done, 1 nobody reads what it says, 3
 * refused, or ended by SIGTERM, SIGINT or SIGHUP; the folder is empty then. */
int unpack_run(const char *archive, const char *folder, uint64_t max_unpacked_bytes, uint64_t max_bytes);

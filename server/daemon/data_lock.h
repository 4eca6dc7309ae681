#pragma once
/* One daemon for a state folder: two would each write what the other does not know of. */
#include "core/base/error.h"

/* Locks the folder itself until the process ends, however it ends: nothing is left behind. A file system without locks
 * is warned of in the log, and counts as locked. Programs that only read, as --backup, take no lock.
 *   errors  ERROR_STATE  another process has locked it
 *           ERROR_IO     it cannot be opened */
NODISCARD bool data_lock(const char *folder, struct error *err);

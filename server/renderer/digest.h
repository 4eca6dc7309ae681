#pragma once
/* The revision of a plan: a digest over the names and contents of its files. Opens no format. */
#include <stdint.h>

#include "server/wire/json.h"

struct plan_patient;

enum { DIGEST_MAX_FILES = 200000 };

/* {revision, key, n_files, n_bytes}, or {reason} when a file cannot be read.
 *
 *   revision  SHA-256, as 64 digits, over one line for each file, "<SHA-256 of it>  <path below the folder>\n", sorted
 * by the bytes of the paths: what `sha256sum` prints of them. Files and folders whose names begin with a dot do not
 * count, links count as what they lead to. key       another number whenever a file's path, size, time of change or
 * inode is another known     a key: when it is still the same nothing is read, and revision is left out; NULL: none
 * watch     NULL: nobody watches */
struct digest_watch {
    bool (*goes_on)(void *context, double percent); /* now and then while files are read; false: stop, {reason} */
    void *context;
};
NODISCARD cJSON *digest_folder(const char *folder, const char *known, const struct digest_watch *watch);
/* A digest, as 64 digits, over whom the patients are: of other ones, or in another order, it is another. */
void patients_seen(const struct plan_patient *patients, size_t n, char hex[65]);

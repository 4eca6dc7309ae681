#pragma once
/* Lists the plan folders on a thread of its own, so that a slow or dead disk holds up nothing else. */
#include "server/fleet/folders.h"

enum { LISTER_LEAVE_MS = 1000 /* at the end, a listing that takes longer is left behind with its thread */ };

typedef void (*lister_function)(const char *const *given, size_t n_given,
                                struct folder_list *list); /* folders_list, or a test's own */

struct lister;

/* folders is copied. wake: called on the lister's thread when a list is ready to be taken.
 *   errors ERROR_IO */
NODISCARD struct lister *lister_create(const char *const *folders, size_t n_folders, lister_function function,
                                       void (*wake)(void *context), void *context, struct error *err);
void lister_destroy(struct lister *lister);
/* Has the folders listed again, and returns the number of this request, from 1 on. Requests during a listing cause one
 * more listing. Never waits. */
uint64_t lister_request(struct lister *lister);
/* Takes the newest list; the caller calls folder_list_finish. number: of the newest request that was made before the
 * list was begun. Returns false when there is none since the last call. */
NODISCARD bool lister_take(struct lister *lister, struct folder_list *list, uint64_t *number);

#pragma once
/* Lists the plan folders on a thread of its own: a slow or dead disk holds up nothing else. */
#include "server/fleet/folders.h"

enum { LISTER_LEAVE_MS = 1000 /* a listing that is not done by then at the end is left behind with its thread */ };

typedef void (*lister_function)(const char *const *given, size_t n_given,
                                struct folder_list *list); /* folders_list, or a test's own */

struct lister;

/* folders are copied. wake: any thread, a list is ready to be taken.
 *   errors ERROR_IO */
NODISCARD struct lister *lister_create(const char *const *folders, size_t n_folders, lister_function function,
                                       void (*wake)(void *context), void *context, struct error *err);
void lister_destroy(struct lister *lister);
/* Lists again; called several times while a listing runs, one more follows. Never waits. */
void lister_request(struct lister *lister);
/* The newest list: folder_list_finish is the caller's; false when there is none since the last call. */
NODISCARD bool lister_take(struct lister *lister, struct folder_list *list);

#pragma once
/* Removes folders with all their contents, on a thread of its own: a plan may have ten thousand files. Knows nothing of
 * plans. */
#include "core/base/error.h"

enum { REMOVER_MAX_WAITING = 4096 };

struct remover;
NODISCARD struct remover *remover_create(struct error *err);
/* Stops at the next file: files not removed by then stay. */
void remover_destroy(struct remover *remover);
/* Takes path, a file or folder that nobody else uses. Links are removed, not followed. Any thread; never waits. */
void remover_put(struct remover *remover, char *path);
bool remover_is_idle(const struct remover *remover); /* all that it was given is gone, or was given up with a warning */

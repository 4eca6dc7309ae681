#pragma once
/* Removes folders with all that is in them, on a thread of its own: a plan may have ten thousand files. Knows nothing
 * of plans. */
#include "core/base/error.h"

enum { REMOVER_MAX_WAITING = 4096 };

struct remover;
NODISCARD struct remover *remover_create(struct error *err);
/* Ends soon: what is not removed by then stays where it is. */
void remover_destroy(struct remover *remover);
/* Takes path: a file, or a folder that nobody else looks into any more. Links are removed, not followed. Any thread. */
void remover_put(struct remover *remover, char *path);

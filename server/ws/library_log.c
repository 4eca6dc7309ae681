/* Passes lines of the library on. */
#include "server/ws/library_log.h"

#include <libwebsockets.h>
#include <string.h>

#include "core/base/log.h"

static void log_library(int level, const char *line)
{
    const int n = (int)strcspn(line, "\n");
    if (level & LLL_ERR)
        log_warn("libwebsockets: %.*s", n, line);
    else
        log_debug("libwebsockets: %.*s", n, line);
}

void library_log_start(void)
{
    lws_set_log_level(LLL_ERR | LLL_WARN, log_library);
}

/* Passes lines of the library on, and tells descriptors apart by their inodes. */
#include "server/ws/library.h"

#include <libwebsockets.h>
#include <string.h>
#include <unistd.h>

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

void library_close_refused(int fd, const struct stat *before)
{
    struct stat now;
    if (fstat(fd, &now) == 0 && now.st_ino == before->st_ino && now.st_dev == before->st_dev)
        (void)close(fd);
}

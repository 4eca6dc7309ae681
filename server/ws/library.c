/* Passes lines of the library on, and tells descriptors apart by their inodes. */
#define _GNU_SOURCE /* AT_EMPTY_PATH */
#include "server/ws/library.h"

#include <fcntl.h>
#include <libwebsockets.h>
#include <limits.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
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

int library_places(void)
{
    struct rlimit allowed;
    return getrlimit(RLIMIT_NOFILE, &allowed) != 0 || allowed.rlim_cur > INT_MAX ? INT_MAX : (int)allowed.rlim_cur;
}

/* The library has closed some of those that it did not adopt itself, and others not. before: the descriptor's facts
 * from then, as another thread may have been given the number since. fstatat: for fstat the thread sanitizer takes the
 * descriptor of that thread as shared. */
static void close_refused(int fd, const struct stat *before)
{
    struct stat now;
    if (fstatat(fd, "", &now, AT_EMPTY_PATH) == 0 && now.st_ino == before->st_ino && now.st_dev == before->st_dev)
        (void)close(fd);
}

struct lws *library_adopt(struct lws_vhost *vhost, int n_places, int options, int fd, const char *protocol)
{
    const lws_sock_file_fd_type one = { .sockfd = fd };
    struct stat facts = { 0 };
    if (fd >= n_places) {
        (void)close(fd);
        return NULL;
    }
    (void)fstat(fd, &facts);
    struct lws *lws = lws_adopt_descriptor_vhost(vhost, (lws_adoption_type)options, one, protocol, NULL);
    if (!lws)
        close_refused(fd, &facts);
    return lws;
}

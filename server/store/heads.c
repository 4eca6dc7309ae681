/* Reads and writes the file beside the database. */
#include "server/store/heads.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "core/base/log.h"
#include "server/store/database.h"

enum { LINE = 20 + 1 + 64 + 1 };

static int open_file(const char *database, int flags)
{
    char path[DATABASE_PATH_SIZE + 16];
    (void)snprintf(path, sizeof path, "%s-audit", database);
    return open(path, flags | O_CLOEXEC | O_NOFOLLOW, 0600);
}

void heads_read(const char *database, struct audit_head *head)
{
    char line[LINE + 1] = "", hash[STORE_AUDIT_HASH] = "";
    long long n = 0;
    const int fd = open_file(database, O_RDONLY);
    *head = (struct audit_head){ 0 };
    if (fd < 0)
        return;
    const ssize_t n_read = pread(fd, line, LINE, 0);
    (void)close(fd);
    if (n_read != LINE || sscanf(line, "%20lld %64[0-9a-f]", &n, hash) != 2 || n < 0 || strlen(hash) != 64)
        return;
    head->n = n;
    memcpy(head->hash, hash, sizeof hash);
}

void heads_write(const char *database, const struct audit_head *head)
{
    static bool has_failed;
    char line[LINE + 1];
    const int fd = open_file(database, O_WRONLY | O_CREAT);
    (void)snprintf(line, sizeof line, "%020lld %s\n", (long long)head->n, head->hash);
    if ((fd < 0 || pwrite(fd, line, LINE, 0) != LINE) && !has_failed) {
        has_failed = true; /* said once: the audit itself is whole */
        log_error("%s-audit: the newest row of the audit cannot be noted: %s", database, strerror(errno));
    }
    if (fd >= 0)
        (void)close(fd);
}

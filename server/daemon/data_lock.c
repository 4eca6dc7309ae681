/* Locks the state folder. */
#include "server/daemon/data_lock.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/base/log.h"

bool data_lock(const char *folder, struct error *err)
{
    int fd = open(folder, O_RDONLY | O_DIRECTORY | O_CLOEXEC); /* never closed: that would unlock it */
    if (fd < 0)
        return error_set(err, ERROR_IO, "--data %.150s: %s", folder, strerror(errno));
    if (flock(fd, LOCK_EX | LOCK_NB) == 0)
        return true;
    const int why = errno;
    (void)close(fd);
    if (why == EWOULDBLOCK)
        return error_set(err, ERROR_STATE,
                         "--data %.150s: another beamroomd uses this folder; stop that one, or name another folder",
                         folder);
    log_warn("--data %.150s cannot be locked (%s): see that no other beamroomd uses it", folder, strerror(why));
    return true;
}

/* Filling closed standard descriptors from /dev/null. */
#include "core/base/standard_files.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

void standard_files_fill(void)
{
    for (int fd = 0; fd <= 2; fd++)
        if (fcntl(fd, F_GETFD) < 0 &&
            open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY) != fd) /* the lowest that is free */
            abort();
}

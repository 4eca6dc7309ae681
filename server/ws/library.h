#pragma once
/* libwebsockets as a whole: its log, which is one for the process, and descriptors that it does not take. */
#include <sys/stat.h>

/* Before its first call; once or more often. Its errors are our warnings, its warnings ours to debug with. */
void library_log_start(void);
/* Closes a descriptor that the library did not adopt: it has closed some of those itself, and others not. before: its
 * facts from then, as another thread may have been given the number since. */
void library_close_refused(int fd, const struct stat *before);

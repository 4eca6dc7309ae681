#pragma once
/* libwebsockets as a whole: its log, which is one for the process, and descriptors that it does or does not take. */

struct lws;
struct lws_vhost;

/* Before its first call; once or more often. Its errors are our warnings, its warnings ours to debug with. */
void library_log_start(void);
/* Descriptors below this have a place in the table of a context that is created now (with fd_limit_per_thread 0): as
 * many as this process may have. */
int library_places(void);
/* Gives a descriptor to the library. NULL: it was not taken, and is closed. n_places: of the vhost's context; for a
 * higher descriptor, as when more were allowed since, the library writes past its table. options: LWS_ADOPT_... */
struct lws *library_adopt(struct lws_vhost *vhost, int n_places, int options, int fd, const char *protocol);

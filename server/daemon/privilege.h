#pragma once
/* Started as root, the daemon becomes an ordinary user before it serves anything; so its renderers run as that user,
 * too. Linux only; to be called before any thread is started. */
#include <stddef.h>

#include "core/base/error.h"

enum { PRIVILEGE_MAX_PLACES = 80 };

/* A path that the daemon needs as the user it becomes. */
struct privilege_place {
    const char *flag; /* the setting it comes from, "--plans" */
    char *path; /* allocated; replaced by a path relative to the working folder when only that one can be reached */
    int mode;   /* R_OK, W_OK, X_OK as in access(2); F_OK: a folder that is given to the user */
};

struct privilege_options {
    const char *user;        /* NULL: "beamroom" where there is one, else "nobody"; "root": stay root */
    const char *data_folder; /* one of the places. When root owns it and it holds only the daemon's folders, it is given
                                to the user with them */
    int port;                /* below 1024: CAP_NET_BIND_SERVICE is kept, and no other capability */
    struct privilege_place *places;
    size_t n_places;
};

/* Does nothing when the daemon was not started by root. When no user is named and the default user cannot reach a
 * place, the daemon stays root and logs why.
 *
 *   errors   ERROR_NOT_FOUND  no such user
 *            ERROR_IO         the named user cannot reach a place, or does not own the data folder */
NODISCARD bool privilege_give_up(const struct privilege_options *options, struct error *err);

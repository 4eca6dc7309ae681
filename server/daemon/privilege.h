#pragma once
/* Started as root, the daemon gives that up for an ordinary user before it serves anything; so its renderers are that
 * user's, too. Linux only; one thread, before any other starts. */
#include <stddef.h>

#include "core/base/error.h"

enum { PRIVILEGE_MAX_PLACES = 80 };

/* A place the daemon needs as the user it becomes. */
struct privilege_place {
    const char *flag; /* as people know it, "--plans" */
    char *path;       /* of malloc; replaced by one relative to the working folder where only that one can be reached */
    int mode;         /* R_OK, W_OK, X_OK as for access(); F_OK for a folder that is given to the user */
};

struct privilege_options {
    const char *user;        /* NULL: "beamroom" where there is one, else "nobody"; "root": stay root */
    const char *data_folder; /* given to the user with what is ours in it, when it is root's and holds nothing else; one
                                of the places */
    int port;                /* below 1024 the right to listen there is kept, and no other */
    struct privilege_place *places;
    size_t n_places;
};

/* Does nothing when not started by root. With no user named, and a place that the user could not reach, the daemon
 * stays root and says so. errors ERROR_NOT_FOUND no such user; ERROR_IO a place the named user cannot reach, or data
 * folder that is not his */
NODISCARD bool privilege_give_up(const struct privilege_options *options, struct error *err);

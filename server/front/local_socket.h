#pragma once
/* A Unix socket that a proxy in front connects to: from the text of --listen to the user of each peer. */
#include <stdbool.h>
#include <sys/types.h>

#include "core/base/error.h"

enum { LOCAL_SOCKET_MAX_PATH = 107, LOCAL_SOCKET_MAX_GROUP = 64 };

struct local_socket {
    char path[LOCAL_SOCKET_MAX_PATH + 1];
    char group[LOCAL_SOCKET_MAX_GROUP + 1]; /* who may connect beside the daemon's user; "": the daemon's own group */
    mode_t mode;
    bool is_control; /* not for a proxy: whoever runs as the daemon's user or root is the administrator there */
    dev_t device;    /* of the file, once it is open: so that no other one is removed */
    ino_t number;
};

/* The proxy's user or group; a name may be both. */
struct local_peers {
    bool has_user, has_group;
    uid_t user;
    gid_t group;
};

struct local_process { /* at the other end of a connection */
    uid_t user;
    gid_t group;
};

bool local_socket_is_meant(const char *listen); /* it begins with unix: */
/* Reads "unix:/run/beamroom/http.sock,group=www-data,mode=0660"; group and mode may be left away (0660). The path is
 * absolute and has no comma. errors ERROR_FORMAT */
NODISCARD bool local_socket_read(const char *listen, struct local_socket *local, struct error *err);
/* Listens; replaces the file of a daemon that has ended. The socket does not block. -1: errors ERROR_NOT_FOUND (no such
 * group), ERROR_IO (another process listens there; it is another kind of file; the system refuses) */
NODISCARD int local_socket_open(struct local_socket *local, struct error *err);
void local_socket_remove(const struct local_socket *local); /* the file, before the socket is closed */

/* Finds the user or group of this name. errors ERROR_NOT_FOUND */
NODISCARD bool local_peers_find(const char *name, struct local_peers *peers, struct error *err);
/* True if the process that connected runs as that user, or with that group as its own. found: what it runs as. */
bool local_peers_have(const struct local_peers *peers, int socket, struct local_process *found);
/* True if it runs as the daemon's user or as root. */
bool local_peers_are_own(int socket, struct local_process *found);

#define _GNU_SOURCE
/* Opens a Unix socket, and asks the system who is at its other end. */
#include "server/front/local_socket.h"

#include <errno.h>
#include <grp.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

static const char before[] = "unix:";

enum { N_BEFORE = sizeof before - 1, BACKLOG = 4096, USUAL_MODE = 0660 };

_Static_assert(LOCAL_SOCKET_MAX_PATH + 1 == sizeof((struct sockaddr_un *)NULL)->sun_path, "what the system takes");

bool local_socket_is_meant(const char *listen)
{
    return strncmp(listen, before, N_BEFORE) == 0;
}

static bool refuse(const char *listen, const char *why, struct error *err)
{
    return error_set(err, ERROR_FORMAT, "--listen %.120s: %s; expected unix:/PATH[,group=NAME][,mode=0660]", listen,
                     why);
}

/* One of group=NAME and mode=OCTAL, n bytes. */
static bool read_part(const char *part, size_t n, struct local_socket *local)
{
    if (n > 6 && n - 6 <= LOCAL_SOCKET_MAX_GROUP && strncmp(part, "group=", 6) == 0) {
        (void)snprintf(local->group, sizeof local->group, "%.*s", (int)(n - 6), part + 6);
        return true;
    }
    if (n < 6 || n > 9 || strncmp(part, "mode=", 5) != 0)
        return false;
    char *end;
    local->mode = (mode_t)strtoul(part + 5, &end, 8);
    return end == part + n && part[5] >= '0' && part[5] <= '7' && local->mode <= 0777;
}

bool local_socket_read(const char *listen, struct local_socket *local, struct error *err)
{
    const char *path = listen + N_BEFORE, *at = path + strcspn(path, ",");
    *local = (struct local_socket){ .mode = USUAL_MODE };
    if (!local_socket_is_meant(listen) || path[0] != '/')
        return refuse(listen, "no absolute path", err);
    if (at - path > LOCAL_SOCKET_MAX_PATH)
        return refuse(listen, "a path of more than 107 bytes", err);
    (void)snprintf(local->path, sizeof local->path, "%.*s", (int)(at - path), path);
    while (*at) {
        const char *part = at + 1;
        at = part + strcspn(part, ",");
        if (!read_part(part, (size_t)(at - part), local))
            return refuse(listen, "neither a group nor a mode behind the comma", err);
    }
    return true;
}

static bool refuse_file(const struct local_socket *local, const char *why, struct error *err)
{
    return error_set(err, ERROR_IO, "--listen unix:%.107s: %s", local->path, why);
}

/* Removes the socket of a daemon that has ended. */
static bool make_place(const struct local_socket *local, const struct sockaddr_un *address, struct error *err)
{
    struct stat facts;
    if (lstat(local->path, &facts) != 0)
        return errno == ENOENT || refuse_file(local, strerror(errno), err);
    if (!S_ISSOCK(facts.st_mode))
        return refuse_file(local, "a file that is no socket is there", err);
    int tried = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    bool is_dead =
        tried >= 0 && connect(tried, (const struct sockaddr *)address, sizeof *address) != 0 && errno == ECONNREFUSED;
    if (tried >= 0)
        (void)close(tried);
    if (!is_dead)
        return refuse_file(local, "another process listens there", err);
    return unlink(local->path) == 0 || refuse_file(local, strerror(errno), err);
}

static bool give(struct local_socket *local, struct error *err)
{
    struct stat facts;
    const struct group *group = local->group[0] ? getgrnam(local->group) : NULL;
    if (local->group[0] && !group)
        return error_set(err, ERROR_NOT_FOUND, "--listen unix:%.107s: there is no group %.64s", local->path,
                         local->group);
    if (group && chown(local->path, (uid_t)-1, group->gr_gid) != 0)
        return error_set(err, ERROR_IO, "--listen unix:%.107s cannot be given to group %.64s: %s", local->path,
                         local->group, strerror(errno));
    if (chmod(local->path, local->mode) != 0 || lstat(local->path, &facts) != 0)
        return refuse_file(local, strerror(errno), err);
    local->device = facts.st_dev;
    local->number = facts.st_ino;
    return true;
}

int local_socket_open(struct local_socket *local, struct error *err)
{
    struct sockaddr_un address = { .sun_family = AF_UNIX };
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", local->path);
    if (!make_place(local, &address, err))
        return -1;
    int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    const bool is_bound = listener >= 0 && bind(listener, (struct sockaddr *)&address, sizeof address) == 0;
    if (!is_bound)
        (void)refuse_file(local, strerror(errno), err);
    if (is_bound && give(local, err)) { /* before listen(2) nobody can connect */
        if (listen(listener, BACKLOG) == 0)
            return listener;
        (void)refuse_file(local, strerror(errno), err);
    }
    if (listener >= 0)
        (void)close(listener);
    if (is_bound)
        (void)unlink(local->path);
    return -1;
}

void local_socket_remove(const struct local_socket *local)
{
    struct stat facts;
    if (lstat(local->path, &facts) == 0 && facts.st_dev == local->device && facts.st_ino == local->number)
        (void)unlink(local->path);
}

bool local_peers_find(const char *name, struct local_peers *peers, struct error *err)
{
    *peers = (struct local_peers){ 0 };
    const struct passwd *user = getpwnam(name);
    if (user) {
        peers->has_user = true;
        peers->user = user->pw_uid;
    }
    const struct group *group = getgrnam(name);
    if (group) {
        peers->has_group = true;
        peers->group = group->gr_gid;
    }
    return user || group ||
           error_set(err, ERROR_NOT_FOUND, "--proxy-user %.64s: there is neither such a user nor such a group", name);
}

static bool find_process(int socket, struct local_process *found)
{
    struct ucred ids;
    socklen_t n = sizeof ids;
    *found = (struct local_process){ (uid_t)-1, (gid_t)-1 };
    if (getsockopt(socket, SOL_SOCKET, SO_PEERCRED, &ids, &n) != 0)
        return false;
    *found = (struct local_process){ ids.uid, ids.gid };
    return true;
}

bool local_peers_have(const struct local_peers *peers, int socket, struct local_process *found)
{
    return find_process(socket, found) &&
           ((peers->has_user && found->user == peers->user) || (peers->has_group && found->group == peers->group));
}

bool local_peers_are_own(int socket, struct local_process *found)
{
    return find_process(socket, found) && (found->user == 0 || found->user == geteuid());
}

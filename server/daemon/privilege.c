/* Finds a user who can reach all paths, gives the data folder to that user, and becomes that user. */
#define _GNU_SOURCE
#include "server/daemon/privilege.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <grp.h>
#include <limits.h>
#include <linux/capability.h>
#include <pwd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"

enum {
    MAX_GROUPS = 64,
    MAX_DEPTH = 64 /* nested folders of the data folder that are given; deeper ones stay as they are */
};

struct user {
    char name[64];
    uid_t uid;
    gid_t gid;
    gid_t groups[MAX_GROUPS];
    int n_groups;
};

enum reach { REACH_NOT, REACH_AS_GIVEN, REACH_FROM_HERE };

static void add_group(struct user *user, const char *name)
{
    const struct group *group = getgrnam(name);
    if (group && user->n_groups < MAX_GROUPS)
        user->groups[user->n_groups++] = group->gr_gid;
}

/* Fills in the user's ids and groups, and the groups that graphics cards belong to. */
static bool find_user(const char *name, struct user *user)
{
    const struct passwd *entry = getpwnam(name);
    if (!entry)
        return false;
    *user = (struct user){ .uid = entry->pw_uid, .gid = entry->pw_gid, .n_groups = MAX_GROUPS - 2 };
    (void)snprintf(user->name, sizeof user->name, "%s", name);
    if (getgrouplist(name, entry->pw_gid, user->groups, &user->n_groups) < 0)
        user->n_groups = 0;
    add_group(user, "video");
    add_group(user, "render");
    return true;
}

static bool become(const struct user *user)
{
    return setgroups((size_t)user->n_groups, user->groups) == 0 && setresgid(user->gid, user->gid, user->gid) == 0 &&
           setresuid(user->uid, user->uid, user->uid) == 0;
}

/* ---- what the user can reach ------------------------------------------------------------------------------------ */

static bool is_reached(const char *path, int mode)
{
    struct stat facts;
    return mode == F_OK ? stat(path, &facts) == 0 : access(path, mode) == 0;
}

/* The path relative to the working folder, when it lies inside; else NULL. A process can reach names below its working
 * folder without access to the folders above it. */
static const char *from_here(const char *path, const char *here)
{
    size_t n = strlen(here);
    if (n > 1 && strncmp(path, here, n) == 0 && path[n] == '/' && path[n + 1])
        return path + n + 1;
    return NULL;
}

/* Tests in a child process, which becomes the user, how each place can be reached. Returns false when the child failed.
 */
static bool try_as(const struct user *user, const struct privilege_options *options, const char *here,
                   enum reach reached[])
{
    int ends[2];
    unsigned char found[PRIVILEGE_MAX_PLACES] = { 0 };
    if (pipe(ends) != 0)
        return false;
    pid_t child = fork();
    if (child == 0) {
        if (!become(user))
            _exit(1);
        for (size_t i = 0; i < options->n_places; i++) {
            const struct privilege_place *place = &options->places[i];
            const char *inside = from_here(place->path, here);
            found[i] = is_reached(place->path, place->mode)        ? REACH_AS_GIVEN
                       : inside && is_reached(inside, place->mode) ? REACH_FROM_HERE
                                                                   : REACH_NOT;
        }
        _exit(write(ends[1], found, options->n_places) == (ssize_t)options->n_places ? 0 : 1);
    }
    int status = 1;
    close(ends[1]);
    bool is_told = child > 0 && read(ends[0], found, options->n_places) == (ssize_t)options->n_places;
    close(ends[0]);
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR)
        continue;
    for (size_t i = 0; i < options->n_places; i++)
        reached[i] = (enum reach)found[i];
    return is_told && status == 0;
}

/* ---- the data folder -------------------------------------------------------------------------------------------- */

static bool is_ours(const char *name)
{
    static const char *const names[] = { ".", "..", "plans", "cache", "uploads" };
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

/* True if the user owns the folder, or root owns it and it holds only the daemon's own folders: a folder with other
 * things in it was not meant to be given away. */
static bool may_give(const char *folder, const struct user *user, struct error *err)
{
    struct stat facts;
    if (stat(folder, &facts) != 0)
        return error_set(err, ERROR_IO, "--data %.150s: %s", folder, strerror(errno));
    if (facts.st_uid == user->uid)
        return true;
    if (facts.st_uid != 0)
        return error_set(err, ERROR_IO, "--data %.150s belongs to neither root nor user %s", folder, user->name);
    DIR *entries = opendir(folder);
    if (!entries)
        return error_set(err, ERROR_IO, "--data %.150s: %s", folder, strerror(errno));
    char other[64] = "";
    for (const struct dirent *entry; !other[0] && (entry = readdir(entries));)
        if (!is_ours(entry->d_name))
            (void)snprintf(other, sizeof other, "%.60s", entry->d_name);
    closedir(entries);
    return !other[0] ||
           error_set(err, ERROR_IO,
                     "--data %.120s belongs to root and holds other things (%.40s): it is not given to user %s", folder,
                     other, user->name);
}

/* Gives what root owns below the folder to the user. Works on descriptors, because another process of that user may put
 * a link in the place of any folder meanwhile. Consumes the descriptor. */
static bool give_opened(int folder, int depth, const struct user *user)
{
    struct stat facts;
    DIR *names = fdopendir(folder);
    bool is_given = names != NULL;
    if (!names)
        close(folder);
    for (const struct dirent *name; is_given && (name = readdir(names));) {
        if (strcmp(name->d_name, ".") == 0 || strcmp(name->d_name, "..") == 0 || (depth == 0 && !is_ours(name->d_name)))
            continue;
        int inner = openat(folder, name->d_name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
        if (inner >= 0 && depth < MAX_DEPTH) {
            is_given = give_opened(inner, depth + 1, user);
            continue;
        }
        if (inner >= 0)
            close(inner);
        /* Checks and gives the same descriptor. A file with a second link is left as it is: the link may lie elsewhere.
         */
        int thing = openat(folder, name->d_name, O_PATH | O_NOFOLLOW | O_CLOEXEC);
        if (thing < 0 || fstat(thing, &facts) != 0)
            is_given = errno == ENOENT;
        else if (facts.st_uid == 0 && (S_ISDIR(facts.st_mode) || facts.st_nlink == 1))
            is_given = fchownat(thing, "", user->uid, user->gid, AT_EMPTY_PATH) == 0;
        if (thing >= 0)
            close(thing);
    }
    if (is_given && fstat(folder, &facts) == 0 && facts.st_uid == 0)
        is_given = fchown(folder, user->uid, user->gid) == 0;
    int reason = errno;
    if (names)
        closedir(names);
    errno = reason;
    return is_given;
}

/* Gives the user what an earlier daemon wrote as root, also in a folder that the user owns already. Links inside are
 * not followed. */
static bool give_folder(const char *folder, const struct user *user, struct error *err)
{
    int top = open(folder, O_RDONLY | O_DIRECTORY |
                               O_CLOEXEC); /* the path may be a link: the person who started the daemon gave it */
    return (top >= 0 && give_opened(top, 0, user)) ||
           error_set(err, ERROR_IO, "--data %.120s cannot be given to user %s: %s", folder, user->name,
                     strerror(errno));
}

/* ---- giving it up ----------------------------------------------------------------------------------------------- */

/* Drops all capabilities but, for a port below 1024, CAP_NET_BIND_SERVICE. */
static bool drop_capabilities(int port)
{
    struct __user_cap_header_struct header = { .version = _LINUX_CAPABILITY_VERSION_3, .pid = 0 };
    struct __user_cap_data_struct sets[2] = { 0 };
    if (port > 0 && port < 1024)
        sets[0].effective = sets[0].permitted = 1U << CAP_NET_BIND_SERVICE;
    return syscall(SYS_capset, &header, sets) == 0;
}

static bool switch_to(const struct user *user, int port, struct error *err)
{
    bool wants_port = port > 0 && port < 1024;
    for (unsigned long capability = 0; capability < 64; capability++)
        if (!wants_port || capability != CAP_NET_BIND_SERVICE)
            (void)prctl(PR_CAPBSET_DROP, capability, 0, 0,
                        0); /* fails in a container without CAP_SETPCAP: then there is less to drop */
    if (wants_port)
        (void)prctl(PR_SET_KEEPCAPS, 1, 0, 0, 0);
    if (!become(user) || !drop_capabilities(port) || setuid(0) == 0 || geteuid() != user->uid)
        return error_set(err, ERROR_IO, "the daemon cannot become user %s: %s", user->name, strerror(errno));
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 ||
           error_set(err, ERROR_IO, "new privileges cannot be refused: %s", strerror(errno));
}

static bool can_be(const struct user *user, const struct privilege_options *options, const char *here,
                   enum reach reached[], struct error *err)
{
    if (!may_give(options->data_folder, user, err))
        return false;
    if (!try_as(user, options, here, reached))
        return error_set(err, ERROR_IO, "nobody can become user %s here", user->name);
    for (size_t i = 0; i < options->n_places; i++) {
        const struct privilege_place *place = &options->places[i];
        if (reached[i] == REACH_NOT &&
            is_reached(place->path,
                       place->mode)) /* a place that root cannot reach either is reported where it is used */
            return error_set(err, ERROR_IO, "user %s cannot reach %s %.140s", user->name, place->flag, place->path);
    }
    return true;
}

bool privilege_give_up(const struct privilege_options *options, struct error *err)
{
    struct user user;
    struct error reason = { 0 };
    enum reach reached[PRIVILEGE_MAX_PLACES] = { REACH_NOT };
    char here[PATH_MAX] = "";
    if (geteuid() != 0)
        return true;
    if (options->user && strcmp(options->user, "root") == 0) {
        log_warn(
            "running as root, as --user root asks: plans are read and archives unpacked as root, without its capabilities");
        return true;
    }
    if (options->user ? !find_user(options->user, &user) : !find_user("beamroom", &user) && !find_user("nobody", &user))
        return error_set(err, ERROR_NOT_FOUND, "there is no user %.40s to run as",
                         options->user ? options->user : "beamroom or nobody");
    if (!getcwd(here, sizeof here))
        here[0] = 0;
    if (!can_be(&user, options, here, reached, &reason) || !give_folder(options->data_folder, &user, &reason)) {
        if (options->user) {
            error_set(err, reason.code, "%s; let him, or say --user root", reason.text);
            return false;
        }
        log_warn("staying root: %s; let him, or name another by --user; renderers run as root without its capabilities",
                 reason.text);
        return true;
    }
    if (!switch_to(&user, options->port, err))
        return false;
    for (size_t i = 0; i < options->n_places; i++)
        if (reached[i] == REACH_FROM_HERE) {
            char *inside = mem_copy_text(from_here(options->places[i].path, here));
            free(options->places[i].path);
            options->places[i].path = inside;
        }
    log_info("running as user %s", user.name);
    return true;
}

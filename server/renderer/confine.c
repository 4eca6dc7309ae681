/* Landlock rules, resource limits and capabilities of a renderer process. */
#define _GNU_SOURCE
#include "server/renderer/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <linux/landlock.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "server/renderer/seccomp.h"

/* Rights added after Landlock version 1, with the version; older kernel headers lack the names. Source: kernel
 * documentation, userspace-api/landlock. */
#define FS_REFER (UINT64_C(1) << 13)     /* 2 */
#define FS_TRUNCATE (UINT64_C(1) << 14)  /* 3 */
#define FS_IOCTL_DEV (UINT64_C(1) << 15) /* 5 */
#define NET_ALL UINT64_C(3)              /* 4: bind and connect TCP */
#define SCOPE_ALL UINT64_C(3)            /* 6: abstract sockets, signals */
#define FS_FIRST ((UINT64_C(1) << 13) - 1)
#define FS_READ (LANDLOCK_ACCESS_FS_READ_FILE | LANDLOCK_ACCESS_FS_READ_DIR)
#define FS_RUN (FS_READ | LANDLOCK_ACCESS_FS_EXECUTE)
#define FS_DEVICE (FS_READ | LANDLOCK_ACCESS_FS_WRITE_FILE | FS_IOCTL_DEV)
#define FS_UNPACK \
    (FS_READ | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_MAKE_REG | LANDLOCK_ACCESS_FS_MAKE_DIR | \
     LANDLOCK_ACCESS_FS_REMOVE_FILE | LANDLOCK_ACCESS_FS_REMOVE_DIR | FS_REFER)

struct ruleset { /* struct landlock_ruleset_attr of the newest kernels */
    uint64_t fs, net, scoped;
};

static const struct allowed_path {
    const char *path;
    uint64_t rights;
    bool is_gpu; /* only with needs_gpu */
} allowed_paths[] = {
    { "/usr", FS_RUN, false },
    { "/lib", FS_RUN, false },
    { "/lib64", FS_RUN, false },
    { "/opt", FS_RUN, true },
    { "/etc/ld.so.cache", FS_READ, false },
    { "/etc/ld.so.conf", FS_READ, false },
    { "/etc/ld.so.conf.d", FS_READ, false },
    { "/etc/localtime", FS_READ, false },
    { "/etc/glvnd", FS_READ, false },
    { "/etc/fonts", FS_READ, false },
    { "/var/cache/fontconfig", FS_READ, false },
    { "/etc/drirc", FS_READ, false },
    { "/dev/null", FS_READ | LANDLOCK_ACCESS_FS_WRITE_FILE, false },
    { "/dev/zero", FS_READ, false },
    { "/dev/urandom", FS_READ, false },
    { "/proc/self", FS_READ, false },
    { "/proc/cpuinfo", FS_READ, false },
    { "/proc/meminfo", FS_READ, false },
    { "/sys/devices/system/cpu", FS_READ, false },
    { "/sys/kernel/mm/transparent_hugepage", FS_READ, false },
    { "/sys", FS_READ, true },
    { "/proc/driver", FS_READ, true },
    { "/proc/devices", FS_READ, true },
    { "/proc/modules", FS_READ, true },
    { "/proc/sys/vm", FS_READ, true },
    { "/run/nvidia-persistenced", FS_READ, true },
    { "/dev/dri", FS_DEVICE, true },
    { "/dev/nvidiactl", FS_DEVICE, true },
    { "/dev/nvidia-modeset", FS_DEVICE, true },
    { "/dev/nvidia-uvm", FS_DEVICE, true },
    { "/dev/nvidia-uvm-tools", FS_DEVICE, true },
    { "/dev/nvidia-caps", FS_DEVICE, true },
    { "/dev/kfd", FS_DEVICE, true },
};

/* The rights that a rule on a file, not a folder, may have. */
#define FS_OF_FILES \
    (LANDLOCK_ACCESS_FS_EXECUTE | LANDLOCK_ACCESS_FS_WRITE_FILE | LANDLOCK_ACCESS_FS_READ_FILE | FS_TRUNCATE | \
     FS_IOCTL_DEV)

static void allow(int rules, const char *path, uint64_t rights)
{
    int file = open(path, O_PATH | O_CLOEXEC);
    struct stat facts;
    if (file < 0)
        return; /* not on this machine */
    if (fstat(file, &facts) == 0 && !S_ISDIR(facts.st_mode))
        rights &= FS_OF_FILES;
    struct landlock_path_beneath_attr rule = { .allowed_access = rights, .parent_fd = file };
    (void)syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
    close(file);
}

/* Returns the Landlock version in force, or -1 with errno. */
static long restrict_files(const struct confine_options *options)
{
    long version = syscall(SYS_landlock_create_ruleset, NULL, 0, LANDLOCK_CREATE_RULESET_VERSION);
    if (version < 1)
        return -1;
    uint64_t known =
        FS_FIRST | (version >= 2 ? FS_REFER : 0) | (version >= 3 ? FS_TRUNCATE : 0) | (version >= 5 ? FS_IOCTL_DEV : 0);
    struct ruleset attributes = { known, version >= 4 ? NET_ALL : 0, version >= 6 ? SCOPE_ALL : 0 };
    size_t size = version >= 6 ? sizeof attributes : version >= 4 ? 2 * sizeof attributes.fs : sizeof attributes.fs;
    int rules = (int)syscall(SYS_landlock_create_ruleset, &attributes, size, 0);
    if (rules < 0)
        return -1;
    for (size_t i = 0; i < sizeof allowed_paths / sizeof *allowed_paths; i++)
        if (!allowed_paths[i].is_gpu || options->needs_gpu)
            allow(rules, allowed_paths[i].path, allowed_paths[i].rights & known);
    for (int i = 0; options->needs_gpu && i < 16; i++) {
        char path[32];
        (void)snprintf(path, sizeof path, "/dev/nvidia%d", i);
        allow(rules, path, FS_DEVICE & known);
    }
    if (options->plan_folder)
        allow(rules, options->plan_folder, FS_READ);
    if (options->cache_folder)
        allow(rules, options->cache_folder, (FS_UNPACK | FS_TRUNCATE) & known);
    if (options->unpack_folder)
        allow(rules, options->unpack_folder, FS_UNPACK & known);
    long failed = syscall(SYS_landlock_restrict_self, rules, 0);
    int reason = errno;
    close(rules);
    errno = reason;
    return failed ? -1 : version;
}

/* Drops all capabilities, for this process and every program it could start. True when none is left. Only a process
 * with CAP_SETPCAP can lower its bounding set; without capabilities the bounding set does not matter. */
static bool drop_capabilities(void)
{
    struct __user_cap_header_struct header = { .version = _LINUX_CAPABILITY_VERSION_3, .pid = 0 };
    struct __user_cap_data_struct sets[2] = { 0 };
    for (unsigned long capability = 0; capability < 64; capability++)
        (void)prctl(PR_CAPBSET_DROP, capability, 0, 0, 0);
    (void)prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
    return syscall(SYS_capset, &header, sets) == 0 ||
           (syscall(SYS_capget, &header, sets) == 0 &&
            (sets[0].permitted | sets[1].permitted | sets[0].inheritable | sets[1].inheritable) == 0);
}

static void limit(int resource, rlim_t most)
{
    struct rlimit now;
    if (getrlimit((__rlimit_resource_t)resource, &now) != 0)
        return;
    if (now.rlim_max != RLIM_INFINITY && now.rlim_max < most)
        most = now.rlim_max;
    (void)setrlimit((__rlimit_resource_t)resource, &(struct rlimit){ most, most });
}

void confine(const struct confine_options *options, char got[128])
{
    char files[40], calls[40];
    bool is_bare = drop_capabilities();
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_NOFILE, 1024);
    if (options->max_file_bytes > 0) {
        (void)signal(SIGXFSZ, SIG_IGN); /* the write fails with EFBIG instead, which the caller reports */
        limit(RLIMIT_FSIZE, (rlim_t)options->max_file_bytes);
    }
    if (options->cpu_seconds > 0)
        limit(RLIMIT_CPU, (rlim_t)options->cpu_seconds);
    if (!SECCOMP_IS_RELAXED) { /* sanitizers map terabytes, and trace their own process */
        /* RLIMIT_DATA, not RLIMIT_AS: graphics drivers reserve far more address space than they use */
        if (options->max_bytes > 0)
            limit(RLIMIT_DATA, (rlim_t)options->max_bytes);
        (void)prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
    }
    (void)prctl(PR_SET_PDEATHSIG, SIGKILL, 0, 0, 0);
    bool is_fixed = prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0;
    long version = is_fixed ? restrict_files(options) : -1;
    if (version > 0)
        (void)snprintf(files, sizeof files, "landlock %ld", version);
    else
        (void)snprintf(files, sizeof files, "landlock not in this kernel");
    const struct seccomp_options filter = { .has_gpu = options->needs_gpu };
    bool is_filtered = is_fixed && seccomp_restrict(&filter);
    (void)snprintf(calls, sizeof calls, "%s",
                   !is_filtered         ? "no seccomp"
                   : SECCOMP_IS_RELAXED ? "seccomp (relaxed)"
                                        : "seccomp");
    (void)snprintf(got, 128, "%s, %s, %s, %s", files, calls, is_fixed ? "no-new-privs" : "no-new-privs refused",
                   is_bare ? "no capabilities" : "capabilities kept");
}

/* Keeps the names of this server, and compares a Host header with them. */
#include "server/front/hosts.h"

#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "core/base/mem.h"

struct hosts {
    char **names;
    size_t n_names;
    bool allows_any;
    bool is_alone;
};

struct hosts *hosts_create(const char *const *names, size_t n_names)
{
    struct hosts *hosts = mem_new(sizeof *hosts);
    char own[HOSTS_MAX_NAME + 1] = "";
    hosts->names = mem_new((n_names + 1) * sizeof *hosts->names);
    for (size_t i = 0; i < n_names; i++)
        if (strcmp(names[i], "*") == 0)
            hosts->allows_any = true;
        else
            hosts->names[hosts->n_names++] = mem_copy_text(names[i]);
    if (gethostname(own, sizeof own - 1) == 0 && own[0])
        hosts->names[hosts->n_names++] = mem_copy_text(own);
    return hosts;
}

struct hosts *hosts_create_alone(void)
{
    struct hosts *hosts = mem_new(sizeof *hosts);
    hosts->is_alone = true;
    return hosts;
}

bool hosts_is_alone(const struct hosts *hosts)
{
    return hosts->is_alone;
}

void hosts_destroy(struct hosts *hosts)
{
    if (!hosts)
        return;
    for (size_t i = 0; i < hosts->n_names; i++)
        free(hosts->names[i]);
    free(hosts->names);
    free(hosts);
}

static bool is_port(const char *text)
{
    return text[strspn(text, "0123456789")] == 0;
}

/* Cuts brackets, port and a final dot off, in place. NULL: malformed. */
static char *bare_name(char *host, bool *is_bracketed)
{
    *is_bracketed = host[0] == '[';
    char *end = *is_bracketed ? strchr(host, ']') : strchr(host, ':');
    if (*is_bracketed && !end)
        return NULL;
    if (*is_bracketed) {
        if (end[1] && (end[1] != ':' || !is_port(end + 2)))
            return NULL;
        *end = 0;
        return host + 1;
    }
    if (end && !is_port(end + 1))
        return NULL;
    if (end)
        *end = 0;
    size_t n = strlen(host);
    if (n > 1 && host[n - 1] == '.')
        host[n - 1] = 0;
    return host;
}

static bool ends_in(const char *name, const char *ending)
{
    size_t n = strlen(name), n_ending = strlen(ending);
    return n > n_ending && strcasecmp(name + n - n_ending, ending) == 0;
}

bool hosts_allow(const struct hosts *hosts, const char *host, size_t n)
{
    char text[HOSTS_MAX_NAME + 16];
    struct in6_addr address;
    struct in_addr old;
    bool is_bracketed;
    if (hosts->allows_any)
        return true;
    if (n == 0 || n >= sizeof text || memchr(host, 0, n))
        return false;
    memcpy(text, host, n);
    text[n] = 0;
    const char *name = bare_name(text, &is_bracketed);
    if (!name || !*name)
        return false;
    if (is_bracketed)
        return inet_pton(AF_INET6, name, &address) == 1 && (!hosts->is_alone || IN6_IS_ADDR_LOOPBACK(&address));
    if (inet_pton(AF_INET, name, &old) == 1)
        return !hosts->is_alone || ntohl(old.s_addr) >> 24 == IN_LOOPBACKNET;
    if (strcasecmp(name, "localhost") == 0 || ends_in(name, ".localhost"))
        return true;
    for (size_t i = 0; i < hosts->n_names; i++)
        if (strcasecmp(name, hosts->names[i]) == 0)
            return true;
    return false;
}

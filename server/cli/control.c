/* HTTP/1.1 over a Unix socket, one call a connection. */
#include "server/cli/control.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/mem.h"
#include "server/wire/identity.h"
#include "server/wire/json.h"

enum { MAX_ANSWER = 32 << 20, HEAD_SIZE = 512 };

static bool socket_path(const char *data_folder, struct sockaddr_un *address, struct error *err)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    const size_t size = sizeof address->sun_path;
    int n = -1;
    if (data_folder)
        n = snprintf(address->sun_path, size, "%s/" CONTROL_SOCKET_NAME, data_folder);
    else if (state && *state)
        n = snprintf(address->sun_path, size, "%s/beamroom/" CONTROL_SOCKET_NAME, state);
    else if (home && *home)
        n = snprintf(address->sun_path, size, "%s/.local/state/beamroom/" CONTROL_SOCKET_NAME, home);
    if (n < 0)
        return error_set(err, ERROR_NOT_FOUND, "--data is needed: neither XDG_STATE_HOME nor HOME is set");
    return n < (int)size || error_set(err, ERROR_LIMIT, "the path of the data folder is too long for a socket");
}

static int connect_to(const char *data_folder, struct error *err)
{
    struct sockaddr_un address = { .sun_family = AF_UNIX };
    if (!socket_path(data_folder, &address, err))
        return -1;
    int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd >= 0 && connect(fd, (const struct sockaddr *)&address, sizeof address) == 0)
        return fd;
    error_set(err, ERROR_NOT_FOUND, "%.107s: %s; a daemon with --sign-in must run on this data folder",
              address.sun_path, strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    return -1;
}

static bool send_all(int fd, const char *bytes, size_t n, struct error *err)
{
    while (n) {
        const ssize_t sent = send(fd, bytes, n, MSG_NOSIGNAL);
        if (sent < 0 && errno == EINTR)
            continue;
        if (sent <= 0)
            return error_set(err, ERROR_IO, "the daemon closed the connection: %s", strerror(errno));
        bytes += sent;
        n -= (size_t)sent;
    }
    return true;
}

/* All until the daemon closes, with a final zero. */
static char *read_all(int fd, size_t *n, struct error *err)
{
    size_t capacity = 1 << 16;
    char *bytes = malloc(capacity);
    *n = 0;
    while (bytes) {
        const ssize_t got = recv(fd, bytes + *n, capacity - *n - 1, 0);
        if (got == 0) {
            bytes[*n] = 0;
            return bytes;
        }
        if (got < 0 && errno == EINTR)
            continue;
        if (got < 0 || capacity >= MAX_ANSWER) {
            error_set(err, ERROR_IO, "the daemon's answer cannot be read: %s", got < 0 ? strerror(errno) : "too long");
            free(bytes);
            return NULL;
        }
        *n += (size_t)got;
        if (*n + 1 < capacity)
            continue;
        char *larger = realloc(bytes, 2 * capacity);
        if (!larger)
            free(bytes);
        capacity *= 2;
        bytes = larger;
    }
    error_set(err, ERROR_MEMORY, "no memory for the daemon's answer");
    return NULL;
}

/* Reads status and JSON out of an HTTP answer. */
static bool read_answer(char *text, size_t n, cJSON **answer, struct error *err)
{
    const char *body = strstr(text, "\r\n\r\n");
    char *end;
    if (strncmp(text, "HTTP/1.1 ", 9) != 0 || !body)
        return error_set(err, ERROR_FORMAT, "what answers there is no daemon of beamroom");
    const long status = strtol(text + 9, &end, 10);
    body += 4;
    const size_t n_body = n - (size_t)(body - text);
    cJSON *json = n_body ? json_read(body, n_body, NULL) : NULL;
    if (status >= 200 && status < 300) {
        *answer = json;
        return true;
    }
    const char *detail = json_text(json, "detail");
    error_set(err, ERROR_STATE, "%.230s", detail ? detail : "the daemon refused without a reason");
    cJSON_Delete(json);
    return false;
}

bool control_call(const char *data_folder, const char *method, const char *path, cJSON *body, cJSON **answer,
                  struct error *err)
{
    char head[HEAD_SIZE];
    size_t n = 0;
    char *text = body ? json_print(body) : mem_copy_text("");
    cJSON_Delete(body);
    *answer = NULL;
    if (!text)
        return error_set(err, ERROR_MEMORY, "no memory for the call");
    const int fd = connect_to(data_folder, err);
    (void)snprintf(head, sizeof head,
                   "%s %.200s HTTP/1.1\r\nHost: localhost\r\nContent-Type: application/json\r\nContent-Length: %zu\r\n"
                   "Connection: close\r\n\r\n",
                   method, path, strlen(text));
    bool ok = fd >= 0 && send_all(fd, head, strlen(head), err) && send_all(fd, text, strlen(text), err);
    explicit_bzero(text, strlen(text)); /* it may be a password */
    free(text);
    char *got = ok ? read_all(fd, &n, err) : NULL;
    ok = got && read_answer(got, n, answer, err);
    free(got);
    if (fd >= 0)
        (void)close(fd);
    return ok;
}

/* Writes a problem as an HTTP/1.1 answer, and sends it without waiting. */
#include "server/wire/refusal.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>

#include "core/base/mem.h"
#include "server/wire/json.h"

char *refusal_write(const struct problem *problem, size_t *n)
{
    cJSON *json = problem_to_json(problem);
    char *body = json_print(json), head[512], more[64] = "";
    cJSON_Delete(json);
    if (!body)
        body = mem_copy_text("{}");
    if (problem->retry_after_ms > 0)
        (void)snprintf(more, sizeof more, "Retry-After: %d\r\n", (problem->retry_after_ms + 999) / 1000);
    else if (problem->type == PROBLEM_UPGRADE) /* RFC 9110 15.5.22, RFC 6455 4.4 */
        (void)snprintf(more, sizeof more, "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\n");
    const struct problem_words *words = &problem_types[problem->type];
    int n_head = snprintf(
        head, sizeof head,
        "HTTP/1.1 %d %s\r\nContent-Type: application/problem+json\r\nContent-Length: %zu\r\n%sConnection: %s\r\n"
        "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\n\r\n",
        words->status, words->title, strlen(body), more, problem->type == PROBLEM_UPGRADE ? "close, Upgrade" : "close");
    size_t n_body = strlen(body);
    *n = (size_t)n_head + n_body;
    char *text = mem_new(*n + 1);
    memcpy(text, head, (size_t)n_head);
    memcpy(text + n_head, body, n_body + 1);
    free(body);
    return text;
}

void refusal_send(int socket, const struct problem *problem)
{
    size_t n;
    char *text = refusal_write(problem, &n);
    if (send(socket, text, n, MSG_NOSIGNAL | MSG_DONTWAIT) == (ssize_t)n)
        (void)shutdown(socket, SHUT_WR);
    free(text);
}

bool refusal_drain(int socket, size_t most)
{
    char bytes[16384];
    for (size_t n_dropped = 0; n_dropped < most;) {
        ssize_t n = recv(socket, bytes, sizeof bytes, MSG_DONTWAIT);
        if (n < 0 && errno == EINTR)
            continue;
        if (n <= 0)
            return n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK);
        n_dropped += (size_t)n;
    }
    return true;
}

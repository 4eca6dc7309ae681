#pragma once
/* A problem as a whole answer of HTTP/1.1, for those who refuse a connection before or beside the HTTP server. */
#include <stddef.h>

#include "server/wire/problem.h"

/* Returns status line, headers and body as one buffer, to be freed by free(); the connection closes after it. */
NODISCARD char *refusal_write(const struct problem *problem, size_t *n);
/* Sends the answer without waiting, and ends the sending side; a peer whose buffer is full gets less of it. Closes
 * nothing. */
void refusal_send(int socket, const struct problem *problem);
/* Drops what has come by now, at most so many bytes: a socket that is closed with bytes unread takes the answer back.
 * False once the peer has ended. */
bool refusal_drain(int socket, size_t most);

#pragma once
/* Writes and sends a problem as a whole HTTP/1.1 answer, for code that refuses a connection before or beside the HTTP
 * server. */
#include <stddef.h>

#include "server/wire/problem.h"

/* Returns status line, headers and body as one buffer, to be freed by free(); the connection closes after it. */
NODISCARD char *refusal_write(const struct problem *problem, size_t *n);
/* Sends the answer without waiting, and ends the sending side; a peer whose buffer is full gets less of it. Closes
 * nothing. */
void refusal_send(int socket, const struct problem *problem);
/* Drops the bytes received by now, up to a limit: closing a socket with unread bytes takes the answer back. False once
 * the peer has ended. */
bool refusal_drain(int socket, size_t most);

#pragma once
/* WebSocket text messages to structs and back (proto/messages.json). A door from outside: at most
 * WIRE_MAX_CLIENT_BYTES. */
#include "wire_gen.h"

/* Reads a message that came from the client (or, from_client false, from the server: for tests and tools).
 * On failure message owns nothing; problem->detail says why. */
NODISCARD bool message_read(const char *bytes, size_t n, bool from_client, struct message *message,
                            struct problem *problem);
NODISCARD char *message_write(const struct message *message); /* free() it */
void message_finish(struct message *message);                 /* frees what its fields own */

#pragma once
/* WebSocket text messages to structs and back, as proto/messages.json describes them. Messages of clients come from
 * outside: longer than WIRE_MAX_CLIENT_BYTES they are refused before they are parsed. Thread: any. */
#include "wire_gen.h"

/* Reads a message of a client; from_client false: one of the server, for tests and tools. True: message_finish is due.
 * False: message owns nothing, and problem says why (too-large, json, validation). */
NODISCARD bool message_read(const char *bytes, size_t n, bool from_client, struct message *message,
                            struct problem *problem);
/* JSON text, for free(). NULL: no memory. */
NODISCARD char *message_write(const struct message *message);
/* Frees what the fields own. */
void message_finish(struct message *message);

#pragma once
/* The answer to the key of a WebSocket handshake. */

enum { WS_KEY_CHARACTERS = 24, WS_ACCEPT_SIZE = 28 + 2 /* the library's base64 asks for a byte more than it writes */ };

/* Sec-WebSocket-Accept for a Sec-WebSocket-Key, which has WS_KEY_CHARACTERS (RFC 6455 4.2.2): base64 of the SHA-1 of
 * the key and a fixed text. It proves no identity: it only shows that the server speaks this protocol. */
void ws_accept_of(const char *key, char accept[WS_ACCEPT_SIZE]);

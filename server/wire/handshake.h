#pragma once
/* The handshake of a WebSocket as the front has checked it: plain data from where requests are read to where they
 * are answered. */
#include <stdbool.h>
#include <stddef.h>

#include "server/wire/identity.h"

enum { HANDSHAKE_MAX_ORIGIN = 300, HANDSHAKE_MAX_HOST = 300 };

struct handshake {
    char room_id[64];                      /* "" when the address names none that could be */
    char key[25];                          /* Sec-WebSocket-Key */
    char host[HANDSHAKE_MAX_HOST + 1];     /* "" when there is none */
    char origin[HANDSHAKE_MAX_ORIGIN + 1]; /* "" when there is none: programs send none */
    char client[46];                       /* address of the client, behind trusted proxies; "": not known */
    bool is_secure;                        /* it came by TLS, which was decrypted here */
    struct identity identity;              /* who opens it */
    size_t n_head;                         /* bytes of the whole head, which are still to be read from the socket */
};

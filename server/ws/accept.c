#include "server/ws/accept.h"

#include <assert.h>
#include <libwebsockets.h>
#include <stdio.h>
#include <string.h>

void ws_accept_of(const char *key, char accept[WS_ACCEPT_SIZE])
{
    char text[WS_KEY_CHARACTERS + 37];
    uint8_t hash[20];
    assert(strlen(key) == WS_KEY_CHARACTERS);
    int n = snprintf(text, sizeof text, "%s258EAFA5-E914-47DA-95CA-C5AB0DC85B11", key);
    (void)lws_SHA1((const uint8_t *)text, (size_t)n, hash);
    (void)lws_b64_encode_string((const char *)hash, (int)sizeof hash, accept, WS_ACCEPT_SIZE);
}

#pragma once
/* The identity behind a call or a WebSocket: plain data from where requests are read to where rights are checked. What
 * a request brings to prove it are its credentials; server/auth makes an identity of them. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Socket in the data folder: whoever may open it is the administrator. */
#define CONTROL_SOCKET_NAME "control.sock"

enum {
    IDENTITY_MAX_GROUPS = 32,
    IDENTITY_MAX_USER = 64, /* bytes of a user's id, and of a group's */
    IDENTITY_MAX_NAME = 160 /* bytes of a name: 40 characters */
};

enum identity_source {
    IDENTITY_NOBODY,   /* has not signed in: has no right, but for what a link to a room gives */
    IDENTITY_MACHINE,  /* --sign-in none: whoever reaches the server is its one person, and may do everything */
    IDENTITY_PASSWORD, /* signed in here, with a session */
    IDENTITY_PROXY,    /* named by the proxy in front, over the Unix socket */
    IDENTITY_TOKEN     /* a script's */
};

/* The acts open to a token, as a set. A session has all of it; its rights come from grants alone. */
enum identity_scope {
    IDENTITY_SCOPE_READ = 1,
    IDENTITY_SCOPE_PLAN = 2, /* changes, uploads */
    IDENTITY_SCOPE_PULL = 4, /* from an archive */
    IDENTITY_SCOPE_ADMIN = 8,
    IDENTITY_SCOPE_ALL = 15
};

struct identity {
    enum identity_source source;
    char user[IDENTITY_MAX_USER + 1]; /* printable, without spaces; "" of nobody and of the machine's person */
    char name[IDENTITY_MAX_NAME + 1]; /* as people are shown it; "": none */
    char groups[IDENTITY_MAX_GROUPS][IDENTITY_MAX_USER + 1];
    size_t n_groups;
    bool is_private;    /* it came over TLS of our own, the Unix socket or loopback, as passwords have to */
    unsigned scopes;    /* enum identity_scope */
    bool is_admin;      /* a local user of the group admin, whom no grant has to name; a proxy's groups never do this */
    char session[17];   /* names the session or token in the audit and when it is ended; opens nothing. "": none */
    char address[46];   /* the client's, behind trusted proxies; "": not known */
    int64_t proved_ms;  /* wall clock: when the person last gave a password, or signed in at the proxy; 0: not known */
    int64_t ends_ms;    /* wall clock: when it ends at the latest; 0: it does not */
    char folders[1024]; /* of a token: grant folders that it is held to, each ended by '\n'; "": none in particular */
};

/* A word for the audit. */
static inline const char *identity_source_word(enum identity_source source)
{
    switch (source) {
    case IDENTITY_MACHINE: return "machine";
    case IDENTITY_PASSWORD: return "password";
    case IDENTITY_PROXY: return "proxy";
    case IDENTITY_TOKEN: return "token";
    default: return "nobody";
    }
}

/* The proof that a request brings. Pointers into it; NULL: it has none. */
struct credentials {
    const char *cookie;        /* the header Cookie, whole */
    const char *authorization; /* the header Authorization, whole */
    /* headers of the proxy, whose names can be set; only where is_from_proxy */
    const char *user, *name, *groups, *auth_time;
    bool is_from_proxy; /* it came over the Unix socket, from a process of the proxy's user or group */
    bool is_control;    /* it came over the control socket of the data folder, from the daemon's user or root */
    bool is_secure;     /* over TLS of our own, the Unix socket or loopback */
    bool is_https;      /* over TLS of our own, or the Unix socket of a proxy: the browser's way is https */
    const char *address;
};

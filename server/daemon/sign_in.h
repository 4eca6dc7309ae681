#pragma once
/* How people sign in and what they may do, as the settings say: joins accounts (server/auth/auth.h) and grants
 * (server/auth/access.h). */
#include "server/auth/access.h"
#include "server/auth/auth.h"
#include "server/daemon/options.h"
#include "server/net/net.h"

struct sign_in {
    const struct options *options;
    struct auth *auth;
    struct access *access; /* NULL: nobody signs in */
    struct options_grants grants;
};

/* options outlive it. errors of auth_create and access_set */
NODISCARD bool sign_in_create(struct sign_in *sign_in, const struct options *options, struct error *err);
void sign_in_finish(struct sign_in *sign_in); /* after everything that uses it; also after a failed create */
/* Reads the grants again, whole or not at all; the log and the audit say which ones changed, or why none did. */
void sign_in_reload(struct sign_in *sign_in, struct net *net);

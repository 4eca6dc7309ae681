#pragma once
/* Calls that bring passwords: bodies of texts, which are wiped; answers that come from the thread
 * that checks passwords. Internal to server/http; net thread. */
#include "server/auth/auth.h"
#include "server/http/api_state.h"

struct api_text { /* a field of the body */
    const char *name;
    bool is_optional;
    const char *value; /* "" where it was left out */
};

/* False: the call was answered, as nobody signs in here; or as is_private, where it came over a way on which passwords
 * can be read. */
bool api_may_sign_in(struct api *api, struct call *call, bool is_private);

struct api_waiting { /* a call that waits for a password: the context of auth_done */
    struct api *api;
    struct call *call;
    void (*then)(struct api_waiting *waiting);
    char user[IDENTITY_MAX_USER + 1];
    bool is_secure_cookie;
    struct auth_answer answer;
};
void api_waited(void *context, const struct auth_answer *answer); /* the auth_done */

struct api_asking { /* what is asked of auth.h with the texts of a body, and what comes of it */
    /* Asks with api_waited and waiting; returns what the function of auth.h does. */
    bool (*ask)(struct api_waiting *waiting, const struct api_text *texts, struct problem *problem);
    void (*then)(struct api_waiting *waiting); /* on the net thread, with the answer; answers the call */
};
/* Reads a body with these texts and nothing else, asks, and wipes it. The text that is called user, else the caller, is
 * the user who is waited for. */
void api_ask_passwords(struct api *api, struct call *call, struct api_text *texts, size_t n,
                       const struct api_asking *asking);

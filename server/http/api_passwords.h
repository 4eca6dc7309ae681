#pragma once
/* Calls that bring passwords: bodies of texts, which are wiped; answers that come from the thread
 * that checks passwords. Internal to server/http; net thread. */
#include "server/auth/auth.h"
#include "server/http/api_state.h"

struct api_text { /* a field of the body */
    const char *name;
    bool is_optional;
    const char *value; /* "" where it was left out; valid until api_texts_finish */
};

/* Reads a body with these texts and nothing else, and wipes the call's own copy of it. NULL: the call was answered. */
cJSON *api_texts_read(struct call *call, struct api_text *texts, size_t n);
void api_texts_finish(cJSON *body); /* wipes them */

/* False: the call was answered, as nobody signs in here; or as is_private, where it came over a way on which passwords
 * can be read. */
bool api_may_sign_in(struct api *api, struct call *call, bool is_private);

/* A call that waits for a password: the context of auth_done. */
struct api_waiting {
    struct api *api;
    struct call *call;
    void (*then)(struct api_waiting *waiting); /* on the net thread, with the answer; answers the call */
    char user[IDENTITY_MAX_USER + 1];
    bool is_secure_cookie;
    struct auth_answer answer;
};
struct api_waiting *api_wait(struct api *api, struct call *call, const char *user,
                             void (*then)(struct api_waiting *waiting));
void api_waited(void *context, const struct auth_answer *answer); /* the auth_done */
/* was_taken: what the function of auth.h returned; false: answers the call with problem and frees waiting. */
void api_wait_or_answer(struct api_waiting *waiting, bool was_taken, const struct problem *problem);

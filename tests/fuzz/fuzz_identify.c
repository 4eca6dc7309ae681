/* The proof that a request brings: cookies, a token, a proxy's names. An identity has whole texts within their limits,
 * of UTF-8 for JSON; a refusal has a sentence. */
#include "server/auth/auth.h"
#include "server/wire/json.h"
#include "tests/fuzz/fuzz.h"

enum { N_TEXTS = 6 };

static int64_t now_ms(void)
{
    return 1767225600000;
}

static struct auth *make_auth(void)
{
    struct error err = { 0 };
    const struct auth_options options = { .is_local = true, .is_proxied = true, .now_ms = now_ms };
    struct store_session session = { .user = "ann", .name = "Ann", .groups = "physics\n", .source = "password" };
    struct store_user user = { .id = "ann", .name = "Ann", .groups = "physics\n" };
    struct store_accounts all = { .users = &user, .sessions = &session, .n_users = 1, .n_sessions = 1 };
    session.created_ms = session.seen_ms = now_ms();
    struct auth *auth = auth_create(&options, &err);
    REQUIRE(auth);
    auth_load(auth, &all, false);
    return auth;
}

static void check_text(const char *text, size_t size)
{
    REQUIRE(memchr(text, 0, size));
    cJSON *json = cJSON_CreateString(text);
    char *printed = json_print(json);
    cJSON *read = json_read(printed, strlen(printed), NULL);
    REQUIRE(cJSON_IsString(read) && strcmp(read->valuestring, text) == 0);
    cJSON_Delete(read);
    cJSON_free(printed);
    cJSON_Delete(json);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static struct auth *auth;
    char *texts[N_TEXTS] = { NULL };
    struct problem problem = { 0 };
    struct identity identity;
    if (!auth)
        auth = make_auth();
    if (n < 1)
        return 0;
    const uint8_t *at = data + 1, *end = data + n;
    for (int i = 0; i < N_TEXTS && at < end; i++) { /* headers have no line breaks, and no zero */
        const uint8_t *line = memchr(at, '\n', (size_t)(end - at));
        const size_t n_line = (size_t)((line ? line : end) - at);
        if (data[0] >> i & 1 && !memchr(at, 0, n_line)) {
            texts[i] = malloc(n_line + 1);
            memcpy(texts[i], at, n_line);
            texts[i][n_line] = 0;
        }
        at += n_line + 1 <= (size_t)(end - at) ? n_line + 1 : (size_t)(end - at);
    }
    const struct credentials credentials = { .cookie = texts[0],
                                             .authorization = texts[1],
                                             .user = texts[2],
                                             .name = texts[3],
                                             .groups = texts[4],
                                             .auth_time = texts[5],
                                             .is_from_proxy = data[0] >> 6 & 1 };
    if (auth_identify(auth, &credentials, &identity, &problem)) {
        REQUIRE(identity.source == IDENTITY_NOBODY || identity.source == IDENTITY_PROXY);
        REQUIRE(identity.n_groups <= IDENTITY_MAX_GROUPS && !identity.is_admin);
        REQUIRE((identity.source == IDENTITY_PROXY) == (identity.user[0] != 0));
        check_text(identity.user, sizeof identity.user);
        check_text(identity.name, sizeof identity.name);
        for (size_t i = 0; i < identity.n_groups; i++)
            check_text(identity.groups[i], sizeof identity.groups[i]);
        REQUIRE(auth_is_still(auth, &identity));
    } else {
        REQUIRE(strlen(problem.detail) > 20);
    }
    for (int i = 0; i < N_TEXTS; i++)
        free(texts[i]);
    return 0;
}

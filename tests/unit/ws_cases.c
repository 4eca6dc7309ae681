/* The echo server, and the list of cases as cmocka's tests. */
#include "tests/unit/ws_cases.h"

#include "core/base/mem.h"
#include "tests/check.h"

enum { MOST_CASES = 301, LARGEST = 16 << 20 };

static struct ws *ws;
struct ws_client client;
const char hello[] = "Hello, world!";

/* ---- the echo server -------------------------------------------------------------------------------------------- */

static bool has_room(void *context, const struct handshake *handshake)
{
    (void)context;
    return strcmp(handshake->room_id, "7q4k-m2wz") == 0;
}

static void opened(void *context, struct ws_connection *connection, const struct handshake *handshake)
{
    (void)context;
    (void)connection;
    (void)handshake;
}

static void echo(void *context, struct ws_connection *connection, enum ws_opcode kind, const char *bytes, size_t n)
{
    (void)context;
    ws_send_message(connection, kind, bytes, n);
}

static bool is_greeted(void *context, struct ws_connection *connection)
{
    (void)context;
    (void)connection;
    return true;
}

static void closed(void *context, struct ws_connection *connection)
{
    (void)context;
    (void)connection;
}

static void nothing(void *context)
{
    (void)context;
}

static int start(void **state)
{
    const struct ws_callbacks callbacks = { has_room, opened, echo, is_greeted, closed, nothing, nothing, NULL };
    struct ws_limits limits = ws_limits_default; /* but for the sizes and numbers of group 9 */
    (void)state;
    limits.takes_binary = true;
    limits.max_message_bytes = limits.max_waiting_bytes = LARGEST;
    limits.bytes = (struct rate_limit){ .per_s = INT64_C(1) << 30, .burst = INT64_C(1) << 30 };
    ws = ws_create(&callbacks, &limits, NULL, NULL);
    assert_non_null(ws);
    ws_client_open(&client, ws);
    return 0;
}

static int end(void **state)
{
    (void)state;
    ws_client_finish(&client);
    ws_destroy(ws);
    return 0;
}

/* ---- what cases are made of ------------------------------------------------------------------------------------- */

void send_close(unsigned code, const char *reason)
{
    uint8_t bytes[200] = { (uint8_t)(code >> 8), (uint8_t)code };
    size_t n = strlen(reason);
    memcpy(bytes + 2, reason, n);
    ws_client_send(&client, CLOSE, bytes, 2 + n);
}

void ends_well(void)
{
    send_close(1000, "");
    ws_client_expect_end(&client, 1000);
}

void add_text(unsigned first, const char *text)
{
    ws_client_add(&client, first, text, strlen(text));
}

void expect_text(const char *text)
{
    ws_client_expect(&client, TEXT, text, strlen(text));
}

uint8_t *make_payload(size_t n)
{
    uint8_t *bytes = mem_new(n + 1);
    for (size_t i = 0; i < n; i++)
        bytes[i] = (uint8_t)('!' + i * 31 % 94);
    return bytes;
}

/* ---- the list --------------------------------------------------------------------------------------------------- */

int ws_cases_run(const struct ws_group *groups, size_t n_groups, size_t n_cases)
{
    static struct CMUnitTest tests[MOST_CASES];
    static struct ws_case cases[MOST_CASES];
    size_t n = 0;
    for (size_t g = 0; g < n_groups; g++)
        for (int i = 1; i <= groups[g].n; i++, n++) {
            struct ws_case *now = &cases[n];
            if (n == MOST_CASES)
                return 1;
            *now = (struct ws_case){ .a = groups[g].a, .b = groups[g].b ? groups[g].b : i, .c = groups[g].b ? i : 0 };
            (void)snprintf(now->name, sizeof now->name, now->c ? "case_%d.%d.%d" : "case_%d.%d", now->a, now->b,
                           now->c);
            tests[n] = (struct CMUnitTest){ now->name, groups[g].run, start, end, now };
        }
    if (n != n_cases)
        return 1;
    return cmocka_run_group_tests(tests, NULL, NULL); /* which leaves out those without a name */
}

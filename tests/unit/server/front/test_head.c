/* Heads of requests: HTTP, WebSocket handshake, or refused with which problem. */
#include <unistd.h>

#include "server/front/head.h"
#include "server/wire/json.h"
#include "server/wire/refusal.h"
#include "tests/check.h"

static struct hosts *hosts;
static struct head_rules rules;

static int make_hosts(void **state)
{
    (void)state;
    static const char *const names[] = { "Beamroom.Example" };
    hosts = hosts_create(names, 1);
    rules = (struct head_rules){ .hosts = hosts, .identity_names = head_identity_names };
    return 0;
}

static int drop_hosts(void **state)
{
    (void)state;
    hosts_destroy(hosts);
    return 0;
}

static enum head_kind look(const char *bytes, size_t n, struct problem *problem)
{
    *problem = (struct problem){ 0 };
    return head_look(bytes, n, &rules, problem);
}

#define HOST "Host: localhost:8080\r\n"
#define SHAKE "GET /api/v1/rooms/a/ws HTTP/1.1\r\n" HOST "Connection: keep-alive, Upgrade\r\nUpgrade: WebSocket\r\n"
#define VERSION "Sec-WebSocket-Version: 13\r\n"
#define KEY "Sec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n"

struct expected {
    const char *bytes;
    enum head_kind kind;
    enum problem_type type;
    const char *words;
};

static void assert_each(const struct expected *list, size_t n)
{
    for (size_t i = 0; i < n; i++) {
        struct problem problem;
        enum head_kind kind = look(list[i].bytes, strlen(list[i].bytes), &problem);
        if (kind != list[i].kind || problem.type != list[i].type ||
            (list[i].words && !strstr(problem.detail, list[i].words)))
            fail_msg("\"%s\": kind %d (expected %d), type %d (expected %d), \"%s\" (expected \"%s\")", list[i].bytes,
                     (int)kind, (int)list[i].kind, (int)problem.type, (int)list[i].type, problem.detail,
                     list[i].words ? list[i].words : "");
    }
}
#define CHECK_EACH(list) assert_each(list, sizeof(list) / sizeof *(list))

static void what_is_whole_and_plain_goes_on(void **state)
{
    (void)state;
    static const struct expected list[] = {
        { "GET / HTTP/1.1\r\n" HOST "\r\n", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "GET / HTTP/1.0\r\n\r\n", HEAD_HTTP, PROBLEM_NONE,
          NULL }, /* as a probe of a proxy asks: RFC 9112 3.2 wants Host of 1.1 alone */
        { "\r\n\nGET / HTTP/1.1\n" HOST "\n", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "BREW /x HTTP/1.1\r\n" HOST "\r\n", HEAD_HTTP, PROBLEM_NONE,
          NULL }, /* which methods there are is the API's to say */
        { "GET http://elsewhere/x HTTP/1.1\r\n" HOST "\r\n", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "POST /x HTTP/1.1\r\n" HOST "Content-Length: 5\r\n\r\nhello", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "POST /x HTTP/1.1\r\n" HOST "Transfer-Encoding: Chunked\r\n\r\n", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "GET / HTTP/1.1\r\nhost:\tBEAMROOM.example.:80  \r\nX: \xc3\xa9\r\n\r\n", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "GET /api/v1/rooms/a/ws HTTP/1.1\r\n" HOST "\r\n", HEAD_HTTP, PROBLEM_NONE,
          NULL }, /* no handshake: the API says how */
        { SHAKE VERSION KEY "\r\n", HEAD_WEBSOCKET, PROBLEM_NONE, NULL },
        { SHAKE VERSION KEY "Content-Length: 0\r\n\r\n", HEAD_WEBSOCKET, PROBLEM_NONE, NULL },
        { "", HEAD_INCOMPLETE, PROBLEM_NONE, NULL },
        { "\r", HEAD_INCOMPLETE, PROBLEM_NONE, NULL },
        { "GET / HTTP/1.1\r\n" HOST, HEAD_INCOMPLETE, PROBLEM_NONE, NULL },
        { "GET / HTTP/1.1\r\n" HOST "\r", HEAD_INCOMPLETE, PROBLEM_NONE, NULL },
    };
    CHECK_EACH(list);
}

static void what_is_not_is_told_which_line_and_what_was_expected(void **state)
{
    (void)state;
    static const struct expected list[] = {
        { "\x16\x03\x01 hello\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "line 1, the request line, is \"??? hello\"; expected is" },
        { "GET /\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "parted by single spaces" },
        { "GET  / HTTP/1.1\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "line 1" },
        { "GET / HTTP/1.1 \r\n", HEAD_REFUSED, PROBLEM_REQUEST, "line 1" },
        { "G\"T / HTTP/1.1\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "begins with a method" },
        { "GET /\x01 HTTP/1.1\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "without control characters" },
        { "CONNECT a:1 HTTP/1.1\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "begins with \"/\"" },
        { "PRI * HTTP/2.0\r\n", HEAD_REFUSED, PROBLEM_HTTP_VERSION, "of HTTP/2.0; expected is HTTP/1.1" },
        { "GET / HTTP/1.2\r\n", HEAD_REFUSED, PROBLEM_HTTP_VERSION, "of HTTP/1.2" },
        { "GET / HTTP/1.1\r\n" HOST "what\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "header 2, \"what\": without a colon" },
        { "GET / HTTP/1.1\r\n" HOST "A: b\r\n c: d\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "header 3, \" c: d\": it goes on" },
        { "GET / HTTP/1.1\r\nHost : a\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "header 1, \"Host : a\": a name that is none" },
        { "GET / HTTP/1.1\r\nA: b\rc\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "header 1, \"A: b?c\": a control character" },
        { "GET / HTTP/1.1\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "Host is there 0 times" },
        { "GET / HTTP/1.1\r\n" HOST HOST "\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "Host is there 2 times" },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length: -5\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "Content-Length is \"-5\"; expected" },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length: 5 \r\n\r\nhello", HEAD_REFUSED, PROBLEM_REQUEST,
          "Content-Length is \"5 \"" },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length: 5\t\n\nhello", HEAD_REFUSED, PROBLEM_REQUEST,
          "Content-Length is \"5?\"" },
        { "GET / HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked \r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "is \"chunked \" in HTTP/1.1" },
        { "GET / HTTP/1.1\r\n" HOST "Transfer-Encoding: \tchunked\t\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "is \"chunked?\" in HTTP/1.1" },
        { "GET / HTTP/1.1\r\n" HOST "Transfer-Encoding: \t chunked\r\n\r\n", HEAD_HTTP, PROBLEM_NONE, NULL },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length:\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "Content-Length is \"\"" },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length: 1234567890123456789\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "at most 18 digits" },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length: 5\r\ncontent-length: 5\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "Content-Length is there 2" },
        { "GET / HTTP/1.1\r\n" HOST "Content-Length: 5\r\nTransfer-Encoding: chunked\r\n\r\n", HEAD_REFUSED,
          PROBLEM_REQUEST, "both Content-Length" },
        { "GET / HTTP/1.1\r\n" HOST "Transfer-Encoding: gzip, chunked\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "is \"gzip, chunked\"" },
        { "GET / HTTP/1.0\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "in HTTP/1.0; expected" },
        { SHAKE VERSION "\r\n", HEAD_REFUSED, PROBLEM_REQUEST, "Sec-WebSocket-Key is \"\"" },
        { SHAKE VERSION "Sec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw\r\n\r\n", HEAD_REFUSED, PROBLEM_REQUEST,
          "16 bytes in base64" },
        { SHAKE KEY "\r\n", HEAD_REFUSED, PROBLEM_UPGRADE, "Version is \"\"; expected is 13" },
        { SHAKE KEY "Sec-WebSocket-Version: 8\r\n\r\n", HEAD_REFUSED, PROBLEM_UPGRADE, "Version is \"8\"" },
        { SHAKE VERSION KEY "Content-Length: 3\r\n\r\nabc", HEAD_REFUSED, PROBLEM_REQUEST, "announces a body" },
        { "GET /api/v1/rooms/a/ws HTTP/1.1\r\n" HOST "Upgrade: websocket\r\n" VERSION KEY "\r\n", HEAD_REFUSED,
          PROBLEM_UPGRADE, "Connection is \"\"" },
        { "GET /api/v1/rooms/a/ws HTTP/1.0\r\n" HOST "Upgrade: websocket\r\n\r\n", HEAD_REFUSED, PROBLEM_UPGRADE,
          "HTTP/1.0; expected is HTTP/1.1" },
    };
    CHECK_EACH(list);
    struct problem problem;
    static const char nul[] = "GET / HTTP/1.1\r\nA: b\0c\r\n";
    assert_int_equal(look(nul, sizeof nul - 1, &problem), HEAD_REFUSED);
    assert_non_null(strstr(problem.detail, "\"A: b?c\": a control character"));
}

/* n bytes: a request line of n_line with its end, then one header and the empty line, filled up with the letter a. */
static void fill(char *bytes, size_t n, size_t n_line)
{
    static const char first[] = "GET /", version[] = " HTTP/1.1\r\n", host[] = HOST "A: ", last[] = "\r\n\r\n";
    memset(bytes, 'a', n);
    memcpy(bytes, first, sizeof first - 1);
    memcpy(bytes + n_line - (sizeof version - 1), version, sizeof version - 1);
    memcpy(bytes + n_line, host, sizeof host - 1);
    memcpy(bytes + n - (sizeof last - 1), last, sizeof last - 1);
}

static void the_limits_hold_to_the_byte(void **state)
{
    (void)state;
    static char bytes[HEAD_MAX_BYTES + 1];
    struct problem problem;
    fill(bytes, HEAD_MAX_BYTES, 100);
    assert_int_equal(look(bytes, HEAD_MAX_BYTES, &problem), HEAD_HTTP);
    fill(bytes, HEAD_MAX_BYTES + 1, 100);
    assert_int_equal(look(bytes, HEAD_MAX_BYTES + 1, &problem), HEAD_REFUSED);
    assert_int_equal(problem.type, PROBLEM_HEADERS_TOO_LARGE);
    assert_int_equal(problem_status(problem.type), 431);
    assert_int_equal(look(bytes, HEAD_MAX_BYTES, &problem), HEAD_REFUSED); /* and no more of it is waited for */
    assert_int_equal(look(bytes, HEAD_MAX_BYTES - 1, &problem), HEAD_INCOMPLETE);
    fill(bytes, HEAD_MAX_BYTES, HEAD_MAX_LINE + 2); /* without the line's end it is HEAD_MAX_LINE */
    assert_int_equal(look(bytes, HEAD_MAX_BYTES, &problem), HEAD_HTTP);
    fill(bytes, HEAD_MAX_BYTES, HEAD_MAX_LINE + 3);
    assert_int_equal(look(bytes, HEAD_MAX_BYTES, &problem), HEAD_REFUSED);
    assert_int_equal(problem.type, PROBLEM_ADDRESS_TOO_LONG);
    assert_int_equal(problem_status(problem.type), 414);
    for (int more = 0; more < 2; more++) {
        size_t n = (size_t)snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n" HOST);
        for (int i = 1; i < HEAD_MAX_FIELDS + more; i++)
            n += (size_t)snprintf(bytes + n, sizeof bytes - n, "A: b\r\n");
        n += (size_t)snprintf(bytes + n, sizeof bytes - n, "\r\n");
        assert_int_equal(look(bytes, n, &problem), more ? HEAD_REFUSED : HEAD_HTTP);
        n = (size_t)snprintf(bytes, sizeof bytes, SHAKE VERSION KEY "Cookie: %*s\r\n\r\n", HEAD_MAX_WEBSOCKET, "a");
        char *cookie = strstr(bytes, "Cookie: ") + 8;
        memset(cookie, 'a', HEAD_MAX_WEBSOCKET);
        size_t too_many = n - HEAD_MAX_WEBSOCKET - (size_t)more;
        memmove(cookie, cookie + too_many, n - too_many - (size_t)(cookie - bytes));
        assert_int_equal(look(bytes, n - too_many, &problem), more ? HEAD_REFUSED : HEAD_WEBSOCKET);
        assert_int_equal(problem.type, more ? PROBLEM_HEADERS_TOO_LARGE : PROBLEM_NONE);
    }
}

static void a_handshake_is_read_as_it_stands(void **state)
{
    (void)state;
    static const struct {
        const char *target, *room_id;
    } cases[] = { { "/api/v1/rooms/7q4k-m2wz/ws", "7q4k-m2wz" },
                  { "/api/v1/rooms/7q4k-m2wz/ws?a=b", "7q4k-m2wz" },
                  { "/api/v1/rooms/x%2f..%2f7q4k-m2wz/ws", "" },
                  { "/api/v1/rooms/x/../7q4k-m2wz/ws", "" },
                  { "/api/v1/rooms/7q4k%2dm2wz/ws", "" },
                  { "/api/v1/rooms/7q4k-m2wz%00/ws", "" },
                  { "/api/v1/rooms//ws", "" },
                  { "/api/v1/rooms/7Q4K/ws", "" } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char bytes[600];
        struct problem problem;
        struct head_request request;
        const struct handshake *handshake = &request.handshake;
        int n = snprintf(bytes, sizeof bytes,
                         "\r\nGET %s HTTP/1.1\r\n" HOST "Connection: Upgrade\r\nUpgrade: websocket\r\n" VERSION KEY
                         "Origin:  http://a.b:1 \r\n\r\n",
                         cases[i].target);
        if (i == 6) { /* no room at all: the API says so */
            assert_int_equal(look(bytes, (size_t)n, &problem), HEAD_HTTP);
            continue;
        }
        memcpy(bytes + n, "\x81\x80", 2); /* the first frame is no part of it */
        assert_int_equal(head_read(bytes, (size_t)n + 2, &rules, &request, &problem), HEAD_WEBSOCKET);
        assert_string_equal(handshake->room_id, cases[i].room_id);
        assert_string_equal(handshake->host, "localhost:8080");
        assert_string_equal(handshake->origin, "http://a.b:1");
        assert_int_equal(strlen(handshake->key), 24);
        assert_non_null(strstr(KEY, handshake->key));
        assert_int_equal(handshake->n_head, n);
    }
}

static void an_origin_is_there_once_and_is_not_cut(void **state)
{
    (void)state;
    struct problem problem;
    static const char twice[] =
        SHAKE VERSION KEY "Origin: http://localhost:8080\r\nOrigin: http://evil.example\r\n\r\n";
    assert_int_equal(look(twice, sizeof twice - 1, &problem), HEAD_REFUSED);
    assert_non_null(strstr(problem.detail, "Origin is there 2 times"));
    for (int more = 0; more < 2; more++) {
        char bytes[1000], origin[400];
        struct head_request request;
        memset(origin, 'a', sizeof origin);
        origin[HANDSHAKE_MAX_ORIGIN + more] = 0;
        size_t n = (size_t)snprintf(bytes, sizeof bytes, SHAKE VERSION KEY "Origin: %s\r\n\r\n", origin);
        assert_int_equal(head_read(bytes, n, &rules, &request, &problem), more ? HEAD_REFUSED : HEAD_WEBSOCKET);
        if (!more)
            assert_string_equal(request.handshake.origin, origin);
    }
}

static void a_beginning_is_waited_for_or_refused_as_the_whole_is(void **state)
{
    (void)state;
    static const char *const wholes[] = { "GET / HTTP/1.1\r\n" HOST "\r\n", SHAKE VERSION KEY "\r\n", SHAKE KEY "\r\n",
                                          "\r\nGET / HTTP/1.1\nA : b\n\n", "GET / HTTP/1.1\r\nHost: evil\r\n\r\n" };
    for (size_t i = 0; i < sizeof wholes / sizeof wholes[0]; i++) {
        struct problem whole, part;
        size_t n = strlen(wholes[i]);
        enum head_kind kind = look(wholes[i], n, &whole);
        for (size_t k = 0; k < n; k++) {
            enum head_kind found = look(wholes[i], k, &part);
            assert_true(found == HEAD_INCOMPLETE || (found == kind && strcmp(part.detail, whole.detail) == 0));
        }
    }
}

static void only_our_own_names_are_answered_to(void **state)
{
    (void)state;
    char own[HOSTS_MAX_NAME + 1] = "";
    assert_int_equal(gethostname(own, sizeof own - 1), 0);
    const struct {
        const char *host;
        bool is_ours;
    } cases[] = { { "localhost", true },
                  { "LOCALHOST:1", true },
                  { "a.localhost:8080", true },
                  { "127.0.0.1:8080", true },
                  { "10.1.2.3", true },
                  { "[::1]:8080", true },
                  { "[fe80::1]", true },
                  { own, true },
                  { "beamroom.example", true },
                  { "beamroom.example:443", true },
                  { "BEAMROOM.EXAMPLE.", true },
                  { "evil.example", false },
                  { "evil.example:8080", false },
                  { "localhost.evil.example", false },
                  { "notlocalhost", false },
                  { "127.0.0.1.evil.example", false },
                  { "a.beamroom.example", false },
                  { "", false },
                  { ":8080", false },
                  { "[::1", false },
                  { "[::1]evil", false },
                  { "[evil]", false },
                  { "localhost:evil", false },
                  { "localhost@evil", false },
                  { "0x7f.1", false },
                  { ".localhost", false } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        if (hosts_allow(hosts, cases[i].host, strlen(cases[i].host)) != cases[i].is_ours)
            fail_msg("%s", cases[i].host);
    static const char *const any[] = { "*" };
    struct hosts *all = hosts_create(any, 1);
    assert_true(hosts_allow(all, "evil.example", 12));
    hosts_destroy(all);
    struct problem problem = { 0 };
    static const char evil[] = "GET / HTTP/1.1\r\nHost: evil.example\r\n\r\n";
    assert_int_equal(look(evil, sizeof evil - 1, &problem), HEAD_REFUSED);
    assert_int_equal(problem_status(problem.type), 421);
}

static void a_server_for_its_own_machine_answers_no_other_name_and_no_proxy(void **state)
{
    (void)state;
    static const struct {
        const char *fields;
        bool is_answered;
    } cases[] = { { "Host: 127.0.0.1:8080", true },
                  { "Host: 127.255.0.3", true },
                  { "Host: localhost", true },
                  { "Host: beamroom.localhost:8080", true },
                  { "Host: [::1]:8080", true },
                  { "Host: [0:0:0:0:0:0:0:1]", true },
                  { "Host: 192.0.2.1", false },
                  { "Host: 128.0.0.1", false },
                  { "Host: [2001:db8::1]", false },
                  { "Host: [::]", false },
                  { "Host: 0.0.0.0", false },
                  { "Host: beamroom.example", false },
                  { "Host: 127.0.0.1.evil.example", false },
                  { "Host: localhost\r\nX-Forwarded-For: 127.0.0.1", false },
                  { "Host: localhost\r\nx-forwarded-proto: https", false },
                  { "Host: localhost\r\nX-FORWARDED-HOST: localhost", false },
                  { "Host: localhost\r\nForwarded: for=127.0.0.1", false },
                  { "Host: localhost\r\nVia: 1.1 proxy", false },
                  { "Host: localhost\r\nVia:", false },
                  { "Host: localhost\r\nX-Real-IP: 127.0.0.1", false },
                  { "Host: localhost\r\nX-Forward: 1\r\nViable: 1", true } };
    struct hosts *alone = hosts_create_alone();
    const struct head_rules rules_alone = { .hosts = alone, .identity_names = head_identity_names };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        char bytes[300];
        struct problem problem = { 0 };
        int n = snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n%s\r\n\r\n", cases[i].fields);
        enum head_kind kind = head_look(bytes, (size_t)n, &rules_alone, &problem);
        if ((kind == HEAD_HTTP) != cases[i].is_answered)
            fail_msg("%s", cases[i].fields);
        if (!cases[i].is_answered)
            assert_int_equal(problem_status(problem.type), 403);
    }
    hosts_destroy(alone);
}

static void a_whole_head_says_where_its_request_ends_and_for_whom_it_comes(void **state)
{
    (void)state;
    static const char post[] =
        "\r\nPOST /x HTTP/1.1\r\n" HOST
        "X-Forwarded-For: 203.0.113.1\r\nContent-Length: 12\r\nx-forwarded-for: 198.51.100.7, 10.0.0.1 \r\n\r\nhello";
    static const char chunked[] = "POST /x HTTP/1.1\r\n" HOST "Transfer-Encoding: chunked\r\n\r\n";
    struct head_request request;
    struct problem problem;
    assert_int_equal(head_read(post, sizeof post - 1, &rules, &request, &problem), HEAD_HTTP);
    assert_int_equal(request.n_bytes, sizeof post - 1 - 5);
    assert_int_equal(request.length, 12);
    assert_false(request.is_chunked);
    assert_int_equal(request.forwarded.n, strlen("198.51.100.7, 10.0.0.1"));
    assert_memory_equal(request.forwarded.at, "198.51.100.7, 10.0.0.1", request.forwarded.n);
    assert_int_equal(head_read(chunked, sizeof chunked - 1, &rules, &request, &problem), HEAD_HTTP);
    assert_true(request.is_chunked);
    assert_int_equal(request.length, 0);
    assert_null(request.forwarded.at);
}

static void what_proves_who_asks_is_there_once_and_not_too_long(void **state)
{
    (void)state;
    static const char *const names[] = { "Cookie", "Authorization" };
    char bytes[2 * HEAD_MAX_SECRET], value[HEAD_MAX_SECRET + 2];
    struct head_request request;
    struct problem problem;
    for (size_t i = 0; i < 2; i++) {
        for (size_t more = 0; more < 2; more++) {
            memset(value, 'a', sizeof value);
            value[HEAD_MAX_SECRET + more] = 0;
            int n = snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n" HOST "%s: %s \r\n\r\n", names[i], value);
            problem = (struct problem){ 0 };
            assert_int_equal(head_read(bytes, (size_t)n, &rules, &request, &problem), more ? HEAD_REFUSED : HEAD_HTTP);
            assert_int_equal(problem.type, more ? PROBLEM_HEADERS_TOO_LARGE : PROBLEM_NONE);
            assert_null(strstr(problem.detail, "aaa"));
        }
        const struct head_text *text = i == 0 ? &request.cookie : &request.authorization,
                               *other = i == 0 ? &request.authorization : &request.cookie;
        int n = snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n" HOST "%s: one two\t\r\n\r\n", names[i]);
        assert_int_equal(head_read(bytes, (size_t)n, &rules, &request, &problem), HEAD_HTTP);
        assert_int_equal(text->n, 7);
        assert_memory_equal(text->at, "one two", 7);
        assert_null(other->at);
        n = snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n" HOST "%s: one\r\n%s: one\r\n\r\n", names[i], names[i]);
        assert_int_equal(head_read(bytes, (size_t)n, &rules, &request, &problem), HEAD_REFUSED);
        assert_int_equal(problem_status(problem.type), 400);
        n = snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n" HOST "%s: secret\001\r\n\r\n", names[i]);
        assert_int_equal(head_read(bytes, (size_t)n, &rules, &request, &problem), HEAD_REFUSED);
        assert_non_null(strstr(problem.detail, names[i]));
        assert_null(strstr(problem.detail, "secret"));
    }
}

/* Reads a request with these headers on the proxy's connection, or on another one. */
static enum head_kind read_with(const char *fields, bool is_proxy, struct head_request *request,
                                struct problem *problem)
{
    static char bytes[HEAD_MAX_BYTES];
    struct head_rules rules_here = rules;
    rules_here.takes_identity = is_proxy;
    *problem = (struct problem){ 0 };
    int n = snprintf(bytes, sizeof bytes, "GET / HTTP/1.1\r\n" HOST "%s\r\n\r\n", fields);
    return head_read(bytes, (size_t)n, &rules_here, request, problem);
}

static void the_proxy_says_who_asks_and_nobody_else(void **state)
{
    (void)state;
    static const char *const names[] = { "X-Beamroom-User", "X-Beamroom-Name", "X-Beamroom-Groups",
                                         "X-Beamroom-Auth-Time" };
    char fields[300];
    struct head_request request;
    struct problem problem;
    for (size_t i = 0; i < 4; i++) {
        (void)snprintf(fields, sizeof fields, "%s: 17", names[i]);
        assert_int_equal(read_with(fields, true, &request, &problem), HEAD_HTTP);
        assert_int_equal(request.identity[i].n, 2);
        assert_int_equal(read_with(fields, false, &request, &problem), HEAD_REFUSED);
        assert_int_equal(problem_status(problem.type), 400);
        (void)snprintf(fields, sizeof fields, "%s:", names[i]);
        assert_int_equal(read_with(fields, true, &request, &problem), HEAD_HTTP);
        assert_int_equal(request.identity[i].n, 0);
        assert_int_equal(read_with(fields, false, &request, &problem), HEAD_REFUSED);
        (void)snprintf(fields, sizeof fields, "%s: 17\r\n%s: 17", names[i], names[i]);
        assert_int_equal(read_with(fields, true, &request, &problem), HEAD_REFUSED);
        (void)snprintf(fields, sizeof fields, "%s: 17", names[i]);
        for (char *at = fields; *at; at++) /* in turn each - is _ */
            if (*at == '-') {
                *at = '_';
                assert_int_equal(read_with(fields, true, &request, &problem), HEAD_REFUSED);
                assert_int_equal(read_with(fields, false, &request, &problem), HEAD_REFUSED);
                assert_int_equal(problem_status(problem.type), 400);
                *at = '-';
            }
        (void)snprintf(fields, sizeof fields, "x%s: 17", names[i] + 1); /* names have no case */
        assert_int_equal(read_with(fields, false, &request, &problem), HEAD_REFUSED);
    }
}

static void what_the_proxy_says_has_its_form(void **state)
{
    (void)state;
    static const struct {
        const char *fields;
        bool is_read;
    } cases[] = { { "X-Beamroom-User: anna.berg@example.org", true },
                  { "X-Beamroom-User: anna berg", false },
                  { "X-Beamroom-User: anna,berg", false },
                  { "X-Beamroom-User: (null)", false },
                  { "X-Beamroom-User: \xc3\xa4", false },
                  { "X-Beamroom-Name: \xc3\x84nne Berg", true },
                  { "X-Beamroom-Name: \xc4nne Berg", false },
                  { "X-Beamroom-Name: a\xc2\x85"
                    "b",
                    false },
                  { "X-Beamroom-Name: a\xc2", false },
                  { "X-Beamroom-Groups: planners, physics staff", true },
                  { "X-Beamroom-Groups: pl\xc3\xa4ner", false },
                  { "X-Beamroom-Auth-Time: 1795000000", true },
                  { "X-Beamroom-Auth-Time: 1795000000.5", false },
                  { "X-Beamroom-Auth-Time: -1", false },
                  { "X-Beamroom-Auth-Time: 12345678901", false } };
    struct head_request request;
    struct problem problem;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++)
        if ((read_with(cases[i].fields, true, &request, &problem) == HEAD_HTTP) != cases[i].is_read)
            fail_msg("%s", cases[i].fields);
    static const size_t most[] = { 64, 160, 4096 };
    static const char *const names[] = { "User", "Name", "Groups" };
    for (size_t i = 0; i < 3; i++)
        for (size_t more = 0; more < 2; more++) {
            char value[4098], fields[4200];
            memset(value, 'a', sizeof value);
            value[most[i] + more] = 0;
            (void)snprintf(fields, sizeof fields, "X-Beamroom-%s: %s", names[i], value);
            assert_int_equal(read_with(fields, true, &request, &problem), more ? HEAD_REFUSED : HEAD_HTTP);
        }
}

static void a_site_has_its_own_names_for_what_the_proxy_says(void **state)
{
    (void)state;
    static const char *const names[] = { "Remote-User", "Remote-Name", "Remote-Groups", "X-Auth-Time" };
    struct head_rules own = { .hosts = hosts, .identity_names = names, .takes_identity = true };
    static const char bytes[] = "GET / HTTP/1.1\r\n" HOST "Remote-User: anna\r\nX-Beamroom-User: bert\r\n\r\n";
    struct head_request request;
    struct problem problem;
    assert_int_equal(head_read(bytes, sizeof bytes - 1, &own, &request, &problem), HEAD_HTTP);
    assert_memory_equal(request.identity[HEAD_USER].at, "anna", 4);
    own.takes_identity = false;
    assert_int_equal(head_read(bytes, sizeof bytes - 1, &own, &request, &problem), HEAD_REFUSED);
    static const char *const free_names[] = { "Remote-User", "X-Forwarded-User", "X-Auth_User",
                                              "X-",          "Cookie",           "Host",
                                              "X-A B",       "X-Real-IP",        "" };
    for (size_t i = 0; i < sizeof free_names / sizeof free_names[0]; i++)
        assert_int_equal(head_may_be_identity(free_names[i]), i == 0);
}

static void more_parameters_than_the_library_has_memory_for_are_refused(void **state)
{
    (void)state;
    for (int more = 0; more < 2; more++) {
        char bytes[2000];
        struct problem problem;
        size_t n = (size_t)snprintf(bytes, sizeof bytes, "GET /a&b?c=d");
        for (int i = 1; i < HEAD_MAX_PARAMETERS + more; i++)
            n += (size_t)snprintf(bytes + n, sizeof bytes - n, "&c=?");
        n += (size_t)snprintf(bytes + n, sizeof bytes - n, " HTTP/1.1\r\n" HOST "\r\n");
        assert_int_equal(look(bytes, n, &problem), more ? HEAD_REFUSED : HEAD_HTTP);
        assert_int_equal(problem.type, more ? PROBLEM_TOO_LARGE : PROBLEM_NONE);
    }
}

static void who_does_not_come_to_an_end_is_told_what_is_missing(void **state)
{
    (void)state;
    struct problem problem;
    head_refuse_incomplete("GET /", 5, true, 0, &problem);
    assert_string_equal(problem.detail,
                        "the sender ended after 5 bytes of the request's head; expected is a request line");
    assert_int_equal(problem_status(problem.type), 400);
    head_refuse_incomplete("GET / HTTP/1.1\n", 15, false, 5000, &problem);
    assert_string_equal(
        problem.detail,
        "15 bytes of the request's head came in 5 s; expected is the empty line after the headers by then");
    assert_int_equal(problem_status(problem.type), 408);
}

static void a_refusal_is_a_whole_answer_of_http(void **state)
{
    (void)state;
    struct problem problem, again;
    for (int type = PROBLEM_NONE + 1; type < PROBLEM_N_TYPES; type++) {
        size_t n;
        problem_set(&problem, (enum problem_type)type, "", "", "a \"quoted\"\r\nsentence");
        problem.retry_after_ms = type == PROBLEM_LIMIT ? 1001 : 0;
        char *text = refusal_write(&problem, &n), *body = strstr(text, "\r\n\r\n");
        assert_int_equal(strlen(text), n);
        assert_non_null(body);
        assert_int_equal(strtol(strstr(text, "Content-Length: ") + 16, NULL, 10), strlen(body + 4));
        assert_int_equal(strtol(text + 9, NULL, 10), problem_status(problem.type));
        assert_non_null(strstr(text, "Content-Type: application/problem+json\r\n"));
        assert_int_equal(strstr(text, "Retry-After: 2\r\n") != NULL, type == PROBLEM_LIMIT);
        cJSON *json = json_read(body + 4, strlen(body + 4), &again);
        assert_true(problem_from_json(json, &again));
        assert_int_equal(again.type, type);
        assert_string_equal(again.detail, problem.detail);
        cJSON_Delete(json);
        free(text);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_whole_and_plain_goes_on),
        cmocka_unit_test(what_is_not_is_told_which_line_and_what_was_expected),
        cmocka_unit_test(the_limits_hold_to_the_byte),
        cmocka_unit_test(a_handshake_is_read_as_it_stands),
        cmocka_unit_test(an_origin_is_there_once_and_is_not_cut),
        cmocka_unit_test(a_beginning_is_waited_for_or_refused_as_the_whole_is),
        cmocka_unit_test(only_our_own_names_are_answered_to),
        cmocka_unit_test(a_server_for_its_own_machine_answers_no_other_name_and_no_proxy),
        cmocka_unit_test(a_whole_head_says_where_its_request_ends_and_for_whom_it_comes),
        cmocka_unit_test(what_proves_who_asks_is_there_once_and_not_too_long),
        cmocka_unit_test(the_proxy_says_who_asks_and_nobody_else),
        cmocka_unit_test(what_the_proxy_says_has_its_form),
        cmocka_unit_test(a_site_has_its_own_names_for_what_the_proxy_says),
        cmocka_unit_test(more_parameters_than_the_library_has_memory_for_are_refused),
        cmocka_unit_test(who_does_not_come_to_an_end_is_told_what_is_missing),
        cmocka_unit_test(a_refusal_is_a_whole_answer_of_http),
    };
    return cmocka_run_group_tests(tests, make_hosts, drop_hosts);
}

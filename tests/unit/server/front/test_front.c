/* The front alone, between clients and a library and a WebSocket side that this program makes up. */
#include "server/front/front.h"

#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "core/base/queue.h"
#include "tests/check.h"

enum { MAX_ENDS = 64, WAIT_MS = 10000 };

struct adopted {
    int socket;
    struct handshake handshake;
    void (*ended)(void *argument);
    void *argument;
};

/* A library that answers each request without a body with the address of its client. On the front's thread. */
struct world {
    struct front *front;
    struct hosts *hosts;
    int epoll;
    struct end {
        int socket;
        struct front_link *link;
    } ends[MAX_ENDS];
    struct queue *adopted;
    const char *path; /* of the proxy's socket */
};

static bool add(void *context, int socket)
{
    struct world *world = context;
    for (size_t i = 0; i < MAX_ENDS; i++) {
        if (world->ends[i].link)
            continue;
        world->ends[i] = (struct end){ socket, front_find(world->front, socket) };
        struct epoll_event event = { .events = EPOLLIN, .data.u64 = i };
        return epoll_ctl(world->epoll, EPOLL_CTL_ADD, socket, &event) == 0;
    }
    close(socket);
    return false;
}

static void answer(struct end *end)
{
    char bytes[4096], client[ADDRESS_TEXT], text[256];
    ssize_t n = recv(end->socket, bytes, sizeof bytes, 0);
    if (n <= 0) {
        close(end->socket);
        front_link_closed(end->link);
        *end = (struct end){ 0 };
        return;
    }
    front_client(end->link, client);
    const char *user = front_identity(end->link)->user;
    int n_text = snprintf(text, sizeof text, "HTTP/1.1 200 OK\r\nContent-Length: %zu\r\n\r\n%s%s",
                          strlen(user) + strlen(client), user, client);
    if (send(end->socket, text, (size_t)n_text, MSG_NOSIGNAL) == n_text)
        front_request_ended(end->link);
}

static bool run(void *context)
{
    struct world *world = context;
    struct epoll_event events[16];
    int n = epoll_wait(world->epoll, events, 16, 0);
    for (int i = 0; i < n; i++)
        answer(&world->ends[events[i].data.u64]);
    return n == 16;
}

static void adopt(void *context, int socket, const struct handshake *handshake, void (*ended)(void *argument),
                  void *argument)
{
    struct world *world = context;
    struct adopted *adopted = malloc(sizeof *adopted);
    assert_non_null(adopted);
    *adopted = (struct adopted){ socket, *handshake, ended, argument };
    assert_true(queue_try_put(world->adopted, adopted));
}

/* Takes a cookie for the name of its user. */
static bool identify(void *context, const struct credentials *credentials, struct identity *identity,
                     struct problem *problem)
{
    (void)context;
    assert_int_equal(identity->source, IDENTITY_NOBODY);
    assert_string_equal(identity->user, "");
    assert_int_equal(credentials->is_secure,
                     credentials->is_from_proxy || strncmp(credentials->address, "127.", 4) == 0);
    assert_int_equal(credentials->is_https, credentials->is_from_proxy);
    if (credentials->user)
        (void)snprintf(identity->user, sizeof identity->user, "%s/%s/%s/%s", credentials->user, credentials->name,
                       credentials->groups, credentials->auth_time);
    if (credentials->authorization)
        return problem_set(problem, PROBLEM_FORBIDDEN, "", "", "no such token");
    if (!credentials->cookie)
        return true;
    identity->source = IDENTITY_PASSWORD;
    (void)snprintf(identity->user, sizeof identity->user, "%s", credentials->cookie);
    return true;
}

static int set_up(void **state)
{
    static struct world world;
    struct error err = { 0 };
    world = (struct world){ .hosts = hosts_create(NULL, 0), .epoll = epoll_create1(EPOLL_CLOEXEC) };
    world.adopted = queue_create(MAX_ENDS, free);
    static struct local_socket local;
    local = (struct local_socket){ .mode = 0600 };
    (void)snprintf(local.path, sizeof local.path, "/tmp/beamroom-test-front-%d", (int)getpid());
    const struct front_options options = { .listen = "127.0.0.1:0",
                                           .sockets = &local,
                                           .n_sockets = 1,
                                           .proxy = { .has_user = true, .user = geteuid() },
                                           .takes_identity = true,
                                           .hosts = world.hosts,
                                           .adopt = adopt,
                                           .identify = identify,
                                           .context = &world };
    world.path = local.path;
    world.front = front_create(&options, &err);
    assert_non_null(world.front);
    const struct front_library library = { .add = add, .run = run, .poll_fd = world.epoll, .context = &world };
    assert_true(front_serve(world.front, &library, &err));
    *state = &world;
    return 0;
}

static int tear_down(void **state)
{
    struct world *world = *state;
    front_close(world->front);
    front_stop(world->front);
    for (size_t i = 0; i < MAX_ENDS; i++)
        if (world->ends[i].link) {
            close(world->ends[i].socket);
            front_link_closed(world->ends[i].link);
        }
    front_destroy(world->front);
    queue_destroy(world->adopted);
    hosts_destroy(world->hosts);
    close(world->epoll);
    return 0;
}

/* Gives one end of a pair to the front as a connection from this address; returns the other. */
static int take(struct front *front, const char *from)
{
    int pair[2];
    struct address address;
    assert_true(address_read(from, strlen(from), &address));
    assert_int_equal(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, pair), 0);
    front_take(front, pair[0], &address);
    return pair[1];
}

static void say(int socket, const char *text)
{
    assert_int_equal(send(socket, text, strlen(text), MSG_NOSIGNAL), strlen(text));
}

/* Waits until the text received ends with this; or until the end for NULL. */
static void hear(int socket, const char *ending, char text[4096])
{
    size_t n_text = 0, n_ending = ending ? strlen(ending) : 0;
    for (;;) {
        struct pollfd polled = { .fd = socket, .events = POLLIN };
        assert_int_equal(poll(&polled, 1, WAIT_MS), 1);
        ssize_t n = recv(socket, text + n_text, 4095 - n_text, 0);
        n_text += n > 0 ? (size_t)n : 0;
        text[n_text] = 0;
        if (ending && n_text >= n_ending && strcmp(text + n_text - n_ending, ending) == 0)
            return;
        if (n <= 0) {
            assert_null(ending);
            return;
        }
    }
}

#define HOST "Host: localhost\r\n"
#define SHAKE \
    "GET /api/v1/rooms/7q4k-m2wz/ws HTTP/1.1\r\n" HOST "Connection: Upgrade\r\nUpgrade: websocket\r\n" \
    "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAECAwQFBgcICQoLDA0ODw==\r\n\r\n"

static void a_taken_stream_is_served_as_its_client_again_and_again(void **state)
{
    struct world *world = *state;
    char text[4096];
    int client = take(world->front, "192.0.2.7");
    for (int i = 0; i < 3; i++) {
        say(client, "GET /healthz HT");
        say(client, "TP/1.1\r\n" HOST "\r\n");
        hear(client, "192.0.2.7", text);
        assert_memory_equal(text, "HTTP/1.1 200", 12);
    }
    close(client);
}

static void a_handshake_is_handed_on_with_its_bytes_and_its_client_first_and_later(void **state)
{
    struct world *world = *state;
    char text[4096];
    for (int is_later = 0; is_later < 2; is_later++) {
        int client = take(world->front, "2001:db8::9");
        if (is_later) {
            say(client, "GET /healthz HTTP/1.1\r\n" HOST "\r\n");
            hear(client, "2001:db8::9", text);
        }
        say(client, SHAKE "\x81\x80");
        struct adopted *adopted = queue_take(world->adopted, WAIT_MS);
        assert_non_null(adopted);
        assert_string_equal(adopted->handshake.client, "2001:db8::9");
        assert_string_equal(adopted->handshake.room_id, "7q4k-m2wz");
        assert_int_equal(adopted->handshake.n_head, strlen(SHAKE));
        assert_int_equal(recv(adopted->socket, text, sizeof text, 0), strlen(SHAKE) + 2);
        assert_memory_equal(text, SHAKE "\x81\x80", strlen(SHAKE) + 2);
        close(adopted->socket);
        adopted->ended(adopted->argument);
        free(adopted);
        close(client);
    }
}

static void each_request_is_of_who_made_it_also_on_one_connection(void **state)
{
    struct world *world = *state;
    char text[4096];
    int client = take(world->front, "127.0.0.1");
    say(client, "GET / HTTP/1.1\r\n" HOST "Cookie: anna\r\n\r\nGET / HTTP/1.1\r\n" HOST "\r\n");
    hear(client, "\r\n\r\n127.0.0.1", text);
    assert_non_null(strstr(text, "\r\n\r\nanna127.0.0.1HTTP/1.1 200"));
    say(client, "GET / HTTP/1.1\r\n" HOST "Cookie: bert\r\n\r\n");
    hear(client, "\r\n\r\nbert127.0.0.1", text);
    char shake[sizeof SHAKE + 40];
    (void)snprintf(shake, sizeof shake, "%.*sCookie: cleo\r\n\r\n", (int)strlen(SHAKE) - 2, SHAKE);
    say(client, shake);
    struct adopted *adopted = queue_take(world->adopted, WAIT_MS);
    assert_non_null(adopted);
    assert_string_equal(adopted->handshake.identity.user, "cleo");
    close(adopted->socket);
    adopted->ended(adopted->argument);
    free(adopted);
    close(client);
}

static void who_is_not_let_in_is_refused_before_the_library_hears_of_it(void **state)
{
    struct world *world = *state;
    char text[4096];
    int client = take(world->front, "192.0.2.7");
    say(client, "POST / HTTP/1.1\r\n" HOST "Content-Length: 1000000\r\nAuthorization: Bearer x\r\n\r\n12345");
    hear(client, NULL, text);
    assert_memory_equal(text, "HTTP/1.1 403", 12);
    assert_null(world->ends[0].link);
    close(client);
    client = take(world->front, "192.0.2.7");
    char shake[sizeof SHAKE + 40];
    (void)snprintf(shake, sizeof shake, "%.*sAuthorization: x\r\n\r\n", (int)strlen(SHAKE) - 2, SHAKE);
    say(client, shake);
    hear(client, NULL, text);
    assert_memory_equal(text, "HTTP/1.1 403", 12);
    assert_null(queue_try_take(world->adopted));
    close(client);
}

static void the_proxy_at_the_socket_says_who_asks_and_from_where(void **state)
{
    struct world *world = *state;
    struct sockaddr_un address = { .sun_family = AF_UNIX };
    char text[4096];
    (void)snprintf(address.sun_path, sizeof address.sun_path, "%s", world->path);
    int proxy = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_int_equal(connect(proxy, (struct sockaddr *)&address, sizeof address), 0);
    say(proxy, "GET / HTTP/1.1\r\n" HOST
               "X-Forwarded-For: 198.51.100.1, 192.0.2.77\r\nX-Beamroom-User: anna\r\nX-Beamroom-Name: A\r\n"
               "X-Beamroom-Groups: a,b\r\nX-Beamroom-Auth-Time: 7\r\n\r\n");
    hear(proxy, "\r\n\r\nanna/A/a,b/7192.0.2.77", text);
    say(proxy, "GET / HTTP/1.1\r\n" HOST "\r\n"); /* the next request is of nobody, from nowhere */
    hear(proxy, "Content-Length: 0\r\n\r\n", text);
    close(proxy);
    int other = take(world->front, "127.0.0.1");
    say(other, "GET / HTTP/1.1\r\n" HOST "X-Beamroom-User: anna\r\n\r\n");
    hear(other, NULL, text);
    assert_memory_equal(text, "HTTP/1.1 400", 12);
    close(other);
}

static void one_websocket_more_than_an_address_may_have_is_refused(void **state)
{
    struct world *world = *state;
    struct adopted *all[FRONT_MAX_WEBSOCKETS_PER_ADDRESS];
    int clients[FRONT_MAX_WEBSOCKETS_PER_ADDRESS + 1];
    char text[4096];
    for (size_t i = 0; i <= FRONT_MAX_WEBSOCKETS_PER_ADDRESS; i++) {
        clients[i] = take(world->front, "192.0.2.8");
        say(clients[i], SHAKE);
        if (i < FRONT_MAX_WEBSOCKETS_PER_ADDRESS)
            assert_non_null(all[i] = queue_take(world->adopted, WAIT_MS));
    }
    hear(clients[FRONT_MAX_WEBSOCKETS_PER_ADDRESS], NULL, text);
    assert_memory_equal(text, "HTTP/1.1 429", 12);
    all[0]->ended(all[0]->argument);
    int client = take(world->front, "192.0.2.8");
    say(client, SHAKE);
    struct adopted *adopted = queue_take(world->adopted, WAIT_MS);
    assert_non_null(adopted);
    close(adopted->socket);
    free(adopted);
    close(client);
    for (size_t i = 0; i <= FRONT_MAX_WEBSOCKETS_PER_ADDRESS; i++)
        close(clients[i]);
    for (size_t i = 0; i < FRONT_MAX_WEBSOCKETS_PER_ADDRESS; i++) {
        close(all[i]->socket);
        free(all[i]);
    }
}

static void after_the_door_is_closed_a_stream_is_closed_and_a_handshake_is_refused(void **state)
{
    struct world *world = *state;
    char text[4096];
    int old = take(world->front, "192.0.2.9"), waiting = take(world->front, "192.0.2.9");
    say(old, "GET /healthz HTTP/1.1\r\n" HOST "\r\n");
    hear(old, "192.0.2.9", text);
    front_close(world->front);
    hear(waiting, NULL, text);
    assert_string_equal(text, "");
    int late = take(world->front, "192.0.2.9");
    hear(late, NULL, text);
    assert_string_equal(text, "");
    say(old, "GET /healthz HTTP/1.1\r\n" HOST "\r\n");
    hear(old, "192.0.2.9", text);
    say(old, SHAKE);
    hear(old, NULL, text);
    assert_memory_equal(text, "HTTP/1.1 503", 12);
    assert_null(queue_try_take(world->adopted));
    close(old);
    close(waiting);
    close(late);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_taken_stream_is_served_as_its_client_again_and_again, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_handshake_is_handed_on_with_its_bytes_and_its_client_first_and_later, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(each_request_is_of_who_made_it_also_on_one_connection, set_up, tear_down),
        cmocka_unit_test_setup_teardown(who_is_not_let_in_is_refused_before_the_library_hears_of_it, set_up, tear_down),
        cmocka_unit_test_setup_teardown(the_proxy_at_the_socket_says_who_asks_and_from_where, set_up, tear_down),
        cmocka_unit_test_setup_teardown(one_websocket_more_than_an_address_may_have_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(after_the_door_is_closed_a_stream_is_closed_and_a_handshake_is_refused, set_up,
                                        tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

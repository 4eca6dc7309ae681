/* The HTTP side of the API: libmicrohttpd behind the front, its requests, and the answers of the net thread. */
#include "server/http/http.h"

#include <ctype.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/socket.h>
#include <sys/un.h>

#include "core/base/clock.h"
#include "core/base/gate.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/queue.h"
#include "server/front/front.h"
#include "server/http/api.h"
#include "server/http/api_access.h"
#include "server/http/etag.h"
#include "server/http/feed.h"
#include "server/http/files.h"
#include "server/http/intake.h"

/* Never reached: the front's limit is lower, also with connections whose end the library has not noticed. */
static const unsigned LIBRARY_LIMIT = 1000000;

enum { FEED_BLOCK = 64 << 10 }; /* bytes of an answer without an end that are made at once */

enum {
    MAX_ANSWERED = 1 << 16
}; /* requests that are answered and not resumed: at most one per connection, ended ones included */

struct http {
    struct net *net;
    bool is_secure_alone; /* as in http_options */
    struct api *api;
    struct files *files;
    struct intake *intake;
    struct front *front;
    struct MHD_Daemon *daemon;
    struct queue *moved; /* requests whose archives the disk has taken, which are resumed likewise */
    struct queue *
        answered; /* answered requests, whose connections the HTTP thread resumes: the library allows no other thread */
    struct request *feeding; /* requests whose answers have no end */
    struct gate *posting;    /* passed by each net_post; closed by http_stop_posting */
    size_t
        max_archive_dropped; /* bytes of a refused archive that are read, so that its sender comes to read the answer */
};

/* A request in the library, and its call. */
struct request {
    struct call *call;
    struct http *http;
    struct MHD_Connection *connection;
    struct front_link *link;
    bool is_posted, is_answered, is_archive;
    struct request *next_feeding; /* call->feed is set */
    bool is_suspended;            /* the feed has nothing for the screen */
    struct intake_file *archive;  /* while it is received */
};

/* The page runs only its own scripts and styles, and may not be framed. */
#define POLICY(sockets) \
    "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' " sockets \
    "; frame-ancestors 'none'; base-uri 'none'; form-action 'self'"
static const char content_policy[] = POLICY("ws: wss:"), secure_content_policy[] = POLICY("wss:");

static enum MHD_Result send_response(const struct request *request, unsigned status, struct MHD_Response *response)
{
    struct MHD_Connection *connection = request->connection;
    if (request->http->is_secure_alone && request->call->is_secure)
        MHD_add_response_header(response, "Strict-Transport-Security", "max-age=31536000");
    MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
    MHD_add_response_header(response, "Referrer-Policy", "no-referrer");
    MHD_add_response_header(response, "Cross-Origin-Resource-Policy", "same-origin");
    enum MHD_Result sent = MHD_queue_response(connection, status, response);
    MHD_destroy_response(response);
    return sent;
}

static enum MHD_Result send_file(const struct request *request, const struct file *file)
{
    struct MHD_Connection *connection = request->connection;
    const char *accept = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Accept-Encoding");
    const char *known = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "If-None-Match");
    enum content_coding coding = file_coding(file, accept);
    const struct file_form *form = &file->forms[coding];
    bool is_fresh = known && etag_is_listed(known, form->etag, true);
    struct MHD_Response *response =
        MHD_create_response_from_buffer(is_fresh ? 0 : form->n_bytes, form->bytes,
                                        MHD_RESPMEM_PERSISTENT); /* files outlives the library's daemon */
    MHD_add_response_header(response, "ETag", form->etag);
    if (file->has_forms)
        MHD_add_response_header(response, "Vary", "Accept-Encoding");
    if (coding != CODING_IDENTITY)
        MHD_add_response_header(response, "Content-Encoding", coding_name(coding));
    /* no-cache is kept but revalidated: a page never mixes versions */
    MHD_add_response_header(response, "Cache-Control",
                            file->is_immutable ? "public, max-age=31536000, immutable" : "no-cache");
    MHD_add_response_header(response, "Content-Type", file->media_type);
    MHD_add_response_header(response, "Content-Security-Policy",
                            request->call->is_secure ? secure_content_policy : content_policy);
    return send_response(request, is_fresh ? 304 : 200, response);
}

/* Called by libmicrohttpd for more bytes of an answer without an end. */
static ssize_t read_feed(void *context, uint64_t at, char *bytes, size_t size)
{
    struct request *request = context;
    struct feed *feed = request->call->feed;
    (void)at;
    if (front_link_is_gone(request->link))
        return MHD_CONTENT_READER_END_WITH_ERROR;
    if (feed_is_ended(feed) && !feed_is_inside(feed))
        return MHD_CONTENT_READER_END_OF_STREAM;
    size_t n = feed_read(feed, bytes, size, front_link_is_free(request->link), clock_now_us());
    request->is_suspended = n == 0;
    if (request->is_suspended)
        MHD_suspend_connection(request->connection);
    return (ssize_t)n;
}

static void resume_feeds(struct http *http, bool all)
{
    int64_t now_us = clock_now_us();
    for (struct request *request = http->feeding; request; request = request->next_feeding) {
        const struct feed *feed = request->call->feed;
        if (!request->is_suspended ||
            !(all || feed_is_ended(feed) || front_link_is_gone(request->link) ||
              (feed_is_due(feed, now_us) && (feed_is_eager(feed) || front_link_is_free(request->link)))))
            continue;
        request->is_suspended = false;
        MHD_resume_connection(request->connection);
    }
}

static void remove_feeding(struct request *request)
{
    struct request **at = &request->http->feeding;
    while (*at && *at != request)
        at = &(*at)->next_feeding;
    if (*at)
        *at = request->next_feeding;
}

static struct MHD_Response *make_response(struct request *request)
{
    struct call *call = request->call;
    if (call->feed) {
        request->next_feeding = request->http->feeding;
        request->http->feeding = request;
        return MHD_create_response_from_callback(MHD_SIZE_UNKNOWN, FEED_BLOCK, read_feed, request, NULL);
    }
    struct MHD_Response *response =
        call->shared ? MHD_create_response_from_buffer_with_free_callback_cls(call->n_bytes, call->bytes,
                                                                              call_bytes_unref, call->shared)
                     : MHD_create_response_from_buffer(call->n_bytes, call->bytes, MHD_RESPMEM_MUST_FREE);
    call->shared = NULL;
    call->bytes = NULL;
    return response;
}

static enum MHD_Result send_answer(struct request *request)
{
    struct call *call = request->call;
    struct MHD_Response *response = make_response(request);
    if (call->media_type[0])
        MHD_add_response_header(response, "Content-Type", call->media_type);
    MHD_add_response_header(response, "Cache-Control", "no-store");
    for (size_t i = 0; i < call->n_headers; i++)
        MHD_add_response_header(response, call->headers[i].name, call->headers[i].value);
    api_count(request->http->api, call->status, clock_now_us() - call->started_us);
    return send_response(request, (unsigned)call->status, response);
}

static void wake_reader(void *front)
{
    front_wake(front);
}

/* Called on the thread that completed the answer. */
static void call_finished(struct call *call)
{
    struct request *request = call->connection;
    struct front *front = request->http->front;
    if (!queue_try_put(request->http->answered,
                       request)) /* cannot be: the queue holds more than there are connections */
        abort();
    front_wake(front); /* from here on the request belongs to the HTTP thread */
}

static void run_call(struct net *net, void *argument)
{
    struct request *request = argument;
    (void)net;
    api_handle(request->http->api, request->call);
}

static enum MHD_Result add_query(void *context, enum MHD_ValueKind kind, const char *name, const char *value)
{
    struct call *call = context;
    (void)kind;
    size_t n = value ? strlen(value) : 0;
    if (call->n_query == CALL_MAX_QUERY || n > CALL_MAX_VALUE || strlen(name) > 64) {
        problem_set(&call->early, PROBLEM_TOO_LARGE, "", "", "at most %d parameters of %d bytes are read",
                    CALL_MAX_QUERY, CALL_MAX_VALUE);
        return MHD_NO;
    }
    call->query[call->n_query++] = (struct call_pair){ mem_copy_text(name), mem_copy_text(value ? value : "") };
    return MHD_YES;
}

static char *copy_header(struct MHD_Connection *connection, const char *name)
{
    const char *value = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, name);
    return value && strlen(value) <= CALL_MAX_VALUE ? mem_copy_text(value) : NULL;
}

static enum call_method method_of(const char *word)
{
    static const char *const words[] = { "GET", "HEAD", "POST", "PATCH", "DELETE" };
    for (int i = 0; i < CALL_OTHER; i++)
        if (strcmp(word, words[i]) == 0)
            return (enum call_method)i;
    return CALL_OTHER;
}

/* Decodes %XX in place, but not %00: the text would end there and pass for a shorter one. */
static size_t unescape(void *context, struct MHD_Connection *connection, char *text)
{
    (void)context;
    (void)connection;
    char *out = text;
    for (const char *at = text; *at; out++) {
        unsigned value;
        if (at[0] == '%' && isxdigit((unsigned char)at[1]) && isxdigit((unsigned char)at[2]) &&
            sscanf(at + 1, "%2x", &value) == 1 && value != 0) {
            *out = (char)value;
            at += 3;
        } else {
            *out = *at++;
        }
    }
    *out = 0;
    return (size_t)(out - text);
}

/* The path of an address, also of one in absolute form (RFC 9112 3.2.2), which proxies send. */
static const char *path_of(const char *url)
{
    if (strncasecmp(url, "http://", 7) != 0)
        return url;
    const char *path = strchr(url + 7, '/');
    return path ? path : "/";
}

/* Refuses a request whose body is being received: answers at once, and its connection counts no longer. */
static enum MHD_Result refuse_body(struct request *request)
{
    struct http *http = request->http;
    struct call *call = request->call;
    intake_drop(request->archive);
    request->archive = NULL;
    api_count(http->api, problem_status(call->early.type), clock_now_us() - call->started_us);
    front_refuse(request->link, &call->early, request->is_archive ? http->max_archive_dropped : FRONT_MAX_DROPPED);
    return MHD_NO;
}

/* On the spool's thread. */
static void disk_moved(void *context)
{
    struct request *request = context;
    (void)queue_try_put(request->http->moved, request);
    front_wake(request->http->front);
}

/* Begins to receive an archive as the body. */
static bool begin_archive(struct request *request)
{
    struct call *call = request->call;
    const char *length = MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, "Content-Length");
    unsigned long long n = length ? strtoull(length, NULL, 10) : 0;
    request->is_archive = true;
    if (call->early.type == PROBLEM_NONE && api_access_may_upload(request->http->api, call, &call->early))
        request->archive = intake_begin(request->http->intake, call,
                                        !length         ? -1
                                        : n < INT64_MAX ? (int64_t)n
                                                        : INT64_MAX,
                                        disk_moved, request, &call->early);
    return request->archive != NULL;
}

/* True if the announced length of the body is allowed. */
static bool check_length(struct request *request)
{
    const char *length = MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, "Content-Length");
    unsigned long long n = length ? strtoull(length, NULL, 10) : 0;
    return n <= CALL_MAX_BODY || problem_set(&request->call->early, PROBLEM_TOO_LARGE, "", "",
                                             "a body of %llu bytes; at most %d are read", n, CALL_MAX_BODY);
}

/* Takes bytes of the body of which *n are there; leaves in *n how many it did not take, which come again. */
static bool add_archive(struct request *request, const char *bytes, size_t *n)
{
    size_t n_taken;
    if (!intake_add(request->archive, bytes, *n, &n_taken, &request->call->early))
        return false;
    *n -= n_taken;
    if (*n > 0)
        MHD_suspend_connection(request->connection);
    return true;
}

/* Returns false while the disk has not taken all of it. */
static bool finish_archive(struct request *request)
{
    struct call *call = request->call;
    if (request->archive && !intake_end(request->archive)) {
        MHD_suspend_connection(request->connection);
        return false;
    }
    if (request->archive)
        call->upload_path = intake_finish(request->archive, &call->n_upload, &call->early);
    request->archive = NULL;
    return true;
}

static struct request *request_create(struct http *http, struct MHD_Connection *connection, const char *url,
                                      const char *method)
{
    struct request *request = mem_new(sizeof *request);
    struct call *call = request->call = call_create();
    request->http = http;
    request->connection = connection;
    request->link = MHD_get_connection_info(connection, MHD_CONNECTION_INFO_SOCKET_CONTEXT)->socket_context;
    call->connection = request;
    call->finished = call_finished;
    call->wake = wake_reader;
    call->wake_context = http->front;
    call->is_secure = request->link && front_link_is_encrypted(request->link);
    call->is_https = request->link && front_link_is_https(request->link);
    call->method = method_of(method);
    call_set_path(call, path_of(url));
    MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, add_query, call);
    if (request->link) {
        front_client(request->link, call->client);
        call->identity = *front_identity(request->link);
    }
    call->if_match = copy_header(connection, "If-Match");
    call->member = copy_header(connection, "Beamroom-Member");
    call->key = copy_header(connection, "Idempotency-Key");
    call->last_event = copy_header(connection, "Last-Event-ID");
    call->if_none_match = copy_header(connection, "If-None-Match");
    call->content_type = copy_header(connection, "Content-Type");
    call->origin = copy_header(connection, "Origin");
    call->host = copy_header(connection, "Host");
    call->fetch_site = copy_header(connection, "Sec-Fetch-Site");
    return request;
}

/* Appends bytes to the body. */
static bool add_body(struct request *request, const char *bytes, size_t *n_bytes)
{
    struct call *call = request->call;
    const size_t n = *n_bytes;
    *n_bytes = 0;
    if (call->n_body + n > CALL_MAX_BODY)
        return problem_set(&call->early, PROBLEM_TOO_LARGE, "", "", "a body of more than %d bytes", CALL_MAX_BODY);
    char *larger = realloc(call->body, call->n_body + n);
    if (!larger)
        return problem_set(&call->early, PROBLEM_INTERNAL, "", "", "no memory for the body");
    memcpy(larger + call->n_body, bytes, n);
    call->body = larger;
    call->n_body += n;
    return true;
}

/* Posts the request to the net thread; the connection sleeps until the answer is there. */
static void post_request(struct http *http, struct request *request)
{
    MHD_suspend_connection(request->connection);
    if (gate_enter(http->posting)) {
        net_post(http->net, run_call, request);
        gate_leave(http->posting);
    } else {
        struct problem problem;
        problem_set(&problem, PROBLEM_BUSY, "", "", "the server is being stopped");
        call_answer_problem(request->call, &problem);
    }
}

/* Called by libmicrohttpd: first with the headers, then for each part of the body, then until a response is queued. */
static enum MHD_Result handle(void *context, struct MHD_Connection *connection, const char *url, const char *method,
                              const char *version, const char *upload, size_t *n_upload, void **state)
{
    struct http *http = context;
    struct request *request = *state;
    (void)version;
    if (!request) {
        *state = request = request_create(http, connection, url, method);
        return (intake_is_for(request->call) ? begin_archive(request) : check_length(request)) ? MHD_YES
                                                                                               : refuse_body(request);
    }
    if (*n_upload) {
        bool goes_on =
            request->is_archive ? add_archive(request, upload, n_upload) : add_body(request, upload, n_upload);
        return goes_on ? MHD_YES : refuse_body(request);
    }
    if (request->is_answered)
        return send_answer(request);
    if (!request->is_posted) {
        enum call_method verb = request->call->method;
        bool is_for_file =
            http->files && request->call->early.type == PROBLEM_NONE && (verb == CALL_GET || verb == CALL_HEAD);
        const struct file *file = is_for_file ? files_find(http->files, request->call->path) : NULL;
        if (file)
            return send_file(request, file);
        if (!finish_archive(request))
            return MHD_YES;
        request->is_posted = true;
        post_request(http, request);
    }
    return MHD_YES;
}

static void request_destroy(struct request *request)
{
    call_destroy(request->call);
    free(request);
}

/* The net thread's. */
static void screen_left(struct net *net, void *argument)
{
    struct request *request = argument;
    (void)net;
    api_display_left(request->http->api, request->call->feed);
    request_destroy(request);
}

static void completed(void *context, struct MHD_Connection *connection, void **state,
                      enum MHD_RequestTerminationCode code)
{
    struct http *http = context;
    struct request *request = *state;
    (void)connection;
    if (!request)
        return;
    if (code == MHD_REQUEST_TERMINATED_COMPLETED_OK)
        front_request_ended(request->link);
    intake_drop(request->archive);
    *state = NULL;
    remove_feeding(request);
    if (request->call->feed && gate_enter(http->posting)) {
        net_post(http->net, screen_left, request); /* which frees it */
        gate_leave(http->posting);
        return;
    }
    feed_leave(request->call->feed); /* the net thread has left it, or is about to */
    request_destroy(request);
}

static void connection_changed(void *context, struct MHD_Connection *connection, void **link,
                               enum MHD_ConnectionNotificationCode code)
{
    struct http *http = context;
    if (code == MHD_CONNECTION_NOTIFY_STARTED)
        *link =
            front_find(http->front, MHD_get_connection_info(connection, MHD_CONNECTION_INFO_CONNECTION_FD)->connect_fd);
    else if (*link)
        front_link_closed(*link);
}

/* Callbacks of the front. */
static bool add_to_library(void *context, int socket)
{
    struct http *http = context;
    const struct sockaddr_un pair = { .sun_family = AF_UNIX };
    return MHD_add_connection(http->daemon, socket, (const struct sockaddr *)&pair, sizeof pair.sun_family) == MHD_YES;
}

static void resume_answered(struct http *http)
{
    for (struct request *request; (request = queue_try_take(http->answered));) {
        request->is_answered = true;
        MHD_resume_connection(request->connection);
    }
}

static void resume_moved(struct http *http)
{
    for (struct request *request; (request = queue_try_take(http->moved));)
        MHD_resume_connection(request->connection);
}

static bool run_library(void *context)
{
    struct http *http = context;
    unsigned MHD_LONG_LONG wait_ms;
    resume_moved(http);
    resume_answered(http);
    resume_feeds(http, false);
    (void)MHD_run(http->daemon);
    return MHD_get_timeout(http->daemon, &wait_ms) == MHD_YES && wait_ms == 0;
}

struct http *http_create(struct net *net, struct front *front, const struct http_options *options, struct error *err)
{
    struct http *http = mem_new(sizeof *http);
    http->net = net;
    http->front = front;
    http->is_secure_alone = options->is_secure_alone;
    http->api = api_create(net, options->auth, options->upload_folder ? options->max_upload_bytes : 0, &options->doors);
    http->max_archive_dropped = options->max_upload_bytes > HTTP_MIN_ARCHIVE_DROPPED ? (size_t)options->max_upload_bytes
                                                                                     : HTTP_MIN_ARCHIVE_DROPPED;
    http->posting = gate_create();
    http->answered = queue_create(MAX_ANSWERED, NULL);
    http->moved = queue_create(INTAKE_MAX_FILES, NULL);
    http->intake = intake_create(options->upload_folder, options->max_upload_bytes, options->disk_reserve_bytes, err);
    if (!http->intake)
        goto fail;
    if (options->web_folder) {
        http->files = files_create(options->web_folder, err);
        if (!http->files)
            goto fail;
    }
    /* The library's log is off: with each answer it reports that a pair of sockets has no options of TCP. The library's
     * own limits on connections and time are off: the front has both, and the library (0.9.75) hangs for ever when its
     * limit on connections is reached. */
    http->daemon = MHD_start_daemon(MHD_USE_EPOLL | MHD_USE_NO_LISTEN_SOCKET | MHD_ALLOW_SUSPEND_RESUME, 0, NULL, NULL,
                                    handle, http, MHD_OPTION_NOTIFY_COMPLETED, completed, http,
                                    MHD_OPTION_NOTIFY_CONNECTION, connection_changed, http, MHD_OPTION_CONNECTION_LIMIT,
                                    LIBRARY_LIMIT, MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)128 * 1024,
                                    MHD_OPTION_UNESCAPE_CALLBACK, unescape, NULL, MHD_OPTION_END);
    const union MHD_DaemonInfo *polled =
        http->daemon ? MHD_get_daemon_info(http->daemon, MHD_DAEMON_INFO_EPOLL_FD) : NULL;
    if (!polled) {
        error_set(err, ERROR_IO, "the HTTP library did not start");
        goto fail;
    }
    const struct front_library library = {
        .add = add_to_library, .run = run_library, .poll_fd = polled->epoll_fd, .context = http
    };
    if (!front_serve(http->front, &library, err))
        goto fail;
    return http;
fail:
    http_destroy(http);
    return NULL;
}

void http_stop_posting(struct http *http)
{
    gate_close(http->posting);
}

void http_stop_printing(struct http *http)
{
    if (http)
        api_stop_printing(http->api);
}

void http_destroy(struct http *http)
{
    if (!http)
        return;
    front_stop(http->front);
    if (http->intake)
        intake_wait(http->intake);
    resume_moved(http);
    resume_answered(http);
    resume_feeds(http, true);
    if (http->daemon)
        MHD_stop_daemon(http->daemon);
    gate_destroy(http->posting);
    files_destroy(http->files);
    intake_destroy(http->intake);
    queue_destroy(http->moved);
    queue_destroy(http->answered);
    api_destroy(http->api);
    free(http);
}

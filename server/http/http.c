#include "server/http/http.h"

#include <ctype.h>
#include <fcntl.h>
#include <microhttpd.h>
#include <pthread.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "core/base/clock.h"
#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/http/api.h"
#include "server/http/files.h"
#include "server/http/head.h"
#include "server/http/intake.h"
#include "server/wire/refusal.h"

struct http {
    struct net *net;
    struct api *api;
    struct files *files;
    struct intake *intake;
    const struct hosts *hosts;
    struct MHD_Daemon *daemon;
    pthread_mutex_t asking; /* held while a task is posted: after http_stop_asking none is */
    size_t max_archive_dropped; /* bytes of an archive beyond the limit that are read: a sender who streams hears why it was refused */
    bool is_stopping;
    size_t n_refused; /* connections, since the log said so last */
    int64_t logged_us;
};

/* A request: the call, and where it stands. */
struct request {
    struct call *call;
    struct http *http;
    struct MHD_Connection *connection;
    atomic_bool is_answered; /* set on the net thread before the connection is resumed */
    bool is_posted, is_archive;
    struct intake_file *archive; /* while it is received */
    size_t n_dropped; /* bytes of the body beyond what is read */
};

/* The page runs its own scripts and styles only, and nobody may frame it. */
static const char content_policy[] =
    "default-src 'self'; img-src 'self' blob: data:; connect-src 'self' ws: wss:; frame-ancestors 'none'; base-uri 'none'; form-action 'self'";

static enum MHD_Result send_response(struct MHD_Connection *connection, unsigned status, struct MHD_Response *response)
{
    MHD_add_response_header(response, "X-Content-Type-Options", "nosniff");
    MHD_add_response_header(response, "Referrer-Policy", "no-referrer");
    MHD_add_response_header(response, "Cross-Origin-Resource-Policy", "same-origin");
    enum MHD_Result sent = MHD_queue_response(connection, status, response);
    MHD_destroy_response(response);
    return sent;
}

static enum MHD_Result send_file(struct MHD_Connection *connection, const struct file *file)
{
    const char *known = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "If-None-Match");
    bool is_fresh = known && strcmp(known, file->etag) == 0;
    struct MHD_Response *response =
        MHD_create_response_from_buffer(is_fresh ? 0 : file->n_bytes, file->bytes, MHD_RESPMEM_PERSISTENT); /* files outlive the daemon */
    MHD_add_response_header(response, "ETag", file->etag);
    MHD_add_response_header(response, "Cache-Control", "no-cache"); /* kept, but asked about: a page never mixes versions */
    MHD_add_response_header(response, "Content-Type", file->media_type);
    MHD_add_response_header(response, "Content-Security-Policy", content_policy);
    return send_response(connection, is_fresh ? 304 : 200, response);
}

static enum MHD_Result send_answer(struct MHD_Connection *connection, struct request *request)
{
    struct call *call = request->call;
    struct MHD_Response *response = MHD_create_response_from_buffer(call->n_bytes, call->bytes, MHD_RESPMEM_MUST_FREE);
    call->bytes = NULL;
    if (call->media_type[0])
        MHD_add_response_header(response, "Content-Type", call->media_type);
    MHD_add_response_header(response, "Cache-Control", "no-store");
    for (size_t i = 0; i < call->n_headers; i++)
        MHD_add_response_header(response, call->headers[i].name, call->headers[i].value);
    api_count(request->http->api, call->status, clock_now_us() - call->started_us);
    return send_response(connection, (unsigned)call->status, response);
}

/* On whichever thread completed the answer. */
static void call_finished(struct call *call)
{
    struct request *request = call->connection;
    atomic_store(&request->is_answered, true);
    MHD_resume_connection(request->connection); /* from here on the request is the HTTP thread's again */
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
        problem_set(&call->early, PROBLEM_TOO_LARGE, "", "", "at most %d parameters of %d bytes are read", CALL_MAX_QUERY, CALL_MAX_VALUE);
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

/* Decodes %XX in place, but leaves %00 as it stands: a text that ended there would pass for a shorter one. */
static size_t unescape(void *context, struct MHD_Connection *connection, char *text)
{
    (void)context;
    (void)connection;
    char *out = text;
    for (const char *at = text; *at; out++) {
        unsigned value;
        if (at[0] == '%' && isxdigit((unsigned char)at[1]) && isxdigit((unsigned char)at[2]) && sscanf(at + 1, "%2x", &value) == 1 && value != 0) {
            *out = (char)value;
            at += 3;
        } else {
            *out = *at++;
        }
    }
    *out = 0;
    return (size_t)(out - text);
}

/* The path of an address in absolute form (RFC 9112 3.2.2), as proxies are asked with. */
static const char *path_of(const char *url)
{
    if (strncasecmp(url, "http://", 7) != 0)
        return url;
    const char *path = strchr(url + 7, '/');
    return path ? path : "/";
}

/* A body that would be read only to be dropped: refused before it comes, where the sender waits to hear that, or where it is huge. */
static bool refuses_body(struct MHD_Connection *connection, struct call *call)
{
    const char *length = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Content-Length");
    const char *expect = MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Expect");
    unsigned long long n = length ? strtoull(length, NULL, 10) : 0;
    if (n <= CALL_MAX_BODY || (!expect && n <= HTTP_MAX_DROPPED))
        return false;
    problem_set(&call->early, PROBLEM_TOO_LARGE, "", "", "a body of more than %d bytes", CALL_MAX_BODY);
    return true;
}

/* The body will be an archive. False: it is refused, and the sender is to hear so before it comes. */
static bool begin_archive(struct request *request)
{
    struct call *call = request->call;
    const char *length = MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, "Content-Length");
    const char *expect = MHD_lookup_connection_value(request->connection, MHD_HEADER_KIND, "Expect");
    unsigned long long n = length ? strtoull(length, NULL, 10) : 0;
    request->is_archive = true;
    if (call->early.type == PROBLEM_NONE)
        request->archive = intake_begin(request->http->intake, call, !length ? -1 : n < INT64_MAX ? (int64_t)n : INT64_MAX, &call->early);
    return request->archive || !(expect || n > HTTP_MAX_DROPPED);
}

/* More of it. After a refusal the rest is read and dropped, as of other bodies. */
static bool add_archive(struct request *request, const char *bytes, size_t n)
{
    if (request->archive && intake_add(request->archive, bytes, n, &request->call->early))
        return true;
    intake_drop(request->archive);
    request->archive = NULL;
    request->n_dropped += n;
    return request->n_dropped <= request->http->max_archive_dropped;
}

static void finish_archive(struct request *request)
{
    struct call *call = request->call;
    if (request->archive)
        call->upload_path = intake_finish(request->archive, &call->n_upload, &call->early);
    request->archive = NULL;
}

static struct request *request_create(struct http *http, struct MHD_Connection *connection, const char *url, const char *method)
{
    struct request *request = mem_new(sizeof *request);
    struct call *call = request->call = call_create();
    request->http = http;
    request->connection = connection;
    atomic_init(&request->is_answered, false);
    call->connection = request;
    call->finished = call_finished;
    call->method = method_of(method);
    call_set_path(call, path_of(url));
    MHD_get_connection_values(connection, MHD_GET_ARGUMENT_KIND, add_query, call);
    call->if_match = copy_header(connection, "If-Match");
    call->if_none_match = copy_header(connection, "If-None-Match");
    call->content_type = copy_header(connection, "Content-Type");
    call->origin = copy_header(connection, "Origin");
    call->host = copy_header(connection, "Host");
    if (call->early.type == PROBLEM_NONE)
        head_host_is_ours(http->hosts, MHD_lookup_connection_value(connection, MHD_HEADER_KIND, "Host"), &call->early);
    return request;
}

/* More of the body. What is over the limit is read and dropped, so that the sender gets to see the answer; false: too much of that. */
static bool add_body(struct request *request, const char *bytes, size_t n)
{
    struct call *call = request->call;
    if (call->n_body + n > CALL_MAX_BODY) {
        problem_set(&call->early, PROBLEM_TOO_LARGE, "", "", "a body of more than %d bytes", CALL_MAX_BODY);
        request->n_dropped += n;
        return request->n_dropped <= HTTP_MAX_DROPPED;
    }
    char *larger = realloc(call->body, call->n_body + n);
    if (!larger) {
        problem_set(&call->early, PROBLEM_INTERNAL, "", "", "no memory for the body");
        return true;
    }
    memcpy(larger + call->n_body, bytes, n);
    call->body = larger;
    call->n_body += n;
    return true;
}

/* Hands the request to the net thread; the connection sleeps until the answer is there. */
static void ask(struct http *http, struct request *request)
{
    pthread_mutex_lock(&http->asking);
    bool is_stopping = http->is_stopping;
    MHD_suspend_connection(request->connection);
    if (!is_stopping)
        net_post(http->net, run_call, request);
    pthread_mutex_unlock(&http->asking);
    if (is_stopping) {
        struct problem problem;
        problem_set(&problem, PROBLEM_BUSY, "", "", "the server is being stopped");
        call_answer_problem(request->call, &problem);
    }
}

/* Called by libmicrohttpd: first with the headers, then for each part of the body, then until a response is queued. */
static enum MHD_Result handle(void *context, struct MHD_Connection *connection, const char *url, const char *method, const char *version,
                              const char *upload, size_t *n_upload, void **state)
{
    struct http *http = context;
    struct request *request = *state;
    (void)version;
    if (!request) {
        *state = request = request_create(http, connection, url, method);
        if (intake_is_for(request->call) ? !begin_archive(request) : refuses_body(connection, request->call)) {
            request->is_posted = true;
            ask(http, request);
        }
        return MHD_YES;
    }
    if (*n_upload) {
        bool goes_on = request->is_archive ? add_archive(request, upload, *n_upload) : add_body(request, upload, *n_upload);
        *n_upload = 0;
        return goes_on ? MHD_YES : MHD_NO;
    }
    if (atomic_load(&request->is_answered))
        return send_answer(connection, request);
    if (!request->is_posted) {
        enum call_method verb = request->call->method;
        const struct file *file = http->files && request->call->early.type == PROBLEM_NONE && (verb == CALL_GET || verb == CALL_HEAD) ? files_find(http->files, request->call->path) : NULL;
        if (file)
            return send_file(connection, file);
        finish_archive(request);
        request->is_posted = true;
        ask(http, request);
    }
    return MHD_YES;
}

static void completed(void *context, struct MHD_Connection *connection, void **state, enum MHD_RequestTerminationCode code)
{
    struct request *request = *state;
    (void)context;
    (void)connection;
    (void)code;
    if (!request)
        return;
    intake_drop(request->archive);
    call_destroy(request->call);
    free(request);
    *state = NULL;
}

static void log_library(void *context, const char *format, va_list args)
{
    char text[400];
    (void)context;
    (void)vsnprintf(text, sizeof text, format, args);
    log_debug("http: %s", text);
}

struct http *http_create(struct net *net, const struct http_options *options, struct error *err)
{
    struct http *http = mem_new(sizeof *http);
    http->net = net;
    http->hosts = options->hosts;
    http->api = api_create(net, options->upload_folder ? options->max_upload_bytes : 0);
    http->max_archive_dropped = options->max_upload_bytes > HTTP_MIN_ARCHIVE_DROPPED ? (size_t)options->max_upload_bytes : HTTP_MIN_ARCHIVE_DROPPED;
    http->intake = intake_create(options->upload_folder, options->max_upload_bytes, options->disk_reserve_bytes);
    pthread_mutex_init(&http->asking, NULL);
    if (options->web_folder) {
        http->files = files_create(options->web_folder, err);
        if (!http->files)
            goto fail;
    }
    http->daemon = MHD_start_daemon(MHD_USE_EPOLL_INTERNAL_THREAD | MHD_USE_NO_LISTEN_SOCKET | MHD_USE_ITC | MHD_ALLOW_SUSPEND_RESUME |
                                        MHD_USE_ERROR_LOG,
                                    0, NULL, NULL, handle, http, MHD_OPTION_EXTERNAL_LOGGER, log_library, NULL,
                                    MHD_OPTION_NOTIFY_COMPLETED, completed, NULL, MHD_OPTION_CONNECTION_LIMIT, (unsigned)HTTP_MAX_CONNECTIONS,
                                    MHD_OPTION_PER_IP_CONNECTION_LIMIT, (unsigned)HTTP_MAX_PER_ADDRESS, MHD_OPTION_CONNECTION_TIMEOUT,
                                    (unsigned)HTTP_TIMEOUT_S, MHD_OPTION_CONNECTION_MEMORY_LIMIT, (size_t)128 * 1024, MHD_OPTION_UNESCAPE_CALLBACK, unescape, NULL, MHD_OPTION_END);
    if (!http->daemon) {
        error_set(err, ERROR_IO, "the HTTP server did not start");
        goto fail;
    }
    return http;
fail:
    http_destroy(http);
    return NULL;
}

void http_stop_asking(struct http *http)
{
    pthread_mutex_lock(&http->asking);
    http->is_stopping = true;
    pthread_mutex_unlock(&http->asking);
}

void http_destroy(struct http *http)
{
    if (!http)
        return;
    if (http->daemon)
        MHD_stop_daemon(http->daemon);
    pthread_mutex_destroy(&http->asking);
    files_destroy(http->files);
    intake_destroy(http->intake);
    api_destroy(http->api);
    free(http);
}

/* A flood of connections must not become one of lines. On the acceptor's thread only. */
static void log_refusal(struct http *http)
{
    int64_t now_us = clock_now_us();
    http->n_refused++;
    if (http->logged_us && now_us - http->logged_us < 10000000)
        return;
    log_warn("http: too many connections: %zu refused", http->n_refused);
    http->logged_us = now_us;
    http->n_refused = 0;
}

void http_add_connection(struct http *http, int socket, const struct sockaddr *address, socklen_t n_address)
{
    int second = fcntl(socket, F_DUPFD_CLOEXEC, 3); /* the library closes what it does not take, without a word */
    if (MHD_add_connection(http->daemon, socket, address, n_address) != MHD_YES) {
        struct problem problem;
        problem_set(&problem, PROBLEM_LIMIT, "", "", "too many connections: at most %d in all, %d from one address", HTTP_MAX_CONNECTIONS,
                    HTTP_MAX_PER_ADDRESS);
        problem.retry_after_ms = HTTP_RETRY_MS;
        if (second >= 0) {
            (void)refusal_drain(second, HEAD_MAX_BYTES); /* its head, which nobody has read */
            refusal_send(second, &problem);
        }
        log_refusal(http);
    }
    if (second >= 0)
        (void)close(second);
}

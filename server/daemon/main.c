/* beamroomd's main: reads the settings, starts net, front and HTTP in this order, waits for a signal, and stops them
 * in the reverse order. */
#define _GNU_SOURCE
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "core/base/standard_files.h"
#include "server/daemon/data_lock.h"
#include "server/daemon/heartbeat.h"
#include "server/daemon/notify.h"
#include "server/daemon/options.h"
#include "server/daemon/privilege.h"
#include "server/daemon/sign_in.h"
#include "server/daemon/stop.h"
#include "server/front/front.h"
#include "server/front/hosts.h"
#include "server/http/http.h"
#include "server/net/net.h"
#include "server/store/backup.h"
#include "server/store/verify.h"
#include "server/tls/tls.h"

enum {
    PATH_SIZE = 4096,
    LISTED_EVERY_MS = 5,
    SLOW_LISTING_S = 10,
    /* for all allowed connections, three each for HTTP and one for a WebSocket, and for the renderers */
    N_DESCRIPTORS = 4096,
    N_DESCRIPTORS_WITH_TLS = 10240, /* two more for each, and one for each that waits for its handshake */
    HTTPS_PORT = 443
};

static bool make_folders(const char *folder, struct error *err)
{
    char path[PATH_SIZE];
    (void)snprintf(path, sizeof path, "%s", folder);
    for (char *slash = path + 1;; slash++) {
        char kept = *slash;
        if (kept != '/' && kept != 0)
            continue;
        *slash = 0;
        if (mkdir(path, kept ? 0755 : 0700) != 0 && errno != EEXIST) /* only the last one is private */
            return error_set(err, ERROR_IO, "--data %.150s: %s", path, strerror(errno));
        *slash = kept;
        if (!kept)
            break;
    }
    if (access(folder, W_OK) != 0)
        return error_set(err, ERROR_IO, "--data %.150s: %s", folder, strerror(errno));
    return true;
}

static bool default_data_folder(char path[PATH_SIZE], struct error *err)
{
    const char *state = getenv("XDG_STATE_HOME"), *home = getenv("HOME");
    if (state && *state)
        (void)snprintf(path, PATH_SIZE, "%s/beamroom", state);
    else if (home && *home)
        (void)snprintf(path, PATH_SIZE, "%s/.local/state/beamroom", home);
    else
        return error_set(err, ERROR_NOT_FOUND, "--data is needed: neither XDG_STATE_HOME nor HOME is set");
    return true;
}

/* ../web beside the program's folder, as in build/, or ../share/beamroom/web of an installation. */
static bool default_web_folder(char path[PATH_SIZE], struct error *err)
{
    static const char *const places[] = { "../web", "../share/beamroom/web" };
    char program[PATH_SIZE - 64];
    ssize_t n = readlink("/proc/self/exe", program, sizeof program - 1);
    program[n > 0 ? n : 0] = 0;
    char *slash = strrchr(program, '/');
    if (slash)
        *slash = 0;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        char index[PATH_SIZE];
        (void)snprintf(path, PATH_SIZE, "%s/%s", program, places[i]);
        (void)snprintf(index, sizeof index, "%s/%s/index.html", program, places[i]);
        if (access(index, R_OK) == 0)
            return true;
    }
    return error_set(err, ERROR_NOT_FOUND, "the page's files are not beside the program; say --web DIR");
}

static bool default_renderer(char path[PATH_SIZE], struct error *err)
{
    ssize_t n = readlink("/proc/self/exe", path, PATH_SIZE - sizeof "beamroom-render");
    path[n > 0 ? n : 0] = 0;
    char *slash = strrchr(path, '/');
    if (!slash)
        return error_set(err, ERROR_IO, "where this program lies cannot be found out: %s", strerror(errno));
    memcpy(slash + 1, "beamroom-render", sizeof "beamroom-render");
    return true;
}

/* Fills in a path that the options lack with its default; the options own it. */
static bool fill_path(char **option, bool (*find)(char path[PATH_SIZE], struct error *err), struct error *err)
{
    char path[PATH_SIZE];
    if (*option)
        return true;
    if (!find(path, err))
        return false;
    *option = mem_copy_text(path);
    return true;
}

/* The port of --listen, 0 where the system chooses. */
static int port_of(const struct options *options)
{
    const char *colon = options->listen ? strrchr(options->listen, ':') : NULL;
    return colon ? (int)strtol(colon + 1, NULL, 10) : 8080;
}

/* The folder of a socket, which the daemon makes there; allocated. */
static char *folder_of(const struct local_socket *local)
{
    char *folder = mem_copy_text(local->path), *slash = strrchr(folder, '/');
    slash[slash == folder] = 0;
    return folder;
}

/* Becomes an ordinary user. Replaces the options' paths by those that this user reaches. */
static bool give_up_root(struct options *options, struct error *err)
{
    struct privilege_place places[OPTIONS_MAX_PLAN_FOLDERS + 6 + FRONT_MAX_SOCKETS];
    size_t n = 0;
    for (size_t i = 0; i < options->n_plan_folders; i++)
        places[n++] = (struct privilege_place){ "--plans", options->plan_folders[i], R_OK | X_OK };
    places[n++] = (struct privilege_place){ "--data", options->data_folder, F_OK };
    places[n++] = (struct privilege_place){ "--web", options->web_folder, R_OK | X_OK };
    places[n++] = (struct privilege_place){ "--renderer", options->renderer_path, R_OK | X_OK };
    const size_t n_always = n;
    if (options->tls_cert) {
        places[n++] = (struct privilege_place){ "--tls-cert", options->tls_cert, R_OK };
        places[n++] = (struct privilege_place){ "--tls-key", options->tls_key, R_OK };
    }
    const size_t n_before_sockets = n;
    for (size_t i = 0; i < options->n_sockets; i++)
        places[n++] = (struct privilege_place){ "--listen", folder_of(&options->sockets[i]), W_OK | X_OK };
    struct privilege_options wanted = { .user = options->user,
                                        .data_folder = options->data_folder,
                                        .port = port_of(options),
                                        .places = places,
                                        .n_places = n };
    bool ok = privilege_give_up(&wanted, err);
    for (size_t i = n_before_sockets; i < n; i++)
        free(places[i].path);
    for (size_t i = 0; i < options->n_plan_folders; i++)
        options->plan_folders[i] = places[i].path;
    options->data_folder = places[n_always - 3].path;
    options->web_folder = places[n_always - 2].path;
    options->renderer_path = places[n_always - 1].path;
    if (options->tls_cert) {
        options->tls_cert = places[n_always].path;
        options->tls_key = places[n_always + 1].path;
    }
    return ok;
}

static bool gl_is_known(const char *gl, struct error *err)
{
    static const char *const known[] = { "auto", "egl-device", "egl-surfaceless", "osmesa", "soft" };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (strcmp(gl, known[i]) == 0)
            return true;
    return error_set(err, ERROR_FORMAT, "--gl is \"%.40s\", expected auto, egl-device, egl-surfaceless, osmesa or soft",
                     gl);
}

/* Sets the limit on open files. The usual 1024 is for programs that use select(2); containers often allow a million,
 * and libwebsockets keeps a table of as many as are allowed. */
static void set_descriptors(rlim_t n_needed)
{
    struct rlimit now;
    if (getrlimit(RLIMIT_NOFILE, &now) != 0)
        return;
    now.rlim_cur = now.rlim_max < n_needed ? now.rlim_max : n_needed;
    (void)setrlimit(RLIMIT_NOFILE, &now);
    if (now.rlim_cur < n_needed)
        log_warn("%llu descriptors are allowed; %llu are needed for every connection that may be open",
                 (unsigned long long)now.rlim_cur, (unsigned long long)n_needed);
}

/* Waits until the plan folders have been listed, so that "ready" means that all plans can be found. Returns false when
 * a signal came before. */
static bool wait_for_plans(const struct net *net)
{
    for (int n = 1; !net_plans_are_listed(net); n++) {
        if (stop_wait(LISTED_EVERY_MS * INT64_C(1000)))
            return false;
        if (n % (SLOW_LISTING_S * 1000 / LISTED_EVERY_MS) != 0)
            continue;
        notify_send("EXTEND_TIMEOUT_USEC=60000000"); /* the server answers meanwhile, so the service manager must go on
                                                        waiting */
        if (n == SLOW_LISTING_S * 1000 / LISTED_EVERY_MS)
            log_warn("the plan folders are still being listed: a disk answers slowly or not at all");
    }
    return true;
}

/* --backup: copies the database of --data, also while a daemon uses it. */
static bool back_up(const struct options *options, struct error *err)
{
    char database[PATH_SIZE + 16];
    (void)snprintf(database, sizeof database, "%s/beamroom.db", options->data_folder);
    return store_backup(database, options->backup, err);
}

static void print_time(const char *what, int64_t time_ms)
{
    char text[32];
    struct tm utc;
    time_t seconds = (time_t)(time_ms / 1000);
    gmtime_r(&seconds, &utc);
    (void)strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    printf("%s %s\n", what, text);
}

/* --verify-audit: says what the audit holds, or which row of it does not fit. */
static bool verify_audit(const struct options *options, struct error *err)
{
    struct audit_facts facts;
    const char *head = options->audit_head;
    if (head && (strlen(head) != STORE_AUDIT_HASH - 1 || strspn(head, "0123456789abcdef") != STORE_AUDIT_HASH - 1))
        return error_set(err, ERROR_FORMAT, "audit-head is \"%.80s\", expected 64 digits of 0-9 and a-f", head);
    if (!store_verify_audit(options->verify_audit, head, &facts, err))
        return false;
    printf("rows %lld\n", (long long)facts.n_rows);
    if (facts.n_rows) {
        print_time("first", facts.first_ms);
        print_time("last", facts.last_ms);
    }
    if (facts.is_export)
        printf("gaps %lld\n", (long long)facts.n_gaps);
    else
        printf("items %lld\n", (long long)facts.n_items);
    printf("head %s\n", facts.head);
    return true;
}

/* ---- serving ---------------------------------------------------------------------------------------------------- */

/* A connection passes through these: TLS, where there is, gives decrypted streams to the front, which hands WebSockets
 * to the net thread. */
struct service {
    struct tls *tls; /* NULL: the port speaks HTTP */
    struct front *front;
    struct net *net;
    struct sign_in sign_in;
};

static void adopt(void *service, int socket, const struct handshake *handshake, void (*ended)(void *argument),
                  void *argument)
{
    net_adopt(((struct service *)service)->net, socket, handshake, ended, argument);
}

static void decrypt(void *service, int socket, const struct address *peer)
{
    tls_accept(((struct service *)service)->tls, socket, peer);
}

static void take_decrypted(void *service, int socket, const struct address *peer)
{
    front_take(((struct service *)service)->front, socket, peer);
}

static void take_plain(void *service, int socket, const struct address *peer)
{
    front_take_plain(((struct service *)service)->front, socket, peer);
}

static bool identify(void *service, const struct credentials *credentials, struct identity *identity,
                     struct problem *problem)
{
    return auth_identify(((struct service *)service)->sign_in.auth, credentials, identity, problem);
}

static bool is_still(void *service, struct identity *who)
{
    return auth_is_still(((struct service *)service)->sign_in.auth, who);
}

/* On SIGHUP. */
static void reload(struct service *service)
{
    struct error err = { 0 };
    if (!service->tls && !service->sign_in.access)
        log_info("nothing to read again on SIGHUP: there is no --tls-cert, and nobody signs in");
    else if (service->tls && !tls_reload(service->tls, &err))
        log_error("TLS: the certificate in use stays: %s", err.text);
    sign_in_reload(&service->sign_in, service->net);
}

/* Until a signal to stop comes. The heartbeat is to be destroyed when all threads have ended. */
static struct heartbeat *serve_on(struct service *service)
{
    struct heartbeat *heartbeat = heartbeat_create(service->net, service->front, service->tls);
    enum stop_signal found;
    while ((found = stop_wait_or_reload(heartbeat_wait_us(heartbeat))) != STOP_STOPS) {
        if (found == STOP_RELOADS)
            reload(service);
        else
            heartbeat_beat(heartbeat);
    }
    return heartbeat;
}

/* Where options ask for TLS. */
static bool start_tls(struct service *service, const struct options *options, struct error *err)
{
    const struct tls_options tls_options = { .cert_file = options->tls_cert,
                                             .key_file = options->tls_key,
                                             .trusted = options->trusted_proxies,
                                             .n_trusted = options->n_trusted_proxies,
                                             .take = take_decrypted,
                                             .take_plain = take_plain,
                                             .context = service };
    if (!options->tls_cert)
        return true;
    service->tls = tls_create(&tls_options, err);
    return service->tls != NULL;
}

/* The sockets of proxies, and where people sign in the one of the data folder, by which `beamroom user` and `beamroom
 * token` reach the daemon. Returns their number. */
static size_t fill_sockets(const struct options *options, struct local_socket sockets[FRONT_ALL_SOCKETS])
{
    size_t n = options->n_sockets;
    memcpy(sockets, options->sockets, sizeof options->sockets);
    if (!options_signs_in(options))
        return n;
    struct local_socket *control = &sockets[n];
    *control = (struct local_socket){ .mode = 0600, .is_control = true };
    const int n_path = snprintf(control->path, sizeof control->path, "%s/" CONTROL_SOCKET_NAME, options->data_folder);
    if (n_path < (int)sizeof control->path)
        return n + 1;
    log_warn("the path of the data folder is too long for a socket, so users and tokens are managed over HTTP alone");
    return n;
}

/* Where nobody can sign in yet, the log has the address that makes the first administrator. A public name without TLS
 * of our own is that of a proxy in front. */
static void say_first(struct auth *auth, const struct options *options, const char *url)
{
    char secret[AUTH_SECRET_TEXT];
    if (!auth_first(auth, secret))
        return;
    const bool has_proxy =
        options->n_public_names > 0 && !options->tls_cert && strcmp(options->public_names[0], "*") != 0;
    log_warn("there are no users yet: within an hour, make the first administrator at %s%s/signin/first#%s",
             has_proxy ? "https://" : "", has_proxy ? options->public_names[0] : url, secret);
    auth_wipe(secret, sizeof secret);
}

/* Serves until a signal comes. */
static bool serve(struct options *options, struct error *err)
{
    const char *data_folder = options->data_folder;
    const char *listen = options->listen || options->n_sockets ? options->listen : "127.0.0.1:8080";
    struct local_peers proxy = { 0 };
    if (options->proxy_user && !local_peers_find(options->proxy_user, &proxy, err))
        return false;
    struct service service = { 0 };
    const bool is_signing_in = sign_in_create(&service.sign_in, options, err);
    char database[PATH_SIZE + 16];
    (void)snprintf(database, sizeof database, "%s/beamroom.db", data_folder);
    const struct net_options net_options = {
        .fleet = { .plan_folders = (const char *const *)options->plan_folders,
                   .n_plan_folders = options->n_plan_folders,
                   .data_folder = data_folder,
                   .max_unpacked_bytes = (uint64_t)options->max_unpacked_mib << 20,
                   .max_cache_bytes = (uint64_t)options->max_cache_mib << 20,
                   .disk_reserve_bytes = (uint64_t)options->disk_reserve_mib << 20,
                   .renderer_path = options->renderer_path,
                   .gl = options->gl ? options->gl : "auto",
                   .hides_folders = options_signs_in(options),
                   .stub_renderer = options->stub_renderer,
                   .max_renderer_bytes = (uint64_t)options->max_renderer_mib << 20,
                   .max_renderers = (int)options->max_renderers,
                   .idle_close_s = (int)options->plan_idle_close_s },
        .max_rooms = (int)options->max_rooms,
        .room_idle_close_s = (int)options->room_idle_close_s,
        .room = { .max_members = (int)options->max_members,
                  .recording_speed = (double)options->recording_speed,
                  .admits_guests = options->admits_guests,
                  .is_open_to_everybody = options->is_open },
        .is_alone = !options->is_open && !options_signs_in(options),
        .allowed_origin = options->allowed_origin,
        .database = database,
        .auth = service.sign_in.auth,
        .access = service.sign_in.access,
        .is_still = is_still,
        .rights = &service,
    };
    const char *identity_names[HEAD_N_IDENTITY];
    for (size_t i = 0; i < HEAD_N_IDENTITY; i++)
        identity_names[i] = options->identity_names[i] ? options->identity_names[i] : head_identity_names[i];
    char upload_folder[PATH_SIZE + 16];
    (void)snprintf(upload_folder, sizeof upload_folder, "%s/uploads", data_folder);
    const bool is_alone = !options->is_open && !options_signs_in(options);
    struct hosts *hosts = !is_alone ? hosts_create((const char *const *)options->public_names, options->n_public_names)
                                    : hosts_create_alone();
    const struct http_options http_options = { .web_folder = options->web_folder,
                                               .upload_folder = upload_folder,
                                               .max_upload_bytes = (uint64_t)options->max_upload_mib << 20,
                                               .disk_reserve_bytes = (uint64_t)options->disk_reserve_mib << 20,
                                               .is_secure_alone = options->tls_cert && port_of(options) == HTTPS_PORT,
                                               .auth = service.sign_in.auth,
                                               .doors = { is_alone, options->is_open } };
    struct net *net = is_signing_in && start_tls(&service, options, err) ? net_create(&net_options, err) : NULL;
    struct local_socket sockets[FRONT_ALL_SOCKETS];
    const struct front_options front_options = { .listen = listen,
                                                 .sockets = sockets,
                                                 .n_sockets = fill_sockets(options, sockets),
                                                 .proxy = proxy,
                                                 .identity_names = identity_names,
                                                 .takes_identity = options->is_proxied,
                                                 .hosts = hosts,
                                                 .trusted = options->trusted_proxies,
                                                 .n_trusted = options->n_trusted_proxies,
                                                 .decrypt = service.tls ? decrypt : NULL,
                                                 .adopt = adopt,
                                                 .identify = identify,
                                                 .context = &service };
    service.net = net;
    struct front *front = service.front = net ? front_create(&front_options, err) : NULL;
    struct http *http = front ? http_create(net, front, &http_options, err) : NULL;
    struct heartbeat *heartbeat = NULL;
    const bool ok = http != NULL;
    if (ok) {
        if (wait_for_plans(net)) {
            printf("ready %s\n", front_url(front));
            (void)fflush(stdout);
            log_info("serving on %s", front_url(front));
            for (size_t i = 0; i < options->n_sockets; i++)
                log_info("serving %s at unix:%s", options->proxy_user, options->sockets[i].path);
            if (options->is_open)
                log_warn("open to everybody: whoever reaches %s may see and change every plan, as nobody signs in here",
                         front_url(front));
            say_first(service.sign_in.auth, options, front_url(front));
            notify_send("READY=1");
            heartbeat = serve_on(&service);
        }
        notify_send("STOPPING=1");
    }
    if (service.sign_in.auth)
        auth_close(service.sign_in.auth); /* its answers are posted to the net thread */
    if (http) {
        front_close(front);
        http_stop_posting(http);
    }
    if (service.tls)
        tls_close(service.tls);
    http_stop_printing(http);
    net_destroy(net);
    http_destroy(http);
    front_destroy(front);
    tls_destroy(service.tls);
    heartbeat_destroy(heartbeat);
    sign_in_finish(&service.sign_in);
    hosts_destroy(hosts);
    return ok;
}

int main(int argc, char **argv)
{
    standard_files_fill();
    struct options options;
    struct error err = { 0 };
    if (!options_read(&options, argc, argv, &err)) {
        fprintf(stderr, "beamroomd: %s\n", err.text);
        options_finish(&options);
        return 2;
    }
    if (options.wants_help || options.wants_version) {
        if (options.wants_help)
            options_print_help();
        else
            printf("beamroomd %s\n", BEAMROOM_VERSION);
        options_finish(&options);
        return 0;
    }
    log_start("beamroomd", options.log_level);
    (void)signal(SIGXFSZ, SIG_IGN); /* a write beyond a limit on the size of files fails with EFBIG */

    signal(SIGPIPE, SIG_IGN);         /* a write to a closed socket fails with EPIPE */
    struct rlimit no_core = { 0, 0 }; /* no core files: memory holds patients' data */
    (void)setrlimit(RLIMIT_CORE, &no_core);

    notify_open();
    set_descriptors(options.tls_cert ? N_DESCRIPTORS_WITH_TLS : N_DESCRIPTORS);

    bool ok = !options.gl || gl_is_known(options.gl, &err);
    if (options.backup) {
        (void)umask(0077);
        ok = ok && fill_path(&options.data_folder, default_data_folder, &err) && back_up(&options, &err);
        if (!ok)
            fprintf(stderr, "beamroomd: --backup %s: %s\n", options.backup, err.text);
        options_finish(&options);
        return ok ? 0 : 1;
    }
    if (options.verify_audit) {
        ok = ok && verify_audit(&options, &err);
        if (!ok)
            fprintf(stderr, "beamroomd: --verify-audit %s: %s\n", options.verify_audit, err.text);
        options_finish(&options);
        return ok ? 0 : 1;
    }
    ok = ok && fill_path(&options.data_folder, default_data_folder, &err) &&
         fill_path(&options.web_folder, default_web_folder, &err) &&
         fill_path(&options.renderer_path, default_renderer, &err) && make_folders(options.data_folder, &err);
    (void)umask(0077); /* what the daemon and its children write is patients' data */
    ok = ok && give_up_root(&options, &err);
    ok = ok && data_lock(options.data_folder, &err);
    ok = ok && stop_watch(&err); /* starts the first thread; before, a signal simply ends the process */
    if (ok && options.recording_speed > 1)
        log_warn("--recording-speed %lld: times in recordings are no times of the clock",
                 (long long)options.recording_speed);
    if (ok && options.n_plan_folders == 0)
        log_warn("no --plans folder: only uploaded plans can be shown");
    ok = ok && serve(&options, &err);
    if (!ok)
        log_error("%s", err.text);
    options_finish(&options);
    return ok ? 0 : 1;
}

/* The table of settings, and reading it from the command line and the configuration file. */
#include "server/daemon/options.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/mem.h"
#include "server/room/room.h"
#include "server/wire/document.h"

enum kind {
    KIND_FOLDERS,
    KIND_LISTEN,
    KIND_SIGN_IN,
    KIND_GRANT,
    KIND_HEADER,
    KIND_TEXT,
    KIND_COUNT,
    KIND_FLAG,
    KIND_LEVEL,
    KIND_NAMES,
    KIND_RANGES
};

/* One setting per row: flag --name VALUE, key "name = value". */
struct setting {
    const char *name, *value_name, *about;
    enum kind kind;
    size_t offset;
    int64_t least, most;
};

#define AT(member) offsetof(struct options, member)
static const struct setting settings[] = {
    { "plans", "DIR", "a folder of plans, or one plan; may be repeated; only ever read", KIND_FOLDERS, AT(plan_folders),
      0, 0 },
    { "data", "DIR", "own state and cache; default: $XDG_STATE_HOME/beamroom or ~/.local/state/beamroom", KIND_TEXT,
      AT(data_folder), 0, 0 },
    { "web", "DIR", "the page's files; default: beside the program or ../share/beamroom/web", KIND_TEXT, AT(web_folder),
      0, 0 },
    { "listen", "ADDRESS:PORT",
      "default 127.0.0.1:8080; port 0 lets the system choose. HTTP, or HTTPS with --tls-cert. Or a Unix socket for a "
      "proxy on this machine, unix:/PATH[,group=NAME][,mode=0660]; sockets may be repeated, also beside an address",
      KIND_LISTEN, AT(listen), 0, 0 },
    { "proxy-user", "NAME", "with --listen unix: the user, or group, of the only processes that are answered there",
      KIND_TEXT, AT(proxy_user), 0, 0 },
    { "tls-cert", "FILE",
      "the port speaks TLS: PEM of this server's certificate and those between it and its root; read again on SIGHUP",
      KIND_TEXT, AT(tls_cert), 0, 0 },
    { "tls-key", "FILE", "PEM of its key, without a passphrase; read again on SIGHUP", KIND_TEXT, AT(tls_key), 0, 0 },
    { "sign-in", "HOW",
      "none (default, for this machine alone), local (users and passwords kept here), proxy (a proxy at the Unix socket "
      "says who they are) or local,proxy",
      KIND_SIGN_IN, 0, 0, 0 },
    { "grant", "'FOLDER WHO ROLE'",
      "who may do what, as '/srv/plans @physics planner'; may be repeated; in the file read again on SIGHUP. FOLDER: a "
      "path, uploads, pulls or *; WHO: a user, @group or *; ROLE: observer, reviewer, presenter, planner or admin, with "
      "+identity for the patients' names",
      KIND_GRANT, 0, 0, 0 },
    { "guest-links", NULL, "links to rooms may let in people who have not signed in", KIND_FLAG, AT(admits_guests), 0,
      0 },
    { "session-idle-min", "N", "a sign-in by password ends after so many minutes without input; default 30", KIND_COUNT,
      AT(session_idle_min), 1, 1440 },
    { "session-max-h", "N", "a sign-in ends after so many hours; default 12", KIND_COUNT, AT(session_max_h), 1, 168 },
    { "proxy-user-header", "NAME", "header by which the proxy says who makes a request; default X-Beamroom-User",
      KIND_HEADER, AT(identity_names[HEAD_USER]), 0, 0 },
    { "proxy-name-header", "NAME", "the person's name; default X-Beamroom-Name", KIND_HEADER,
      AT(identity_names[HEAD_NAME]), 0, 0 },
    { "proxy-groups-header", "NAME", "their groups, parted by commas; default X-Beamroom-Groups", KIND_HEADER,
      AT(identity_names[HEAD_GROUPS]), 0, 0 },
    { "proxy-auth-time-header", "NAME",
      "when they signed in there, in seconds since 1970; default X-Beamroom-Auth-Time", KIND_HEADER,
      AT(identity_names[HEAD_AUTH_TIME]), 0, 0 },
    { "gl", "NAME", "auto (default), egl-device, egl-surfaceless, osmesa or soft", KIND_TEXT, AT(gl), 0, 0 },
    { "renderer", "FILE", "the renderer's program; default: beamroom-render beside this one", KIND_TEXT,
      AT(renderer_path), 0, 0 },
    { "max-renderers", "N", "plans open at once; default 8", KIND_COUNT, AT(max_renderers), 1, 1000 },
    { "max-renderer-mib", "N", "memory one renderer may take in MiB, 0 no limit; default 16384", KIND_COUNT,
      AT(max_renderer_mib), 0, 1 << 24 },
    { "plan-idle-close", "SECONDS", "close a plan nobody uses or is in a room with after this, 0 never; default 600",
      KIND_COUNT, AT(plan_idle_close_s), 0, 1 << 24 },
    { "room-idle-close", "SECONDS", "let a room nobody is in sleep on the disk after this, 0 never; default 86400",
      KIND_COUNT, AT(room_idle_close_s), 0, 1 << 24 },
    { "max-rooms", "N", "rooms in use at once, of all plans; default 200, at most 10000", KIND_COUNT, AT(max_rooms), 1,
      SCENE_MAX_ROOMS },
    { "max-members", "N", "people in one room; default 100, at most 200", KIND_COUNT, AT(max_members), 1,
      ROOM_MAX_MEMBERS },
    { "max-upload-mib", "N", "largest archive that may be uploaded, in MiB; default 2048", KIND_COUNT,
      AT(max_upload_mib), 1, 1 << 24 },
    { "max-unpacked-mib", "N", "what may come out of one, in MiB; default 8192", KIND_COUNT, AT(max_unpacked_mib), 1,
      1 << 24 },
    { "max-cache-mib", "N", "what opened plans kept for the next time may take in --data, in MiB; default 16384",
      KIND_COUNT, AT(max_cache_mib), 128, 1 << 24 },
    { "disk-reserve-mib", "N", "what uploads and kept plans leave free on the disk of --data, in MiB; default 64",
      KIND_COUNT, AT(disk_reserve_mib), 0, 1 << 24 },
    { "allow-origin", "ORIGIN", "a further origin whose pages may open WebSockets, as https://beamroom.example",
      KIND_TEXT, AT(allowed_origin), 0, 0 },
    { "public-name", "NAME", "a name people reach this server by, as beamroom.example; may be repeated; * for any",
      KIND_NAMES, AT(public_names), 0, 0 },
    { "trusted-proxy", "ADDRESS[/BITS]", "a proxy whose X-Forwarded-For says who its clients are; may be repeated",
      KIND_RANGES, AT(trusted_proxies), 0, 0 },
    { "open-to-everybody", NULL,
      "whoever reaches the port may see and change everything, as nobody signs in here: needed for any other address "
      "than loopback, for --public-name and for --trusted-proxy",
      KIND_FLAG, AT(is_open), 0, 0 },
    { "user", "NAME",
      "started by root: the user to run as; default beamroom where there is one, else nobody; root stays root",
      KIND_TEXT, AT(user), 0, 0 },
    { "backup", "FILE", "copy the rooms that --data keeps to this file, also while a daemon serves them, and end",
      KIND_TEXT, AT(backup), 0, 0 },
    { "verify-audit", "FILE",
      "check the record of what was done in rooms, in this database, copy of one or file of rows, and end", KIND_TEXT,
      AT(verify_audit), 0, 0 },
    { "audit-head", "HEX", "with --verify-audit: a hash from the record of a room, which a row must still have",
      KIND_TEXT, AT(audit_head), 0, 0 },
    { "log-level", "LEVEL", "debug, info (default), warning or error", KIND_LEVEL, AT(log_level), 0, 0 },
    { "stub", NULL, "draw grey pictures instead of using GL; for tests", KIND_FLAG, AT(stub_renderer), 0, 0 },
    { "recording-speed", "N", "the clock of recordings and replays runs N times as fast; for tests and rehearsals",
      KIND_COUNT, AT(recording_speed), 1, 1000 },
};
enum { N_SETTINGS = sizeof settings / sizeof settings[0] };

static const struct setting *find_setting(const char *name, size_t n)
{
    for (size_t i = 0; i < N_SETTINGS; i++)
        if (strlen(settings[i].name) == n && strncmp(settings[i].name, name, n) == 0)
            return &settings[i];
    return NULL;
}

static bool set_count(const struct setting *setting, const char *value, int64_t *count, struct error *err)
{
    char *end;
    errno = 0;
    long long number = strtoll(value, &end, 10);
    if (end == value || *end || errno || number < setting->least || number > setting->most)
        return error_set(err, ERROR_FORMAT, "%s is \"%.40s\", expected a whole number from %lld to %lld", setting->name,
                         value, (long long)setting->least, (long long)setting->most);
    *count = number;
    return true;
}

static bool set_level(const char *value, enum log_level *level, struct error *err)
{
    static const char *const words[] = { "debug", "info", "warning", "error" };
    for (int i = 0; i < 4; i++)
        if (strcmp(value, words[i]) == 0) {
            *level = (enum log_level)i;
            return true;
        }
    return error_set(err, ERROR_FORMAT, "log-level is \"%.40s\", expected debug, info, warning or error", value);
}

static void set_text(char *at, const char *value)
{
    char **text = (char **)(void *)at;
    free(*text);
    *text = mem_copy_text(value);
}

static bool set_header(const struct setting *setting, const char *value, char *at, struct error *err)
{
    if (!head_may_be_identity(value))
        return error_set(err, ERROR_FORMAT,
                         "%s is \"%.60s\", expected a name that begins with X- or Remote-, of letters, digits and -",
                         setting->name, value);
    set_text(at, value);
    return true;
}

static bool set_sign_in(struct options *options, const char *value, struct error *err)
{
    static const char *const words[] = { "none", "local", "proxy", "local,proxy", "proxy,local" };
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++)
        if (strcmp(value, words[i]) == 0) {
            options->is_local = strstr(value, "local") != NULL;
            options->is_proxied = strstr(value, "proxy") != NULL;
            return true;
        }
    return error_set(err, ERROR_FORMAT, "sign-in is \"%.40s\", expected none, local, proxy or local,proxy", value);
}

static bool add_grant(struct options_grants *grants, const char *value, int line, struct error *err)
{
    if (grants->n == OPTIONS_MAX_GRANTS)
        return error_set(err, ERROR_LIMIT, "more than %d grants", OPTIONS_MAX_GRANTS);
    if (!grants->list)
        grants->list = mem_new(OPTIONS_MAX_GRANTS * sizeof *grants->list);
    grants->list[grants->n++] = (struct options_grant){ mem_copy_text(value), line };
    return true;
}

void options_grants_finish(struct options_grants *grants)
{
    for (size_t i = 0; i < grants->n; i++)
        free(grants->list[i].value);
    free(grants->list);
    *grants = (struct options_grants){ 0 };
}

bool options_signs_in(const struct options *options)
{
    return options->is_local || options->is_proxied;
}

/* line: of the configuration file; 0: of the command line. */
static bool set(struct options *options, const struct setting *setting, const char *value, int line, struct error *err)
{
    char *at = (char *)options + setting->offset;
    switch (setting->kind) {
    case KIND_FOLDERS:
        if (options->n_plan_folders == OPTIONS_MAX_PLAN_FOLDERS)
            return error_set(err, ERROR_LIMIT, "more than %d plan folders", OPTIONS_MAX_PLAN_FOLDERS);
        options->plan_folders[options->n_plan_folders++] = mem_copy_text(value);
        return true;
    case KIND_NAMES:
        if (options->n_public_names == OPTIONS_MAX_NAMES)
            return error_set(err, ERROR_LIMIT, "more than %d public names", OPTIONS_MAX_NAMES);
        if (!*value || strpbrk(value, ":/ \t[]"))
            return error_set(err, ERROR_FORMAT, "public-name is \"%.80s\", expected a name alone, as beamroom.example",
                             value);
        options->public_names[options->n_public_names++] = mem_copy_text(value);
        return true;
    case KIND_RANGES:
        if (options->n_trusted_proxies == ADDRESS_MAX_RANGES)
            return error_set(err, ERROR_LIMIT, "more than %d trusted proxies", ADDRESS_MAX_RANGES);
        if (!address_range_read(value, &options->trusted_proxies[options->n_trusted_proxies], err)) {
            error_prefix(err, "trusted-proxy");
            return false;
        }
        options->n_trusted_proxies++;
        return true;
    case KIND_LISTEN:
        if (local_socket_is_meant(value)) {
            if (options->n_sockets == FRONT_MAX_SOCKETS)
                return error_set(err, ERROR_LIMIT, "more than %d Unix sockets", FRONT_MAX_SOCKETS);
            return local_socket_read(value, &options->sockets[options->n_sockets++], err);
        }
        set_text(at, value);
        return true;
    case KIND_SIGN_IN: return set_sign_in(options, value, err);
    case KIND_GRANT: return add_grant(&options->grants, value, line, err);
    case KIND_HEADER: return set_header(setting, value, at, err);
    case KIND_TEXT: set_text(at, value); return true;
    case KIND_COUNT: return set_count(setting, value, (int64_t *)(void *)at, err);
    case KIND_LEVEL: return set_level(value, &options->log_level, err);
    case KIND_FLAG: *(bool *)at = strcmp(value, "no") != 0 && strcmp(value, "false") != 0; return true;
    }
    return false;
}

static char *trim(char *text)
{
    text += strspn(text, " \t\r\n");
    size_t n = strlen(text);
    while (n && strchr(" \t\r\n", text[n - 1]))
        text[--n] = 0;
    return text;
}

/* given: settings that the command line has; they win. */
static bool read_file(struct options *options, const char *name, const bool *given, struct error *err)
{
    char line[OPTIONS_MAX_LINE];
    FILE *file = fopen(name, "re");
    if (!file)
        return error_set(err, ERROR_IO, "--config %.100s: %s", name, strerror(errno));
    bool ok = true;
    for (int number = 1; ok && fgets(line, sizeof line, file); number++) {
        options->grants.last_line = number;
        if (!strchr(line, '\n') && !feof(file)) {
            ok =
                error_set(err, ERROR_LIMIT, "%.100s line %d: longer than %d bytes", name, number, OPTIONS_MAX_LINE - 2);
            break;
        }
        line[strcspn(line, "#")] = 0;
        char *key = trim(line);
        if (!*key)
            continue;
        char *equals = strchr(key, '=');
        if (!equals) {
            ok = error_set(err, ERROR_FORMAT, "%.100s line %d: expected \"key = value\", found \"%.60s\"", name, number,
                           key);
            break;
        }
        *equals = 0;
        key = trim(key);
        const struct setting *setting = find_setting(key, strlen(key));
        if (!setting)
            ok = error_set(err, ERROR_FORMAT, "%.100s line %d: there is no setting \"%.40s\"", name, number, key);
        else if (!given[setting - settings]) {
            ok = set(options, setting, trim(equals + 1), number, err);
            if (!ok)
                error_prefix(err, "%.100s line %d", name, number);
        }
    }
    fclose(file);
    return ok;
}

/* Nobody signs in here: what lets others than the person at this machine in must be said. */
static bool may_be_reached(const struct options *options, const struct address *address, struct error *err)
{
    if (options->grants.n > 0)
        return error_set(err, ERROR_FORMAT,
                         "--grant says who may do what, and nobody signs in here; say --sign-in too");
    if (options->is_open)
        return true;
    if (options->n_sockets > 0)
        return error_set(err, ERROR_FORMAT,
                         "--listen unix:%.80s is for a proxy, and nobody signs in here. Say --sign-in proxy, or "
                         "--open-to-everybody: whoever reaches it then sees and changes every plan",
                         options->sockets[0].path);
    if (options->listen && !address_is_loopback(address))
        return error_set(
            err, ERROR_FORMAT,
            "--listen %.60s lets others than this machine in, and nobody signs in here. Say --sign-in local "
            "with --tls-cert and --tls-key, or listen on 127.0.0.1 or [::1], or say --open-to-everybody",
            options->listen);
    return (options->n_public_names == 0 && options->n_trusted_proxies == 0) ||
           error_set(err, ERROR_FORMAT,
                     "--%s is for a server that others reach, and nobody signs in here. Leave it away, or say "
                     "--sign-in, or --open-to-everybody: whoever reaches it then sees and changes every plan",
                     options->n_public_names > 0 ? "public-name" : "trusted-proxy");
}

/* People sign in: passwords and tokens must not be readable on the wire. */
static bool keeps_secrets(const struct options *options, const struct address *address, struct error *err)
{
    if (options->is_open)
        return error_set(err, ERROR_FORMAT,
                         "--open-to-everybody lets in who has not signed in, and --sign-in does not; expected one of "
                         "them");
    if (options->is_proxied && options->n_sockets == 0)
        return error_set(err, ERROR_FORMAT,
                         "--sign-in proxy needs --listen unix:/PATH and --proxy-user NAME: what a proxy says is "
                         "believed there alone");
    return !options->listen || address_is_loopback(address) || options->tls_cert ||
           error_set(
               err, ERROR_FORMAT,
               "--listen %.80s would carry passwords without encryption; give --tls-cert and --tls-key, or listen "
               "on 127.0.0.1, [::1] or unix:/PATH behind a proxy",
               options->listen);
}

static bool may_serve(const struct options *options, struct error *err)
{
    const char *listen = options->listen;
    struct address address = { { 0 } };
    if (listen && !options->is_open && !address_read(listen, strlen(listen), &address)) /* nor taken for loopback */
        return error_set(err, ERROR_FORMAT, "--listen %.80s: expected ADDRESS:PORT, as in 127.0.0.1:8080 or [::1]:8080",
                         listen);
    return options_signs_in(options) ? keeps_secrets(options, &address, err) : may_be_reached(options, &address, err);
}

/* True if no setting lacks the other that it needs. */
static bool is_whole(const struct options *options, struct error *err)
{
    if (!options->tls_cert != !options->tls_key)
        return error_set(err, ERROR_FORMAT, "--tls-%s is given without --tls-%s; expected both or neither",
                         options->tls_cert ? "cert" : "key", options->tls_cert ? "key" : "cert");
    if (!options->proxy_user != !options->n_sockets)
        return error_set(err, ERROR_FORMAT, "%s is given without %s; expected both or neither",
                         options->proxy_user ? "--proxy-user" : "--listen unix:",
                         options->proxy_user ? "--listen unix:" : "--proxy-user");
    return true;
}

bool options_read(struct options *options, int argc, char **argv, struct error *err)
{
    bool given[N_SETTINGS] = { false };
    *options = (struct options){ .max_renderers = 8,
                                 .max_renderer_mib = 16384,
                                 .plan_idle_close_s = 600,
                                 .room_idle_close_s = 86400,
                                 .max_rooms = 200,
                                 .max_members = 100,
                                 .recording_speed = 1,
                                 .max_upload_mib = 2048,
                                 .max_unpacked_mib = 8192,
                                 .max_cache_mib = 16384,
                                 .disk_reserve_mib = 64,
                                 .session_idle_min = 30,
                                 .session_max_h = 12,
                                 .log_level = LOG_INFO };
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "-h") == 0 || strcmp(argv[i], "--help") == 0) {
            options->wants_help = true;
            return true;
        }
        if (strcmp(argv[i], "--version") == 0) {
            options->wants_version = true;
            return true;
        }
        if (strncmp(argv[i], "--", 2) != 0)
            return error_set(err, ERROR_FORMAT, "\"%.60s\" is not a flag; see --help", argv[i]);
        const char *name = argv[i] + 2, *value = strchr(name, '=');
        size_t n = value ? (size_t)(value - name) : strlen(name);
        const struct setting *setting = find_setting(name, n);
        bool is_config = n == 6 && strncmp(name, "config", 6) == 0;
        if (!setting && !is_config)
            return error_set(err, ERROR_FORMAT, "there is no flag --%.*s; see --help", (int)(n < 60 ? n : 60), name);
        if (value)
            value++;
        else if (setting && setting->kind == KIND_FLAG)
            value = "yes";
        else if (++i < argc)
            value = argv[i];
        else
            return error_set(err, ERROR_FORMAT, "--%.60s needs a value", name);
        if (is_config)
            set_text((char *)&options->config, value);
        else if (!set(options, setting, value, 0, err))
            return false;
        else
            given[setting - settings] = true;
    }
    options->has_grants_on_command = options->grants.n > 0;
    return (!options->config || read_file(options, options->config, given, err)) && is_whole(options, err) &&
           (options->backup || options->verify_audit || may_serve(options, err));
}

bool options_read_grants(const struct options *options, struct options_grants *grants, struct error *err)
{
    bool given[N_SETTINGS];
    struct options read = { 0 };
    bool ok = true;
    for (size_t i = 0; i < N_SETTINGS; i++)
        given[i] = settings[i].kind != KIND_GRANT;
    *grants = (struct options_grants){ 0 };
    if (options->has_grants_on_command || !options->config)
        for (size_t i = 0; i < options->grants.n; i++)
            ok = ok && add_grant(&read.grants, options->grants.list[i].value, 0, err);
    else
        ok = read_file(&read, options->config, given, err);
    if (ok)
        *grants = read.grants;
    else
        options_grants_finish(&read.grants);
    grants->last_line = read.grants.last_line;
    return ok;
}

void options_finish(struct options *options)
{
    for (size_t i = 0; i < options->n_plan_folders; i++)
        free(options->plan_folders[i]);
    for (size_t i = 0; i < options->n_public_names; i++)
        free(options->public_names[i]);
    free(options->data_folder);
    free(options->web_folder);
    options_grants_finish(&options->grants);
    free(options->config);
    free(options->listen);
    free(options->proxy_user);
    for (size_t i = 0; i < HEAD_N_IDENTITY; i++)
        free(options->identity_names[i]);
    free(options->tls_cert);
    free(options->tls_key);
    free(options->gl);
    free(options->renderer_path);
    free(options->allowed_origin);
    free(options->user);
    free(options->backup);
    free(options->verify_audit);
    free(options->audit_head);
}

void options_print_help(void)
{
    printf(
        "beamroomd: shows neutron capture therapy plans to browsers\n\n"
        "  beamroomd --plans DIR [--listen ADDRESS:PORT] [flags]\n\n"
        "Loads plans from the folders given, draws them here and streams the pictures to any browser that opens the\n"
        "address it prints (\"ready http://...\"). Stops on SIGINT or SIGTERM; reads the certificate of TLS again on SIGHUP.\n"
        "Research and plan review only.\n\n");
    for (size_t i = 0; i < N_SETTINGS; i++) {
        char flag[64];
        (void)snprintf(flag, sizeof flag, "--%s%s%s", settings[i].name, settings[i].value_name ? " " : "",
                       settings[i].value_name ? settings[i].value_name : "");
        printf("  %-28s %s\n", flag, settings[i].about);
    }
    printf("  %-28s %s\n  %-28s %s\n  %-28s %s\n", "--config FILE",
           "the same settings as lines of \"name = value\"; flags win", "--version", "print the version", "--help",
           "print this");
}

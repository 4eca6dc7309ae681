#pragma once
/* The daemon's settings, from the command line and from a configuration file with the same names as keys. */
#include <stddef.h>
#include <stdint.h>

#include "core/base/error.h"
#include "core/base/log.h"
#include "server/front/front.h"
#include "server/front/head.h"

enum { OPTIONS_MAX_PLAN_FOLDERS = 64, OPTIONS_MAX_NAMES = 64, OPTIONS_MAX_LINE = 4096, OPTIONS_MAX_GRANTS = 1000 };

/* Grants, a line of text each. */
struct options_grants {
    struct options_grant {
        char *value; /* FOLDER WHO ROLE */
        int line;    /* of the configuration file; 0: of the command line */
    } * list;
    size_t n;
    int last_line; /* of the configuration file: the last that was read, so the wrong one where reading failed */
};

struct options {
    char *plan_folders[OPTIONS_MAX_PLAN_FOLDERS];
    size_t n_plan_folders;
    char *public_names[OPTIONS_MAX_NAMES];
    size_t n_public_names;
    struct address_range trusted_proxies[ADDRESS_MAX_RANGES];
    size_t n_trusted_proxies;
    char *backup;                    /* the file to copy the database to, instead of serving; NULL: not given */
    char *verify_audit, *audit_head; /* the database whose audit is checked instead; a hash that it must have; NULL: not
                                        given */
    char *tls_cert, *tls_key;        /* files of PEM; both or neither; NULL: not given */
    struct local_socket sockets[FRONT_MAX_SOCKETS]; /* of --listen unix: */
    size_t n_sockets;
    char *proxy_user;                      /* NULL: not given */
    char *identity_names[HEAD_N_IDENTITY]; /* headers of the proxy; NULL: the usual ones */
    char *data_folder, *web_folder, *listen, *gl, *renderer_path, *allowed_origin, *user; /* NULL: not given */
    int64_t max_renderers, max_renderer_mib, plan_idle_close_s, room_idle_close_s, max_rooms, max_members,
        recording_speed;
    int64_t max_upload_mib, max_unpacked_mib, max_cache_mib, disk_reserve_mib;
    bool stub_renderer;
    bool is_open;              /* open-to-everybody */
    bool is_local, is_proxied; /* how people sign in; neither: nobody does */
    bool admits_guests;        /* links may let in who has not signed in */
    int64_t session_idle_min, session_max_h;
    struct options_grants grants;
    char *config;               /* NULL: not given */
    bool has_grants_on_command; /* so those of the file do not count */
    enum log_level log_level;
    bool wants_help, wants_version;
};

/* Fills options with the defaults, the command line and its --config file; the command line wins.
 *   errors ERROR_FORMAT, ERROR_RANGE, ERROR_LIMIT, ERROR_IO; the sentence names the flag, or file and line */
NODISCARD bool options_read(struct options *options, int argc, char **argv, struct error *err);
/* Reads the grants anew, as they stand in the configuration file now. False: grants is empty, but for last_line.
 *   errors as options_read */
NODISCARD bool options_read_grants(const struct options *options, struct options_grants *grants, struct error *err);
void options_grants_finish(struct options_grants *grants);
bool options_signs_in(const struct options *options); /* people have to sign in */
void options_finish(struct options *options);
void options_print_help(void);

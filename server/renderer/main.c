/* beamroom-render: the process that reads one plan, draws it and answers questions about it, for beamroomd. */
#include <errno.h>
#include <fcntl.h>
#include <getopt.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "core/annotate/font.h"
#include "core/base/log.h"
#include "core/base/standard_files.h"
#include "core/load/part_names.h"
#include "core/load/summary.h"
#include "server/renderer/answers.h"
#include "server/renderer/confine.h"
#include "server/renderer/digest.h"
#include "server/renderer/session.h"
#include "server/renderer/unpack_run.h"

enum { EXIT_USAGE = 2 };

static void print_help(void)
{
    fputs(
        "usage: beamroom-render --socket-fd FD --plan-folder DIR --plan-id ID --cache DIR [OPTION]...\n"
        "       beamroom-render --scan DIR\n"
        "       beamroom-render --digest DIR [--known KEY]\n"
        "       beamroom-render --probe-gl [--gl BACK-END]\n"
        "       beamroom-render --unpack ARCHIVE --into FOLDER --max-unpacked-bytes N\n"
        "Reads one plan, draws it and answers questions about it. beamroomd starts one of these for each open plan and speaks\n"
        "with it over a socket; by hand only --scan, --probe-gl and --unpack are of use.\n\n"
        "  --scan DIR         print as JSON what the plan folder DIR holds, without reading voxels, and end\n"
        "  --digest DIR       print as JSON the SHA-256 over names and contents of its files, and end\n"
        "  --known KEY        the key of an earlier --digest: while it is the same, no file is read\n"
        "  --probe-gl         print as JSON how pictures can be drawn on this machine, and end\n"
        "  --unpack ARCHIVE   unpack a zip, or a tar (plain, gzip, bzip2, xz, zstd), printing one JSON object a line: percent, and\n"
        "                     last done or problem; whatever breaks a rule refuses all of it\n"
        "  --into FOLDER      an empty folder to unpack into\n"
        "  --max-unpacked-bytes N  most bytes that may come out of the archive\n"
        "  --gl BACK-END      auto (default), egl-device, egl-surfaceless, osmesa or soft\n"
        "  --stub             no graphics: grey pictures of the right size, for tests\n"
        "  --socket-fd FD     number of the open socket to the daemon\n"
        "  --plan-folder DIR  the plan to read; nothing else is readable from then on\n"
        "  --hide-folder      a plan without a name of its own is called by its id, not by its folder\n"
        "  --statement        the daemon sends a packet \"statement\", after which the plan is read\n"
        "  --plan-id ID       what the daemon calls the plan: letters a-z, digits, '-'\n"
        "  --cache DIR        folder that may be written\n"
        "  --max-file-bytes N  largest file it may write; 0 (default): no limit\n"
        "  --max-bytes N      most memory of its own the process may take; 0 (default): no limit\n"
        "  --help, --version  this text, the version\n\n"
        "It gives up the network, other programs and other files before it reads a plan, as far as the kernel offers that.\n"
        "Exit status: 0 done, or the daemon closed the socket; 1 the connection broke, or GL does not start (--probe-gl);\n"
        "2 wrong usage; 3 the plan cannot be read, or the archive was refused.\n",
        stdout);
}

struct arguments {
    struct session_options session;
    const char *scan, *digest, *known, *cache, *archive, *into;
    bool is_probe;
    uint64_t max_bytes, max_file_bytes, max_unpacked_bytes; /* max_unpacked_bytes 0: not given */
};

static int refuse(const char *what, const char *value)
{
    fprintf(stderr, "beamroom-render: %s%s%s; see beamroom-render --help\n", what, value ? " " : "",
            value ? value : "");
    return EXIT_USAGE;
}

static bool read_number(const char *text, unsigned long long most, unsigned long long *number)
{
    char *end;
    errno = 0;
    *number = strtoull(text, &end, 10);
    return errno == 0 && end != text && *end == 0 && text[0] != '-' && *number <= most;
}

/* Returns -1 to go on, else the exit status. */
static int read_arguments(int argc, char **argv, struct arguments *arguments)
{
    enum {
        HELP = 256,
        VERSION,
        SOCKET,
        FOLDER,
        ID,
        CACHE,
        GL,
        STUB,
        MAX_BYTES,
        SCAN,
        DIGEST,
        KNOWN,
        PROBE,
        UNPACK,
        INTO,
        MAX_UNPACKED,
        MAX_FILE,
        HIDE,
        STATEMENT
    };
    static const struct option options[] = {
        { "help", no_argument, NULL, HELP },
        { "version", no_argument, NULL, VERSION },
        { "socket-fd", required_argument, NULL, SOCKET },
        { "plan-folder", required_argument, NULL, FOLDER },
        { "plan-id", required_argument, NULL, ID },
        { "cache", required_argument, NULL, CACHE },
        { "gl", required_argument, NULL, GL },
        { "stub", no_argument, NULL, STUB },
        { "max-bytes", required_argument, NULL, MAX_BYTES },
        { "scan", required_argument, NULL, SCAN },
        { "digest", required_argument, NULL, DIGEST },
        { "known", required_argument, NULL, KNOWN },
        { "probe-gl", no_argument, NULL, PROBE },
        { "unpack", required_argument, NULL, UNPACK },
        { "into", required_argument, NULL, INTO },
        { "max-unpacked-bytes", required_argument, NULL, MAX_UNPACKED },
        { "max-file-bytes", required_argument, NULL, MAX_FILE },
        { "hide-folder", no_argument, NULL, HIDE },
        { "statement", no_argument, NULL, STATEMENT },
        { NULL, 0, NULL, 0 },
    };
    *arguments = (struct arguments){ .session = { .socket = -1 } };
    unsigned long long number;
    for (int option; (option = getopt_long(argc, argv, "", options, NULL)) != -1;) {
        switch (option) {
        case HELP: print_help(); return EXIT_SUCCESS;
        case VERSION: puts("beamroom-render " BEAMROOM_VERSION); return EXIT_SUCCESS;
        case SOCKET:
            if (!read_number(optarg, 1023, &number))
                return refuse("no file number:", optarg);
            arguments->session.socket = (int)number;
            break;
        case FOLDER: arguments->session.plan_folder = optarg; break;
        case ID: arguments->session.plan_id = optarg; break;
        case CACHE: arguments->cache = optarg; break;
        case GL:
            if (!render_back_end_from_word(optarg, &arguments->session.back_end))
                return refuse("--gl is auto, egl-device, egl-surfaceless, osmesa or soft, not", optarg);
            break;
        case STUB: arguments->session.is_stub = true; break;
        case MAX_BYTES:
            if (!read_number(optarg, UINT64_MAX, &number))
                return refuse("--max-bytes needs a number of bytes, not", optarg);
            arguments->max_bytes = number;
            break;
        case MAX_FILE:
            if (!read_number(optarg, UINT64_MAX, &number))
                return refuse("--max-file-bytes needs a number of bytes, not", optarg);
            arguments->max_file_bytes = number;
            break;
        case SCAN: arguments->scan = optarg; break;
        case HIDE: arguments->session.hides_folder = true; break;
        case STATEMENT: arguments->session.awaits_statement = true; break;
        case DIGEST: arguments->digest = optarg; break;
        case KNOWN: arguments->known = optarg; break;
        case PROBE: arguments->is_probe = true; break;
        case UNPACK: arguments->archive = optarg; break;
        case INTO: arguments->into = optarg; break;
        case MAX_UNPACKED:
            if (!read_number(optarg, UINT64_MAX, &number) || number == 0)
                return refuse("--max-unpacked-bytes needs a number of bytes, not", optarg);
            arguments->max_unpacked_bytes = number;
            break;
        default: return refuse("wrong usage", NULL);
        }
    }
    if (optind < argc)
        return refuse("what is meant by", argv[optind]);
    const struct session_options *session = &arguments->session;
    if (arguments->archive || arguments->into || arguments->max_unpacked_bytes > 0) {
        bool is_whole = arguments->archive && arguments->into && arguments->max_unpacked_bytes > 0;
        return is_whole ? -1 : refuse("--unpack, --into and --max-unpacked-bytes are needed together", NULL);
    }
    if (arguments->scan || arguments->digest || arguments->is_probe)
        return -1;
    if (session->socket < 0 || !session->plan_folder || !session->plan_id || !arguments->cache)
        return refuse("--socket-fd, --plan-folder, --plan-id and --cache are needed", NULL);
    struct stat facts;
    if (fstat(session->socket, &facts) != 0 || !S_ISSOCK(facts.st_mode))
        return refuse("--socket-fd is not an open socket", NULL);
    return -1;
}

static int print_json(cJSON *json)
{
    char *text = json_write(json);
    int failed = puts(text) < 0 || fflush(stdout) != 0;
    free(text);
    cJSON_Delete(json);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}

static int scan(const char *folder, bool hides_folder)
{
    static struct plan_summary summary;
    char name[sizeof summary.name];
    plan_summarize(folder, &summary);
    plan_folder_name(folder, name, sizeof name);
    if (hides_folder && strcmp(summary.name, name) == 0)
        summary.name[0] = 0;
    return print_json(answer_summary(&summary));
}

static int probe_gl(const struct session_options *options, const char *confined)
{
    struct error err = { 0 };
    static const struct render_facts stub_facts = {
        .vendor = "Beamroom", .renderer = "stub", .version = "none", .is_software = true
    };
    struct renderer *renderer = options->is_stub ? NULL : renderer_create(options->back_end, &err);
    cJSON *json;
    if (renderer || options->is_stub) {
        json = answer_gl(renderer ? renderer_facts(renderer) : &stub_facts, options->is_stub);
        cJSON_AddStringToObject(json, "confined", confined);
    } else {
        struct problem problem;
        problem_set(&problem, PROBLEM_GL_UNAVAILABLE, "", "", "%s", err.text);
        json = cJSON_CreateObject();
        cJSON_AddItemToObject(json, "problem", problem_to_json(&problem));
    }
    int status = print_json(json);
    bool has_failed = !renderer && !options->is_stub;
    renderer_destroy(renderer);
    return has_failed ? EXIT_FAILURE : status;
}

int main(int argc, char **argv)
{
    standard_files_fill();
    log_start("beamroom-render", LOG_INFO);
    struct arguments arguments;
    int status = read_arguments(argc, argv, &arguments);
    if (status >= 0)
        return status;
    struct session_options *session = &arguments.session;
    (void)signal(SIGPIPE, SIG_IGN);
    if (arguments.archive)
        return unpack_run(arguments.archive, arguments.into, arguments.max_unpacked_bytes, arguments.max_bytes);
    /* Compiled shaders are code. A renderer must not leave code for another plan's renderer, so the drivers keep them
     * in the plan's own cache folder. */
    if (arguments.cache) {
        (void)setenv("MESA_SHADER_CACHE_DIR", arguments.cache, 1);
        (void)setenv("__GL_SHADER_DISK_CACHE_PATH", arguments.cache, 1);
    } else {
        (void)setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
    }
    if (arguments.digest)
        (void)setpriority(PRIO_PROCESS, 0, 19); /* everything else goes first */
    char confined[128];
    struct confine_options limits = {
        .plan_folder = arguments.scan     ? arguments.scan
                       : arguments.digest ? arguments.digest
                                          : session->plan_folder,
        .cache_folder = arguments.cache,
        .max_bytes = arguments.max_bytes,
        .max_file_bytes = arguments.max_file_bytes,
        .needs_gpu = !arguments.scan && !arguments.digest && !session->is_stub,
    };
    if (!arguments.scan && !arguments.digest)
        font_prepare();
    confine(&limits, confined);
    session->confined = confined;
    session->cache = arguments.cache;
    session->max_bytes = arguments.max_bytes;
    if (arguments.scan)
        return scan(arguments.scan, session->hides_folder);
    if (arguments.digest)
        return print_json(digest_folder(arguments.digest, arguments.known, NULL));
    if (arguments.is_probe)
        return probe_gl(session, confined);
    return session_run(session);
}

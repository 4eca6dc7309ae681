/* `beamroom phantom`: writes the demo plan, a made-up head. */
#include <errno.h>
#include <getopt.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/base/clock.h"
#include "core/phantom/phantom.h"
#include "server/cli/command.h"
#include "server/cli/exit_code.h"

static void print_help(void)
{
    printf(
        "usage: beamroom phantom DIR [--size IxJxK] [--seed N] [--force]\n"
        "Writes the demo plan into the new folder DIR: a head of ellipsoids after a published phantom, with an image,\n"
        "five regions, four dose components, a beam and particle tracks. DIR/README.txt says where each number is from.\n\n"
        "  --size IxJxK  voxels of image and regions toward left, back and top; each %d to %d (default %ux%ux%u)\n"
        "  --seed N      of the image's noise and the tracks, 0 or more (default %" PRIu64 ")\n"
        "  --force       replace a phantom that is there; a folder that holds anything else is never touched\n"
        "  --help        this text\n\n"
        "Equal sizes and seeds give equal files, byte for byte.\n",
        PHANTOM_MIN_SIDE, PHANTOM_MAX_SIDE, phantom_defaults.size[0], phantom_defaults.size[1],
        phantom_defaults.size[2], phantom_defaults.seed);
}

/* A number of digits alone that fits: strtoull would also read "-1" and blanks. */
static bool parse_number(const char **at, uint64_t highest, uint64_t *number)
{
    if (**at < '0' || **at > '9')
        return false;
    char *end;
    errno = 0;
    *number = strtoull(*at, &end, 10);
    *at = end;
    return errno == 0 && *number <= highest;
}

static bool parse_size(const char *text, uint32_t size[3])
{
    for (int axis = 0; axis < 3; axis++) {
        uint64_t side;
        if ((axis > 0 && *text++ != 'x') || !parse_number(&text, UINT32_MAX, &side))
            return false;
        size[axis] = (uint32_t)side;
    }
    return *text == 0;
}

static bool parse_seed(const char *text, uint64_t *seed)
{
    return parse_number(&text, UINT64_MAX, seed) && *text == 0;
}

int command_phantom(int argc, char **argv)
{
    static const struct option long_options[] = { { "size", required_argument, NULL, 's' },
                                                  { "seed", required_argument, NULL, 'n' },
                                                  { "force", no_argument, NULL, 'f' },
                                                  { "help", no_argument, NULL, 'h' },
                                                  { NULL, 0, NULL, 0 } };
    struct phantom_options options = phantom_defaults;
    bool replace = false;
    opterr = 0;
    for (int option; (option = getopt_long(argc, argv, "h", long_options, NULL)) != -1;) {
        switch (option) {
        case 's':
            if (!parse_size(optarg, options.size))
                return command_usage_error("phantom", "--size '%s' is not of the form 256x256x128", optarg);
            break;
        case 'n':
            if (!parse_seed(optarg, &options.seed))
                return command_usage_error("phantom", "--seed '%s' is not a whole number from 0 to %" PRIu64, optarg,
                                           UINT64_MAX);
            break;
        case 'f': replace = true; break;
        case 'h': print_help(); return EXIT_DONE;
        default: return command_usage_error("phantom", "'%s' is not an option or lacks its value", argv[optind - 1]);
        }
    }
    if (argc - optind != 1)
        return command_usage_error("phantom", "one folder is needed, %d are given", argc - optind);

    struct error err = { 0 };
    int64_t start_us = clock_now_us();
    if (!phantom_write(argv[optind], &options, replace, &err)) {
        fprintf(stderr, "beamroom phantom: %s%s\n", err.text,
                err.code == ERROR_STATE && !replace ? "; --force replaces a phantom" : "");
        return err.code == ERROR_RANGE || err.code == ERROR_LIMIT ? EXIT_USAGE : EXIT_REFUSED;
    }
    printf("%s: phantom of %u x %u x %u voxels, seed %" PRIu64 ", written in %.2f s\n", argv[optind], options.size[0],
           options.size[1], options.size[2], options.seed, (double)(clock_now_us() - start_us) / 1e6);
    return EXIT_DONE;
}

/* Reads the words of the commands about accounts. */
#include "server/cli/account_words.h"

#include <getopt.h>
#include <stdio.h>

static const struct option options[] = {
    { "data", required_argument, NULL, 'd' },   { "name", required_argument, NULL, 'n' },
    { "groups", required_argument, NULL, 'g' }, { "user", required_argument, NULL, 'u' },
    { "scope", required_argument, NULL, 's' },  { "days", required_argument, NULL, 't' },
    { "folder", required_argument, NULL, 'f' }, { "json", no_argument, NULL, 'j' },
    { "help", no_argument, NULL, 'h' },         { 0 },
};

static bool take(int found, struct account_words *words, const char *command)
{
    switch (found) {
    case 'd': words->data = optarg; return true;
    case 'n': words->name = optarg; return true;
    case 'g': words->groups = optarg; return true;
    case 'u': words->user = optarg; return true;
    case 's': words->scope = optarg; return true;
    case 't': words->days = optarg; return true;
    case 'j': return words->wants_json = true;
    case 'h': return words->wants_help = true;
    case 'f':
        if (words->n_folders == sizeof words->folders / sizeof words->folders[0]) {
            fprintf(stderr, "beamroom %s: more than %zu folders\n", command, words->n_folders);
            return false;
        }
        words->folders[words->n_folders++] = optarg;
        return true;
    default: return false;
    }
}

bool account_words_read(int argc, char **argv, const char *command, struct account_words *words)
{
    *words = (struct account_words){ 0 };
    opterr = 0;
    for (int found; (found = getopt_long(argc, argv, "", options, NULL)) != -1;)
        if (!take(found, words, command)) {
            if (found == '?')
                fprintf(stderr, "beamroom %s: '%s' is not an option, or lacks its value; see --help\n", command,
                        argv[optind - 1]);
            return false;
        }
    const int n = argc - optind;
    words->act = n > 0 ? argv[optind] : NULL;
    words->subject = n > 1 ? argv[optind + 1] : NULL;
    if (n > 2)
        fprintf(stderr, "beamroom %s: '%s' is one word too many\n", command, argv[optind + 2]);
    return n <= 2;
}

#pragma once
/* The words behind `beamroom user` and `beamroom token`. */
#include <stdbool.h>
#include <stddef.h>

struct account_words {
    const char *act, *subject; /* add, ann; subject NULL: none was given */
    const char *data, *name, *groups, *user, *scope, *days;
    const char *folders[32];
    size_t n_folders;
    bool wants_json, wants_help;
};

/* command: its name, for sentences. False: standard error says what is wrong. */
bool account_words_read(int argc, char **argv, const char *command, struct account_words *words);

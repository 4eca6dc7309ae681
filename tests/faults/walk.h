#pragma once
/* Walks through one piece of work: its n-th call of a kind fails, for n = 1, 2, 3, ... until a run has no such call
 * left. After each: a clear error or the very result of a run without faults, nothing kept of memory, descriptors and
 * files, and the next run as if nothing had been. */
#include <stdint.h>

#include "server/wire/problem.h"
#include "tests/faults/faults.h"

/* Outcome of one run. */
struct outcome {
    bool is_done;
    uint64_t digest; /* of the result, when done: outcome_add */
    struct error err;
    struct problem problem; /* instead of err where the work says a problem */
    bool is_told;           /* done with less than all, and the result says so: the digest may differ */
    char notes[400];        /* shown with a finding: outcome_note */
};
void outcome_add(struct outcome *outcome, const void *bytes, size_t n);
void outcome_add_text(struct outcome *outcome, const char *text);
void outcome_add_number(struct outcome *outcome, double number);

void outcome_note(struct outcome *outcome, const char *text);

struct walk {
    const char *name; /* a sentence */
    /* The work, from beginning to end; gives back all it took. What the test itself needs stands between faults_pause
     * and faults_go_on. */
    void (*run)(void *context, struct outcome *outcome);
    void *context;
    const char *folder;        /* whose names must be the same after each run; NULL: none */
    bool kinds[FAULT_N_KINDS]; /* which are walked */
    bool is_library_leaky;  /* DCMTK or libjpeg-turbo is in it, which lose memory when an allocation of theirs fails */
    const char *may_die_in; /* a library that ends the process without memory, "libarchive"; NULL: none */
    bool is_short;          /* without the runs in which every later call fails too */
};

/* Runs it; prints "[       OK ] ..." or what was found. */
void walk_run(const struct walk *walk);
/* The exit status of main. */
int walks_end(void);

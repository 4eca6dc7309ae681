#pragma once
/* RFC 6455 case by case against an echo server: the 301 cases without compression of the Autobahn Testsuite 25.10.1, by
 * their numbers. What a case sends and expects was written from its published description and from the RFC. Where the
 * RFC leaves a choice, the test asks for the strict one: text that is not UTF-8 is refused as soon as a byte shows it,
 * every ping is answered in order. */
#include "tests/unit/ws_client.h"

enum { CODE_PROTOCOL = 1002, CODE_NOT_UTF8 = 1007 };

struct ws_case { /* what a test's state is: its number, a.b.c or a.b (c 0) */
    char name[24];
    int a, b, c;
};

struct ws_group {
    int a, b, n; /* cases a.b.1 to a.b.n; b 0: a.1 to a.n */
    void (*run)(void **state);
};

extern struct ws_client client; /* connected to the echo server when a case begins */
extern const char hello[];

/* Runs the cases of the groups; fails unless there are as many as n_cases. */
int ws_cases_run(const struct ws_group *groups, size_t n_groups, size_t n_cases);
void send_close(unsigned code, const char *reason);
/* The connection still works as it should: it is closed with 1000, and nothing else comes. */
void ends_well(void);
void add_text(unsigned first, const char *text);
void expect_text(const char *text);
/* n bytes, to be freed; a text is of printable ASCII. */
uint8_t *make_payload(size_t n);

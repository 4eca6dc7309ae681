#pragma once
/* Texts from outside that name people: which are taken, and lists of them. Internal to server/auth. Thread: any. */
#include <stdbool.h>
#include <stddef.h>

#include "server/wire/identity.h"
#include "server/wire/problem.h"

/* True: 1 to most bytes of UTF-8 without control characters and characters that do not show. */
bool words_are_printable(const char *text, size_t most);
/* True: printable, of at most IDENTITY_MAX_USER bytes, without spaces and , ; " \ and not beginning with @ or -. */
bool words_are_id(const char *text);
/* Adds the entries of a list, separated by ',' ';' or '\n', without spaces around them; each once. False with problem:
 * one is not an id of a group, or there are too many. */
bool words_read_groups(const char *list, struct identity *identity, struct problem *problem);
/* Adds the entries of a list that was checked before; each ends with '\n'. */
void words_copy_groups(const char *list, struct identity *identity);
/* True: the list, each entry ended by '\n', has this entry. */
bool words_has(const char *list, const char *entry);
/* Copies at most most bytes, whole characters alone. */
void words_cut(char *to, const char *text, size_t most);

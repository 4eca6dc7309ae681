#pragma once
/* The other side of a benchmark: another program that does the same work, run as a process of its own. */
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/types.h>

/* A program that waits for lines on its standard input and answers each by one line. */
struct peer {
    pid_t pid; /* 0: it did not start */
    FILE *to, *from;
};

const char *peer_python(void); /* $PYTHON, else the system's */
/* Starts a program by its name or path, which is arguments[0]; the last is NULL. line: the first line it prints, ""
 * when there is none. False: it cannot be started; peer_end is due all the same. */
bool peer_start(struct peer *peer, const char *const *arguments, char *line, int size);
/* Puts a question, a whole line, and waits for the answer. False: the program is gone. */
bool peer_ask(struct peer *peer, const char *question, char *line, int size);
/* Closes its input, drops what it still prints and waits for its end. The exit status; -1: it did not start or end by
 * itself. */
int peer_end(struct peer *peer);
/* Runs it to its end. Milliseconds from start to end; negative when it cannot run here or fails. */
double peer_run_ms(const char *const *arguments, char *line, int size);

/* Writes bytes to a new file under /tmp for the peer to read; path has room for PEER_PATH_SIZE. The caller unlinks it.
 */
enum { PEER_PATH_SIZE = 32 };
bool peer_write_file(char *path, const void *bytes, size_t n);

#pragma once
/* Asks another program: a script of tests/oracle run by Python. */
#include <stdbool.h>
#include <stddef.h>

enum { ORACLE_MISSING = 77 }; /* no Python, or not the library the script needs */

/* The interpreter: $PYTHON, else Debian's. First of the arguments. */
char *oracle_python(void);

/* Runs the program (arguments end with NULL) and keeps what it prints, zero-terminated; more than fits fails the test.
 * Returns its exit status, ORACLE_MISSING when it could not be started, -1 when a signal ended it. */
int oracle_run(char *const *arguments, char *out, size_t out_size);

/* Unpacks a .tar.xz into a folder that is there; false, with a message, where there is no tar or no xz: skip() then. An
 * archive that cannot be unpacked fails the test. */
bool oracle_unpack(const char *archive, const char *folder);

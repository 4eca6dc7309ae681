#pragma once
/* A password from the terminal, unseen and twice, or a line of standard input. */
#include <stdbool.h>
#include <stddef.h>

enum { PASSWORD_SIZE = 300 };

/* False: standard error says why. */
bool password_read(char password[PASSWORD_SIZE]);

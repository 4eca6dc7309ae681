/* Reads passwords. */
#include "server/cli/password.h"

#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

static bool read_line(char line[PASSWORD_SIZE])
{
    if (!fgets(line, PASSWORD_SIZE, stdin))
        return false;
    const size_t n = strcspn(line, "\n");
    const bool is_whole = line[n] == '\n' || n < PASSWORD_SIZE - 1;
    line[n] = 0;
    return is_whole;
}

static bool ask(const char *what, char line[PASSWORD_SIZE])
{
    fputs(what, stderr);
    const bool is_read = read_line(line);
    fputc('\n', stderr);
    return is_read;
}

bool password_read(char password[PASSWORD_SIZE])
{
    char again[PASSWORD_SIZE] = "";
    struct termios before, silent;
    const bool is_terminal = isatty(STDIN_FILENO) && tcgetattr(STDIN_FILENO, &before) == 0;
    bool is_read;
    if (!is_terminal) {
        is_read = read_line(password);
    } else {
        silent = before;
        silent.c_lflag &= ~(tcflag_t)ECHO;
        (void)tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
        is_read = ask("Password: ", password) && ask("Once more: ", again);
        (void)tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
    }
    const bool is_same = !is_terminal || strcmp(password, again) == 0;
    explicit_bzero(again, sizeof again);
    if (!is_read)
        fputs("beamroom: no password could be read\n", stderr);
    else if (!is_same)
        fputs("beamroom: the two passwords differ\n", stderr);
    return is_read && is_same;
}

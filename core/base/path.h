#pragma once
/* Resolving the paths of folders that are given on the command line. */

/* The absolute path without symbolic links, as realpath gives it; the caller's to free(). A relative path is returned
 * unchanged if it exists but a parent of the working folder must not be entered (EACCES): the process can still use it.
 * NULL with errno set: the path does not exist, cannot be reached, or memory ran out. */
char *path_resolve(const char *path);

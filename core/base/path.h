#pragma once
/* Paths of folders the program is given. */

/* Absolute and without links, as realpath makes it. A path from the working folder on stays as it is where a folder
 * above must not be entered: a process may use what lies below its working folder all the same. NULL with errno: there
 * is nothing, or it cannot be reached. free() */
char *path_resolve(const char *path);

#pragma once
/* Descriptors 0, 1 and 2: standard input, output and error. */

/* Opens /dev/null on each of the three that is closed. Otherwise a file or socket opened later would get that number,
 * and the output or log would be written into it. Opened the wrong way round (0 for writing, 1 and 2 for reading), so
 * using one still fails. Call it first in main. Aborts if /dev/null cannot be opened. */
void standard_files_fill(void);

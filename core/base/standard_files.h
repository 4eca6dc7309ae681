#pragma once
/* The three descriptors a program starts with. Knows nothing of what is read or written there. */

/* Fills those of 0, 1 and 2 that are closed, so that no plan, socket or picture that is opened later gets such a number
 * and then what is meant for standard output or the log. Using one that was closed fails as before. First thing in
 * main. */
void standard_files_fill(void);

#pragma once
/* The log of libwebsockets, which is one for the whole process: its errors are our warnings, its warnings ours to debug
 * with. */

void library_log_start(void); /* before its first call; once or more often */

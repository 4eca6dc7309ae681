#pragma once
/* The least that sending to many costs: a process that does nothing but write the same bytes to its sockets. */
#include <stddef.h>
#include <sys/types.h>

/* Starts it, and gives its port: it answers n connections as WebSockets, then sends each n_bytes, rate times a second,
 * when all but one of the messages before were answered by one of any contents. -1: it could not. To be killed. */
pid_t floor_start(int n, size_t n_bytes, int rate, int *port);

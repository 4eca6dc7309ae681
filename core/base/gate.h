#pragma once
/* A gate that any thread may pass and that is closed once and for good: when gate_close returns, nobody is inside and
 * nobody will be. For shutting down what others call. */
#include <stdbool.h>

struct gate;

struct gate *gate_create(void); /* open */
void gate_destroy(struct gate *gate);
/* True: the caller is inside until gate_leave. False: the gate is closed. Waits only for others to be let in. */
bool gate_enter(struct gate *gate);
void gate_leave(struct gate *gate);
/* Waits until those inside have left. Not from inside. */
void gate_close(struct gate *gate);

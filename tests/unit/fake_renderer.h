#pragma once
/* A made-up renderer: the test program itself, started by the fleet in place of beamroom-render. The file "behave" in
 * the plan's folder says what it does, and what it does wrong. */

/* To be called by the test's main() when it has arguments. */
int fake_renderer_main(int argc, char **argv);

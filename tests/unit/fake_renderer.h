#pragma once
/* A made-up renderer: a test program that the fleet starts as if it were beamroom-render. It behaves as the file
 * "behave" in the plan's folder says; what a renderer may do wrong is done here. */

/* What a test's main() does when it has arguments. */
int fake_renderer_main(int argc, char **argv);

/* beamroom-paper: reads a paper and its pictures from descriptor 3, draws it, writes the PDF back, and ends. Confined
 * before it reads the first byte. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/printer/order.h"
#include "server/renderer/confine.h"

static bool read_all(void *context, void *to, size_t n)
{
    (void)context;
    for (size_t done = 0; done < n;) {
        const ssize_t got = read(PRINTER_SOCKET, (char *)to + done, n - done);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        done += (size_t)got;
    }
    return true;
}

static bool write_all(const unsigned char *from, size_t n)
{
    for (size_t done = 0; done < n;) {
        const ssize_t put = write(PRINTER_SOCKET, from + done, n - done);
        if (put < 0 && errno == EINTR)
            continue;
        if (put <= 0)
            return false;
        done += (size_t)put;
    }
    return true;
}

static int fail(const char *why)
{
    (void)fprintf(stderr, "beamroom-paper: %s\n", why);
    return 1;
}

static int serve(void)
{
    struct order order;
    const char *why = "what came in is not whole";
    size_t n = 0;
    unsigned char *pdf = order_read(&order, read_all, NULL) ? draw_paper(&order.input, &n, &why) : NULL;
    const bool is_done = pdf && write_all(pdf, n);
    if (pdf && !is_done)
        why = "the PDF was not taken whole";
    order_finish(&order);
    free(pdf);
    return is_done ? 0 : fail(why);
}

int main(int argc, char *argv[])
{
    char got[128];
    if (argc == 2 && strcmp(argv[1], "--version") == 0)
        return printf("beamroom-paper %s\n", BEAMROOM_VERSION) < 0;
    if (argc != 2 || strcmp(argv[1], "--serve") != 0) {
        (void)printf(
            "usage: beamroom-paper --serve\n\nStarted by beamroomd for each record that is drawn as PDF; it speaks to it on "
            "descriptor 3.\n\n  --version   print the version\n  --help      print this\n");
        return argc == 2 && strcmp(argv[1], "--help") == 0 ? 0 : 2;
    }
    const struct confine_options options = { .max_bytes = PRINTER_MAX_MEMORY, .cpu_seconds = PRINTER_CPU_S };
    confine(&options, got);
    _exit(serve()); /* without what the fonts' libraries keep until the end */
}

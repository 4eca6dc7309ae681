/* beamroom-paper: reads a paper and its pictures from descriptor 3, draws it, writes the PDF back, and ends. Confined
 * before it reads the first byte. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "server/printer/draw.h"
#include "server/renderer/confine.h"

static bool read_all(void *to, size_t n)
{
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

static bool read_pictures(const struct printer_head *head, struct drawing_input *input, unsigned char *pictures[])
{
    for (int i = 0; i < PRINTER_PICTURES; i++) {
        if (!head->n_pictures[i])
            continue;
        pictures[i] = head->n_pictures[i] <= PRINTER_MAX_PICTURE ? malloc(head->n_pictures[i]) : NULL;
        if (!pictures[i] || !read_all(pictures[i], head->n_pictures[i]))
            return false;
        input->pictures[i] = pictures[i];
        input->n_pictures[i] = head->n_pictures[i];
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
    struct printer_head head;
    struct drawing_input input = { 0 };
    unsigned char *pictures[PRINTER_PICTURES] = { NULL }, *pdf = NULL;
    const char *why = "what came in is not whole";
    size_t n = 0;
    char *json = NULL;
    cJSON *paper = NULL;
    bool ok = read_all(&head, sizeof head) && head.magic == PRINTER_MAGIC && head.n_json <= PRINTER_MAX_JSON &&
              (json = malloc((size_t)head.n_json + 1)) && read_all(json, head.n_json) &&
              (paper = json_read(json, head.n_json, NULL)) && read_pictures(&head, &input, pictures);
    if (ok) {
        input.paper = paper;
        input.is_letter = head.is_letter != 0;
        pdf = draw_paper(&input, &n, &why);
        ok = pdf && write_all(pdf, n);
    }
    cJSON_Delete(paper);
    for (int i = 0; i < PRINTER_PICTURES; i++)
        free(pictures[i]);
    free(json);
    free(pdf);
    return ok ? 0 : fail(why);
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

#pragma once
/* The input of beamroom-paper, which beamroomd sends on descriptor 3: this head, in the machine's own byte order, then
 * the paper as JSON, then its pictures. The PDF comes back on the same socket, and nothing else. Both programs are of
 * one version.
 */
#include <stdint.h>

enum {
    PRINTER_PICTURES = 4,
    PRINTER_SOCKET = 3,
    PRINTER_MAX_JSON = 16 << 20,
    PRINTER_MAX_PICTURE = 8 << 20,
    PRINTER_MAX_PDF = 64 << 20,
    PRINTER_MAX_PAGES = 500,
    PRINTER_CPU_S = 30,            /* of processor time */
    PRINTER_MAX_MEMORY = 768 << 20 /* bytes */
};
struct printer_head {
    uint32_t magic; /* "BRPP" */
    uint32_t is_letter;
    uint32_t n_json, n_pictures[PRINTER_PICTURES];
};
#define PRINTER_MAGIC 0x42525050u

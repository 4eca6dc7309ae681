/* The PDF: drawn once to count its pages, and once for good. */
#include "server/printer/draw.h"

#include <cairo-pdf.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/printer/sheet.h"

struct bytes {
    unsigned char *at;
    size_t n, room;
    bool is_full;
};

static cairo_status_t collect(void *context, const unsigned char *data, unsigned n)
{
    struct bytes *bytes = context;
    if (bytes->n + n > bytes->room) {
        const size_t room = 2 * (bytes->n + n) + 65536;
        unsigned char *more = bytes->n + n <= PRINTER_MAX_PDF ? realloc(bytes->at, room) : NULL;
        if (!more) {
            bytes->is_full = true;
            return CAIRO_STATUS_WRITE_ERROR;
        }
        bytes->at = more;
        bytes->room = room;
    }
    memcpy(bytes->at + bytes->n, data, n);
    bytes->n += n;
    return CAIRO_STATUS_SUCCESS;
}

static cairo_status_t ignore(void *context, const unsigned char *data, unsigned n)
{
    (void)context;
    (void)data;
    (void)n;
    return CAIRO_STATUS_SUCCESS;
}

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    return text ? text : "";
}

/* ---- the whole ---------------------------------------------------------------------------------------------------- */

static void draw_all(struct sheet *sheet)
{
    static const struct ink title = { 15, 0x14181d, true, false, false },
                            under = { 7.5, 0x3f474f, false, false, false };
    const cJSON *paper = sheet->input->paper, *block;
    sheet_begin(sheet);
    sheet_write(sheet, text_of(paper, "title"), &title);
    sheet_write(sheet, text_of(paper, "under"), &under);
    cJSON_ArrayForEach(block, cJSON_GetObjectItemCaseSensitive(paper, "blocks"))
    {
        block_draw(sheet, block);
    }
    sheet_end(sheet);
}

static bool run(const struct drawing_input *input, cairo_write_func_t write, void *context, int n_pages, int *counted)
{
    struct sheet sheet = { .input = input,
                           .width = input->is_letter ? 612 : 595.276,
                           .height = input->is_letter ? 792 : 841.89,
                           .left = SHEET_SIDE,
                           .n_pages = n_pages };
    char date[32];
    const double ms = json_number(input->paper, "time_ms", 0);
    const time_t at = ms > 0 && ms < 4e12 ? (time_t)(ms / 1000) : 0;
    struct tm utc = { 0 };
    (void)gmtime_r(&at, &utc);
    (void)strftime(date, sizeof date, "%Y-%m-%dT%H:%M:%SZ", &utc);
    sheet.right = sheet.width - SHEET_SIDE;
    sheet.bottom = sheet.height - SHEET_FOOT - 4;
    sheet.surface = cairo_pdf_surface_create_for_stream(write, context, sheet.width, sheet.height);
    cairo_pdf_surface_set_metadata(sheet.surface, CAIRO_PDF_METADATA_TITLE, text_of(input->paper, "title"));
    cairo_pdf_surface_set_metadata(sheet.surface, CAIRO_PDF_METADATA_CREATOR, "Beamroom " BEAMROOM_VERSION);
    cairo_pdf_surface_set_metadata(sheet.surface, CAIRO_PDF_METADATA_CREATE_DATE, date);
    sheet.cairo = cairo_create(sheet.surface);
    draw_all(&sheet);
    cairo_destroy(sheet.cairo);
    cairo_surface_finish(sheet.surface);
    const bool is_good = cairo_surface_status(sheet.surface) == CAIRO_STATUS_SUCCESS;
    cairo_surface_destroy(sheet.surface);
    *counted = sheet.page;
    return is_good;
}

unsigned char *draw_paper(const struct drawing_input *input, size_t *n_bytes, const char **why)
{
    struct bytes bytes = { 0 };
    int n_pages = 0;
    *why = "it could not be drawn";
    if (!run(input, ignore, NULL, 0, &n_pages))
        return NULL;
    if (n_pages >= PRINTER_MAX_PAGES) {
        *why = "it has too many pages";
        return NULL;
    }
    if (run(input, collect, &bytes, n_pages, &n_pages) && !bytes.is_full) {
        *n_bytes = bytes.n;
        return bytes.at;
    }
    if (bytes.is_full)
        *why = "it has too many bytes";
    free(bytes.at);
    return NULL;
}

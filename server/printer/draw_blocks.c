/* The blocks of a paper on a sheet: headings, text, tables, histograms, figures. */
#include <math.h>
#include <pango/pangocairo.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/printer/sheet.h"

enum { MAX_COLUMNS = 12, UNBROKEN_ROWS = 8 };
static const unsigned dark = 0x14181d, pale = 0x3f474f, rule = 0xd3d8dd;

static const cJSON *get(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

static const char *text_of(const cJSON *object, const char *name)
{
    const char *text = json_text(object, name);
    return text ? text : "";
}

/* A small whole number; -1 for anything else. */
static int int_of(const cJSON *object, const char *name)
{
    const double value = json_number(object, name, -1);
    return value >= 0 && value < 1e6 ? (int)value : -1;
}

static bool is(const cJSON *object, const char *name, const char *word)
{
    return strcmp(text_of(object, name), word) == 0;
}

static unsigned rgb_of(const char *text)
{
    return text[0] == '#' ? (unsigned)strtoul(text + 1, NULL, 16) & 0xffffff : 0x333333;
}

/* ---- words -------------------------------------------------------------------------------------------------------- */

static void draw_heading(struct sheet *sheet, const cJSON *block)
{
    const struct ink bold = { 10, dark, true, false, false }, note = { 7.5, pale, false, false, false };
    sheet_need(sheet, 60);
    sheet->y += sheet->y > sheet->top ? 8 : 0;
    PangoLayout *heading = sheet_text(sheet, text_of(block, "text"), &bold, sheet->right - sheet->left);
    PangoRectangle place;
    pango_layout_get_pixel_extents(heading, NULL, &place);
    sheet_show(sheet, heading, sheet->left, sheet->y, dark);
    if (text_of(block, "note")[0]) {
        const double x = sheet->left + place.width + 6;
        PangoLayout *beside = sheet_text(sheet, text_of(block, "note"), &note, sheet->right - x);
        pango_layout_set_height(beside, -1);
        pango_layout_set_ellipsize(beside, PANGO_ELLIPSIZE_END);
        sheet_show(sheet, beside, x, sheet->y + 2, pale);
        g_object_unref(beside);
    }
    sheet->y += layout_height(heading) + 2;
    g_object_unref(heading);
}

static void draw_text(struct sheet *sheet, const cJSON *block)
{
    const bool is_pale = is(block, "style", "pale"), is_warning = is(block, "style", "warn");
    const struct ink ink = { is_pale ? 7.5 : 8, is_pale ? pale : is_warning ? 0x7a4b00 : dark, false, false, false };
    sheet->y += 2;
    sheet_write(sheet, text_of(block, "text"), &ink);
}

/* ---- tables ------------------------------------------------------------------------------------------------------- */

struct table {
    const cJSON *columns;
    int n;
    double x[MAX_COLUMNS], width[MAX_COLUMNS];
    bool is_right[MAX_COLUMNS];
};

struct row {
    PangoLayout *cells[MAX_COLUMNS];
    unsigned rgb[MAX_COLUMNS];
    double height; /* with the space around */
};

static void read_columns(const struct sheet *sheet, const cJSON *block, struct table *table)
{
    const cJSON *column;
    const double wide = sheet->right - sheet->left;
    double x = sheet->left;
    *table = (struct table){ .columns = get(block, "columns") };
    cJSON_ArrayForEach(column, table->columns)
    {
        if (table->n == MAX_COLUMNS)
            break;
        const double share = fmin(fmax(json_number(column, "percent", 10), 1), 100) / 100 * wide;
        table->x[table->n] = x;
        table->width[table->n] = fmax(share - 6, 8);
        table->is_right[table->n++] = is(column, "side", "right");
        x += share;
    }
}

static struct row make_row(const struct sheet *sheet, const struct table *table, const cJSON *cells, bool is_head)
{
    struct row row = { .height = 0 };
    for (int i = 0; i < table->n; i++) {
        const cJSON *cell = cJSON_GetArrayItem(cells, i);
        const bool is_good = is(cell, "style", "ok"), is_bad = is(cell, "style", "err"),
                   is_warning = is(cell, "style", "warn"), is_code = is(cell, "style", "code");
        const struct ink ink = { is_head   ? 7
                                 : is_code ? 6.6
                                           : 7.6,
                                 dark, is_good || is_bad || is_warning || is(cell, "style", "bold"), table->is_right[i],
                                 is_code };
        row.rgb[i] = is_head ? pale : is_good ? 0x14652f : is_bad ? 0xa3211a : is_warning ? 0x7a4b00 : dark;
        row.cells[i] = sheet_text(sheet, text_of(cell, "text"), &ink, table->width[i]);
        row.height = fmax(row.height, layout_height(row.cells[i]) + 5);
    }
    return row;
}

static void free_row(const struct table *table, struct row *row)
{
    for (int i = 0; i < table->n; i++)
        g_object_unref(row->cells[i]);
}

/* The lines of a cell between two heights of it, from the sheet's y on. */
static void show_part(const struct sheet *sheet, PangoLayout *cell, double x, unsigned rgb, double from, double to)
{
    PangoLayoutIter *lines = pango_layout_get_iter(cell);
    do {
        int low, high;
        PangoRectangle extents;
        pango_layout_iter_get_line_yrange(lines, &low, &high);
        if ((double)low / PANGO_SCALE < from - 0.01 || (double)high / PANGO_SCALE > to + 0.01)
            continue;
        pango_layout_iter_get_line_extents(lines, NULL, &extents);
        cairo_set_source_rgb(sheet->cairo, (rgb >> 16 & 0xff) / 255.0, (rgb >> 8 & 0xff) / 255.0, (rgb & 0xff) / 255.0);
        cairo_move_to(sheet->cairo, x + (double)extents.x / PANGO_SCALE,
                      sheet->y + 2 + (double)pango_layout_iter_get_baseline(lines) / PANGO_SCALE - from);
        pango_cairo_show_layout_line(sheet->cairo, pango_layout_iter_get_line_readonly(lines));
    } while (pango_layout_iter_next_line(lines));
    pango_layout_iter_free(lines);
}

/* Where lines of the highest cell end at or before this height of it. */
static double last_whole_line(const struct table *table, const struct row *row, double from, double to)
{
    double end = from;
    for (int i = 0; i < table->n; i++) {
        PangoLayoutIter *lines = pango_layout_get_iter(row->cells[i]);
        do {
            int low, high;
            pango_layout_iter_get_line_yrange(lines, &low, &high);
            if ((double)high / PANGO_SCALE <= to && (double)high / PANGO_SCALE > end)
                end = (double)high / PANGO_SCALE;
        } while (pango_layout_iter_next_line(lines));
        pango_layout_iter_free(lines);
    }
    return end;
}

static void show_row(struct sheet *sheet, const struct table *table, const struct row *row)
{
    for (int i = 0; i < table->n; i++)
        sheet_show(sheet, row->cells[i], table->x[i], sheet->y + 2, row->rgb[i]);
    sheet->y += row->height;
    sheet_line(sheet, sheet->left, sheet->y - 1, sheet->right, sheet->y - 1, rule, 0.5);
}

static void show_head(struct sheet *sheet, const struct table *table)
{
    struct row head = make_row(sheet, table, table->columns, true);
    show_row(sheet, table, &head);
    free_row(table, &head);
}

/* A row that is higher than a page goes on with its next line on the next. */
static void show_long_row(struct sheet *sheet, const struct table *table, const struct row *row)
{
    const double all = row->height - 5;
    for (double from = 0; from < all - 0.01 && sheet->page < PRINTER_MAX_PAGES;) {
        double to = last_whole_line(table, row, from, from + sheet->bottom - sheet->y - 5);
        if (to <= from) {
            sheet_new_page(sheet);
            show_head(sheet, table);
            to = last_whole_line(table, row, from, from + sheet->bottom - sheet->y - 5);
            if (to <= from)
                return; /* a line that is higher than a page */
        }
        for (int i = 0; i < table->n; i++)
            show_part(sheet, row->cells[i], table->x[i], row->rgb[i], from, to);
        sheet->y += to - from + 5;
        from = to;
    }
    sheet_line(sheet, sheet->left, sheet->y - 1, sheet->right, sheet->y - 1, rule, 0.5);
}

static void draw_table(struct sheet *sheet, const cJSON *block)
{
    struct table table;
    const cJSON *rows = get(block, "rows"), *cells;
    const double head = 16, page = sheet->bottom - sheet->top - head;
    double all = head;
    int n = 0;
    read_columns(sheet, block, &table);
    cJSON_ArrayForEach(cells, rows)
    {
        if (n++ >= UNBROKEN_ROWS)
            break;
        struct row row = make_row(sheet, &table, cells, false);
        all += n <= UNBROKEN_ROWS ? row.height : 0;
        free_row(&table, &row);
    }
    sheet_need(sheet, n < UNBROKEN_ROWS && all <= page ? all : 40);
    show_head(sheet, &table);
    cJSON_ArrayForEach(cells, rows)
    {
        struct row row = make_row(sheet, &table, cells, false);
        if (row.height <= page && sheet->y + row.height > sheet->bottom && sheet->page < PRINTER_MAX_PAGES) {
            sheet_new_page(sheet);
            show_head(sheet, &table);
        }
        if (row.height <= page)
            show_row(sheet, &table, &row);
        else
            show_long_row(sheet, &table, &row);
        free_row(&table, &row);
    }
}

/* ---- the histogram ------------------------------------------------------------------------------------------------ */

struct chart {
    double left, right, top, bottom, end;
};

static double at_x(const struct chart *chart, double value)
{
    return chart->left + (chart->right - chart->left) * value / chart->end;
}

static double at_y(const struct chart *chart, double percent)
{
    return chart->bottom - (chart->bottom - chart->top) * fmin(fmax(percent, 0), 100) / 100;
}

/* The next of 1, 2, 5 times a power of ten that parts the range into at most eight. */
static double step_of(double range)
{
    const double power = pow(10, floor(log10(range)));
    static const double steps[] = { 1, 2, 5, 10 };
    for (size_t i = 0; i < 4; i++)
        if (range / (steps[i] * power) <= 8)
            return steps[i] * power;
    return 10 * power;
}

static void put_word(const struct sheet *sheet, const char *text, double x, double y, double width, bool is_right)
{
    const struct ink ink = { 6.5, dark, false, is_right, false };
    PangoLayout *layout = sheet_text(sheet, text, &ink, width);
    pango_layout_set_height(layout, -1);
    pango_layout_set_ellipsize(layout, PANGO_ELLIPSIZE_END);
    sheet_show(sheet, layout, x, y, dark);
    g_object_unref(layout);
}

/* A name behind its sign also stands at the left when it is written from right to left. */
static void stand_left(PangoLayout *layout)
{
    if (pango_layout_get_direction(layout, 0) == PANGO_DIRECTION_RTL)
        pango_layout_set_alignment(layout, PANGO_ALIGN_RIGHT); /* auto_dir: the end of the line, which is the left */
}

static void set_dash(const struct sheet *sheet, int dash)
{
    static const double dashes[6][4] = { { 1, 0, 1, 0 },   { 5, 2.5, 5, 2.5 }, { 1.5, 2, 1.5, 2 },
                                         { 7, 2, 1.5, 2 }, { 3, 1.5, 3, 1.5 }, { 1, 1.5, 1, 1.5 } };
    const int index = dash >= 0 && dash < 6 ? dash : 0;
    cairo_set_dash(sheet->cairo, dashes[index], index ? 4 : 0, 0);
}

/* The points of a curve, forward from its start or back to it, raised by `more` percent. */
static void trace(const struct sheet *sheet, const struct chart *chart, const cJSON *curve, double more, bool is_back)
{
    const cJSON *list = get(curve, "percent");
    const int n = cJSON_GetArraySize(list);
    const double from = json_number(curve, "from", 0), width = json_number(curve, "width", 0);
    double *shares = n > 0 && n <= 4096 ? malloc((size_t)(n + 1) * sizeof *shares) : NULL;
    const cJSON *share;
    int i = 0;
    if (!shares)
        return;
    cJSON_ArrayForEach(share, list)
    {
        shares[i++] = cJSON_IsNumber(share) ? share->valuedouble : 0;
    }
    shares[n] = 0;
    for (int k = 0; k <= n; k++) {
        const int at = is_back ? n - k : k;
        cairo_line_to(sheet->cairo, at_x(chart, fmin(from + at * width, chart->end)), at_y(chart, shares[at] + more));
    }
    free(shares);
}

static void draw_curve(const struct sheet *sheet, const struct chart *chart, const cJSON *curve)
{
    const unsigned rgb = rgb_of(text_of(curve, "color"));
    const double missing = json_number(curve, "missing_percent", 0);
    const double r = (rgb >> 16 & 0xff) / 255.0, g = (rgb >> 8 & 0xff) / 255.0, b = (rgb & 0xff) / 255.0;
    cairo_new_path(sheet->cairo); /* words leave a point */
    if (missing > 0) {
        trace(sheet, chart, curve, missing, false);
        trace(sheet, chart, curve, 0, true);
        cairo_close_path(sheet->cairo);
        cairo_set_source_rgba(sheet->cairo, r, g, b, 0.18);
        cairo_fill(sheet->cairo);
    }
    trace(sheet, chart, curve, 0, false);
    cairo_set_source_rgb(sheet->cairo, r, g, b);
    cairo_set_line_width(sheet->cairo, 1);
    set_dash(sheet, int_of(curve, "dash"));
    cairo_stroke(sheet->cairo);
    cairo_set_dash(sheet->cairo, NULL, 0, 0);
}

static void draw_axes(const struct sheet *sheet, const struct chart *chart)
{
    char text[32];
    const double step = step_of(chart->end);
    for (int percent = 0; percent <= 100; percent += 25) {
        (void)snprintf(text, sizeof text, "%d", percent);
        sheet_line(sheet, chart->left, at_y(chart, percent), chart->right, at_y(chart, percent), rule, 0.5);
        put_word(sheet, text, chart->left - 26, at_y(chart, percent) - 4, 22, true);
    }
    for (int i = 0; i * step <= chart->end * (1 + 1e-9) && i <= 10; i++) {
        (void)snprintf(text, sizeof text, "%.6g", i * step);
        put_word(sheet, text, at_x(chart, i * step) - 3, chart->bottom + 3, 40, false);
    }
}

/* The names of the curves, each behind a piece of its line. */
static void draw_key(struct sheet *sheet, const cJSON *curves)
{
    const struct ink ink = { 7, dark, false, false, false };
    const cJSON *curve;
    double x = sheet->left, line = 10;
    cJSON_ArrayForEach(curve, curves)
    {
        char text[400];
        const double missing = json_number(curve, "missing_percent", 0);
        const unsigned rgb = rgb_of(text_of(curve, "color"));
        (void)snprintf(text, sizeof text, missing > 0 ? "%.300s: in the band, %.1f %% has no dose" : "%.300s",
                       text_of(curve, "name"), missing);
        PangoLayout *layout = sheet_text(sheet, text, &ink, sheet->right - sheet->left - 30);
        PangoRectangle place;
        stand_left(layout);
        pango_layout_get_pixel_extents(layout, NULL, &place);
        if (x > sheet->left && x + place.width + 40 > sheet->right) {
            x = sheet->left;
            sheet->y += line;
            line = 10;
        }
        if (x == sheet->left) /* as a rule one line; a long name has more */
            sheet_need(sheet, fmax(12, layout_height(layout)));
        line = fmax(line, layout_height(layout) + 1);
        cairo_set_source_rgb(sheet->cairo, (rgb >> 16 & 0xff) / 255.0, (rgb >> 8 & 0xff) / 255.0, (rgb & 0xff) / 255.0);
        set_dash(sheet, int_of(curve, "dash"));
        cairo_set_line_width(sheet->cairo, 1.2);
        cairo_move_to(sheet->cairo, x, sheet->y + 5);
        cairo_line_to(sheet->cairo, x + 22, sheet->y + 5);
        cairo_stroke(sheet->cairo);
        cairo_set_dash(sheet->cairo, NULL, 0, 0);
        sheet_show(sheet, layout, x + 26, sheet->y, dark);
        x += place.width + 40;
        g_object_unref(layout);
    }
    sheet->y += line + 2;
}

static void draw_chart(struct sheet *sheet, const cJSON *block)
{
    const cJSON *curves = get(block, "curves"), *curve;
    double end = 0;
    sheet_need(sheet, 160);
    cJSON_ArrayForEach(curve, curves)
    {
        end = fmax(end, json_number(curve, "from", 0) +
                            json_number(curve, "width", 0) * cJSON_GetArraySize(get(curve, "percent")));
    }
    const struct chart chart = { sheet->left + 28, sheet->right - 4, sheet->y + 14, sheet->y + 112,
                                 end > 1e-9 && isfinite(end) ? end : 1 };
    put_word(sheet, text_of(block, "y"), sheet->left, sheet->y, sheet->right - sheet->left, false);
    draw_axes(sheet, &chart);
    cJSON_ArrayForEach(curve, curves)
    {
        draw_curve(sheet, &chart, curve);
    }
    put_word(sheet, text_of(block, "x"), sheet->left, chart.bottom + 13, sheet->right - sheet->left, true);
    sheet->y = chart.bottom + 24;
    draw_key(sheet, curves);
}

/* ---- figures ------------------------------------------------------------------------------------------------------ */

/* The JPEG goes into the PDF as it is: the pixels of the surface that carries it are never looked at. */
static void draw_picture(const struct sheet *sheet, const cJSON *figure, double x, double y, double width,
                         double height)
{
    const int place = int_of(figure, "place"), w = int_of(figure, "width_px"), h = int_of(figure, "height_px");
    cairo_rectangle(sheet->cairo, x, y, width, height);
    cairo_set_source_rgb(sheet->cairo, 0.93, 0.94, 0.95);
    cairo_fill(sheet->cairo);
    if (place < 0 || place >= PRINTER_PICTURES || !sheet->input->pictures[place] || w < 1 || w > 4096 || h < 1 ||
        h > 4096)
        return;
    cairo_surface_t *image = cairo_image_surface_create(CAIRO_FORMAT_RGB24, w, h);
    (void)cairo_surface_set_mime_data(image, CAIRO_MIME_TYPE_JPEG, sheet->input->pictures[place],
                                      sheet->input->n_pictures[place], NULL, NULL);
    cairo_save(sheet->cairo);
    cairo_translate(sheet->cairo, x, y);
    cairo_scale(sheet->cairo, width / w, height / h);
    cairo_set_source_surface(sheet->cairo, image, 0, 0);
    cairo_paint(sheet->cairo);
    cairo_restore(sheet->cairo);
    cairo_surface_destroy(image);
}

/* Parts of a caption beside each other, each behind the square of its colour. Returns the height. */
static double draw_caption(const struct sheet *sheet, const cJSON *caption, double x, double y, double width,
                           bool is_shown)
{
    const struct ink ink = { 6.5, dark, false, false, false };
    const cJSON *part;
    double at = x, top = y, line = 9;
    cJSON_ArrayForEach(part, caption)
    {
        const char *rgb = text_of(part, "rgb");
        const double chip = rgb[0] ? 9 : 0;
        PangoLayout *layout = sheet_text(sheet, text_of(part, "text"), &ink, width - chip);
        PangoRectangle place;
        stand_left(layout);
        pango_layout_get_pixel_extents(layout, NULL, &place);
        if (at > x && at + chip + place.width > x + width) {
            at = x;
            top += line;
            line = 9;
        }
        if (is_shown && chip > 0) {
            const unsigned color = rgb_of(rgb);
            cairo_rectangle(sheet->cairo, at, top + 1.2, 6, 6);
            cairo_set_source_rgb(sheet->cairo, (color >> 16 & 0xff) / 255.0, (color >> 8 & 0xff) / 255.0,
                                 (color & 0xff) / 255.0);
            cairo_fill_preserve(sheet->cairo);
            cairo_set_source_rgb(sheet->cairo, 0.1, 0.1, 0.1);
            cairo_set_line_width(sheet->cairo, 0.3);
            cairo_stroke(sheet->cairo);
        }
        if (is_shown)
            sheet_show(sheet, layout, at + chip, top, dark);
        line = fmax(line, layout_height(layout) + 1);
        at += chip + place.width + 8;
        g_object_unref(layout);
    }
    return top + line - y;
}

static void draw_figures(struct sheet *sheet, const cJSON *block)
{
    const struct ink bold = { 8, dark, true, false, false };
    const cJSON *list = get(block, "figures"), *figure;
    const bool is_half = is(block, "width", "half");
    const double all = sheet->right - sheet->left, gap = 10, width = is_half ? (all - gap) / 2 : all;
    const double picture = fmin(width * 0.75, (sheet->bottom - sheet->top) * 0.56);
    double below = 0, x = sheet->left;
    cJSON_ArrayForEach(figure, list)
    {
        below = fmax(below, draw_caption(sheet, get(figure, "caption"), 0, 0, width, false));
    }
    sheet_need(sheet, 14 + picture + below + 10);
    sheet->y += 4;
    int n = 0;
    cJSON_ArrayForEach(figure, list)
    {
        if (n++ == (is_half ? 2 : 1))
            break;
        const double shown = picture / 0.75;
        PangoLayout *title = sheet_text(sheet, text_of(figure, "title"), &bold, width);
        pango_layout_set_height(title, -1);
        pango_layout_set_ellipsize(title, PANGO_ELLIPSIZE_END);
        sheet_show(sheet, title, x, sheet->y, dark);
        g_object_unref(title);
        draw_picture(sheet, figure, x, sheet->y + 13, shown, picture);
        (void)draw_caption(sheet, get(figure, "caption"), x, sheet->y + 13 + picture + 3, width, true);
        x += width + gap;
    }
    sheet->y += 13 + picture + 3 + below + 4;
}

void block_draw(struct sheet *sheet, const cJSON *block)
{
    static const struct {
        const char *type;
        void (*draw)(struct sheet *sheet, const cJSON *block);
    } kinds[] = { { "heading", draw_heading },
                  { "text", draw_text },
                  { "table", draw_table },
                  { "chart", draw_chart },
                  { "figures", draw_figures } };
    if (is(block, "type", "page") && sheet->y > sheet->top && sheet->page < PRINTER_MAX_PAGES)
        sheet_new_page(sheet);
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (is(block, "type", kinds[i].type))
            kinds[i].draw(sheet, block);
}

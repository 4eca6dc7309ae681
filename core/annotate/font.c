/* FreeType, and the font's bytes. */
#include "core/annotate/font.h"

#include <fcntl.h>
#include <freetype/freetype.h>
#include <freetype/ftmodapi.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/base/invisible.h"
#include "core/base/log.h"
#include "core/base/mem.h"

#ifndef ANNOTATE_FONT
#define ANNOTATE_FONT "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf" /* Debian's fonts-dejavu-core */
#endif

/* The font file, put into the program by the assembler. */
__asm__(".pushsection .rodata\n"
        ".balign 16\n"
        ".global annotate_font_begin\n"
        ".hidden annotate_font_begin\n"
        "annotate_font_begin:\n"
        ".incbin \"" ANNOTATE_FONT "\"\n"
        ".global annotate_font_end\n"
        ".hidden annotate_font_end\n"
        "annotate_font_end:\n"
        ".popsection\n");
extern const unsigned char annotate_font_begin[], annotate_font_end[];

enum { ELLIPSIS = 0x2026, REPLACEMENT = 0xfffd };

enum { N_FALLBACKS = 2 };

struct font {
    struct FT_MemoryRec_ memory;
    FT_Library library;
    FT_Face face;
    FT_Face fallbacks[N_FALLBACKS]; /* for characters that face lacks; NULL: not opened yet, or there is none */
    bool has_looked_for_fallbacks;
    int size_px, ascent_px, descent_px;
    bool is_short; /* an allocation failed: FreeType does not report all of them, but does without a module */
};

static void *allocate(FT_Memory memory, long size)
{
    struct font *font = memory->user;
    void *block = malloc((size_t)size);
    font->is_short = font->is_short || !block;
    return block;
}

static void release(FT_Memory memory, void *block)
{
    (void)memory;
    free(block);
}

static void *resize(FT_Memory memory, long old_size, long size, void *block)
{
    struct font *font = memory->user;
    void *resized = realloc(block, (size_t)size);
    (void)old_size;
    font->is_short = font->is_short || !resized;
    return resized;
}

/* ---- fallback fonts ---------------------------------------------------------------------------------------------- */

/* Debian's fonts-droid-fallback: the first has more Chinese letters, the second the Korean ones. */
static const char *const fallback_paths[N_FALLBACKS] = {
    "/usr/share/fonts/truetype/droid/DroidSansFallbackFull.ttf",
    "/usr/share/fonts-droid-fallback/truetype/DroidSansFallback.ttf",
};
enum { MAX_FALLBACK_BYTES = 64 << 20 };

static struct fallback_file {
    const void *bytes; /* mapped until the process ends; NULL: there is none */
    size_t n_bytes;
} fallback_files[N_FALLBACKS];

static void map_fallback(const char *path, struct fallback_file *mapped)
{
    struct stat about;
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file < 0)
        return;
    void *bytes = MAP_FAILED;
    if (fstat(file, &about) == 0 && S_ISREG(about.st_mode) && about.st_size > 0 && about.st_size <= MAX_FALLBACK_BYTES)
        bytes = mmap(NULL, (size_t)about.st_size, PROT_READ, MAP_PRIVATE, file, 0);
    close(file);
    if (bytes != MAP_FAILED)
        *mapped = (struct fallback_file){ bytes, (size_t)about.st_size };
}

static void map_fallbacks(void)
{
    const char *chosen = getenv("BEAMROOM_FALLBACK_FONT");
    for (size_t i = 0; i < (chosen ? 1 : N_FALLBACKS); i++)
        map_fallback(chosen ? chosen : fallback_paths[i], &fallback_files[i]);
}

void font_prepare(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;
    pthread_once(&once, map_fallbacks);
}

static void say_missing(void)
{
    log_warn(
        "no font for some letters of a caption; they are drawn as <U+4E00>. Debian's fonts-droid-fallback has those "
        "of Chinese, Japanese and Korean");
}

/* Opens the fallback fonts in this size, as far as they are there and not damaged. */
static void open_fallbacks(struct font *font)
{
    font->has_looked_for_fallbacks = true;
    font_prepare();
    for (size_t i = 0; i < N_FALLBACKS; i++) {
        FT_Face face;
        if (!fallback_files[i].bytes ||
            FT_New_Memory_Face(font->library, fallback_files[i].bytes, (FT_Long)fallback_files[i].n_bytes, 0, &face))
            continue;
        if (FT_Set_Pixel_Sizes(face, 0, (FT_UInt)font->size_px) == 0)
            font->fallbacks[i] = face;
        else
            FT_Done_Face(face);
    }
}

/* status: of a call of FreeType */
static bool is_done(const struct font *font, FT_Error status, struct error *err)
{
    if (!status && !font->is_short)
        return true;
    return error_set(err, ERROR_MEMORY, "no memory for text: FreeType's error %d", status);
}

struct font *font_create(int size_px, struct error *err)
{
    struct font *font = mem_new(sizeof *font);
    font->memory = (struct FT_MemoryRec_){ font, allocate, release, resize };
    FT_Error status = FT_New_Library(&font->memory, &font->library);
    if (!status)
        FT_Add_Default_Modules(font->library);
    if (!status)
        status = FT_New_Memory_Face(font->library, annotate_font_begin,
                                    (FT_Long)(annotate_font_end - annotate_font_begin), 0, &font->face);
    if (!status)
        status = FT_Set_Pixel_Sizes(font->face, 0, (FT_UInt)size_px);
    if (!is_done(font, status, err)) {
        font_destroy(font);
        return NULL;
    }
    font->size_px = size_px;
    font->ascent_px = (int)((font->face->size->metrics.ascender + 63) / 64);
    font->descent_px = (int)((63 - font->face->size->metrics.descender) / 64);
    return font;
}

void font_destroy(struct font *font)
{
    if (!font)
        return;
    for (size_t i = 0; i < N_FALLBACKS; i++)
        if (font->fallbacks[i])
            FT_Done_Face(font->fallbacks[i]);
    if (font->face)
        FT_Done_Face(font->face);
    if (font->library)
        FT_Done_Library(font->library);
    free(font);
}

int font_size_px(const struct font *font)
{
    return font->size_px;
}
int font_ascent_px(const struct font *font)
{
    return font->ascent_px;
}
int font_descent_px(const struct font *font)
{
    return font->descent_px;
}

/* ---- characters ------------------------------------------------------------------------------------------------- */

static bool is_printable(uint32_t c)
{
    return c >= 0x20 && !(c >= 0x7f && c < 0xa0) && c != 0x2065 && !(c >= 0xd800 && c < 0xe000) && c <= 0x10ffff;
}

/* Reads one character of UTF-8 and moves *at behind it, by at least one byte. REPLACEMENT for anything else. */
static uint32_t next_character(const unsigned char **at)
{
    static const uint32_t lowest[4] = { 0, 0x80, 0x800, 0x10000 };
    uint32_t c = *(*at)++;
    int n_more = c < 0x80 ? 0 : c >= 0xc2 && c < 0xe0 ? 1 : c >= 0xe0 && c < 0xf0 ? 2 : c >= 0xf0 && c < 0xf5 ? 3 : -1;
    if (n_more < 0)
        return REPLACEMENT;
    if (n_more)
        c &= 0x3fU >> n_more;
    for (int i = 0; i < n_more; i++) {
        if ((**at & 0xc0) != 0x80)
            return REPLACEMENT;
        c = c << 6 | (*(*at)++ & 0x3fU);
    }
    return c >= lowest[n_more] && is_printable(c) ? c : REPLACEMENT;
}

enum { LOAD = FT_LOAD_TARGET_LIGHT | FT_LOAD_NO_BITMAP };

/* The glyph of the first fallback font that has it; NULL where none has. */
static FT_GlyphSlot fallback_glyph(struct font *font, uint32_t character, FT_Int32 flags)
{
    if (!font->has_looked_for_fallbacks)
        open_fallbacks(font);
    for (size_t i = 0; i < N_FALLBACKS; i++) {
        FT_UInt glyph = font->fallbacks[i] ? FT_Get_Char_Index(font->fallbacks[i], character) : 0;
        if (glyph && FT_Load_Glyph(font->fallbacks[i], glyph, LOAD | flags) == 0)
            return font->fallbacks[i]->glyph;
    }
    return NULL;
}

/* Loads the character's glyph, of a fallback font where the other has none; then what stands for no character. */
static bool load(struct font *font, uint32_t character, FT_Int32 flags, FT_GlyphSlot *slot, struct error *err)
{
    *slot = FT_Get_Char_Index(font->face, character) ? NULL : fallback_glyph(font, character, flags);
    FT_Error status = *slot ? 0 : FT_Load_Char(font->face, character, LOAD | flags);
    if (!*slot)
        *slot = font->face->glyph;
    return is_done(font, status, err);
}

enum { HALF = FONT_MAX_CHARACTERS / 2 };
/* Characters of a text: the first HALF, and the last HALF of those after them. */
struct kept {
    uint32_t first[HALF], last[HALF]; /* last: a ring */
    size_t n;                         /* all, also those given up */
};

static void keep(struct kept *kept, uint32_t c)
{
    *(kept->n < HALF ? &kept->first[kept->n] : &kept->last[kept->n % HALF]) = c;
    kept->n++;
}

static void keep_ascii(struct kept *kept, const char *text)
{
    for (; *text; text++)
        keep(kept, (unsigned char)*text);
}

/* Keeps the character, or the tag of one that does not show, or the number of one that no font has. */
static void keep_visible(struct font *font, struct kept *kept, uint32_t c)
{
    const char *tag = invisible_tag(c);
    if (!tag) {
        static pthread_once_t once = PTHREAD_ONCE_INIT;
        char number[16];
        (void)snprintf(number, sizeof number, "<U+%04X>", (unsigned)c);
        if (FT_Get_Char_Index(font->face, c) || fallback_glyph(font, c, 0))
            keep(kept, c);
        else
            pthread_once(&once, say_missing), keep_ascii(kept, number);
        return;
    }
    keep(kept, 0xab); /* « */
    keep_ascii(kept, tag);
    keep(kept, 0xbb);
}

bool font_lay_out(struct font *font, const char *text, int max_width_px, struct font_line *line, struct error *err)
{
    struct kept kept;
    kept.n = 0;
    *line = (struct font_line){ .n = 0 };
    for (const unsigned char *at = (const unsigned char *)text; *at;)
        keep_visible(font, &kept, next_character(&at));
    size_t n = kept.n, n_first = n < HALF ? n : HALF, n_last = n - n_first < HALF ? n - n_first : HALF;
    memcpy(line->characters, kept.first, n_first * sizeof kept.first[0]);
    for (size_t i = 0; i < n_last; i++)
        line->characters[n_first + i] = kept.last[(n - n_last + i) % HALF];
    FT_GlyphSlot slot;
    int n_kept = line->n = (int)(n_first + n_last);
    for (int i = 0; i < n_kept; i++) {
        if (!load(font, line->characters[i], 0, &slot, err))
            return false;
        line->advance_px[i] = (int)(slot->advance.x >> 6);
        line->width_px += line->advance_px[i];
    }
    if (line->width_px <= max_width_px && n == (size_t)n_kept)
        return true;

    /* [first, behind) becomes an ellipsis */
    if (!load(font, ELLIPSIS, 0, &slot, err))
        return false;
    int ellipsis_px = (int)(slot->advance.x >> 6), first = n_kept / 2, behind = first;
    while (behind - first < n_kept && (behind == first || line->width_px + ellipsis_px > max_width_px))
        line->width_px -= n_kept - behind >= first ? line->advance_px[behind++] : line->advance_px[--first];
    line->characters[first] = ELLIPSIS;
    line->advance_px[first] = ellipsis_px;
    line->width_px += ellipsis_px;
    line->n = first + 1 + n_kept - behind;
    memmove(line->characters + first + 1, line->characters + behind,
            (size_t)(n_kept - behind) * sizeof line->characters[0]);
    memmove(line->advance_px + first + 1, line->advance_px + behind,
            (size_t)(n_kept - behind) * sizeof line->advance_px[0]);
    return true;
}

/* ---- pixels ----------------------------------------------------------------------------------------------------- */

static void put_glyph(const FT_Bitmap *glyph, int left_px, int top_px, struct coverage *coverage)
{
    for (int row = 0; row < (int)glyph->rows; row++) {
        int y = top_px + row;
        if (y < 0 || y >= coverage->height_px)
            continue;
        for (int column = 0; column < (int)glyph->width; column++) {
            int x = left_px + column;
            if (x < 0 || x >= coverage->width_px)
                continue;
            uint8_t value = glyph->buffer[row * glyph->pitch + column];
            uint8_t *pixel = &coverage->pixels[(size_t)y * (size_t)coverage->width_px + (size_t)x];
            *pixel = value > *pixel ? value : *pixel;
        }
    }
}

bool font_draw(struct font *font, const struct font_line *line, int x_px, int baseline_px, struct coverage *coverage,
               struct error *err)
{
    for (int i = 0; i < line->n; i++) {
        FT_GlyphSlot slot;
        if (!load(font, line->characters[i], FT_LOAD_RENDER, &slot, err))
            return false;
        if (slot->bitmap.pixel_mode == FT_PIXEL_MODE_GRAY)
            put_glyph(&slot->bitmap, x_px + slot->bitmap_left, baseline_px - slot->bitmap_top, coverage);
        x_px += line->advance_px[i];
    }
    return true;
}

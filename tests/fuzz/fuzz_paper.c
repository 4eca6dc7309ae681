/* Orders to beamroom-paper: head, paper, pictures. What begins with "{" is the paper of an order whose other parts are
 * good, so that what is found goes deep into the blocks. */
#include "server/printer/order.h"
#include "tests/fuzz/fuzz.h"

struct bytes {
    const uint8_t *at;
    size_t n;
};

static bool take(void *context, void *to, size_t n)
{
    struct bytes *bytes = context;
    if (n > bytes->n)
        return false;
    memcpy(to, bytes->at, n);
    bytes->at += n;
    bytes->n -= n;
    return true;
}

static void draw(struct bytes bytes)
{
    struct order order;
    if (order_read(&order, take, &bytes)) {
        const char *why = NULL;
        size_t n_pdf = 0;
        unsigned char *pdf = draw_paper(&order.input, &n_pdf, &why);
        REQUIRE(pdf ? n_pdf > 5 && n_pdf <= PRINTER_MAX_PDF && memcmp(pdf, "%PDF-", 5) == 0 : why && strlen(why) > 10);
        free(pdf);
    }
    order_finish(&order);
}

/* Called by the leak sanitizer: fontconfig keeps its patterns until the process ends. */
const char *__lsan_default_suppressions(void);
const char *__lsan_default_suppressions(void)
{
    return "leak:libfontconfig";
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t n)
{
    static const uint8_t picture[] = { 0xff, 0xd8, 0xff, 0xe0, 0, 4, 0, 0, 0xff, 0xd9 }; /* a JPEG without an image */
    struct printer_head head = { .magic = PRINTER_MAGIC, .is_letter = n % 2, .n_json = (uint32_t)n };
    if (!n || data[0] != '{') {
        draw((struct bytes){ data, n });
        return 0;
    }
    head.n_pictures[0] = sizeof picture;
    uint8_t *whole = malloc(sizeof head + n + sizeof picture);
    REQUIRE(whole);
    memcpy(whole, &head, sizeof head);
    memcpy(whole + sizeof head, data, n);
    memcpy(whole + sizeof head + n, picture, sizeof picture);
    draw((struct bytes){ whole, sizeof head + n + sizeof picture });
    free(whole);
    return 0;
}

/* Reads Accept-Encoding and chooses a content coding. */
#include "server/http/coding.h"

#include <stddef.h>
#include <string.h>
#include <strings.h>

static const char space[] = " \t";
static const char name_end[] = " \t,;";

const char *coding_name(enum content_coding coding)
{
    return coding == CODING_GZIP ? "gzip" : coding == CODING_BR ? "br" : NULL;
}

static bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* Reads a weight, "0" to "1" with at most three digits after the point, in thousandths; -1 when it is none. */
static int read_weight(const char **at)
{
    const char *p = *at;
    if (*p != '0' && *p != '1')
        return -1;
    int thousandths = (*p++ - '0') * 1000;
    if (*p == '.') {
        p++;
        for (int unit = 100; unit > 0 && is_digit(*p); unit /= 10)
            thousandths += (*p++ - '0') * unit;
    }
    *at = p;
    return thousandths <= 1000 ? thousandths : -1;
}

/* Reads what follows the name of a coding, up to the end of the list's element; -1 when it is not a weight. */
static int read_parameter(const char **at)
{
    const char *p = *at + strspn(*at, space);
    int weight = 1000;
    if (*p == ';') {
        p += 1 + strspn(p + 1, space);
        bool is_weight = (*p == 'q' || *p == 'Q') && p[1] == '=';
        p += is_weight ? 2 : 0;
        weight = is_weight ? read_weight(&p) : -1;
        p += strspn(p, space);
    }
    if (*p && *p != ',')
        weight = -1;
    *at = p + strcspn(p, ",");
    return weight;
}

static bool is_named(const char *name, size_t n, const char *expected)
{
    return n == strlen(expected) && strncasecmp(name, expected, n) == 0;
}

enum content_coding coding_choose(const char *accept, const bool exists[N_CODINGS])
{
    enum { UNNAMED = -1 };
    int weights[N_CODINGS] = { UNNAMED, UNNAMED, UNNAMED };
    int any = UNNAMED; /* of "*" */
    if (!accept)
        return CODING_IDENTITY;
    for (const char *at = accept; *at;) {
        at += strspn(at, " \t,");
        const char *name = at;
        size_t n = strcspn(at, name_end);
        at += n;
        int weight = read_parameter(&at);
        if (n == 0 || weight < 0)
            continue;
        if (is_named(name, n, "*"))
            any = weight;
        else if (is_named(name, n, "gzip") || is_named(name, n, "x-gzip"))
            weights[CODING_GZIP] = weight;
        else if (is_named(name, n, "br"))
            weights[CODING_BR] = weight;
        else if (is_named(name, n, "identity"))
            weights[CODING_IDENTITY] = weight;
    }
    enum content_coding best = CODING_IDENTITY;
    /* identity is accepted without being named, but after anything that is named */
    int best_weight = weights[CODING_IDENTITY] != UNNAMED ? weights[CODING_IDENTITY] : 0;
    for (enum content_coding coding = CODING_GZIP; coding < N_CODINGS; coding++) {
        int weight = weights[coding] != UNNAMED ? weights[coding] : any;
        if (exists[coding] && weight > 0 && weight >= best_weight) {
            best = coding;
            best_weight = weight;
        }
    }
    return best;
}

/* Parses and checks the head of a request. */
#include "server/front/head.h"

#include <ctype.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "server/wire/fields.h"
#include "server/wire/json.h"

/* The headers that are used. */
struct fields {
    struct head_text host, origin, upgrade, connection, key, version, length, coding, forwarded;
    struct head_text
        passed_on; /* name of the header by which a proxy says that it passed the request on; n 0: there is none */
    struct head_text cookie, authorization, identity[HEAD_N_IDENTITY];
    struct head_text misspelt; /* name of a header that is one of identity but for _ and -; n 0: there is none */
    size_t n_identity[HEAD_N_IDENTITY];
    size_t n_hosts, n_origins, n_lengths, n_codings, n_keys, n_versions, n_cookies, n_authorizations;
};

struct head {
    const char *begin;
    struct head_text method, target;
    int minor; /* of HTTP/1.x */
    struct fields fields;
    const struct head_rules *rules;
    struct problem *problem;
};

const char *const head_identity_names[HEAD_N_IDENTITY] = { "X-Beamroom-User", "X-Beamroom-Name", "X-Beamroom-Groups",
                                                           "X-Beamroom-Auth-Time" };

enum { SHOWN_SIZE = 61 };

/* Bytes of a request, made printable for an error sentence. */
static const char *show(struct head_text text, char shown[SHOWN_SIZE])
{
    size_t n = text.n < SHOWN_SIZE - 1 ? text.n : SHOWN_SIZE - 1;
    for (size_t i = 0; i < n; i++)
        shown[i] = text.at[i] >= 32 && text.at[i] < 127 ? text.at[i] : '?';
    shown[n] = 0;
    return shown;
}

static bool is_word(struct head_text text, const char *word)
{
    return text.n == strlen(word) && strncasecmp(text.at, word, text.n) == 0;
}

/* RFC 9110 5.6.2 */
static bool is_token(struct head_text text)
{
    for (size_t i = 0; i < text.n; i++)
        if (!isalnum((unsigned char)text.at[i]) && !memchr("!#$%&'*+-.^_`|~", text.at[i], 15))
            return false;
    return text.n > 0;
}

static struct head_text trim_front(struct head_text text)
{
    while (text.n && (*text.at == ' ' || *text.at == '\t')) {
        text.at++;
        text.n--;
    }
    return text;
}

static struct head_text trim(struct head_text text)
{
    text = trim_front(text);
    while (text.n && (text.at[text.n - 1] == ' ' || text.at[text.n - 1] == '\t'))
        text.n--;
    return text;
}

/* True if the comma-separated list holds the word. */
static bool has_word(struct head_text list, const char *word)
{
    while (list.n) {
        const char *comma = memchr(list.at, ',', list.n);
        size_t n = comma ? (size_t)(comma - list.at) : list.n;
        if (is_word(trim((struct head_text){ list.at, n }), word))
            return true;
        n += comma != NULL;
        list.at += n;
        list.n -= n;
    }
    return false;
}

/* True for a header that a proxy adds to what it passes on (RFC 7239, RFC 9110 7.6.3, and what was used before them).
 */
static bool is_of_proxy(struct head_text name)
{
    static const char before[] = "X-Forwarded-";
    return is_word(name, "Forwarded") || is_word(name, "Via") || is_word(name, "X-Real-IP") ||
           (name.n >= sizeof before - 1 && strncasecmp(name.at, before, sizeof before - 1) == 0);
}

/* Takes the next line, without its line end. Returns false when it is not whole. */
static bool next_line(const char **at, const char *end, struct head_text *line)
{
    const char *newline = memchr(*at, '\n', (size_t)(end - *at));
    if (!newline)
        return false;
    *line = (struct head_text){ *at, (size_t)(newline - *at) };
    if (line->n && newline[-1] == '\r')
        line->n--;
    *at = newline + 1;
    return true;
}

static bool refuse_line(const struct head *head, struct head_text line, const char *expected)
{
    char shown[SHOWN_SIZE];
    return problem_set(head->problem, PROBLEM_REQUEST, "", "", "line 1, the request line, is \"%s\"; expected is %s",
                       show(line, shown), expected);
}

/* METHOD SP TARGET SP HTTP/1.x */
static bool read_request_line(struct head *head, struct head_text line)
{
    static const char form[] = "a method, an address and HTTP/1.1, parted by single spaces";
    const char *end = line.at + line.n, *space = memchr(line.at, ' ', line.n);
    const char *second = space ? memchr(space + 1, ' ', (size_t)(end - space - 1)) : NULL;
    if (!second)
        return refuse_line(head, line, form);
    head->method = (struct head_text){ line.at, (size_t)(space - line.at) };
    head->target = (struct head_text){ space + 1, (size_t)(second - space - 1) };
    struct head_text version = { second + 1, (size_t)(end - second - 1) };
    if (!is_token(head->method) || head->method.n > 32)
        return refuse_line(head, line, "that it begins with a method, as GET");
    for (size_t i = 0; i < head->target.n; i++)
        if ((unsigned char)head->target.at[i] <= 32 || head->target.at[i] == 127)
            return refuse_line(head, line, "an address without control characters");
    bool is_path = head->target.n && head->target.at[0] == '/';
    bool is_whole = head->target.n > 7 && (strncasecmp(head->target.at, "http://", 7) == 0 ||
                                           strncasecmp(head->target.at, "https://", 8) == 0);
    if (!is_path && !is_whole && !is_word(head->target, "*"))
        return refuse_line(head, line, "an address that begins with \"/\" or \"http://\"");
    if (version.n != 8 || memcmp(version.at, "HTTP/", 5) != 0 || !isdigit((unsigned char)version.at[5]) ||
        version.at[6] != '.' || !isdigit((unsigned char)version.at[7]))
        return refuse_line(head, line, form);
    head->minor = version.at[7] - '0';
    if (version.at[5] != '1' || head->minor > 1)
        return problem_set(head->problem, PROBLEM_HTTP_VERSION, "", "",
                           "the request is of HTTP/%.3s; expected is HTTP/1.1 or HTTP/1.0", version.at + 5);
    return true;
}

/* Shows of a secret header its name alone. */
static bool refuse_field(const struct head *head, size_t number, struct head_text line, const char *found)
{
    char shown[SHOWN_SIZE];
    const char *colon = memchr(line.at, ':', line.n);
    const struct head_text name = { line.at, colon ? (size_t)(colon - line.at) : line.n };
    if (is_word(trim(name), "Cookie") || is_word(trim(name), "Authorization"))
        line = name;
    return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                       "header %zu, \"%s\": %s; expected is \"Name: value\" on one line", number, show(line, shown),
                       found);
}

/* True for names that are equal where _ is taken for -, as some readers of headers do. */
static bool is_like(struct head_text name, const char *other)
{
    if (name.n != strlen(other))
        return false;
    for (size_t i = 0; i < name.n; i++) {
        const int a = name.at[i] == '_' ? '-' : tolower((unsigned char)name.at[i]);
        if (a != (other[i] == '_' ? '-' : tolower((unsigned char)other[i])))
            return false;
    }
    return true;
}

static void note_identity(struct head *head, struct head_text name, struct head_text value)
{
    for (size_t i = 0; i < HEAD_N_IDENTITY; i++) {
        const char *known = head->rules->identity_names[i];
        if (is_word(name, known)) {
            head->fields.identity[i] = value;
            head->fields.n_identity[i]++;
        } else if (is_like(name, known))
            head->fields.misspelt = name;
    }
}

bool head_may_be_identity(const char *name)
{
    const struct head_text text = { name, strlen(name) };
    const bool is_free = (strncasecmp(name, "X-", 2) == 0 && name[2]) || strncasecmp(name, "Remote-", 7) == 0;
    return is_token(text) && text.n <= 60 && !strpbrk(name, "_!#$%&'*+.^`|~") && is_free && !is_of_proxy(text);
}

/* Stores the value of a known field. Content-Length and Transfer-Encoding keep blanks after their value, and are then
 * refused: libmicrohttpd counts those blanks as part of the value, and would find a different end of the body. */
static void note_field(struct fields *fields, struct head_text name, struct head_text after_colon)
{
    struct head_text whole = trim_front(after_colon), value = trim(after_colon);
    if (is_of_proxy(name))
        fields->passed_on = name;
    const struct {
        const char *name;
        struct head_text *value;
        size_t *n;
    } known[] = { { "Host", &fields->host, &fields->n_hosts },
                  { "Origin", &fields->origin, &fields->n_origins },
                  { "Content-Length", &fields->length, &fields->n_lengths },
                  { "Transfer-Encoding", &fields->coding, &fields->n_codings },
                  { "Sec-WebSocket-Key", &fields->key, &fields->n_keys },
                  { "Sec-WebSocket-Version", &fields->version, &fields->n_versions },
                  { "Cookie", &fields->cookie, &fields->n_cookies },
                  { "Authorization", &fields->authorization, &fields->n_authorizations },
                  { "X-Forwarded-For", &fields->forwarded, NULL },
                  { "Upgrade", &fields->upgrade, NULL },
                  { "Connection", &fields->connection, NULL } };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (is_word(name, known[i].name)) {
            *known[i].value = known[i].value == &fields->length || known[i].value == &fields->coding ? whole : value;
            if (known[i].n)
                ++*known[i].n;
        }
}

static bool read_field(struct head *head, size_t number, struct head_text line)
{
    const char *colon = memchr(line.at, ':', line.n);
    if (line.at[0] == ' ' || line.at[0] == '\t')
        return refuse_field(head, number, line, "it goes on from the line before");
    if (!colon)
        return refuse_field(head, number, line, "without a colon");
    struct head_text name = { line.at, (size_t)(colon - line.at) }, value = { colon + 1, line.n - name.n - 1 };
    if (!is_token(name))
        return refuse_field(head, number, line, "a name that is none");
    for (size_t i = 0; i < value.n; i++)
        if (((unsigned char)value.at[i] < 32 && value.at[i] != '\t') || value.at[i] == 127)
            return refuse_field(head, number, line, "a control character in its value");
    note_field(&head->fields, name, value);
    note_identity(head, name, trim(value));
    return true;
}

/* The length of the body must be given once and plainly: where two readers find different ends, requests can be
 * smuggled. */
static bool check_length(const struct head *head)
{
    const struct fields *fields = &head->fields;
    char shown[SHOWN_SIZE];
    if (fields->n_lengths > 1)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                           "Content-Length is there %zu times; expected is once", fields->n_lengths);
    if (fields->n_codings > 1)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                           "Transfer-Encoding is there %zu times; expected is once", fields->n_codings);
    if (fields->n_lengths && fields->n_codings)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                           "both Content-Length and Transfer-Encoding are there; expected is one of them");
    if (fields->n_codings && (head->minor == 0 || !is_word(fields->coding, "chunked")))
        return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                           "Transfer-Encoding is \"%s\" in HTTP/1.%d; expected is \"chunked\" in HTTP/1.1",
                           show(fields->coding, shown), head->minor);
    if (!fields->n_lengths)
        return true;
    bool is_number = fields->length.n > 0 && fields->length.n <= 18; /* less than 2^63 */
    for (size_t i = 0; i < fields->length.n; i++)
        is_number = is_number && isdigit((unsigned char)fields->length.at[i]);
    return is_number || problem_set(head->problem, PROBLEM_REQUEST, "", "",
                                    "Content-Length is \"%s\"; expected is a number of at most 18 digits",
                                    show(fields->length, shown));
}

/* A header with a secret may stand there once: of two values another reader could take the other one. */
static bool check_secret(const struct head *head, const char *name, size_t n_times, struct head_text value)
{
    if (n_times > 1)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "", "%s is there %zu times; expected is once at most",
                           name, n_times);
    return value.n <= HEAD_MAX_SECRET ||
           problem_set(head->problem, PROBLEM_HEADERS_TOO_LARGE, "", "", "%s has %zu bytes; at most %d are read", name,
                       value.n, HEAD_MAX_SECRET);
}

static bool check_secrets(const struct head *head)
{
    const struct fields *fields = &head->fields;
    return check_secret(head, "Cookie", fields->n_cookies, fields->cookie) &&
           check_secret(head, "Authorization", fields->n_authorizations, fields->authorization);
}

/* True for the allowed form of a header of the proxy. */
static bool is_of_form(enum head_identity which, struct head_text value)
{
    static const size_t most[HEAD_N_IDENTITY] = { IDENTITY_MAX_USER, IDENTITY_MAX_NAME, HEAD_MAX_GROUPS, 10 };
    if (which == HEAD_USER && is_word(value, "(null)")) /* Apache writes it for a variable that is not set */
        return false;
    if (value.n > most[which] || (which == HEAD_NAME && !json_is_utf8(value.at, value.n)))
        return false;
    for (size_t i = 0; i < value.n; i++) {
        const unsigned char c = (unsigned char)value.at[i];
        if ((which == HEAD_AUTH_TIME && !isdigit(c)) || (which == HEAD_USER && (c <= 32 || c == ',' || c > 126)) ||
            (which == HEAD_GROUPS && (c < 32 || c > 126)))
            return false;
        if (which == HEAD_NAME && (c < 32 || (c == 0xc2 && (unsigned char)value.at[i + 1] < 0xa0)))
            return false; /* C1 control characters */
    }
    return true;
}

static bool check_identity_header(const struct head *head, enum head_identity which)
{
    static const char *const forms[HEAD_N_IDENTITY] = { "at most 64 letters, digits and signs of ASCII",
                                                        "at most 160 bytes of UTF-8",
                                                        "names of ASCII, parted by commas, with at most 4096 bytes",
                                                        "seconds since 1970" };
    const char *name = head->rules->identity_names[which];
    const size_t n_times = head->fields.n_identity[which];
    if (n_times > 0 && !head->rules->takes_identity)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                           "%s says who makes the request; that is believed of the proxy at the Unix socket alone",
                           name);
    if (n_times > 1)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "", "%s is there %zu times; expected is once at most",
                           name, n_times);
    return is_of_form(which, head->fields.identity[which]) ||
           problem_set(head->problem, PROBLEM_REQUEST, "", "", "%s has another form than expected: %s", name,
                       forms[which]);
}

static bool check_identity(const struct head *head)
{
    char shown[SHOWN_SIZE];
    if (head->fields.misspelt.n > 0)
        return problem_set(head->problem, PROBLEM_REQUEST, "", "",
                           "the name %s is that of a header which says who makes the request, but for _ and -",
                           show(head->fields.misspelt, shown));
    for (int i = 0; i < HEAD_N_IDENTITY; i++)
        if (!check_identity_header(head, (enum head_identity)i))
            return false;
    return true;
}

static bool refuse_host(struct problem *problem, struct head_text host)
{
    char shown[SHOWN_SIZE];
    return problem_set(
        problem, PROBLEM_MISDIRECTED, "", "",
        "Host is \"%s\"; expected is an address, localhost, this machine's name, or one that --public-name gave",
        show(host, shown));
}

/* Where nobody signs in, whoever reaches the server may do everything: a proxy on this machine would make that
 * everybody who reaches the proxy. */
static bool check_alone(const struct head *head, const struct hosts *hosts)
{
    const struct fields *fields = &head->fields;
    char shown[SHOWN_SIZE];
    if (!hosts_is_alone(hosts))
        return true;
    if (fields->passed_on.n > 0)
        return problem_set(
            head->problem, PROBLEM_THIS_MACHINE, "", "",
            "a proxy passed the request on (%s), but nobody signs in here, so this server answers its own "
            "machine alone; --open-to-everybody would let everybody in",
            show(fields->passed_on, shown));
    return fields->n_hosts == 0 || hosts_allow(hosts, fields->host.at, fields->host.n) ||
           problem_set(
               head->problem, PROBLEM_THIS_MACHINE, "", "",
               "Host is \"%s\"; nobody signs in here, so this server answers its own machine alone: expected is "
               "127.0.0.1, [::1] or localhost",
               show(fields->host, shown));
}

static bool check_host(const struct head *head, const struct hosts *hosts)
{
    const struct fields *fields = &head->fields;
    if (fields->n_hosts > 1 || (fields->n_hosts == 0 && head->minor > 0))
        return problem_set(head->problem, PROBLEM_REQUEST, "", "", "Host is there %zu times; HTTP/1.1 expects it once",
                           fields->n_hosts);
    return check_alone(head, hosts) && (fields->n_hosts == 0 || hosts_allow(hosts, fields->host.at, fields->host.n) ||
                                        refuse_host(head->problem, fields->host));
}

/* True for "/api/v1/rooms/<room>/ws"; fills in room. */
static bool is_room_address(struct head_text target, struct head_text *room)
{
    static const char before[] = "/api/v1/rooms/";
    const size_t n_before = sizeof before - 1;
    const char *question = target.n ? memchr(target.at, '?', target.n) : NULL;
    size_t n = question ? (size_t)(question - target.at) : target.n;
    if (n <= n_before + 3 || memcmp(target.at, before, n_before) != 0 || memcmp(target.at + n - 3, "/ws", 3) != 0)
        return false;
    *room = (struct head_text){ target.at + n_before, n - n_before - 3 };
    return true;
}

/* True for 16 bytes in base64. */
static bool is_key(struct head_text key)
{
    if (key.n != 24 || key.at[22] != '=' || key.at[23] != '=')
        return false;
    for (size_t i = 0; i < 22; i++)
        if (!isalnum((unsigned char)key.at[i]) && key.at[i] != '+' && key.at[i] != '/')
            return false;
    return true;
}

/* RFC 6455 4.2.1 */
static bool check_handshake(const struct head *head, size_t n_bytes)
{
    const struct fields *fields = &head->fields;
    struct problem *problem = head->problem;
    char shown[SHOWN_SIZE];
    if (head->minor == 0)
        return problem_set(problem, PROBLEM_UPGRADE, "", "", "the handshake is of HTTP/1.0; expected is HTTP/1.1");
    if (!has_word(fields->connection, "upgrade"))
        return problem_set(problem, PROBLEM_UPGRADE, "", "",
                           "the handshake's Connection is \"%s\"; expected is that it says Upgrade",
                           show(fields->connection, shown));
    if (fields->n_versions != 1 || !is_word(fields->version, "13"))
        return problem_set(problem, PROBLEM_UPGRADE, "", "",
                           "the handshake's Sec-WebSocket-Version is \"%s\"; expected is 13, once",
                           show(fields->version, shown));
    if (fields->n_keys != 1 || !is_key(fields->key))
        return problem_set(problem, PROBLEM_REQUEST, "", "",
                           "the handshake's Sec-WebSocket-Key is \"%s\"; expected are 16 bytes in base64, once",
                           show(fields->key, shown));
    if (fields->n_codings || (fields->n_lengths && !is_word(fields->length, "0")))
        return problem_set(problem, PROBLEM_REQUEST, "", "", "the handshake announces a body; expected is none");
    if (fields->n_origins > 1 || fields->origin.n > HANDSHAKE_MAX_ORIGIN)
        return problem_set(
            problem, PROBLEM_REQUEST, "", "",
            "the handshake's Origin is there %zu times, with %zu bytes; expected is once at most, with %d",
            fields->n_origins, fields->origin.n, HANDSHAKE_MAX_ORIGIN);
    if (fields->host.n > HANDSHAKE_MAX_HOST)
        return problem_set(problem, PROBLEM_REQUEST, "", "",
                           "the handshake's Host has %zu bytes; expected are %d at most", fields->host.n,
                           HANDSHAKE_MAX_HOST);
    if (n_bytes > HEAD_MAX_WEBSOCKET)
        return problem_set(problem, PROBLEM_HEADERS_TOO_LARGE, "", "", "a handshake of %zu bytes; at most %d are read",
                           n_bytes, HEAD_MAX_WEBSOCKET);
    return true;
}

static enum head_kind refuse_size(const struct head *head, const char *line, const char *end)
{
    size_t n_line = (size_t)((line ? line : end) - head->begin);
    if (n_line > HEAD_MAX_LINE)
        (void)problem_set(head->problem, PROBLEM_ADDRESS_TOO_LONG, "", "",
                          "the request line has more than %d bytes; at most so many are read", HEAD_MAX_LINE);
    else
        (void)problem_set(head->problem, PROBLEM_HEADERS_TOO_LARGE, "", "",
                          "the request's head has more than %d bytes; at most so many, in %d headers, are read",
                          HEAD_MAX_BYTES, HEAD_MAX_FIELDS);
    return HEAD_REFUSED;
}

/* libmicrohttpd keeps the parameters in the memory of the connection, and gives no answer when they do not fit. */
static bool check_parameters(const struct head *head)
{
    size_t n_parameters = 0;
    bool is_query = false;
    for (size_t i = 0; i < head->target.n; i++) {
        bool is_mark = head->target.at[i] == '?' && !is_query;
        n_parameters += is_mark || (is_query && head->target.at[i] == '&');
        is_query = is_query || is_mark;
    }
    return n_parameters <= HEAD_MAX_PARAMETERS ||
           problem_set(head->problem, PROBLEM_TOO_LARGE, "", "", "the address has %zu parameters; at most %d are read",
                       n_parameters, HEAD_MAX_PARAMETERS);
}

/* digits were checked by check_length. */
static uint64_t number_of(struct head_text digits)
{
    uint64_t number = 0;
    for (size_t i = 0; i < digits.n; i++)
        number = number * 10 + (uint64_t)(digits.at[i] - '0');
    return number;
}

static void copy(char *out, size_t size, struct head_text text)
{
    size_t n = text.n < size ? text.n : 0; /* what does not fit is left out as a whole */
    if (n)
        memcpy(out, text.at, n);
    out[n] = 0;
}

static void fill_handshake(struct handshake *handshake, const struct head *head, struct head_text room, size_t n_head)
{
    *handshake = (struct handshake){ .n_head = n_head };
    copy(handshake->room_id, sizeof handshake->room_id, room);
    if (!id_is_valid(handshake->room_id)) /* ids need no percent-encoding, so none is decoded */
        handshake->room_id[0] = 0;
    copy(handshake->key, sizeof handshake->key, head->fields.key);
    copy(handshake->host, sizeof handshake->host, head->fields.host);
    copy(handshake->origin, sizeof handshake->origin, head->fields.origin);
}

enum head_kind head_look(const char *bytes, size_t n, const struct head_rules *rules, struct problem *problem)
{
    struct head_request request;
    return head_read(bytes, n, rules, &request, problem);
}

enum head_kind head_read(const char *bytes, size_t n, const struct head_rules *rules, struct head_request *request,
                         struct problem *problem)
{
    struct head head = { .begin = bytes, .rules = rules, .problem = problem };
    const char *at = bytes, *end = bytes + n;
    struct head_text line, room;
    size_t n_fields = 0;
    for (int i = 0;
         i < HEAD_MAX_EMPTY && end - at >= 1 && (*at == '\n' || (*at == '\r' && end - at >= 2 && at[1] == '\n')); i++)
        head.begin = at += *at == '\r' ? 2 : 1;
    bool has_line = next_line(&at, end, &line);
    const char *after_line = has_line ? at : NULL;
    if ((has_line ? line.n : (size_t)(end - head.begin)) > HEAD_MAX_LINE)
        return refuse_size(&head, after_line, end);
    if (!has_line)
        return n >= HEAD_MAX_BYTES ? refuse_size(&head, NULL, end) : HEAD_INCOMPLETE;
    if (!read_request_line(&head, line))
        return HEAD_REFUSED;
    for (;;) {
        bool is_whole = next_line(&at, end, &line);
        if ((size_t)(at - bytes) > HEAD_MAX_BYTES || (!is_whole && n >= HEAD_MAX_BYTES))
            return refuse_size(&head, after_line, end);
        if (!is_whole)
            return HEAD_INCOMPLETE;
        if (line.n == 0)
            break;
        if (++n_fields > HEAD_MAX_FIELDS)
            return refuse_size(&head, after_line, end);
        if (!read_field(&head, n_fields, line))
            return HEAD_REFUSED;
    }
    if (!check_length(&head) || !check_host(&head, rules->hosts) || !check_parameters(&head) || !check_secrets(&head) ||
        !check_identity(&head))
        return HEAD_REFUSED;
    request->n_bytes = (size_t)(at - bytes);
    request->is_chunked = head.fields.n_codings > 0;
    request->length = number_of(head.fields.length);
    request->forwarded = head.fields.forwarded;
    request->cookie = head.fields.cookie;
    request->authorization = head.fields.authorization;
    memcpy(request->identity, head.fields.identity, sizeof request->identity);
    bool is_get = head.method.n == 3 && memcmp(head.method.at, "GET", 3) == 0;
    if (!is_get || !is_room_address(head.target, &room) || !has_word(head.fields.upgrade, "websocket"))
        return HEAD_HTTP;
    if (!check_handshake(&head, request->n_bytes))
        return HEAD_REFUSED;
    fill_handshake(&request->handshake, &head, room, request->n_bytes);
    return HEAD_WEBSOCKET;
}

void head_refuse_incomplete(const char *bytes, size_t n, bool has_ended, int waited_ms, struct problem *problem)
{
    bool has_line = n > 0 && memchr(bytes, '\n', n);
    const char *missing = has_line ? "the empty line after the headers" : "a request line";
    if (has_ended)
        (void)problem_set(problem, PROBLEM_REQUEST, "", "",
                          "the sender ended after %zu bytes of the request's head; expected is %s", n, missing);
    else
        (void)problem_set(problem, PROBLEM_TOO_SLOW, "", "",
                          "%zu bytes of the request's head came in %g s; expected is %s by then", n, waited_ms / 1000.0,
                          missing);
}

/* Reads PEM files into OpenSSL's certificate and key. A pair is tried on a context of its own before it is used, so
 * that a bad one never takes the place of a good one. */
#include "server/tls/certificate.h"

#include <errno.h>
#include <fcntl.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "core/base/log.h"
#include "core/base/mem.h"
#include "server/tls/policy.h"

struct certificate {
    X509 *leaf;
    STACK_OF(X509) * chain; /* the others of the file */
    EVP_PKEY *key;
};

struct pem {
    char *bytes;
    int n_bytes;
    bool is_open_to_all; /* every user of the machine may read it */
};

static const char *last_reason(void)
{
    const char *reason = ERR_reason_error_string(ERR_peek_last_error());
    return reason ? reason : "unknown reason";
}

/* Reads up to a limit; a file that is being replaced is read as the descriptor has it. */
static bool read_all(int fd, struct pem *pem)
{
    pem->bytes = malloc(CERTIFICATE_MAX_BYTES + 1);
    if (!pem->bytes) {
        errno = ENOMEM;
        return false;
    }
    for (ssize_t n = 1; n > 0 && pem->n_bytes <= CERTIFICATE_MAX_BYTES;) {
        n = read(fd, pem->bytes + pem->n_bytes, (size_t)(CERTIFICATE_MAX_BYTES + 1 - pem->n_bytes));
        if (n < 0 && errno != EINTR)
            return false;
        pem->n_bytes += n > 0 ? (int)n : 0;
        if (n < 0)
            n = 1;
    }
    return true;
}

static bool read_file(const char *flag, const char *file, struct pem *pem, struct error *err)
{
    struct stat facts;
    int fd = open(file, O_RDONLY | O_CLOEXEC | O_NONBLOCK); /* a pipe must not hold the start up */
    bool is_read = fd >= 0 && fstat(fd, &facts) == 0;
    if (is_read && !S_ISREG(facts.st_mode)) {
        (void)close(fd);
        return error_set(err, ERROR_IO, "%s %.140s: expected a file", flag, file);
    }
    is_read = is_read && read_all(fd, pem);
    if (!is_read)
        (void)error_set(err, ERROR_IO, "%s %.140s: %s", flag, file, strerror(errno));
    if (fd >= 0)
        (void)close(fd);
    if (!is_read)
        return false;
    pem->is_open_to_all = (facts.st_mode & S_IROTH) != 0;
    return pem->n_bytes <= CERTIFICATE_MAX_BYTES ||
           error_set(err, ERROR_LIMIT, "%s %.140s: more than %d bytes; expected a file of PEM", flag, file,
                     CERTIFICATE_MAX_BYTES);
}

static void wipe(struct pem *pem)
{
    if (pem->bytes)
        OPENSSL_cleanse(pem->bytes, (size_t)pem->n_bytes);
    free(pem->bytes);
}

/* ---- the two files ---------------------------------------------------------------------------------------------- */

/* Reads what follows the first certificate. */
static bool read_chain(struct certificate *certificate, BIO *bio, const char *file, struct error *err)
{
    X509 *next;
    certificate->chain = sk_X509_new_null();
    if (!certificate->chain)
        return error_set(err, ERROR_MEMORY, "--tls-cert %.140s: no memory", file);
    while ((next = PEM_read_bio_X509(bio, NULL, NULL, NULL))) {
        if (sk_X509_num(certificate->chain) >= CERTIFICATE_MAX_CHAIN || !sk_X509_push(certificate->chain, next)) {
            X509_free(next);
            return error_set(err, ERROR_LIMIT, "--tls-cert %.140s: more than %d certificates after the first", file,
                             CERTIFICATE_MAX_CHAIN);
        }
    }
    bool is_at_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
    bool ok = is_at_end || error_set(err, ERROR_FORMAT, "--tls-cert %.120s: certificate %d of it cannot be read: %.60s",
                                     file, sk_X509_num(certificate->chain) + 2, last_reason());
    ERR_clear_error();
    return ok;
}

static bool read_certificates(struct certificate *certificate, const char *file, struct error *err)
{
    struct pem pem = { 0 };
    BIO *bio = NULL;
    bool ok = read_file("--tls-cert", file, &pem, err);
    if (ok) {
        bio = BIO_new_mem_buf(pem.bytes, pem.n_bytes);
        certificate->leaf = bio ? PEM_read_bio_X509(bio, NULL, NULL, NULL) : NULL;
        ok = certificate->leaf ||
             error_set(
                 err, ERROR_FORMAT,
                 "--tls-cert %.100s: no certificate can be read (%.40s); expected PEM, \"-----BEGIN CERTIFICATE-----\"",
                 file, last_reason());
        ok = ok && read_chain(certificate, bio, file, err);
    }
    BIO_free(bio);
    wipe(&pem);
    return ok;
}

/* Called by OpenSSL for the passphrase of an encrypted key: there is none, and nobody to ask. */
static int no_passphrase(char *text, int size, int is_writing, void *was_asked)
{
    (void)text;
    (void)size;
    (void)is_writing;
    *(bool *)was_asked = true;
    return -1;
}

static bool read_key(struct certificate *certificate, const char *file, struct error *err)
{
    struct pem pem = { 0 };
    bool is_encrypted = false, ok = read_file("--tls-key", file, &pem, err);
    if (ok) {
        BIO *bio = BIO_new_mem_buf(pem.bytes, pem.n_bytes);
        certificate->key = bio ? PEM_read_bio_PrivateKey(bio, NULL, no_passphrase, &is_encrypted) : NULL;
        BIO_free(bio);
        if (is_encrypted)
            ok = error_set(err, ERROR_FORMAT,
                           "--tls-key %.100s: the key is encrypted; expected one without a passphrase", file);
        else if (!certificate->key)
            ok = error_set(
                err, ERROR_FORMAT,
                "--tls-key %.100s: no private key can be read (%.40s); expected PEM, \"-----BEGIN PRIVATE KEY-----\"",
                file, last_reason());
    }
    if (ok && pem.is_open_to_all)
        log_warn("TLS: every user of this machine may read the private key %.140s", file);
    wipe(&pem);
    return ok;
}

/* ---- the pair --------------------------------------------------------------------------------------------------- */

static bool try_pair(const struct certificate *certificate, const char *cert_file, const char *key_file,
                     struct error *err)
{
    if (X509_check_private_key(certificate->leaf, certificate->key) != 1)
        return error_set(err, ERROR_FORMAT,
                         "--tls-key %.80s is not the key of the certificate in --tls-cert %.80s; expected a pair",
                         key_file, cert_file);
    SSL_CTX *trial = SSL_CTX_new(TLS_server_method());
    bool ok = trial && policy_set(trial) &&
              SSL_CTX_use_cert_and_key(trial, certificate->leaf, certificate->key, certificate->chain, 1) == 1;
    if (!ok)
        (void)error_set(err, ERROR_FORMAT, "--tls-cert %.120s cannot be used: %.60s", cert_file, last_reason());
    SSL_CTX_free(trial);
    return ok;
}

struct certificate *certificate_read(const char *cert_file, const char *key_file, struct error *err)
{
    struct certificate *certificate = mem_new(sizeof *certificate);
    ERR_clear_error();
    const bool ok = read_certificates(certificate, cert_file, err) && read_key(certificate, key_file, err) &&
                    try_pair(certificate, cert_file, key_file, err);
    ERR_clear_error();
    if (ok)
        return certificate;
    certificate_destroy(certificate);
    return NULL;
}

void certificate_destroy(struct certificate *certificate)
{
    if (!certificate)
        return;
    X509_free(certificate->leaf);
    sk_X509_pop_free(certificate->chain, X509_free);
    EVP_PKEY_free(certificate->key);
    free(certificate);
}

bool certificate_use(const struct certificate *certificate, SSL *ssl)
{
    SSL_certs_clear(ssl); /* else one of another kind of key stays beside it */
    return SSL_use_cert_and_key(ssl, certificate->leaf, certificate->key, certificate->chain, 1) == 1;
}

/* Its first name of DNS, else its common name. */
static void write_name(X509 *leaf, char *name, size_t size)
{
    GENERAL_NAMES *names = X509_get_ext_d2i(leaf, NID_subject_alt_name, NULL, NULL);
    name[0] = 0;
    for (int i = 0; i < sk_GENERAL_NAME_num(names) && !name[0]; i++) {
        const GENERAL_NAME *one = sk_GENERAL_NAME_value(names, i);
        if (one->type == GEN_DNS)
            (void)snprintf(name, size, "%.*s", ASN1_STRING_length(one->d.dNSName),
                           (const char *)ASN1_STRING_get0_data(one->d.dNSName));
    }
    GENERAL_NAMES_free(names);
    if (!name[0] && X509_NAME_get_text_by_NID(X509_get_subject_name(leaf), NID_commonName, name, (int)size) < 0)
        (void)snprintf(name, size, "without a name");
    for (char *at = name; *at; at++) /* it goes to the log */
        if (*at < ' ' || *at > '~')
            *at = '?';
}

void certificate_describe(const struct certificate *certificate, char text[CERTIFICATE_TEXT])
{
    struct tm last = { 0 };
    char name[100];
    write_name(certificate->leaf, name, sizeof name);
    (void)ASN1_TIME_to_tm(X509_get0_notAfter(certificate->leaf), &last);
    (void)snprintf(text, CERTIFICATE_TEXT, "%s, valid until %04d-%02d-%02d", name, (last.tm_year + 1900) % 10000,
                   (last.tm_mon + 1) % 100, last.tm_mday % 100);
}

bool certificate_is_out_of_date(const struct certificate *certificate)
{
    return X509_cmp_current_time(X509_get0_notBefore(certificate->leaf)) > 0 ||
           X509_cmp_current_time(X509_get0_notAfter(certificate->leaf)) < 0;
}

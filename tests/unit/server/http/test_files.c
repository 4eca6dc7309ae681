/* The page's files: the content coding chosen for a request (RFC 9110 12.5.3), and how compressed copies are read. */
#include "server/http/coding.h"
#include "server/http/files.h"
#include "tests/check.h"
#include "tests/unit/data_folder.h"

static void the_preferred_coding_that_exists_is_chosen(void **state)
{
    (void)state;
    static const struct {
        const char *accept;
        enum content_coding both, gzip_only; /* with br and gzip there, and with gzip alone */
    } cases[] = { { NULL, CODING_IDENTITY, CODING_IDENTITY },
                  { "", CODING_IDENTITY, CODING_IDENTITY },
                  { "identity", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip", CODING_GZIP, CODING_GZIP },
                  { "x-gzip", CODING_GZIP, CODING_GZIP },
                  { "br", CODING_BR, CODING_IDENTITY },
                  { "gzip,br", CODING_BR, CODING_GZIP },
                  { "BR , GZIP", CODING_BR, CODING_GZIP },
                  { "gzip;q=0", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=0.0, br", CODING_BR, CODING_IDENTITY },
                  { "gzip;q=0.000", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=1.000, br;q=0.999", CODING_GZIP, CODING_GZIP },
                  { "gzip ; q=0.5 , br\t;\tQ=0.25", CODING_GZIP, CODING_GZIP },
                  { "*", CODING_BR, CODING_GZIP },
                  { "*;q=0", CODING_IDENTITY, CODING_IDENTITY },
                  { "*;q=0, gzip", CODING_GZIP, CODING_GZIP },
                  { "br;q=0, *", CODING_GZIP, CODING_GZIP },
                  { "identity;q=0", CODING_IDENTITY, CODING_IDENTITY }, /* nothing is acceptable: sent all the same */
                  { "identity;q=0, *", CODING_BR, CODING_GZIP },
                  { "identity, gzip;q=0.5", CODING_IDENTITY, CODING_IDENTITY },
                  { "identity;q=0.5, gzip;q=0.5", CODING_GZIP, CODING_GZIP },
                  { "deflate, compress, zstd", CODING_IDENTITY, CODING_IDENTITY },
                  { ",, gzip ,", CODING_GZIP, CODING_GZIP },
                  /* what breaks the grammar does not count */
                  { "gzip;q=2", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=1.5", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=-1", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=0.1234", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;level=9", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip br", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzip;q=x, br", CODING_BR, CODING_IDENTITY },
                  { ";q=1", CODING_IDENTITY, CODING_IDENTITY },
                  { "gzipped", CODING_IDENTITY, CODING_IDENTITY } };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        enum content_coding both = coding_choose(cases[i].accept, (bool[N_CODINGS]){ true, true, true });
        enum content_coding gzip = coding_choose(cases[i].accept, (bool[N_CODINGS]){ true, true, false });
        if (both != cases[i].both || gzip != cases[i].gzip_only)
            fail_msg("\"%s\": %d and %d", cases[i].accept ? cases[i].accept : "(none)", (int)both, (int)gzip);
    }
}

static void a_compressed_copy_is_a_form_of_its_file_and_has_no_path(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    folder_make(folder);
    folder_put_text(folder, "index.html", "the page");
    folder_put_text(folder, "index.html.gz", "packed");
    folder_put_text(folder, "index.html.br", "smaller");
    folder_put_text(folder, "page/main-0.js", "1");
    folder_put_text(folder, "lone.js.gz", "a copy of nothing");
    struct files *files = files_create(folder, &err);
    assert_string_equal(err.text, "");
    const struct file *page = files_find(files, "/");
    assert_true(page->has_forms && !page->is_immutable);
    assert_int_equal(page->forms[CODING_IDENTITY].n_bytes, 8);
    assert_memory_equal(page->forms[CODING_GZIP].bytes, "packed", 6);
    assert_memory_equal(page->forms[CODING_BR].bytes, "smaller", 7);
    assert_string_not_equal(page->forms[CODING_GZIP].etag, page->forms[CODING_BR].etag);
    assert_int_equal(file_coding(page, "gzip, br"), CODING_BR);
    assert_ptr_equal(files_find(files, "/rooms/kave-rimo"), page);
    assert_ptr_equal(files_find(files, "/signin"), page);
    assert_ptr_equal(files_find(files, "/signin/first"), page);
    assert_null(files_find(files, "/signin/proxy"));
    assert_null(files_find(files, "/rooms/"));
    assert_null(files_find(files, "/rooms/kave-rimo/ws"));
    assert_null(files_find(files, "/rooms/../index.html"));
    const struct file *code = files_find(files, "/page/main-0.js");
    assert_true(code->is_immutable && !code->has_forms);
    assert_int_equal(file_coding(code, "gzip, br"), CODING_IDENTITY);
    assert_null(files_find(files, "/index.html.gz"));
    assert_null(files_find(files, "/index.html.br"));
    assert_null(files_find(files, "/lone.js"));
    assert_null(files_find(files, "/lone.js.gz"));
    files_destroy(files);
    folder_remove(folder);
}

static void a_copy_that_is_no_file_is_refused(void **state)
{
    (void)state;
    char folder[256];
    struct error err = { 0 };
    folder_make(folder);
    folder_put_text(folder, "index.html", "the page");
    folder_put_text(folder, "index.html.gz/inner", "a folder of that name");
    assert_null(files_create(folder, &err));
    assert_int_equal(err.code, ERROR_LIMIT);
    folder_remove(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_preferred_coding_that_exists_is_chosen),
        cmocka_unit_test(a_compressed_copy_is_a_form_of_its_file_and_has_no_path),
        cmocka_unit_test(a_copy_that_is_no_file_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

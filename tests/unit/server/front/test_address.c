/* Addresses, and the client that a connection counts for. */
#include "server/front/address.h"
#include "tests/check.h"

static struct address address(const char *text)
{
    struct address found = { { 0 } };
    assert_true(address_read(text, strlen(text), &found));
    return found;
}

static void an_address_is_read_with_or_without_a_port(void **state)
{
    (void)state;
    static const char *const same[][2] = { { "192.0.2.1", "192.0.2.1:65535" },
                                           { "192.0.2.1", "::ffff:192.0.2.1" },
                                           { "192.0.2.1", "::ffff:c000:201" },
                                           { "2001:db8::1", "[2001:DB8:0::1]:80" },
                                           { "2001:db8::1", "[2001:db8::1]" } };
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        struct address a = address(same[i][0]), b = address(same[i][1]);
        assert_true(address_is_equal(&a, &b));
    }
    static const char *const wrong[] = { "",
                                         "unknown",
                                         "_hidden",
                                         "192.0.2",
                                         "192.0.2.256",
                                         "192.0.2.1:",
                                         "192.0.2.1:http",
                                         "192.0.2.1:123456",
                                         "[2001:db8::1",
                                         "[192.0.2.1]:80",
                                         "[2001:db8::1]80",
                                         "2001:db8::1::",
                                         " 192.0.2.1",
                                         "192.0.2.1 ",
                                         "1" };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct address found;
        assert_false(address_read(wrong[i], strlen(wrong[i]), &found));
    }
    static const char nul[] = "192.0.2.1\0x";
    struct address found;
    assert_false(address_read(nul, sizeof nul - 1, &found));
}

static void a_range_holds_the_addresses_with_its_first_bits(void **state)
{
    (void)state;
    static const struct {
        const char *range, *inside, *outside;
    } list[] = { { "192.0.2.1", "192.0.2.1", "192.0.2.2" },
                 { "192.0.2.0/24", "192.0.2.255", "192.0.3.0" },
                 { "10.0.0.0/9", "10.127.255.255", "10.128.0.0" },
                 { "0.0.0.0/0", "203.0.113.9", "2001:db8::1" },
                 { "2001:db8::/32", "2001:db8:ffff::1", "2001:db9::" },
                 { "::1", "::1", "::2" },
                 { "::/0", "192.0.2.1", NULL },
                 { "2001:db8::8/125", "2001:db8::f", "2001:db8::10" } };
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        struct address_range range;
        struct error err = { 0 };
        assert_true(address_range_read(list[i].range, &range, &err));
        struct address inside = address(list[i].inside);
        assert_true(address_is_in(&inside, &range, 1));
        if (!list[i].outside)
            continue;
        struct address outside = address(list[i].outside);
        assert_false(address_is_in(&outside, &range, 1));
    }
    static const char *const wrong[] = { "",           "proxy",        "192.0.2.0/33",  "2001:db8::/129",
                                         "192.0.2.0/", "192.0.2.0/-1", "192.0.2.0/24x", "192.0.2.1:80",
                                         "/24" };
    for (size_t i = 0; i < sizeof wrong / sizeof wrong[0]; i++) {
        struct address_range range;
        struct error err = { 0 };
        assert_false(address_range_read(wrong[i], &range, &err));
        assert_non_null(strstr(err.text, wrong[i]));
    }
}

static void the_client_is_the_newest_address_that_is_no_trusted_proxy(void **state)
{
    (void)state;
    struct address_range trusted[2];
    struct error err = { 0 };
    assert_true(address_range_read("127.0.0.1", &trusted[0], &err) &&
                address_range_read("10.0.0.0/8", &trusted[1], &err));
    static const struct {
        const char *peer, *forwarded, *client;
    } list[] = {
        { "127.0.0.1", "198.51.100.7", "198.51.100.7" },
        { "127.0.0.1", "203.0.113.1, 198.51.100.7", "198.51.100.7" }, /* the client said the first of itself */
        { "127.0.0.1", "198.51.100.7,\t10.1.2.3 , 10.4.5.6", "198.51.100.7" },
        { "127.0.0.1", "10.9.9.9, 10.1.2.3", "10.9.9.9" }, /* a client in the proxies' own network */
        { "127.0.0.1", "", "127.0.0.1" },
        { "127.0.0.1", "unknown", "127.0.0.1" },
        { "127.0.0.1", "198.51.100.7, unknown, 10.1.2.3", "10.1.2.3" }, /* what stands before it is not believed */
        { "127.0.0.1", "198.51.100.7,", "127.0.0.1" },
        { "127.0.0.1", "[2001:db8::5]:443", "2001:db8::5" },
        { "192.0.2.9", "198.51.100.7", "192.0.2.9" }, /* no proxy of ours */
    };
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        struct address peer = address(list[i].peer), expected = address(list[i].client);
        struct address client = address_of_client(&peer, trusted, 2, list[i].forwarded, strlen(list[i].forwarded));
        assert_true(address_is_equal(&client, &expected));
    }
}

static void an_ipv6_client_is_counted_by_its_network_of_64_bits(void **state)
{
    (void)state;
    static const struct {
        const char *a, *b;
        bool are_one;
    } list[] = { { "2001:db8::1", "2001:db8::ffff:1:2:3", true },
                 { "2001:db8::1", "2001:db8:0:1::1", false },
                 { "192.0.2.1", "192.0.2.2", false },
                 { "192.0.2.1", "::ffff:192.0.2.1", true } };
    for (size_t i = 0; i < sizeof list / sizeof list[0]; i++) {
        struct address a = address(list[i].a), b = address(list[i].b);
        a = address_counted(&a);
        b = address_counted(&b);
        assert_int_equal(address_is_equal(&a, &b), list[i].are_one);
    }
}

static void loopback_is_told_from_all_other_addresses(void **state)
{
    (void)state;
    static const struct {
        const char *text;
        bool is_loopback;
    } rows[] = { { "127.0.0.1:8080", true }, { "127.255.3.4", true }, { "[::1]:0", true },     { "::1", true },
                 { "0.0.0.0:8080", false },  { "128.0.0.1", false },  { "10.127.0.1", false }, { "::", false },
                 { "::2", false },           { "fe80::1", false },    { "1::1", false } };
    for (size_t i = 0; i < sizeof rows / sizeof rows[0]; i++) {
        struct address address;
        assert_true(address_read(rows[i].text, strlen(rows[i].text), &address));
        assert_int_equal(address_is_loopback(&address), rows[i].is_loopback);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(loopback_is_told_from_all_other_addresses),
        cmocka_unit_test(an_address_is_read_with_or_without_a_port),
        cmocka_unit_test(a_range_holds_the_addresses_with_its_first_bits),
        cmocka_unit_test(the_client_is_the_newest_address_that_is_no_trusted_proxy),
        cmocka_unit_test(an_ipv6_client_is_counted_by_its_network_of_64_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

// Whose address counts: the connection's, or what a trusted proxy says of it.

#include "server/http/client.h"
#include "tests/unit/helper_cmocka.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <string.h>
#include <sys/un.h>

static http_client find_of(const char *peer, const char *forwarded, bool is_forwarded_otherwise,
                           const char *list)
{
    struct sockaddr_in v4 = { .sin_family = AF_INET };
    struct sockaddr_in6 v6 = { .sin6_family = AF_INET6 };
    http_proxies proxies;

    assert_int_equal(http_client_read_proxies(list, &proxies, NULL), BF_OK);
    if (inet_pton(AF_INET, peer, &v4.sin_addr) == 1)
        return http_client_find((struct sockaddr *)&v4, forwarded, is_forwarded_otherwise,
                                &proxies);
    assert_int_equal(inet_pton(AF_INET6, peer, &v6.sin6_addr), 1);
    return http_client_find((struct sockaddr *)&v6, forwarded, is_forwarded_otherwise, &proxies);
}

static bool count_as(const char *peer, const char *list, uint8_t *ret_key)
{
    struct sockaddr_in v4 = { .sin_family = AF_INET };
    struct sockaddr_in6 v6 = { .sin6_family = AF_INET6 };
    http_proxies proxies;

    assert_int_equal(http_client_read_proxies(list, &proxies, NULL), BF_OK);
    if (inet_pton(AF_INET, peer, &v4.sin_addr) == 1)
        return http_client_of_connection((struct sockaddr *)&v4, &proxies, ret_key);
    assert_int_equal(inet_pton(AF_INET6, peer, &v6.sin6_addr), 1);
    return http_client_of_connection((struct sockaddr *)&v6, &proxies, ret_key);
}

static http_client find(const char *peer, const char *forwarded, const char *list)
{
    return find_of(peer, forwarded, false, list);
}

static void the_client_is_found(void **state)
{
    static const struct {
        const char *peer, *forwarded, *proxies, *client;
    } cases[] = {
        { "203.0.113.7", NULL, "", "203.0.113.7" },
        { "203.0.113.7", "198.51.100.1", "", "203.0.113.7" },
        { "203.0.113.7", "198.51.100.1", "10.0.0.1", "203.0.113.7" },
        { "10.0.0.1", "198.51.100.1", "10.0.0.1", "198.51.100.1" },
        { "10.1.2.3", "198.51.100.1", "10.0.0.0/8", "198.51.100.1" },
        { "11.1.2.3", "198.51.100.1", "10.0.0.0/8", "11.1.2.3" },
        // Addresses left of the first one that is no trusted proxy may be forged.
        { "10.0.0.1", "127.0.0.1, 198.51.100.1", "10.0.0.1", "198.51.100.1" },
        { "10.0.0.1", ",198.51.100.1, 10.0.0.2", "10.0.0.0/30", "198.51.100.1" },
        { "10.0.0.1", "10.0.0.3", "10.0.0.0/8", "10.0.0.3" },
        { "10.0.0.1", "198.51.100.1:4711", "10.0.0.1", "198.51.100.1" },
        { "10.0.0.1", "[2001:db8::1]:4711", "10.0.0.1", "2001:db8::" },
        { "10.0.0.1", "unknown", "10.0.0.1", "10.0.0.1" },
        { "10.0.0.1", "198.51.100.1, unknown", "10.0.0.1", "10.0.0.1" },
        { "10.0.0.1", " , ", "10.0.0.1", "10.0.0.1" },
        // One host has all the addresses of its network.
        { "2001:db8:1:2:3:4:5:6", NULL, "", "2001:db8:1:2::" },
        { "::ffff:203.0.113.7", NULL, "", "203.0.113.7" },
        { "fd00::1", "198.51.100.1", "fd00::/8, 10.0.0.1", "198.51.100.1" },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        http_client client = find(cases[i].peer, cases[i].forwarded, cases[i].proxies);
        assert_string_equal(client.text, cases[i].client);
        assert_false(client.is_local);
    }
    assert_memory_equal(find("2001:db8:1:2::5", NULL, "").key,
                        find("2001:db8:1:2::6", NULL, "").key, HTTP_CLIENT_KEY_SIZE);
    assert_memory_not_equal(find("203.0.113.7", NULL, "").key, find("203.0.113.8", NULL, "").key,
                            HTTP_CLIENT_KEY_SIZE);
}

static void who_is_on_this_machine_is_local(void **state)
{
    const struct sockaddr_un address = { .sun_family = AF_UNIX };
    const http_proxies none = { .n = 0 };

    assert_true(find("127.0.0.1", NULL, "").is_local);
    assert_true(find("127.8.9.1", NULL, "").is_local);
    assert_true(find("::1", NULL, "").is_local);
    assert_true(find("::ffff:127.0.0.1", NULL, "").is_local);
    assert_true(http_client_find((const struct sockaddr *)&address, NULL, false, &none).is_local);
    // A proxy on this machine asks for others.
    assert_false(find("127.0.0.1", "198.51.100.1", "127.0.0.1").is_local);
    assert_false(find("::2", NULL, "").is_local);
}

// Who forwards requests asks for others, and if it is not known for whom, they count as one client.
static void a_proxy_on_this_machine_that_is_not_trusted_is_one_client(void **state)
{
    static const struct {
        const char *peer, *forwarded, *proxies;
        bool is_forwarded_otherwise;
    } cases[] = {
        { "127.0.0.1", "198.51.100.1", "", false },
        { "127.0.0.1", "127.0.0.1", "", false },
        { "127.0.0.1", "", "", false },
        { "127.0.0.1", NULL, "", true },
        { "127.0.0.1", "198.51.100.1", "10.0.0.1", false },
        // It is trusted, but does not say for whom it asks.
        { "127.0.0.1", "unknown", "127.0.0.1", false },
        { "127.0.0.1", NULL, "127.0.0.1", true },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        http_client client = find_of(cases[i].peer, cases[i].forwarded,
                                     cases[i].is_forwarded_otherwise, cases[i].proxies);
        assert_string_equal(client.text, "127.0.0.1");
        assert_false(client.is_local);
        assert_true(client.is_unknown_proxy);
    }
    assert_false(find("::1", "198.51.100.1", "").is_local);
    // A trusted one that asks for this machine does so for itself.
    assert_true(find("127.0.0.1", "127.0.0.1", "127.0.0.1").is_local);
    assert_false(find("127.0.0.1", "198.51.100.1", "127.0.0.1").is_unknown_proxy);
    assert_false(find("203.0.113.7", "198.51.100.1", "").is_unknown_proxy);
}

static void settings_are_addresses_and_networks(void **state)
{
    static const char *const bad[] = { "localhost",         "10.0.0.0/33", "10.0.0.0/", "::1/129",
                                       "10.0.0.1;10.0.0.2", "10.0.0.0/-1", "1.2.3" };
    char many[HTTP_PROXIES_MAX * 9 + 10] = "";
    http_proxies proxies = { .n = 77 };
    bf_error err = { 0 };

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        assert_int_equal(http_client_read_proxies(bad[i], &proxies, &err), BF_EINPUT);
    for (int i = 0; i <= HTTP_PROXIES_MAX; i++)
        strcat(many, "10.0.0.1 ");
    assert_int_equal(http_client_read_proxies(many, &proxies, &err), BF_ELIMIT);
    assert_int_equal(proxies.n, 77);
    assert_int_equal(http_client_read_proxies("0.0.0.0/0 ::/0", &proxies, &err), BF_OK);
    assert_int_equal(proxies.n, 2);
}

static void connections_are_counted_by_client(void **state)
{
    static const struct {
        const char *peer, *proxies;
        bool is_counted;
        const char *same; // counts as the same client
    } cases[] = {
        { "203.0.113.7", "10.0.0.1", true, "203.0.113.7" },
        { "2001:db8:1:2:3:4:5:6", "", true, "2001:db8:1:2::1" },
        { "10.0.0.1", "10.0.0.0/8", false, NULL },
        { "127.0.0.1", "", false, NULL },
        { "::1", "", false, NULL },
        { "::ffff:127.0.0.1", "", false, NULL },
    };

    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint8_t key[HTTP_CLIENT_KEY_SIZE], same[HTTP_CLIENT_KEY_SIZE];
        assert_int_equal(count_as(cases[i].peer, cases[i].proxies, key), cases[i].is_counted);
        if (cases[i].same == NULL)
            continue;
        assert_true(count_as(cases[i].same, cases[i].proxies, same));
        assert_memory_equal(key, same, sizeof key);
        assert_true(count_as("203.0.113.8", cases[i].proxies, same));
        assert_memory_not_equal(key, same, sizeof key);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(connections_are_counted_by_client),
        cmocka_unit_test(the_client_is_found),
        cmocka_unit_test(who_is_on_this_machine_is_local),
        cmocka_unit_test(a_proxy_on_this_machine_that_is_not_trusted_is_one_client),
        cmocka_unit_test(settings_are_addresses_and_networks),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}

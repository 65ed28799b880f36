#include "server/http/client.h"
#include "api/json/number.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <string.h>

enum { KEY_BITS = 8 * HTTP_CLIENT_KEY_SIZE, MAPPED_BITS = 96, NETWORK_SIZE = 8 };

static const uint8_t mapped[12] = { 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff };
static const char separators[] = ", \t";

static void map_ipv4(const void *address, uint8_t *ret_key)
{
    memcpy(ret_key, mapped, sizeof mapped);
    memcpy(ret_key + sizeof mapped, address, 4);
}

static bool read_address(const char *text, uint8_t *ret_key)
{
    struct in_addr v4;

    if (inet_pton(AF_INET, text, &v4) == 1) {
        map_ipv4(&v4, ret_key);
        return true;
    }
    return inet_pton(AF_INET6, text, ret_key) == 1;
}

// Reads "address" or "address/bits" of n bytes.
static bool read_network(const char *text, size_t n, uint8_t *ret_key, unsigned *ret_bits)
{
    char copy[INET6_ADDRSTRLEN + 4];
    unsigned offset;
    uint64_t bits = 0;

    if (n >= sizeof copy)
        return false;
    memcpy(copy, text, n);
    copy[n] = '\0';
    char *slash = strchr(copy, '/');
    if (slash != NULL)
        *slash++ = '\0';
    if (!read_address(copy, ret_key))
        return false;
    offset = strchr(copy, ':') == NULL ? MAPPED_BITS : 0;
    *ret_bits = KEY_BITS;
    if (slash == NULL)
        return true;
    if (!number_read_digits(slash, 0, KEY_BITS - offset, &bits))
        return false;
    *ret_bits = offset + (unsigned)bits;
    return true;
}

bf_status http_client_read_proxies(const char *list, http_proxies *ret_proxies, bf_error *err)
{
    http_proxies found = { .n = 0 };

    for (const char *p = list + strspn(list, separators); *p != '\0';) {
        size_t n = strcspn(p, separators);
        if (found.n == HTTP_PROXIES_MAX)
            return bf_fail(err, BF_ELIMIT, "", "more than %d proxies", HTTP_PROXIES_MAX);
        if (!read_network(p, n, found.keys[found.n], &found.bits[found.n]))
            return bf_fail(err, BF_EINPUT, "",
                           "'%.*s' is no address or network of a proxy, such as 10.0.0.0/8 or ::1",
                           (int)(n < 60 ? n : 60), p);
        found.n++;
        p += n;
        p += strspn(p, separators);
    }
    *ret_proxies = found;
    return BF_OK;
}

static bool have_same_prefix(const uint8_t *a, const uint8_t *b, unsigned bits)
{
    unsigned whole = bits / 8, rest = bits % 8;

    if (memcmp(a, b, whole) != 0)
        return false;
    return rest == 0 || (a[whole] ^ b[whole]) >> (8 - rest) == 0;
}

static bool is_proxy(const http_proxies *proxies, const uint8_t *key)
{
    for (size_t i = 0; i < proxies->n; i++) {
        if (have_same_prefix(key, proxies->keys[i], proxies->bits[i]))
            return true;
    }
    return false;
}

// Takes the last address off a list of *n bytes; some proxies add ports and brackets. False: it is
// none.
static bool take_last(const char *list, size_t *n, uint8_t *ret_key)
{
    char copy[INET6_ADDRSTRLEN + 8];
    size_t end = *n;

    while (end > 0 && strchr(separators, list[end - 1]) != NULL)
        end--;
    size_t begin = end;
    while (begin > 0 && strchr(separators, list[begin - 1]) == NULL)
        begin--;
    *n = begin;
    if (end == begin || end - begin >= sizeof copy)
        return false;
    memcpy(copy, list + begin, end - begin);
    copy[end - begin] = '\0';
    char *colon = strchr(copy, ':');
    if (copy[0] == '[') {
        copy[strcspn(copy, "]")] = '\0';
        return read_address(copy + 1, ret_key);
    }
    if (colon != NULL && strchr(colon + 1, ':') == NULL)
        *colon = '\0';
    return read_address(copy, ret_key);
}

static http_client describe(const uint8_t *key)
{
    static const uint8_t loopback6[HTTP_CLIENT_KEY_SIZE] = { [15] = 1 };
    bool is_v4 = memcmp(key, mapped, sizeof mapped) == 0;
    http_client client = { .text = "" };

    client.is_local = is_v4 ? key[12] == 127 : memcmp(key, loopback6, sizeof loopback6) == 0;
    memcpy(client.key, key, is_v4 ? HTTP_CLIENT_KEY_SIZE : NETWORK_SIZE);
    const void *address = is_v4 ? client.key + sizeof mapped : client.key;
    (void)inet_ntop(is_v4 ? AF_INET : AF_INET6, address, client.text, sizeof client.text);
    return client;
}

// False: of another family than IPv4 and IPv6.
static bool read_peer(const struct sockaddr *peer, uint8_t *ret_key)
{
    if (peer->sa_family == AF_INET)
        map_ipv4(&((const struct sockaddr_in *)(const void *)peer)->sin_addr, ret_key);
    else if (peer->sa_family == AF_INET6)
        memcpy(ret_key, &((const struct sockaddr_in6 *)(const void *)peer)->sin6_addr,
               HTTP_CLIENT_KEY_SIZE);
    return peer->sa_family == AF_INET || peer->sa_family == AF_INET6;
}

bool http_client_of_connection(const struct sockaddr *peer, const http_proxies *proxies,
                               uint8_t *ret_key)
{
    uint8_t key[HTTP_CLIENT_KEY_SIZE];

    if (!read_peer(peer, key) || is_proxy(proxies, key))
        return false;
    const http_client client = describe(key);
    memcpy(ret_key, client.key, sizeof client.key);
    return !client.is_local;
}

http_client http_client_find(const struct sockaddr *peer, const char *forwarded,
                             bool is_forwarded_otherwise, const http_proxies *proxies)
{
    size_t n = forwarded == NULL ? 0 : strlen(forwarded);
    uint8_t key[HTTP_CLIENT_KEY_SIZE], before[HTTP_CLIENT_KEY_SIZE];
    bool is_for_another = forwarded != NULL || is_forwarded_otherwise;

    if (!read_peer(peer, key))
        return (http_client){ .text = "local", .is_local = true };
    while (n > 0 && is_proxy(proxies, key) && take_last(forwarded, &n, before)) {
        memcpy(key, before, sizeof key);
        is_for_another = false;
    }
    http_client client = describe(key);
    client.is_unknown_proxy = client.is_local && is_for_another;
    client.is_local = client.is_local && !is_for_another;
    return client;
}

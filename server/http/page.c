// The page's files: regular files below the web directory, each path component opened by itself
// without following links, so that no path leads out of it. A client that takes it gets the encoded
// form that the page's build wrote beside a file; nothing is encoded here.

#include "server/http/page.h"

#include "api/http/negotiation.h"
#include "server/http/http_priv.h"
#include "server/http/representation.h"

#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

enum { FILE_NAME_SIZE = 256 };

static const struct {
    const char *ending;
    const char *type;
} types[] = {
    { ".html", "text/html; charset=utf-8" },
    { ".css", "text/css; charset=utf-8" },
    { ".js", "text/javascript; charset=utf-8" },
    { ".mjs", "text/javascript; charset=utf-8" },
    { ".json", "application/json" },
    { ".map", "application/json" },
    { ".webmanifest", "application/manifest+json" },
    { ".svg", "image/svg+xml" },
    { ".png", "image/png" },
    { ".ico", "image/x-icon" },
    { ".woff2", "font/woff2" },
    { ".wasm", "application/wasm" },
    { ".txt", "text/plain; charset=utf-8" },
};

// What a page may load.
static const char policy[] = "default-src 'self'; base-uri 'none'; form-action 'self'; "
                             "frame-ancestors 'none'; object-src 'none'";

// NULL: it is of no type that a page has, and therefore none of its files.
static const char *type_of(const char *path)
{
    size_t n = strlen(path);

    for (size_t i = 0; i < sizeof types / sizeof *types; i++) {
        size_t n_ending = strlen(types[i].ending);
        if (n > n_ending && strcasecmp(path + n - n_ending, types[i].ending) == 0)
            return types[i].type;
    }
    return NULL;
}

// Copies the first component of *path and moves *path behind it. False: it is none that the page
// can have ("", hidden ones, "." and "..", too long).
static bool take_component(const char **path, char *ret_name)
{
    size_t n = strcspn(*path, "/");

    if (n == 0 || n >= FILE_NAME_SIZE || **path == '.')
        return false;
    memcpy(ret_name, *path, n);
    ret_name[n] = '\0';
    *path += n;
    return true;
}

// Opens a path without its first slash below directory. -1: there is no such file.
static int open_below(int directory, const char *path)
{
    char name[FILE_NAME_SIZE];
    int at = directory;

    while (take_component(&path, name)) {
        int flags = *path == '/' ? O_PATH | O_DIRECTORY : O_RDONLY | O_NONBLOCK;
        int next = openat(at, name, flags | O_NOFOLLOW | O_CLOEXEC);
        if (at != directory)
            (void)close(at);
        if (next < 0 || *path == '\0')
            return next;
        at = next;
        path++;
    }
    if (at != directory)
        (void)close(at);
    return -1;
}

// Facts of an open regular file. False: it is none.
static bool look_at(int fd, struct stat *ret_facts)
{
    return fd >= 0 && fstat(fd, ret_facts) == 0 && S_ISREG(ret_facts->st_mode);
}

static bool is_older(const struct stat *a, const struct stat *b)
{
    return a->st_mtim.tv_sec < b->st_mtim.tv_sec ||
           (a->st_mtim.tv_sec == b->st_mtim.tv_sec && a->st_mtim.tv_nsec < b->st_mtim.tv_nsec);
}

// Replaces an open plain file by the encoded one beside it. False: there is none of its age.
static bool open_beside(int web_fd, const char *path, coding form, const struct stat *plain,
                        http_file *file)
{
    static const char *const endings[CODING_COUNT] = {
        [CODING_GZIP] = ".gz", [CODING_ZSTD] = ".zst"
    };
    char name[API_PATH_MAX + 8];
    struct stat facts;

    (void)snprintf(name, sizeof name, "%s%s", path, endings[form]);
    int fd = open_below(web_fd, name + 1);
    bool is_good = look_at(fd, &facts) && !is_older(&facts, plain);
    int unused = is_good ? file->fd : fd;
    if (unused >= 0)
        (void)close(unused);
    if (!is_good)
        return false;
    file->fd = fd;
    file->n = (uint64_t)facts.st_size;
    return true;
}

bool http__page_open(int web_fd, const char *path, coding form, http_file *ret_file)
{
    struct stat facts;

    if (strcmp(path, "/") == 0)
        path = "/index.html";
    else if (strcmp(path, "/docs") == 0 || strcmp(path, "/docs/") == 0)
        path = "/docs/index.html";
    const char *type = type_of(path);
    http_file file = { .fd = -1, .type = type };
    if (*path == '/' && type != NULL)
        file.fd = open_below(web_fd, path + 1);
    bool is_there = look_at(file.fd, &facts);
    if (is_there) {
        file.n = (uint64_t)facts.st_size;
        (void)snprintf(file.etag, sizeof file.etag, "%llx-%llx.%lx",
                       (unsigned long long)facts.st_size, (unsigned long long)facts.st_mtim.tv_sec,
                       (unsigned long)facts.st_mtim.tv_nsec);
        if (form == CODING_IDENTITY || open_beside(web_fd, path, form, &facts, &file)) {
            *ret_file = file;
            return true;
        }
    }
    // open_beside() leaves the plain file open when it finds nothing.
    if (file.fd >= 0)
        (void)close(file.fd);
    return false;
}

bool http__page_may_have(const http *h, const char *path)
{
    return h->web_fd >= 0 && strncmp(path, "/v1/", 4) != 0 && !api_route_exists(path);
}

// What is answered in place of a page that this build lacks or that no directory was given for.
static const struct {
    const char *path;
    bool needs_no_folder; // it is also said where a folder was given that lacks the page
    const char *type;
    const char *text;
} placeholder_pages[] = {
    { "/", false, "text/plain; charset=utf-8",
      "This is beltflowd " BELTFLOW_VERSION ". Its page is not here: it is made when npm is there\n"
      "while Beltflow is built, and is looked for beside the program.\n"
      "The API is under /v1: try /v1/runs, /v1/examples and /version. /openapi.json describes it.\n"
      "To have the page, build with npm, or give the page's directory by --web.\n" },
    { "/docs", true, "text/html; charset=utf-8",
      "<!doctype html>\n<meta charset=\"utf-8\">\n<title>Beltflow: the API</title>\n"
      "<p>The manual and the reference of the API are made where npm is there while Beltflow is "
      "built, and are not here; they are made of <a href=\"/openapi.json\">/openapi.json</a>, "
      "which is.</p>\n" },
};

enum { N_PLACEHOLDERS = sizeof placeholder_pages / sizeof *placeholder_pages };

// Which placeholder a path has, or N_PLACEHOLDERS.
static size_t find_placeholder(const http_request *r)
{
    size_t i = 0;

    while (i < N_PLACEHOLDERS &&
           (strcmp(r->path, placeholder_pages[i].path) != 0 ||
            (r->server->web_fd >= 0 && !placeholder_pages[i].needs_no_folder)))
        i++;
    return i;
}

static void answer_placeholder(http_request *r, size_t which)
{
    const char *text = placeholder_pages[which].text;

    api_response_fini(&r->response);
    if (buffer_append(&r->response.body, text, strlen(text)) != BF_OK) {
        http__respond_refuse(r, 503, BF_ENOMEM, "out of memory");
        return;
    }
    r->response.status = 200;
    api_response_header(&r->response, "Content-Type", "%s", placeholder_pages[which].type);
    api_response_header(&r->response, "Content-Security-Policy", "%s", policy);
}

// Exchanges the plain file for the encoded one beside it that the client likes best, if that is as
// good to the client as any.
static coding choose_form(http_request *r, http_file *file)
{
    static const coding offers[] = { CODING_ZSTD, CODING_GZIP, CODING_IDENTITY };
    const char *accepted = http__request_header(r, "Accept-Encoding");
    // A range is one of the plain form, and little is won by an encoded one of a file that is short or compressed.
    const bool pays = http_encoding_is_text(file->type) && file->n >= HTTP_ENCODING_MIN &&
                      http__request_header(r, "Range") == NULL;
    int chosen = negotiation_choose_coding(accepted, offers, CODING_COUNT);

    if (chosen < 0 || offers[chosen] == CODING_IDENTITY ||
        (!pays && negotiation_coding_quality(accepted, CODING_IDENTITY) > 0))
        return CODING_IDENTITY;
    for (int c = chosen; c < CODING_IDENTITY; c++) {
        http_file beside;
        if (negotiation_coding_quality(accepted, offers[c]) <
                negotiation_coding_quality(accepted, offers[chosen]) ||
            !http__page_open(r->server->web_fd, r->path, offers[c], &beside))
            continue;
        (void)close(file->fd);
        *file = beside;
        return offers[c];
    }
    return CODING_IDENTITY;
}

static void answer_file(http_request *r, http_file *file)
{
    const char *wanted = http__request_header(r, "If-Match");
    const char *known = http__request_header(r, "If-None-Match");
    char tag[CODING_TAG_SIZE];

    if (wanted != NULL && !negotiation_allows_change(wanted, file->etag)) {
        http__respond_refuse(r, 412, BF_EINPUT,
                             "the state is not the one that If-Match names: it is \"%s\"",
                             file->etag);
        return;
    }
    api_response_fini(&r->response);
    coding form = choose_form(r, file);
    r->response.status = 200;
    api_response_header(&r->response, "ETag", "\"%s\"", file->etag);
    api_response_header(&r->response, "Cache-Control", "no-cache");
    api_response_header(&r->response, "Content-Security-Policy", "%s", policy);
    api_response_header(&r->response, "Referrer-Policy", "no-referrer");
    api_response_header(&r->response, "Content-Type", "%s", file->type);
    if (form != CODING_IDENTITY)
        http__set_coding(&r->response, form);
    if (known != NULL &&
        negotiation_match_etag(known, file->etag, http__request_header(r, "Accept-Encoding"), tag))
        r->response.status = 304;
    r->file = *file;
}

static bool is_method(const http_request *r, const char *method)
{
    return strcmp(r->method, method) == 0;
}

void http__page_answer(http_request *r)
{
    bool is_read = is_method(r, "GET") || is_method(r, "HEAD");
    http_file file = { .fd = -1 };
    bool is_there = r->server->web_fd >= 0 &&
                    http__page_open(r->server->web_fd, r->path, CODING_IDENTITY, &file);
    size_t placeholder = is_there ? N_PLACEHOLDERS : find_placeholder(r);

    if (!is_there && placeholder == N_PLACEHOLDERS)
        return;
    if (is_method(r, "OPTIONS")) {
        api_response_fini(&r->response);
        r->response.status = 204;
    } else if (!is_read) {
        http__respond_refuse(r, 405, BF_EINPUT, "this path knows: GET, HEAD, OPTIONS");
    } else if (is_there) {
        answer_file(r, &file);
    } else {
        answer_placeholder(r, placeholder);
    }
    if (!is_read)
        api_response_header(&r->response, "Allow", "GET, HEAD, OPTIONS");
    r->response.route = METRICS_PAGE;
    if (file.fd >= 0 && r->file.fd < 0)
        (void)close(file.fd);
}

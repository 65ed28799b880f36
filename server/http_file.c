// The page's files: regular files below the web directory, each path component opened by itself
// without following links, so that no path leads out of it.

#include "server/http_priv.h"

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

bool http__file_open(int web_fd, const char *path, http_file *ret_file)
{
    struct stat facts;

    if (strcmp(path, "/") == 0)
        path = "/index.html";
    const char *type = type_of(path);
    int fd = *path == '/' && type != NULL ? open_below(web_fd, path + 1) : -1;
    if (fd < 0)
        return false;
    if (fstat(fd, &facts) != 0 || !S_ISREG(facts.st_mode)) {
        (void)close(fd);
        return false;
    }
    ret_file->fd = fd;
    ret_file->n = (uint64_t)facts.st_size;
    ret_file->type = type;
    (void)snprintf(ret_file->etag, sizeof ret_file->etag, "\"%llx-%llx.%lx\"",
                   (unsigned long long)facts.st_size, (unsigned long long)facts.st_mtim.tv_sec,
                   (unsigned long)facts.st_mtim.tv_nsec);
    return true;
}

static void explain_absence(http_request *r)
{
    static const char text[] =
        "This is beltflowd " BELTFLOW_VERSION ". It was started without a page.\n"
        "The API is under /v1: try /v1/runs, /v1/examples and /version.\n"
        "To have the page, give its directory by --web.\n";

    api_response_fini(&r->response);
    if (buffer_append(&r->response.body, text, sizeof text - 1) != BF_OK) {
        http__respond_refuse(r, 503, &(bf_error){ .code = BF_ENOMEM, .text = "out of memory" });
        return;
    }
    r->response.status = 200;
    api_response_header(&r->response, "Content-Type", "text/plain; charset=utf-8");
}

// True if the client's If-None-Match names the tag.
static bool has_it_already(http_request *r, const char *etag)
{
    const char *known = http__request_header(r, "If-None-Match");
    return known != NULL && (strcmp(known, "*") == 0 || strstr(known, etag) != NULL);
}

static void refuse_method(http_request *r)
{
    const bf_error err = { .code = BF_EINPUT, .text = "this path knows: GET, HEAD" };

    http__respond_refuse(r, 405, &err);
    api_response_header(&r->response, "Allow", "GET, HEAD");
}

static void answer_file(http_request *r, const http_file *file)
{
    api_response_fini(&r->response);
    r->response.status = 200;
    api_response_header(&r->response, "ETag", "%s", file->etag);
    api_response_header(&r->response, "Cache-Control", "no-cache");
    api_response_header(&r->response, "Content-Security-Policy",
                        "default-src 'self'; base-uri 'none'; form-action 'self'; "
                        "frame-ancestors 'none'; object-src 'none'");
    api_response_header(&r->response, "Referrer-Policy", "no-referrer");
    // MHD sends no body with a 304, but the length of what it is given.
    r->file = *file;
    if (has_it_already(r, file->etag))
        r->response.status = 304;
    else
        api_response_header(&r->response, "Content-Type", "%s", file->type);
}

void http__file_answer(http_request *r)
{
    bool is_read = strcmp(r->method, "GET") == 0 || strcmp(r->method, "HEAD") == 0;
    http_file file = { .fd = -1 };
    bool is_there = r->server->web_fd < 0 ? strcmp(r->path, "/") == 0
                                          : http__file_open(r->server->web_fd, r->path, &file);

    if (is_there && !is_read)
        refuse_method(r);
    else if (file.fd >= 0)
        answer_file(r, &file);
    else if (is_there)
        explain_absence(r);
    if (file.fd >= 0 && r->file.fd < 0)
        (void)close(file.fd);
}

#include "server/cli/cmd.h"

#include "api/openapi/openapi.h"

#include <argp.h>
#include <stdio.h>

int cmd_openapi(int argc, char **argv)
{
    static const struct argp parser = {
        .doc = "Print the OpenAPI 3.1 document of the daemon's API, as GET /openapi.json gives it.",
    };
    bf_buffer document = { 0 };
    bf_error err = { 0 };

    argp_parse(&parser, argc, argv, 0, NULL, NULL);
    if (openapi_write(&document, &err) != BF_OK)
        return cmd_fail(argv[0], &err);
    (void)fwrite(document.bytes, 1, document.n, stdout);
    buffer_fini(&document);
    return CMD_DONE;
}

#include "tests/unit/server/helper_golden.h"

#include <stdio.h>
#include <zstd.h>

void helper_golden_put(helper_store *h, int version)
{
    static char packed[1 << 17], bytes[1 << 20];
    char path[160];

    helper_store_close(h);
    (void)snprintf(path, sizeof path, SOURCE_DIR "/tests/golden/store-%d.db.zst", version);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    const size_t n =
        ZSTD_decompress(bytes, sizeof bytes, packed, fread(packed, 1, sizeof packed, file));
    assert_false(ZSTD_isError(n));
    assert_int_equal(fclose(file), 0);
    (void)snprintf(path, sizeof path, "%s/beltflow.db", h->directory);
    file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, n, file), n);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(helper_store_sql(h, "PRAGMA user_version"), version);
}

// Unit tests of `beltflow worker`: a job and a checkpoint in, frames out.

#include "core/observe/frame.h"
#include "core/run/run.h"
#include "server/base/file_io.h"
#include "server/cli/cmd.h"
#include "tests/unit/helper_cmocka.h"

#include <fcntl.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

static const char scenario[] =
    "{\"duration_s\": 0.05, \"domain\": {\"x_m\": [0, 0.5], \"y_m\": [0, 0.3]}, "
    "\"cargo\": {\"shape\": {\"type\": \"cylinder\"}}, \"initial\": {\"positions_m\": [[0.1, "
    "0.1]]}}";

// A file of the test's folder.
typedef struct path {
    char text[64];
} path;

static path path_of(const char *folder, const char *name)
{
    path p;

    snprintf(p.text, sizeof p.text, "%s/%s", folder, name);
    return p;
}

// A job, and after it a checkpoint of these bytes.
static void write_input(const char *to, const void *checkpoint, size_t n)
{
    const frame job = { .type = FRAME_JOB, .job = { RUN_MACRO, 1, sizeof scenario - 1, scenario } };
    const frame resume = { .type = FRAME_RESUME, .bytes = { 5, n, checkpoint } };
    bf_buffer in = { 0 };

    assert_int_equal(frame_encode(&job, &in, NULL), BF_OK);
    assert_int_equal(frame_encode(&resume, &in, NULL), BF_OK);
    FILE *file = fopen(to, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(in.bytes, 1, in.n, file), in.n);
    assert_int_equal(fclose(file), 0);
    buffer_fini(&in);
}

// Asserts that these frames are those of a whole run from t = 0.
static void check_frames(const char *from)
{
    bool has_begun = false, has_ended = false;
    bf_buffer bytes = { 0 };

    assert_int_equal(file_io_read(from, NULL, 1 << 24, &bytes, NULL), BF_OK);
    while (bytes.n > 0) {
        size_t used = 0;
        frame f;
        assert_int_equal(frame_decode(bytes.bytes, bytes.n, &f, &used, NULL), BF_OK);
        assert_true(used > 0);
        if (f.type == FRAME_BEGIN) {
            assert_int_equal(f.begin.first_step, 0);
            has_begun = true;
        }
        if (f.type == FRAME_END) {
            assert_int_equal(f.end.stopped, 0);
            has_ended = true;
        }
        buffer_drop(&bytes, used);
    }
    assert_true(has_begun && has_ended);
    buffer_fini(&bytes);
}

static void check_start_again(const void *checkpoint, size_t n)
{
    char folder[] = "/tmp/beltflow-worker-XXXXXX", command[400];
    bf_buffer said = { 0 };

    assert_non_null(mkdtemp(folder));
    const path in = path_of(folder, "in"), out = path_of(folder, "out"),
               err = path_of(folder, "err");
    write_input(in.text, checkpoint, n);
    snprintf(command, sizeof command, "%s/beltflow worker <%s >%s 2>%s", PROGRAM_DIR, in.text,
             out.text, err.text);
    assert_int_equal(system(command), 0);
    check_frames(out.text);
    assert_int_equal(file_io_read(err.text, NULL, 1 << 16, &said, NULL), BF_OK);
    assert_non_null(strstr(said.bytes, "starting again from t = 0: "));
    buffer_fini(&said);
    unlink(in.text);
    unlink(out.text);
    unlink(err.text);
    rmdir(folder);
}

// A checkpoint of an older version began with "BFR1".
static void a_checkpoint_that_does_not_fit_means_to_start_again(void **state)
{
    char older[200] = "BFR1";

    check_start_again(older, sizeof older);
    check_start_again("torn", 4);
}

static size_t given;           // to jansson as its seed
static bool was_given_outside; // where files could still be opened

// This takes the place of jansson's.
void json_object_seed(size_t seed)
{
    const int file = open("/dev/null", O_RDONLY | O_CLOEXEC);

    given = seed;
    was_given_outside = file >= 0;
    if (file >= 0)
        close(file);
}

// Without a job the worker fails, after it has confined itself.
static void work_on_nothing(void)
{
    char name[] = "beltflow worker", *arguments[] = { name, NULL };
    const int nothing = open("/dev/null", O_RDWR | O_CLOEXEC);

    for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; fd++)
        (void)dup2(nothing, fd);
    const bool has_failed = cmd_worker(1, arguments) == CMD_FAILED;
    _exit(has_failed && given != 0 && was_given_outside ? 0 : 1);
}

static void hashes_are_seeded_before_the_confinement(void **state)
{
    int status = -1;

    const pid_t child = fork();
    if (child == 0)
        work_on_nothing();
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_int_equal(status, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_checkpoint_that_does_not_fit_means_to_start_again),
        cmocka_unit_test(hashes_are_seeded_before_the_confinement),
    };

    return cmocka_run_group_tests(tests, NULL, NULL);
}

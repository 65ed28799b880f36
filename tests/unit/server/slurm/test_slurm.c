// Tests of what Slurm is asked for. The programs of Slurm are scripts in a folder of the test: squeue prints the file `queue`,
// sbatch and scancel write their arguments to `calls`, and sbatch its input to `script`.

#include "core/base/memory.h"
#include "server/base/clock.h"
#include "server/base/metrics.h"
#include "server/base/solver.h"
#include "server/pull/pull_executor.h"
#include "server/slurm/slurm_priv.h"
#include "tests/unit/server/helper_await.h"
#include "tests/unit/server/helper_store.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SECOND_MS = 1000, TEXT_SIZE = 4096 };

#define URL     "http://head:8080"
#define COMMENT "beltflow " URL

static char folder[] = "/tmp/test_slurm_XXXXXX";

static const slurm_settings usual = { .url = URL,
                                      .token_file = "",
                                      .program = "/usr/bin/beltflow",
                                      .template_file = "",
                                      .n_workers_max = 4,
                                      .cores = 2,
                                      .walltime_s = 3600,
                                      .idle_s = 60,
                                      .interval_s = 10 };

// A file of the folder with that text.
static void write_file(const char *name, const char *text, mode_t mode)
{
    char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
    assert_int_equal(chmod(path, mode), 0);
}

// What a file of the folder holds, and then no more; "" if there is none.
static const char *take_file(const char *name, char storage[static TEXT_SIZE])
{
    char path[128];

    (void)snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "r");
    const size_t n = file == NULL ? 0 : fread(storage, 1, TEXT_SIZE - 1, file);
    storage[n] = '\0';
    if (file != NULL) {
        (void)fclose(file);
        (void)unlink(path);
    }
    return storage;
}

static int make_folder(void **state)
{
    char path[256];

    if (mkdtemp(folder) == NULL)
        return -1;
    (void)snprintf(path, sizeof path, "%s:/usr/bin:/bin", folder);
    (void)setenv("PATH", path, 1);
    (void)setenv("FOLDER", folder, 1);
    write_file("squeue", "#!/bin/sh\necho squeue >>$FOLDER/calls\ncat $FOLDER/queue\n", 0700);
    write_file("sbatch",
               "#!/bin/sh\necho \"sbatch $@\" >>$FOLDER/calls\ncat >$FOLDER/script\necho 7\n",
               0700);
    write_file("scancel", "#!/bin/sh\necho \"scancel $@\" >>$FOLDER/calls\n", 0700);
    return 0;
}

static int remove_folder(void **state)
{
    helper_store_remove_directory(folder);
    return 0;
}

static slurm_settings with_template(const char *text)
{
    static char path[128];
    slurm_settings settings = usual;

    write_file("template", text, 0600);
    (void)snprintf(path, sizeof path, "%s/template", folder);
    settings.template_file = path;
    return settings;
}

static void assert_script(const slurm_settings *settings, const char *text)
{
    bf_buffer script = { 0 };

    assert_int_equal(slurm_write_script(settings, &script, NULL), BF_OK);
    assert_string_equal(script.bytes, text);
    buffer_fini(&script);
}

static void test_the_script_starts_a_worker_that_ends_before_the_time_limit(void **state)
{
    assert_script(&usual, "#!/bin/sh\n"
                          "#SBATCH --nodes=1 --ntasks=1 --cpus-per-task=2\n"
                          "#SBATCH --time=60\n"
                          "#SBATCH --signal=B:TERM@120\n"
                          "#SBATCH --no-requeue\n"
                          "#SBATCH --output=/dev/null\n"
                          "exec '/usr/bin/beltflow' worker --pull '" URL "'  --cores 2 \\\n"
                          "    --name slurm-${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID} \\\n"
                          "    --lifetime-s 3480 --idle-s 60\n");
}

static void test_texts_in_a_template_are_quoted_and_other_braces_stay(void **state)
{
    slurm_settings settings = with_template("a {token} ${X} {url {program}}{idle_s}");
    settings.token_file = "/etc/it's";
    assert_script(&settings, "a --token-file '/etc/it'\"'\"'s' ${X} {url '/usr/bin/beltflow'}60");
}

static void test_a_bad_template_is_refused(void **state)
{
    slurm_settings settings = with_template("");
    bf_buffer script = { 0 };
    char large[SLURM_TEMPLATE_BYTES_MAX + 2];

    assert_int_equal(slurm_write_script(&settings, &script, NULL), BF_EINPUT);
    memset(large, '#', sizeof large);
    large[sizeof large - 1] = '\0';
    settings = with_template(large);
    assert_int_equal(slurm_write_script(&settings, &script, NULL), BF_ELIMIT);
    settings.template_file = "/none/such";
    assert_int_equal(slurm_write_script(&settings, &script, NULL), BF_EINPUT);
    settings = usual;
    settings.url = "";
    assert_int_equal(slurm_write_script(&settings, &script, NULL), BF_EINPUT);
    assert_int_equal(script.n, 0);
}

static void test_times_of_the_queue_have_days_hours_minutes_and_seconds(void **state)
{
    assert_int_equal(slurm__read_time("0:07"), 7);
    assert_int_equal(slurm__read_time("12:34"), 12 * 60 + 34);
    assert_int_equal(slurm__read_time("2:00:01"), 2 * 3600 + 1);
    assert_int_equal(slurm__read_time("3-01:00:00"), 73 * 3600);
    assert_int_equal(slurm__read_time("INVALID"), 0);
    assert_int_equal(slurm__read_time(""), 0);
}

static void test_the_queue_has_our_tasks_among_others(void **state)
{
    static const char text[] = "8|1|RUNNING|0:30|None|" COMMENT "\n"
                               "squeue: warning: something\n"
                               "8|2|PENDING|0:00|Priority|" COMMENT "\n"
                               "8|3|PENDING|0:00|launch failed requeued held|" COMMENT "\n"
                               "8|4|COMPLETING|0:09|None|" COMMENT "\n"
                               "8|5|PENDING|0:00|JobHeldUser|" COMMENT "\n"
                               "8|6|PENDING|0:00|JobHeldAdmin|" COMMENT "\n"
                               "8|7|PENDING|0:00|launch_failed_requeued_held|" COMMENT "\n"
                               "8|8|REQUEUE_HOLD|0:00|None|" COMMENT "\n"
                               "8|9|SPECIAL_EXIT|0:00|None|" COMMENT "\n"
                               "9|1|RUNNING|0:30|None|beltflow http://other:8080\n"
                               "10|N/A|RUNNING|0:30|None|" COMMENT "\n"
                               "11|1|RUNNING";
    static const slurm__task expected[] = {
        { "8_1", SLURM_STARTED, 30 }, { "8_2", SLURM_PENDING, 0 }, { "8_3", SLURM_FAILED, 0 },
        { "8_4", SLURM_OVER, 9 },     { "8_5", SLURM_HELD, 0 },    { "8_6", SLURM_HELD, 0 },
        { "8_7", SLURM_FAILED, 0 },   { "8_8", SLURM_FAILED, 0 },  { "8_9", SLURM_FAILED, 0 }
    };
    slurm__queue queue;

    assert_int_equal(slurm__read_queue(text, COMMENT, &queue, NULL), BF_OK);
    assert_int_equal(queue.n, sizeof expected / sizeof *expected);
    for (size_t k = 0; k < queue.n; k++) {
        assert_string_equal(queue.tasks[k].name, expected[k].name);
        assert_int_equal(queue.tasks[k].state, expected[k].state);
        assert_int_equal(queue.tasks[k].runs_s, expected[k].runs_s);
    }
    memory_free(queue.tasks);
}

// What a shell command gives, run as one of Slurm's.
static bf_status run_shell(const char *command, bool is_stopping, bf_buffer *out, bf_error *err)
{
    const char *const argv[] = { "sh", "-c", command, NULL };
    const atomic_bool must_stop = is_stopping;
    const slurm__command c = { .argv = argv, .must_stop = &must_stop };

    return slurm__run(&c, out, err);
}

static void test_a_command_that_fails_says_why(void **state)
{
    const char *const missing[] = { "no-such-program", NULL };
    const atomic_bool must_stop = false;
    const slurm__command c = { .argv = missing, .must_stop = &must_stop };
    bf_buffer out = { 0 };
    bf_error err = { 0 };

    assert_int_equal(run_shell("echo one; echo two >&2", false, &out, NULL), BF_OK);
    assert_string_equal(out.bytes, "one\ntwo\n");
    assert_int_equal(run_shell("echo first; echo last >&2; exit 3", false, &out, &err), BF_ESYSTEM);
    assert_string_equal(err.text, "sh failed: last");
    buffer_truncate(&out, 0);
    assert_int_equal(run_shell("kill -9 $$", false, &out, &err), BF_ESYSTEM);
    assert_string_equal(err.text, "sh failed: without a message");
    assert_int_equal(slurm__run(&c, &out, &err), BF_ESYSTEM);
    assert_string_equal(err.text, "no-such-program cannot be run: No such file or directory");
    buffer_fini(&out);
}

static void test_a_command_has_limits(void **state)
{
    const int64_t begin_ms = clock_monotonic_ms();
    bf_buffer out = { 0 };

    assert_int_equal(run_shell("yes", false, &out, NULL), BF_ELIMIT);
    buffer_fini(&out);
    assert_int_equal(run_shell("exec sleep 60", true, &out, NULL), BF_ESYSTEM);
    assert_int_equal(run_shell("exec sleep 60 >/dev/null 2>&1", true, &out, NULL), BF_ESYSTEM);
    assert_true(clock_monotonic_ms() - begin_ms < HELPER_PATIENCE_MS);
    buffer_fini(&out);
}

// A store with runs that wait, an executor, and what counts workers for them.
typedef struct fixture {
    helper_store *h;
    executor *pull;
    slurm *slurm;
} fixture;

static fixture begin(void **state, uint64_t n_runs)
{
    fixture f = { .h = *state };
    store_stats stats = { .file_bytes = 0 };
    char text[TEXT_SIZE];

    for (uint64_t k = 0; k < n_runs; k++)
        (void)helper_submit(f.h->store, "", 0);
    HELPER_AWAIT((store_read_stats(f.h->store, &stats), stats.n_runs[RUN_QUEUED] == n_runs));
    assert_int_equal(pull_executor_create(&f.pull, NULL), BF_OK);
    const slurm_options options = {
        .settings = usual, .pull = f.pull, .store = f.h->store, .n_threads = 1
    };
    assert_int_equal(slurm__create(&options, &f.slurm, NULL), BF_OK);
    write_file("queue", "", 0600);
    (void)take_file("calls", text);
    return f;
}

static void end(fixture *f)
{
    slurm__destroy(f->slurm);
    (void)pull_executor_destroy(f->pull);
}

// What Slurm was asked at a time, with this in its queue.
static void assert_calls(fixture *f, int64_t now_ms, const char *queue, const char *calls)
{
    char text[TEXT_SIZE];

    write_file("queue", queue, 0600);
    slurm__take_turn(f->slurm, now_ms);
    assert_string_equal(take_file("calls", text), calls);
}

#define SUBMIT(n) "sbatch --parsable --job-name=beltflow --array=1-" #n " --comment=" COMMENT "\n"

static void test_without_work_slurm_is_left_alone(void **state)
{
    fixture f = begin(state, 0);

    assert_calls(&f, SECOND_MS, "", "");
    end(&f);
}

// Nobody may claim them, so a worker would come for nothing.
static void test_trials_of_a_study_that_rests_want_no_worker(void **state)
{
    fixture f = begin(state, 3);
    store_stats stats = { .n_claimable = 3 };

    helper_store_close(f.h);
    helper_store_sql(f.h, "UPDATE runs SET parent = '0190a0b0-0000-7000-8000-00000000000a'");
    helper_store_open(f.h);
    f.slurm->options.store = f.h->store;
    HELPER_AWAIT((store_read_stats(f.h->store, &stats), stats.n_runs[RUN_QUEUED] == 3));
    assert_calls(&f, SECOND_MS, "", "");
    end(&f);
}

static void test_one_array_is_submitted_for_what_waits(void **state)
{
    fixture f = begin(state, 3);
    char text[TEXT_SIZE];

    assert_calls(&f, SECOND_MS, "", "squeue\n" SUBMIT(2));
    assert_string_equal(take_file("script", text), f.slurm->script.bytes);
    assert_calls(&f, 2 * SECOND_MS, "", "");
    assert_calls(&f, 11 * SECOND_MS,
                 "7|1|RUNNING|0:01|None|" COMMENT "\n7|2|PENDING|0:00|Priority|" COMMENT "\n",
                 "squeue\n");
    end(&f);
}

static void test_what_slurm_forgot_is_submitted_again(void **state)
{
    fixture f = begin(state, 3);

    assert_calls(&f, SECOND_MS, "", "squeue\n" SUBMIT(2));
    assert_calls(&f, 11 * SECOND_MS, "7|1|RUNNING|0:01|None|" COMMENT "\n", "squeue\n" SUBMIT(1));
    assert_calls(&f, 21 * SECOND_MS, "", "squeue\n" SUBMIT(2));
    end(&f);
}

static void test_no_more_than_slurm_workers_are_wanted(void **state)
{
    fixture f = begin(state, 11);

    assert_calls(&f, SECOND_MS, "", "squeue\n" SUBMIT(4));
    assert_int_equal(metrics_value(METRICS_SLURM_WANTED, 0), 4);
    end(&f);
}

static void test_what_could_not_be_launched_is_cancelled_and_replaced(void **state)
{
    fixture f = begin(state, 2);

    assert_calls(&f, SECOND_MS, "7|1|PENDING|0:00|launch failed requeued held|" COMMENT "\n",
                 "squeue\nscancel 7_1\n" SUBMIT(1));
    end(&f);
}

static void test_what_an_operator_holds_is_left_and_replaced(void **state)
{
    fixture f = begin(state, 2);

    assert_calls(&f, SECOND_MS, "7|1|PENDING|0:00|JobHeldAdmin|" COMMENT "\n",
                 "squeue\n" SUBMIT(1));
    assert_calls(&f, 11 * SECOND_MS,
                 "7|1|PENDING|0:00|JobHeldAdmin|" COMMENT "\n8|1|RUNNING|0:01|None|" COMMENT "\n",
                 "squeue\n");
    end(&f);
}

static void test_a_task_whose_worker_is_not_heard_of_counts_for_ten_minutes(void **state)
{
    fixture f = begin(state, 2);
    const api_leases workers = pull_executor_leases(f.pull);
    api_worker who = { .name = "slurm-7_1", .cores = 2 };
    api_lease lease = { .n_jobs = 0 };

    (void)solver_name(who.solver);
    assert_calls(&f, SECOND_MS, "7|1|RUNNING|9:59|None|" COMMENT "\n", "squeue\n");
    assert_calls(&f, 11 * SECOND_MS, "7|1|RUNNING|10:00|None|" COMMENT "\n", "squeue\n" SUBMIT(1));
    assert_int_equal(workers.lease(workers.context, &who, &lease, NULL), BF_OK);
    assert_calls(&f, 21 * SECOND_MS, "7|1|RUNNING|10:10|None|" COMMENT "\n", "squeue\n");
    api_lease_fini(&lease);
    end(&f);
}

static void test_nothing_is_submitted_while_the_queue_is_not_known(void **state)
{
    fixture f = begin(state, 2);
    const int64_t n_failures = metrics_value(METRICS_SLURM_FAILURES, 0);

    write_file("squeue", "#!/bin/sh\necho \"squeue\" >>$FOLDER/calls\nexit 1\n", 0700);
    assert_calls(&f, SECOND_MS, "", "squeue\n");
    assert_int_equal(metrics_value(METRICS_SLURM_FAILURES, 0), n_failures + 1);
    write_file("squeue", "#!/bin/sh\necho squeue >>$FOLDER/calls\ncat $FOLDER/queue\n", 0700);
    assert_calls(&f, 2 * SECOND_MS, "", "");
    assert_calls(&f, 11 * SECOND_MS, "", "squeue\n" SUBMIT(1));
    end(&f);
}

static void test_a_thread_does_it_until_it_is_stopped(void **state)
{
    fixture f = begin(state, 1);
    slurm *started;
    char text[TEXT_SIZE] = "";

    assert_int_equal(slurm_start(&f.slurm->options, &started, NULL), BF_OK);
    HELPER_AWAIT((take_file("script", text), text[0] != '\0'));
    assert_null(slurm_stop(started));
    assert_string_equal(text, f.slurm->script.bytes);
    end(&f);
}

#define WITH_STORE(test)                                                                           \
    cmocka_unit_test_setup_teardown(test, helper_store_setup, helper_store_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_the_script_starts_a_worker_that_ends_before_the_time_limit),
        cmocka_unit_test(test_texts_in_a_template_are_quoted_and_other_braces_stay),
        cmocka_unit_test(test_a_bad_template_is_refused),
        cmocka_unit_test(test_times_of_the_queue_have_days_hours_minutes_and_seconds),
        cmocka_unit_test(test_the_queue_has_our_tasks_among_others),
        cmocka_unit_test(test_a_command_that_fails_says_why),
        cmocka_unit_test(test_a_command_has_limits),
        WITH_STORE(test_without_work_slurm_is_left_alone),
        WITH_STORE(test_trials_of_a_study_that_rests_want_no_worker),
        WITH_STORE(test_one_array_is_submitted_for_what_waits),
        WITH_STORE(test_what_slurm_forgot_is_submitted_again),
        WITH_STORE(test_no_more_than_slurm_workers_are_wanted),
        WITH_STORE(test_what_could_not_be_launched_is_cancelled_and_replaced),
        WITH_STORE(test_what_an_operator_holds_is_left_and_replaced),
        WITH_STORE(test_a_task_whose_worker_is_not_heard_of_counts_for_ten_minutes),
        WITH_STORE(test_nothing_is_submitted_while_the_queue_is_not_known),
        WITH_STORE(test_a_thread_does_it_until_it_is_stopped),
    };

    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

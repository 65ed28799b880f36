// Unit tests of the settings: table, file, environment, sample.

#include "server/daemon/config.h"

#include "core/base/memory.h"
#include "tests/unit/helper_cmocka.h"

#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/test_config_XXXXXX";

static int make_folder(void **state)
{
    return mkdtemp(folder) == NULL ? -1 : 0;
}

static int remove_folder(void **state)
{
    char command[64];

    (void)snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command);
}

// A file below the folder with that text; returns its path in storage.
static const char *write_file(const char *name, const char *text, char storage[static 256])
{
    (void)snprintf(storage, 256, "%s/%s", folder, name);
    FILE *file = fopen(storage, "w");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
    return storage;
}

static void defaults_are_those_of_the_table(void **state)
{
    config c;

    config_init(&c);
    assert_string_equal(c.listen, "127.0.0.1:8080");
    assert_string_equal(c.web, "");
    assert_int_equal(c.workers, 0);
    assert_int_equal(c.body_bytes, 1048576);
    assert_int_equal(config_log_level(&c), LOG_LEVEL_INFO);
}

static void a_setting_is_taken_by_its_name(void **state)
{
    config c;

    config_init(&c);
    assert_int_equal(config_set(&c, "workers", "64", "--workers", NULL), BF_OK);
    assert_int_equal(config_set(&c, "data", "/var/lib/x", "--data", NULL), BF_OK);
    assert_int_equal(config_set(&c, "log_level", "debug", "--log-level", NULL), BF_OK);
    assert_int_equal(c.workers, 64);
    assert_string_equal(c.data, "/var/lib/x");
    assert_int_equal(config_log_level(&c), LOG_LEVEL_DEBUG);
}

static void a_bad_value_is_refused_and_changes_nothing(void **state)
{
    static const struct {
        const char *name, *value;
    } cases[] = {
        { "threads", "0" },      { "workers", "65" },  { "workers", "" },
        { "workers", "-1" },     { "workers", "1.5" }, { "workers", " 1" },
        { "workers", "0x10" },   { "workers", "1k" },  { "run_cpu_s", "18446744073709551616" },
        { "log_level", "loud" }, { "log_level", "" },
    };
    config c, before;

    config_init(&c);
    before = c;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_error err = { 0 };
        assert_int_equal(config_set(&c, cases[i].name, cases[i].value, "here:7", &err), BF_EINPUT);
        assert_non_null(strstr(err.text, "here:7"));
        assert_non_null(strstr(err.text, cases[i].name));
        assert_memory_equal(&c, &before, sizeof c);
    }
}

static void a_text_may_be_as_long_as_its_room(void **state)
{
    char text[CONFIG_TEXT_SIZE + 1];
    config c;

    config_init(&c);
    memset(text, 'x', sizeof text);
    text[CONFIG_TEXT_SIZE] = '\0';
    assert_int_equal(config_set(&c, "data", text, "--data", NULL), BF_EINPUT);
    assert_string_equal(c.data, "beltflow-data");
    text[CONFIG_TEXT_SIZE - 1] = '\0';
    assert_int_equal(config_set(&c, "data", text, "--data", NULL), BF_OK);
    assert_string_equal(c.data, text);
}

static void an_unknown_name_is_refused_with_a_suggestion(void **state)
{
    bf_error err = { 0 };
    config c;

    config_init(&c);
    assert_int_equal(config_set(&c, "worker", "1", "--worker", &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "'workers'"));
    assert_int_equal(config_set(&c, "zzzzzzzzzzzz", "1", "x", &err), BF_EINPUT);
    assert_null(strstr(err.text, "meant"));
}

static void a_file_is_read_line_by_line(void **state)
{
    char path[256];
    config c;

    config_init(&c);
    assert_int_equal(config_read_file(&c,
                                      write_file("good.conf",
                                                 "# comment\n"
                                                 "; another\n"
                                                 "\n"
                                                 "workers = 3\n"
                                                 "   threads=2\n"
                                                 "data = /srv/belt flow\n"
                                                 "listen = [::1]:0\n"
                                                 "workers = 4",
                                                 path),
                                      NULL),
                     BF_OK);
    assert_int_equal(c.workers, 4);
    assert_int_equal(c.threads, 2);
    assert_string_equal(c.data, "/srv/belt flow");
    assert_string_equal(c.listen, "[::1]:0");
}

static void a_bad_file_is_refused_with_its_line_and_changes_nothing(void **state)
{
    char long_line[600], path[256];
    const struct {
        const char *text, *place, *word;
    } cases[] = {
        { "workers = 2\nthread = 1\n", ":2", "'threads'" },
        { "workers = 2\n\nworkers = many\n", ":3", "workers" },
        { "workers = 2\nnonsense\n", ":2", "name = value" },
        { "workers = 2\n[http]\nthreads = 2\n", ":3", "sections" },
        { long_line, ":2", "long" },
        { "workers = 2\nworkers =\n", ":2", "workers" },
    };
    config c, before;

    (void)snprintf(long_line, sizeof long_line, "workers = 2\ndata = %0500d\n", 0);
    config_init(&c);
    before = c;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        bf_error err = { 0 };
        assert_int_equal(config_read_file(&c, write_file("bad.conf", cases[i].text, path), &err),
                         BF_EINPUT);
        assert_non_null(strstr(err.text, path));
        assert_non_null(strstr(err.text, cases[i].place));
        assert_non_null(strstr(err.text, cases[i].word));
        assert_memory_equal(&c, &before, sizeof c);
    }
}

static void a_file_that_cannot_be_read_says_why(void **state)
{
    bf_error err = { 0 };
    config c;

    config_init(&c);
    assert_int_equal(config_read_file(&c, "/nowhere/beltflowd.conf", &err), BF_ESYSTEM);
    assert_non_null(strstr(err.text, "/nowhere/beltflowd.conf"));
    assert_int_equal(config_read_file(&c, folder, &err), BF_ESYSTEM);
}

static void the_environment_names_settings_in_capitals(void **state)
{
    bf_error err = { 0 };
    config c;

    config_init(&c);
    assert_int_equal(setenv("BELTFLOW_HTTP_THREADS", "5", 1), 0);
    assert_int_equal(setenv("BELTFLOW_SOMETHING_ELSE", "x", 1), 0);
    assert_int_equal(config_read_environment(&c, NULL), BF_OK);
    assert_int_equal(c.http_threads, 5);
    assert_int_equal(setenv("BELTFLOW_STREAMS", "none", 1), 0);
    assert_int_equal(config_read_environment(&c, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "BELTFLOW_STREAMS"));
    assert_int_equal(unsetenv("BELTFLOW_STREAMS"), 0);
    assert_int_equal(unsetenv("BELTFLOW_HTTP_THREADS"), 0);
}

static void the_sample_names_every_setting_and_is_itself_a_good_file(void **state)
{
    bf_buffer sample = { 0 };
    char path[256];
    size_t n = 0;
    const config_row *rows = config_rows(&n);
    config c, defaults;

    assert_int_equal(config_sample(&sample, NULL), BF_OK);
    for (size_t i = 0; i < n; i++) {
        char line[128];
        (void)snprintf(line, sizeof line, "\n#%s =%s%s\n", rows[i].name,
                       rows[i].initial[0] == '\0' ? "" : " ", rows[i].initial);
        assert_non_null(strstr(sample.bytes, line));
        assert_non_null(strstr(sample.bytes, rows[i].help));
    }
    config_init(&c);
    config_init(&defaults);
    assert_int_equal(config_read_file(&c, write_file("sample.conf", sample.bytes, path), NULL),
                     BF_OK);
    assert_memory_equal(&c, &defaults, sizeof c);
    buffer_fini(&sample);
}

static void a_sample_without_memory_fails(void **state)
{
    for (size_t n = 1;; n++) {
        bf_buffer sample = { 0 };
        memory_plan_fault(n, 0);
        bf_status status = config_sample(&sample, NULL);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        buffer_fini(&sample);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        if (!has_struck)
            break;
        assert_true(n < 100);
    }
}

static void a_text_that_a_file_could_not_say_is_refused(void **state)
{
    static const char *const texts[] = { " a", "a ", ";a", "a ;b", "a\nb", "\ta", "a\x7f" };
    static const char *const good[] = { "", "a;b", "a b", "# a", "\xc3\xa4" };
    config c;

    config_init(&c);
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
        assert_int_equal(config_set(&c, "data", texts[i], "--data", NULL), BF_EINPUT);
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        assert_int_equal(config_set(&c, "data", good[i], "--data", NULL), BF_OK);
        assert_string_equal(c.data, good[i]);
    }
}

static void it_is_known_where_a_setting_comes_from(void **state)
{
    char path[256], expected[300];
    config c;

    config_init(&c);
    assert_string_equal(c.origins[CONFIG_workers], "default");
    assert_int_equal(config_read_file(&c, write_file("o.conf", "\nworkers = 3\n", path), NULL),
                     BF_OK);
    (void)snprintf(expected, sizeof expected, "%s:2", path);
    assert_string_equal(c.origins[CONFIG_workers], expected);
    assert_int_equal(config_set(&c, "workers", "65", "--workers", NULL), BF_EINPUT);
    assert_string_equal(c.origins[CONFIG_workers], expected);
    assert_int_equal(config_set(&c, "workers", "4", "--workers", NULL), BF_OK);
    assert_string_equal(c.origins[CONFIG_workers], "--workers");
    assert_string_equal(c.origins[CONFIG_threads], "default");
}

static void what_is_printed_is_a_file_that_says_the_same(void **state)
{
    bf_buffer text = { 0 };
    char path[256];
    config c, again;

    config_init(&c);
    assert_int_equal(config_set(&c, "workers", "7", "--workers", NULL), BF_OK);
    assert_int_equal(config_set(&c, "data", "/srv/belt flow", "BELTFLOW_DATA", NULL), BF_OK);
    assert_int_equal(config_print(&c, &text, NULL), BF_OK);
    assert_non_null(strstr(text.bytes, "\n# from: --workers\nworkers = 7\n"));
    assert_non_null(strstr(text.bytes, "\n# from: BELTFLOW_DATA\ndata = /srv/belt flow\n"));
    assert_non_null(strstr(text.bytes, "\n# from: default\nthreads = 1\n"));
    config_init(&again);
    assert_int_equal(config_read_file(&again, write_file("p.conf", text.bytes, path), NULL), BF_OK);
    memcpy(again.origins, c.origins, sizeof c.origins);
    assert_memory_equal(&again, &c, sizeof c);
    buffer_fini(&text);
}

static void printing_without_memory_fails(void **state)
{
    config c;

    config_init(&c);
    for (size_t n = 1;; n++) {
        bf_buffer text = { 0 };
        memory_plan_fault(n, 0);
        bf_status status = config_print(&c, &text, NULL);
        bool has_struck = memory_faults() > 0;
        memory_plan_fault(0, 0);
        buffer_fini(&text);
        assert_int_equal(status, has_struck ? BF_ENOMEM : BF_OK);
        if (!has_struck)
            break;
        assert_true(n < 100);
    }
}

static void note_change(void *context, const config_row *row, const char *before, const char *after)
{
    char *text = context;
    size_t n = strlen(text);

    (void)snprintf(text + n, 256 - n, "%s %s>%s %s;", row->name, before, after,
                   row->can_reload ? "now" : "later");
}

static void a_reload_takes_what_it_can_and_tells_of_the_rest(void **state)
{
    char told[256] = "";
    config c, fresh;

    config_init(&c);
    config_init(&fresh);
    config_reload(&c, &fresh, note_change, told);
    assert_string_equal(told, "");
    assert_int_equal(config_set(&fresh, "workers", "5", "f:1", NULL), BF_OK);
    assert_int_equal(config_set(&fresh, "data", "elsewhere", "f:2", NULL), BF_OK);
    assert_int_equal(config_set(&fresh, "log_level", "warn", "f:3", NULL), BF_OK);
    config_reload(&c, &fresh, note_change, told);
    assert_string_equal(told, "data beltflow-data>elsewhere later;workers 0>5 now;"
                              "log_level info>warn now;");
    assert_int_equal(c.workers, 5);
    assert_string_equal(c.origins[CONFIG_workers], "f:1");
    assert_string_equal(c.log_level, "warn");
    assert_string_equal(c.data, "beltflow-data");
    assert_string_equal(c.origins[CONFIG_data], "default");
}

// deploy/beltflowd.conf is what `beltflowd --sample-config` prints.
static void the_sample_in_the_tree_is_up_to_date(void **state)
{
    static char kept[32768];
    bf_buffer sample = { 0 };
    FILE *file = fopen(SOURCE_DIR "/deploy/beltflowd.conf", "re");

    assert_non_null(file);
    kept[fread(kept, 1, sizeof kept - 1, file)] = '\0';
    assert_int_equal(fclose(file), 0);
    assert_int_equal(config_sample(&sample, NULL), BF_OK);
    assert_string_equal(sample.bytes, kept);
    buffer_fini(&sample);
}

static config_flags parse(const char *const *words, int n)
{
    static char texts[8][128];
    char *argv[9] = { NULL };
    config_flags flags;

    for (int i = 0; i < n; i++) {
        (void)snprintf(texts[i], sizeof texts[i], "%s", words[i]);
        argv[i] = texts[i];
    }
    config_parse_flags(n, argv, &flags);
    return flags;
}

static void a_flag_goes_before_the_environment_and_that_before_the_file(void **state)
{
    char path[256];
    const char *words[] = { "beltflowd",
                            "--config",
                            write_file("all.conf", "workers = 2\nthreads = 2\nstreams = 2\n", path),
                            "--check-config",
                            "--workers=4",
                            "--http-threads",
                            "4" };
    config c;

    assert_int_equal(setenv("BELTFLOW_THREADS", "3", 1), 0);
    assert_int_equal(setenv("BELTFLOW_WORKERS", "3", 1), 0);
    config_flags flags = parse(words, sizeof words / sizeof *words);
    assert_true(flags.is_check && !flags.is_print && !flags.is_sample);
    assert_int_equal(config_read(&flags, &c, NULL), BF_OK);
    assert_int_equal(c.workers, 4);
    assert_int_equal(c.threads, 3);
    assert_int_equal(c.streams, 2);
    assert_int_equal(c.http_threads, 4);
    assert_string_equal(c.origins[CONFIG_http_threads], "--http-threads");
    assert_int_equal(unsetenv("BELTFLOW_THREADS"), 0);
    assert_int_equal(unsetenv("BELTFLOW_WORKERS"), 0);
}

static void a_service_with_workers_takes_what_they_send(void **state)
{
    const char *words[] = { "beltflowd", "--executor", "pull", "--body-bytes", "262143" };
    bf_error err = { 0 };
    config c;

    config_flags flags = parse(words, sizeof words / sizeof *words);
    assert_int_equal(config_read(&flags, &c, &err), BF_EINPUT);
    assert_non_null(strstr(err.text, "--body-bytes: workers send requests of up to 262144 bytes"));
    words[4] = "262144";
    flags = parse(words, sizeof words / sizeof *words);
    assert_int_equal(config_read(&flags, &c, NULL), BF_OK);
}

static void a_text_at_fault_is_told_with_its_origin(void **state)
{
    static const char *const lines[] = { "listen = nowhere",         "cors_origins = nonsense",
                                         "trusted_proxies = nobody", "plaintext = closed",
                                         "listen = 0.0.0.0:80",      "access = sometimes" };
    char path[256], text[128], expected[300];

    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        (void)snprintf(text, sizeof text, "workers = 1\n%s\n", lines[i]);
        const char *words[] = { "beltflowd", "--config", write_file("l.conf", text, path) };
        bf_error err = { 0 };
        config c = { .workers = 9 };
        config_flags flags = parse(words, sizeof words / sizeof *words);
        assert_int_equal(config_read(&flags, &c, &err), BF_EINPUT);
        (void)snprintf(expected, sizeof expected, "%s:2: ", path);
        assert_ptr_equal(strstr(err.text, expected), err.text);
        assert_non_null(strstr(err.text, strrchr(lines[i], ' ') + 1));
        assert_int_equal(c.workers, 9);
    }
}

static void what_lies_beside_the_program_is_found(void **state)
{
    char path[256], bin[64], expected[128];
    config c;

    (void)snprintf(bin, sizeof bin, "%s/bin", folder);
    config_init(&c);
    assert_int_equal(config_locate(&c, bin, NULL), BF_OK);
    (void)snprintf(expected, sizeof expected, "%s/beltflow-worker", bin);
    assert_string_equal(c.program, expected);
    assert_string_equal(c.web, "");

    assert_int_equal(mkdir(bin, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/web", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    write_file("web/index.html", "<!doctype html>", path);
    assert_int_equal(config_locate(&c, bin, NULL), BF_OK);
    (void)snprintf(expected, sizeof expected, "%s/../web", bin);
    assert_string_equal(c.web, expected);

    // Installed goes first.
    config_init(&c);
    (void)snprintf(path, sizeof path, "%s/share", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/share/beltflow", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    (void)snprintf(path, sizeof path, "%s/share/beltflow/web", folder);
    assert_int_equal(mkdir(path, 0700), 0);
    write_file("share/beltflow/web/index.html", "<!doctype html>", path);
    assert_int_equal(config_locate(&c, bin, NULL), BF_OK);
    (void)snprintf(expected, sizeof expected, "%s/../share/beltflow/web", bin);
    assert_string_equal(c.web, expected);
}

static void what_was_set_is_not_looked_for(void **state)
{
    char too_long[CONFIG_TEXT_SIZE + 10];
    config c;

    memset(too_long, 'x', sizeof too_long);
    too_long[sizeof too_long - 1] = '\0';
    config_init(&c);
    assert_int_equal(config_locate(&c, too_long, NULL), BF_ELIMIT);
    assert_string_equal(c.program, "");
    assert_int_equal(config_set(&c, "program", "/opt/beltflow", "--program", NULL), BF_OK);
    assert_int_equal(config_set(&c, "slurm_program", "/opt/bf", "--slurm-program", NULL), BF_OK);
    assert_int_equal(config_set(&c, "web", "/opt/web", "--web", NULL), BF_OK);
    assert_int_equal(config_locate(&c, too_long, NULL), BF_OK);
    assert_string_equal(c.program, "/opt/beltflow");
    assert_string_equal(c.slurm_program, "/opt/bf");
    assert_string_equal(c.web, "/opt/web");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(defaults_are_those_of_the_table),
        cmocka_unit_test(a_setting_is_taken_by_its_name),
        cmocka_unit_test(a_bad_value_is_refused_and_changes_nothing),
        cmocka_unit_test(a_text_may_be_as_long_as_its_room),
        cmocka_unit_test(an_unknown_name_is_refused_with_a_suggestion),
        cmocka_unit_test(a_file_is_read_line_by_line),
        cmocka_unit_test(a_bad_file_is_refused_with_its_line_and_changes_nothing),
        cmocka_unit_test(a_file_that_cannot_be_read_says_why),
        cmocka_unit_test(the_environment_names_settings_in_capitals),
        cmocka_unit_test(the_sample_names_every_setting_and_is_itself_a_good_file),
        cmocka_unit_test(a_sample_without_memory_fails),
        cmocka_unit_test(a_text_that_a_file_could_not_say_is_refused),
        cmocka_unit_test(it_is_known_where_a_setting_comes_from),
        cmocka_unit_test(what_is_printed_is_a_file_that_says_the_same),
        cmocka_unit_test(printing_without_memory_fails),
        cmocka_unit_test(a_reload_takes_what_it_can_and_tells_of_the_rest),
        cmocka_unit_test(the_sample_in_the_tree_is_up_to_date),
        cmocka_unit_test(a_flag_goes_before_the_environment_and_that_before_the_file),
        cmocka_unit_test(a_service_with_workers_takes_what_they_send),
        cmocka_unit_test(a_text_at_fault_is_told_with_its_origin),
        cmocka_unit_test(what_lies_beside_the_program_is_found),
        cmocka_unit_test(what_was_set_is_not_looked_for),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}

// The batch script: a template in which names in braces stand for settings.

#include "server/base/file_io.h"
#include "server/slurm/slurm_priv.h"

#include <inttypes.h>
#include <string.h>

const char slurm_template[] = "#!/bin/sh\n"
                              "#SBATCH --nodes=1 --ntasks=1 --cpus-per-task={cores}\n"
                              "#SBATCH --time={minutes}\n"
                              "#SBATCH --signal=B:TERM@120\n"
                              "#SBATCH --no-requeue\n"
                              "#SBATCH --output=/dev/null\n"
                              "exec {program} worker --pull {url} {token} --cores {cores} \\\n"
                              "    --name slurm-${SLURM_ARRAY_JOB_ID}_${SLURM_ARRAY_TASK_ID} \\\n"
                              "    --lifetime-s {lifetime_s} --idle-s {idle_s}\n";

// For a shell: between apostrophes, and each apostrophe between quotes.
static bf_status quote(bf_buffer *out, const char *text)
{
    BF_TRY(buffer_append(out, "'", 1));
    for (; *text != '\0'; text++)
        BF_TRY(*text == '\'' ? buffer_append(out, "'\"'\"'", 5) : buffer_append(out, text, 1));
    return buffer_append(out, "'", 1);
}

// What stands for a name of n bytes. *ret_is_known = false: it is none, and nothing was written.
static bf_status write_value(bf_buffer *out, const slurm_settings *s, const char *name, size_t n,
                             bool *ret_is_known)
{
    const struct {
        const char *name, *text; // NULL: a number
        uint64_t number;
    } values[] = {
        { "program", s->program, 0 },
        { "url", s->url, 0 },
        { "cores", NULL, s->cores },
        { "minutes", NULL, (s->walltime_s + 59) / 60 },
        { "lifetime_s", NULL, s->walltime_s - SLURM_LEAD_S },
        { "idle_s", NULL, s->idle_s },
    };

    *ret_is_known = true;
    if (n == strlen("token") && memcmp(name, "token", n) == 0) {
        if (s->token_file[0] == '\0')
            return BF_OK;
        bf_status status = buffer_printf(out, "--token-file ");
        return status == BF_OK ? quote(out, s->token_file) : status;
    }
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        if (strlen(values[i].name) != n || memcmp(values[i].name, name, n) != 0)
            continue;
        return values[i].text == NULL ? buffer_printf(out, "%" PRIu64, values[i].number)
                                      : quote(out, values[i].text);
    }
    *ret_is_known = false;
    return BF_OK;
}

static bf_status fill(bf_buffer *out, const slurm_settings *s, const char *text)
{
    bf_status status = BF_OK;

    while (*text != '\0' && status == BF_OK) {
        const char *end = *text == '{' ? strchr(text, '}') : NULL;
        bool is_known = false;
        if (end != NULL)
            status = write_value(out, s, text + 1, (size_t)(end - text - 1), &is_known);
        if (status == BF_OK && !is_known)
            status = buffer_append(out, text, 1);
        text = is_known ? end + 1 : text + 1;
    }
    return status;
}

static bf_status read_template(const char *path, bf_buffer *out, bf_error *err)
{
    BF_TRY(file_io_read(path, NULL, SLURM_TEMPLATE_BYTES_MAX, out, err));
    if (out->n == 0 || strlen(out->bytes) != out->n)
        return bf_fail(err, BF_EINPUT, "", "%s is no batch script: it is empty or has a zero",
                       path);
    return BF_OK;
}

bf_status slurm_write_script(const slurm_settings *s, bf_buffer *out, bf_error *err)
{
    bf_buffer text = { 0 };
    bf_status status = BF_OK;

    if (s->url[0] == '\0')
        return bf_fail(err, BF_EINPUT, "",
                       "slurm_url must say at which URL compute nodes reach this service");
    if (s->template_file[0] != '\0')
        status = read_template(s->template_file, &text, err);
    if (status == BF_OK && fill(out, s, text.n == 0 ? slurm_template : text.bytes) != BF_OK)
        status = bf_fail(err, BF_ENOMEM, "", "no memory for a batch script");
    buffer_fini(&text);
    return status;
}

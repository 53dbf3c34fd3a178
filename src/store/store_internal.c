#include "store/store_internal.h"
#include "store/store_read.h"

#include <stdlib.h>
#include <time.h>

void hf_store_free(hf_store *s, hf_messages *messages)
{
    hf_store_file_end(&s->f, messages);
    hf_generations_free(&s->rows);
    free(s->refine);
    free(s);
}

hf_store *hf_store_new(const char *path, bool replaces, hf_status *status, hf_messages *messages)
{
    hf_store *s = calloc(1, sizeof *s);
    *status = s ? hf_store_file_begin(path, replaces, &s->f, messages)
                : hf_error(messages, HF_NO_MEMORY, "%s: out of memory", path);
    if (s && *status != HF_OK) {
        hf_store_free(s, messages);
        s = NULL;
    }
    return s;
}

hf_hdf5 *hf_store_enter(hf_store *s, hf_messages *messages)
{
    hf_hdf5_lock();
    s->f.io.messages = messages;
    hf_store_file_open(&s->f);
    return &s->f.io;
}

hf_status hf_store_judge(hf_store *s)
{
    hf_hdf5 *io = &s->f.io;
    if (s->is_resumed && io->status == HF_IO && io->is_damaged)
        io->status = hf_store_fail_damaged(s->f.out.path, io->messages);
    return io->status;
}

hf_status hf_store_hand_over(hf_store *s, hf_store **store)
{
    hf_status status = s->f.io.status;
    if (status == HF_OK)
        *store = s;
    else
        hf_store_free(s, s->f.io.messages);
    return hf_hdf5_unlock(status);
}

void hf_store_put_time(hf_store *s, const char *attribute)
{
    char text[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc)) strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    hf_hdf5_put_chars(&s->f.io, s->f.io.file, "/", attribute, text);
}

void hf_store_put_job(hf_store *s)
{
    static const char *const table[][2] = {{"slurm_job_id", "SLURM_JOB_ID"},
                                           {"slurm_array_job_id", "SLURM_ARRAY_JOB_ID"},
                                           {"slurm_array_task_id", "SLURM_ARRAY_TASK_ID"},
                                           {"slurm_restart_count", "SLURM_RESTART_COUNT"}};
    for (int i = 0; i < HF_HDF5_COUNT(table); i++) {
        const char *value = getenv(table[i][1]);
        if (value) hf_hdf5_put_chars(&s->f.io, s->f.io.file, "/", table[i][0], value);
    }
}

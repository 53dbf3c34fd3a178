#include "store/store_internal.h"

#include "store/store_open.h"

#include <stdlib.h>

hf_status hf_store_hold(hf_store *s, double hold_s, hf_messages *messages)
{
    if (!s) return HF_OK;
    s->f.journal.hold_s = hold_s;
    if (hold_s == 0 && s->f.io.status == HF_OK) s->f.io.status = hf_journal_write(&s->f.journal, messages);
    return s->f.io.status;
}

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

void hf_store_put_refine(hf_store *s, bool finished)
{
    hf_hdf5 *io = &s->f.io;
    if (finished || s->refine) hf_layout_renew(io, io->file, HF_REFINE_STATE);
    if (!s->refine) return;
    hf_hdf5_write_list(io, io->file, HF_REFINE_STATE, HF_KIND_REAL, (int)s->n_refine, 0, "",
                       "state of Levenberg-Marquardt after its last step, from which it can continue", s->refine);
    hf_hdf5_put(io, io->file, HF_REFINE_STATE, "wall_s", HF_KIND_REAL, 0, &s->refine_wall_s);
}

/* Writes and reads the group /coupling: the attachments, the history of the coupling and its results. */
#include "store/layout.h"

#include <stdlib.h>

static void write_nodes(hf_hdf5 *io, hid_t group, const hf_model *m)
{
    const hf_hdf5_array array = {
        "node", HF_KIND_INT, 1, {(hsize_t)m->n_attachment}, "", "each attachment, as an index into /scene/node"};
    int *index = io->status == HF_OK ? malloc((size_t)m->n_attachment * sizeof *index) : NULL;
    if (!index) hf_hdf5_no_memory(io);
    if (!index) return;
    for (int i = 0; i < m->n_attachment; i++)
        index[i] = m->node_of_row[m->attachment_row[i]];
    hf_hdf5_write_array(io, group, &array, index);
    free(index);
}

void hf_layout_write_coupling(hf_hdf5 *io, const hf_model *m, const hf_workspace *w, const hf_coupling_history *h)
{
    static const hf_layout_column history_column[] = {
        {"step_m", HF_KIND_REAL, 0, 1, "m", "largest move of an attachment by the next form-finding",
         offsetof(hf_coupling_history, step_m)},
        {"psi_m", HF_KIND_REAL, 0, 1, "m", "RMS distance of the inner nodes", offsetof(hf_coupling_history, psi_m)},
        {"max_displacement_m", HF_KIND_REAL, 0, 1, "m", "largest displacement of an attachment",
         offsetof(hf_coupling_history, max_displacement_m)}};
    static const hf_layout_column attachment_column[] = {
        {"displacement_m", HF_KIND_REAL, 0, 3, "m", "of each attachment", offsetof(hf_workspace, displacement_m)},
        {"force_N", HF_KIND_REAL, 0, 3, "N", "pull of the net and its loads on each attachment",
         offsetof(hf_workspace, attachment_force_N)}};
    static const hf_layout_columns history = {HF_LAYOUT_COLUMNS(history_column)};
    static const hf_layout_columns attachment = {HF_LAYOUT_COLUMNS(attachment_column)};
    hid_t group = hf_hdf5_make_group(io, "/coupling");
    write_nodes(io, group, m);
    hf_layout_write_columns(io, group, &attachment, m->n_attachment, 0, w);
    hf_hdf5_close(io, group);
    if (!h) return;
    group = hf_hdf5_make_group(io, "/coupling/history");
    hf_layout_write_columns(io, group, &history, h->n, 0, h);
    hf_hdf5_close(io, group);
}

void hf_layout_put_coupling(hf_hdf5 *io, const hf_summary *summary)
{
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/coupling"));
    hf_layout_put_summary(io, HF_LAYOUT_COUPLING, summary);
    if (summary->has_optimize) hf_layout_put_summary(io, HF_LAYOUT_COUPLING_GA, summary);
    if (summary->has_polish) hf_layout_put_summary(io, HF_LAYOUT_COUPLING_REFINE, summary);
}

void hf_layout_get_coupling(hf_hdf5 *io, hf_summary *summary)
{
    hf_layout_get_summary(io, HF_LAYOUT_COUPLING, summary);
    if (summary->has_optimize) hf_layout_get_summary(io, HF_LAYOUT_COUPLING_GA, summary);
    if (summary->has_polish) hf_layout_get_summary(io, HF_LAYOUT_COUPLING_REFINE, summary);
}

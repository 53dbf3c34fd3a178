/* Writes and reads the group /truss. Sections: supports, writing, reading. */
#include "store/store_internal.h"
#include "store/store_read.h"

#include "base/arena.h"

#include <stdio.h>
#include <stdlib.h>

/* ---- supports ---- */

/* Writes or reads "node/fixed": one bit per degree of freedom in memory, one flag per degree of freedom in the file. */
static void pass_fixed(hf_hdf5 *io, bool writes, hid_t group, const hf_truss *t)
{
    signed char *flag = hf_hdf5_take(io, (size_t)t->n_node, HF_TRUSS_DOF);
    if (!flag) return;
    if (!writes) hf_hdf5_read_list(io, group, "node/fixed", HF_KIND_FLAG, t->n_node, HF_TRUSS_DOF, flag);
    for (int k = 0; io->status == HF_OK && k < HF_TRUSS_DOF * t->n_node; k++) {
        if (writes)
            flag[k] = (signed char)(t->fixed[k / HF_TRUSS_DOF] >> k % HF_TRUSS_DOF & 1);
        else
            t->fixed[k / HF_TRUSS_DOF] |= (unsigned char)(flag[k] << k % HF_TRUSS_DOF);
    }
    if (writes)
        hf_hdf5_write_list(io, group, "node/fixed", HF_KIND_FLAG, t->n_node, HF_TRUSS_DOF, "",
                           "held by a support: along x, y, z, about x, y, z", flag);
    free(flag);
}

/* ---- writing ---- */

hid_t hf_layout_make_truss(hf_hdf5 *io, const char *path)
{
    char part[HF_LAYOUT_LOAD_CASE_SIZE + 8];
    hid_t group = hf_hdf5_make_group(io, path);
    for (int i = 0; i < 2; i++) {
        snprintf(part, sizeof part, "%s/%s", path, i ? "member" : "node");
        hf_hdf5_close(io, hf_hdf5_make_group(io, part));
    }
    return group;
}

hf_status hf_store_truss(hf_store *s, const hf_carrier *carrier, const hf_carrier_state *state, hf_messages *messages)
{
    static const hf_layout_column attachment_column[] = {
        {"attachment/net_node", HF_KIND_INT, 0, 1, "", "support of the net, as index from 0 into /scene/node",
         offsetof(hf_carrier, scene_node)},
        {"attachment/truss_node", HF_KIND_INT, 0, 1, "", "truss node that carries it, as index from 0 into /truss/node",
         offsetof(hf_carrier, truss_node)},
        {0}};
    if (!s) return HF_OK;
    const hf_truss *t = &carrier->truss;
    hf_hdf5 *io = hf_store_enter(s, messages);
    hid_t group = hf_layout_make_truss(io, "/truss");
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/truss/attachment"));
    hf_hdf5_write_ids(io, group, "node/id", t->node_id, t->n_node, "name of the node");
    hf_hdf5_write_ids(io, group, "member/id", t->member_id, t->n_member, "name of the member");
    pass_fixed(io, true, group, t);
    hf_layout_pass_columns(io, true, group, hf_layout_truss, t->n_node, t->n_member, t);
    hf_layout_pass_columns(io, true, group, attachment_column, carrier->n_attachment, 0, carrier);
    if (state) hf_layout_pass_columns(io, true, group, hf_layout_truss_state, t->n_node, t->n_member, state);
    hf_hdf5_close(io, group);
    return hf_hdf5_unlock(io->status);
}

/* ---- reading ---- */

void hf_layout_read_truss_state(hf_hdf5 *io, hid_t group, const hf_truss *t, hf_carrier_state *state)
{
    const size_t n_value = HF_TRUSS_DOF * (size_t)t->n_node;
    if (!hf_hdf5_has(io, group, "node/displacement")) return;
    if (HF_ARENA_ARRAYS(&state->block, HF_ARRAY(state->displacement, n_value), HF_ARRAY(state->reaction, n_value),
                        HF_ARRAY(state->end_force, 2 * HF_TRUSS_DOF * (size_t)t->n_member)) != HF_OK)
        hf_hdf5_no_memory(io);
    if (io->status == HF_OK)
        hf_layout_pass_columns(io, false, group, hf_layout_truss_state, t->n_node, t->n_member, state);
}

hf_status hf_store_read_truss(const char *path, hf_truss *t, hf_carrier_state *state, hf_messages *messages)
{
    *t = (hf_truss){0};
    *state = (hf_carrier_state){0};
    hf_hdf5 io = hf_store_open_result(path, messages);
    if (io.status == HF_OK && !hf_hdf5_has(&io, io.file, "/truss") && io.status == HF_OK)
        io.status =
            hf_error(messages, HF_IO, "%s: this result has no truss, because the case has no `truss` section", path);
    if (io.status == HF_OK && !hf_hdf5_has(&io, io.file, "/truss/node") && io.status == HF_OK)
        io.status = hf_error(messages, HF_IO,
                             "%s: this result has no truss yet, because hifdm stores the truss at the end of a run. "
                             "Resume the run first",
                             path);
    hid_t group = hf_hdf5_open_group(&io, "/truss");
    int n_node = hf_hdf5_length(&io, group, "node/mass_kg", HF_LAYOUT_COUNT_MAX);
    int n_member = hf_hdf5_length(&io, group, "member/joint", HF_LAYOUT_COUNT_MAX);
    if (io.status == HF_OK && hf_truss_allocate(t, n_node, n_member, false) != HF_OK) hf_hdf5_no_memory(&io);
    hf_layout_pass_columns(&io, false, group, hf_layout_truss, n_node, n_member, t);
    if (io.status == HF_OK)
        hf_hdf5_read_ids(&io, group, "node/id", n_node, t->node_id, "member/id", n_member, t->member_id, &t->text);
    if (io.status == HF_OK) pass_fixed(&io, false, group, t);
    for (int k = 0; k < 2 * n_member && io.status == HF_OK; k++)
        if (t->end[k] < 0 || t->end[k] >= n_node)
            hf_hdf5_damaged(&io, group, "member/end", "names a node that is not there");
    if (io.status == HF_OK) hf_layout_read_truss_state(&io, group, t, state);
    hf_hdf5_close(&io, group);
    if (hf_store_close_result(&io) != HF_OK) {
        hf_truss_free(t);
        hf_carrier_state_free(state);
    }
    return io.status;
}

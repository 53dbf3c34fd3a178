/* Writes and reads the groups /at_limit/STAGE: the limits that the shape of a stage is at. */
#include "store/layout.h"

#include "base/text.h"

#include <math.h>

enum { N_STAGE = 3, N_COLUMN = 5 };
static const char *const group_of[N_STAGE] = {"/at_limit/form", "/at_limit/optimize", "/at_limit/polish"};

/* Describes the data sets of one shape, and sets value[] to their values in `h`. */
static void list_columns(hf_held_limits *h, hf_hdf5_array array[N_COLUMN], void *value[N_COLUMN])
{
    const hsize_t n = (hsize_t)h->n;
    array[0] = (hf_hdf5_array){"row", HF_KIND_INT, 1, {n}, "", "of optimize.limits; -1: boundary_ratio_cap"};
    array[1] = (hf_hdf5_array){"count", HF_KIND_INT, 1, {n}, "", "cables or attachments of the row at this bound"};
    array[2] = (hf_hdf5_array){"name", HF_KIND_CHARS, 1, {n, HF_HELD_NAME_SIZE}, "", "of one of them"};
    array[3] = (hf_hdf5_array){"value", HF_KIND_REAL, 1, {n}, "", "of this one: N, m, or a ratio"};
    array[4] = (hf_hdf5_array){"bound", HF_KIND_REAL, 1, {n}, "", "the same"};
    void *const to[N_COLUMN] = {h->row, h->count, h->name, h->value, h->bound};
    for (int i = 0; i < N_COLUMN; i++)
        value[i] = to[i];
}

void hf_layout_put_held(hf_hdf5 *io, const hf_summary *summary)
{
    int n = 0;
    for (int stage = 0; stage < N_STAGE; stage++)
        n += summary->held[stage].n;
    hf_layout_renew(io, "/at_limit");
    if (n == 0) return;
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/at_limit"));
    for (int stage = 0; stage < N_STAGE; stage++) {
        hf_held_limits h = summary->held[stage];
        hf_hdf5_array array[N_COLUMN];
        void *value[N_COLUMN];
        if (h.n == 0) continue;
        hid_t group = hf_hdf5_make_group(io, group_of[stage]);
        list_columns(&h, array, value);
        for (int i = 0; i < N_COLUMN; i++)
            hf_hdf5_write_array(io, group, &array[i], value[i]);
        hf_hdf5_close(io, group);
    }
}

/* Returns true if names and indices are valid. Names are printed as they are, so they are trimmed to whole UTF-8
 * characters. */
static bool is_sound(hf_held_limits *h)
{
    bool is_right = true;
    for (int i = 0; i < h->n; i++) {
        h->name[i][HF_HELD_NAME_SIZE - 1] = '\0';
        hf_text_trim_utf8(h->name[i]);
        is_right &= *h->name[i] && h->row[i] >= -1 && h->row[i] < HF_DESIGN_ROWS_MAX && h->count[i] > 0;
    }
    return is_right;
}

void hf_layout_get_held(hf_hdf5 *io, hf_summary *summary)
{
    if (!hf_hdf5_has(io, io->file, "/at_limit")) return;
    for (int stage = 0; stage < N_STAGE; stage++) {
        hf_held_limits *h = &summary->held[stage];
        hf_hdf5_array array[N_COLUMN];
        void *value[N_COLUMN];
        if (!hf_hdf5_has(io, io->file, group_of[stage])) continue;
        hid_t group = hf_hdf5_open_group(io, group_of[stage]);
        h->n = hf_hdf5_length(io, group, "bound", HF_SUMMARY_HELD);
        list_columns(h, array, value);
        for (int i = 0; i < N_COLUMN; i++)
            hf_hdf5_read_array(io, group, &array[i], value[i]);
        if (io->status == HF_OK && !is_sound(h)) hf_hdf5_damaged(io, group, "name", "does not name limits");
        hf_hdf5_close(io, group);
    }
}

/* Writes and reads the groups /set_tension/STAGE: minimum, maximum and ratio of the tensions in the named sets. */
#include "store/layout.h"

#include <string.h>

static const char *const stage_group[3] = {"/set_tension/form", "/set_tension/optimize", "/set_tension/polish"};

enum { N_COLUMN = 3 };

/* Describes the data sets of one shape, and sets value[] to their values in `s`. */
static void columns_of(hf_set_tensions *s, hf_hdf5_array array[N_COLUMN], double *value[N_COLUMN])
{
    static const char *const name[N_COLUMN] = {"least_N", "largest_N", "ratio"};
    static const char *const description[N_COLUMN] = {
        "least tension of each set", "largest tension of each set",
        "the largest over the least; infinite with a slack cable, NaN with a strut"};
    double *const from[N_COLUMN] = {s->least_N, s->largest_N, s->ratio};
    for (int i = 0; i < N_COLUMN; i++) {
        array[i] = (hf_hdf5_array){name[i], HF_KIND_REAL, 1, {(hsize_t)s->n}, i < 2 ? "N" : "", description[i]};
        value[i] = from[i];
    }
}

static hf_hdf5_array names(int n)
{
    return (hf_hdf5_array){"name", HF_KIND_CHARS, 1, {(hsize_t)n, HF_CABLE_SET_NAME_SIZE}, "", "name of the set"};
}

void hf_layout_put_sets(hf_hdf5 *io, const hf_summary *summary)
{
    if (summary->sets[0].n == 0) return;
    hf_layout_renew(io, "/set_tension");
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/set_tension"));
    for (int stage = 0; stage < 3; stage++) {
        hf_set_tensions s = summary->sets[stage];
        hf_hdf5_array array[N_COLUMN], name = names(s.n);
        double *value[N_COLUMN];
        if (s.n == 0) continue;
        hid_t group = hf_hdf5_make_group(io, stage_group[stage]);
        columns_of(&s, array, value);
        hf_hdf5_write_array(io, group, &name, s.name);
        for (int i = 0; i < N_COLUMN; i++)
            hf_hdf5_write_array(io, group, &array[i], value[i]);
        hf_hdf5_close(io, group);
    }
}

/* Returns true if the names are valid and in ascending order. They are printed as they are. */
static bool are_names_right(hf_set_tensions *s)
{
    for (int k = 0; k < s->n; k++) {
        s->name[k][HF_CABLE_SET_NAME_SIZE - 1] = '\0';
        if (hf_cable_set_name_fault(s->name[k]) || (k > 0 && strcmp(s->name[k - 1], s->name[k]) >= 0)) return false;
    }
    return true;
}

void hf_layout_get_sets(hf_hdf5 *io, hf_summary *summary)
{
    if (!hf_hdf5_has(io, io->file, "/set_tension")) return;
    for (int stage = 0; stage < 3; stage++) {
        hf_set_tensions *s = &summary->sets[stage];
        hf_hdf5_array array[N_COLUMN];
        double *value[N_COLUMN];
        if (!hf_hdf5_has(io, io->file, stage_group[stage])) continue;
        hid_t group = hf_hdf5_open_group(io, stage_group[stage]);
        s->n = hf_hdf5_length(io, group, "ratio", HF_SUMMARY_SETS);
        hf_hdf5_array name = names(s->n);
        columns_of(s, array, value);
        hf_hdf5_read_array(io, group, &name, s->name);
        for (int i = 0; i < N_COLUMN; i++)
            hf_hdf5_read_array(io, group, &array[i], value[i]);
        if (io->status == HF_OK && !are_names_right(s))
            hf_hdf5_damaged(io, group, "name", "does not name sets of cables");
        hf_hdf5_close(io, group);
    }
}

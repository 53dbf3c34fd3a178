/* Writes and reads the group /cases: the names and the figures of the load cases. */
#include "store/layout.h"

#include <stdio.h>
#include <string.h>

/* The object is NULL here; figures_of sets it for each load case. */
#define FIGURE(type, member, kind, ...) HF_HDF5_MEMBER(hf_load_case_summary, NULL, #member, result.member, kind)
#define COUPLING(type, member, kind, ...)                                                                              \
    HF_HDF5_MEMBER(hf_load_case_summary, NULL, "coupling_" #member, result.coupling.member, kind)
#define LOAD_CASE(type, member, kind, ...) HF_HDF5_MEMBER(hf_load_case_summary, NULL, #member, member, kind)
static const hf_hdf5_member figure_table[] = {HF_RESULT_LIST(FIGURE) HF_LOAD_CASE_LIST(LOAD_CASE)
                                                  HF_COUPLING_LIST(COUPLING)};
enum { N_FIGURE = HF_HDF5_COUNT(figure_table) };

static hf_hdf5_array name_array(int n)
{
    return (hf_hdf5_array){"name", HF_KIND_CHARS, 1, {(hsize_t)n, HF_SET_NAME_SIZE}, "", "states of the net as built"};
}

static void figures_of(const char *group, hf_hdf5_member table[N_FIGURE])
{
    memcpy(table, figure_table, sizeof figure_table);
    for (int i = 0; i < N_FIGURE; i++)
        table[i].object = group;
}

void hf_layout_put_cases(hf_hdf5 *io, const hf_summary *summary)
{
    if (summary->n_load_case == 0) return;
    const hf_hdf5_array array = name_array(summary->n_load_case);
    char name[HF_LOAD_CASES_MAX][HF_SET_NAME_SIZE] = {{0}}, path[HF_LAYOUT_LOAD_CASE_SIZE];
    hid_t group = hf_hdf5_make_group(io, "/cases");
    for (int k = 0; k < summary->n_load_case; k++)
        memcpy(name[k], summary->load_case[k].name, sizeof name[k]);
    hf_layout_renew(io, "/cases/name");
    hf_hdf5_write_array(io, group, &array, name);
    hf_hdf5_close(io, group);
    for (int k = 0; k < summary->n_load_case; k++) {
        const hf_load_case_summary *s = &summary->load_case[k];
        hf_hdf5_member table[N_FIGURE];
        snprintf(path, sizeof path, "/cases/%s", s->name);
        figures_of(path, table);
        hf_hdf5_close(io, hf_hdf5_make_group(io, path));
        hf_hdf5_put_members(io, table, N_FIGURE, s);
        snprintf(path, sizeof path, "/cases/%s/surface", s->name);
        if (s->measures.is_measured) hf_layout_put_measures(io, path, summary->surface.frequencies_Hz.n, &s->measures);
    }
}

/* Returns true if a name has only harmless characters. Names are printed as they are, and groups have these names. */
static bool is_name_right(const char *name)
{
    static const char *const letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    return *name && !name[strspn(name, letters)];
}

void hf_layout_get_cases(hf_hdf5 *io, hf_summary *summary)
{
    char name[HF_LOAD_CASES_MAX][HF_SET_NAME_SIZE] = {{0}}, path[HF_LAYOUT_LOAD_CASE_SIZE];
    /* An unfinished result has shapes of load cases, but no list of their names yet. */
    if (!hf_hdf5_has(io, io->file, "/cases") || !hf_hdf5_has(io, io->file, "/cases/name")) return;
    hid_t group = hf_hdf5_open_group(io, "/cases");
    int n = hf_hdf5_length(io, group, "name", HF_LOAD_CASES_MAX);
    const hf_hdf5_array array = name_array(n);
    hf_hdf5_read_array(io, group, &array, name);
    hf_hdf5_close(io, group);
    for (int k = 0; k < n && io->status == HF_OK; k++) {
        hf_load_case_summary *s = &summary->load_case[k];
        hf_hdf5_member table[N_FIGURE];
        name[k][HF_SET_NAME_SIZE - 1] = '\0';
        if (!is_name_right(name[k])) {
            hf_hdf5_damaged(io, io->file, "/cases/name", "does not name states");
            return;
        }
        memcpy(s->name, name[k], sizeof s->name);
        snprintf(path, sizeof path, "/cases/%s", s->name);
        figures_of(path, table);
        hf_hdf5_get_members(io, table, N_FIGURE, s);
        snprintf(path, sizeof path, "/cases/%s/surface", s->name);
        hf_layout_get_measures(io, path, summary->surface.frequencies_Hz.n, &s->measures);
    }
    summary->n_load_case = n;
}

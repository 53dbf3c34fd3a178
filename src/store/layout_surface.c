/* Writes and reads the group /surface: the settings and the measures of the surface. */
#include "store/layout.h"

#include <string.h>

/* The object is NULL here; table_of sets it for each stage. */
#define MEASURE(type, member, kind, ...) HF_HDF5_MEMBER(hf_surface_measures, NULL, #member, member, kind)
#define FIT(type, member, kind, ...) HF_HDF5_MEMBER(hf_surface_measures, NULL, "fit_" #member, fit.member, kind)
static const hf_hdf5_member measures_table[] = {HF_SURFACE_LIST(MEASURE) HF_SURFACE_FIT_LIST(FIT)};
#define N_MEASURE HF_HDF5_COUNT(measures_table)

static const hf_hdf5_member settings_table[] = {
    {"/surface", "kind", HF_KIND_SURFACE, offsetof(hf_surface_settings, kind), sizeof(hf_surface_kind)},
    {"/surface", "focal_length_m", HF_KIND_REAL, offsetof(hf_surface_settings, focal_length_m), sizeof(double)},
    {"/surface", "strip_width_m", HF_KIND_REAL, offsetof(hf_surface_settings, strip_width_m), sizeof(double)},
    {"/surface", "mesh_tension_N_per_m", HF_KIND_REAL, offsetof(hf_surface_settings, mesh_tension_N_per_m),
     sizeof(double)}};

static const char *const stage_group[3] = {"/surface/form", "/surface/optimize", "/surface/polish"};

static void table_of(const char *group, hf_hdf5_member table[N_MEASURE])
{
    memcpy(table, measures_table, sizeof measures_table);
    for (int i = 0; i < N_MEASURE; i++)
        table[i].object = group;
}

static hf_hdf5_array losses(const char *name, int n, const char *description)
{
    return (hf_hdf5_array){name, HF_KIND_REAL, 1, {(hsize_t)n}, "dB", description};
}

static hf_hdf5_array frequency_array(int n)
{
    return (hf_hdf5_array){"frequency_Hz", HF_KIND_REAL, 1, {(hsize_t)n}, "Hz", "at which the loss of gain is told"};
}

/* The data sets of the gain losses of a stage, and where hf_surface_measures has their values. */
#define LOSS(member, description) {#member, description, offsetof(hf_surface_measures, member)},
static const struct {
    const char *name, *description;
    size_t offset;
} loss_table[] = {HF_SURFACE_LOSS_LIST(LOSS)};
enum { N_LOSS = sizeof loss_table / sizeof *loss_table };

static double *loss_of(int i, int n, hf_surface_measures *s, hf_hdf5_array *array)
{
    *array = losses(loss_table[i].name, n, loss_table[i].description);
    return (void *)((char *)s + loss_table[i].offset);
}

void hf_layout_put_measures(hf_hdf5 *io, const char *path, int n_frequency, const hf_surface_measures *measures)
{
    hf_surface_measures s = *measures;
    hf_hdf5_member table[N_MEASURE];
    hf_hdf5_array loss;
    table_of(path, table);
    hid_t group = hf_hdf5_make_group(io, path);
    hf_hdf5_put_members(io, table, N_MEASURE, &s);
    for (int i = 0; n_frequency && i < N_LOSS; i++) {
        const double *value = loss_of(i, n_frequency, &s, &loss);
        hf_hdf5_write_array(io, group, &loss, value);
    }
    hf_hdf5_close(io, group);
}

void hf_layout_get_measures(hf_hdf5 *io, const char *path, int n_frequency, hf_surface_measures *s)
{
    hf_hdf5_member table[N_MEASURE];
    hf_hdf5_array loss;
    if (!hf_hdf5_has(io, io->file, path)) return;
    table_of(path, table);
    s->is_measured = true;
    hid_t group = hf_hdf5_open_group(io, path);
    hf_hdf5_get_members(io, table, N_MEASURE, s);
    for (int i = 0; n_frequency && i < N_LOSS; i++) {
        double *value = loss_of(i, n_frequency, s, &loss);
        hf_hdf5_read_array(io, group, &loss, value);
    }
    hf_hdf5_close(io, group);
}

void hf_layout_put_surface(hf_hdf5 *io, const hf_summary *summary)
{
    int n = summary->surface.frequencies_Hz.n;
    if (!(summary->surface.focal_length_m > 0)) return;
    hf_hdf5_array frequency = frequency_array(n);
    hf_layout_renew(io, "/surface");
    hid_t group = hf_hdf5_make_group(io, "/surface");
    hf_hdf5_put_members(io, settings_table, HF_HDF5_COUNT(settings_table), &summary->surface);
    if (n) hf_hdf5_write_array(io, group, &frequency, summary->surface.frequencies_Hz.value);
    hf_hdf5_close(io, group);
    for (int stage = 0; stage < 3; stage++)
        if (summary->measures[stage].is_measured)
            hf_layout_put_measures(io, stage_group[stage], n, &summary->measures[stage]);
}

void hf_layout_get_surface(hf_hdf5 *io, hf_summary *summary)
{
    if (!hf_hdf5_has(io, io->file, "/surface")) return;
    hid_t group = hf_hdf5_open_group(io, "/surface");
    hf_hdf5_get_members(io, settings_table, HF_HDF5_COUNT(settings_table), &summary->surface);
    int n = hf_hdf5_has(io, group, "frequency_Hz") ? hf_hdf5_length(io, group, "frequency_Hz", HF_LIST_MAX) : 0;
    hf_hdf5_array frequency = frequency_array(n);
    if (n) hf_hdf5_read_array(io, group, &frequency, summary->surface.frequencies_Hz.value);
    summary->surface.frequencies_Hz.n = n;
    hf_hdf5_close(io, group);
    for (int stage = 0; stage < 3; stage++)
        hf_layout_get_measures(io, stage_group[stage], n, &summary->measures[stage]);
}

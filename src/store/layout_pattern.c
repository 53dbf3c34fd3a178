/* Writes and reads the groups /pattern/STAGE: the far field, its figures and the feed. */
#include "store/layout.h"

#include <string.h>

static const hf_hdf5_kind kind_of_feed = {HF_HDF5_ENUM, 4, hf_feed_word, NULL};
static const char *const stage_group[3] = {"/pattern/form", "/pattern/optimize", "/pattern/polish"};

#define N_THETA_MOST 1000000 /* maximum number of angles in a file */

/* ---- what stands there ---- */

enum { FREQUENCY, PHI, THETA, CO, CROSS, N_ARRAY };
static hf_hdf5_array array_of(int i, int n_frequency, int n_cut, int n_theta)
{
    const hsize_t f = (hsize_t)n_frequency, c = (hsize_t)n_cut, t = (hsize_t)n_theta;
    const hf_hdf5_array all[N_ARRAY] = {
        {"frequency_Hz", HF_KIND_REAL, 1, {f}, "Hz", ""},
        {"phi_deg", HF_KIND_REAL, 1, {c}, "deg", "of each cut, from +x towards +y"},
        {"theta_deg", HF_KIND_REAL, 1, {t}, "deg", "from +z; below 0 on the other side of +z"},
        {"co_dBi", HF_KIND_REAL, 3, {f, c, t}, "dBi", "gain in the polarisation of the feed (Ludwig 3)"},
        {"cross_dBi", HF_KIND_REAL, 3, {f, c, t}, "dBi", "gain in the polarisation across it"},
    };
    return all[i];
}

static void *values_of(const hf_pattern_table *t, int i)
{
    double *const values[N_ARRAY] = {t->frequency_Hz, t->phi_deg, t->theta_deg, t->co_dBi, t->cross_dBi};
    return values[i];
}

#define FIGURE(member, units, description)                                                                             \
    {                                                                                                                  \
#member, units, description, offsetof(hf_cut_figures, member)                                                  \
    }
static const struct {
    const char *name, *units, *description;
    size_t offset;
} figure_table[] = {
    FIGURE(gain_dBi, "dBi", "highest of the cut"),
    FIGURE(beam_deg, "deg", "theta of it"),
    FIGURE(half_power_width_deg, "deg", "of the beam; NaN where angles do not reach it, as the next two"),
    FIGURE(first_sidelobe_dB, "dB", "the higher one beside the beam, below the beam"),
    FIGURE(highest_sidelobe_dB, "dB", "of all in the cut, below the beam"),
};
#define N_FIGURE HF_HDF5_COUNT(figure_table)

static hf_hdf5_array array_of_figure(int i, int n_frequency, int n_cut)
{
    return (hf_hdf5_array){
        figure_table[i].name,       HF_KIND_REAL, 2, {(hsize_t)n_frequency, (hsize_t)n_cut}, figure_table[i].units,
        figure_table[i].description};
}

/* Copies figure i of n cuts from the structs to a list of numbers (to_list), or back. */
static void move_figure(int i, int n, hf_cut_figures *figure, double *list, bool to_list)
{
    for (int k = 0; k < n; k++) {
        char *member = (char *)&figure[k] + figure_table[i].offset;
        memcpy(to_list ? (char *)&list[k] : member, to_list ? member : (char *)&list[k], sizeof *list);
    }
}

#define MEMBER(name, member)                                                                                           \
    {                                                                                                                  \
        NULL, name, HF_KIND_REAL, offsetof(hf_feed, member), sizeof(double)                                            \
    }
static const hf_hdf5_member feed_table[] = {
    {NULL, "feed", &kind_of_feed, offsetof(hf_feed, kind), sizeof(hf_feed_kind)},
    MEMBER("feed_x_m", position_m[0]),
    MEMBER("feed_y_m", position_m[1]),
    MEMBER("feed_z_m", position_m[2]),
    MEMBER("axis_x", axis[0]),
    MEMBER("axis_y", axis[1]),
    MEMBER("axis_z", axis[2]),
    MEMBER("polarisation_x", co[0]),
    MEMBER("polarisation_y", co[1]),
    MEMBER("polarisation_z", co[2]),
    MEMBER("cos_power", cos_power),
    MEMBER("scale", scale),
};
enum { N_MEMBER = sizeof feed_table / sizeof *feed_table };

static void table_of(const char *group, hf_hdf5_member table[N_MEMBER])
{
    memcpy(table, feed_table, sizeof feed_table);
    for (int i = 0; i < N_MEMBER; i++)
        table[i].object = group;
}

/* ---- writing ---- */

void hf_layout_write_pattern(hf_hdf5 *io, int stage, const hf_pattern_table *t, const hf_pattern_summary *figures)
{
    hf_pattern_summary s = *figures;
    hf_hdf5_member feed[N_MEMBER];
    double list[HF_LIST_MAX * HF_PATTERN_CUTS];
    hf_hdf5_close(io, hf_hdf5_make_group(io, "/pattern"));
    hf_layout_renew(io, stage_group[stage]);
    hid_t group = hf_hdf5_make_group(io, stage_group[stage]);
    table_of(stage_group[stage], feed);
    hf_hdf5_put_members(io, feed, N_MEMBER, &s.feed);
    for (int i = 0; i < N_ARRAY; i++) {
        const hf_hdf5_array array = array_of(i, t->n_frequency, t->n_cut, t->n_theta);
        hf_hdf5_write_array(io, group, &array, values_of(t, i));
    }
    for (int i = 0; i < N_FIGURE; i++) {
        const hf_hdf5_array array = array_of_figure(i, t->n_frequency, t->n_cut);
        move_figure(i, t->n_frequency * t->n_cut, s.figure, list, true);
        hf_hdf5_write_array(io, group, &array, list);
    }
    hf_hdf5_close(io, group);
}

/* ---- reading ---- */

static void get_stage(hf_hdf5 *io, hid_t group, hf_pattern_summary *s)
{
    double list[HF_LIST_MAX * HF_PATTERN_CUTS];
    int f = hf_hdf5_length(io, group, "frequency_Hz", HF_LIST_MAX);
    int c = hf_hdf5_length(io, group, "phi_deg", HF_PATTERN_CUTS);
    const hf_hdf5_array frequency = array_of(FREQUENCY, f, c, 1), phi = array_of(PHI, f, c, 1);
    s->n_frequency = f;
    s->n_cut = c;
    hf_hdf5_read_array(io, group, &frequency, s->frequency_Hz);
    hf_hdf5_read_array(io, group, &phi, s->phi_deg);
    for (int i = 0; i < N_FIGURE; i++) {
        const hf_hdf5_array array = array_of_figure(i, f, c);
        hf_hdf5_read_array(io, group, &array, list);
        if (io->status == HF_OK) move_figure(i, f * c, s->figure, list, false);
    }
}

void hf_layout_get_pattern(hf_hdf5 *io, hf_summary *summary)
{
    hf_hdf5_member feed[N_MEMBER];
    if (io->status != HF_OK || !hf_hdf5_has(io, io->file, "/pattern")) return;
    for (int stage = 0; stage < 3; stage++) {
        if (!hf_hdf5_has(io, io->file, stage_group[stage])) continue;
        hid_t group = hf_hdf5_open_group(io, stage_group[stage]);
        get_stage(io, group, &summary->pattern[stage]);
        table_of(stage_group[stage], feed);
        hf_hdf5_get_members(io, feed, N_MEMBER, &summary->pattern[stage].feed);
        hf_hdf5_close(io, group);
    }
}

void hf_layout_read_pattern(hf_hdf5 *io, int stage, hf_pattern_table *t)
{
    hid_t group = hf_hdf5_open_group(io, stage_group[stage]);
    int f = hf_hdf5_length(io, group, "frequency_Hz", HF_LIST_MAX);
    int c = hf_hdf5_length(io, group, "phi_deg", HF_PATTERN_CUTS);
    int n = hf_hdf5_length(io, group, "theta_deg", N_THETA_MOST);
    if (io->status == HF_OK && hf_pattern_table_create(f, c, n, t) != HF_OK) hf_hdf5_no_memory(io);
    for (int i = 0; i < N_ARRAY && io->status == HF_OK; i++) {
        const hf_hdf5_array array = array_of(i, f, c, n);
        hf_hdf5_read_array(io, group, &array, values_of(t, i));
    }
    hf_hdf5_close(io, group);
}

/* Writes and reads the group /goals: the rows of the objective and their values in each stage. */
#include "store/layout.h"

#include <string.h>

/* The stages whose results have values of objectives, and the names of their data sets. */
enum { N_STAGE = HF_LAYOUT_N_OBJECTIVES_STAGE };
static const char *const stage_name[N_STAGE] = {"form", "optimize", "polish"};

static hf_form_result *objectives_of(hf_summary *s, int stage)
{
    hf_form_result *const result[N_STAGE] = {&s->form, &s->best, &s->polish};
    return result[stage];
}

static bool has_stage(const hf_summary *s, int stage)
{
    return stage == 0 || (stage == 1 ? hf_summary_has_best_shape(s) : s->has_polish);
}

const double *hf_layout_objectives(const hf_summary *s, int stage)
{
    const hf_form_result *const result[N_STAGE] = {&s->form, &s->best, &s->polish};
    return s->objectives.n > 0 && has_stage(s, stage) ? result[stage]->objective : NULL;
}

static hf_hdf5_array names(int n)
{
    return (hf_hdf5_array){"name", HF_KIND_CHARS, 1, {(hsize_t)n, HF_OBJECTIVE_NAME_SIZE}, "", "number, goal and set"};
}

static hf_hdf5_array values(const char *name, int n, const char *description)
{
    return (hf_hdf5_array){name, HF_KIND_REAL, 1, {(hsize_t)n}, "", description};
}

static hf_hdf5_array after_fit(int n)
{
    static const char help[] = "1: of the surface after its best fit, 0: as it stands, -1: not of the surface";
    return (hf_hdf5_array){"after_fit", HF_KIND_INT, 1, {(hsize_t)n}, "", help};
}

void hf_layout_put_objectives(hf_hdf5 *io, const hf_summary *s)
{
    const hf_objective_list *g = &s->objectives;
    if (g->n == 0) return;
    hf_hdf5_array name = names(g->n), weight = values("weight", g->n, "of the value in the merit"),
                  fit = after_fit(g->n);
    hf_layout_renew(io, "/goals");
    hid_t group = hf_hdf5_make_group(io, "/goals");
    hf_hdf5_write_array(io, group, &name, g->name);
    hf_hdf5_write_array(io, group, &fit, g->after_fit);
    if (!g->is_front) hf_hdf5_write_array(io, group, &weight, g->weight);
    for (int stage = 0; stage < N_STAGE; stage++) {
        hf_hdf5_array value = values(stage_name[stage], g->n, "value of each goal, in its own unit");
        if (has_stage(s, stage)) hf_hdf5_write_array(io, group, &value, hf_layout_objectives(s, stage));
    }
    hf_hdf5_close(io, group);
}

/* Returns true if all names have only harmless characters. They are printed as they are. */
static bool are_names_right(hf_objective_list *g)
{
    static const char letters[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    for (int k = 0; k < g->n; k++) {
        g->name[k][HF_OBJECTIVE_NAME_SIZE - 1] = '\0';
        if (!*g->name[k] || g->name[k][strspn(g->name[k], letters)]) return false;
    }
    return true;
}

void hf_layout_get_objectives(hf_hdf5 *io, hf_summary *s)
{
    if (!hf_hdf5_has(io, io->file, "/goals")) return;
    hid_t group = hf_hdf5_open_group(io, "/goals");
    s->objectives.is_front = !hf_hdf5_has(io, group, "weight");
    s->objectives.n = hf_hdf5_length(io, group, s->objectives.is_front ? "name" : "weight", HF_DESIGN_ROWS_MAX);
    hf_hdf5_array name = names(s->objectives.n), weight = values("weight", s->objectives.n, ""),
                  fit = after_fit(s->objectives.n);
    hf_hdf5_read_array(io, group, &name, s->objectives.name);
    for (int k = 0; k < s->objectives.n; k++)
        s->objectives.after_fit[k] = -1; /* files of earlier versions have no such values */
    if (hf_hdf5_has(io, group, "after_fit")) hf_hdf5_read_array(io, group, &fit, s->objectives.after_fit);
    if (!s->objectives.is_front) hf_hdf5_read_array(io, group, &weight, s->objectives.weight);
    for (int stage = 0; stage < N_STAGE; stage++) {
        hf_hdf5_array value = values(stage_name[stage], s->objectives.n, "");
        if (has_stage(s, stage)) hf_hdf5_read_array(io, group, &value, objectives_of(s, stage)->objective);
    }
    if (io->status == HF_OK && !are_names_right(&s->objectives))
        hf_hdf5_damaged(io, group, "name", "does not name goals");
    hf_hdf5_close(io, group);
}

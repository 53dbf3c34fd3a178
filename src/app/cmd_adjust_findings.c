/* Finds what a measured net shows besides its adjustments. cmd_adjust.h describes the interface.
 *
 * Contents: outliers - other aims */
#include "app/cmd_adjust.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- outliers ---- */

#define TOLD 0.05 /* a smaller part is not reported, because it may be rounding */

/* Compares two items for qsort: in descending order of size, and equal ones by their index. */
static int by_size(const void *a, const void *b)
{
    const hf_adjust_sized *p = a, *q = b;
    if (p->size != q->size) return p->size > q->size ? -1 : 1;
    return p->at < q->at ? -1 : p->at > q->at;
}

/* Sorts the n items of the scratch list into `at`, the largest first. */
static void sort(const hf_adjust_job *j, int n, int *at)
{
    qsort(j->sized, (size_t)n, sizeof *j->sized, by_size);
    for (int k = 0; k < n; k++)
        at[k] = j->sized[k].at;
}

double hf_adjust_sigmas(const hf_adjust_job *j, int e)
{
    return j->prior.sigma_m[e] > 0 ? j->estimate.cut_m[e] / j->prior.sigma_m[e] : 0;
}

/* Returns true if nearly all of the error of cable e is shared with its spool, or is that of the temperature. */
static bool is_shared(const hf_adjust_job *j, int e)
{
    return fabs(hf_estimate_own_m(&j->estimate, e)) < TOLD * fabs(j->estimate.cut_m[e]);
}

int hf_adjust_find_places(hf_adjust_job *j)
{
    double most = -1;
    int worst = 0;
    j->n_far = 0;
    for (int row = 0; row < j->built.model.n_node; row++) {
        if (!j->measured.line[row]) continue;
        double off = hf_adjust_off_m(j, row) * sqrt(j->measured.weight_per_m2[3 * row]);
        if (off > HF_ADJUST_OFF) j->sized[j->n_far++] = (hf_adjust_sized){off, row};
        if (off <= most) continue;
        most = off;
        worst = row;
    }
    sort(j, j->n_far, j->far_row);
    return worst;
}

double hf_adjust_off_m(const hf_adjust_job *j, int row)
{
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double d = j->measured.position_m[3 * row + c] - j->estimate.work.position_m[c * j->built.model.n_node + row];
        square += d * d;
    }
    return sqrt(square);
}

hf_status hf_adjust_find_cables(hf_adjust_job *j)
{
    j->n_out = 0;
    for (int e = 0; e < j->built.model.n_cable; e++) {
        double size = fabs(hf_adjust_sigmas(j, e));
        if (size > HF_ADJUST_STANDS_OUT && !is_shared(j, e)) j->sized[j->n_out++] = (hf_adjust_sized){size, e};
    }
    sort(j, j->n_out, j->out);
    HF_TRY(hf_estimate_belief(&j->estimate, j->n_out, j->out, j->by_places_m));
    for (int k = 0; k < j->n_out; k++) {
        double own_m = hf_estimate_own_m(&j->estimate, j->out[k]), part = j->by_places_m[k];
        j->by_places_m[k] = part >= TOLD ? j->estimate.cut_m[j->out[k]] + own_m / part - own_m : (double)NAN;
    }
    return HF_OK;
}

/* ---- other aims ---- */

hf_status hf_adjust_make_objectives(const hf_adjust_job *j, hf_figure_kind figure, hf_objectives *objectives,
                                    hf_messages *messages)
{
    const hf_problem *p = &j->problem;
    hf_optimize_settings wanted = {.n_term = 1};
    wanted.term[0] = (hf_objective_settings){.figure = figure, .weight = 1};
    return hf_objectives_create(&j->built.scene, &j->built.model, &wanted, &p->surface, &p->facets, NULL, objectives,
                                messages);
}

void hf_adjust_take_aim(hf_adjust_job *j, hf_aim aim)
{
    hf_model *m = &j->built.model;
    const double *from = aim == HF_AIM_DESIGN ? j->built.position_m : j->problem.model.position_m;
    for (int c = 0; c < 3; c++)
        memcpy(m->position_m + c * m->n_node, from + c * m->n_node, (size_t)m->n_free * sizeof(double));
}

/* Returns the number of adjustments that reach the range. */
static int count_at_range(const hf_adjustment *a, const hf_adjust_settings *s)
{
    int n = 0;
    for (int k = 0; k < a->n_move; k++)
        n += abs(a->move[k].steps) == hf_adjust_steps(s);
    return n;
}

/* Computes the RMS distance of the inner nodes of the design from their target positions, and of a net with errors from
 * the design. */
static void find_psi_of_design(hf_adjust_job *j)
{
    const hf_model *m = &j->built.model;
    double design = 0, errors = 0;
    for (int k = 0; k < m->n_inner_node; k++) {
        int row = m->inner_row[k];
        for (int c = 0; c < 3; c++) {
            double d = j->built.position_m[c * m->n_node + row] - j->problem.model.position_m[c * m->n_node + row];
            design += d * d;
        }
        errors += j->expected_m[row] * j->expected_m[row];
    }
    j->design_psi_m = m->n_inner_node > 0 ? sqrt(design / m->n_inner_node) : 0;
    j->error_psi_m = m->n_inner_node > 0 ? sqrt(errors / m->n_inner_node) : 0;
}

/* Finds the adjustments for another figure and aim, and stores what they would reach. */
static hf_status try_instead(hf_adjust_job *j, hf_figure_kind figure, hf_aim aim)
{
    hf_messages unwanted = {0};
    hf_adjust_settings settings = *j->task.settings;
    hf_adjust_task task = j->task;
    hf_objectives objectives = {0};
    hf_adjustment found = {0};
    settings.figure = figure;
    settings.aim = aim;
    settings.target_m = 0;
    task.settings = &settings;
    task.objectives = &objectives;
    hf_adjust_take_aim(j, aim);
    hf_status status = hf_adjust_make_objectives(j, figure, &objectives, &unwanted);
    hf_messages_free(&unwanted);
    if (status == HF_OK) status = hf_adjust_find(&j->estimate, &task, &found);
    if (status == HF_OK)
        j->instead[j->n_instead++] = (hf_adjust_instead){
            figure, aim, found.estimated_m, found.adjusted_m, found.n_move, count_at_range(&found, &settings)};
    hf_adjust_free(&found);
    hf_objectives_free(&objectives);
    hf_adjust_take_aim(j, j->task.settings->aim);
    /* An aim without a shape is not offered. */
    return status == HF_INTERRUPTED || status == HF_NO_MEMORY ? status : HF_OK;
}

hf_status hf_adjust_find_instead(hf_adjust_job *j)
{
    const hf_adjust_settings *s = j->task.settings;
    find_psi_of_design(j);
    j->n_at_range = count_at_range(&j->adjustment, s);
    bool has_own_psi = j->design_psi_m > j->error_psi_m, is_far = 2 * j->n_at_range > j->adjustment.n_move;
    bool is_psi = s->figure == HF_FIGURE_PSI;
    if (!is_far && !(has_own_psi && is_psi)) return HF_OK;
    if (!is_psi || s->aim != HF_AIM_DESIGN) HF_TRY(try_instead(j, HF_FIGURE_PSI, HF_AIM_DESIGN));
    if (has_own_psi && !(is_psi && s->aim == HF_AIM_THEORY)) HF_TRY(try_instead(j, HF_FIGURE_PSI, HF_AIM_THEORY));
    if (!is_psi || !j->problem.settings.has_surface) return HF_OK;
    hf_figure_kind figure = j->problem.facets.n_facet > 0 ? HF_FIGURE_FACETS : HF_FIGURE_SURFACE;
    return try_instead(j, figure, HF_AIM_THEORY);
}

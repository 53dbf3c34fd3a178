/* Checks of several keys about the as-built net: adjust, cables, load_cases and tolerance, and the rows of objectives
 * over several nets. */
#include "case/config_check.h"

#include "base/text.h"
#include "net/cable_pick.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *set_fault(const char *sets)
{
    const char *fault = NULL, *rest = *sets ? sets : NULL;
    char set[HF_SET_NAME_SIZE];
    while (rest && !fault) {
        rest = hf_cable_pick_name(rest, set);
        bool is_group = !strcmp(set, hf_group_word[0]) || !strcmp(set, hf_group_word[1]) || !strcmp(set, "all");
        fault = is_group ? NULL : hf_cable_set_name_fault(set);
    }
    return fault;
}

void hf_config_check_set(hf_config_faults *f, const char *list, int row, const char *set)
{
    const char *fault = set_fault(set);
    if (fault) hf_config_fault_in_row(f, list, row, "set", fault);
}

static void check_adjust(const hf_adjust_settings *a, hf_config_faults *f)
{
    const char *fault = set_fault(a->set);
    if (fault) hf_config_fault_of(f, "adjust.set", fault);
    if (a->range_m * (1 + 1e-12) < a->step_m)
        hf_config_fault_of(f, "adjust.range_m", "is smaller than adjust.step_m, which allows no move at all");
    if (a->aim == HF_AIM_DESIGN && a->figure != HF_FIGURE_PSI && hf_config_is_given(f, "adjust.aim"))
        hf_config_fault_of(f, "adjust.aim", "design goes with adjust.figure: psi alone; the others are of the surface");
}

static void check_cables(const hf_case *c, hf_config_faults *f)
{
    const hf_built_settings *b = &c->built;
    for (int i = 0; i < b->n_cable; i++) {
        const hf_cable_settings *row = &b->cable[i];
        if (!hf_config_is_read(c, "cables.%d", i)) continue;
        hf_config_check_set(f, "cables", i, row->set);
        if (isnan(row->expansion_per_K) && isnan(row->mass_kg_per_m))
            hf_config_fault_in_row(f, "cables", i, "set",
                                   "says nothing of these cables; give expansion_per_K, mass_kg_per_m or both");
    }
}

/* ---- load cases ---- */

static const char load_case_list[] = "load_cases";

static bool is_there(const double vector[3])
{
    return !isnan(vector[0]);
}

static bool has_temperature(const hf_load_case_settings *s)
{
    return !isnan(s->temperature_K) || is_there(s->gradient_K_per_m);
}

static void check_name(const hf_load_case_settings *s, int row, hf_config_faults *f)
{
    static const char *const letters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-";
    if (s->name[strspn(s->name, letters)] || *s->name == '-')
        hf_config_fault_in_row(f, load_case_list, row, "name",
                               "must be made of letters, digits, _ and -, and not begin with -");
    /* The result file has the names in /cases/name. In an objective, the others have a meaning of their own. */
    if (!strcmp(s->name, "name") || !strcmp(s->name, "nominal") || !strcmp(s->name, "all"))
        hf_config_fault_in_row(f, load_case_list, row, "name", "must be another word than name, nominal and all");
}

/* Reports keys that have a meaning only together with another key. */
static void check_company(const hf_load_case_settings *s, int row, hf_config_faults *f)
{
    const struct {
        const char *key;
        bool has_company;
        const char *what;
    } use[] = {{"set", has_temperature(s), "has no meaning without temperature_K or gradient_K_per_m"},
               {"part", has_temperature(s), "has no meaning without temperature_K or gradient_K_per_m"},
               {"direction", !isnan(s->gravity_m_per_s2), "has no meaning without gravity_m_per_s2"},
               {"role", is_there(s->force_N), "has no meaning without force_N"}};
    for (size_t k = 0; k < sizeof use / sizeof *use; k++)
        if (!use[k].has_company && hf_config_is_given_in_row(f, load_case_list, row, use[k].key))
            hf_config_fault_in_row(f, load_case_list, row, use[k].key, use[k].what);
    if (*s->set && s->part != HF_PART_ALL)
        hf_config_fault_in_row(f, load_case_list, row, "part", "does not go with set: a row names cables or members");
    if (is_there(s->direction) && s->direction[0] == 0 && s->direction[1] == 0 && s->direction[2] == 0)
        hf_config_fault_in_row(f, load_case_list, row, "direction", "must not be zero");
    if (!has_temperature(s) && isnan(s->gravity_m_per_s2) && !is_there(s->force_N) &&
        !is_there(s->support_displacement_m) && !*s->nodes_path)
        hf_config_fault_in_row(f, load_case_list, row, "name",
                               "this row says nothing; give temperature_K, gradient_K_per_m, gravity_m_per_s2, "
                               "force_N, support_displacement_m or nodes");
}

/* Reports a quantity that two rows of the same load case set. Forces and displacements add up instead. */
static void check_twice(const hf_case *c, int row, hf_config_faults *f)
{
    const hf_built_settings *b = &c->built;
    const hf_load_case_settings *s = &b->load_case[row];
    char what[96];
    for (int i = 0; i < row; i++) {
        const hf_load_case_settings *before = &b->load_case[i];
        if (strcmp(before->name, s->name) != 0 || !hf_config_is_read(c, "%s.%d", load_case_list, i)) continue;
        snprintf(what, sizeof what, "%s.%d has it for this load case already", load_case_list, i);
        if (!isnan(s->gravity_m_per_s2) && !isnan(before->gravity_m_per_s2))
            hf_config_fault_in_row(f, load_case_list, row, "gravity_m_per_s2", what);
        if (has_temperature(s) && has_temperature(before) && s->part == before->part && !strcmp(s->set, before->set))
            hf_config_fault_in_row(f, load_case_list, row,
                                   isnan(s->temperature_K) ? "gradient_K_per_m" : "temperature_K", what);
    }
}

static void check_load_cases(const hf_case *c, hf_config_faults *f)
{
    const hf_built_settings *b = &c->built;
    int n_name = 0;
    for (int i = 0; i < b->n_load_case; i++) {
        int same = 0;
        while (strcmp(b->load_case[same].name, b->load_case[i].name) != 0)
            same++;
        n_name += same == i;
        if (n_name > HF_LOAD_CASES_MAX && same == i)
            hf_config_fault_in_row(f, load_case_list, i, "name", "there are more than 16 load cases");
        if (!hf_config_is_read(c, "%s.%d", load_case_list, i)) continue;
        check_name(&b->load_case[i], i, f);
        hf_config_check_set(f, load_case_list, i, b->load_case[i].set);
        check_company(&b->load_case[i], i, f);
        check_twice(c, i, f);
    }
}

/* Reports an expansion that has no effect, because nothing has a temperature. */
static void check_expansions(const hf_case *c, hf_config_faults *f)
{
    const hf_built_settings *b = &c->built;
    if (!hf_config_is_read(c, "cables") || !hf_config_is_read(c, "load_cases") || !hf_config_is_read(c, "tolerance"))
        return;
    if (c->has_tolerance && hf_tolerance_is_warm(&c->tolerance)) return;
    for (int i = 0; i < b->n_load_case; i++)
        if (has_temperature(&b->load_case[i])) return;
    for (int i = 0; i < b->n_cable; i++)
        if (!isnan(b->cable[i].expansion_per_K))
            hf_config_fault_in_row(f, "cables", i, "expansion_per_K",
                                   "has no effect: no row of load_cases has a temperature");
}

/* ---- tolerance ---- */

static void check_truss_heat(const hf_case *c, hf_config_faults *f)
{
    static const char list[] = "tolerance.truss";
    for (int i = 0; i < c->tolerance.n_truss; i++) {
        if (!c->has_truss && hf_config_is_read(c, "truss"))
            hf_config_fault_in_row(f, list, i, "part", "the case has no truss");
        for (int k = 0; k < i; k++)
            if (c->tolerance.truss[k].part == c->tolerance.truss[i].part)
                hf_config_fault_in_row(f, list, i, "part", "has a row already");
    }
}

/* Returns true if one of n objectives is measured on samples in load cases. */
static bool has_sampled_load_case(const hf_objective_settings *objective, int n)
{
    for (int i = 0; i < n; i++)
        if (objective[i].over == HF_OVER_SAMPLES && *objective[i].load_case) return true;
    return false;
}

/* Reports errors of load cases that no sample has. Samples are only solved in the load cases of rows with a share and
 * of objectives. */
static void check_load_errors(const hf_case *c, hf_config_faults *f)
{
    const struct {
        const char *key;
        double sigma;
    } of[] = {{"tolerance.sigma_load_case_temperature_K", c->tolerance.sigma_load_case_temperature_K},
              {"tolerance.sigma_gravity_ratio", c->tolerance.sigma_gravity_ratio},
              {"tolerance.sigma_force_ratio", c->tolerance.sigma_force_ratio}};
    const hf_optimize_settings *o = &c->optimize;
    if (!hf_config_is_read(c, "requirements")) return;
    if (has_sampled_load_case(o->term, o->n_term) || has_sampled_load_case(o->front, o->n_front)) return;
    for (int i = 0; i < c->n_requirement; i++)
        if (!isnan(c->requirement[i].share) && strcmp(c->requirement[i].load_case, "nominal") != 0) return;
    for (size_t k = 0; k < sizeof of / sizeof *of; k++)
        if (of[k].sigma > 0)
            hf_config_fault_of(
                f, of[k].key,
                "has no effect: no row of `requirements` with a share and no objective over samples has a load_case");
}

static void check_tolerance(const hf_case *c, hf_config_faults *f)
{
    const hf_tolerance_settings *t = &c->tolerance;
    bool knows_expansion = false;
    for (int i = 0; i < c->built.n_cable; i++)
        knows_expansion |= !isnan(c->built.cable[i].expansion_per_K);
    check_truss_heat(c, f);
    check_load_errors(c, f);
    if (t->sigma_cut_m + t->sigma_cut_ratio + t->sigma_EA_ratio + t->sigma_support_m + t->sigma_temperature_K +
                t->sigma_load_case_temperature_K + t->sigma_gravity_ratio + t->sigma_force_ratio ==
            0 &&
        t->n_truss == 0)
        hf_config_fault_of(f, "tolerance.sigma_cut_m",
                           "must be above 0, or another sigma: without errors all is nominal");
    if (hf_tolerance_is_warm(t) && !knows_expansion && hf_config_is_read(c, "cables"))
        hf_config_fault_of(
            f, t->sigma_temperature_K > 0 ? "tolerance.sigma_temperature_K" : "tolerance.sigma_load_case_temperature_K",
            "needs expansion_per_K in a row of `cables`");
    bool has_share = false;
    for (int i = 0; i < c->n_requirement; i++)
        has_share |= !isnan(c->requirement[i].share);
    if (t->find_scale && !has_share && t->n_require == 0 && hf_config_is_read(c, "requirements"))
        hf_config_fault_of(f, "tolerance.find_scale", "needs rows of `requirements` with a share");
    if (t->batch > 0 && t->sigma_cut_ratio + t->sigma_EA_ratio == 0)
        hf_config_fault_of(f, "tolerance.batch", "is about sigma_cut_ratio and sigma_EA_ratio; give one of them");
}

void hf_config_check_built(const hf_case *c, hf_config_faults *f)
{
    if (c->has_adjust && hf_config_is_read(c, "adjust")) check_adjust(&c->adjust, f);
    check_cables(c, f);
    check_load_cases(c, f);
    check_expansions(c, f);
    if (c->has_tolerance && hf_config_is_read(c, "tolerance")) check_tolerance(c, f);
}

/* ---- objectives over load cases and samples ---- */

static void check_load_case(const hf_case *c, const char *list, int row, const hf_objective_settings *g,
                            hf_config_faults *f)
{
    const hf_built_settings *b = &c->built;
    const char *name[HF_LOAD_CASE_ROWS_MAX], *near;
    char what[2 * HF_KEY_SIZE];
    bool is_known = false;
    for (int i = 0; i < b->n_load_case; i++) {
        name[i] = b->load_case[i].name;
        is_known |= !strcmp(name[i], g->load_case);
    }
    if (!hf_config_is_read(c, load_case_list)) return;
    if (b->n_load_case == 0)
        snprintf(what, sizeof what, "needs load cases of the as-built net; add rows to `load_cases`");
    else if (is_known || hf_objective_takes_load_cases(g))
        return;
    else if ((near = hf_text_nearest(g->load_case, name, b->n_load_case)))
        snprintf(what, sizeof what, "is no load case of `load_cases`; did you mean '%s'?", near);
    else
        snprintf(what, sizeof what, "is no load case of `load_cases`, whose first is '%s'", name[0]);
    hf_config_fault_in_row(f, list, row, "load_case", what);
}

static void check_quantile(const hf_optimize_settings *o, const char *list, int row, const hf_objective_settings *g,
                           hf_config_faults *f)
{
    if (!(g->quantile > 0)) return;
    if (g->over != HF_OVER_SAMPLES)
        hf_config_fault_in_row(f, list, row, "quantile", "has a meaning for over: samples alone");
    if (hf_config_is_given_in_row(f, list, row, "take"))
        hf_config_fault_in_row(f, list, row, "quantile", "stands in place of take; remove one of them");
    if (o->method == HF_OPTIMIZE_GA && o->refine == HF_REFINE_TRUE)
        hf_config_fault_in_row(f, list, row, "quantile",
                               "has no derivatives, which optimize.refine: true needs; remove one of them");
}

/* Reports objectives that cannot be part of a front with Levenberg-Marquardt. Such a front keeps limits on the norm of
 * residuals, or on figures of the design itself. */
static void check_objective(const hf_optimize_settings *o, const char *list, int row, const hf_objective_settings *g,
                            hf_config_faults *f)
{
    bool is_largest = g->figure == HF_FIGURE_PULL || g->figure == HF_FIGURE_DEFLECTION || g->figure == HF_FIGURE_RATIO;
    bool is_quantile = g->quantile > 0, is_over_nets = g->over == HF_OVER_SAMPLES || hf_objective_takes_load_cases(g);
    bool is_worst = is_quantile || (is_over_nets && g->take == HF_TAKE_WORST);
    bool is_of_nets = *g->load_case || g->over != HF_OVER_DESIGN;
    if (o->n_front > 0 && o->method != HF_OPTIMIZE_GA && (is_worst || (is_of_nets && is_largest)))
        hf_config_fault_in_row(f, list, row,
                               is_quantile ? "quantile"
                               : is_worst  ? "take"
                                           : "figure",
                               is_quantile ? "needs method: ga in optimize.front"
                               : is_worst  ? "worst needs method: ga in optimize.front"
                                           : "as the maximum over as-built nets needs method: ga in optimize.front");
}

void hf_config_check_nets(const hf_case *c, const char *list, int n_objective, const hf_objective_settings *objective,
                          hf_config_faults *f)
{
    for (int i = 0; i < n_objective; i++) {
        const hf_objective_settings *g = &objective[i];
        if (*g->load_case) check_load_case(c, list, i, g, f);
        if (g->over == HF_OVER_SAMPLES && !c->has_tolerance && hf_config_is_read(c, "tolerance"))
            hf_config_fault_in_row(f, list, i, "over",
                                   "samples needs a section tolerance, which says how large errors are");
        if (g->over == HF_OVER_DESIGN && !hf_objective_takes_load_cases(g) &&
            hf_config_is_given_in_row(f, list, i, "take"))
            hf_config_fault_in_row(f, list, i, "take", "has a meaning for load_case: all and over: samples alone");
        check_quantile(&c->optimize, list, i, g, f);
        check_objective(&c->optimize, list, i, g, f);
    }
}

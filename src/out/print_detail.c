/* Prints a block for each stage of a result, and the phrases that the summary shares. Contents: parts, search,
 * refinement. */
#include "out/print_summary.h"

#include "net/symmetry.h"
#include "store/ledger.h"

#include <math.h>

#define SHOWN_MM 5e-5 /* smaller lengths, in mm, print as 0.0000, so they have no relative change */

/* ---- parts ---- */

static void print_result(const hf_form_result *r, FILE *f)
{
    char slack[40] = "";
    if (r->n_slack) snprintf(slack, sizeof slack, " (%d slack cable%s)", r->n_slack, r->n_slack == 1 ? "" : "s");
    fprintf(f, "                tension ratio %s inside, %s on the boundary%s; maximum nodal residual %.1e N\n",
            hf_print_decimals(r->inner_tension_ratio).text, hf_print_decimals(r->boundary_tension_ratio).text, slack,
            r->residual_N);
}

static void print_sets(const hf_set_tensions *s, FILE *f)
{
    if (!s || s->n == 0) return;
    fputs("                tension ratio of sets:", f);
    for (int k = 0; k < s->n; k++)
        fprintf(f, "%s %s %s", k ? "," : "", s->name[k], hf_print_decimals(s->ratio[k]).text);
    fputc('\n', f);
}

void hf_print_gained(double psi_m, double initial_psi_m, const char *of, FILE *f)
{
    if (!(initial_psi_m * 1e3 >= SHOWN_MM) || !isfinite(initial_psi_m)) return;
    fprintf(f, ", %s %s (%s mm)", hf_print_change(psi_m, initial_psi_m).text, of,
            hf_print_decimals(initial_psi_m * 1e3).text);
}

/* A settled or stalled refinement whose model predicts more than this part of the merit has not followed its model. */
#define REFUTED 1e-4

void hf_print_iterations(const hf_form_result *r, FILE *f)
{
    static const char *const before[] = {
        "", "", "converged after ", "ended by stop: rms_change after ", "not converged after ", "no shape after "};
    bool is_known = r->stop_reason <= HF_STOPPED_ILL_POSED;
    bool is_direct = r->stop_reason == HF_STOPPED_DIRECT;
    fprintf(f, "%s%d %s%s", is_known ? before[r->stop_reason] : "", r->iterations,
            is_direct ? "linear solve" : "iteration", r->iterations == 1 ? "" : "s");
}

void hf_print_generations(const hf_search_summary *s, FILE *f)
{
    static const char *const before[] = {"", "stagnation after ", "", ""};
    fprintf(f, "%s%d generation%s", before[s->algorithm_stop], s->generations, s->generations == 1 ? "" : "s");
}

void hf_print_steps(const hf_refine_summary *r, FILE *f)
{
    static const char *const before[] = {"converged", "stalled", "not converged", "settled", "none"};
    static const char *const why[] = {"", ": shorter steps gain nothing", "", ": the last five gained less than 0.01 %",
                                      ""};
    fprintf(f, "%s after %d step%s%s", before[r->algorithm_stop], r->steps, r->steps == 1 ? "" : "s",
            why[r->algorithm_stop]);
    if (r->algorithm_stop == HF_REFINE_CONVERGED || !isfinite(r->predicted_gain)) return;
    bool is_refuted = r->algorithm_stop != HF_REFINE_MAX_ITERATIONS && r->predicted_gain > REFUTED;
    fprintf(f, "%s the model predicts at most %.3g %% less",
            r->algorithm_stop == HF_REFINE_MAX_ITERATIONS ? ":"
            : is_refuted                                  ? ", although"
                                                          : ",",
            100 * r->predicted_gain);
}

void hf_print_held(const hf_held_limits *h, FILE *f)
{
    if (!h) return;
    char limit[32], more[40];
    for (int i = 0; i < h->n; i++) {
        snprintf(limit, sizeof limit, h->row[i] < 0 ? "boundary_ratio_cap" : "optimize.limits.%d", h->row[i]);
        snprintf(more, sizeof more, " and %d more", h->count[i] - 1);
        hf_print_line(f, "                at a limit (%s): %s%s at %.6g", limit, h->name[i],
                      h->count[i] > 1 ? more : "", h->bound[i]);
    }
}

void hf_print_optima(const hf_summary *s, FILE *f)
{
    const hf_optima *o = s->stage[HF_STAGE_REFINE].optima;
    bool is_psi = s->objectives.n == 0;
    int n_refinement = 0;
    if (!o) return;
    for (int i = 0; i < o->n; i++)
        n_refinement += o->count[i];
    fprintf(f, "                distinct optima:");
    for (int i = 0; i < o->n; i++) {
        fprintf(f, is_psi ? "%s psi %.4f mm" : "%s merit %.6g", i ? "," : "", o->merit[i] * (is_psi ? 1e3 : 1));
        fprintf(f, " (%d of %d refinement%s)", o->count[i], n_refinement, n_refinement == 1 ? "" : "s");
    }
    fputc('\n', f);
}

void hf_print_objective(const char *before, const char *name, double value, bool in_SI, FILE *f)
{
    const char *unit = hf_ledger_objective_unit(name);
    double scale = in_SI ? 1 : hf_print_scale(unit, &unit);
    fprintf(f, "%s%s %.6g%s%s", before, name, scale * value, *unit ? " " : "", unit);
}

void hf_print_objectives(const hf_summary *s, const hf_form_result *r, FILE *f)
{
    if (s->objectives.n == 0 || !isfinite(r->merit))
        return; /* a run that ended before its initial design has no merit */
    if (s->objectives.is_front)
        fputs("                objectives", f);
    else
        fprintf(f, "                merit %.6g from", r->merit);
    for (int k = 0; k < s->objectives.n; k++) {
        hf_print_objective(k ? ", " : " ", s->objectives.name[k], r->objective[k], !s->objectives.is_front, f);
        if (!s->objectives.is_front) fprintf(f, " (weight %g)", s->objectives.weight[k]);
    }
    fputc('\n', f);
}

static void print_certificate(const hf_form_result *r, FILE *f)
{
    if (isfinite(r->position_error_m) && isfinite(r->condition))
        fprintf(f, "                estimated position error %.1e m; condition %.1e; backward error %.1e\n",
                r->position_error_m, r->condition, r->backward_error);
    if (r->bound_reason == HF_BOUND_CERTIFIED)
        fprintf(
            f,
            "                certified: no node is farther than %.1e m from equilibrium; psi is accurate to %.1e m\n",
            r->position_bound_m, r->psi_bound_m);
    else if (r->bound_reason != HF_BOUND_NONE)
        fprintf(f, "                no certified error bound: %s\n", hf_bound_reason_meaning((int)r->bound_reason));
}

static void print_facets(const hf_surface_measures *m, FILE *f)
{
    if (m->n_facet == 0) return;
    if (isnan(m->facet_half_path_rms_m)) {
        fprintf(f, "                %d facets: errors unknown, because the mesh pulls on a slack cable\n", m->n_facet);
        return;
    }
    fprintf(f, "                %d facets: half-path RMS %.4f mm, normal %.4f mm", m->n_facet,
            m->facet_half_path_rms_m * 1e3, m->facet_normal_rms_m * 1e3);
    if (isfinite(m->facet_fit_half_path_rms_m))
        fprintf(f, "; after best fit (f %.4f m) %.4f mm, %.4f mm", m->facet_fit_focal_length_m,
                m->facet_fit_half_path_rms_m * 1e3, m->facet_fit_normal_rms_m * 1e3);
    if (isfinite(m->pillow_rms_m)) fprintf(f, "; pillow %.4f mm RMS", m->pillow_rms_m * 1e3);
    if (m->n_open_face) fprintf(f, "; %d face%s left out", m->n_open_face, m->n_open_face == 1 ? "" : "s");
    fputc('\n', f);
}

/* Prints a gain loss behind these words, if the error from which it follows is known. */
static void print_gain(const char *words, bool is_known, double loss_dB, double limit_Hz, FILE *f)
{
    if (!is_known) return;
    if (isnan(loss_dB))
        fprintf(f, "%sabove %g dB, the limit of Ruze's formula (%.3g GHz)", words, HF_RUZE_MOST_DB, limit_Hz / 1e9);
    else
        fprintf(f, "%s%.3g dB", words, hf_print_loss_dB(loss_dB));
}

/* Prints the figures by physical optics of one feed at frequency k, and beside them the loss by Ruze's formula. */
static void print_feed(const char *words, double gain_dBi, double loss_dB, double rms_m, double ruze_dB, FILE *f)
{
    if (isnan(loss_dB)) return;
    fprintf(f, "                  %s feed: gain %.3f dBi, loss %.3g dB; RMS by illumination %.4f mm", words, gain_dBi,
            hf_print_loss_dB(loss_dB), rms_m * 1e3);
    if (isfinite(ruze_dB)) fprintf(f, ", by Ruze %.3g dB", hf_print_loss_dB(ruze_dB));
}

/* Prints the figures by physical optics at frequency k, if there are any. */
static void print_feeds(const hf_surface_measures *m, int k, FILE *f)
{
    if (isnan(m->fixed_gain_loss_dB[k])) return;
    print_feed("refocused", m->refocused_gain_dBi[k], m->refocused_gain_loss_dB[k], m->refocused_half_path_rms_m,
               m->refocused_ruze_loss_dB[k], f);
    if (isfinite(m->refocused_gain_loss_dB[k])) fputc('\n', f);
    print_feed("fixed", m->fixed_gain_dBi[k], m->fixed_gain_loss_dB[k], m->fixed_half_path_rms_m,
               m->fixed_ruze_loss_dB[k], f);
    if (isfinite(m->pointing_deg[k])) fprintf(f, "; beam off by %.5f deg", m->pointing_deg[k]);
    fputc('\n', f);
}

/* Prints the measures of the surface of a stage, if the case measures the surface. */
static void print_surface(const hf_summary *s, hf_stage stage, FILE *f)
{
    const hf_surface_measures *m = &s->stage[stage].surface;
    if (!m->is_measured) return;
    fprintf(f, "                surface, %s: half-path RMS %.4f mm, normal %.4f mm; ",
            s->surface.kind == HF_SURFACE_PARABOLOID ? "paraboloid" : "parabolic cylinder", m->half_path_rms_m * 1e3,
            m->normal_rms_m * 1e3);
    if (m->fit.converged)
        fprintf(f, "after best fit (f %.4f m) %.4f mm, %.4f mm\n", m->fit.focal_length_m, m->fit.half_path_rms_m * 1e3,
                m->fit.normal_rms_m * 1e3);
    else
        fputs("the best fit did not converge\n", f);
    print_facets(m, f);
    fprintf(f,
            "                deviation of 50/90/95/99 %% of the nodes at most %.3f/%.3f/%.3f/%.3f mm, maximum %.3f mm",
            m->deviation_p50_m * 1e3, m->deviation_p90_m * 1e3, m->deviation_p95_m * 1e3, m->deviation_p99_m * 1e3,
            m->deviation_max_m * 1e3);
    if (isfinite(m->faceting_rms_m)) fprintf(f, "; faceting %.4f mm", m->faceting_rms_m * 1e3);
    fputc('\n', f);
    for (int k = 0; k < s->surface.frequencies_Hz.n; k++) {
        fprintf(f, "                gain loss at %g GHz%s:", s->surface.frequencies_Hz.value[k] / 1e9,
                isfinite(m->fixed_gain_loss_dB[k]) ? ", physical optics" : " by Ruze");
        if (isfinite(m->fixed_gain_loss_dB[k])) {
            fputc('\n', f);
            print_feeds(m, k, f);
            continue;
        }
        print_gain(" ", true, m->gain_loss_dB[k], m->ruze_limit_Hz, f);
        print_gain(", after best fit ", m->fit.converged, m->fit_gain_loss_dB[k], m->fit.ruze_limit_Hz, f);
        /* Facets add an error to that of the nodes, because the mesh is flat between them. */
        print_gain("; of the facets ", isfinite(m->facet_half_path_rms_m), m->facet_gain_loss_dB[k],
                   m->facet_ruze_limit_Hz, f);
        print_gain(", after best fit ", isfinite(m->facet_fit_half_path_rms_m), m->facet_fit_gain_loss_dB[k],
                   m->facet_fit_ruze_limit_Hz, f);
        fputc('\n', f);
    }
}

/* Prints what all stages have, for the design of a stage. */
static void print_design(const hf_summary *s, hf_stage stage, FILE *f)
{
    const hf_stage_summary *of = &s->stage[stage];
    hf_print_held(of->held, f);
    print_sets(of->sets, f);
    hf_print_objectives(s, &of->result, f);
    if (stage != HF_STAGE_REFINE) print_certificate(&of->result, f);
    print_surface(s, stage, f);
}

/* ---- search ---- */

static void print_search(const hf_summary *s, FILE *f)
{
    const hf_stage_summary *stage = &s->stage[HF_STAGE_SEARCH];
    if (stage->result.status != HF_OK) {
        fprintf(f, "  search        no feasible design in %ld evaluations, %s\n", s->search.evaluations,
                hf_print_duration(stage->wall_s).text);
        return;
    }
    fprintf(f, "  search        psi %.4f mm", stage->result.psi_m * 1e3);
    if (s->front)
        fprintf(f, ": the end of the front with the minimum %s", s->objectives.name[0]);
    else if (s->objectives.n > 0 && !s->objectives.is_front &&
             s->stage[HF_STAGE_FORM].result.merit > 0) /* psi is not the objective */
        fprintf(f, ", merit %.6g, %s after form-finding", stage->result.merit,
                hf_print_change(stage->result.merit, s->stage[HF_STAGE_FORM].result.merit).text);
    else /* initial_psi_m is evaluated under the same rule, so only the tensions differ */
        hf_print_gained(stage->result.psi_m, s->search.initial_psi_m, "for the initial design", f);
    fprintf(f, "; found in generation %d\n", s->search.best_generation);
    print_result(&stage->result, f);
    if (s->search.n_at_lower + s->search.n_at_upper > 0)
        fprintf(f, "                %d of %d design variables at their lower bounds, %d at their upper bounds\n",
                s->search.n_at_lower, s->n_variable, s->search.n_at_upper);
    print_design(s, HF_STAGE_SEARCH, f);
    if (s->search.planes)
        fprintf(f, "                symmetry: %s; %d of %d design variables are independent\n",
                hf_symmetry_planes_text(s->search.planes), s->search.n_leader, s->n_variable);
    fputs("                ", f);
    hf_print_generations(&s->search, f);
    fprintf(f, ", %ld evaluations (%ld infeasible)", s->search.evaluations, s->search.infeasible);
    if (!s->finished) { /* other figures are those of the last publication, which may be before the first generation */
        fputs(" so far\n", f);
        return;
    }
    fprintf(f, " by %s\n", hf_solver_word[s->search.solver]);
    fprintf(f, "                %s, %.0f evaluations/s; cpu_s / (wall_s * threads) = %.3f on %d thread%s\n",
            hf_print_duration(stage->wall_s).text, (double)s->search.evaluations / stage->wall_s,
            hf_summary_utilisation(s), s->threads, s->threads == 1 ? "" : "s");
}

/* ---- refinement ---- */

static const char *start_of(const hf_summary *s)
{
    if (!s->stage[HF_STAGE_SEARCH].exists) return "initial design";
    return s->stage[HF_STAGE_SEARCH].result.status == HF_OK ? "best design of the search"
                                                            : "design of the search nearest to the constraints";
}

static void print_refine(const hf_summary *s, FILE *f)
{
    const hf_stage_summary *stage = &s->stage[HF_STAGE_REFINE];
    hf_print_text boundary = hf_print_decimals(stage->result.boundary_tension_ratio);
    char limits[40] = "";
    if (s->taken.point) {
        hf_print_line(f, "  point         psi %.4f mm, boundary ratio %s: point %d of the front in %s",
                      stage->result.psi_m * 1e3, boundary.text, s->taken.point, s->taken.path);
    } else {
        fprintf(f, "  refine        psi %.4f mm, %s; started from the %s; boundary ratio %s; ",
                stage->result.psi_m * 1e3, s->refine.is_result ? "the result" : "no better than the search",
                start_of(s), boundary.text);
        hf_print_steps(&s->refine, f);
        fprintf(f, ", %s\n", hf_print_duration(stage->wall_s).text);
    }
    if (s->refine.n_at_limit) snprintf(limits, sizeof limits, " and %d limits", s->refine.n_at_limit);
    fprintf(f, "                at %d lower bounds and %d upper bounds%s%s\n", s->refine.n_at_lower,
            s->refine.n_at_upper, limits, s->refine.is_at_cap ? " and at boundary_ratio_cap" : "");
    hf_print_optima(s, f);
    print_design(s, HF_STAGE_REFINE, f);
}

void hf_print_details(const hf_summary *s, FILE *f)
{
    const hf_stage_summary *stage = &s->stage[HF_STAGE_FORM];
    fprintf(f, "  form          psi %s mm; ", hf_print_decimals(stage->result.psi_m * 1e3).text);
    hf_print_iterations(&stage->result, f);
    fprintf(f, ", %s; half-bandwidth %d\n", hf_print_duration(stage->wall_s).text, s->half_bandwidth);
    print_result(&stage->result, f);
    print_design(s, HF_STAGE_FORM, f);
    if (s->stage[HF_STAGE_SEARCH].exists) print_search(s, f);
    if (s->stage[HF_STAGE_REFINE].exists) print_refine(s, f);
}

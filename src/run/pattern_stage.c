/* Computes the far field of one shape (METHOD section 13).
 *
 *     positions and tensions -> facets, with the sags of the mesh
 *     feed of the net at the target positions
 *         | each frequency: integral over the facets, by all threads
 *         v
 *     table of co and cross components -> store
 *     gain, width and sidelobes of each cut -> summary */
#include "run/pattern_stage.h"

#include "search/parallel.h"
#include "surface/facet_mesh.h"
#include <hifdm/pattern.h>

#include <stdlib.h>
#include <string.h>

/* The threads and the stop flag of a far field. */
typedef struct {
    int n_thread;
    const volatile sig_atomic_t *stop;
} means;

/* Computes the far field at frequency i into its part of the table. Returns HF_OK, HF_NO_MEMORY or HF_INTERRUPTED. */
static hf_status solve(const hf_problem *p, const hf_pattern_surface *surface, const hf_feed *feed, int i, means by,
                       hf_pattern_table *t)
{
    hf_far_field pattern;
    const hf_pattern_settings *s = &p->surface.pattern;
    const size_t at = (size_t)i * (size_t)(t->n_cut * t->n_theta);
    hf_status status = hf_pattern_create(s, surface, feed, t->frequency_Hz[i], by.n_thread, &pattern);
    pattern.stop = by.stop;
    if (status == HF_OK) {
        hf_parallel_each(by.n_thread, HF_PATTERN_BLOCKS, hf_pattern_sum_block, &pattern);
        if (by.stop && *by.stop) status = HF_INTERRUPTED;
    }
    if (status == HF_OK) {
        hf_pattern_finish(&pattern, t->co_dBi + at, t->cross_dBi + at);
    }
    hf_pattern_free(&pattern);
    return status;
}

/* Warns about cuts without width and sidelobes. The message gives the number of these cuts and the reason for the first
 * one. */
static void doubt(const hf_pattern_settings *s, const hf_pattern_summary *to, hf_stage stage, hf_messages *messages)
{
    int n = 0, first = -1, n_all = to->n_frequency * to->n_cut;
    for (int k = 0; k < n_all; k++)
        if (to->figure[k].doubt && n++ == 0) first = k;
    if (n == 0) return;
    double GHz = to->frequency_Hz[first / to->n_cut] / 1e9, phi_deg = to->phi_deg[first % to->n_cut];
    if (to->figure[first].doubt == HF_CUT_AT_END)
        hf_warning(messages,
                   "surface.pattern: in %d of %d cuts of stage %s, such as phi %g deg at %g GHz, the maximum gain is "
                   "at the end "
                   "of theta_deg: the beam may be outside, and its width and sidelobes are unknown; widen theta_deg",
                   n, n_all, hf_stage_word[stage], phi_deg, GHz);
    else
        hf_warning(messages,
                   "surface.pattern: in %d of %d cuts of stage %s, such as phi %g deg at %g GHz, steps of %.3g deg are "
                   "coarse: fewer than %g steps are within the width of the beam. Its maximum may be missed, and width "
                   "and sidelobes are unknown; raise n_theta, or narrow theta_deg",
                   n, n_all, hf_stage_word[stage], phi_deg, GHz, (s->theta_deg[1] - s->theta_deg[0]) / (s->n_theta - 1),
                   HF_PATTERN_WIDTH_STEPS);
}

static void sum_up(const hf_pattern_settings *s, const hf_pattern_table *t, const hf_feed *feed, hf_pattern_summary *to)
{
    *to = (hf_pattern_summary){.n_frequency = t->n_frequency, .n_cut = t->n_cut, .feed = *feed};
    memcpy(to->frequency_Hz, t->frequency_Hz, (size_t)t->n_frequency * sizeof(double));
    memcpy(to->phi_deg, t->phi_deg, (size_t)t->n_cut * sizeof(double));
    for (int k = 0; k < t->n_frequency * t->n_cut; k++)
        to->figure[k] = hf_pattern_figures(t->n_theta, s->theta_deg, t->co_dBi + (size_t)k * (size_t)t->n_theta);
}

static hf_status solve_all(const hf_problem *p, const hf_pattern_surface *surface, means by, hf_pattern_table *t,
                           hf_pattern_summary *to)
{
    const hf_pattern_settings *s = &p->surface.pattern;
    const hf_double_list *frequencies = &p->surface.frequencies_Hz;
    hf_feed feed;
    HF_TRY(hf_pattern_table_create(frequencies->n, s->phi_deg.n, s->n_theta, t));
    memcpy(t->frequency_Hz, frequencies->value, (size_t)frequencies->n * sizeof(double));
    memcpy(t->phi_deg, s->phi_deg.value, (size_t)s->phi_deg.n * sizeof(double));
    for (int i = 0; i < s->n_theta; i++)
        t->theta_deg[i] = s->theta_deg[0] + (s->theta_deg[1] - s->theta_deg[0]) * i / (s->n_theta - 1);
    hf_feed_make(&p->surface, &p->facets, p->scene.position_m, &feed);
    for (int i = 0; i < frequencies->n; i++)
        HF_TRY(solve(p, surface, &feed, i, by, t));
    sum_up(s, t, &feed, to);
    return HF_OK;
}

hf_status hf_pattern_stage(const hf_problem *p, hf_stage stage, const hf_workspace *w, int n_thread,
                           const volatile sig_atomic_t *stop, hf_store *store, hf_summary *summary,
                           hf_messages *messages)
{
    hf_arena arena = {0}, sags = {0};
    hf_facet_shape shape;
    hf_pattern_table table = {0};
    hf_pattern_summary *to = summary->stage[stage].pattern;
    double pull_ratio = 0, mesh_N_per_m = p->surface.mesh_tension_N_per_m, *sag_m = NULL;
    if (!p->surface.has_pattern) return HF_OK;
    if (n_thread <= 0) n_thread = hf_parallel_cores();
    if (!to) to = summary->stage[stage].pattern = calloc(1, sizeof *to);
    if (!to) return hf_error(messages, HF_NO_MEMORY, "out of memory for the far field");
    hf_status status = hf_facet_shape_take(&p->model, w->position_m, w->tension_N, &shape, &arena);
    if (status == HF_OK && mesh_N_per_m > 0)
        status = hf_facet_mesh_make_sags(mesh_N_per_m, &p->facets, &shape, &sags, &sag_m, &pull_ratio);
    if (status == HF_OK && pull_ratio <= HF_FACET_PULL_MOST) {
        const hf_pattern_surface surface = {&p->facets, shape.position_m, sag_m};
        status = solve_all(p, &surface, (means){n_thread, stop}, &table, to);
    }
    if (status == HF_OK && table.block) doubt(&p->surface.pattern, to, stage, messages);
    if (status == HF_NO_MEMORY) hf_error(messages, status, "out of memory for the far field");
    if (status == HF_OK && table.block) status = hf_store_pattern(store, stage, &table, to, messages);
    hf_pattern_table_free(&table);
    hf_arena_free(&sags);
    hf_arena_free(&arena);
    return status;
}

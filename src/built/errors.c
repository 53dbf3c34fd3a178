/* Turns independent random numbers into the errors of an as-built net, exactly and to first order (METHOD section 12).
 * Contents: making, numbers, errors of a net, first order. */
#include "built/errors.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "base/random.h"

#include <math.h>
#include <string.h>

#define KIND_SHIFT 27 /* bits of an item; enough for three coordinates of each node */

/* ---- making ---- */

static void find_spools(const hf_scene *s, hf_built_errors *e)
{
    e->n_spool = s->n_set + 2; /* the sets, then the two groups */
    for (int i = 0; i < s->n_cable; i++)
        e->spool[i] = s->n_set + s->group[i];
    for (int k = s->n_set - 1; k >= 0; k--)
        for (int i = s->set_start[k]; i < s->set_start[k + 1]; i++)
            e->spool[s->set_cable[i]] = k;
}

hf_status hf_built_errors_make(const hf_built_linear *l, const hf_tolerance_settings *t, const hf_built_heat *heat,
                               hf_built_errors *e)
{
    const hf_scene *s = &l->built->scene;
    const hf_model *m = &l->built->model;
    double own = sqrt(1 - t->batch), shared = sqrt(t->batch);
    const hf_built_heat none = {0};
    if (!heat) heat = &none;
    *e = (hf_built_errors){
        .linear = l,
        .distribution = t->distribution,
        .seed = t->seed,
        .n_truss = heat->truss_move_m_per_K ? t->n_truss : 0,
        .sigma = {t->sigma_cut_m, own * t->sigma_cut_ratio, shared * t->sigma_cut_ratio, own * t->sigma_EA_ratio,
                  shared * t->sigma_EA_ratio, t->sigma_support_m, t->sigma_temperature_K, 1},
        .sigma_load = {t->sigma_load_case_temperature_K, t->sigma_gravity_ratio, t->sigma_force_ratio}};
    HF_TRY(HF_ARENA_ARRAYS(&e->block, HF_ARRAY(e->spool, m->n_cable), HF_ARRAY(e->support, m->n_node - m->n_free),
                           HF_ARRAY(e->expansion_per_K, m->n_cable),
                           HF_ARRAY(e->truss_move_m, 3 * (size_t)e->n_truss * (size_t)m->n_attachment)));
    find_spools(s, e);
    for (int i = 0; i < s->n_node; i++)
        if (s->role[i] == HF_ROLE_SUPPORT) e->support[e->n_support++] = i;
    if (heat->expansion_per_K) memcpy(e->expansion_per_K, heat->expansion_per_K, (size_t)s->n_cable * sizeof(double));
    for (int k = 0, n = 3 * m->n_attachment; k < e->n_truss; k++) {
        e->part[k] = t->truss[k].part;
        for (int i = 0; i < n; i++)
            e->truss_move_m[k * n + i] = t->truss[k].sigma_temperature_K * heat->truss_move_m_per_K[k * n + i];
    }
    const int count[HF_ERROR_N_KIND] = {s->n_cable, s->n_cable,       e->n_spool, s->n_cable,
                                        e->n_spool, 3 * e->n_support, 1,          e->n_truss};
    for (int k = 0; k < HF_ERROR_N_KIND; k++)
        e->first[k + 1] = e->first[k] + (e->sigma[k] > 0 ? count[k] : 0);
    return HF_OK;
}

/* ---- numbers ---- */

unsigned hf_built_errors_vary(const hf_built_errors *e)
{
    bool has_EA = e->sigma[HF_ERROR_EA] > 0 || e->sigma[HF_ERROR_EA_BATCH] > 0;
    return (has_EA ? HF_BUILT_VARIES_EA : 0u) |
           (e->sigma[HF_ERROR_SUPPORT] > 0 || e->n_truss > 0 ? HF_BUILT_VARIES_SUPPORTS : 0u);
}

hf_error_kind hf_built_errors_kind(const hf_built_errors *e, int i_error)
{
    int k = 0;
    while (i_error >= e->first[k + 1])
        k++;
    return (hf_error_kind)k;
}

int hf_built_errors_cable(const hf_built_errors *e, int i_error)
{
    hf_error_kind kind = hf_built_errors_kind(e, i_error);
    bool is_own = kind == HF_ERROR_CUT || kind == HF_ERROR_RATIO || kind == HF_ERROR_EA;
    return is_own ? i_error - e->first[kind] : -1;
}

double hf_built_errors_uniform(uint64_t seed, long sample, int kind, int item)
{
    hf_random stream = hf_random_stream(seed, (int)sample, kind << KIND_SHIFT | item);
    return ((double)(hf_random_next(&stream) >> 12) + 0.5) * 0x1p-52;
}

double hf_built_errors_shape(hf_distribution distribution, double uniform)
{
    static const double root_12 = 3.4641016151377545871;
    return distribution == HF_DISTRIBUTION_UNIFORM ? root_12 * (uniform - 0.5) : hf_normal_quantile(uniform);
}

double hf_built_errors_largest_scale(const hf_built_errors *e)
{
    const hf_built *b = e->linear->built;
    const double *sigma = e->sigma;
    double largest = e->distribution == HF_DISTRIBUTION_UNIFORM ? hf_built_errors_shape(e->distribution, 1) : 6;
    double max = sigma[HF_ERROR_EA] + sigma[HF_ERROR_EA_BATCH];
    for (int i = 0; i < b->model.n_cable; i++)
        max = fmax(max, sigma[HF_ERROR_RATIO] + sigma[HF_ERROR_RATIO_BATCH] + sigma[HF_ERROR_CUT] / b->model.target[i] +
                            fabs(e->expansion_per_K[i]) *
                                (sigma[HF_ERROR_TEMPERATURE] + e->sigma_load[HF_LOAD_ERROR_TEMPERATURE]));
    return 0.5 / (largest * max);
}

/* Returns the item of error i of a kind: 3 node + component for supports, 1 + part for the truss, otherwise i. */
static int item_of(const hf_built_errors *e, int kind, int i)
{
    if (kind == HF_ERROR_TRUSS_TEMPERATURE) return 1 + e->part[i];
    return kind == HF_ERROR_SUPPORT ? 3 * e->support[i / 3] + i % 3 : i;
}

void hf_built_errors_draw(const hf_built_errors *e, long sample, double *z)
{
    for (int kind = 0; kind < HF_ERROR_N_KIND; kind++)
        for (int i = e->first[kind]; i < e->first[kind + 1]; i++) {
            int stream = kind == HF_ERROR_TRUSS_TEMPERATURE ? HF_ERROR_TEMPERATURE : kind;
            double uniform = hf_built_errors_uniform(e->seed, sample, stream, item_of(e, kind, i - e->first[kind]));
            z[i] = hf_built_errors_shape(e->distribution, uniform);
        }
}

double hf_built_errors_of_load(const hf_built_errors *e, long sample, hf_load_error kind, int i_load_case)
{
    double uniform = hf_built_errors_uniform(e->seed, sample, HF_LOAD_ERROR_STREAMS + (int)kind, i_load_case);
    return e->sigma_load[kind] * hf_built_errors_shape(e->distribution, uniform);
}

/* ---- errors of a net ---- */

/* Returns sigma z of item i of a kind, or 0 when the kind has no errors. */
static double error_of(const hf_built_errors *e, hf_error_kind kind, int i, const double *z)
{
    return e->sigma[kind] > 0 ? e->sigma[kind] * z[e->first[kind] + i] : 0;
}

/* Returns the relative error of cable i, its own and that of its spool. */
static double ratio_of(const hf_built_errors *e, hf_error_kind own, hf_error_kind batch, int i, const double *z)
{
    return error_of(e, own, i, z) + error_of(e, batch, e->spool[i], z);
}

/* Returns the displacement by the truss of coordinate i_coordinate = 3 attachment + component, m. */
static double truss_move_of(const hf_built_errors *e, int i_coordinate, const double *z)
{
    int n = 3 * e->linear->built->model.n_attachment;
    double sum = 0;
    for (int k = 0; k < e->n_truss; k++)
        sum += error_of(e, HF_ERROR_TRUSS_TEMPERATURE, k, z) * e->truss_move_m[k * n + i_coordinate];
    return sum;
}

void hf_built_errors_apply(const hf_built_errors *e, double scale, const double *z, double *cut_m, double *EA_N,
                           double *support_displacement_m)
{
    const hf_model *m = &e->linear->built->model;
    double warmer_K = scale * error_of(e, HF_ERROR_TEMPERATURE, 0, z);
    for (int i = 0; i < m->n_cable; i++) {
        cut_m[i] += scale * (cut_m[i] * ratio_of(e, HF_ERROR_RATIO, HF_ERROR_RATIO_BATCH, i, z) +
                             error_of(e, HF_ERROR_CUT, i, z));
        cut_m[i] *= 1 + e->expansion_per_K[i] * warmer_K;
        if (EA_N) EA_N[i] *= 1 + scale * ratio_of(e, HF_ERROR_EA, HF_ERROR_EA_BATCH, i, z);
    }
    for (int k = 0; k < 3 * e->n_support && support_displacement_m && e->sigma[HF_ERROR_SUPPORT] > 0; k++)
        support_displacement_m[k % 3 * m->n_node + m->row_of_node[e->support[k / 3]]] +=
            scale * error_of(e, HF_ERROR_SUPPORT, k, z);
    for (int k = 0; k < 3 * m->n_attachment && support_displacement_m && e->n_truss > 0; k++)
        support_displacement_m[k % 3 * m->n_node + m->attachment_row[k / 3]] += scale * truss_move_of(e, k, z);
}

/* ---- first order ---- */

void hf_built_errors_strain(const hf_built_errors *e, double scale, const double *z, double *strain_N, double *move_m)
{
    const hf_built_linear *l = e->linear;
    const hf_model *m = &l->built->model;
    double warmer_K = error_of(e, HF_ERROR_TEMPERATURE, 0, z);
    for (int i = 0; i < m->n_cable; i++) {
        double longer = ratio_of(e, HF_ERROR_RATIO, HF_ERROR_RATIO_BATCH, i, z) + e->expansion_per_K[i] * warmer_K;
        strain_N[i] = scale * (l->ratio_N[i] * longer + l->cut_N_per_m[i] * error_of(e, HF_ERROR_CUT, i, z) +
                               l->built->tension_N[i] * ratio_of(e, HF_ERROR_EA, HF_ERROR_EA_BATCH, i, z));
    }
    memset(move_m, 0, l->n_dof * sizeof *move_m);
    for (int k = 0; k < 3 * e->n_support && e->sigma[HF_ERROR_SUPPORT] > 0; k++)
        move_m[3 * m->row_of_node[e->support[k / 3]] + k % 3] = scale * error_of(e, HF_ERROR_SUPPORT, k, z);
    for (int k = 0; k < 3 * m->n_attachment && e->n_truss > 0; k++)
        move_m[3 * m->attachment_row[k / 3] + k % 3] += scale * truss_move_of(e, k, z);
}

/* Adds sigma times rate to slope_z of item i of a kind, when the kind has errors. */
static void add_slope(const hf_built_errors *e, hf_error_kind kind, int i, double rate, double *slope_z)
{
    if (e->sigma[kind] > 0) slope_z[e->first[kind] + i] += e->sigma[kind] * rate;
}

void hf_built_errors_slope(const hf_built_errors *e, const double *strain, const double *slope, double *slope_z)
{
    const hf_built_linear *l = e->linear;
    const hf_model *m = &l->built->model;
    memset(slope_z, 0, (size_t)hf_built_errors_count(e) * sizeof *slope_z);
    for (int i = 0; i < m->n_cable; i++) {
        double by_ratio = strain[i] * l->ratio_N[i], by_EA = strain[i] * l->built->tension_N[i];
        add_slope(e, HF_ERROR_CUT, i, strain[i] * l->cut_N_per_m[i], slope_z);
        add_slope(e, HF_ERROR_RATIO, i, by_ratio, slope_z);
        add_slope(e, HF_ERROR_RATIO_BATCH, e->spool[i], by_ratio, slope_z);
        add_slope(e, HF_ERROR_EA, i, by_EA, slope_z);
        add_slope(e, HF_ERROR_EA_BATCH, e->spool[i], by_EA, slope_z);
        add_slope(e, HF_ERROR_TEMPERATURE, 0, by_ratio * e->expansion_per_K[i], slope_z);
    }
    for (int k = 0; k < 3 * e->n_support; k++)
        add_slope(e, HF_ERROR_SUPPORT, k, slope[3 * m->row_of_node[e->support[k / 3]] + k % 3], slope_z);
    for (int k = 0; k < e->n_truss; k++)
        for (int i = 0, n = 3 * m->n_attachment; i < n; i++)
            add_slope(e, HF_ERROR_TRUSS_TEMPERATURE, k,
                      e->truss_move_m[k * n + i] * slope[3 * m->attachment_row[i / 3] + i % 3], slope_z);
}

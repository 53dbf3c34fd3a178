#include "solve/limits.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "net/cable_pick.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* ---- from the rows ---- */

static hf_status read_row(const hf_scene *scene, const hf_model *m, const hf_limit_settings *s, int row, hf_limit *to,
                          hf_messages *messages)
{
    char where[48];
    snprintf(where, sizeof where, "optimize.limits.%d", row);
    to->kind = s->limit;
    to->lower = s->lower;
    to->upper = s->upper;
    if (s->limit == HF_LIMIT_DISPLACEMENT) {
        if (m->n_attachment > 0) return HF_OK;
        return hf_error(messages, HF_BAD_CASE, "%s: displacement needs a truss, whose attachments it limits", where);
    }
    to->n_cable = hf_cable_pick_some(scene, s->set, where, to->cable, messages);
    return to->n_cable ? HF_OK : HF_BAD_CASE;
}

static void lay_out(hf_arena *a, const hf_model *m, hf_limits *l)
{
    l->row = hf_arena_take(a, (size_t)l->n, sizeof *l->row);
    for (int i = 0; i < l->n; i++) {
        int *cable = hf_arena_take(a, (size_t)m->n_cable, sizeof(int));
        if (l->row) l->row[i].cable = cable;
    }
}

hf_status hf_limits_create(const hf_scene *scene, const hf_model *m, const hf_optimize_settings *s, hf_limits *l,
                           hf_messages *messages)
{
    hf_arena arena = {0};
    *l = (hf_limits){.n = s->n_limit};
    if (l->n == 0) return HF_OK;
    if (HF_ARENA_MAKE(&arena, lay_out(&arena, m, l)) != HF_OK) {
        l->n = 0;
        return hf_error(messages, HF_NO_MEMORY, "optimize.limits: out of memory");
    }
    l->block = arena.block;
    for (int i = 0; i < l->n; i++)
        HF_TRY(read_row(scene, m, &s->limit[i], i, &l->row[i], messages));
    return HF_OK;
}

void hf_limits_free(hf_limits *l)
{
    free(l->block);
    *l = (hf_limits){0};
}

/* ---- violations ---- */

double hf_limits_ratio_violation(int n, const int *cable, const double *tension_N, double cap, double slack_N)
{
    double low = INFINITY, high = 0, sum = 0;
    for (int i = 0; i < n; i++) {
        low = fmin(low, tension_N[cable[i]]);
        high = fmax(high, tension_N[cable[i]]);
    }
    if (low >= slack_N && high <= cap * low) return 0;
    double least = sqrt(fmax(low, slack_N) * high / cap), most = cap * least;
    for (int i = 0; i < n; i++) {
        double tension = tension_N[cable[i]];
        if (tension < least) sum += 1 - tension / least;
        if (tension > most) sum += 1 - most / tension;
    }
    return sum > 0 ? sum : 1 - low / slack_N; /* slack, under a cap so large that the rest is within it */
}

#define LIMIT_ROUNDING 1e-9 /* a value so near to its bound, over its unit, is at it */

/* How far a value is outside of the bounds, over what it is measured in. */
static double outside(const hf_limit *row, double value, double unit)
{
    double beyond = fmax(row->lower - value, value - row->upper) / unit;
    return beyond > LIMIT_ROUNDING ? beyond : 0;
}

static double row_violation(const hf_limit *row, const hf_model *m, const hf_workspace *w)
{
    double sum = 0, slack_N = HF_SLACK_RATIO * m->reference_N;
    switch (row->kind) {
    case HF_LIMIT_TENSION:
        for (int i = 0; i < row->n_cable; i++)
            sum += outside(row, w->tension_N[row->cable[i]], m->reference_N);
        break;
    case HF_LIMIT_RATIO:
        return hf_limits_ratio_violation(row->n_cable, row->cable, w->tension_N, row->upper, slack_N);
    case HF_LIMIT_DISPLACEMENT:
        for (int i = 0; i < m->n_attachment; i++) {
            const double *d = w->displacement_m + 3 * i;
            sum += outside(row, hf_norm(d[0], d[1], d[2]), row->upper);
        }
        break;
    }
    return sum;
}

double hf_limits_violation(const hf_limits *l, const hf_model *m, const hf_workspace *w)
{
    double sum = 0;
    for (int i = 0; i < l->n; i++)
        sum += row_violation(&l->row[i], m, w);
    return sum;
}

/* Implements required_radio.h. */
#include "built/required_radio.h"

#include "base/arena.h"
#include "surface/antenna_shape.h"

#include <math.h>

hf_status hf_required_radio_make(hf_required *q, const hf_surface_settings *surface, const hf_facets *facets,
                                 const double *position_m)
{
    hf_status status = HF_OK;
    if (q->n_antenna == 0) return HF_OK;
    HF_TRY(HF_ARENA_ARRAYS(&q->antenna_block, HF_ARRAY(q->antenna, q->n_antenna)));
    q->mesh_tension_N_per_m = surface->mesh_tension_N_per_m;
    for (int k = 0; k < q->n_antenna && status == HF_OK; k++)
        status = hf_antenna_make(surface, facets, position_m, q->frequency_Hz[k], &q->antenna[k]);
    return status;
}

static hf_status take_shape(const hf_required *q, const hf_required_net *net, hf_antenna_shape *shape)
{
    return hf_antenna_shape_take(q->mesh_tension_N_per_m, q->antenna[0].facets, net->model, net->position_m,
                                 net->tension_N, shape);
}

/* Takes a shape and the scratch memory of the antenna that needs most. */
static hf_status begin(const hf_required *q, const hf_required_net *net, hf_antenna_shape *shape, double **scratch,
                       void **block)
{
    size_t most = 0;
    for (int k = 0; k < q->n_antenna; k++)
        if (most < hf_antenna_scratch(&q->antenna[k])) most = hf_antenna_scratch(&q->antenna[k]);
    *block = NULL;
    HF_TRY(take_shape(q, net, shape));
    return HF_ARENA_ARRAYS(block, HF_ARRAY(*scratch, most));
}

hf_status hf_required_radio_near(const hf_required *q, const hf_required_net *net, hf_antenna *near)
{
    hf_antenna_shape shape;
    double *scratch;
    void *block;
    if (q->n_antenna == 0) return HF_OK;
    hf_status status = begin(q, net, &shape, &scratch, &block);
    for (int k = 0; k < q->n_antenna && status == HF_OK; k++) {
        near[k] = q->antenna[k];
        if (shape.exists) status = hf_antenna_near(&q->antenna[k], &shape.surface, scratch, &near[k]);
    }
    hf_arena_free_block(block);
    hf_antenna_shape_free(&shape);
    return status;
}

unsigned hf_required_radio_group(const hf_required_column *c)
{
    if (c->figure == HF_REQUIRED_POINTING) return HF_ANTENNA_POINTING;
    return c->feed == HF_FIXED ? HF_ANTENNA_FIXED : HF_ANTENNA_REFOCUSED;
}

bool hf_required_radio_what(const hf_required *q, bool is_many, int state, unsigned *what)
{
    bool is_any = false;
    for (int k = 0; k < q->n_antenna; k++)
        what[k] = 0;
    for (int k = 0; k < q->n_column; k++) {
        const hf_required_column *c = &q->column[k];
        if (c->antenna < 0 || !((is_many ? c->many : c->nominal) >> state & 1u)) continue;
        what[c->antenna] |= hf_required_radio_group(c);
        is_any = true;
    }
    return is_any;
}

static void keep(unsigned what, const hf_antenna_figures *from, hf_antenna_figures *to)
{
    if (what & HF_ANTENNA_REFOCUSED) to->refocused = from->refocused;
    if (what & HF_ANTENNA_FIXED) to->fixed = from->fixed;
    if (what & HF_ANTENNA_POINTING) to->pointing_deg = from->pointing_deg;
}

hf_status hf_required_radio_measure(const hf_required *q, const hf_antenna *near, const unsigned *what,
                                    const hf_required_net *net, hf_antenna_figures *to)
{
    hf_antenna_shape shape;
    hf_antenna_figures is;
    double *scratch;
    void *block;
    hf_status status = begin(q, net, &shape, &scratch, &block);
    for (int k = 0; k < q->n_antenna && status == HF_OK; k++) {
        if (!what[k]) continue;
        hf_antenna_blank(&is);
        if (shape.exists) status = hf_antenna_measure(&near[k], what[k], &shape.surface, scratch, &is);
        keep(what[k], &is, &to[k]);
    }
    hf_arena_free_block(block);
    hf_antenna_shape_free(&shape);
    return status;
}

hf_status hf_required_radio_bound(const hf_required *q, const unsigned *what, const hf_required_net *net,
                                  double bound_m, hf_antenna_figures *to)
{
    hf_antenna_shape shape;
    hf_status status = take_shape(q, net, &shape);
    for (int k = 0; k < q->n_antenna && status == HF_OK; k++) {
        hf_antenna_blank(&to[k]);
        if (what[k] && shape.exists && isfinite(bound_m))
            status = hf_antenna_bound(&q->antenna[k], what[k], &shape.surface, bound_m, &to[k]);
    }
    hf_antenna_shape_free(&shape);
    return status;
}

double hf_required_radio_of(const hf_required_column *c, const hf_antenna_figures *figures)
{
    if (!figures) return (double)NAN;
    const hf_antenna_figures *is = &figures[c->antenna];
    const hf_antenna_feed *feed = c->feed == HF_FIXED ? &is->fixed : &is->refocused;
    return c->figure == HF_REQUIRED_POINTING    ? is->pointing_deg
           : c->figure == HF_REQUIRED_GAIN_LOSS ? feed->gain_loss_dB
                                                : feed->gain_dBi;
}

hf_status hf_required_radio_gradient(const hf_required *q, const hf_required_column *c, const hf_antenna *near,
                                     const hf_required_net *net, double *gradient, bool *exists)
{
    hf_antenna_shape shape;
    const int n_node = net->model->n_node;
    hf_status status = take_shape(q, net, &shape);
    *exists = false;
    if (status == HF_OK && shape.exists)
        status = hf_antenna_gradient(&near[c->antenna], hf_required_radio_group(c), &shape.surface, n_node, gradient,
                                     exists);
    for (int i = 0; i < 3 * n_node && c->figure == HF_REQUIRED_GAIN_LOSS && *exists; i++)
        gradient[i] = -gradient[i]; /* relative to a gain that does not depend on the shape */
    hf_antenna_shape_free(&shape);
    return status;
}

/* Takes a shape of a model as the surface of an antenna. */
#include "surface/antenna_shape.h"

hf_status hf_antenna_shape_take(double mesh_N_per_m, const hf_facets *facets, const hf_model *m,
                                const double *position_m, const double *tension_N, hf_antenna_shape *to)
{
    double pull_ratio = 0, *sag_m = NULL;
    *to = (hf_antenna_shape){0};
    HF_TRY(hf_facet_shape_take(m, position_m, tension_N, &to->shape));
    if (mesh_N_per_m > 0)
        HF_TRY(hf_facet_mesh_make_sags(mesh_N_per_m, facets, &to->shape, &to->sags, &sag_m, &pull_ratio));
    to->exists = pull_ratio <= HF_FACET_PULL_MOST;
    to->surface = (hf_pattern_surface){facets, to->shape.position_m, sag_m};
    return HF_OK;
}

void hf_antenna_shape_free(hf_antenna_shape *s)
{
    hf_arena_free(&s->sags);
    hf_arena_free_block(s->shape.block);
    *s = (hf_antenna_shape){0};
}

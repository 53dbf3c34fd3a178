/* Solves and linearises the as-built nets of a design, for objectives over load cases and samples (METHOD section 7):
 *
 *     cut        shape of the design ---> cut lengths, and the nominal net as starting point
 *     solve      number of a net     ---> its shape and tensions, or none
 *     linearise  number of a net     ---> its shape, and the factor of its Hessian there
 *     follow     change of the design ---> change of the cut lengths ---> change of the shape of the linearised net
 *
 * Contents: working memory of a thread, one net, shapes, derivatives, all nets. */
#include "built/built_nets.h"

#include "base/arena.h"

#include <string.h>

/* ---- working memory of a thread ---- */

typedef struct {
    const hf_built_nets *nets;
    bool is_made; /* false before the first design that could be cut */
    hf_built built;
    hf_built_batch *batch;
    hf_built_loaded loaded[1 + HF_LOAD_CASES_MAX]; /* [n_sample_state] by state, from 1 */
    int state;                                     /* of the samples that are being solved */
    hf_built_linear linear;                        /* the net linearised last; not factored before the first one */
    hf_built_errors errors;                        /* made only with samples */
    hf_workspace design, of_net;                   /* views of a shape; other objects own the arrays */
    hf_objectives_take *take;
    void *context;
    double *cut_m, *EA_N, *move_m, *load_N; /* [n_cable] or [3][n_node] by row, of one net */
    double *z;                              /* [hf_built_errors_count] numbers of a sample */
    /* [n_cable] derivative of the cut length in this net with respect to the cut length of the design. */
    double *stretch;
    double *weight_N_per_m; /* [n_cable][3] weight per unstressed length in a load case */
    bool has_weight;
    double *length_m;     /* [n_cable] lengths in one shape */
    unsigned char *loose; /* [n_node] all 0: each node counts at the position that it has */
    /* [HF_OBJECTIVES_AT_ONCE][...] arguments of hf_built_linear_apply. */
    double *strain_N, *dof_load_N, *dof_move_m, *scratch;
    double *cut_rate;                              /* [n_cable] derivatives of the cut lengths of the design */
    double *rate_m, *rate_N, *rate_displacement_m; /* [HF_OBJECTIVES_AT_ONCE] derivatives of the shape of a net */
    void *block, *more;
} nets_room;

static hf_status open_room(const hf_objectives_nets *as, void **room)
{
    const hf_built_nets *nets = (const void *)as;
    const hf_model *m = nets->model;
    size_t n = (size_t)m->n_cable, n_dof = 3 * (size_t)m->n_node, many = HF_OBJECTIVES_AT_ONCE;
    nets_room r = {.nets = nets}, *kept;
    hf_status status = HF_ARENA_ARRAYS(
        &r.block, HF_ARRAY(kept, 1), HF_ARRAY(r.cut_m, n), HF_ARRAY(r.EA_N, n), HF_ARRAY(r.move_m, n_dof),
        HF_ARRAY(r.load_N, n_dof), HF_ARRAY(r.stretch, n), HF_ARRAY(r.weight_N_per_m, 3 * n), HF_ARRAY(r.length_m, n),
        HF_ARRAY(r.loose, m->n_node), HF_ARRAY(r.strain_N, many * n), HF_ARRAY(r.dof_load_N, many * n_dof),
        HF_ARRAY(r.dof_move_m, many * n_dof), HF_ARRAY(r.scratch, many * hf_built_linear_scratch(m)),
        HF_ARRAY(r.cut_rate, n), HF_ARRAY(r.rate_m, many * n_dof), HF_ARRAY(r.rate_N, many * n),
        HF_ARRAY(r.rate_displacement_m, many * 3 * (size_t)m->n_attachment));
    *room = kept;
    if (status == HF_OK) *kept = r;
    return status;
}

static void close_room(void *room)
{
    nets_room *r = room;
    if (!r) return;
    for (int s = 0; s <= HF_LOAD_CASES_MAX; s++)
        hf_built_loaded_free(&r->loaded[s]);
    hf_built_batch_free(r->batch);
    hf_built_linear_free(&r->linear);
    hf_arena_free_block(r->errors.block);
    hf_built_free(&r->built);
    hf_arena_free_block(r->more);
    hf_arena_free_block(r->block);
}

/* Makes the as-built net, the batch and the errors for the first design. Later designs only renew the net. */
static hf_status make_room_for(nets_room *r, const hf_workspace *w)
{
    const hf_built_nets *nets = r->nets;
    hf_messages messages = {0};
    hf_built_free(&r->built); /* left by an earlier design that could not be cut */
    hf_status status = hf_built_make("", nets->scene, nets->model, nets->form, w, &r->built, &messages);
    hf_messages_free(&messages);
    HF_TRY(status);
    HF_TRY(hf_built_batch_create(&r->built, 1, &r->batch));
    r->linear.built = &r->built;
    if (nets->as.n_sample > 0) {
        HF_TRY(hf_built_errors_make(&r->linear, nets->tolerance, &nets->heat, &r->errors));
        HF_TRY(HF_ARENA_ARRAYS(&r->more, HF_ARRAY(r->z, hf_built_errors_count(&r->errors))));
    }
    r->is_made = true;
    return HF_OK;
}

/* ---- one net ---- */

/* Returns the load case of net i_net, -1 for a sample without load case. *state receives the state of a sample, -1 for
 * the design in a load case. */
static int load_case_of(const hf_built_nets *nets, int i_net, int *state)
{
    *state = i_net < nets->as.n_load_case ? -1 : (i_net - nets->as.n_load_case) / nets->as.n_sample;
    return *state < 0 ? i_net : *state == 0 ? -1 : nets->as.sample_load_case[*state];
}

/* Returns the first net of a state of the samples. */
static int first_of_state(const hf_built_nets *nets, int state)
{
    return nets->as.n_load_case + state * nets->as.n_sample;
}

/* Makes sample i in the state of the room, as an hf_built_sample. */
static void make_sample(void *room, long i, double *cut_m, double *EA_N, double *move_m, double *load_N)
{
    nets_room *r = room;
    hf_built_errors_draw(&r->errors, i, r->z);
    if (r->state == 0)
        hf_built_errors_apply(&r->errors, 1, r->z, cut_m, EA_N, move_m);
    else
        hf_built_loaded_apply(&r->loaded[r->state], &r->errors, 1, i, r->z, cut_m, EA_N, move_m, load_N);
}

static unsigned vary_in(const nets_room *r, int state)
{
    return state == 0 ? hf_built_errors_vary(&r->errors) : hf_built_loaded_vary(&r->loaded[state], &r->errors);
}

/* Sets *net to a load case or a sample, in the arrays of the room. */
static void make_net(nets_room *r, int i_net, hf_built_net *net)
{
    const hf_built_nets *nets = r->nets;
    const hf_model *m = &r->built.model;
    int state, i_load_case = load_case_of(nets, i_net, &state);
    size_t n = (size_t)m->n_cable * sizeof(double);
    if (i_load_case >= 0) {
        const double *move_m = nets->rest.move_m;
        if (move_m) move_m += 3 * (size_t)i_load_case * (size_t)m->n_attachment;
        hf_built_load_case(&r->built, &nets->load_cases->material, &nets->load_cases->load_case[i_load_case], move_m,
                           r->cut_m, r->move_m, r->load_N, net);
        if (state < 0) return;
    } else {
        *net = (hf_built_net){.cut_m = r->cut_m};
        memset(r->move_m, 0, 3 * (size_t)m->n_node * sizeof(double));
    }
    unsigned varies = vary_in(r, state);
    bool moves = varies & HF_BUILT_VARIES_SUPPORTS;
    if (varies & HF_BUILT_VARIES_EA) net->EA_N = r->EA_N;
    if (moves) net->support_displacement_m = r->move_m;
    memcpy(r->cut_m, m->target, n);
    memcpy(r->EA_N, m->EA_N, n);
    r->state = state;
    make_sample(r, i_net - first_of_state(nets, state), r->cut_m, net->EA_N ? r->EA_N : NULL, moves ? r->move_m : NULL,
                varies & HF_BUILT_VARIES_LOADS ? r->load_N : NULL);
}

/* ---- shapes ---- */

/* Returns a view of a shape for objectives.h. All nodes of a net count, loose ones at the positions that they were
 * given, as in the samples of `tolerance`. */
static const hf_workspace *view(nets_room *r, const double *position_m, const double *tension_N,
                                const double *displacement_m)
{
    const hf_model *m = &r->built.model;
    double u[3];
    for (int e = 0; e < m->n_cable; e++)
        r->length_m[e] = hf_newton_matrix_direction(m, position_m, e, u);
    r->of_net = (hf_workspace){.position_m = (double *)(uintptr_t)position_m, /* the view is only read */
                               .tension_N = (double *)(uintptr_t)tension_N,
                               .displacement_m = (double *)(uintptr_t)displacement_m,
                               .length_m = r->length_m,
                               .loose = r->loose};
    return &r->of_net;
}

static void take_from_lane(void *context, long i, const hf_built_shape *s, const hf_form_result *result)
{
    nets_room *r = context;
    bool has_shape = result->status == HF_OK;
    r->take(r->context, first_of_state(r->nets, r->state) + (int)i,
            has_shape ? view(r, s->position_m, s->tension_N, s->displacement_m) : NULL);
}

/* Solves one net. Returns a view of its shape, or NULL when it has none. *whole is the workspace that holds it. */
static const hf_workspace *find_one(nets_room *r, int i_net, const hf_workspace **whole)
{
    hf_built_net net;
    hf_form_result result;
    make_net(r, i_net, &net);
    *whole = hf_built_batch_find(r->batch, &net, &result);
    const hf_workspace *w = *whole;
    return result.status == HF_OK ? view(r, w->position_m, w->tension_N, w->displacement_m) : NULL;
}

static void solve_nets(void *room, int first, int n, hf_objectives_take *take, void *context)
{
    nets_room *r = room;
    const hf_built_nets *nets = r->nets;
    const hf_workspace *whole;
    int i = first, end = first + n;
    for (; i < nets->as.n_load_case && i < end; i++)
        take(context, i, find_one(r, i, &whole));
    r->take = take;
    r->context = context;
    while (i < end) {
        load_case_of(nets, i, &r->state);
        int first_here = first_of_state(nets, r->state), next = first_of_state(nets, r->state + 1);
        if (next > end) next = end;
        hf_built_batch *batch = r->state == 0 ? r->batch : r->loaded[r->state].batch;
        bool has_shape = r->state == 0 || r->loaded[r->state].has_shape;
        if (has_shape)
            hf_built_batch_run(batch, vary_in(r, r->state), i - first_here, next - i, make_sample, take_from_lane, r);
        for (; i < next; i++)
            if (!has_shape) take(context, i, NULL);
    }
}

/* ---- a design ---- */

/* Finds the design in the load case of a state of the samples, and makes or renews the net near which its samples
 * are. */
static hf_status load_state(nets_room *r, int state)
{
    const hf_built_nets *nets = r->nets;
    hf_built_loaded *to = &r->loaded[state];
    hf_messages messages = {0};
    hf_built_loaded_select(nets->load_cases, nets->as.sample_load_case[state], &nets->rest, nets->model->n_attachment,
                           to);
    hf_status status = hf_built_loaded_make(&r->built, r->batch, 1, to, &messages);
    hf_messages_free(&messages);
    return status;
}

/* Cuts the nets for the design in the workspace, as hf_objectives_nets.cut. */
static hf_status cut_for(void *room, const hf_workspace *w)
{
    nets_room *r = room;
    r->design = (hf_workspace){.length_m = w->length_m, .tension_N = w->tension_N};
    if (!r->is_made) {
        HF_TRY(make_room_for(r, w));
    } else {
        HF_TRY(hf_built_renew(r->nets->model, w, &r->built));
        HF_TRY(hf_built_batch_renew(r->batch));
    }
    for (int state = 1; state < r->nets->as.n_sample_state; state++)
        HF_TRY(load_state(r, state));
    return HF_OK;
}

/* ---- derivatives ---- */

/* Sets `stretch` for one net. Its cut lengths are linear functions of those of the design, so the derivatives of a
 * sample are the difference of two values. */
static void find_stretch(nets_room *r, int i_net)
{
    const hf_built_nets *nets = r->nets;
    const hf_model *m = &r->built.model;
    int state, i_load_case = load_case_of(nets, i_net, &state);
    for (int e = 0; e < m->n_cable; e++) {
        r->stretch[e] = 1;
        r->cut_rate[e] = 0;
    }
    if (state >= 0) {
        hf_built_errors_apply(&r->errors, 1, r->z, r->stretch, NULL, NULL);
        hf_built_errors_apply(&r->errors, 1, r->z, r->cut_rate, NULL, NULL);
        for (int e = 0; e < m->n_cable; e++)
            r->stretch[e] -= r->cut_rate[e];
    }
    r->has_weight = false;
    if (i_load_case < 0) return;
    double warmer_K = 0, heavier = 0;
    if (state >= 0) {
        const hf_built_loaded *loaded = &r->loaded[state];
        int i = i_net - first_of_state(nets, state);
        warmer_K = hf_built_loaded_error(loaded, &r->errors, i, HF_LOAD_ERROR_TEMPERATURE);
        heavier = hf_built_loaded_error(loaded, &r->errors, i, HF_LOAD_ERROR_GRAVITY);
    }
    const hf_load_case *load_case = &nets->load_cases->load_case[i_load_case];
    const hf_material *t = &nets->load_cases->material;
    for (int e = 0; e < m->n_cable; e++) {
        double rise_K = load_case->rise_K[e] + warmer_K;
        if (rise_K != 0) r->stretch[e] *= 1 + t->expansion_per_K[e] * rise_K;
    }
    for (int c = 0; c < 3; c++)
        r->has_weight |= load_case->gravity_m_per_s2[c] != 0;
    for (int e = 0; e < 3 * m->n_cable && r->has_weight; e++)
        r->weight_N_per_m[e] = t->mass_kg_per_m[e / 3] * load_case->gravity_m_per_s2[e % 3] * (1 + heavier);
}

/* Solves one net and factors its Hessian, as hf_objectives_nets.linearise. A net without a shape or without stiffness
 * gives HF_NOT_FINITE. */
static hf_status linearise_net(void *room, int i_net, const hf_workspace **shape)
{
    nets_room *r = room;
    const hf_workspace *whole;
    *shape = find_one(r, i_net, &whole);
    if (!*shape) return HF_NOT_FINITE;
    if (!r->linear.block) {
        hf_status status = hf_built_linear_make(&r->built, &r->linear);
        if (status == HF_NO_MEMORY || !r->linear.work.block) return HF_NO_MEMORY;
    }
    hf_status status = hf_built_linear_take(&r->linear, whole);
    if (status != HF_OK) return status == HF_NO_MEMORY ? status : HF_NOT_FINITE;
    find_stretch(r, i_net);
    return HF_OK;
}

/* Sets cut_rate for a change of the design, the derivative of l0 = l/(1 + T/EA) (M32). */
static void follow_cut(nets_room *r, const hf_objectives_rate *by)
{
    const hf_model *m = r->nets->model;
    const double *x = r->built.position_m, *v = by->position_m;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double l = r->design.length_m[e], l0 = r->built.model.target[e], longer = 0;
        for (int c = 0; c < 3; c++, a += m->n_node, b += m->n_node)
            longer += (x[b] - x[a]) * (v[b] - v[a]);
        r->cut_rate[e] = l0 / l * (longer / l - l0 / r->built.model.EA_N[e] * by->tension_N[e]);
    }
}

/* Sets the displacements of the supports where they rest. They follow the design, at attachments less the change of the
 * displacement of the truss. */
static void follow_rest(const nets_room *r, const hf_objectives_rate *by, double *dof_move)
{
    const hf_model *m = r->nets->model;
    for (int row = m->n_free; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            dof_move[3 * row + c] = by->position_m[c * m->n_node + row];
    for (int k = 0; k < m->n_attachment; k++)
        for (int c = 0; c < 3; c++)
            dof_move[3 * m->attachment_row[k] + c] -= by->displacement_m[3 * k + c];
}

/* Sets the change of the loads: the weight of each cable follows its cut length. */
static void follow_weight(const nets_room *r, double *dof_load)
{
    const hf_model *m = r->nets->model;
    memset(dof_load, 0, 3 * (size_t)m->n_node * sizeof *dof_load);
    for (int k = 0; k < 6 * m->n_cable; k++) { /* half of the weight at each end */
        int e = k / 6, row = m->end_row[k / 3];
        dof_load[3 * row + k % 3] += r->weight_N_per_m[3 * e + k % 3] * r->cut_rate[e] / 2;
    }
}

/* Rearranges the solution by coordinate for objectives.h, and sets the displacements of the attachments by the
 * truss. */
static void spread_net(const nets_room *r, int k, double *displacement_m)
{
    const hf_model *m = r->nets->model;
    size_t n_dof = r->linear.n_dof;
    const double *dof_move = r->dof_move_m + (size_t)k * n_dof;
    double *move = r->rate_m + (size_t)k * n_dof;
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            move[c * m->n_node + row] = dof_move[3 * row + c];
    for (int i = 0; i < 3 * m->n_attachment; i++) /* it held the displacement of the resting position */
        displacement_m[i] = dof_move[3 * m->attachment_row[i / 3] + i % 3] - displacement_m[i];
}

/* Turns n changes of the design into those of the net linearised last, as hf_objectives_nets.follow. */
static void follow_net(void *room, int n, const hf_objectives_rate *by, hf_objectives_rate *by_net)
{
    nets_room *r = room;
    const hf_model *m = r->nets->model;
    size_t n_cable = (size_t)m->n_cable, n_dof = r->linear.n_dof, n_attachment = 3 * (size_t)m->n_attachment;
    for (size_t k = 0; k < (size_t)n; k++) {
        double *strain = r->strain_N + k * n_cable, *move = r->dof_move_m + k * n_dof;
        follow_cut(r, &by[k]);
        follow_rest(r, &by[k], move);
        for (size_t e = 0; e < n_cable; e++)
            strain[e] = r->linear.cut_N_per_m[e] * r->stretch[e] * r->cut_rate[e];
        for (size_t i = 0; i < n_attachment; i++)
            r->rate_displacement_m[k * n_attachment + i] = move[3 * (size_t)m->attachment_row[i / 3] + i % 3];
        if (r->has_weight) follow_weight(r, r->dof_load_N + k * n_dof);
    }
    hf_built_linear_apply(&r->linear, NULL, n, r->strain_N, r->has_weight ? r->dof_load_N : NULL, r->dof_move_m,
                          r->scratch);
    for (size_t k = 0; k < (size_t)n; k++) {
        double *tension = r->rate_N + k * n_cable, *displacement = r->rate_displacement_m + k * n_attachment;
        hf_built_linear_tension(&r->linear, r->strain_N + k * n_cable, r->dof_move_m + k * n_dof, tension);
        spread_net(r, (int)k, displacement);
        by_net[k] = (hf_objectives_rate){r->rate_m + k * n_dof, tension, displacement};
    }
}

/* ---- all nets ---- */

void hf_built_nets_make(const hf_scene *scene, const hf_model *model, const hf_form_settings *form,
                        const hf_load_cases *load_cases, const hf_built_rest *rest,
                        const hf_tolerance_settings *tolerance, const hf_built_heat *heat, int n_sample,
                        hf_built_nets *nets)
{
    int n_load_case = load_cases ? load_cases->n : 0;
    *nets = (hf_built_nets){.as = {.n_load_case = n_load_case,
                                   .n_sample = n_sample,
                                   .load_case_name = nets->name,
                                   .open = open_room,
                                   .close = close_room,
                                   .cut = cut_for,
                                   .solve = solve_nets,
                                   .linearise = linearise_net,
                                   .follow = follow_net,
                                   .n_sample_state = 1},
                            .scene = scene,
                            .model = model,
                            .form = form,
                            .load_cases = load_cases,
                            .tolerance = tolerance,
                            .rest = *rest,
                            .heat = *heat};
    for (int i = 0; i < n_load_case; i++)
        nets->name[i] = load_cases->load_case[i].name;
}

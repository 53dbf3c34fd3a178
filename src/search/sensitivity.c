/* Computes the derivatives of the shape of a net by the variables of a design. sensitivity.h describes the interface.
 *
 *     shape -> Newton matrix H, factored -> for each variable: forces -dg/dv -> H dx/dv = -dg/dv
 *     with a truss:               attachments move by (I + F S)^-1 F b -> free nodes follow
 *     with cables of law length:  multipliers in place of stiff springs -> solve again -> iterative refinement
 *     dx/dv -> dT/dv of each cable
 *
 * Contents: layout - forces of variables - first derivatives - tensions - cables of law length - access */
#include "search/sensitivity.h"

#include "linalg/dot.h"
#include "net/symmetry.h"
#include "search/parallel.h"
#include "solve/newton_matrix.h"

#include <string.h>

/* ---- layout ---- */

static void lay_out(hf_arena *arena, hf_sensitivity *to)
{
    const hf_model *m = to->v->model;
    size_t n = (size_t)to->n, n_room = to->v->n_thread > 1 ? (size_t)to->v->n_thread : 1;
    hf_packed_band_lay_out(arena, &to->matrix);
    HF_SENSITIVITY_FIELDS(HF_ARENA_TAKE)
}

/* Returns true if cable e has law length in the designs of this evaluator. `variable` is its design variable, or -1. A
 * cable between two supports does not count, because it moves no node. */
static bool is_rigid(const hf_evaluator *v, int e, int variable)
{
    const hf_model *m = v->model;
    if (m->end_row[2 * e] >= m->n_free && m->end_row[2 * e + 1] >= m->n_free) return false;
    hf_variable_sets sets = variable >= 0 ? hf_evaluate_sets(v, variable) : HF_SETS_START;
    return sets == HF_SETS_LENGTH || (sets == HF_SETS_START && hf_law_has((hf_law)m->law[e], HF_LAW_IS_RIGID));
}

/* Returns the number of supports that design variables move. place_of_row [n_node] receives the index of their first
 * coordinates in `move`, and -1 for all other rows. */
static int place_supports(const hf_model *m, int *place_of_row)
{
    int n = 0;
    for (int row = 0; row < m->n_node; row++)
        place_of_row[row] = -1;
    for (int row = m->n_free; m->moves_supports && row < m->n_node; row++) {
        bool moves = false;
        for (int k = 0; k < m->n_variable; k++)
            moves |= m->variable[k].support_row == row;
        if (moves) place_of_row[row] = 3 * (m->n_free + m->n_attachment + n);
        n += moves;
    }
    return n;
}

/* Numbers the variables, lists the design variable of each cable, the cables of law length, and the coordinates of each
 * row, and counts the last two. */
static void number(hf_sensitivity *s)
{
    const hf_model *m = s->v->model;
    int n = 0;
    for (int k = 0; k < m->n_variable; k++)
        s->class_of_variable[k] = m->variable_leader[k] == k ? n++ : s->class_of_variable[m->variable_leader[k]];
    for (int e = 0; e < m->n_cable; e++)
        s->variable_of_cable[e] = -1;
    for (int k = 0; k < m->n_variable; k++)
        if (m->variable_cable[k] >= 0) s->variable_of_cable[m->variable_cable[k]] = k;
    for (int e = 0; e < m->n_cable; e++) {
        s->rigid_of_cable[e] = is_rigid(s->v, e, s->variable_of_cable[e]) ? s->n_rigid : -1;
        if (s->rigid_of_cable[e] >= 0) s->rigid[s->n_rigid++] = e;
    }
    for (int row = 0; row < m->n_node; row++)
        s->place_of_row[row] = row < m->n_free ? 3 * row : -1;
    for (int i = 0; i < m->n_attachment; i++)
        s->place_of_row[m->attachment_row[i]] = 3 * (m->n_free + i);
    s->n_dof = 3 * ((size_t)m->n_free + (size_t)m->n_attachment + (size_t)place_supports(m, s->base_of_row));
}

hf_status hf_sensitivity_number(const hf_evaluator *v, hf_sensitivity *to)
{
    const hf_model *m = v->model;
    *to = (hf_sensitivity){.v = v};
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_SENSITIVITY_INDICES(HF_ARENA_ITEM)));
    number(to);
    return HF_OK;
}

hf_status hf_sensitivity_create(const hf_evaluator *v, hf_sensitivity *to)
{
    const hf_model *m = v->model;
    HF_TRY(hf_sensitivity_number(v, to));
    to->n = m->n_leader;
    to->matrix = hf_newton_matrix_packed(m);
    to->n_lane = hf_packed_band_rows(&to->matrix) * HF_LANES;
    HF_TRY(HF_ARENA_MAKE(&to->arena, lay_out(&to->arena, to)));
    return m->n_attachment ? hf_schur_create(m, &to->schur) : HF_OK;
}

void hf_sensitivity_free(hf_sensitivity *s)
{
    hf_arena_free(&s->schur.arena);
    hf_arena_free(&s->arena);
    hf_arena_free_block(s->block);
    *s = (hf_sensitivity){0};
}

/* ---- forces of variables ---- */

/* Adds a pull on the first end of cable e, and the opposite on its second end, to the forces on free nodes and on the
 * truss. */
static void add_pull(const hf_model *m, int e, const double pull[3], double *force, double *on_truss)
{
    int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
    for (int c = 0; c < 3; c++) {
        if (a < m->n_free) force[3 * a + c] += pull[c];
        if (b < m->n_free) force[3 * b + c] -= pull[c];
        for (int t = 0; t < m->n_tie; t++)
            if (m->tie[t] / 2 == e) on_truss[3 * m->tie_attachment[t] + c] += m->tie[t] % 2 ? -pull[c] : pull[c];
    }
}

/* Returns the change of the tension of its cable per unit of design variable k, at fixed nodes. */
static double direct_tension(const hf_sensitivity *s, const hf_workspace *w, int k, double length)
{
    int e = s->v->model->variable_cable[k];
    hf_law_cable cable = hf_workspace_cable(s->v->model, w, e);
    hf_variable_sets sets = hf_evaluate_sets(s->v, k);
    if (sets == HF_SETS_DENSITY) return length / hf_evaluate_divisor(s->v, k);
    if (sets == HF_SETS_LENGTH) return -hf_newton_matrix_stiffness(cable, length, w->tension_N[e]);
    if (sets != HF_SETS_CUT) return 1;
    return length > cable.target ? -cable.EA_N * length / (cable.target * cable.target) : 0;
}

/* Adds the forces with which a support pulls on the other ends of its cables, per unit of design variable k. */
static void add_force_of_support(const hf_sensitivity *s, const hf_workspace *w, int k, double *force, double *on_truss)
{
    const hf_model *m = s->v->model;
    const hf_variable *g = &m->variable[k];
    for (int end = 0; end < 2 * m->n_cable; end++) {
        double block[3][3], pull[3];
        if (m->end_row[end] != g->support_row) continue;
        hf_newton_matrix_block(m, w, end / 2, block);
        for (int c = 0; c < 3; c++) {
            pull[c] = block[c][0] * g->direction[0] + block[c][1] * g->direction[1] + block[c][2] * g->direction[2];
            if (end % 2 == 0) pull[c] = -pull[c];
        }
        add_pull(m, end / 2, pull, force, on_truss);
    }
}

/* Adds -dg/dv of design variable k at the shape in the workspace (M11): the change of the forces on nodes and truss per
 * unit of its value. */
static void add_force_of_variable(const hf_sensitivity *s, const hf_workspace *w, int k, double *force,
                                  double *on_truss)
{
    const hf_model *m = s->v->model;
    int e = m->variable_cable[k];
    double pull[3];
    if (e < 0) {
        add_force_of_support(s, w, k, force, on_truss);
        return;
    }
    hf_variable_sets sets = hf_evaluate_sets(s->v, k);
    double length = sets == HF_SETS_DENSITY ? hf_evaluate_divisor(s->v, k) : w->length_m[e], rate = 1;
    if (sets == HF_SETS_LENGTH || sets == HF_SETS_CUT) rate = direct_tension(s, w, k, length);
    rate *= hf_symmetry_weight(m, s->v->initial, k);
    for (int c = 0; c < 3; c++) {
        const double *x = w->position_m + (ptrdiff_t)c * m->n_node;
        pull[c] = (x[m->end_row[2 * e + 1]] - x[m->end_row[2 * e]]) / length * rate;
    }
    add_pull(m, e, pull, force, on_truss);
}

/* ---- first derivatives ---- */

/* A thread solves for a block of HF_LANES variables at a time. The derivatives depend neither on the threads nor on the
 * other variables of the block. */
typedef struct {
    hf_sensitivity *s;
    const hf_workspace *w;
} solved;

/* Returns the number of variables in a block. */
static int lanes_in_block(const hf_sensitivity *s, int i_block)
{
    int left = s->n - HF_LANES * i_block;
    return left < HF_LANES ? left : HF_LANES;
}

/* Solves for the displacements under the forces in `answer`, and adds them to `move`. */
static void follow_block(void *context, int room, int i_block)
{
    hf_sensitivity *s = ((solved *)context)->s;
    size_t n_free = 3 * (size_t)s->v->model->n_free, first = HF_LANES * (size_t)i_block;
    int n = lanes_in_block(s, i_block);
    hf_packed_band_back_solve(&s->matrix, s->lanes + (size_t)room * s->n_lane, n, s->answer + first * n_free, n_free);
    for (size_t k = first; k < first + (size_t)n; k++)
        hf_add(n_free, 1, s->answer + k * n_free, s->move + k * s->n_dof);
}

/* Turns displacements with fixed attachments into those of net and truss together. */
static void let_truss_answer(solved *q, int room, int i_block)
{
    hf_sensitivity *s = q->s;
    const hf_model *m = s->v->model;
    size_t n_free = 3 * (size_t)m->n_free, n_attachment = 3 * (size_t)m->n_attachment;
    size_t first = HF_LANES * (size_t)i_block, n = (size_t)lanes_in_block(s, i_block);
    memset(s->answer + first * n_free, 0, n * n_free * sizeof(double));
    for (size_t k = first; k < first + n; k++) {
        double *free_nodes = s->move + k * s->n_dof, *supports = free_nodes + n_free,
               *pull = s->pull + k * n_attachment;
        hf_schur_pull(m, q->w, hf_newton_matrix_block, free_nodes, pull);
        hf_schur_displace(m, &s->schur, pull, supports);
        hf_schur_push(m, q->w, hf_newton_matrix_block, supports, s->answer + k * n_free);
    }
    follow_block(q, room, i_block);
}

static void solve_block(void *context, int room, int i_block)
{
    hf_sensitivity *s = ((solved *)context)->s;
    size_t first = HF_LANES * (size_t)i_block;
    hf_packed_band_back_solve(&s->matrix, s->lanes + (size_t)room * s->n_lane, lanes_in_block(s, i_block),
                              s->move + first * s->n_dof, s->n_dof);
    if (s->v->model->n_attachment) let_truss_answer(context, room, i_block);
}

/* Calls `work` for all blocks: solve_block to solve for dx/dv, on entry with the forces in `move` and `pull`;
 * follow_block to add the displacements under the forces in `answer`. */
static void do_blocks(hf_sensitivity *s, const hf_workspace *w, void (*work)(void *context, int room, int i_block))
{
    solved q = {s, w};
    hf_parallel_each(s->v->n_thread, (s->n + HF_LANES - 1) / HF_LANES, work, &q);
}

/* Sets `move` and `pull` to the forces of all variables. */
static void add_forces(hf_sensitivity *s, const hf_workspace *w)
{
    const hf_model *m = s->v->model;
    memset(s->pull, 0, 3 * (size_t)s->n * (size_t)m->n_attachment * sizeof(double));
    memset(s->move, 0, (size_t)s->n * s->n_dof * sizeof(double));
    for (int k = 0; k < m->n_variable; k++) {
        size_t i = (size_t)s->class_of_variable[k];
        add_force_of_variable(s, w, k, s->move + i * s->n_dof, s->pull + 3 * i * (size_t)m->n_attachment);
    }
}

/* Adds the displacements of the supports that design variables move. */
static void move_supports(hf_sensitivity *s)
{
    const hf_model *m = s->v->model;
    for (int k = 0; k < m->n_variable && m->moves_supports; k++) {
        if (m->variable[k].support_row < 0) continue;
        double *move =
            s->move + (size_t)s->class_of_variable[k] * s->n_dof + s->base_of_row[m->variable[k].support_row];
        for (int c = 0; c < 3; c++)
            move[c] += m->variable[k].direction[c];
    }
}

/* ---- tensions ---- */

/* Returns component c of dx/dv of a row. */
static double move_of_row(const hf_sensitivity *s, const double *move, int row, int c)
{
    int place = s->place_of_row[row], base = s->base_of_row[row];
    return (place >= 0 ? move[place + c] : 0) + (base >= 0 ? move[base + c] : 0);
}

/* Computes dx/dv of the second end of cable e relative to its first end. */
static void relative_move(const hf_sensitivity *s, int e, const double *move, double relative[3])
{
    const int *end = s->v->model->end_row + 2 * (ptrdiff_t)e;
    for (int c = 0; c < 3; c++)
        relative[c] = move_of_row(s, move, end[1], c) - move_of_row(s, move, end[0], c);
}

/* Returns the direction, stiffness and variable of cable e at the shape in the workspace. */
static hf_strained look_at(const hf_sensitivity *s, const hf_workspace *w, int e)
{
    const hf_model *m = s->v->model;
    hf_strained q = {.class = -1, .rigid = s->rigid_of_cable[e]};
    int variable = s->variable_of_cable[e];
    double length = hf_newton_matrix_direction(m, w->position_m, e, q.unit);
    q.stiffness_N_per_m = hf_newton_matrix_stiffness(hf_workspace_cable(m, w, e), length, w->tension_N[e]);
    if (variable < 0) return q;
    q.direct = direct_tension(s, w, variable, length) * hf_symmetry_weight(m, s->v->initial, variable);
    q.class = s->class_of_variable[variable];
    return q;
}

/* Returns dT/dv of cable e by variable i. */
static double tension_rate(const hf_sensitivity *s, int e, int i)
{
    const hf_strained *q = &s->strained[e];
    double relative[3];
    relative_move(s, e, s->move + (size_t)i * s->n_dof, relative);
    double rate =
        q->stiffness_N_per_m * (q->unit[0] * relative[0] + q->unit[1] * relative[1] + q->unit[2] * relative[2]);
    if (q->class == i) rate += q->direct;
    if (q->rigid >= 0) rate += s->multiplier[(size_t)i * (size_t)s->n_rigid + (size_t)q->rigid];
    return rate;
}

/* ---- cables of law length ---- */

/* Computes the change of the forces on free nodes (`answer`) and truss (`pull`) under the present derivatives, cable by
 * cable. */
static void sum_forces(hf_sensitivity *s, const hf_workspace *w)
{
    const hf_model *m = s->v->model;
    size_t n_free = 3 * (size_t)m->n_free, n_attachment = 3 * (size_t)m->n_attachment, n = (size_t)s->n;
    memset(s->answer, 0, n * n_free * sizeof(double));
    memset(s->pull, 0, n * n_attachment * sizeof(double));
    for (int e = 0; e < m->n_cable; e++) {
        const double *u = s->strained[e].unit;
        double density = w->tension_N[e] / w->length_m[e];
        for (size_t i = 0; i < n; i++) {
            double pull[3], rate = tension_rate(s, e, (int)i);
            relative_move(s, e, s->move + i * s->n_dof, pull);
            double along = u[0] * pull[0] + u[1] * pull[1] + u[2] * pull[2];
            for (int c = 0; c < 3; c++)
                pull[c] = rate * u[c] + density * (pull[c] - along * u[c]);
            add_pull(m, e, pull, s->answer + i * n_free, s->pull + i * n_attachment);
        }
    }
}

/* Improves the derivatives by a step of iterative refinement. As a 3 x 3 block of the matrix, a stiff spring loses its
 * transverse stiffness to rounding, which changes `move` by up to 1e-7 of it. Forces that are summed cable by cable do
 * not have this error. One more solve therefore removes the forces that are left on nodes and truss. */
static void refine_iteratively(hf_sensitivity *s, const hf_workspace *w)
{
    const hf_model *m = s->v->model;
    size_t n_free = 3 * (size_t)m->n_free, n_attachment = 3 * (size_t)m->n_attachment;
    sum_forces(s, w);
    do_blocks(s, w, follow_block);
    for (size_t k = 0; k < (size_t)s->n && n_attachment; k++) {
        double *supports = s->move + k * s->n_dof + n_free, *pull = s->pull + k * n_attachment;
        hf_schur_pull(m, w, hf_newton_matrix_block, s->answer + k * n_free, pull);
        hf_schur_flex(m, pull, s->gap);
        hf_subtract(n_attachment, 1, supports, s->gap);
        hf_schur_solve(&s->schur, s->gap);
        hf_add(n_attachment, 1, s->gap, supports);
        memset(s->answer + k * n_free, 0, n_free * sizeof(double));
        hf_schur_push(m, w, hf_newton_matrix_block, s->gap, s->answer + k * n_free);
    }
    if (n_attachment) do_blocks(s, w, follow_block);
}

/* Solves again with the tensions that the stiff springs have found as forces (`multiplier`). The springs then carry
 * almost no force, and hardly stretch. */
static void harden(hf_sensitivity *s, const hf_workspace *w)
{
    const hf_model *m = s->v->model;
    size_t n = (size_t)s->n, n_rigid = (size_t)s->n_rigid;
    for (size_t r = 0; r < n_rigid; r++) {
        for (size_t i = 0; i < n; i++)
            s->multiplier[i * n_rigid + r] = tension_rate(s, s->rigid[r], (int)i);
    }
    add_forces(s, w);
    for (size_t r = 0; r < n_rigid; r++) {
        double u[3];
        hf_newton_matrix_direction(m, w->position_m, s->rigid[r], u);
        for (size_t i = 0; i < n; i++) {
            double rate = s->multiplier[i * n_rigid + r], pull[3] = {rate * u[0], rate * u[1], rate * u[2]};
            add_pull(m, s->rigid[r], pull, s->move + i * s->n_dof, s->pull + 3 * i * (size_t)m->n_attachment);
        }
    }
    do_blocks(s, w, solve_block);
    move_supports(s);
    refine_iteratively(s, w);
}

hf_status hf_sensitivity_find(hf_sensitivity *s, hf_workspace *w)
{
    const hf_model *m = s->v->model;
    HF_TRY(hf_newton_matrix_factor(m, w, NULL));
    if (m->n_attachment) HF_TRY(hf_schur_factor(m, w, hf_newton_matrix_block, &s->schur));
    memset(s->multiplier, 0, (size_t)s->n * (size_t)s->n_rigid * sizeof(double));
    add_forces(s, w);
    hf_packed_band_pack(&s->matrix, w->newton_band);
    do_blocks(s, w, solve_block);
    move_supports(s);
    for (int e = 0; e < m->n_cable; e++)
        s->strained[e] = look_at(s, w, e);
    if (s->n_rigid) harden(s, w);
    return HF_OK;
}

/* ---- access ---- */

void hf_sensitivity_tension(const hf_sensitivity *s, int e, double *rate)
{
    for (int i = 0; i < s->n; i++)
        rate[i] = tension_rate(s, e, i);
}

void hf_sensitivity_spread(const hf_sensitivity *s, int i_class, double *move, double *rate)
{
    const hf_model *m = s->v->model;
    const double *of = s->move + (size_t)i_class * s->n_dof;
    for (int row = 0; row < m->n_node; row++)
        for (int c = 0; c < 3; c++)
            move[c * m->n_node + row] = move_of_row(s, of, row, c);
    for (int e = 0; e < m->n_cable; e++)
        rate[e] = tension_rate(s, e, i_class);
}

const double *hf_sensitivity_follow(const void *sensitivity, int i_class, double *move, double *rate)
{
    hf_sensitivity_spread(sensitivity, i_class, move, rate);
    return hf_sensitivity_displacement(sensitivity, i_class, 0);
}

/* Solves the linear model of an as-built net (METHOD section 12):
 *
 *     apply      errors ---> forces f (push_by_errors) ---> H^-1 f, with the truss by (M24) (answer_forces)
 *                       ---> displacements ---> changes of tension (hf_built_linear_tension)
 *     transpose  derivatives by positions ---> H^-1, with the truss ---> derivatives by errors (pull_errors)
 *
 * H is symmetric, so both directions use the same factor. Contents: making, net and truss under forces, errors to
 * displacements, the transpose. */
#include "built/linear.h"

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "solve/joint.h"
#include <hifdm/formfind.h>

#include <math.h>
#include <string.h>

/* ---- making ---- */

/* Sets all arrays of cable e from the shape in the workspace. */
static void look_at_cable(hf_built_linear *l, int e)
{
    const hf_model *m = &l->built->model;
    double block[3][3], *u = l->unit + 3 * (ptrdiff_t)e, l0 = l->work.target[e];
    double length = hf_newton_matrix_direction(m, l->work.position_m, e, u);
    double k = hf_newton_matrix_stiffness(hf_workspace_cable(m, &l->work, e), length, l->work.tension_N[e]);
    hf_newton_matrix_block(m, &l->work, e, block);
    memcpy(l->block_N_per_m + 9 * (ptrdiff_t)e, block, sizeof block);
    l->stiffness_N_per_m[e] = k;
    l->ratio_N[e] = -k * length;
    l->cut_N_per_m[e] = -k * length / l0;
}

/* Factors the Hessian at the shape in the workspace. Returns HF_OK or HF_SINGULAR. */
static hf_status factor_shape(hf_built_linear *l)
{
    const hf_model *m = &l->built->model;
    const double *spring = NULL;
    double condition;
    l->is_factored = false;
    l->n_factor++;
    for (int e = 0; e < m->n_cable; e++)
        look_at_cable(l, e);
    for (int i = 0; i < m->n_free; i++) { /* loose nodes would make the Hessian singular */
        l->work.spring_N_per_m[i] = l->work.loose[i] ? hf_joint_loose_spring_N_per_m(m) : 0;
        if (l->work.loose[i]) spring = l->work.spring_N_per_m;
    }
    HF_TRY(hf_newton_matrix_factor_blocks(m, &l->work, hf_newton_matrix_block, spring, NULL, &condition));
    if (isinf(condition)) return HF_SINGULAR;
    if (m->n_attachment) HF_TRY(hf_schur_factor(m, &l->work, hf_newton_matrix_block, &l->schur));
    l->is_factored = true;
    return HF_OK;
}

hf_status hf_built_linear_make(const hf_built *b, hf_built_linear *l)
{
    const hf_model *m = &b->model;
    size_t n = (size_t)m->n_cable;
    *l = (hf_built_linear){.built = b, .n_dof = 3 * (size_t)m->n_node, .n_scratch = hf_built_linear_scratch(m)};
    HF_TRY(HF_ARENA_ARRAYS(&l->block, HF_ARRAY(l->unit, 3 * n), HF_ARRAY(l->stiffness_N_per_m, n),
                           HF_ARRAY(l->cut_N_per_m, n), HF_ARRAY(l->ratio_N, n), HF_ARRAY(l->block_N_per_m, 9 * n)));
    HF_TRY(hf_workspace_create(m, &l->work));
    if (m->n_attachment) HF_TRY(hf_schur_create(m, &l->schur));
    hf_form_prepare(m, &l->work);
    memcpy(l->work.position_m, b->position_m, 3 * (size_t)m->n_node * sizeof(double));
    memcpy(l->work.tension_N, b->tension_N, n * sizeof(double));
    return factor_shape(l);
}

/* Returns whether two shapes agree in all arrays that hf_built_linear_take copies. */
static bool is_same_shape(const hf_model *m, const hf_workspace *a, const hf_workspace *b)
{
    size_t by_cable = (size_t)m->n_cable * sizeof(double);
    return memcmp(a->position_m, b->position_m, 3 * (size_t)m->n_node * sizeof(double)) == 0 &&
           memcmp(a->tension_N, b->tension_N, by_cable) == 0 && memcmp(a->target, b->target, by_cable) == 0 &&
           memcmp(a->EA_N, b->EA_N, by_cable) == 0 && memcmp(a->loose, b->loose, (size_t)m->n_node) == 0;
}

hf_status hf_built_linear_take(hf_built_linear *l, const hf_workspace *shape)
{
    const hf_model *m = &l->built->model;
    if (l->is_factored && is_same_shape(m, &l->work, shape)) return HF_OK;
    memcpy(l->work.position_m, shape->position_m, 3 * (size_t)m->n_node * sizeof(double));
    memcpy(l->work.tension_N, shape->tension_N, (size_t)m->n_cable * sizeof(double));
    memcpy(l->work.target, shape->target, (size_t)m->n_cable * sizeof(double));
    memcpy(l->work.EA_N, shape->EA_N, (size_t)m->n_cable * sizeof(double));
    memcpy(l->work.loose, shape->loose, (size_t)m->n_node);
    return factor_shape(l);
}

void hf_built_linear_free(hf_built_linear *l)
{
    hf_workspace_free(&l->work);
    hf_arena_free(&l->schur.arena);
    hf_arena_free_block(l->block);
    *l = (hf_built_linear){0};
}

/* ---- net and truss under forces ---- */

/* Solves for the free nodes with attachments held, n right-hand sides v of row length ld, in place. */
static void back_solve(const hf_built_linear *l, const hf_built_lanes *by, int n, double *v, size_t ld)
{
    const hf_model *m = &l->built->model;
    if (by)
        hf_packed_band_back_solve(by->matrix, by->lanes, n, v, ld);
    else
        hf_band_back_solve(3 * m->n_free, 3 * m->half_bandwidth + 2, n, l->work.newton_band, v, (int)ld);
}

/* Turns forces on free nodes and attachments into their displacements, in place, v [n][n_dof]. Entries of supports on
 * rigid ground do not change. */
static void answer_forces(const hf_built_linear *l, const hf_built_lanes *by, int n, double *v, double *scratch)
{
    const hf_model *m = &l->built->model;
    size_t n_free = 3 * (size_t)m->n_free, n_attachment = 3 * (size_t)m->n_attachment;
    back_solve(l, by, n, v, l->n_dof);
    if (!n_attachment) return;
    double *answer = scratch, *pull = scratch + (size_t)n * n_free;
    memset(answer, 0, (size_t)n * n_free * sizeof *answer);
    for (size_t k = 0; k < (size_t)n; k++) {
        double *free_nodes = v + k * l->n_dof, *attachments = free_nodes + n_free, *sum = pull + k * n_attachment;
        memcpy(sum, attachments, n_attachment * sizeof *sum);
        hf_schur_pull(m, &l->work, hf_newton_matrix_block, free_nodes, sum);
        hf_schur_displace(m, &l->schur, sum, attachments);
        hf_schur_push(m, &l->work, hf_newton_matrix_block, attachments, answer + k * n_free);
    }
    back_solve(l, by, n, answer, n_free);
    for (size_t k = 0; k < (size_t)n; k++)
        hf_add(n_free, 1, answer + k * n_free, v + k * l->n_dof);
}

/* Computes the force [3] of the stretched cable e, its stiffness matrix times v(second end) - v(first end). */
static void stretch(const hf_built_linear *l, int e, const double *v, double force[3])
{
    const int *end = l->built->model.end_row + 2 * (ptrdiff_t)e;
    const double *a = v + 3 * (ptrdiff_t)end[0], *b = v + 3 * (ptrdiff_t)end[1];
    const double *k = l->block_N_per_m + 9 * (ptrdiff_t)e, d[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    for (int r = 0; r < 3; r++)
        force[r] = k[3 * r] * d[0] + k[3 * r + 1] * d[1] + k[3 * r + 2] * d[2];
}

/* ---- errors to displacements ---- */

/* Computes the forces [n_dof] of loads, of strained cables, and of supports displaced by v [n_dof]. Sets the free nodes
 * of v to 0. */
static void push_by_errors(const hf_built_linear *l, const double *strain_N, const double *load_N, double *v,
                           double *force)
{
    const hf_model *m = &l->built->model;
    hf_copy(l->n_dof, load_N, force);
    memset(v, 0, 3 * (size_t)m->n_free * sizeof *v);
    for (int e = 0; e < m->n_cable; e++) {
        double pull[3] = {0};
        if (hf_newton_matrix_is_at_support(m, e)) stretch(l, e, v, pull);
        for (int c = 0; c < 3 && strain_N; c++)
            pull[c] += strain_N[e] * l->unit[3 * (ptrdiff_t)e + c];
        for (int c = 0; c < 3; c++) {
            force[3 * m->end_row[2 * e] + c] += pull[c];
            force[3 * m->end_row[2 * e + 1] + c] -= pull[c];
        }
    }
}

void hf_built_linear_apply(const hf_built_linear *l, const hf_built_lanes *by, int n, const double *strain_N,
                           const double *load_N, double *move, double *scratch)
{
    const hf_model *m = &l->built->model;
    size_t n_free = 3 * (size_t)m->n_free, n_moving = n_free + 3 * (size_t)m->n_attachment;
    double *force = scratch, *more = scratch + (size_t)n * l->n_dof;
    for (size_t k = 0; k < (size_t)n; k++)
        push_by_errors(l, strain_N ? strain_N + k * (size_t)m->n_cable : NULL, load_N ? load_N + k * l->n_dof : NULL,
                       move + k * l->n_dof, force + k * l->n_dof);
    answer_forces(l, by, n, force, more);
    for (size_t k = 0; k < (size_t)n; k++) /* v of free nodes is 0; v of attachments is their displacement at rest */
        hf_add(n_moving, 1, force + k * l->n_dof, move + k * l->n_dof);
}

void hf_built_linear_tension(const hf_built_linear *l, const double *strain_N, const double *move, double *change_N)
{
    const hf_model *m = &l->built->model;
    for (int e = 0; e < m->n_cable; e++) {
        const double *a = move + 3 * (ptrdiff_t)m->end_row[2 * e], *b = move + 3 * (ptrdiff_t)m->end_row[2 * e + 1];
        const double *u = l->unit + 3 * (ptrdiff_t)e;
        double along = u[0] * (b[0] - a[0]) + u[1] * (b[1] - a[1]) + u[2] * (b[2] - a[2]);
        change_N[e] = l->stiffness_N_per_m[e] * along + (strain_N ? strain_N[e] : 0);
    }
}

/* ---- the transpose ---- */

/* Turns z, the solution for the derivatives as forces, into the derivatives with respect to strains, and adds to those
 * of supports. */
static void pull_errors(const hf_built_linear *l, const double *z, double *slope, double *strain)
{
    const hf_model *m = &l->built->model;
    for (int e = 0; e < m->n_cable; e++) {
        const double *a = z + 3 * (ptrdiff_t)m->end_row[2 * e], *b = z + 3 * (ptrdiff_t)m->end_row[2 * e + 1];
        const double *u = l->unit + 3 * (ptrdiff_t)e;
        strain[e] = u[0] * (a[0] - b[0]) + u[1] * (a[1] - b[1]) + u[2] * (a[2] - b[2]);
        if (!hf_newton_matrix_is_at_support(m, e)) continue;
        double pull[3];
        stretch(l, e, z, pull);
        hf_newton_matrix_add_to_supports(m, e, pull, slope + 3 * (size_t)m->n_free);
    }
}

void hf_built_linear_transpose(const hf_built_linear *l, int n, double *slope, double *strain, double *scratch)
{
    const hf_model *m = &l->built->model;
    size_t n_moving = 3 * (size_t)(m->n_free + m->n_attachment);
    double *z = scratch, *more = scratch + (size_t)n * l->n_dof;
    memcpy(z, slope, (size_t)n * l->n_dof * sizeof *z);
    answer_forces(l, NULL, n, z, more);
    for (size_t k = 0; k < (size_t)n; k++) {
        memset(z + k * l->n_dof + n_moving, 0, (l->n_dof - n_moving) * sizeof *z);
        pull_errors(l, z + k * l->n_dof, slope + k * l->n_dof, strain + k * (size_t)m->n_cable);
    }
}

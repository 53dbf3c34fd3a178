/* Solves for a step of net and truss together (M24).
 *
 *     forces on free nodes and attachments
 *         | solve H_ff: step of the free nodes with the attachments fixed
 *         | b = pull on the attachments after that step
 *         | d_r = (I + F S)^-1 (F b - r), the step of the attachments; F enters, its inverse does not
 *         | d_r acts on the free nodes: solve H_ff again and add
 *         v
 *     steps of free nodes and attachments */
#include "solve/joint.h"

#include "linalg/dot.h"
#include "solve/schur.h"

#include <string.h>

static bool has_truss(const hf_model *m, const hf_workspace *w)
{
    return w->n_moving > m->n_free;
}

double hf_joint_resting_m(const hf_model *m, const hf_workspace *w, int at)
{
    return m->moves_supports ? m->position_m[at] + w->support_displacement_m[at] : m->position_m[at];
}

static double displacement_m(const hf_model *m, const hf_workspace *w, const double *position_m, int i_dof)
{
    int at = i_dof % 3 * m->n_node + m->attachment_row[i_dof / 3];
    return position_m[at] - hf_joint_resting_m(m, w, at);
}

hf_status hf_joint_factor(const hf_model *m, hf_workspace *w, hf_newton_block *block_of, const double *spring_N_per_m,
                          const hf_newton_rows *rows, double *condition)
{
    HF_TRY(hf_newton_matrix_factor_blocks(m, w, block_of, spring_N_per_m, rows, condition));
    if (!has_truss(m, w)) return HF_OK;
    hf_schur schur = hf_schur_of(m, w);
    w->n_joint_step++;
    return hf_schur_factor(m, w, block_of, &schur);
}

void hf_joint_solve(const hf_model *m, const hf_workspace *w, hf_newton_block *block_of, const hf_newton_rows *rows,
                    double *rhs)
{
    hf_newton_matrix_solve(m, w, rows, 1, rhs);
    if (!has_truss(m, w)) return;
    hf_schur schur = hf_schur_of(m, w);
    int n_free = 3 * m->n_free;
    double *pull = rhs + n_free, *answer = schur.column, *move = answer + n_free;
    hf_schur_pull(m, w, block_of, rhs, pull);
    hf_schur_flex(m, pull, move);
    for (int i = 0; i < schur.n; i++)
        move[i] -= displacement_m(m, w, w->position_m, i);
    hf_schur_solve(&schur, move);
    memset(answer, 0, (size_t)n_free * sizeof *answer);
    hf_schur_push(m, w, block_of, move, answer);
    hf_newton_matrix_solve(m, w, NULL, 1, answer);
    hf_add((size_t)n_free, 1, answer, rhs);
    memcpy(pull, move, (size_t)schur.n * sizeof *pull);
}

double hf_joint_mean_length_m(const hf_model *m)
{
    double sum = 0;
    for (int e = 0; e < m->n_cable; e++)
        sum += m->length_m[e];
    return sum / m->n_cable;
}

double hf_joint_loose_spring_N_per_m(const hf_model *m)
{
    return m->reference_N / hf_joint_mean_length_m(m);
}

double hf_joint_largest(int n, double scale, const double *a, const double *b)
{
    double largest = 0;
    for (int i = 0; i < 3 * n; i += 3) {
        double square = 0;
        for (int c = i; c < i + 3; c++) {
            double d = scale * a[c] - (b ? b[c] : 0);
            square += d * d;
        }
        if (!(square <= largest)) largest = square;
    }
    return sqrt(largest);
}

double hf_joint_gap_m(const hf_model *m, const hf_workspace *w, const double *position_m, const double *force,
                      double *square)
{
    double largest = 0, all = 0, *gap = w->coupling_work;
    if (!has_truss(m, w)) return 0;
    hf_schur_flex(m, force + 3 * m->n_free, gap);
    for (int i = 0; i < 3 * m->n_attachment; i += 3) {
        double sum = 0;
        for (int c = i; c < i + 3; c++) {
            double d = gap[c] - displacement_m(m, w, position_m, c);
            sum += d * d;
        }
        if (!(sum <= largest)) largest = sum; /* a NaN stays */
        all += sum;
    }
    double mean_m = hf_joint_mean_length_m(m);
    if (square) *square += all / (mean_m * mean_m);
    return sqrt(largest);
}

void hf_joint_set_displacement(const hf_model *m, hf_workspace *w)
{
    for (int i = 0; i < 3 * m->n_attachment; i++) {
        int at = i % 3 * m->n_node + m->attachment_row[i / 3];
        w->displacement_m[i] = displacement_m(m, w, w->position_m, i);
        w->position_m[at] = hf_joint_resting_m(m, w, at) + w->displacement_m[i];
    }
}

/* Linear statics of a truss of spatial beams:
 *
 *     truss -> axes, lengths, stiffness of members -> degrees of freedom -> row numbering
 *       -> assembly (lower band) -> unit diagonal -> Cholesky factor, condition number (or the error HF_MECHANISM)
 *     load case: settlements, temperatures, forces -> forces out of balance -> back substitution -> displacements
 *       -> reactions, member end forces, strain energy
 *     condensation: unit forces at the attachments -> back substitution -> flexibility
 *     blocks: stiffness of members -> blocks of three degrees of freedom
 *
 * Contents: members - layout - dofs and numbering - assembly - mechanisms - build - load cases - from
 * displacements - condensation - blocks */
#include <hifdm/frame.h>

#include "base/arena.h"
#include "linalg/band.h"
#include "linalg/dot.h"
#include "linalg/lapack.h"
#include "net/numbering.h"
#include "base/elementary.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Each comment ends with the range in which no test of the room `truss` and no frame of tests/verify changes. */
#define CONDITION_MAX 1e13 /* maximum for the scaled matrix; beyond it no digit is certain; 1e11 to 1e15 */
#define SHIFT 1e-11        /* makes the scaled matrix of a mechanism definite; far above rounding; 1e-13 to 1e-9 */
#define POWER_STEPS 20     /* steps of inverse iteration to find the node that moves; 2 to 60 */
#define CASES_AT_ONCE 64   /* right-hand sides per pass of the condensation; limits its memory; 1 to 512 */

enum { N_DEFORMATION = 6 }; /* elongation, twist, end rotations against the chord: about z at i, j, about y at i, j */

/* ---- members ---- */

static void set_axes(const hf_truss *t, int e, hf_frame *f)
{
    const double *a = t->position_m + 3 * (size_t)t->end[2 * e], *b = t->position_m + 3 * (size_t)t->end[2 * e + 1];
    double length = f->length_m[e] = hf_truss_member_length(t, e), y[3], z[3];
    double *axes = f->axes + 9 * (size_t)e, *x = axes;
    for (int c = 0; c < 3; c++)
        x[c] = (b[c] - a[c]) / length;
    double across = hf_norm(x[0], x[1], 0);
    y[0] = across > 0 ? -x[1] / across : 0;
    y[1] = across > 0 ? x[0] / across : 1;
    y[2] = 0;
    hf_cross(x, y, z);
    double cosine = hf_cosine(t->roll_rad[e]), sine = hf_sine(t->roll_rad[e]);
    for (int c = 0; c < 3; c++) {
        axes[3 + c] = cosine * y[c] + sine * z[c];
        axes[6 + c] = cosine * z[c] - sine * y[c];
    }
}

/* Computes the stiffness of an exact two-node Timoshenko beam with Phi = 12 E I/(G As L^2). Phi is 0 for an
 * infinite shear area. */
static void set_stiffness(const hf_truss *t, int e, hf_frame *f)
{
    double length = f->length_m[e], *k = f->stiffness + N_DEFORMATION * (size_t)e;
    k[0] = t->E_Pa[e] * t->A_m2[e] / length;
    if (t->joint[e] == HF_JOINT_PINNED) return;
    k[1] = t->G_Pa[e] * t->J_m4[e] / length;
    for (int axis = 0; axis < 2; axis++) { /* about z, about y */
        double EI = t->E_Pa[e] * (axis ? t->Iy_m4 : t->Iz_m4)[e], area = (axis ? t->Asz_m2 : t->Asy_m2)[e];
        double phi = 12 * EI / (t->G_Pa[e] * area * length * length);
        k[2 + 2 * axis] = (4 + phi) * EI / ((1 + phi) * length);
        k[3 + 2 * axis] = (2 - phi) * EI / ((1 + phi) * length);
    }
}

/* Computes the deformations per displacement of the two nodes, b [N_DEFORMATION][12]. Rotations are relative to the
 * chord, so that a rigid-body motion causes no strain, to rounding. */
static void deformation_matrix(const hf_frame *f, int e, double b[N_DEFORMATION][12])
{
    const double *x = f->axes + 9 * (size_t)e, *y = x + 3, *z = x + 6;
    double length = f->length_m[e];
    memset(b, 0, N_DEFORMATION * sizeof *b);
    for (int c = 0; c < 3; c++) {
        b[0][c] = -x[c];
        b[0][6 + c] = x[c];
        b[1][3 + c] = -x[c];
        b[1][9 + c] = x[c];
        for (int end = 0; end < 2; end++) {
            b[2 + end][c] = y[c] / length;
            b[2 + end][6 + c] = -y[c] / length;
            b[2 + end][3 + 6 * end + c] = z[c];
            b[4 + end][c] = -z[c] / length;
            b[4 + end][6 + c] = z[c] / length;
            b[4 + end][3 + 6 * end + c] = y[c];
        }
    }
}

/* Computes the forces q of deformations: N, T, Mz at i and j, My at i and j. */
static void resist(const double *k, const double *deformation, double *q)
{
    q[0] = k[0] * deformation[0];
    q[1] = k[1] * deformation[1];
    for (int axis = 2; axis < N_DEFORMATION; axis += 2) {
        q[axis] = k[axis] * deformation[axis] + k[axis + 1] * deformation[axis + 1];
        q[axis + 1] = k[axis + 1] * deformation[axis] + k[axis] * deformation[axis + 1];
    }
}

/* Computes the elastic deformations of a member in a load case under displacements of all nodes, which are the total
 * ones minus the thermal ones, and the forces q of these. */
static void strain(const hf_frame *f, const hf_frame_load *load, int e, const double *displacement, double *deformation,
                   double *q)
{
    const hf_truss *t = f->truss;
    double rise_K = load->temperature_K ? load->temperature_K[e] : 0;
    const double *x = f->axes + 9 * (size_t)e, *y = x + 3, *z = x + 6, length = f->length_m[e];
    const double *i = displacement + HF_TRUSS_DOF * (size_t)t->end[2 * e];
    const double *j = displacement + HF_TRUSS_DOF * (size_t)t->end[2 * e + 1];
    double along[3] = {0}, turn_i[3] = {0}, turn_j[3] = {0};
    for (int c = 0; c < 3; c++) {
        along[0] += x[c] * (j[c] - i[c]);
        along[1] += y[c] * (j[c] - i[c]);
        along[2] += z[c] * (j[c] - i[c]);
        for (int axis = 0; axis < 3; axis++) {
            turn_i[axis] += f->axes[9 * (size_t)e + (size_t)(3 * axis + c)] * i[3 + c];
            turn_j[axis] += f->axes[9 * (size_t)e + (size_t)(3 * axis + c)] * j[3 + c];
        }
    }
    memset(deformation, 0, N_DEFORMATION * sizeof *deformation);
    deformation[0] = along[0] - t->expansion_per_K[e] * rise_K * length;
    if (t->joint[e] == HF_JOINT_RIGID) {
        deformation[1] = turn_j[0] - turn_i[0];
        deformation[2] = turn_i[2] - along[1] / length;
        deformation[3] = turn_j[2] - along[1] / length;
        deformation[4] = turn_i[1] + along[2] / length;
        deformation[5] = turn_j[1] + along[2] / length;
    }
    resist(f->stiffness + N_DEFORMATION * (size_t)e, deformation, q);
}

/* Computes the local end forces s [12] from the forces q of the deformations, by equilibrium of the member. */
static void end_forces(const double *q, double length, double *s)
{
    double shear_y = (q[2] + q[3]) / length, shear_z = (q[4] + q[5]) / length;
    const double force[12] = {-q[0], shear_y, -shear_z, -q[1], q[4], q[2], q[0], -shear_y, shear_z, q[1], q[5], q[3]};
    memcpy(s, force, sizeof force);
}

/* ---- dofs and numbering ---- */

/* Marks each dof before rows are numbered: 0 (gets a row), HF_FRAME_FIXED or HF_FRAME_ABSENT. */
static void classify_dofs(const hf_truss *t, int *row_of_dof)
{
    for (int k = 0; k < HF_TRUSS_DOF * t->n_node; k++)
        row_of_dof[k] = k % HF_TRUSS_DOF < 3 ? 0 : HF_FRAME_ABSENT;
    for (int e = 0; e < t->n_member; e++)
        for (int k = 0; k < 2 * HF_TRUSS_DOF && t->joint[e] == HF_JOINT_RIGID; k++)
            row_of_dof[HF_TRUSS_DOF * t->end[2 * e + k / HF_TRUSS_DOF] + k % HF_TRUSS_DOF] = 0;
    for (int k = 0; k < HF_TRUSS_DOF * t->n_node; k++)
        if (t->fixed[k / HF_TRUSS_DOF] >> k % HF_TRUSS_DOF & 1) row_of_dof[k] = HF_FRAME_FIXED;
}

/* Orders the nodes so that the bandwidth is small. hf_numbering_find does it for a net with one cable for each member.
 * The supports of this net are the nodes without a free dof. */
static hf_status order_nodes(const hf_truss *t, const int *row_of_dof, int *order, int *n_ordered)
{
    int unused;
    unsigned char *role;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(role, t->n_node)));
    *n_ordered = 0;
    for (int i = 0; i < t->n_node; i++) {
        role[i] = HF_ROLE_SUPPORT;
        for (int c = 0; c < HF_TRUSS_DOF; c++)
            if (row_of_dof[HF_TRUSS_DOF * i + c] >= 0) role[i] = HF_ROLE_INNER;
        *n_ordered += role[i] == HF_ROLE_INNER;
    }
    hf_scene net = {.n_node = t->n_node, .n_cable = t->n_member, .position_m = t->position_m};
    net.role = role;
    net.end = t->end;
    hf_status status = hf_numbering_find(&net, order, &unused);
    hf_arena_free_block(block);
    return status;
}

/* Numbers the rows in this order. Returns their number. */
static int give_rows(const int *order, int n_ordered, int *row_of_dof)
{
    int n = 0;
    for (int k = 0; k < n_ordered; k++)
        for (int c = 0; c < HF_TRUSS_DOF; c++) {
            int *row = &row_of_dof[HF_TRUSS_DOF * order[k] + c];
            if (*row >= 0) *row = n++;
        }
    return n;
}

static void rows_of_member(const hf_frame *f, const int *row_of_dof, int e, int row[12])
{
    for (int k = 0; k < 12; k++)
        row[k] = row_of_dof[HF_TRUSS_DOF * f->truss->end[2 * e + k / HF_TRUSS_DOF] + k % HF_TRUSS_DOF];
}

static int find_half_bandwidth(const hf_frame *f, const int *row_of_dof)
{
    int widest = 0, row[12];
    for (int e = 0; e < f->truss->n_member; e++) {
        int low = INT_MAX, high = 0;
        rows_of_member(f, row_of_dof, e, row);
        for (int k = 0; k < 12; k++) {
            if (row[k] < 0) continue;
            low = row[k] < low ? row[k] : low;
            high = row[k] > high ? row[k] : high;
        }
        if (high - low > widest) widest = high - low;
    }
    return widest;
}

/* ---- assembly ---- */

/* Sets k [12][12] to the stiffness matrix of a member in the axes of the truss. */
static void stiffness_of(const hf_frame *f, int e, double k[12][12])
{
    double b[N_DEFORMATION][12];
    int n = f->truss->joint[e] == HF_JOINT_PINNED ? 1 : N_DEFORMATION;
    deformation_matrix(f, e, b);
    for (int j = 0; j < 12; j++) {
        double column[N_DEFORMATION], q[N_DEFORMATION];
        for (int d = 0; d < N_DEFORMATION; d++)
            column[d] = b[d][j];
        resist(f->stiffness + N_DEFORMATION * (size_t)e, column, q);
        for (int i = 0; i < 12; i++) {
            k[i][j] = 0;
            for (int d = 0; d < n; d++)
                k[i][j] += b[d][i] * q[d];
        }
    }
}

static void assemble(const hf_frame *f, double *band)
{
    const hf_truss *t = f->truss;
    size_t width = (size_t)f->half_bandwidth + 1;
    memset(band, 0, (size_t)f->n_dof * width * sizeof *band);
    for (int e = 0; e < t->n_member; e++) {
        double k[12][12];
        int row[12];
        stiffness_of(f, e, k);
        rows_of_member(f, f->row_of_dof, e, row);
        for (int j = 0; j < 12; j++)
            for (int i = 0; i < 12 && row[j] >= 0; i++)
                if (row[i] >= row[j]) /* not above the diagonal, nor fixed, nor absent */
                    band[(size_t)(row[i] - row[j]) + (size_t)row[j] * width] += k[i][j];
    }
}

/* Scales the matrix to a unit diagonal, so that displacements and rotations have equal weight. Returns a row without
 * stiffness, or -1. */
static int scale_to_unit_diagonal(const hf_frame *f, double *scale, double *band)
{
    size_t width = (size_t)f->half_bandwidth + 1;
    for (int i = 0; i < f->n_dof; i++) {
        if (!(band[(size_t)i * width] > 0)) return i;
        scale[i] = 1 / sqrt(band[(size_t)i * width]);
    }
    for (int j = 0; j < f->n_dof; j++)
        for (int d = 0; d <= f->half_bandwidth && j + d < f->n_dof; d++)
            band[(size_t)d + (size_t)j * width] *= scale[j] * scale[j + d];
    return -1;
}

/* ---- mechanisms ---- */

/* Returns the row with the largest component in the motion with the smallest stiffness. The motion is found by inverse
 * iteration on the matrix, which is shifted to be definite. Returns -1 if the shifted matrix has no finite factor. */
static int find_loosest_row(const hf_frame *f, double *work)
{
    assemble(f, f->factor);
    scale_to_unit_diagonal(f, f->scale, f->factor);
    for (int i = 0; i < f->n_dof; i++) {
        f->factor[(size_t)i * ((size_t)f->half_bandwidth + 1)] += SHIFT;
        work[i] = 1 + 0.37 * (double)(i % 7) - 0.21 * (double)(i % 11); /* has a part of every motion */
    }
    if (hf_band_factor(f->n_dof, f->half_bandwidth, f->factor) != 0) return -1;
    int loosest = 0;
    for (int k = 0; k < POWER_STEPS; k++) {
        hf_band_back_solve(f->n_dof, f->half_bandwidth, 1, f->factor, work, f->n_dof);
        loosest = 0;
        for (int i = 1; i < f->n_dof; i++)
            if (fabs(work[i]) > fabs(work[loosest])) loosest = i;
        double most = fabs(work[loosest]);
        if (!(most > 0 && isfinite(most))) return -1;
        for (int i = 0; i < f->n_dof; i++)
            work[i] /= most;
    }
    return loosest;
}

/* Reports that the truss moves without force in this row. If row < 0, the row is unknown. Returns HF_MECHANISM. */
static hf_status refuse(const hf_frame *f, int row, hf_messages *messages)
{
    static const char *const direction[] = {"move along x", "move along y", "move along z",
                                            "turn about x", "turn about y", "turn about z"};
    const hf_truss *t = f->truss;
    char where[HF_TRUSS_DESCRIPTION_SIZE] = "truss";
    int dof = 0, n_support = 0;
    if (row < 0)
        return hf_error(messages, HF_MECHANISM,
                        "truss: the stiffness matrix cannot be factored. The truss is a mechanism, has too few "
                        "supports, or has a member whose stiffness is out of range");
    for (int k = 0; k < HF_TRUSS_DOF * t->n_node; k++)
        if (f->row_of_dof[k] == row) dof = k;
    for (int i = 0; i < t->n_node; i++)
        n_support += t->fixed[i] != 0;
    hf_truss_describe(t, false, dof / HF_TRUSS_DOF, where, sizeof where);
    if (n_support == 0)
        return hf_error(messages, HF_MECHANISM, "%s can %s without force, because no node of the truss is supported",
                        where, direction[dof % HF_TRUSS_DOF]);
    return hf_error(messages, HF_MECHANISM,
                    "%s can %s without force, because the truss is a mechanism or has too few supports. Add members or "
                    "supports, or join members rigidly",
                    where, direction[dof % HF_TRUSS_DOF]);
}

/* ---- build ---- */

static hf_status no_memory(const hf_truss *t, hf_messages *messages)
{
    return hf_error(messages, HF_NO_MEMORY, "out of memory for a truss of %d nodes", t->n_node);
}

static hf_status factor(hf_frame *f, hf_messages *messages)
{
    size_t n = (size_t)f->n_dof;
    double *work;
    int *integer_work, k = f->half_bandwidth;
    void *block;
    HF_TRY(hf_lapack_load(messages));
    if (HF_ARENA_ARRAYS(&block, HF_ARRAY(work, 3 * n), HF_ARRAY(integer_work, n)) != HF_OK)
        return no_memory(f->truss, messages);
    assemble(f, f->factor);
    int loose = scale_to_unit_diagonal(f, f->scale, f->factor);
    bool is_sound = loose < 0;
    if (is_sound) {
        double norm = hf_band_norm(f->n_dof, k, f->factor, work);
        f->condition = hf_band_factor(f->n_dof, k, f->factor) != 0
                           ? (double)INFINITY
                           : hf_band_condition(f->n_dof, k, f->factor, norm, work, integer_work);
        is_sound = f->condition <= CONDITION_MAX;
        if (!is_sound) loose = find_loosest_row(f, work);
    }
    hf_arena_free_block(block);
    return is_sound ? HF_OK : refuse(f, loose, messages);
}

static hf_status build(const hf_truss *truss, int *row_of_dof, int *order, hf_frame *f, hf_messages *messages)
{
    int n_ordered;
    classify_dofs(truss, row_of_dof);
    hf_status status = order_nodes(truss, row_of_dof, order, &n_ordered);
    if (status != HF_OK) return no_memory(truss, messages);
    f->n_dof = give_rows(order, n_ordered, row_of_dof);
    f->half_bandwidth = find_half_bandwidth(f, row_of_dof);
    if (f->n_dof == 0) return hf_error(messages, HF_BAD_CASE, "truss: every node is supported, so nothing can deform");
    if ((double)f->n_dof * (f->half_bandwidth + 1.0) > INT_MAX)
        return hf_error(messages, HF_NO_MEMORY, "the stiffness matrix with %d rows and half-bandwidth %d is too large",
                        f->n_dof, f->half_bandwidth);
    size_t m = (size_t)truss->n_member, n_dof = (size_t)f->n_dof;
    if (HF_ARENA_ARRAYS(&f->block, HF_ARRAY(f->row_of_dof, HF_TRUSS_DOF * (size_t)truss->n_node),
                        HF_ARRAY(f->axes, 9 * m), HF_ARRAY(f->length_m, m), HF_ARRAY(f->stiffness, N_DEFORMATION * m),
                        HF_ARRAY(f->scale, n_dof),
                        HF_ARRAY(f->factor, n_dof * ((size_t)f->half_bandwidth + 1))) != HF_OK)
        return no_memory(truss, messages);
    memcpy(f->row_of_dof, row_of_dof, HF_TRUSS_DOF * (size_t)truss->n_node * sizeof *row_of_dof);
    for (int e = 0; e < truss->n_member; e++) {
        set_axes(truss, e, f);
        set_stiffness(truss, e, f);
    }
    return factor(f, messages);
}

hf_status hf_frame_build(const hf_truss *truss, hf_frame *frame, hf_messages *messages)
{
    *frame = (hf_frame){.truss = truss};
    size_t n = (size_t)truss->n_node;
    int *scratch = malloc((HF_TRUSS_DOF + 1) * n * sizeof *scratch);
    if (!scratch) return no_memory(truss, messages);
    hf_status status = build(truss, scratch, scratch + HF_TRUSS_DOF * n, frame, messages);
    free(scratch);
    return status;
}

void hf_frame_free(hf_frame *frame)
{
    hf_arena_free_block(frame->block);
    *frame = (hf_frame){0};
}

/* ---- load cases ---- */

/* Computes the forces out of balance at all dofs under a displacement, force [n_node][6]: the load minus the forces
 * that the members need. */
static void out_of_balance(const hf_frame *f, const hf_frame_load *load, const double *displacement, double *force)
{
    const hf_truss *t = f->truss;
    hf_copy(HF_TRUSS_DOF * (size_t)t->n_node, load->force, force);
    for (int e = 0; e < t->n_member; e++) {
        double deformation[N_DEFORMATION], q[N_DEFORMATION], s[12];
        const double *axes = f->axes + 9 * (size_t)e;
        strain(f, load, e, displacement, deformation, q);
        end_forces(q, f->length_m[e], s);
        for (int k = 0; k < 4; k++) { /* force at i, moment at i, force at j, moment at j */
            double *at = force + HF_TRUSS_DOF * (size_t)t->end[2 * e + k / 2] + 3 * (k % 2);
            for (int c = 0; c < 3; c++)
                at[c] -= axes[c] * s[3 * k] + axes[3 + c] * s[3 * k + 1] + axes[6 + c] * s[3 * k + 2];
        }
    }
}

/* Returns the dof of a moment that nothing resists, or -1. */
static int find_bad_dof(const hf_frame *f, int n_case, const hf_frame_load *load)
{
    for (int k = 0; k < n_case; k++)
        for (int i = 0; load[k].force && i < HF_TRUSS_DOF * f->truss->n_node; i++)
            if (f->row_of_dof[i] == HF_FRAME_ABSENT && load[k].force[i] != 0) return i;
    return -1;
}

size_t hf_frame_work_size(const hf_frame *f, int n_case)
{
    return (size_t)n_case * (size_t)f->n_dof + HF_TRUSS_DOF * (size_t)f->truss->n_node;
}

hf_status hf_frame_solve(const hf_frame *f, int n_case, const hf_frame_load *load, double *work, double *displacement,
                         int *bad_dof)
{
    size_t n = HF_TRUSS_DOF * (size_t)f->truss->n_node, n_dof = (size_t)f->n_dof;
    double *force = work + (size_t)n_case * n_dof;
    *bad_dof = find_bad_dof(f, n_case, load);
    if (*bad_dof >= 0) return HF_MECHANISM;
    for (size_t k = 0; k < (size_t)n_case; k++)
        for (size_t i = 0; i < n; i++)
            displacement[k * n + i] =
                load[k].settlement && f->row_of_dof[i] == HF_FRAME_FIXED ? load[k].settlement[i] : 0;
    /* First, supports settle and all other dofs are held. Then the free dofs move under the forces out of balance. */
    for (size_t k = 0; k < (size_t)n_case; k++) {
        out_of_balance(f, &load[k], displacement + k * n, force);
        for (size_t i = 0; i < n; i++)
            if (f->row_of_dof[i] >= 0)
                work[k * n_dof + (size_t)f->row_of_dof[i]] = force[i] * f->scale[f->row_of_dof[i]];
    }
    hf_band_back_solve(f->n_dof, f->half_bandwidth, n_case, f->factor, work, f->n_dof);
    for (size_t k = 0; k < (size_t)n_case; k++)
        for (size_t i = 0; i < n; i++)
            if (f->row_of_dof[i] >= 0)
                displacement[k * n + i] = work[k * n_dof + (size_t)f->row_of_dof[i]] * f->scale[f->row_of_dof[i]];
    return HF_OK;
}

/* ---- from displacements ---- */

void hf_frame_reactions(const hf_frame *f, const hf_frame_load *load, const double *displacement, double *reaction,
                        double *residual)
{
    out_of_balance(f, load, displacement, reaction);
    for (int i = 0; i < HF_TRUSS_DOF * f->truss->n_node; i++) {
        bool fixed = f->row_of_dof[i] == HF_FRAME_FIXED;
        if (residual) residual[i] = fixed ? 0 : reaction[i];
        reaction[i] = fixed ? -reaction[i] : 0;
    }
}

void hf_frame_member_forces(const hf_frame *f, const hf_frame_load *load, const double *displacement, double *end_force)
{
    for (int e = 0; e < f->truss->n_member; e++) {
        double deformation[N_DEFORMATION], q[N_DEFORMATION];
        strain(f, load, e, displacement, deformation, q);
        end_forces(q, f->length_m[e], end_force + 12 * (size_t)e);
    }
}

double hf_frame_strain_energy(const hf_frame *f, const hf_frame_load *load, const double *displacement)
{
    double twice = 0;
    for (int e = 0; e < f->truss->n_member; e++) {
        double deformation[N_DEFORMATION], q[N_DEFORMATION];
        strain(f, load, e, displacement, deformation, q);
        for (int d = 0; d < N_DEFORMATION; d++)
            twice += q[d] * deformation[d];
    }
    return twice / 2;
}

/* ---- condensation ---- */

/* Computes columns first to first+n-1 of the flexibility. Each has a unit force as right-hand side. */
static void condense_some(const hf_frame *f, int n_point, const int *node, int first, int n, double *work,
                          double *flexibility)
{
    size_t n_dof = (size_t)f->n_dof, size = 3 * (size_t)n_point;
    memset(work, 0, (size_t)n * n_dof * sizeof *work);
    for (int k = 0; k < n; k++) {
        int row = f->row_of_dof[HF_TRUSS_DOF * node[(first + k) / 3] + (first + k) % 3];
        if (row >= 0) work[(size_t)k * n_dof + (size_t)row] = f->scale[row];
    }
    hf_band_back_solve(f->n_dof, f->half_bandwidth, n, f->factor, work, f->n_dof);
    for (int k = 0; k < n; k++)
        for (size_t i = 0; i < size; i++) {
            int row = f->row_of_dof[HF_TRUSS_DOF * (size_t)node[i / 3] + i % 3];
            flexibility[(size_t)(first + k) * size + i] =
                row >= 0 ? work[(size_t)k * n_dof + (size_t)row] * f->scale[row] : 0;
        }
}

hf_status hf_frame_condense(const hf_frame *f, int n_point, const int *node, double *flexibility_m_per_N)
{
    size_t size = 3 * (size_t)n_point;
    double *work = malloc(CASES_AT_ONCE * (size_t)f->n_dof * sizeof *work);
    if (!work) return HF_NO_MEMORY;
    for (int first = 0; first < 3 * n_point; first += CASES_AT_ONCE) {
        int left = 3 * n_point - first;
        condense_some(f, n_point, node, first, left < CASES_AT_ONCE ? left : CASES_AT_ONCE, work, flexibility_m_per_N);
    }
    free(work);
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < i; j++) {
            double *a = &flexibility_m_per_N[i * size + j], *b = &flexibility_m_per_N[j * size + i];
            *a = *b = (*a + *b) / 2; /* equal but for rounding (Maxwell) */
        }
    return HF_OK;
}

/* ---- blocks ---- */

/* Numbers the blocks: the translations of the points, of the other nodes, then the rotations. Returns their number, or
 * 0 if two points are the same node. */
static int number_blocks(const hf_frame *f, int n_point, const int *node, int *block_of)
{
    const hf_truss *t = f->truss;
    int n = n_point;
    for (int k = 0; k < 2 * t->n_node; k++)
        block_of[k] = -1;
    for (int k = 0; k < n_point; k++) {
        if (block_of[2 * node[k]] >= 0) return 0;
        block_of[2 * node[k]] = k;
    }
    for (int i = 0; i < t->n_node; i++)
        if (block_of[2 * i] < 0) block_of[2 * i] = n++;
    for (int i = 0; i < t->n_node; i++) {
        bool turns = false;
        for (int c = 3; c < HF_TRUSS_DOF; c++)
            turns |= f->row_of_dof[HF_TRUSS_DOF * i + c] != HF_FRAME_ABSENT;
        if (turns) block_of[2 * i + 1] = n++;
    }
    return n;
}

/* Adds the blocks of a member. Fixed degrees of freedom have no entries. */
static void add_member(const hf_frame *f, int e, const int *block_of, hf_stiffness_blocks *to)
{
    double k[12][12];
    int row[12], part[4];
    stiffness_of(f, e, k);
    rows_of_member(f, f->row_of_dof, e, row);
    for (int i = 0; i < 4; i++)
        part[i] = block_of[2 * f->truss->end[2 * e + i / 2] + i % 2];
    for (int i = 0; i < 4; i++)
        for (int j = 0; j <= i; j++) {
            if (part[i] < 0 || part[j] < 0) continue;
            hf_stiffness_block *b = &to->block[to->n_block++];
            b->row = part[i];
            b->column = part[j];
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 3; c++)
                    b->entry[r][c] = row[3 * i + r] < 0 || row[3 * j + c] < 0 ? 0 : k[3 * i + r][3 * j + c];
        }
}

hf_status hf_frame_blocks(const hf_frame *f, int n_point, const int *node, hf_stiffness_blocks *to)
{
    const hf_truss *t = f->truss;
    size_t n_node = (size_t)t->n_node;
    int *block_of;
    void *scratch;
    *to = (hf_stiffness_blocks){0};
    HF_TRY(HF_ARENA_ARRAYS(&scratch, HF_ARRAY(block_of, 2 * n_node)));
    to->n = number_blocks(f, n_point, node, block_of);
    hf_status status =
        HF_ARENA_ARRAYS(&to->memory, HF_ARRAY(to->block, 10 * (size_t)t->n_member),
                        HF_ARRAY(to->is_held, 3 * (size_t)to->n), HF_ARRAY(to->position_m, 3 * (size_t)to->n));
    for (int e = 0; status == HF_OK && to->n > 0 && e < t->n_member; e++)
        add_member(f, e, block_of, to);
    for (int i = 0; status == HF_OK && to->n > 0 && i < 2 * t->n_node; i++)
        for (int c = 0; c < 3 && block_of[i] >= 0; c++) {
            to->is_held[3 * (ptrdiff_t)block_of[i] + c] = f->row_of_dof[3 * i + c] < 0;
            to->position_m[3 * (ptrdiff_t)block_of[i] + c] = t->position_m[3 * (ptrdiff_t)(i / 2) + c];
        }
    hf_arena_free_block(scratch);
    return status;
}

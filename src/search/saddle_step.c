/* Solves steps of Levenberg-Marquardt by one sparse saddle-point system. saddle_step.h describes the interface.
 *
 *     cables, residuals -> for each cable: eliminate its variable -> blocks of 6 x 6 -> factor
 *         -> border of the mean tensions -> attachments to the truss by GMRES -> steps of the variables
 *         -> limits violated, or held without need? -> change the active set, factor again
 *
 * With displacements d, multipliers m of equilibrium and y of the border, a cable with the relative vectors d and m
 * along it has the energy
 *
 *     h dT^2/2 + (g + c'y + m) dT + D x^2/2 + across (m.d - m d),    dT = direct x + along d,
 *
 * where h and g are the curvature and slope of the objectives. Without its variable x it is
 *
 *     dd d^2/2 + dm d v - mm v^2/2 + m v + d d + across (m.d - m d),  v = g + c'y + m.
 *
 * Contents: making - model - products - solves - attachments - active set - the step */
#include "search/saddle_step.h"

#include "linalg/dense.h"
#include "linalg/dot.h"
#include "solve/newton_matrix.h"
#include "solve/schur.h"

#include <math.h>
#include <string.h>

#define SETS_MAX 30        /* maximum number of active sets of a step */
#define ALL_AT_ONCE 8      /* sets after which only the worst limits change */
#define ROUNDING 1e-12     /* a violation below this part of the magnitude is rounding */
#define KRYLOV_END 1e-10   /* relative residual at which GMRES ends */
#define KRYLOV_ENOUGH 1e-9 /* the step fails if it is larger after HF_SADDLE_KRYLOV solves */
#define REFINEMENTS 1      /* steps of iterative refinement of each solve */

/* ---- making ---- */

static int n_objective(const hf_evaluator *v)
{
    return v->objectives ? v->objectives->n_objective : 1;
}

static hf_figure_kind figure_of(const hf_evaluator *v, int k)
{
    return v->objectives ? v->objectives->objective[k].settings.figure : HF_FIGURE_PSI;
}

bool hf_saddle_step_applies(const hf_evaluator *v)
{
    const hf_model *m = v->model;
    if (v->objectives && (v->objectives->nets || v->objectives->constraints)) return false;
    if (m->n_leader != m->n_variable || m->has_strut) return false;
    for (int i = 0; v->limits && i < v->limits->n; i++)
        if (v->limits->row[i].kind != HF_LIMIT_TENSION) return false;
    int n_rigid = 0; /* cables of law length in all designs */
    for (int e = 0; e < m->n_cable; e++)
        n_rigid += hf_law_has((hf_law)m->law[e], HF_LAW_IS_RIGID);
    for (int k = 0; k < m->n_variable; k++) {
        if (hf_evaluate_sets(v, k) != HF_SETS_DENSITY && hf_evaluate_sets(v, k) != HF_SETS_TENSION) return false;
        n_rigid -= hf_law_has((hf_law)m->law[m->variable_cable[k]], HF_LAW_IS_RIGID);
    }
    if (n_rigid > 0) return false;
    for (int k = 0; k < n_objective(v); k++) {
        hf_figure_kind figure = figure_of(v, k);
        if (figure != HF_FIGURE_PSI && figure != HF_FIGURE_TENSION && figure != HF_FIGURE_EVENNESS) return false;
    }
    return true;
}

hf_status hf_saddle_step_create(const hf_evaluator *v, int n_row, hf_saddle_step *to)
{
    const hf_model *m = v->model;
    size_t n_dof = HF_BLOCK * (size_t)m->n_free, n_held = HF_BLOCK * (size_t)m->n_attachment;
    *to = (hf_saddle_step){.v = v, .n_row = n_row, .n_rows = n_objective(v)};
    for (int k = 0; k < n_objective(v); k++)
        if (figure_of(v, k) == HF_FIGURE_EVENNESS) to->border += 2;
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_SADDLE_STEP_FIELDS(HF_ARENA_ITEM)));
    for (int e = 0; e < m->n_cable; e++)
        to->cable[e].variable = -1;
    for (int k = 0; k < m->n_variable; k++)
        to->cable[m->variable_cable[k]].variable = k;
    return hf_block_band_create(m->n_free, m->half_bandwidth, &to->matrix);
}

void hf_saddle_step_free(hf_saddle_step *s)
{
    hf_arena_free_block(s->matrix.block);
    hf_arena_free_block(s->block);
    *s = (hf_saddle_step){0};
}

/* ---- model ---- */

/* Returns the rows of objective k at the tensions of the cables. */
static hf_saddle_rows rows_of(const hf_saddle_step *s, int k)
{
    const hf_model *m = s->v->model;
    hf_saddle_rows r = {.figure = figure_of(s->v, k), .n = m->n_inner_node, .index = m->inner_row};
    double weight = 1, mean = 0;
    for (int i = 0; s->v->objectives && i < k; i++) {
        r.first_row += s->v->objectives->objective[i].n_row;
        if (figure_of(s->v, i) == HF_FIGURE_EVENNESS) r.border += 2;
    }
    if (s->v->objectives) weight = s->v->objectives->objective[k].settings.weight;
    if (r.figure != HF_FIGURE_PSI) {
        r.n = s->v->objectives->objective[k].n_cable;
        r.index = s->v->objectives->objective[k].cable;
    }
    r.part = weight / sqrt(r.n);
    if (r.figure != HF_FIGURE_EVENNESS) return r;
    for (int i = 0; i < r.n; i++)
        mean += s->cable[r.index[i]].tension_N;
    mean /= r.n;
    r.part /= mean;
    r.of_mean = r.part / mean;
    for (int i = 0; i < r.n; i++) {
        double of_mean = r.of_mean * s->cable[r.index[i]].tension_N;
        r.square += of_mean * of_mean;
    }
    return r;
}

void hf_saddle_step_linearise(hf_saddle_step *s, const hf_workspace *w, const double *f)
{
    const hf_model *m = s->v->model;
    for (int e = 0; e < m->n_cable; e++) {
        hf_saddle_cable *c = &s->cable[e];
        double length_m = hf_newton_matrix_direction(m, w->position_m, e, c->unit);
        c->tension_N = w->tension_N[e];
        c->across = c->tension_N / length_m;
        c->along = hf_newton_matrix_stiffness(hf_workspace_cable(m, w, e), length_m, c->tension_N);
        c->direct = 0;
        if (c->variable >= 0) c->direct = length_m / hf_evaluate_divisor(s->v, c->variable);
        c->curvature = 0;
    }
    memset(s->weight, 0, (size_t)m->n_free * sizeof *s->weight);
    memset(s->coefficient, 0, (size_t)s->border * (size_t)m->n_cable * sizeof *s->coefficient);
    memcpy(s->base, f, (size_t)s->n_row * sizeof *f);
    hf_saddle_step_bend(s, NULL);
    for (int k = 0; k < s->n_rows; k++) {
        hf_saddle_rows r = s->rows[k] = rows_of(s, k);
        double *of_mean = s->coefficient + (size_t)r.border * (size_t)m->n_cable, *mean = of_mean + m->n_cable;
        for (int i = 0; i < r.n; i++) {
            int at = r.index[i];
            if (r.figure == HF_FIGURE_PSI) {
                s->weight[at] += r.part * r.part;
                continue;
            }
            s->cable[at].curvature += r.part * r.part;
            if (r.figure != HF_FIGURE_EVENNESS) continue;
            of_mean[at] = -r.part * r.of_mean * s->cable[at].tension_N;
            mean[at] = -1.0 / r.n;
        }
    }
    s->factored_damping = -1;
}

double hf_saddle_step_spread(const hf_saddle_step *s, const double *unit)
{
    const hf_model *m = s->v->model;
    double sum = 0;
    memset(s->stiffness, 0, (size_t)m->n_free * sizeof *s->stiffness);
    for (int end = 0; end < 2 * m->n_cable; end++)
        if (m->end_row[end] < m->n_free) s->stiffness[m->end_row[end]] += s->cable[end / 2].across;
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        if (c->variable < 0) continue;
        double change_N = c->direct * unit[c->variable], square = c->curvature;
        for (int end = 2 * e; end < 2 * e + 2 && !(c->curvature > 0); end++) {
            int row = m->end_row[end];
            if (row < m->n_free) square += s->weight[row] / (s->stiffness[row] * s->stiffness[row]);
        }
        sum += square * change_N * change_N;
    }
    return sqrt(sum);
}

void hf_saddle_step_bend(hf_saddle_step *s, const double *f)
{
    for (int i = 0; i < s->n_row; i++)
        s->residual[i] = f ? f[i] - s->rate[i] : s->base[i];
}

void hf_saddle_step_limit(hf_saddle_step *s, const hf_watch *watch)
{
    for (int e = 0; e < s->v->model->n_cable; e++) {
        s->cable[e].low = -INFINITY;
        s->cable[e].high = INFINITY;
    }
    for (int i = 0; i < watch->n; i++) {
        const hf_watched *t = &watch->item[i];
        if (t->cable < 0) continue;
        hf_saddle_cable *c = &s->cable[t->cable];
        double inside = HF_WATCH_INSIDE * fabs(t->value);
        c->low = fmax(c->low, t->from + inside - t->value - t->bend);
        c->high = fmin(c->high, t->to - inside - t->value - t->bend);
    }
}

/* Eliminates the variable of a cable, which is free, or at a limit of its own or of its tension. */
static void eliminate(hf_saddle_cable *c)
{
    double h = c->curvature, along = c->along;
    c->mm = c->m = c->d = 0;
    if (c->variable < 0 || c->side == -1 || c->side == 1) {
        double by = c->variable < 0 ? 0 : c->direct * (c->side < 0 ? c->down : c->up);
        c->dd = h * along * along;
        c->dm = along;
        c->m = by;
        c->d = h * along * by;
    } else if (c->side != 0) {
        double by = c->side < 0 ? c->low : c->high, per = c->damping / (c->direct * c->direct);
        c->dd = per * along * along;
        c->dm = 0;
        c->m = by;
        c->d = -per * along * by;
    } else {
        double all = c->direct * c->direct * h + c->damping;
        c->dd = h * c->damping * along * along / all;
        c->dm = c->damping * along / all;
        c->mm = c->direct * c->direct / all;
    }
}

/* ---- products ---- */

/* Adds a vector along the cable and one across it to the entries of its ends. */
static void add_to_ends(const hf_model *m, int e, const double add[6], double *to)
{
    double *first = to + 6 * (ptrdiff_t)m->end_row[2 * e], *second = to + 6 * (ptrdiff_t)m->end_row[2 * e + 1];
    for (int i = 0; i < 6; i++) {
        first[i] -= add[i];
        second[i] += add[i];
    }
}

/* Computes the product of the matrix without the truss with `all` and `border_value`. */
static void multiply(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    const double *y = s->border_value;
    memset(s->product, 0, 6 * (size_t)m->n_node * sizeof *s->product);
    memset(s->border_product, 0, (size_t)s->border * sizeof *s->border_product);
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        const double *a = s->all + 6 * (ptrdiff_t)m->end_row[2 * e], *b = s->all + 6 * (ptrdiff_t)m->end_row[2 * e + 1];
        const double *u = c->unit;
        double r[6], add[6], of_border = 0;
        for (int i = 0; i < 6; i++)
            r[i] = b[i] - a[i];
        for (int k = 0; k < s->border; k++)
            of_border += s->coefficient[(size_t)k * (size_t)m->n_cable + (size_t)e] * y[k];
        double d = u[0] * r[0] + u[1] * r[1] + u[2] * r[2], v = u[0] * r[3] + u[1] * r[4] + u[2] * r[5];
        double pull = c->dm * d - c->mm * (v + of_border);
        double by_d = c->dd * d + (c->dm - c->across) * v + c->dm * of_border, by_m = pull - c->across * d;
        for (int i = 0; i < 3; i++) {
            add[i] = by_d * u[i] + c->across * r[3 + i];
            add[3 + i] = by_m * u[i] + c->across * r[i];
        }
        add_to_ends(m, e, add, s->product);
        for (int k = 0; k < s->border; k++)
            s->border_product[k] += s->coefficient[(size_t)k * (size_t)m->n_cable + (size_t)e] * pull;
    }
    for (int i = 0; i < m->n_free; i++)
        for (int c = 0; c < 3; c++)
            s->product[6 * i + c] += s->weight[i] * s->all[6 * i + c];
    for (int k = 0; k < s->n_rows; k++) {
        hf_saddle_rows r = s->rows[k];
        if (r.figure != HF_FIGURE_EVENNESS) continue;
        s->border_product[r.border] += r.square * y[r.border] + y[r.border + 1];
        s->border_product[r.border + 1] += y[r.border];
    }
}

/* Sets the slopes of the cables by the residuals, and the right-hand side: `start`, `border_start`, and for the
 * attachments `product`. */
static void find_right(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    memset(s->product, 0, 6 * (size_t)m->n_node * sizeof *s->product);
    memset(s->border_start, 0, (size_t)s->border * sizeof *s->border_start);
    for (int e = 0; e < m->n_cable; e++)
        s->cable[e].slope = 0;
    for (int k = 0; k < s->n_rows; k++) {
        hf_saddle_rows r = s->rows[k];
        const double *f = s->residual + r.first_row;
        for (int i = 0; i < r.n; i++) {
            if (r.figure == HF_FIGURE_PSI) {
                for (int c = 0; c < 3; c++)
                    s->product[6 * r.index[i] + c] += r.part * f[3 * i + c];
                continue;
            }
            s->cable[r.index[i]].slope += r.part * f[i];
            if (r.figure == HF_FIGURE_EVENNESS)
                s->border_start[r.border] -= r.of_mean * s->cable[r.index[i]].tension_N * f[i];
        }
    }
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        double by_d = c->d + c->dm * c->slope, by_m = c->m - c->mm * c->slope, add[6];
        for (int i = 0; i < 3; i++) {
            add[i] = by_d * c->unit[i];
            add[3 + i] = by_m * c->unit[i];
        }
        add_to_ends(m, e, add, s->product);
        for (int k = 0; k < s->border; k++)
            s->border_start[k] += s->coefficient[(size_t)k * (size_t)m->n_cable + (size_t)e] * by_m;
    }
    for (int i = 0; i < 6 * m->n_node; i++)
        s->start[i] = -s->product[i];
    for (int k = 0; k < s->border; k++)
        s->border_start[k] = -s->border_start[k];
}

/* ---- solves ---- */

/* Assembles the matrix of the free nodes. */
static void assemble(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    hf_block_band_clear(&s->matrix);
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double block[6][6], minus[6][6];
        if (a >= m->n_free && b >= m->n_free) continue;
        for (int r = 0; r < 3; r++)
            for (int k = 0; k < 3; k++) {
                double uu = c->unit[r] * c->unit[k];
                block[r][k] = c->dd * uu;
                block[3 + r][k] = block[r][3 + k] = (c->dm - c->across) * uu + (r == k ? c->across : 0);
                block[3 + r][3 + k] = -c->mm * uu;
            }
        for (int r = 0; r < 6; r++)
            for (int k = 0; k < 6; k++)
                minus[r][k] = -block[r][k];
        if (a < m->n_free) hf_block_band_add(&s->matrix, a, a, block);
        if (b < m->n_free) hf_block_band_add(&s->matrix, b, b, block);
        if (a < m->n_free && b < m->n_free) hf_block_band_add(&s->matrix, a > b ? a : b, a > b ? b : a, minus);
    }
    for (int i = 0; i < m->n_free; i++) {
        double block[6][6] = {{0}};
        for (int c = 0; c < 3; c++)
            block[c][c] = s->weight[i];
        hf_block_band_add(&s->matrix, i, i, block);
    }
}

/* Returns column k of the border in the rows of the free nodes. */
static double *border_column(const hf_saddle_step *s, int k)
{
    return s->column + (size_t)(s->border + k) * 6 * (size_t)s->v->model->n_free;
}

/* Assembles and factors the matrix of the free nodes and the border, from which the variables are eliminated. Returns
 * HF_OK or HF_SINGULAR. */
static hf_status factor(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    size_t n_dof = 6 * (size_t)m->n_free, border = (size_t)s->border;
    for (int e = 0; e < m->n_cable; e++)
        s->cable[e].factored_side = s->cable[e].side;
    assemble(s);
    HF_TRY(hf_block_band_factor(&s->matrix));
    memset(s->all, 0, 6 * (size_t)m->n_node * sizeof *s->all);
    memset(s->border_value, 0, border * sizeof *s->border_value);
    for (int k = 0; k < s->border; k++) {
        double *solution = s->column + (size_t)k * n_dof;
        s->border_value[k] = 1;
        multiply(s);
        s->border_value[k] = 0;
        memcpy(border_column(s, k), s->product, n_dof * sizeof(double));
        memcpy(solution, s->product, n_dof * sizeof(double));
        hf_block_band_solve(&s->matrix, solution);
        memcpy(s->corner + (size_t)k * border, s->border_product, border * sizeof(double));
    }
    for (int k = 0; k < s->border; k++)
        for (int i = 0; i < s->border; i++)
            s->corner[(size_t)k * border + (size_t)i] -=
                hf_dot(n_dof, border_column(s, i), s->column + (size_t)k * n_dof);
    return s->border && hf_dense_factor(s->border, s->corner, s->pivot) ? HF_SINGULAR : HF_OK;
}

/* Replaces `right` and border_right by the solution with the factor. */
static void solve_once(hf_saddle_step *s)
{
    size_t n_dof = 6 * (size_t)s->v->model->n_free;
    hf_block_band_solve(&s->matrix, s->right);
    for (int k = 0; k < s->border; k++)
        s->border_right[k] -= hf_dot(n_dof, border_column(s, k), s->right);
    if (s->border) hf_dense_solve(s->border, s->corner, s->pivot, 1, s->border_right);
    for (int k = 0; k < s->border; k++)
        hf_subtract(n_dof, s->border_right[k], s->column + (size_t)k * n_dof, s->right);
}

/* Solves for `all` of the free nodes and border_value; those of the attachments are given. has_start: with the
 * right-hand side, otherwise with zero. `product` is that of the solution afterwards. */
static void solve_free(hf_saddle_step *s, bool has_start, int refinements)
{
    int n_dof = 6 * s->v->model->n_free;
    memset(s->all, 0, (size_t)n_dof * sizeof *s->all);
    memset(s->border_value, 0, (size_t)s->border * sizeof *s->border_value);
    for (int again = 0; again <= refinements; again++) {
        multiply(s);
        for (int i = 0; i < n_dof; i++)
            s->right[i] = (has_start ? s->start[i] : 0) - s->product[i];
        for (int k = 0; k < s->border; k++)
            s->border_right[k] = (has_start ? s->border_start[k] : 0) - s->border_product[k];
        solve_once(s);
        hf_add((size_t)n_dof, 1, s->right, s->all);
        hf_add((size_t)s->border, 1, s->border_right, s->border_value);
    }
    multiply(s);
}

/* ---- attachments ---- */

/* Sets u [n_attachment][6] to `held` + F (forces and their multipliers on the attachments), which is zero if the truss
 * is in equilibrium. `held` are the displacements and multipliers of the attachments. */
static void answer(hf_saddle_step *s, const double *held, bool has_start, double *u)
{
    const hf_model *m = s->v->model;
    int n = m->n_attachment;
    double *force = s->flexed, *moved = s->flexed + 3 * (ptrdiff_t)n;
    memcpy(s->all + 6 * (ptrdiff_t)m->n_free, held, 6 * (size_t)n * sizeof(double));
    solve_free(s, has_start, has_start ? REFINEMENTS : 0);
    for (int part = 0; part < 2; part++) { /* multipliers answer to displacements, and the reverse */
        for (int i = 0; i < 3 * n; i++) {
            ptrdiff_t at = 6 * (ptrdiff_t)(m->n_free + i / 3) + 3 * (1 - part) + i % 3;
            force[i] = s->product[at] - (has_start ? s->start[at] : 0);
        }
        hf_schur_flex(m, force, moved);
        for (int i = 0; i < 3 * n; i++)
            u[6 * (i / 3) + 3 * part + i % 3] = held[6 * (i / 3) + 3 * part + i % 3] + moved[i];
    }
}

/* Solves for all unknowns. The attachments are found by GMRES (Saad, Schultz, SIAM J. Sci. Stat. Comput. 7, 1986).
 * Returns HF_OK, or HF_SINGULAR if it does not converge. */
static hf_status solve_all(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    size_t n = 6 * (size_t)m->n_attachment;
    double *cosine = s->turn, *sine = cosine + HF_SADDLE_KRYLOV, *right = sine + HF_SADDLE_KRYLOV, first;
    int k = 0;
    memset(s->basis, 0, n * sizeof(double));
    if (n == 0) {
        solve_free(s, true, REFINEMENTS);
        return HF_OK;
    }
    answer(s, s->basis, true, s->basis + n);
    memcpy(s->basis, s->basis + n, n * sizeof(double));
    first = right[0] = sqrt(hf_dot(n, s->basis, s->basis));
    for (size_t i = 0; i < n && first > 0; i++)
        s->basis[i] /= -first;
    for (; k < HF_SADDLE_KRYLOV && fabs(right[k]) > KRYLOV_END * first; k++) {
        double *next = s->basis + (size_t)(k + 1) * n, *h = s->triangle + (size_t)k * (HF_SADDLE_KRYLOV + 1);
        answer(s, s->basis + (size_t)k * n, false, next);
        for (int i = 0; i <= k; i++) {
            h[i] = hf_dot(n, s->basis + (size_t)i * n, next);
            hf_subtract(n, h[i], s->basis + (size_t)i * n, next);
        }
        double norm = sqrt(hf_dot(n, next, next));
        for (size_t i = 0; i < n && norm > 0; i++)
            next[i] /= norm;
        for (int i = 0; i < k; i++) {
            double upper = cosine[i] * h[i] + sine[i] * h[i + 1];
            h[i + 1] = cosine[i] * h[i + 1] - sine[i] * h[i];
            h[i] = upper;
        }
        double length = hypot(h[k], norm);
        if (!(length > 0)) return HF_SINGULAR;
        cosine[k] = h[k] / length;
        sine[k] = norm / length;
        h[k] = length;
        right[k + 1] = -sine[k] * right[k];
        right[k] *= cosine[k];
    }
    if (fabs(right[k]) > KRYLOV_ENOUGH * first) return HF_SINGULAR;
    for (int i = k - 1; i >= 0; i--) {
        for (int j = i + 1; j < k; j++)
            right[i] -= s->triangle[(size_t)j * (HF_SADDLE_KRYLOV + 1) + (size_t)i] * right[j];
        right[i] /= s->triangle[(size_t)i * (HF_SADDLE_KRYLOV + 1) + (size_t)i];
    }
    double *sum = s->basis + (size_t)HF_SADDLE_KRYLOV * n;
    for (size_t i = 0; i < n; i++) {
        double value = 0;
        for (int j = 0; j < k; j++)
            value += right[j] * s->basis[(size_t)j * n + i];
        sum[i] = value;
    }
    memcpy(s->all + 6 * (size_t)m->n_free, sum, n * sizeof(double));
    solve_free(s, true, REFINEMENTS);
    return HF_OK;
}

/* ---- active set ---- */

/* Sets the step of a cable from `all` and border_value. Returns v of the comment at the top. */
static double find_step(const hf_saddle_step *s, int e, hf_saddle_cable *c)
{
    const hf_model *m = s->v->model;
    const double *a = s->all + 6 * (ptrdiff_t)m->end_row[2 * e], *b = s->all + 6 * (ptrdiff_t)m->end_row[2 * e + 1];
    double d = 0, v = c->slope;
    for (int i = 0; i < 3; i++) {
        d += c->unit[i] * (b[i] - a[i]);
        v += c->unit[i] * (b[3 + i] - a[3 + i]);
    }
    for (int k = 0; k < s->border; k++)
        v += s->coefficient[(size_t)k * (size_t)m->n_cable + (size_t)e] * s->border_value[k];
    double by_length = c->along * d;
    c->x = 0;
    if (c->variable >= 0) {
        if (c->side == -1 || c->side == 1)
            c->x = c->side < 0 ? c->down : c->up;
        else if (c->side != 0)
            c->x = ((c->side < 0 ? c->low : c->high) - by_length) / c->direct;
        else
            c->x = -c->direct * (c->curvature * by_length + v) / (c->direct * c->direct * c->curvature + c->damping);
    }
    c->change_N = c->side == -2 ? c->low : c->side == 2 ? c->high : c->direct * c->x + by_length;
    return v;
}

/* Sets c->next to the limit at which the cable must be held: the one that its step violates most, or none if the
 * present one pulls the wrong way, else the present one. c->excess is the violation, relative to the magnitude of the
 * value, or below zero the slope by which the model falls away from the limit, per such a magnitude. */
static void find_side(hf_saddle_cable *c, double v)
{
    double excess[] = {(c->down - c->x) / c->unit_of_x, (c->x - c->up) / c->unit_of_x,
                       (c->low - c->change_N) / c->tension_N, (c->change_N - c->high) / c->tension_N};
    const int side[] = {-1, 1, -2, 2};
    c->next = c->side;
    c->excess = ROUNDING;
    for (int i = 0; i < 4; i++)
        if (side[i] != c->side && excess[i] > c->excess) {
            c->excess = excess[i];
            c->next = side[i];
        }
    if (c->next != c->side || c->side == 0) return;
    double by_tension = c->curvature * c->change_N + v, slope;
    if (c->side == -1 || c->side == 1)
        slope = (c->direct * by_tension + c->damping * c->x) * c->unit_of_x;
    else
        slope = (by_tension + c->damping * c->x / c->direct) * c->tension_N;
    c->excess = c->side < 0 ? slope : -slope;
    if (c->excess < 0) c->next = 0;
}

/* Changes the active set. All cables change in the first ALL_AT_ONCE sets. Later only those change whose excess is at
 * least half of the maximum one, because many changes at once may lead back to an earlier set. Returns false if there
 * is nothing to change. */
static bool change_set(hf_saddle_step *s, int n_set)
{
    const hf_model *m = s->v->model;
    double most = 0, least = 0;
    bool changes = false;
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        if (c->variable < 0 || c->next == c->side) continue;
        changes = true;
        most = fmax(most, c->excess);
        least = fmin(least, c->excess);
    }
    for (int e = 0; e < m->n_cable; e++) {
        hf_saddle_cable *c = &s->cable[e];
        double part = n_set < ALL_AT_ONCE ? 0 : 0.5;
        if (c->variable >= 0 && (c->excess > 0 ? c->excess >= part * most : c->excess <= part * least))
            c->side = c->next;
    }
    return changes;
}

/* ---- the step ---- */

/* Computes the rates of the residuals by the step. Returns the decrease of |f|^2/2. */
static double find_rates(hf_saddle_step *s)
{
    double gain = 0;
    for (int k = 0; k < s->n_rows; k++) {
        hf_saddle_rows r = s->rows[k];
        double *rate = s->rate + r.first_row;
        for (int i = 0; i < r.n; i++) {
            int at = r.index[i];
            if (r.figure == HF_FIGURE_PSI) {
                for (int c = 0; c < 3; c++)
                    rate[3 * i + c] = r.part * s->all[6 * at + c];
                continue;
            }
            rate[i] = r.part * s->cable[at].change_N;
            if (r.figure == HF_FIGURE_EVENNESS)
                rate[i] -= r.of_mean * s->cable[at].tension_N * s->border_value[r.border];
        }
    }
    for (int i = 0; i < s->n_row; i++)
        gain -= (s->residual[i] + s->rate[i] / 2) * s->rate[i];
    return gain;
}

/* Eliminates the variables with their present limits, and factors unless the factor is that of this damping and of the
 * same kinds of limits. Returns HF_OK or HF_SINGULAR. */
static hf_status prepare(hf_saddle_step *s, double damping)
{
    bool is_factored = damping == s->factored_damping;
    for (int e = 0; e < s->v->model->n_cable; e++) {
        hf_saddle_cable *c = &s->cable[e];
        is_factored &= c->side * c->side == c->factored_side * c->factored_side;
        eliminate(c);
    }
    if (is_factored) return HF_OK;
    s->factored_damping = -1; /* until there is a factor */
    HF_TRY(factor(s));
    s->factored_damping = damping;
    return HF_OK;
}

hf_status hf_saddle_step_solve(hf_saddle_step *s, double damping, const double *down, const double *up,
                               const double *unit, int *side, double *x, double *gain)
{
    const hf_model *m = s->v->model;
    double square = hf_dot((size_t)s->n_row, s->base, s->base) / m->n_variable;
    for (int e = 0; e < m->n_cable; e++) {
        hf_saddle_cable *c = &s->cable[e];
        double part = c->direct / m->reference_N;
        c->side = 0;
        c->damping = damping * square * part * part;
        if (c->variable < 0) continue;
        c->down = down[c->variable];
        c->up = up[c->variable];
        c->unit_of_x = unit[c->variable];
        c->side = side[c->variable];
        double held[] = {c->low, c->down, 0, c->up, c->high};
        if (!isfinite(held[2 + c->side])) c->side = 0;
    }
    bool changes = true;
    for (int n = 0; changes && n < SETS_MAX; n++) {
        HF_TRY(prepare(s, damping));
        find_right(s);
        HF_TRY(solve_all(s));
        for (int e = 0; e < m->n_cable; e++) {
            hf_saddle_cable *c = &s->cable[e];
            double v = find_step(s, e, c);
            if (c->variable >= 0) find_side(c, v);
        }
        changes = change_set(s, n);
    }
    if (changes) return HF_DIFFERENT;
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        if (c->variable < 0) continue;
        x[c->variable] = c->x;
        side[c->variable] = c->side;
    }
    *gain = find_rates(s);
    if (!(*gain >= 0)) return HF_DIFFERENT;
    return HF_OK;
}

void hf_saddle_step_learn(const hf_saddle_step *s, hf_watch *watch)
{
    for (int i = 0; i < watch->n; i++) {
        hf_watched *t = &watch->item[i];
        if (t->cable >= 0) t->bend = t->now - t->value - s->cable[t->cable].change_N;
    }
}

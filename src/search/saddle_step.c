/* Solves steps of Levenberg-Marquardt by one sparse saddle-point system. saddle_step.h describes the interface.
 *
 *     cables, residuals -> for each cable: eliminate its variable -> blocks of 6 x 6 -> factor
 *         -> border of the mean tensions -> steps of the variables
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
 * A truss with displacements d and multipliers m has the energy m'K d.
 *
 * Contents: making - model - right-hand side - solves - active set - the step */
#include "search/saddle_step.h"

#include "base/elementary.h"
#include "linalg/dense.h"
#include "linalg/dot.h"
#include "solve/newton_matrix.h"

#include <math.h>
#include <string.h>

#define SETS_MAX 12    /* maximum number of active sets of a step */
#define ALL_AT_ONCE 8  /* sets after which only the worst limits change */
#define ROUNDING 1e-12 /* a violation below this part of the magnitude is rounding */

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
    if (v->objectives && v->objectives->nets) return false;
    if (m->n_leader != m->n_variable || m->has_strut || (m->n_attachment && !m->truss_stiffness)) return false;
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

/* Returns the row in `all` of block i of the stiffness matrix of the truss. */
static int row_of_truss(const hf_model *m, int i)
{
    return i < m->n_attachment ? m->n_free + i : m->n_node + i - m->n_attachment;
}

/* Orders the matrix by the target positions of the net and the positions of the truss. */
static hf_status create_matrix(hf_saddle_step *to)
{
    const hf_model *m = to->v->model;
    const hf_stiffness_blocks *truss = m->truss_stiffness;
    int n_moving = m->n_free + m->n_attachment, n = 0, *end;
    double *position;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(end, 2 * ((size_t)m->n_cable + (size_t)(truss ? truss->n_block : 0))),
                           HF_ARRAY(position, 3 * (size_t)to->n)));
    for (int e = 0; e < m->n_cable; e++) {
        if (m->end_row[2 * e] >= n_moving || m->end_row[2 * e + 1] >= n_moving) continue;
        memcpy(end + 2 * (ptrdiff_t)n++, m->end_row + 2 * (ptrdiff_t)e, 2 * sizeof *end);
    }
    for (int i = 0; truss && i < truss->n_block; i++) {
        if (truss->block[i].row == truss->block[i].column) continue;
        end[2 * n] = row_of_truss(m, truss->block[i].row);
        end[2 * n++ + 1] = row_of_truss(m, truss->block[i].column);
    }
    for (int i = 0; i < m->n_node; i++)
        for (int c = 0; c < 3; c++)
            position[3 * i + c] = m->position_m[c * m->n_node + i];
    for (int i = 0; truss && i < truss->n; i++)
        memcpy(position + 3 * (ptrdiff_t)row_of_truss(m, i), truss->position_m + 3 * (ptrdiff_t)i,
               3 * sizeof *position);
    hf_status status = hf_dissection_create(to->n, position, n, end, &to->matrix);
    hf_arena_free_block(block);
    return status;
}

hf_status hf_saddle_step_create(const hf_evaluator *v, int n_row, hf_saddle_step *to)
{
    const hf_model *m = v->model;
    *to = (hf_saddle_step){.v = v, .n_row = n_row, .n_rows = n_objective(v)};
    to->n = m->n_node + (m->truss_stiffness ? m->truss_stiffness->n - m->n_attachment : 0);
    size_t n_dof = HF_BLOCK * (size_t)to->n;
    for (int k = 0; k < n_objective(v); k++)
        if (figure_of(v, k) == HF_FIGURE_EVENNESS) to->border += 2;
    HF_TRY(HF_ARENA_ARRAYS(&to->block, HF_SADDLE_STEP_FIELDS(HF_ARENA_ITEM)));
    for (int e = 0; e < m->n_cable; e++)
        to->cable[e].variable = -1;
    for (int k = 0; k < m->n_variable; k++)
        to->cable[m->variable_cable[k]].variable = k;
    for (int i = 6 * (m->n_free + m->n_attachment); i < 6 * m->n_node; i++)
        to->is_held[i] = true;
    for (int i = 0; m->truss_stiffness && i < 6 * m->truss_stiffness->n; i++)
        to->is_held[6 * row_of_truss(m, i / 6) + i % 6] = m->truss_stiffness->is_held[3 * (i / 6) + i % 3];
    return create_matrix(to);
}

void hf_saddle_step_free(hf_saddle_step *s)
{
    hf_dissection_free(&s->matrix);
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

/* ---- right-hand side ---- */

/* Adds vectors along the cable, by displacements and by multipliers, to the entries of its ends. */
static void add_to_ends(const hf_model *m, int e, const double unit[3], double by_d, double by_m, double *to)
{
    double *first = to + 6 * (ptrdiff_t)m->end_row[2 * e], *second = to + 6 * (ptrdiff_t)m->end_row[2 * e + 1];
    for (int i = 0; i < 6; i++) {
        double add = (i < 3 ? by_d : by_m) * unit[i % 3];
        first[i] -= add;
        second[i] += add;
    }
}

/* Sets the rows that have no unknowns to zero. */
static void clear_held(const hf_saddle_step *s, double *to)
{
    for (int i = 0; i < 6 * s->n; i++)
        if (s->is_held[i]) to[i] = 0;
}

/* Sets the slopes of the cables by the residuals, and `all` and border_value to the right-hand side. */
static void find_right(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    memset(s->all, 0, 6 * (size_t)s->n * sizeof *s->all);
    memset(s->border_value, 0, (size_t)s->border * sizeof *s->border_value);
    for (int e = 0; e < m->n_cable; e++)
        s->cable[e].slope = 0;
    for (int k = 0; k < s->n_rows; k++) {
        hf_saddle_rows r = s->rows[k];
        const double *f = s->residual + r.first_row;
        for (int i = 0; i < r.n; i++) {
            if (r.figure == HF_FIGURE_PSI) {
                for (int c = 0; c < 3; c++)
                    s->all[6 * r.index[i] + c] -= r.part * f[3 * i + c];
                continue;
            }
            s->cable[r.index[i]].slope += r.part * f[i];
            if (r.figure == HF_FIGURE_EVENNESS)
                s->border_value[r.border] += r.of_mean * s->cable[r.index[i]].tension_N * f[i];
        }
    }
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        double by_m = c->m - c->mm * c->slope;
        add_to_ends(m, e, c->unit, -(c->d + c->dm * c->slope), -by_m, s->all);
        for (int k = 0; k < s->border; k++)
            s->border_value[k] -= s->coefficient[(size_t)k * (size_t)m->n_cable + (size_t)e] * by_m;
    }
    clear_held(s, s->all);
}

/* ---- solves ---- */

/* Adds a block to the matrix without the rows and columns that have no unknowns, in the units of displacements and
 * multipliers. */
static void add_block(hf_saddle_step *s, int i, int j, double block[6][6])
{
    double free_part[6][6];
    for (int r = 0; r < 6; r++)
        for (int c = 0; c < 6; c++)
            free_part[r][c] = s->is_held[6 * i + r] || s->is_held[6 * j + c]
                                  ? 0
                                  : block[r][c] * (r < 3 ? s->unit : 1 / s->unit) * (c < 3 ? s->unit : 1 / s->unit);
    hf_dissection_add(&s->matrix, i, j, free_part);
}

/* Chooses the units so that the curvatures by displacements and by multipliers have the same magnitude. Otherwise, the
 * smaller ones are lost beside the stiffness. A power of two adds no rounding. */
static void choose_unit(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    double by_d = hf_max_magnitude((size_t)m->n_free, s->weight), by_m = 0;
    for (int e = 0; e < m->n_cable; e++) {
        by_d = fmax(by_d, s->cable[e].dd);
        by_m = fmax(by_m, s->cable[e].mm);
    }
    s->unit = by_d > 0 && by_m > 0 ? ldexp(1, (int)lround(log2(by_m / by_d) / 4)) : 1;
}

/* Replaces x by the solution of the factored matrix. */
static void solve_matrix(const hf_saddle_step *s, double *x)
{
    for (int again = 0; again < 2; again++) {
        if (again) hf_dissection_solve(&s->matrix, x);
        for (int i = 0; i < 6 * s->n; i++)
            x[i] *= i % 6 < 3 ? s->unit : 1 / s->unit;
    }
}

/* Assembles the matrix. A row without an unknown has the diagonal entry 1. */
static void assemble(hf_saddle_step *s)
{
    const hf_model *m = s->v->model;
    const hf_stiffness_blocks *truss = m->truss_stiffness;
    int n_moving = m->n_free + m->n_attachment;
    hf_dissection_clear(&s->matrix);
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1];
        double block[6][6], minus[6][6];
        if (a >= n_moving && b >= n_moving) continue;
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
        if (a < n_moving) add_block(s, a, a, block);
        if (b < n_moving) add_block(s, b, b, block);
        if (a < n_moving && b < n_moving) add_block(s, a, b, minus);
    }
    for (int i = 0; i < s->n; i++) {
        double block[6][6] = {{0}};
        for (int c = 0; c < 6; c++)
            block[c][c] = s->is_held[6 * i + c];
        hf_dissection_add(&s->matrix, i, i, block);
        for (int c = 0; c < 6; c++)
            block[c][c] = i < m->n_free && c < 3 ? s->weight[i] : 0;
        add_block(s, i, i, block);
    }
    for (int i = 0; truss && i < truss->n_block; i++) {
        const hf_stiffness_block *b = &truss->block[i];
        double block[6][6] = {{0}};
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                block[r][3 + c] = block[3 + r][c] = b->entry[r][c];
        add_block(s, row_of_truss(m, b->row), row_of_truss(m, b->column), block);
    }
}

/* Returns column k of the border. */
static double *border_column(const hf_saddle_step *s, int k)
{
    return s->column + (size_t)(s->border + k) * 6 * (size_t)s->n;
}

/* Sets column k of the border and row k of the corner. */
static void make_border(hf_saddle_step *s, int k)
{
    const hf_model *m = s->v->model;
    const double *coefficient = s->coefficient + (size_t)k * (size_t)m->n_cable;
    double *corner = s->corner + (size_t)k * (size_t)s->border;
    memset(border_column(s, k), 0, 6 * (size_t)s->n * sizeof(double));
    memset(corner, 0, (size_t)s->border * sizeof *corner);
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        double pull = -c->mm * coefficient[e];
        add_to_ends(m, e, c->unit, c->dm * coefficient[e], pull, border_column(s, k));
        for (int i = 0; i < s->border; i++)
            corner[i] += s->coefficient[(size_t)i * (size_t)m->n_cable + (size_t)e] * pull;
    }
    clear_held(s, border_column(s, k));
    for (int i = 0; i < s->n_rows; i++) {
        if (s->rows[i].figure != HF_FIGURE_EVENNESS) continue;
        if (k == s->rows[i].border) corner[k] += s->rows[i].square;
        if (k / 2 == s->rows[i].border / 2) corner[k ^ 1] += 1;
    }
}

/* Assembles and factors the matrix and the border, from which the variables are eliminated. Returns HF_OK or
 * HF_SINGULAR. */
static hf_status factor(hf_saddle_step *s)
{
    size_t n_dof = 6 * (size_t)s->n, border = (size_t)s->border;
    for (int e = 0; e < s->v->model->n_cable; e++)
        s->cable[e].factored_side = s->cable[e].side;
    choose_unit(s);
    assemble(s);
    HF_TRY(hf_dissection_factor(&s->matrix));
    for (int k = 0; k < s->border; k++) {
        make_border(s, k);
        memcpy(s->column + (size_t)k * n_dof, border_column(s, k), n_dof * sizeof(double));
        solve_matrix(s, s->column + (size_t)k * n_dof);
    }
    for (int k = 0; k < s->border; k++)
        for (int i = 0; i < s->border; i++)
            s->corner[(size_t)k * border + (size_t)i] -=
                hf_dot(n_dof, border_column(s, i), s->column + (size_t)k * n_dof);
    return s->border && hf_dense_factor(s->border, s->corner, s->pivot) ? HF_SINGULAR : HF_OK;
}

/* Replaces the right-hand side in `all` and border_value by the solution. */
static void solve_all(hf_saddle_step *s)
{
    size_t n_dof = 6 * (size_t)s->n;
    solve_matrix(s, s->all);
    for (int k = 0; k < s->border; k++)
        s->border_value[k] -= hf_dot(n_dof, border_column(s, k), s->all);
    if (s->border) hf_dense_solve(s->border, s->corner, s->pivot, 1, s->border_value);
    for (int k = 0; k < s->border; k++)
        hf_subtract(n_dof, s->border_value[k], s->column + (size_t)k * n_dof, s->all);
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
        solve_all(s);
        for (int e = 0; e < m->n_cable; e++) {
            hf_saddle_cable *c = &s->cable[e];
            double v = find_step(s, e, c);
            if (c->variable >= 0) find_side(c, v);
        }
        changes = change_set(s, n);
    }
    for (int e = 0; e < m->n_cable; e++) {
        const hf_saddle_cable *c = &s->cable[e];
        if (c->variable < 0) continue;
        x[c->variable] = c->x;
        side[c->variable] = c->side;
    }
    *gain = find_rates(s);
    return changes ? HF_DIFFERENT : HF_OK;
}

void hf_saddle_step_learn(const hf_saddle_step *s, hf_watch *watch)
{
    for (int i = 0; i < watch->n; i++) {
        hf_watched *t = &watch->item[i];
        if (t->cable >= 0) t->bend = t->now - t->value - s->cable[t->cable].change_N;
    }
}

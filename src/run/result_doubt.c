/* Checks a result for three things that its user should know before the net is built.
 *
 *     truss:   displacements too large for linear theory
 *     strains: T/EA of a cable above a few per cent
 *     nodes:   far from their positions after form-finding, in a direction that no objective counts */
#include "run/result_doubt.h"

#include "base/arena.h"
#include "net/wanted.h"
#include "solve/prestress.h"
#include <hifdm/metrics.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

/* ---- the truss ---- */

/* Neglected displacement above which a warning appears, relative to the span of the attachments: 0.1 mm on 10 m, as
 * much as an error of cutting may be. It must also exceed SECOND_ORDER_PSI times psi. */
#define SECOND_ORDER_DOUBT 1e-5
#define SECOND_ORDER_PSI 0.05

/* The truss is computed by linear theory. This warns if the neglected second order is large for the size of the
 * reflector and its psi. */
void hf_result_doubt_truss(const hf_problem *p, const hf_carrier_state *truss, const hf_workspace *shape,
                           hf_messages *messages)
{
    double move_m, span_m, off_m = hf_carrier_second_order_m(&p->carrier, truss, &move_m, &span_m);
    double psi_m = shape ? hf_metrics_psi_m(&p->model, shape) : 0;
    if (off_m > fmax(SECOND_ORDER_DOUBT * span_m, SECOND_ORDER_PSI * psi_m))
        hf_warning(messages,
                   "truss: its attachments give way so far (%.3g mm in the result) that linear theory, which it is "
                   "computed by, may be off by some %.2g mm: stiffen it (tubes of larger diameter, more bays) or lower "
                   "form.pretension_N",
                   move_m * 1e3, off_m * 1e3);
}

/* ---- strains ---- */

/* Fibres and steel break at a few per cent. With more strain, EA or the tension is not the intended one. */
#define STRAIN_DOUBT 0.05

void hf_result_doubt_strain(const hf_problem *p, const hf_workspace *shape, hf_messages *messages)
{
    const double *EA_N = p->scene.EA_N;
    double most = STRAIN_DOUBT;
    int worst = -1, n = 0;
    char more[32] = "";
    for (int e = 0; EA_N && shape && e < p->scene.n_cable; e++) {
        double strain = EA_N[e] > 0 ? shape->tension_N[e] / EA_N[e] : 0;
        n += strain > STRAIN_DOUBT;
        if (!(strain > most)) continue;
        most = strain;
        worst = e;
    }
    if (worst < 0) return;
    if (n > 1) snprintf(more, sizeof more, ", and %d more", n - 1);
    hf_warning(
        messages,
        "cable '%s'%s is stretched by %.3g %%, by %.4g N with an EA of %.4g N: cables break at a few per cent; is "
        "EA in N?",
        p->scene.cable_id[worst], more, most * 100, shape->tension_N[worst], EA_N[worst]);
}

/* ---- nodes that no objective counts ---- */

/* Displacement above which a warning appears, relative to the mean length of a node's cables. In the cases of configs/
 * the maximum uncounted one is 0.11. With every force density as a variable, the objective facets permits 0.3 to 1.3.
 * The tests pass with 0.17 to 0.3. */
#define FAR_MOVE 0.25

static void lay_out_places(hf_arena *a, const hf_model *m, hf_places *to)
{
    size_t n = (size_t)m->n_node;
    to->position_m = hf_arena_take(a, 3 * n, sizeof(double));
    to->cable_m = hf_arena_take(a, n, sizeof(double));
    to->n_cable = hf_arena_take(a, n, sizeof(int));
    to->counted = hf_arena_take(a, n, 1);
}

static void count_rows(hf_places *to, const int *row, int n, hf_counted how)
{
    for (int i = 0; i < n; i++)
        if (to->counted[row[i]] < how) to->counted[row[i]] = (unsigned char)how;
}

static void count_objective(const hf_problem *p, const hf_objective *g, hf_places *to)
{
    const hf_model *m = &p->model;
    switch (g->settings.figure) {
    case HF_FIGURE_PSI:
    case HF_FIGURE_SURFACE:
        count_rows(to, m->inner_row, m->n_inner_node,
                   g->settings.figure == HF_FIGURE_PSI ? HF_COUNTED : HF_COUNTED_ACROSS);
        break;
    case HF_FIGURE_FACETS:
    case HF_FIGURE_GAIN:
        count_rows(to, p->objectives.corner_row, 4 * p->objectives.n_facet, HF_COUNTED_ACROSS);
        break;
    case HF_FIGURE_LENGTH:
        for (int i = 0; i < g->n_cable; i++)
            count_rows(to, m->end_row + 2 * (ptrdiff_t)g->cable[i], 2, HF_COUNTED);
        break;
    default: /* forces, and sums of lengths, do not fix positions */
        break;
    }
}

static void find_cables(const hf_model *m, hf_places *to)
{
    for (int i = 0; i < 2 * m->n_cable; i++) {
        to->cable_m[m->end_row[i]] += m->length_m[i / 2];
        to->n_cable[m->end_row[i]]++;
    }
    for (int row = 0; row < m->n_node; row++)
        if (to->n_cable[row]) to->cable_m[row] /= to->n_cable[row];
}

hf_status hf_places_keep(const hf_problem *p, hf_places *to)
{
    const hf_model *m = &p->model;
    const hf_objective psi = {.settings = {.figure = HF_FIGURE_PSI}};
    hf_arena arena = {0};
    *to = (hf_places){0};
    HF_TRY(HF_ARENA_MAKE(&arena, lay_out_places(&arena, m, to)));
    to->block = arena.block;
    memcpy(to->position_m, p->workspace.position_m, 3 * (size_t)m->n_node * sizeof(double));
    find_cables(m, to);
    if (p->objectives.n_objective == 0) count_objective(p, &psi, to);
    for (int k = 0; k < p->objectives.n_objective; k++)
        count_objective(p, &p->objectives.objective[k], to);
    return HF_OK;
}

void hf_places_free(hf_places *places)
{
    hf_arena arena = {.block = places->block};
    hf_arena_free(&arena);
    *places = (hf_places){0};
}

/* Splits the displacement of a node since form-finding, m, into a part that objectives count and one that they do
 * not. */
static void split_move(const hf_problem *p, const hf_places *form, const hf_workspace *shape, int row,
                       double *counted_m, double *open_m)
{
    double at[3], move[3], slope[2], square = 0, across = 0;
    for (int c = 0; c < 3; c++) {
        int i = c * p->model.n_node + row;
        at[c] = form->position_m[i];
        move[c] = shape->position_m[i] - at[c];
        square += move[c] * move[c];
    }
    if (form->counted[row] == HF_COUNTED) across = sqrt(square);
    if (form->counted[row] == HF_COUNTED_ACROSS) {
        hf_wanted_height_above(p->surface.kind, 1 / (4 * p->surface.focal_length_m), at, slope);
        across = fabs(move[2] - slope[0] * move[0] - slope[1] * move[1]) /
                 sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
    }
    *counted_m = across;
    *open_m = sqrt(fmax(0, square - across * across));
}

/* Returns the set to which most cables at a node belong, or their group, as a row of a case can name it. */
static const char *set_at(const hf_problem *p, int row)
{
    const hf_scene *s = &p->scene;
    const int *end = p->model.end_row;
    int best = -1, most = 0;
    for (int e = 0; e < s->n_cable; e++) {
        if (end[2 * e] != row && end[2 * e + 1] != row) continue;
        int family = hf_prestress_family(s, e), n = 0;
        for (int k = 0; k <= e; k++)
            n += (end[2 * k] == row || end[2 * k + 1] == row) && hf_prestress_family(s, k) == family;
        if (n > most) best = family;
        if (n > most) most = n;
    }
    return best < s->n_set ? s->set_name[best] : hf_group_word[best - s->n_set];
}

typedef struct {
    int row, n; /* row of the farthest node, and number of far nodes */
    double move_m;
} far_nodes;

/* Writes "", or ", and 61 more". Returns text. */
static const char *and_more(const far_nodes *far, char text[32])
{
    *text = '\0';
    if (far->n > 1) snprintf(text, 32, ", and %d more", far->n - 1);
    return text;
}

static void tell_far(const hf_problem *p, const hf_places *form, const far_nodes *far, hf_messages *messages)
{
    const far_nodes *open = &far[HF_COUNTED_NOT], *within = &far[HF_COUNTED_ACROSS];
    char more[32];
    if (open->n)
        hf_warning(messages,
                   "optimize: node %s%s moved far from where form-finding has it, by %.0f mm where its cables are %.0f "
                   "mm long, and no goal counts that: vary fewer sets of cables, or add {figure: length, set: %s, "
                   "weight: 0.1} to optimize.objective%s",
                   p->scene.node_id[p->model.node_of_row[open->row]], and_more(open, more), open->move_m * 1e3,
                   form->cable_m[open->row] * 1e3, set_at(p, open->row),
                   p->objectives.n_objective ? "" : " beside {figure: psi}");
    if (within->n)
        hf_warning(
            messages,
            "optimize: node %s%s moved far within the surface, by %.0f mm where its cables are %.0f mm long, and "
            "no goal counts that: vary fewer sets of cables, or add {figure: psi, weight: 0.1} to optimize.objective",
            p->scene.node_id[p->model.node_of_row[within->row]], and_more(within, more), within->move_m * 1e3,
            form->cable_m[within->row] * 1e3);
}

void hf_result_doubt_uncounted(const hf_problem *p, const hf_places *form, const hf_workspace *shape,
                               hf_messages *messages)
{
    far_nodes far[HF_COUNTED + 1] = {0};
    double counted_m, open_m, most_m = 0;
    if (!form->block || !shape) return;
    for (int row = 0; row < p->model.n_free; row++) {
        split_move(p, form, shape, row, &counted_m, &open_m);
        most_m = fmax(most_m, counted_m);
    }
    for (int row = 0; row < p->model.n_free; row++) {
        far_nodes *to = &far[form->counted[row]];
        split_move(p, form, shape, row, &counted_m, &open_m);
        if (shape->loose[row] || !(open_m > fmax(FAR_MOVE * form->cable_m[row], most_m))) continue;
        to->n++;
        if (open_m > to->move_m) to->row = row;
        to->move_m = fmax(to->move_m, open_m);
    }
    tell_far(p, form, far, messages);
}

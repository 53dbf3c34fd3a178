/* Makes the load cases of the as-built net from the rows of `load_cases`:
 *
 *     rows -> names in order of appearance -> materials -> for each row: temperatures, gravity, forces, displacements,
 *     table of nodes -> hf_load_cases
 *
 * Contents: names - temperatures - gravity - forces and displacements - a table of nodes - together */
#include <hifdm/config.h>

#include "base/csv.h"
#include "case/config_fault.h"
#include "net/cable_pick.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define COLUMN_MAX 64
#define RISE_DOUBT_K 250.0 /* a larger rise of temperature is probably an absolute temperature */
#define COLDEST_RISE_K (-293.15)
#define LARGEST_STRAIN 0.1 /* maximum thermal strain; a larger one is an error in the case */

_Static_assert(sizeof hf_part_word / sizeof *hf_part_word == HF_PART_UNIT + HF_N_UNIT + 1, "a part for each unit");

typedef struct {
    const hf_case *c;
    const hf_scene *scene;
    const hf_truss *truss; /* NULL: no truss */
    hf_load_cases *load_cases;
    int *cable; /* [n_cable], scratch: the cables of a row */
    hf_messages *messages;
} maker;

/* ---- names ---- */

/* Lists the names of the load cases in the order of their first appearance. Returns their number. */
static int count_names(const hf_built_settings *b, const char *name[HF_LOAD_CASES_MAX])
{
    int n = 0;
    for (int i = 0; i < b->n_load_case; i++) {
        int k = 0;
        while (k < n && strcmp(name[k], b->load_case[i].name) != 0)
            k++;
        if (k == n) name[n++] = b->load_case[i].name; /* the case has been checked, so all names fit */
    }
    return n;
}

static hf_load_case *load_case_of_row(const maker *q, int row)
{
    hf_load_case *load_case = q->load_cases->load_case;
    while (strcmp(load_case->name, q->c->built.load_case[row].name) != 0)
        load_case++;
    return load_case;
}

/* ---- temperatures ---- */

static double rise_at(const hf_load_case_settings *s, const double *a, const double *b)
{
    double rise = isnan(s->temperature_K) ? 0 : s->temperature_K;
    for (int c = 0; c < 3 && !isnan(s->gradient_K_per_m[0]); c++)
        rise += s->gradient_K_per_m[c] * (a[c] + b[c]) / 2; /* at the middle of the cable or member */
    return rise;
}

static const char *temperature_key(const hf_load_case_settings *s)
{
    return isnan(s->temperature_K) ? "gradient_K_per_m" : "temperature_K";
}

static hf_status heat_cables(const maker *q, int row)
{
    const hf_load_case_settings *s = &q->c->built.load_case[row];
    const hf_scene *scene = q->scene;
    hf_load_case *load_case = load_case_of_row(q, row);
    char where[HF_LOCATION_SIZE];
    int n_unknown = 0, unknown = 0, n_wild = 0, wild = 0;
    int n = hf_cable_pick_some(scene, s->set, hf_config_place(q->c, where, "load_cases.%d.set", row), q->cable,
                               q->messages);
    for (int k = 0; k < n; k++) {
        int e = q->cable[k];
        double expansion = q->load_cases->material.expansion_per_K[e];
        load_case->rise_K[e] = rise_at(s, scene->position_m + 3 * (size_t)scene->end[2 * e],
                                       scene->position_m + 3 * (size_t)scene->end[2 * e + 1]);
        if (isnan(expansion) && n_unknown++ == 0) unknown = e;
        if (fabs(expansion * load_case->rise_K[e]) > LARGEST_STRAIN && n_wild++ == 0) wild = e;
    }
    load_case->has_temperature = true;
    if (n == 0) return HF_BAD_CASE;
    if (n_wild)
        hf_error(
            q->messages, HF_BAD_CASE,
            "%s: the lengths of %d cable%s would change by more than the fraction %g. For example, the length of cable "
            "'%s' would change by the fraction %.3g at %.6g K. Check this temperature and the value expansion_per_K",
            hf_config_place(q->c, where, "load_cases.%d.%s", row, temperature_key(s)), n_wild, n_wild == 1 ? "" : "s",
            LARGEST_STRAIN, scene->cable_id[wild],
            q->load_cases->material.expansion_per_K[wild] * load_case->rise_K[wild], load_case->rise_K[wild]);
    if (n_unknown == 0) return n_wild ? HF_BAD_CASE : HF_OK;
    return hf_error(q->messages, HF_BAD_CASE,
                    "%s: %d cable%s no thermal expansion coefficient, such as cable '%s'. In the list `cables`, "
                    "give expansion_per_K for these cables (0 for cables that do not expand)",
                    hf_config_place(q->c, where, "load_cases.%d.%s", row, temperature_key(s)), n_unknown,
                    n_unknown == 1 ? " has" : "s have", scene->cable_id[unknown]);
}

hf_status hf_config_demand_expansion(const hf_case *c, const hf_truss *t, hf_part part, const char *where,
                                     const char *other, hf_messages *messages)
{
    char location[HF_LOCATION_SIZE];
    int n = 0, n_expanding = 0;
    for (int e = 0; e < t->n_member; e++) {
        n += hf_truss_is_of(t, e, part);
        n_expanding += hf_truss_is_of(t, e, part) && t->expansion_per_K[e] != 0;
    }
    if (n == 0)
        return hf_error(messages, HF_BAD_CASE, "%s: the truss has no members of the unit '%s'", where,
                        hf_part_word[part]);
    if (!c->has_truss_import && !hf_config_location(c, "truss.expansion_per_K", location, sizeof location))
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the truss has no thermal expansion coefficient. Add the key truss.expansion_per_K (0 for "
                        "a truss that does not expand)%s",
                        where, other);
    if (n_expanding == 0 && c->has_truss_import)
        hf_warning(messages,
                   "%s: no member of the truss expands, because no member in the table has an expansion_per_K above 0",
                   where);
    return HF_OK;
}

static hf_status heat_truss(const maker *q, int row)
{
    const hf_load_case_settings *s = &q->c->built.load_case[row];
    const hf_truss *t = q->truss;
    hf_load_case *load_case = load_case_of_row(q, row);
    char where[HF_LOCATION_SIZE];
    if (!t && s->part == HF_PART_ALL) return HF_OK;
    hf_config_place(q->c, where, "load_cases.%d.%s", row, s->part == HF_PART_ALL ? temperature_key(s) : "part");
    if (!t) return hf_error(q->messages, HF_BAD_CASE, "%s: the case has no truss", where);
    for (int e = 0; e < t->n_member; e++)
        if (hf_truss_is_of(t, e, s->part))
            load_case->member_rise_K[e] =
                rise_at(s, t->position_m + 3 * (size_t)t->end[2 * e], t->position_m + 3 * (size_t)t->end[2 * e + 1]);
    return hf_config_demand_expansion(q->c, t, s->part, where, ", or part: net for a temperature of the cables alone",
                                      q->messages);
}

static hf_status heat(const maker *q, int row)
{
    const hf_load_case_settings *s = &q->c->built.load_case[row];
    bool of_net = *s->set || s->part == HF_PART_ALL || s->part == HF_PART_NET;
    if (isnan(s->temperature_K) && isnan(s->gradient_K_per_m[0])) return HF_OK;
    if (s->temperature_K > RISE_DOUBT_K || s->temperature_K < COLDEST_RISE_K) {
        char where[HF_LOCATION_SIZE];
        hf_warning(q->messages, "%s: %g K is the rise from the temperature at which the cables were cut. %s",
                   hf_config_place(q->c, where, "load_cases.%d.temperature_K", row), s->temperature_K,
                   s->temperature_K > 0 ? "If it is an absolute temperature, subtract that temperature"
                                        : "Cables cut at 20 degC would be below absolute zero");
    }
    if (of_net) HF_TRY(heat_cables(q, row));
    return *s->set || s->part == HF_PART_NET ? HF_OK : heat_truss(q, row);
}

/* ---- gravity ---- */

static hf_status weigh(const maker *q, int row)
{
    static const double down[3] = {0, 0, -1};
    const hf_load_case_settings *s = &q->c->built.load_case[row];
    const double *along = isnan(s->direction[0]) ? down : s->direction;
    char where[HF_LOCATION_SIZE];
    int n_unknown = 0, unknown = 0;
    if (isnan(s->gravity_m_per_s2)) return HF_OK;
    double length = sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
    for (int c = 0; c < 3; c++)
        load_case_of_row(q, row)->gravity_m_per_s2[c] = s->gravity_m_per_s2 * along[c] / length;
    for (int e = 0; e < q->scene->n_cable; e++)
        if (isnan(q->load_cases->material.mass_kg_per_m[e]) && n_unknown++ == 0) unknown = e;
    if (n_unknown == 0) return HF_OK;
    return hf_error(q->messages, HF_BAD_CASE,
                    "%s: %d cable%s no mass per length, such as cable '%s'. In the list `cables`, give "
                    "mass_kg_per_m for these cables (0 for cables without mass)",
                    hf_config_place(q->c, where, "load_cases.%d.gravity_m_per_s2", row), n_unknown,
                    n_unknown == 1 ? " has" : "s have", q->scene->cable_id[unknown]);
}

/* ---- forces and displacements ---- */

static hf_status push(const maker *q, int row)
{
    const hf_load_case_settings *s = &q->c->built.load_case[row];
    hf_load_case *load_case = load_case_of_row(q, row);
    char where[HF_LOCATION_SIZE];
    int n = 0;
    for (int i = 0; i < q->scene->n_node; i++) {
        bool is_support = q->scene->role[i] == HF_ROLE_SUPPORT;
        bool is_pushed = !isnan(s->force_N[0]) && hf_material_names(s->role, q->scene->role[i]);
        for (int c = 0; c < 3; c++) {
            if (is_pushed) load_case->force_N[3 * i + c] += s->force_N[c];
            if (is_support && !isnan(s->support_displacement_m[0]))
                load_case->support_displacement_m[3 * i + c] += s->support_displacement_m[c];
        }
        n += is_pushed;
    }
    if (isnan(s->force_N[0]) || n > 0) return HF_OK;
    return hf_error(q->messages, HF_BAD_CASE, "%s: this net has no %s nodes",
                    hf_config_place(q->c, where, "load_cases.%d.role", row), hf_nodes_word[s->role]);
}

/* ---- a table of nodes ---- */

enum { ROW_ID, ROW_FORCE, ROW_MOVE = ROW_FORCE + 3, N_ROW_COLUMN = ROW_MOVE + 3 };
static const char *const row_column[N_ROW_COLUMN] = {"id", "Fx_N", "Fy_N", "Fz_N", "dx_m", "dy_m", "dz_m"};

/* Adds a row of the table to the load case. Empty cells are 0. */
static void add_node(hf_csv *t, const int *where, int r, const hf_scene *s, hf_load_case *load_case)
{
    const char *id = hf_csv_cell(t, r, where[ROW_ID]);
    int i = hf_csv_find_known(t, id);
    if (i < 0) {
        hf_csv_fault(t, t->line[r], id, "the net has no node with this id", "");
        return;
    }
    for (int k = ROW_FORCE; k < N_ROW_COLUMN; k++) {
        if (where[k] < 0 || !*hf_csv_cell(t, r, where[k])) continue;
        double value = hf_csv_number(t, r, where[k], id, row_column[k]);
        double *to = k < ROW_MOVE ? load_case->force_N + 3 * i + (k - ROW_FORCE)
                                  : load_case->support_displacement_m + 3 * i + (k - ROW_MOVE);
        if (k >= ROW_MOVE && value != 0 && s->role[i] != HF_ROLE_SUPPORT)
            hf_csv_fault(t, t->line[r], id, "is no support, so it has no place to be moved to: ", row_column[k]);
        *to += value;
    }
}

static hf_status read_table(hf_csv *t, const hf_scene *s, hf_load_case *load_case)
{
    int where[N_ROW_COLUMN], n_known = 0;
    HF_TRY(hf_csv_read(t->path, COLUMN_MAX, t, t->messages));
    HF_TRY(hf_csv_find_columns(t, row_column, N_ROW_COLUMN, ROW_FORCE, where));
    for (int k = ROW_FORCE; k < N_ROW_COLUMN; k++)
        n_known += where[k] >= 0;
    if (n_known == 0)
        return hf_error(
            t->messages, HF_BAD_CASE,
            "%s:%d: the table gives no loads, because it has none of the columns Fx_N, Fy_N, Fz_N, dx_m, dy_m, dz_m",
            t->path, t->header_line);
    HF_TRY(hf_csv_index(t, where[ROW_ID]));
    HF_TRY(hf_csv_know(t, s->n_node, s->node_id));
    for (int r = 0; r < t->n_row; r++)
        add_node(t, where, r, s, load_case);
    return hf_csv_close_faults(t);
}

static hf_status read_nodes(const maker *q, int row)
{
    hf_csv table = {.path = q->c->built.load_case[row].nodes_path, .messages = q->messages};
    if (!*table.path) return HF_OK;
    hf_status status = read_table(&table, q->scene, load_case_of_row(q, row));
    hf_csv_free(&table);
    return status;
}

/* ---- together ---- */

static hf_status check_EA(const maker *q)
{
    const hf_scene *s = q->scene;
    char where[HF_LOCATION_SIZE];
    int n = 0, first = 0;
    for (int e = 0; e < s->n_cable; e++)
        if (!(s->EA_N && s->EA_N[e] > 0) && n++ == 0) first = e;
    if (n == 0) return HF_OK;
    return hf_error(
        q->messages, HF_BAD_CASE,
        "%s: %d cable%s no stiffness EA, such as '%s', but load cases of the as-built net need this stiffness. Add "
        "the keys scene.EA_inner_N and scene.EA_boundary_N, or add the column EA_N to the table of an imported net",
        hf_config_place(q->c, where, "load_cases.0.name"), n, n == 1 ? " has" : "s have", s->cable_id[first]);
}

typedef hf_status row_step(const maker *, int);

/* Reads all rows, so that one run reports the faults of all. */
static hf_status read_rows_of_load_cases(const maker *q)
{
    static row_step *const step[] = {heat, weigh, push, read_nodes};
    hf_status worst = check_EA(q);
    for (int row = 0; row < q->c->built.n_load_case; row++) {
        for (size_t k = 0; k < sizeof step / sizeof *step; k++) {
            hf_status status = step[k](q, row);
            if (status != HF_OK) worst = status;
            if (status == HF_NO_MEMORY) return status;
        }
    }
    return worst;
}

hf_status hf_config_load_cases(const hf_case *c, const hf_scene *s, const hf_truss *truss, hf_load_cases *load_cases,
                               hf_messages *messages)
{
    const char *name[HF_LOAD_CASES_MAX];
    int n = count_names(&c->built, name);
    *load_cases = (hf_load_cases){0};
    if (n == 0) return HF_OK;
    maker q = {c, s, truss, load_cases, NULL, messages};
    hf_status status = hf_load_cases_allocate(s, truss ? truss->n_member : 0, n, load_cases);
    q.cable = malloc((size_t)s->n_cable * sizeof *q.cable);
    if (status == HF_OK && !q.cable) status = HF_NO_MEMORY;
    for (int k = 0; k < n; k++)
        load_cases->load_case[k].name = name[k];
    if (status == HF_OK)
        status = hf_config_material(c, s, &load_cases->material, messages);
    else
        hf_error(messages, status, "%s: out of memory for %d load cases", c->path, n);
    if (status == HF_OK) status = read_rows_of_load_cases(&q);
    free(q.cable);
    return status;
}

/* Contents: nodes - cables - sets - together */
#include "net/scene_import.h"

#include "base/arena.h"
#include "base/csv.h"
#include <hifdm/cable_set.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COLUMN_MAX 64

/* ---- nodes ---- */

enum { NODE_ID, NODE_X, NODE_Y, NODE_Z, NODE_ROLE, NODE_FX, NODE_FY, NODE_FZ, N_NODE_COLUMN };
static const char *const node_column[N_NODE_COLUMN] = {"id", "x_m", "y_m", "z_m", "role", "Fx_N", "Fy_N", "Fz_N"};

/* Columns that `hifdm export` writes in addition. */
static const char *const node_ours[] = {"x0_m", "y0_m", "z0_m", NULL};

/* Reads the nodes. Returns true if some load is not zero. */
static bool read_nodes(hf_csv *t, const int *where, hf_scene *s)
{
    bool any_load = false;
    for (int r = 0; r < t->n_row; r++) {
        const char *id = hf_csv_cell(t, r, where[NODE_ID]);
        for (int c = 0; c < 3; c++) {
            s->position_m[3 * r + c] = hf_csv_number(t, r, where[NODE_X + c], id, node_column[NODE_X + c]);
            if (where[NODE_FX + c] < 0 || !*hf_csv_cell(t, r, where[NODE_FX + c])) continue; /* empty: no load */
            s->load_N[3 * r + c] = hf_csv_number(t, r, where[NODE_FX + c], id, node_column[NODE_FX + c]);
            any_load |= s->load_N[3 * r + c] != 0;
        }
        s->role[r] = (unsigned char)hf_csv_word(t, r, where[NODE_ROLE], id, hf_role_word, 3);
        s->node_id[r] = id;
        s->node_line[r] = t->line[r];
    }
    return any_load;
}

/* ---- cables ---- */

enum { CABLE_ID, CABLE_I, CABLE_J, CABLE_GROUP, CABLE_LAW, CABLE_VALUE, CABLE_EA, CABLE_SET, N_CABLE_COLUMN };
static const char *const cable_column[N_CABLE_COLUMN] = {"id", "i", "j", "group", "law", "value", "EA_N", "set"};

/* Columns of the tables that hifdm writes. The last three are in cut lists of versions before 0.3. */
static const char *const cable_ours[] = {"tension_N",    "length_m",
                                         "q_N_per_m",    "unstressed_length_m",
                                         "elongation_m", "unstressed_minus_target_m",
                                         "l0_m",         "l0_minus_theory_m",
                                         "adjustment_m", NULL};

/* Returns true if every cable has a value. Only then are the columns in cable_ours ignored silently. If a value is
 * empty, the user may expect that one of these columns replaces it. */
static bool has_values(const hf_csv *t)
{
    int column = hf_csv_column(t, "value");
    for (int r = 0; column >= 0 && r < t->n_row; r++)
        if (!*hf_csv_cell(t, r, column)) return false;
    return column >= 0;
}

static void read_target(hf_csv *t, const int *where, int r, const char *id, hf_scene *s)
{
    hf_law law = s->law[r];
    double length_at_target_m = hf_scene_length_at_target(s, r), given = NAN;
    bool is_given = *hf_csv_cell(t, r, where[CABLE_VALUE]);
    if (is_given) given = hf_csv_number(t, r, where[CABLE_VALUE], id, "value");
    s->target[r] = is_given ? given : hf_law_default_target(law, length_at_target_m);
    char text[HF_LAW_FAULT_SIZE];
    const char *fault = is_given && isnan(given) ? NULL : hf_law_target_fault(law, given, length_at_target_m, text);
    if (fault) hf_csv_fault(t, t->line[r], id, fault, "");
}

static void read_EA(hf_csv *t, const int *where, int r, const char *id, const double group_EA_N[2], hf_scene *s)
{
    bool is_given = where[CABLE_EA] >= 0 && *hf_csv_cell(t, r, where[CABLE_EA]);
    double EA_N = group_EA_N[s->group[r]] > 0 ? group_EA_N[s->group[r]] : (double)NAN;
    if (is_given) {
        EA_N = hf_csv_number(t, r, where[CABLE_EA], id, "EA_N");
        if (EA_N <= 0) hf_csv_fault(t, t->line[r], id, "EA_N must be above zero", "");
    } else if (isnan(EA_N) && hf_law_has(s->law[r], HF_LAW_NEEDS_EA)) {
        char text[HF_LAW_FAULT_SIZE];
        snprintf(text, sizeof text, "the law %s needs an EA_N", hf_law_word[s->law[r]]);
        hf_csv_fault(t, t->line[r], id, text, "");
    }
    if (s->EA_N) s->EA_N[r] = EA_N;
}

static void read_cables(hf_csv *t, const int *where, const hf_csv *nodes, const double group_EA_N[2], hf_scene *s)
{
    for (int r = 0; r < t->n_row; r++) {
        const char *id = hf_csv_cell(t, r, where[CABLE_ID]);
        s->cable_id[r] = id;
        s->cable_line[r] = t->line[r];
        for (int k = 0; k < 2; k++)
            s->end[2 * r + k] = hf_csv_reference(t, r, where[CABLE_I + k], id, "there is no node with the id ", nodes);
        s->group[r] = (unsigned char)hf_csv_word(t, r, where[CABLE_GROUP], id, hf_group_word, 2);
        s->law[r] = (unsigned char)hf_csv_word(t, r, where[CABLE_LAW], id, hf_law_word, HF_N_LAW);
        read_target(t, where, r, id, s);
        read_EA(t, where, r, id, group_EA_N, s);
    }
}

/* ---- sets ---- */

#define BETWEEN_NAMES " \t;"

typedef struct {
    const char *name; /* points into the text of the table */
    int row;
} mention;

static int count_mentions(const hf_csv *t, int column)
{
    int n = 0;
    for (int r = 0; column >= 0 && r < t->n_row; r++)
        for (const char *p = hf_csv_cell(t, r, column); *(p += strspn(p, BETWEEN_NAMES)); n++)
            p += strcspn(p, BETWEEN_NAMES);
    return n;
}

static int by_name_and_row(const void *a, const void *b)
{
    const mention *p = a, *q = b;
    int order = strcmp(p->name, q->name);
    return order ? order : (p->row > q->row) - (p->row < q->row);
}

/* Splits the cells of the column `set` into names, in the order of the rows. */
static void read_mentions(hf_csv *t, const int *where, mention *all)
{
    int n = 0;
    for (int r = 0; r < t->n_row; r++)
        for (char *p = hf_csv_cell(t, r, where[CABLE_SET]); *(p += strspn(p, BETWEEN_NAMES)); n++) {
            char *end = p + strcspn(p, BETWEEN_NAMES);
            bool is_last = *end == '\0';
            *end = '\0';
            all[n] = (mention){p, r};
            const char *fault = hf_cable_set_name_fault(p);
            if (fault) {
                char what[HF_CABLE_SET_NAME_SIZE + 16];
                snprintf(what, sizeof what, "the set '%.63s' ", p);
                hf_csv_fault(t, t->line[r], hf_csv_cell(t, r, where[CABLE_ID]), what, fault);
            }
            p = is_last ? end : end + 1;
        }
}

static hf_status read_sets(hf_csv *t, const int *where, hf_scene *s)
{
    int n = count_mentions(t, where[CABLE_SET]), n_set = 0;
    if (n == 0) return HF_OK;
    mention *all;
    const char **name;
    hf_cable_set_member *member;
    void *block;
    HF_TRY(HF_ARENA_ARRAYS(&block, HF_ARRAY(all, n), HF_ARRAY(name, n), HF_ARRAY(member, n)));
    read_mentions(t, where, all);
    qsort(all, (size_t)n, sizeof *all, by_name_and_row);
    for (int k = 0; k < n; k++) {
        bool is_same = k > 0 && !strcmp(all[k].name, all[k - 1].name);
        int row = all[k].row;
        if (!is_same) name[n_set++] = all[k].name;
        if (is_same && row == all[k - 1].row)
            hf_csv_fault(t, t->line[row], s->cable_id[row], "stands twice in the set ", all[k].name);
        member[k] = (hf_cable_set_member){n_set - 1, row};
    }
    hf_status status = t->n_fault == 0 ? hf_cable_set_make(s, n_set, name, n, member) : HF_OK;
    hf_arena_free_block(block);
    return status;
}

/* ---- together ---- */

static hf_status build(hf_csv *nodes, hf_csv *cables, const double group_EA_N[2], hf_scene *s)
{
    int node_where[N_NODE_COLUMN] = {0}, cable_where[N_CABLE_COLUMN] = {0}; /* cppcheck needs values here */
    /* Both files are read before returning, so that one run reports the faults of both. */
    hf_status node_status = hf_csv_read(nodes->path, COLUMN_MAX, nodes, nodes->messages);
    hf_status cable_status = hf_csv_read(cables->path, COLUMN_MAX, cables, cables->messages);
    nodes->ours = node_ours;
    if (cable_status == HF_OK && has_values(cables)) cables->ours = cable_ours;
    if (node_status == HF_OK) node_status = hf_csv_find_columns(nodes, node_column, N_NODE_COLUMN, NODE_FX, node_where);
    if (cable_status == HF_OK)
        cable_status = hf_csv_find_columns(cables, cable_column, N_CABLE_COLUMN, CABLE_EA, cable_where);
    HF_TRY(node_status);
    HF_TRY(cable_status);
    bool with_load = node_where[NODE_FX] >= 0 || node_where[NODE_FY] >= 0 || node_where[NODE_FZ] >= 0;
    bool with_EA = cable_where[CABLE_EA] >= 0 || group_EA_N[0] > 0 || group_EA_N[1] > 0;
    if (hf_scene_allocate(s, nodes->n_row, cables->n_row, with_load, with_EA, true) != HF_OK)
        return hf_csv_no_memory(nodes);
    HF_TRY(hf_csv_index(nodes, node_where[NODE_ID]));
    HF_TRY(hf_csv_index(cables, cable_where[CABLE_ID]));
    if (!read_nodes(nodes, node_where, s)) s->load_N = NULL; /* columns of zeros are no load */
    read_cables(cables, cable_where, nodes, group_EA_N, s);
    if (read_sets(cables, cable_where, s) != HF_OK) return hf_csv_no_memory(cables);
    node_status = hf_csv_close_faults(nodes);
    cable_status = hf_csv_close_faults(cables);
    HF_TRY(node_status);
    HF_TRY(cable_status);
    s->nodes_file = nodes->path;
    s->cables_file = cables->path;
    /* The ids point into the texts of the two tables. They move to one block that the scene owns. */
    const hf_csv_texts all[] = {
        {&s->nodes_file, 1}, {&s->cables_file, 1}, {s->node_id, s->n_node}, {s->cable_id, s->n_cable}};
    s->text = hf_csv_keep(4, all);
    return s->text ? HF_OK : hf_csv_no_memory(nodes);
}

hf_status hf_scene_import(const char *nodes_path, const char *cables_path, const double group_EA_N[2], hf_scene *scene,
                          hf_messages *messages)
{
    *scene = (hf_scene){0};
    hf_csv nodes = {.path = nodes_path, .messages = messages}, cables = {.path = cables_path, .messages = messages};
    hf_status status = build(&nodes, &cables, group_EA_N, scene);
    hf_csv_free(&nodes);
    hf_csv_free(&cables);
    if (status != HF_OK) hf_scene_free(scene); /* its ids would point into freed text */
    return status;
}

/* Contents: nodes - members - together */
#include "truss/truss_import.h"

#include "base/csv.h"

#include <string.h>

#define COLUMN_MAX 64

/* ---- nodes ---- */

enum { NODE_ID, NODE_X, NODE_Y, NODE_Z, NODE_FIXED, NODE_MASS, N_NODE_COLUMN };
static const char *const node_column[N_NODE_COLUMN] = {"id", "x_m", "y_m", "z_m", "fixed", "mass_kg"};

static int dof_bit(const char *word, size_t length)
{
    if (length == 3 && !strncmp(word, "all", 3)) return 0x3f;
    for (int k = 0; k < HF_TRUSS_DOF; k++)
        if (length == 2 && !strncmp(word, hf_dof_word[k], 2)) return 1 << k;
    return 0;
}

static unsigned char read_fixed(hf_csv *t, int row, int column, const char *id)
{
    const char *word = hf_csv_cell(t, row, column);
    int fixed = 0;
    for (;;) {
        word += strspn(word, " \t");
        if (!*word) return (unsigned char)fixed;
        size_t length = strcspn(word, " \t");
        int bit = dof_bit(word, length);
        if (!bit) {
            hf_csv_fault(t, t->line[row], id, "fixed must be empty, all, or some of ux uy uz rx ry rz, not ", word);
            return 0;
        }
        fixed |= bit;
        word += length;
    }
}

/* Columns that `hifdm export` writes in addition. */
static const char *const node_ours[] = {"ux_m", "uy_m", "uz_m", "rx_rad", "ry_rad", "rz_rad", NULL};
static const char *const member_ours[] = {"Nx_i_N", "Vy_i_N", "Vz_i_N",  "Tx_i_Nm", "My_i_Nm", "Mz_i_Nm", "Nx_j_N",
                                          "Vy_j_N", "Vz_j_N", "Tx_j_Nm", "My_j_Nm", "Mz_j_Nm", NULL};

static void read_nodes(hf_csv *t, const int *where, hf_truss *s)
{
    for (int r = 0; r < t->n_row; r++) {
        const char *id = hf_csv_cell(t, r, where[NODE_ID]);
        for (int c = 0; c < 3; c++)
            s->position_m[3 * r + c] = hf_csv_number(t, r, where[NODE_X + c], id, node_column[NODE_X + c]);
        s->fixed[r] = read_fixed(t, r, where[NODE_FIXED], id);
        if (where[NODE_MASS] >= 0 && *hf_csv_cell(t, r, where[NODE_MASS]))
            s->mass_kg[r] = hf_csv_number(t, r, where[NODE_MASS], id, node_column[NODE_MASS]);
        s->node_id[r] = id;
        s->node_line[r] = t->line[r];
    }
}

/* ---- members ---- */

enum { MEMBER_ID, MEMBER_I, MEMBER_J, MEMBER_E, MEMBER_A, MEMBER_OPTIONAL };
#define COLUMN_NAME(name, units, otherwise, description) #name,
#define COUNT(name, units, otherwise, description) +1
enum { N_NUMBER = 0 HF_MEMBER_NUMBERS(COUNT), MEMBER_JOINT = MEMBER_E + N_NUMBER, MEMBER_UNIT, N_MEMBER_COLUMN };
static const char *const member_column[N_MEMBER_COLUMN] = {"id", "i", "j", HF_MEMBER_NUMBERS(COLUMN_NAME) "joint",
                                                           "unit"};

static int optional_word(hf_csv *t, int row, int column, const char *id, const char *const *words, int n, int otherwise)
{
    if (column < 0 || !*hf_csv_cell(t, row, column)) return otherwise;
    return hf_csv_word(t, row, column, id, words, n);
}

static void read_numbers(hf_csv *t, const int *where, int r, const char *id, hf_truss *s)
{
#define FIELD(name, units, otherwise, description) {s->name + r, otherwise},
    const struct {
        double *value, otherwise;
    } field[N_NUMBER] = {HF_MEMBER_NUMBERS(FIELD)};
#undef FIELD
    for (int k = 0; k < N_NUMBER; k++) {
        int column = where[MEMBER_E + k];
        bool required = MEMBER_E + k < MEMBER_OPTIONAL;
        *field[k].value = field[k].otherwise;
        if (required || (column >= 0 && *hf_csv_cell(t, r, column)))
            *field[k].value = hf_csv_number(t, r, column, id, member_column[MEMBER_E + k]);
    }
}

static void read_members(hf_csv *t, const int *where, const hf_csv *nodes, hf_truss *s)
{
    for (int r = 0; r < t->n_row; r++) {
        const char *id = hf_csv_cell(t, r, where[MEMBER_ID]);
        s->member_id[r] = id;
        s->member_line[r] = t->line[r];
        for (int k = 0; k < 2; k++)
            s->end[2 * r + k] =
                hf_csv_reference(t, r, where[MEMBER_I + k], id, "there is no truss node with the id ", nodes);
        read_numbers(t, where, r, id, s);
        s->joint[r] = (unsigned char)optional_word(t, r, where[MEMBER_JOINT], id, hf_joint_word, 2, HF_JOINT_RIGID);
        s->unit[r] = (unsigned char)optional_word(t, r, where[MEMBER_UNIT], id, hf_unit_word, HF_N_UNIT, HF_UNIT_OTHER);
    }
}

/* ---- together ---- */

static hf_status build(hf_csv *nodes, hf_csv *members, hf_truss *s)
{
    int node_where[N_NODE_COLUMN], member_where[N_MEMBER_COLUMN];
    /* Both files are read before returning, so that one run reports the faults of both. */
    hf_status node_status = hf_csv_read(nodes->path, COLUMN_MAX, nodes, nodes->messages);
    hf_status member_status = hf_csv_read(members->path, COLUMN_MAX, members, members->messages);
    nodes->ours = node_ours;
    members->ours = member_ours;
    if (node_status == HF_OK)
        node_status = hf_csv_find_columns(nodes, node_column, N_NODE_COLUMN, NODE_MASS, node_where);
    if (member_status == HF_OK)
        member_status = hf_csv_find_columns(members, member_column, N_MEMBER_COLUMN, MEMBER_OPTIONAL, member_where);
    HF_TRY(node_status);
    HF_TRY(member_status);
    if (hf_truss_allocate(s, nodes->n_row, members->n_row, true) != HF_OK) return hf_csv_no_memory(nodes);
    HF_TRY(hf_csv_index(nodes, node_where[NODE_ID]));
    HF_TRY(hf_csv_index(members, member_where[MEMBER_ID]));
    read_nodes(nodes, node_where, s);
    read_members(members, member_where, nodes, s);
    node_status = hf_csv_close_faults(nodes);
    member_status = hf_csv_close_faults(members);
    HF_TRY(node_status);
    HF_TRY(member_status);
    s->nodes_file = nodes->path;
    s->members_file = members->path;
    /* The ids point into the texts of the two tables. They move to one block that the truss owns. */
    const hf_csv_texts all[] = {
        {&s->nodes_file, 1}, {&s->members_file, 1}, {s->node_id, s->n_node}, {s->member_id, s->n_member}};
    s->text = hf_csv_keep(4, all);
    return s->text ? HF_OK : hf_csv_no_memory(nodes);
}

hf_status hf_truss_import(const char *nodes_path, const char *members_path, hf_truss *truss, hf_messages *messages)
{
    *truss = (hf_truss){0};
    hf_csv nodes = {.path = nodes_path, .messages = messages}, members = {.path = members_path, .messages = messages};
    hf_status status = build(&nodes, &members, truss);
    hf_csv_free(&nodes);
    hf_csv_free(&members);
    if (status != HF_OK) hf_truss_free(truss); /* its ids would point into freed text */
    return status;
}

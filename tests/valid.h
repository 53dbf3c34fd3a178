/* The invariants of a model. */
#pragma once

#include <hifdm/model.h>

/* Returns true if all indices of the model obey their invariants. */
static inline bool model_is_valid(const hf_model *m)
{
    int column = m->half_bandwidth + 1;
    if (m->n_free < 1 || m->n_free > m->n_node || m->n_band != m->n_free * column) return false;
    for (int row = 0; row < m->n_node; row++)
        if (m->node_of_row[row] < 0 || m->node_of_row[row] >= m->n_node || m->row_of_node[m->node_of_row[row]] != row)
            return false;
    for (int e = 0; e < m->n_cable; e++) {
        int a = m->end_row[2 * e], b = m->end_row[2 * e + 1], low = a < b ? a : b, high = a < b ? b : a;
        if (a == b || low < 0 || high >= m->n_node || !(m->length_m[e] > 0)) return false;
        if (m->diagonal_a[e] != (a < m->n_free ? a * column : m->n_band)) return false;
        if (m->diagonal_b[e] != (b < m->n_free ? b * column : m->n_band)) return false;
        if (high < m->n_free ? high - low > m->half_bandwidth || m->off_diagonal[e] != high - low + low * column
                             : m->off_diagonal[e] != m->n_band)
            return false;
    }
    for (int k = 0; k < m->n_variable; k++)
        if (m->variable_leader[k] < 0 || m->variable_leader[k] > k) return false;
    for (int k = 0; k < m->n_inner_node; k++)
        if (m->inner_row[k] < 0 || m->inner_row[k] >= m->n_free) return false;
    for (int k = 0; k < m->n_tie; k++)
        if (m->end_row[m->tie[k]] != m->attachment_row[m->tie_attachment[k]]) return false;
    for (int i = 0; i < m->n_attachment; i++)
        if (m->attachment_row[i] != m->n_free + i || m->attachment_row[i] >= m->n_node) return false;
    return m->chain_start[0] == 0 && (m->variable || m->n_variable <= m->n_cable);
}

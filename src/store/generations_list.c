/* Implements generations_list.h. Sections: the list, values. */
#include "store/generations_list.h"

#include <assert.h>
#include <string.h>

/* ---- the list ---- */

static void list_objectives(const hf_population *now, hf_generations_row *row)
{
    static const char *const name[] = {"objective_0", "objective_1", "objective_2"};
    _Static_assert(sizeof name / sizeof *name == HF_FRONT_OBJECTIVES_MAX, "a name for each objective");
    for (int k = 0; k < HF_FRONT_OBJECTIVES_MAX; k++) {
        hsize_t n = k < now->n_objective ? (hsize_t)now->n_individual : 0;
        row[k] = (hf_generations_row){{name[k], HF_KIND_REAL, 2, {1, n}, "", "of optimize.front, each in its own unit"},
                                      &now->result->objective[k],
                                      sizeof *now->result,
                                      sizeof(double)};
    }
}

void hf_generations_list(const hf_population *now, hf_generations_row row[HF_GENERATIONS_PIECES])
{
    const hsize_t p = (hsize_t)now->n_individual, k = (hsize_t)now->n_variable;
#define ARRAY(member) now->member, sizeof *now->member, sizeof *now->member
#define SINGLE(value) &(value), 0, sizeof(value)
    const hf_generations_row before[] = {
        {hf_layout_of_variables("design", now->has_rows, 3, (const hsize_t[3]){1, p, k}), ARRAY(design)},
        {{"evaluated",
          HF_KIND_FLAG,
          2,
          {1, p},
          "",
          "TRUE = a trial was evaluated for this individual; FALSE: its result was known"},
         ARRAY(pending)}};
    const hf_generations_row behind[] = {
        {{"trial_status", HF_KIND_STATUS, 2, {1, p}, "", "of what was proposed for this individual"},
         ARRAY(trial_status)},
        {{"trial_psi_m", HF_KIND_REAL, 2, {1, p}, "m", "the same; kept when it was not worse"}, ARRAY(trial_psi_m)},
        {{"crossover_rate", HF_KIND_REAL, 2, {1, p}, "", "that bred the individual"}, ARRAY(crossover_rate)},
        {{"mutation_rate", HF_KIND_REAL, 2, {1, p}, "", "that bred the individual"}, ARRAY(mutation_rate)},
        {{"parent", HF_KIND_INT, 3, {1, p, 2}, "", "individuals of the generation before, or -1; i, -1: i was kept"},
         ARRAY(parent)},
        {{"best_individual", HF_KIND_INT, 1, {1}, "", "-1 while none is feasible"}, SINGLE(now->best)},
        {{"best_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the generation"}, SINGLE(now->best_psi_m[now->generation])},
        {{"best_merit",
          HF_KIND_REAL,
          1,
          {1},
          "",
          "of the generation: psi, m, without an objective; the first one of a front"},
         SINGLE(now->best_merit[now->generation])},
        {{"violation_min", HF_KIND_REAL, 1, {1}, "", "0: a design is feasible; inf: none has a shape"},
         SINGLE(now->least_violation[now->generation])},
        {{"mean_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the feasible individuals"}, SINGLE(now->mean_psi_m)},
        {{"worst_psi_m", HF_KIND_REAL, 1, {1}, "m", "of the feasible individuals"}, SINGLE(now->worst_psi_m)},
        {{"n_infeasible", HF_KIND_INT, 1, {1}, "", "individuals whose status is not ok"}, SINGLE(now->n_infeasible)}};
#undef ARRAY
#undef SINGLE
    _Static_assert(sizeof before == HF_ROW_RESULT * sizeof row[0], "rows before the results");
    _Static_assert(sizeof behind == (HF_ROW_N - HF_ROW_TRIAL_STATUS) * sizeof row[0], "rows behind the results");
    const hf_result_field *field[HF_RESULT_N_INDIVIDUAL];
    hf_result_list_individual(field);
    memcpy(row, before, sizeof before);
    for (int i = 0; i < HF_RESULT_N_INDIVIDUAL; i++) {
        const hf_result_field *f = field[i];
        row[HF_ROW_RESULT + i] =
            (hf_generations_row){{f->name, hf_layout_kind_of(f), 2, {1, p}, f->units ? f->units : "", f->description},
                                 (const char *)now->result + f->offset,
                                 sizeof *now->result,
                                 f->size};
    }
    list_objectives(now, row + HF_ROW_OBJECTIVE);
    memcpy(row + HF_ROW_TRIAL_STATUS, behind, sizeof behind);
    assert(!strcmp(row[HF_ROW_STATUS].array.name, "status") && !strcmp(row[HF_ROW_PSI].array.name, "psi_m") &&
           !strcmp(row[HF_ROW_BEST_INDIVIDUAL].array.name, "best_individual") &&
           !strcmp(row[HF_ROW_BEST_PSI].array.name, "best_psi_m") &&
           !strcmp(row[HF_ROW_BEST_MERIT].array.name, "best_merit") &&
           !strcmp(row[HF_ROW_TRIAL_STATUS].array.name, "trial_status") &&
           !strcmp(row[HF_ROW_VIOLATION].array.name, "violation_min"));
}

void hf_generations_list_empty(const hf_generations *g, int n_individual, hf_generations_row row[HF_GENERATIONS_PIECES])
{
    hf_form_result nothing = {0};
    double none = 0;
    const hf_population empty = {.n_individual = n_individual,
                                 .n_variable = g->n_variable,
                                 .n_objective = g->n_objective,
                                 .has_rows = g->has_rows,
                                 .result = &nothing,
                                 .best_psi_m = &none,
                                 .best_merit = &none,
                                 .least_violation = &none};
    hf_generations_list(&empty, row);
}

/* ---- values ---- */

const char *const hf_generations_count_name[HF_GENERATIONS_COUNTS] = {"n_evaluation", "n_evaluation_infeasible",
                                                                      "n_evaluation_above_cap"};

void hf_generations_tally(const hf_population *p, int sign, long count[HF_GENERATIONS_COUNTS])
{
    for (int i = 0; i < p->n_individual; i++) {
        count[0] += p->pending[i] ? sign : 0;
        count[1] += p->pending[i] && p->trial_status[i] != HF_OK ? sign : 0;
        count[2] += p->pending[i] && p->trial_status[i] != HF_OK && hf_status_has_shape(p->trial_status[i]) ? sign : 0;
    }
}

void hf_generations_copy(const hf_generations_row *row, size_t bytes, bool packs, char *packed)
{
    size_t each = hf_hdf5_kind_bytes(row->array.kind);
    hf_layout_copy(row->array.kind, each, row->item_bytes, row->stride, (int)(bytes / each), packs, packed,
                   (char *)row->from);
}

/* Implements the ask-and-tell interface of the optimisers, and lists the optimiser of each method of a case.
 * <hifdm/optimiser.h> describes both.
 *
 *     create -> first generation -> caller evaluates it -> tell: survivors, ranks -> next: begin, propose, end -> ...
 *
 * Contents: ask and tell - the methods of a case */
#include <hifdm/optimiser.h>

#include "search/repair.h"

#include <assert.h>
#include <stddef.h>

const char *const hf_refine_stop_word[5] = {"converged", "stalled", "max_iterations", "settled", "taken"};

/* ---- ask and tell ---- */

hf_status hf_optimiser_create(const hf_optimiser_kind *kind, const hf_optimize_settings *s, const hf_model *m,
                              const double *initial, hf_optimiser *o)
{
    *o = (hf_optimiser){.settings = s};
    HF_TRY(hf_population_create(s, m, initial, &o->population, &o->next));
    if (!kind) return HF_OK;
    o->kind = kind;
    HF_TRY(kind->create(s, m, &o->state));
    kind->first(o->state, &o->population);
    o->is_fresh = true;
    return HF_OK;
}

hf_status hf_optimiser_repair(hf_optimiser *o, const hf_evaluator *evaluator)
{
    return hf_repair_create(evaluator, &o->population, &o->repair);
}

void hf_optimiser_tell(hf_optimiser *o)
{
    if (o->is_fresh) {
        hf_population_note_trials(&o->population);
        if (o->population.generation > 0 && o->kind->survive) o->kind->survive(o->state, &o->next, &o->population);
    }
    o->is_fresh = false;
    hf_population_rank(o->settings, &o->population);
}

bool hf_optimiser_begin(hf_optimiser *optimiser)
{
    assert(optimiser->kind);
    if (optimiser->population.stop_reason != HF_POPULATION_RUNNING) return false;
    optimiser->kind->begin(optimiser->state, &optimiser->population);
    if (optimiser->repair) hf_repair_begin(optimiser->repair, &optimiser->population);
    return true;
}

void hf_optimiser_propose(hf_optimiser *optimiser, int i)
{
    optimiser->kind->propose(optimiser->state, &optimiser->population, &optimiser->next, i);
    if (optimiser->repair && optimiser->next.pending[i]) hf_repair_child(optimiser->repair, &optimiser->next, i);
}

void hf_optimiser_end(hf_optimiser *optimiser)
{
    hf_population_advance(&optimiser->population, &optimiser->next);
    optimiser->population.is_moved = optimiser->repair && hf_repair_is_active(optimiser->repair);
    optimiser->is_fresh = true;
}

bool hf_optimiser_next(hf_optimiser *optimiser)
{
    if (!hf_optimiser_begin(optimiser)) return false;
    for (int i = 0; i < optimiser->population.n_individual; i++)
        hf_optimiser_propose(optimiser, i);
    hf_optimiser_end(optimiser);
    return true;
}

void hf_optimiser_free(hf_optimiser *optimiser)
{
    if (optimiser->kind) optimiser->kind->free(optimiser->state);
    hf_repair_free(optimiser->repair);
    hf_population_free(&optimiser->population);
    *optimiser = (hf_optimiser){0};
}

/* ---- the methods of a case ---- */

const hf_optimiser_kind hf_optimiser_none = {0};

hf_optimiser_plan hf_optimiser_plan_of(const hf_optimize_settings *settings)
{
#define ROW(name, optimiser, ends_with_refine) [HF_OPTIMIZE_##name] = {&hf_optimiser_##optimiser, ends_with_refine},
    static const hf_optimiser_plan plan[] = {HF_OPTIMISER_LIST(ROW)};
#undef ROW
    hf_optimiser_plan it = plan[settings->method];
    assert(it.kind); /* every method has a row in HF_OPTIMISER_LIST */
    if (it.kind == &hf_optimiser_none) it.kind = NULL;
    if (it.kind && settings->n_front) it.kind = &hf_optimiser_nsga;
    return it;
}

#include "search/trade_meet.h"

#include "search/polish.h"

#define WEIGHT 1e-4 /* of `least`, both in parts of their ranges: the other rises by the square of that */

hf_status hf_trade_meet(const hf_trade *t, int met, int least, const double *range, double *design, hf_workspace *w)
{
    hf_evaluator evaluator = *t->evaluator;
    hf_goals goals = *evaluator.goals;
    hf_polish_result result;
    for (int k = 0; k < goals.n_goal; k++)
        goals.goal[k].wanted.weight = k == met ? 1 : k == least ? WEIGHT * range[met] / range[least] : 0;
    evaluator.goals = &goals;
    hf_status status = hf_polish_run(&evaluator, t->lower, t->upper, t->max_iterations, NULL, design, w, &result);
    return status == HF_NO_MEMORY || status == HF_INTERRUPTED ? status : HF_OK;
}

/* trade_meet - the end of a front at which an objective is met, such as even tensions (METHOD section 7): its size has
 * no slope there that a limit could follow, its squares have. */
#ifndef HIFDM_TRADE_MEET_H
#define HIFDM_TRADE_MEET_H

#include "search/trade.h"

/* To replace the design [n_gene]: the objective `least` while the objective `met` rises by some 1e-8 of its
 * range, by the least sum of their squares with little weight of the former. range: of each objective. HF_OK, also
 * where the design stays as it is; HF_NO_MEMORY or HF_INTERRUPTED. */
hf_status hf_trade_meet(const hf_trade *trade, int met, int least, const double *range, double *design,
                        hf_workspace *w);

#endif

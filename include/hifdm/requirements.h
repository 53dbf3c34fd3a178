/* requirements - the verdicts on the rows of `requirements` (METHOD section 14).
 * Stability: internal. This header may change in any version.
 *
 * A row bounds a figure of the nominal net or, with a share, of the as-built samples, in one or several load cases. The
 * margin of a value is its signed distance from the nearer bound, in the unit of the figure. A value outside the bounds
 * has a negative margin. The margin of a net is the minimum over the load cases of the row. */
#pragma once

#include <hifdm/api.h>
#include <hifdm/settings.h>
#include <stddef.h>

HF_API_BEGIN

/* X(name, word). The verdict on a row. HF_VERDICT_NONE: there is no row, or no verdict yet. */
#define HF_VERDICTS(X) X(PASS, "pass") X(FAIL, "fail") X(UNDECIDED, "undecided") X(NONE, "none")
#define HF_VERDICT_ENUMERATOR(name, word) HF_VERDICT_##name,
typedef enum { HF_VERDICTS(HF_VERDICT_ENUMERATOR) HF_VERDICT_N } hf_verdict;
#undef HF_VERDICT_ENUMERATOR
extern const char *const hf_verdict_word[HF_VERDICT_N];

#define HF_REQUIREMENT_ITEM_SIZE 256 /* size in bytes of the id of a cable or node */

/* X(kind, type, member, size, description) defines a member of hf_requirement_verdict, also in HDF5 and JSON. Values
 * and margins are in the unit of the figure. */
#define HF_VERDICT_LIST(X)                                                                                             \
    X(REAL, double, value, , "of the nominal net, or of the share")                                                    \
    X(REAL, double, bound, , "the bound that the value is relatively nearer to")                                       \
    X(REAL, double, margin, , "signed distance of the value from that bound; negative: not met")                       \
    X(REAL, double, relative_margin, , "margin relative to that bound; NaN: the bound is 0")                           \
    X(REAL, double, error_bound, , "of the value of the nominal net; NaN: not known")                                  \
    X(REAL, double, yield, , "share of the samples that meet the row")                                                 \
    X(REAL, double, yield_low, , "95 % interval of the yield: its lower end")                                          \
    X(REAL, double, yield_high, , "95 % interval of the yield: its upper end")                                         \
    X(LONG, long, worst_sample, , "sample with the minimum margin, from 0; -1: the nominal net")                       \
    X(REAL, double, worst_margin, , "margin of the worst net")                                                         \
    X(REAL, double, worst_value, , "value of the worst net")                                                           \
    X(CHARS, char, worst_load_case, [HF_SET_NAME_SIZE], "load case of the worst value")                                \
    X(CHARS, char, worst_item, [HF_REQUIREMENT_ITEM_SIZE], "cable or support of the worst value; empty: none")

/* Contains the verdict on a row. NaN means that a number does not exist or is not known.
 *
 * Without a share, `value` is the value of the nominal net with the minimum margin, and error_bound is the bound of its
 * numerical error. If the margin is within error_bound of 0, the verdict is undecided. With a share, `margin` is the
 * quantile: the given share of the samples has at least this margin. The confidence interval of the yield contains the
 * true yield with a probability of 95 %. If it contains the share, the verdict is undecided. The worst net is the
 * nominal net or the sample with the minimum margin. */
typedef struct {
    hf_requirement_settings row; /* the row */
    hf_verdict verdict;
#define HF_VERDICT_MEMBER(kind, type, member, size, description) type member size;
    HF_VERDICT_LIST(HF_VERDICT_MEMBER)
#undef HF_VERDICT_MEMBER
} hf_requirement_verdict;

/* What verdicts amount to. Designs and points rank by it (METHOD section 14). */
typedef struct {
    int n_required, n_failed, n_undecided; /* numbers of rows with a verdict, of failed and of undecided ones */
    /* Over the rows with a verdict. NaN: none has a relative margin, or only a row with the bound 0 fails, because a
     * positive margin would deny the failure. */
    double relative_margin_min;
} hf_judgement;

hf_judgement hf_requirements_judge(int n, const hf_requirement_verdict *verdict);

/* Returns the verdict: fail if a row fails, else undecided if a row is undecided, else pass. Returns HF_VERDICT_NONE if
 * no row has a verdict. */
hf_verdict hf_judgement_verdict(const hf_judgement *judgement);

/* Returns a negative number if a ranks before b, a positive one if it ranks after b, and 0 if they are equal. Fewer
 * failed rows are better, then fewer undecided ones, then a larger minimum of the relative margins, which NaN leaves
 * out. A judgement without a verdict ranks last, because it is not known to pass. */
int hf_judgement_compare(const hf_judgement *a, const hf_judgement *b);

/* Writes what a row is about to text[size], such as "tension of ties, all load cases, 95 % of samples". Returns
 * text. */
const char *hf_requirement_name(const hf_requirement_settings *row, char *text, size_t size);

HF_API_END

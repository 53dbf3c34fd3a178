/* unit_cube - the designs of a case as points of the unit cube, which is what other people's optimisers work on: a
 * variable in [0, 1] per gene, or per chain of boundary cables, is the place between the bounds. */
#ifndef HIFDM_TOOLS_UNIT_CUBE_HPP
#define HIFDM_TOOLS_UNIT_CUBE_HPP

#include <hifdm/hifdm.h>

#include <cmath>
#include <cstdio>
#include <vector>

namespace {

hf_problem problem;
std::vector<double> lower, upper; /* of each gene */

int genes()
{
    return problem.model.n_variable;
}

int variables(bool by_chain)
{
    return by_chain ? problem.model.n_variable_group : genes();
}

/* Opens the case argv[1] with the overrides of its options --set, which begin at argv[first], on one thread. Returns 0,
 * or the exit status after a message. */
int open_problem(int argc, char **argv, int first)
{
    std::vector<const char *> set;
    hf_messages said{};
    for (int i = first; i + 1 < argc; i += 2)
        set.push_back(argv[i + 1]);
    hf_status status = hf_problem_open(argv[1], set.data(), (int)set.size(), 1, &problem, &said);
    if (status == HF_OK)
        hf_batch_share(&problem.batch, problem.initial);
    else
        std::fprintf(stderr, "%s%s: %s\n", said.text ? said.text : "", argv[1], hf_status_text(status));
    hf_messages_free(&said);
    return status == HF_OK ? 0 : hf_status_exit_code(status);
}

void take_bounds(const hf_population &p)
{
    lower.assign(p.lower, p.lower + genes());
    upper.assign(p.upper, p.upper + genes());
}

void make_design(const double *v, bool by_chain, double *design)
{
    for (int k = 0; k < genes(); k++) {
        double place = std::fmin(1, std::fmax(0, v[by_chain ? problem.model.variable_group[k] : k]));
        design[k] = lower[k] + place * (upper[k] - lower[k]);
    }
}

std::vector<double> make_variables(const double *design, bool by_chain)
{
    std::vector<double> v(variables(by_chain));
    for (int k = genes() - 1; k >= 0; k--) {
        double width = upper[k] - lower[k], place = width > 0 ? (design[k] - lower[k]) / width : 0.5;
        v[by_chain ? problem.model.variable_group[k] : k] = place;
    }
    return v;
}

} // namespace

#endif

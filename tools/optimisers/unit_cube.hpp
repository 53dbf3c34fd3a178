/* unit_cube - the designs of a case as points of the unit cube, which is what other people's optimisers work on: a
 * variable in [0, 1] per gene, or per chain of boundary cables, is the place between the bounds. */
#ifndef HIFDM_TOOLS_UNIT_CUBE_HPP
#define HIFDM_TOOLS_UNIT_CUBE_HPP

#include <hifdm/hifdm.h>

#include <cmath>
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

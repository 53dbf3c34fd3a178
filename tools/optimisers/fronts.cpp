/* fronts - pagmo's NSGA-II on the objectives of a case, beside ours.
 *
 *     fronts CASE SEEDS EVALUATIONS[,EVALUATIONS]... [--set KEY=VALUE]...
 *
 * Both see the same objectives, evaluated by the library as `hifdm run` evaluates its individuals, and begin with the
 * same 100 designs. A design beyond its limits costs 1e6 and as much times its violation, one without a shape 1e12, in
 * each objective: pagmo's knows no limits. It is also tried with one variable per chain of boundary cables, all cables
 * of which then take the same step.
 *
 * CSV: optimiser, variables (gene or chain), seed, evaluations, and the objectives of an individual of the population
 * that has taken so many evaluations, at most; 0: of the first one. */
#include "unit_cube.hpp"

#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/nsga2.hpp>
#include <pagmo/batch_evaluators/member_bfe.hpp>
#include <pagmo/bfe.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr int population = 100; /* pagmo's needs a multiple of four */

std::vector<long> budgets;

size_t objectives()
{
    return (size_t)problem.settings.optimize.n_front;
}

double cost(const hf_form_result &r, size_t j)
{
    return r.status == HF_OK ? r.objective[j] : hf_status_has_shape(r.status) ? 1e6 * (1 + r.violation) : 1e12;
}

void report(const char *name, bool by_chain, unsigned seed, long evaluations, const std::vector<std::vector<double>> &f)
{
    for (const auto &point : f) {
        std::printf("%s,%s,%u,%ld", name, by_chain ? "chain" : "gene", seed, evaluations);
        for (double value : point)
            std::printf(",%.12g", value);
        std::printf("\n");
    }
}

/* ---- ours ---- */

struct ours { /* with its own memory */
    hf_optimize_settings settings = problem.settings.optimize;
    hf_optimiser o{};

    explicit ours(unsigned seed)
    {
        settings.seed = seed;
        settings.population = population;
        settings.generations = 100000;
        if (hf_optimiser_create(&hf_optimiser_nsga, &settings, &problem.model, problem.initial, &o) != HF_OK)
            std::exit(5);
    }
    ours(const ours &) = delete;
    ~ours() { hf_optimiser_free(&o); }
};

std::vector<std::vector<double>> values_of(const hf_population *p)
{
    std::vector<std::vector<double>> f((size_t)p->n_individual);
    for (int i = 0; i < p->n_individual; i++)
        for (size_t j = 0; j < objectives(); j++)
            f[(size_t)i].push_back(cost(p->result[i], j));
    return f;
}

/* What a generation would need more than there is left of the evaluations is not begun. */
void evolve(unsigned seed)
{
    ours mine(seed);
    hf_population *p = &mine.o.population;
    size_t next = 0;
    for (;;) {
        hf_batch_run(&problem.batch, p->n_individual, p->design, p->pending, p->result);
        hf_optimiser_tell(&mine.o);
        if (p->generation == 0) report("ours", false, seed, 0, values_of(p));
        for (; next < budgets.size() && p->n_evaluation + population > budgets[next]; next++)
            report("ours", false, seed, budgets[next], values_of(p));
        if (next == budgets.size() || !hf_optimiser_next(&mine.o)) return;
    }
}

/* ---- pagmo's ---- */

struct function { /* as pagmo wants it */
    bool by_chain = false;
    pagmo::vector_double::size_type get_nobj() const { return objectives(); }
    pagmo::vector_double batch_fitness(const pagmo::vector_double &v) const
    {
        size_t n_variable = (size_t)variables(by_chain), n = v.size() / n_variable;
        std::vector<double> design(n * (size_t)genes());
        std::vector<hf_form_result> result(n);
        pagmo::vector_double f;
        for (size_t i = 0; i < n; i++)
            make_design(&v[i * n_variable], by_chain, &design[i * (size_t)genes()]);
        hf_batch_run(&problem.batch, (int)n, design.data(), nullptr, result.data());
        for (const auto &r : result)
            for (size_t j = 0; j < objectives(); j++)
                f.push_back(cost(r, j));
        return f;
    }
    pagmo::vector_double fitness(const pagmo::vector_double &v) const { return batch_fitness(v); }
    std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const
    {
        return {pagmo::vector_double(variables(by_chain), 0), pagmo::vector_double(variables(by_chain), 1)};
    }
};

void evolve_pagmo(bool by_chain, unsigned seed)
{
    ours start(seed);
    pagmo::population p{pagmo::problem{function{by_chain}}, 0, seed};
    for (int i = 0; i < population; i++)
        p.push_back(make_variables(start.o.population.design + (size_t)i * genes(), by_chain));
    long used = population;
    for (size_t b = 0; b < budgets.size(); b++) {
        long n = (budgets[b] - used) / population; /* generations; it goes on with the population it is given */
        pagmo::nsga2 method((unsigned)n, 0.95, 10., 0.01, 50., seed + 1000 * (unsigned)b);
        method.set_bfe(pagmo::bfe{pagmo::member_bfe{}});
        p = pagmo::algorithm{method}.evolve(p);
        used += n * population;
        report("pagmo nsga2", by_chain, seed, budgets[b], p.get_f());
    }
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 4) {
        std::fprintf(stderr, "usage: fronts CASE SEEDS EVALUATIONS[,EVALUATIONS]... [--set KEY=VALUE]...\n");
        return 2;
    }
    for (const char *text = argv[3]; *text;) {
        char *end;
        budgets.push_back(std::strtol(text, &end, 10));
        if (end == text || budgets.back() < population) return 2;
        text = end + (*end == ',');
    }
    if (int code = open_problem(argc, argv, 4)) return code;
    if (objectives() == 0) {
        std::fprintf(stderr, "%s: has no optimize.front\n", argv[1]);
        return 2;
    }
    take_bounds(ours(1).o.population);
    for (unsigned seed = 1; seed <= (unsigned)std::atoi(argv[2]); seed++) {
        evolve(seed);
        evolve_pagmo(false, seed);
        if (variables(true) < genes()) evolve_pagmo(true, seed);
    }
    hf_problem_free(&problem);
    return 0;
}

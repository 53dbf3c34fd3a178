/* peers - other people's optimisers on the designs of a case, beside ours.
 *
 *     peers CASE SEEDS EVALUATIONS [--set KEY=VALUE]...    all of them: CSV
 *     peers CASE serve [--set KEY=VALUE]...                for an optimiser outside, see serve()
 *
 * Every optimiser sees the same function: psi of a design in the unit cube of its bounds, evaluated by the library as
 * `hifdm run` evaluates its individuals. A design above the cap on the boundary ratio costs 1 km and its violation, one
 * without a shape 1000 km. If one of the first designs is above the cap, pagmo also gets the cap as a constraint
 * (cstrs_self_adaptive). All begin with the same 50 designs (BOBYQA with the base, the first of them). Each is also
 * tried with one variable per chain of boundary cables, all cables of which then take the same step.
 *
 * Most of them ask for one design at a time, which takes the library as long as eight. So eight runs go on at once,
 * each on a stack of its own: one that asks waits until the others have asked as well.
 *
 * CSV without a head: optimiser, variables (gene or chain), seed, evaluations of the run, and for each design that was
 * better than all before it two columns: its evaluation, counted from 1, and its cost (m). */
#include "unit_cube.hpp"

#include <nlopt.hpp>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/bee_colony.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/cstrs_self_adaptive.hpp>
#include <pagmo/algorithms/de.hpp>
#include <pagmo/algorithms/de1220.hpp>
#include <pagmo/algorithms/gaco.hpp>
#include <pagmo/algorithms/pso.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <pagmo/algorithms/sade.hpp>
#include <pagmo/algorithms/sga.hpp>
#include <pagmo/algorithms/xnes.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <ucontext.h>
#include <utility>
#include <vector>

namespace
{

constexpr int population = 50, at_a_time = 8;
constexpr size_t stack_bytes = 8 << 20;

double cost_m(const hf_form_result &r)
{
    return r.status == HF_OK ? r.psi_m : r.status == HF_RATIO_CAP ? 1e3 + r.violation : 1e6;
}

/* ---- runs ---- */

struct spent {
}; /* thrown when the evaluations of a run are used up */

struct run {
    std::string name;
    bool by_chain;
    unsigned seed;
    long limit;
    std::function<void(run &)> work;
    long used = 0;
    double best_m = INFINITY;
    std::vector<std::pair<long, double>> improvements{}; /* evaluation and cost (m) of each new best */
    /* of one that asks for a design at a time */
    std::vector<double> design{}, stack{};
    hf_form_result result{};
    ucontext_t here{};
    bool has_ended = false;

    void note(double cost)
    {
        if (used >= limit) throw spent();
        used++;
        if (!(cost < best_m)) return;
        best_m = cost;
        improvements.emplace_back(used, cost);
    }

    const hf_form_result &evaluate(const double *v);
    double ask(const double *v)
    {
        return cost_m(evaluate(v));
    }

    void report() const
    {
        std::printf("%s,%s,%u,%ld", name.c_str(), by_chain ? "chain" : "gene", seed, used); /* it may stop early */
        for (const auto &[at, cost] : improvements)
            std::printf(",%ld,%.17g", at, cost);
        std::printf("\n");
        std::fflush(stdout);
    }
};

ucontext_t scheduler;
run *now; /* whose stack is in use */

const hf_form_result &run::evaluate(const double *v)
{
    design.resize(genes());
    make_design(v, by_chain, design.data());
    swapcontext(&here, &scheduler);
    note(cost_m(result));
    return result;
}

void enter()
{
    run *r = now;
    try {
        r->work(*r);
    } catch (const spent &) {
    } catch (const std::exception &e) { /* BOBYQA stops by rounding: what it found counts */
        std::fprintf(stderr, "%s: %s\n", r->name.c_str(), e.what());
    }
    r->has_ended = true;
    swapcontext(&r->here, &scheduler);
}

void resume(run &r)
{
    if (r.stack.empty()) {
        r.stack.resize(stack_bytes / sizeof(double));
        getcontext(&r.here);
        r.here.uc_stack.ss_sp = r.stack.data();
        r.here.uc_stack.ss_size = stack_bytes;
        r.here.uc_link = nullptr;
        makecontext(&r.here, enter, 0);
    }
    now = &r;
    swapcontext(&scheduler, &r.here);
}

/* Evaluate what the runs ask for, and remove those that have ended. */
void evaluate(std::vector<std::unique_ptr<run>> &active)
{
    std::vector<double> design;
    std::vector<hf_form_result> result(active.size());
    for (auto &r : active)
        design.insert(design.end(), r->design.begin(), r->design.end());
    hf_batch_run(&problem.batch, (int)active.size(), design.data(), nullptr, result.data());
    for (size_t i = 0; i < active.size(); i++)
        active[i]->result = result[i];
}

void work_off(std::vector<std::unique_ptr<run>> waiting)
{
    std::vector<std::unique_ptr<run>> active;
    for (size_t next = 0; next < waiting.size() || !active.empty();) {
        if (!active.empty()) evaluate(active);
        for (auto &r : active)
            resume(*r);
        for (; active.size() < at_a_time && next < waiting.size(); next++) {
            active.push_back(std::move(waiting[next]));
            resume(*active.back());
        }
        for (size_t i = active.size(); i-- > 0;) {
            if (!active[i]->has_ended) continue;
            active[i]->report();
            active.erase(active.begin() + (long)i);
        }
    }
}

/* ---- optimisers ---- */

struct ours { /* with its own memory */
    hf_optimize_settings settings = problem.settings.optimize;
    hf_optimiser o{};

    explicit ours(unsigned seed, hf_variation variation = HF_VARIATION_DIFFERENCE)
    {
        settings.seed = seed;
        settings.population = population;
        settings.generations = settings.stagnation_generations = 100000;
        settings.variation = variation;
        if (hf_optimiser_create(&hf_optimiser_ga, &settings, &problem.model, problem.initial, &o) != HF_OK ||
            hf_optimiser_repair(&o, &problem.evaluator) != HF_OK)
            std::exit(5);
    }
    ours(const ours &) = delete;
    ~ours()
    {
        hf_optimiser_free(&o);
    }
};

void evolve(const char *name, hf_variation variation, unsigned seed, long limit)
{
    run r{name, false, seed, limit, nullptr};
    ours ga(seed, variation);
    hf_population *p = &ga.o.population;
    try {
        do {
            hf_batch_run(&problem.batch, p->n_individual, p->design, p->pending, p->result);
            for (int i = 0; i < p->n_individual; i++)
                if (p->pending[i]) r.note(cost_m(p->result[i]));
            hf_optimiser_tell(&ga.o);
        } while (hf_optimiser_next(&ga.o));
    } catch (const spent &) {
    }
    r.report();
}

struct function { /* as pagmo wants it */
    bool by_chain = false, is_constrained = false;
    pagmo::vector_double fitness(const pagmo::vector_double &v) const
    {
        const hf_form_result &r = now->evaluate(v.data());
        if (!is_constrained) return {cost_m(r)};
        double outside = r.status == HF_OK ? 0 : hf_status_has_shape(r.status) ? r.violation : 1e6;
        return {r.status == HF_OK ? r.psi_m : 1, outside}; /* a design above the cap has no psi */
    }
    pagmo::vector_double::size_type get_nic() const
    {
        return is_constrained;
    }
    std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const
    {
        return {pagmo::vector_double(variables(by_chain), 0), pagmo::vector_double(variables(by_chain), 1)};
    }
};

void evolve_pagmo(run &r, pagmo::algorithm algorithm, bool is_constrained)
{
    ours start(r.seed);
    algorithm.set_seed(r.seed);
    if (is_constrained) algorithm = pagmo::algorithm{pagmo::cstrs_self_adaptive(1, algorithm, r.seed)};
    pagmo::population p{pagmo::problem{function{r.by_chain, is_constrained}}, 0, r.seed};
    for (int i = 0; i < population; i++)
        p.push_back(make_variables(start.o.population.design + (size_t)i * genes(), r.by_chain));
    for (long before = -1; before != r.used;) { /* it may have converged */
        before = r.used;
        p = algorithm.evolve(p);
    }
}

double ask_of(unsigned, const double *v, double *, void *context)
{
    run *r = static_cast<run *>(context);
    return r->ask(v);
}

void run_bobyqa(run &r)
{
    nlopt::opt o(nlopt::LN_BOBYQA, (unsigned)variables(r.by_chain));
    o.set_lower_bounds(0);
    o.set_upper_bounds(1);
    o.set_min_objective(ask_of, &r);
    o.set_initial_step(0.1);
    o.set_maxeval((int)r.limit - 1);
    std::vector<double> v = make_variables(problem.initial, r.by_chain);
    double least;
    o.optimize(v, least);
}

/* Returns true if one of the first designs of seed 1 is above the cap. */
bool exceeds_cap()
{
    ours start(1);
    hf_population *p = &start.o.population;
    hf_batch_run(&problem.batch, p->n_individual, p->design, nullptr, p->result);
    return std::any_of(p->result, p->result + p->n_individual,
                       [](const hf_form_result &r) { return r.status == HF_RATIO_CAP; });
}

void run_all(unsigned n_seed, long limit)
{
    bool has_cap = exceeds_cap();
    std::vector<std::unique_ptr<run>> runs;
    auto add = [&](const std::string &name, bool by_chain, unsigned seed, std::function<void(run &)> work) {
        runs.emplace_back(new run{name, by_chain, seed, limit, std::move(work)});
    };
    for (unsigned seed = 1; seed <= n_seed; seed++) {
        evolve("ours", HF_VARIATION_DIFFERENCE, seed, limit);
        evolve("ours (variation chain)", HF_VARIATION_CHAIN, seed, limit);
    }
    for (bool chain : {false, true}) {
        if (chain && variables(true) == genes()) break;
        add("nlopt BOBYQA", chain, 1, run_bobyqa); /* it has no random numbers */
        auto add_pagmo = [&](const std::string &name, std::function<pagmo::algorithm()> make) {
            for (unsigned seed = 1; seed <= n_seed; seed++) {
                add("pagmo " + name, chain, seed, [make](run &r) { evolve_pagmo(r, make(), false); });
                if (has_cap && !chain)
                    add("pagmo cstrs " + name, chain, seed, [make](run &r) { evolve_pagmo(r, make(), true); });
            }
        };
        add_pagmo("sga", [] { return pagmo::algorithm{pagmo::sga(10)}; });
        add_pagmo("cmaes",
                  [] { return pagmo::algorithm{pagmo::cmaes(10, -1, -1, -1, -1, 0.05, 1e-12, 1e-16, true, true)}; });
        add_pagmo("xnes", [] { return pagmo::algorithm{pagmo::xnes(10, -1, -1, -1, 0.05, 1e-12, 1e-16, true, true)}; });
        add_pagmo("pso_gen",
                  [] { return pagmo::algorithm{pagmo::pso_gen(10, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, true)}; });
        add_pagmo("de", [] { return pagmo::algorithm{pagmo::de(10, 0.8, 0.9, 2, 1e-16, 1e-16)}; });
        add_pagmo("de1220", [] {
            return pagmo::algorithm{pagmo::de1220(10, {2, 3, 7, 10, 13, 14, 15, 16}, 1, 1e-16, 1e-16, true)};
        });
        add_pagmo("pso", [] { return pagmo::algorithm{pagmo::pso(10, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, true)}; });
        add_pagmo("gaco", [] {
            return pagmo::algorithm{pagmo::gaco(10, population, 1.0, 0.0, 0.01, 1, 7, 100000, 100000, 0.0, true)};
        });
        add_pagmo("bee_colony", [] { return pagmo::algorithm{pagmo::bee_colony(10, 20)}; });
        add_pagmo("sade", [] { return pagmo::algorithm{pagmo::sade(10, 2, 1, 1e-16, 1e-16, true)}; });
    }
    work_off(std::move(runs));
}

/* ---- an optimiser outside ---- */

bool read_all(void *to, size_t bytes)
{
    return std::fread(to, 1, bytes, stdin) == bytes;
}

void write_all(const std::vector<double> &values)
{
    std::fwrite(values.data(), sizeof(double), values.size(), stdout);
    std::fflush(stdout);
}

/* Binary, until the end of the input. Two ints: variables (0: gene, 1: chain) and n. n > 0: n designs in the unit cube
 * follow, and the answer is their n costs (m). n <= 0: the answer is the number of variables and the first 50 designs
 * of seed -n. */
void serve()
{
    int head[2];
    while (read_all(head, sizeof head)) {
        bool by_chain = head[0] != 0;
        size_t n_variable = (size_t)variables(by_chain), n = head[1] > 0 ? (size_t)head[1] : population;
        std::vector<double> v(n * n_variable), design(n * (size_t)genes()), answer;
        if (head[1] <= 0) {
            ours start((unsigned)-head[1]);
            answer.push_back((double)n_variable);
            for (size_t i = 0; i < n; i++) {
                auto one = make_variables(start.o.population.design + i * (size_t)genes(), by_chain);
                answer.insert(answer.end(), one.begin(), one.end());
            }
        } else if (read_all(v.data(), v.size() * sizeof(double))) {
            std::vector<hf_form_result> result(n);
            for (size_t i = 0; i < n; i++)
                make_design(&v[i * n_variable], by_chain, &design[i * (size_t)genes()]);
            hf_batch_run(&problem.batch, (int)n, design.data(), nullptr, result.data());
            for (const auto &r : result)
                answer.push_back(cost_m(r));
        }
        write_all(answer);
    }
}

} // namespace

int main(int argc, char **argv)
{
    bool serves = argc > 2 && !std::strcmp(argv[2], "serve");
    if (argc < 4 && !serves) {
        std::fprintf(stderr, "usage: peers CASE SEEDS EVALUATIONS [--set KEY=VALUE]...\n"
                             "       peers CASE serve [--set KEY=VALUE]...\n");
        return 2;
    }
    if (int code = open_problem(argc, argv, serves ? 3 : 4)) return code;
    take_bounds(ours(1).o.population);
    if (serves) {
        serve();
    } else {
        run_all((unsigned)std::atoi(argv[2]), std::atol(argv[3]));
    }
    hf_problem_free(&problem);
    return 0;
}

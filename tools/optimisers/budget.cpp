/* budget - other people's optimisers on a case without binding constraints, with the budget of `method: auto`.
 *
 *     budget CASE SEEDS SOLVES SECONDS [--set KEY=VALUE]...
 *
 * Each optimiser may use SOLVES form-findings, and in a second run as many as fit into SECONDS of processor time. They
 * are charged less than they take: a design as one of many in lanes, a gradient as one more design, because an adjoint
 * needs at least that, and their own mathematics not at all. nlopt's MMA and SLSQP get exact gradients of psi. Seed 1
 * begins with the initial design, each other seed with a random one of the first population of our genetic algorithm.
 *
 * The archipelago has two islands each of pagmo's de1220, sade, cmaes and pso_gen, with 20 individuals, on a ring.
 *
 * CSV without a head: optimiser, seed, "solves" or "time", form-findings used, and the lowest psi (m). */
#include "unit_cube.hpp"

#include <nlopt.hpp>
#include <pagmo/algorithm.hpp>
#include <pagmo/algorithms/cmaes.hpp>
#include <pagmo/algorithms/de1220.hpp>
#include <pagmo/algorithms/pso_gen.hpp>
#include <pagmo/algorithms/sade.hpp>
#include <pagmo/archipelago.hpp>
#include <pagmo/population.hpp>
#include <pagmo/problem.hpp>
#include <pagmo/topologies/ring.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace
{

constexpr int population = 50, island_population = 20, timed_designs = 64, timed_rounds = 15;
constexpr double no_shape_m = 1e6;

std::vector<double> first; /* [population][genes]: of this seed */

struct spent {
}; /* thrown when the budget is used up */

/* One run. The islands of an archipelago share it. */
struct account {
    double limit, used = 0, best_m = INFINITY; /* in designs */
    std::mutex mutex{};

    double note(double psi_m, double price)
    {
        used += price;
        best_m = std::fmin(best_m, psi_m);
        return psi_m;
    }
    void demand(double price)
    {
        if (used + price > limit) throw spent();
    }
} *now;

double psi_of(const double *v)
{
    std::vector<double> design((size_t)genes());
    hf_form_result r{};
    const std::lock_guard<std::mutex> lock(now->mutex);
    now->demand(1);
    make_design(v, false, design.data());
    hf_batch_run(&problem.batch, 1, design.data(), nullptr, &r);
    return now->note(r.status == HF_OK ? r.psi_m : no_shape_m, 1);
}

double without_gradient(unsigned, const double *v, double *, void *)
{
    return psi_of(v);
}

double gradient_price; /* in designs */

double with_gradient(unsigned n, const double *v, double *gradient, void *)
{
    const unsigned blocks = hf_problem_objective_blocks(&problem);
    char name[HF_OBJECTIVE_NAME_SIZE];
    hf_messages said{};
    hf_form_result r{};
    std::vector<double> design(n), residual;
    double sum = 0, price = gradient ? gradient_price : 1;
    now->demand(price);
    make_design(v, false, design.data());
    size_t rows = 0;
    for (int i = 0, some; (some = hf_problem_block(&problem, i, name)) >= 0; i++)
        rows += blocks >> i & 1 ? (size_t)some : 0;
    residual.resize(rows);
    bool ok = hf_problem_residuals(&problem, design.data(), blocks, residual.data(), nullptr, &said) == HF_OK;
    for (double one : residual)
        sum += one * one;
    double psi_m = ok ? std::sqrt(sum) : no_shape_m;
    if (gradient) {
        std::fill(gradient, gradient + n, 0.0);
        if (ok && hf_problem_vjp(&problem, design.data(), blocks, residual.data(), gradient, &said) == HF_OK)
            for (unsigned k = 0; k < n; k++)
                gradient[k] *= (upper[k] - lower[k]) / psi_m;
    }
    hf_messages_free(&said);
    hf_batch_run(&problem.batch, 1, design.data(), nullptr, &r); /* residuals know no cap */
    now->note(r.status == HF_OK ? psi_m : no_shape_m, price);
    return psi_m;
}

/* ---- optimisers ---- */

void run_nlopt(nlopt::algorithm algorithm, nlopt::func function, unsigned seed)
{
    nlopt::opt o(algorithm, (unsigned)genes());
    o.set_lower_bounds(0);
    o.set_upper_bounds(1);
    o.set_min_objective(function, nullptr);
    if (algorithm == nlopt::LN_BOBYQA) o.set_initial_step(0.1);
    o.set_ftol_rel(1e-15);
    o.set_xtol_rel(1e-12);
    const double *random = &first[(size_t)genes() * (1 + seed % (population - 1))];
    auto v = make_variables(seed == 1 ? problem.initial : random, false);
    for (double &x : v)
        x = std::fmin(1, std::fmax(0, x));
    double least;
    o.optimize(v, least);
}

struct function { /* as pagmo wants it */
    pagmo::vector_double fitness(const pagmo::vector_double &v) const
    {
        return {psi_of(v.data())};
    }
    std::pair<pagmo::vector_double, pagmo::vector_double> get_bounds() const
    {
        return {pagmo::vector_double((size_t)genes(), 0), pagmo::vector_double((size_t)genes(), 1)};
    }
};

void run_archipelago(unsigned seed)
{
    const std::vector<pagmo::algorithm> kind = {
        pagmo::algorithm{pagmo::de1220(5, {2, 3, 7, 10, 13, 14, 15, 16}, 1, 1e-16, 1e-16, true, seed)},
        pagmo::algorithm{pagmo::sade(5, 2, 1, 1e-16, 1e-16, true, seed)},
        pagmo::algorithm{pagmo::cmaes(5, -1, -1, -1, -1, 0.05, 1e-12, 1e-16, true, true, seed)},
        pagmo::algorithm{pagmo::pso_gen(5, 0.7298, 2.05, 2.05, 0.5, 5, 2, 4, true, seed)}};
    pagmo::archipelago islands{pagmo::ring{}};
    const pagmo::problem here{function{}};
    for (size_t i = 0; i < 2 * kind.size(); i++) {
        pagmo::population p{here, 0, seed + (unsigned)i};
        for (size_t k = 0; k < island_population; k++) {
            size_t at = i == 0 && k == 0 ? 0 : (i * island_population + k) % population; /* 0: the initial design */
            p.push_back(make_variables(&first[at * (size_t)genes()], false));
        }
        islands.push_back(kind[i % kind.size()], p);
    }
    for (double before = -1; before != now->used;) {
        before = now->used;
        islands.evolve(1);
        islands.wait_check();
    }
}

/* ---- runs ---- */

void take_seed(unsigned seed)
{
    hf_optimize_settings settings = problem.settings.optimize;
    hf_optimiser o{};
    settings.seed = seed;
    settings.population = population;
    if (hf_optimiser_create(&hf_optimiser_ga, &settings, &problem.model, problem.initial, &o) != HF_OK) std::exit(5);
    take_bounds(o.population);
    first.assign(o.population.design, o.population.design + (size_t)population * (size_t)genes());
    hf_optimiser_free(&o);
}

template <typename work> void run(const char *name, unsigned seed, const char *by, double limit, work &&of)
{
    account a{limit};
    now = &a;
    try {
        of(seed);
    } catch (const spent &) {
    } catch (const std::exception &) { /* nlopt says "failure" for this, and for rounding: what it found counts */
    }
    std::printf("%s,%u,%s,%.0f,%.17g\n", name, seed, by, a.used, a.best_m);
    std::fflush(stdout);
}

double processor_s()
{
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Returns the processor time of a design as one of many, s: the median of some rounds. */
double time_of_design()
{
    std::vector<double> design, took;
    std::vector<hf_form_result> r(timed_designs);
    for (size_t i = 0; i < timed_designs; i++)
        design.insert(design.end(), &first[(i % population) * (size_t)genes()],
                      &first[(i % population + 1) * (size_t)genes() - 1] + 1);
    for (int i = 0; i < timed_rounds; i++) {
        double start_s = processor_s();
        hf_batch_run(&problem.batch, timed_designs, design.data(), nullptr, r.data());
        took.push_back((processor_s() - start_s) / timed_designs);
    }
    std::sort(took.begin(), took.end());
    return took[took.size() / 2];
}

} // namespace

int main(int argc, char **argv)
{
    if (argc < 5) {
        std::fprintf(stderr, "usage: budget CASE SEEDS SOLVES SECONDS [--set KEY=VALUE]...\n");
        return 2;
    }
    if (int code = open_problem(argc, argv, 5)) return code;
    take_seed(1);
    const double designs = std::atof(argv[4]) / time_of_design();
    for (unsigned seed = 1; seed <= (unsigned)std::atoi(argv[2]); seed++) {
        take_seed(seed);
        for (bool by_time : {false, true}) {
            const char *by = by_time ? "time" : "solves";
            double limit = by_time ? designs : std::atof(argv[3]);
            gradient_price = by_time ? 2 : 1;
            run("nlopt BOBYQA", seed, by, limit, [](unsigned s) { run_nlopt(nlopt::LN_BOBYQA, without_gradient, s); });
            run("nlopt MMA", seed, by, limit, [](unsigned s) { run_nlopt(nlopt::LD_MMA, with_gradient, s); });
            run("nlopt SLSQP", seed, by, limit, [](unsigned s) { run_nlopt(nlopt::LD_SLSQP, with_gradient, s); });
            run("pagmo archipelago", seed, by, limit, run_archipelago);
        }
    }
    hf_problem_free(&problem);
    return 0;
}

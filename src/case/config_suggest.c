#include "case/config_suggest.h"

#include "case/config_key.h"

#include <ctype.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

/* A row is valid in its section and the sections below it, but not in rows of lists. Section "*" is valid everywhere.
 * The first matching row is used. */
static const struct {
    const char *section, *words, *meant;
} synonym[] = {
    {"optimize", "maxiterations iterations maxiter maxit niter nit lmiterations steps maxsteps maxfev nfev",
     "'optimize.refine_steps' (steps of Levenberg-Marquardt) or 'optimize.generations'"},
    {"optimize", "ngen gens maxgen ngenerations", "'optimize.generations'"},
    {"optimize", "pop popsize npop individuals", "'optimize.population'"},
    {"optimize", "tolerance tol ftol xtol gtol eps stagnation",
     "'optimize.stagnation_tolerance_m' and 'optimize.stagnation_generations' (of the genetic algorithm; "
     "Levenberg-Marquardt needs none)"},
    {"optimize", "algorithm optimizer optimiser", "'optimize.method'"},
    {"optimize", "bounds", "'optimize.variables' (rows with bounds), or 'optimize.range_N'"},
    {"form", "tolerance tol ftol eps", "'form.residual_tolerance'"},
    {"form", "maxiter iterations maxit niter", "'form.max_iterations'"},
    {"form", "tension force", "'form.pretension_N'"},
    {"form", "solver", "'form.method'"},
    {"tolerance", "sigma sigmam error cut", "'tolerance.sigma_cut_m'"},
    {"tolerance", "nsamples n", "'tolerance.samples'"},
    {"surface", "frequency frequencyhz frequencies freq freqs", "'surface.frequencies_Hz'"},
    {"truss", "e youngmodulus youngsmodulus modulus emodulus elasticmodulus egpa empa", "'truss.E_Pa' (in Pa)"},
    {"scene.paraboloid", "diameter diameterm d", "'scene.paraboloid.aperture_m'"},
    {"scene.paraboloid", "f focallength", "'scene.paraboloid.focal_length_m'"},
    {"scene.paraboloid", "depth depthm", "'scene.paraboloid.rear_distance_m' (between the rims of two nets)"},
    {"*", "maxiterations maxiter iterations",
     "'form.max_iterations', 'optimize.refine_steps' or 'optimize.generations'"},
    {"*", "seed randomseed rngseed", "'optimize.seed' or 'tolerance.seed'"},
    {"*", "threads nthreads numthreads cores jobs nproc workers",
     "the option --threads of the command line? A case has no key for it"},
    {"*", "ea stiffness axialstiffness", "'scene.EA_inner_N' and 'scene.EA_boundary_N' (a table: its column EA_N)"},
    {"*", "e youngmodulus youngsmodulus modulus emodulus elasticmodulus",
     "'scene.EA_inner_N' and 'scene.EA_boundary_N' (of cables, times their cross-section) or 'truss.E_Pa'"},
    {"*", "tension pretension prestressn", "'form.pretension_N'"},
    {"*", "load loads force forces",
     "'scene.import.nodes' (columns Fx_N, Fy_N, Fz_N of that table), or 'load_cases' (rows with force_N)"},
    {"*", "gravity temperature temperatures", "'load_cases' (rows with gravity_m_per_s2 or temperature_K)"},
    {"*", "material materials density",
     "'cables' (rows with mass_kg_per_m), 'scene.EA_inner_N' or 'truss.density_kg_per_m3'"},
    {"*", "focallength focallengthm f", "'scene.paraboloid.focal_length_m' or 'surface.focal_length_m'"},
    {"*", "diameter aperture aperturem", "'scene.paraboloid.aperture_m'"},
    {"*", "output out", "the option -o of the command line? A case has no key for it"},
};

/* Returns true if the key is one of these words. */
static bool is_among(const char *words, const char *key)
{
    while (*words) {
        size_t n = strcspn(words, " "), i = 0;
        const char *k = key;
        for (; *k; k++) {
            if (*k == '_' || *k == '-') continue;
            if (i >= n || tolower((unsigned char)*k) != words[i]) break;
            i++;
        }
        if (!*k && i == n) return true;
        words += n;
        words += *words == ' ';
    }
    return false;
}

const char *hf_config_suggestion(const char *section, const char *key)
{
    hf_key of;
    bool is_row = hf_key_find(section, &of) && !of.field;
    for (size_t i = 0; i < sizeof synonym / sizeof *synonym; i++) {
        size_t n = strlen(synonym[i].section);
        bool is_here = *synonym[i].section == '*' || (!strncmp(section, synonym[i].section, n) &&
                                                      (section[n] == '\0' || (section[n] == '.' && !is_row)));
        if (is_here && is_among(synonym[i].words, key)) return synonym[i].meant;
    }
    return NULL;
}

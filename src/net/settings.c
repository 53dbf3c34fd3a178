/* Words of the choices in case files. Defaults, ranges and help are in case/config_table.c. */
#include <hifdm/settings.h>

#include <stddef.h>
#include <string.h>

const char *const hf_method_word[6] = {"hifdm", "iterative_fdm", "fdm", "newton", "auto", NULL};
const char *const hf_stop_rule_word[3] = {"residual", "rms_change", NULL};
const char *const hf_rule_word[4] = {"force_density", "tension", "seeded", NULL};
const char *const hf_solver_word[5] = {"auto", "chord", "newton", "fixed_point", NULL};
#define WORD(name, word) word,
const char *const hf_optimize_method_word[HF_OPTIMIZE_N_METHOD + 1] = {HF_OPTIMIZE_METHODS(WORD) NULL};
#undef WORD
const char *const hf_coupling_scheme_word[4] = {"accelerated", "plain", "auto", NULL};
const char *const hf_feed_word[5] = {"auto", "point", "line", "plane_wave", NULL};
const char *const hf_surface_kind_word[4] = {"auto", "parabolic_cylinder", "paraboloid", NULL};
const char *const hf_keep_word[4] = {"all", "best", "every", NULL};
const char *const hf_vary_word[8] = {"tension",   "force_density",  "length",      "unstressed_length",
                                     "support_z", "support_normal", "support_xyz", NULL};
const char *const hf_figure_kind_word[12] = {"psi",  "surface",    "facets", "tension", "length", "evenness",
                                             "pull", "deflection", "mass",   "ratio",   "gain",   NULL};
const char *const hf_figure_kind_unit[11] = {"m", "m", "m", "N", "m", "", "N", "m", "kg", "", ""};
const char *const hf_aim_word[3] = {"target_positions", "design", NULL};
const char *const hf_adjust_figure_word[4] = {"psi", "surface", "facets", NULL};
const char *const hf_distribution_word[3] = {"normal", "uniform", NULL};
const char *const hf_sampling_word[3] = {"random", "sobol", NULL};
#define WORD(name, word, unit, condition, description) word,
const char *const hf_tolerance_measure_word[] = {HF_TOLERANCE_MEASURES(WORD) NULL};
#undef WORD
const char *const hf_over_word[3] = {"design", "samples", NULL};
const char *const hf_take_word[3] = {"mean", "worst", NULL};
const char *const hf_limit_word[4] = {"tension", "ratio", "deflection", NULL};
const char *const hf_part_word[11] = {"all",   "net",      "truss",    "bud",      "mbug", "abug",
                                      "other", "longeron", "vertical", "diagonal", NULL};
const char *const hf_nodes_word[5] = {"all", "support", "inner", "edge", NULL};
const char *const hf_symmetry_word[6] = {"none", "x", "y", "xy", "auto", NULL};

bool hf_objective_takes_load_cases(const hf_objective_settings *s)
{
    return !strcmp(s->load_case, "all");
}

bool hf_optimize_takes_samples(const hf_optimize_settings *s)
{
    bool takes = false;
    for (int k = 0; k < s->n_term; k++)
        takes |= s->term[k].over == HF_OVER_SAMPLES;
    for (int k = 0; k < s->n_front; k++)
        takes |= s->front[k].over == HF_OVER_SAMPLES;
    return takes;
}

/* The tables of config.h: every key of a case file with its default. The rows of generators are beside their settings,
 * in generate.h and truss.h. No other file contains defaults. */
#include "case/config_key.h"

#include <stddef.h>
#include <stdio.h>
#include <string.h>

#define AT(member) offsetof(hf_case, member)
#define BIG 1e300

const hf_section hf_section_table[] = {
    {"scene", SIZE_MAX, HF_GENERATORS_HELP},
#define SECTION(section, type, KEYS, help) {"scene." #section, AT(has_##section), help},
    HF_GENERATORS(SECTION)
#undef SECTION
        {"scene.import", AT(has_import), "Any net from two CSV files."},
    {"surface", AT(has_surface),
     "Target surface and figures of the reflecting surface. Without this section, hifdm computes no surface figures."},
    {"surface.pattern", AT(surface.has_pattern),
     "Far field, computed by physical optics over the facets at surface.frequencies_Hz. Without this section, hifdm "
     "computes no far field."},
    {"surface.pattern.feed", AT(surface.has_pattern), "The feed that illuminates the reflector."},
    {"form", SIZE_MAX, "Form-finding. Without this section, the defaults apply."},
    {"optimize", AT(has_optimize), "Optimisation. Without this section, hifdm only finds the shape."},
    {"tolerance", AT(has_tolerance),
     "Errors of cut lengths, stiffness, supports and temperature for samples of the as-built net. Without this "
     "section, hifdm computes no samples. All cables need EA."},
    {"truss", AT(has_truss),
     "The deployable truss that carries the net. Without this section, the supports are rigid. The paper gives no "
     "dimensions of the truss, so every default here is an assumption."},
    {"truss.bud", AT(has_truss), "Basic unit on the directrix: planar trusses on the module borders along x."},
    {"truss.mbug", AT(has_truss), "Main basic unit on the generatrix, along y."},
    {"truss.abug", AT(has_truss), "Assistant basic unit on the generatrix: the lines along y between the main ones."},
    {"truss.ring", AT(has_truss_ring),
     "A hoop truss under the rim of scene.paraboloid, in place of the generated units. Its material is that of the "
     "section truss. Every default is an assumption."},
    {"truss.ring.longeron", AT(has_truss_ring), "Members of the two rings."},
    {"truss.ring.vertical", AT(has_truss_ring), "Members between the rings."},
    {"truss.ring.diagonal", AT(has_truss_ring), "Members across the bays."},
    {"truss.import", AT(has_truss_import), "Any truss from two CSV files, in place of the generated units."},
    {"coupling", SIZE_MAX,
     "Coupling of the net with its truss (Fig. 17 of the paper). Without a truss, this section is not used."},
    {"adjust", AT(has_adjust),
     "Turnbuckles of the as-built net for `hifdm adjust`, which finds adjustments from measured positions."},
    {"sweep", AT(has_sweep),
     "Axes of a sweep for `hifdm sweep`, which runs the case once per point. An axis is key: [values] or key: {from, "
     "to, n}."},
};
const int hf_n_section = sizeof hf_section_table / sizeof *hf_section_table;

const hf_field hf_field_table[] = {
    {"title", HF_FIELD_TEXT, AT(title), 0, sizeof((hf_case *)0)->title, "", "", NULL, "Title in one line"},

    {"scene.EA_inner_N", HF_FIELD_DOUBLE, AT(EA_N[0]), HF_ABOVE_ZERO, 1e15, "", "N", NULL,
     "Axial stiffness EA of the inner cables to which the net gives none. Cut lengths require EA"},
    {"scene.EA_boundary_N", HF_FIELD_DOUBLE, AT(EA_N[1]), HF_ABOVE_ZERO, 1e15, "", "N", NULL,
     "Axial stiffness EA of the boundary cables to which the net gives none. Cut lengths require EA"},

#define FIELD(section, member, type, ...) {"scene." #section "." #member, type, AT(section.member), __VA_ARGS__},
#define FIELDS(section, type, KEYS, help) KEYS(FIELD, section)
    HF_GENERATORS(FIELDS)
#undef FIELDS
#undef FIELD

        {"scene.import.nodes", HF_FIELD_TEXT, AT(nodes_path), 1, HF_PATH_SIZE, NULL, "", NULL,
         "CSV file id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N] of the nodes. The path is relative to the case file"},
    {"scene.import.cables", HF_FIELD_TEXT, AT(cables_path), 1, HF_PATH_SIZE, NULL, "", NULL,
     "CSV file id,i,j,group,law,value[,EA_N,set] of the cables. The path is relative to the case file"},

    {"scene.import.facets", HF_FIELD_TEXT, AT(facets_path), 1, HF_PATH_SIZE, "", "", NULL,
     "CSV file id,a,b,c[,d] with the nodes around each facet. A triangle has no d. The path is relative to the case "
     "file. Default: hifdm finds the facets from the cables"},

    {"surface.kind", HF_FIELD_WORD, AT(surface.kind), 0, 0, "auto", "", hf_surface_kind_word,
     "Target surface. parabolic_cylinder is z = x^2/(4f) along y. paraboloid is z = (x^2 + y^2)/(4f). auto selects "
     "the surface of a generated net, or the surface on which the inner nodes of an imported net lie"},
    {"surface.focal_length_m", HF_FIELD_DOUBLE, AT(surface.focal_length_m), HF_ABOVE_ZERO, 1e9, "", "m", NULL,
     "Focal length of the target surface. Default: the focal length of a generated net"},
    {"surface.strip_width_m", HF_FIELD_DOUBLE, AT(surface.strip_width_m), HF_ABOVE_ZERO, 1e4, "", "m", NULL,
     "Width of the flat strips along y, for the faceting error. Default: the width of a cell of parabolic_cylinder"},
    {"surface.mesh_tension_N_per_m", HF_FIELD_DOUBLE, AT(surface.mesh_tension_N_per_m), 0, 1e6, "0", "N/m", NULL,
     "Tension of the mesh, the same in all directions. The mesh bends the cables between two facets, so the facets "
     "become pillows. 0: the facets are flat"},
    {"surface.frequencies_Hz", HF_FIELD_DOUBLE_LIST, AT(surface.frequencies_Hz), HF_ABOVE_ZERO, 1e15, "[]", "Hz", NULL,
     "Up to 32 frequencies at which hifdm reports the gain loss (Ruze)"},

    {"surface.pattern.theta_deg", HF_FIELD_BOUNDS, AT(surface.pattern.theta_deg), -180, 180, "[-5, 5]", "deg", NULL,
     "First and last angle of each cut, from +z. Negative angles are on the other side of +z"},
    {"surface.pattern.n_theta", HF_FIELD_INT, AT(surface.pattern.n_theta), 2, 4001, "721", "", NULL,
     "Number of angles of each cut, in equal steps"},
    {"surface.pattern.phi_deg", HF_FIELD_DOUBLE_LIST, AT(surface.pattern.phi_deg), -360, 360, "[0, 90]", "deg", NULL,
     "Angles of up to 8 cuts, from +x towards +y"},
    {"surface.pattern.feed.kind", HF_FIELD_WORD, AT(surface.pattern.feed), 0, 0, "auto", "", hf_feed_word,
     "point is a point source, line is a line source along y, and plane_wave is a plane wave that travels along -z. "
     "auto selects line for a parabolic cylinder and point for a paraboloid"},
    {"surface.pattern.feed.position_m", HF_FIELD_VECTOR, AT(surface.pattern.position_m), -1e9, 1e9, "", "m", NULL,
     "Position of the point source, or of a point on the line source. Default: the focus of the target surface"},
    {"surface.pattern.feed.aim_m", HF_FIELD_VECTOR, AT(surface.pattern.aim_m), -1e9, 1e9, "", "m", NULL,
     "Point at which the feed aims. Default: the middle of the aperture, on the target surface"},
    {"surface.pattern.feed.cos_power", HF_FIELD_DOUBLE, AT(surface.pattern.cos_power), 0, 1e4, "", "", NULL,
     "Exponent q. The field of the feed is proportional to cos^q of the angle from its axis, and the power of the "
     "feed is proportional to cos^(2q). Default: the value with which the power at the edge of the facets is 10 dB "
     "below the power on the axis, without the effect of the distances"},
    {"surface.pattern.feed.polarisation", HF_FIELD_WORD, AT(surface.pattern.polarisation), 0, 0, "x", "",
     HF_WORDS("x", "y"),
     "Polarisation of the electric field on the axis of the feed. For a line source: across the line or along it"},

    {"form.method", HF_FIELD_WORD, AT(form.method), 0, 0, "auto", "", hf_method_word,
     "With newton, every cable obeys its own law, solved by Newton's method on the energy. With hifdm, the iteration "
     "of the paper (Eqs. 7, 8) solves the same laws. With iterative_fdm, every cable keeps a given tension (Eq. 7). "
     "fdm is one linear solve with the initial force densities (Eqs. 5, 6). auto selects newton where it applies, "
     "otherwise hifdm"},
    {"form.pretension_N", HF_FIELD_DOUBLE, AT(form.pretension_N), HF_ABOVE_ZERO, 1e9, "10", "N", NULL,
     "Uniform tension Td of the inner cables"},
    {"form.prestress", HF_FIELD_WORD, AT(form.prestress), 0, 0, "given", "", HF_WORDS("given", "exact"),
     "With given, every cable keeps its law. With exact, every cable gets the force density that holds all nodes at "
     "their target positions. The tensions are then as close as equilibrium allows to those of the laws tension and "
     "force_density. They are as uniform as possible for cables with the laws length and elastic"},
    {"form.stop", HF_FIELD_WORD, AT(form.stop), 0, 0, "residual", "", hf_stop_rule_word,
     "Stopping rule of the iteration. With residual, it stops when equilibrium and lengths are within the "
     "tolerances. With rms_change, it stops when psi changes by less than rms_tolerance_m. The paper uses "
     "rms_change, which stops before equilibrium. Use this rule only to reproduce the paper"},
    {"form.residual_tolerance", HF_FIELD_DOUBLE, AT(form.residual_tolerance), 1e-13, 1, "1e-7", "", NULL,
     "Maximum residual force of a node, relative to the pretension"},
    {"form.length_tolerance", HF_FIELD_DOUBLE, AT(form.length_tolerance), 1e-13, 1, "1e-7", "", NULL,
     "Maximum |l/L*-1| of a taut cable with law length"},
    {"form.rms_tolerance_m", HF_FIELD_DOUBLE, AT(form.rms_tolerance_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL,
     "Change of psi between two iterations below which rms_change stops (0.001 mm in the paper)"},
    {"form.max_iterations", HF_FIELD_INT, AT(form.max_iterations), 1, 10000000, "100000", "", NULL,
     "Maximum number of iterations. A shape that needs more iterations is not converged"},
    {"form.collapse_ratio", HF_FIELD_DOUBLE, AT(form.collapse_ratio), 1e-12, 0.5, "1e-3", "", NULL,
     "A cable with law tension has collapsed if its length is below this fraction of its length at the target "
     "positions"},
    {"form.factor", HF_FIELD_WORD, AT(form.factor), 0, 0, "own", "", HF_WORDS("own", "lapack"),
     "own is the band Cholesky factorisation of hifdm. lapack uses dpbtrf and dpbtrs of LAPACK for the positive "
     "definite matrices of form-finding, of designs and of refinement. With lapack, hifdm factors the matrix of each "
     "design. Certificates and as-built nets always use own"},

    {"coupling.tof_m", HF_FIELD_DOUBLE, AT(form.coupling.tof_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL,
     "The coupling has converged when no attachment moves farther than this in one step. The paper uses 1e-3"},
    {"coupling.scheme", HF_FIELD_WORD, AT(form.coupling.scheme), 0, 0, "auto", "", hf_coupling_scheme_word,
     "plain is the loop of the paper. accelerated adds Anderson acceleration, which needs fewer form-findings and "
     "also converges for softer trusses. auto begins with accelerated. If that is slow and Newton's method solves "
     "the net, auto solves net and truss in one matrix"},
    {"coupling.max_iterations", HF_FIELD_INT, AT(form.coupling.max_iterations), 1, 1000000, "200", "", NULL,
     "Maximum number of form-findings in the coupling"},

    {"adjust.set", HF_FIELD_TEXT, AT(adjust.set), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "Cables with turnbuckles: a set of the net, or inner, boundary, all"},
    {"adjust.range_m", HF_FIELD_DOUBLE, AT(adjust.range_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL,
     "Maximum change of the cut length of each cable, in both directions"},
    {"adjust.step_m", HF_FIELD_DOUBLE, AT(adjust.step_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL,
     "Adjustments are multiples of this step"},
    {"adjust.max_adjustments", HF_FIELD_INT, AT(adjust.max_adjustments), 1, 1000000, "10", "", NULL,
     "Maximum number of cables to adjust"},
    {"adjust.target_m", HF_FIELD_DOUBLE, AT(adjust.target_m), 0, BIG, "0", "m", NULL,
     "hifdm adds no further adjustment when the figure is below this value"},
    {"adjust.figure", HF_FIELD_WORD, AT(adjust.figure), 0, 0, "psi", "", hf_adjust_figure_word,
     "RMS figure that the adjustments minimise. psi is the distance of the inner nodes from the positions that "
     "adjust.aim selects. surface is the distance of the inner nodes from the target surface, along its normal. "
     "facets is the distance of the facets from the target surface"},
    {"adjust.aim", HF_FIELD_WORD, AT(adjust.aim), 0, 0, "design", "", hf_aim_word,
     "Positions from which the figure psi is measured. design selects the positions in the shape of the design, so "
     "the adjustments also restore its tensions. target_positions selects the target positions, including for nodes "
     "that the design deliberately places elsewhere"},
    {"adjust.sigma_m", HF_FIELD_DOUBLE, AT(adjust.sigma_m), HF_ABOVE_ZERO, BIG, "", "m", NULL,
     "Standard deviation of each measured coordinate of nodes without their own sigma_m"},

    {"optimize.method", HF_FIELD_WORD, AT(optimize.method), 0, 0, "ga", "", hf_optimize_method_word,
     "ga is the genetic algorithm. lm is Levenberg-Marquardt from the tensions of form-finding. ga+lm refines the "
     "best design of the genetic algorithm by Levenberg-Marquardt. With ga, optimize.refine reports this refined "
     "design only for comparison"},
    {"optimize.refine", HF_FIELD_WORD, AT(optimize.refine), 0, 0, "auto", "", HF_WORDS("auto", "true", "false"),
     "Whether hifdm also refines the best design of the genetic algorithm by Levenberg-Marquardt, for comparison. "
     "auto refines it only if this takes little time, or less than a tenth of the time of the genetic algorithm"},
    {"optimize.rule", HF_FIELD_WORD, AT(optimize.rule), 0, 0, "force_density", "", hf_rule_word,
     "Rule that determines how the pretension T' of a design acts on a boundary cable. With force_density, the cable "
     "keeps q = T'/L*, so the shape is always unique. With tension, the cable keeps T'. With seeded, Eq. 8 starts "
     "from q = T'/L* and stops by rms_change, so the optimum depends on the iteration at which it stops"},
    {"optimize.symmetry", HF_FIELD_WORD, AT(optimize.symmetry), 0, 0, "none", "", hf_symmetry_word,
     "Boundary cables that are mirror images of each other change by the same amount, so a design has fewer "
     "variables. The mirror planes are in the middle of the net along x, along y, or both. auto: those of the two "
     "planes about which the net is symmetric"},
    {"optimize.solver", HF_FIELD_WORD, AT(optimize.solver), 0, 0, "auto", "", hf_solver_word,
     "Solver of the individuals. With chord, all designs share one factored Newton matrix, and one pass solves eight "
     "designs. With newton, each design has its own matrix. fixed_point is the iteration of the paper. auto selects "
     "the first of these solvers that applies"},
    {"optimize.population", HF_FIELD_INT, AT(optimize.population), 2, 100000, "50", "", NULL, "Number of individuals"},
    {"optimize.generations", HF_FIELD_INT, AT(optimize.generations), 1, 1000000, "400", "", NULL,
     "Maximum number of generations"},
    {"optimize.range_N", HF_FIELD_DOUBLE, AT(optimize.range_N), HF_ABOVE_ZERO, 1e9, "1", "N", NULL,
     "Maximum change |dT| of a boundary pretension from its value after form-finding (Eq. 13)"},
    {"optimize.min_tension_N", HF_FIELD_DOUBLE, AT(optimize.min_tension_N), HF_ABOVE_ZERO, 1e9, "0.1", "N", NULL,
     "Lower bound of each boundary pretension (Eq. 12: above zero)"},
    {"optimize.max_tension_N", HF_FIELD_DOUBLE, AT(optimize.max_tension_N), HF_ABOVE_ZERO, BIG, "1e6", "N", NULL,
     "Upper bound of each boundary pretension"},
    {"optimize.boundary_ratio_cap", HF_FIELD_DOUBLE, AT(optimize.boundary_ratio_cap), 1, BIG, "10", "", NULL,
     "Maximum boundary tension ratio. An individual with a larger ratio is infeasible"},
    {"optimize.seed", HF_FIELD_UINT64, AT(optimize.seed), 0, 18446744073709551615.0, "1", "", NULL,
     "Seed of the random numbers. The same seed gives the same run with any number of threads"},
    {"optimize.crossover_high", HF_FIELD_DOUBLE, AT(optimize.crossover_high), 0, 1, "0.9", "", NULL,
     "Pc1 of the adaptive crossover rate (Srinivas & Patnaik 1994)"},
    {"optimize.crossover_low", HF_FIELD_DOUBLE, AT(optimize.crossover_low), 0, 1, "0.6", "", NULL, "Pc2"},
    {"optimize.mutation_high", HF_FIELD_DOUBLE, AT(optimize.mutation_high), 0, 1, "0.1", "", NULL, "Pm1"},
    {"optimize.mutation_low", HF_FIELD_DOUBLE, AT(optimize.mutation_low), 0, 1, "0.001", "", NULL, "Pm2"},
    {"optimize.variation", HF_FIELD_WORD, AT(optimize.variation), 0, 0, "difference", "",
     HF_WORDS("difference", "chain"),
     "With difference, a crossover moves an elite along the difference of two parents, and children replace worse "
     "individuals. With chain, a crossover mixes two parents chain by chain, and children replace the whole "
     "generation"},
    {"optimize.elites", HF_FIELD_INT, AT(optimize.elites), 1, 100000, "1", "", NULL,
     "Number of best individuals that survive unchanged. With variation: difference, the crossovers start from these "
     "individuals"},
    {"optimize.stagnation_tolerance_m", HF_FIELD_DOUBLE, AT(optimize.stagnation_tolerance_m), 0, BIG, "1e-6", "m", NULL,
     "Stagnation tolerance. The genetic algorithm stops if the best psi or merit improves by less than this value in "
     "stagnation_generations generations"},
    {"optimize.stagnation_generations", HF_FIELD_INT, AT(optimize.stagnation_generations), 1, 1000000, "50", "", NULL,
     "Number of generations over which stagnation_tolerance_m is measured"},
    {"optimize.store", HF_FIELD_WORD, AT(optimize.store), 0, 0, "all", "", hf_keep_word,
     "Individuals that the result file stores. With all, it stores every individual. With best, it stores the best "
     "individual of each generation. With every, it stores one generation in store_every. The last generation is "
     "always stored"},
    {"optimize.store_every", HF_FIELD_INT, AT(optimize.store_every), 2, 1000000, "100", "", NULL,
     "With store: every, generations 0, n, 2n, ... are stored"},
    {"optimize.refine_steps", HF_FIELD_INT, AT(optimize.refine_steps), 1, 100000, "200", "", NULL,
     "Maximum number of Levenberg-Marquardt steps"},
    {"optimize.samples", HF_FIELD_INT, AT(optimize.samples), 2, 100000, "64", "", NULL,
     "Number of nets with errors from which objectives over samples are computed. All designs have the same errors: "
     "the first samples that tolerance.sampling random draws"},
    {"optimize.front_points", HF_FIELD_INT, AT(optimize.front_points), 3, HF_FRONT_POINTS_MAX, "21", "", NULL,
     "Number of points of optimize.front that Levenberg-Marquardt finds, including both ends"},

    {"tolerance.sigma_cut_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_m), 0, 1, "0", "m", NULL,
     "Standard deviation of each cut length"},
    {"tolerance.sigma_cut_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_ratio), 0, 0.05, "0", "", NULL,
     "Standard deviation of each cut length as a fraction of the length, such as the scale error of a measuring tape"},
    {"tolerance.sigma_EA_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_EA_ratio), 0, 0.05, "0", "", NULL,
     "Standard deviation of each EA, as a fraction of EA"},
    {"tolerance.sigma_support_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_support_m), 0, 1, "0", "m", NULL,
     "Standard deviation of each coordinate of each support. For an attachment, this is the position before the "
     "truss deflects"},
    {"tolerance.sigma_temperature_K", HF_FIELD_DOUBLE, AT(tolerance.sigma_temperature_K), 0, 1000, "0", "K", NULL,
     "Standard deviation of the temperature, which is the same for all cables. This key requires "
     "cables.expansion_per_K. For the truss, use tolerance.truss"},
    {"tolerance.distribution", HF_FIELD_WORD, AT(tolerance.distribution), 0, 0, "normal", "", hf_distribution_word,
     "Distribution of each error. A uniform distribution extends to 1.73 times the standard deviation"},
    {"tolerance.batch", HF_FIELD_DOUBLE, AT(tolerance.batch), 0, 1, "0", "", NULL,
     "Correlation of the errors of sigma_cut_ratio, and of the errors of sigma_EA_ratio, among the cables of one "
     "spool. A spool is a set of the net. A cable that is in several sets belongs to the first set by name. A cable "
     "without a set belongs to the spool inner or boundary"},
    {"tolerance.samples", HF_FIELD_INT, AT(tolerance.samples), 10, 100000000, "1000", "", NULL,
     "Number of samples. With fewer than 10 samples, the 95 % confidence intervals, which assume normal "
     "distributions, would be more than 15 % too narrow"},
    {"tolerance.seed", HF_FIELD_UINT64, AT(tolerance.seed), 0, 18446744073709551615.0, "1", "", NULL,
     "Seed of the random numbers. The same seed gives the same samples with any number of threads"},
    {"tolerance.sampling", HF_FIELD_WORD, AT(tolerance.sampling), 0, 0, "random", "", hf_sampling_word,
     "random uses random numbers. sobol uses Sobol's sequence in the 40 directions of errors that change the shape "
     "most, which converges faster"},
    {"tolerance.required_yield", HF_FIELD_DOUBLE, AT(tolerance.required_yield), 0, 0.9999, "0", "", NULL,
     "Required fraction of samples that meet tolerance.require. If it is above 0, the run reports the factor by "
     "which all errors may grow or must shrink"},

#define FIELD(section, member, type, ...) {"truss." #member, type, AT(section.member), __VA_ARGS__},
    HF_TRUSS_KEYS(FIELD, truss)
#undef FIELD
        {"truss.match_tolerance_m", HF_FIELD_DOUBLE, AT(truss.match_tolerance_m), 0, 1e3, "1e-6", "m", NULL,
         "Maximum distance between a support of the net and the truss node that carries it"},

#define FIELD(section, member, type, ...) {"truss." #section "." #member, type, AT(truss.section.member), __VA_ARGS__},
#define UNIT(section, diameter, panels) HF_TRUSS_UNIT_KEYS(FIELD, section, diameter, panels)
    UNIT(bud, "0.03", "2") UNIT(mbug, "0.03", "1") UNIT(abug, "0.025", "1")
#undef UNIT

        HF_RING_KEYS(FIELD, ring)
#undef FIELD
#define FIELD(section, member, type, ...)                                                                              \
    {"truss.ring." #section "." #member, type, AT(truss.ring.section.member), __VA_ARGS__},
            HF_TUBE_KEYS(FIELD, longeron, "0.03") HF_TUBE_KEYS(FIELD, vertical, "0.03")
                HF_TUBE_KEYS(FIELD, diagonal, "0.02")
#undef FIELD

                    {"truss.import.nodes", HF_FIELD_TEXT, AT(truss_nodes_path), 1, HF_PATH_SIZE, NULL, "", NULL,
                     "CSV file id,x_m,y_m,z_m,fixed[,mass_kg] of the nodes. fixed is a list of ux uy uz rx ry rz, or "
                     "all, or empty. The path is relative to the case file"},
    {"truss.import.members", HF_FIELD_TEXT, AT(truss_members_path), 1, HF_PATH_SIZE, NULL, "", NULL,
     "CSV file "
     "id,i,j,E_Pa,A_m2[,G_Pa,Iy_m4,Iz_m4,J_m4,Asy_m2,Asz_m2,roll_rad,density_kg_per_m3,expansion_per_K,joint,unit] "
     "of the members. joint is rigid or pinned. The path is relative to the case file"},
};
const int hf_n_field = sizeof hf_field_table / sizeof *hf_field_table;

/* ---- lists of rows ---- */

#define IN(row, member) offsetof(hf_##row##_settings, member)

_Static_assert(IN(variable, range_ratio) == IN(variable, range) + sizeof(double) &&
                   IN(variable, upper) == IN(variable, lower) + sizeof(double),
               "a range is an amount, bounds are bounds");
static const hf_field variable_field[] = {
    {"set", HF_FIELD_TEXT, IN(variable, set), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "Cables that vary, or cables whose supports vary: a set of the net, or inner, boundary, all"},
    {"vary", HF_FIELD_WORD, IN(variable, vary), 0, 0, NULL, "", hf_vary_word,
     "Quantity that varies. With tension (N), force_density (N/m) or length (m), the cable keeps the value. "
     "unstressed_length (m) is for cables with law elastic. support_z, support_normal and support_xyz (m) displace the "
     "supports at the ends of the cables along z, along the normal of the target surface, or in all three directions"},
    {"range", HF_FIELD_AMOUNT, IN(variable, range), HF_ABOVE_ZERO, BIG, "", "", NULL,
     "Maximum change from the value after form-finding, in the unit of the quantity or in per cent of the value. "
     "Default: as far as the bounds allow"},
    {"bounds", HF_FIELD_BOUNDS, IN(variable, lower), -BIG, BIG, "", "", NULL,
     "Lower and upper bound, in the unit of the quantity. Default: none"},
    {"link", HF_FIELD_WORD, IN(variable, link), 0, 0, "each", "", HF_WORDS("each", "set", "symmetry"),
     "Variables that change together. With each, every cable changes on its own. With set, all cables of the row "
     "change by the same amount. With symmetry, mirror images change by the same amount (optimize.symmetry)"},
};

static const hf_field objective_field[] = {
    {"figure", HF_FIELD_WORD, IN(objective, figure), 0, 0, NULL, "", hf_figure_kind_word,
     "psi: RMS distance of the inner nodes to their target positions (m); surface: RMS distance of the inner nodes "
     "to the target surface (m); facets: RMS distance of the facets to the target surface (m); tension, length: RMS "
     "difference from target over the set (N, m); evenness: standard deviation of the tensions of the set divided by "
     "their mean; pull: maximum force of the net on a support (N); deflection: maximum deflection of the truss at an "
     "attachment (m); mass: mass of the cables of the set (kg); ratio: maximum tension of the set divided by its "
     "minimum tension; gain: square root of the fraction of the gain that the shape loses in the direction of the "
     "beam, by physical optics (surface.pattern)"},
    {"set", HF_FIELD_TEXT, IN(objective, set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Cables of tension, length, evenness, mass and ratio. Default: all"},
    {"target", HF_FIELD_DOUBLE, IN(objective, target), -BIG, BIG, "", "", NULL,
     "Target of tension (N, required) or of length (m). Default for length: the lengths at the target positions"},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(objective, mass_kg_per_m), HF_ABOVE_ZERO, BIG, "", "kg/m", NULL,
     "Mass of the cables per metre, required for the figure mass"},
    {"along", HF_FIELD_WORD, IN(objective, along), 0, 0, "normal", "", HF_WORDS("normal", "half_path"),
     "Distance that surface and facets measure. normal is the distance along the normal. half_path is half the "
     "change of the path of a ray"},
    {"fit", HF_FIELD_WORD, IN(objective, fit), 0, 0, "none", "", HF_WORDS("none", "best"),
     "Reference for surface and facets: the target surface itself, or its best fit to the shape"},
    {"frequency_Hz", HF_FIELD_DOUBLE, IN(objective, frequency_Hz), HF_ABOVE_ZERO, 1e15, "", "Hz", NULL,
     "Frequency of the figure gain. Default: the highest of surface.frequencies_Hz"},
    {"load_case", HF_FIELD_TEXT, IN(objective, load_case), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Name of the load case in which the figure is computed on the as-built net. all computes the figure in all load "
     "cases"},
    {"over", HF_FIELD_WORD, IN(objective, over), 0, 0, "design", "", hf_over_word,
     "Nets from which the figure is computed: the design itself, or samples with the errors of `tolerance`"},
    {"take", HF_FIELD_WORD, IN(objective, take), 0, 0, "mean", "", hf_take_word,
     "Combination of the values of all load cases or samples. mean is their RMS value, and worst is their maximum"},
    {"quantile", HF_FIELD_DOUBLE, IN(objective, quantile), HF_ABOVE_ZERO, 1, "", "", NULL,
     "Quantile over the samples, in place of take. This fraction of the samples has no larger value. Only the method "
     "ga supports this key"},
    {"weight", HF_FIELD_DOUBLE, IN(objective, weight), HF_ABOVE_ZERO, BIG, "1", "", NULL,
     "Weight of this objective in the merit of a design, the square root of the sum of (weight * value)^2"},
};

_Static_assert(IN(limit, upper) == IN(limit, lower) + sizeof(double), "bounds are bounds");
static const hf_field limit_field[] = {
    {"figure", HF_FIELD_WORD, IN(limit, figure), 0, 0, NULL, "", hf_limit_word,
     "tension limits the tension of each cable of the set (N). ratio limits the maximum tension of the set divided "
     "by its minimum tension. deflection limits the deflection of the truss at each attachment (m)"},
    {"set", HF_FIELD_TEXT, IN(limit, set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Cables of tension and ratio. Default: all"},
    {"bounds", HF_FIELD_BOUNDS, IN(limit, lower), -BIG, BIG, NULL, "", NULL, "Lower and upper bound"},
};

static const hf_field cable_field[] = {
    {"set", HF_FIELD_TEXT, IN(cable, set), 1, HF_SET_NAME_SIZE, "all", "", NULL,
     "Cables of the row: a set of the net, or inner, boundary, all"},
    {"expansion_per_K", HF_FIELD_DOUBLE, IN(cable, expansion_per_K), -1, 1, "", "1/K", NULL,
     "Thermal expansion of the cables. 0: no expansion"},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(cable, mass_kg_per_m), 0, 1e6, "", "kg/m", NULL,
     "Mass of the cables per metre of unstressed length"},
};

static const hf_field node_field[] = {
    {"role", HF_FIELD_WORD, IN(node, role), 0, 0, "all", "", hf_nodes_word,
     "Nodes of the row: the nodes of a role, or all"},
    {"mass_kg", HF_FIELD_DOUBLE, IN(node, mass_kg), 0, 1e6, NULL, "kg", NULL, "Mass of each node"},
};

static const hf_field load_case_field[] = {
    {"name", HF_FIELD_TEXT, IN(load_case, name), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "Name of the load case, of letters, digits, _ and -. Rows with the same name form one load case"},
    {"set", HF_FIELD_TEXT, IN(load_case, set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Cables to which the temperature applies: a set of the net, or inner, boundary, all"},
    {"part", HF_FIELD_WORD, IN(load_case, part), 0, 0, "all", "", hf_part_word,
     "Part to which the temperature applies: net and truss, all cables, the whole truss, or the members of one truss "
     "unit"},
    {"temperature_K", HF_FIELD_DOUBLE, IN(load_case, temperature_K), -1e4, 1e4, "", "K", NULL,
     "Difference from the temperature at which the cables were cut and the truss was made. If several rows of a load "
     "case give the temperature of a part, the last row applies"},
    {"gradient_K_per_m", HF_FIELD_VECTOR, IN(load_case, gradient_K_per_m), -1e4, 1e4, "", "K/m", NULL,
     "Temperature gradient. It adds to temperature_K, in proportion to the distance from the origin"},
    {"gravity_m_per_s2", HF_FIELD_DOUBLE, IN(load_case, gravity_m_per_s2), HF_ABOVE_ZERO, 1e6, "", "m/s2", NULL,
     "Acceleration of gravity, for the weight of cables, nodes and truss"},
    {"direction", HF_FIELD_VECTOR, IN(load_case, direction), -1e9, 1e9, "", "", NULL,
     "Direction of gravity, a vector of any length. Default: [0, 0, -1]"},
    {"force_N", HF_FIELD_VECTOR, IN(load_case, force_N), -1e12, 1e12, "", "N", NULL, "Force on each node of the role"},
    {"role", HF_FIELD_WORD, IN(load_case, role), 0, 0, "all", "", hf_nodes_word, "Nodes on which force_N acts"},
    {"support_displacement_m", HF_FIELD_VECTOR, IN(load_case, support_displacement_m), -1e6, 1e6, "", "m", NULL,
     "Displacement of all supports from their positions in the design. On a truss, the displacement from the "
     "positions that the truss gives them"},
    {"nodes", HF_FIELD_TEXT, IN(load_case, nodes_path), 1, HF_PATH_SIZE, "", "", NULL,
     "CSV id[,Fx_N,Fy_N,Fz_N][,dx_m,dy_m,dz_m] with forces on nodes and displacements of supports. The path is "
     "relative to the case file"},
};

static const hf_field require_field[] = {
    {"measure", HF_FIELD_WORD, IN(require, measure), 0, 0, NULL, "", hf_tolerance_measure_word,
     "Figure of each as-built net. Surface figures need a section surface, and facet figures a net with facets. Losses "
     "by Ruze's formula (...gain_loss_dB) need surface.frequencies_Hz, and pattern_loss_dB needs surface.pattern. "
     "Figures with fit_ are those after the best fit, that is, after the reflector has been pointed and focused again"},
    {"at_most", HF_FIELD_DOUBLE, IN(require, at_most), -BIG, BIG, "", "", NULL, "Maximum allowed value"},
    {"at_least", HF_FIELD_DOUBLE, IN(require, at_least), -BIG, BIG, "", "", NULL, "Minimum allowed value"},
};

static const hf_field truss_heat_field[] = {
    {"part", HF_FIELD_WORD, IN(truss_heat, part), 0, 0, NULL, "", hf_part_word + HF_PART_TRUSS,
     "Members to which this temperature applies: the whole truss, or one truss unit"},
    {"sigma_temperature_K", HF_FIELD_DOUBLE, IN(truss_heat, sigma_temperature_K), HF_ABOVE_ZERO, 1000, NULL, "K", NULL,
     "Standard deviation of this temperature. This key requires truss.expansion_per_K"},
};

#undef IN

/* `less` is the number of last keys that the rows of this list do not have. */
#define LIST(name, count, row, max_row, keys, less, help)                                                              \
    {                                                                                                                  \
        name, AT(count), AT(row), sizeof(((hf_case *)0)->row[0]), max_row, keys,                                       \
            (int)(sizeof keys / sizeof *keys) - less, help                                                             \
    }
const hf_list hf_list_table[] = {
    LIST("optimize.variables", optimize.n_variable_row, optimize.variable_row, HF_DESIGN_ROWS_MAX, variable_field, 0,
         "Design variables. Without rows, the pretensions of the boundary cables vary within range_N, and rule "
         "determines how they act"),
    LIST("optimize.objective", optimize.n_term, optimize.term, HF_DESIGN_ROWS_MAX, objective_field, 0,
         "Objectives, which the merit of a design combines. Without rows, the objective is psi"),
    /* A row of optimize.front has the keys of a row of optimize.objective without the last one, weight. */
    LIST("optimize.front", optimize.n_front, optimize.front, HF_FRONT_OBJECTIVES_MAX, objective_field, 1,
         "Two or three objectives of a Pareto front. The run then finds the front instead of one design. No other "
         "design dominates a design of the front"),
    LIST("optimize.limits", optimize.n_limit, optimize.limit, HF_DESIGN_ROWS_MAX, limit_field, 0,
         "Limits that a design must satisfy. Without rows, there are none"),
    LIST("cables", built.n_cable, built.cable, HF_MATERIAL_ROWS_MAX, cable_field, 0,
         "Material of the cables of the as-built net. A later row replaces the values of an earlier row"),
    LIST("nodes", built.n_node, built.node, HF_MATERIAL_ROWS_MAX, node_field, 0,
         "Mass of the joints of the as-built net. A later row replaces an earlier row"),
    LIST("load_cases", built.n_load_case, built.load_case, HF_LOAD_CASE_ROWS_MAX, load_case_field, 0,
         "Up to 16 load cases of the as-built net: temperatures, gravity, forces and displacements of supports. "
         "Without rows, hifdm computes none"),
    LIST("tolerance.require", tolerance.n_require, tolerance.require, HF_REQUIRE_ROWS_MAX, require_field, 0,
         "Requirements for each as-built net. Without rows, there are no requirements and no yield"),
    LIST("tolerance.truss", tolerance.n_truss, tolerance.truss, HF_TRUSS_HEAT_ROWS_MAX, truss_heat_field, 0,
         "Temperatures of the truss that vary independently. The temperatures of rows with the same members add up. "
         "Without rows, the temperature of the truss does not vary"),
};
#undef LIST
const int hf_n_list = sizeof hf_list_table / sizeof *hf_list_table;

/* ---- differences ---- */

static bool is_same(const hf_field *f, const char *a, const char *b)
{
    const hf_double_list *p = (const void *)a, *q = (const void *)b;
    switch (f->type) { /* no default label, so that the compiler reports a type without a comparison */
    case HF_FIELD_TEXT:
        return !strcmp(a, b);
    case HF_FIELD_DOUBLE:
        return !memcmp(a, b, sizeof(double));
    case HF_FIELD_UINT64:
        return !memcmp(a, b, sizeof(uint64_t));
    case HF_FIELD_INT_PAIR:
        return !memcmp(a, b, 2 * sizeof(int));
    case HF_FIELD_AMOUNT:
    case HF_FIELD_BOUNDS:
        return !memcmp(a, b, 2 * sizeof(double));
    case HF_FIELD_VECTOR:
        return !memcmp(a, b, 3 * sizeof(double));
    case HF_FIELD_INT:
    case HF_FIELD_WORD:
        return !memcmp(a, b, sizeof(int));
    case HF_FIELD_DOUBLE_LIST:
        return p->n == q->n && !memcmp(p->value, q->value, (size_t)p->n * sizeof *p->value);
    }
    return false;
}

static int add_key(const char *key, int n, char *text, size_t size)
{
    size_t used = strlen(text);
    snprintf(text + used, size - used, "%s%s", n ? ", " : "", key);
    return n + 1;
}

/* Adds the keys in which the rows of a list differ. Adds the list itself if the numbers of rows differ. */
static int add_rows(const hf_list *list, const hf_case *a, const hf_case *b, int n, char *text, size_t size)
{
    int n_row = hf_key_n_row(a, list);
    if (n_row != hf_key_n_row(b, list)) return add_key(list->path, n, text, size);
    for (int row = 0; row < n_row; row++)
        for (int i = 0; i < list->n_field; i++) {
            const hf_key key = hf_key_of_row(list, row, i);
            if (!is_same(key.field, (const char *)a + key.offset, (const char *)b + key.offset))
                n = add_key(key.path, n, text, size);
        }
    return n;
}

int hf_config_differences(const hf_case *a, const hf_case *b, char *text, size_t size)
{
    const char *p = (const char *)a, *q = (const char *)b;
    int n = 0;
    *text = '\0';
    for (int i = 0; i < hf_n_section; i++) {
        size_t at = hf_section_table[i].present_offset;
        if (at != SIZE_MAX && memcmp(p + at, q + at, sizeof(bool)) != 0)
            n = add_key(hf_section_table[i].path, n, text, size);
    }
    for (int i = 0; i < hf_n_field; i++)
        if (!is_same(&hf_field_table[i], p + hf_field_table[i].offset, q + hf_field_table[i].offset))
            n = add_key(hf_field_table[i].path, n, text, size);
    for (int i = 0; i < hf_n_list; i++)
        n = add_rows(&hf_list_table[i], a, b, n, text, size);
    return n;
}

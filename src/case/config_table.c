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
        {"scene.import", AT(has_import), "The section `scene.import` reads a net from two CSV files."},
    {"surface", AT(has_surface),
     "The section `surface` describes the target surface. If the case file contains the section `surface`, hifdm "
     "computes the errors of the reflecting surface."},
    {"surface.pattern", AT(surface.has_pattern),
     "The section `surface.pattern` requests the far field. hifdm computes the far field by physical optics over the "
     "facets, at each frequency in the key `surface.frequencies_Hz`. Without the section `surface.pattern`, hifdm "
     "computes no far field."},
    {"surface.pattern.feed", AT(surface.has_pattern),
     "The section `surface.pattern.feed` describes the feed that illuminates the reflector."},
    {"form", SIZE_MAX,
     "The section `form` contains the settings of the form-finding. Without the section `form`, hifdm uses the default "
     "settings."},
    {"optimize", AT(has_optimize),
     "The section `optimize` requests an optimisation and contains its settings. Without the section `optimize`, hifdm "
     "does not optimise the net."},
    {"tolerance", AT(has_tolerance),
     "The section `tolerance` describes the random errors of cut lengths, stiffness, support positions and "
     "temperature. From random errors, hifdm computes samples of the as-built net. Without the section `tolerance`, "
     "hifdm computes no samples. The section `tolerance` requires an axial stiffness EA for every cable."},
    {"truss", AT(has_truss),
     "The section `truss` describes the deployable truss that carries the net. Without the section `truss`, the "
     "supports of the net are rigid. Because the paper gives no dimensions of the truss, all default values in the "
     "section `truss` are assumptions."},
    {"truss.bud", AT(has_truss),
     "The section `truss.bud` describes the basic units along the directrix. Each basic unit along the directrix is a "
     "planar truss on a module border along x."},
    {"truss.mbug", AT(has_truss),
     "The section `truss.mbug` describes the main basic units along the generatrix. Main basic units are on module "
     "borders along y."},
    {"truss.abug", AT(has_truss),
     "The section `truss.abug` describes the assistant basic units along the generatrix. Assistant basic units are on "
     "the module borders along y that have no main basic unit."},
    {"truss.ring", AT(has_truss_ring),
     "The section `truss.ring` describes a hoop truss under the rim of the net from the section `scene.paraboloid`. "
     "The hoop truss replaces the basic units. The section `truss` sets the material of the hoop truss. All default "
     "values of the section `truss.ring` are assumptions."},
    {"truss.ring.longeron", AT(has_truss_ring),
     "The section `truss.ring.longeron` describes the members of the front ring and of the rear ring."},
    {"truss.ring.vertical", AT(has_truss_ring),
     "The section `truss.ring.vertical` describes the members that connect the front ring to the rear ring."},
    {"truss.ring.diagonal", AT(has_truss_ring),
     "The section `truss.ring.diagonal` describes the diagonal members of the hoop truss."},
    {"truss.import", AT(has_truss_import),
     "The section `truss.import` reads a truss from two CSV files. The imported truss replaces the generated truss."},
    {"coupling", SIZE_MAX,
     "The section `coupling` contains the settings for the coupling of the net with its truss (Fig. 17 of the paper). "
     "If the net has no truss, hifdm does not use the section `coupling`."},
    {"adjust", AT(has_adjust),
     "The section `adjust` describes the turnbuckles of the as-built net. The command `hifdm adjust` computes "
     "turnbuckle adjustments from measured node positions."},
    {"sweep", AT(has_sweep),
     "The section `sweep` defines the axes of a sweep. The command `hifdm sweep` runs the case once for each point of "
     "the sweep. Each axis of a sweep has the form `key: [values]` or `key: {from, to, n}`."},
};
const int hf_n_section = sizeof hf_section_table / sizeof *hf_section_table;

const hf_field hf_field_table[] = {
    {"title", HF_FIELD_TEXT, AT(title), 0, sizeof((hf_case *)0)->title, "", "", NULL,
     "Sets the title of the case in one line"},

    {"scene.EA_inner_N", HF_FIELD_DOUBLE, AT(EA_N[0]), HF_ABOVE_ZERO, 1e15, "", "N", NULL,
     "Sets the axial stiffness EA of inner cables for which the net defines no stiffness. To compute cut lengths, "
     "hifdm needs the axial stiffness of every cable"},
    {"scene.EA_boundary_N", HF_FIELD_DOUBLE, AT(EA_N[1]), HF_ABOVE_ZERO, 1e15, "", "N", NULL,
     "Sets the axial stiffness EA of boundary cables for which the net defines no stiffness. To compute cut lengths, "
     "hifdm needs the axial stiffness of every cable"},

#define FIELD(section, member, type, ...) {"scene." #section "." #member, type, AT(section.member), __VA_ARGS__},
#define FIELDS(section, type, KEYS, help) KEYS(FIELD, section)
    HF_GENERATORS(FIELDS)
#undef FIELDS
#undef FIELD

        {"scene.import.nodes", HF_FIELD_TEXT, AT(nodes_path), 1, HF_PATH_SIZE, NULL, "", NULL,
         "Sets the path of the CSV file with the nodes of the net. The columns of the node file are "
         "`id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]`. Columns in brackets are optional. A relative path starts from the "
         "folder of the case file"},
    {"scene.import.cables", HF_FIELD_TEXT, AT(cables_path), 1, HF_PATH_SIZE, NULL, "", NULL,
     "Sets the path of the CSV file with the cables of the net. The columns of the cable file are "
     "`id,i,j,group,law,value[,EA_N,set]`. Columns in brackets are optional. A relative path starts from the folder of "
     "the case file"},

    {"scene.import.facets", HF_FIELD_TEXT, AT(facets_path), 1, HF_PATH_SIZE, "", "", NULL,
     "Sets the path of the CSV file with the corner nodes of the facets. The columns of the facet file are "
     "`id,a,b,c[,d]`. Columns in brackets are optional. If a facet is a triangle, the column `d` is empty. A relative "
     "path starts from the folder of the case file. Without this key, hifdm determines the facets from the cables"},

    {"surface.kind", HF_FIELD_WORD, AT(surface.kind), 0, 0, "auto", "", hf_surface_kind_word,
     "Selects the target surface. The surface `parabolic_cylinder` is the cylinder z = x^2/(4f) with the focal length "
     "f. The surface `paraboloid` is the paraboloid z = (x^2 + y^2)/(4f) with the focal length f. For a generated net, "
     "the value `auto` selects the surface of the generator. For an imported net, the value `auto` selects the surface "
     "on which the inner nodes are"},
    {"surface.focal_length_m", HF_FIELD_DOUBLE, AT(surface.focal_length_m), HF_ABOVE_ZERO, 1e9, "", "m", NULL,
     "Sets the focal length of the target surface. For a generated net, the default focal length of the target surface "
     "is the focal length of the net"},
    {"surface.strip_width_m", HF_FIELD_DOUBLE, AT(surface.strip_width_m), HF_ABOVE_ZERO, 1e4, "", "m", NULL,
     "Sets the width of flat strips along y for the faceting error. For a net over a parabolic cylinder, the default "
     "strip width is the width of a cell"},
    {"surface.mesh_tension_N_per_m", HF_FIELD_DOUBLE, AT(surface.mesh_tension_N_per_m), 0, 1e6, "0", "N/m", NULL,
     "Sets the tension of the mesh. The mesh tension is equal in all directions. The tension of the mesh bends the "
     "cables and curves the facets into pillows. If the mesh tension is 0 N/m, the facets are flat"},
    {"surface.frequencies_Hz", HF_FIELD_DOUBLE_LIST, AT(surface.frequencies_Hz), HF_ABOVE_ZERO, 1e15, "[]", "Hz", NULL,
     "Lists up to 32 frequencies at which hifdm reports the gain loss by Ruze's formula"},

    {"surface.pattern.theta_deg", HF_FIELD_BOUNDS, AT(surface.pattern.theta_deg), -180, 180, "[-5, 5]", "deg", NULL,
     "Sets the first and the last angle of each far-field cut, measured from the +z axis. In a far-field cut, negative "
     "angles are on the opposite side of the +z axis"},
    {"surface.pattern.n_theta", HF_FIELD_INT, AT(surface.pattern.n_theta), 2, 4001, "721", "", NULL,
     "Sets the number of equally spaced angles in each far-field cut"},
    {"surface.pattern.phi_deg", HF_FIELD_DOUBLE_LIST, AT(surface.pattern.phi_deg), -360, 360, "[0, 90]", "deg", NULL,
     "Lists the angles of up to 8 far-field cuts, measured from +x towards +y"},
    {"surface.pattern.feed.kind", HF_FIELD_WORD, AT(surface.pattern.feed), 0, 0, "auto", "", hf_feed_word,
     "Selects the kind of feed. The feed `point` is a point source. The feed `line` is a line source along y. The feed "
     "`plane_wave` is a plane wave that travels along -z. The value `auto` selects a line source for a parabolic "
     "cylinder and a point source for a paraboloid"},
    {"surface.pattern.feed.position_m", HF_FIELD_VECTOR, AT(surface.pattern.position_m), -1e9, 1e9, "", "m", NULL,
     "Sets the position of the point source, or of one point on the line source. The default position of the feed is "
     "the focus of the target surface"},
    {"surface.pattern.feed.aim_m", HF_FIELD_VECTOR, AT(surface.pattern.aim_m), -1e9, 1e9, "", "m", NULL,
     "Sets the point at which the feed is aimed. By default, the feed is aimed at the centre of the aperture, on the "
     "target surface"},
    {"surface.pattern.feed.cos_power", HF_FIELD_DOUBLE, AT(surface.pattern.cos_power), 0, 1e4, "", "", NULL,
     "Sets the exponent q of the feed pattern. The field of the feed is proportional to cos^q of the angle from the "
     "feed axis. The power of the feed is proportional to cos^(2q) of the angle from the feed axis. With the default "
     "exponent, the power at the edge of the facets is 10 dB below the power on the axis. For the default exponent, "
     "hifdm neglects the differences in distance from the feed"},
    {"surface.pattern.feed.polarisation", HF_FIELD_WORD, AT(surface.pattern.polarisation), 0, 0, "x", "",
     HF_WORDS("x", "y"),
     "Sets the direction of the electric field on the feed axis. For a line source, the value `x` selects the "
     "direction across the line. For a line source, the value `y` selects the direction along the line"},

    {"form.method", HF_FIELD_WORD, AT(form.method), 0, 0, "auto", "", hf_method_word,
     "Selects the method of form-finding. The method `newton` solves the cable laws by Newton's method on the energy. "
     "The method `hifdm` solves the cable laws by the iteration of the paper (Eqs. 7 and 8). The method "
     "`iterative_fdm` applies a given tension to every cable (Eq. 7). The method `fdm` solves one linear system with "
     "the initial force densities (Eqs. 5 and 6). The value `auto` selects the method `newton` if this method is "
     "applicable, and otherwise the method `hifdm`"},
    {"form.pretension_N", HF_FIELD_DOUBLE, AT(form.pretension_N), HF_ABOVE_ZERO, 1e9, "10", "N", NULL,
     "Sets the uniform tension Td of the inner cables"},
    {"form.prestress", HF_FIELD_WORD, AT(form.prestress), 0, 0, "given", "", HF_WORDS("given", "exact"),
     "Selects whether hifdm applies the given cable laws or computes force densities. If the value is `given`, every "
     "cable obeys its given law. If the value is `exact`, hifdm computes force densities that hold all nodes at their "
     "target positions. For cables with the laws `tension` and `force_density`, the computed tensions are as close to "
     "the laws as equilibrium allows. For cables with the laws `length` and `elastic`, the computed tensions are as "
     "uniform as possible"},
    {"form.stop", HF_FIELD_WORD, AT(form.stop), 0, 0, "residual", "", hf_stop_rule_word,
     "Selects the stopping rule of the form-finding. With the rule `residual`, the iteration stops when equilibrium "
     "and cable lengths are within their tolerances. With the rule `rms_change`, the iteration stops when psi changes "
     "by less than `rms_tolerance_m`. The rule `rms_change` stops the iteration before equilibrium. Use the rule "
     "`rms_change` only to reproduce the paper"},
    {"form.residual_tolerance", HF_FIELD_DOUBLE, AT(form.residual_tolerance), 1e-13, 1, "1e-7", "", NULL,
     "Sets the maximum residual force of a node, divided by the pretension"},
    {"form.length_tolerance", HF_FIELD_DOUBLE, AT(form.length_tolerance), 1e-13, 1, "1e-7", "", NULL,
     "Sets the maximum length error |l/L* - 1| of a taut cable with the law `length`. In the length error, l is the "
     "length of the cable and L* is its target length"},
    {"form.rms_tolerance_m", HF_FIELD_DOUBLE, AT(form.rms_tolerance_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL,
     "Sets the maximum change of psi between two iterations for the stopping rule `rms_change`. For the change of psi, "
     "the paper uses a tolerance of 0.001 mm"},
    {"form.max_iterations", HF_FIELD_INT, AT(form.max_iterations), 1, 10000000, "100000", "", NULL,
     "Sets the maximum number of iterations of the form-finding. If the form-finding needs more than `max_iterations` "
     "iterations, the shape has not converged"},
    {"form.collapse_ratio", HF_FIELD_DOUBLE, AT(form.collapse_ratio), 1e-12, 0.5, "1e-3", "", NULL,
     "Sets the length ratio below which a cable with the law `tension` has collapsed. The length ratio is the length "
     "of the cable divided by its length at the target positions"},
    {"form.factor", HF_FIELD_WORD, AT(form.factor), 0, 0, "own", "", HF_WORDS("own", "lapack"),
     "Selects the code that factors matrices. The value `own` selects the band Cholesky factorisation of hifdm. The "
     "value `lapack` selects the LAPACK routines dpbtrf and dpbtrs. LAPACK factors only the positive definite matrices "
     "of the form-finding, the designs and the refinement. If the value is `lapack`, hifdm factors the matrix of each "
     "design separately. For certificates and as-built nets, hifdm always uses its own factorisation"},

    {"coupling.tof_m", HF_FIELD_DOUBLE, AT(form.coupling.tof_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL,
     "Sets the tolerance of the coupling. The coupling has converged when no attachment moves farther than the "
     "tolerance in one iteration. For the coupling, the paper uses a tolerance of 1e-3 m"},
    {"coupling.scheme", HF_FIELD_WORD, AT(form.coupling.scheme), 0, 0, "auto", "", hf_coupling_scheme_word,
     "Selects the coupling scheme. The scheme `plain` is the iteration of the paper. The scheme `accelerated` adds "
     "Anderson acceleration to the iteration of the paper. Anderson acceleration reduces the number of form-findings "
     "in the coupling. With Anderson acceleration, the coupling also converges for soft trusses. The scheme `auto` "
     "begins with the scheme `accelerated`. If the accelerated iteration is slow and Newton's method solves the net, "
     "the scheme `auto` solves net and truss in one matrix"},
    {"coupling.max_iterations", HF_FIELD_INT, AT(form.coupling.max_iterations), 1, 1000000, "200", "", NULL,
     "Sets the maximum number of form-findings in the coupling"},

    {"adjust.set", HF_FIELD_TEXT, AT(adjust.set), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "Selects the cables with turnbuckles. The value is the name of a set of cables, or `inner`, `boundary` or `all`"},
    {"adjust.range_m", HF_FIELD_DOUBLE, AT(adjust.range_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL,
     "Sets the maximum change of the cut length of each cable in either direction"},
    {"adjust.step_m", HF_FIELD_DOUBLE, AT(adjust.step_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL,
     "Sets the step size of the turnbuckles. Every turnbuckle adjustment is a multiple of the step size"},
    {"adjust.max_adjustments", HF_FIELD_INT, AT(adjust.max_adjustments), 1, 1000000, "10", "", NULL,
     "Sets the maximum number of cables that hifdm adjusts"},
    {"adjust.target_m", HF_FIELD_DOUBLE, AT(adjust.target_m), 0, BIG, "0", "m", NULL,
     "If the RMS error of the net is below the value of `target_m`, hifdm adjusts no further cables"},
    {"adjust.figure", HF_FIELD_WORD, AT(adjust.figure), 0, 0, "psi", "", hf_adjust_figure_word,
     "Selects the RMS error that the adjustments minimise. The error `psi` is the RMS distance of the inner nodes from "
     "the positions that the key `aim` selects. The error `surface` is the RMS distance of the inner nodes from the "
     "target surface, along the normal of the surface. The error `facets` is the RMS distance of the facets from the "
     "target surface"},
    {"adjust.aim", HF_FIELD_WORD, AT(adjust.aim), 0, 0, "design", "", hf_aim_word,
     "Selects the positions from which hifdm measures the error `psi`. The value `design` selects the positions of the "
     "nodes in the design. If the value is `design`, the adjustments also restore the tensions of the design. The "
     "value "
     "`target_positions` selects the target positions. If the value is `target_positions`, hifdm also uses the target "
     "positions of nodes that the design deliberately displaces"},
    {"adjust.sigma_m", HF_FIELD_DOUBLE, AT(adjust.sigma_m), HF_ABOVE_ZERO, BIG, "", "m", NULL,
     "Sets the standard deviation of each measured coordinate. If the table of measured positions gives a standard "
     "deviation for a node, hifdm ignores this key for this node"},

    {"optimize.method", HF_FIELD_WORD, AT(optimize.method), 0, 0, "ga", "", hf_optimize_method_word,
     "Selects the optimisation method. The method `ga` is the genetic algorithm. The method `lm` is the "
     "Levenberg-Marquardt method, which starts from the tensions of the form-finding. The method `ga+lm` refines the "
     "best design of the genetic algorithm by the Levenberg-Marquardt method. If the method is `ga` and the key "
     "`refine` requests a refinement, hifdm reports the refined design only for comparison"},
    {"optimize.refine", HF_FIELD_WORD, AT(optimize.refine), 0, 0, "auto", "", HF_WORDS("auto", "true", "false"),
     "Selects whether hifdm refines the best design of the genetic algorithm for comparison. hifdm refines the best "
     "design by the Levenberg-Marquardt method. If the value is `auto`, hifdm requires that the refinement takes less "
     "than a tenth of the time of the genetic algorithm. A refinement that takes less than about a tenth of a second "
     "is always allowed"},
    {"optimize.rule", HF_FIELD_WORD, AT(optimize.rule), 0, 0, "force_density", "", hf_rule_word,
     "Selects how the pretension T' of a design acts on a boundary cable. With the rule `force_density`, the cable has "
     "the force density T'/L*, where L* is the target length. With the rule `force_density`, the shape is always "
     "unique. With the rule `tension`, the tension of the cable is T'. The rule `seeded` solves Eq. 8 from the initial "
     "force density T'/L* with the stopping rule `rms_change`. With the rule `seeded`, the optimum depends on the "
     "iteration at which the form-finding stops"},
    {"optimize.symmetry", HF_FIELD_WORD, AT(optimize.symmetry), 0, 0, "none", "", hf_symmetry_word,
     "Selects mirror planes of the net. Boundary cables that are mirror images of each other change by the same "
     "amount. Symmetry reduces the number of independent design variables. All mirror planes run through the middle of "
     "the net. The value `x` selects the mirror plane perpendicular to x. The value `y` selects the mirror plane "
     "perpendicular to y. The value `xy` selects the mirror planes perpendicular to x and to y. The value `auto` "
     "selects each of the two mirror planes about which the net is symmetric"},
    {"optimize.solver", HF_FIELD_WORD, AT(optimize.solver), 0, 0, "auto", "", hf_solver_word,
     "Selects the solver of the individuals. With the solver `chord`, all designs share one factored Newton matrix. "
     "The solver `chord` solves eight designs at a time. The solver `newton` factors a separate matrix for each "
     "design. The solver `fixed_point` is the iteration of the paper. The value `auto` selects the first applicable "
     "solver in the order `chord`, `newton`, `fixed_point`"},
    {"optimize.population", HF_FIELD_INT, AT(optimize.population), 2, 100000, "50", "", NULL,
     "Sets the number of individuals"},
    {"optimize.generations", HF_FIELD_INT, AT(optimize.generations), 1, 1000000, "400", "", NULL,
     "Sets the maximum number of generations"},
    {"optimize.range_N", HF_FIELD_DOUBLE, AT(optimize.range_N), HF_ABOVE_ZERO, 1e9, "1", "N", NULL,
     "Sets the maximum change |dT| of a boundary pretension from its value after form-finding (Eq. 13)"},
    {"optimize.min_tension_N", HF_FIELD_DOUBLE, AT(optimize.min_tension_N), HF_ABOVE_ZERO, 1e9, "0.1", "N", NULL,
     "Sets the lower bound of each boundary pretension. Eq. 12 of the paper requires pretensions above 0 N"},
    {"optimize.max_tension_N", HF_FIELD_DOUBLE, AT(optimize.max_tension_N), HF_ABOVE_ZERO, BIG, "1e6", "N", NULL,
     "Sets the upper bound of each boundary pretension"},
    {"optimize.boundary_ratio_cap", HF_FIELD_DOUBLE, AT(optimize.boundary_ratio_cap), 1, BIG, "10", "", NULL,
     "Sets the maximum boundary tension ratio. If the boundary tension ratio of an individual exceeds "
     "`boundary_ratio_cap`, the individual is infeasible"},
    {"optimize.seed", HF_FIELD_UINT64, AT(optimize.seed), 0, 18446744073709551615.0, "1", "", NULL,
     "Sets the seed of the random numbers. For any number of threads, the same seed leads to the same results"},
    {"optimize.crossover_high", HF_FIELD_DOUBLE, AT(optimize.crossover_high), 0, 1, "0.9", "", NULL,
     "Sets the parameter Pc1 of the adaptive crossover rate (Srinivas and Patnaik 1994)"},
    {"optimize.crossover_low", HF_FIELD_DOUBLE, AT(optimize.crossover_low), 0, 1, "0.6", "", NULL,
     "Sets the parameter Pc2 of the adaptive crossover rate"},
    {"optimize.mutation_high", HF_FIELD_DOUBLE, AT(optimize.mutation_high), 0, 1, "0.1", "", NULL,
     "Sets the parameter Pm1 of the adaptive mutation rate"},
    {"optimize.mutation_low", HF_FIELD_DOUBLE, AT(optimize.mutation_low), 0, 1, "0.001", "", NULL,
     "Sets the parameter Pm2 of the adaptive mutation rate"},
    {"optimize.variation", HF_FIELD_WORD, AT(optimize.variation), 0, 0, "difference", "",
     HF_WORDS("difference", "chain"),
     "Selects how the genetic algorithm creates children. With the variation `difference`, a crossover moves an elite "
     "individual along the difference of two parents. Children of the variation `difference` replace worse "
     "individuals. With the variation `chain`, a crossover mixes two parents chain by chain. Children of the variation "
     "`chain` replace the whole generation"},
    {"optimize.elites", HF_FIELD_INT, AT(optimize.elites), 1, 100000, "1", "", NULL,
     "Sets the number of elite individuals. Elite individuals are the best individuals of a generation. If the "
     "variation is `chain`, the elite individuals survive unchanged. If the variation is `difference`, the crossovers "
     "start from the elite individuals"},
    {"optimize.stagnation_tolerance_m", HF_FIELD_DOUBLE, AT(optimize.stagnation_tolerance_m), 0, BIG, "1e-6", "m", NULL,
     "Sets the stagnation tolerance. If the best psi or merit improves by less than the stagnation tolerance in "
     "`stagnation_generations` generations, the genetic algorithm stops"},
    {"optimize.stagnation_generations", HF_FIELD_INT, AT(optimize.stagnation_generations), 1, 1000000, "50", "", NULL,
     "Sets the number of generations over which hifdm measures the improvement of the best individual"},
    {"optimize.store", HF_FIELD_WORD, AT(optimize.store), 0, 0, "all", "", hf_keep_word,
     "Selects the individuals that hifdm stores in the result file. The value `all` selects all individuals of all "
     "generations. The value `best` selects the best individual of each generation. The value `every` selects one "
     "generation in every `store_every` generations. hifdm always stores the last generation"},
    {"optimize.store_every", HF_FIELD_INT, AT(optimize.store_every), 2, 1000000, "100", "", NULL,
     "If the key `store` is `every`, the key `store_every` sets the interval n of the stored generations. With the "
     "interval n, hifdm stores the generations 0, n, 2n and so on"},
    {"optimize.refine_steps", HF_FIELD_INT, AT(optimize.refine_steps), 1, 100000, "200", "", NULL,
     "Sets the maximum number of steps of the Levenberg-Marquardt method"},
    {"optimize.samples", HF_FIELD_INT, AT(optimize.samples), 2, 100000, "64", "", NULL,
     "Sets the number of as-built samples from which hifdm computes objectives. For all designs, hifdm uses the same "
     "random errors. The random errors for objectives are the first samples of the sampling method `random`"},
    {"optimize.front_points", HF_FIELD_INT, AT(optimize.front_points), 3, HF_FRONT_POINTS_MAX, "21", "", NULL,
     "Sets the number of points of the Pareto front that the Levenberg-Marquardt method computes. The number of points "
     "includes the ends of the Pareto front"},

    {"tolerance.sigma_cut_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_m), 0, 1, "0", "m", NULL,
     "Sets the standard deviation of each cut length"},
    {"tolerance.sigma_cut_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_ratio), 0, 0.05, "0", "", NULL,
     "Sets the standard deviation of each cut length as a fraction of the length. The scale error of a measuring tape "
     "is an example of a relative length error"},
    {"tolerance.sigma_EA_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_EA_ratio), 0, 0.05, "0", "", NULL,
     "Sets the standard deviation of each axial stiffness EA as a fraction of EA"},
    {"tolerance.sigma_support_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_support_m), 0, 1, "0", "m", NULL,
     "Sets the standard deviation of each coordinate of each support. For an attachment to the truss, this key applies "
     "to the position before the truss deflects"},
    {"tolerance.sigma_temperature_K", HF_FIELD_DOUBLE, AT(tolerance.sigma_temperature_K), 0, 1000, "0", "K", NULL,
     "Sets the standard deviation of the temperature of the cables. All cables of a sample have the same temperature "
     "error. This key requires the key `expansion_per_K` in the list `cables`. For temperature errors of the truss, "
     "use the list `tolerance.truss`"},
    {"tolerance.distribution", HF_FIELD_WORD, AT(tolerance.distribution), 0, 0, "normal", "", hf_distribution_word,
     "Selects the distribution of the random errors. A uniform distribution extends from -1.73 to +1.73 standard "
     "deviations"},
    {"tolerance.batch", HF_FIELD_DOUBLE, AT(tolerance.batch), 0, 1, "0", "", NULL,
     "Sets the correlation of errors among the cables of one spool. The correlation applies separately to relative "
     "errors of cut length and to relative errors of stiffness. Each set of cables is one spool. If a cable is in "
     "several sets, it belongs to the spool of the first set by name. A cable without a set belongs to the spool "
     "`inner` or to the spool `boundary`"},
    {"tolerance.samples", HF_FIELD_INT, AT(tolerance.samples), 10, 100000000, "1000", "", NULL,
     "Sets the number of samples. With fewer than 10 samples, the 95 % confidence intervals would be more than 15 % "
     "too narrow. The confidence intervals assume normal distributions"},
    {"tolerance.seed", HF_FIELD_UINT64, AT(tolerance.seed), 0, 18446744073709551615.0, "1", "", NULL,
     "Sets the seed of the random numbers. For any number of threads, the same seed leads to the same samples"},
    {"tolerance.sampling", HF_FIELD_WORD, AT(tolerance.sampling), 0, 0, "random", "", hf_sampling_word,
     "Selects the sampling method. The method `random` uses random numbers. The method `sobol` uses Sobol's sequence "
     "in the 40 error directions that change the shape most. Statistics over Sobol points converge faster than "
     "statistics over random points"},
    {"tolerance.required_yield", HF_FIELD_DOUBLE, AT(tolerance.required_yield), 0, 0.9999, "0", "", NULL,
     "Sets the fraction of samples that must meet the requirements in `tolerance.require`. If the required yield is "
     "above 0, hifdm reports the factor by which all errors may grow or must shrink"},

#define FIELD(section, member, type, ...) {"truss." #member, type, AT(section.member), __VA_ARGS__},
    HF_TRUSS_KEYS(FIELD, truss)
#undef FIELD
        {"truss.match_tolerance_m", HF_FIELD_DOUBLE, AT(truss.match_tolerance_m), 0, 1e3, "1e-6", "m", NULL,
         "Sets the maximum distance between a support of the net and the truss node that carries the support"},

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
                     "Sets the path of the CSV file with the nodes of the truss. The columns of the node file are "
                     "`id,x_m,y_m,z_m,fixed[,mass_kg]`. Columns in brackets are optional. The column `fixed` lists the "
                     "fixed degrees of freedom of a node, for example `ux uy uz rx ry rz`. The column `fixed` can also "
                     "contain `all` or be empty. A relative path starts from the folder of the case file"},
    {"truss.import.members", HF_FIELD_TEXT, AT(truss_members_path), 1, HF_PATH_SIZE, NULL, "", NULL,
     "Sets the path of the CSV file with the members of the truss. The columns of the member file are "
     "`id,i,j,E_Pa,A_m2[,G_Pa,Iy_m4,Iz_m4,J_m4,Asy_m2,Asz_m2,roll_rad,density_kg_per_m3,expansion_per_K,joint,unit]`. "
     "Columns in brackets are optional. The column `joint` contains `rigid` or `pinned`. A relative path starts from "
     "the folder of the case file"},
};
const int hf_n_field = sizeof hf_field_table / sizeof *hf_field_table;

/* ---- lists of rows ---- */

#define IN(row, member) offsetof(hf_##row##_settings, member)

_Static_assert(IN(variable, range_ratio) == IN(variable, range) + sizeof(double) &&
                   IN(variable, upper) == IN(variable, lower) + sizeof(double),
               "a range is an amount, bounds are bounds");
static const hf_field variable_field[] = {
    {"set", HF_FIELD_TEXT, IN(variable, set), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "Selects the cables that vary, or the cables whose supports vary. The value is the name of a set of cables, or "
     "`inner`, `boundary` or `all`"},
    {"vary", HF_FIELD_WORD, IN(variable, vary), 0, 0, NULL, "", hf_vary_word,
     "Selects the quantity that varies. For the quantities `tension` (N), `force_density` (N/m) and `length` (m), each "
     "cable obeys the law with the name of the quantity. The quantity `unstressed_length` (m) is available only for "
     "cables with the law `elastic`. The quantity `support_z` (m) is a displacement along z of the supports at the "
     "ends of the cables. The quantity `support_normal` (m) is a support displacement along the normal of the target "
     "surface. The quantity `support_xyz` (m) is a support displacement along x, y and z"},
    {"range", HF_FIELD_AMOUNT, IN(variable, range), HF_ABOVE_ZERO, BIG, "", "", NULL,
     "Sets the maximum change of the quantity from its value after form-finding. The range is a value in the unit of "
     "the quantity, or a percentage of the value after form-finding. Without this key, only the key `bounds` limits "
     "the change"},
    {"bounds", HF_FIELD_BOUNDS, IN(variable, lower), -BIG, BIG, "", "", NULL,
     "Sets the lower bound and the upper bound of the quantity, in its unit. Without this key, only the key `range` "
     "limits the quantity"},
    {"link", HF_FIELD_WORD, IN(variable, link), 0, 0, "each", "", HF_WORDS("each", "set", "symmetry"),
     "Selects the design variables that change together. If the value is `each`, every cable changes independently. If "
     "the value is `set`, all cables of the row change by the same amount. If the value is `symmetry`, cables that are "
     "mirror images of each other change by the same amount. The key `optimize.symmetry` selects the mirror planes of "
     "the net"},
};

static const hf_field objective_field[] = {
    {"figure", HF_FIELD_WORD, IN(objective, figure), 0, 0, NULL, "", hf_figure_kind_word,
     "Selects the quantity that hifdm minimises. The quantity `psi` is the RMS distance of the inner nodes from their "
     "target positions (m). The quantity `surface` is the RMS distance of the inner nodes from the target surface (m). "
     "The quantity `facets` is the RMS distance of the facets from the target surface (m). The quantity `tension` is "
     "the RMS difference between the tensions of the set and the target (N). The quantity `length` is the RMS "
     "difference between the lengths of the set and the target (m). The quantity `evenness` is the standard deviation "
     "of the tensions of the set divided by their mean. The quantity `pull` is the maximum force of the net on a "
     "support (N). The quantity `deflection` is the maximum deflection of the truss at an attachment (m). The quantity "
     "`mass` is the mass of the cables of the set (kg). The quantity `ratio` is the maximum tension of the set divided "
     "by its minimum tension. The quantity `gain` is the square root of the fraction of gain lost in the direction of "
     "the beam. hifdm computes the lost gain by physical optics with the settings of the section `surface.pattern`"},
    {"set", HF_FIELD_TEXT, IN(objective, set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Selects the cables of the quantities `tension`, `length`, `evenness`, `mass` and `ratio`. Without this key, the "
     "objective applies to all cables"},
    {"target", HF_FIELD_DOUBLE, IN(objective, target), -BIG, BIG, "", "", NULL,
     "Sets the target value of the quantity `tension` (N) or `length` (m). The quantity `tension` requires this key. "
     "For the quantity `length`, the default targets are the cable lengths at the target positions"},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(objective, mass_kg_per_m), HF_ABOVE_ZERO, BIG, "", "kg/m", NULL,
     "Sets the mass of the cables per metre. The quantity `mass` requires this key"},
    {"along", HF_FIELD_WORD, IN(objective, along), 0, 0, "normal", "", HF_WORDS("normal", "half_path"),
     "Selects how hifdm measures the distance for the quantities `surface` and `facets`. The value `normal` selects "
     "the distance along the normal of the target surface. The value `half_path` selects half the change in the path "
     "length of a ray"},
    {"fit", HF_FIELD_WORD, IN(objective, fit), 0, 0, "none", "", HF_WORDS("none", "best"),
     "Selects the reference surface for the quantities `surface` and `facets`. The value `none` selects the target "
     "surface itself. The value `best` selects the best fit of the target surface to the shape"},
    {"frequency_Hz", HF_FIELD_DOUBLE, IN(objective, frequency_Hz), HF_ABOVE_ZERO, 1e15, "", "Hz", NULL,
     "Sets the frequency of the quantity `gain`. The default frequency of the quantity `gain` is the highest frequency "
     "in the key `surface.frequencies_Hz`"},
    {"load_case", HF_FIELD_TEXT, IN(objective, load_case), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Selects the load case in which hifdm computes the quantity for the as-built net. If the value is `all`, hifdm "
     "computes the quantity in all load cases"},
    {"over", HF_FIELD_WORD, IN(objective, over), 0, 0, "design", "", hf_over_word,
     "Selects the nets for which hifdm computes the quantity. The value `design` selects the design itself. The value "
     "`samples` selects as-built samples with the errors of the section `tolerance`"},
    {"take", HF_FIELD_WORD, IN(objective, take), 0, 0, "mean", "", hf_take_word,
     "Selects how hifdm combines the values of all load cases or samples. The value `mean` selects the RMS of the "
     "values. The value `worst` selects the maximum of the values"},
    {"quantile", HF_FIELD_DOUBLE, IN(objective, quantile), HF_ABOVE_ZERO, 1, "", "", NULL,
     "Replaces the key `take` by a quantile over all samples. The value is the fraction of samples that do not exceed "
     "the quantile. Only the optimisation method `ga` supports this key"},
    {"weight", HF_FIELD_DOUBLE, IN(objective, weight), HF_ABOVE_ZERO, BIG, "1", "", NULL,
     "Sets the weight of an objective in the merit of a design. The merit is the square root of the sum of (weight * "
     "value)^2 over all objectives"},
};

_Static_assert(IN(limit, upper) == IN(limit, lower) + sizeof(double), "bounds are bounds");
static const hf_field limit_field[] = {
    {"figure", HF_FIELD_WORD, IN(limit, figure), 0, 0, NULL, "", hf_limit_word,
     "Selects the quantity to which the limit applies. The limit `tension` applies to the tension of each cable of the "
     "set (N). The limit `ratio` applies to the maximum tension of the set divided by its minimum tension. The limit "
     "`deflection` applies to the deflection of the truss at each attachment (m)"},
    {"set", HF_FIELD_TEXT, IN(limit, set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Selects the cables of the limits `tension` and `ratio`. Without this key, the limit applies to all cables"},
    {"bounds", HF_FIELD_BOUNDS, IN(limit, lower), -BIG, BIG, NULL, "", NULL,
     "Sets the lower bound and the upper bound of the quantity"},
};

static const hf_field cable_field[] = {
    {"set", HF_FIELD_TEXT, IN(cable, set), 1, HF_SET_NAME_SIZE, "all", "", NULL,
     "Selects the cables to which the row applies. The value is the name of a set of cables, or `inner`, `boundary` or "
     "`all`"},
    {"expansion_per_K", HF_FIELD_DOUBLE, IN(cable, expansion_per_K), -1, 1, "", "1/K", NULL,
     "Sets the coefficient of thermal expansion of the cables. If the value is 0, the cables have no thermal expansion"},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(cable, mass_kg_per_m), 0, 1e6, "", "kg/m", NULL,
     "Sets the mass of the cables per metre of unstressed length"},
};

static const hf_field node_field[] = {
    {"role", HF_FIELD_WORD, IN(node, role), 0, 0, "all", "", hf_nodes_word,
     "Selects the nodes to which the row applies. The value is `all`, or one of the node roles `support`, `inner` and "
     "`edge`"},
    {"mass_kg", HF_FIELD_DOUBLE, IN(node, mass_kg), 0, 1e6, NULL, "kg", NULL, "Sets the mass of each node"},
};

static const hf_field load_case_field[] = {
    {"name", HF_FIELD_TEXT, IN(load_case, name), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "Sets the name of the load case. The name of a load case consists of letters, digits, underscores and hyphens. "
     "Rows with the same name form one load case"},
    {"set", HF_FIELD_TEXT, IN(load_case, set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "Selects the cables to which the temperature applies. The value is the name of a set of cables, or `inner`, "
     "`boundary` or `all`"},
    {"part", HF_FIELD_WORD, IN(load_case, part), 0, 0, "all", "", hf_part_word,
     "Selects the part of the structure to which the temperature applies. The value `all` selects net and truss. The "
     "value `net` selects all cables. The value `truss` selects the whole truss. Any other value of this key selects "
     "the members of one truss unit"},
    {"temperature_K", HF_FIELD_DOUBLE, IN(load_case, temperature_K), -1e4, 1e4, "", "K", NULL,
     "Sets the temperature as a difference from the reference temperature. At the reference temperature, the cables "
     "were cut and the truss was made. If several rows of a load case set the temperature of a part, the last row "
     "applies"},
    {"gradient_K_per_m", HF_FIELD_VECTOR, IN(load_case, gradient_K_per_m), -1e4, 1e4, "", "K/m", NULL,
     "Sets the temperature gradient. At each position, hifdm adds the scalar product of gradient and position to the "
     "value of `temperature_K`"},
    {"gravity_m_per_s2", HF_FIELD_DOUBLE, IN(load_case, gravity_m_per_s2), HF_ABOVE_ZERO, 1e6, "", "m/s2", NULL,
     "Sets the gravitational acceleration. From the gravitational acceleration, hifdm computes the weight of cables, "
     "nodes and truss"},
    {"direction", HF_FIELD_VECTOR, IN(load_case, direction), -1e9, 1e9, "", "", NULL,
     "Sets the direction of gravity as a vector of any length. The default direction of gravity is [0, 0, -1]"},
    {"force_N", HF_FIELD_VECTOR, IN(load_case, force_N), -1e12, 1e12, "", "N", NULL,
     "Sets the force on each node that the key `role` selects"},
    {"role", HF_FIELD_WORD, IN(load_case, role), 0, 0, "all", "", hf_nodes_word,
     "Selects the nodes on which the force `force_N` acts"},
    {"support_displacement_m", HF_FIELD_VECTOR, IN(load_case, support_displacement_m), -1e6, 1e6, "", "m", NULL,
     "Sets the displacement of all supports from their positions in the design. If a truss carries the net, hifdm adds "
     "the displacement to the positions on the deflected truss"},
    {"nodes", HF_FIELD_TEXT, IN(load_case, nodes_path), 1, HF_PATH_SIZE, "", "", NULL,
     "Sets the path of a CSV file with forces on nodes and displacements of supports. The columns of the load file are "
     "`id[,Fx_N,Fy_N,Fz_N][,dx_m,dy_m,dz_m]`. Columns in brackets are optional. A relative path starts from the folder "
     "of the case file"},
};

static const hf_field require_field[] = {
    {"measure", HF_FIELD_WORD, IN(require, measure), 0, 0, NULL, "", hf_tolerance_measure_word,
     "Selects the measure of the as-built net that the requirement limits. Measures of the surface require the section "
     "`surface`. Measures of the facets require a net with facets. Losses by Ruze's formula have names that end in "
     "`gain_loss_dB`. Losses by Ruze's formula require the key `surface.frequencies_Hz`. The measure `pattern_loss_dB` "
     "requires the section `surface.pattern`. hifdm computes measures with `fit_` in their name after the best fit. "
     "The best fit describes a reflector that has been pointed and focused again"},
    {"at_most", HF_FIELD_DOUBLE, IN(require, at_most), -BIG, BIG, "", "", NULL,
     "Sets the maximum allowed value of the measure"},
    {"at_least", HF_FIELD_DOUBLE, IN(require, at_least), -BIG, BIG, "", "", NULL,
     "Sets the minimum allowed value of the measure"},
};

static const hf_field truss_heat_field[] = {
    {"part", HF_FIELD_WORD, IN(truss_heat, part), 0, 0, NULL, "", hf_part_word + HF_PART_TRUSS,
     "Selects the members to which the temperature error applies. The value `truss` selects the whole truss. Any other "
     "value of this key selects the members of one truss unit"},
    {"sigma_temperature_K", HF_FIELD_DOUBLE, IN(truss_heat, sigma_temperature_K), HF_ABOVE_ZERO, 1000, NULL, "K", NULL,
     "Sets the standard deviation of the temperature of the selected members. This key requires the key "
     "`truss.expansion_per_K`"},
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
         "Each row of the list `optimize.variables` defines design variables. If the list `optimize.variables` is "
         "empty, the design variables are the pretensions of the boundary cables. The key `optimize.range_N` limits "
         "the change of the boundary pretensions. The key `optimize.rule` determines how the boundary pretensions act "
         "on the cables"),
    LIST("optimize.objective", optimize.n_term, optimize.term, HF_DESIGN_ROWS_MAX, objective_field, 0,
         "Each row of the list `optimize.objective` defines one objective. The merit of a design combines all "
         "objectives. If the list `optimize.objective` is empty, the objective is psi"),
    /* A row of optimize.front has the keys of a row of optimize.objective without the last one, weight. */
    LIST("optimize.front", optimize.n_front, optimize.front, HF_FRONT_OBJECTIVES_MAX, objective_field, 1,
         "The list `optimize.front` defines the two or three objectives of a Pareto front. If the list "
         "`optimize.front` has rows, the run computes a Pareto front instead of one design. No other design dominates "
         "a design of the Pareto front"),
    LIST("optimize.limits", optimize.n_limit, optimize.limit, HF_DESIGN_ROWS_MAX, limit_field, 0,
         "Each row of the list `optimize.limits` defines a limit that all designs must satisfy"),
    LIST("cables", built.n_cable, built.cable, HF_MATERIAL_ROWS_MAX, cable_field, 0,
         "Each row of the list `cables` sets material properties of cables in the as-built net. If several rows set "
         "the same property of a cable, the last row applies"),
    LIST("nodes", built.n_node, built.node, HF_MATERIAL_ROWS_MAX, node_field, 0,
         "Each row of the list `nodes` sets the mass of joints in the as-built net. If several rows set the mass of a "
         "node, the last row applies"),
    LIST("load_cases", built.n_load_case, built.load_case, HF_LOAD_CASE_ROWS_MAX, load_case_field, 0,
         "The list `load_cases` defines up to 16 load cases of the as-built net. A load case can include temperatures, "
         "gravity, forces and displacements of supports. If the list `load_cases` is empty, hifdm computes no load "
         "cases"),
    LIST("tolerance.require", tolerance.n_require, tolerance.require, HF_REQUIRE_ROWS_MAX, require_field, 0,
         "Each row of the list `tolerance.require` defines a requirement for each as-built net. If the list "
         "`tolerance.require` is empty, hifdm computes no yield"),
    LIST("tolerance.truss", tolerance.n_truss, tolerance.truss, HF_TRUSS_HEAT_ROWS_MAX, truss_heat_field, 0,
         "Each row of the list `tolerance.truss` defines an independent temperature error of the truss. If several "
         "rows apply to the same members, hifdm adds the temperature errors of the rows. If the list `tolerance.truss` "
         "is empty, the temperature of the truss does not vary"),
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

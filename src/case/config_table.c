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
    {"surface", AT(has_surface), "Measures of the reflecting surface. Without this section there are none."},
    {"surface.pattern", AT(surface.has_pattern),
     "The far field by physical optics over the facets, at surface.frequencies_Hz. Without this section there is "
     "none."},
    {"surface.pattern.feed", AT(surface.has_pattern), "What illuminates the reflector."},
    {"form", SIZE_MAX, "Form-finding. May be left out: the defaults hold."},
    {"optimize", AT(has_optimize), "Optimisation of the boundary pretensions. Without this section none runs."},
    {"tolerance", AT(has_tolerance),
     "Samples of the as-built net, with errors of cut lengths, stiffness and supports. Without this section there are "
     "none. Needs EA of all cables."},
    {"truss", AT(has_truss),
     "The deployable truss that carries the net. Without this section the supports stand on rigid ground. The paper "
     "prints no dimensions: every default here is an assumption."},
    {"truss.bud", AT(has_truss), "Basic unit on the directrix: planar trusses on the module borders along x."},
    {"truss.mbug", AT(has_truss), "Main basic unit on the generatrix, along y."},
    {"truss.abug", AT(has_truss), "Assistant basic unit on the generatrix: the lines along y between the main ones."},
    {"truss.ring", AT(has_truss_ring),
     "Instead of the generated units: a hoop truss under the rim of scene.paraboloid, in the material of the section "
     "truss. Every default is an assumption."},
    {"truss.ring.longeron", AT(has_truss_ring), "Members of the two rings."},
    {"truss.ring.vertical", AT(has_truss_ring), "Members between the rings."},
    {"truss.ring.diagonal", AT(has_truss_ring), "Members across the bays."},
    {"truss.import", AT(has_truss_import), "Instead of the generated units: any truss from two CSV files."},
    {"coupling", SIZE_MAX, "Of the net with its truss (Fig. 17). Without a truss nothing of it is used."},
    {"adjust", AT(has_adjust),
     "Turnbuckles of the as-built net, for `hifdm adjust`, which finds adjustments from measured positions."},
    {"sweep", AT(has_sweep),
     "Axes of a sweep, key: [values] or key: {from, to, n}: for `hifdm sweep`, which runs the case once per point."},
};
const int hf_n_section = sizeof hf_section_table / sizeof *hf_section_table;

const hf_field hf_field_table[] = {
    {"title", HF_FIELD_TEXT, AT(title), 0, sizeof((hf_case *)0)->title, "", "", NULL, "one line for people"},

    {"scene.EA_inner_N", HF_FIELD_DOUBLE, AT(EA_N[0]), HF_ABOVE_ZERO, 1e15, "", "N", NULL,
     "axial stiffness EA of the inner cables, where the net gives none: for cut lengths"},
    {"scene.EA_boundary_N", HF_FIELD_DOUBLE, AT(EA_N[1]), HF_ABOVE_ZERO, 1e15, "", "N", NULL,
     "the same of the boundary cables"},

#define FIELD(section, member, type, ...) {"scene." #section "." #member, type, AT(section.member), __VA_ARGS__},
#define FIELDS(section, type, KEYS, help) KEYS(FIELD, section)
    HF_GENERATORS(FIELDS)
#undef FIELDS
#undef FIELD

        {"scene.import.nodes", HF_FIELD_TEXT, AT(nodes_path), 1, HF_PATH_SIZE, NULL, "", NULL,
         "CSV id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]; path relative to the case file"},
    {"scene.import.cables", HF_FIELD_TEXT, AT(cables_path), 1, HF_PATH_SIZE, NULL, "", NULL,
     "CSV id,i,j,group,law,value[,EA_N,set]; path relative to the case file"},

    {"scene.import.facets", HF_FIELD_TEXT, AT(facets_path), 1, HF_PATH_SIZE, "", "", NULL,
     "CSV id,a,b,c[,d]: nodes around each facet, of a triangle without d; default: facets are found from the cables; "
     "path relative to the case file"},

    {"surface.kind", HF_FIELD_WORD, AT(surface.kind), 0, 0, "auto", "", hf_surface_kind_word,
     "parabolic_cylinder: z = x^2/(4f) along y; paraboloid: z = (x^2 + y^2)/(4f); auto: that of a generated net, of an "
     "imported one the one that its inner nodes are on"},
    {"surface.focal_length_m", HF_FIELD_DOUBLE, AT(surface.focal_length_m), HF_ABOVE_ZERO, 1e9, "", "m", NULL,
     "of the target surface; default: that of a generated net"},
    {"surface.strip_width_m", HF_FIELD_DOUBLE, AT(surface.strip_width_m), HF_ABOVE_ZERO, 1e4, "", "m", NULL,
     "width of the flat strips along y, for the faceting error; default: a cell of parabolic_cylinder"},
    {"surface.mesh_tension_N_per_m", HF_FIELD_DOUBLE, AT(surface.mesh_tension_N_per_m), 0, 1e6, "0", "N/m", NULL,
     "of the mesh, in all directions: it bends the cables between two facets, and the facets are pillows; 0: they are "
     "flat"},
    {"surface.frequencies_Hz", HF_FIELD_DOUBLE_LIST, AT(surface.frequencies_Hz), HF_ABOVE_ZERO, 1e15, "[]", "Hz", NULL,
     "up to 32, at which the gain loss is reported (Ruze)"},

    {"surface.pattern.theta_deg", HF_FIELD_BOUNDS, AT(surface.pattern.theta_deg), -180, 180, "[-5, 5]", "deg", NULL,
     "first and last angle from +z of each cut; below 0 on the other side of +z"},
    {"surface.pattern.n_theta", HF_FIELD_INT, AT(surface.pattern.n_theta), 2, 4001, "721", "", NULL,
     "angles of each cut, at even steps"},
    {"surface.pattern.phi_deg", HF_FIELD_DOUBLE_LIST, AT(surface.pattern.phi_deg), -360, 360, "[0, 90]", "deg", NULL,
     "up to 8 cuts, angles from +x towards +y"},
    {"surface.pattern.feed.kind", HF_FIELD_WORD, AT(surface.pattern.feed), 0, 0, "auto", "", hf_feed_word,
     "point; line along y; plane_wave that falls along -z; auto: a line of a parabolic cylinder, a point of a "
     "paraboloid"},
    {"surface.pattern.feed.position_m", HF_FIELD_VECTOR, AT(surface.pattern.position_m), -1e9, 1e9, "", "m", NULL,
     "of a point, or of a line along y through it; default: the focus of the target surface"},
    {"surface.pattern.feed.aim_m", HF_FIELD_VECTOR, AT(surface.pattern.aim_m), -1e9, 1e9, "", "m", NULL,
     "the point that the feed looks at; default: the middle of the aperture, on the target surface"},
    {"surface.pattern.feed.cos_power", HF_FIELD_DOUBLE, AT(surface.pattern.cos_power), 0, 1e4, "", "", NULL,
     "q: the field of the feed goes as cos^q of the angle from its axis, its power as cos^(2q); default: 10 dB less at "
     "the edge of the facets, distances aside"},
    {"surface.pattern.feed.polarisation", HF_FIELD_WORD, AT(surface.pattern.polarisation), 0, 0, "x", "",
     HF_WORDS("x", "y"), "of the electric field on the axis of the feed; of a line: across it or along it"},

    {"form.method", HF_FIELD_WORD, AT(form.method), 0, 0, "auto", "", hf_method_word,
     "auto: newton where it applies, else hifdm; newton: every cable obeys its own law, by Newton on the energy; "
     "hifdm: "
     "the same by the paper's iteration (Eqs. 7, 8); iterative_fdm: every cable is held at a tension (Eq. 7); fdm: one "
     "solve with the starting force densities (Eqs. 5, 6)"},
    {"form.pretension_N", HF_FIELD_DOUBLE, AT(form.pretension_N), HF_ABOVE_ZERO, 1e9, "10", "N", NULL,
     "uniform tension Td of the inner cables"},
    {"form.prestress", HF_FIELD_WORD, AT(form.prestress), 0, 0, "given", "", HF_WORDS("given", "exact"),
     "given: every cable keeps its law; exact: every cable gets the force density that holds all nodes at their "
     "target positions. The tensions are as near as equilibrium allows to those of the laws tension and force_density, "
     "and even where the laws give none (length, elastic)"},
    {"form.stop", HF_FIELD_WORD, AT(form.stop), 0, 0, "residual", "", hf_stop_rule_word,
     "residual: equilibrium and lengths within the tolerances; rms_change: the paper's rule, psi changes by less than "
     "rms_tolerance_m (stops early, for reproduction)"},
    {"form.residual_tolerance", HF_FIELD_DOUBLE, AT(form.residual_tolerance), 1e-13, 1, "1e-7", "", NULL,
     "maximum nodal residual, relative to the pretension"},
    {"form.length_tolerance", HF_FIELD_DOUBLE, AT(form.length_tolerance), 1e-13, 1, "1e-7", "", NULL,
     "maximum |l/L*-1| of a taut cable of law length"},
    {"form.rms_tolerance_m", HF_FIELD_DOUBLE, AT(form.rms_tolerance_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL,
     "change of psi between two iterations at which rms_change stops (0.001 mm in the paper)"},
    {"form.max_iterations", HF_FIELD_INT, AT(form.max_iterations), 1, 10000000, "100000", "", NULL,
     "bound on the iterations; reached: not converged"},
    {"form.collapse_ratio", HF_FIELD_DOUBLE, AT(form.collapse_ratio), 1e-12, 0.5, "1e-3", "", NULL,
     "a cable of law tension has collapsed if it is shorter than this part of its length at the target positions"},
    {"form.factor", HF_FIELD_WORD, AT(form.factor), 0, 0, "own", "", HF_WORDS("own", "lapack"),
     "own: band Cholesky of this program; lapack: dpbtrf and dpbtrs of LAPACK for the positive definite matrices of "
     "form-finding, of designs and of refinement; every design then has a factor of its own. Certificates and as-built "
     "nets always use own"},

    {"coupling.tof_m", HF_FIELD_DOUBLE, AT(form.coupling.tof_m), HF_ABOVE_ZERO, BIG, "1e-6", "m", NULL,
     "net and truss are one when no attachment moves farther than this any more; the paper takes 1e-3"},
    {"coupling.scheme", HF_FIELD_WORD, AT(form.coupling.scheme), 0, 0, "auto", "", hf_coupling_scheme_word,
     "plain: the paper's loop, displacements straight from the forces; accelerated: the same with Anderson's method, "
     "which needs fewer form-findings and also holds for softer trusses; auto: accelerated, and where that is slow net "
     "and truss in one matrix, if the net is solved by Newton's method"},
    {"coupling.max_iterations", HF_FIELD_INT, AT(form.coupling.max_iterations), 1, 1000000, "200", "", NULL,
     "form-findings in this loop before it is given up"},

    {"adjust.set", HF_FIELD_TEXT, AT(adjust.set), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "cables that can be turned: a set of the net, or inner, boundary, all"},
    {"adjust.range_m", HF_FIELD_DOUBLE, AT(adjust.range_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL,
     "how far the cut length of each may be changed, either way"},
    {"adjust.step_m", HF_FIELD_DOUBLE, AT(adjust.step_m), HF_ABOVE_ZERO, 1e3, NULL, "m", NULL,
     "moves are multiples of it"},
    {"adjust.max_adjustments", HF_FIELD_INT, AT(adjust.max_adjustments), 1, 1000000, "10", "", NULL,
     "cables that are turned at most"},
    {"adjust.target_m", HF_FIELD_DOUBLE, AT(adjust.target_m), 0, BIG, "0", "m", NULL,
     "no further move is made once the figure is below it"},
    {"adjust.figure", HF_FIELD_WORD, AT(adjust.figure), 0, 0, "psi", "", hf_adjust_figure_word,
     "RMS figure that the adjustments minimise. psi: distance of the inner nodes to the positions of adjust.aim; "
     "surface: distance of the inner nodes to the target surface, along its normal; facets: of the facets to it"},
    {"adjust.aim", HF_FIELD_WORD, AT(adjust.aim), 0, 0, "design", "", hf_aim_word,
     "of the figure psi: design: back to the shape of the design, which has its tensions, too; target_positions: to "
     "the "
     "target positions, also where the design is not there on purpose"},
    {"adjust.sigma_m", HF_FIELD_DOUBLE, AT(adjust.sigma_m), HF_ABOVE_ZERO, BIG, "", "m", NULL,
     "standard deviation of each measured coordinate, of nodes without a sigma_m of their own"},

    {"optimize.method", HF_FIELD_WORD, AT(optimize.method), 0, 0, "ga", "", hf_optimize_method_word,
     "genetic algorithm, Levenberg-Marquardt from the form-finding's tensions, or both. After the genetic algorithm "
     "the "
     "optimum that Levenberg-Marquardt reaches from it is reported (refine); with ga+lm it is the result"},
    {"optimize.refine", HF_FIELD_WORD, AT(optimize.refine), 0, 0, "auto", "", HF_WORDS("auto", "true", "false"),
     "the optimum that Levenberg-Marquardt reaches from the genetic algorithm's design, for comparison. auto: unless "
     "it would cost noticeable time and more than a tenth of the genetic algorithm's"},
    {"optimize.rule", HF_FIELD_WORD, AT(optimize.rule), 0, 0, "force_density", "", hf_rule_word,
     "what a design means: boundary held at q = T'/L* (always one answer), held at T', or Eq. 8 started from q = T'/L* "
     "and stopped by rms_change (the paper's literal reading; its optimum depends on where it stops)"},
    {"optimize.symmetry", HF_FIELD_WORD, AT(optimize.symmetry), 0, 0, "none", "", hf_symmetry_word,
     "boundary cables that are mirror images of each other change by the same step, so a design has fewer variables. "
     "The planes are in the middle of the net's extent along x, along y, or both; auto: those of the two planes about "
     "which the net is symmetric"},
    {"optimize.solver", HF_FIELD_WORD, AT(optimize.solver), 0, 0, "auto", "", hf_solver_word,
     "how an individual is solved: chord shares one factored Newton matrix, eight designs to a pass; newton: each its "
     "own; fixed_point: the paper's iteration. auto: chord where it applies, else newton, else fixed_point"},
    {"optimize.population", HF_FIELD_INT, AT(optimize.population), 2, 100000, "50", "", NULL, "individuals"},
    {"optimize.generations", HF_FIELD_INT, AT(optimize.generations), 1, 1000000, "400", "", NULL,
     "largest number of generations"},
    {"optimize.range_N", HF_FIELD_DOUBLE, AT(optimize.range_N), HF_ABOVE_ZERO, 1e9, "1", "N", NULL,
     "|dT| of Eq. 13: how far a boundary pretension may move from its value after form-finding"},
    {"optimize.min_tension_N", HF_FIELD_DOUBLE, AT(optimize.min_tension_N), HF_ABOVE_ZERO, 1e9, "0.1", "N", NULL,
     "lower bound on every boundary pretension (Eq. 12: above zero)"},
    {"optimize.max_tension_N", HF_FIELD_DOUBLE, AT(optimize.max_tension_N), HF_ABOVE_ZERO, BIG, "1e6", "N", NULL,
     "upper bound on every boundary pretension"},
    {"optimize.boundary_ratio_cap", HF_FIELD_DOUBLE, AT(optimize.boundary_ratio_cap), 1, BIG, "10", "", NULL,
     "an individual with a larger boundary tension ratio is infeasible"},
    {"optimize.seed", HF_FIELD_UINT64, AT(optimize.seed), 0, 18446744073709551615.0, "1", "", NULL,
     "the same seed gives the same run, whatever the number of threads"},
    {"optimize.crossover_high", HF_FIELD_DOUBLE, AT(optimize.crossover_high), 0, 1, "0.9", "", NULL,
     "Pc1 of the adaptive rates (Srinivas & Patnaik 1994)"},
    {"optimize.crossover_low", HF_FIELD_DOUBLE, AT(optimize.crossover_low), 0, 1, "0.6", "", NULL, "Pc2"},
    {"optimize.mutation_high", HF_FIELD_DOUBLE, AT(optimize.mutation_high), 0, 1, "0.1", "", NULL, "Pm1"},
    {"optimize.mutation_low", HF_FIELD_DOUBLE, AT(optimize.mutation_low), 0, 1, "0.001", "", NULL, "Pm2"},
    {"optimize.variation", HF_FIELD_WORD, AT(optimize.variation), 0, 0, "difference", "",
     HF_WORDS("difference", "chain"),
     "difference: crossovers move an elite along the difference of two parents, children replace what is worse; chain: "
     "crossovers mix two parents chain by chain, children replace whole generations"},
    {"optimize.elites", HF_FIELD_INT, AT(optimize.elites), 1, 100000, "1", "", NULL,
     "best individuals that live on unchanged; variation difference moves them in its crossovers"},
    {"optimize.stagnation_tolerance_m", HF_FIELD_DOUBLE, AT(optimize.stagnation_tolerance_m), 0, BIG, "1e-6", "m", NULL,
     "stop when the best psi, or merit, gained less than this over the window below"},
    {"optimize.stagnation_generations", HF_FIELD_INT, AT(optimize.stagnation_generations), 1, 1000000, "50", "", NULL,
     "length of that window"},
    {"optimize.store", HF_FIELD_WORD, AT(optimize.store), 0, 0, "all", "", hf_keep_word,
     "what the result file holds of the generations beside their figures: all of each; the best individual of each; or "
     "whole generations store_every apart. The last one is there in any case"},
    {"optimize.store_every", HF_FIELD_INT, AT(optimize.store_every), 2, 1000000, "100", "", NULL,
     "with store every: generations 0, n, 2n, ... are stored"},
    {"optimize.refine_steps", HF_FIELD_INT, AT(optimize.refine_steps), 1, 100000, "200", "", NULL,
     "maximum number of Levenberg-Marquardt steps"},
    {"optimize.samples", HF_FIELD_INT, AT(optimize.samples), 2, 100000, "64", "", NULL,
     "of objectives over samples: nets with errors that each design is judged by, the same numbers for all; the first "
     "so "
     "many "
     "of those that tolerance.sampling random draws"},
    {"optimize.front_points", HF_FIELD_INT, AT(optimize.front_points), 3, HF_FRONT_POINTS_MAX, "21", "", NULL,
     "of optimize.front that Levenberg-Marquardt finds, its ends included"},

    {"tolerance.sigma_cut_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_m), 0, 1, "0", "m", NULL,
     "standard deviation of each cut length"},
    {"tolerance.sigma_cut_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_cut_ratio), 0, 0.05, "0", "", NULL,
     "another one in parts of the length, as of a measuring tape"},
    {"tolerance.sigma_EA_ratio", HF_FIELD_DOUBLE, AT(tolerance.sigma_EA_ratio), 0, 0.05, "0", "", NULL,
     "of each EA, in parts of it"},
    {"tolerance.sigma_support_m", HF_FIELD_DOUBLE, AT(tolerance.sigma_support_m), 0, 1, "0", "m", NULL,
     "of each coordinate of each support, of attachments before the truss deflects"},
    {"tolerance.sigma_temperature_K", HF_FIELD_DOUBLE, AT(tolerance.sigma_temperature_K), 0, 1000, "0", "K", NULL,
     "of the temperature, the same for all cables; needs cables.expansion_per_K. That of the truss: tolerance.truss"},
    {"tolerance.distribution", HF_FIELD_WORD, AT(tolerance.distribution), 0, 0, "normal", "", hf_distribution_word,
     "of each error, with the same standard deviation: normal, or uniform up to 1.73 of it"},
    {"tolerance.batch", HF_FIELD_DOUBLE, AT(tolerance.batch), 0, 1, "0", "", NULL,
     "correlation of the errors of sigma_cut_ratio, and of those of sigma_EA_ratio, among the cables of one spool: a "
     "set of the net (of several the first by name), or else inner or boundary"},
    {"tolerance.samples", HF_FIELD_INT, AT(tolerance.samples), 10, 100000000, "1000", "", NULL,
     "nets that are solved; with fewer than 10 the intervals of 95 %, those of normal distributions, would be more "
     "than "
     "15 % too narrow"},
    {"tolerance.seed", HF_FIELD_UINT64, AT(tolerance.seed), 0, 18446744073709551615.0, "1", "", NULL,
     "the same seed gives the same samples, whatever the number of threads"},
    {"tolerance.sampling", HF_FIELD_WORD, AT(tolerance.sampling), 0, 0, "random", "", hf_sampling_word,
     "random numbers, or Sobol's sequence in the 40 directions of errors that move the shape most, which converges "
     "faster"},
    {"tolerance.required_yield", HF_FIELD_DOUBLE, AT(tolerance.required_yield), 0, 0.9999, "0", "", NULL,
     "required part of the nets that meet tolerance.require. The run reports by which factor all errors may grow, or "
     "must shrink; 0: it does not"},

#define FIELD(section, member, type, ...) {"truss." #member, type, AT(section.member), __VA_ARGS__},
    HF_TRUSS_KEYS(FIELD, truss)
#undef FIELD
        {"truss.match_tolerance_m", HF_FIELD_DOUBLE, AT(truss.match_tolerance_m), 0, 1e3, "1e-6", "m", NULL,
         "maximum distance between a support of the net and the truss node that carries it"},

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
                     "CSV id,x_m,y_m,z_m,fixed[,mass_kg]; fixed: some of ux uy uz rx ry rz, or all, or empty; path "
                     "relative to the "
                     "case file"},
    {"truss.import.members", HF_FIELD_TEXT, AT(truss_members_path), 1, HF_PATH_SIZE, NULL, "", NULL,
     "CSV "
     "id,i,j,E_Pa,A_m2[,G_Pa,Iy_m4,Iz_m4,J_m4,Asy_m2,Asz_m2,roll_rad,density_kg_per_m3,expansion_per_K,joint,unit]; "
     "joint: rigid or pinned; path relative to the case file"},
};
const int hf_n_field = sizeof hf_field_table / sizeof *hf_field_table;

/* ---- lists of rows ---- */

#define IN(member) offsetof(hf_variable_settings, member)
_Static_assert(IN(range_ratio) == IN(range) + sizeof(double) && IN(upper) == IN(lower) + sizeof(double),
               "a range is an amount, bounds are bounds");
static const hf_field variable_field[] = {
    {"set", HF_FIELD_TEXT, IN(set), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "cables that vary, or those whose supports do: a set of the net, or inner, boundary, all"},
    {"vary", HF_FIELD_WORD, IN(vary), 0, 0, NULL, "", hf_vary_word,
     "what varies of each: tension (N), force_density (N/m) or length (m) at which the cable is held; "
     "unstressed_length "
     "(m) of cables of law elastic; the position of the supports at which the cables end (m from their position in the "
     "net): along z, along the normal of the target surface, or in all three directions"},
    {"range", HF_FIELD_AMOUNT, IN(range), HF_ABOVE_ZERO, BIG, "", "", NULL,
     "how far each may move from its value after form-finding, in the unit of what varies or as a part of that value; "
     "default: as far as the bounds"},
    {"bounds", HF_FIELD_BOUNDS, IN(lower), -BIG, BIG, "", "", NULL,
     "between which each stays, in the unit of what varies; default: none"},
    {"link", HF_FIELD_WORD, IN(link), 0, 0, "each", "", HF_WORDS("each", "set", "symmetry"),
     "which change by the same step: none; all of the row; those at mirrored places (optimize.symmetry)"},
};
#undef IN

#define IN(member) offsetof(hf_objective_settings, member)
static const hf_field objective_field[] = {
    {"figure", HF_FIELD_WORD, IN(figure), 0, 0, NULL, "", hf_figure_kind_word,
     "psi: distance of the inner nodes to their target positions, RMS (m); surface: to the target surface (m); "
     "facets: distance of the facets to it, RMS (m); tension, length: difference to target, RMS over the set (N, m); "
     "evenness: standard deviation of the tensions of the set over their mean; pull: maximum force of the net on a "
     "support (N); deflection: maximum deflection of the truss at an attachment (m); mass: of the cables of the set "
     "(kg); ratio: maximum over minimum tension of the set; gain: root of the part of the gain that the shape loses in "
     "the direction of the beam, by physical optics (surface.pattern)"},
    {"set", HF_FIELD_TEXT, IN(set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "cables of tension, length, evenness, mass, ratio; default: all"},
    {"target", HF_FIELD_DOUBLE, IN(target), -BIG, BIG, "", "", NULL,
     "of tension (N), which needs it, and of length (m), where the lengths at the target positions are the default"},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(mass_kg_per_m), HF_ABOVE_ZERO, BIG, "", "kg/m", NULL,
     "of the cables, which mass needs"},
    {"along", HF_FIELD_WORD, IN(along), 0, 0, "normal", "", HF_WORDS("normal", "half_path"),
     "of surface and facets: distance along the normal, or half the change of the path of a ray"},
    {"fit", HF_FIELD_WORD, IN(fit), 0, 0, "none", "", HF_WORDS("none", "best"),
     "of surface and facets: distance to the target surface, or to its best fit to the shape"},
    {"frequency_Hz", HF_FIELD_DOUBLE, IN(frequency_Hz), HF_ABOVE_ZERO, 1e15, "", "Hz", NULL,
     "of gain; default: the highest of surface.frequencies_Hz"},
    {"load_case", HF_FIELD_TEXT, IN(load_case), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "of `load_cases`: the figure is that of the net that is cut for the design, in this load case; all: in all of "
     "them"},
    {"over", HF_FIELD_WORD, IN(over), 0, 0, "design", "", hf_over_word,
     "of what the figure is: the design itself; samples of the errors of `tolerance`"},
    {"take", HF_FIELD_WORD, IN(take), 0, 0, "mean", "", hf_take_word,
     "over all load cases or samples: the root of the mean of squares, or the largest"},
    {"quantile", HF_FIELD_DOUBLE, IN(quantile), HF_ABOVE_ZERO, 1, "", "", NULL,
     "over samples, instead of take: so large a part of them has no larger value; method ga alone"},
    {"weight", HF_FIELD_DOUBLE, IN(weight), HF_ABOVE_ZERO, BIG, "1", "", NULL,
     "of this objective in the merit of a design, the root of the sum of (weight * value)^2"},
};
#undef IN

#define IN(member) offsetof(hf_limit_settings, member)
_Static_assert(IN(upper) == IN(lower) + sizeof(double), "bounds are bounds");
static const hf_field limit_field[] = {
    {"figure", HF_FIELD_WORD, IN(figure), 0, 0, NULL, "", hf_limit_word,
     "tension of each cable of the set (N); ratio: its largest over its smallest tension; deflection of each "
     "attachment by the truss (m)"},
    {"set", HF_FIELD_TEXT, IN(set), 1, HF_SET_NAME_SIZE, "", "", NULL, "cables of tension, ratio; default: all"},
    {"bounds", HF_FIELD_BOUNDS, IN(lower), -BIG, BIG, NULL, "", NULL, "between which it stays"},
};
#undef IN

#define IN(member) offsetof(hf_cable_settings, member)
static const hf_field cable_field[] = {
    {"set", HF_FIELD_TEXT, IN(set), 1, HF_SET_NAME_SIZE, "all", "", NULL,
     "of cables: a set of the net, or inner, boundary, all"},
    {"expansion_per_K", HF_FIELD_DOUBLE, IN(expansion_per_K), -1, 1, "", "1/K", NULL,
     "thermal expansion of the cables; 0: they keep their lengths"},
    {"mass_kg_per_m", HF_FIELD_DOUBLE, IN(mass_kg_per_m), 0, 1e6, "", "kg/m", NULL,
     "mass of the cables, per metre of unstressed length"},
};
#undef IN

#define IN(member) offsetof(hf_node_settings, member)
static const hf_field node_field[] = {
    {"role", HF_FIELD_WORD, IN(role), 0, 0, "all", "", hf_nodes_word, "nodes: those of a role, or all"},
    {"mass_kg", HF_FIELD_DOUBLE, IN(mass_kg), 0, 1e6, NULL, "kg", NULL, "mass of each"},
};
#undef IN

#define IN(member) offsetof(hf_load_case_settings, member)
static const hf_field load_case_field[] = {
    {"name", HF_FIELD_TEXT, IN(name), 1, HF_SET_NAME_SIZE, NULL, "", NULL,
     "of the load case: letters, digits, _ and -; rows with the same name are one load case"},
    {"set", HF_FIELD_TEXT, IN(set), 1, HF_SET_NAME_SIZE, "", "", NULL,
     "cables that have the temperature: a set of the net, or inner, boundary, all"},
    {"part", HF_FIELD_WORD, IN(part), 0, 0, "all", "", hf_part_word,
     "what has the temperature: net and truss; all cables; the truss; or the members of a unit of the truss"},
    {"temperature_K", HF_FIELD_DOUBLE, IN(temperature_K), -1e4, 1e4, "", "K", NULL,
     "difference to the temperature at which the cables were cut and the truss was made; of what several rows of a "
     "load case name the last one holds"},
    {"gradient_K_per_m", HF_FIELD_VECTOR, IN(gradient_K_per_m), -1e4, 1e4, "", "K/m", NULL,
     "added to temperature_K in proportion to the place, 0 at the origin"},
    {"gravity_m_per_s2", HF_FIELD_DOUBLE, IN(gravity_m_per_s2), HF_ABOVE_ZERO, 1e6, "", "m/s2", NULL,
     "weight of cables, nodes and truss"},
    {"direction", HF_FIELD_VECTOR, IN(direction), -1e9, 1e9, "", "", NULL,
     "in which gravity pulls, of any length; default: [0, 0, -1]"},
    {"force_N", HF_FIELD_VECTOR, IN(force_N), -1e12, 1e12, "", "N", NULL, "on each node of the role"},
    {"role", HF_FIELD_WORD, IN(role), 0, 0, "all", "", hf_nodes_word, "nodes on which force_N acts"},
    {"support_displacement_m", HF_FIELD_VECTOR, IN(support_displacement_m), -1e6, 1e6, "", "m", NULL,
     "of all supports from where the design has them, on a truss from where the truss holds them"},
    {"nodes", HF_FIELD_TEXT, IN(nodes_path), 1, HF_PATH_SIZE, "", "", NULL,
     "CSV id[,Fx_N,Fy_N,Fz_N][,dx_m,dy_m,dz_m]: forces on nodes, moves of supports; path relative to the case file"},
};
#undef IN

#define IN(member) offsetof(hf_require_settings, member)
static const hf_field require_field[] = {
    {"measure", HF_FIELD_WORD, IN(measure), 0, 0, NULL, "", hf_tolerance_measure_word,
     "figure of each as-built net; those of the surface need a section surface, of facets a net that has "
     "some, losses by Ruze's formula (..gain_loss_dB) surface.frequencies_Hz, pattern_loss_dB surface.pattern; fit_ is "
     "after the best fit, as a reflector that is pointed and focused again has it"},
    {"at_most", HF_FIELD_DOUBLE, IN(at_most), -BIG, BIG, "", "", NULL, "maximum value that is allowed"},
    {"at_least", HF_FIELD_DOUBLE, IN(at_least), -BIG, BIG, "", "", NULL, "minimum value that is allowed"},
};
#undef IN

#define IN(member) offsetof(hf_truss_heat_settings, member)
static const hf_field truss_heat_field[] = {
    {"part", HF_FIELD_WORD, IN(part), 0, 0, NULL, "", hf_part_word + HF_PART_TRUSS,
     "members that share this temperature: of the whole truss, or of a unit of it"},
    {"sigma_temperature_K", HF_FIELD_DOUBLE, IN(sigma_temperature_K), HF_ABOVE_ZERO, 1000, NULL, "K", NULL,
     "standard deviation of it; needs truss.expansion_per_K"},
};
#undef IN

#define N_KEY(keys) (int)(sizeof keys / sizeof *keys)
#define LIST(name, count, row, max_row, keys, n_key, help)                                                             \
    {                                                                                                                  \
        name, AT(count), AT(row), sizeof(((hf_case *)0)->row[0]), max_row, keys, n_key, help                           \
    }
const hf_list hf_list_table[] = {
    LIST("optimize.variables", optimize.n_variable_row, optimize.variable_row, HF_DESIGN_ROWS_MAX, variable_field,
         N_KEY(variable_field),
         "What a design varies; without rows the pretensions of the boundary, within range_N by rule"),
    LIST("optimize.objective", optimize.n_term, optimize.term, HF_DESIGN_ROWS_MAX, objective_field,
         N_KEY(objective_field), "What a design should reach; without rows psi"),
    /* A row of optimize.front has the keys of a row of optimize.objective without the last one, weight. */
    LIST("optimize.front", optimize.n_front, optimize.front, HF_FRONT_OBJECTIVES_MAX, objective_field,
         N_KEY(objective_field) - 1,
         "Two or three objectives to be weighed against each other: instead of one design the run finds their front, "
         "the designs than which none is better in all of them"),
    LIST("optimize.limits", optimize.n_limit, optimize.limit, HF_DESIGN_ROWS_MAX, limit_field, N_KEY(limit_field),
         "What a design must keep; without rows nothing"),
    LIST("cables", built.n_cable, built.cable, HF_MATERIAL_ROWS_MAX, cable_field, N_KEY(cable_field),
         "Material of the cables of the as-built net; a later row replaces the values of an earlier one"),
    LIST("nodes", built.n_node, built.node, HF_MATERIAL_ROWS_MAX, node_field, N_KEY(node_field),
         "Mass of the joints of the as-built net; a later row replaces an earlier one"),
    LIST("load_cases", built.n_load_case, built.load_case, HF_LOAD_CASE_ROWS_MAX, load_case_field,
         N_KEY(load_case_field),
         "Load cases of the as-built net, of up to 16 names: temperatures, gravity, forces, displacements of "
         "supports; without rows none is computed"),
    LIST("tolerance.require", tolerance.n_require, tolerance.require, HF_REQUIRE_ROWS_MAX, require_field,
         N_KEY(require_field), "Requirements of an as-built net; without rows there are none, and there is no yield"),
    LIST("tolerance.truss", tolerance.n_truss, tolerance.truss, HF_TRUSS_HEAT_ROWS_MAX, truss_heat_field,
         N_KEY(truss_heat_field),
         "Temperatures of the truss that vary on their own; those of rows that name the same members add up. Without "
         "rows the truss keeps its shape"),
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

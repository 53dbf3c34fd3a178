/* Defines the entries of `hifdm explain`, from the lists of figures and statuses and from a table of its own. Contents:
 * entries from the lists, other entries (terms, what to do, stop reasons, objects and figures of --json), all entries
 * together. */
#include "out/words.h"

#include <hifdm/front.h>
#include <hifdm/summary.h>

#include <ctype.h>
#include <string.h>

/* ---- entries from the lists of figures and statuses ---- */

#define SHAPE "figure of form, optimize, polish, cases"
#define RESULT(type, member, kind, json, individual, key, units, description) {key, SHAPE, units, description, NULL},
#define COUPLING(type, member, kind, json, individual, key, units, description)                                        \
    {key, "figure of coupling", units, description, NULL},
#define FORM(type, member, kind, json, key, description)                                                               \
    {json ? key : #member, "figure of form", "", description, NULL},
#define GA(type, member, kind, json, key, description)                                                                 \
    {json ? key : #member, "figure of optimize", "", description, NULL},
#define REFINE(type, member, kind, json, key, description) {key, "figure of polish", "", description, NULL},
#define LOAD_CASE(type, member, kind, json, key, description) {key, "figure of cases", "", description, NULL},
#define TRUSS(type, member, kind, json, key, description) {key, "figure of truss", "", description, NULL},
#define TOLERANCE(type, member, kind, json, key, description) {key, "figure of tolerance", "", description, NULL},
#define SURFACE(type, member, kind, json, description) {#member, "figure of surface", "", description, NULL},
#define FIT(type, member, kind, json, description)                                                                     \
    {"fit_" #member, "figure of surface, best fit", "", description, NULL},
#define LOSS(member, description) {#member, "figure of surface", "dB", description, NULL},
#define STATUS(name, value, code, word, text) {word, "status; exit status " #code, "", text, NULL},
#define PROOF(name, value, word, meaning) {word, "bound_reason", "", meaning, NULL},

static const hf_word listed[] = {
    HF_STATUS_LIST(STATUS) HF_BOUND_REASON_LIST(PROOF) HF_RESULT_LIST(RESULT) HF_COUPLING_LIST(COUPLING)
        HF_SUMMARY_FORM_LIST(FORM) HF_SUMMARY_SEARCH_LIST(GA) HF_SUMMARY_REFINE_LIST(REFINE)
            HF_LOAD_CASE_LIST(LOAD_CASE) HF_SUMMARY_TRUSS_LIST(TRUSS) HF_TOLERANCE_LIST(TOLERANCE)
                HF_SURFACE_LIST(SURFACE) HF_SURFACE_FIT_LIST(FIT) HF_SURFACE_LOSS_LIST(LOSS)};
enum { N_LISTED = sizeof listed / sizeof *listed };

/* ---- other entries ---- */

static const hf_word told[] = {
    /* ---- term ---- */
    {"psi", "term", "",
     "How far a net is from where it should be: the root mean square, over the inner nodes, of the distance to the "
     "theoretical position (Eqs. 9, 10 of Chen et al.). Moves within the surface count, too. In JSON: psi_m.",
     NULL},
    {"law", "term", "",
     "What a cable keeps: its tension, its length, its force density, or that of an elastic piece of cable with an "
     "unstressed length.",
     NULL},
    {"chain", "term", "",
     "Cables in a row between two supports whose inner ends have no other cable that could balance a force across: a "
     "straight chain of cables that keep their lengths cannot carry a lateral load with any finite tension.",
     NULL},
    {"gene", "term", "",
     "A variable of the optimisation: without optimize.variables the pretension of a boundary cable with a free end.",
     NULL},
    {"set", "term", "",
     "A named group of cables: generated nets name the families of their cables (front, tie, edge, ...), imported ones "
     "have a column `set`.",
     NULL},
    {"stage", "term", "",
     "One of the steps of a run that has a shape: form (form-finding), optimize (the best of the genetic algorithm), "
     "polish (Levenberg-Marquardt).",
     NULL},
    {"form-finding", "term", "",
     "The first row of the summary: the shape in which all forces balance and every cable obeys its law.", NULL},
    {"GA", "term", "",
     "The genetic algorithm: generations of designs, the better ones of which breed the next; needs no derivatives. In "
     "JSON: optimize.",
     NULL},
    {"LM", "term", "",
     "Levenberg-Marquardt: least squares by exact derivatives from the best design there is; for comparison behind the "
     "GA, or the result by optimize.method lm and ga+lm. In JSON: polish.",
     NULL},
    {"good to", "term", "",
     "The frequency at which the errors cost 1 dB of gain by Ruze's formula: of the facets where a section surface "
     "measures them, else of the nodes, else of psi, which is no less than the nodes' error. The second number is "
     "after the best fit: the feed follows. That one stands first where all rows of tolerance.require and all goals "
     "that "
     "are about the surface are after the best fit.",
     NULL},
    {"half path", "term", "",
     "Half of how much longer or shorter the way from a plane wave to the focus is: the error along the normal times "
     "the cosine of the angle there. What Ruze's formula takes.",
     NULL},
    {"best fit", "term", "",
     "The surface of the wanted kind, moved, turned and with another focal length, that is nearest to the shape: the "
     "errors that are left when the feed follows.",
     NULL},
    {"facet", "term", "",
     "A flat triangle or a bilinear quadrilateral of mesh between cables; it is off a curved surface even where its "
     "nodes are on it. Smaller ones are nearer.",
     NULL},
    {"force density", "term", "",
     "Tension over length, N/m. With force densities given, balance is linear in the positions.", NULL},
    {"individual", "term", "", "A design of the genetic algorithm: a whole form-finding of its own.", NULL},
    {"generation", "term", "", "The individuals that are bred together, and compared.", NULL},
    {"inner", "term", "", "The group of cables inside; of nodes: those that psi counts.", NULL},
    {"boundary", "term", "", "The group of cables whose tensions the optimisation sets, mostly those along the edges.",
     NULL},
    {"attachment", "term", "", "A support of the net that is a node of its truss: it gives way as the truss does.",
     NULL},
    {"pillow", "term", "",
     "A facet between bent cables: its mesh is bent by its own tension (surface.mesh_tension_N_per_m).", NULL},
    {"as built", "term", "",
     "The net cut from elastic cable to unstressed lengths: with errors (tolerance), in another state (cases), "
     "measured and adjusted (hifdm adjust).",
     NULL},
    {"certificate", "term", "",
     "What says how good a shape is: residual, backward error, condition, and a proven bound of how far it is from "
     "equilibrium.",
     NULL},
    {"pretension", "term", "",
     "The tension that cables are to have without loads: form.pretension_N for cables of law tension without a value.",
     NULL},
    {"boundary ratio", "term", "", "Column of the summary: boundary_tension_ratio.", NULL},
    {"ratio inside", "term", "", "Column of the summary: inner_tension_ratio.", NULL},
    {"at bounds", "term", "",
     "Column of the summary: how many variables are at an end of their ranges. A few: a wider range (range of a row of "
     "optimize.variables, else optimize.range_N) may give a better design. Many, with nodes that no goal counts "
     "(facets "
     "and all cables, say): a wider range lets these move still farther for next to nothing; vary fewer sets, or count "
     "them. Force densities at 0 are cables that the design does without: leave them out, or give them a bound above "
     "0. Limits (optimize.limits) have lines of their own.",
     NULL},
    {"proven to", "term", "",
     "Column of the summary: position_bound_m, or \"no:\" and the bound_reason. Without a proof the figures are as "
     "good as residual_N says.",
     NULL},
    {"slack cable", "term", "",
     "A cable without tension: below 1e-3 of the reference tension. It does not shape the net; ratios with it are "
     "infinite.",
     NULL},
    {"loose node", "term", "",
     "A free node without load all of whose cables are slack: its place is anywhere its cables let it be, and psi "
     "leaves it out.",
     NULL},
    {"slack", "term", "", "Without tension; see slack cable. The figure slack_cables counts them.", NULL},
    {"tension", "term", "N",
     "The force by which a cable pulls at its two nodes: force density times length. As a law of a cable: it keeps "
     "this "
     "force whatever its length.",
     NULL},
    {"EA", "term", "N",
     "Stiffness of a cable, modulus of elasticity times cross-section: the force that would stretch it to twice its "
     "length. Columns EA_N of tables, keys EA_inner_N and EA_boundary_N of generated nets; cut lengths need it.",
     NULL},
    {"prestress", "term", "",
     "Tensions that balance each other without any load. form.prestress exact looks for those that hold every node at "
     "its theoretical place.",
     NULL},
    {"rule", "term", "",
     "optimize.rule: what a design of tensions means. force_density holds T'/L* in the boundary cables, L* their "
     "theoretical length; tension holds T' itself; seeded is the paper's iteration, begun there.",
     NULL},
    {"base design", "term", "",
     "The design that an optimisation starts from: the tensions that the form-finding found, under optimize.rule. See "
     "base_psi_m.",
     NULL},
    {"edge", "term", "",
     "Of cables the set along a border of the net; of nodes the role of free ones that psi does not count.", NULL},
    {"support", "term", "", "A node that does not move; on a truss it is an attachment, and moves with it.", NULL},
    {"tie", "term", "",
     "A cable between the two nets of a double net. An edge tie holds a node of the rim to a support outside of the "
     "net.",
     NULL},
    {"Ruze", "term", "",
     "Ruze's formula: errors of RMS half path e cost a gain factor of exp(-(4 pi e / wavelength)^2). See good to.",
     NULL},
    {"Levenberg-Marquardt", "term", "", "Least squares by derivatives, a damped Gauss-Newton method; see LM.", NULL},
    {"chi_square", "term", "",
     "Of `hifdm adjust`: squares of errors over their sigmas, by coordinate. About 1 when the sigmas are right; much "
     "above it the measured places do not fit the net.",
     NULL},
    {"chi^2", "term", "", "See chi_square, its name in JSON.", NULL},
    /* ---- what to do ---- */
    {"ok", "what to do", "", "Nothing: it is done, or the design is feasible.", NULL},
    {"not_converged", "what to do", "",
     "Raise form.max_iterations, or let Newton find it (form.method=newton). The message names the cable that is "
     "furthest from its law; a length that its neighbours cannot take keeps the iteration from its end.",
     NULL},
    {"singular", "what to do", "",
     "Some node is held by nothing, or only along a line: the message names it. Give it another cable or a support; of "
     "a net with struts, change their force densities.",
     NULL},
    {"straight_chain", "what to do", "",
     "Let the chain sag (a scallop, a shorter or longer length), give one of its cables law tension, or tie its nodes.",
     NULL},
    {"collapsed", "what to do", "",
     "Force densities or tensions differ too much, or a part of the net has nothing that keeps it open. Look at the "
     "cable that the message names: its length, its law, the supports behind it.",
     NULL},
    {"not_finite", "what to do", "",
     "Numbers have run away, most often from lengths that cannot be. Look at the cable that the message names.", NULL},
    {"ratio_cap", "what to do", "",
     "As it counts for designs: they are infeasible. Raise optimize.boundary_ratio_cap if such tensions can be had, or "
     "narrow the ranges.",
     NULL},
    {"no_feasible", "what to do", "",
     "The message says which limit most designs break, or what status they have. Wider ranges, looser limits or a "
     "better start help.",
     NULL},
    {"truss_too_soft", "what to do", "", "Stiffer tubes (E_Pa, diameter, wall), more bracing, less pretension.", NULL},
    {"mechanism", "what to do", "",
     "The message names the node that moves without a force: brace it, or hold more of the truss (truss.ring.held, "
     "supports).",
     NULL},
    {"out_of_limits", "what to do", "",
     "As it counts for designs: they are infeasible. The summary names the limits that hold the best one.", NULL},
    {"points_failed", "what to do", "",
     "`hifdm status STUDY` says which and why; `hifdm sweep STUDY --retry failed` runs those again.", NULL},
    {"exists", "what to do", "", "Another name, or --force (of run: --restart), if it may be replaced.", NULL},
    {"no_lapack", "what to do", "", "Install LAPACK, of Debian the package liblapack3 or libopenblas0.",
     "LAPACK cannot be loaded"},
    {"interrupted", "what to do", "", "The same command goes on where it was.", NULL},
    {"io", "what to do", "", "The message names the file and the reason of the system; what was stored stays.", NULL},
    /* ---- stop_reason ---- */
    {"direct", "stop_reason", "", "No law changes a force density: one linear solve is the answer.", NULL},
    {"residual", "stop_reason", "",
     "Equilibrium, lengths and tensions are within the tolerances (form.residual_tolerance and its kin).", NULL},
    {"rms_change", "stop_reason", "",
     "The rule of the paper: psi changes by less than form.rms_tolerance_m from one iteration to the next. It ends "
     "before equilibrium.",
     NULL},
    {"max_iterations", "stop_reason", "", "The limit of iterations came first: not converged.", NULL},
    {"ill_posed", "stop_reason", "", "There is no answer; the status says why.", NULL},
    {"tof", "stop_reason", "", "Of net and truss: no attachment moves farther than coupling.tof_m any more.", NULL},
    {"diverged", "stop_reason", "", "Of net and truss: the steps grow, the truss is too soft.", NULL},
    {"net", "stop_reason", "", "Of net and truss: the net has no shape on the truss as it is bent; see the status.",
     NULL},
    {"generations", "stop_reason", "", "The genetic algorithm has done optimize.generations.", NULL},
    {"stagnation", "stop_reason", "", "The genetic algorithm has gained nothing for optimize.stagnation_generations.",
     NULL},
    {"all_infeasible", "stop_reason", "", "The genetic algorithm ends without a feasible design.", NULL},
    {"running", "stop_reason", "", "The genetic algorithm goes on when the same command is given again.", NULL},
    {"converged", "stop_reason", "", "Levenberg-Marquardt: no step promises more.", NULL},
    {"stalled", "stop_reason", "",
     "Levenberg-Marquardt: shorter steps gain nothing, though the derivatives promise it; the design is a good one, "
     "but not shown to be an optimum.",
     NULL},
    {"settled", "stop_reason", "",
     "Levenberg-Marquardt: its last ten steps lowered the merit by less than a millionth and changed no goal (weight x "
     "value) by more than 1e-5 of the merit. The design is a good one; steps still promise a little. That is how runs "
     "end whose goals leave much open: vary fewer sets of cables, or count what may not move.",
     NULL},
    {"taken", "stop_reason", "", "Nothing was searched: the design is a point of a front (`hifdm run --point`).", NULL},
    /* ---- object of --json ---- */
    {"form", "object of --json", "", "The found shape: figures of the form-finding.", NULL},
    {"optimize", "object of --json", "", "The best design of the genetic algorithm.", NULL},
    {"polish", "object of --json", "", "The optimum of Levenberg-Marquardt, or the point of a front that was taken.",
     NULL},
    {"truss", "object of --json", "", "The structure that carries the net.", NULL},
    {"coupling", "object of --json", "", "How net and truss came to balance.", NULL},
    {"surface", "object of --json", "", "Errors of a shape as a reflector.", NULL},
    {"sets", "object of --json", "", "Tensions of each named set of cables.", NULL},
    {"goals", "object of --json", "", "Value and weight of each row of optimize.objective or optimize.front.", NULL},
    {"front", "object of --json", "",
     "Designs of which none is better than another in all objectives; a single one where they do not conflict. `hifdm "
     "run "
     "CASE --point FILE:N` makes point N a result.",
     NULL},
    {"cases", "object of --json", "", "States of the net as built: cold, in the sun, on the ground.", NULL},
    {"tolerance", "object of --json", "", "Samples of nets as built with errors of cut, stiffness and supports.", NULL},
    {"require", "object of --json", "", "Rows of tolerance.require, each with the part of samples that meets it.",
     NULL},
    {"kind_share", "object of --json", "", "Part of the variance of psi by kind of error.", NULL},
    {"cable_share", "object of --json", "", "Cables with the largest parts of the variance of psi: cut these well.",
     NULL},
    {"at_limits", "object of --json", "", "Limits that the design is at: what to loosen for a better one.", NULL},
    {"points", "object of --json", "", "Points of the front, ascending by the first objective.", NULL},
    /* ---- figure ---- */
    {"status", "figure", "", "How a run, a shape or a design ended; `hifdm explain` lists the words.", NULL},
    {"stop_reason", "figure", "",
     "Why an iteration, the genetic algorithm or Levenberg-Marquardt ended; `hifdm explain` lists the words.", NULL},
    {"psi_m", "figure", "m", "How far the net is from where it should be; see psi. Of a status other than ok null.",
     NULL},
    {"base_psi_m", "figure", "m",
     "psi of the base design, which gains of the optimisation are measured against. Where boundary cables keep lengths "
     "in the form-finding and force densities T'/L* in designs, the same tensions give another shape, so that it may "
     "differ from the psi of the form-finding.",
     NULL},
    {"residual_N", "figure", "N",
     "What is out of balance at the worst node with every cable at the tension of its law. Against the pretension it "
     "says how near to equilibrium the shape is: 1e-6 of it is plenty.",
     NULL},
    {"inner_tension_ratio", "figure", "",
     "Largest over smallest tension of the inner cables: 1 is even. Infinity: one is slack.", NULL},
    {"boundary_tension_ratio", "figure", "",
     "Largest over smallest tension of the boundary cables. optimize.boundary_ratio_cap keeps it below a limit.", NULL},
    {"condition", "figure", "",
     "How much the net amplifies small forces and rounding, relatively: 1e10 leaves some six digits. A net that is "
     "nearly a mechanism has a large one.",
     NULL},
    {"backward_error", "figure", "",
     "What is out of balance beside the tensions at the node: rounding alone leaves 1e-16 to 1e-14.", NULL},
    {"position_error_m", "figure", "m",
     "Estimated distance of the worst node from equilibrium; the proven one is position_bound_m.", NULL},
    {"position_bound_m", "figure", "m",
     "Proven, rounding included: no equilibrium of the net has a node farther from its place here. Null without a "
     "proof; bound_reason says why.",
     NULL},
    {"merit", "figure", "",
     "What the optimisation lowers: the root of the sum of (weight x goal)^2; without goals psi.", NULL},
    {"violation", "figure", "", "How far a design is beyond its limits, summed over cables; 0: feasible.", NULL},
    {"wall_s", "figure", "s", "Time by the clock on the wall; cpu_s is what the processors worked.", NULL},
    {"cpu_s", "figure", "s", "Processor time of breeding, evaluating and storing, over all threads.", NULL},
    {"evaluations", "figure", "", "Designs that were evaluated, each a form-finding.", NULL},
    {"iterations", "figure", "", "Linear solves of a form-finding; steps of the coupling, or of a point of the front.",
     NULL},
    {"seed", "figure", "", "Of the genetic algorithm: the same seed gives the same result, to the bit.", NULL},
    {"threads", "figure", "", "Threads that were used; results do not depend on it.", NULL},
    {"version", "figure", "", "Of the program that made the result.", NULL},
    {"case", "figure", "", "The case file.", NULL},
    {"file", "figure", "", "The result file.", NULL},
    {"pattern", "object", "", "The far field of the shape by surface.pattern: an object for each frequency and cut.",
     NULL},
    {"phi_deg", "figure of pattern", "deg", "Where the cut is, from +x towards +y.", NULL},
    {"gain_dBi", "figure of pattern", "dBi",
     "Highest gain of the cut over isotropic radiation of the power of the feed: taper, spillover and errors of the "
     "surface are in it, losses of mesh and feed are not.",
     NULL},
    {"beam_deg", "figure of pattern", "deg", "Theta of it, from +z; below 0 on the other side of +z.", NULL},
    {"half_power_width_deg", "figure of pattern", "deg",
     "Width of the beam at half of its power; null where the angles do not reach it, as the next two.", NULL},
    {"first_sidelobe_dB", "figure of pattern", "dB", "The higher one of the two beside the beam, below the beam.",
     NULL},
    {"highest_sidelobe_dB", "figure of pattern", "dB", "The highest of the cut, below the beam.", NULL},
    {"warnings", "figure", "", "What the run warned of; `hifdm explain` takes such a text, too.", NULL},
    {"kind", "figure", "", "Of the surface: parabolic_cylinder or paraboloid.", NULL},
    {"frequency_Hz", "figure", "Hz", "Where the losses of gain are told: surface.frequencies_Hz.", NULL},
    {"least_N", "figure", "N", "Least tension of the set.", NULL},
    {"largest_N", "figure", "N", "Largest tension of the set.", NULL},
    {"tension_ratio", "figure", "", "Largest over least tension of the set; Infinity: a cable of it is slack.", NULL},
    {"value", "figure", "", "Of a goal, in its own unit; of a limit, what the named cable has.", NULL},
    {"weight", "figure", "", "Of a goal in the merit.", NULL},
    {"row", "figure", "", "Of a limit: its row of optimize.limits from 0, or -1: boundary_ratio_cap.", NULL},
    {"name", "figure", "", "Of one cable, or attachment, that is at the limit.", NULL},
    {"bound", "figure", "", "The limit that it is at.", NULL},
    {"count", "figure", "", "How many cables or attachments of the row are at this bound.", NULL},
    {"n_point", "figure", "", "Points of the front.", NULL},
    {"n_listed", "figure", "", "Points of the front that are listed here; the table of `hifdm export --front` has all.",
     NULL},
    {"n_dominated", "figure", "", "Points of the front that another one beats in all objectives.", NULL},
    {"n_failed", "figure", "", "Points of the front without a feasible design.", NULL},
    {"n_not_converged", "figure", "",
     "Points of the front whose design is not known to be an optimum: raise optimize.refine_steps.", NULL},
    {"minimised", "figure", "", "The objective whose least is sought under limits on the others.", NULL},
    {"knee", "figure", "",
     "The point of the front farthest below the line, or plane, of its ends: where a trade turns bad on all sides.",
     NULL},
    {"base", "figure", "", "The objectives of the shape after form-finding.", NULL},
    {"id", "figure", "",
     "Of a point: its row in the table of `hifdm export --front`, and its number for `hifdm run --point`.", NULL},
    {"front_file", "figure of polish", "", "The result whose front has the point that was taken.", NULL},
    {"front_point", "figure of polish", "", "The number of this point in the front.", NULL},
    {"objective", "figure", "", "Values of the objectives at this point.", NULL},
    {"multiplier", "figure", "",
     "Slope of the front: by how much the minimised objective falls for one unit more of this one.", NULL},
    {"mark", "figure", "", "Of a point: on the front, dominated, or failed.", NULL},
    {"mean", "figure", "", "Over all samples that have the figure.", NULL},
    {"mean_low", "figure", "", "Lower end of the 95 % interval of the mean.", NULL},
    {"mean_high", "figure", "", "Upper end of the 95 % interval of the mean.", NULL},
    {"deviation", "figure", "", "Standard deviation over the samples.", NULL},
    {"least", "figure", "", "Smallest of the samples.", NULL},
    {"largest", "figure", "", "Largest of the samples.", NULL},
    {"quantiles", "figure", "", "The parts of nets that the quantiles are of: 50, 95, 99 %.", NULL},
    {"quantile", "figure", "", "What these parts of the nets keep: at most, or of tensions at least.", NULL},
    {"quantile_low", "figure", "", "Lower ends of the 95 % intervals of the quantiles.", NULL},
    {"quantile_high", "figure", "", "Upper ends of the 95 % intervals of the quantiles.", NULL},
    {"measure", "figure", "", "What the row of tolerance.require is about.", NULL},
    {"at_most", "figure", "", "Limit of the row.", NULL},
    {"at_least", "figure", "", "Limit of the row.", NULL},
    {"histogram", "figure", "", "Samples of psi by bins of equal width over histogram_range_m.", NULL},
    {"histogram_range_m", "figure", "m", "Ends of the histogram of psi.", NULL},
    {"cable", "figure", "", "Id of the cable.", NULL},
    {"share", "figure", "", "Part of the variance of psi that errors of this cable make, to first order.", NULL},
    {"least_tension_N", "figure", "N", "Least tension of all cables, of a state or of a sample.", NULL},
    {"tension_min_N", "figure", "N", "Minimum tension of the cables of a sample.", NULL},
    {"n_slack", "figure", "", "Slack cables of a sample.", NULL},
    {"n_loose", "figure", "", "Loose nodes of a sample.", NULL},
    {"fit_gain_loss_dB", "figure", "dB", "Loss of gain (Ruze) after the best fit; null beyond 3 dB.", NULL},
    {"pattern_loss_dB", "figure", "dB",
     "What a net as built loses of its gain in the direction of the beam, at the highest frequency, by physical optics "
     "over its facets, below the same current in phase. Asked for by surface.pattern beside tolerance.",
     NULL},
    {"n_node", "figure", "", "Nodes of the net.", NULL},
    {"n_cable", "figure", "", "Cables of the net.", NULL},
    {"fit_converged", "figure", "", "Whether the best fit has ended; false: it has no figures.", NULL},
};
enum { N_TOLD = sizeof told / sizeof *told };

/* ---- all entries together ---- */

int hf_word_count(void)
{
    return N_LISTED + N_TOLD + hf_n_words_warning + hf_n_words_case + hf_n_words_adjust;
}

hf_word hf_word_at(int i)
{
    if (i < N_LISTED) return listed[i];
    if ((i -= N_LISTED) < N_TOLD) return told[i];
    if ((i -= N_TOLD) < hf_n_words_warning) return hf_words_warning[i];
    return (i -= hf_n_words_warning) < hf_n_words_case ? hf_words_case[i] : hf_words_adjust[i - hf_n_words_case];
}

bool hf_word_is(int i, const char *word)
{
    const hf_word entry = hf_word_at(i);
    return !strcmp(entry.word, word) || (entry.says && strstr(word, entry.says));
}

int hf_word_letter(char letter)
{
    return letter == '-' || letter == '_' ? ' ' : tolower((unsigned char)letter);
}

/* Returns whether the rest of the name of a figure is a unit, which users leave out. */
static bool is_unit(const char *rest)
{
    static const char *const unit[] = {"_m", "_N", "_dB", "_deg", "_s", "_kg", "_Hz"};
    for (size_t k = 0; k < sizeof unit / sizeof *unit; k++)
        if (!strcmp(rest, unit[k])) return true;
    return false;
}

bool hf_word_is_like(int i, const char *word)
{
    const char *known = hf_word_at(i).word;
    while (*known && hf_word_letter(*known) == hf_word_letter(*word))
        known++, word++;
    return (!*known || is_unit(known)) && (!*word || !strcmp(word, "s"));
}

/* Defines the entries of `hifdm explain` for words of case files, of cut lists, and of trade-offs. */
#include "out/words.h"

#include <stddef.h>

const hf_word hf_words_case[] = {
    {"goal", "term", "",
     "What a design should reach: a row of optimize.objective, a figure of the shape of which less is better (psi, "
     "facets, "
     "tension, evenness, gain, ...). The merit is the root of the sum of (weight x value)^2; without rows psi is the "
     "goal.",
     NULL},
    {"limits", "term", "",
     "What a design must keep: rows of optimize.limits (limit, set, bounds), such as tensions between 1 and 20 N. "
     "Designs outside are infeasible.",
     NULL},
    {"range", "term", "",
     "Of a row of optimize.variables: how far a value may move either way from where form-finding has it, in its unit "
     "(range: 2) or as a part of it (range: 50 %). Without rows optimize.range_N; of turnbuckles adjust.range_m.",
     NULL},
    {"facets", "term", "m",
     "As a goal: RMS distance of the facets to the wanted surface, so the error between the nodes counts. See also "
     "facet.",
     NULL},
    {"evenness", "term", "",
     "A goal: the standard deviation of the tensions of a set over their mean; 0 when all are equal.", NULL},
    {"gain", "term", "dB",
     "Power in the direction of the beam over that of an isotropic antenna, by physical optics (surface.pattern). As a "
     "goal: the root of the part of it that errors of the shape lose; 0.1 is 0.044 dB.",
     NULL},
    {"RMS", "term", "",
     "Root mean square: the root of the mean of the squares. psi is one of distances, over the inner nodes.", NULL},
    {"rings", "term", "",
     "Of scene.paraboloid: rings of triangles around the middle of the net. More of them make smaller facets, a better "
     "surface, and more cables to cut.",
     NULL},
    {"cutlist", "term", "",
     "`hifdm export FILE --cutlist cut.csv`: to which length each cable is cut (l0_m, without tension; cut_mm.csv: for "
     "the bench), where a jig "
     "holds the nodes, and how much cable each group and set needs. It can be imported as a net.",
     NULL},
    {"cut list", "term", "", "See cutlist.", NULL},
    {"study", "term", "",
     "A file for `hifdm sweep`: a base case and axes over its keys; a point for each combination of their values. "
     "`hifdm check` says what it would do, `hifdm merge` makes one file of it, `hifdm show` and `report` show that.",
     NULL},
    {"sweep", "term", "",
     "`hifdm sweep study.yaml` runs the points of a study, on any number of machines, and each of them once. See also "
     "study. In a study: its axes, a key and its values each.",
     NULL},
    {"point", "term", "", "Of a study: one value of each axis, so one run. Of a front: one design.", NULL},
    {"merge", "term", "", "See study.", NULL},
    {"psi_by_cut", "data set of /tolerance", "m/m",
     "What letting a cable out by a unit of length adds to psi of the net without errors, while no cable goes slack. "
     "On pages: psi by a turn, in mm per mm. `hifdm adjust` makes moves of it.",
     NULL},
    {"by a turn", "term", "", "See psi_by_cut.", NULL},
    {"meets yield", "column of a study", "",
     "Has the point the yield that its tolerance.required_yield wants? yes: the whole 95 % interval of its samples is "
     "above it; "
     "no: "
     "below; open: only more of them (tolerance.samples) can tell.",
     NULL},
    {"meets the yield", "column of a study", "", "See meets yield.", NULL},
    {"axis", "term", "",
     "Of a study: a key of the case and the values that it takes, such as form.pretension_N: [5, 10, 20].", NULL},
    {"best_by", "key of --json, of a merged study", "",
     "The figure by which the point `best` is the best, with the least value: where goals want more than psi their "
     "merit, "
     "or the only goal; else psi of 95 % of the nets as built where it is known, or psi of the result.",
     NULL},
    {"good_to_Hz", "figure of a merged study", "Hz",
     "See good to; of facets where there are some (facet_good_to_Hz), and after the best fit (fit_).", NULL},
    {"l0_m", "column of cut lists", "m",
     "Unstressed length of a cable, length / (1 + T/EA): what it measures on the bench, its turnbuckle in the middle.",
     NULL},
    {"l0_minus_theory_m", "column of cut lists", "m",
     "l0_m minus what it would be in the theoretical shape. No travel of a turnbuckle: a cable that is cut to l0_m "
     "needs "
     "none.",
     NULL},
    {"adjustment_m", "column of cut lists", "m", "See l0_minus_theory_m, its name since version 0.2.", NULL},
    {"turnbuckle", "term", "",
     "What lets a cable out or takes it in when the net hangs. `hifdm adjust` says which to turn, how far and in which "
     "order, from measured places of nodes; adjust.set names the cables that have one.",
     NULL},
    /* ---- of the summary and the report ---- */
    {"drift", "term", "",
     "How far nodes move within the surface: psi counts it, goals of the surface (facets, surface, gain) "
     "do not, and a radio wave hardly sees it. It takes facets and cables to where nobody drew them: "
     "{figure: psi, weight: 0.1} beside the other goals keeps it small.",
     NULL},
    {"within the surface", "term", "", "See drift.", NULL},
    {"gives way", "term", "",
     "The attachments of the net move under its pull, as the truss bends. The design knows of it: psi and "
     "all figures are those on the truss as it is bent. Less pretension or stiffer tubes let it give way "
     "less.",
     NULL},
    {"give way", "term", "", "See gives way.", NULL},
    {"on its truss", "term", "",
     "Line of the summary: how far attachments move under the net, and how net and truss came to balance; "
     "see gives way and rounds.",
     NULL},
    {"rounds", "term", "",
     "Form-findings in turn with the truss until no attachment moves farther than coupling.tof_m.", NULL},
    {"last step", "term", "",
     "How far the attachments still moved in the last round: below coupling.tof_m net and truss balance.", NULL},
    {"linear theory", "term", "",
     "The truss is computed as if it did not turn: displacements in proportion to forces. What that leaves "
     "out is turn times displacement / 2; a warning tells where it counts. Then stiffen the truss, or "
     "lower form.pretension_N.",
     NULL},
    {"loss of gain", "term", "",
     "What errors of the surface cost at a frequency, dB, by Ruze's formula: 3 dB is half of the power. "
     "Above 3 dB the formula does not hold, and no number is told. See good to.",
     NULL},
    {"after best fit", "term", "", "See best fit.", NULL},
    {"the result", "term", "",
     "The stage whose design the files, the report and exports have: the last one that optimize.method "
     "names. \"For comparison\": a stage that only says how good a design could be.",
     NULL},
    {"for comparison", "term", "", "See the result.", NULL},
    {"variable", "term", "",
     "What the optimisation may change: a row of optimize.variables names the cables and the value "
     "(force_density, tension, length, a support), and how far it may go. Without rows the pretensions of "
     "the boundary cables.",
     NULL},
    {"free node", "term", "", "A node that is no support: it moves until its forces balance.", NULL},
    {"inner node", "term", "", "A node that psi counts: of a double layer those of the front net inside of the rim.",
     NULL},
    {"form-finding's tensions", "term", "",
     "The tensions that the first stage found, before any optimisation; see base design.", NULL},
    {"stopped by", "term", "",
     "Why an iteration ended: direct, residual, tof, converged, settled, stalled, max_iterations, "
     "generations, stagnation; each has an entry. All but max_iterations, stalled and diverged are as they "
     "should be.",
     NULL},
    {"not converged", "term", "",
     "The limit of iterations came first: raise optimize.refine_steps (of Levenberg-Marquardt) or "
     "form.max_iterations (of the form-finding), and run with --restart.",
     NULL},
    {"dB", "term", "",
     "Decibel: ten times the decimal logarithm of a ratio of powers. A loss of 1 dB leaves 79 %, 3 dB "
     "half.",
     NULL},
    {"dBi", "term", "", "Gain in dB over an antenna that radiates the same in all directions.", NULL},
    {"dominated", "term", "", "Of a point of a front: another one is better, or as good, in all objectives.", NULL},
    {"slope", "term", "",
     "Of a front: by how much the minimised objective changes for one unit more of the other one. Where people read it "
     "lengths are in mm, in files and --json in m.",
     NULL},
    {"objective", "term", "",
     "One of two or three goals that are weighed against each other: optimize.front asks for their "
     "front.",
     NULL},
    {"sidelobe", "term", "",
     "A maximum of the far field beside the beam. The first one is next to the beam, the highest the "
     "largest of all.",
     NULL},
    {"half power", "term", "",
     "The width of the beam between the two directions where the power is half (-3 dB) of the largest.", NULL},
    {"physical optics", "term", "",
     "The far field as the sum of the currents that the feed makes on the facets: good for reflectors of "
     "many wavelengths (surface.pattern).",
     NULL},
    {"taper", "term", "",
     "What the feed lights less at the rim than in the middle: it costs gain and lowers sidelobes.", NULL},
    {"spillover", "term", "", "The part of the feed's power that goes past the reflector.", NULL},
    {"sigma", "term", "", "Standard deviation of an error: two thirds of all errors are below it.", NULL},
    {"pull", "term", "", "The force of the net on a support; as a goal the largest of them, N.", NULL},
    {"displacement", "term", "", "How far an attachment moves with the truss.", NULL},
    {"deflection", "term", "", "The largest displacement of an attachment, in an objective or a limit, m.", NULL},
    {"turnbuckle move", "term", "", "See turnbuckle.", NULL},
    {"unstressed length", "term", "",
     "The length of a cable without tension, length / (1 + T/EA): what the workshop cuts. See l0_m.", NULL},
    {"theoretical place", "term", "",
     "Where a node should be: on the wanted surface, by the generator or the table of the import. psi "
     "measures from there.",
     NULL},
    {"theoretical position", "term", "", "See theoretical place.", NULL},
    {"Newton", "term", "",
     "Newton's method: shapes by second derivatives of the energy, in few steps (form.method: newton).", NULL},
    {"fixed point", "term", "", "The paper's iteration: force densities from the lengths found, a linear solve, again.",
     NULL},
    {"chord", "term", "",
     "One of the ways to solve designs of a population: Newton steps with the matrix of the base design.", NULL},
    {"swarm", "term", "",
     "One of the ways to solve designs of a population: the paper's iteration for many of them side by "
     "side.",
     NULL},
    {"longeron", "term", "",
     "A tube of the ring along the rim, front or rear; verticals join the two, diagonals brace the bays.", NULL},
    {"f/D", "term", "", "Focal length over aperture: small for deep dishes.", NULL},
    {"focal length", "term", "", "Distance from the vertex of the parabola to its focus, where the feed is.", NULL},
    {"aperture", "term", "", "The opening of the reflector, seen along the axis: of a round one its diameter.", NULL},
    {"wavelength", "term", "",
     "Speed of light over frequency: 30 mm at 10 GHz. Errors of a 26th of it (half path, RMS) cost 1 dB.", NULL},
    {"mesh", "term", "",
     "The knitted wire that reflects, stretched over the front net: flat between the cables but for its "
     "own pull, see pillow.",
     NULL},
    {"mesh tension", "term", "", "See pillow.", NULL},
    {"faceting", "term", "", "The error of flat facets whose nodes are all on the surface: smaller with more rings.",
     NULL},
    {"convergence", "term", "",
     "An iteration has converged when more steps change nothing that matters; see stopped by.", NULL},
    {"journal", "term", "",
     "FILE.journal: what a run keeps beside its result while it works, so that a killed one goes on.", NULL},
    {"report", "term", "",
     "`hifdm report FILE`: a page to look at in a browser, with the net in 3-D, maps, charts and tables.", NULL},
    {"degrees of freedom", "term", "",
     "How many numbers say where all joints of the truss are: three shifts and three turns each, less what "
     "is held.",
     NULL},
    {"uncounted", "term", "", "See uncounted_nodes.", NULL},
    {"member", "term", "", "A tube of the truss.", NULL},
    {"d psi / d T", "term", "", "By how much psi changes for 1 N more in a cable, all others as they are.", NULL},
};
const int hf_n_words_case = sizeof hf_words_case / sizeof *hf_words_case;

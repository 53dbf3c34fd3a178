/* Defines the entries of `hifdm explain` for warnings. Each has text that occurs in no other warning. */
#include "out/words.h"

#include <stddef.h>

const hf_word hf_words_warning[] = {
    {"loose_nodes", "warning", "",
     "The nodes hang on slack cables alone. Shorten a cable there, raise its tension, or take the node out; their "
     "places mean nothing.",
     "no taut cable holds these nodes"},
    {"drifting_nodes", "warning", "",
     "Some node can move without a force, as one whose load equals the tension that it hangs on: the shape is one of "
     "many. Hold the node, or give a cable there another law.",
     "the equilibrium is not unique"},
    {"stopped_early", "warning", "",
     "The rule of the paper stops by the change of psi. For equilibrium: form.stop residual. Figures at this point "
     "depend on where the iteration stopped.",
     "ended before equilibrium"},
    {"elastic_tolerance", "warning", "",
     "A stiff cable turns a small error of its length into a large force. Lower form.length_tolerance.",
     "by the laws of the elastic cables forces of"},
    {"loaded_chains", "warning", "",
     "Straight chains of cables that keep their lengths carry a load across, which no finite tension holds: their "
     "tensions mean nothing. Let the edges sag (scene scallop), or give one cable of each chain law tension; form.stop "
     "residual refuses such a net and names all chains.",
     "of length-controlled cables carry lateral load"},
    {"slack_cables", "warning", "",
     "Cables without tension do not shape the net. Raise their tension, shorten them, or leave them out.",
     "slack in the"},
    {"mesh_pull", "warning", "",
     "The mesh pulls so much on cables that figures of first order mean less: raise the tension of the cables, lower "
     "surface.mesh_tension_N_per_m, or make facets smaller.",
     "the mesh pulls on"},
    {"coarse_facets", "warning", "",
     "The far field is that of the facets, whatever the shape: their errors make lobes at the angles of their period. "
     "Use "
     "a finer net, or a lower frequency.",
     "the facets are coarse"},
    {"loss_unmeasured", "warning", "",
     "The facets are too coarse for the highest frequency: pattern_loss_dB of nets as built is left out. Use a finer "
     "net, or a lower frequency.",
     "pattern_loss_dB is not measured at"},
    {"no_beam", "warning", "",
     "The goal gain begins where hardly anything of the field goes along the beam. Use another surface.pattern.feed, "
     "a lower frequency or a finer net.",
     "the theoretical shape itself loses"},
    {"coarse_angles", "warning", "",
     "The angles of the far field are too far apart for the beam, so that lobes are missed. Raise "
     "surface.pattern.n_theta, or narrow surface.pattern.theta_deg.",
     "deg are coarse: fewer than"},
    {"beam_at_end", "warning", "",
     "The highest gain is at an end of surface.pattern.theta_deg: the beam may lie beyond. Widen the range, or move "
     "it.",
     "the gain is largest at the end of theta_deg"},
    {"long_waves", "warning", "",
     "Physical optics holds for reflectors of many wavelengths; in smaller ones the edge matters as much as the "
     "surface. Use a higher frequency, or leave out surface.pattern.",
     "wavelengths across: physical optics does not hold"},
    {"no_facets", "warning", "",
     "No cables on the surface enclose a triangle or a quadrangle, so that nothing is known of the mesh between the "
     "nodes. Add cables, or name facets in a table.",
     "the net has no facets"},
    {"fit_failed", "warning", "",
     "The nodes do not tell a best fit: too few of them, or a shape far from the wanted kind of surface. Its figures "
     "are left out.",
     "the best fit to the shape of stage"},
    {"crossing_cables", "warning", "",
     "Seen along the axis two cables cross without a node: the net has no facets there that could be measured. Name "
     "them in a table of facets, or put a node at the crossing.",
     "cross without a node"},
    {"loss_of_nodes", "warning", "",
     "A requirement asks for the loss of gain that the nodes make. The mesh between them is flat and loses more: ask "
     "for "
     "facet_gain_loss_dB, or for facet_fit_gain_loss_dB of a reflector that is pointed and focused again.",
     "counts the nodes only"},
    {"slack_as_built", "warning", "",
     "An error of the cut changes a cable's tension by up to EA times error over length; where that is more than the "
     "tension, the cable goes slack in some of the nets. More tension, cables of less EA, or smaller errors.",
     "tolerance: slack cables in"},
    {"truss_gives_way", "warning", "",
     "The truss is computed by linear theory, which leaves out what turning does to second order, turn times "
     "displacement / 2: here more than 1e-5 of the span and a twentieth of psi. Stiffen the truss, or lower "
     "form.pretension_N.",
     "truss: its attachments give way so far"},
    {"stretched_far", "warning", "",
     "T/EA of this cable is more than 5 %. Where EA was given in kN it is a thousandth of what was meant; else the "
     "tension is more than such a cable carries. Cut lengths, states and samples of the net as built follow EA.",
     "is stretched by"},
    {"uncounted_nodes", "warning", "",
     "Goals count some nodes only: psi the inner ones, facets those of the front. The optimiser moves all others as "
     "far "
     "as that helps a little, and the net is no longer the one that was drawn. Let fewer cables vary (of a double "
     "layer "
     "the ties alone), or count the others, too: a goal length of their set (of the rear net) with a small weight "
     "keeps "
     "their cables near their theoretical lengths. Where the goals gain by these moves themselves, that gain is lost.",
     "moved far from where form-finding has it"},
    {"drifting_within_surface", "warning", "",
     "Goals of the surface (facets, surface, gain) count how far nodes are from it, not where on it they are. {figure: "
     "psi, weight: 0.1} beside them keeps nodes near their theoretical places; or let fewer cables vary (of a double "
     "layer the ties alone).",
     "moved far within the surface"},
    {"polish_not_converged", "warning", "",
     "The design is good, but not known to be an optimum: the message says what the last steps still gained. With more "
     "optimize.refine_steps, and `hifdm run --restart`, it gets better; a target that is met needs none.",
     "Levenberg-Marquardt is not converged after"},
    {"polish_needs", "warning", "",
     "Levenberg-Marquardt needs derivatives, which this case has not; the genetic algorithm does without.",
     "Levenberg-Marquardt needs"},
    {"no_feasible_start", "warning", "",
     "Levenberg-Marquardt starts from a design that keeps all limits, and there was none. Loosen the limit that the "
     "message names, or let the genetic algorithm look for a start (optimize.method ga+lm).",
     "has no feasible start"},
    {"no_free_end", "warning", "",
     "All ends of all boundary cables are supports, so that their tensions change nothing: check the column group, or "
     "say what may vary (optimize.variables).",
     "no boundary cable has a free end"},
    {"no_effect", "warning", "",
     "No variable of the case moves what the goal asks for: it only adds a constant to the merit. Let something vary "
     "there, or leave the goal out.",
     "no variable of this case changes"},
    {"variable_without_effect", "warning", "",
     "The variable acts on slack cables alone, or on none: at the base design it changes nothing. Give its cables "
     "tension, or leave the row out.",
     "changes nothing at the base design"},
    {"finished_result", "warning", "",
     "Nothing was computed: the file has the finished result of just this case. --restart computes it again.",
     "is the finished result of this case"},
    {"seed_unused", "warning", "", "Without a section optimize nothing is random.", "--seed has no effect"},
    {"unfinished_result", "warning", "",
     "A fault of the machine or a file in the way stopped a late stage. The stages before it are stored. Remove the "
     "cause that the error states and run the same command again to resume.",
     "is unfinished; run the same command again"},
    {"design_alone", "warning", "",
     "The net of this design has no samples; the error states why. Running the case again finds the same: change the "
     "design or the section tolerance.",
     "the result has the design alone"},
    {"point_dominated", "warning", "",
     "The point that was taken is none that one would choose: another is better in an objective and as good in all. "
     "`hifdm export --front` has the marks.",
     "is dominated: another point of its front"},
    {"front_is_no_design", "warning", "",
     "A front has many designs. The nets as built of `load_cases` and `tolerance` are cut for one, and without a point "
     "that "
     "is the form-finding's. `hifdm run CASE --point FRONT.h5:N` takes point N of a front that was found before.",
     "a front is no single design"},
    {"no_point_taken", "warning", "",
     "The file has a front, and what was read of it is no point that one would choose: mostly the net as form-finding "
     "has it, before any optimisation. Make a result of a point and use that one; with --stage the shape is meant.",
     "no point of its front is taken"},
    {"front_failed", "warning", "",
     "Points of the front have no design within their limits. Fewer points, wider ranges or other objectives; the "
     "other points hold.",
     "points of the front failed"},
    {"front_not_converged", "warning", "",
     "These points are good designs, but not known to be optima, and have no slope. Raise optimize.refine_steps.",
     "points of the front are not converged"},
    {"front_of_generations", "warning", "",
     "Levenberg-Marquardt could not refine the front; it is that of the last generation.",
     "the front is that of the last generation"},
    {"no_shape_in_state", "warning", "",
     "The net as built has no shape in this state of `load_cases`: look at its loads and temperatures.",
     "the net has no shape in state"},
    {"slack_in_state", "warning", "",
     "In this state of `load_cases` cables go slack. Of nets in zero gravity that is a fault of the design; on the "
     "ground, "
     "or folded, it may be meant.",
     "cases: in state"},
    {"cable_twice", "warning", "", "Two cables join the same nodes: one of them is mostly a slip.",
     "joins the same two nodes as cable"},
    {"cables_twice", "warning", "", "See cable_twice; these are the rest of them.",
     "more cables that join the same two nodes"},
    {"far_node", "warning", "", "A coordinate in mm among others in m, or a digit too many.",
     "from the middle of the net"},
    {"far_nodes", "warning", "", "See far_node; these are the rest of them.", "more nodes as far away"},
    {"large_net", "warning", "",
     "A net of more than 500 m: lengths may be in mm, and keys and tables have them in m. If it is meant, nothing to "
     "do.",
     "m across: are all lengths in m?"},
    {"long_cable", "warning", "",
     "The length that a cable of law length or elastic has by its table is far from the distance of its nodes: in mm, "
     "or "
     "a digit too many. If a cable is meant to hang, nothing to do.",
     "m long by its law"},
    {"long_cables", "warning", "", "See long_cable; these are the rest of them.",
     "more cables of other lengths than their nodes"},
    {"far_range", "warning", "",
     "A range several times as large as the values themselves lets them become almost nothing, or many times as large. "
     "Parts have a sign: range: 50 %. If the number is meant, give bounds, too.",
     "times the largest value of this row"},
    {"unused_length", "warning", "",
     "form.prestress exact replaces every law by a force density: of cables of laws length and elastic it takes no "
     "length. Prescribe lengths with form.prestress given.",
     "form.prestress: exact: the length given to cable"},
    {"flat_rim", "warning", "",
     "With all supports in one plane tensions pull the whole net into it. Tie the net to a second one "
     "(rear_distance_m), load it, or put supports on the surface.",
     "whatever its tensions, it collapses there"},
    {"focal_length", "warning", "", "Reflectors have focal lengths of some apertures: is it in m?",
     "times the aperture of"},
    {"no_expansion", "warning", "",
     "The state has a temperature of the truss, and no member with an expansion_per_K. Without it the truss stays as "
     "it is.",
     "no member of the truss expands"},
    {"unused_column", "warning", "",
     "A column of a table that hifdm does not know, perhaps a misspelt one; it is left out.", "is not used"},
    {"places_do_not_fit", "warning", "",
     "The measured places are farther from what the net can be than the sigmas allow: units, the frame, mixed-up ids, "
     "supports that have moved, or another design.",
     "these places do not fit the net"},
    {"estimate_not_settled", "warning", "",
     "The estimate of the errors still moved: measure more nodes, or allow for fewer errors.",
     "the estimate did not settle"},
    {"truss_not_estimated", "warning", "",
     "The case has temperatures of the truss among its errors, and adjust knows none: places that a warm truss has "
     "moved "
     "are taken for errors of cables and supports.",
     "tolerance.truss is not estimated"},
    {"places_tell_little", "warning", "",
     "The places are measured less well than the net is known from its tolerances: they change next to nothing.",
     "these places tell next to nothing"},
    {"other_frame", "warning", "",
     "The measured places look moved or turned as a whole: is this the frame of the case, in m?",
     "is this the frame of the case"},
    {"no_locks", "warning", "",
     "The file system has no locks: start no second process on the same result or sweep; of a sweep only --task keeps "
     "several apart.",
     "this file system has no locks"},
    {"run_elsewhere", "warning", "", "Another process works on these points: nothing to do.",
     "points are run by another process"},
    {"no_journal", "warning", "", "A file with the name of the journal was none; it was replaced.",
     "was no journal of hifdm"},
    {"damaged_journal", "warning", "",
     "The end of the journal is damaged, as after a power cut: what it held is computed again.",
     "bytes count for nothing"},
    {"other_bits", "warning", "", "Another machine or build began this result. Figures agree, the last bits may not.",
     "finds the shape with other last bits"},
    {"other_designs", "warning", "",
     "Another machine or build began this result: the generations that were not published are computed again.",
     "breeds other designs"},
    {"no_far_field", "warning", "",
     "The run was told to stop while it summed the far field: the shape is kept, its pattern is not there.",
     "told to stop: the shape of stage"},
    {"nothing_to_recover", "warning", "", "The result is finished.", "there is nothing to recover"},
    {"export_without_truss", "warning", "",
     "The result is not finished, and its truss is stored last. Run the same case again to resume, then export.",
     "the export has no truss"},
    {"temporary_file_left", "warning", "",
     "The folder does not let the program remove its temporary file. The next command that writes the same file "
     "removes it; or allow it, or remove the file yourself.",
     "cannot remove the temporary file"},
    {"earlier_result_kept", "warning", "",
     "A run with --restart replaces a finished result only when it is finished itself. Until then the earlier one has "
     "the name that ends in .before-restart.",
     "the earlier result is"},
    {"earlier_result_left", "warning", "",
     "The new result is finished, but the folder does not let the program remove the earlier one: remove it yourself.",
     "cannot remove the earlier result"},
};
const int hf_n_words_warning = sizeof hf_words_warning / sizeof *hf_words_warning;

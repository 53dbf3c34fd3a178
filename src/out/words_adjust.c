/* Defines the entries of `hifdm explain` for keys of `hifdm adjust --json` and columns of its table. */
#include "out/words.h"

#include <stddef.h>

const hf_word hf_words_adjust[] = {
    {"order", "column of adjust", "", "Moves are made in this order.", NULL},
    {"move_mm", "column of adjust", "mm", "How far the turnbuckle is turned; above 0 lets the cable out.", NULL},
    {"tension_before_N", "figure of adjust", "N",
     "Tension of the cable right before its move, after those that come before it.", NULL},
    {"tension_after_N", "figure of adjust", "N", "Tension of the cable right after its move.", NULL},
    {"predicted_rms_mm", "column of adjust", "mm",
     "The figure (adjust.figure) of the whole net after this move and those before it, by its solved shape.", NULL},
    {"expected_rms_mm", "column of adjust", "mm",
     "RMS of the figure after this move over all nets that fit the measurement as well: what to expect. Where few "
     "nodes "
     "were measured it is far above predicted_rms_mm, which is of the most probable net alone.",
     NULL},
    {"figure", "figure of adjust", "",
     "What the moves make small: adjust.figure. surface and facets are RMS along the normal, which `hifdm show "
     "--verbose` tells beside the half path.",
     NULL},
    {"aim", "figure of adjust", "",
     "What psi is measured from: adjust.aim. Other figures are measured from the wanted surface.", NULL},
    {"design_psi_m", "figure of adjust", "m",
     "How far the inner nodes of the design are from their theoretical places, RMS.", NULL},
    {"error_psi_m", "figure of adjust", "m",
     "How far the errors of section tolerance move the inner nodes, RMS, to first order.", NULL},
    {"at_range", "figure of adjust", "",
     "Moves that are as far as adjust.range_m allows. When most are, they aim at what these cables do not reach: see "
     "instead.",
     NULL},
    {"instead", "figure of adjust", "",
     "What moves would do that aim at something else (adjust.figure, adjust.aim), where the design is farther from "
     "theory than errors make it, or most moves are at range_m.",
     NULL},
    {"before_m", "figure of adjust", "m", "The figure of another aim before any move, of the most probable net.", NULL},
    {"after_m", "figure of adjust", "m", "The figure of another aim after its moves, of the most probable net.", NULL},
    {"move_count", "figure of adjust", "", "How many moves another aim takes.", NULL},
    {"measured_nodes", "figure of adjust", "", "Nodes that the table of measured places has.", NULL},
    {"fits", "figure of adjust", "",
     "Whether chi_square is what chance makes of it. false: the moves are not to be trusted before the cause is known.",
     NULL},
    {"cables", "figure of adjust", "", "How many cables can be turned (adjust.set).", NULL},
    {"nominal_m", "figure of adjust", "m", "The figure of the net without errors.", NULL},
    {"measured_m", "figure of adjust", "m", "psi of the measured places themselves, noise included.", NULL},
    {"estimated_m", "figure of adjust", "m", "The figure of the most probable shape, before any move.", NULL},
    {"estimated_expected_m", "figure of adjust", "m",
     "RMS of the figure before any move over all nets that fit the measurement as well.", NULL},
    {"estimated_sigma_m", "figure of adjust", "m", "Standard deviation of the figure over these nets.", NULL},
    {"adjusted_m", "figure of adjust", "m", "The figure of the most probable shape after all moves.", NULL},
    {"adjusted_expected_m", "figure of adjust", "m",
     "RMS of the figure after all moves over all nets that fit the measurement as well: what to expect.", NULL},
    {"adjusted_sigma_m", "figure of adjust", "m",
     "Standard deviation of the figure after all moves over these nets, each of them solved. The figure goes with the "
     "square of what tensions are off by, so single nets are further above what to expect than a normal distribution "
     "has it: of 96 nets whose tensions are open by 5 % each, one was so by 8 standard deviations, as its tensions "
     "were by 3.8.",
     NULL},
    {"best_m", "figure of adjust", "m",
     "What a search over moves of all cables that can be turned reached, of any size within the range and without "
     "least tensions. It goes downhill from the moves of the table and ends where no step gains: there may be better.",
     NULL},
    {"end", "figure of adjust", "",
     "Why there is no further move: target (the most probable net meets target_m), moves (all are made), doubt (the "
     "next one gains less "
     "than the measurement can tell), none (none gains anything).",
     NULL},
    {"held_taut", "figure of adjust", "",
     "Whether other moves were better but for cables that would fall below their least tension.", NULL},
    {"maybe_slack", "figure of adjust", "",
     "Cables whose estimated tension is less than its standard deviation over the nets that fit the measurement as "
     "well, or that are slack. How much too long a slack cable is shows in no place, so what becomes taut after moves "
     "is not known: it is in what to expect after them, and in its standard deviation.",
     NULL},
    {"maybe_slack", "what to do", "",
     "Make a few moves and measure again. Nets whose errors leave no cable slack are designed with larger tensions or "
     "softer cables.",
     NULL},
    {"supports_estimated", "figure of adjust", "", "Whether supports may be off: tolerance.sigma_support_m.", NULL},
    {"estimate_steps", "figure of adjust", "", "Steps of the estimate of the errors.", NULL},
    {"rounds", "figure of adjust", "", "Linear models of the choice of moves.", NULL},
    {"settled", "figure of adjust", "", "Whether estimate and choice ended because nothing was left to gain.", NULL},
    {"moves", "figure of adjust", "", "The moves in the order in which they are made.", NULL},
    {"steps", "figure of adjust", "", "A move in steps of adjust.step_m.", NULL},
    {"move_m", "figure of adjust", "m", "How far the turnbuckle is turned; above 0 lets the cable out.", NULL},
    {"predicted_m", "figure of adjust", "m", "The figure after this move and those before it, by the solved shape.",
     NULL},
    {"expected_m", "figure of adjust", "m",
     "RMS of the figure after this move over all nets that fit the measurement as well: what to expect.", NULL},
    {"gain_m", "figure of adjust", "m",
     "By how much this move lowers the figure, after those before it, mean over the nets that fit the measurement as "
     "well; below 0: it raises it, and makes room for moves behind it.",
     NULL},
    {"gain_sigma_m", "figure of adjust", "m",
     "Standard deviation of this gain over the nets that fit the measurement as well. A move that gains less at its "
     "place may still be one that moves behind it need: all of them were chosen together. Leave the last ones out, or "
     "measure again before them.",
     NULL},
    {"slack", "figure of adjust", "", "Cables that are slack right after this move.", NULL},
    {"stand_out", "figure of adjust", "",
     "Cables whose estimated error is beyond three of its sigmas, the worst first; without those whose error is nearly "
     "all their spool's.",
     NULL},
    {"error_m", "figure of adjust", "m", "Estimated error of the cut length; above 0 the cable is too long.", NULL},
    {"sigmas", "figure of adjust", "", "An estimated error over its sigma in section tolerance.", NULL},
    {"by_places_m", "figure of adjust", "m",
     "What the measured places alone tell of the error of this cable, as if its sigma said nothing; above 0 too long. "
     "null where they hardly tell it from the errors of others.",
     NULL},
    {"off_shape", "figure of adjust", "",
     "Measured nodes that are more than four of their sigmas off the estimated shape, the worst first.", NULL},
    {"node", "figure of adjust", "", "The id of a node.", NULL},
    {"distance_m", "figure of adjust", "m", "How far a measured place is from the estimated shape.", NULL},
    {"shared", "figure of adjust", "",
     "What several cables have in common: the errors of spools (tolerance.batch), the temperature.", NULL},
    {"kind", "figure of adjust", "", "Of what is shared: cut_ratio and EA_ratio of a spool, or temperature_K.", NULL},
    {"error", "figure of adjust", "", "Of what is shared: over the length, over EA, or in K.", NULL},
    {"errors_m", "figure of adjust", "m", "Estimated errors of all cut lengths, by cable.", NULL},
    {"outlier", "term", "",
     "Of `hifdm adjust`: an error far beyond its sigma. That of a cable is held back, since the estimate weighs it "
     "against its sigma: of one cut 2 mm wrong where 0.1 mm is usual it may believe the half. Places are not held "
     "back: each counts in full, by its own sigma_m, also one that was measured wrong.",
     NULL},
    {"outlier", "what to do", "",
     "A cable: look at it; make the moves, measure again and adjust again, since what was not believed shows again. In "
     "a table of cables, give it the length that the places alone tell. A node: measure it again, or leave its line "
     "out.",
     NULL},
    {"result", "figure of adjust", "", "The result file that the design was read from.", NULL},
};
const int hf_n_words_adjust = sizeof hf_words_adjust / sizeof *hf_words_adjust;

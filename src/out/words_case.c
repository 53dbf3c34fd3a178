#include "out/words.h"

#include <stddef.h>

/* Words of case files, of cut lists, and of the trade. */
const hf_word hf_words_case[] = {
    {"goal", "term", "",
     "What a design should reach: a row of optimize.goals, a figure of the shape of which less is better (psi, facets, "
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
     "`hifdm export FILE --cutlist cut.csv`: to which length each cable is cut (l0_m, without tension), where a jig "
     "holds the nodes, and how much cable each group and set needs. It can be imported as a net.",
     NULL},
    {"cut list", "term", "", "See cutlist.", NULL},
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
};
const int hf_n_words_case = sizeof hf_words_case / sizeof *hf_words_case;

/* cable_law - the laws that a cable can obey, and all functions that depend on the law (METHOD.md section 2).
 * Stability: internal. This header may change in any version.
 *
 * The names and words of the laws are stable because files contain them.
 *
 * A new law needs one row of HF_LAW_LIST and one case in each function below. The compiler reports a function that
 * lacks the case of a law. Solvers use only the flags and functions of this header. A new law therefore requires no
 * change in a solver. A kernel may have its own formulas for the laws. Each kernel with its own formulas has a set of
 * flags that defines the laws that the kernel can solve (hf_law_is_served). If a net contains a law that the kernel
 * cannot solve, another method solves the net.
 *
 * Lengths are in m, tensions in N and force densities in N/m. The order of the floating-point operations determines the
 * last bits of stored data sets and must not change. */
#pragma once

#include <hifdm/api.h>
#include <math.h>
#include <stdbool.h>

HF_API_BEGIN

/* These flags describe the properties of a law that solvers may use. */
enum {
    HF_LAW_ITERATES = 1,      /* the force density depends on the shape, so one linear solve is not enough */
    HF_LAW_IS_CONVEX = 2,     /* the potential is convex under tension */
    HF_LAW_GIVES_TENSION = 4, /* the tension is the target value at any length */
    /* the tension is a separate unknown; the law gives the required length at this tension */
    HF_LAW_HAS_MULTIPLIER = 8,
    /* law with a multiplier: the required length is the same at every tension, and there is no potential */
    HF_LAW_IS_RIGID = 16,
    HF_LAW_GOES_SLACK = 32, /* law with a multiplier: the tension may be zero, and the cable then carries no force */
    HF_LAW_NEEDS_EA = 64,   /* the law depends on the axial stiffness EA of the cable */
    HF_LAW_MAY_PUSH = 128   /* the target value may be below zero; the cable is then a strut */
};

/* Each row X(name, word, target, unit of target, flags) defines one law. Files store the words in the order of the
 * rows. `target` is the name of the target value in messages. If `target` is NULL, a cable of this law may have no
 * value.
 *
 *   tension         T = T*, Eq. 7
 *   length          l = L*, Eq. 8
 *   force_density   q is constant, Eq. 5
 *   elastic         T = EA max(l/l0 - 1, 0) with the unstressed length l0 */
#define HF_LAW_LIST(X)                                                                                                 \
    X(HF_LAW_TENSION, "tension", NULL, "N", HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_GIVES_TENSION)                 \
    X(HF_LAW_LENGTH, "length", NULL, "m",                                                                              \
      HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_HAS_MULTIPLIER | HF_LAW_IS_RIGID)                                    \
    X(HF_LAW_FORCE_DENSITY, "force_density", "", "N/m", HF_LAW_IS_CONVEX | HF_LAW_MAY_PUSH)                            \
    X(HF_LAW_ELASTIC, "elastic", "unstressed length", "m",                                                             \
      HF_LAW_ITERATES | HF_LAW_IS_CONVEX | HF_LAW_HAS_MULTIPLIER | HF_LAW_GOES_SLACK | HF_LAW_NEEDS_EA)

#define HF_LAW_NAME(name, word, target, unit, flags) name,
/* The law of a cable. Files contain the values of the enumeration hf_law. */
typedef enum { HF_LAW_LIST(HF_LAW_NAME) } hf_law;
#undef HF_LAW_NAME

#define HF_LAW_WORD(name, word, target, unit, flags) word, /* for lists of all words */
#define HF_LAW_ONE_MORE(name, word, target, unit, flags) +1
enum { HF_N_LAW = HF_LAW_LIST(HF_LAW_ONE_MORE) };
#undef HF_LAW_ONE_MORE

extern const char *const hf_law_word[HF_N_LAW];        /* "tension", "length", "force_density", "elastic" */
extern const char *const hf_law_target_name[HF_N_LAW]; /* names of the target values; NULL: the value is optional */
extern const char *const hf_law_target_unit[HF_N_LAW]; /* units of the target values */

/* Contains the values of one cable that its law uses. */
typedef struct {
    hf_law law;                /* law in force */
    double target;             /* target value by law: T* (N), L* (m), q (N/m) or l0 (m) */
    double EA_N;               /* axial stiffness; NaN if the law does not need it */
    double length_at_target_m; /* distance between the target positions of the ends of the cable */
} hf_law_cable;

/* Returns true if the law has at least one of the given flags. */
static inline bool hf_law_has(hf_law law, unsigned flags)
{
#define HF_LAW_FLAGS(name, word, target, unit, flags) flags,
    static const unsigned char flags_of[HF_N_LAW] = {HF_LAW_LIST(HF_LAW_FLAGS)};
#undef HF_LAW_FLAGS
    return (flags_of[law] & flags) != 0;
}

/* Returns true if a kernel for laws with the flags `served` can solve this law. A kernel can solve a law if `served`
 * contains all flags of the law. */
static inline bool hf_law_is_served(hf_law law, unsigned served)
{
    return !hf_law_has(law, ~served);
}

/* Returns the default target value of a cable without a given target value. For the law `length`, the default is the
 * distance length_at_target_m between the target positions of the ends of the cable. For all other laws, the function
 * returns NaN because these laws have no default or use the pretension. */
static inline double hf_law_default_target(hf_law law, double length_at_target_m)
{
    switch (law) {
    case HF_LAW_LENGTH:
        return length_at_target_m;
    case HF_LAW_TENSION:
    case HF_LAW_FORCE_DENSITY:
    case HF_LAW_ELASTIC:
        break;
    }
    return (double)NAN;
}

/* Defines the size in bytes of the buffer for hf_law_target_fault. */
#define HF_LAW_FAULT_SIZE 160

/* Checks the target value of a cable. If the user gave no target value, the argument `target` is NaN. The argument
 * length_at_target_m is the distance between the target positions of the ends of the cable, in m. Returns NULL if the
 * value is valid. If the value is invalid, the function writes the fault into `text` and returns `text`. */
const char *hf_law_target_fault(hf_law law, double target, double length_at_target_m, char text[HF_LAW_FAULT_SIZE]);

/* Returns the length in m that a law with a multiplier requires at the tension tension_N. Returns NaN for other laws.
 * Expressed as a function of the tension, the length needs no special case for stiff cables. In the limit of infinite
 * EA, the law elastic becomes the law length (METHOD M3). */
static inline double hf_law_required_length_m(hf_law_cable c, double tension_N)
{
    switch (c.law) {
    case HF_LAW_LENGTH:
        return c.target;
    case HF_LAW_ELASTIC:
        return c.target + c.target * tension_N / c.EA_N;
    case HF_LAW_TENSION:
    case HF_LAW_FORCE_DENSITY:
        break;
    }
    return (double)NAN;
}

/* Returns the tension in N of a cable with the length length_m. Returns NaN for a rigid law because its length does not
 * determine the tension. */
static inline double hf_law_tension_N(hf_law_cable c, double length_m)
{
    switch (c.law) {
    case HF_LAW_TENSION:
        return c.target;
    case HF_LAW_FORCE_DENSITY:
        return c.target * length_m;
    case HF_LAW_ELASTIC:
        return c.EA_N * fmax(length_m / c.target - 1, 0);
    case HF_LAW_LENGTH:
        break;
    }
    return (double)NAN;
}

/* Returns the unstressed length in m of a cable with the length length_m and the tension tension_N (METHOD M32). For a
 * slack cable whose law has a multiplier, the function returns the length that the law requires at zero tension. The
 * member c.EA_N is required for every law. */
static inline double hf_law_cut_m(hf_law_cable c, double length_m, double tension_N, bool is_slack)
{
    if (is_slack && hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER)) return hf_law_required_length_m(c, 0);
    return length_m / (1 + tension_N / c.EA_N);
}

/* Returns the axial stiffness phi'' = dT/dl of the law at the length length_m, in N/m. Returns INFINITY for a rigid
 * law. */
static inline double hf_law_stiffness_N_per_m(hf_law_cable c, double length_m)
{
    switch (c.law) {
    case HF_LAW_FORCE_DENSITY:
        return c.target;
    case HF_LAW_ELASTIC:
        return length_m > c.target ? c.EA_N / c.target : 0;
    case HF_LAW_LENGTH:
        return (double)INFINITY;
    case HF_LAW_TENSION:
        break;
    }
    return 0;
}

/* ---- functions that follow from the flags ---- */

/* Returns the force density in N/m at the length length_m. If the law determines the tension, the force density is the
 * tension divided by the length. Otherwise it is q_N_per_m. */
static inline double hf_law_held_q_N_per_m(hf_law_cable c, double length_m, double q_N_per_m)
{
    return hf_law_has(c.law, HF_LAW_GIVES_TENSION) ? c.target / length_m : q_N_per_m;
}

/* Eq. 8 assigns at least the force density HF_LAW_MIN_Q_N_PER_M, in N/m, to a slack cable. The force of a cable with
 * this force density is far below all other forces in a net. A minimum of 1e-100 N/m would be too large for nets with
 * pretensions of 1e-300 N. The minimum force density is large enough to determine the position of a node that only
 * slack cables hold. */
#define HF_LAW_MIN_Q_N_PER_M 1e-305

/* Returns the next force density of the fixed-point iteration in N/m. Eq. 7 multiplies the force density q by the ratio
 * of the required tension to the present tension. Because T = q l, the result of Eq. 7 is the required tension divided
 * by the length l. Eq. 8 multiplies the force density q by the ratio of the present length to the required length. The
 * required length of an elastic cable increases with the tension. */
static inline double hf_law_next_q_N_per_m(hf_law_cable c, double length_m, double tension_N, double q_N_per_m)
{
    if (hf_law_has(c.law, HF_LAW_GIVES_TENSION)) return c.target / length_m;
    if (!hf_law_has(c.law, HF_LAW_HAS_MULTIPLIER)) return q_N_per_m;
    double next = q_N_per_m * (length_m / hf_law_required_length_m(c, tension_N));
    return next < HF_LAW_MIN_Q_N_PER_M ? HF_LAW_MIN_Q_N_PER_M : next; /* NaN is returned unchanged */
}

/* Returns the tension in N with which an iteration begins. If the cable can go slack and is taut between its target
 * positions, the iteration begins with the tension at these positions. For all other cables, the iteration begins with
 * the tension otherwise_N. The function limits the ratio of this tension to otherwise_N to the range from
 * 1/HF_LAW_FIRST_RANGE to HF_LAW_FIRST_RANGE. Without this limit, a stiff cable that is only just taut would carry
 * almost no force at the beginning. Without this limit, a stiff cable that was cut too short would carry almost the
 * entire force at the beginning. */
#define HF_LAW_FIRST_RANGE 10.0
static inline double hf_law_first_tension_N(hf_law_cable c, double otherwise_N)
{
    bool is_taut = hf_law_has(c.law, HF_LAW_GOES_SLACK) && c.length_at_target_m > hf_law_required_length_m(c, 0);
    if (!is_taut) return otherwise_N;
    double tension_N = hf_law_tension_N(c, c.length_at_target_m);
    return fmin(fmax(tension_N, otherwise_N / HF_LAW_FIRST_RANGE), otherwise_N * HF_LAW_FIRST_RANGE);
}

HF_API_END

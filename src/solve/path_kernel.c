/* The functions of path_cable.h, compiled once for each instruction set.
 *
 * Contents: eight cables - errors - the cone - scaling - right-hand side - direction and room - move */
#include "solve/path_kernel.h"

#include <string.h>

/* ---- eight cables ---- */

typedef double lanes __attribute__((vector_size(HF_LANES * sizeof(double))));
typedef long long bits __attribute__((vector_size(HF_LANES * sizeof(double))));
typedef struct {
    lanes x[3];
} vectors;

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)
#define KERNEL(name) JOIN(name, HF_ISA)
#define INLINE static inline __attribute__((always_inline))

INLINE lanes load(const double from[HF_LANES])
{
    lanes a;
    memcpy(&a, from, sizeof a);
    return a;
}

INLINE void store(double to[HF_LANES], lanes a)
{
    memcpy(to, &a, sizeof a);
}

INLINE vectors load3(const double from[3][HF_LANES])
{
    return (vectors){{load(from[0]), load(from[1]), load(from[2])}};
}

INLINE void store3(double to[3][HF_LANES], const vectors *a)
{
    for (int c = 0; c < 3; c++)
        store(to[c], a->x[c]);
}

/* Lanes of a where the condition (-1 or 0) holds, else of b. */
INLINE lanes choose(bits condition, lanes a, lanes b)
{
    bits x, y;
    memcpy(&x, &a, sizeof x);
    memcpy(&y, &b, sizeof y);
    x = (x & condition) | (y & ~condition);
    memcpy(&a, &x, sizeof a);
    return a;
}

/* fmax: a NaN gives the other. */
INLINE lanes larger(lanes a, lanes b)
{
    return choose((a >= b) | (b != b), a, b);
}

INLINE lanes root(lanes a)
{
    for (int k = 0; k < HF_LANES; k++)
        a[k] = __builtin_sqrt(a[k]);
    return a;
}

INLINE lanes size(lanes a)
{
    return choose(a < 0, -a, a);
}

INLINE lanes inner(vectors a, vectors b)
{
    return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

/* Largest lane of `a` above 0; NaNs do not count. */
INLINE double largest(lanes a)
{
    double most = 0;
    for (int k = 0; k < HF_LANES; k++)
        if (a[k] > most) most = a[k];
    return most;
}

INLINE bits has_cone(const hf_path_cables *p)
{
    return load(p->has_cone) != 0;
}

INLINE bits has_multiplier(const hf_path_cables *p)
{
    return load(p->has_multiplier) != 0;
}

INLINE bool is_empty(const hf_path_cables *p)
{
    for (int k = 0; k < HF_LANES; k++)
        if (p->has_cone[k] != 0) return false;
    return true;
}

/* ---- errors ---- */

double KERNEL(hf_path_measure)(int n_block, hf_path_cables *block)
{
    lanes most = {0};
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        vectors d = load3(p->d), t = load3(p->t);
        lanes T = load(p->T), v = load(p->v), along = load(p->along), target = load(p->target);
        bits cone = has_cone(p);
        for (int c = 0; c < 3; c++)
            t.x[c] = choose(cone, t.x[c], along * d.x[c]);
        store3(p->t, &t);
        store(p->gap, T * v - inner(t, d));
        lanes over = target + target * T / load(p->EA) - v;
        store(p->short_m, choose(has_multiplier(p), over, (lanes){0}));
        most = larger(choose(has_multiplier(p) & cone, size(over) / load(p->theoretical), (lanes){0}), most);
    }
    return largest(most);
}

/* ---- the cone ---- */

/* Root of the determinant a0^2 - |a1|^2 of a point in the cone; never zero. */
INLINE lanes root_det(lanes a0, vectors a1)
{
    lanes length = root(inner(a1, a1)), det = (a0 - length) * (a0 + length), least = (lanes){0} + 1e-300;
    return root(larger(det, least));
}

typedef struct {
    lanes eta, w0;
    vectors w1;
} scaling;

INLINE scaling scaling_of(const hf_path_cables *p)
{
    return (scaling){root(load(p->eta2)), load(p->w0), load3(p->w1)};
}

/* b = W a */
INLINE lanes scale(const scaling *s, lanes a0, vectors a1, vectors *b1)
{
    lanes along = inner(s->w1, a1), share = a0 + along / (1 + s->w0);
    for (int c = 0; c < 3; c++)
        b1->x[c] = s->eta * (a1.x[c] + share * s->w1.x[c]);
    return s->eta * (s->w0 * a0 + along);
}

/* b = W^-1 a */
INLINE lanes unscale(const scaling *s, lanes a0, vectors a1, vectors *b1)
{
    lanes along = inner(s->w1, a1), share = along / (1 + s->w0) - a0;
    for (int c = 0; c < 3; c++)
        b1->x[c] = (a1.x[c] + share * s->w1.x[c]) / s->eta;
    return (s->w0 * a0 - along) / s->eta;
}

/* K a */
INLINE vectors times_K(const hf_path_cables *p, vectors a)
{
    lanes across = load(p->across);
    vectors unit = load3(p->unit), b;
    lanes more = (load(p->along) - across) * inner(unit, a);
    for (int c = 0; c < 3; c++)
        b.x[c] = across * a.x[c] + more * unit.x[c];
    return b;
}

/* ---- scaling ---- */

INLINE void set_stiffness(hf_path_cables *p, lanes eta2, vectors w1)
{
    lanes square = inner(w1, w1), A = 1 + 2 * square, length = root(square), flex = load(p->flex);
    lanes taut = (eta2 * A + flex) / (eta2 * (eta2 + flex * A)), given = 1 / (eta2 * A);
    bits cone = has_cone(p);
    store(p->across, choose(cone, 1 / eta2, load(p->across)));
    store(p->along, choose(cone, choose(has_multiplier(p), taut, given), load(p->along)));
    for (int c = 0; c < 3; c++)
        store(p->unit[c], choose(cone & (length > 0), w1.x[c] / length, (lanes){0}));
}

void KERNEL(hf_path_set_scaling)(int n_block, hf_path_cables *block)
{
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        lanes v = load(p->v), T = load(p->T);
        vectors d = load3(p->d), t = load3(p->t), s1, z1, w1, lambda1;
        lanes s = root_det(v, d), z = root_det(T, t), s0 = v / s, z0 = T / z;
        for (int c = 0; c < 3; c++) {
            s1.x[c] = d.x[c] / s;
            z1.x[c] = -t.x[c] / z;
        }
        lanes gamma = root((1 + s0 * z0 + inner(s1, z1)) / 2), eta2 = s / z, det = root(s * z);
        for (int c = 0; c < 3; c++) {
            w1.x[c] = (s1.x[c] - z1.x[c]) / (2 * gamma);
            lambda1.x[c] = det * ((gamma + z0) * s1.x[c] + (gamma + s0) * z1.x[c]) / (s0 + z0 + 2 * gamma);
        }
        store(p->eta2, eta2);
        store(p->det, det);
        store(p->w0, (s0 + z0) / (2 * gamma));
        store3(p->w1, &w1);
        store(p->lambda0, gamma * det);
        store3(p->lambda1, &lambda1);
        set_stiffness(p, eta2, w1);
    }
}

/* ---- right-hand side ---- */

void KERNEL(hf_path_set_side)(int n_block, hf_path_cables *block, double target, bool corrected)
{
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        scaling s = scaling_of(p);
        vectors l1 = load3(p->lambda1), r1, q1, R1, off, pull;
        lanes l0 = load(p->lambda0), det = load(p->det), eta2 = load(p->eta2);
        lanes r0 = target * load(p->weight) - l0 * l0 - inner(l1, l1);
        for (int c = 0; c < 3; c++)
            r1.x[c] = -2 * l0 * l1.x[c];
        if (corrected) {
            r0 -= load(p->corrector0);
            for (int c = 0; c < 3; c++)
                r1.x[c] -= load(p->corrector1[c]);
        }
        lanes q0 = (l0 * r0 - inner(l1, r1)) / (det * det); /* lambda o q = r */
        for (int c = 0; c < 3; c++)
            q1.x[c] = (r1.x[c] - q0 * l1.x[c]) / l0;
        lanes R0 = scale(&s, q0, q1, &R1);
        lanes a = eta2 * (2 * s.w0 * s.w0 - 1), b = 2 * eta2 * s.w0;
        lanes share = b * (R0 - load(p->short_m)) / (a + load(p->flex));
        share = choose(has_multiplier(p), share, (lanes){0});
        for (int c = 0; c < 3; c++)
            off.x[c] = share * s.w1.x[c] - R1.x[c];
        store(p->R0, R0);
        store3(p->off, &off);
        pull = times_K(p, off);
        store3(p->pull, &pull);
    }
}

/* ---- direction and room ---- */

/* How many times the scaled direction fits between the scaled point and the boundary of the cone, inverted: <= 0
 * without end. */
INLINE lanes inverse_room(const hf_path_cables *p, lanes a0, vectors a1)
{
    lanes det = load(p->det), l0 = load(p->lambda0) / det;
    vectors l1 = load3(p->lambda1), r1;
    for (int c = 0; c < 3; c++)
        l1.x[c] /= det;
    lanes r0 = l0 * a0 - inner(l1, a1), share = (r0 + a0) / (l0 + 1);
    for (int c = 0; c < 3; c++)
        r1.x[c] = a1.x[c] - share * l1.x[c];
    return (root(inner(r1, r1)) - r0) / det;
}

double KERNEL(hf_path_set_direction)(int n_block, hf_path_cables *block, bool corrects)
{
    lanes most = {0};
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        scaling s = scaling_of(p);
        vectors Dd = load3(p->Dd), off = load3(p->off), y, minus, s1, z1;
        lanes eta2 = load(p->eta2), short_m = load(p->short_m), R0 = load(p->R0), flex = load(p->flex);
        bits cone = has_cone(p), multiplier = has_multiplier(p);
        for (int c = 0; c < 3; c++)
            y.x[c] = Dd.x[c] + off.x[c];
        vectors Dt = times_K(p, y);
        lanes a = eta2 * (2 * s.w0 * s.w0 - 1), turned = 2 * eta2 * s.w0 * inner(s.w1, Dt);
        lanes DT = choose(multiplier, (R0 - short_m + turned) / (a + flex), (lanes){0});
        lanes Dv = choose(multiplier, flex * DT + short_m, R0 - a * DT + turned);
        store(p->DT, DT);
        store(p->Dv, Dv);
        store3(p->Dt, &Dt);
        for (int c = 0; c < 3; c++)
            minus.x[c] = -Dt.x[c];
        lanes s0 = unscale(&s, Dv, Dd, &s1), z0 = scale(&s, DT, minus, &z1);
        if (corrects) {
            store(p->corrector0, s0 * z0 + inner(s1, z1));
            for (int c = 0; c < 3; c++)
                store(p->corrector1[c], s0 * z1.x[c] + z0 * s1.x[c]);
        }
        lanes inverse = larger(inverse_room(p, s0, s1), inverse_room(p, z0, z1));
        most = larger(choose(cone, inverse, (lanes){0}), most);
    }
    return largest(most);
}

/* ---- move ---- */

void KERNEL(hf_path_move)(int n_block, hf_path_cables *block, double part)
{
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        lanes v = load(p->v), T = load(p->T);
        bits cone = has_cone(p);
        store(p->T_before, T);
        store(p->v, choose(cone, v + part * load(p->Dv), v));
        store(p->T, choose(cone, T + part * load(p->DT), T));
        for (int c = 0; c < 3; c++) {
            lanes t = load(p->t[c]);
            store(p->t[c], choose(cone, t + part * load(p->Dt[c]), t));
        }
    }
}

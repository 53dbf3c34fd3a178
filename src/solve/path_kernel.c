/* Computes the parts of the cables in a step of the primal-dual path, eight cables at a time. The file
 * is compiled once for each instruction set.
 *
 *     measure:        v, d, T, t  -> gap = T v - t.d, short_m = L + c T - v, t of springs
 *     set_scaling:    v, d, T, t  -> scaling W and scaled point lambda, stiffness K = along, across, unit (M21)
 *     set_side:       target of the product, second-order terms  -> R0, off, pull = K off
 *         (interior.c solves for the nodes and sets Dd)
 *     set_direction:  Dd  -> DT, Dv, Dt; the maximum part of the step; second-order terms
 *     move:           part of the step  -> v, T, t */
#define HF_LANE_EIGHT
#include "solve/path_kernel.h"

/* ---- eight cables ---- */

typedef struct {
    lanes x[3];
} vectors;

INLINE vectors load3(const double from[3][HF_LANES])
{
    return (vectors){{lanes_load(from[0]), lanes_load(from[1]), lanes_load(from[2])}};
}

INLINE void store3(double to[3][HF_LANES], const vectors *a)
{
    for (int c = 0; c < 3; c++)
        lanes_store(to[c], a->x[c]);
}

/* Returns the larger of a and b in each lane, as fmax does: a NaN gives the other. */
INLINE lanes larger(lanes a, lanes b)
{
    return lanes_choose((a >= b) | (b != b), a, b);
}

INLINE lanes size(lanes a)
{
    return lanes_choose(a < 0, -a, a);
}

INLINE lanes inner(vectors a, vectors b)
{
    return a.x[0] * b.x[0] + a.x[1] * b.x[1] + a.x[2] * b.x[2];
}

/* Returns the maximum positive lane of `a`, or 0. A NaN does not count. */
INLINE double largest(lanes a)
{
    double most = 0;
    for (int k = 0; k < HF_LANES; k++)
        if (a[k] > most) most = a[k];
    return most;
}

INLINE lanes_where has_cone(const hf_path_cables *p)
{
    return lanes_load(p->has_cone) != 0;
}

INLINE lanes_where has_multiplier(const hf_path_cables *p)
{
    return lanes_load(p->has_multiplier) != 0;
}

INLINE bool is_empty(const hf_path_cables *p)
{
    for (int k = 0; k < HF_LANES; k++)
        if (p->has_cone[k] != 0) return false;
    return true;
}

/* ---- errors ---- */

static double measure(int n_block, hf_path_cables *block)
{
    lanes most = {0};
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        vectors d = load3(p->d), t = load3(p->t);
        lanes T = lanes_load(p->T), v = lanes_load(p->v), along = lanes_load(p->along), target = lanes_load(p->target);
        lanes_where cone = has_cone(p);
        for (int c = 0; c < 3; c++)
            t.x[c] = lanes_choose(cone, t.x[c], along * d.x[c]);
        store3(p->t, &t);
        lanes_store(p->gap, T * v - inner(t, d));
        lanes over = target + target * T / lanes_load(p->EA) - v;
        lanes_store(p->short_m, lanes_choose(has_multiplier(p), over, (lanes){0}));
        most =
            larger(lanes_choose(has_multiplier(p) & cone, size(over) / lanes_load(p->theoretical), (lanes){0}), most);
    }
    return largest(most);
}

/* ---- the cone ---- */

/* Returns the root of the determinant a0^2 - |a1|^2 of a point in the cone. It is never zero. */
INLINE lanes root_det(lanes a0, vectors a1)
{
    lanes length = lanes_root(inner(a1, a1)), det = (a0 - length) * (a0 + length), least = (lanes){0} + 1e-300;
    return lanes_root(larger(det, least));
}

typedef struct {
    lanes eta, w0;
    vectors w1;
} scaling;

INLINE scaling scaling_of(const hf_path_cables *p)
{
    return (scaling){lanes_root(lanes_load(p->eta2)), lanes_load(p->w0), load3(p->w1)};
}

/* Computes b = W a: sets the vector part b1 and returns b0. */
INLINE lanes scale(const scaling *s, lanes a0, vectors a1, vectors *b1)
{
    lanes along = inner(s->w1, a1), share = a0 + along / (1 + s->w0);
    for (int c = 0; c < 3; c++)
        b1->x[c] = s->eta * (a1.x[c] + share * s->w1.x[c]);
    return s->eta * (s->w0 * a0 + along);
}

/* Computes b = W^-1 a: sets the vector part b1 and returns b0. */
INLINE lanes unscale(const scaling *s, lanes a0, vectors a1, vectors *b1)
{
    lanes along = inner(s->w1, a1), share = along / (1 + s->w0) - a0;
    for (int c = 0; c < 3; c++)
        b1->x[c] = (a1.x[c] + share * s->w1.x[c]) / s->eta;
    return (s->w0 * a0 - along) / s->eta;
}

/* Returns K a. */
INLINE vectors times_K(const hf_path_cables *p, vectors a)
{
    lanes across = lanes_load(p->across);
    vectors unit = load3(p->unit), b;
    lanes more = (lanes_load(p->along) - across) * inner(unit, a);
    for (int c = 0; c < 3; c++)
        b.x[c] = across * a.x[c] + more * unit.x[c];
    return b;
}

/* ---- scaling ---- */

INLINE void set_stiffness(hf_path_cables *p, lanes eta2, vectors w1)
{
    lanes square = inner(w1, w1), A = 1 + 2 * square, length = lanes_root(square), flex = lanes_load(p->flex);
    lanes taut = (eta2 * A + flex) / (eta2 * (eta2 + flex * A)), given = 1 / (eta2 * A);
    lanes_where cone = has_cone(p);
    lanes_store(p->across, lanes_choose(cone, 1 / eta2, lanes_load(p->across)));
    lanes_store(p->along, lanes_choose(cone, lanes_choose(has_multiplier(p), taut, given), lanes_load(p->along)));
    for (int c = 0; c < 3; c++)
        lanes_store(p->unit[c], lanes_choose(cone & (length > 0), w1.x[c] / length, (lanes){0}));
}

static void set_scaling(int n_block, hf_path_cables *block)
{
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        lanes v = lanes_load(p->v), T = lanes_load(p->T);
        vectors d = load3(p->d), t = load3(p->t), s1, z1, w1, lambda1;
        lanes s = root_det(v, d), z = root_det(T, t), s0 = v / s, z0 = T / z;
        for (int c = 0; c < 3; c++) {
            s1.x[c] = d.x[c] / s;
            z1.x[c] = -t.x[c] / z;
        }
        lanes gamma = lanes_root((1 + s0 * z0 + inner(s1, z1)) / 2), eta2 = s / z, det = lanes_root(s * z);
        for (int c = 0; c < 3; c++) {
            w1.x[c] = (s1.x[c] - z1.x[c]) / (2 * gamma);
            lambda1.x[c] = det * ((gamma + z0) * s1.x[c] + (gamma + s0) * z1.x[c]) / (s0 + z0 + 2 * gamma);
        }
        lanes_store(p->eta2, eta2);
        lanes_store(p->det, det);
        lanes_store(p->w0, (s0 + z0) / (2 * gamma));
        store3(p->w1, &w1);
        lanes_store(p->lambda0, gamma * det);
        store3(p->lambda1, &lambda1);
        set_stiffness(p, eta2, w1);
    }
}

/* ---- right-hand side ---- */

static void set_side(int n_block, hf_path_cables *block, double target, bool corrected)
{
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        scaling s = scaling_of(p);
        vectors l1 = load3(p->lambda1), r1, q1, R1, off, pull;
        lanes l0 = lanes_load(p->lambda0), det = lanes_load(p->det), eta2 = lanes_load(p->eta2);
        lanes r0 = target * lanes_load(p->weight) - l0 * l0 - inner(l1, l1);
        for (int c = 0; c < 3; c++)
            r1.x[c] = -2 * l0 * l1.x[c];
        if (corrected) {
            r0 -= lanes_load(p->corrector0);
            for (int c = 0; c < 3; c++)
                r1.x[c] -= lanes_load(p->corrector1[c]);
        }
        lanes q0 = (l0 * r0 - inner(l1, r1)) / (det * det); /* solves lambda o q = r */
        for (int c = 0; c < 3; c++)
            q1.x[c] = (r1.x[c] - q0 * l1.x[c]) / l0;
        lanes R0 = scale(&s, q0, q1, &R1);
        lanes a = eta2 * (2 * s.w0 * s.w0 - 1), b = 2 * eta2 * s.w0;
        lanes share = b * (R0 - lanes_load(p->short_m)) / (a + lanes_load(p->flex));
        share = lanes_choose(has_multiplier(p), share, (lanes){0});
        for (int c = 0; c < 3; c++)
            off.x[c] = share * s.w1.x[c] - R1.x[c];
        lanes_store(p->R0, R0);
        store3(p->off, &off);
        pull = times_K(p, off);
        store3(p->pull, &pull);
    }
}

/* ---- direction and distance to the boundary ---- */

/* Returns the reciprocal of the maximum part of the scaled direction a that keeps the scaled point in its cone. A value
 * <= 0 means that every part does. */
INLINE lanes inverse_room(const hf_path_cables *p, lanes a0, vectors a1)
{
    lanes det = lanes_load(p->det), l0 = lanes_load(p->lambda0) / det;
    vectors l1 = load3(p->lambda1), r1;
    for (int c = 0; c < 3; c++)
        l1.x[c] /= det;
    lanes r0 = l0 * a0 - inner(l1, a1), share = (r0 + a0) / (l0 + 1);
    for (int c = 0; c < 3; c++)
        r1.x[c] = a1.x[c] - share * l1.x[c];
    return (lanes_root(inner(r1, r1)) - r0) / det;
}

static double set_direction(int n_block, hf_path_cables *block, bool corrects)
{
    lanes most = {0};
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        scaling s = scaling_of(p);
        vectors Dd = load3(p->Dd), off = load3(p->off), y, minus, s1, z1;
        lanes eta2 = lanes_load(p->eta2), short_m = lanes_load(p->short_m), R0 = lanes_load(p->R0),
              flex = lanes_load(p->flex);
        lanes_where cone = has_cone(p), multiplier = has_multiplier(p);
        for (int c = 0; c < 3; c++)
            y.x[c] = Dd.x[c] + off.x[c];
        vectors Dt = times_K(p, y);
        lanes a = eta2 * (2 * s.w0 * s.w0 - 1), turned = 2 * eta2 * s.w0 * inner(s.w1, Dt);
        lanes DT = lanes_choose(multiplier, (R0 - short_m + turned) / (a + flex), (lanes){0});
        lanes Dv = lanes_choose(multiplier, flex * DT + short_m, R0 - a * DT + turned);
        lanes_store(p->DT, DT);
        lanes_store(p->Dv, Dv);
        store3(p->Dt, &Dt);
        for (int c = 0; c < 3; c++)
            minus.x[c] = -Dt.x[c];
        lanes s0 = unscale(&s, Dv, Dd, &s1), z0 = scale(&s, DT, minus, &z1);
        if (corrects) {
            lanes_store(p->corrector0, s0 * z0 + inner(s1, z1));
            for (int c = 0; c < 3; c++)
                lanes_store(p->corrector1[c], s0 * z1.x[c] + z0 * s1.x[c]);
        }
        lanes inverse = larger(inverse_room(p, s0, s1), inverse_room(p, z0, z1));
        most = larger(lanes_choose(cone, inverse, (lanes){0}), most);
    }
    return largest(most);
}

/* ---- move ---- */

static void move(int n_block, hf_path_cables *block, double part)
{
    for (hf_path_cables *p = block; p < block + n_block; p++) {
        if (is_empty(p)) continue;
        lanes v = lanes_load(p->v), T = lanes_load(p->T);
        lanes_where cone = has_cone(p);
        lanes_store(p->T_before, T);
        lanes_store(p->v, lanes_choose(cone, v + part * lanes_load(p->Dv), v));
        lanes_store(p->T, lanes_choose(cone, T + part * lanes_load(p->DT), T));
        for (int c = 0; c < 3; c++) {
            lanes t = lanes_load(p->t[c]);
            lanes_store(p->t[c], lanes_choose(cone, t + part * lanes_load(p->Dt[c]), t));
        }
    }
}

const hf_path_kernels HF_KERNEL(hf_path_kernels) = {measure, set_scaling, set_side, set_direction, move};

/* Computes what a case leaves open about a feed, and its field:
 *
 *     case, facets -> kind, position, aim -> axis, polarisation, beam -> taper -> scale of the gain
 *     point -> direction, path, field; rates of the field
 *
 * Contents: the field - what a case leaves open - together */
#include "surface/pattern_feed.h"

#include "base/elementary.h"
#include "net/target_surface.h"
#include "surface/facet_mesh.h"

#include <math.h>
#include <string.h>

#define EDGE_FIELD_LN (-0.5 * 2.30258509299404568402) /* natural logarithm of the field ratio of -10 dB */
#define POWER_MOST 1e4                                /* maximum power of the cosine; its beam is about 1 degree wide */

/* ---- the field ---- */

/* Returns c^q, or 0 if it is negligible. */
static double power(double c, double q)
{
    if (!(c > 0)) return 0;
    double exponent = q * hf_logarithm(c) / HF_LN_2;
    return exponent > -900 ? hf_power_of_two(exponent) : 0;
}

/* Returns the size of the field at an angle with this cosine from the axis. */
static double size_of(const hf_feed *f, double cosine, double path_m)
{
    return power(cosine, f->cos_power) / (f->kind == HF_FEED_LINE ? sqrt(path_m) : path_m);
}

/* The field of a point source is polarised along x or y on the axis and turned without twist to the other directions
 * (Ludwig's third definition). The field of a line source is polarised along the line or across it. */
double hf_feed_light(const hf_feed *f, const double p[3], double toward[3], double field[3])
{
    double along[3] = {0, 1, 0}, size = 1, path_m;
    for (int d = 0; d < 3; d++)
        toward[d] = f->kind == HF_FEED_PLANE_WAVE ? f->axis[d] : p[d] - f->position_m[d];
    if (f->kind == HF_FEED_PLANE_WAVE) {
        path_m = hf_dot3(p, f->axis);
    } else {
        if (f->kind == HF_FEED_LINE) toward[1] = 0;
        path_m = hf_norm(toward[0], toward[1], toward[2]);
        for (int d = 0; d < 3; d++)
            toward[d] /= path_m;
        size = size_of(f, hf_dot3(toward, f->axis), path_m);
    }
    if (f->kind == HF_FEED_LINE && f->co[1] == 0) hf_cross(toward, (const double[3]){0, 1, 0}, along);
    double turn = hf_dot3(f->co, toward) / (1 + hf_dot3(f->axis, toward));
    for (int d = 0; d < 3 && f->kind != HF_FEED_LINE && size > 0; d++)
        along[d] = f->co[d] - turn * (f->axis[d] + toward[d]);
    hf_cross(toward, along, field);
    for (int d = 0; d < 3; d++)
        field[d] *= size;
    return path_m;
}

/* With t = toward, axis a and polarisation c: field = size t x along, and t x along = t x c - turn t x a. */
void hf_feed_light_rate(const hf_feed *f, const double p[3], const double move[3], double field_rate[3])
{
    double t[3], field[3], dt[3], one[3], other[3];
    double path_m = hf_feed_light(f, p, t, field), longer_m = hf_dot3(t, move), cosine = hf_dot3(t, f->axis);
    memset(field_rate, 0, 3 * sizeof *field_rate);
    if (f->kind == HF_FEED_PLANE_WAVE || !(cosine > 0)) return;
    for (int d = 0; d < 3; d++)
        dt[d] = f->kind == HF_FEED_LINE && d == 1 ? 0 : (move[d] - longer_m * t[d]) / path_m;
    double size = size_of(f, cosine, path_m);
    double grow =
        f->cos_power * hf_dot3(dt, f->axis) / cosine - (f->kind == HF_FEED_LINE ? 0.5 : 1) * longer_m / path_m;
    hf_cross(dt, (const double[3]){0, f->co[1] != 0, 0}, one); /* line source: a field across it keeps its direction */
    if (f->kind != HF_FEED_LINE) {
        double down = 1 + hf_dot3(f->axis, t), turn = hf_dot3(f->co, t) / down;
        double turn_rate = (hf_dot3(f->co, dt) - turn * hf_dot3(f->axis, dt)) / down;
        hf_cross(dt, f->co, one);
        hf_cross(dt, f->axis, other);
        for (int d = 0; d < 3; d++)
            one[d] -= turn * other[d];
        hf_cross(t, f->axis, other);
        for (int d = 0; d < 3; d++)
            one[d] -= turn_rate * other[d];
    }
    for (int d = 0; d < 3; d++)
        field_rate[d] = grow * field[d] + size * one[d];
}

/* Returns the integral of cos^(2q) from -pi/2 to pi/2, sqrt(pi) Gamma(q + 1/2)/Gamma(q + 1). The recurrence leads to q
 * above 40, where the series of the quotient of the Gamma functions has an error below 1e-14. */
static double half_circle(double q)
{
    double factor = 1;
    for (; q < 40; q++)
        factor *= (2 * q + 2) / (2 * q + 1);
    double x = 1 / q;
    return factor * sqrt(HF_PI * x) *
           (1 + x * (-1.0 / 8 + x * (1.0 / 128 + x * (5.0 / 1024 + x * (-21.0 / 32768 - x * 399.0 / 262144)))));
}

/* ---- what a case leaves open ---- */

/* Computes the extent of the corners of the facets, m. */
static void extent(const hf_facets *f, const double *position_m, double low[3], double high[3])
{
    for (int d = 0; d < 3; d++) {
        low[d] = INFINITY;
        high[d] = -INFINITY;
        for (int k = 0; k < 4 * f->n_facet; k++) {
            double x = position_m[3 * (size_t)f->corner[k] + (size_t)d];
            low[d] = fmin(low[d], x);
            high[d] = fmax(high[d], x);
        }
    }
}

/* Computes the axis towards `aim`, and the polarisation across it. */
static void look(const hf_pattern_settings *s, const double aim_m[3], hf_feed *f)
{
    double size = 0, part;
    for (int d = 0; d < 3; d++)
        f->axis[d] = f->kind == HF_FEED_PLANE_WAVE ? -(d == 2) : aim_m[d] - f->position_m[d];
    if (f->kind == HF_FEED_LINE) f->axis[1] = 0;
    size = hf_norm(f->axis[0], f->axis[1], f->axis[2]);
    for (int d = 0; d < 3; d++)
        f->axis[d] /= size;
    int along = s->polarisation == HF_POLARISATION_Y;
    if (fabs(f->axis[along]) > 0.999) along = 2; /* the feed looks along its own polarisation */
    part = f->axis[along];
    for (int d = 0; d < 3; d++)
        f->co[d] = ((d == along) - part * f->axis[d]) / sqrt(1 - part * part);
    if (f->kind == HF_FEED_LINE)
        memcpy(f->co, s->polarisation ? (double[3]){0, 1, 0} : (double[3]){1, 0, 0}, sizeof f->co);
}

/* Returns the power of the cosine at which the field at the outermost corner is 10 dB below that on the axis, apart
 * from the distance. */
static double tapered(const hf_feed *f, const hf_facets *facets, const double *position_m)
{
    double least = 1, toward[3], field[3];
    for (int k = 0; k < 4 * facets->n_facet; k++) {
        hf_feed_light(f, position_m + 3 * (size_t)facets->corner[k], toward, field);
        least = fmin(least, hf_dot3(toward, f->axis));
    }
    if (!(least > 0)) return 1;
    double q = least < 1 ? EDGE_FIELD_LN / hf_logarithm(least) : POWER_MOST;
    return fmin(q, POWER_MOST);
}

/* Returns the projected area of a facet that a wave along -z meets, m2. Returns 0 if the middle of the facet shows its
 * back, as in `sees`. */
static double met_area(const hf_facets *facets, int i, const double *position_m)
{
    const int *c = facets->corner + 4 * (size_t)i;
    const double *p[4];
    for (int k = 0; k < 4; k++)
        p[k] = position_m + 3 * (size_t)c[k];
    return fmax(((p[2][0] - p[0][0]) * (p[3][1] - p[1][1]) - (p[3][0] - p[1][0]) * (p[2][1] - p[0][1])) / 2, 0);
}

/* Returns the factor between |N|^2 / wavelength^2 and the gain (M44). Area without current has no share of the power,
 * so gains stay below 4 pi area/lambda^2. */
static double scale_of(const hf_feed *f, const hf_facets *facets, const double *position_m)
{
    double low[3], high[3], area = 0;
    extent(facets, position_m, low, high);
    if (f->kind == HF_FEED_POINT) return (2 * f->cos_power + 1) / 2;
    if (f->kind == HF_FEED_LINE) return HF_PI / ((high[1] - low[1]) * half_circle(f->cos_power));
    for (int i = 0; i < facets->n_facet; i++)
        area += met_area(facets, i, position_m);
    return HF_PI / area;
}

/* Computes the beam: the ray to the point of the target surface above or below `aim`, reflected there. */
static void send_beam(const hf_surface_settings *s, const double aim_m[3], hf_feed *f)
{
    double p[3] = {aim_m[0], aim_m[1], 0}, toward[3], field[3], slope[2];
    p[2] = -hf_target_surface_height_above(s->kind, 1 / (4 * s->focal_length_m), p, slope);
    hf_feed_light(f, p, toward, field);
    const double up[3] = {-slope[0], -slope[1], 1};
    double part = 2 * hf_dot3(toward, up) / hf_dot3(up, up);
    for (int d = 0; d < 3; d++)
        f->beam[d] = toward[d] - part * up[d];
}

/* ---- together ---- */

static bool sees(const hf_feed *f, const hf_facets *facets, int i, const double *position_m)
{
    hf_facet_mesh m;
    double p[3], du[3], dv[3], up[3], toward[3], field[3];
    hf_facet_mesh_take(facets, i, position_m, &m);
    hf_facet_mesh_at(&m, 0.5, 0.5, p, du, dv);
    hf_cross(du, dv, up);
    hf_feed_light(f, p, toward, field);
    return hf_dot3(toward, up) < 0 && hf_dot3(toward, f->axis) > 0;
}

int hf_feed_make(const hf_surface_settings *s, const hf_facets *facets, const double *position_m, hf_feed *feed)
{
    const hf_pattern_settings *want = &s->pattern;
    const double curvature = 1 / (4 * s->focal_length_m);
    double low[3], high[3], aim_m[3], slope[2];
    bool is_cylinder = s->kind == HF_SURFACE_PARABOLIC_CYLINDER;
    *feed = (hf_feed){.kind = want->feed, .position_m = {0, 0, s->focal_length_m}, .cos_power = want->cos_power};
    if (feed->kind == HF_FEED_AUTO) feed->kind = is_cylinder ? HF_FEED_LINE : HF_FEED_POINT;
    extent(facets, position_m, low, high);
    for (int d = 0; d < 2; d++)
        aim_m[d] = (low[d] + high[d]) / 2;
    aim_m[2] = 0;
    aim_m[2] = -hf_target_surface_height_above(s->kind, curvature, aim_m, slope);
    if (is_cylinder) feed->position_m[1] = aim_m[1];
    if (!isnan(want->position_m[0])) memcpy(feed->position_m, want->position_m, sizeof feed->position_m);
    if (!isnan(want->aim_m[0])) memcpy(aim_m, want->aim_m, sizeof aim_m);
    look(want, aim_m, feed);
    send_beam(s, aim_m, feed);
    if (isnan(feed->cos_power)) {
        feed->cos_power = 0;
        if (feed->kind != HF_FEED_PLANE_WAVE) feed->cos_power = tapered(feed, facets, position_m);
    }
    feed->scale = scale_of(feed, facets, position_m);
    int n_dark = 0;
    for (int i = 0; i < facets->n_facet; i++)
        n_dark += !sees(feed, facets, i, position_m);
    return n_dark;
}

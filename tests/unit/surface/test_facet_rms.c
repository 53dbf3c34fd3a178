/* RMS over facets: integrals by hand, the published formula under refinement, the order of convergence. */
#include "nets.h"

#include "surface/facet_mesh.h"

/* ---- a triangular net over a hexagon ---- */

/* Node (i, j) of a triangular grid is at i (1, 0) + j (1/2, sqrt(3)/2), those with |i|, |j|, |i + j| <= rings are in.
 *  */
static int index_of(int rings, int i, int j)
{
    static int place[129][129];
    static int of = 0;
    if (of != rings) {
        memset(place, -1, sizeof place);
        for (int b = -rings, n = 0; b <= rings; b++)
            for (int a = -rings; a <= rings; a++)
                if (abs(a + b) <= rings) place[b + 64][a + 64] = n++;
        of = rings;
    }
    return abs(i) > rings || abs(j) > rings || abs(i + j) > rings ? -1 : place[j + 64][i + 64];
}

/* All nodes on z = (x^2 + y^2)/(4f); the hexagon has this radius, the rim is fixed. */
static void open_hexagon(struct net *net, int rings, double radius_m, double focal_length_m)
{
    static const int step[3][2] = {{1, 0}, {0, 1}, {-1, 1}};
    int n_node = 3 * rings * (rings + 1) + 1, n_cable = 3 * rings * (3 * rings + 1), e = 0;
    double l = radius_m / rings;
    *net = (struct net){.form = tight_form(HF_METHOD_FDM)};
    ck_assert_int_eq(hf_scene_allocate(&net->scene, n_node, n_cable, false, false, false), HF_OK);
    for (int j = -rings; j <= rings; j++)
        for (int i = -rings; i <= rings; i++) {
            int at = index_of(rings, i, j);
            if (at < 0) continue;
            double *p = net->scene.position_m + 3 * at;
            p[0] = l * (i + 0.5 * j);
            p[1] = l * sqrt(0.75) * j;
            p[2] = (p[0] * p[0] + p[1] * p[1]) / (4 * focal_length_m);
            bool is_rim = abs(i) == rings || abs(j) == rings || abs(i + j) == rings;
            net->scene.role[at] = is_rim ? HF_ROLE_SUPPORT : HF_ROLE_INNER;
            net->scene.node_id[at] = "n";
            for (int k = 0; k < 3; k++) {
                int to = index_of(rings, i + step[k][0], j + step[k][1]);
                if (to < 0) continue;
                net->scene.end[2 * e] = at;
                net->scene.end[2 * e + 1] = to;
                net->scene.law[e] = HF_LAW_FORCE_DENSITY;
                net->scene.target[e] = 1;
                net->scene.cable_id[e++] = "c";
            }
        }
    ck_assert_int_eq(e, n_cable);
    open_net(net);
    memcpy(net->work.position_m, net->model.position_m, 3 * (size_t)n_node * sizeof(double));
}

/* As hf_surface_measure calls it. */
static hf_status measure(const hf_surface_settings *s, const hf_facets *f, const struct net *net,
                         hf_surface_measures *to)
{
    double *position_m = malloc(3 * (size_t)net->model.n_node * sizeof *position_m);
    for (int i = 0; i < net->model.n_node; i++)
        for (int c = 0; c < 3; c++)
            position_m[3 * i + c] = net->work.position_m[c * net->model.n_node + net->model.row_of_node[i]];
    const hf_facet_shape shape = {.position_m = position_m};
    hf_status status = hf_facet_measure(s, f, &shape, to);
    free(position_m);
    return status;
}

static hf_surface_measures measured_of(struct net *net, const hf_surface_settings *s)
{
    hf_facets f;
    hf_surface_measures to = {0};
    ck_assert_int_eq(hf_facets_find(&net->scene, s, &f), HF_OK);
    ck_assert(f.is_planar);
    ck_assert_int_eq(measure(s, &f, net, &to), HF_OK);
    hf_facets_free(&f);
    return to;
}

/* Triangles of side l on a paraboloid: l^2/(16 sqrt(15) f) after the best fit. The aperture is a thousandth of f, so
 * that slopes, whose squares the formula leaves out, are 3e-4. Triangles are all alike, so that the fit takes their
 * mean l^2/(16 f) away; on few of them it takes a little more. */
START_TEST(triangles_have_the_error_of_the_formula)
{
    const double f = 1000, radius = 0.5;
    const hf_surface_settings s = {.focal_length_m = f, .kind = HF_SURFACE_PARABOLOID};
    double off = 0;
    for (int rings = 2; rings <= 16; rings *= 2) {
        double l = radius / rings, formula = l * l / (16 * sqrt(15) * f), mean = l * l / (16 * f);
        struct net net;
        open_hexagon(&net, rings, radius, f);
        hf_surface_measures m = measured_of(&net, &s);
        off = m.facet_fit_half_path_rms_m / formula - 1;
        ck_assert_int_eq(m.n_facet, 6 * rings * rings);
        ck_assert_int_eq(m.n_open_face, 0);
        ck_assert_double_eq_tol(m.facet_area_m2, 1.5 * sqrt(3) * radius * radius, 1e-13);
        ck_assert_double_eq_tol(m.facet_half_path_rms_m, sqrt(formula * formula + mean * mean), 1e-6 * mean);
        ck_assert_double_le(fabs(off), 0.05 / rings);
        close_net(&net);
    }
    ck_assert_double_lt(fabs(off), 0.5e-4);
}
END_TEST

/* A deep paraboloid, f/D = 0.35: the errors fall with the square of the side of the triangles. */
START_TEST(errors_fall_with_the_square_of_the_side)
{
    const hf_surface_settings s = {.focal_length_m = 0.7, .kind = HF_SURFACE_PARABOLOID};
    double before[4] = {0};
    for (int rings = 4; rings <= 32; rings *= 2) {
        struct net net;
        open_hexagon(&net, rings, 1, s.focal_length_m);
        hf_surface_measures m = measured_of(&net, &s);
        const double now[4] = {m.facet_half_path_rms_m, m.facet_normal_rms_m, m.facet_fit_half_path_rms_m,
                               m.facet_fit_normal_rms_m};
        for (int k = 0; k < 4; k++) {
            if (rings > 4) ck_assert_double_eq_tol(log2(before[k] / now[k]), 2, 0.2 / rings);
            before[k] = now[k];
        }
        close_net(&net);
    }
}
END_TEST

/* Errors of each facet: on equal triangles of a shallow paraboloid the mean is l^2/(16 f) and the RMS is that of all;
 * after the best fit, which takes the mean away, the squares add up to that of all as well. */
START_TEST(errors_of_each_facet_make_that_of_all)
{
    const double f = 1000, radius = 0.5, l = radius / 8;
    const hf_surface_settings s = {.focal_length_m = f, .kind = HF_SURFACE_PARABOLOID};
    struct net net;
    hf_facets facets;
    open_hexagon(&net, 8, radius, f);
    hf_surface_measures all = measured_of(&net, &s);
    ck_assert_int_eq(hf_facets_find(&net.scene, &s, &facets), HF_OK);
    int n = facets.n_facet;
    double *value = malloc(4 * (size_t)n * sizeof *value), square = 0;
    const hf_facet_shape shape = {.position_m = net.scene.position_m};
    const hf_facet_errors e = {value, value + n, value + 2 * n, value + 3 * n};
    ck_assert_int_eq(hf_facet_map(&s, &facets, &shape, &e), HF_OK);
    for (int i = 0; i < n; i++) {
        ck_assert_double_eq_tol(e.normal_mean_m[i] / (l * l / (16 * f)), 1, 1e-6);
        ck_assert_double_eq_tol(e.normal_rms_m[i] / all.facet_normal_rms_m, 1, 1e-6);
        ck_assert_double_le(fabs(e.fit_normal_mean_m[i]), 0.05 * e.fit_normal_rms_m[i]);
        square += e.fit_normal_rms_m[i] * e.fit_normal_rms_m[i] / n;
    }
    ck_assert_double_eq_tol(sqrt(square) / all.facet_fit_normal_rms_m, 1, 1e-9);
    free(value);
    hf_facets_free(&facets);
    close_net(&net);
}
END_TEST

/* On triangles with cables of one tension T the mesh makes the error after the fit grow by 1 + 0.3298 N l / T, 0.33 in
 * Agrawal, Anderson, Card (NASA TP-1605); seen at a facet in the middle, the others around it being alike. With w0 the
 * height of the flat facet and phi that of a membrane under pressure, the coefficient is (1 - <w0, phi>/(f <w0, w0>))
 * / sqrt(3) for heights less their means. */
START_TEST(mesh_makes_the_error_grow)
{
    enum { RINGS = 8 };
    const double f = 1000, radius = 0.5, l = radius / RINGS;
    hf_surface_settings s = {.focal_length_m = f, .kind = HF_SURFACE_PARABOLOID};
    struct net net;
    hf_facets facets;
    open_hexagon(&net, RINGS, radius, f);
    ck_assert_int_eq(hf_facets_find(&net.scene, &s, &facets), HF_OK);
    size_t n = (size_t)facets.n_facet;
    double *value = malloc(4 * n * sizeof *value), *tension_N = malloc((size_t)net.scene.n_cable * sizeof *tension_N);
    for (int e = 0; e < net.scene.n_cable; e++)
        tension_N[e] = 10;
    const hf_facet_shape shape = {net.scene.position_m, net.scene.n_cable, net.scene.end, tension_N, NULL};
    const hf_facet_errors e = {value, value + n, value + 2 * n, value + 3 * n};
    int middle = 0, centre = index_of(RINGS, 0, 0);
    while (facets.corner[4 * middle] != centre)
        middle++;
    double scatter[3];
    for (int k = 0; k < 3; k++) {
        s.mesh_tension_N_per_m = k * 1e-3 * 10 / l; /* N l / T = 0, 0.001, 0.002 */
        ck_assert_int_eq(hf_facet_map(&s, &facets, &shape, &e), HF_OK);
        double mean = e.normal_mean_m[middle], rms = e.normal_rms_m[middle];
        scatter[k] = sqrt(rms * rms - mean * mean);
    }
    for (int k = 1; k < 3; k++)
        ck_assert_double_eq_tol((scatter[k] / scatter[0] - 1) / (k * 1e-3), 0.3298, 4e-4);
    free(value);
    free(tension_N);
    hf_facets_free(&facets);
    close_net(&net);
}
END_TEST

/* Facets of a net that is a little off have from the fit of the design the RMS values of the reference, also under a
 * mesh; and none where the mesh has no shape. */
START_TEST(facets_near_those_of_the_design)
{
    enum { RINGS = 5 };
    hf_surface_settings s = {.focal_length_m = 4, .kind = HF_SURFACE_PARABOLOID};
    struct net net;
    hf_facets facets;
    hf_surface_fit fit;
    hf_fit_parameters parameters;
    hf_surface_measures all = {0};
    struct rng rng = rng_start(470);
    double path, fit_path;
    open_hexagon(&net, RINGS, 3, 4);
    ck_assert_int_eq(hf_facets_find(&net.scene, &s, &facets), HF_OK);
    double *tension_N = malloc((size_t)net.scene.n_cable * sizeof *tension_N);
    for (int e = 0; e < net.scene.n_cable; e++)
        tension_N[e] = 10;
    const hf_facet_shape shape = {net.scene.position_m, net.scene.n_cable, net.scene.end, tension_N, NULL};
    s.mesh_tension_N_per_m = _i ? 0.1 : 0;
    ck_assert_int_eq(hf_facet_fit(&s, &facets, &shape, &fit, &parameters), HF_OK);
    hf_surface_pose pose = hf_surface_pose_of(s.kind, s.focal_length_m, &fit, &parameters);
    ck_assert(pose.n == HF_FIT_N_PARAMETER);
    for (int k = 0; k < 3 * net.scene.n_node; k++)
        net.scene.position_m[k] += rng_uniform(&rng, -1e-3, 1e-3);
    ck_assert_int_eq(hf_facet_measure(&s, &facets, &shape, &all), HF_OK);
    ck_assert_int_eq(hf_facet_measure_near(&pose, &s, &facets, &shape, &path, &fit_path), HF_OK);
    ck_assert_double_eq(path, all.facet_half_path_rms_m);
    ck_assert_double_eq_tol(fit_path, all.facet_fit_half_path_rms_m, 1e-9 * fit_path);
    ck_assert_double_lt(fit_path, 0.9 * path);
    memset(tension_N, 0, (size_t)net.scene.n_cable * sizeof *tension_N);
    ck_assert_int_eq(hf_facet_measure_near(&pose, &s, &facets, &shape, &path, &fit_path), HF_OK);
    ck_assert(isnan(path) == (_i == 1) && isnan(fit_path) == (_i == 1));
    free(tension_N);
    hf_facets_free(&facets);
    close_net(&net);
}
END_TEST

/* ---- by hand ---- */

/* The triangle (0,0), (1,0), (0,1) in the plane z = 0 below the paraboloid c (x^2 + y^2): the mean of the square of the
 * height is c^2 times (1/30 + 1/90 + 1/90 + 1/30 ... of x^4 + 2 x^2 y^2 + y^4) = 7/45. The unit square with one corner
 * at z = k below the cylinder c x^2, its surface k x y: k^2/9 - k c/4 + c^2/5. f = 1e5 m: slopes of 5e-6, which are
 * nothing. */
START_TEST(integrals_are_exact)
{
    static const double xy[2][4][2] = {{{0, 0}, {1, 0}, {0, 1}, {0, 0}}, {{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    const double f = 1e5, c = 1 / (4 * f), k = _i ? 1e-5 : 0;
    const double square = _i ? k * k / 9 - k * c / 4 + c * c / 5 : 7 * c * c / 45;
    const hf_surface_settings s = {.focal_length_m = f,
                                   .kind = _i ? HF_SURFACE_PARABOLIC_CYLINDER : HF_SURFACE_PARABOLOID};
    int n = 3 + _i;
    struct net net = {.form = tight_form(HF_METHOD_FDM)};
    ck_assert_int_eq(hf_scene_allocate(&net.scene, n, n, false, false, false), HF_OK);
    for (int i = 0; i < n; i++) {
        memcpy(net.scene.position_m + 3 * i, xy[_i][i], sizeof xy[_i][i]);
        net.scene.position_m[3 * i + 2] = _i && i == 2 ? k : 0;
        net.scene.role[i] = i == 2 ? HF_ROLE_INNER : HF_ROLE_SUPPORT;
        net.scene.end[2 * i] = i;
        net.scene.end[2 * i + 1] = (i + 1) % n;
        net.scene.law[i] = HF_LAW_FORCE_DENSITY;
        net.scene.target[i] = 1;
        net.scene.node_id[i] = net.scene.cable_id[i] = "x";
    }
    open_net(&net);
    memcpy(net.work.position_m, net.model.position_m, 3 * (size_t)n * sizeof(double));
    hf_facets facets = {.n_facet = 1, .is_planar = true, .corner = (int[]){0, 1, 2, _i ? 3 : 2}};
    hf_surface_measures m = {0};
    ck_assert_int_eq(measure(&s, &facets, &net, &m), HF_OK);
    ck_assert_double_eq_tol(m.facet_area_m2, _i ? 1 : 0.5, 1e-15);
    ck_assert_double_eq_tol(m.facet_normal_rms_m / sqrt(square), 1, 1e-10);
    ck_assert_double_eq_tol(m.facet_half_path_rms_m / sqrt(square), 1, 1e-10);
    facets.n_facet = 0;
    ck_assert_int_eq(measure(&s, &facets, &net, &m), HF_OK);
    ck_assert_double_nan(m.facet_half_path_rms_m);
    ck_assert_double_nan(m.facet_fit_half_path_rms_m);
    close_net(&net);
}
END_TEST

/* N l over no tension, or over what rounding leaves of one. */
START_TEST(a_pull_on_nothing_is_no_number)
{
    char text[64];
    ck_assert_str_eq(hf_facet_mesh_pull_words(0.4, text), "a cable with N l = 0.4 of its tension");
    ck_assert_str_eq(hf_facet_mesh_pull_words(INFINITY, text), "a slack cable");
    ck_assert_str_eq(hf_facet_mesh_pull_words(1e14, text), "a slack cable");
}
END_TEST

Suite *suite_unit_facet_rms(void)
{
    Suite *suite = suite_create("unit/facet_rms");
    TCase *tests = tcase_create("facet_rms");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, triangles_have_the_error_of_the_formula);
    tcase_add_test(tests, errors_fall_with_the_square_of_the_side);
    tcase_add_test(tests, errors_of_each_facet_make_that_of_all);
    tcase_add_test(tests, mesh_makes_the_error_grow);
    tcase_add_test(tests, a_pull_on_nothing_is_no_number);
    tcase_add_loop_test(tests, facets_near_those_of_the_design, 0, 2);
    tcase_add_loop_test(tests, integrals_are_exact, 0, 2);
    return suite;
}

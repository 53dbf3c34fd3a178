/* Studies: what axes mean, which points they give, and that a point keeps its name when values are added to an axis. */
#include "case/study.h"

#include "support.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char BASE[] = "title: small\n"
                           "scene:\n"
                           "  parabolic_cylinder: {aperture_m: 2, length_m: 3, focal_length_m: 2, modules: [2, 3], "
                           "cells_per_module: [2, 2]}\n";

static char said[8192];

/* A study file beside base.yaml with these axes. */
static hf_status read_study(const char *axes, hf_study *study)
{
    char text[4096];
    hf_messages messages = {0};
    write_file(temp_path("base.yaml"), BASE);
    snprintf(text, sizeof text, "base: base.yaml\nsweep:\n%s", axes);
    write_file(temp_path("study.yaml"), text);
    hf_status status = hf_study_read(temp_path("study.yaml"), study, &messages);
    snprintf(said, sizeof said, "%s", messages.text ? messages.text : "");
    hf_messages_free(&messages);
    return status;
}

static void open_study(const char *axes, hf_study *study)
{
    hf_status status = read_study(axes, study);
    ck_assert_msg(status == HF_OK, "%s", said);
}

/* The value of point i on an axis, by the key. */
static const char *value_at(const hf_study *s, int i, const char *key)
{
    hf_study_overrides o;
    static char kept[4][128];
    static int n;
    hf_study_point_overrides(s, i, &o);
    for (int k = 0; k < o.n_set; k++)
        if (!strncmp(o.set[k], key, strlen(key)) && o.set[k][strlen(key)] == '=') {
            n = (n + 1) % 4;
            snprintf(kept[n], sizeof kept[n], "%s", o.set[k] + strlen(key) + 1);
            return kept[n];
        }
    return "(not set)";
}

static double number_at(const hf_study *s, int i, const char *key)
{
    return strtod(value_at(s, i, key), NULL);
}

static int has_id(const hf_study *s, const char *id)
{
    for (int i = 0; i < s->n_point; i++)
        if (!strcmp(s->id[i], id)) return 1;
    return 0;
}

#define TD "form.pretension_N"
#define RANGE "optimize.range_N"

START_TEST(product_has_every_combination)
{
    hf_study s;
    open_study("  optimize.range_N: [1, 2, 3]\n  form.pretension_N: [8, 10]\n", &s);
    ck_assert_int_eq(s.n_point, 6);
    for (int i = 0; i < 6; i++) { /* in the order of the keys, the last fastest */
        ck_assert_double_eq(number_at(&s, i, TD), i < 3 ? 8 : 10);
        ck_assert_double_eq(number_at(&s, i, RANGE), 1 + i % 3);
    }
    hf_study_free(&s);
}
END_TEST

/* Replicates stand side by side in a product and in a zip. Their seeds differ, also between combinations. The first
 * one is the point of the study without replicates, so that its result is kept. */
START_TEST(replicates_have_seeds_of_their_own)
{
    hf_study s, single;
    static const char *const axes[] = {"  form.pretension_N: [8, 10]\n  optimize.range_N: [1, 2]\n",
                                       "  combine: zip\n  optimize.range_N: [1, 2]\n  form.pretension_N: [8, 10]\n"};
    for (int is_zip = 0; is_zip < 2; is_zip++) {
        char text[256];
        snprintf(text, sizeof text, "  replicates: 3\n%s", axes[is_zip]);
        open_study(text, &s);
        open_study(axes[is_zip], &single);
        ck_assert_int_eq(s.n_point, 3 * single.n_point);
        for (int i = 0; i < s.n_point; i++) {
            ck_assert_double_eq(number_at(&s, i, TD), number_at(&single, i / 3, TD));
            ck_assert_double_eq(number_at(&s, i, RANGE), number_at(&single, i / 3, RANGE));
            ck_assert_str_eq(value_at(&s, i, "replicate"), "(not set)");
            for (int k = 0; k < i; k++)
                ck_assert_str_ne(value_at(&s, i, "optimize.seed"), value_at(&s, k, "optimize.seed"));
        }
        for (int i = 0; i < single.n_point; i++) {
            ck_assert_str_eq(s.id[3 * i], single.id[i]);
            ck_assert_str_eq(value_at(&s, 3 * i, "optimize.seed"), value_at(&single, i, "optimize.seed"));
        }
        ck_assert_str_eq(s.fingerprint, single.fingerprint);
        hf_study_free(&s);
        hf_study_free(&single);
    }
    open_study("  replicates: 4\n  optimize.range_N: [1]\n", &s); /* more of them: the others keep their ids */
    open_study("  replicates: 6\n  optimize.range_N: [1]\n", &single);
    for (int i = 0; i < 4; i++)
        ck_assert(has_id(&single, s.id[i]));
    hf_study_free(&s);
    hf_study_free(&single);
}
END_TEST

START_TEST(zip_goes_side_by_side)
{
    hf_study s;
    open_study("  combine: zip\n  optimize.range_N: [1, 2, 3]\n  form.pretension_N: {from: 8, to: 10, n: 3}\n", &s);
    ck_assert_int_eq(s.n_point, 3);
    for (int i = 0; i < 3; i++) {
        ck_assert_double_eq(number_at(&s, i, TD), 8 + i);
        ck_assert_double_eq(number_at(&s, i, RANGE), 1 + i);
    }
    hf_study_free(&s);
    ck_assert_int_eq(read_study("  combine: zip\n  optimize.range_N: [1, 2]\n  form.pretension_N: [8, 9, 10]\n", &s),
                     HF_BAD_CASE);
    ck_assert_msg(
        strstr(said,
               "study.yaml:5:3: sweep.form.pretension_N: this axis has 3 values, but the axis optimize.range_N has 2"),
        "%s", said);
    hf_study_free(&s);
}
END_TEST

START_TEST(ranges_are_linear_or_logarithmic)
{
    hf_study s;
    open_study("  combine: zip\n  n: 3\n  form.pretension_N: {from: 8, to: 9}\n"
               "  optimize.range_N: {from: 0.01, to: 1, spacing: log}\n  optimize.population: {from: 10, to: 21}\n"
               "  optimize.seed: {from: 7, to: 5}\n",
               &s);
    ck_assert_int_eq(s.n_point, 3);
    ck_assert_str_eq(value_at(&s, 1, TD), "8.5");
    ck_assert_str_eq(value_at(&s, 2, TD), "9"); /* the end is exact */
    ck_assert_str_eq(value_at(&s, 0, RANGE), "0.01");
    ck_assert_str_eq(value_at(&s, 1, RANGE), "0.1"); /* 12 digits: 0.1, not 0.10000000000000001 */
    ck_assert_str_eq(value_at(&s, 2, RANGE), "1");
    ck_assert_str_eq(value_at(&s, 1, "optimize.population"), "16"); /* 15.5, rounded: it counts */
    ck_assert_str_eq(value_at(&s, 1, "optimize.seed"), "6");
    hf_study_free(&s);
}
END_TEST

/* The difference or the quotient of the ends is beyond what a double holds; the values between them are not. */
START_TEST(the_ends_of_a_range_may_be_far_apart)
{
    static const struct {
        double from, to, x;
        bool is_log;
        const char *value;
    } at[] = {{1e308, -1e308, 0, false, "1e+308"},  {1e308, -1e308, 0.5, false, "0"},
              {1e308, -1e308, 1, false, "-1e+308"}, {-1e308, 1e308, 0.75, false, "5e+307"},
              {1e-300, 1e300, 0.5, true, "1"},      {1e300, 1e-300, 0.5, true, "1"},
              {1e300, 1e-300, 0, true, "1e+300"},   {1e-300, 1e300, 0.75, true, "1e+150"}};
    const hf_field any = {.type = HF_FIELD_DOUBLE};
    for (size_t i = 0; i < sizeof at / sizeof *at; i++) {
        char text[40];
        hf_study_range_value(&any, at[i].from, at[i].to, at[i].is_log, at[i].x, text);
        ck_assert_str_eq(text, at[i].value);
    }
}
END_TEST

/* A point whose values do not go together is no fault of the study, wherever it stands; what the points share is that
 * of the others. */
START_TEST(impossible_points_are_points)
{
    hf_study s;
    for (int k = 0; k < 2; k++) {
        open_study(k ? "  optimize.elites: [60, 1]\n" : "  optimize.elites: [1, 60]\n", &s);
        ck_assert_int_eq(s.n_point, 2);
        ck_assert(s.has_optimize && s.derives_seed);
        ck_assert_str_eq(s.title, "small");
        hf_study_free(&s);
    }
}
END_TEST

START_TEST(points_are_found_by_their_names)
{
    hf_study s;
    open_study("  form.pretension_N: {from: 1, to: 2, n: 50}\n  optimize.range_N: {from: 1, to: 2, n: 20}\n", &s);
    char seen[1000] = "";
    for (int i = 0; i < s.n_point; i++) {
        ck_assert_int_eq(hf_study_find(&s, s.id[i]), i);
        int k = hf_study_spread(&s, i);
        ck_assert(k >= 0 && k < s.n_point && !seen[k]);
        seen[k] = 1;
    }
    ck_assert_int_eq(hf_study_find(&s, "000000000000"), -1);
    ck_assert_int_eq(hf_study_find(&s, ""), -1);
    char longer[HF_STUDY_ID_SIZE + 1];
    snprintf(longer, sizeof longer, "%sx", s.id[7]);
    ck_assert_int_eq(hf_study_find(&s, longer), -1);
    hf_study_free(&s);
}
END_TEST

/* A study of 10^12 points is refused before two million values are made. */
START_TEST(points_are_counted_before_any_is_made)
{
    hf_study s;
    long before = allocation_count();
    ck_assert_int_eq(read_study("  form.pretension_N: {from: 1, to: 2, n: 1000000}\n"
                                "  optimize.range_N: {from: 1, to: 2, n: 1000000}\n",
                                &s),
                     HF_BAD_CASE);
    ck_assert_msg(strstr(said, "sweep: the study has 1e+12 points, but the maximum is 1000000 points"), "%s", said);
    hf_study_free(&s);
    ck_assert_int_lt(allocation_count() - before, 100);
}
END_TEST

/* Each value in a cell of its own on every axis, whatever the seed; another seed, another design. */
START_TEST(latin_hypercube_fills_every_row_and_column)
{
    enum { N = 40 };
    hf_study s;
    double first[2];
    for (int seed = 1; seed <= 2; seed++) {
        char axes[256];
        int cell[2][N] = {{0}};
        snprintf(axes, sizeof axes,
                 "  n: %d\n  seed: %d\n  form.pretension_N: {from: 100, to: 200, sample: latin_hypercube}\n"
                 "  optimize.range_N: {from: 1, to: 2, sample: latin_hypercube}\n",
                 N, seed);
        open_study(axes, &s);
        ck_assert_int_eq(s.n_point, N); /* one joint axis, no product of the two */
        int n_diagonal = 0;
        for (int i = 0; i < N; i++) {
            int a = (int)((number_at(&s, i, TD) - 100) / 100 * N), b = (int)((number_at(&s, i, RANGE) - 1) * N);
            ck_assert(a >= 0 && a < N && b >= 0 && b < N);
            cell[0][a]++;
            cell[1][b]++;
            n_diagonal += a == b;
        }
        for (int k = 0; k < N; k++)
            ck_assert(cell[0][k] == 1 && cell[1][k] == 1);
        ck_assert_int_lt(n_diagonal, N / 4); /* expected: 1; the two axes are shuffled apart */
        first[seed - 1] = number_at(&s, 0, TD);
        hf_study_free(&s);
    }
    ck_assert_double_ne(first[0], first[1]);
}
END_TEST

/* The start of Sobol's sequence in two dimensions as everybody prints it (Joe & Kuo: 1/2 1/2, 3/4 1/4, 1/4 3/4). */
START_TEST(sobol_is_the_sequence_and_combines_with_lists)
{
    static const double x[3][2] = {{0.5, 0.5}, {0.75, 0.25}, {0.25, 0.75}};
    hf_study s;
    open_study("  n: 3\n  form.pretension_N: {from: 100, to: 200, sample: sobol}\n"
               "  optimize.range_N: {from: 1, to: 2, sample: sobol}\n  optimize.seed: [4, 5]\n",
               &s);
    ck_assert_int_eq(s.n_point, 6);
    int n_found = 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 6; i++)
            n_found += fabs(number_at(&s, i, TD) - 100 - 100 * x[k][0]) < 1e-9 &&
                       fabs(number_at(&s, i, RANGE) - 1 - x[k][1]) < 1e-9;
    ck_assert_int_eq(n_found, 6); /* each of the three with each seed */
    hf_study_free(&s);
}
END_TEST

/* The names of the points of the first study are among those of the second. */
static void grows(const char *axes, const char *larger)
{
    hf_study before, after;
    open_study(axes, &before);
    open_study(larger, &after);
    ck_assert_int_lt(before.n_point, after.n_point);
    for (int i = 0; i < before.n_point; i++)
        ck_assert_msg(has_id(&after, before.id[i]), "point %d of '%s' has another name in '%s'", i, axes, larger);
    ck_assert_str_eq(before.fingerprint, after.fingerprint);
    hf_study_free(&before);
    hf_study_free(&after);
}

START_TEST(points_keep_their_names_when_axes_grow)
{
    grows("  form.pretension_N: [8, 10]\n", "  form.pretension_N: [10, 9, 8]\n");
    grows("  form.pretension_N: [8, 10]\n", "  form.pretension_N: {from: 8, to: 10, n: 5}\n");
    grows("  form.pretension_N: {from: 8, to: 10, n: 5}\n", "  form.pretension_N: {from: 8, to: 10, n: 9}\n");
    grows("  form.pretension_N: {from: 1, to: 16, n: 5, spacing: log}\n",
          "  form.pretension_N: {from: 1, to: 16, n: 9, spacing: log}\n");
    grows("  n: 8\n  form.pretension_N: {from: 1, to: 16, sample: sobol}\n",
          "  n: 13\n  form.pretension_N: {from: 1, to: 16, sample: sobol}\n");
    /* neither the order of the axes nor the way to write a number is part of a name */
    grows("  form.pretension_N: [8.0, 1e1]\n  optimize.seed: [1]\n",
          "  optimize.seed: [1, 2]\n  form.pretension_N: [8, 10]\n");
}
END_TEST

START_TEST(names_differ_and_are_digests_of_what_is_set)
{
    hf_study s;
    open_study("  form.pretension_N: [10]\n", &s);
    ck_assert_str_eq(s.id[0], "b7e6132d1d3d"); /* printf 'form.pretension_N=10\n' | sha256sum */
    hf_study_free(&s);
    open_study("  form.pretension_N: {from: 1, to: 2, n: 100}\n  optimize.seed: {from: 0, to: 9, n: 10}\n", &s);
    for (int i = 0; i < s.n_point; i++)
        for (int k = 0; k < i; k++)
            ck_assert_str_ne(s.id[i], s.id[k]);
    hf_study_free(&s);
    ck_assert_int_eq(read_study("  form.pretension_N: [8, 9, 8.0]\n", &s), HF_BAD_CASE);
    ck_assert_msg(strstr(said, "two points of the study are identical: form.pretension_N=8"), "%s", said);
    hf_study_free(&s);
}
END_TEST

/* From the seed of the base case and the point's name; an axis of seeds is taken as it is. */
START_TEST(every_point_has_a_seed_of_its_own)
{
    hf_study s, again;
    open_study("  optimize.range_N: [1, 2]\n", &s);
    open_study("  optimize.range_N: [2, 3]\n", &again);
    ck_assert_str_ne(value_at(&s, 0, "optimize.seed"), value_at(&s, 1, "optimize.seed"));
    ck_assert_str_eq(value_at(&s, 1, "optimize.seed"), value_at(&again, 0, "optimize.seed"));
    hf_study_free(&s);
    hf_study_free(&again);
    open_study("  optimize.seed: [3]\n  optimize.range_N: [1]\n", &s);
    ck_assert_str_eq(value_at(&s, 0, "optimize.seed"), "3");
    hf_study_free(&s);
    open_study("  form.pretension_N: [1]\n", &s); /* nothing random in these points */
    ck_assert_str_eq(value_at(&s, 0, "optimize.seed"), "(not set)");
    ck_assert(!hf_study_has_files(&s)); /* and each is over in no time */
    hf_study_free(&s);
}
END_TEST

START_TEST(a_case_may_hold_its_own_sweep)
{
    hf_study s;
    hf_case c;
    hf_messages m = {0};
    char text[1024];
    snprintf(text, sizeof text, "%ssweep:\n  form.pretension_N: [8, 10] # two\n\nform:\n  max_iterations: 99\n", BASE);
    write_file(temp_path("one.yaml"), text);
    ck_assert_msg(hf_study_read(temp_path("one.yaml"), &s, &m) == HF_OK, "%s", m.text);
    ck_assert_int_eq(s.n_point, 2);
    ck_assert_str_eq(s.base, s.path);
    ck_assert_int_eq(hf_config_load(s.base, (const char *const[]){"form.pretension_N=8"}, 1, &c, &m), HF_OK);
    ck_assert(c.has_sweep && c.form.max_iterations == 99);
    /* what is stored with a run is the case without the axes */
    ck_assert_ptr_null(strstr(c.text, "sweep"));
    ck_assert_ptr_nonnull(strstr(c.text, "form:\n  max_iterations: 99\n"));
    ck_assert_uint_eq(c.text_length, strlen(c.text));
    hf_case_free(&c);
    hf_study_free(&s);
}
END_TEST

/* YAML ends a line at a carriage return, too: no line of the case is lost with the section. */
START_TEST(a_sweep_with_other_line_breaks_is_cut_whole)
{
    static const char *const line_break[] = {"\r", "\r\n", "\xC2\x85", "\xE2\x80\xA8"};
    hf_case c;
    hf_messages m = {0};
    char text[1024];
    snprintf(text, sizeof text, "%ssweep:\n  form.pretension_N: [8,%s 10]\nform: {max_iterations: 99}\n", BASE,
             line_break[_i]);
    write_file(temp_path("one.yaml"), text);
    ck_assert_msg(hf_config_load(temp_path("one.yaml"), NULL, 0, &c, &m) == HF_OK, "%s", m.text);
    ck_assert(c.has_sweep && c.form.max_iterations == 99);
    ck_assert_ptr_null(strstr(c.text, "sweep"));
    ck_assert_ptr_null(strstr(c.text, "10]"));
    ck_assert_ptr_nonnull(strstr(c.text, "form: {max_iterations: 99}\n"));
    hf_case_free(&c);
}
END_TEST

START_TEST(values_of_all_types_are_swept)
{
    hf_study s;
    open_study("  scene.parabolic_cylinder.cells_per_module: [[1, 2], [2,2]]\n  form.method: [newton, hifdm]\n"
               "  title: ['a \"b\" \\ c: # d', x]\n",
               &s);
    ck_assert_int_eq(s.n_point, 8);
    hf_study_overrides o;
    hf_case c;
    hf_messages m = {0};
    hf_study_point_overrides(&s, 0, &o);
    ck_assert_msg(hf_config_load(s.base, o.set, o.n_set, &c, &m) == HF_OK, "%s", m.text);
    ck_assert_str_eq(c.title, "a \"b\" \\ c: # d");
    ck_assert_int_eq(c.parabolic_cylinder.cells_per_module[0], 1);
    ck_assert_int_eq(c.form.method, HF_METHOD_NEWTON);
    hf_case_free(&c);
    hf_study_free(&s);
}
END_TEST

#define ROWS                                                                                                           \
    "optimize:\n  variables: [{set: edge, vary: length, range: 1}, {set: edge, vary: tension, bounds: [1, 2]}]\n"      \
    "  objective: [{figure: psi}]\n"

static hf_status read_rows_study(const char *axes, hf_study *s)
{
    hf_messages m = {0};
    char text[2048];
    snprintf(text, sizeof text, "%s%ssweep:\n%s", BASE, ROWS, axes);
    write_file(temp_path("one.yaml"), text);
    hf_status status = hf_study_read(temp_path("one.yaml"), s, &m);
    snprintf(said, sizeof said, "%s", m.text ? m.text : "");
    hf_messages_free(&m);
    return status;
}

START_TEST(keys_of_rows_are_swept)
{
    hf_study s;
    hf_status status = read_rows_study("  optimize.variables.0.range: [1e-1, 30%, 30.0 %]\n"
                                       "  optimize.variables.1.bounds: [[1, 2], [null, 3]]\n"
                                       "  optimize.objective.0.weight: {from: 1, to: 3, n: 3}\n",
                                       &s);
    ck_assert_int_eq(status, HF_BAD_CASE); /* one way to write each amount */
    ck_assert_msg(strstr(said, "two points of the study are identical: ") &&
                      strstr(said, "optimize.variables.0.range=30 %,"),
                  "%s", said);
    hf_study_free(&s);
    status = read_rows_study("  optimize.variables.0.range: [1e-1, 30%]\n"
                             "  optimize.variables.1.bounds: [[1, 2], [null, 3]]\n"
                             "  optimize.variables.1.range: {from: 1, to: 2, n: 2}\n"
                             "  optimize.objective.0.weight: {from: 1, to: 3, n: 3}\n",
                             &s);
    ck_assert_msg(status == HF_OK, "%s", said);
    ck_assert_int_eq(s.n_point, 24);
    hf_study_overrides o;
    hf_case c;
    hf_messages m = {0};
    hf_study_point_overrides(&s, 23, &o);
    ck_assert_msg(hf_config_load(s.base, o.set, o.n_set, &c, &m) == HF_OK, "%s", m.text);
    const hf_variable_settings *v = c.optimize.variable_row;
    ck_assert(v[0].range_ratio == 0.3 && isnan(v[0].range) && v[1].range == 2);
    ck_assert(v[1].lower == -INFINITY && v[1].upper == 3 && c.optimize.term[0].weight == 3);
    hf_case_free(&c);
    hf_study_free(&s);
}
END_TEST

static const struct {
    const char *axes, *words;
} row_fault[] = {
    {"  optimize.variables.0.rnge: [1]\n",
     "one.yaml:8:3: sweep.optimize.variables.0: unknown key 'rnge'; did you mean 'range'?"},
    {"  optimize.variables: [1]\n",
     "one.yaml:8:3: sweep.optimize.variables: has many keys; an axis is one key of one row"},
    {"  optimize.objective.0: [1]\n",
     "one.yaml:8:3: sweep.optimize.objective.0: has many keys; an axis is one key of one row"},
    {"  optimize.variables.0.range: [-1]\n",
     "one.yaml:8:32: sweep: optimize.variables.0.range: must be above 0, not -1"},
    {"  optimize.variables.1.bounds: {from: 1, to: 2, n: 2}\n",
     "one.yaml:8:32: sweep.optimize.variables.1.bounds: is no number, so it needs a list of values"},
    {"  optimize.variables.2.range: [1]\n",
     "point optimize.variables.2.range=1: --set optimize.variables.2.range=1: optimize.variables.2.range: there is no "
     "such row: optimize.variables has 2, numbered from 0"},
    {"  optimize.range_N: [1]\n", "--set optimize.range_N: is of the default variables alone"},
};

START_TEST(faults_of_axes_over_rows_are_told)
{
    hf_study s;
    ck_assert_int_eq(read_rows_study(row_fault[_i].axes, &s), HF_BAD_CASE);
    ck_assert_msg(strstr(said, row_fault[_i].words), "'%s' is not in\n%s", row_fault[_i].words, said);
    hf_study_free(&s);
}
END_TEST

/* Each with its place; {axes, what is said}. */
static const struct {
    const char *axes, *words;
} fault[] = {
    {"  form.pretenson_N: [1]\n",
     "study.yaml:3:3: sweep: unknown key 'form.pretenson_N'; did you mean 'form.pretension_N'?"},
    {"  form.pretension_N: [1, -2]\n", "study.yaml:3:26: sweep: form.pretension_N: must be above 0"},
    {"  form.pretension_N: [1, ten]\n", "study.yaml:3:26: sweep: form.pretension_N: must be a number"},
    {"  form.pretension_N: {from: 1, to: -2, n: 3}\n",
     "study.yaml:3:36: sweep.form.pretension_N: to must be above 0 and at most 1000000000, not -2"},
    {"  form.pretension_N: {from: 1, n: 3}\n", "study.yaml:3:22: sweep.form.pretension_N: a range needs from and to"},
    {"  form.pretension_N: {from: 1, to: 2}\n", "study.yaml:3:22: sweep.form.pretension_N: needs n"},
    {"  form.pretension_N: {from: 1, to: 2, n: 0}\n", "study.yaml:3:42: sweep.form.pretension_N: n must be a whole"},
    {"  form.pretension_N: {from: 1, too: 2}\n",
     "study.yaml:3:32: sweep.form.pretension_N: unknown key 'too'; did you mean 'to'?"},
    {"  form.pretension_N: {from: 0, to: 2, n: 3, spacing: log}\n", "spacing: log needs from and to above 0"},
    {"  form.pretension_N: {from: 1, to: 2, sample: sobol}\n", "sampled axes need n in the sweep section"},
    {"  n: 3\n  form.pretension_N: {from: 1, to: 2, n: 4, sample: sobol}\n", "sampled axes share the n"},
    {"  form.method: {from: 1, to: 2, n: 3}\n", "study.yaml:3:16: sweep.form.method: is no number, so it needs a list"},
    {"  form.method: [newtn]\n", "study.yaml:3:17: sweep: form.method: must be one of"},
    {"  form.pretension_N: 12\n", "study.yaml:3:22: sweep.form.pretension_N: must be a list of values"},
    {"  form.pretension_N: []\n", "study.yaml:3:22: sweep.form.pretension_N: needs from 1 to"},
    {"  form.pretension_N: [[1, [2]]]\n", "a value must be one number, word or pair"},
    {"  title: [\"a\\nb\"]\n", "study.yaml:3:11: sweep.title: a value must be on one line"},
    {"  form.pretension_N: [1]\n  form.pretension_N: [2]\n",
     "study.yaml:4:3: sweep: 'form.pretension_N' stands here already, on line 3"},
    {"  combine: zap\n  form.pretension_N: [1]\n", "combine must be one of product, zip, not 'zap'"},
    {"  files: some\n  form.pretension_N: [1]\n", "files must be one of auto, all, none"},
    {"  n: 3\n", "study.yaml:3:3: sweep: has no axis"},
    {"  form.pretension_N: {from: 1, to: 2, n: 2000}\n  optimize.seed: {from: 1, to: 2000, n: 2000}\n",
     "4000000 points, but the maximum is 1000000"},
    {"  replicates: 1\n", "study.yaml:3:15: sweep.replicates: must be a whole number from 2 to 1000, not '1'"},
    {"  replicates: 1001\n", "study.yaml:3:15: sweep.replicates: must be a whole number from 2 to 1000, not '1001'"},
    {"  replicates: [3]\n", "study.yaml:3:15: sweep.replicates: must be a whole number from 2 to 1000"},
    {"  replicate: [1, 2]\n", "study.yaml:3:3: sweep: unknown key 'replicate'; did you mean 'replicates'?"},
    {"  replicates: 3\n  optimize.seed: [1, 2]\n",
     "study.yaml:4:18: sweep.optimize.seed: each replicate has a seed of its own. Remove this axis, or the key "
     "replicates"},
    {"  optimize.seed: {from: 1, to: 3, n: 3}\n  replicates: 3\n", "study.yaml:3:18: sweep.optimize.seed: each"},
    {"  form.pretension_N: [1]\n  replicates: 3\n",
     "study.yaml:4:3: sweep.replicates: all replicates would be identical, because the case has no section optimize. "
     "Remove the key replicates, or add the section optimize"},
    {"  optimize.method: [lm]\n  replicates: 3\n",
     "study.yaml:4:3: sweep.replicates: all replicates would be identical, because the method lm uses no random "
     "numbers. Remove the key replicates, or use the method ga, ga+lm or auto"},
    {"  form.pretension_N: {from: 1, to: 2, n: 2000}\n  replicates: 501\n",
     "the study has 1002000 points, but the maximum is 1000000"},
    /* ends too far apart for a difference or a quotient, and too large for a whole number */
    {"  form.pretension_N: {from: 1e308, to: -1e308, n: 3}\n",
     "study.yaml:3:29: sweep.form.pretension_N: from must be above 0 and at most 1000000000, not 1e308"},
    {"  optimize.population: {from: 2, to: 1e300, n: 3}\n",
     "study.yaml:3:38: sweep.optimize.population: to must be at least 2 and at most 100000, not 1e300"},
    {"  form.pretension_N: {from: 0, to: 2, n: 3}\n", "study.yaml:3:22: sweep: form.pretension_N: must be above 0"},
    /* keys that go together at no point: the first is named */
    {"  optimize.elites: [70, 60]\n",
     "point optimize.elites=70: --set optimize.elites: must be below optimize.population"},
};

START_TEST(faults_name_axis_file_and_line)
{
    hf_study s;
    ck_assert_int_eq(read_study(fault[_i].axes, &s), HF_BAD_CASE);
    ck_assert_msg(strstr(said, fault[_i].words), "'%s' is not in\n%s", fault[_i].words, said);
    hf_study_free(&s);
}
END_TEST

/* The name of a base that is empty would be that of the folder. */
START_TEST(a_base_has_a_name)
{
    hf_study s;
    hf_messages m = {0};
    write_file(temp_path("study.yaml"), "base: ''\nsweep:\n  form.pretension_N: [1]\n");
    ck_assert_int_eq(hf_study_read(temp_path("study.yaml"), &s, &m), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(m.text, "study.yaml:1:7: sweep: base must be the name of a case file\n"));
    hf_messages_free(&m);
    hf_study_free(&s);
}
END_TEST

START_TEST(all_faults_are_told_at_once)
{
    hf_study s;
    ck_assert_int_eq(read_study("  form.pretenson_N: [1]\n  optimize.range_N: [1, 0]\n  combne: zip\n", &s),
                     HF_BAD_CASE);
    ck_assert(strstr(said, ":3:3:") && strstr(said, ":4:25:") && strstr(said, ":5:3:"));
    hf_study_free(&s);
}
END_TEST

/* The title is the study's own, or else that of its case; a fault in it has its place. */
START_TEST(the_title_is_of_the_study_or_of_its_case)
{
    hf_study s;
    hf_messages m = {0};
    open_study("  form.pretension_N: [1]\n", &s);
    ck_assert_str_eq(s.title, "small");
    hf_study_free(&s);
    write_file(temp_path("study.yaml"), "title: which pretension?\nbase: base.yaml\nsweep: {form.pretension_N: [1]}\n");
    ck_assert_int_eq(hf_study_read(temp_path("study.yaml"), &s, &m), HF_OK);
    ck_assert_str_eq(s.title, "which pretension?");
    hf_study_free(&s);
    write_file(temp_path("study.yaml"), "base: base.yaml\ntitle: [a]\nsweep: {form.pretension_N: [1]}\n");
    ck_assert_int_eq(hf_study_read(temp_path("study.yaml"), &s, &m), HF_BAD_CASE);
    ck_assert_ptr_nonnull(strstr(m.text, "study.yaml:2:8: sweep: title must be a text on one line"));
    hf_messages_free(&m);
    hf_study_free(&s);
}
END_TEST

/* Any study file that is damaged is refused with words; nothing crashes (the sanitizers watch). */
START_TEST(damaged_files_are_refused)
{
    static const char *const text[] = {"",
                                       "- a\n",
                                       "base: [1]\nsweep: {}\n",
                                       "base: nosuch.yaml\nsweep: {form.pretension_N: [1]}\n",
                                       "base: base.yaml\n",
                                       "base: base.yaml\nsweep: 3\n",
                                       "base: base.yaml\nsweep: {a: b\n",
                                       "base: base.yaml\nswep: {}\n",
                                       "base: base.yaml\nbase: base.yaml\nsweep: {n: 1}\n",
                                       "? [a]\n: b\n",
                                       "title: x\nsweep: {form.pretension_N: [1]}\n"};
    for (size_t k = 0; k < sizeof text / sizeof *text; k++) {
        hf_study s;
        hf_messages m = {0};
        write_file(temp_path("base.yaml"), BASE);
        write_file(temp_path("study.yaml"), text[k]);
        ck_assert_msg(hf_study_read(temp_path("study.yaml"), &s, &m) == HF_BAD_CASE, "%s", text[k]);
        ck_assert_int_gt(m.n_error, 0);
        hf_messages_free(&m);
        hf_study_free(&s);
    }
}
END_TEST

/* Without memory: a status, no leak and no crash. */
START_TEST(any_allocation_may_fail)
{
    hf_study s;
    open_study("  form.pretension_N: {from: 1, to: 2, n: 3}\n  optimize.seed: [1, 2]\n", &s); /* writes the files */
    hf_study_free(&s);
    const char *path = temp_path("study.yaml");
    for (long n = 1;; n++) {
        hf_messages m = {0};
        fail_allocation_at(n);
        hf_status status = hf_study_read(path, &s, &m);
        bool reached = end_allocation_failure();
        hf_study_free(&s);
        hf_messages_free(&m);
        if (!reached) {
            ck_assert_int_eq(status, HF_OK);
            break;
        }
        /* a message that found no memory is lost, which does no harm */
        ck_assert_msg(status == HF_NO_MEMORY || status == HF_OK || status == HF_BAD_CASE, "allocation %ld: %d", n,
                      status);
    }
}
END_TEST

Suite *suite_unit_study(void)
{
    Suite *suite = suite_create("unit/study");
    TCase *tests = tcase_create("study");
    suite_add_tcase(suite, tests);
    tcase_add_test(tests, product_has_every_combination);
    tcase_add_test(tests, replicates_have_seeds_of_their_own);
    tcase_add_test(tests, zip_goes_side_by_side);
    tcase_add_test(tests, ranges_are_linear_or_logarithmic);
    tcase_add_test(tests, the_ends_of_a_range_may_be_far_apart);
    tcase_add_test(tests, impossible_points_are_points);
    tcase_add_test(tests, points_are_found_by_their_names);
    tcase_add_test(tests, points_are_counted_before_any_is_made);
    tcase_add_test(tests, latin_hypercube_fills_every_row_and_column);
    tcase_add_test(tests, sobol_is_the_sequence_and_combines_with_lists);
    tcase_add_test(tests, points_keep_their_names_when_axes_grow);
    tcase_add_test(tests, names_differ_and_are_digests_of_what_is_set);
    tcase_add_test(tests, every_point_has_a_seed_of_its_own);
    tcase_add_test(tests, a_case_may_hold_its_own_sweep);
    tcase_add_loop_test(tests, a_sweep_with_other_line_breaks_is_cut_whole, 0, 4);
    tcase_add_test(tests, values_of_all_types_are_swept);
    tcase_add_test(tests, keys_of_rows_are_swept);
    tcase_add_loop_test(tests, faults_of_axes_over_rows_are_told, 0, sizeof row_fault / sizeof *row_fault);
    tcase_add_loop_test(tests, faults_name_axis_file_and_line, 0, sizeof fault / sizeof *fault);
    tcase_add_test(tests, a_base_has_a_name);
    tcase_add_test(tests, all_faults_are_told_at_once);
    tcase_add_test(tests, the_title_is_of_the_study_or_of_its_case);
    tcase_add_test(tests, damaged_files_are_refused);
    tcase_add_test(tests, any_allocation_may_fail);
    return suite;
}

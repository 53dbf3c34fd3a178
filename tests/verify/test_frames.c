/* Fourteen beam frames, all with and most also without shear deformation, compared with results of other programs.
 *
 * Source: tests/verify/data/frames/NAME.txt, which says at its top where each comes from. Reference displacements are
 * from a double-precision Frame3DD. Two further programs agree with it to 1e-12 in most frames, to 3e-10 on roll30
 * (random roll angles, Iy != Iz) and to 7e-10 on exE. Displacements, rotations, forces and moments are therefore held
 * to 1e-9 of the largest of their kind, in those two frames to 1e-8. Forces at free nodes differ from zero by this
 * program's rounding only. */
#include "figures.h"

#include <hifdm/frame.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct {
    const char *name;
    double tolerance;
    int n_case; /* with both theories */
} frames[] = {{"Icosahedron_1v", 1e-9, 2},
              {"exA", 1e-9, 4},
              {"exA_settle", 1e-9, 2},
              {"exB", 1e-9, 6},
              {"exC", 1e-9, 2},
              {"exE", 1e-8, 2},
              {"exF", 1e-9, 2},
              {"exG", 1e-9, 2},
              {"exH", 1e-9, 2},
              {"exI", 1e-9, 2},
              {"roll30", 1e-8, 6},
              {"stat-frame-13", 1e-9, 2},
              {"truss200", 1e-9, 5},
              {"truss40", 1e-9, 10}};
enum { N_FRAME = sizeof frames / sizeof *frames };

struct reference {
    FILE *file;
    char word[32]; /* the next line's first; "" at the end */
    hf_truss truss;
    double (*section)[8];
    int n_section;
    double *shear_area_m2; /* [n_member][2] */
    int timoshenko;
    double *force, *settlement, *expected, *reaction, *end_force; /* of the case being read; NaN: not given */
    int n_support;
};

static void next_word(struct reference *r)
{
    if (fscanf(r->file, "%31s", r->word) != 1) r->word[0] = '\0';
}

static int is(const struct reference *r, const char *word)
{
    return !strcmp(r->word, word);
}

static void numbers(struct reference *r, int n, double *value)
{
    for (int k = 0; k < n; k++)
        ck_assert_int_eq(fscanf(r->file, "%lf", value + k), 1);
}

/* An index and n numbers into row `index` of a table. */
static void row(struct reference *r, int n, double *table, int n_row)
{
    int i;
    ck_assert_int_eq(fscanf(r->file, "%d", &i), 1);
    ck_assert(i >= 0 && i < n_row);
    numbers(r, n, table + (size_t)n * (size_t)i);
}

static void read_member(struct reference *r, int e)
{
    hf_truss *t = &r->truss;
    int k;
    double roll_deg;
    ck_assert_int_eq(fscanf(r->file, "%d %d %d %lf", &t->end[2 * e], &t->end[2 * e + 1], &k, &roll_deg), 4);
    ck_assert(k >= 0 && k < r->n_section);
    const double *s = r->section[k];
    t->E_Pa[e] = s[0];
    t->G_Pa[e] = s[1];
    t->A_m2[e] = s[2];
    r->shear_area_m2[2 * e] = s[3];
    r->shear_area_m2[2 * e + 1] = s[4];
    t->J_m4[e] = s[5];
    t->Iy_m4[e] = s[6];
    t->Iz_m4[e] = s[7];
    t->roll_rad[e] = roll_deg * 3.141592653589793 / 180;
    t->member_id[e] = "member";
}

static double *table(size_t n)
{
    double *values = calloc(n, sizeof *values);
    ck_assert_ptr_nonnull(values);
    return values;
}

static void open_reference(struct reference *r, const char *name)
{
    char path[128], line[256];
    int n_node, n_member;
    *r = (struct reference){0};
    snprintf(path, sizeof path, "tests/verify/data/frames/%s.txt", name);
    r->file = fopen(source_path(path), "r");
    ck_assert_ptr_nonnull(r->file);
    do
        ck_assert_ptr_nonnull(fgets(line, sizeof line, r->file));
    while (*line == '#');
    ck_assert_int_eq(sscanf(line, "size %d %d", &n_node, &n_member), 2);
    size_t n = (size_t)n_node, m = (size_t)n_member;
    ck_assert_int_eq(hf_truss_allocate(&r->truss, n_node, n_member, 0), HF_OK);
    r->section = calloc(m, sizeof *r->section);
    ck_assert_ptr_nonnull(r->section);
    r->shear_area_m2 = table(2 * m);
    r->force = table(6 * n);
    r->settlement = table(6 * n);
    r->expected = table(6 * n);
    r->reaction = table(6 * n);
    r->end_force = table(12 * m);
    int i = 0, e = 0;
    for (next_word(r); *r->word && !is(r, "case"); next_word(r)) {
        if (is(r, "node")) {
            r->truss.node_id[i] = "node";
            numbers(r, 3, r->truss.position_m + 3 * i++);
        } else if (is(r, "section")) {
            numbers(r, 8, r->section[r->n_section++]);
        } else if (is(r, "member")) {
            read_member(r, e++);
        } else {
            ck_assert(is(r, "support"));
            row(r, 6, r->force, n_node);
            r->n_support++;
        }
    }
    ck_assert(i == n_node && e == n_member);
    for (int k = 0; k < 6 * n_node; k++)
        r->truss.fixed[k / 6] |= (unsigned char)((r->force[k] != 0) << k % 6);
}

static int read_case(struct reference *r)
{
    char theory[32], name[64];
    int n = r->truss.n_node, m = r->truss.n_member;
    if (!is(r, "case")) return 0;
    ck_assert_int_eq(fscanf(r->file, "%31s %63s", theory, name), 2);
    memset(r->force, 0, 6 * (size_t)n * sizeof(double));
    memset(r->settlement, 0, 6 * (size_t)n * sizeof(double));
    memset(r->expected, 0, 6 * (size_t)n * sizeof(double));
    memset(r->reaction, 0, 6 * (size_t)n * sizeof(double));
    for (int k = 0; k < 12 * m; k++)
        r->end_force[k] = NAN;
    r->timoshenko = !strcmp(theory, "timoshenko");
    for (next_word(r); !is(r, "case") && !is(r, "end"); next_word(r)) {
        ck_assert_msg(*r->word, "the file ends early");
        if (is(r, "s"))
            row(r, 12, r->end_force, m);
        else
            row(r, 6,
                is(r, "load")     ? r->force
                : is(r, "settle") ? r->settlement
                : is(r, "u")      ? r->expected
                                  : r->reaction,
                n);
    }
    for (int e = 0; e < m; e++) {
        r->truss.Asy_m2[e] = r->timoshenko ? r->shear_area_m2[2 * e] : (double)INFINITY;
        r->truss.Asz_m2[e] = r->timoshenko ? r->shear_area_m2[2 * e + 1] : (double)INFINITY;
    }
    return 1;
}

static void close_reference(struct reference *r)
{
    fclose(r->file);
    hf_truss_free(&r->truss);
    free(r->section);
    free(r->shear_area_m2);
    free(r->force);
    free(r->settlement);
    free(r->expected);
    free(r->reaction);
    free(r->end_force);
}

/* The largest difference of the components first, first+1, first+2 of every six, relative to the largest expected one;
 * expected figures that are NaN are left out. */
static double difference(int n, const double *found, const double *expected, int first)
{
    double most = 0, largest = 0;
    for (int k = 0; k < n; k++) {
        if (k % 6 < first || k % 6 > first + 2 || isnan(expected[k])) continue;
        most = fmax(most, fabs(found[k] - expected[k]));
        largest = fmax(largest, fabs(expected[k]));
    }
    return most > 0 ? most / largest : 0;
}

/* Largest component of its kind (force or moment) among members' ends: what residuals are relative to. */
static double largest_end_force(const double *end_force, int n_member, int first)
{
    double largest = 0;
    for (int k = 0; k < 12 * n_member; k++)
        if (k % 6 >= first && k % 6 < first + 3) largest = fmax(largest, fabs(end_force[k]));
    return largest;
}

#define RELATIVE ", in parts of the largest"

static void compare(const struct reference *r, const char *name, double tolerance)
{
    static const char *const kind[] = {"displacements", "rotations", "forces", "moments"};
    int n = 6 * r->truss.n_node, m = r->truss.n_member, bad_dof;
    hf_frame frame;
    hf_frame_load load = {r->force, r->settlement, NULL};
    hf_messages messages = {0};
    ck_assert_msg(hf_truss_check(&r->truss, &messages) == HF_OK, "%s", messages.text);
    ck_assert_msg(hf_frame_build(&r->truss, &frame, &messages) == HF_OK, "%s", messages.text);
    double *work = table(hf_frame_work_size(&frame, 1)), *u = table((size_t)n), *reaction = table((size_t)n);
    double *residual = table((size_t)n), *end_force = table(12 * (size_t)m);
    ck_assert_int_eq(hf_frame_solve(&frame, 1, &load, work, u, &bad_dof), HF_OK);
    hf_frame_reactions(&frame, &load, u, reaction, residual);
    hf_frame_member_forces(&frame, &load, u, end_force);
    for (int k = 0; k < 2; k++) {
        VERIFY_WORST(difference(n, u, r->expected, 3 * k), tolerance, "%s: %s" RELATIVE, name, kind[k]);
        VERIFY_WORST(difference(n, reaction, r->reaction, 3 * k), tolerance, "%s: reactions, %s" RELATIVE, name,
                     kind[2 + k]);
        VERIFY_WORST(difference(12 * m, end_force, r->end_force, 3 * k), tolerance, "%s: ends, %s" RELATIVE, name,
                     kind[2 + k]);
    }
    /* every free node is in equilibrium, to the rounding of the forces that meet there */
    double force_N = largest_end_force(end_force, m, 0), moment_Nm = largest_end_force(end_force, m, 3);
    for (int k = 0; k < n; k++)
        ck_assert_msg(fabs(residual[k]) <= 1e-9 * (k % 6 < 3 ? force_N : moment_Nm + force_N),
                      "%s: node %d is out of balance by %.1e of %.1e", name, k / 6, residual[k],
                      k % 6 < 3 ? force_N : moment_Nm);
    hf_frame_free(&frame);
    hf_messages_free(&messages);
    free(work);
    free(u);
    free(reaction);
    free(residual);
    free(end_force);
}

START_TEST(figures_of_other_programs)
{
    struct reference r;
    int n_case = 0;
    open_reference(&r, frames[_i].name);
    for (; read_case(&r); n_case++)
        compare(&r, frames[_i].name, frames[_i].tolerance);
    ck_assert_int_eq(n_case, frames[_i].n_case);
    close_reference(&r);
}
END_TEST

Suite *suite_verify_frames(void)
{
    Suite *suite = suite_create("verify/frames");
    TCase *tests = tcase_create("frames");
    suite_add_tcase(suite, tests);
    tcase_add_loop_test(tests, figures_of_other_programs, 0, N_FRAME);
    return suite;
}

/* The far field of a reflector on all cores, and its facets for peers.py, which sums as many points by numpy. */
#include "bench.h"

#include "search/parallel.h"
#include <hifdm/pattern.h>
#include <hifdm/problem.h>

#include <stdlib.h>

#define SCENE "12 m offset reflector at 10 GHz"
#define ENOUGH_S 0.5

typedef struct {
    hf_problem problem;
    hf_feed feed;
    hf_pattern_surface surface;
    hf_pattern_table table;
    int n_thread;
    long n_point;
} far_bench;

static void solve(void *context)
{
    far_bench *b = context;
    hf_far_field p;
    const hf_surface_settings *s = &b->problem.surface;
    if (hf_pattern_create(&s->pattern, &b->surface, &b->feed, s->frequencies_Hz.value[0], b->n_thread, &p) != HF_OK)
        bench_fail(SCENE, "out of memory");
    hf_parallel_each(b->n_thread, HF_PATTERN_BLOCKS, hf_pattern_sum_block, &p);
    hf_pattern_finish(&p, b->table.co_dBi, b->table.cross_dBi);
    b->n_point = p.n_point;
    hf_pattern_free(&p);
}

static void write_facets(const far_bench *b, const char *folder)
{
    FILE *f = bench_open_file(folder, "pattern.txt");
    const hf_facets *facets = &b->problem.facets;
    fprintf(f, "%d %ld", facets->n_facet, b->n_point);
    for (int d = 0; d < 3; d++)
        fprintf(f, " %.17g %.17g %.17g", b->feed.position_m[d], b->feed.axis[d], b->feed.co[d]);
    fprintf(f, " %.17g %.17g\n", b->feed.cos_power, b->feed.scale);
    for (int k = 0; k < 4 * facets->n_facet; k++) {
        const double *p = b->surface.position_m + 3 * facets->corner[k];
        fprintf(f, "%.17g %.17g %.17g\n", p[0], p[1], p[2]);
    }
    for (int i = 0; i < b->table.n_theta; i++)
        fprintf(f, "%.17g %.17g\n", b->table.theta_deg[i], b->table.co_dBi[i]);
    fclose(f);
}

void bench_pattern(const char *to_deg, const char *folder)
{
    far_bench b = {.n_thread = 1};
    char theta[64];
    hf_messages messages = {0};
    snprintf(theta, sizeof theta, "surface.pattern.theta_deg=[-%s, %s]", to_deg, to_deg);
    const char *const set[] = {"surface.frequencies_Hz=[10e9]", "surface.pattern.phi_deg=[0]", theta};
    hf_problem *p = &b.problem;
    if (hf_problem_open("configs/paraboloid-offset-12m.yaml", set, 3, 1, p, &messages) != HF_OK ||
        hf_pattern_table_create(1, 1, p->surface.pattern.n_theta, &b.table) != HF_OK)
        bench_fail(SCENE, messages.text);
    b.surface = (hf_pattern_surface){&p->facets, p->scene.position_m, NULL};
    hf_feed_make(&p->surface, &p->facets, p->scene.position_m, &b.feed);
    for (int i = 0; i < b.table.n_theta; i++) {
        const hf_pattern_settings *s = &p->surface.pattern;
        b.table.theta_deg[i] = s->theta_deg[0] + (s->theta_deg[1] - s->theta_deg[0]) * i / (s->n_theta - 1);
    }
    for (int n = hf_parallel_cores(); n > 0; n = n > 1 ? 1 : 0) {
        char method[32];
        snprintf(method, sizeof method, "hifdm, %d thread%s", n, n > 1 ? "s" : "");
        b.n_thread = n;
        bench_emit("pattern", SCENE, method, atof(to_deg), "wall_s", bench_time_s(solve, &b, ENOUGH_S));
        bench_emit("pattern", SCENE, method, atof(to_deg), "points", (double)b.n_point);
    }
    write_facets(&b, folder);
    hf_pattern_table_free(&b.table);
    hf_problem_free(p);
}

/* Writes what a workshop needs to make the net of a stored shape. --cutlist NAME.csv gives four CSV files:
 *
 *   NAME.csv       : id,i,j,group,tension_N,length_m,unstressed_length_m,elongation_m,EA_N,unstressed_minus_target_m,
 *                    law,value[,set]
 *                    unstressed_length_m        length_m / (1 + T/EA); a slack cable of law length or elastic has the
 *                                               length that its law gives
 *                    elongation_m               length_m - unstressed_length_m
 *                    unstressed_minus_target_m  unstressed_length_m minus the unstressed length for the same tension at
 *                                               the target positions: how much longer (> 0) a turnbuckle must make a
 *                                               cable that was cut for these positions
 *                    law, value                 "elastic" and unstressed_length_m, so that NAME.csv can be imported as
 *                                               cables.csv of the as-built net
 *                    set                        names of sets with blanks between them, when the net has sets
 *   NAME_mm.csv    : id,i,j,group,unstressed_length_mm,length_mm,elongation_mm,tension_N,unstressed_minus_target_mm
 *                    [,set]
 *                    the same for people, rounded to 0.001 mm and 0.01 N
 *   NAME_nodes.csv : id,x_m,y_m,z_m,role[,Fx_N,Fy_N,Fz_N]
 *                    positions of the nodes in the jig; can be imported as nodes.csv
 *   NAME_totals.csv: group,cables,unstressed_length_m,length_m,tension_min_N,tension_max_N,
 *                    unstressed_minus_target_min_m,unstressed_minus_target_max_m
 *                    one row for each group, for all cables, and for each set
 *
 * Numbers have 17 significant digits except in NAME_mm.csv, so the net imported from these files has the stored
 * shape. */
#include "out/export.h"

#include "base/csv.h"
#include "net/cable_pick.h"
#include "out/cut.h"
#include "out/print.h"
#include <hifdm/cable_set.h>

#include <math.h>

typedef struct {
    const hf_scene *scene;
    const hf_shape *shape;
    double reference_N;
} view;

static void write_cables(const void *context, FILE *f)
{
    const view *v = context;
    const hf_scene *s = v->scene;
    fprintf(
        f,
        "id,i,j,group,tension_N,length_m,unstressed_length_m,elongation_m,EA_N,unstressed_minus_target_m,law,value%s\n",
        s->n_set ? ",set" : "");
    for (int e = 0; e < s->n_cable; e++) {
        hf_cut c = hf_cut_of(s, v->shape, v->reference_N, e);
        hf_export_ends(s->cable_id[e], s->node_id, s->end + 2 * e, f);
        fprintf(f, ",%s,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%s,%.17g", hf_group_word[s->group[e]], c.tension_N,
                c.length_m, c.l0_m, c.length_m - c.l0_m, s->EA_N[e], c.unstressed_minus_target_m,
                hf_law_word[HF_LAW_ELASTIC], c.l0_m);
        hf_export_sets_of(s, e, f);
        fputc('\n', f);
    }
}

/* Converts a length to millimetres, rounds it to 0.001 mm and turns -0 into 0. */
static double bench_mm(double length_m)
{
    return round(1e6 * length_m) / 1e3 + 0.0;
}

static void write_bench(const void *context, FILE *f)
{
    const view *v = context;
    const hf_scene *s = v->scene;
    fprintf(f, "id,i,j,group,unstressed_length_mm,length_mm,elongation_mm,tension_N,unstressed_minus_target_mm%s\n",
            s->n_set ? ",set" : "");
    for (int e = 0; e < s->n_cable; e++) {
        hf_cut c = hf_cut_of(s, v->shape, v->reference_N, e);
        hf_export_ends(s->cable_id[e], s->node_id, s->end + 2 * e, f);
        fprintf(f, ",%s,%.3f,%.3f,%.3f,%.2f,%.3f", hf_group_word[s->group[e]], bench_mm(c.l0_m), bench_mm(c.length_m),
                bench_mm(c.length_m - c.l0_m), c.tension_N, bench_mm(c.unstressed_minus_target_m));
        hf_export_sets_of(s, e, f);
        fputc('\n', f);
    }
}

static void write_nodes(const void *context, FILE *f)
{
    const hf_scene *s = ((const view *)context)->scene;
    fprintf(f, "id,x_m,y_m,z_m,role%s\n", s->load_N ? ",Fx_N,Fy_N,Fz_N" : "");
    for (int i = 0; i < s->n_node; i++) {
        const double *p = ((const view *)context)->shape->position_m + 3 * (size_t)i;
        hf_csv_write_id(s->node_id[i], f);
        fprintf(f, ",%.17g,%.17g,%.17g,%s", p[0], p[1], p[2], hf_role_word[s->role[i]]);
        for (int c = 0; c < 3 && s->load_N; c++)
            fprintf(f, ",%.17g", s->load_N[3 * (size_t)i + (size_t)c]);
        fputc('\n', f);
    }
}

typedef enum { OF_GROUP, OF_SET, OF_ALL } total_kind;

static void write_total(const view *v, const char *name, total_kind kind, int which, FILE *f)
{
    int n = 0;
    double unstressed_m = 0, length_m = 0, tension_N[2] = {INFINITY, -INFINITY},
           difference_m[2] = {INFINITY, -INFINITY};
    for (int e = 0; e < v->scene->n_cable; e++) {
        if (kind == OF_GROUP && v->scene->group[e] != which) continue;
        if (kind == OF_SET && !hf_cable_set_has(v->scene, which, e)) continue;
        hf_cut c = hf_cut_of(v->scene, v->shape, v->reference_N, e);
        n++;
        unstressed_m += c.l0_m;
        length_m += c.length_m;
        tension_N[0] = fmin(tension_N[0], c.tension_N);
        tension_N[1] = fmax(tension_N[1], c.tension_N);
        difference_m[0] = fmin(difference_m[0], c.unstressed_minus_target_m);
        difference_m[1] = fmax(difference_m[1], c.unstressed_minus_target_m);
    }
    if (n)
        fprintf(f, "%s,%d,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", name, n, unstressed_m, length_m, tension_N[0],
                tension_N[1], difference_m[0], difference_m[1]);
}

static void write_totals(const void *context, FILE *f)
{
    const view *v = context;
    fputs("group,cables,unstressed_length_m,length_m,tension_min_N,tension_max_N,unstressed_minus_target_min_m,"
          "unstressed_minus_target_max_m\n",
          f);
    for (int group = 0; group < 2; group++)
        write_total(v, hf_group_word[group], OF_GROUP, group, f);
    write_total(v, "all", OF_ALL, 0, f);
    for (int k = 0; k < v->scene->n_set; k++)
        write_total(v, v->scene->set_name[k], OF_SET, k, f);
}

static hf_status export_cutlist(const hf_export_request *o, const hf_export_stored *stored, hf_messages *messages)
{
    static hf_export_file file[] = {
        {"", write_cables, ""}, {"_mm", write_bench, ""}, {"_nodes", write_nodes, ""}, {"_totals", write_totals, ""}};
    const hf_scene *scene = &stored->scene;
    const view v = {scene, &stored->shape, hf_model_reference_N(scene, stored->summary.pretension_N)};
    HF_TRY(hf_cable_demand_EA(scene, o->file, "cutting lengths need", ", and run again", messages));
    HF_TRY(hf_export_files(o, file, 4, &v, messages));
    hf_print_line(
        o->said,
        "%s: cutting lengths of %d cables of the %s shape in %s, in mm for the bench in %s, node positions for the jig "
        "in %s, totals in %s",
        o->file, scene->n_cable, stored->word, file[0].path, file[1].path, file[2].path, file[3].path);
    return HF_OK;
}

const hf_exporter hf_exporter_cutlist = {
    .option = "--cutlist",
    .argument = "FILE",
    .help = "write the unstressed lengths to FILE, and write bench lengths in mm, jig positions and totals beside this "
            "file",
    .reads = HF_EXPORT_SHAPE,
    .takes_stage = true,
    .write = export_cutlist,
};

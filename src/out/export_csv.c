/* Writes a stored shape as CSV files into the folder of --csv, which is created when it does not exist:
 *
 *   nodes.csv : id,x_m,y_m,z_m,x0_m,y0_m,z0_m,role   position of the shape, target position
 *   cables.csv: id,i,j,group,law,length_m,tension_N,q_N_per_m[,set]   set: names of sets, blanks between, if any
 *   facets.csv: id,a,b,c,d   nodes of each facet, d empty for a triangle; only when the case measures the surface
 *
 * A result with a truss also gives truss_nodes.csv and members.csv, in the columns that truss_import reads.
 * Displacements and end forces follow in further columns when the result has them. Numbers have 17 significant digits,
 * so reading them gives the same bits. */
#include "out/export.h"

#include "base/csv.h"
#include "out/print.h"
#include <math.h>

typedef struct {
    const hf_scene *scene;
    const hf_shape *shape;
    const hf_facets *facets;
    hf_truss truss;
    hf_carrier_state state; /* of the truss */
} view;

static void write_nodes(const void *context, FILE *f)
{
    const hf_scene *s = ((const view *)context)->scene;
    const hf_shape *shape = ((const view *)context)->shape;
    fputs("id,x_m,y_m,z_m,x0_m,y0_m,z0_m,role\n", f);
    for (int i = 0; i < s->n_node; i++) {
        const double *p = shape->position_m + 3 * (size_t)i, *p0 = s->position_m + 3 * (size_t)i;
        hf_csv_write_id(s->node_id[i], f);
        fprintf(f, ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%s\n", p[0], p[1], p[2], p0[0], p0[1], p0[2],
                hf_role_word[s->role[i]]);
    }
}

static void write_cables(const void *context, FILE *f)
{
    const hf_scene *s = ((const view *)context)->scene;
    const hf_shape *shape = ((const view *)context)->shape;
    fprintf(f, "id,i,j,group,law,length_m,tension_N,q_N_per_m%s\n", s->n_set ? ",set" : "");
    for (int e = 0; e < s->n_cable; e++) {
        hf_export_ends(s->cable_id[e], s->node_id, s->end + 2 * e, f);
        fprintf(f, ",%s,%s,%.17g,%.17g,%.17g", hf_group_word[s->group[e]], hf_law_word[shape->law[e]],
                shape->length_m[e], shape->tension_N[e], shape->q_N_per_m[e]);
        hf_export_sets_of(s, e, f);
        fputc('\n', f);
    }
}

static void write_facets(const void *context, FILE *f)
{
    const view *v = context;
    fputs("id,a,b,c,d\n", f);
    for (int i = 0; i < v->facets->n_facet; i++) {
        const int *corner = v->facets->corner + 4 * (size_t)i;
        fprintf(f, "f%d", i + 1);
        for (int k = 0; k < 4; k++) {
            fputc(',', f);
            if (k < 3 || corner[3] != corner[2]) hf_csv_write_id(v->scene->node_id[corner[k]], f);
        }
        fputc('\n', f);
    }
}

static void write_fixed(unsigned char fixed, FILE *f)
{
    const char *gap = "";
    if (fixed == 0x3f) fputs("all", f);
    for (int k = 0; k < HF_TRUSS_DOF && fixed != 0x3f; k++) {
        if (!(fixed >> k & 1)) continue;
        fprintf(f, "%s%s", gap, hf_dof_word[k]);
        gap = " ";
    }
}

static void write_truss_nodes(const void *context, FILE *f)
{
    const hf_truss *t = &((const view *)context)->truss;
    const double *u = ((const view *)context)->state.displacement;
    fprintf(f, "id,x_m,y_m,z_m,fixed,mass_kg%s\n", u ? ",ux_m,uy_m,uz_m,rx_rad,ry_rad,rz_rad" : "");
    for (int i = 0; i < t->n_node; i++) {
        const double *p = t->position_m + 3 * (size_t)i;
        hf_csv_write_id(t->node_id[i], f);
        fprintf(f, ",%.17g,%.17g,%.17g,", p[0], p[1], p[2]);
        write_fixed(t->fixed[i], f);
        fprintf(f, ",%.17g", t->mass_kg[i]);
        for (int c = 0; u && c < HF_TRUSS_DOF; c++)
            fprintf(f, ",%.17g", u[HF_TRUSS_DOF * (size_t)i + (size_t)c]);
        fputc('\n', f);
    }
}

static void write_members(const void *context, FILE *f)
{
    const hf_truss *t = &((const view *)context)->truss;
    const double *end_force = ((const view *)context)->state.end_force;
#define COLUMN_NAME(name, units, otherwise, description) "," #name
    fprintf(f, "id,i,j" HF_MEMBER_NUMBERS(COLUMN_NAME) ",joint,unit%s\n",
            end_force ? ",Nx_i_N,Vy_i_N,Vz_i_N,Tx_i_Nm,My_i_Nm,Mz_i_Nm,Nx_j_N,Vy_j_N,Vz_j_N,Tx_j_Nm,My_j_Nm,Mz_j_Nm"
                      : "");
#undef COLUMN_NAME
    for (int e = 0; e < t->n_member; e++) {
#define VALUE(name, units, otherwise, description) t->name[e],
        const double number[] = {HF_MEMBER_NUMBERS(VALUE)};
#undef VALUE
        hf_export_ends(t->member_id[e], t->node_id, t->end + 2 * e, f);
        for (size_t k = 0; k < sizeof number / sizeof *number; k++)
            fprintf(f, isfinite(number[k]) ? ",%.17g" : ",", number[k]); /* an infinite shear area is an empty cell */
        fprintf(f, ",%s,%s", hf_joint_word[t->joint[e]], hf_unit_word[t->unit[e]]);
        for (size_t k = 0; end_force && k < 12; k++)
            fprintf(f, ",%.17g", end_force[12 * (size_t)e + k]);
        fputc('\n', f);
    }
}

static hf_status export_csv(const hf_export_request *o, const hf_export_stored *stored, hf_messages *messages)
{
    static hf_export_file file[] = {{"nodes.csv", write_nodes, ""},
                                    {"cables.csv", write_cables, ""},
                                    {"facets.csv", write_facets, ""},
                                    {"truss_nodes.csv", write_truss_nodes, ""},
                                    {"members.csv", write_members, ""}};
    view v = {.scene = &stored->scene, .shape = &stored->shape, .facets = &stored->facets};
    bool has_truss = hf_export_has_truss(o, &stored->summary, messages);
    hf_status status = HF_OK;
    if (has_truss) status = hf_export_read_truss(o->file, o->load_case, &v.truss, &v.state, messages);
    file[2].write = stored->summary.surface.focal_length_m > 0 ? write_facets : NULL;
    if (status == HF_OK) status = hf_export_files(o, file, has_truss ? 5 : 3, &v, messages);
    char of_truss[2 * PATH_MAX + 128] = "";
    if (has_truss)
        snprintf(of_truss, sizeof of_truss,
                 "; %d nodes and %d members of the truss in %s/truss_nodes.csv and %s/members.csv", v.truss.n_node,
                 v.truss.n_member, o->output, o->output);
    hf_print_line(o->said, "%s: %d nodes and %d cables of the %s shape in %s/nodes.csv and %s/cables.csv%s", o->file,
                  v.scene->n_node, v.scene->n_cable, stored->word, o->output, o->output, of_truss);
    hf_truss_free(&v.truss);
    hf_carrier_state_free(&v.state);
    return status;
}

const hf_exporter hf_exporter_csv = {
    .option = "--csv",
    .argument = "DIR",
    .help = "write the tables nodes.csv, cables.csv, facets.csv (surface), truss_nodes.csv and members.csv (truss) "
            "into the folder DIR",
    .reads = HF_EXPORT_SHAPE,
    .takes_stage = true,
    .takes_case = true,
    .write = export_csv,
};

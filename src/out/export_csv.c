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
#include "base/file_out.h"
#include <hifdm/facets.h>

#include <math.h>
#include <string.h>

typedef struct {
    const hf_scene *scene;
    const hf_shape *shape;
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
        hf_export_ends_of(s, e, f);
        fprintf(f, ",%s,%.17g,%.17g,%.17g", hf_law_word[shape->law[e]], shape->length_m[e], shape->tension_N[e],
                shape->q_N_per_m[e]);
        hf_export_sets_of(s, e, f);
        fputc('\n', f);
    }
}

typedef struct {
    const hf_scene *scene;
    const hf_facets *facets;
} facets_view;

static void write_facets(const void *context, FILE *f)
{
    const facets_view *v = context;
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

/* Writes facets.csv, unless the net has no facets. */
static hf_status export_facets(const hf_export_request *o, const hf_export_stored *stored, const char *path,
                               hf_messages *messages)
{
    hf_facets facets;
    const facets_view both = {&stored->scene, &facets};
    hf_status status = hf_facets_find(&stored->scene, &stored->summary.surface, &facets);
    if (status != HF_OK)
        hf_error(messages, status, "%s: out of memory", o->file);
    else if (facets.n_facet > 0)
        status = hf_file_out_set_write(o->files, path, write_facets, &both, messages);
    hf_facets_free(&facets);
    return status;
}

typedef struct {
    const hf_truss *truss;
    const hf_carrier_state *state;
} truss_view;

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
    const hf_truss *t = ((const truss_view *)context)->truss;
    const double *u = ((const truss_view *)context)->state->displacement;
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
    const hf_truss *t = ((const truss_view *)context)->truss;
    const double *end_force = ((const truss_view *)context)->state->end_force;
#define COLUMN_NAME(name, units, otherwise, description) "," #name
    fprintf(f, "id,i,j" HF_MEMBER_NUMBERS(COLUMN_NAME) ",joint,unit%s\n",
            end_force ? ",Nx_i_N,Vy_i_N,Vz_i_N,Tx_i_Nm,My_i_Nm,Mz_i_Nm,Nx_j_N,Vy_j_N,Vz_j_N,Tx_j_Nm,My_j_Nm,Mz_j_Nm"
                      : "");
#undef COLUMN_NAME
    for (int e = 0; e < t->n_member; e++) {
#define VALUE(name, units, otherwise, description) t->name[e],
        const double number[] = {HF_MEMBER_NUMBERS(VALUE)};
#undef VALUE
        hf_csv_write_id(t->member_id[e], f);
        for (int k = 0; k < 2; k++) {
            fputc(',', f);
            hf_csv_write_id(t->node_id[t->end[2 * e + k]], f);
        }
        for (size_t k = 0; k < sizeof number / sizeof *number; k++)
            fprintf(f, isfinite(number[k]) ? ",%.17g" : ",", number[k]); /* an infinite shear area is an empty cell */
        fprintf(f, ",%s,%s", hf_joint_word[t->joint[e]], hf_unit_word[t->unit[e]]);
        for (size_t k = 0; end_force && k < 12; k++)
            fprintf(f, ",%.17g", end_force[12 * (size_t)e + k]);
        fputc('\n', f);
    }
}

static hf_status export_truss(const hf_export_request *o, hf_truss *truss, hf_carrier_state *state, char *said,
                              size_t size, hf_messages *messages)
{
    char nodes[PATH_MAX], members[PATH_MAX];
    const truss_view both = {truss, state};
    HF_TRY(hf_export_claim_in_folder(o, "truss_nodes.csv", nodes, messages));
    HF_TRY(hf_export_claim_in_folder(o, "members.csv", members, messages));
    HF_TRY(hf_store_read_truss(o->file, truss, state, messages));
    if (o->load_case) {
        hf_carrier_state_free(state);
        HF_TRY(hf_store_read_load_case_truss(o->file, o->load_case, truss, state, messages));
    }
    HF_TRY(hf_file_out_set_write(o->files, nodes, write_truss_nodes, &both, messages));
    HF_TRY(hf_file_out_set_write(o->files, members, write_members, &both, messages));
    size_t used = strlen(said);
    snprintf(said + used, size - used, "; %d nodes and %d members of the truss in %s and %s", truss->n_node,
             truss->n_member, nodes, members);
    return HF_OK;
}

static hf_status write_csv(const hf_export_request *o, const hf_export_stored *stored, char *said, size_t size,
                           hf_messages *messages)
{
    const hf_scene *scene = &stored->scene;
    static char nodes[PATH_MAX], cables[PATH_MAX], facets[PATH_MAX];
    bool is_measured = stored->summary.surface.focal_length_m > 0;
    HF_TRY(hf_export_claim_in_folder(o, "nodes.csv", nodes,
                                     messages)); /* all names are checked before a file is written */
    HF_TRY(hf_export_claim_in_folder(o, "cables.csv", cables, messages));
    if (is_measured) HF_TRY(hf_export_claim_in_folder(o, "facets.csv", facets, messages));
    HF_TRY(hf_file_out_folder(o->output, messages));
    const view both = {scene, &stored->shape};
    HF_TRY(hf_file_out_set_write(o->files, nodes, write_nodes, &both, messages));
    HF_TRY(hf_file_out_set_write(o->files, cables, write_cables, &both, messages));
    if (is_measured) HF_TRY(export_facets(o, stored, facets, messages));
    snprintf(said, size, "%s: %d nodes and %d cables of the %s shape in %s and %s", o->file, scene->n_node,
             scene->n_cable, stored->word, nodes, cables);
    if (!hf_export_has_truss(o, &stored->summary, messages)) return HF_OK;
    hf_truss truss = {0};
    hf_carrier_state state = {0};
    hf_status status = export_truss(o, &truss, &state, said, size, messages);
    hf_truss_free(&truss);
    hf_carrier_state_free(&state);
    return status;
}

static hf_status export_csv(const hf_export_request *request, char *said, size_t size, hf_messages *messages)
{
    return hf_export_shape(request, write_csv, said, size, messages);
}

const hf_exporter hf_exporter_csv = {
    .option = "--csv",
    .argument = "DIR",
    .help = "write nodes.csv, cables.csv, facets.csv of nets with a surface, and truss_nodes.csv and members.csv of a "
            "truss, into DIR",
    .takes_stage = true,
    .takes_case = true,
    .write = export_csv,
};

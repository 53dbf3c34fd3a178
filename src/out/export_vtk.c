/* Writes the shapes of a run for ParaView: VTKHDF 1.0 files with unstructured grids, which VTK 9.1, ParaView 5.11 and
 * newer versions read. The folder of --vtk receives these files, as far as the run has the shapes:
 *
 *   target.hdf, form.hdf, search.hdf, refine.hdf    cables as lines, at the target positions and of each stage
 *   form_facets.hdf and so on                       facets as cells over the same points
 *   truss.hdf                                       members as lines
 *   load_case_1.hdf, load_case_facets_1.hdf, load_case_truss_1.hdf, ...
 *                   load cases of the as-built net, in the order of the case
 *
 * ParaView opens files that differ only in a number as steps in time.
 *
 * Points and cells are in the order of the scene. Point data are role and load_N. A solved shape also has
 * displacement_m from the target positions and its magnitude deviation_m, and normal_error_m when the case measures the
 * surface. Cell data are group, law, length_m and EA_N. A solved shape also has tension_N, q_N_per_m, slack, and
 * length_change_m from the length at the target positions. Words are stored as numbers: role 0 support, 1 inner, 2
 * edge; group 0 inner, 1 boundary; law 0 tension, 1 length, 2 force_density, 3 elastic.
 *
 * Files of facets exist when the case measures the surface. Their cells are triangles and quadrilaterals. normal_mean_m
 * and normal_rms_m are mean and RMS over the facet of the error along the normal. fit_normal_mean_m and
 * fit_normal_rms_m are the same after the best fit to all facets; they are NaN when the fit does not converge.
 *
 * Point data of the truss are fixed (bit k: degree of freedom k is fixed), mass_kg, displacement_m and rotation_rad.
 * Its cell data are unit, joint and axial_force_N (tension > 0).
 *
 * Contents: a grid, its file, the shapes of a run, facets, the truss, load cases, all files together. */
#include "out/export.h"

#include "base/arena.h"
#include "base/text.h"
#include "net/target_surface.h"
#include "out/print.h"
#include "surface/facet_mesh.h"
#include "store/vtkhdf.h"
#include <hifdm/metrics.h>
#include <hifdm/store.h>
#include <hifdm/truss.h>

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define FIELDS_MAX 12 /* maximum number of point or cell fields of a file; add() asserts it */

/* ---- a grid ---- */

/* Describes a data field of a grid. The caller owns `values`. */
typedef struct {
    const char *name, *units;
    const hf_hdf5_kind *kind; /* NULL: values are unsigned char, and are stored as integers */
    int columns;
    const void *values;
} field;

typedef struct {
    int n;
    field of[FIELDS_MAX];
} fields;

typedef struct {
    int n_point, n_cell;
    const double *position_m;  /* [n_point][3], m */
    const int *corner;         /* [offset[n_cell]] points of the cells, one cell after the other */
    const int *offset;         /* [n_cell + 1] first point of each cell in `corner` */
    const unsigned char *type; /* [n_cell] type of each cell */
    fields point, cell;
} grid;

/* Appends a field to a list, unless it has no values. */
static void add(fields *list, const char *name, const char *units, const hf_hdf5_kind *kind, int columns,
                const void *values)
{
    if (!values) return;
    assert(list->n < FIELDS_MAX);
    list->of[list->n++] = (field){name, units, kind, columns, values};
}

/* ---- its file ---- */

static void put(hf_hdf5 *io, hid_t group, const field *f, int n)
{
    const hf_hdf5_kind *kind = f->kind ? f->kind : HF_KIND_INT;
    hf_hdf5_array array = {f->name, kind, f->columns > 1 ? 2 : 1, {(hsize_t)n, (hsize_t)f->columns}, f->units, ""};
    int *number = f->kind ? NULL : hf_hdf5_take(io, (size_t)n, sizeof *number);
    for (int i = 0; i < n && number; i++)
        number[i] = ((const unsigned char *)f->values)[i];
    hf_hdf5_write_array(io, group, &array, number ? number : f->values);
    free(number);
}

static void put_fields(hf_hdf5 *io, const char *path, const fields *list, int n)
{
    hid_t group = hf_hdf5_make_group(io, path);
    for (int i = 0; i < list->n; i++)
        put(io, group, &list->of[i], n);
    hf_hdf5_close(io, group);
}

/* Writes the file `name` in the folder of the request. */
static hf_status write_grid(const hf_export_request *o, const char *name, const grid *g, hf_messages *messages)
{
    char path[PATH_MAX];
    hf_file_out *out;
    HF_TRY(hf_export_claim_part(o, name, path, messages));
    HF_TRY(hf_file_out_set_begin(o->files, path, &out, messages));
    hf_hdf5 io = {.path = path, .messages = messages, .status = HF_OK, .file = -1};
    hf_hdf5_create_file(&io, out);
    hf_vtkhdf_put_cells(&io, &(hf_vtkhdf_cells){g->n_point, g->n_cell, g->corner, g->offset, g->type});
    hid_t group = hf_hdf5_open_group(&io, "/VTKHDF");
    put(&io, group, &(field){"Points", "m", HF_KIND_REAL, 3, g->position_m}, g->n_point);
    hf_hdf5_close(&io, group);
    put_fields(&io, "/VTKHDF/PointData", &g->point, g->n_point);
    put_fields(&io, "/VTKHDF/CellData", &g->cell, g->n_cell);
    hf_hdf5_close_file(&io);
    return io.status;
}

/* Makes all n cells lines; offset is [n + 1], type is [n]. */
static void set_lines(int n, int *offset, unsigned char *type)
{
    for (int e = 0; e <= n; e++)
        offset[e] = 2 * e;
    memset(type, HF_VTKHDF_LINE, (size_t)n);
}

/* ---- the shapes of a run ---- */

/* Holds computed values of nodes, cables and facets. */
typedef struct {
    int *offset; /* [n_cable + 1] */
    unsigned char *type, *slack;
    double *length_at_target_m, *displacement_m, *deviation_m, *normal_error_m, *length_change_m;
    bool has_truss;          /* a truss is written */
    const hf_facets *facets; /* empty when the case does not measure the surface */
    int *facet_corner, *facet_offset;
    unsigned char *facet_type;
    hf_facet_errors facet_error;
    void *block;
} scratch;

static hf_status allocate(const hf_scene *s, scratch *t)
{
    size_t n = (size_t)s->n_node, m = (size_t)s->n_cable, n_facet = (size_t)t->facets->n_facet;
    hf_facet_errors *e = &t->facet_error;
    return HF_ARENA_ARRAYS(&t->block, HF_ARRAY(t->slack, m), HF_ARRAY(t->offset, m + 1), HF_ARRAY(t->type, m),
                           HF_ARRAY(t->length_at_target_m, m), HF_ARRAY(t->displacement_m, 3 * n),
                           HF_ARRAY(t->deviation_m, n), HF_ARRAY(t->normal_error_m, n), HF_ARRAY(t->length_change_m, m),
                           HF_ARRAY(t->facet_corner, 4 * n_facet), HF_ARRAY(t->facet_offset, n_facet + 1),
                           HF_ARRAY(t->facet_type, n_facet), HF_ARRAY(e->normal_mean_m, n_facet),
                           HF_ARRAY(e->normal_rms_m, n_facet), HF_ARRAY(e->fit_normal_mean_m, n_facet),
                           HF_ARRAY(e->fit_normal_rms_m, n_facet));
}

/* Computes the fields of a shape; shape NULL stands for the target positions. */
static void fill(const hf_scene *s, const hf_shape *shape, const hf_summary *summary, scratch *t)
{
    const hf_surface_settings *surface = &summary->surface;
    double reference_N = hf_model_reference_N(s, summary->pretension_N);
    const double *position_m = shape ? shape->position_m : s->position_m;
    for (int i = 0; i < s->n_node; i++) {
        const double *p = position_m + 3 * (size_t)i, *p0 = s->position_m + 3 * (size_t)i;
        double *d = t->displacement_m + 3 * (size_t)i, slope[2];
        for (int c = 0; c < 3; c++)
            d[c] = p[c] - p0[c];
        t->deviation_m[i] = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
        double above = hf_target_surface_height_above(surface->kind, 1 / (4 * surface->focal_length_m), p, slope);
        t->normal_error_m[i] = above / sqrt(1 + slope[0] * slope[0] + slope[1] * slope[1]);
    }
    for (int e = 0; e < s->n_cable; e++) {
        t->length_at_target_m[e] = hf_scene_length_at_target(s, e);
        if (!shape) continue;
        t->length_change_m[e] = shape->length_m[e] - t->length_at_target_m[e];
        t->slack[e] = fabs(shape->tension_N[e]) < HF_SLACK_RATIO * reference_N;
    }
}

/* Returns the grid of cables of a shape; shape NULL stands for the target positions. */
static grid grid_of(const hf_scene *s, const hf_shape *shape, const hf_summary *summary, const scratch *t)
{
    grid g = {s->n_node, s->n_cable, s->position_m, s->end, t->offset, t->type, {0}, {0}};
    if (shape) g.position_m = shape->position_m;
    add(&g.point, "role", "", NULL, 1, s->role);
    add(&g.point, "load_N", "N", HF_KIND_REAL, 3, s->load_N);
    if (summary->surface.focal_length_m > 0) add(&g.point, "normal_error_m", "m", HF_KIND_REAL, 1, t->normal_error_m);
    add(&g.cell, "group", "", NULL, 1, s->group);
    add(&g.cell, "law", "", NULL, 1, shape ? shape->law : s->law);
    add(&g.cell, "length_m", "m", HF_KIND_REAL, 1, shape ? shape->length_m : t->length_at_target_m);
    add(&g.cell, "EA_N", "N", HF_KIND_REAL, 1, s->EA_N);
    if (!shape) return g;
    add(&g.point, "displacement_m", "m", HF_KIND_REAL, 3, t->displacement_m);
    add(&g.point, "deviation_m", "m", HF_KIND_REAL, 1, t->deviation_m);
    add(&g.cell, "tension_N", "N", HF_KIND_REAL, 1, shape->tension_N);
    add(&g.cell, "q_N_per_m", "N/m", HF_KIND_REAL, 1, shape->q_N_per_m);
    add(&g.cell, "length_change_m", "m", HF_KIND_REAL, 1, t->length_change_m);
    add(&g.cell, "slack", "", NULL, 1, t->slack);
    return g;
}

/* ---- facets ---- */

/* Makes the cells of facets. A triangle, whose last corner is stored twice, becomes a cell of three points. */
static void set_facet_cells(scratch *t)
{
    int n = 0;
    for (int i = 0; i < t->facets->n_facet; i++) {
        const int *corner = t->facets->corner + 4 * (size_t)i;
        int n_corner = corner[2] == corner[3] ? 3 : 4;
        t->facet_offset[i] = n;
        t->facet_type[i] = n_corner == 3 ? HF_VTKHDF_TRIANGLE : HF_VTKHDF_QUAD;
        for (int k = 0; k < n_corner; k++)
            t->facet_corner[n++] = corner[k];
    }
    t->facet_offset[t->facets->n_facet] = n;
}

/* Writes the grid of facets, over the points of the grid of cables. */
static hf_status write_facets(const hf_export_request *o, const char *name, const grid *cables, const hf_shape *found,
                              const hf_summary *summary, const scratch *t, hf_messages *messages)
{
    const hf_facet_shape shape = {cables->position_m, cables->n_cell, cables->corner, found ? found->tension_N : NULL,
                                  NULL};
    const hf_facet_errors *e = &t->facet_error;
    grid g = *cables;
    if (hf_facet_map(&summary->surface, t->facets, &shape, e) != HF_OK)
        return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", o->file);
    g.n_cell = t->facets->n_facet;
    g.corner = t->facet_corner;
    g.offset = t->facet_offset;
    g.type = t->facet_type;
    g.cell.n = 0;
    add(&g.cell, "normal_mean_m", "m", HF_KIND_REAL, 1, e->normal_mean_m);
    add(&g.cell, "normal_rms_m", "m", HF_KIND_REAL, 1, e->normal_rms_m);
    add(&g.cell, "fit_normal_mean_m", "m", HF_KIND_REAL, 1, e->fit_normal_mean_m);
    add(&g.cell, "fit_normal_rms_m", "m", HF_KIND_REAL, 1, e->fit_normal_rms_m);
    return write_grid(o, name, &g, messages);
}

/* ---- the truss ---- */

typedef struct {
    int *offset;
    unsigned char *type;
    double *displacement_m, *rotation_rad, *axial_force_N;
} truss_scratch;

static grid grid_of_truss(const hf_truss *truss, const hf_carrier_state *at, truss_scratch *t)
{
    grid g = {truss->n_node, truss->n_member, truss->position_m, truss->end, t->offset, t->type, {0}, {0}};
    set_lines(truss->n_member, t->offset, t->type);
    add(&g.point, "fixed", "", NULL, 1, truss->fixed);
    add(&g.point, "mass_kg", "kg", HF_KIND_REAL, 1, truss->mass_kg);
    add(&g.cell, "unit", "", NULL, 1, truss->unit);
    add(&g.cell, "joint", "", NULL, 1, truss->joint);
    if (!at->displacement || !at->end_force) return g;
    for (int k = 0; k < 3 * truss->n_node; k++) {
        const double *u = at->displacement + (size_t)k / 3 * HF_TRUSS_DOF;
        t->displacement_m[k] = u[k % 3];
        t->rotation_rad[k] = u[3 + k % 3];
    }
    for (size_t e = 0; e < (size_t)truss->n_member; e++)
        t->axial_force_N[e] = at->end_force[12 * e + HF_TRUSS_DOF]; /* at end j */
    add(&g.point, "displacement_m", "m", HF_KIND_REAL, 3, t->displacement_m);
    add(&g.point, "rotation_rad", "rad", HF_KIND_REAL, 3, t->rotation_rad);
    add(&g.cell, "axial_force_N", "N", HF_KIND_REAL, 1, t->axial_force_N);
    return g;
}

/* Writes the truss under the result of the run, or in a load case of the as-built net. */
static hf_status write_truss(const hf_export_request *o, const char *of_load_case, const char *name,
                             hf_messages *messages)
{
    hf_truss truss = {0};
    hf_carrier_state at = {0};
    void *block = NULL;
    truss_scratch t;
    hf_status status = hf_export_read_truss(o->file, of_load_case, &truss, &at, messages);
    if (status == HF_OK) {
        size_t n = (size_t)truss.n_node, m = (size_t)truss.n_member;
        status =
            HF_ARENA_ARRAYS(&block, HF_ARRAY(t.offset, m + 1), HF_ARRAY(t.type, m), HF_ARRAY(t.displacement_m, 3 * n),
                            HF_ARRAY(t.rotation_rad, 3 * n), HF_ARRAY(t.axial_force_N, m));
        if (status != HF_OK) hf_error(messages, status, "%s: out of memory", o->file);
    }
    if (status == HF_OK) {
        const grid g = grid_of_truss(&truss, &at, &t);
        status = write_grid(o, name, &g, messages);
    }
    hf_arena_free_block(block);
    hf_carrier_state_free(&at);
    hf_truss_free(&truss);
    return status;
}

/* ---- all files together ---- */

/* What is written: the shapes of the stages, the target positions, the truss of the result, then the load cases. */
enum { TARGET = HF_N_STAGE, TRUSS, N_FIXED };
enum { OF_NET, OF_FACETS, OF_TRUSS, N_PART };

typedef struct {
    const char *load_case; /* its name, or NULL */
    char name[N_PART][48]; /* of its files; "": it has no such file */
} item;

/* Sets *w to item i. Returns false if the run does not have it. */
static bool find_item(const hf_summary *s, const scratch *t, int i, item *w)
{
    static const char *const part[N_PART] = {"", "_facets", "_truss"};
    int k = i - N_FIXED;
    bool is_load_case = k >= 0;
    if (is_load_case ? s->load_case[k].result.status != HF_OK
                     : i < HF_N_STAGE && i != HF_STAGE_FORM && !hf_summary_has_shape(s, (hf_stage)i))
        return false;
    *w = (item){.load_case = is_load_case ? s->load_case[k].name : NULL};
    if (i == TRUSS) {
        if (t->has_truss) strcpy(w->name[OF_TRUSS], "truss.hdf");
        return t->has_truss;
    }
    for (int j = 0; j < N_PART; j++) {
        if (j == OF_FACETS ? t->facets->n_facet == 0 : j == OF_TRUSS && !(is_load_case && s->has_truss)) continue;
        if (is_load_case) /* ParaView opens files that differ only in a number as steps in time */
            snprintf(w->name[j], sizeof w->name[j], "load_case%s_%d.hdf", part[j], k + 1);
        else
            snprintf(w->name[j], sizeof w->name[j], "%s%s.hdf", i == TARGET ? "target" : hf_stage_word[i], part[j]);
    }
    return true;
}

/* Writes the net of item i, and its facets. */
static hf_status write_net(const hf_export_request *o, const hf_export_stored *stored, int i, const item *w, scratch *t,
                           hf_messages *messages)
{
    hf_shape shape = {0};
    const hf_shape *found = i == TARGET ? NULL : &shape;
    if (w->load_case) HF_TRY(hf_store_read_load_case(o->file, w->load_case, &shape, messages));
    if (i < HF_N_STAGE) HF_TRY(hf_store_read_shape(o->file, (hf_stage)i, &shape, messages));
    fill(&stored->scene, found, &stored->summary, t);
    const grid g = grid_of(&stored->scene, found, &stored->summary, t);
    hf_status status = write_grid(o, w->name[OF_NET], &g, messages);
    if (status == HF_OK && *w->name[OF_FACETS])
        status = write_facets(o, w->name[OF_FACETS], &g, found, &stored->summary, t, messages);
    hf_shape_free(&shape);
    return status;
}

static hf_status write_all(const hf_export_request *o, const hf_export_stored *stored, scratch *t,
                           hf_messages *messages)
{
    const hf_summary *s = &stored->summary;
    static const int order[N_FIXED] = {TARGET, HF_STAGE_FORM, HF_STAGE_SEARCH, HF_STAGE_REFINE, TRUSS};
    int n = N_FIXED + s->n_load_case;
    static char names[3 * PATH_MAX];
    char path[PATH_MAX];
    item w;
    *names = '\0';
    for (int i = 0; i < n; i++) { /* all names are checked before a file is written */
        if (!find_item(s, t, i, &w)) continue;
        for (int j = 0; j < N_PART; j++)
            if (*w.name[j]) HF_TRY(hf_export_claim_part(o, w.name[j], path, messages));
    }
    HF_TRY(hf_file_out_folder(o->output, messages));
    for (int k = 0; k < n; k++) {
        int i = k < N_FIXED ? order[k] : k;
        if (!find_item(s, t, i, &w)) continue;
        if (*w.name[OF_NET]) HF_TRY(write_net(o, stored, i, &w, t, messages));
        if (*w.name[OF_TRUSS]) HF_TRY(write_truss(o, w.load_case, w.name[OF_TRUSS], messages));
        for (int j = 0; j < N_PART; j++) {
            if (!*w.name[j] || (w.load_case && j != OF_NET)) continue;
            snprintf(path, sizeof path, w.load_case ? " %s (%s)" : " %s", w.name[j], w.load_case);
            hf_text_append(names, sizeof names, "", path, "");
        }
    }
    hf_print_line(o->said, "%s: for ParaView, in %s:%s", o->file, o->output, names);
    return HF_OK;
}

static hf_status export_vtk(const hf_export_request *o, const hf_export_stored *stored, hf_messages *messages)
{
    const hf_scene *scene = &stored->scene;
    scratch t = {.has_truss = hf_export_has_truss(o, &stored->summary, messages), .facets = &stored->facets};
    if (allocate(scene, &t) != HF_OK) return hf_error(messages, HF_NO_MEMORY, "%s: out of memory", o->file);
    set_lines(scene->n_cable, t.offset, t.type);
    set_facet_cells(&t);
    hf_status status = write_all(o, stored, &t, messages);
    hf_arena_free_block(t.block);
    return status;
}

const hf_exporter hf_exporter_vtk = {
    .option = "--vtk",
    .argument = "DIR",
    .help = "write every shape of the run with its facets into the folder DIR as VTKHDF files for ParaView",
    .reads = HF_EXPORT_SCENE,
    .takes_stage = false,
    .write = export_vtk,
};

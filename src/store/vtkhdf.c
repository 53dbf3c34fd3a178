/* Contents: cells - links - a result */
#include "store/vtkhdf.h"

#include "base/arena.h"
#include "store/layout.h"
#include <hifdm/store.h>

#include <stdio.h>
#include <string.h>

#define POINT_DATA "/VTKHDF/PointData"
#define CELL_DATA "/VTKHDF/CellData"
#define LINKS_MAX 1000 /* of a group: 3 for each of HF_STATES_MAX states and of 5 shapes, and a few more */

/* ---- cells ---- */

/* VTK's reader accepts this attribute only as an ASCII string. */
static void put_type(hf_hdf5 *io, hid_t group)
{
    static const char word[] = "UnstructuredGrid";
    hid_t type = -1, space = -1, attribute = -1;
    if (io->status != HF_OK) return;
    if ((type = H5Tcopy(H5T_C_S1)) < 0 || H5Tset_size(type, sizeof word - 1) < 0 ||
        H5Tset_strpad(type, H5T_STR_NULLPAD) < 0 || (space = H5Screate(H5S_SCALAR)) < 0 ||
        (attribute = H5Acreate2(group, "Type", type, space, H5P_DEFAULT, H5P_DEFAULT)) < 0 ||
        H5Awrite(attribute, type, word) < 0)
        hf_hdf5_fail(io, "write", group, "Type");
    hf_hdf5_close(io, attribute);
    hf_hdf5_close(io, space);
    hf_hdf5_close(io, type);
}

/* Numbers of one byte: as what VTK's reader expects the types of cells. */
static void put_bytes(hf_hdf5 *io, hid_t group, const char *name, int n, const void *values, const char *description)
{
    hid_t space = -1, properties = -1, data_set = -1;
    if (io->status != HF_OK) return;
    if ((space = H5Screate_simple(1, &(hsize_t){(hsize_t)n}, NULL)) < 0 ||
        (properties = H5Pcreate(H5P_DATASET_CREATE)) < 0 || H5Pset_obj_track_times(properties, 0) < 0 ||
        (data_set = H5Dcreate2(group, name, H5T_NATIVE_UCHAR, space, H5P_DEFAULT, properties, H5P_DEFAULT)) < 0 ||
        H5Dwrite(data_set, H5T_NATIVE_UCHAR, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
        hf_hdf5_fail(io, "write", group, name);
    hf_hdf5_close(io, properties);
    hf_hdf5_close(io, space);
    hf_hdf5_put_text(io, data_set, ".", "units", "");
    hf_hdf5_put_text(io, data_set, ".", "description", description);
    hf_hdf5_close(io, data_set);
}

/* A new group that keeps all its links in its header: the tables that HDF5 makes for more than eight take 4 KiB. */
static hid_t make_group(hf_hdf5 *io, const char *path)
{
    hid_t properties = -1, group = -1;
    if (io->status != HF_OK) return -1;
    if ((properties = H5Pcreate(H5P_GROUP_CREATE)) < 0 || H5Pset_obj_track_times(properties, 0) < 0 ||
        H5Pset_link_phase_change(properties, LINKS_MAX, LINKS_MAX - 1) < 0 ||
        (group = H5Gcreate2(io->file, path, H5P_DEFAULT, properties, H5P_DEFAULT)) < 0)
        hf_hdf5_fail(io, "write", -1, path);
    hf_hdf5_close(io, properties);
    return group;
}

static void put_numbers(hf_hdf5 *io, hid_t group, const char *name, const hf_hdf5_kind *kind, int n, const void *values)
{
    const hf_hdf5_array array = {name, kind, 1, {(hsize_t)n}, "", ""};
    hf_hdf5_write_array(io, group, &array, values);
}

void hf_vtkhdf_put_cells(hf_hdf5 *io, const hf_vtkhdf_cells *c)
{
    const long n_point = c->n_point, n_cell = c->n_cell, n_corner = c->offset[c->n_cell], version[2] = {1, 0};
    hid_t group = make_group(io, "/VTKHDF");
    hf_hdf5_put(io, group, ".", "Version", HF_KIND_LONG, 2, version);
    put_type(io, group);
    put_numbers(io, group, "NumberOfPoints", HF_KIND_LONG, 1, &n_point);
    put_numbers(io, group, "NumberOfCells", HF_KIND_LONG, 1, &n_cell);
    put_numbers(io, group, "NumberOfConnectivityIds", HF_KIND_LONG, 1, &n_corner);
    put_numbers(io, group, "Connectivity", HF_KIND_INT, (int)n_corner, c->corner);
    put_numbers(io, group, "Offsets", HF_KIND_INT, c->n_cell + 1, c->offset);
    put_bytes(io, group, "Types", c->n_cell, c->type, "");
    hf_hdf5_close(io, group);
    hf_hdf5_close(io, make_group(io, POINT_DATA));
    hf_hdf5_close(io, make_group(io, CELL_DATA));
}

/* ---- links ---- */

/* A second name for what is there. */
static void link_to(hf_hdf5 *io, const char *from, const char *to)
{
    if (hf_hdf5_has(io, io->file, from) && H5Lcreate_hard(io->file, from, io->file, to, H5P_DEFAULT, H5P_DEFAULT) < 0)
        hf_hdf5_fail(io, "write", io->file, to);
}

static void link_as(hf_hdf5 *io, const char *folder, const char *name, const char *group, const char *prefix)
{
    char from[HF_LAYOUT_STATE_SIZE + 32], to[HF_LAYOUT_STATE_SIZE + 64];
    snprintf(from, sizeof from, "%s/%s", folder, name);
    snprintf(to, sizeof to, "%s/%s%s", group, prefix, name);
    link_to(io, from, to);
}

/* The numbers of the cables of a shape, but the law, which is an enumeration. */
static void link_forces(hf_hdf5 *io, const char *folder, const char *prefix)
{
    link_as(io, folder, "tension_N", CELL_DATA, prefix);
    link_as(io, folder, "q_N_per_m", CELL_DATA, prefix);
    link_as(io, folder, "length_m", CELL_DATA, prefix);
}

static void link_shape(hf_hdf5 *io, const char *folder, const char *prefix)
{
    link_as(io, folder, "position_m", POINT_DATA, prefix);
    link_forces(io, folder, prefix);
}

static void link_all(hf_hdf5 *io, const char *result, const char *position, const hf_summary *summary)
{
    char folder[HF_LAYOUT_STATE_SIZE], prefix[HF_LAYOUT_STATE_SIZE];
    link_to(io, position, "/VTKHDF/Points");
    link_forces(io, result, "");
    for (int i = 0; i < HF_STAGE_NONE; i++) {
        snprintf(prefix, sizeof prefix, "%s_", hf_stage_word[i]);
        link_shape(io, hf_stage_group[i], prefix);
    }
    for (int k = 0; k < summary->n_state; k++) {
        snprintf(folder, sizeof folder, "/cases/%s", summary->state[k].name);
        snprintf(prefix, sizeof prefix, "case_%s_", summary->state[k].name);
        link_shape(io, folder, prefix);
    }
    link_as(io, "/scene/node", "position_m", POINT_DATA, "theoretical_");
    link_as(io, "/scene/node", "load_N", POINT_DATA, "");
    link_as(io, "/scene/cable", "length_m", CELL_DATA, "theoretical_");
    link_as(io, "/scene/cable", "EA_N", CELL_DATA, "");
    link_as(io, "/tolerance", "node_deviation_m", POINT_DATA, "tolerance_");
    link_as(io, "/tolerance", "cable_share", CELL_DATA, "tolerance_");
}

/* ---- a result ---- */

typedef struct {
    int *corner, *offset;
    unsigned char *bytes; /* a value of each node or of each cable */
} room;

static void lay_out(hf_arena *a, size_t n, size_t m, room *r)
{
    r->corner = hf_arena_take(a, 2 * m, sizeof *r->corner);
    r->offset = hf_arena_take(a, m + 1, sizeof *r->offset);
    r->bytes = hf_arena_take(a, n > m ? n : m, 1);
}

/* Copies an enumeration, as its numbers. */
static void copy_numbers(hf_hdf5 *io, const char *from, const hf_hdf5_kind *kind, int n, void *values,
                         const char *group, const char *name, const char *description)
{
    const hf_hdf5_array array = {.name = from, .kind = kind, .rank = 1, .dims = {(hsize_t)n}};
    hf_hdf5_read_array(io, io->file, &array, values);
    hid_t place = hf_hdf5_open_group(io, group);
    put_bytes(io, place, name, n, values, description);
    hf_hdf5_close(io, place);
}

void hf_vtkhdf_put_result(hf_hdf5 *io, const hf_summary *summary)
{
    const char *result = hf_stage_group[hf_store_result_stage(summary)];
    char position[32];
    snprintf(position, sizeof position, "%s/position_m", result);
    if (!hf_hdf5_has(io, io->file, position)) return;
    hf_layout_renew(io, "/VTKHDF");
    const int n = hf_hdf5_length(io, io->file, "/scene/node/role", HF_LAYOUT_COUNT_MAX);
    const int m = hf_hdf5_length(io, io->file, "/scene/cable/group", HF_LAYOUT_COUNT_MAX);
    const hf_hdf5_array end = {.name = "/scene/cable/end", .kind = HF_KIND_INT, .rank = 2, .dims = {(hsize_t)m, 2}};
    hf_arena arena = {0};
    room r;
    if (io->status == HF_OK && HF_ARENA_MAKE(&arena, lay_out(&arena, (size_t)n, (size_t)m, &r)) != HF_OK)
        hf_hdf5_no_memory(io);
    if (io->status == HF_OK) {
        for (int e = 0; e <= m; e++)
            r.offset[e] = 2 * e;
        memset(r.bytes, HF_VTKHDF_LINE, (size_t)m);
        hf_hdf5_read_array(io, io->file, &end, r.corner);
        hf_vtkhdf_put_cells(io, &(hf_vtkhdf_cells){n, m, r.corner, r.offset, r.bytes});
        copy_numbers(io, "/scene/node/role", HF_KIND_ROLE, n, r.bytes, POINT_DATA, "role",
                     "0 support, 1 inner, 2 edge");
        copy_numbers(io, "/scene/cable/group", HF_KIND_GROUP, m, r.bytes, CELL_DATA, "group", "0 inner, 1 boundary");
        link_all(io, result, position, summary);
    }
    hf_arena_free(&arena);
}

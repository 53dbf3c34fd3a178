/* Implements vtkhdf.h. Sections: cells, links, a result. */
#include "store/vtkhdf.h"

#include "store/layout.h"
#include <hifdm/store.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define POINT_DATA "/VTKHDF/PointData"
#define CELL_DATA "/VTKHDF/CellData"
#define LINKS_MAX 1000 /* in a group: 3 for each of HF_LOAD_CASES_MAX load cases and 5 shapes, and a few more */

/* ---- cells ---- */

/* Makes a group that keeps all its links in its header. The tables that HDF5 makes for more than eight links take 4
 * KiB. */
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

static void put_count(hf_hdf5 *io, hid_t group, const char *name, long count)
{
    hf_hdf5_write_list(io, group, name, HF_KIND_LONG, 1, 0, "", "", &count);
}

void hf_vtkhdf_put_cells(hf_hdf5 *io, const hf_vtkhdf_cells *c)
{
    const int n_corner = c->offset[c->n_cell];
    hid_t group = make_group(io, "/VTKHDF");
    hf_hdf5_put(io, group, ".", "Version", HF_KIND_LONG, 2, (const long[]){1, 0});
    hf_hdf5_put_ascii(io, group, ".", "Type", "UnstructuredGrid"); /* VTK's reader accepts no other kind of text */
    put_count(io, group, "NumberOfPoints", c->n_point);
    put_count(io, group, "NumberOfCells", c->n_cell);
    put_count(io, group, "NumberOfConnectivityIds", n_corner);
    hf_hdf5_write_packed(io, group, "Connectivity", HF_KIND_INT, n_corner, "", c->corner);
    hf_hdf5_write_packed(io, group, "Offsets", HF_KIND_INT, c->n_cell + 1, "", c->offset);
    hf_hdf5_write_packed(io, group, "Types", HF_KIND_BYTE, c->n_cell, "", c->type);
    hf_hdf5_close(io, group);
    hf_hdf5_close(io, make_group(io, POINT_DATA));
    hf_hdf5_close(io, make_group(io, CELL_DATA));
}

/* ---- links ---- */

/* Makes `to` a second name of the object `from`, if that exists. */
static void link_to(hf_hdf5 *io, const char *from, const char *to)
{
    if (hf_hdf5_has(io, io->file, from) && H5Lcreate_hard(io->file, from, io->file, to, H5P_DEFAULT, H5P_DEFAULT) < 0)
        hf_hdf5_fail(io, "write", io->file, to);
}

static void link_as(hf_hdf5 *io, const char *folder, const char *name, const char *group, const char *prefix)
{
    char from[HF_LAYOUT_LOAD_CASE_SIZE + 32], to[HF_LAYOUT_LOAD_CASE_SIZE + 64];
    snprintf(from, sizeof from, "%s/%s", folder, name);
    snprintf(to, sizeof to, "%s/%s%s", group, prefix, name);
    link_to(io, from, to);
}

/* Links the numbers of the cables of a shape. The law is left out, because it is an enumeration. */
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
    char folder[HF_LAYOUT_LOAD_CASE_SIZE], prefix[HF_LAYOUT_LOAD_CASE_SIZE];
    link_to(io, position, "/VTKHDF/Points");
    link_forces(io, result, "");
    for (int i = 0; i < HF_N_STAGE; i++) {
        snprintf(prefix, sizeof prefix, "%s_", hf_stage_word[i]);
        link_shape(io, hf_stage_group[i], prefix);
    }
    for (int k = 0; k < summary->n_load_case; k++) {
        snprintf(folder, sizeof folder, "/load_cases/%s", summary->load_case[k].name);
        snprintf(prefix, sizeof prefix, "load_case_%s_", summary->load_case[k].name);
        link_shape(io, folder, prefix);
    }
    link_as(io, "/scene/node", "position_m", POINT_DATA, "target_");
    link_as(io, "/scene/node", "load_N", POINT_DATA, "");
    link_to(io, "/scene/cable/length_m", CELL_DATA "/length_at_target_m");
    link_as(io, "/scene/cable", "EA_N", CELL_DATA, "");
    link_as(io, "/tolerance", "node_deviation_m", POINT_DATA, "tolerance_");
    link_as(io, "/tolerance", "cable_share", CELL_DATA, "tolerance_");
}

/* ---- a result ---- */

/* Copies an enumeration as its numbers. */
static void copy_numbers(hf_hdf5 *io, const char *from, const hf_hdf5_kind *kind, int n, void *values,
                         const char *group, const char *name, const char *description)
{
    hf_hdf5_read_list(io, io->file, from, kind, n, 0, values);
    hid_t place = hf_hdf5_open_group(io, group);
    hf_hdf5_write_packed(io, place, name, HF_KIND_BYTE, n, description, values);
    hf_hdf5_close(io, place);
}

void hf_vtkhdf_put_result(hf_hdf5 *io, const hf_summary *summary)
{
    const char *result = hf_stage_group[hf_store_result_stage(summary)];
    char position[32];
    snprintf(position, sizeof position, "%s/position_m", result);
    if (!hf_hdf5_has(io, io->file, position)) return;
    hf_layout_renew(io, io->file, "/VTKHDF");
    const int n = hf_hdf5_length(io, io->file, "/scene/node/role", HF_LAYOUT_COUNT_MAX);
    const int m = hf_hdf5_length(io, io->file, "/scene/cable/group", HF_LAYOUT_COUNT_MAX);
    int *corner = hf_hdf5_take(io, (size_t)m, 2 * sizeof *corner);
    int *offset = hf_hdf5_take(io, (size_t)m + 1, sizeof *offset);
    unsigned char *bytes = hf_hdf5_take(io, (size_t)(n > m ? n : m), 1); /* a value for each node or each cable */
    if (io->status == HF_OK) {
        for (int e = 0; e <= m; e++)
            offset[e] = 2 * e;
        memset(bytes, HF_VTKHDF_LINE, (size_t)m);
        hf_hdf5_read_list(io, io->file, "/scene/cable/end", HF_KIND_INT, m, 2, corner);
        hf_vtkhdf_put_cells(io, &(hf_vtkhdf_cells){n, m, corner, offset, bytes});
        copy_numbers(io, "/scene/node/role", HF_KIND_ROLE, n, bytes, POINT_DATA, "role", "0 support, 1 inner, 2 edge");
        copy_numbers(io, "/scene/cable/group", HF_KIND_GROUP, m, bytes, CELL_DATA, "group", "0 inner, 1 boundary");
        link_all(io, result, position, summary);
    }
    free(corner);
    free(offset);
    free(bytes);
}

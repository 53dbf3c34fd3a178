/* Writes the facets of a shape for physical-optics programs into the folder of --rf, in m, in the frame of the scene:
 *
 *   surface.grd: z over a regular grid of x and y, in the layout of GRASP's text files (TICRA's GRASP Technical
 *                Description, surfaces given by z-values in a rectangular grid). A line of text; XS YS XE YE, the
 *                corners; NX NY KLIMIT with KLIMIT = 0, so every row has all its points; then z, x fastest, one row for
 *                each y from YS. Outside the facets z is that of the target surface.
 *   points.csv : x,y,z,nx,ny,nz,dA: points on the facets, unit normals on the side of +z, and the areas that the points
 *                represent. Points are at most a wavelength of the highest frequency apart; there are 3 to 16 along
 *                a side.
 *   facets.stl : the flat facets as triangles, in text, counter-clockwise seen from +z.
 *
 * Facets under a mesh tension are pillows in the first two files. Numbers have 17 significant digits, those of the grid
 * 12.
 *
 * Contents: facets, grid, points, triangles, all files together. */
#include "out/export.h"

#include "base/arena.h"
#include "base/elementary.h"
#include "net/target_surface.h"
#include "out/print.h"
#include "surface/facet_mesh.h"

#include <math.h>

enum { GRID = 301, POINTS_LEAST = 3, POINTS_MOST = 16 };

typedef struct {
    const hf_export_stored *stored;
    double *sag_m;          /* [n_facet][4] sags of the sides; NULL: flat facets */
    double *z_m;            /* [n_y][n_x] of the grid */
    double low[2], high[2]; /* corners of the grid */
    int n[2], n_side;       /* points of the grid along x and y; points along each side of a facet */
} view;

/* ---- facets ---- */

/* Takes the mesh of facet i from the shape. */
static void take(const view *v, int i, hf_facet_mesh *m)
{
    hf_facet_mesh_take_bent(&v->stored->facets, i, v->stored->shape.position_m, v->sag_m, m);
}

/* Computes the sags of the pillows, if the mesh has a tension. Returns HF_BAD_USAGE when the cables cannot hold it. */
static hf_status find_sags(view *v, const char *file, hf_arena *arena, hf_messages *messages)
{
    const hf_export_stored *s = v->stored;
    const hf_facet_shape shape = {s->shape.position_m, s->scene.n_cable, s->scene.end, s->shape.tension_N, NULL};
    char words[64];
    double pull_ratio, mesh_N_per_m = s->summary.surface.mesh_tension_N_per_m, *sag_m;
    if (!(mesh_N_per_m > 0)) return HF_OK;
    hf_status status = hf_facet_mesh_make_sags(mesh_N_per_m, &v->stored->facets, &shape, arena, &sag_m, &pull_ratio);
    if (status != HF_OK) return hf_error(messages, status, "%s: out of memory for the facets of this net", file);
    v->sag_m = sag_m;
    if (pull_ratio <= HF_FACET_PULL_MOST) return HF_OK;
    return hf_error(messages, HF_BAD_USAGE,
                    "%s: the pillows of the %s shape are unknown, because the mesh pulls on %s. The pillow formula is "
                    "valid only up to a mesh force N l of %g times the cable tension. Raise the cable tensions, or "
                    "lower surface.mesh_tension_N_per_m",
                    file, s->word, hf_facet_mesh_pull_words(pull_ratio, words), HF_FACET_PULL_MOST);
}

/* Computes the extent of the grid and the numbers of points. */
static void measure(view *v)
{
    double longest_m = 0, most_Hz = hf_surface_highest_Hz(&v->stored->summary.surface);
    v->low[0] = v->low[1] = INFINITY;
    v->high[0] = v->high[1] = -INFINITY;
    for (int i = 0; i < 4 * v->stored->facets.n_facet; i++) {
        const int *corner = v->stored->facets.corner + i / 4 * 4;
        const double *p = v->stored->shape.position_m + 3 * (size_t)corner[i % 4];
        longest_m = fmax(longest_m, hf_distance(p, v->stored->shape.position_m + 3 * (size_t)corner[(i + 1) % 4]));
        for (int d = 0; d < 2; d++) {
            v->low[d] = fmin(v->low[d], p[d]);
            v->high[d] = fmax(v->high[d], p[d]);
        }
    }
    double n = ceil(longest_m * most_Hz / HF_LIGHT_M_PER_S);
    v->n_side = n < POINTS_LEAST ? POINTS_LEAST : n > POINTS_MOST ? POINTS_MOST : (int)n;
    double step = fmax(v->high[0] - v->low[0], v->high[1] - v->low[1]) / (GRID - 1);
    for (int d = 0; d < 2; d++) {
        v->n[d] = (int)ceil((v->high[d] - v->low[d]) / step - 1e-9) + 1;
        v->high[d] = v->low[d] + step * (v->n[d] - 1);
    }
}

/* ---- grid ---- */

/* Returns coordinate d of grid line i, m. */
static double place_of(const view *v, int d, int i)
{
    return v->low[d] + (v->high[d] - v->low[d]) * i / (v->n[d] - 1);
}

/* Returns whether (x, y) is on the facet, up to rounding, and sets uv to its parameters there. Newton's method inverts
 * the bilinear map. */
static bool is_on(const hf_facet_mesh *m, const double xy[2], double uv[2])
{
    uv[0] = uv[1] = 0.5;
    for (int k = 0; k < 20; k++) {
        double p[3], du[3], dv[3];
        hf_facet_mesh_at(m, uv[0], uv[1], p, du, dv);
        double det = du[0] * dv[1] - du[1] * dv[0], gap[2] = {xy[0] - p[0], xy[1] - p[1]};
        if (fabs(det) < 1e-300) return false; /* the doubled corner of a triangle; the point is on another facet, too */
        double step[2] = {(gap[0] * dv[1] - gap[1] * dv[0]) / det, (du[0] * gap[1] - du[1] * gap[0]) / det};
        uv[0] += step[0];
        uv[1] += step[1];
        if (fabs(step[0]) + fabs(step[1]) < 1e-13) break;
    }
    return uv[0] > -1e-9 && uv[0] < 1 + 1e-9 && uv[1] > -1e-9 && uv[1] < 1 + 1e-9;
}

/* Writes the grid points on facet i. A pillow that rises by h along the normal of the facet rises by h / normal_z along
 * z. */
static void put_facet(view *v, int i)
{
    hf_facet_mesh m;
    int from[2], to[2];
    take(v, i, &m);
    for (int d = 0; d < 2; d++) {
        double low = fmin(fmin(m.corner[0][d], m.corner[1][d]), fmin(m.corner[2][d], m.corner[3][d]));
        double high = fmax(fmax(m.corner[0][d], m.corner[1][d]), fmax(m.corner[2][d], m.corner[3][d]));
        double per_m = (v->n[d] - 1) / (v->high[d] - v->low[d]);
        from[d] = (int)fmax(ceil((low - v->low[d]) * per_m - 1e-6), 0);
        to[d] = (int)fmin(floor((high - v->low[d]) * per_m + 1e-6), v->n[d] - 1);
    }
    for (int y = from[1]; y <= to[1]; y++)
        for (int x = from[0]; x <= to[0]; x++) {
            double uv[2], p[3], du[3], dv[3], slope[2];
            const double xy[2] = {place_of(v, 0, x), place_of(v, 1, y)};
            if (!is_on(&m, xy, uv)) continue;
            hf_facet_mesh_at(&m, uv[0], uv[1], p, du, dv);
            double lift_m = v->sag_m ? hf_facet_mesh_lift_m(&m, uv[0], uv[1], slope) / m.normal[2] : 0;
            v->z_m[(size_t)y * (size_t)v->n[0] + (size_t)x] = p[2] + lift_m;
        }
}

/* Fills the grid: the target surface first, then the facets over it. */
static void fill_grid(view *v)
{
    const hf_surface_settings *s = &v->stored->summary.surface;
    double slope[2];
    for (int k = 0; k < v->n[0] * v->n[1]; k++) {
        const double p[3] = {place_of(v, 0, k % v->n[0]), place_of(v, 1, k / v->n[0]), 0};
        v->z_m[k] = -hf_target_surface_height_above(s->kind, 1 / (4 * s->focal_length_m), p, slope);
    }
    for (int i = 0; i < v->stored->facets.n_facet; i++)
        put_facet(v, i);
}

static void write_grid(const void *context, FILE *f)
{
    const view *v = context;
    fprintf(f,
            "z of the %s shape over x and y, m, frame of the scene: vertex of the target surface at 0, its axis +z\n",
            v->stored->word);
    fprintf(f, "%.17g %.17g %.17g %.17g\n%d %d 0\n", v->low[0], v->low[1], v->high[0], v->high[1], v->n[0], v->n[1]);
    for (int k = 0; k < v->n[0] * v->n[1]; k++)
        fprintf(f, "%.11e%c", v->z_m[k], (k + 1) % v->n[0] ? ' ' : '\n');
}

/* ---- points ---- */

static void write_points(const void *context, FILE *f)
{
    const view *v = context;
    fprintf(f,
            "# facets of the %s shape, %d points each: positions in m, unit normals on the side of +z, areas in m2\n"
            "# frame of the scene: vertex of the target surface at 0, its axis +z\n"
            "x,y,z,nx,ny,nz,dA\n",
            v->stored->word, v->n_side * v->n_side);
    for (int i = 0; i < v->stored->facets.n_facet; i++) {
        hf_facet_mesh m;
        take(v, i, &m);
        for (int k = 0; k < v->n_side * v->n_side; k++) {
            double p[3], du[3], dv[3], up[3];
            double a = (k % v->n_side + 0.5) / v->n_side, b = (k / v->n_side + 0.5) / v->n_side;
            if (v->sag_m)
                hf_facet_mesh_lifted(&m, a, b, p, du, dv);
            else
                hf_facet_mesh_at(&m, a, b, p, du, dv);
            hf_cross(du, dv, up);
            double size = hf_norm(up[0], up[1], up[2]);
            fprintf(f, "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", p[0], p[1], p[2], up[0] / size, up[1] / size,
                    up[2] / size, size / (v->n_side * v->n_side));
        }
    }
}

/* ---- triangles ---- */

static void write_triangle(const double *const corner[3], FILE *f)
{
    double side[2][3], up[3];
    for (int d = 0; d < 3; d++) {
        side[0][d] = corner[1][d] - corner[0][d];
        side[1][d] = corner[2][d] - corner[0][d];
    }
    hf_cross(side[0], side[1], up);
    double size = hf_norm(up[0], up[1], up[2]);
    fprintf(f, "facet normal %.9g %.9g %.9g\nouter loop\n", up[0] / size, up[1] / size, up[2] / size);
    for (int k = 0; k < 3; k++)
        fprintf(f, "vertex %.17g %.17g %.17g\n", corner[k][0], corner[k][1], corner[k][2]);
    fputs("endloop\nendfacet\n", f);
}

static void write_triangles(const void *context, FILE *f)
{
    const view *v = context;
    fputs("solid facets in m, frame of the scene\n", f);
    for (int i = 0; i < v->stored->facets.n_facet; i++) {
        hf_facet_mesh m;
        take(v, i, &m);
        write_triangle((const double *const[]){m.corner[0], m.corner[1], m.corner[2]}, f);
        if (!m.is_triangle) write_triangle((const double *const[]){m.corner[0], m.corner[2], m.corner[3]}, f);
    }
    fputs("endsolid facets in m, frame of the scene\n", f);
}

/* ---- all files together ---- */

/* Computes what the files hold, and writes them. */
static hf_status write_files(const hf_export_request *o, view *v, hf_messages *messages)
{
    static hf_export_file file[] = {
        {"surface.grd", write_grid, ""}, {"points.csv", write_points, ""}, {"facets.stl", write_triangles, ""}};
    hf_arena sags = {0}, grid = {0};
    measure(v);
    hf_status status = find_sags(v, o->file, &sags, messages);
    size_t n = (size_t)v->n[0] * (size_t)v->n[1];
    if (status == HF_OK && HF_ARENA_MAKE(&grid, v->z_m = hf_arena_take(&grid, n, sizeof(double))) != HF_OK)
        status = hf_error(messages, HF_NO_MEMORY, "%s: out of memory for the facets of this net", o->file);
    if (status == HF_OK) fill_grid(v);
    if (status == HF_OK) status = hf_export_files(o, file, 3, v, messages);
    hf_arena_free(&sags);
    hf_arena_free(&grid);
    return status;
}

static hf_status export_rf(const hf_export_request *o, const hf_export_stored *stored, hf_messages *messages)
{
    view v = {.stored = stored};
    if (!(stored->summary.surface.focal_length_m > 0))
        return hf_error(messages, HF_BAD_USAGE,
                        "%s: the facets have no target surface, because the case has no `surface` section", o->file);
    if (stored->facets.n_facet == 0) return hf_error(messages, HF_BAD_USAGE, "%s: this net has no facets", o->file);
    HF_TRY(write_files(o, &v, messages));
    hf_print_line(
        o->said,
        "%s: %d facets of the %s shape: grid of %d x %d in %s/surface.grd, %d points in %s/points.csv, triangles "
        "in %s/facets.stl",
        o->file, stored->facets.n_facet, stored->word, v.n[0], v.n[1], o->output,
        stored->facets.n_facet * v.n_side * v.n_side, o->output, o->output);
    return HF_OK;
}

const hf_exporter hf_exporter_rf = {
    .option = "--rf",
    .argument = "DIR",
    .help = "write surface.grd, points.csv with normals and areas, and facets.stl for physical-optics programs into "
            "the folder DIR",
    .reads = HF_EXPORT_SHAPE,
    .takes_stage = true,
    .takes_case = true,
    .write = export_rf,
};

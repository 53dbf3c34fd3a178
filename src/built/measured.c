/* Reads measured positions and compares them with the nominal net. Contents: the table, another unit or frame, nodes
 * far away. */
#include "built/measured.h"

#include "base/arena.h"
#include "base/csv.h"
#include "base/elementary.h"
#include "base/text.h"

#include <math.h>
#include <stdio.h>

enum { ID, X, Y, Z, SIGMA, N_COLUMN };
static const char *const column_name[N_COLUMN] = {"id", "x_m", "y_m", "z_m", "sigma_m"};
/* Columns of `hifdm export --csv` that are ignored. */
static const char *const ours[] = {"x0_m", "y0_m", "z0_m", "role", NULL};
#define SPARE_COLUMNS 64
/* Measured nodes that can move. Fewer do not determine a displacement and a rotation of the whole net. */
#define NODES_MIN 3

/* ---- the table ---- */

/* Returns the standard deviation of the node in row r: its own, or sigma_m. */
static double read_sigma(hf_csv *t, const int *where, int r, const char *id, double sigma_m)
{
    bool is_given = where[SIGMA] >= 0 && *hf_csv_cell(t, r, where[SIGMA]);
    if (is_given) sigma_m = hf_csv_number(t, r, where[SIGMA], id, column_name[SIGMA]);
    if (is_given && sigma_m <= 0) hf_csv_fault(t, t->line[r], id, "sigma_m must be above zero", "");
    if (!is_given && !(sigma_m > 0))
        hf_csv_fault(t, t->line[r], id, "has no sigma_m; add the column, or adjust.sigma_m for all nodes", "");
    return sigma_m;
}

static void read_node(hf_csv *t, const int *where, int r, int row, double sigma_m, hf_measured *measured)
{
    const char *id = hf_csv_cell(t, r, where[ID]);
    double sigma = read_sigma(t, where, r, id, sigma_m);
    for (int c = 0; c < 3; c++) {
        measured->position_m[3 * row + c] = hf_csv_number(t, r, where[X + c], id, column_name[X + c]);
        measured->weight_per_m2[3 * row + c] = 1 / (sigma * sigma);
    }
    measured->line[row] = t->line[r];
    measured->n_node++;
}

/* Reads all rows. hf_csv_index reports ids that are empty or repeated. */
static hf_status read_nodes(hf_csv *t, const int *where, const hf_scene *scene, const hf_model *m, double sigma_m,
                            hf_measured *measured)
{
    HF_TRY(hf_csv_index(t, where[ID]));
    HF_TRY(hf_csv_know(t, m->n_node, scene->node_id));
    for (int r = 0; r < t->n_row; r++) {
        const char *id = hf_csv_cell(t, r, where[ID]);
        int node = hf_csv_find_known(t, id);
        if (node >= 0)
            read_node(t, where, r, m->row_of_node[node], sigma_m, measured);
        else if (*id)
            hf_csv_fault(t, t->line[r], id, "the net has no node with this id", "");
    }
    return hf_csv_close_faults(t);
}

/* Returns HF_BAD_CASE unless enough nodes that can move were measured. */
static hf_status count_nodes(const char *path, const hf_model *m, const hf_measured *measured, hf_messages *messages)
{
    int n = 0;
    for (int row = 0; row < m->n_free + m->n_attachment; row++)
        n += measured->line[row] > 0;
    if (n >= NODES_MIN) return HF_OK;
    return hf_error(messages, HF_BAD_CASE,
                    "%s: the file has positions of %d free node%s, but hifdm needs at least %d positions", path, n,
                    n == 1 ? "" : "s", NODES_MIN);
}

hf_status hf_measured_read(const char *path, const hf_scene *scene, const hf_model *m, double sigma_m,
                           hf_measured *measured, hf_messages *messages)
{
    hf_csv table = {0};
    int where[N_COLUMN];
    size_t n = (size_t)m->n_node;
    *measured = (hf_measured){0};
    hf_status status = hf_csv_read(path, N_COLUMN + SPARE_COLUMNS, &table, messages);
    table.ours = ours;
    if (status == HF_OK) status = hf_csv_find_columns(&table, column_name, N_COLUMN, Z + 1, where);
    if (status == HF_OK && HF_ARENA_ARRAYS(&measured->block, HF_ARRAY(measured->position_m, 3 * n),
                                           HF_ARRAY(measured->weight_per_m2, 3 * n), HF_ARRAY(measured->line, n)))
        status = hf_csv_no_memory(&table);
    if (status == HF_OK) status = read_nodes(&table, where, scene, m, sigma_m, measured);
    hf_csv_free(&table);
    return status == HF_OK ? count_nodes(path, m, measured, messages) : status;
}

/* ---- another unit or frame ---- */

/* Describes the rigid motion that fits the measured positions best to the nominal ones. */
typedef struct {
    double centre_m[2][3]; /* centres of the nominal and of the measured positions */
    double spread[2];      /* sums of squares of the distances from these centres */
    double square, rest;   /* sums of squares of the differences before and after the motion */
    double angle;          /* angle of rotation, rad */
} rigid_fit;

static const double *measured_at(const hf_measured *measured, int row)
{
    return measured->position_m + 3 * (ptrdiff_t)row;
}

static double nominal_at(const hf_built *b, int row, int c)
{
    return b->position_m[c * b->model.n_node + row];
}

/* Computes the sums over the measured nodes. product [3][3] is the sum of nominal times measured coordinates about the
 * centres. */
static void sum_up(const hf_built *b, const hf_measured *measured, rigid_fit *f, double product[3][3])
{
    for (int row = 0; row < b->model.n_node; row++)
        for (int c = 0; c < 3 && measured->line[row]; c++) {
            double x = nominal_at(b, row, c), y = measured_at(measured, row)[c];
            f->centre_m[0][c] += x / measured->n_node;
            f->centre_m[1][c] += y / measured->n_node;
            f->square += (y - x) * (y - x);
        }
    for (int row = 0; row < b->model.n_node; row++)
        for (int c = 0; c < 3 && measured->line[row]; c++) {
            double x = nominal_at(b, row, c) - f->centre_m[0][c];
            f->spread[0] += x * x;
            for (int d = 0; d < 3; d++) {
                double y = measured_at(measured, row)[d] - f->centre_m[1][d];
                product[c][d] += x * y;
                if (c == d) f->spread[1] += y * y;
            }
        }
}

/* Finds the rotation by Horn's method (J. Opt. Soc. Am. A 4, 1987). Its quaternion is the eigenvector of the largest
 * eigenvalue of a symmetric 4 x 4 matrix. Repeated squaring of this matrix leaves that eigenvector. Returns the
 * eigenvalue and sets *angle, rad. */
static double rotate(double s[3][3], double *angle)
{
    double trace = s[0][0] + s[1][1] + s[2][2], size = 0, best = 0, value = 0;
    double n[4][4] = {{trace, s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]}}, power[4][4], next[4][4];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            n[i + 1][j + 1] = s[i][j] + s[j][i] - (i == j ? trace : 0);
    for (int i = 1; i < 4; i++)
        n[i][0] = n[0][i];
    for (int i = 0; i < 16; i++)
        size = fmax(size, fabs(n[i / 4][i % 4]));
    for (int i = 0; i < 16; i++)
        /* The shift makes all eigenvalues positive. */
        power[i / 4][i % 4] = n[i / 4][i % 4] + (i % 5 == 0 ? 4 * size : 0);
    for (int k = 0; k < 40; k++) {
        for (int i = 0; i < 16; i++) {
            next[i / 4][i % 4] = 0;
            for (int l = 0; l < 4; l++)
                next[i / 4][i % 4] += power[i / 4][l] * power[l][i % 4];
        }
        double largest = fmax(fmax(next[0][0], next[1][1]), fmax(next[2][2], next[3][3]));
        for (int i = 0; i < 16; i++)
            power[i / 4][i % 4] = next[i / 4][i % 4] / largest;
    }
    int column = 0;
    for (int i = 0; i < 4; i++)
        if (power[i][i] > best) best = power[i][i], column = i;
    double q[4], norm = 0;
    for (int i = 0; i < 4; i++)
        norm += power[i][column] * power[i][column];
    for (int i = 0; i < 4; i++)
        q[i] = power[i][column] / sqrt(norm);
    for (int i = 0; i < 16; i++)
        value += q[i / 4] * n[i / 4][i % 4] * q[i % 4];
    *angle = 2 * acos(fmin(fabs(q[0]), 1));
    return value;
}

/* Returns the best rigid motion. What it leaves is the sum of both spreads minus twice the eigenvalue. */
static rigid_fit fit_motion(const hf_built *b, const hf_measured *measured)
{
    rigid_fit f = {0};
    double product[3][3] = {{0}};
    sum_up(b, measured, &f, product);
    f.rest = fmax(f.spread[0] + f.spread[1] - 2 * rotate(product, &f.angle), 0);
    return f;
}

/* Returns the unit of lengths that are `ratio` times as large as in metres; NULL: metres, or no known unit. */
static const char *guess_unit(double ratio)
{
    static const struct {
        double per_m;
        const char *name;
    } unit[] = {{1000, "mm"}, {100, "cm"}, {1e6, "um"}, {1e-3, "km"}, {39.37, "inches"}, {3.2808, "feet"}};
    for (size_t i = 0; i < sizeof unit / sizeof *unit; i++)
        if (fabs(ratio / unit[i].per_m - 1) < 0.02) return unit[i].name;
    return NULL;
}

/* ---- nodes far away ---- */

#define FAR 10.0      /* times its expected distance: a node farther off is reported as a fault */
#define DOUBTFUL 3.0  /* times the expected RMS distance: above it, a motion that explains it gives a warning */
#define EXPLAINED 0.1 /* fraction of the sum of squares that a motion may leave unexplained */
#define VAGUE 30.0    /* times the expected displacements: a larger sigma_m may be in another unit */
#define MANY 0.2      /* fraction of the nodes: up to it, distant nodes are reported one by one */
#define FRAME_SIZE 256

static void describe_motion(const rigid_fit *f, int n, char text[FRAME_SIZE])
{
    snprintf(text, FRAME_SIZE,
             "a shift of the centre of the nodes by (%.4g, %.4g, %.4g) mm and a rotation by %.4g degrees explain all "
             "but %.3g mm",
             (f->centre_m[1][0] - f->centre_m[0][0]) * 1e3, (f->centre_m[1][1] - f->centre_m[0][1]) * 1e3,
             (f->centre_m[1][2] - f->centre_m[0][2]) * 1e3, f->angle / HF_RAD_PER_DEG, sqrt(f->rest / n) * 1e3);
}

/* Returns the distance between measured and nominal position of a node, m. */
static double distance_of(const hf_built *b, const hf_measured *measured, int row)
{
    double square = 0;
    for (int c = 0; c < 3; c++) {
        double d = measured_at(measured, row)[c] - nominal_at(b, row, c);
        square += d * d;
    }
    return sqrt(square);
}

/* Returns the expected RMS distance of a node by errors and measurement, m. */
static double allowed_m(const double *expected_m, double all_m, const hf_measured *measured, int row)
{
    double weight = measured->weight_per_m2[3 * row], own = fmax(expected_m[row], all_m);
    return sqrt(own * own + 3 / weight);
}

/* Reports what explains the positions of all nodes: another unit, another frame, or another net. Returns
 * HF_BAD_CASE. */
static hf_status explain_far(const char *path, const hf_built *b, double all_m, const hf_measured *measured,
                             hf_messages *messages)
{
    char frame[FRAME_SIZE];
    rigid_fit f = fit_motion(b, measured);
    double rms_m = sqrt(f.square / measured->n_node);
    const char *unit = guess_unit(sqrt(f.spread[1] / f.spread[0]));
    describe_motion(&f, measured->n_node, frame);
    if (unit)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the positions seem to be in %s, but the columns x_m, y_m and z_m must be in m", path,
                        unit);
    if (f.rest < EXPLAINED * f.square)
        return hf_error(messages, HF_BAD_CASE,
                        "%s: the nodes are %.4g mm RMS from their design positions, but the `tolerance` section allows "
                        "for only %.3g mm: %s. Transform the positions into the coordinate frame of the case",
                        path, rms_m * 1e3, all_m * 1e3, frame);
    return hf_error(
        messages, HF_BAD_CASE,
        "%s: the nodes are %.4g mm RMS from their design positions, but the `tolerance` section allows for only %.3g "
        "mm. The positions belong to another net, or the errors of the net are larger than in this section",
        path, rms_m * 1e3, all_m * 1e3);
}

/* Reports the distant nodes one by one, at most HF_FAULT_MAX of them. */
static void name_far(const char *path, const hf_built *b, const double *expected_m, double all_m,
                     const hf_measured *measured, hf_messages *messages)
{
    int n = 0;
    for (int i = 0; i < b->model.n_node; i++) {
        int row = b->model.row_of_node[i];
        if (!measured->line[row]) continue;
        double far_m = distance_of(b, measured, row), allowed = allowed_m(expected_m, all_m, measured, row);
        if (far_m <= FAR * allowed || n++ >= HF_FAULT_MAX) continue;
        hf_error(messages, HF_BAD_CASE,
                 "%s:%d: node '%s' is %.4g mm from its design position, but sigma_m and the `tolerance` section allow "
                 "for only %.3g mm. Check the id and the coordinates, and correct or remove the line",
                 path, measured->line[row], b->scene.node_id[i], far_m * 1e3, allowed * 1e3);
    }
}

hf_status hf_measured_check(const char *path, const hf_built *b, const double *expected_m, const hf_measured *measured,
                            hf_messages *messages)
{
    double square = 0, allowed_square = 0;
    int n_far = 0;
    for (int row = 0; row < b->model.n_node; row++)
        if (measured->line[row]) square += expected_m[row] * expected_m[row] / measured->n_node;
    double all_m = sqrt(square);
    for (int row = 0; row < b->model.n_node; row++) {
        if (!measured->line[row]) continue;
        double allowed = allowed_m(expected_m, all_m, measured, row);
        allowed_square += allowed * allowed;
        n_far += !(distance_of(b, measured, row) <= FAR * allowed);
    }
    if (n_far > MANY * measured->n_node) return explain_far(path, b, all_m, measured, messages);
    if (n_far) {
        name_far(path, b, expected_m, all_m, measured, messages);
        return HF_BAD_CASE;
    }
    double tells_m = sqrt(allowed_square / measured->n_node - all_m * all_m);
    if (tells_m > VAGUE * all_m)
        hf_warning(messages,
                   "%s: a sigma_m of about %.3g m makes these positions almost useless, because the given tolerances "
                   "displace the nodes by only %.3g m",
                   path, tells_m / sqrt(3), all_m);
    rigid_fit f = fit_motion(b, measured);
    if (f.square > DOUBTFUL * DOUBTFUL * allowed_square && f.rest < EXPLAINED * f.square) {
        char frame[FRAME_SIZE];
        describe_motion(&f, measured->n_node, frame);
        hf_warning(messages, "%s: %s. Are the positions in the coordinate frame of the case?", path, frame);
    }
    return HF_OK;
}

/* `hifdm new` writes a new case: commented, complete, and ready to run. */
#include "app/options.h"

#include "base/file_out.h"
#include "out/print.h"

#include <string.h>

/* ---- the texts: '@' stands for the name ---- */

static const char head[] =
    "# Lengths are in m, forces in N; the unit is the last part of a name. `hifdm schema` prints every key.\n"
    "#     hifdm check @.yaml     what would run, how large it is, how long it takes\n"
    "#     hifdm run @.yaml       writes @.h5\n"
    "#     hifdm report @.h5      writes @.html, a page to look at\n";

#define STIFFNESS                                                                                                      \
    "  EA_inner_N: 47000           # stiffness of the cables: for unstressed lengths; an aramid cord of 1 mm\n"        \
    "  EA_boundary_N: 47000\n"
#define SURFACE "surface:                      # errors of the mesh between the nodes, and what they cost\n"
#define OPTIMIZE                                                                                                       \
    "# The optimisation: tensions of the boundary cables, each within range_N, for the minimum psi.\n"                 \
    "# Leave this section out for form-finding only.\n"                                                                \
    "optimize:\n"                                                                                                      \
    "  method: auto                # refinements from several starts; ga: the genetic algorithm alone\n"

static const char paraboloid[] =
    "# A round mesh reflector: a front net on the paraboloid, a rear net behind it, ties between them.\n"
    "title: @\n"
    "\n"
    "scene:\n" STIFFNESS "  paraboloid:\n"
    "    aperture_m: 6\n"
    "    focal_length_m: 3\n"
    "    offset_m: 0               # of the middle of the aperture from the axis; 0: fed from the centre\n"
    "    rings: 8                  # of triangles; more of them: smaller facets, a smoother surface\n"
    "    rear_distance_m: 1.8      # from the front rim to the rear one\n"
    "\n"
    "form:\n"
    "  pretension_N: 10            # what the cables of the front net are to have\n"
    "  prestress: exact            # tensions, as even as balance allows, that hold every node on its surface\n"
    "\n" SURFACE "  frequencies_Hz: [2e9, 10e9]\n"
    "\n"
    "# Flat facets lie inside of their surface. A feed that is moved to the best fit makes good most of this error. "
    "This "
    "lets\n"
    "# the ties vary until the rest is as small as it gets, so the gain rises. Leave it out for form-finding only.\n"
    "optimize:\n"
    "  method: auto                # least squares from several starts; ga: the genetic algorithm\n"
    "  variables: [{set: tie, vary: force_density, range: 50 %}]   # of the value that each has, either way\n"
    "  objective:\n"
    "    - {figure: facets, feed: refocused, along: half_path}   # error of the facets that a radio wave sees\n"
    "    - {figure: psi, weight: 0.3}  # keeps the nodes on their surface; without this row the nets move by 0.1 m\n"
    "\n"
    "# The hoop truss that carries both rims, CFRP tubes; without it the rims are rigid.\n"
    "# truss:\n"
    "#   ring: {cells_per_bay: 2, bracing: single, held: bay}\n"
    "\n"
    "# What becomes of the net when it is cut as long as it should be, give or take 0.01 mm. An error of 0.1 mm in a "
    "cable of\n"
    "# 0.75 m is one of EA x 0.1 mm/0.75 m = 6 N, and the ties have 2 N: they would be slack. With pretension_N: 100 "
    "none is.\n"
    "# tolerance: {sigma_cut_m: 1e-5, samples: 1000}\n";

static const char cylinder[] =
    "# A parabolic cylinder, one net whose scalloped edges hang between supports at the corners of its modules. A "
    "single\n"
    "# net without ties bows between its supports: psi says how far it is from the theoretical surface.\n"
    "title: @\n"
    "\n"
    "scene:\n" STIFFNESS "  parabolic_cylinder:\n"
    "    aperture_m: 10            # along the directrix, the parabola (x)\n"
    "    length_m: 12              # along the generatrix, which is straight (y)\n"
    "    focal_length_m: 15\n"
    "    modules: [10, 4]          # along x and y; supports at all corners of modules\n"
    "    cells_per_module: [2, 2]  # cells of the net in each\n"
    "    pattern: triangle         # or quad, alternating, diagonal\n"
    "    boundary: outer_edge      # these cables keep their length, all others their tension\n"
    "    scallop: 0.1              # sag of the free edges, as a part of their span\n"
    "\n"
    "form:\n"
    "  pretension_N: 10\n"
    "\n" OPTIMIZE "  range_N: 1\n"
    "  seed: 1                     # the same seed gives the same result, to the bit\n"
    "\n" SURFACE "  frequencies_Hz: [1e9]\n";

static const char import[] =
    "# A net of your own in two tables. This one is a small net over a parabolic cylinder, z = x^2/10, whose free "
    "edges\n"
    "# sag inward and whose inner nodes are tied to supports behind it: the optimisation finds what the ties have to "
    "pull.\n"
    "# Put your own rows in; `hifdm check` reports errors in them by line and id.\n"
    "title: @\n"
    "\n"
    "scene:\n"
    "  import:\n"
    "    nodes: @_nodes.csv        # relative to this file\n"
    "    cables: @_cables.csv\n"
    "\n"
    "form:\n"
    "  pretension_N: 20            # of the cables whose law is tension and whose value is empty\n"
    "\n" OPTIMIZE "  range_N: 4\n";

static const char nodes[] = "# id: any text. Where the node is in theory (a support: where it is). role: support, "
                            "edge, or inner (psi counts these)\n"
                            "# Places in millimetres: columns x_mm,y_mm,z_mm.\n"
                            "# Loads, if there are some: columns Fx_N,Fy_N,Fz_N.\n"
                            "id,x_m,y_m,z_m,role\n"
                            "s1,-1.5,-1,0.225,support\nn1,-1.5,1,0.225,support\n"
                            "s2,-0.5,-1,0.025,support\nn2,-0.5,1,0.025,support\n"
                            "s3,0.5,-1,0.025,support\nn3,0.5,1,0.025,support\n"
                            "s4,1.5,-1,0.225,support\nn4,1.5,1,0.225,support\n"
                            "rp,-0.5,0,-0.8,support\nrq,0.5,0,-0.8,support\n"
                            "w,-1.1,0,0.121,edge\np,-0.5,0,0.025,inner\n"
                            "q,0.5,0,0.025,inner\ne,1.1,0,0.121,edge\n";

static const char cables[] =
    "# i, j: the nodes of a cable. group: boundary (the optimisation sets their tensions) or inner.\n"
    "# law: tension (value in N; empty: form.pretension_N), length (m; empty: that between the theoretical nodes),\n"
    "# force_density (N/m), elastic (unstressed length, m; needs EA_N). EA_N: stiffness, if known.\n"
    "id,i,j,group,law,value,EA_N\n"
    "b1,s1,w,boundary,length,,47000\nb2,w,n1,boundary,length,,47000\n"
    "b3,s4,e,boundary,length,,47000\nb4,e,n4,boundary,length,,47000\n"
    "tie1,p,rp,boundary,tension,5,47000\ntie2,q,rq,boundary,tension,5,47000\n"
    "c1,s2,p,inner,tension,,47000\nc2,p,n2,inner,tension,,47000\n"
    "c3,s3,q,inner,tension,,47000\nc4,q,n3,inner,tension,,47000\n"
    "c5,w,p,inner,tension,,47000\nc6,p,q,inner,tension,,47000\n"
    "c7,q,e,inner,tension,,47000\n";

static const char *const case_text[] = {[HF_NEW_UNSAID] = paraboloid,
                                        [HF_NEW_PARABOLOID] = paraboloid,
                                        [HF_NEW_CYLINDER] = cylinder,
                                        [HF_NEW_IMPORT] = import};

/* ---- writing ---- */

typedef struct {
    const char *name, *head, *text;
} new_text;

static void put_named(const char *text, const char *name, FILE *f)
{
    for (; *text; text++) {
        if (*text == '@')
            fputs(name, f);
        else
            fputc(*text, f);
    }
}

static void write_text(const void *context, FILE *f)
{
    const new_text *t = context;
    put_named(t->head, t->name, f);
    put_named(t->text, t->name, f);
}

static hf_status add_file(hf_file_out_set *files, const char *path, const new_text *text, hf_messages *messages)
{
    bool is_there;
    HF_TRY(hf_file_out_look(path, &is_there, messages));
    if (is_there)
        return hf_error(messages, HF_EXISTS, "the file %s already exists. Use another name, or remove the file", path);
    return hf_file_out_set_write(files, path, write_text, text, messages);
}

/* Checks the name of the case. It is part of a YAML file, so none of its characters may have a meaning there. */
static hf_status check_name(const char *word, const char *name, size_t n, hf_messages *messages)
{
    static const char may_have[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-.";
    if (n > 0 && n <= 100 && strspn(name, may_have) >= n && *name != '-' && *name != '.') return HF_OK;
    return hf_error(messages, HF_BAD_USAGE,
                    "'%s': the name of a new case may contain only letters, digits, '_', '-' and '.'. The name must "
                    "not begin with '-' or '.'",
                    word);
}

static hf_status command_new(const hf_options *o, FILE *file, hf_messages *messages)
{
    static hf_file_out_set files;
    const char *slash = strrchr(o->file, '/'), *begin = slash ? slash + 1 : o->file;
    size_t n = strlen(begin), n_folder = (size_t)(begin - o->file);
    char name[128], path[3][HF_FILE_OUT_SIZE];
    static const char *const end[3] = {".yaml", "_nodes.csv", "_cables.csv"};
    if (n > 5 && !strcmp(begin + n - 5, ".yaml")) n -= 5;
    HF_TRY(check_name(o->file, begin, n, messages));
    if (n_folder + n + 16 > HF_FILE_OUT_SIZE) return hf_error(messages, HF_BAD_USAGE, "'%s' is too long", o->file);
    snprintf(name, sizeof name, "%.*s", (int)n, begin);
    for (int i = 0; i < 3; i++)
        snprintf(path[i], sizeof path[i], "%.*s%s%s", (int)n_folder, o->file, name, end[i]);
    const new_text text[3] = {{name, head, case_text[o->new_case]}, {name, "", nodes}, {name, "", cables}};
    int n_file = o->new_case == HF_NEW_IMPORT ? 3 : 1;
    hf_status status = HF_OK;
    for (int i = 0; i < n_file && status == HF_OK; i++)
        status = add_file(&files, path[i], &text[i], messages);
    HF_TRY(hf_file_out_set_end(&files, status, messages));
    for (int i = 0; i < n_file; i++)
        hf_print_line(file, "%s is written", path[i]);
    hf_print_line(file, "next: hifdm run %s", path[0]);
    return HF_OK;
}

const hf_command hf_cmd_new = {
    .name = "new",
    .argument = "NAME",
    .help = "write the commented case file NAME.yaml, ready to run",
    .about = "Without options, the new case is a round reflector with two nets and ties between them. With the "
             "--import option, hifdm new also writes the tables NAME_nodes.csv and NAME_cables.csv of a small net. "
             "hifdm new never replaces an existing file.",
    .examples = "hifdm new dish\n"
                "hifdm new mine --import",
    .run = command_new,
};

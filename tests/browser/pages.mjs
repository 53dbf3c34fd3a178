// The pages that test.mjs opens, each of a case that is run or of a study that is swept and merged.
//   source: path of a case in the repository, or text: a case, with the files beside it
//   sections: those it must have, in order, apart from those that are there maybe
//   title: what must stand on it, to the letter
//   says: texts of places, or what is in them, and nothing else is looked at
//   warnings, slack: how many it must tell of
//   rounding: the deviations of its result are nothing else
//   measured: from the nodes of the result to a table of measured positions, by which the net is adjusted
//   pattern: how many charts of its far field, of how many neighbouring angles each
//   facets: how many, all triangles; off: families of cables whose switches are tried
//   other: how the case of a second result differs, with which it is compared; unlike: in its figures, too
//   fails: a run of it ends without a feasible design
//   bytes_max: how large it may be, if more than usual; fluid: it is only looked at how fast it is
//   overlay: a load case is drawn over the net
//   look: its looks are checked, and its sizes are in sizes.json
//   judged: how the margin over the axes is drawn, as a map, as maps for each value of the third axis, or as a line
//   study: how many points; leads: the axis that matters most, of two; along the other one nothing changes

const FORM = ["net", "cables", "map", "tensions", "summary", "form-finding", "provenance"];
const GA = ["net", "cables", "map", "tensions", "summary", "form-finding", "search", "provenance"];

const HOSTILE = `</script><img src=x onerror="window.hit=1"><!--<b>&amp;]]>'"\u2028\u202e\u007f`;

const cylinder = (modules, more = "") =>
  `scene:\n  parabolic_cylinder: {aperture_m: 10, length_m: 12, focal_length_m: 7.2, modules: [${modules}], ` +
  `cells_per_module: [2, 2], boundary: outer_edge, scallop: 0.1}\nform: {method: auto}\n${more}`;

// Cables whose names try to be markup; the last one is slack.
const ODD_NODES = `id,x_m,y_m,z_m,role
<script>window.hit=2</script>,0,0,0,support
b&amp;,2,0,0,support
"c""",2,2,0,support
d',0,2,0,support
"<i>e</i>",1,1,0.1,inner
${"long</script>".repeat(19)},3,0,0,support
`;
const ODD_CABLES = `id,i,j,group,law,value
"<img src=x onerror=window.hit=3>",<script>window.hit=2</script>,"<i>e</i>",inner,tension,10
k2,b&amp;,"<i>e</i>",inner,tension,10
k3,"c""","<i>e</i>",inner,tension,10
k4,d',"<i>e</i>",boundary,tension,0.001
`;

const LOOSE_NODES = `id,x_m,y_m,z_m,role,Fx_N,Fy_N,Fz_N
a,0,0,0,support,,,
b,2,0,0,support,,,
c,1,1,0,support,,,
m,1,0,-0.2,edge,0,0,-5
n,1,0.5,0,inner,,,
`;
const LOOSE_CABLES = `id,i,j,group,law,value
k1,a,m,inner,length,
k2,m,b,boundary,length,
k3,a,n,boundary,length,1.2
k4,c,n,boundary,length,0.6
`;

const REQUIRED =
  "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, " +
  "rear_distance_m: 1.8}\nform: {prestress: exact}\ntruss: {ring: {cells_per_bay: 2, held: bay, longeron: " +
  "{diameter_m: 0.03, wall_m: 0.001}}}\ntolerance: {sigma_cut_m: 5e-5, samples: 60}\nrequirements: [{figure: " +
  "tension, set: tie, at_least: 2, share: 0.9}, {figure: psi, at_most: 3.7e-4, share: 0.5}, {figure: slack_cables, " +
  "at_most: 0}]\n";

export const pages = [
  { name: "chen2022", source: "configs/chen2022.yaml", sections: GA, warnings: 0, look: true },
  { name: "straight-edges", source: "configs/straight-edges.yaml", sections: GA, warnings: 2 },
  { name: "reflector", source: "configs/reflector.yaml", sections: FORM, warnings: 0 },
  {
    name: "reflector-ga",
    text: cylinder(
      [10, 12],
      "optimize: {rule: tension, population: 10, generations: 5}\n" +
        `title: ${JSON.stringify(HOSTILE).replace("\u007f", "\\x7f")}\n`,
    ),
    title: HOSTILE.replace("\u2028\u202e\u007f", "\\u2028\\u202e\\x7f"),
    sections: GA,
  },
  {
    name: "imported",
    text: "scene:\n  import: {nodes: odd-nodes.csv, cables: odd-cables.csv}\n",
    files: { "odd-nodes.csv": ODD_NODES, "odd-cables.csv": ODD_CABLES },
    sections: FORM,
    slack: 1,
  },
  {
    name: "loose", // of two nodes the one that psi counts hangs on slack cables
    text: "scene:\n  import: {nodes: loose-nodes.csv, cables: loose-cables.csv}\n",
    files: { "loose-nodes.csv": LOOSE_NODES, "loose-cables.csv": LOOSE_CABLES },
    sections: FORM,
    says: { ".figures dd >> nth=0": "–", "#tensions p >> nth=1": "k1 has 12.748 N." },
  },
  {
    name: "exact", // no figure reports the rounding of a net that is held at all target positions
    text:
      "scene: {paraboloid: {aperture_m: 3, focal_length_m: 1.5, rings: 3, rear_distance_m: 1}, EA_inner_N: 1e4, " +
      "EA_boundary_N: 1e4}\nform: {prestress: exact}\ntolerance: {sigma_cut_m: 2e-4, samples: 50}\n" +
      "optimize: {population: 4, generations: 2}\n",
    sections: ["net", "cables", "map", "tensions", "tolerance", "summary", "form-finding", "search", "provenance"],
    says: {
      ".figures dt >> nth=2": "tension ratio, inner cables",
      "#cables thead tr":
        "CableFamilytension, form (N)tension, search (N)length (m)unstressed length (m)share of the error (%)",
      "#tolerance": /without errors < 10⁻⁶ mm/,
    },
  },
  {
    name: "objectives", // of which psi is none: it rises
    text:
      "scene: {paraboloid: {aperture_m: 3, focal_length_m: 1.5, rings: 3, rear_distance_m: 1}}\n" +
      "form: {prestress: exact, pretension_N: 10}\nsurface: {}\n" +
      "truss: {ring: {longeron: {diameter_m: 0.02, wall_m: 0.001}}}\n" +
      "optimize: {population: 10, generations: 10, variables: [{set: tie, vary: force_density, range: 40 %}], " +
      "objective: [{figure: facets, feed: fixed}]}\n",
    sections: [...GA.slice(0, -1), "coupling", "provenance"],
    says: { ".figures dt >> nth=1": "ψ after form-finding", ".figures dt >> nth=2": "tension ratio, inner cables" },
  },
  {
    name: "large", // 41x49 nodes
    text: cylinder([20, 24], "optimize: {rule: tension, population: 4, generations: 400, refine_steps: 2}\n"),
    sections: GA,
  },
  {
    name: "tied", // 9842 nodes, 33241 cables
    text:
      "scene:\n  paraboloid: {aperture_m: 30, focal_length_m: 15, rings: 40, rear_distance_m: 9}\n" +
      "  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\nsurface: {}\n",
    bytes_max: 5e6,
    fluid: true,
    sections: FORM,
  },
  {
    name: "paraboloid",
    text: "scene:\n  paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 8, rear_distance_m: 1.8}\nsurface: {}\n",
    sections: FORM,
    facets: 384,
    off: ["rear", "rear edge", "tie"],
  },
  {
    name: "front",
    look: true,
    text: cylinder(
      [4, 5],
      "optimize: {method: lm, front_points: 5, front: [{figure: psi}, {figure: ratio, set: boundary}]}\n",
    ),
    sections: ["front", "net", "cables", "map", "tensions", "summary", "form-finding", "provenance"],
  },
  {
    name: "front-judged", // some points fail
    text: cylinder(
      [4, 5],
      "optimize: {method: lm, front_points: 5, front: [{figure: psi}, {figure: ratio, set: boundary}]}\n" +
        "requirements: [{figure: psi, at_most: 0.0779, search: off}]\n",
    ),
    sections: ["front", "requirements", "net", "cables", "map", "tensions", "summary", "form-finding", "provenance"],
  },
  {
    name: "tolerance",
    look: true,
    text:
      "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n  parabolic_cylinder: {aperture_m: 10, length_m: 12, " +
      "focal_length_m: 7.2, modules: [4, 5], cells_per_module: [2, 2], boundary: outer_edge, scallop: 0.1}\n" +
      "form: {method: auto}\ntolerance: {sigma_cut_m: 1e-4, samples: 500}\n",
    sections: ["net", "cables", "map", "tensions", "tolerance", "summary", "form-finding", "provenance"],
    slack: 0,
  },
  {
    name: "requirements", // more rows than are shown at first; two are of all load cases
    look: true,
    text: cylinder(
      [4, 5],
      "cables:\n  - {expansion_per_K: -2e-6}\nload_cases:\n  - {name: cold, temperature_K: -5}\n" +
        "tolerance: {sigma_cut_m: 1e-4, samples: 600, seed: 1}\nrequirements:\n" +
        "  - {figure: psi, at_most: 0.0783, load_case: nominal, share: 0.9}\n" +
        "  - {figure: psi, at_most: 0.0782, load_case: cold, share: 0.9}\n" +
        "  - {figure: psi, at_most: 0.08, load_case: all, share: 0.95}\n" +
        "  - {figure: tension, set: inner, within: [4, 60], load_case: all, share: 0.95}\n" +
        "  - {figure: tension, set: inner, at_most: 90}\n" +
        "  - {figure: tension, set: boundary, at_most: 900}\n" +
        "  - {figure: ratio, set: boundary, at_most: 90, load_case: cold}\n" +
        "  - {figure: slack_cables, at_most: 0, load_case: all, share: 0.95}\n" +
        "  - {figure: tension, set: boundary, at_most: 45, share: 0.5}\n",
    ).replace("scene:", "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5"),
    sections: [
      ...["requirements", "net", "cables", "map", "tensions", "load-cases", "distributions", "tolerance", "summary"],
      ...["form-finding", "provenance"],
    ],
  },
  {
    name: "limits", // of the search, with a load case
    text: cylinder(
      [4, 5],
      "load_cases: [{name: cold, temperature_K: -5}]\ncables: [{expansion_per_K: -2e-6}]\noptimize: {method: lm, " +
        "limits: [{figure: tension, set: inner, bounds: [2, 66]}]}\n",
    ).replace("scene:", "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5"),
    sections: ["net", "cables", "map", "tensions", "load-cases", "summary", "form-finding", "provenance"],
    maybe: ["search"],
    overlay: true,
    says: {
      '#tensions tr:has-text("inner") >> nth=0 >> td >> nth=-2': "2 to 66",
      '#tensions tr:has-text("inner") >> nth=1 >> td >> nth=-2': "–", // in the load case
    },
  },
  {
    name: "compare",
    look: true,
    source: "configs/chen2022.yaml",
    other: ["--set", "optimize.method=lm", "--set", "form.pretension_N=10.5"],
    sections: ["compare", ...GA],
    warnings: 0,
  },
  {
    name: "compare-unlike", // EA and fewer frequencies in the other one alone
    text: cylinder([4, 5], "surface: {frequencies_Hz: [1e7, 5e7]}\n"),
    other: ["EA_inner_N=1e5", "EA_boundary_N=2e5"]
      .flatMap((line) => ["--set", `scene.${line}`])
      .concat("--set", "surface.frequencies_Hz=[5e7]"),
    unlike: true,
    sections: ["compare", ...FORM],
  },
  {
    name: "compare-verdicts", // of both, before the headlines
    text: cylinder([4, 5], "requirements: [{figure: psi, at_most: 0.078}, {figure: slack_cables, at_most: 0}]\n"),
    other: ["--set", "requirements.0.at_most=0.07"],
    sections: ["requirements", "requirements-other", "compare", ...FORM],
    says: {
      "main > section:nth-of-type(1) h2": "Verdict on result.h5: pass",
      "#requirements > p": "2 of 2 requirements pass.",
      "main > section:nth-of-type(2) h2": "Verdict on other.h5: fail",
      "#requirements-other > p": "1 of 2 requirements pass, 1 fails.",
      "#answer-other": /^other\.h5: Psi 77\./,
    },
  },
  {
    name: "failed", // no design is within the cap
    text: cylinder([4, 5], "optimize: {method: lm, range_N: 1e-6, boundary_ratio_cap: 1.0001}\n"),
    fails: true,
    sections: FORM,
    warnings: 1,
    says: {
      "#warnings h2": "This run failed: its figures are those of the form-finding",
      "#warnings li": /^optimize: Levenberg-Marquardt has no feasible start: /,
      "#answer": /^Failed: optimize: Levenberg-Marquardt .*; the form-finding has psi /,
    },
  },
  {
    name: "compare-failed", // the warnings of both, and the error of the other
    source: "configs/straight-edges.yaml",
    other: ["method=lm", "range_N=1e-6", "boundary_ratio_cap=1.0001"].flatMap((key) => ["--set", `optimize.${key}`]),
    fails: true,
    sections: ["compare", ...GA],
    says: {
      "#warnings h2": "The run of other.h5 failed",
      "#warnings li >> nth=0": /^other\.h5: optimize: Levenberg-Marquardt has no feasible start: /,
      "#warnings li >> nth=1": /^result\.h5: /,
      "#warnings li >> nth=-1": /^other\.h5: /,
    },
  },
  {
    name: "truss",
    source: "configs/straight-edges-truss.yaml",
    sections: FORM,
    maybe: ["coupling", "search"],
    truss: true,
  },
  {
    name: "rounding",
    look: true,
    source: "configs/paraboloid-even.yaml",
    sections: [...FORM.slice(0, -1), "coupling", "provenance"],
    rounding: true,
    off: ["rear", "rear edge", "tie"],
  },
  {
    name: "adjust",
    text:
      "scene:\n  EA_inner_N: 8.0e4\n  EA_boundary_N: 8.0e4\n  parabolic_cylinder: {aperture_m: 10, length_m: 12, " +
      "focal_length_m: 7.2, modules: [4, 5], cells_per_module: [2, 2], boundary: outer_edge, scallop: 0.1}\n" +
      "form: {method: auto, pretension_N: 20}\ntolerance: {sigma_cut_m: 1e-4, samples: 10}\n" +
      "adjust: {set: boundary, range_m: 0.003, step_m: 1e-4, max_adjustments: 8, sigma_m: 5e-5, target_m: 2e-4, aim: " +
      "target_positions}\n",
    measured: (nodes) =>
      ["id,x_m,y_m,z_m"]
        .concat(
          nodes
            .filter(({ role }) => role !== "support")
            .map(({ id, x_m, y_m, z_m }, i) => `${id},${x_m},${y_m},${Number(z_m) + 8e-4 * Math.sin(7 * i)}`),
        )
        .join("\n"),
    sections: ["net", "adjust", "cables", "map", "tensions", "tolerance", "summary", "form-finding", "provenance"],
  },
  {
    name: "pattern", // more angles than a screen shows, more cuts than there are colours; one cut too coarse to tell
    text:
      "scene:\n  paraboloid: {aperture_m: 6, focal_length_m: 3, rings: 3, rear_distance_m: 1.8}\nform: {prestress: " +
      "exact}\ntruss: {ring: {cells_per_bay: 2, held: bay, longeron: {diameter_m: 0.03, wall_m: 0.001}}}\nsurface: " +
      "{frequencies_Hz: [2e9, 20e9], pattern: {theta_deg: [-80, 80], n_theta: 2401, phi_deg: [0, 45, 90, 135, 20]}}\n" +
      "optimize: {method: lm, variables: [{set: all, vary: force_density, range: 50 %}]}\n",
    sections: ["net", "cables", "map", "tensions", "far-field", "summary", "form-finding", "coupling", "provenance"],
    off: ["rear", "rear edge", "tie"],
    facets: 54,
    rounding: true,
    pattern: { charts: 4, neighbours: 3 },
  },
  {
    name: "sweep",
    look: true,
    study: 64,
    leads: "scene.parabolic_cylinder.scallop",
    text:
      "base: base.yaml\nsweep:\n  form.pretension_N: {from: 5, to: 40, n: 16, spacing: log}\n" +
      "  scene.parabolic_cylinder.scallop: [0.05, 0.08, 0.11, 0.14]\n  files: all\n",
    files: { "base.yaml": cylinder([4, 5]) },
    sections: ["sweep", "points"],
  },
  {
    name: "sweep-surface", // one axis; objectives, one of them psi, the surface, the as-built net; wide tables on paper
    look: true,
    study: 3,
    text:
      "title: How hard may the net pull?\nbase: base.yaml\nsweep:\n  form.pretension_N: [19, 20, 21]\n" +
      "  scene.EA_boundary_N: [2e5]\n",
    files: {
      "base.yaml":
        "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, " +
        "rear_distance_m: 1.8}\nform: {prestress: exact}\ntruss: {ring: {cells_per_bay: 2, held: bay, longeron: " +
        "{diameter_m: 0.03, wall_m: 0.001}}}\nsurface: {frequencies_Hz: [2e9, 10e9]}\noptimize: {method: lm, " +
        "variables: [{set: all, vary: force_density, range: 50 %}], " +
        "objective: [{figure: psi}, {figure: tension, set: " +
        "tie, target: 8, weight: 1e-4}]}\ntolerance: {sigma_cut_m: 5e-5, samples: 40}\nrequirements: " +
        "[{figure: psi, at_most: 3e-4, share: 0.9, search: off}]\n",
    },
    sections: ["sweep", "points"],
  },
  {
    name: "sweep-replicates", // the scatter of the search
    look: true,
    study: 18,
    says: {
      "main > p.advice": /^Pretension [\d.]+ N and pretension [\d.]+ N (are not shown to )?differ by more than the sc/,
      "#sweep .chart >> nth=0": /Each mark is the median of the replicates\. The error bar extends between/,
      ".figures": /best median/,
    },
    text: "base: base.yaml\nsweep:\n  form.pretension_N: [5, 5.5, 20]\n  replicates: 6\n",
    files: {
      "base.yaml":
        "scene:\n  EA_inner_N: 1e5\n  EA_boundary_N: 2e5\n  paraboloid: {aperture_m: 4, focal_length_m: 3, rings: 3, " +
        "rear_distance_m: 1.8}\nform: {prestress: exact}\ntruss: {ring: {cells_per_bay: 2, held: bay, longeron: " +
        "{diameter_m: 0.03, wall_m: 0.001}}}\noptimize: {variables: [{set: all, vary: force_density, range: 50 %}], " +
        "population: 8, generations: 30, elites: 2, refine: false, objective: [{figure: psi}]}\n",
    },
    sections: ["sweep", "points"],
  },
  {
    name: "sweep-requirements", // two axes: a map of the smallest margin
    look: true,
    study: 12,
    judged: "map",
    text:
      "base: base.yaml\nsweep:\n  form.pretension_N: [4, 8, 10, 12, 14, 18]\n  tolerance.sigma_cut_m: [2e-5, 5e-5]\n" +
      "  files: all\n",
    files: { "base.yaml": REQUIRED },
    sections: ["sweep", "points"],
  },
  {
    name: "sweep-three", // three axes: a map of two for each value of the third
    study: 18,
    judged: "maps",
    text:
      "base: base.yaml\nsweep:\n  form.pretension_N: [4, 10, 14]\n  tolerance.sigma_cut_m: [2e-5, 5e-5]\n" +
      "  scene.EA_inner_N: [6e4, 1e5, 1.4e5]\n  files: all\n",
    files: { "base.yaml": REQUIRED },
    sections: ["sweep", "points"],
  },
  {
    name: "sweep-margin", // one axis, and no point that passes
    study: 3,
    judged: "line",
    text: "base: base.yaml\nsweep:\n  form.pretension_N: [4, 18, 22]\n  files: all\n",
    files: { "base.yaml": REQUIRED },
    sections: ["sweep", "points"],
  },
];

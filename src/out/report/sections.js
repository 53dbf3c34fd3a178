// Contents: histories, tables.

// ---- histories ----

const ALGORITHM = { ga: "Genetic algorithm", nsga2: "Genetic algorithm NSGA-II" };

const spaced = ({ n, stride }) => {
  const at = [];
  for (let i = 0; i < n; i++) if (i % stride === 0 || i === n - 1) at.push(i);
  return at;
};
const scaled = (values, k) => values.map((v) => (typeof v === "number" ? v * k : null));
const thinned = ({ stride }) => (stride > 1 ? ` The plot shows only one of every ${stride} values.` : "");

function writeHistory() {
  const h = data.history;
  if (!h) return;
  const x = spaced(h).map((i) => i + 1),
    xLabel = "iteration",
    head = (i) => `iteration ${x[i]}`,
    charts = [];
  const add = (title, key, name, figures, options, k = 1) => {
    if (!h[key] || !(range(h[key]) || h[key].includes(Infinity))) return;
    charts.push(
      chart({
        title,
        xLabel,
        x,
        head,
        ...options,
        caption: figures + thinned(h),
        series: [{ name, stored: key, values: scaled(h[key], k), colour: "--one", dots: x.length < 2 }],
      }),
    );
  };
  add(
    "Surface error ψ",
    "psi_m",
    "ψ",
    "ψ is the RMS distance of the inner nodes from their target positions.",
    { yLabel: "ψ (mm)", unit: "mm", floor: RESOLVED_MM },
    1e3,
  );
  add(
    "Tension ratio, inner cables",
    "inner_tension_ratio",
    "inner ratio",
    "The tension ratio of the inner cables is their maximum tension divided by their minimum tension. If the " +
      "tension ratio is 1, all tensions are equal.",
    { yLabel: "T max / T min" },
  );
  add(
    "Tension ratio, boundary cables",
    "boundary_tension_ratio",
    "boundary ratio",
    "The tension ratio of the boundary cables is their maximum tension divided by their minimum tension.",
    { yLabel: "T max / T min" },
  );
  const residual = "The residual is the maximum unbalanced force at a free node. It is 0 in equilibrium.";
  add("Nodal force out of balance", "residual_N", "residual", residual, {
    yLabel: "residual (N)",
    log: true,
    unit: "N",
  });
  if (charts.length)
    section(
      "form-finding",
      "Form-finding",
      el(
        "p",
        {},
        `Form-finding took ${fmtCount(h.n)} linear solves. ${sentence(stopText(summary.form.stop_reason))}`,
      ),
      el("div", { class: "charts" }, charts),
    );
}

function writeSearch() {
  const g = data.search;
  if (!g || !range(g.best_psi_m)) return;
  const x = spaced(g),
    xLabel = "generation",
    head = (i) => `generation ${x[i]}`,
    o = summary.search;
  const best = scaled(g.best_psi_m, 1e3);
  const change = best.map((v, i) => (i && v !== null && best[i - 1] !== null ? Math.abs(v - best[i - 1]) : null));
  section(
    "search",
    "Search",
    el(
      "p",
      {},
      `${ALGORITHM[o.algorithm] || o.algorithm}: ${fmtCount(o.generations)} generations with ` +
        `${fmtCount(o.evaluations)} form-findings in ${fmtDuration(o.wall_s)}. ${fmtCount(o.infeasible)} designs ` +
        `were infeasible. ${sentence(stopText(o.stop_reason))} The best design was found in generation ` +
        `${fmtCount(o.best_generation)}.`,
    ),
    el(
      "div",
      { class: "charts" },
      chart({
        title: "Convergence",
        xLabel,
        yLabel: "ψ (mm)",
        unit: "mm",
        x,
        head,
        caption:
          "The plot shows the surface error ψ of the feasible individuals. The worst individuals may lie outside the " +
          "plotted range." +
          thinned(g),
        series: [
          {
            name: "worst",
            stored: "worst_psi_m",
            values: scaled(g.worst_psi_m, 1e3),
            colour: "--two",
            dots: true,
            free: true,
          },
          {
            name: "mean",
            stored: "mean_psi_m",
            values: scaled(g.mean_psi_m, 1e3),
            colour: "--three",
            dash: "7 3",
          },
          { name: "best", stored: "best_psi_m", values: best, colour: "--one" },
        ],
      }),
      chart({
        title: "Difference between generations",
        xLabel,
        yLabel: "change of the best ψ (mm)",
        unit: "mm",
        x,
        head,
        caption: "The plot has no marks for generations without an improvement of the best design.",
        series: [{ name: "change", values: change.map((v) => (v > 0 ? v : null)), colour: "--one", dots: true }],
      }),
    ),
  );
}

function writeCoupling() {
  const c = data.coupling,
    k = summary.coupling;
  if (!c || !range(c.step_m || [])) return;
  const x = spaced(c).map((i) => i + 1),
    xLabel = "iteration",
    head = (i) => `iteration ${x[i]}`;
  const one = (title, key, yLabel, caption, options) =>
    c[key] &&
    chart({
      ...options,
      title,
      xLabel,
      yLabel,
      unit: "mm",
      x,
      head,
      caption,
      series: [{ name: title, stored: key, values: scaled(c[key], 1e3), colour: "--one", dots: x.length < 2 }],
    });
  const said =
    k &&
    `The truss deflects by up to ${fmt(1e3 * k.deflection_max_m)} mm at the attachments of the net. ` +
      (k.stop_reason === "converged"
        ? `The coupling of net and truss converged in ${fmtCount(k.iterations)} iterations.`
        : `The coupling of net and truss did not converge in ${fmtCount(k.iterations)} iterations ` +
        `(${stopText(k.stop_reason)}).`);
  section(
    "coupling",
    "Coupling of net and truss",
    said ? el("p", {}, said) : null,
    el(
      "div",
      { class: "charts" },
      one(
        "Change of the elastic deformation",
        "step_m",
        "change (mm)",
        "The plot shows the maximum displacement of the net attachments in each iteration.",
      ),
      one(
        "Maximum deflection",
        "deflection_max_m",
        "deflection (mm)",
        "The plot shows the maximum deflection of the truss at the attachments of the net.",
      ),
      one(
        "Surface error ψ on the truss",
        "psi_m",
        "ψ (mm)",
        "ψ is the RMS distance of the inner nodes from their target positions.",
        { floor: RESOLVED_MM },
      ),
    ),
  );
}

// ---- tables ----

// Returns a table. On a phone, a table of more than three columns shows them one below the other.
function table(headings, rows, caption) {
  const isWide = headings.length > 3;
  if (isWide)
    for (const row of rows) headings.forEach(([text], k) => row.children[k].setAttribute("data-label", text));
  return el(
    "div",
    { class: "scroll", tabindex: 0, role: "region", "aria-label": caption },
    el(
      "table",
      { "aria-label": caption, class: isWide ? "stacked" : undefined },
      el(
        "thead",
        {},
        el(
          "tr",
          {},
          headings.map(([text, kind]) => el("th", { scope: "col", class: kind }, text)),
        ),
      ),
      el("tbody", {}, rows),
    ),
  );
}

// The RMS from which each gain loss is computed. If it has a value and the loss has none, the loss is outside the range
// of Ruze's formula.
const RMS_OF_LOSS = {
  gain_loss_dB: "half_path_rms_m",
  fit_gain_loss_dB: "fit_half_path_rms_m",
  facet_gain_loss_dB: "facet_half_path_rms_m",
  facet_fit_gain_loss_dB: "facet_fit_half_path_rms_m",
  refocused_ruze_loss_dB: "refocused_half_path_rms_m",
  fixed_ruze_loss_dB: "fixed_half_path_rms_m",
};
const OPTICS = ["refocused_gain_loss_dB", "fixed_gain_loss_dB", "refocused_gain_dBi", "fixed_gain_dBi", "pointing_deg"];

// Returns all figures of a stage by their keys, with those of the surface, objectives and gain losses. The key of a
// gain loss contains the index of its frequency in frequency_Hz, by default the stage's own.
function stageValues(stage, frequency_Hz) {
  const surface = stage.surface || {},
    own_Hz = surface.frequency_Hz || [],
    all_Hz = frequency_Hz || own_Hz,
    values = { ...stage, ...surface };
  for (const [name, { value }] of Object.entries(stage.objectives || {})) values[name] = value;
  for (const [loss, rms] of Object.entries(RMS_OF_LOSS))
    (surface[loss] || []).forEach((v, k) => {
      const index = all_Hz.indexOf(own_Hz[k]);
      values[`${loss}[${index}]`] = v === null && surface[rms] !== null ? "above 3" : v;
    });
  for (const name of OPTICS)
    (surface[name] || []).forEach((v, k) => {
      values[`${name}[${all_Hz.indexOf(own_Hz[k])}]`] = v;
    });
  return values;
}

// Returns the rows of tables of figures: name, unit, key, format. `first` has the values of a stage.
function figureRows(first) {
  const mm = (v) => rounded(1e3 * v, 5);
  const hz = (v) => (v < 1e15 ? digitsOf(v / 1e9, 3) : `> ${power(6)}`); // higher frequencies come from rounding
  const objectives = Object.entries(first.objectives || {});
  const loss = (v) => (typeof v === "string" ? v : rounded(v, 3));
  const frequencies = (first.frequency_Hz || []).map((v) => `${fmt(v / 1e9, 4)} GHz`);
  // Ruze's formula of errors without the weights of the illumination is not beside physical optics.
  const isComputed = (k) => hasNumber((first.refocused_gain_loss_dB || [])[k]);
  const rows = [
    ["surface error ψ", "mm", "psi_m", mm],
    ["merit of all objectives", "", "merit", (v) => fmt(v, 5)],
    ...objectives.map(([name, { weight }]) => [
      `objective: ${objectiveName(name)}${weight === undefined ? "" : `, weight ${weight}`}`,
      objectiveUnit(name),
      name,
      (v) => digitsOf(objectiveScale(name) * v, 5),
    ]),
    ["half-path RMS", "mm", "half_path_rms_m", mm],
    ["half-path RMS, best fit", "mm", "fit_half_path_rms_m", mm],
    ["RMS along the normal", "mm", "normal_rms_m", mm],
    ["RMS along the normal, best fit", "mm", "fit_normal_rms_m", mm],
    ["focal length of the best fit", "m", "fit_focal_length_m", (v) => digitsOf(v, 6)],
    ["half-path RMS of the facets", "mm", "facet_half_path_rms_m", mm],
    ["half-path RMS of the facets, best fit", "mm", "facet_fit_half_path_rms_m", mm],
    ["RMS of the facets along the normal", "mm", "facet_normal_rms_m", mm],
    ["RMS of the facets along the normal, best fit", "mm", "facet_fit_normal_rms_m", mm],
    ["pillow, RMS", "mm", "pillow_rms_m", mm],
    ["maximum pull of the mesh, N l / T", "", "mesh_pull_ratio", (v) => fmt(v, 3)],
    ["facets", "", "n_facet", fmtCount],
    ["faceting error of flat strips", "mm", "faceting_rms_m", mm],
    ["deviation, median", "mm", "deviation_p50_m", mm],
    ["deviation, 90th percentile", "mm", "deviation_p90_m", mm],
    ["deviation, 95th percentile", "mm", "deviation_p95_m", mm],
    ["deviation, 99th percentile", "mm", "deviation_p99_m", mm],
    ["deviation, maximum", "mm", "deviation_max_m", mm],
    ["RMS of the facets by illumination, refocused feed", "mm", "refocused_half_path_rms_m", mm],
    ["RMS of the facets by illumination, fixed feed", "mm", "fixed_half_path_rms_m", mm],
    ...frequencies.flatMap((at, k) => [
      [`gain loss at ${at}, refocused feed (physical optics)`, "dB", `refocused_gain_loss_dB[${k}]`, loss],
      [`gain loss at ${at}, refocused feed (Ruze)`, "dB", `refocused_ruze_loss_dB[${k}]`, loss],
      [`gain loss at ${at}, fixed feed (physical optics)`, "dB", `fixed_gain_loss_dB[${k}]`, loss],
      [`gain loss at ${at}, fixed feed (Ruze)`, "dB", `fixed_ruze_loss_dB[${k}]`, loss],
      [`gain at ${at}, refocused feed`, "dBi", `refocused_gain_dBi[${k}]`, (v) => rounded(v, 5)],
      [`gain at ${at}, fixed feed`, "dBi", `fixed_gain_dBi[${k}]`, (v) => rounded(v, 5)],
      [`angle of the beam at ${at}, fixed feed`, "deg", `pointing_deg[${k}]`, (v) => rounded(v, 3)],
      ...(isComputed(k)
        ? []
        : [
            [`gain loss at ${at}, fixed feed (Ruze, nodes)`, "dB", `gain_loss_dB[${k}]`, loss],
            [`gain loss at ${at}, refocused feed (Ruze, nodes)`, "dB", `fit_gain_loss_dB[${k}]`, loss],
            [`gain loss at ${at}, fixed feed (Ruze, facets)`, "dB", `facet_gain_loss_dB[${k}]`, loss],
            [`gain loss at ${at}, refocused feed (Ruze, facets)`, "dB", `facet_fit_gain_loss_dB[${k}]`, loss],
          ]),
    ]),
    ["limit of Ruze’s formula (3 dB gain loss)", "GHz", "ruze_limit_Hz", hz],
    ["limit of Ruze’s formula, best fit", "GHz", "fit_ruze_limit_Hz", hz],
    ["limit of Ruze’s formula, facets", "GHz", "facet_ruze_limit_Hz", hz],
    ["limit of Ruze’s formula, facets, best fit", "GHz", "facet_fit_ruze_limit_Hz", hz],
    ["tension ratio, inner cables", "", "inner_tension_ratio", fmtRatio],
    ["tension ratio, boundary cables", "", "boundary_tension_ratio", fmtRatio],
    ["slack cables", "", "slack_cables", fmtCount],
    ["maximum nodal residual", "N", "residual_N", (v) => fmt(v, 3)],
    ["maximum error of a prescribed tension", "relative", "tension_error", (v) => fmt(v, 3)],
    ["maximum error of a prescribed length", "relative", "length_error", (v) => fmt(v, 3)],
    ["shortest cable, relative to its length at target", "", "shortest_length_ratio", (v) => digitsOf(v, 4)],
    ["straight chains under load", "", "loaded_straight_chains", fmtCount],
    ["estimated position error", "mm", "position_error_m", (v) => fmt(1e3 * v, 3)],
    ["certified bound of the position error", "mm", "position_bound_m", (v) => fmt(1e3 * v, 3)],
    ["certified bound of the error of ψ", "mm", "psi_bound_m", (v) => fmt(1e3 * v, 3)],
    ["certificate of these bounds", "", "bound_reason", boundText],
    ["condition of the Newton matrix", "", "condition", (v) => digitsOf(v, 3)],
    ["backward error", "", "backward_error", (v) => fmt(v, 3)],
    ["linear solves", "", "iterations", fmtCount],
    ["generations", "", "generations", fmtCount],
    ["evaluations", "", "evaluations", fmtCount],
    ["status", "", "status", plainWord],
    ["point of the front", "", "front_point", fmtCount],
    ["result with this front", "", "front_file", String],
    ["stop reason", "", "stop_reason", stopText],
    ["wall time", "", "wall_s", fmtDuration],
  ];
  // Other figures of the result have the description of the list that defines them.
  const named = new Set(rows.map(([, , key]) => key));
  const others = (data.figures || []).filter(({ key }) => !named.has(key));
  rows.push(...others.map(({ key, units, description }) => [description, units, key, (v) => fmt(v, 4)]));
  return rows;
}

const inOneLine = (paragraphs) => paragraphs.replaceAll("\n", " ");

// Lists terms, figures of these keys and words of these stages with their descriptions, as `hifdm explain` prints them.
function writtenWords(keys, stages) {
  const figures = new Set(keys.map((key) => key.replace(/\[.*/, ""))),
    listed = new Set();
  const list = (data.words || []).filter(({ word, term, of }) => {
    const isOnPage = of ? stages.some((values) => values[of] === word) : term || figures.has(word),
      isNew = isOnPage && !listed.has(word);
    if (isNew) listed.add(word);
    return isNew;
  });
  if (!list.length) return null;
  list.sort((a, b) => !!b.term - !!a.term);
  return el(
    "details",
    { class: "words" },
    el("summary", {}, "What the words and figures mean"),
    el(
      "dl",
      {},
      list.flatMap(({ word, text }) => [
        el("dt", {}, word.replace(/_/g, "_\u200b")),
        el("dd", {}, inOneLine(text)),
      ]),
    ),
  );
}

const hasFigure = (v) => typeof v === "number" || typeof v === "string";

// Returns the description of a figure or, with `of`, of a word that is the value of figure `of`.
function meaning(word, of) {
  const found = (data.words || []).find((entry) => entry.word === word && entry.of === of);
  return found ? inOneLine(found.text) : undefined;
}
const quantity = (name, unit, key) =>
  el("th", { scope: "row", "data-unit": unit || null, title: meaning(key.replace(/\[.*/, "")) }, name);
// Returns a value, with its description if it is a word.
const shownFigure = (key, value, format) =>
  hasFigure(value) ? el("span", { title: typeof value === "string" ? meaning(value, key) : null }, format(value)) : "–";
const breakable = (key) => key.split(/(?<=_)/).flatMap((part, k) => (k ? [el("wbr"), part] : part));

function writeSummary() {
  const stages = [
    ["form", "Form"],
    ["search", "Search"],
    ["refine", pointIn(summary) ? `Point ${pointIn(summary)}` : "Refine"],
  ].filter(([key]) => summary[key]);
  if (!stages.length) return;
  const values = Object.fromEntries(stages.map(([stage]) => [stage, stageValues(summary[stage])]));
  const rows = figureRows(values[stages[0][0]]);
  const shown = rows.filter(([, , key]) =>
    stages.some(([s]) => values[s][key] !== undefined && values[s][key] !== null),
  );
  section(
    "summary",
    "Summary",
    table(
      [["Quantity"], ...stages.map(([, name]) => [name, "number"]), ["Unit"], ["Name in the file", "names"]],
      shown.map(([name, unit, key, format]) =>
        el(
          "tr",
          {},
          quantity(name, unit, key),
          stages.map(([s]) => el("td", { class: "number" }, shownFigure(key, values[s][key], format))),
          el("td", { class: "unit" }, unit),
          el("td", { class: "names" }, el("code", {}, breakable(key))),
        ),
      ),
      "Summary",
    ),
    writtenWords(
      shown.map(([, , key]) => key),
      Object.values(values),
    ),
  );
}

// Writes the load cases of the as-built net, one row each.
function writeLoadCases() {
  const loadCases = Object.entries(summary.load_cases || {});
  if (!loadCases.length) return;
  const values = loadCases.map(([, figures]) => ({ ...figures, ...figures.surface }));
  const number = (name, key, digits, unit) =>
    numberColumn(
      name,
      values.map((v) => (typeof v[key] === "number" ? v[key] : NaN)),
      digits,
      { unit },
    );
  const columns = [
    { name: "Load case", of: (i) => i, show: (i) => loadCases[i][0] },
    { name: "status", beside: true, of: (i) => values[i].status, show: (i) => plainWord(values[i].status) },
    number("ψ (mm)", "psi_m", 5, 1e3),
    number("displacement, RMS (mm)", "displacement_rms_m", 5, 1e3),
    number("half-path RMS (mm)", "half_path_rms_m", 5, 1e3),
    number("best fit (mm)", "fit_half_path_rms_m", 5, 1e3),
    number("facets, best fit (mm)", "facet_fit_half_path_rms_m", 5, 1e3),
    number("minimum tension (N)", "tension_min_N", 4),
    number("maximum tension (N)", "tension_max_N", 4),
    number("slack cables", "slack_cables", 1),
    number("loose nodes", "loose_nodes", 1),
    number("maximum member force (N)", "member_force_max_N", 4),
  ].filter((column) => column);
  const design = summary.front ? "the form-finding" : "the result";
  section(
    "load-cases",
    "Load cases of the as-built net",
    el(
      "p",
      {},
      `The table lists values for the as-built net of ${design} in each load case. A load case consists of ` +
        "temperatures, loads and support displacements.",
    ),
    sortableTable({ caption: "Load cases of the as-built net", columns, n: loadCases.length, by: -1 }).node,
  );
}

const PROVENANCE = {
  started_utc: "started (UTC)",
  finished_utc: "finished (UTC)",
  git_describe: "commit",
  build_flags: "compiler flags",
  lapack: "LAPACK",
  gsl_version: "GSL",
  hdf5_version: "HDF5",
  rng: "random numbers",
  sha256: "SHA-256 of the case",
};

function writeProvenance() {
  const rows = [
    ["result file", summary.file],
    ["case", summary.case],
    ["seed", data.seed],
    ["threads", String(summary.threads)],
    ...(data.provenance || []).map((line) => {
      const at = line.indexOf(": ");
      const key = line.slice(0, at);
      return [PROVENANCE[key] || key.replace(/_/g, " "), line.slice(at + 2)];
    }),
  ];
  section(
    "provenance",
    "Provenance",
    table(
      [["What"], ["Value"]],
      rows.map(([name, value]) => el("tr", {}, el("th", { scope: "row" }, name), el("td", { class: "wrap" }, value))),
      "Provenance",
    ),
  );
}

// Contents: axes - curves - table of points - the page of a merged study

// ---- axes ----

const NAME_MAX = 60; // characters of the name or value of an axis
const UNITS = { N_per_m: "N/m", N: "N", m: "m", kg: "kg", Hz: "Hz" };
// Splits a key into name and unit: "form.pretension_N" gives "pretension" and "N".
function axisName(key) {
  const parts = key.split("."),
    isOfRow = /^\d+$/.test(parts[parts.length - 2] || ""),
    last = parts.slice(isOfRow ? -3 : -1).join(" "),
    unit = Object.keys(UNITS).find((u) => last.endsWith(`_${u}`));
  const name = clip((unit ? last.slice(0, -unit.length - 1) : last).replace(/_/g, " "), NAME_MAX);
  return { name, unit: unit ? UNITS[unit] : "", text: unit ? `${name} (${UNITS[unit]})` : name };
}

function readAxes(study) {
  return study.input.map((input) => {
    const columns = input.columns || 1,
      named = axisName(input.name),
      isNumber = !input.texts && columns === 1;
    // small lengths, such as errors of the cut, in millimetres
    const isSmall = isNumber && named.unit === "m" && (range(input.values.map(Math.abs)) || [0, 1])[1] < 0.1,
      values = isSmall ? input.values.map((v) => Number((1e3 * v).toPrecision(12))) : input.values;
    if (isSmall) Object.assign(named, { unit: "mm", text: `${named.name} (mm)` });
    const label = (i) =>
      input.texts
        ? clip(input.texts[i], NAME_MAX)
        : Array.from({ length: columns }, (_, k) => fmt(values[columns * i + k], 5)).join(" × ");
    const labels = new Set(Array.from({ length: study.n }, (_, i) => label(i)));
    return {
      key: input.name,
      ...named,
      label,
      isNumber,
      varies: labels.size > 1,
      value: (i) => (isNumber ? values[i] : label(i)),
    };
  });
}

// ---- figures: what the points have, and which axis it depends on ----

const STAGE_STYLE = { form: ["--one", null], optimize: ["--two", "7 3"], polish: ["--three", "2 3"] };
const STAGE_FIGURES = [
  { key: "psi_m", title: "Surface error ψ", yLabel: "ψ (mm)", unit: "mm", scale: 1e3 },
  { key: "inner_tension_ratio", title: "Tension ratio, inner cables", yLabel: "T max / T min", unit: "", scale: 1 },
  {
    key: "boundary_tension_ratio",
    title: "Tension ratio, boundary cables",
    yLabel: "T max / T min",
    unit: "",
    scale: 1,
  },
];

// The goals that any stage has, each in its own unit.
function goalFigures(study) {
  const keys = new Set(study.output.flatMap((o) => Object.keys(o).filter((k) => k.startsWith("goal_"))));
  return [...keys].sort().map((key) => {
    const name = clip(key.replace(/_/g, " "), NAME_MAX);
    return { key, title: name[0].toUpperCase() + name.slice(1), yLabel: name, unit: "", scale: 1 };
  });
}

// One figure: of: (i, stage) -> its value at a finished point, or null; isConstant: it has one value, but for rounding.
function readFigures(study, mainStage) {
  const value = (list, i, scale) => (study.status[i] === "ok" && typeof list[i] === "number" ? list[i] * scale : null);
  const stages = [...STAGE_FIGURES, ...goalFigures(study)]
    .map((f) => ({ ...f, stages: study.output.filter((o) => o[f.key]).map((o) => o.stage) }))
    .filter((f) => f.stages.length)
    .map((f) => ({
      ...f,
      of: (i, stage = mainStage) => value((study.output.find((o) => o.stage === stage) || {})[f.key] || [], i, f.scale),
    }));
  const others = (study.figure || []).map(({ key, title, unit, values }) => {
    const isLength = unit === "m";
    return {
      key,
      title,
      yLabel: isLength ? "ψ (mm)" : title,
      unit: isLength ? "mm" : unit,
      stages: [],
      of: (i) => value(values, i, isLength ? 1e3 : 1),
    };
  });
  return [...stages, ...others]
    .map((f) => {
      const at = range(Array.from({ length: study.n }, (_, i) => f.of(i)));
      return { ...f, at, isConstant: !!at && at[1] - at[0] <= 1e-6 * Math.abs(at[1]) };
    })
    .filter((f) => f.at);
}

// Which part of the variance of a figure the mean over the points with the same value of an axis has. In a product of
// axes the parts of all axes and of their interplay make 1.
function shareOf(study, figure, axis) {
  const groups = new Map();
  let n = 0,
    sum = 0,
    square = 0;
  for (let i = 0; i < study.n; i++) {
    const v = figure.of(i);
    if (v === null) continue;
    const group = groups.get(axis.value(i)) || [0, 0];
    groups.set(axis.value(i), [group[0] + 1, group[1] + v]);
    n++;
    sum += v;
    square += v * v;
  }
  const mean = sum / n,
    whole = square / n - mean * mean;
  let between = 0;
  for (const [count, total] of groups.values()) between += (count / n) * (total / count - mean) ** 2;
  return whole > 0 ? Math.min(1, between / whole) : 0;
}

// ---- curves and maps ----

const CURVES_MAX = 4; // more curves than these colours are drawn as a map of two axes, or as marks
const valuesOf = (study, axis) =>
  [...new Set(Array.from({ length: study.n }, (_, i) => axis.value(i)))].sort((a, b) => (a < b ? -1 : a > b ? 1 : 0));

// Groups the points into curves: the points of a curve agree in all axes but one. Curves are in the order of the values
// that their points share.
function curves(study, axis, others) {
  const groups = new Map();
  for (let i = 0; i < study.n; i++) {
    const name = others.map((a) => `${a.name} ${a.label(i)}${a.unit ? ` ${a.unit}` : ""}`).join(", ");
    if (!groups.has(name)) groups.set(name, { name, first: i, at: new Map() });
    groups.get(name).at.set(axis.value(i), i);
  }
  const order = (p, q) => {
    const a = others.find((o) => o.value(p.first) !== o.value(q.first));
    return a ? (a.value(p.first) < a.value(q.first) ? -1 : 1) : 0;
  };
  return [...groups.values()].sort(order);
}

const headOf = (axis, text) => `${axis.name} ${text}${axis.unit ? ` ${axis.unit}` : ""}`;
const captionOf = (figure, axis) =>
  figure.key === "psi_m" && axis.key === "form.pretension_N" ? " Fig. 22 of Chen et al., 2022." : "";

function curveChart(study, figure, axis, groups, stage) {
  const x = valuesOf(study, axis),
    isOne = groups.length === 1;
  const stages = isOne && figure.stages.length ? figure.stages : [stage];
  const series = groups.flatMap((group, k) =>
    stages.map((of) => ({
      name: group.name || (figure.stages.length ? stageName[of] : figure.title),
      stored: figure.key,
      values: x.map((v) => (group.at.has(v) ? figure.of(group.at.get(v), of) : null)),
      colour: isOne && figure.stages.length ? STAGE_STYLE[of][0] : SERIES[k],
      dash: isOne && figure.stages.length ? STAGE_STYLE[of][1] : null,
      dots: x.length < 2,
    })),
  );
  return chart({
    ...figure,
    xLabel: axis.text,
    x,
    series,
    counted: false,
    caption: `${isOne ? "" : "One curve for each value of the other axes."}${captionOf(figure, axis)}`.trim(),
    head: (i) => headOf(axis, fmt(x[i], 6)),
  });
}

// A mark for each point, and the mean over those with the same value.
function markChart(study, figure, axis, stage) {
  const points = Array.from({ length: study.n }, (_, i) => i).sort((i, j) => axis.value(i) - axis.value(j));
  return chart({
    ...figure,
    xLabel: axis.text,
    x: points.map(axis.value),
    counted: false,
    caption: `One mark per finished point.${captionOf(figure, axis)}`,
    head: (i) => `point ${study.id[points[i]]}, ${headOf(axis, axis.label(points[i]))}`,
    series: [
      {
        name: figure.title,
        stored: figure.key,
        colour: "--one",
        dots: true,
        values: points.map((i) => figure.of(i, stage)),
      },
    ],
  });
}

// Two axes and a colour: a cell for each pair of values, with its value where there is room.
const CELL_TEXT_MAX = 44; // characters of a row that still have room
function heatMap(study, figure, axis, other, stage) {
  const columns = valuesOf(study, axis),
    rows = valuesOf(study, other).reverse(),
    at = new Map();
  for (let i = 0; i < study.n; i++) at.set(`${axis.value(i)} ${other.value(i)}`, i);
  const of = (x, y) => (at.has(`${x} ${y}`) ? figure.of(at.get(`${x} ${y}`), stage) : null);
  const all = range(columns.flatMap((x) => rows.map((y) => of(x, y))));
  if (!all) return null;
  const label = (a, value) => (a.isNumber ? fmt(value, 4) : String(value));
  const bar = el("div", { class: "bar" });
  const decimals = Math.min(9, Math.max(0, 2 - Math.floor(Math.log10(all[1] - all[0] || 1))));
  const text = (v) => (Math.abs(all[1]) < 1e5 ? minus(v.toFixed(decimals)) : fmt(v, 3));
  const cell = (x, y) => {
    const v = of(x, y);
    if (v === null) return el("td", { class: "gap", title: "no value" }, "–");
    const t = all[1] > all[0] ? (v - all[0]) / (all[1] - all[0]) : 0,
      node = el("td", {
        title: `${headOf(axis, label(axis, x))}, ${headOf(other, label(other, y))}: ${fmt(v, 5)} ${figure.unit}`,
      });
    const paintCell = () => {
      const colour = sequential(t),
        light = 0.299 * colour[0] + 0.587 * colour[1] + 0.114 * colour[2];
      node.style.background = rgb(colour);
      node.style.color = light > 140 ? "#000" : "#fff";
    };
    paintCell();
    for (const scheme of [darkScheme, printing]) scheme.addEventListener("change", paintCell);
    const hasRoom = columns.length * text(all[1]).length <= CELL_TEXT_MAX;
    node.append(hasRoom ? text(v) : el("span", { class: "hidden" }, text(v)));
    return node;
  };
  drawBar(bar, sequential, all, figure.yLabel);
  return el(
    "figure",
    { class: "heat" },
    el("h3", {}, figure.title),
    el(
      "div",
      { class: "scroll", tabindex: 0, role: "region", "aria-label": `${figure.title}, a map of two axes` },
      el(
        "table",
        {},
        el("caption", {}, `${other.text} down, ${axis.text} across`),
        el(
          "tbody",
          {},
          rows.map((y) => el("tr", {}, el("th", { scope: "row" }, label(other, y)), columns.map((x) => cell(x, y)))),
        ),
        el(
          "tfoot",
          {},
          el("tr", {}, el("th", { scope: "row" }, ""), columns.map((x) => el("th", { scope: "col" }, label(axis, x)))),
        ),
      ),
    ),
    bar,
  );
}

function drawFigures(study, figures, axis, others, stage, place) {
  const groups = curves(study, axis, others),
    isMap = groups.length > CURVES_MAX && others.length === 1;
  const drawn = figures
    .filter((f) => !f.isConstant)
    .map((f) =>
      groups.length <= CURVES_MAX
        ? curveChart(study, f, axis, groups, stage)
        : isMap
          ? heatMap(study, f, axis, others[0], stage)
          : markChart(study, f, axis, stage),
    );
  place.replaceChildren(...drawn.filter((c) => c));
}

// Sentences: what each axis explains, and figures that are the same everywhere.
function whatMatters(figure, shares) {
  if (shares.length < 2) return "";
  const part = (share) => (share < 0.001 ? "less than 0.1\u00a0%" : percent(share, 2));
  const parts = shares.map(({ axis, share }) => `${axis.name} ${part(share)}`),
    rest = 1 - shares.reduce((sum, { share }) => sum + share, 0);
  const both = rest > 0.005 ? `; the rest, ${part(rest)}, is their interplay` : "";
  return `Of the variance of ${figure.title.replace(/^S/, "s")} over the points: ${parts.join(", ")}${both}.`;
}

function writeCurves(study, axes, figures, mainStage) {
  const varying = axes.filter((a) => a.varies),
    along = varying.filter((a) => a.isNumber),
    place = el("div", { class: "charts" }),
    constant = figures.filter((f) => f.isConstant);
  const lead = leading(figures.filter((f) => !f.isConstant));
  const same = constant.map((f) => `${f.title} is ${fmt(f.at[1], 5)}${f.unit ? ` ${f.unit}` : ""} at all points.`);
  const shares = lead
    ? varying.map((axis) => ({ axis, share: shareOf(study, lead, axis) })).sort((a, b) => b.share - a.share)
    : [];
  if (!along.length || !figures.length) return;
  const most = shares.find(({ axis }) => axis.isNumber);
  const state = { axis: (most && most.axis) || along[0], stage: mainStage };
  const others = () => varying.filter((a) => a !== state.axis);
  const redraw = (change) => {
    Object.assign(state, change);
    drawFigures(study, figures, state.axis, others(), state.stage, place);
  };
  const tools = [];
  if (along.length > 1)
    tools.push(
      choice(
        "axis",
        "Along",
        along.map((a) => [a.key, a.name]),
        state.axis.key,
        (key) => redraw({ axis: along.find((a) => a.key === key) }),
      ),
    );
  if (study.output.length > 1 && others().length)
    tools.push(
      choice(
        "stage",
        "Shape",
        study.output.map((o) => [o.stage, stageName[o.stage]]),
        state.stage,
        (stage) => redraw({ stage }),
      ),
    );
  section(
    "sweep",
    "Sweep",
    el("p", {}, [lead ? whatMatters(lead, shares) : "", ...same].filter((text) => text).join(" ")),
    tools.length ? el("div", { class: "tools" }, tools) : null,
    place,
  );
  redraw({});
}

// The figure that tells which point is best: psi of the nets as built where they are known, else psi of the result.
const leading = (figures) => figures.find((f) => f.key === "tolerance/psi_95_m") || figures[0];

// ---- table of points ----

const TOLD_MAX = 5,
  POINTS_SHOWN = 64;

// A link is made only to a file: any other scheme in the data stays text.
const href = (path) => (path.startsWith("/") ? "" : "./") + path.split("/").map(encodeURIComponent).join("/");

function pointLink(study, i) {
  const target = study.page[i] || study.file[i];
  return target ? el("a", { href: href(target) }, study.id[i]) : study.id[i];
}

function writePoints(study, axes, figures, best) {
  const varying = axes.filter((a) => a.varies),
    fixed = axes.filter((a) => !a.varies),
    why = study.reason.some((r) => r),
    there = (v) => typeof v === "number";
  const number = (name, of, format) => ({ name, number: true, of, show: (i) => (there(of(i)) ? format(of(i)) : "–") });
  const slack = (i) => (study.status[i] === "ok" ? ((study.output.at(-1) || {}).n_slack || [])[i] : null),
    rows = Array.from({ length: study.n }, (_, i) => i),
    changing = figures.filter((f) => !f.isConstant);
  const columns = [
    ...varying.map((a) => ({ name: a.text, number: a.isNumber, of: a.value, show: (i) => a.label(i) })),
    { name: "Status", of: (i) => statusText(study.status[i]), show: (i) => statusText(study.status[i]) },
    ...changing
      .filter((f) => f.stages.length)
      .flatMap((f) =>
        (f.key === "psi_m" ? f.stages : f.stages.slice(-1)).map((stage) =>
          f.key === "psi_m"
            ? number(`ψ ${stageName[stage]} (mm)`, (i) => f.of(i, stage), (v) => fmt(v, 5))
            : number(f.title, (i) => f.of(i), f.key.startsWith("goal_") ? (v) => fmt(v, 5) : fmtRatio),
        ),
      ),
    ...changing
      .filter((f) => !f.stages.length)
      .map((f) => number(f.unit ? `${f.title} (${f.unit})` : f.title, (i) => f.of(i), (v) => fmt(v, 5))),
    ...(rows.some(slack) ? [number("Slack cables", slack, fmtCount)] : []),
    ...(why ? [{ name: "Why", of: (i) => study.reason[i], show: (i) => study.reason[i] }] : []),
    { name: "Point", of: (i) => study.id[i], show: (i) => pointLink(study, i) },
  ];
  const said = [];
  if (fixed.length) said.push(`All with ${fixed.map((a) => headOf(a, a.label(0))).join(", ")}.`);
  if (best >= 0) said.push("The marked row is the best one. A click on a heading sorts.");
  if (study.page.some((p) => p)) said.push("The last column leads to the report of a point, or else to its result.");
  else if (study.file.some((p) => p)) said.push("The last column leads to the result file of a point.");
  const points = sortableTable({
    caption: "Points",
    columns,
    n: study.n,
    by: -1,
    most: POINTS_SHOWN,
    search: "value or status",
    words: (i) => columns.map(({ show }) => (typeof show(i) === "string" ? show(i) : study.id[i])).join(" "),
  });
  points.first(best);
  section("points", "Points", el("p", {}, said.join(" ")), points.node);
}

// ---- the page ----

const statusText = (word) =>
  word === "not_evaluated" ? "missing" : word === "ok" ? "done" : word.replace(/_/g, " ");

function writeStudy(study) {
  const count = (test) => study.status.filter(test).length,
    failed = count((s) => s !== "ok" && s !== "not_evaluated");
  const missing = count((s) => s === "not_evaluated"),
    axes = readAxes(study),
    varying = axes.filter((a) => a.varies);
  const mainStage = (study.output.find((o) => o.stage === "optimize") || study.output.at(-1) || {}).stage,
    figures = readFigures(study, mainStage),
    lead = leading(figures);
  let best = -1;
  for (let i = 0; lead && i < study.n; i++)
    if (lead.of(i) !== null && (best < 0 || lead.of(i) < lead.of(best))) best = i;
  document.getElementById("title").textContent = shown(data.title);
  document.getElementById("subtitle").textContent = shown(
    `Sweep of ${fmtCount(study.n)} points over ${(varying.length ? varying : axes).map((a) => a.name).join(" and ")}`,
  );
  document.getElementById("footer").textContent = shown(
    `Merged study ${study.path}. “Fig.” refers to Chen et al., Aerospace 2022, 9, 239.`,
  );
  const told = study.reason.map((reason, i) => (reason ? `point ${study.id[i]}: ${reason}` : "")).filter((t) => t);
  writeWarnings(
    failed === 1 ? "One point failed" : failed ? `${fmtCount(failed)} points failed` : "Points of note",
    told.length > TOLD_MAX ? [...told.slice(0, TOLD_MAX), `and ${told.length - TOLD_MAX} more, see the table`] : told,
  );
  main.append(
    el(
      "dl",
      { class: "figures" },
      best < 0 ? null : figure(`least: ${lead.title}`, fmt(lead.of(best), 4), lead.unit),
      best < 0 ? null : varying.map((a) => figure(`${a.name}, there`, a.label(best), a.unit)),
      figure("points done", `${fmtCount(count((s) => s === "ok"))} of ${fmtCount(study.n)}`),
      failed ? figure("failed", fmtCount(failed)) : null,
      missing ? figure("missing", fmtCount(missing)) : null,
    ),
  );
  writeCurves(study, axes, figures, mainStage);
  writePoints(study, axes, figures, best);
}

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
    const columns = input.columns || 1;
    const label = (i) =>
      input.texts
        ? clip(input.texts[i], NAME_MAX)
        : Array.from({ length: columns }, (_, k) => fmt(input.values[columns * i + k], 5)).join(" × ");
    const isNumber = !input.texts && columns === 1;
    const labels = new Set(Array.from({ length: study.n }, (_, i) => label(i)));
    return {
      key: input.name,
      ...axisName(input.name),
      label,
      isNumber,
      varies: labels.size > 1,
      value: (i) => (isNumber ? input.values[i] : label(i)),
    };
  });
}

// ---- curves ----

const STAGE_STYLE = { form: ["--one", null], optimize: ["--two", "7 3"], polish: ["--three", "2 3"] };
const QUANTITIES = [
  { key: "psi_m", title: "Surface error ψ", yLabel: "ψ (mm)", unit: "mm", scale: 1e3 },
  { key: "inner_tension_ratio", title: "Tension ratio, inner cables", yLabel: "T max / T min", scale: 1 },
  { key: "boundary_tension_ratio", title: "Tension ratio, boundary cables", yLabel: "T max / T min", scale: 1 },
];
// The goals that any stage has, each in its own unit.
function goalQuantities(study) {
  const keys = new Set(study.output.flatMap((o) => Object.keys(o).filter((k) => k.startsWith("goal_"))));
  return [...keys].sort().map((key) => {
    const name = clip(key.replace(/_/g, " "), NAME_MAX);
    return { key, title: name[0].toUpperCase() + name.slice(1), yLabel: name, scale: 1 };
  });
}
const CURVES_MAX = 12; // the points of more curves are drawn as marks, without lines

// Groups the points into curves: the points of a curve agree in all axes but one. Curves are in the order of the values
// that their points share.
function curves(study, axis, others) {
  const groups = new Map();
  for (let i = 0; i < study.n; i++) {
    const name = others.map((a) => `${a.name} ${a.label(i)}`).join(", ");
    if (!groups.has(name)) groups.set(name, { name, first: i, at: new Map() });
    groups.get(name).at.set(axis.value(i), i);
  }
  const order = (p, q) => {
    const a = others.find((o) => o.value(p.first) !== o.value(q.first));
    return a ? (a.value(p.first) < a.value(q.first) ? -1 : 1) : 0;
  };
  return [...groups.values()].sort(order);
}

function curveSeries(study, axis, others, stage, quantity) {
  const isThere = (of, i) => study.status[i] === "ok" && typeof of[quantity.key][i] === "number";
  const number = (of, i) => (isThere(of, i) ? of[quantity.key][i] * quantity.scale : null);
  const stages = others.length ? study.output.filter((o) => o.stage === stage) : study.output;
  const groups = curves(study, axis, others);
  if (groups.length > CURVES_MAX) {
    const points = Array.from({ length: study.n }, (_, i) => i).sort((i, j) => axis.value(i) - axis.value(j));
    return {
      x: points.map(axis.value),
      points,
      series: [
        {
          name: quantity.title,
          stored: quantity.key,
          colour: "--one",
          dots: true,
          values: points.map((i) => number(stages[0], i)),
        },
      ],
    };
  }
  const x = [...new Set(Array.from({ length: study.n }, (_, i) => axis.value(i)))].sort((a, b) => a - b);
  const series = groups.flatMap((group, k) =>
    stages
      .filter((of) => of[quantity.key])
      .map((of) => ({
        name: group.name || stageName[of.stage],
        stored: quantity.key,
        values: x.map((v) => (group.at.has(v) ? number(of, group.at.get(v)) : null)),
        colour: others.length
          ? () => sequential(0.15 + (0.85 * k) / Math.max(1, groups.length - 1))
          : STAGE_STYLE[of.stage][0],
        dash: others.length ? null : STAGE_STYLE[of.stage][1],
        dots: x.length < 2,
      })),
  );
  return { x, points: null, series };
}

function drawCurves(study, axis, others, stage, place) {
  const quantities = [...QUANTITIES, ...goalQuantities(study)];
  const charts = quantities.filter((q) => study.output.some((o) => o[q.key])).map((quantity) => {
    const { x, points, series } = curveSeries(study, axis, others, stage, quantity);
    const figure = quantity.key === "psi_m" && axis.key === "form.pretension_N" ? " Fig. 22." : "";
    const what = points
      ? "One mark per finished point."
      : others.length
        ? "One curve per value of the other axes."
        : "";
    return chart({
      ...quantity,
      xLabel: axis.text,
      x,
      series,
      counted: false,
      caption: `${what}${figure}`.trim(),
      head: (i) => (points ? `point ${study.id[points[i]]}, ` : "") + `${axis.name} ${fmt(x[i], 6)} ${axis.unit}`,
    });
  });
  place.replaceChildren(...charts.filter((c) => c));
}

function writeCurves(study, axes) {
  const along = axes.filter((a) => a.varies && a.isNumber),
    place = el("div", { class: "charts" });
  if (!along.length || !study.output.length) return;
  const state = {
    axis: along.find((a) => a.key === "form.pretension_N") || along[0],
    stage: (study.output.find((o) => o.stage === "optimize") || study.output[0]).stage,
  };
  const others = () => axes.filter((a) => a.varies && a !== state.axis);
  const redraw = (change) => {
    Object.assign(state, change);
    drawCurves(study, state.axis, others(), state.stage, place);
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
  section("sweep", "Sweep", tools.length ? el("div", { class: "tools" }, tools) : null, place);
  redraw({});
}

// ---- table of points ----

const ROWS_MAX = 2000,
  TOLD_MAX = 5;

// A link is made only to a file: any other scheme in the data stays text.
const href = (path) => (path.startsWith("/") ? "" : "./") + path.split("/").map(encodeURIComponent).join("/");

function pointCell(study, i) {
  const target = study.page[i] || study.file[i];
  return el("th", { scope: "row" }, target ? el("a", { href: href(target) }, study.id[i]) : study.id[i]);
}

function writePoints(study, axes) {
  const result = study.output.find((o) => o.stage === "optimize") || study.output[0] || {};
  const varying = axes.filter((a) => a.varies),
    fixed = axes.filter((a) => !a.varies),
    why = study.reason.some((r) => r);
  const number = (values, i, format) =>
    el("td", { class: "number" }, values && typeof values[i] === "number" ? format(values[i]) : "–");
  const headings = [
    ["Point"],
    ...varying.map((a) => [a.text, "number"]),
    ["Status"],
    ...study.output.map((o) => [`ψ ${stageName[o.stage]} (mm)`, "number"]),
    ["Inner ratio", "number"],
    ["Boundary ratio", "number"],
    ["Slack", "number"],
    ...(why ? [["Why"]] : []),
  ];
  const rows = Array.from({ length: Math.min(study.n, ROWS_MAX) }, (_, i) =>
    el(
      "tr",
      {},
      pointCell(study, i),
      varying.map((a) => el("td", { class: "number" }, a.label(i))),
      el("td", {}, statusText(study.status[i])),
      study.output.map((o) => number(o.psi_m, i, (v) => fmt(1e3 * v, 5))),
      number(result.inner_tension_ratio, i, fmtRatio),
      number(result.boundary_tension_ratio, i, fmtRatio),
      number(study.status[i] === "ok" ? result.n_slack : null, i, fmtCount),
      why ? el("td", { class: "wrap" }, study.reason[i]) : null,
    ),
  );
  const said = [];
  if (fixed.length) said.push(`All with ${fixed.map((a) => `${a.name} ${a.label(0)} ${a.unit}`.trim()).join(", ")}.`);
  if (study.page.some((p) => p)) said.push("A name leads to the report of its point, or else to the result file.");
  else if (study.file.some((p) => p)) said.push("A name leads to the result file of its point.");
  if (study.n > ROWS_MAX) said.push(`The first ${fmtCount(ROWS_MAX)} of ${fmtCount(study.n)} points.`);
  section("points", "Points", el("p", {}, said.join(" ")), table(headings, rows, "Points"));
}

// ---- the page ----

const statusText = (word) =>
  word === "not_evaluated" ? "missing" : word === "ok" ? "done" : word.replace(/_/g, " ");

function writeStudy(study) {
  const count = (test) => study.status.filter(test).length,
    failed = count((s) => s !== "ok" && s !== "not_evaluated");
  const missing = count((s) => s === "not_evaluated"),
    axes = readAxes(study);
  const result = study.output.find((o) => o.stage === "optimize") || study.output[0] || { psi_m: [] };
  let best = -1;
  result.psi_m.forEach((v, i) => {
    if (study.status[i] === "ok" && typeof v === "number" && (best < 0 || v < result.psi_m[best])) best = i;
  });
  document.getElementById("title").textContent = shown(data.title);
  document.getElementById("subtitle").textContent = shown(
    `Sweep of ${fmtCount(study.n)} points over ${axes.map((a) => a.name).join(", ")}`,
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
      figure("points", fmtCount(study.n)),
      figure("done", fmtCount(count((s) => s === "ok"))),
      figure("failed", fmtCount(failed)),
      figure("missing", fmtCount(missing)),
      best < 0
        ? null
        : figure(
            `least ψ, ${axes
              .filter((a) => a.varies)
              .map((a) => `${a.name} ${a.label(best)} ${a.unit}`.trim())
              .join(", ")}`,
            fmt(1e3 * result.psi_m[best], 4),
            "mm",
          ),
    ),
  );
  writeCurves(study, axes);
  writePoints(study, axes);
}

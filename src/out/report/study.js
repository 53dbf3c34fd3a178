// Contents: axes, figures, curves and maps, table of points, the page of a merged study.

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
    // small lengths, such as errors of cutting lengths, in mm
    const isSmall = isNumber && named.unit === "m" && (range(input.values.map(Math.abs)) || [0, 1])[1] < 0.1,
      values = isSmall ? input.values.map((v) => Number((1e3 * v).toPrecision(12))) : input.values;
    if (isSmall) Object.assign(named, { unit: "mm", text: `${named.name} (mm)` });
    const label = (i) =>
      input.texts
        ? clip(input.texts[i], NAME_MAX)
        : Array.from({ length: columns }, (_, k) => fmt(values[columns * i + k], 5)).join(" × ");
    const all = Array.from({ length: study.n }, (_, i) => i),
      countOf = (points) => new Set(points.map(label)).size,
      done = all.filter((i) => study.status[i] === "ok");
    return {
      key: input.name,
      extend: input.extend, // the side on which to extend the axis, if any
      ...named,
      label,
      isNumber,
      varies: countOf(all) > 1,
      isDrawn: countOf(done) > 1, // several of its values have a result
      only: done.length ? label(done[0]) : "",
      value: (i) => (isNumber ? values[i] : label(i)),
    };
  });
}

// ---- figures of the points ----

const STAGE_STYLE = {
  form: ["--one", null],
  search: ["--two", "7 3"],
  refine: ["--three", "2 3"],
  result: ["--three", "2 3"], // refined at some points, of the search at others
};
const BUILT = "tolerance", // the stage of the as-built net
  REQUIRED = "requirements", // that of the verdicts
  MARGIN = "relative_margin_min";
const isOfStage = (figure) => figure.main !== BUILT && figure.main !== REQUIRED;
const stageOf = (figure, stage) => (isOfStage(figure) ? stage : figure.main);
const VERDICTS = {
  pass: ["passes", "✓", "--one"],
  undecided: ["undecided", "?", "--ghost"],
  fail: ["fails", "✗", "--alarm"],
};
const isLoadCase = (stage) => stage.startsWith("load case "); // of the as-built net
const stageWords = (stage) => stageName[stage] || stage;
const SHOWN_IN = { m: ["mm", 1e3], Hz: ["GHz", 1e-9] };

// Returns the names of a figure: title, name of its values on an axis, rank among the figures, heading of its column.
function figureWords({ key, objective: objectiveWords }) {
  const [, facets, fit, rest] = key.match(/^(facet_)?(fit_)?(.*)$/),
    after = fit ? ", after best fit" : "",
    fitted = fit ? ", fitted" : "",
    of = facets ? "facets" : "nodes";
  const loss = rest.match(/^gain_loss_at_(.*)_GHz_dB$/),
    objective = objectiveWords && clip(objectiveWords, NAME_MAX);
  if (key === "psi_m") return ["Surface error ψ", "ψ", 1, "ψ"];
  if (key === "psi_95_m") return ["95th percentile of ψ of the samples", "ψ", 0, "ψ of 95 %"];
  if (key === MARGIN) return ["Smallest relative margin of the requirements", "margin", -1, "Smallest margin"];
  if (key === "merit") return ["Merit of all objectives with their weights", "merit", 2, "Merit"];
  if (key === "yield") return ["Yield: samples that meet all rows with a share", "yield", 2, "Yield"];
  if (rest === "half_path_rms_m")
    return [`Half-path error of the ${of}${after}`, "RMS", fit ? 4 : 3, `RMS of ${of}${fitted}`];
  if (rest === "gain_loss_1dB_Hz")
    return [`Frequency of 1 dB gain loss of the ${of}${after}`, "frequency", fit ? 6 : 5, `1 dB gain loss${fitted}`];
  const feed = key.match(/^(refocused|fixed)_gain_loss_at_(.*)_GHz_dB$/),
    beam = key.match(/^pointing_at_(.*)_GHz_deg$/);
  if (feed)
    return [
      `Gain loss at ${feed[2]} GHz, ${feed[1]} feed`,
      "loss",
      feed[1] === "fixed" ? 6 : 5,
      `Loss at ${feed[2]} GHz, ${feed[1]} feed`,
    ];
  if (beam)
    return [`Angle of the beam at ${beam[1]} GHz, fixed feed`, "angle", 7, `Beam at ${beam[1]} GHz, fixed feed`];
  if (loss) return [`Gain loss at ${loss[1]} GHz${after}`, "loss", fit ? 8 : 7, `Gain loss at ${loss[1]} GHz${fitted}`];
  if (objective) return [`Objective ${objective}`, objective, 9, `Objective ${objective}`];
  if (key === "inner_tension_ratio")
    return ["Tension ratio, inner cables", "T max / T min", 10, "Tension ratio, inner"];
  if (key === "boundary_tension_ratio")
    return ["Tension ratio, boundary cables", "T max / T min", 11, "Tension ratio, boundary"];
  if (key === "n_slack") return ["Slack cables", "slack cables", 12, "Slack cables"];
  if (key === "n_loose") return ["Loose nodes", "loose nodes", 13, "Loose nodes"];
  if (key === "tension_max_N") return ["Maximum tension", "T max", 14, "Maximum tension"];
  return null;
}
const lowered = (title) => title.replace(/^[A-Z]/, (c) => c.toLowerCase());

// Returns the figures of a study with their stages.
//   of: (i, stage) -> value at a finished point, or null
//   drawn: the stages in which the figure varies by more than rounding
// Losses by Ruze's formula are left out beside those by physical optics, which are for the feeds that they name.
function readFigures(study, mainStage) {
  const hasOptics = study.figure.some(({ key }) => /^refocused_gain_loss_at_/.test(key)),
    isBehind = ({ key }) => hasOptics && /gain_loss/.test(key) && !/^(refocused|fixed)_gain/.test(key);
  const rows = study.figure.filter((row) => figureWords(row) && !row.psi && !isBehind(row));
  return [...new Set(rows.map(({ key }) => key))]
    .map((key) => {
      const own = rows.filter((row) => row.key === key),
        [title, name, rank, column] = figureWords(own[0]),
        [unit, scale] = key === "yield" || key === MARGIN ? ["%", 100] : SHOWN_IN[own[0].unit] || [own[0].unit, 1],
        main = [BUILT, REQUIRED].find((stage) => own.some((row) => row.stage === stage)) || mainStage;
      const values = Object.fromEntries(study.output.filter((o) => o[key]).map((o) => [o.stage, o[key]]));
      return {
        key,
        title,
        rank,
        column,
        unit,
        main,
        yLabel: unit ? `${name} (${unit})` : name,
        isLoss: /gain_loss_at_/.test(key),
        isError: /half_path_rms_m|gain_loss_1dB_Hz/.test(key),
        log: /^n_/.test(key) || key === MARGIN ? false : "auto", // a count may be 0, a margin negative
        // a loss without a value is outside the range of the formula if the surface error has one
        isBeyond: (i, stage = main) => {
          const errors = study.output.find((o) => o.stage === stage) || {},
            rms = errors[key.replace(/gain_loss_at_.*/, "half_path_rms_m")] || [];
          return study.status[i] === "ok" && typeof rms[i] === "number";
        },
        stages: own.map(({ stage }) => stage),
        drawn: own.filter(({ same }) => !same).map(({ stage }) => stage),
        of: (i, stage = main) => {
          const v = (values[stage] || [])[i];
          return study.status[i] === "ok" && typeof v === "number" ? v * scale : null;
        },
      };
    })
    .sort((f, g) => f.rank - g.rank);
}

// Returns the required figures in the order of their columns. They have no other stage than that of the verdicts.
function readRequired(study) {
  return (study.required || []).map((row, k) => {
    const { unit, times } = scaleOf(row.unit),
      inUnit = (name) => (unit ? `${name} (${unit})` : name),
      hasBound = hasNumber(row.at_least) || hasNumber(row.at_most), // else an axis has it
      of = (i) => (study.status[i] === "ok" && hasNumber(row.values[i]) ? times * row.values[i] : null);
    const values = pointsDone(study).map(of),
      [low, high] = range(values.filter(Number.isFinite)) || [0, 0],
      varies = isChange(low, high) || new Set(values.map(Number.isFinite)).size > 1;
    return {
      key: `required ${k}`,
      row,
      title: hasBound ? `${row.name}: ${boundOf(row)}` : row.name,
      rank: -0.5,
      column: hasBound ? `${row.name}: ${boundOf(row)}` : inUnit(row.name),
      unit,
      main: REQUIRED,
      yLabel: inUnit(plainWord(row.name.split(/[ ,]/)[0])),
      log: false,
      stages: [REQUIRED],
      drawn: varies ? [REQUIRED] : [],
      of,
    };
  });
}

// Returns the text of a figure that is the same at all points. Of stages other than the result only psi is listed.
function sameText(study, f, stage) {
  const i = study.status.findIndex((word, k) => word === "ok" && f.of(k, stage) !== null),
    of = f.key === "psi_m" && f.stages.length > 1 ? ` ${stageWords(stage)}` : "";
  if (stage !== f.main && f.key !== "psi_m") return "";
  if (f.key === "n_slack" && i >= 0) return `slack cables of the design ${fmtCount(f.of(i, stage))}`;
  const isBeyond = f.isLoss && study.status.some((_, k) => f.isBeyond(k, stage));
  if (i < 0) return isBeyond ? `${lowered(f.title)} above 3\u00a0dB` : "";
  const value = (f.unit === "mm" ? rounded : fmt)(f.of(i, stage), 5);
  return `${lowered(f.title)}${of} ${value}${f.unit ? `\u00a0${f.unit}` : ""}`;
}

// Returns whether two values differ by more than rounding.
const isChange = (low, high) => high - low > 1e-6 * Math.max(Math.abs(low), Math.abs(high));

// Returns the share of an axis in the variance of a figure: the variance of the means over points with the same value
// of the axis. In a full product of axes, the shares of all axes and of their interaction add up to 1.
function shareOf(study, figure, axis) {
  const groups = new Map();
  let n = 0,
    sum = 0,
    square = 0;
  for (let i = 0; i < study.n; i++) {
    const v = figure.of(i);
    if (v === null || !Number.isFinite(v)) continue;
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

// ---- replicates ----

const REPLICATE = "replicate";

// Returns the value at a position from 0 to 1 among sorted numbers, as the program computes it.
function quantile(sorted, position) {
  const at = position * (sorted.length - 1),
    k = Math.floor(at);
  return at > k ? (1 - (at - k)) * sorted[k] + (at - k) * sorted[k + 1] : sorted[k];
}

// Returns figures whose value at a point is the median over the replicates of the point, with their quartiles. A failed
// replicate is the worst one in the figure that ranks.
function medians(study, axes, figures) {
  const others = axes.filter((a) => a.key !== REPLICATE),
    groups = new Map(),
    nameOf = (i) => others.map((a) => a.label(i)).join("\n");
  for (let i = 0; i < study.n; i++) {
    if (study.status[i] === "not_evaluated") continue;
    groups.set(nameOf(i), [...(groups.get(nameOf(i)) || []), i]);
  }
  const quantileOf = (f, position) => (i, stage) => {
    const worst = f.isLead ? (f.key === MARGIN ? -Infinity : Infinity) : null,
      values = (groups.get(nameOf(i)) || []).map((k) => f.of(k, stage) ?? worst).filter((v) => v !== null),
      value = values.length ? quantile(values.sort((a, b) => a - b), position) : null;
    return Number.isFinite(value) ? value : null;
  };
  return figures.map((f) => ({
    ...f,
    of: quantileOf(f, 0.5),
    quartiles: (i, stage) => {
      const ends = [0.25, 0.75].map((position) => quantileOf(f, position)(i, stage));
      return ends.includes(null) ? null : ends;
    },
  }));
}

// Returns the best point or, with replicates, that of the group with the best median.
const bestOf = ({ replicates, id, best }) =>
  replicates ? id.indexOf(replicates.groups.find(({ rank }) => rank === 1).best) : best;

// ---- curves and maps ----

const CURVES_MAX = 4; // more curves are drawn as a map of two axes, or as marks
const pointsDone = (study) => Array.from({ length: study.n }, (_, i) => i).filter((i) => study.status[i] === "ok");
const valuesOf = (study, axis) =>
  [...new Set(pointsDone(study).map(axis.value))].sort((a, b) => (a < b ? -1 : a > b ? 1 : 0));

// Groups the points into curves. Points of a curve agree in all axes but one. Curves are in the order of the values
// that their points share.
function curves(study, axis, others) {
  const groups = new Map();
  for (const i of pointsDone(study)) {
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
const listed = (names) =>
  names.length < 2 ? names.join("") : `${names.slice(0, -1).join(", ")} and ${names[names.length - 1]}`;
const pointName = (axes, i) =>
  axes
    .filter((a) => a.varies)
    .map((a) => headOf(a, a.label(i)))
    .join(", ");

// Returns the marks of points by their verdicts, and the line of margin 0, for a chart of the margin.
function verdictSeries(study, points, figure) {
  const marks = Object.entries(VERDICTS).map(([verdict, [name, , colour]]) => ({
    name,
    colour,
    dots: true,
    size: 9,
    values: points.map((i) => (i !== undefined && study.verdict[i] === verdict ? figure.of(i) : null)),
  }));
  const zero = { name: "margin 0", colour: "--alarm", dash: "6 4", isLevel: true, values: points.map(() => 0) };
  return [zero, ...marks.filter(({ values }) => values.some((v) => v !== null))];
}

// Returns horizontal lines at the bounds of a required figure.
function levelsOf({ row }, series) {
  if (!row) return [];
  const ends = range(series.flatMap(({ values }) => values).filter(Number.isFinite)) || [0, 0];
  return boundMarks(row, scaleOf(row.unit).times, ends).map(({ at, ...mark }) => ({ ...mark, level: at }));
}

const isWhole = (x) => x.every(Number.isInteger);

function curveChart(study, figure, axis, others, groups, stage) {
  const x = valuesOf(study, axis),
    isOne = groups.length === 1;
  const isStaged = isOfStage(figure),
    stages = isOne ? figure.drawn : [stageOf(figure, stage)],
    loadCases = figure.stages.filter(isLoadCase),
    unstaged = figure.row ? "value" : figure.main === BUILT ? "samples" : "smallest margin",
    styleOf = (of) => STAGE_STYLE[of] || [SERIES[(loadCases.indexOf(of) + 3) % SERIES.length], "1 2"];
  const series = groups.flatMap((group, k) =>
    stages.map((of) => ({
      name: group.name || (isStaged ? stageWords(of) : unstaged),
      stored: figure.row ? undefined : figure.key,
      values: x.map((v) => (group.at.has(v) ? figure.of(group.at.get(v), of) : null)),
      errors: figure.quartiles && x.map((v) => (group.at.has(v) ? figure.quartiles(group.at.get(v), of) : null)),
      colour: isOne && isStaged ? styleOf(of)[0] : SERIES[k],
      dash: isOne && isStaged ? styleOf(of)[1] : null,
      dots: x.length < 2,
    })),
  );
  if (isOne && figure.key === MARGIN && !figure.quartiles)
    series.push(
      ...verdictSeries(
        study,
        x.map((v) => groups[0].at.get(v)),
        figure,
      ),
    );
  const bounds = levelsOf(figure, series);
  const isAlone = isOne && isStaged && stages.length === 1 && figure.stages.length > 1; // the chart then has no legend
  return chart({
    ...figure,
    title: isAlone ? `${figure.title}, ${stageWords(stages[0])}` : figure.title,
    xLabel: axis.text,
    x,
    series,
    counted: isWhole(x),
    floor: ["mm", "N"].includes(figure.unit) ? RESOLVED_MM : undefined, // smaller values are rounding
    marks: [
      ...bounds.filter(({ isFar }) => !isFar),
      ...(isOne && figure.isLead
        ? [
            {
              name: study.replicates ? "best median" : bestWord(study) + " point",
              at: axis.value(bestOf(study)),
              colour: "--alarm",
              dash: "2 3",
            },
          ]
        : []),
    ],
    caption: [
      isOne ? "" : `The chart contains one curve for each value of ${listed(others.map((a) => a.name))}.`,
      figure.quartiles ? "Each mark is the median of the replicates. The error bar extends between the quartiles." : "",
      outsideText(bounds),
    ]
      .filter((text) => text)
      .join(" "),
    head: (i) => headOf(axis, fmt(x[i], 6)),
  });
}

// Draws a mark for each point.
function markChart(study, figure, axis, others, stage) {
  const points = pointsDone(study).sort((i, j) => axis.value(i) - axis.value(j)),
    values = points.map((i) => figure.of(i, stageOf(figure, stage))),
    bounds = levelsOf(figure, [{ values }]);
  return chart({
    ...figure,
    marks: bounds.filter(({ isFar }) => !isFar),
    xLabel: axis.text,
    x: points.map(axis.value),
    counted: isWhole(points.map(axis.value)),
    caption: `The chart contains one mark for each completed point of the study. ${outsideText(bounds)}`.trim(),
    head: (i) => pointName([axis, ...others], points[i]),
    series: [
      {
        name: figure.row ? "value" : figure.title,
        stored: figure.row ? undefined : figure.key,
        colour: "--one",
        dots: true,
        values,
      },
      ...(figure.key === MARGIN ? verdictSeries(study, points, figure) : []),
    ],
  });
}

// Draws a map of two axes, with a coloured cell for each pair of values. The cell shows its value if there is room.
// third: with an axis there is one map for each of its values; all have the same colours
const CELL_TEXT_MAX = 44, // characters of a row that fit
  MAPS_MAX = 12; // more values of a third axis are drawn as marks
function heatMap(study, figure, axis, other, stage, third) {
  const columns = valuesOf(study, axis),
    rows = valuesOf(study, other).reverse(),
    panels = third ? valuesOf(study, third) : [""],
    place = (x, y, z) => `${x} ${y} ${z}`,
    at = new Map();
  for (const i of pointsDone(study)) at.set(place(axis.value(i), other.value(i), third ? third.value(i) : ""), i);
  const from = stageOf(figure, stage),
    isMargin = figure.key === MARGIN;
  const all = range([...at.values()].map((i) => figure.of(i, from)));
  if (!all) return null;
  // Margin 0 is the middle of the colours. They end at the largest margin that passes, so that it differs from 0.
  const most = all[1] > 0 ? all[1] : Math.abs(all[0]) || 1,
    [scale, low, high] = isMargin ? [(t) => diverging(1 - t), -most, most] : [sequential, ...widened(all)];
  const label = (a, value) => (a.isNumber ? fmt(value, 4) : String(value)),
    isWide = isMargin && columns.length > 4;
  const bar = el("div", { class: "bar" });
  const decimals = isMargin ? 1 : Math.min(9, Math.max(0, 2 - Math.floor(Math.log10(all[1] - all[0] || 1))));
  const text = (v) => (Math.abs(all[1]) < 1e5 ? minus(v.toFixed(decimals)) : fmt(v, 3));
  const cell = (i) => {
    const v = i === undefined ? null : figure.of(i, from);
    if (v === null) return el("td", { class: "gap", title: "no value" }, "–");
    const [verdict, sign] = (isMargin && VERDICTS[study.verdict[i]]) || ["", ""],
      t = high > low ? Math.min(1, Math.max(0, (v - low) / (high - low))) : 0,
      where = [axis, other, ...(third ? [third] : [])].map((a) => headOf(a, label(a, a.value(i)))).join(", "),
      node = el("td", {
        class: figure.isLead && i === study.best ? "best" : undefined,
        title: `${where}: ${minus(fmt(v, 5))} ${figure.unit}${verdict ? `, ${verdict}` : ""}`,
      });
    const paintCell = () => {
      const colour = scale(t),
        light = [0.2126, 0.7152, 0.0722].reduce((sum, part, k) => sum + part * (colour[k] / 255) ** 2.2, 0);
      node.style.background = rgb(colour);
      node.style.color = light > 0.18 ? "#000" : "#fff"; // where both have the same contrast
    };
    paintCell();
    for (const scheme of [darkScheme, printing]) scheme.addEventListener("change", paintCell);
    const hasRoom = columns.length * text(all[1]).length <= CELL_TEXT_MAX;
    if (sign) node.append(`${sign} `);
    // a telephone shows only the sign
    const kind = !hasRoom ? "hidden" : sign && columns.length > 4 ? "amount" : undefined;
    node.append(kind ? el("span", { class: kind }, text(v)) : text(v));
    return node;
  };
  const map = (z) => {
    const name = third ? headOf(third, label(third, z)) : "";
    return el(
      "div",
      {
        class: "scroll",
        tabindex: 0,
        role: "region",
        "aria-label": `${figure.title}, a map of two axes ${name}`.trim(),
      },
      name ? el("h4", {}, name) : null,
      el(
        "table",
        {},
        el("caption", {}, `${other.text} down, ${axis.text} across`),
        el(
          "tbody",
          {},
          rows.map((y) =>
            el(
              "tr",
              {},
              el("th", { scope: "row" }, label(other, y)),
              columns.map((x) => cell(at.get(place(x, y, z)))),
            ),
          ),
        ),
        el(
          "tfoot",
          {},
          el(
            "tr",
            {},
            el("th", { scope: "row" }, ""),
            columns.map((x) => el("th", { scope: "col" }, label(axis, x))),
          ),
        ),
      ),
    );
  };
  drawBar(bar, scale, [low, high], figure.yLabel, all);
  return el(
    "figure",
    { class: third || isWide ? "heat wide" : "heat" },
    el("h3", {}, figure.title),
    el("div", { class: third ? "charts" : undefined }, panels.map(map)),
    bar,
  );
}

// Returns whether the figure changes along the axis of these curves.
function changesAlong(figure, groups, stage) {
  const from = stageOf(figure, stage);
  return groups.some(({ at }) => {
    const values = [...at.values()].map((i) => figure.of(i, from)),
      [low, high] = range(values) || [0, 0];
    return isChange(low, high) || new Set(values.map(Number.isFinite)).size > 1;
  });
}

function drawFigures(study, figures, axis, others, stage, charts, note) {
  const groups = curves(study, axis, others),
    count = (a) => valuesOf(study, a).length,
    [other, third] = [...others].sort((a, b) => count(b) - count(a)), // maps for the few values of the third axis
    hasMap = groups.length > 1 && others.length <= 2 && (!third || count(third) <= MAPS_MAX),
    isMap = (f) => hasMap && (third || groups.length > CURVES_MAX || f.key === MARGIN);
  const has = (f) => f.drawn.includes(stageOf(f, stage)),
    all = figures.filter((f) => !f.isLoss && (groups.length === 1 ? f.drawn.length : has(f))),
    drawn = all.filter((f) => groups.length === 1 || isMap(f) || changesAlong(f, groups, stage)),
    flat = all.filter((f) => !drawn.includes(f));
  note.textContent = flat.length
    ? `The following quantities do not depend on ${axis.name}: ${flat.map((f) => lowered(f.title)).join("; ")}.`
    : "";
  const drawings = drawn.map((f) =>
    isMap(f)
      ? heatMap(study, f, axis, other, stage, third)
      : groups.length > CURVES_MAX || (f.key === MARGIN && groups.length > 1)
        ? markChart(study, f, axis, others, stage)
        : curveChart(study, f, axis, others, groups, stage),
  );
  charts.replaceChildren(...drawings.filter((c) => c));
}

const LITTLE = 0.001; // a smaller share of the variance is negligible

// Describes the shares of the axes in the variance of a figure.
function whatMatters(figure, shares) {
  if (shares.length < 2) return "";
  const part = (share) => (share < LITTLE ? "less than 0.1\u00a0%" : percent(share, 2));
  const parts = shares.map(({ axis, share }) => `${axis.name} ${part(share)}`),
    rest = 1 - shares.reduce((sum, { share }) => sum + share, 0);
  const both = rest > 0.005 ? ` Interactions between the axes contribute ${part(rest)}.` : "";
  const title = figure.title.replace(/^S/, "s");
  return `The axes contribute the following shares to the variance of ${title}: ${parts.join(", ")}.${both}`;
}

function writeCurves(study, axes, figures, mainStage) {
  const varying = axes.filter((a) => a.isDrawn && !(study.replicates && a.key === REPLICATE)),
    along = varying.filter((a) => a.isNumber),
    note = el("p", { class: "flat" }),
    charts = el("div", { class: "charts" }),
    lead = figures.find((f) => f.isLead);
  const same = figures
    .flatMap((f) => f.stages.filter((s) => !f.drawn.includes(s)).map((s) => sameText(study, f, s)))
    .filter((text) => text);
  const psi = study.figure.filter((f) => f.psi && f.stage === mainStage),
    fixed = axes.filter((a) => a.varies && !a.isDrawn && a.only);
  const notes = [
    ...along
      .filter((a) => a.extend)
      .map((a) => {
        const end = headOf(a, a.label(bestOf(study)));
        const change = lead.key === MARGIN ? "increases" : "decreases";
        const of = study.replicates ? `The median of ${lowered(lead.title)}` : lead.title;
        return `${of} still ${change} at the end of the axis (${end}). Add points ${a.extend} this value.`;
      }),
    same.length ? `At all points: ${same.join("; ")}.` : "",
    ...psi.map(
      ({ objective }) =>
        `The page does not list the objective ${objective} separately, because this objective equals ψ.`,
    ),
    ...fixed.map((a) => `All completed points have ${headOf(a, a.only)}.`),
  ];
  const shares = lead
    ? varying.map((axis) => ({ axis, share: shareOf(study, lead, axis) })).sort((a, b) => b.share - a.share)
    : [];
  if (!along.length || !figures.length) return;
  const most = shares.find(({ axis }) => axis.isNumber);
  const state = { axis: (most && most.axis) || along[0], stage: mainStage };
  const others = () => varying.filter((a) => a !== state.axis);
  const redraw = (change) => {
    Object.assign(state, change);
    drawFigures(study, figures, state.axis, others(), state.stage, charts, note);
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
  const stages = study.output.filter((o) => o.stage !== BUILT && o.stage !== REQUIRED);
  if (stages.length > 1 && others().length)
    tools.push(
      choice(
        "stage",
        "Shape",
        stages.map((o) => [o.stage, stageWords(o.stage)]),
        state.stage,
        (stage) => redraw({ stage }),
      ),
    );
  section(
    "sweep",
    "Sweep",
    lead ? el("p", {}, whatMatters(lead, shares)) : null,
    el("p", { class: "same" }, notes.filter((text) => text).join(" ")),
    tools.length ? el("div", { class: "tools" }, tools) : null,
    charts,
    note,
  );
  redraw({});
}

// ---- table of points ----

const FAILURES_SHOWN = 5,
  COLUMNS_WIDE = 11, // a table with more columns has narrow ones
  REQUIRED_SHOWN = 5, // requirements with a column and a chart at first, as in the text
  POINTS_SHOWN = 64;

// Returns a link to a file only. Any other scheme in the data becomes part of a path.
const href = (path) => (path.startsWith("/") ? "" : "./") + path.split("/").map(encodeURIComponent).join("/");

// Returns a link to the result of a point, which is named by its values; without a result, the id of the point.
function pointLink(study, axes, i) {
  const target = study.page[i] || study.file[i],
    word = study.page[i] ? "report" : "result file";
  if (!target) return study.id[i];
  return el("a", { href: href(target), title: study.id[i], "aria-label": `${word}: ${pointName(axes, i)}` }, word);
}

const aligned = (v, digits) => (v === 0 ? "0" : Math.abs(v) < RESOLVED_MM ? rounded(v) : digitsOf(v, digits));

// Returns the column of a figure of a stage.
function figureColumn(study, f, stage) {
  const of = (i) => f.of(i, stage),
    name = f.key === "psi_m" ? `ψ ${stageWords(stage)}` : isLoadCase(stage) ? `${f.column}, ${stage}` : f.column,
    percents = (v) => (Number.isFinite(v) ? minus(v.toFixed(1)) : minus(fmt(v))),
    isCount = /^n_/.test(f.key),
    plain = f.row && !f.unit ? fmt : aligned, // such as a number of slack cables
    format = /ratio$/.test(f.key) ? fmtRatio : isCount ? fmtCount : f.unit === "%" ? percents : plain;
  const show = (i) =>
    of(i) === null ? (f.isLoss && f.isBeyond(i, stage) ? "> 3" : "–") : format(of(i), f.unit === "mm" ? 5 : 4);
  return { name: f.unit && !f.row ? `${name} (${f.unit})` : name, number: true, of, show };
}

function writePoints(study, axes, figures, best) {
  // The table has the gain loss with the refocused feed. The charts have that with the fixed feed, too.
  const hasOptics = figures.some((f) => /^refocused_gain_loss_at_/.test(f.key)),
    isRadio = (f) => /gain_loss_at_|ruze|pointing/.test(f.key),
    isInTable = (f) => {
      if (f.key === "yield" && study.tightest.length) return false; // the verdict says it
      return !hasOptics || /^refocused_gain_loss_at_/.test(f.key) || !isRadio(f);
    };
  const varying = axes.filter((a) => a.varies),
    fixed = axes.filter((a) => !a.varies),
    rows = Array.from({ length: study.n }, (_, i) => i);
  const statusCell = (i) =>
    el("span", { class: "status", title: study.reason[i] || undefined }, statusText(study.status[i]));
  const tightestCell = (i) => el("span", { class: "tightest" }, study.tightest[i]);
  const leading = [
    ...varying.map((a) => ({ name: a.text, number: a.isNumber, of: a.value, show: (i) => a.label(i) })),
    { name: "Status", of: (i) => statusText(study.status[i]), show: statusCell },
    ...(study.tightest.length
      ? [
          { name: "Verdict", of: (i) => study.verdict_text[i], show: (i) => study.verdict_text[i] },
          { name: "Tightest requirement and its margin", of: (i) => study.tightest[i], show: tightestCell },
        ]
      : []),
  ];
  const columnsOf = (some) =>
      some
        .filter(isInTable)
        .flatMap((f) =>
          f.drawn
            .filter((s) => f.key === "psi_m" || s === f.main || (isLoadCase(s) && !f.isError))
            .map((s) => figureColumn(study, f, s)),
        ),
    link = { name: "Result", of: (i) => study.id[i], show: (i) => pointLink(study, axes, i) },
    required = figures.filter((f) => f.row).map((f) => figureColumn(study, f, REQUIRED)),
    isMargin = (f) => f.key === MARGIN;
  // With requirements, the table first has the tightest of them; the other figures are behind a button.
  const all = [
    ...leading,
    ...columnsOf(figures.filter(isMargin)),
    ...required,
    ...columnsOf(figures.filter((f) => !isMargin(f) && !f.row)),
    link,
  ];
  const n = leading.length + columnsOf(figures.filter(isMargin)).length + Math.min(required.length, REQUIRED_SHOWN);
  const notes = [];
  if (fixed.length) notes.push(`All points have ${fixed.map((a) => headOf(a, a.label(0))).join(", ")}.`);
  if (study.ranked_by) notes.push(`The points are ranked by ${study.ranked_by}.`);
  if (best >= 0) notes.push(`The ${bestWord(study)} point is marked. Click a column heading to sort the table.`);
  if (study.page.some((p) => p))
    notes.push(
      "The last column links to the report of each point. If a point has no report, the last column links to its " +
        "result file.",
    );
  else if (study.file.some((p) => p)) notes.push("The last column links to the result file of each point.");
  const tableOf = (columns) => {
    const points = sortableTable({
      caption: "Points",
      columns,
      n: study.n,
      by: -1,
      most: POINTS_SHOWN,
      dense: columns.length > COLUMNS_WIDE,
      search: "value or status",
      words: (i) =>
        [statusText(study.status[i]), study.reason[i], study.tightest[i] || "", ...columns.map(({ show }) => show(i))]
          .map((text) => (typeof text === "string" ? text : study.id[i]))
          .join(" "),
    });
    points.first(best);
    return points.node;
  };
  const isShort = required.length && n + 1 < all.length,
    table = tableOf(isShort ? [...all.slice(0, n), link] : all),
    more = el("button", { type: "button" }, "show all columns");
  more.addEventListener("click", () => {
    table.replaceWith(tableOf(all));
    more.parentElement.remove();
  });
  section(
    "points",
    "Points",
    el("p", {}, notes.join(" ")),
    table,
    isShort ? el("div", { class: "tools" }, more) : null,
  );
}

// ---- the page ----

const isJudged = (study) => study.verdict.some((word) => word !== "none");
// The first point of the ranking is the best one only if it passes.
const bestWord = (study) => (isJudged(study) && study.verdict[study.best] !== "pass" ? "closest" : "best");

// Writes whether the two best groups of replicates differ.
function writeScatter({ replicates }) {
  const text = replicates && replicates.scatter;
  return text ? el("p", { class: "advice" }, `${text[0].toUpperCase()}${text.slice(1)}.`) : null;
}

// Writes which points pass. If the closest point does not pass, none does.
function writeAdvice(study) {
  if (!study.advice) return null;
  const closest = study.best >= 0 && bestWord(study) === "closest" ? study.verdict_text[study.best] : "";
  return el(
    "p",
    { class: "advice" },
    `${study.advice.replace(/^n/, "N")}. `,
    closest ? `The verdict on the closest point is: ${closest}. ` : "",
    / between the points /.test(study.advice) ? "Values between the points have not been tried." : "",
  );
}

const statusText = (word) => (word === "not_evaluated" ? "missing" : word === "ok" ? "done" : word.replace(/_/g, " "));

function writeStudy(study) {
  const count = (test) => study.status.filter(test).length,
    failed = count((s) => s !== "ok" && s !== "not_evaluated");
  const missing = count((s) => s === "not_evaluated"),
    axes = readAxes(study),
    varying = axes.filter((a) => a.varies);
  const mainStage = study.main,
    figures = [...readFigures(study, mainStage), ...readRequired(study)].sort((f, g) => f.rank - g.rank),
    best = study.best;
  const leads = study.figure.find((f) => f.lead) || {};
  for (const f of figures) f.isLead = f.key === leads.key;
  const lead = figures.find((f) => f.isLead),
    value = lead && lead.unit === "mm" ? rounded : fmt,
    others = (axis) => axes.filter((a) => a.isDrawn && a !== axis),
    matters = (axis) => axis.isDrawn && changesAlong(lead, curves(study, axis, others(axis)), lead.main);
  document.getElementById("title").textContent = shown(data.title);
  document.getElementById("subtitle").textContent = shown(
    `Sweep of ${fmtCount(study.n)} points over ${listed((varying.length ? varying : axes).map((a) => a.name))}`,
  );
  document.getElementById("footer").textContent = shown(`Merged study ${study.path}.`);
  // points grouped by the kind of failure, with the reason of the first
  const ways = new Map();
  study.reason.forEach((reason, i) => {
    const way = reason.split(": ")[0];
    if (reason) ways.set(way, [...(ways.get(way) || []), i]);
  });
  const failures = [...ways.values()].map(
    ([i, ...more]) =>
      `${pointName(axes, i)}${more.length ? ` and ${fmtCount(more.length)} more` : ""}: ${study.reason[i]}`,
  );
  writeWarnings(
    failed === 1 ? "One point failed" : failed ? `${fmtCount(failed)} points failed` : "Points of note",
    failures.length > FAILURES_SHOWN
      ? [
          ...failures.slice(0, FAILURES_SHOWN),
          `${failures.length - FAILURES_SHOWN} more kinds of failure; hifdm status lists all reasons`,
        ]
      : failures,
  );
  const [median] = study.replicates && lead ? medians(study, axes, [lead]) : [],
    typical = median ? bestOf(study) : -1;
  const best_is = bestWord(study),
    ofLead = isJudged(study) ? `${best_is} point, ` : "minimum ";
  main.append(
    ...[writeAdvice(study), writeScatter(study)].filter((node) => node),
    el(
      "dl",
      { class: "figures" },
      best < 0 || !lead ? null : figure(ofLead + lowered(lead.title), value(lead.of(best), 4), lead.unit),
      typical < 0 || !lead ? null : figure("best median", value(median.of(typical), 4), lead.unit),
      best < 0 || !lead
        ? null
        : varying
            .filter((a) => matters(a) && a.key !== REPLICATE)
            .map((a) => figure(`${best_is} ${a.name}`, a.label(bestOf(study)), a.unit)),
      isJudged(study)
        ? figure("points pass", `${fmtCount(count((_, i) => study.verdict[i] === "pass"))} of ${fmtCount(study.n)}`)
        : null,
      figure("points done", `${fmtCount(count((s) => s === "ok"))} of ${fmtCount(study.n)}`),
      failed ? figure("failed", fmtCount(failed)) : null,
      missing ? figure("missing", fmtCount(missing)) : null,
    ),
  );
  const isDrawn = (f) => !f.row || study.required.indexOf(f.row) < REQUIRED_SHOWN;
  const drawn = figures.filter(isDrawn);
  writeCurves(study, axes, study.replicates ? medians(study, axes, drawn) : drawn, mainStage);
  writePoints(study, axes, figures, best);
}

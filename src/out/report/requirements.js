// The verdicts on the rows of `requirements`, and the distribution functions of the figures of their samples.

const VERDICT_RANK = { fail: 0, undecided: 1, pass: 2 },
  TIGHTEST_SHOWN = 5, // rows shown besides those that are not passed, as in the summary
  DISTRIBUTIONS_SHOWN = 4;

const scaleOf = (unit) => (unit === "m" ? { unit: "mm", times: 1e3 } : { unit, times: 1 });
const hasNumber = (value) => typeof value === "number";
function withUnit(value, of) {
  const { unit, times } = scaleOf(of);
  return hasNumber(value) ? `${fmt(times * value, 4)}${unit ? `\u00a0${unit}` : ""}` : "–";
}
const withSign = (value, text) => (value > 0 ? `+${text}` : text);

function boundOf({ at_least: low, at_most: high, unit }) {
  if (!hasNumber(high)) return `at least ${withUnit(low, unit)}`;
  if (!hasNumber(low)) return `at most ${withUnit(high, unit)}`;
  return `${fmt(scaleOf(unit).times * low, 4)} to ${withUnit(high, unit)}`;
}

// Returns which samples meet a row, or the numerical error of a nominal value that decides nothing.
function evidenceOf(row) {
  if (hasNumber(row.yield))
    return `${fmt(100 * row.yield, 4)} (${fmt(100 * row.yield_low, 4)} to ${fmt(100 * row.yield_high, 4)})`;
  return row.verdict === "undecided" ? `value certified to ${withUnit(row.error_bound, row.unit)} only` : "–";
}

function worstOf(row) {
  const isSample = row.worst_sample >= 0,
    parts = [
      isSample ? `${withUnit(row.worst_value, row.unit)} in sample ${row.worst_sample}` : "",
      row.worst_item,
      row.worst_load_case === row.load_case ? "" : row.worst_load_case,
    ];
  return parts.filter((part) => part).join(", ") || "–";
}

// Returns the rows as in the summary: failed, undecided, passed; in each the tightest first.
function judged(of = summary, required = data.required) {
  const tightness = (row) => (hasNumber(row.relative_margin) ? row.relative_margin : Infinity);
  return (of.requirements || [])
    .map((row, i) => ({ ...row, ...required[i] }))
    .sort((a, b) => VERDICT_RANK[a.verdict] - VERDICT_RANK[b.verdict] || tightness(a) - tightness(b) || 0);
}

function verdictOfRows(rows) {
  return ["fail", "undecided", "pass"].find((verdict) => rows.some((row) => row.verdict === verdict));
}

function verdictText(rows) {
  const count = (verdict) => rows.filter((row) => row.verdict === verdict).length,
    more = [
      [count("fail"), count("fail") === 1 ? "fails" : "fail"],
      [count("undecided"), count("undecided") === 1 ? "is undecided" : "are undecided"],
    ].filter(([n]) => n);
  return (
    `${fmtCount(count("pass"))} of ${fmtCount(rows.length)} requirements pass` +
    `${more.map(([n, verb]) => `, ${fmtCount(n)} ${verb}`).join("")}.`
  );
}

function verdictTable(rows, caption) {
  const open = rows.filter((row) => row.verdict === "fail" || row.verdict === "undecided").length;
  const column = (name, show, more) => ({ name, show: (i) => show(rows[i]), of: (i) => show(rows[i]), ...more });
  const amount = (name, key, show) => column(name, show, { number: true, of: (i) => rows[i][key] });
  return sortableTable({
    caption,
    n: rows.length,
    by: -1,
    most: open + TIGHTEST_SHOWN,
    columns: [
      column("Requirement", (row) => row.name),
      column(
        "verdict",
        (row) => el("strong", { class: `verdict ${row.verdict}` }, row.verdict),
        { beside: true, of: (i) => VERDICT_RANK[rows[i].verdict] },
      ),
      amount("value", "value", (row) => withUnit(row.value, row.unit)),
      column("bound", boundOf),
      amount("margin", "margin", (row) => withSign(row.margin, withUnit(row.margin, row.unit))),
      amount("relative margin (%)", "relative_margin", ({ relative_margin: part }) =>
        hasNumber(part) ? withSign(part, fmt(100 * part, 3)) : "–",
      ),
      column("samples that meet it (%)", evidenceOf),
      column("worst net", worstOf),
    ],
  }).node;
}

// ---- distribution functions ----

// Returns the part of the samples, in per cent, whose value is at most v.
function shareBelow({ value, share }, v) {
  let low = 0,
    high = value.length; // the number of values that are at most v
  while (low < high) {
    const middle = (low + high) >> 1;
    if (value[middle] <= v) low = middle + 1;
    else high = middle;
  }
  return low ? 100 * share[low - 1] : 0;
}

// Returns the abscissae of all curves, sorted. The curves are steps, so each has one just before it, too.
const ABSCISSAE_MAX = 600;
function abscissaeOf(curves, step) {
  const all = [...new Set(curves.flatMap(({ value }) => [...value]))].sort((a, b) => a - b),
    stride = Math.ceil(all.length / ABSCISSAE_MAX),
    kept = all.filter((_, i) => i % stride === 0 || i === all.length - 1);
  return kept.flatMap((v) => [v - step, v]);
}

function boundMarks(row, times, [low, high]) {
  const reach = REACH * (high - low || Math.abs(high) || 1);
  return ["at_least", "at_most"]
    .filter((key) => hasNumber(row[key]))
    .map((key) => ({
      name: `${key === "at_least" ? "at least" : "at most"} ${withUnit(row[key], row.unit)}`,
      at: times * row[key],
      isFar: times * row[key] < low - reach || times * row[key] > high + reach,
      colour: "--four",
      dash: "7 3",
    }));
}

function outsideText(marks) {
  const far = marks.filter(({ isFar }) => isFar).map(({ name }) => name);
  return far.length ? `Outside of the picture: ${far.join("; ")}.` : "";
}

// Returns the required share as horizontal lines: at a maximum at least that share of the samples is at most the bound,
// at a minimum at most the rest is below it.
function shareMarks(row) {
  const percents = (share) => `${fmt(100 * share, 4)}\u00a0% of the samples`,
    { share, at_most: high, at_least: low, unit } = row;
  const line = (part, name) => ({ level: 100 * part, name: `required: ${name}`, colour: "--four", dash: "2 3" });
  return [
    ...(hasNumber(high) ? [line(share, `at least ${percents(share)} at most ${withUnit(high, unit)}`)] : []),
    ...(hasNumber(low) ? [line(1 - share, `at most ${percents(1 - share)} below ${withUnit(low, unit)}`)] : []),
  ];
}

const WORST = "all"; // no load case has this name

function distribution(row) {
  const { unit, times } = scaleOf(row.unit),
    isBoth = new Set(row.curves.map(({ bound }) => bound)).size > 1, // minimum and maximum tension
    curves = row.curves
      .map((c) => ({ ...c, isWorst: c.load_case === WORST, value: Array.from(c.value, (v) => times * v) }))
      .filter((c) => c.value.length)
      .sort((a, b) => b.isWorst - a.isWorst); // below the others
  const ends = range(curves.flatMap(({ value }) => [value[0], value[value.length - 1]])),
    loadCases = [...new Set(curves.filter((c) => !c.isWorst).map((c) => c.load_case))],
    x = abscissaeOf(curves, 1e-6 * (ends[1] - ends[0] || Math.abs(ends[1]) || 1)),
    marks = boundMarks(row, times, ends),
    label = `${plainWord(row.figure)}${unit ? ` (${unit})` : ""}`;
  return chart({
    title: row.name,
    xLabel: label,
    yLabel: "samples (%)",
    unit: "%",
    x,
    counted: false,
    log: false,
    head: (i) => `${plainWord(row.figure)} of at most ${fmt(x[i], 5)}${unit ? ` ${unit}` : ""}`,
    series: curves.map((c) => ({
      name:
        (c.isWorst ? "worst of all load cases in each sample" : c.load_case) +
        (isBoth ? (c.bound === "at_least" ? ", minimum" : ", maximum") : ""),
      values: x.map((v) => shareBelow(c, v)),
      isWide: c.isWorst,
      colour: c.isWorst ? "--six" : SERIES[loadCases.indexOf(c.load_case) % SERIES.length],
      dash: isBoth && c.bound === "at_most" ? "5 3" : undefined,
      isLevel: true, // a step function has no marks
    })),
    marks: [...marks.filter(({ isFar }) => !isFar), ...shareMarks(row)],
    caption: outsideText(marks),
  });
}

// Writes the verdicts; with two results, on both.
function writeRequirements() {
  const write = (id, of, required, name) => {
    const rows = judged(of, required);
    if (!rows.length) return;
    const caption = name ? `Requirements of ${name}` : "Requirements";
    // the points of a front have their own table
    const whose = of.front ? "the net after form-finding" : name,
      counted = of.front ? verdictOfRows(rows) : of.verdict;
    section(
      id,
      `Verdict${whose ? ` on ${whose}` : ""}: ${counted}`,
      el("p", {}, verdictText(rows)),
      verdictTable(rows, caption),
    );
  };
  write("requirements", summary, data.required, thisName);
  if (other) write("requirements-other", other.summary, other.required, otherName);
}

// Writes the distribution functions of the rows with a share, those of the tightest rows first.
function writeDistributions() {
  const rows = judged().filter(({ curves }) => curves.some(({ value }) => value.length)), // else without any shape
    charts = el("div", { class: "charts" }, rows.slice(0, DISTRIBUTIONS_SHOWN).map(distribution)),
    rest = rows.slice(DISTRIBUTIONS_SHOWN),
    more = el("button", { type: "button" }, `show all ${fmtCount(rows.length)}`);
  if (!rows.length) return;
  more.addEventListener("click", () => {
    charts.append(...rest.map(distribution));
    more.remove();
  });
  section(
    "distributions",
    "Distribution functions of the requirements",
    el(
      "p",
      {},
      "The charts show the share of the as-built samples whose value is at most that on the axis. Each load case has " +
        "its own curve. If the requirement applies to all load cases, the wide curve shows the worst of their " +
        "values in each sample. With two bounds, the verdict counts the samples within both bounds, which no curve " +
        "shows. Vertical lines are the bounds of the requirement. " +
        "Horizontal lines are the required share. Samples without a shape have no value.",
    ),
    charts,
    rest.length ? el("div", { class: "tools" }, more) : null,
  );
}

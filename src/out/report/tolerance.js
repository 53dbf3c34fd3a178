// The section of the samples of the as-built net, which are under `tolerance` in the summary.

const ERROR_KIND = {
  cut_m: "cutting lengths",
  cut_ratio: "cutting lengths, in parts of the length",
  cut_ratio_batch: "cutting lengths of a spool",
  EA_ratio: "EA",
  EA_ratio_batch: "EA of a spool",
  support_m: "supports",
  temperature_K: "temperature of the cables",
  truss_temperature_K: "temperature of the truss",
};
const percent = (part, digits = 3) => `${fmt(100 * part, digits)}\u00a0%`;

// Returns marks for figures of the samples. A mark is only named when its distance from the samples exceeds REACH times
// their range, because it would compress the histogram.
function toleranceMarks(t, [low, high]) {
  const reach = REACH * (high - low);
  const all = [
    { name: "without errors", at: t.nominal_psi_m, colour: "--three", dash: "2 3" },
    { name: "95 % of the samples are below", at: t.psi_95_m, colour: "--two" },
  ].filter(({ at }) => typeof at === "number" && Number.isFinite(at));
  return all.map((mark) => {
    const isFar = mark.at < low - reach || mark.at > high + reach;
    const name = `${mark.name} ${rounded(1e3 * mark.at, 5)} mm${isFar ? ", outside of the picture" : ""}`;
    return { ...mark, name, at: 1e3 * mark.at, isFar };
  });
}

function toleranceChart(t) {
  const [low, high] = t.histogram_range_m;
  if (typeof low !== "number" || typeof high !== "number") return null; // no sample has a shape
  const n = t.histogram.length,
    width = (1e3 * (high - low)) / n,
    digits = Math.max(5, Math.ceil(Math.log10((1e3 * high) / width)) + 1), // edges differ in the last digit
    edge = (i) => fmt(1e3 * low + i * width, high > low ? digits : 5),
    marks = toleranceMarks(t, [low, high]);
  const far = marks.filter(({ isFar }) => isFar).map(({ name }) => name);
  return chart({
    title: "Surface error ψ of the samples",
    xLabel: "ψ (mm)",
    yLabel: "samples (%)",
    unit: "%",
    x: t.histogram.map((_, i) => 1e3 * low + (i + 0.5) * width),
    counted: false,
    log: false,
    caption:
      `Each bar shows the share of samples in one of ${n} intervals of ψ.` + (far.length ? ` ${far.join("; ")}.` : ""),
    head: (i) => `ψ of ${edge(i)} to ${edge(i + 1)} mm`,
    series: [{ name: "samples", values: scaled(t.histogram, 100), colour: "--one", bars: width / 2 }],
    marks: marks.filter(({ isFar }) => !isFar),
  });
}

// Returns the row of `requirements` that costs yield: of those with a share and samples the one with the lowest yield.
function costliestRow() {
  const rows = judged().filter((row) => hasNumber(row.yield) && row.curves.some(({ value }) => value.length));
  return rows.reduce((a, b) => (a && a.yield <= b.yield ? a : b), null);
}

// Returns the part of the samples of a curve, in per cent, that is outside of the bounds of its row.
function outsideOf(row, c) {
  const isBoth = row.figure !== "tension", // else a curve belongs to one bound
    below = c.value.findLast((v) => v < row.at_least);
  const low = hasNumber(row.at_least) && (isBoth || c.bound === "at_least") && below !== undefined,
    high = hasNumber(row.at_most) && (isBoth || c.bound === "at_most");
  return (low ? shareBelow(c, below) : 0) + (high ? 100 * c.share.at(-1) - shareBelow(c, row.at_most) : 0);
}

// Returns the curve of the load case in which a row costs most.
const costliestCurve = (row) =>
  row.curves
    .filter((c) => c.value.length && c.load_case !== WORST)
    .reduce((a, b) => (outsideOf(row, a) >= outsideOf(row, b) ? a : b));

// Draws the histogram of the figure of a row.
const BINS = 40;
function requirementChart(row, c) {
  const { unit, times } = scaleOf(row.unit),
    ends = [c.value[0], c.value.at(-1)],
    isCount = c.value.every(Number.isInteger) && ends[1] - ends[0] < BINS,
    n = isCount ? ends[1] - ends[0] + 1 : BINS,
    width = isCount ? 1 : (ends[1] - ends[0]) / n || Math.abs(ends[0]) / n || 1,
    first = isCount ? ends[0] - 0.5 : ends[0];
  const upTo = (i) => (i === 0 ? 0 : i === n ? 100 * c.share.at(-1) : shareBelow(c, first + i * width)),
    bins = Array.from({ length: n }, (_, i) => i),
    x = bins.map((i) => times * (first + (i + 0.5) * width)),
    marks = boundMarks(
      row,
      times,
      ends.map((v) => times * v),
    ),
    far = marks.filter(({ isFar }) => isFar).map(({ name }) => name),
    name = `${plainWord(row.figure)}${c.bound === "at_least" && row.figure === "tension" ? ", minimum" : ""}`;
  return chart({
    title: `Samples in load case ${c.load_case}`,
    xLabel: `${name}${unit ? ` (${unit})` : ""}`,
    yLabel: "samples (%)",
    unit: "%",
    x,
    counted: isCount,
    log: false,
    caption:
      "Each bar shows the share of samples in one interval." +
      (far.length ? ` Outside of the picture: ${far.join("; ")}.` : ""),
    head: (i) => `${name} of about ${fmt(x[i], 5)}${unit ? ` ${unit}` : ""}`,
    series: [
      { name: "samples", values: bins.map((i) => upTo(i + 1) - upTo(i)), colour: "--one", bars: (times * width) / 2 },
    ],
    marks: marks.filter(({ isFar }) => !isFar),
  });
}

function scaleText(t) {
  if (typeof t.sigma_scale !== "number") return "";
  if (!(t.sigma_scale > 0))
    return " The required shares are impossible, because the net fails a requirement even without errors.";
  const part = percent(t.sigma_scale, 4);
  if (t.scale_bound < 0 || t.sigma_scale < 1)
    return (
      " To obtain the required shares, reduce all tolerances to " +
      `${t.scale_bound < 0 ? "less than " : ""}${part} of their values.`
    );
  return (
    ` If all tolerances are increased to ${part} of their values, the samples still have the required shares.` +
    (t.scale_bound > 0 ? " Larger tolerances were not tried." : "")
  );
}

function toleranceText(t) {
  const failed = t.failed ? `, ${fmtCount(t.failed)} of them without a shape` : "";
  const yielded =
    typeof t.yield === "number"
      ? ` Yield: ${percent(t.yield)} of the samples meet all requirements (95 % interval: ` +
        `${fmt(100 * t.yield_low, 3)} to ${percent(t.yield_high)}).`
      : "";
  const design = summary.front ? " of the form-finding" : "";
  return `${fmtCount(t.samples)} samples of the as-built net${design} were solved${failed}.${yielded}${scaleText(t)}`;
}

function shareTable(shares, caption) {
  if (!shares.length) return null;
  const group = new Map(net.cable_id.map((id, e) => [id, groupOf(e)]));
  return table(
    [["Cable"], ["Group"], ["Share", "number"]],
    shares.map(({ cable, share }) =>
      el(
        "tr",
        {},
        el("th", { scope: "row" }, cable),
        el("td", {}, group.get(cable) || "–"),
        el("td", { class: "number" }, percent(share)),
      ),
    ),
    caption,
  );
}

// Returns which cables break a required tension, or else have the largest part of psi.
function costliestCables(t, c) {
  if (c && c.cables) {
    const shares = [];
    for (let k = 0; k < c.cables.length; k += 2)
      shares.push({ cable: net.cable_id[c.cables[k]], share: c.cables[k + 1] / c.failing });
    const extreme = c.bound === "at_least" ? "minimum" : "maximum";
    return [
      el("h3", { class: "after" }, "Cables that break the requirement"),
      el(
        "p",
        {},
        `In ${fmtCount(c.failing)} samples, the ${extreme} tension in the load case ${c.load_case} is out of bounds. ` +
          "The table lists the cables with this tension, and their share of these samples.",
      ),
      shareTable(shares, "Cables by their share of the failing samples"),
    ];
  }
  const kinds = Object.entries(t.kind_share).map(([kind, part]) => `${ERROR_KIND[kind] || kind} ${percent(part)}`);
  return [
    kinds.length ? el("h3", { class: "after" }, "Cables with the largest part of the error of ψ") : null,
    kinds.length
      ? el("p", {}, `To first order, the errors contribute the following shares to ψ²: ${kinds.join(", ")}.`)
      : null,
    shareTable(t.cable_share, "Cables by their share of the error"),
  ];
}

function writeTolerance() {
  const t = summary.tolerance;
  if (!t) return;
  const row = costliestRow(),
    curve = row && costliestCurve(row),
    costs = row && `Of all requirements of the samples, this one has the lowest yield: ${percent(row.yield)}.`;
  section(
    "tolerance",
    row ? `Tolerances: ${row.name}` : "Tolerances of the as-built net",
    el("p", {}, toleranceText(t), row ? ` ${costs}` : ""),
    el("div", { class: "charts" }, row ? requirementChart(row, curve) : toleranceChart(t)),
    ...costliestCables(t, curve),
  );
}

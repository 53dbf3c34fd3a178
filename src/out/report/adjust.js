// The section of `hifdm adjust`: the errors of a measured net, and the turnbuckle adjustments that restore its figure.

const adjust = data.adjust;
const cableAt = adjust && new Map(net.cable_id.map((id, e) => [id, e]));
const WORKSHOP = "Turnbuckle adjustments for the workshop, in their order";
// Adjustments by cable, for the cables that have one.
const adjustmentOf = new Map(adjust ? adjust.adjustments.map((row) => [cableAt.get(row.cable), row]) : []);

const FIGURE = { psi: "ψ", surface: "RMS along the normal", facets: "RMS of the facets along the normal" };
const ADJUST_END = {
  target: "The target is met.",
  max_adjustments: "adjust.max_adjustments allows no further adjustment.",
  doubt: "Another turnbuckle adjustment would reduce the surface error by less than the measurement uncertainty.",
  none: "No further turnbuckle adjustment reduces the surface error of the net.",
};
const adjustments = (n) => (n === 1 ? "one turnbuckle adjustment" : `${fmtCount(n)} turnbuckle adjustments`);

const inMm = (v, digits = 4) => `${Math.abs(1e3 * v) < RESOLVED_MM ? rounded(0, digits) : fmt(1e3 * v, digits)} mm`,
  signed = (v, digits = 5) => (v > 0 ? "+" : "") + fmt(v, digits),
  tooWhat = (v) => `too ${v > 0 ? "long" : "short"}`;

function adjustText(name) {
  const expected = (value, sigma) => `expected: ${inMm(value)} ± ${fmt(1e3 * sigma, 2)}`;
  return [
    `The measurement covers ${fmtCount(adjust.measured_nodes)} nodes. ` +
      `χ² per coordinate is ${fmt(adjust.chi_square, 3)}. ` +
      "χ² is about 1 if the case file states the tolerances and measurement errors correctly.",
    `The most probable net has a ${name} of ${inMm(adjust.estimated_m)}` +
      ` (${expected(adjust.estimated_expected_m, adjust.estimated_sigma_m)}).` +
      ` After ${adjustments(adjust.adjustments.length)} it has` +
      ` ${inMm(adjust.adjusted_m)} (${expected(adjust.adjusted_expected_m, adjust.adjusted_sigma_m)}).`,
    adjust.figure !== "psi"
      ? ""
      : adjust.aim === "design"
        ? "ψ is measured from the shape of the design. ψ of this shape from the target positions is " +
          `${inMm(adjust.design_psi_m)}.`
        : "ψ is measured from the target positions.",
    adjust.end === "target" && adjust.adjusted_expected_m > adjust.target_m
      ? "The surface error of the most probable net meets the target. The expected surface error exceeds the target."
      : ADJUST_END[adjust.end] || "",
    adjust.maybe_slack
      ? `${fmtCount(adjust.maybe_slack)} cables may be slack. The measured positions do not show how slack these ` +
        "cables are. Because of slack cables, the uncertainty after adjustment is larger than the stated ± value."
      : "",
    adjust.held_taut
      ? "The turnbuckle adjustments maintain the minimum tension in each cable. No additional cable becomes slack."
      : "",
    adjust.supports_estimated ? "" : "The estimate assumes that all supports are at the positions in the case file.",
    adjust.settled ? "" : "The estimate has not converged.",
    adjust.fits
      ? ""
      : "χ² is larger than chance explains. Tolerances or measurement errors may exceed the values in the case file. " +
        "Supports may be displaced. The measured net may also differ from the design in the case file.",
  ]
    .filter((text) => text)
    .join(" ");
}

function adjustChart(name) {
  const rows = adjust.adjustments,
    values = [adjust.estimated_m, ...rows.map((row) => row.predicted_m)],
    expected = [adjust.estimated_expected_m, ...rows.map((row) => row.expected_m)],
    [low, high] = range([...values, ...expected]),
    // a level that is too far away is named and not drawn
    isFar = (at) => at < low - REACH * (high - low) || at > high + REACH * (high - low),
    level = (text, at, colour, dash) =>
      typeof at === "number" && 1e3 * at > RESOLVED_MM
        ? [
            {
              name: `${text} ${inMm(at)}${isFar(at) ? ", outside of the picture" : ""}`,
              values: values.map(() => 1e3 * at),
              colour,
              dash,
              isLevel: true,
              free: isFar(at),
            },
          ]
        : [];
  return chart({
    title: `Predicted ${name} after each adjustment`,
    xLabel: "adjustments",
    yLabel: `${name} (mm)`,
    unit: "mm",
    x: values.map((_, k) => k),
    log: false,
    head: (k) => (k ? `adjustment ${k}: cable ${rows[k - 1].cable}` : "before the first adjustment"),
    series: [
      { name: "predicted", stored: "predicted_m", values: scaled(values, 1e3), colour: "--one" },
      { name: "expected", stored: "expected_m", values: scaled(expected, 1e3), colour: "--five", dash: "3 3" },
      ...level("target", adjust.target_m, "--four", "7 3"),
      ...level("best of all cables, without minimum tensions", adjust.best_m, "--three", "2 3"),
      ...level("nominal design", adjust.nominal_m, "--two", "9 3 2 3"),
    ],
  });
}

function adjustmentsTable(name, choose) {
  const rows = adjust.adjustments,
    column = (heading, of, show) => ({ name: heading, number: true, of, show: (k) => show(of(k)) }),
    real = (heading, key, digits, options) => numberColumn(heading, rows.map((row) => row[key]), digits, options);
  return sortableTable({
    caption: WORKSHOP,
    columns: [
      column("order", (k) => k + 1, fmtCount),
      { name: "cable", of: (k) => rows[k].cable, show: (k) => cableLink(cableAt.get(rows[k].cable), choose) },
      real("turnbuckle adjustment (mm)", "turnbuckle_m", 4, { unit: 1e3, isChange: true }),
      column("turnbuckle adjustment (steps)", (k) => rows[k].steps, (v) => signed(v, 9)),
      real("tension before (N)", "tension_before_N", 4),
      real("tension after (N)", "tension_after_N", 4),
      real(`${name} afterwards (mm)`, "predicted_m", 4, { unit: 1e3 }),
      real(`expected ${name} (mm)`, "expected_m", 4, { unit: 1e3 }),
      real(`gain of ${name} (mm)`, "gain_m", 3, { unit: 1e3 }),
      real("± of the gain (mm)", "gain_sigma_m", 2, { unit: 1e3 }),
      ...(rows.some(({ slack }) => slack) ? [column("slack cables", (k) => rows[k].slack, fmtCount)] : []),
    ],
    n: rows.length,
    by: -1,
  }).node;
}

const SHARED = {
  temperature_K: (error) => `the temperature: ${signed(error, 3)} K`,
  EA_ratio: (error, set) => `EA of spool ${set}: ${signed(100 * error, 3)} %`,
  cut_ratio: (error, set) => `lengths of spool ${set}: ${signed(100 * error, 3)} %`,
};

// Lists the figures that adjustments with another aim would reach.
function otherAims() {
  if (!adjust.instead.length) return [];
  const items = adjust.instead.map(({ figure: of, aim, before_m, after_m, adjustment_count, at_range }) =>
    el(
      "li",
      {},
      el("code", {}, of === "psi" ? `adjust: {figure: psi, aim: ${aim}}` : `adjust: {figure: ${of}}`),
      `: ${FIGURE[of]} from ${inMm(before_m)} to ${inMm(after_m)} by ${adjustments(adjustment_count)}, ` +
        `${fmtCount(at_range)} of them at adjust.range_m`,
    ),
  );
  return [
    el("h3", { class: "after" }, "Other aims"),
    el(
      "p",
      {},
      `${fmtCount(adjust.at_range)} of the adjustments above reach the limit adjust.range_m. ψ of the design is ` +
        `${inMm(adjust.design_psi_m)}. ` +
        `The errors displace the inner nodes by ${inMm(adjust.error_psi_m)} (RMS) from their positions in the design.`,
    ),
    el("ul", {}, items),
  ];
}

const NAMED_MOST = 10, // maximum number of outlying cables in the list
  NODES_MOST = 3, // maximum number of outlying nodes in the list
  OUTLYING = 2; // σ above which a shared number is listed
function outliers(choose) {
  const { stand_out: cables, off_shape: nodes } = adjust,
    shared = adjust.shared.filter((number) => number.sigmas > OUTLYING),
    left = cables.length - NAMED_MOST;
  const sigmas = (v) => `${fmt(v, 3)} σ`,
    byPositions = (v, error) =>
      typeof v === "number"
        ? `; ${inMm(Math.abs(v), 3)}${error * v < 0 ? ` ${tooWhat(v)}` : ""} by the positions alone`
        : "";
  const list = [
    ...shared.map(({ kind, set, error, sigmas: s }) =>
      el("li", {}, `${SHARED[kind] ? SHARED[kind](error, set) : kind}, ${sigmas(s)}`),
    ),
    ...cables.slice(0, NAMED_MOST).map(({ cable, error_m, by_positions_m, sigmas: s }) =>
      el(
        "li",
        {},
        cableLink(cableAt.get(cable), choose),
        ` is estimated ${inMm(Math.abs(error_m), 3)} ${tooWhat(error_m)}, ${sigmas(s)}` +
          byPositions(by_positions_m, error_m),
      ),
    ),
    left > 0 ? el("li", {}, `${fmtCount(left)} more cables beyond 3 σ; the table of cables has all errors`) : null,
    ...nodes
      .slice(0, NODES_MOST)
      .map(({ node, distance_m, sigmas: s }) =>
        el("li", {}, `node ${node} was measured ${inMm(distance_m, 3)} from the estimated shape, ${sigmas(s)}`),
      ),
    nodes.length > NODES_MOST
      ? el("li", {}, `${fmtCount(nodes.length - NODES_MOST)} more measured nodes beyond 4 σ`)
      : null,
  ];
  if (!shared.length && !cables.length && !nodes.length) return [];
  return [el("h3", { class: "after" }, "Outliers"), el("ul", {}, list)];
}

function writeAdjust(view) {
  if (!adjust) return;
  const name = FIGURE[adjust.figure] || adjust.figure,
    choose = chooserOf(view);
  const figures = [
    typeof adjust.measured_m === "number" ? figure(`${name}, measured`, roundedMm(adjust.measured_m), "mm") : null,
    figure(`${name}, expected now`, roundedMm(adjust.estimated_expected_m), "mm"),
    figure(`${name}, expected after adjustment`, roundedMm(adjust.adjusted_expected_m), "mm"),
    figure(`${name}, nominal design`, roundedMm(adjust.nominal_m), "mm"),
    figure("turnbuckle adjustments", fmtCount(adjust.adjustments.length)),
    figure("χ² per coordinate", fmt(adjust.chi_square, 3)),
  ].filter((node) => node);
  section(
    "adjust",
    "Adjustment of the as-built net",
    el("p", {}, adjustText(name)),
    el("dl", { class: "figures" }, figures),
    ...(adjust.adjustments.length
      ? [
          el("div", { class: "charts" }, adjustChart(name)),
          el("h3", { class: "after" }, WORKSHOP),
          el(
            "p",
            {},
            `Set ${familyName(adjust.set)}. A positive turnbuckle adjustment lengthens the cable. Click a cable ` +
              "name to show the cable in the picture.",
          ),
          adjustmentsTable(name, choose),
        ]
      : []),
    ...outliers(choose),
    ...otherAims(),
  );
}

// The section of `hifdm adjust`: the errors of a measured net, and the turnbuckle adjustments that restore its figure.

const adjust = data.adjust;
const cableAt = adjust && new Map(net.cable_id.map((id, e) => [id, e]));
// Adjustments by cable, for the cables that have one.
const moveOf = new Map(adjust ? adjust.moves.map((move) => [cableAt.get(move.cable), move]) : []);

const FIGURE = { psi: "ψ", surface: "RMS along the normal", facets: "RMS of the facets along the normal" };
const ADJUST_END = {
  target: "The target is met.",
  moves: "All moves that the case allows are made.",
  doubt: "The next move would gain less than these measurements can tell.",
  none: "No further move gains anything.",
};

const inMm = (v, digits = 4) => `${Math.abs(1e3 * v) < RESOLVED_MM ? rounded(0, digits) : fmt(1e3 * v, digits)} mm`,
  signed = (v, digits = 5) => (v > 0 ? "+" : "") + fmt(v, digits);

function adjustText(name) {
  const open = (expected, sigma) => `${inMm(expected)} ± ${fmt(1e3 * sigma, 2)} with what is left open`;
  return [
    `${fmtCount(adjust.measured_nodes)} nodes were measured. χ² is ${fmt(adjust.chi_square, 3)} per coordinate: ` +
      "about 1 when the tolerances and the errors of the measurement are as the case says.",
    `The net is estimated to have a ${name} of ${inMm(adjust.estimated_m)}` +
      ` (${open(adjust.estimated_expected_m, adjust.estimated_sigma_m)}),` +
      ` and after ${adjust.moves.length === 1 ? "one move" : `${fmtCount(adjust.moves.length)} moves`}` +
      ` ${inMm(adjust.adjusted_m)} (${open(adjust.adjusted_expected_m, adjust.adjusted_sigma_m)}).`,
    adjust.figure !== "psi"
      ? ""
      : adjust.aim === "design"
        ? `ψ is measured from the shape of the design, which is ${inMm(adjust.design_psi_m)} from theory.`
        : "ψ is measured from the theoretical places.",
    adjust.end === "target" && adjust.adjusted_expected_m > adjust.target_m
      ? "The most probable net meets the target, but more is to be expected."
      : ADJUST_END[adjust.end] || "",
    adjust.maybe_slack
      ? `${fmtCount(adjust.maybe_slack)} cables may be slack, as far as the measurement tells; how slack, places do ` +
        "not show, and the figures after moves are less sure than ± says."
      : "",
    adjust.held_taut ? "Moves leave each cable its least tension, and no further one slack." : "",
    adjust.supports_estimated ? "" : "Supports are taken to be where the case has them.",
    adjust.settled ? "" : "The estimate has not settled.",
    adjust.fits
      ? ""
      : "χ² is beyond what chance makes: a tolerance or an error of the measurement is larger than the case says, " +
        "supports are off, or it is another design.",
  ]
    .filter((text) => text)
    .join(" ");
}

function adjustChart(name) {
  const values = [adjust.estimated_m, ...adjust.moves.map((move) => move.predicted_m)],
    expected = [adjust.estimated_expected_m, ...adjust.moves.map((move) => move.expected_m)],
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
    title: `Predicted ${name} after each move`,
    xLabel: "moves made",
    yLabel: `${name} (mm)`,
    unit: "mm",
    x: values.map((_, k) => k),
    log: false,
    head: (k) => (k ? `move ${k}: cable ${adjust.moves[k - 1].cable}` : "before the first move"),
    series: [
      { name: "predicted", stored: "predicted_m", values: scaled(values, 1e3), colour: "--one" },
      { name: "to expect", stored: "expected_m", values: scaled(expected, 1e3), colour: "--five", dash: "3 3" },
      ...level("target", adjust.target_m, "--four", "7 3"),
      ...level("reached by a search over all cables, without least tensions", adjust.best_m, "--three", "2 3"),
      ...level("as designed", adjust.nominal_m, "--two", "9 3 2 3"),
    ],
  });
}

function movesTable(name, choose) {
  const { moves } = adjust,
    column = (heading, of, show) => ({ name: heading, number: true, of, show: (k) => show(of(k)) }),
    real = (heading, key, digits, options) => numberColumn(heading, moves.map((move) => move[key]), digits, options);
  return sortableTable({
    caption: "Moves in the order in which they are made",
    columns: [
      column("order", (k) => k + 1, fmtCount),
      { name: "cable", of: (k) => moves[k].cable, show: (k) => cableLink(cableAt.get(moves[k].cable), choose) },
      real("move (mm)", "move_m", 4, { unit: 1e3, isChange: true }),
      column("steps", (k) => moves[k].steps, (v) => signed(v, 9)),
      real("tension before (N)", "tension_before_N", 4),
      real("tension after (N)", "tension_after_N", 4),
      real(`${name} after it (mm)`, "predicted_m", 4, { unit: 1e3 }),
      real("to expect (mm)", "expected_m", 4, { unit: 1e3 }),
      real(`it gains (mm)`, "gain_m", 3, { unit: 1e3 }),
      real("± (mm)", "gain_sigma_m", 2, { unit: 1e3 }),
      ...(moves.some(({ slack }) => slack) ? [column("slack cables", (k) => moves[k].slack, fmtCount)] : []),
    ],
    n: moves.length,
    by: -1,
  }).node;
}

const SHARED = {
  temperature_K: (error) => `the temperature: ${signed(error, 3)} K`,
  EA_ratio: (error, set) => `EA of spool ${set}: ${signed(100 * error, 3)} %`,
  cut_ratio: (error, set) => `lengths of spool ${set}: ${signed(100 * error, 3)} %`,
};

// Lists what adjustments with another aim would reach.
function otherAims() {
  if (!adjust.instead.length) return [];
  const items = adjust.instead.map(({ figure: of, aim, before_m, after_m, move_count, at_range }) =>
    el(
      "li",
      {},
      el("code", {}, of === "psi" ? `adjust: {figure: psi, aim: ${aim}}` : `adjust: {figure: ${of}}`),
      `: ${FIGURE[of]} from ${inMm(before_m)} to ${inMm(after_m)} by ` +
        `${move_count === 1 ? "one move" : `${fmtCount(move_count)} moves`}, ` +
        `${fmtCount(at_range)} at range_m`,
    ),
  );
  return [
    el("h3", { class: "after" }, "Aimed at something else"),
    el(
      "p",
      {},
      `Of the moves above ${fmtCount(adjust.at_range)} are as far as range_m allows; the design is ` +
        `${inMm(adjust.design_psi_m)} from the theoretical places, where errors make ${inMm(adjust.error_psi_m)}.`,
    ),
    el("ul", {}, items),
  ];
}

const NAMED_MOST = 10, // maximum number of outlying cables in the list
  PLACES_MOST = 3, // maximum number of outlying nodes in the list
  SEEMS_OFF = 2; // σ above which a shared number is listed
function outliers(choose) {
  const { stand_out: cables, off_shape: places } = adjust,
    shared = adjust.shared.filter((number) => number.sigmas > SEEMS_OFF),
    left = cables.length - NAMED_MOST;
  const sigmas = (v) => `${fmt(v, 3)} σ`,
    tooWhat = (v) => `too ${v > 0 ? "long" : "short"}`,
    byPlaces = (v, error) =>
      typeof v === "number"
        ? `; ${inMm(Math.abs(v), 3)}${error * v < 0 ? ` ${tooWhat(v)}` : ""} by the places alone`
        : "";
  const list = [
    ...shared.map(({ kind, set, error, sigmas: s }) =>
      el("li", {}, `${SHARED[kind] ? SHARED[kind](error, set) : kind}, ${sigmas(s)}`),
    ),
    ...cables.slice(0, NAMED_MOST).map(({ cable, error_m, by_places_m, sigmas: s }) =>
      el(
        "li",
        {},
        cableLink(cableAt.get(cable), choose),
        ` seems ${inMm(Math.abs(error_m), 3)} ${tooWhat(error_m)}, ${sigmas(s)}${byPlaces(by_places_m, error_m)}`,
      ),
    ),
    left > 0 ? el("li", {}, `and ${fmtCount(left)} more cables beyond 3 σ: the table of cables has all errors`) : null,
    ...places
      .slice(0, PLACES_MOST)
      .map(({ node, distance_m, sigmas: s }) =>
        el("li", {}, `node ${node} was measured ${inMm(distance_m, 3)} off the estimated shape, ${sigmas(s)}`),
      ),
    places.length > PLACES_MOST
      ? el("li", {}, `and ${fmtCount(places.length - PLACES_MOST)} more measured nodes beyond 4 σ`)
      : null,
  ];
  if (!shared.length && !cables.length && !places.length) return [];
  return [el("h3", { class: "after" }, "What stands out of the tolerances"), el("ul", {}, list)];
}

function writeAdjust(view) {
  if (!adjust) return;
  const name = FIGURE[adjust.figure] || adjust.figure,
    choose = chooserOf(view);
  const figures = [
    typeof adjust.measured_m === "number" ? figure(`${name}, measured`, roundedMm(adjust.measured_m), "mm") : null,
    figure(`${name}, to expect now`, roundedMm(adjust.estimated_expected_m), "mm"),
    figure(`${name}, to expect after the moves`, roundedMm(adjust.adjusted_expected_m), "mm"),
    figure(`${name} as designed`, roundedMm(adjust.nominal_m), "mm"),
    figure("moves", fmtCount(adjust.moves.length)),
    figure("χ² per coordinate", fmt(adjust.chi_square, 3)),
  ].filter((node) => node);
  section(
    "adjust",
    "Adjustment of the net as built",
    el("p", {}, adjustText(name)),
    el("dl", { class: "figures" }, figures),
    adjust.moves.length ? el("div", { class: "charts" }, adjustChart(name)) : null,
    adjust.moves.length ? el("h3", { class: "after" }, "Moves in the order in which they are made") : null,
    adjust.moves.length
      ? el("p", {}, `Of ${familyName(adjust.set)}. A move above 0 lets the cable out; a name shows it in the picture.`)
      : null,
    adjust.moves.length ? movesTable(name, choose) : null,
    ...outliers(choose),
    ...otherAims(),
  );
}

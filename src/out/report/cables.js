// The table of cables: tensions and lengths. No column is a turnbuckle adjustment.

// Returns the object with the figures of a design, which are not shown beside those of a measured net.
const ofDesign = () => (adjust ? {} : net);

// Returns the names of the families of every cable.
function allFamilies() {
  const all = Array.from({ length: net.n_cable }, () => []);
  for (const { name, cable } of net.sets) for (const e of cable) all[e].push(familyName(name));
  return all;
}

// Returns a column of numbers with `digits` digits of the largest one. Returns null when no row has a number or all are
// rounding.
//   unit: factor for display; isChange: sorted by size, shown with a sign
//   rounding: the column is left out when the largest number is below this
function numberColumn(name, values, digits, { unit = 1, isChange = false, rounding = 0 } = {}) {
  const [low, high] = range(values) || [0, 0],
    size = Math.max(Math.abs(low), Math.abs(high)),
    most = unit * size;
  if (!range(values) || size < rounding) return null;
  const decimals = most > 0 ? Math.min(12, Math.max(0, digits - 1 - Math.floor(Math.log10(most)))) : 0;
  const show = (v) => (Number.isFinite(v) ? (isChange && v > 0 ? "+" : "") + minus((unit * v).toFixed(decimals)) : "–");
  return { name, number: true, of: (e) => values[e], show: (e) => show(values[e]), size: isChange };
}
// The same for a column with a value of each cable.
const RESOLVED_RATIO = 1e-9; // relative size of rounding of tensions
const cableColumn = (name, of, digits, options) =>
  numberColumn(
    name,
    Array.from({ length: net.n_cable }, (_, e) => of(e)),
    digits,
    options,
  );

// Returns the column of the estimated length errors. Words state their direction, because a workshop could take a sign
// for a turnbuckle adjustment.
function errorColumn() {
  const size = (e) => Math.abs(adjust.error_m[e]),
    column = cableColumn("estimated length error (mm)", size, 3, { unit: 1e3 });
  return column && { ...column, size: true, show: (e) => `${column.show(e)} ${tooWhat(adjust.error_m[e])}` };
}

// Returns heading and values of a column of differences of unstressed lengths. They are those of the result from the
// form-finding, and without a search those from the same net at its target positions.
function lengthChange(before, after) {
  const length = after.unstressed_length_m;
  if (!length || (before !== after && !before.unstressed_length_m)) return null;
  if (before === after) return [`unstressed: ${after.name} − target (mm)`, (e) => after.unstressed_minus_target_m[e]];
  return [`unstressed: ${after.name} − ${before.name} (mm)`, (e) => length[e] - before.unstressed_length_m[e]];
}

function cableColumns(before, after, families, choose) {
  const two = before !== after,
    ofAfter = otherShape ? `, ${after.name}` : "", // only with two results
    length = after.unstressed_length_m,
    { psi_by_cut: psiByCut, cable_share: share } = ofDesign(),
    lengthened = adjust ? null : lengthChange(before, after);
  const family = families.map((names, e) => names.join(", ") || groupOf(e));
  const change = (e) => after.tension_N[e] - before.tension_N[e],
    rounding = RESOLVED_RATIO * Math.max(...(range(before.tension_N) || [0]).map(Math.abs));
  return [
    { name: "Cable", of: (e) => net.cable_id[e], show: (e) => cableLink(e, choose) },
    { name: "Family", beside: true, of: (e) => family[e], show: (e) => family[e] },
    two ? cableColumn(`tension, ${before.name} (N)`, (e) => before.tension_N[e], 5) : null,
    cableColumn(`tension, ${after.name} (N)`, (e) => after.tension_N[e], 5),
    two
      ? cableColumn(`change${otherShape ? ` to ${otherName}` : ""} (N)`, change, 4, { isChange: true, rounding })
      : null,
    cableColumn(`length${ofAfter} (m)`, (e) => after.length_m[e], 6),
    length ? cableColumn(`unstressed length${ofAfter} (m)`, (e) => length[e], 6) : null,
    lengthened
      ? cableColumn(lengthened[0], lengthened[1], 4, { unit: 1e3, isChange: true, rounding: RESOLVED_MM / 1e3 })
      : null,
    adjust ? errorColumn() : null,
    psiByCut ? cableColumn("ψ per mm (mm per mm)", (e) => psiByCut[e], 3, { isChange: true }) : null,
    share ? cableColumn("share of the error (%)", (e) => share[e], 3, { unit: 100 }) : null,
  ].filter((column) => column);
}

const CABLES_SAID =
  "Click a column heading to sort the table. Click a cable name to show the cable in the picture. Click a cable in " +
  "the picture to move its row to the top.";

// Returns the id of a cable as a button that shows the cable in the picture.
function cableLink(e, choose) {
  const press = el("button", { type: "button", class: "link" }, net.cable_id[e]);
  press.addEventListener("click", () => choose(e));
  return press;
}

// Returns a function that shows a cable in the picture and scrolls to it.
const chooserOf = (view) => (e) => {
  view.choose(e);
  document.getElementById("net").scrollIntoView({ block: "nearest" });
};

function writeCables(view) {
  const after = otherShape || resultShape,
    before = otherShape ? resultShape : shapeOf("form") || after;
  if (!after) return;
  const two = before !== after,
    base = otherShape ? `in ${thisName}` : two ? "after form-finding" : "in the net at its target positions",
    families = allFamilies(),
    columns = cableColumns(before, after, families, chooserOf(view)),
    change = columns.findIndex(({ size }) => size);
  const words = [
    otherShape
      ? `The table lists the cable tensions in ${thisName} and ${otherName}.`
      : two
        ? `The table lists the cable tensions after form-finding and in the result (${after.name}).`
        : null,
    columns.some(({ name }) => name.startsWith("unstressed: "))
      ? `The last lengths compare the unstressed lengths of two designs (here and ${base}). They are not turnbuckle ` +
        "adjustments."
      : null,
    adjust
      ? "The length errors are not turnbuckle adjustments." +
        (adjust.adjustments.length ? ` The workshop follows the table “${WORKSHOP}”.` : "")
      : null,
    ofDesign().psi_by_cut
      ? "ψ per mm is the change of ψ if the cable becomes 1 mm longer and no cable goes slack."
      : null,
    ofDesign().cable_share
      ? "The share of the error is a first-order estimate of the contribution of each cable to ψ²."
      : null,
  ].filter((text) => text);
  const all = sortableTable({
    caption: "Cables",
    columns,
    n: net.n_cable,
    by: change > 0 ? change : 2,
    words: (e) => [net.cable_id[e], groupOf(e), ...families[e]].join(" "),
  });
  view.onChoose = (e) => all.first(e);
  const hint = el("span", { class: "keys" }, CABLES_SAID);
  section(
    "cables",
    "Cables",
    el(
      "p",
      {},
      words.map((text) => `${text} `),
      hint,
    ),
    all.node,
  );
}

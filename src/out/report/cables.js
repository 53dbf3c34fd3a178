// The table of cables, with the columns that show which cables to adjust and by how much.

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
  const show = (v) =>
    Number.isFinite(v) ? (isChange && v > 0 ? "+" : "") + minus((unit * v).toFixed(decimals)) : "–";
  return { name, number: true, of: (e) => values[e], show: (e) => show(values[e]), size: isChange };
}
// The same for a column with a value of each cable.
const RESOLVED_RATIO = 1e-9; // relative size of rounding of tensions
const cableColumn = (name, of, digits, options) =>
  numberColumn(name, Array.from({ length: net.n_cable }, (_, e) => of(e)), digits, options);

// Returns heading and values of a column of adjustments. They turn the net of the form-finding into the result. Without
// a search they adjust a net that was cut for the target positions.
function turned(before, after) {
  if (!after.l0_m || (before !== after && !before.l0_m)) return null;
  if (before === after) return ["turn, if cut to theory (mm)", (e) => after.l0_minus_theory_m[e]];
  return [`turn, from ${before.name} (mm)`, (e) => after.l0_m[e] - before.l0_m[e]];
}

function cableColumns(before, after, families, choose) {
  const two = before !== after,
    turn = turned(before, after);
  const family = families.map((names, e) => names.join(", ") || groupOf(e));
  const change = (e) => after.tension_N[e] - before.tension_N[e],
    rounding = RESOLVED_RATIO * Math.max(...(range(before.tension_N) || [0]).map(Math.abs));
  return [
    { name: "Cable", of: (e) => net.cable_id[e], show: (e) => cableLink(e, choose) },
    { name: "Family", beside: true, of: (e) => family[e], show: (e) => family[e] },
    two ? cableColumn(`tension, ${before.name} (N)`, (e) => before.tension_N[e], 5) : null,
    cableColumn(`tension, ${after.name} (N)`, (e) => after.tension_N[e], 5),
    two ? cableColumn("change (N)", change, 4, { isChange: true, rounding }) : null,
    turn ? cableColumn(turn[0], turn[1], 4, { unit: 1e3, isChange: true, rounding: RESOLVED_MM / 1e3 }) : null,
    cableColumn("length (m)", (e) => after.length_m[e], 6),
    after.l0_m ? cableColumn("cut to (m)", (e) => after.l0_m[e], 6) : null,
    adjust ? cableColumn("seems too long by (mm)", (e) => adjust.error_m[e], 3, { unit: 1e3, isChange: true }) : null,
    net.psi_by_cut
      ? cableColumn("ψ by a turn (mm per mm)", (e) => net.psi_by_cut[e], 3, { isChange: true })
      : null,
    net.cable_share ? cableColumn("share of the error (%)", (e) => net.cable_share[e], 3, { unit: 100 }) : null,
  ].filter((column) => column);
}

const CABLES_SAID =
  "A click on a heading sorts, a name shows its cable in the picture, and a click on a cable there puts its row at " +
  "the top.";

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
  const families = allFamilies(),
    columns = cableColumns(before, after, families, chooserOf(view)),
    change = columns.findIndex(({ size }) => size);
  const words = [
    otherShape
      ? "Tensions of this result, and of the other."
      : before === after
        ? null
        : `Tensions of the found net, and of the ${after.name}, which is the result.`,
    columns.some(({ name }) => name.startsWith("turn,")) ? "A turn above 0 lets the cable out." : null,
    net.psi_by_cut ? "ψ by a turn: what letting the cable out by 1 mm adds to ψ, while no cable goes slack." : null,
    net.cable_share ? "The share is that of what all errors add to ψ², to first order: cut those cables well." : null,
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
  section("cables", "Cables", el("p", {}, words.map((text) => `${text} `), hint), all.node);
}

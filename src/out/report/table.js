// Tables that can be sorted by a click on a heading, and searched.

const ROWS_AT_ONCE = 100;
const phone = matchMedia("(max-width: 40rem)");
let tables = 0;

// Returns a table of n rows. It shows a few rows until the reader asks for all, and then creates those that are
// scrolled into view. Print has the rows that are shown, and a line that says which.
//   columns: { name, number: right-aligned, of: (i) -> value to sort by, show: (i) -> text or node of the cell,
//     beside: on a phone it is beside the name of the row, size: sorted by size without the sign }
//   by: column of the first order, largest value first; -1: in the order of the rows
//   search: hint in the search field; most: number of rows at first
//   dense: many columns, which are narrow
//   words: (i) -> text that the search looks in; without it there is no search
// The result has the node, and first(i), which puts row i at the top and marks it; -1: none.
function sortableTable({ caption, columns, n, by, words, search: hint = "name or family", most: few = 0, dense }) {
  const most = () => few || (phone.matches ? 10 : 20);
  const state = { by, falls: true, text: "", all: false, first: -1, order: [], made: 0 };
  const every = Array.from({ length: n }, (_, i) => i),
    letters = new Intl.Collator("en", { numeric: true });
  let texts = null; // created by the first search
  const body = el("tbody", { id: `rows-${++tables}` }),
    more = el("button", { type: "button", "aria-controls": body.id }),
    said = el("span", { class: "muted", role: "status" }),
    paper = el("p", { class: "paper" });
  const heads = columns.map((column, k) => {
    const press = el("button", { type: "button", class: "sort" }, column.name);
    press.addEventListener("click", () => {
      Object.assign(state, { falls: state.by === k ? !state.falls : !!column.number, by: k });
      redraw();
    });
    return el("th", { scope: "col", class: column.number ? "number" : undefined, "data-name": column.name }, press);
  });

  // Compares rows. Those without a value are last in either direction.
  function compare(a, b) {
    const { of, size } = columns[state.by];
    const at = (i) => (size && typeof of(i) === "number" ? Math.abs(of(i)) : of(i));
    const [u, v] = [at(a), at(b)],
      hasU = u !== null && u !== undefined && !Number.isNaN(u),
      hasV = v !== null && v !== undefined && !Number.isNaN(v);
    if (!hasU || !hasV) return hasV - hasU || a - b;
    const order = typeof u === "string" ? letters.compare(u, v) : u < v ? -1 : u > v ? 1 : 0;
    return (state.falls ? -order : order) || a - b;
  }

  function row(i) {
    const cells = columns.map(({ name, number, beside, show }, k) =>
      el(
        k ? "td" : "th",
        { scope: k ? undefined : "row", class: number ? "number" : beside ? "beside" : undefined, "data-label": name },
        show(i),
      ),
    );
    return el("tr", { class: i === state.first ? "chosen" : undefined }, cells);
  }

  // Adds rows while the end of the table is less than `far` below the upper edge of the screen.
  function makeRows(far = 2 * innerHeight) {
    const { order } = state,
      now = most(),
      limit = state.all ? order.length : Math.min(now, order.length);
    while (state.made < limit && (state.made < now || body.getBoundingClientRect().bottom < far)) {
      const next = order.slice(state.made, Math.min(limit, state.made + (state.made < now ? now : ROWS_AT_ONCE)));
      body.append(...next.map(row));
      state.made += next.length;
    }
  }

  const sortedBy = () =>
    state.by < 0 ? "" : `, those with the ${state.falls ? "largest" : "smallest"} ${columns[state.by].name}`;

  function redraw() {
    if (state.text && !texts) texts = every.map((i) => words(i).toLowerCase());
    const order = every.filter((i) => !state.text || texts[i].includes(state.text));
    if (state.by >= 0) order.sort(compare);
    if (state.first >= 0) order.unshift(...order.splice(order.indexOf(state.first) >>> 0, 1));
    Object.assign(state, { order, made: 0 });
    body.replaceChildren();
    makeRows();
    heads.forEach((head, k) =>
      k === state.by
        ? head.setAttribute("aria-sort", state.falls ? "descending" : "ascending")
        : head.removeAttribute("aria-sort"),
    );
    const listed = state.all ? order.length : Math.min(most(), order.length);
    said.textContent = `${fmtCount(listed)} of ${fmtCount(order.length)}${state.text ? " found" : ""}`;
    more.hidden = order.length <= most();
    more.textContent = state.all ? `show the first ${most()}` : `show all ${fmtCount(order.length)}`;
    more.setAttribute("aria-expanded", state.all);
    paper.textContent =
      listed < order.length ? `${fmtCount(listed)} of ${fmtCount(order.length)} rows${sortedBy()}.` : "";
  }

  more.addEventListener("click", () => {
    state.all = !state.all;
    redraw();
  });
  const search = el("input", { type: "search", placeholder: hint, "aria-label": `Search: ${caption}` });
  search.addEventListener("input", () => {
    state.text = search.value.trim().toLowerCase();
    redraw();
  });
  addEventListener("scroll", () => state.all && makeRows(), { passive: true });
  phone.addEventListener("change", () => state.all || redraw());
  addEventListener("beforeprint", () => makeRows(Infinity));
  redraw();
  return {
    node: el(
      "div",
      {},
      words || n > most() ? el("div", { class: "tools" }, words ? search : null, said, more) : null,
      el(
        "div",
        { class: "scroll", tabindex: 0, role: "region", "aria-label": caption },
        paper,
        el(
          "table",
          { class: dense ? "stacked dense" : "stacked", "aria-label": caption },
          el("thead", {}, el("tr", {}, heads)),
          body,
        ),
      ),
    ),
    first(i) {
      state.first = i;
      redraw();
    },
  };
}

// Contents: tables that are sorted by a click on a heading, and searched

// A table of n rows, of which at most `most` are shown until the reader asks for all.
//   columns: { name, number: right-aligned, of: (i) -> value to sort by, show: (i) -> text or node of the cell }
//   by: the column that it is sorted by at first, largest value first; -1: none, in the order of the rows
//   search: what the field of the search says
//   size: its values without their signs (a change)
//   words: (i) -> text that a search looks in; without it there is no search
// Returns the node, and first(i): puts row i at the top and marks it; -1: none.
function sortableTable({ caption, columns, n, by, words, search: hint = "name or family", most = 25 }) {
  const state = { by, falls: true, text: "", all: false, first: -1 };
  const texts = words && Array.from({ length: n }, (_, i) => words(i).toLowerCase());
  const body = el("tbody", {}),
    more = el("button", { type: "button" }),
    said = el("span", { class: "muted", role: "status" });
  const heads = columns.map((column, k) => {
    const press = el("button", { type: "button", class: "sort" }, column.name);
    press.addEventListener("click", () => {
      Object.assign(state, { falls: state.by === k ? !state.falls : !!column.number, by: k });
      redraw();
    });
    return el("th", { scope: "col", class: column.number ? "number" : undefined }, press);
  });

  // Rows without a value are last, whichever way the others are sorted.
  function compare(a, b) {
    const { of, size } = columns[state.by];
    const at = (i) => (size && typeof of(i) === "number" ? Math.abs(of(i)) : of(i));
    const [u, v] = [at(a), at(b)],
      hasU = u !== null && u !== undefined && !Number.isNaN(u),
      hasV = v !== null && v !== undefined && !Number.isNaN(v);
    if (!hasU || !hasV) return hasV - hasU || a - b;
    const order = typeof u === "string" ? u.localeCompare(v, "en", { numeric: true }) : u < v ? -1 : u > v ? 1 : 0;
    return (state.falls ? -order : order) || a - b;
  }

  function row(i) {
    const cells = columns.map(({ number, show }, k) =>
      el(
        k ? "td" : "th",
        { scope: k ? undefined : "row", class: number ? "number" : undefined, "data-label": columns[k].name },
        show(i),
      ),
    );
    return el("tr", { class: i === state.first ? "chosen" : undefined }, cells);
  }

  function redraw() {
    const order = Array.from({ length: n }, (_, i) => i)
      .filter((i) => !state.text || texts[i].includes(state.text))
      .sort(state.by < 0 ? (a, b) => a - b : compare);
    if (state.first >= 0) order.unshift(...order.splice(order.indexOf(state.first) >>> 0, 1));
    const list = state.all ? order : order.slice(0, most);
    body.replaceChildren(...list.map(row));
    heads.forEach((head, k) =>
      k === state.by
        ? head.setAttribute("aria-sort", state.falls ? "descending" : "ascending")
        : head.removeAttribute("aria-sort"),
    );
    said.textContent = `${fmtCount(list.length)} of ${fmtCount(order.length)}${state.text ? " found" : ""}`;
    more.hidden = order.length <= most;
    more.textContent = state.all ? "show fewer" : "show all";
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
  redraw();
  return {
    node: el(
      "div",
      {},
      words || n > most ? el("div", { class: "tools" }, words ? search : null, said, more) : null,
      el(
        "div",
        { class: "scroll", tabindex: 0, role: "region", "aria-label": caption },
        el("table", { class: "stacked" }, el("thead", {}, el("tr", {}, heads)), body),
      ),
    ),
    first(i) {
      state.first = i;
      redraw();
    },
  };
}

// Opens every page of pages.mjs in headless Chromium and looks at it as its readers would: is everything drawn, is what
// is under the pointer the value in the file, do mouse and keyboard work, in the light, in the dark and on paper?
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";
import { checkFluid } from "./large.mjs";
import { checkLook, inspect } from "./look.mjs";
import { pages } from "./pages.mjs";
import { checkAdjust, checkPattern, checkRounding, checkWords } from "./parts.mjs";
import { csv, number, picture, same, settle, tip } from "./see.mjs";

const { HIFDM, CHROMIUM, WORK } = process.env;
const { chromium } = createRequire(join(WORK, "package.json"))("playwright-core");
const DATA = /(<script type="application\/json" id="data">)([^]*?)(<\/script>)/;
const SIZE_MAX = 1e6; // bytes: the promise of the README
const at =
  (folder) =>
  (...words) =>
    execFileSync(HIFDM, words, { cwd: folder, encoding: "utf8", stdio: ["ignore", "pipe", "ignore"] });

// ---- making a page and the numbers to hold it against ----

function build(page, folder) {
  rmSync(folder, { recursive: true, force: true });
  mkdirSync(folder, { recursive: true });
  const hifdm = at(folder),
    result = page.study ? "study.h5" : "result.h5",
    html = join(folder, "report.html");
  for (const [name, text] of Object.entries(page.files || {})) writeFileSync(join(folder, name), text);
  const source = page.source ? resolve(page.source) : page.study ? "study.yaml" : "case.yaml";
  if (page.text) writeFileSync(join(folder, source), page.text);
  if (page.study) {
    hifdm("sweep", source);
    hifdm("merge", source);
  } else {
    hifdm("run", source, "-o", result, "--quiet");
  }
  const beside = page.other ? ["other.h5"] : [];
  if (page.other) hifdm("run", source, ...page.other, "-o", "other.h5", "--quiet");
  if (page.measured) {
    hifdm("export", result, "--csv", ".");
    writeFileSync(join(folder, "measured.csv"), page.measured(csv(join(folder, "nodes.csv"))));
  }
  const start = performance.now();
  if (page.measured)
    hifdm("adjust", source, "--measured", "measured.csv", "--result", result, "-o", "moves.csv", "--report", html);
  else hifdm("report", result, ...beside, "-o", html);
  const made = { html, hifdm, folder, made_ms: performance.now() - start };
  if (page.study) return { ...made, study: JSON.parse(readFileSync(html, "utf8").match(DATA)[2]).study };
  hifdm("export", result, "--csv", ".", "--force");
  return {
    ...made,
    nodes: csv(join(folder, "nodes.csv")),
    cables: csv(join(folder, "cables.csv")),
    summary: JSON.parse(hifdm("show", result, "--json")),
  };
}

// ---- what a reader sees ----

async function changes(tab, what, act) {
  const before = await picture(tab, "net-canvas");
  await act();
  assert.notEqual((await picture(tab, "net-canvas")).sum, before.sum, `${what} leaves the picture as it was`);
}

// ---- the checks, one after the other on an open page ----

async function checkText(tab, page) {
  if (page.title) {
    assert.equal(await tab.locator("h1").textContent(), page.title);
    assert.equal(await tab.title(), page.title);
  }
  const sections = await tab.locator("main section").evaluateAll((all) => all.map((s) => s.id));
  assert.deepEqual(
    sections.filter((id) => !(page.maybe || []).includes(id)),
    page.sections,
  );
  assert.equal(await tab.evaluate("window.hit"), undefined, "a text of the case became markup");
  assert.equal(await tab.locator("main img, main i, main b, main script").count(), 0);
  const text = await tab.locator("body").innerText();
  for (const word of ["NaN", "undefined", "null", "Infinity", "[object"])
    assert.ok(!text.includes(word), `the page says ${word}`);
  if (page.warnings !== undefined) assert.equal(await tab.locator("#warnings li").count(), page.warnings);
}

async function checkSummary(tab, made) {
  const said = made.hifdm("show", "result.h5").split("\n"),
    answer = await tab.locator("#answer").textContent(),
    loss = said.find((line) => line.trim().startsWith("loss of gain at"));
  assert.equal(answer, `${said[0]}.${loss ? ` ${loss.trim()}.` : ""}`);
  const cells = await tab.locator("#summary tr", { hasText: "psi_m" }).locator("td").allTextContents();
  same(number(cells[0]), 1e3 * made.summary.form.psi_m, 5);
  if (made.summary.optimize) same(number(cells[1]), 1e3 * made.summary.optimize.psi_m, 5);
}

// Every point has a row, its name leads to its result, and the row says what the result says.
async function checkPoints(tab, page, made, folder) {
  const rows = tab.locator("#points tbody tr");
  assert.equal(await rows.count(), page.study);
  for (const i of [0, Math.floor(page.study / 2), page.study - 1]) {
    const file = decodeURIComponent(await rows.nth(i).locator("a").getAttribute("href"));
    const summary = JSON.parse(at(folder)("show", file, "--json"));
    const cell = (label) => rows.nth(i).locator(`[data-label^="${label}"]`).textContent();
    assert.equal(await cell("Status"), "done");
    same(number(await cell("ψ found")), 1e3 * summary.form.psi_m, 5);
    same(number(await cell("Tension ratio, boundary")), summary.form.boundary_tension_ratio, 5);
  }
  // the best point is on top and marked; a heading sorts; a figure with one value is a sentence and no column
  const psi = tab.locator("#points thead button", { hasText: "ψ found" });
  const column = (await tab.locator("#points thead th").allTextContents()).findIndex((t) => t.startsWith("ψ found"));
  const shown = async () =>
    (await tab.locator(`#points tbody tr > :nth-child(${column + 1})`).allTextContents()).map(number);
  const all = await shown();
  assert.equal(await tab.locator("#points tr.chosen").count(), 1);
  assert.equal(all[0], Math.min(...all));
  await psi.click();
  assert.deepEqual((await shown()).slice(1), all.slice(1).sort((a, b) => b - a));
  assert.match(await tab.locator("#sweep > p").innerText(), /inner cables is 1 at all points/);
  assert.equal(await tab.locator("#points thead th", { hasText: "inner" }).count(), 0);
  await checkShares(tab, made.study);
  await checkHeat(tab, made.study);
}

// The shares of the axes in the variance of psi, from the points themselves: in a product of axes those of its means.
async function checkShares(tab, study) {
  const mean = (v) => v.reduce((sum, x) => sum + x, 0) / v.length,
    variance = (v) => mean(v.map((x) => x * x)) - mean(v) ** 2;
  const said = await tab.locator("#sweep > p").innerText(),
    psi = study.output.at(-1).psi_m;
  for (const { name, values } of study.input) {
    const means = [...new Set(values)].map((at) => mean(psi.filter((_, i) => values[i] === at)));
    const words = name.split(".").pop().replace(/_N$/, ""),
      [, little, told] = said.match(new RegExp(`${words} (less than )?([\\d.]+)\u00a0%`)),
      share = (100 * variance(means)) / variance(psi);
    if (little) assert.ok(share < number(told));
    else same(number(told), share, 2);
  }
}

// Along the axis of few values the many of the other one are a map: each cell has the value of its point.
async function checkHeat(tab, study) {
  const few = study.input.find(({ values }) => new Set(values).size <= 4),
    many = study.input.find((input) => input !== few),
    sorted = ({ values }) => [...new Set(values)].sort((a, b) => a - b);
  await tab.locator(`#sweep input[name=axis][value="${few.name}"]`).check();
  const rows = tab.locator("#sweep .heat").first().locator("tbody tr"),
    [x, y] = [sorted(few), sorted(many).reverse()];
  assert.equal(await rows.count(), y.length);
  for (const [r, c] of [
    [0, 0],
    [5, 2],
  ]) {
    const i = few.values.findIndex((v, k) => v === x[c] && many.values[k] === y[r]);
    const title = await rows.nth(r).locator("td").nth(c).getAttribute("title");
    same(number(title.match(/: (\S+) mm$/)[1]), 1e3 * study.output.at(-1).psi_m[i], 5);
  }
  await tab.locator(`#sweep input[name=axis][value="${many.name}"]`).check();
}

// part: of the page, whose first chart must say these words about its last point.
async function checkCharts(tab, least, part, words) {
  const charts = await tab.locator(".chart").evaluateAll((all) =>
    all.map((c) => ({
      title: c.querySelector("h3").textContent,
      markup: c.querySelector("svg[tabindex]").outerHTML,
      ticks: c.querySelectorAll("svg[tabindex] text").length,
      drawn: [...c.querySelectorAll("svg[tabindex] path")].map(
        (p) => p.getTotalLength() + p.getAttribute("d").length,
      ),
      endless: c.querySelectorAll("svg[tabindex] circle").length,
    })),
  );
  assert.ok(charts.length >= least, "too few charts");
  for (const c of charts) {
    assert.ok(!/NaN|undefined|Infinity/.test(c.markup), `${c.title}: holds no numbers`);
    assert.ok(c.ticks >= 5, `${c.title}: ${c.ticks} labels`);
    assert.ok((c.drawn.length && c.drawn.some((d) => d > 0)) || c.endless, `${c.title}: is empty`);
    assert.equal(c.endless > 0, c.markup.includes("∞"), `${c.title}: infinite values without their sign`);
  }
  const first = tab.locator(`${part} .chart svg[tabindex]`).first(),
    said = tab.locator(`${part} .chart .tip`).first();
  await first.focus();
  await tab.keyboard.press("End");
  assert.match(await said.innerText(), words);
  await tab.keyboard.press("Escape");
  assert.ok(await said.isHidden());
  return charts.filter((c) => c.endless).map((c) => c.title);
}

// Where families can be switched off they are first: from above, a rear net lies under the front one.
async function checkHover(tab, page, made) {
  for (const name of page.off || []) await tab.locator("#families").getByLabel(name, { exact: true }).uncheck();
  const seen = made.cables.filter((c) => !(page.off || []).includes((c.set || "").replace("_", " ")));
  await tab.locator("#net-canvas").scrollIntoViewIfNeeded();
  const box = await tab.locator("#net-canvas").boundingBox();
  const at = (kind, i) => tab.evaluate(([k, e]) => report.net.screenOf(k, e), [kind, i]);
  // The tooltip of a node or cable, seen from above and so near that nothing else is close.
  async function hover(kind, i) {
    await tab.getByRole("button", { name: "View along z" }).click();
    for (let k = 0; k < 5; k++) {
      await settle(tab);
      const [x, y] = await at(kind, i);
      await tab.mouse.move(box.x + x + 1, box.y + y + 1);
      if (k < 4) await tab.mouse.wheel(0, -500);
    }
    return tip(tab, "net");
  }
  for (const part of [0.1, 0.37, 0.62, 0.98]) {
    const cable = seen[Math.floor(part * seen.length)],
      said = await hover("cable", made.cables.indexOf(cable));
    assert.equal(said && said.heading, `cable ${cable.id}`);
    same(number(said.tension), Number(cable.tension_N), 6);
    same(number(said.length), Number(cable.length_m), 6);
    same(number(said["force density"]), Number(cable.q_N_per_m), 5);
    const i = made.nodes.findIndex((n) => n.id === cable.j),
      node = made.nodes[i],
      about = await hover("node", i);
    assert.equal(about && about.heading, `node ${node.id}`);
    const distance_m = Math.hypot(node.x_m - node.x0_m, node.y_m - node.y0_m, node.z_m - node.z0_m);
    same(number(about["to theory"]), 1e3 * distance_m, 5);
  }
  await tab.mouse.move(box.x - 5, box.y - 5);
  await tab.getByRole("button", { name: "View from above" }).click();
  assert.equal(await tip(tab, "net"), null);
  for (const name of page.off || []) await tab.locator("#families").getByLabel(name, { exact: true }).check();
}

async function checkNet(tab, page, made) {
  const canvas = tab.locator("#net-canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox();
  assert.ok((await picture(tab, "net-canvas")).colours > 10, "the net is not drawn");
  await changes(tab, "dragging", async () => {
    await tab.mouse.move(box.x + 300, box.y + 200);
    await tab.mouse.down();
    await tab.mouse.move(box.x + 360, box.y + 230, { steps: 4 });
    await tab.mouse.up();
    await tab.mouse.move(box.x + 5, box.y + 5);
  });
  await tab.getByRole("button", { name: "View along x" }).focus();
  await tab.keyboard.press("Tab"); // the picture comes after its tools
  assert.equal(await tab.evaluate("document.activeElement.id"), "net-canvas");
  assert.notEqual(await canvas.evaluate((c) => getComputedStyle(c).outlineStyle), "none", "no visible focus");
  for (const key of ["ArrowLeft", "ArrowUp", "Shift+ArrowRight", "+", "-", "0"])
    await changes(tab, key, () => tab.keyboard.press(key));
  await tab.keyboard.press("n");
  assert.equal((await tip(tab, "net")).heading, `node ${made.nodes[0].id}`);
  await tab.keyboard.press("Shift+C");
  assert.equal((await tip(tab, "net")).heading, `cable ${made.cables.at(-1).id}`);
  await tab.keyboard.press("Escape");
  assert.equal(await tip(tab, "net"), null);
  for (const label of ["tension", "slack", "none", "theoretical", "found"])
    await changes(tab, label, () => tab.locator("#net").getByLabel(label, { exact: true }).check());
  if (page.truss)
    await changes(tab, "the truss", () => tab.locator("#net").getByLabel("truss", { exact: true }).uncheck());
  await tab.locator("#net").getByLabel("slack").check();
  await settle(tab);
  if (page.slack !== undefined)
    assert.match(await tab.locator("#net .bar").innerText(), new RegExp(`^${page.slack} of`));
  await tab.locator("#net").getByLabel("deviation").check();
  await changes(tab, "the scale", () => tab.getByLabel("scale of the deformation").press("ArrowRight"));
  await tab.reload();
}

// In the page: scrolls until no more rows are made.
async function wholeTable(selector) {
  const body = document.querySelector(selector);
  for (let made = 0; made < body.rows.length;) {
    made = body.rows.length;
    body.rows[made - 1].scrollIntoView();
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  }
}

// The table of cables: values of the file, sorted by the heading that is pressed, found by a search; a name marks its
// cable in the picture, a click on a cable there brings its row to the top.
async function checkCables(tab, made) {
  const rows = tab.locator("#cables tbody tr"),
    names = tab.locator("#cables tbody th"),
    heads = await tab.locator("#cables thead th").allTextContents(),
    { length } = made.cables;
  const more = tab.locator("#cables").getByRole("button", { name: "show all" });
  if (length > 25) {
    await more.click();
    const made = await rows.count();
    assert.ok(made <= Math.min(length, 300), `${made} rows at once`);
    await tab.evaluate(wholeTable, "#cables tbody");
  }
  assert.equal(await rows.count(), length);
  const column = heads.findLastIndex((head) => head.startsWith("tension, ")),
    head = tab.locator("#cables thead th").nth(column);
  await tab.locator("#cables thead button").first().click();
  for (const [way, sign] of [
    ["descending", -1],
    ["ascending", 1],
  ]) {
    await head.getByRole("button").click();
    assert.equal(await head.getAttribute("aria-sort"), way);
    const shown = (await tab.locator(`#cables tbody tr > :nth-child(${column + 1})`).allTextContents()).map(number);
    const wanted = made.cables.map((c) => Number(c.tension_N)).sort((a, b) => sign * (a - b));
    const size = Math.max(...wanted.map(Math.abs));
    shown.forEach((v, k) => assert.ok(Math.abs(v - wanted[k]) < 1e-4 * size, `${v} is shown for ${wanted[k]}`));
  }
  if (heads.some((text) => text.startsWith("cut to"))) await checkCuts(tab, made, heads);
  const cable = made.cables[Math.floor(length / 2)],
    search = tab.locator("#cables input[type=search]");
  await search.fill(cable.id);
  assert.ok((await names.allTextContents()).includes(cable.id) && (await rows.count()) < Math.max(length, 2));
  await search.fill("there is no such cable");
  assert.equal(await rows.count(), 0);
  await search.fill("");
  await changes(tab, "a name in the table", () => names.first().getByRole("button").click());
  assert.equal((await tip(tab, "net")).heading, `cable ${await names.first().textContent()}`);
  await tab.locator("#net-canvas").focus();
  await tab.keyboard.press("Escape");
  for (let k = 0; k < 3; k++) await tab.keyboard.press("c");
  await tab.keyboard.press("Enter");
  assert.equal(await names.first().textContent(), made.cables[2].id);
  assert.equal(await tab.locator("#cables tr.chosen").count(), 1);
  await tab.reload();
}

// Lengths and turns are those of the cut list, turns from the found net the difference of two.
async function checkCuts(tab, made, heads) {
  const of = (stage) => {
    made.hifdm("export", "result.h5", "--cutlist", `${stage}.csv`, "--stage", stage, "--force");
    return new Map(csv(join(made.folder, `${stage}.csv`)).map((c) => [c.id, c]));
  };
  const found = of("form"),
    result = made.summary.polish?.is_result ? of("polish") : made.summary.optimize ? of("optimize") : found;
  const cells = await tab.locator("#cables tbody tr").evaluateAll((all) =>
    all.map((row) => [...row.children].map((c) => c.textContent)),
  );
  const column = (start) => heads.findIndex((text) => text.startsWith(start));
  for (const row of cells) {
    const now = result.get(row[0]),
      turn_m = found === result ? Number(now.l0_minus_theory_m) : Number(now.l0_m) - Number(found.get(row[0]).l0_m);
    assert.ok(Math.abs(number(row[column("cut to")]) - Number(now.l0_m)) < 1e-4 * Number(now.l0_m));
    const shown_mm = number(row[column("turn, ")]);
    assert.ok(Math.abs(shown_mm - 1e3 * turn_m) < 0.06, `a turn of ${shown_mm} mm for ${1e3 * turn_m}`);
  }
}

// Figures of both results, what differs in their cases, and the tensions of both in the table of cables.
async function checkOther(tab, page, made) {
  const other = JSON.parse(made.hifdm("show", "other.h5", "--json")),
    row = tab.locator("#compare tr", { hasText: "surface error ψ" }),
    [a, b, change] = (await row.locator("td").allTextContents()).map(number);
  same(a, 1e3 * made.summary.optimize.psi_m, 5);
  same(b, 1e3 * other.polish.psi_m, 5);
  same(change, 1e3 * (other.polish.psi_m - made.summary.optimize.psi_m), 4);
  const lines = await tab.locator("#compare .differences li").allTextContents();
  assert.deepEqual(lines, ["+ optimize.method=lm", "+ form.pretension_N=10.5"]);
  made.hifdm("export", "other.h5", "--csv", ".", "--force");
  const theirs = new Map(csv(join(made.folder, "cables.csv")).map((c) => [c.id, Number(c.tension_N)])),
    ours = new Map(made.cables.map((c) => [c.id, Number(c.tension_N)]));
  const heads = await tab.locator("#cables thead th").allTextContents(),
    column = heads.findIndex((text) => text.startsWith("change"));
  const rows = await tab
    .locator("#cables tbody tr")
    .evaluateAll((all) => all.map((r) => [...r.children].map((c) => c.textContent)));
  assert.equal(rows.length, 25);
  for (const cells of rows) {
    const wanted = theirs.get(cells[0]) - ours.get(cells[0]);
    assert.ok(Math.abs(number(cells[column]) - wanted) < 2e-3, `${cells[column]} is shown for ${wanted}`);
  }
  await changes(tab, "the other shape", () => tab.locator("#net").getByLabel("other.h5: LM optimum").check());
  await tab.reload();
}

// Losses of gain stand beside those at the same frequency; cases are compared without comments, and what is left out of
// long ones is said.
async function checkUnlike(browser, tab, made, folder) {
  const [a, b] = ["result.h5", "other.h5"].map((file) => JSON.parse(made.hifdm("show", file, "--json")).form.surface),
    cells = (at) => tab.locator("#compare tr", { hasText: `loss of gain at ${at}` }).first().locator("td");
  const [low, high] = [await cells("0.01 GHz").allTextContents(), await cells("0.05 GHz").allTextContents()];
  same(number(low[0]), a.gain_loss_dB[0], 3);
  assert.deepEqual(low.slice(1, 3), ["–", ""]);
  same(number(high[0]), a.gain_loss_dB[1], 3);
  same(number(high[1]), b.gain_loss_dB[0], 3);
  const page = readFileSync(made.html, "utf8"),
    said = async (text, otherText) => {
      let found;
      const data = JSON.parse(page.match(DATA)[2]);
      Object.assign(data, { case_text: [text], overrides: [""] });
      Object.assign(data.other, { case_text: [otherText], overrides: [""] });
      const copy = page.replace(DATA, (_, head, old, tail) => head + JSON.stringify(data) + tail);
      await openCopy(browser, folder, "texts", copy, async (of) => (found = await of.locator("#compare").innerText()));
      return found;
    };
  const long = "a: 1\n".repeat(700);
  assert.ok((await said("a: 1 # one\n# two\n", "  # three\na: 1 # one\n")).includes("the same text of the case"));
  assert.ok((await said("a: 1\n", "a: 2\n")).includes("+ a: 2"));
  for (const end of ["", "b: 2\n"]) {
    const text = await said(long, `${end}${long}`);
    assert.ok(text.includes("Only the first 600 lines") && !text.includes("the same text"), text);
  }
}

async function checkMap(tab, made) {
  assert.ok((await picture(tab, "map-canvas")).colours > 30, "the map is not drawn");
  const canvas = tab.locator("#map-canvas");
  await canvas.scrollIntoViewIfNeeded();
  const box = await canvas.boundingBox(),
    before = await picture(tab, "map-canvas");
  let said = null;
  for (let k = 1; k < 60 && !said; k++) {
    // somewhere on the way across there is a node
    await tab.mouse.move(box.x + (box.width * k) / 60, box.y + box.height / 2);
    said = await tip(tab, "map");
  }
  const node = made.nodes.find((n) => said && said.heading === `node ${n.id}`);
  assert.ok(node, "no node on the map");
  same(number(said["height, Δz"]), 1e3 * (node.z_m - node.z0_m), 4);
  await tab.locator("#map").getByLabel("height").check();
  assert.notEqual((await picture(tab, "map-canvas")).sum, before.sum);
}

// The value of a facet is that of its corners in the tables, by the rule of the middles of the sides; switches of
// families take their cables out of the picture and from under the pointer.
async function checkFacets(tab, page, made) {
  const corners = await tab.evaluate("Array.from(net.facets)"),
    f = 3; // m, of the case
  assert.equal(corners.length, 4 * page.facets);
  for (const quantity of ["facets, best fit", "facets, along the normal"]) {
    const before = await picture(tab, "map-canvas");
    await tab.locator("#map").getByLabel(quantity).check();
    const after = await picture(tab, "map-canvas");
    assert.ok(after.sum !== before.sum && after.colours > 8, `${quantity}: nothing is drawn`);
  }
  await tab.locator("#map-canvas").scrollIntoViewIfNeeded();
  const box = await tab.locator("#map-canvas").boundingBox();
  for (const k of [0, Math.floor(page.facets / 2), page.facets - 1]) {
    const [x, y] = await tab.evaluate((facet) => report.map.facetAt(facet), k);
    await tab.mouse.move(box.x + x, box.y + y);
    const said = await tip(tab, "map"),
      nodes = corners.slice(4 * k, 4 * k + 3).map((i) => made.nodes[i]);
    assert.equal(said && said.heading, `facet ${nodes.map((n) => n.id).join(", ")}`);
    const p = nodes.map((n) => [Number(n.x_m), Number(n.y_m), Number(n.z_m)]);
    const errors = [0, 1, 2].map((i) => {
      const [a, b, c] = [0, 1, 2].map((d) => (p[i][d] + p[(i + 1) % 3][d]) / 2);
      return (c - (a * a + b * b) / (4 * f)) / Math.hypot(1, a / (2 * f), b / (2 * f));
    });
    const mean_mm = (1e3 * (errors[0] + errors[1] + errors[2])) / 3;
    const size_mm = 1e3 * Math.max(...errors.map(Math.abs)); // the slope, which is not constant, makes 5e-3 of it
    assert.ok(Math.abs(number(said["along the normal, mean"]) - mean_mm) < 5e-3 * size_mm, "another error");
  }
  const switches = tab.locator("#families"),
    e = made.cables.findIndex((c) => page.off.includes(c.set));
  for (const name of page.off) await changes(tab, name, () => switches.getByLabel(name, { exact: true }).uncheck());
  await tab.locator("#net-canvas").scrollIntoViewIfNeeded();
  const [x, y] = await tab.evaluate((i) => report.net.screenOf("cable", i), e),
    view = await tab.locator("#net-canvas").boundingBox();
  await tab.mouse.move(view.x + x, view.y + y);
  const said = await tip(tab, "net");
  assert.ok(!said || said.heading !== `cable ${made.cables[e].id}`, "a cable that is switched off is picked");
  for (const name of page.off) await switches.getByLabel(name, { exact: true }).check();
}

// Bars as high as the samples are many, a line for each figure at its place, and the cables of the file.
async function checkTolerance(tab, made) {
  const t = made.summary.tolerance,
    legend = await tab.locator("#tolerance .legend > span").allTextContents(),
    named = legend.filter((text) => text.endsWith(" mm")).map((text) => number(text.match(/([^ ]+) mm$/)[1]));
  assert.equal(await tab.locator("#tolerance line.curve").count(), 3);
  [t.nominal_psi_m, t.psi_95_m, t.require[0].at_most].forEach((at, k) => same(named[k], 1e3 * at, 5));
  assert.match(await tab.locator("#tolerance figcaption").textContent(), /at least 1 mm, outside of the picture/);
  const most = t.histogram.indexOf(Math.max(...t.histogram)),
    [low, high] = t.histogram_range_m;
  await tab.locator("#tolerance svg[tabindex]").focus();
  for (let k = 0; k <= most; k++) await tab.keyboard.press("ArrowRight");
  const said = await tab.locator("#tolerance .tip").innerText();
  same(number(said.match(/nets\s+([\d.]+)/)[1]), 100 * t.histogram[most], 6);
  same(number(said.match(/of ([\d.]+) to/)[1]), 1e3 * (low + (most * (high - low)) / t.histogram.length), 5);
  assert.ok((await tab.locator("#tolerance > p").first().innerText()).includes("give a yield of 90\u00a0%"));
  const rows = await tab.locator("#tolerance tbody th").allTextContents();
  assert.deepEqual(
    rows,
    t.cable_share.map(({ cable }) => cable),
  );
}

async function checkRules(tab) {
  assert.equal(await tab.locator("th:not([scope])").count(), 0, "a heading of a table without scope");
  assert.equal(await tab.locator("button:not([type])").count(), 0);
  assert.equal(await tab.locator("canvas:not([aria-label]), svg[role=img]:not([aria-label])").count(), 0);
  assert.equal(
    await tab
      .locator("input")
      .evaluateAll((all) => all.filter((i) => !i.labels.length && !i.getAttribute("aria-label")).length),
    0,
    "an input without a label",
  );
}

const background = (tab) =>
  tab.evaluate(
    () =>
      getComputedStyle(document.body)
        .backgroundColor.match(/\d+/g)
        .slice(0, 3)
        .reduce((a, b) => a + Number(b), 0) / 3,
  );

// The pictures follow the scheme of colours, and paper is light.
async function checkMedia(tab, pictures) {
  const seen = {};
  for (const [name, media] of [
    ["light", { colorScheme: "light", media: "screen" }],
    ["dark", { colorScheme: "dark", media: "screen" }],
    ["print", { colorScheme: "dark", media: "print" }],
  ]) {
    await tab.emulateMedia(media);
    seen[name] = {
      paper: await background(tab),
      sums: await Promise.all(pictures.map(async (name) => (await picture(tab, name)).sum)),
      tools: await tab.locator(".tools").first().isVisible(),
    };
  }
  assert.ok(seen.light.paper > 230 && seen.dark.paper < 50 && seen.print.paper > 250, "wrong colour of the paper");
  pictures.forEach((name, k) => {
    assert.notEqual(seen.light.sums[k], seen.dark.sums[k], `${name} does not follow the dark scheme`);
    assert.notEqual(seen.print.sums[k], seen.dark.sums[k], `${name} is printed in the dark`);
  });
  assert.ok(seen.light.tools && !seen.print.tools, "controls on paper");
  await tab.emulateMedia({ colorScheme: "light", media: "screen" });
  await tab.setViewportSize({ width: 360, height: 700 });
  await settle(tab);
  assert.deepEqual((await tab.evaluate(inspect)).faults, [], "on a telephone");
}

// A figure of which the page knows nothing but its row in the list of figures is in the summary with the words of that
// row; in a copy of the page, which is given one.
async function checkUnknownFigure(browser, made, folder) {
  const copy = join(folder, "figure.html"),
    given = readFileSync(made.html, "utf8")
      .replace('"figures": [', '"figures": [{"key":"made_up_N","units":"N","description":"a made-up force"}, ')
      .replace('"form": {', '"form": {"made_up_N": 1.25, ');
  writeFileSync(copy, given);
  const tab = await browser.newPage();
  await tab.goto(pathToFileURL(copy).href);
  const cells = await tab.locator("#summary tr", { hasText: "a made-up force" }).locator("td").allTextContents();
  assert.equal(number(cells[0]), 1.25);
  assert.deepEqual(cells.slice(-2), ["N", "made_up_N"]);
  await tab.close();
}

// ---- hostile texts: in every text of the data of a page, longer than any that the program writes ----

const HOSTILE =
  `</script><script>window.hit=4</script><img src=x onerror="window.hit=5"><svg onload="window.hit=6">javascript:0` +
  `<!--]]>'"\\&amp;\u2028\u2029\u202e\u2066\u200f\u061c\0\x1b[31m\x7f\x9b` + "x".repeat(1e4);
const HIDDEN = /[\0-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]/;

function poison(data) {
  data.title = HOSTILE;
  if (data.study) {
    const { study } = data,
      every = () => Array(study.n).fill(HOSTILE);
    Object.assign(study, { path: HOSTILE, id: every(), reason: every(), file: every(), page: every() });
    study.input[0].name = HOSTILE;
    study.input.push({ name: HOSTILE, texts: every().map((text, i) => text + (i % 2)) });
    return data;
  }
  data.net.node_id = data.net.node_id.map(() => HOSTILE);
  data.net.cable_id = data.net.cable_id.map(() => HOSTILE);
  if (data.other) {
    Object.assign(data.other, { name: HOSTILE, case_text: [HOSTILE], overrides: [`${HOSTILE}\n${HOSTILE}`] });
    data.other.summary.form.status = HOSTILE;
  }
  if (data.summary.tolerance) data.summary.tolerance.cable_share.forEach((row) => (row.cable = HOSTILE));
  data.provenance = data.provenance.map((line) => line + HOSTILE);
  Object.assign(data.summary, { file: HOSTILE, case: HOSTILE, version: HOSTILE, warnings: [HOSTILE, HOSTILE] });
  data.figures.push({ key: "made_up_N", units: HOSTILE, description: HOSTILE });
  data.summary.form.made_up_N = 1.25;
  return data;
}

// Opens a copy of a page; what it did to the tripwire window.hit.
async function openCopy(browser, folder, name, text, look = () => {}) {
  const copy = join(folder, `${name}.html`),
    tab = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  writeFileSync(copy, text);
  await tab.goto(pathToFileURL(copy).href);
  await settle(tab);
  await look(tab);
  const hit = await tab.evaluate("window.hit");
  await tab.close();
  return hit;
}

async function lookAtHostile(tab) {
  const text = await tab.locator("body").innerText();
  assert.ok(!HIDDEN.test(text) && !HIDDEN.test(await tab.title()), "a hidden character is on the page");
  assert.ok(text.includes("\\u202e") && text.includes("\\x1b[31m"), "no trace of the hostile texts");
  assert.equal(await tab.locator("main img, main script, main [onload], main [onerror]").count(), 0);
  assert.ok((await tab.locator("h1").boundingBox()).height < 200, "the title covers the page");
  for (const width of [1200, 360]) {
    await tab.setViewportSize({ width, height: 900 });
    await settle(tab);
    assert.ok((await tab.evaluate("document.documentElement.scrollWidth")) <= width, `wider than ${width}`);
  }
  await tab.setViewportSize({ width: 1200, height: 900 });
  if (!(await tab.locator("#net-canvas").count())) return;
  await tab.locator("#net-canvas").focus();
  await tab.keyboard.press("n");
  await settle(tab);
  const said = tab.locator(".stage.net .tip"),
    box = await said.boundingBox();
  assert.ok((await said.locator("strong").textContent()).startsWith("node </script>"));
  assert.ok(box.height < 250 && box.width < 400, `a tooltip of ${box.width} x ${box.height}`);
}

// Nothing of the texts runs and the page stays usable. So that this is known to be seen: the same page trips the wire
// when its data are not escaped, and when texts become markup.
async function checkHostile(browser, made, folder) {
  const page = readFileSync(made.html, "utf8"),
    data = JSON.stringify(poison(JSON.parse(page.match(DATA)[2]))),
    escaped = data.replace(/</g, "\\u003c"),
    hostile = page.replace(DATA, (_, head, old, tail) => head + escaped + tail),
    open = page.replace(DATA, (_, head, old, tail) => head + data + tail),
    append = `node.append(typeof child === "string" ? shown(child) : child)`;
  assert.equal(await openCopy(browser, folder, "hostile", hostile, lookAtHostile), undefined, "a text was run");
  assert.notEqual(await openCopy(browser, folder, "open", open), undefined, "the wire is dead: data as they are");
  assert.ok(page.includes(append));
  const markup = hostile.replace(
    append,
    `typeof child === "string" ? node.insertAdjacentHTML("beforeend", child) : node.append(child)`,
  );
  assert.notEqual(await openCopy(browser, folder, "markup", markup), undefined, "the wire is dead: texts as markup");
}

// ---- all pages ----

async function test(browser, page) {
  const folder = join(WORK, page.name),
    made = build(page, folder),
    bytes = statSync(made.html).size;
  assert.ok(bytes < (page.bytes_max || SIZE_MAX), `${bytes} bytes`);
  const url = pathToFileURL(made.html).href,
    trouble = [];
  const tab = await browser.newPage({ viewport: { width: 1200, height: 900 } });
  tab.on("console", (message) => trouble.push(`console: ${message.text()}`));
  tab.on("pageerror", (error) => trouble.push(`error: ${error.message}`));
  tab.on("request", (request) => request.url() === url || trouble.push(`request: ${request.url()}`));
  await tab.goto(url);
  await checkText(tab, page);
  let said = "";
  if (page.fluid) {
    said = `; ${await checkFluid(tab, url)}`;
  } else if (page.study) {
    const chosen = tab.locator("#sweep input[name=axis]:checked");
    assert.equal(await chosen.getAttribute("value"), page.leads, "the axis at first is not the one that matters most");
    await tab.locator(`#sweep input[name=axis]:not([value="${page.leads}"])`).check();
    await checkCharts(tab, 2, "#sweep", /pretension [\d.]+ N/);
    await checkPoints(tab, page, made, folder);
  } else {
    await checkSummary(tab, made);
    if (page.name === "chen2022") await checkWords(tab, made);
    const endless = await checkCharts(tab, 4, "#form-finding", /iteration \d+\s+ψ\s+[\d.]+.* mm/);
    await checkNet(tab, page, made);
    if (page.unlike) await checkUnlike(browser, tab, made, folder);
    else if (page.other) await checkOther(tab, page, made);
    else await checkCables(tab, made);
    await checkHover(tab, page, made);
    if (page.slack) assert.ok(endless.includes("Tension ratio, boundary cables"), "an infinite ratio is not shown");
    if (page.rounding) await checkRounding(tab);
    else await checkMap(tab, made);
    if (page.facets) await checkFacets(tab, page, made);
    if (page.measured) await checkAdjust(tab, made, changes);
    if (page.pattern) await checkPattern(tab, page, made);
    if (made.summary.tolerance && !page.measured) await checkTolerance(tab, made);
    await checkUnknownFigure(browser, made, folder);
  }
  if (page.study || page.other || page.slack !== undefined) await checkHostile(browser, made, folder);
  await checkRules(tab);
  if (!page.fluid) await checkMedia(tab, page.study ? [] : ["net-canvas", "map-canvas"]);
  if (page.look) await checkLook(tab, page, folder);
  assert.deepEqual(trouble, []);
  await tab.close();
  return `${(bytes / 1e3).toFixed(0)} kB, written in ${made.made_ms.toFixed(0)} ms${said}`;
}

const wanted = process.argv.slice(2),
  browser = await chromium.launch({ executablePath: CHROMIUM, args: ["--no-sandbox"] });
let failed = 0;
for (const page of pages.filter((p) => !wanted.length || wanted.includes(p.name))) {
  try {
    console.log(`${page.name}: ${await test(browser, page)}`);
  } catch (error) {
    failed++;
    console.log(`${page.name}: FAILED: ${error.stack}`);
  }
}
await browser.close();
console.log(failed ? `${failed} pages failed` : "all pages are as they should be");
process.exitCode = failed ? 1 : 0;

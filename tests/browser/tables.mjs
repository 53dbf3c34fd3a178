// The summary, the charts and the table of cables: values of the file, sorted, searched and read out.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { changes, csv, number, same, settle, tip } from "./see.mjs";

export async function checkSummary(tab, made, page) {
  const said = made.hifdm("show", "result.h5").split("\n"),
    answer = await tab.locator("#answer").textContent(),
    first = said[said.findIndex((line) => line.startsWith("  case ")) - 1], // below the verdicts
    loss = said.find((line) => /^ +gain loss at .*GHz/.test(line));
  const sentence = (text) => `${text[0].toUpperCase()}${text.slice(1)}.`;
  assert.equal(answer, (page.other ? "result.h5: " : "") + sentence(first) + (loss ? sentence(loss.trim()) : ""));
  const cells = await tab.locator("#summary tr", { hasText: "psi_m" }).locator("td").allTextContents();
  same(number(cells[0]), 1e3 * made.summary.form.psi_m, 5);
  if (made.summary.search) same(number(cells[1]), 1e3 * made.summary.search.psi_m, 5);
  const figure = page.other || made.summary.front ? cells[0] : await tab.locator(".figures dd").first().textContent();
  const digits = (text) => text.replace(/[^\d]/g, "").replace(/^0+/, "").length;
  for (const text of [cells[0], figure]) if (number(text) >= 1e-3) assert.equal(digits(text), 5, text);
  const why = made.summary.form.stop_reason,
    told = tab.locator("#summary tr", { hasText: "stop_reason" }).locator("td span").first(),
    title = await told.getAttribute("title");
  const plain = (text) => text.replace(/\s+/g, " ");
  assert.ok(plain(made.hifdm("explain", why)).includes(plain(title)), `${why}: ${title}`);
}

// part: of the page, whose first chart must say these words about its last point.
export async function checkCharts(tab, least, part, words) {
  const charts = await tab.locator(".chart").evaluateAll((all) =>
    all.map((c) => ({
      title: c.querySelector("h3").textContent,
      markup: c.querySelector("svg[tabindex]").outerHTML,
      ticks: c.querySelectorAll("svg[tabindex] text").length,
      values: c.querySelectorAll("svg[tabindex] text[text-anchor=end]").length,
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
    assert.ok(c.values >= 2 || c.endless, `${c.title}: its values have ${c.values} labels`);
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

// In the page: scrolls until no more rows are made.
async function wholeTable(selector) {
  const body = document.querySelector(selector);
  for (let made = 0; made < body.rows.length;) {
    made = body.rows.length;
    body.rows[made - 1].scrollIntoView();
    await new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
  }
}

// Few rows at first, fewer on a phone; the button says how many there are, to a screen reader, too, and paper which of
// them it has.
async function checkFew(tab, more, length) {
  const rows = tab.locator("#cables tbody tr"),
    desk = tab.viewportSize(),
    all = String(length).replace(/\B(?=(\d{3})+$)/g, "\u202f");
  for (const [width, few] of [
    [400, 10],
    [desk.width, 20],
  ]) {
    await tab.setViewportSize({ ...desk, width });
    await settle(tab);
    assert.equal(await rows.count(), few);
    assert.equal(await more.textContent(), `show all ${all}`);
    assert.equal(await more.getAttribute("aria-expanded"), "false");
    assert.equal(await tab.locator(`#${await more.getAttribute("aria-controls")} tr`).count(), few);
    const paper = await tab.locator("#cables .paper").textContent();
    assert.ok(paper.startsWith(`${few} of ${all} rows, those with the largest`), paper);
  }
}

// The table of cables: values of the file, sorted by the heading that is pressed, found by a search; a name marks its
// cable in the picture, a click on a cable there brings its row to the top.
export async function checkCables(tab, made) {
  const rows = tab.locator("#cables tbody tr"),
    names = tab.locator("#cables tbody th"),
    heads = await tab.locator("#cables thead th").allTextContents(),
    { length } = made.cables;
  const more = tab.locator("#cables .tools button");
  if (length > 20) {
    await checkFew(tab, more, length);
    await more.focus();
    await tab.keyboard.press("Enter");
    assert.equal(await more.getAttribute("aria-expanded"), "true");
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
  if (heads.some((text) => text.startsWith("unstressed length"))) await checkCuts(tab, made, heads);
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

// Unstressed lengths are those of the cut list, and so are their differences, of two cut lists after a search.
async function checkCuts(tab, made, heads) {
  const of = (stage) => {
    made.hifdm("export", "result.h5", "--cutlist", `${stage}.csv`, "--stage", stage, "--force");
    return new Map(csv(join(made.folder, `${stage}.csv`)).map((c) => [c.id, c]));
  };
  const found = of("form"),
    result = made.summary.refine?.is_result ? of("refine") : made.summary.search ? of("search") : found;
  const cells = await tab.locator("#cables tbody tr").evaluateAll((all) =>
    all.map((row) => [...row.children].map((c) => c.textContent)),
  );
  const column = (start) => heads.findIndex((text) => text.startsWith(start)),
    isMeasured = (await tab.locator("#adjust").count()) > 0; // then there are no differences of designs
  assert.equal(column("unstressed: ") < 0, isMeasured);
  for (const row of cells) {
    const now = result.get(row[0]),
      length_m = Number(now.unstressed_length_m),
      change_m =
        found === result
          ? Number(now.unstressed_minus_target_m)
          : length_m - Number(found.get(row[0]).unstressed_length_m);
    assert.ok(Math.abs(number(row[column("unstressed length")]) - length_m) < 1e-4 * length_m);
    if (isMeasured) continue;
    const shown_mm = number(row[column("unstressed: ")]);
    assert.ok(Math.abs(shown_mm - 1e3 * change_m) < 0.06, `${shown_mm} mm is shown for ${1e3 * change_m}`);
  }
}

// A change of ψ has the word of its sign; in copies of the page with another initial design.
export async function checkChange(browser, made, folder) {
  const psi_m = made.summary.refine.psi_m,
    given = readFileSync(made.html, "utf8");
  for (const [part, size, word] of [
    [0.5, "100.00", "above"],
    [2, "50.00", "below"],
    [1.00001, "0.00", "against"],
  ]) {
    const copy = join(folder, `change-${word}.html`);
    writeFileSync(copy, given.replace(/"initial_psi_m": [^,}]*/, `"initial_psi_m": ${part * psi_m}`));
    const tab = await browser.newPage();
    await tab.goto(pathToFileURL(copy).href);
    assert.equal(await tab.locator(".figures dt").nth(2).textContent(), `ψ ${word} that of the initial design`);
    assert.equal(await tab.locator(".figures dd").nth(2).textContent(), `${size}%`);
    await tab.close();
  }
}

// A figure of which the page knows nothing but its row in the list of figures is in the summary with the words of that
// row; in a copy of the page, which is given one.
export async function checkUnknownFigure(browser, made, folder) {
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

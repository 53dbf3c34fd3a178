// The page of a study: its points, the shares of its axes, its maps of two axes.
import assert from "node:assert/strict";
import { number, same } from "./see.mjs";
import { checkCharts } from "./tables.mjs";

// Every point has a row, its name leads to its result, and the row says what the result says.
export async function checkPoints(tab, page, made) {
  const rows = tab.locator("#points tbody tr");
  assert.equal(await rows.count(), page.study);
  for (const i of [0, Math.floor(page.study / 2), page.study - 1]) {
    const file = decodeURIComponent(await rows.nth(i).locator("a").getAttribute("href"));
    const summary = JSON.parse(made.hifdm("show", file, "--json"));
    const cell = (label) => rows.nth(i).locator(`[data-label^="${label}"]`).textContent();
    assert.equal(await cell("Status"), "done");
    same(number(await cell("ψ form")), 1e3 * summary.form.psi_m, 5);
    same(number(await cell("Tension ratio, boundary")), summary.form.boundary_tension_ratio, 5);
  }
  // the best point is on top and marked; a heading sorts; a figure with one value is a sentence and no column
  const psi = tab.locator("#points thead button", { hasText: "ψ form" });
  const column = (await tab.locator("#points thead th").allTextContents()).findIndex((t) => t.startsWith("ψ form"));
  const shown = async () =>
    (await tab.locator(`#points tbody tr > :nth-child(${column + 1})`).allTextContents()).map(number);
  const all = await shown();
  assert.equal(await tab.locator("#points tr.chosen").count(), 1);
  assert.equal(all[0], Math.min(...all));
  await psi.click();
  assert.deepEqual(
    (await shown()).slice(1),
    all.slice(1).sort((a, b) => b - a),
  );
  assert.match(await tab.locator("#sweep > p.same").innerText(), /At all points: tension ratio, inner cables 1[.;]/);
  assert.equal(await tab.locator("#points thead th", { hasText: "inner" }).count(), 0);
  await checkShares(tab, made.study);
  await checkHeat(tab, made.study);
}

// The shares of the axes in the variance of psi, from the points themselves: in a product of axes those of its means.
async function checkShares(tab, study) {
  const mean = (v) => v.reduce((sum, x) => sum + x, 0) / v.length,
    variance = (v) => mean(v.map((x) => x * x)) - mean(v) ** 2;
  const said = await tab.locator("#sweep > p").first().innerText(),
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

// Objectives have units, psi is there once, the surface and the as-built net have charts and columns, the best is
// marked.
export async function checkSurfaceOfStudy(tab, study) {
  await checkCharts(tab, 6, "#sweep", /pretension [\d.]+ N/);
  const leading = (await tab.locator("#points thead th").allTextContents()).join("; ");
  assert.ok(!/ψ|RMS|Objective/.test(leading), `figures that nothing requires: ${leading}`);
  await tab.locator("#points button", { hasText: "show all columns" }).click();
  const titles = await tab.locator("#sweep .chart h3").allTextContents(),
    heads = (await tab.locator("#points thead th").allTextContents()).join("; "),
    text = await tab.locator("body").innerText();
  assert.ok(titles.includes("Surface error ψ, form"), titles.join("; ")); // the optimum's is met, and left out
  assert.ok(titles.includes("Objective tension tie") && !titles.includes("Objective psi"), titles.join("; "));
  assert.match(text, /The page does not list the objective psi separately, because this objective equals ψ\./);
  const ticks = await tab.locator("#sweep .chart svg[tabindex] text[text-anchor=middle]:not(.label)").allTextContents();
  assert.ok(
    ticks.every((t) => /^\d+$/.test(t)),
    `whole values, but ticks ${ticks.join("; ")}`,
  );
  assert.match(text, /All points have EA boundary 200000 N/);
  assert.ok(!/Fig\.|Chen/.test(text), "a study of one's own speaks of the paper");
  const errors = ["RMS of facets (mm)", "RMS of facets, fitted (mm)", "Loss at 10 GHz, refocused feed (dB)"],
    wanted = ["Objective tension tie (N)", ...errors, "Verdict"];
  for (const head of wanted) assert.ok(heads.includes(head), `${head} is not in ${heads}`);
  const values = study.output.find(({ stage }) => stage === "tolerance").psi_95_m,
    best = tab.locator("#points tr.chosen");
  same(number(await best.locator('[data-label^="ψ of 95"]').textContent()), 1e3 * values[study.best], 5);
  assert.equal(await best.locator('[data-label="Verdict"]').textContent(), study.verdict_text[study.best]);
  assert.match(await tab.locator("dl.figures").first().innerText(), /points pass/i);
  const rms = study.output.find(({ stage }) => stage === "refine").facet_half_path_rms_m[study.best];
  same(number(await best.locator('[data-label="RMS of facets (mm)"]').textContent()), 1e3 * rms, 5);
  const word = study.verdict[study.best] === "pass" ? "best point" : "closest point"; // best only if it passes
  assert.ok((await tab.locator("#sweep .chart .legend").first().innerText()).includes(word));
  await tab.reload();
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

// The required figures are those of the result and have columns, as long as nobody asks for others. Their charts have
// lines at their bounds.
async function checkRequired(tab, study, row, requirements) {
  const wanted = ["tension of tie, 90 % of samples: at least 2 N", "psi, 50 % of samples: at most 0.37 mm"],
    texts = (await tab.locator("#points thead th").allTextContents()).map((text) => text.replaceAll("\u00a0", " "));
  for (const head of [...wanted, "slack_cables: at most 0"]) assert.ok(texts.includes(head), `${head}: ${texts}`);
  assert.ok(!texts.some((text) => /ψ/.test(text)), `${texts}`);
  for (const q of requirements) {
    const value = await row.locator(`[data-label^="${q.figure}"]`).textContent();
    same(number(value), (q.unit === "m" ? 1e3 : 1) * q.value, 4);
  }
  const drawn = tab.locator("#sweep .chart", { has: tab.locator("h3", { hasText: "tension of tie" }) });
  for (const chart of await drawn.all()) {
    assert.match(await chart.locator(".legend").innerText(), /at least 2\sN/);
    const level = chart.locator('svg[tabindex] line.curve[stroke-dasharray="7 3"]');
    assert.equal(await level.getAttribute("y1"), await level.getAttribute("y2"));
  }
}

// Verdicts are those of the results: in the table, and in the picture of the smallest margin. The best point passes, or
// none does, and the page says so.
export async function checkVerdicts(tab, page, made) {
  const { study } = made,
    rows = tab.locator("#points tbody tr"),
    seen = new Map(); // by id: verdict and smallest relative margin
  for (let r = 0; r < page.study; r++) {
    const row = rows.nth(r),
      link = row.locator("a"),
      summary = JSON.parse(made.hifdm("show", decodeURIComponent(await link.getAttribute("href")), "--json"));
    const least = Math.min(...summary.requirements.map((q) => q.relative_margin).filter((v) => v !== null)),
      n = summary.requirements.filter((q) => q.verdict === summary.verdict).length,
      words = summary.verdict === "pass" ? "pass" : `${summary.verdict} (${n} of ${summary.requirements.length})`;
    assert.equal(await row.locator('[data-label="Verdict"]').textContent(), words);
    const margin = number(await row.locator('[data-label^="Smallest margin"]').textContent());
    assert.ok(Math.abs(margin - 100 * least) < 0.051);
    if (r % 4 === 0) await checkRequired(tab, study, row, summary.requirements);
    seen.set(await link.getAttribute("title"), [summary.verdict, 100 * least]);
  }
  const at = (i) => seen.get(study.id[i]),
    passing = study.id.filter((_, i) => at(i)[0] === "pass").length,
    advice = await tab.locator("p.advice").innerText(),
    figures = await tab.locator("dl.figures").first().innerText();
  assert.ok(figures.includes(`${passing} of ${page.study}`) && /points pass/.test(figures), figures);
  assert.equal(await tab.locator("#points tr.chosen a").getAttribute("title"), study.id[study.best]);
  if (passing) {
    const margins = [...seen.values()].filter(([verdict]) => verdict === "pass").map(([, margin]) => margin);
    assert.equal(at(study.best)[0], "pass");
    assert.equal(at(study.best)[1], Math.max(...margins));
    assert.match(advice, new RegExp(`^${passing} of ${page.study} points pass`));
  } else {
    assert.match(advice, /^No point passes.*The verdict on the closest point is: fail \(1 of 3\)\./);
    assert.match(figures, /closest point, smallest relative margin/);
    assert.ok(!/best/.test(figures), figures);
  }
  if (page.judged === "map") await checkMarginMap(tab, study, at);
  else if (page.judged === "maps") await checkMarginMaps(tab, study, at);
  else await checkMarginLine(tab, study, at);
}

async function checkMarginMap(tab, study, at) {
  const map = tab.locator("#sweep .heat").first(),
    sorted = ({ values }) => [...new Set(values)].sort((a, b) => a - b),
    across = study.input.find(({ name }) => map && name === "form.pretension_N"),
    down = study.input.find((input) => input !== across),
    signs = { pass: ["✓", "passes"], fail: ["✗", "fails"], undecided: ["?", "undecided"] };
  await tab.locator(`#sweep input[name=axis][value="${across.name}"]`).check();
  assert.equal(await map.locator("h3").textContent(), "Smallest relative margin of the requirements");
  assert.equal(await map.locator("td.best").count(), 1);
  for (const [r, y] of sorted(down).reverse().entries())
    for (const [c, x] of sorted(across).entries()) {
      const cell = map.locator("tbody tr").nth(r).locator("td").nth(c),
        [verdict, margin] = at(study.id.findIndex((_, i) => across.values[i] === x && down.values[i] === y)),
        [, value, word] = (await cell.getAttribute("title")).match(/: (\S+) %, (\w+)$/);
      same(number(value), margin, 5);
      assert.equal(word, signs[verdict][1]);
      assert.equal((await cell.textContent())[0], signs[verdict][0]);
    }
}

// Three axes: a map of two for each value of the third, all with the same colours, and each point in the right cell.
// The points are named by their values.
async function checkMarginMaps(tab, study, at) {
  const heat = tab.locator("#sweep .heat").first(),
    sorted = ({ values }) => [...new Set(values)].sort((a, b) => a - b),
    [across, down, third] = study.input;
  await tab.locator(`#sweep input[name=axis][value="${across.name}"]`).check();
  const panels = heat.locator(".scroll");
  assert.equal(await tab.locator("#sweep figure:not(.heat)").count(), 0, "a chart beside the maps");
  assert.deepEqual(await panels.locator("h4").allTextContents(), ["sigma cut 0.02 mm", "sigma cut 0.05 mm"]);
  assert.equal(await heat.locator(".bar").count(), 1);
  const paint = new Map();
  for (const [p, z] of sorted(third).entries())
    for (const [r, y] of sorted(down).reverse().entries())
      for (const [c, x] of sorted(across).entries()) {
        const cell = panels.nth(p).locator("tbody tr").nth(r).locator("td").nth(c),
          i = study.id.findIndex((_, k) => across.values[k] === x && down.values[k] === y && third.values[k] === z),
          [, value] = (await cell.getAttribute("title")).match(/, sigma cut \S+ mm: (\S+) %, \w+$/),
          margin = at(i)[1];
        same(number(value), margin, 5);
        assert.equal(await cell.evaluate((td) => td.classList.contains("best")), i === study.best);
        paint.set(margin, await cell.evaluate((td) => td.style.background));
      }
  const colours = [...paint].sort(([a], [b]) => a - b).map(([, colour]) => colour),
    runs = colours.filter((colour, k) => colour !== colours[k - 1]).length;
  assert.equal(runs, new Set(colours).size, "the colours of the maps differ");
  const link = tab.locator("#points tr.chosen a");
  assert.match(
    await link.getAttribute("aria-label"),
    /^(report|result file): pretension \d+ N, EA inner \d+ N, sigma cut \S+ mm$/,
  );
  assert.match(await link.textContent(), /^(report|result file)$/);
}

async function checkMarginLine(tab, study, at) {
  const chart = tab.locator("#sweep .chart").first();
  assert.equal(await chart.locator("h3").textContent(), "Smallest relative margin of the requirements");
  assert.equal(await tab.locator("#sweep .chart h3", { hasText: "tension of tie" }).count(), 1);
  const legend = await chart.locator(".legend").innerText(),
    words = { pass: "passes", fail: "fails", undecided: "undecided" };
  assert.match(legend, /margin 0/);
  for (const [verdict, word] of Object.entries(words))
    assert.equal(
      legend.includes(word),
      study.id.some((_, i) => at(i)[0] === verdict),
      `${word} in ${legend}`,
    );
  const picture = chart.locator("svg[role=img]");
  await picture.focus();
  await tab.keyboard.press("Home");
  same(number((await chart.locator(".tip td").first().textContent()).trim()), at(0)[1], 5);
}

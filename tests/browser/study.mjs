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
  assert.deepEqual((await shown()).slice(1), all.slice(1).sort((a, b) => b - a));
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
  const titles = await tab.locator("#sweep .chart h3").allTextContents(),
    heads = (await tab.locator("#points thead th").allTextContents()).join("; "),
    text = await tab.locator("body").innerText();
  assert.ok(titles.includes("Surface error ψ, form"), titles.join("; ")); // the optimum's is met, and left out
  assert.ok(titles.includes("Objective tension tie") && !titles.includes("Objective psi"), titles.join("; "));
  assert.match(text, /The page does not list the objective psi separately, because this objective equals ψ\./);
  const ticks = await tab.locator("#sweep .chart svg[tabindex] text[text-anchor=middle]:not(.label)").allTextContents();
  assert.ok(ticks.every((t) => /^\d+$/.test(t)), `whole values, but ticks ${ticks.join("; ")}`);
  assert.match(text, /All points have EA boundary 200000 N/);
  assert.ok(!/Fig\.|Chen/.test(text), "a study of one's own speaks of the paper");
  const errors = ["RMS of facets (mm)", "RMS of facets, fitted (mm)", "1 dB gain loss (GHz)"],
    wanted = ["Objective tension tie (N)", ...errors, "Yield", "Meets required yield"];
  for (const head of wanted) assert.ok(heads.includes(head), `${head} is not in ${heads}`);
  const values = study.output.find(({ stage }) => stage === "tolerance").psi_95_m,
    best = tab.locator("#points tr.chosen");
  assert.equal(study.best, values.indexOf(Math.min(...values)));
  same(number(await best.locator('[data-label^="ψ of 95"]').textContent()), 1e3 * Math.min(...values), 5);
  assert.equal(await best.locator('[data-label="Meets required yield"]').textContent(), study.meets_yield[study.best]);
  assert.match(await tab.locator("dl.figures").first().innerText(), /points with a yield of 90\u00a0?\s?%/i);
  const rms = study.output.find(({ stage }) => stage === "refine").facet_half_path_rms_m[study.best];
  same(number(await best.locator('[data-label="RMS of facets (mm)"]').textContent()), 1e3 * rms, 5);
  assert.match(await tab.locator("#sweep .chart .legend").first().innerText(), /best point/);
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

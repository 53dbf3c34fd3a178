// A result beside another one.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { changes, csv, DATA, number, openCopy, same } from "./see.mjs";

// Both results are named by their files: in the title, in the headline of each, in columns, pictures and legends.
async function checkNames(tab, made, other) {
  assert.equal(await tab.locator("h1").textContent(), "result.h5 and other.h5");
  assert.equal(await tab.title(), "result.h5 and other.h5");
  const answers = await tab.locator(".answer").allTextContents(),
    said = ["result.h5", "other.h5"].map((file) =>
      made.hifdm("show", file).split("\n").find((line) => /^psi /.test(line)),
    );
  assert.equal(answers.length, 2);
  assert.ok(answers[0].startsWith(`result.h5: P${said[0].slice(1)}.`), answers[0]);
  assert.ok(answers[1].startsWith(`other.h5: P${said[1].slice(1)}.`), answers[1]);
  const labels = async (place) => (await tab.locator(place).allTextContents()).map((text) => text.trim()),
    shapes = ["result.h5: form", "result.h5: search", "result.h5: refine", "other.h5: refine"];
  assert.deepEqual((await labels("#net fieldset:first-child label")).slice(1), shapes);
  assert.deepEqual(await labels("#map fieldset:first-child label"), shapes);
  assert.deepEqual(await labels("#tensions .chart:first-child .legend > span"), shapes);
  assert.deepEqual(await labels("#compare thead th"), [
    ...["Quantity", "result.h5: refine", "other.h5: refine", "change to other.h5", "Unit"],
  ]);
  const heads = await labels("h2");
  assert.ok(heads.includes("result.h5: Summary") && heads.includes("Tensions"), heads.join("; "));
  const alike = await tab.evaluate(() => fileNames(["/runs/a/x.h5", "/runs/b/x.h5"]));
  assert.deepEqual(alike, ["…/a/x.h5", "…/b/x.h5"]);
  const text = await tab.locator("body").innerText();
  assert.ok(!/\b(this|other) result\b|\bthis:|\bother:/.test(text));
}

// Figures of both results, what differs in their cases, and the tensions of both in the table of cables.
export async function checkOther(tab, page, made) {
  const other = JSON.parse(made.hifdm("show", "other.h5", "--json")),
    row = tab.locator("#compare tr", { hasText: "surface error ψ" }),
    [a, b, change] = (await row.locator("td").allTextContents()).map(number);
  same(a, 1e3 * made.summary.refine.psi_m, 5);
  same(b, 1e3 * other.refine.psi_m, 5);
  await checkNames(tab, made, other);
  assert.equal(change, Number((1e3 * (other.refine.psi_m - made.summary.refine.psi_m)).toFixed(4)));
  const lines = await tab.locator("#compare .differences li").allTextContents();
  assert.deepEqual(lines, ["+ optimize.method=lm", "+ form.pretension_N=10.5"]);
  made.hifdm("export", "other.h5", "--csv", ".", "--force");
  const theirs = new Map(csv(join(made.folder, "cables.csv")).map((c) => [c.id, Number(c.tension_N)])),
    ours = new Map(made.cables.map((c) => [c.id, Number(c.tension_N)]));
  const heads = await tab.locator("#cables thead th").allTextContents(),
    column = heads.indexOf("change to other.h5 (N)");
  const rows = await tab
    .locator("#cables tbody tr")
    .evaluateAll((all) => all.map((r) => [...r.children].map((c) => c.textContent)));
  assert.equal(rows.length, 20);
  for (const cells of rows) {
    const wanted = theirs.get(cells[0]) - ours.get(cells[0]);
    assert.ok(Math.abs(number(cells[column]) - wanted) < 2e-3, `${cells[column]} is shown for ${wanted}`);
  }
  await changes(tab, "the other shape", () => tab.locator("#net").getByLabel("other.h5: refine").check());
  await tab.reload();
}

// Losses of gain stand beside those at the same frequency; cases are compared without comments, and what is left out of
// long ones is said.
export async function checkUnlike(browser, tab, made, folder) {
  const [a, b] = ["result.h5", "other.h5"].map((file) => JSON.parse(made.hifdm("show", file, "--json")).form.surface),
    cells = (at) => tab.locator("#compare tr", { hasText: `gain loss at ${at}` }).first().locator("td");
  const [low, high] = [await cells("0.01 GHz").allTextContents(), await cells("0.05 GHz").allTextContents()];
  same(number(low[0]), a.refocused_gain_loss_dB[0], 3); // by physical optics, which leads
  assert.deepEqual(low.slice(1, 3), ["–", ""]);
  same(number(high[0]), a.refocused_gain_loss_dB[1], 3);
  same(number(high[1]), b.refocused_gain_loss_dB[0], 3);
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
  assert.ok((await said("a: 1 # one\n# two\n", "  # three\na: 1 # one\n")).includes("two case files are identical"));
  assert.ok((await said("a: 1\n", "a: 2\n")).includes("+ a: 2"));
  for (const end of ["", "b: 2\n"]) {
    const text = await said(long, `${end}${long}`);
    assert.ok(text.includes("only the first 600 lines") && !text.includes("are identical"), text);
  }
}

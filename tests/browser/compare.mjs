// A result beside another one.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { changes, csv, DATA, number, openCopy, same } from "./see.mjs";

// Figures of both results, what differs in their cases, and the tensions of both in the table of cables.
export async function checkOther(tab, page, made) {
  const other = JSON.parse(made.hifdm("show", "other.h5", "--json")),
    row = tab.locator("#compare tr", { hasText: "surface error ψ" }),
    [a, b, change] = (await row.locator("td").allTextContents()).map(number);
  same(a, 1e3 * made.summary.search.psi_m, 5);
  same(b, 1e3 * other.refine.psi_m, 5);
  assert.equal(change, Number((1e3 * (other.refine.psi_m - made.summary.search.psi_m)).toFixed(4)));
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

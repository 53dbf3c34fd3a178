// Parts of a page that only some results have.
import assert from "node:assert/strict";
import { picture } from "./see.mjs";

// Nodes whose deviations are rounding have one colour, and the page says so; another shape of the page has a scale. Of
// the two nets in space only the front counts.
export async function checkRounding(tab) {
  for (const name of ["rear", "rear edge", "tie"])
    await tab.locator("#families").getByLabel(name, { exact: true }).uncheck();
  for (const [part, canvas] of [
    ["#net", "net-canvas"],
    ["#map", "map-canvas"],
  ]) {
    const bar = tab.locator(`${part} .bar`),
      colours = async (name) => {
        await tab.locator(part).getByLabel(name, { exact: true }).check();
        return (await picture(tab, canvas)).colours;
      };
    const one = await colours("LM optimum");
    assert.match(await bar.innerText(), /within 1 nm of theory, .* one neutral colour\.$/);
    const many = await colours("found");
    assert.ok(!(await bar.innerText()).includes("1 nm"));
    assert.ok(many > one + 20, `${part}: ${one} colours of rounding, ${many} of deviations`);
  }
  await tab.reload();
}

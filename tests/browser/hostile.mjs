// Hostile texts: in every text of the data of a page, longer than any that the program writes.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { DATA, openCopy, settle } from "./see.mjs";

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
    Object.assign(study, { advice: HOSTILE, ranked_by: HOSTILE, tightest: every(), verdict_text: every() });
    if (study.replicates) study.replicates.scatter = HOSTILE;
    study.input[0].name = HOSTILE;
    study.input.push({ name: HOSTILE, texts: every().map((text, i) => text + (i % 2)) });
    return data;
  }
  data.net.node_id = data.net.node_id.map(() => HOSTILE);
  data.net.cable_id = data.net.cable_id.map(() => HOSTILE);
  if (data.other) {
    Object.assign(data.other, { answer: HOSTILE, case_text: [HOSTILE], overrides: [`${HOSTILE}\n${HOSTILE}`] });
    Object.assign(data.other.summary, { file: HOSTILE, version: HOSTILE });
    data.other.summary.form.status = HOSTILE;
  }
  if (data.summary.tolerance) data.summary.tolerance.cable_share.forEach((row) => (row.cable = HOSTILE));
  data.provenance = data.provenance.map((line) => line + HOSTILE);
  Object.assign(data.summary, { file: HOSTILE, case: HOSTILE, version: HOSTILE, warnings: [HOSTILE, HOSTILE] });
  data.figures.push({ key: "made_up_N", units: HOSTILE, description: HOSTILE });
  data.summary.form.made_up_N = 1.25;
  return data;
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
export async function checkHostile(browser, made, folder) {
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

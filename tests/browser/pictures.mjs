// The net in space and the map over the aperture: what is drawn, what is under the pointer, what keys and switches do.
import assert from "node:assert/strict";
import { changes, number, picture, same, settle, tip } from "./see.mjs";

// Where families can be switched off they are first: from above, a rear net lies under the front one.
export async function checkHover(tab, page, made) {
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
    same(number(about["to target position"]), 1e3 * distance_m, 5);
  }
  await tab.mouse.move(box.x - 5, box.y - 5);
  await tab.getByRole("button", { name: "View from above" }).click();
  assert.equal(await tip(tab, "net"), null);
  for (const name of page.off || []) await tab.locator("#families").getByLabel(name, { exact: true }).check();
}

export async function checkNet(tab, page, made) {
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
  for (const label of ["tension", "slack", "none", "target", page.other ? "result.h5: form" : "form"])
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

// A load case over the nominal net: its cables are drawn in its colour where its displacements from the shape put them,
// enlarged by the factor that the page states, which draws them as at most a twentieth of the net.
export async function checkOverlay(tab) {
  const box = tab.locator("#overlay label").first(),
    name = (await box.textContent()).trim(),
    net = tab.locator("#net"),
    choose = (label) => net.locator(`fieldset:not(#overlay) label:text-is("${label}") input`).check();
  await choose("none");
  await net.getByLabel("target positions").uncheck();
  const middles = async (label) => {
    await choose(label);
    await settle(tab);
    return tab.evaluate(() =>
      Array.from({ length: 20 }, (_, k) => report.net.screenOf("cable", Math.floor((k * net.n_cable) / 20))),
    );
  };
  const case_ = await middles(name),
    form = await middles("form");
  await changes(tab, "the load case over the net", () => box.locator("input").check());
  const note = await net.locator("figcaption").textContent(),
    said = note.match(/Displacements from this shape, enlarged ([\d\u202f]+) times: (.*)\. To rotate/),
    factor = Number(said[1].replaceAll("\u202f", ""));
  assert.equal(said[2].trim(), name);
  const [scale, most_m, radius_m] = await tab.evaluate(() => {
    const { state, radius } = report.net,
      move = state.overlay[0].displacement_m.map((v, k) => v - state.shape.displacement_m[k]);
    return [state.scale, Math.max(...move.map(Math.abs)), radius];
  });
  assert.ok(factor * most_m <= 0.1 * radius_m && factor * most_m > 0.03 * radius_m, `${factor} times ${most_m} m`);
  const places = form.map((at, k) => at.map((v, i) => v + (factor / scale) * (case_[k][i] - v)));
  const hits = await tab.evaluate((all) => {
    const canvas = document.getElementById("net-canvas"),
      copy = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height }),
      c = copy.getContext("2d", { willReadFrequently: true });
    c.fillStyle = css(report.net.state.overlay[0].colour);
    const colour = [1, 3, 5].map((k) => parseInt(c.fillStyle.slice(k, k + 2), 16));
    c.drawImage(canvas, 0, 0);
    const isHit = ([x, y]) => {
      const { data: pixel } = c.getImageData(Math.round(x) - 2, Math.round(y) - 2, 5, 5);
      return Array.from({ length: 25 }, (_, k) => pixel.slice(4 * k, 4 * k + 3)).some((rgb) =>
        rgb.every((v, k) => Math.abs(v - colour[k]) < 40),
      );
    };
    return all.filter(isHit).length;
  }, places);
  assert.equal(hits, places.length, "cables of the load case are elsewhere");
  await changes(tab, "the load case off the net", () => box.locator("input").uncheck());
  assert.ok(!(await net.locator("figcaption").textContent()).includes("Displacements from"));
  await tab.reload();
}

export async function checkMap(tab, made) {
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
export async function checkFacets(tab, page, made) {
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

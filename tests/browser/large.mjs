// The page of a net of 10^4 nodes: how soon it is there, and is it fluid when the net is turned? In lines of many
// colours, which are slower than those of one.
import assert from "node:assert/strict";
import { settle } from "./see.mjs";

const LOADED_MS = 3000, // three times what it takes; the rest is for slower machines
  FRAME_MS = 1000 / 60,
  BUSY_MOST_MS = 0.4 * FRAME_MS, // the rest is for slower machines
  FRAMES = 60,
  ROUNDS = 5; // the best counts: other programs run, too

// In the page: drags the picture for so many frames. The median of what a frame takes.
async function turn(frames) {
  const canvas = document.getElementById("net-canvas"),
    box = canvas.getBoundingClientRect(),
    frame = () => new Promise(requestAnimationFrame),
    between = [];
  canvas.setPointerCapture = () => {}; // no pointer of the system takes part
  const send = (type, k) => {
    const [clientX, clientY] = [box.left + 300 + 2 * k, box.top + 200 + (k % 30)];
    canvas.dispatchEvent(new PointerEvent(type, { pointerId: 1, clientX, clientY, buttons: 1, bubbles: true }));
  };
  send("pointerdown", 0);
  let last = await frame();
  for (let k = 1; k <= frames; k++) {
    send("pointermove", k);
    const now = await frame(); // asked for after that of the picture, so called after it
    between.push(now - last);
    last = now;
  }
  send("pointerup", frames);
  return { frame_ms: between.sort((a, b) => a - b)[Math.floor(between.length / 2)] };
}

// Processor time of the page's thread while it does something: its scripts, and what the browser draws for it, which
// is all of it where there is no graphics card.
async function busyWhile(tab, act) {
  const session = await tab.context().newCDPSession(tab),
    busy_s = async () =>
      (await session.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
  await session.send("Performance.enable", { timeDomain: "threadTicks" });
  const before_s = await busy_s(),
    result = await act();
  const busy_ms = 1e3 * ((await busy_s()) - before_s);
  await session.detach();
  return { ...result, busy_ms };
}

export async function checkFluid(tab, url) {
  let loaded_ms = Infinity,
    best = { frame_ms: Infinity, busy_ms: Infinity };
  for (let k = 0; k < ROUNDS && loaded_ms > LOADED_MS / 2; k++) {
    await tab.goto(url);
    await settle(tab); // the pictures are drawn
    loaded_ms = Math.min(loaded_ms, await tab.evaluate("performance.now()"));
  }
  await tab.locator("#net").getByLabel("tension", { exact: true }).check();
  await tab.locator("#net-canvas").scrollIntoViewIfNeeded();
  const isFluid = () => best.frame_ms < 1.05 * FRAME_MS && best.busy_ms < BUSY_MOST_MS;
  for (let k = 0; k < ROUNDS && !isFluid(); k++) {
    const { frame_ms, busy_ms } = await busyWhile(tab, () => tab.evaluate(turn, FRAMES));
    if (busy_ms / FRAMES < best.busy_ms) best = { frame_ms, busy_ms: busy_ms / FRAMES };
  }
  const said =
    `all drawn after ${loaded_ms.toFixed(0)} ms; turned, a frame takes ${best.frame_ms.toFixed(1)} ms, ` +
    `${best.busy_ms.toFixed(1)} ms of them of the processor`;
  assert.ok(loaded_ms < LOADED_MS && isFluid(), said);
  return said;
}

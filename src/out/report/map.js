// Contents: faces of the net along z, cables on the map, the map.

// ---- faces: the cables at every node are sorted by direction; the next side of a face is the cable before the one on
// which the walk arrives ----

function findFaces(cables) {
  const p = net.position_m,
    out = Array.from({ length: net.n_node }, () => []),
    faces = [];
  for (const e of cables) {
    const a = net.end[2 * e],
      b = net.end[2 * e + 1];
    out[a].push({ to: b });
    out[b].push({ to: a });
  }
  const angle = (a, b) => Math.atan2(p[3 * b + 1] - p[3 * a + 1], p[3 * b] - p[3 * a]);
  out.forEach((list, a) => list.sort((s, t) => angle(a, s.to) - angle(a, t.to)));
  for (let a = 0; a < net.n_node; a++)
    for (const first of out[a]) {
      const face = [];
      for (let from = a, side = first; !side.done;) {
        side.done = true;
        face.push(from);
        const list = out[side.to],
          back = list.findIndex((s) => s.to === from);
        from = side.to;
        side = list[(back + list.length - 1) % list.length];
      }
      const area = face.reduce((sum, i, k) => {
        const j = face[(k + 1) % face.length];
        return sum + p[3 * i] * p[3 * j + 1] - p[3 * j] * p[3 * i + 1];
      }, 0);
      if (face.length > 2 && area > 0) faces.push(face);
    }
  return faces;
}

// ---- cables on the map: with facets only their nodes, the supports of these nodes and the cables between them; a rear
// net and its ties are behind the facets ----

function mapParts() {
  const every = Array.from({ length: net.n_cable }, (_, e) => e),
    on = new Uint8Array(net.n_node);
  if (!net.facets) return { cables: every, on: on.fill(1) };
  for (const i of net.facets) on[i] = 1;
  const ends = (e) => [net.end[2 * e], net.end[2 * e + 1]];
  const cables = every.filter(
    (e) => ends(e).some((i) => on[i]) && ends(e).every((i) => on[i] || digit(net.role, i) === 0),
  );
  for (const e of cables) for (const i of ends(e)) on[i] = 1;
  return { cables, on };
}

// ---- the map ----

function aperture({ canvas, tip, bar }) {
  const state = { shape: resultShape, quantity: "distance" };
  const p = net.position_m,
    n = net.n_node,
    { cables, on } = mapParts(),
    faces = findFaces(cables),
    facets = Array.from({ length: (net.facets || []).length / 4 }, (_, k) => [
      ...new Set(net.facets.slice(4 * k, 4 * k + 4)),
    ]),
    left = 58,
    bottom = 44,
    top = 30,
    right = 14;
  const spans = [0, 1].map((k) => range(p.filter((_, i) => i % 3 === k)));
  const across = spans[1][1] - spans[1][0] > spans[0][1] - spans[0][0] ? 1 : 0,
    up = 1 - across; // the longer axis is horizontal
  const box = [spans[across], spans[up]];
  const sx = new Float64Array(n),
    sy = new Float64Array(n);
  let queued = false;

  const ofFacets = () => ({ normal: "facet_normal_mean_m", fit: "facet_fit_normal_mean_m" })[state.quantity];
  function values() {
    if (ofFacets()) return state.shape[ofFacets()].map((v) => 1e3 * v);
    return state.quantity === "distance" ? state.shape.distance_mm : state.shape.height_mm;
  }
  const isRounding = () => limits()[1] < RESOLVED_MM;
  const colours = () => (isRounding() ? neutral : state.quantity === "distance" ? sequential : diverging);
  function limits() {
    const size = ofFacets() ? Math.max(...(range(values().map(Math.abs)) || [0, 1])) || 1 : innerMost(values());
    return state.quantity === "distance" ? [0, size] : [-size, size];
  }

  // Fills a triangle with colours of values that are linear between its corners.
  function triangle(image, ratio, table, limit, [a, b, c]) {
    const [ax, ay, av] = a,
      [bx, by, bv] = b,
      [cx, cy, cv] = c,
      { width, height, data: pixel } = image;
    const det = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay);
    if (!det) return;
    const low = (v, u, w) => Math.floor(Math.min(u, v, w) * ratio),
      high = (v, u, w) => Math.ceil(Math.max(u, v, w) * ratio);
    for (let j = Math.max(0, low(ay, by, cy)); j <= Math.min(height - 1, high(ay, by, cy)); j++)
      for (let i = Math.max(0, low(ax, bx, cx)); i <= Math.min(width - 1, high(ax, bx, cx)); i++) {
        const x = (i + 0.5) / ratio - ax,
          y = (j + 0.5) / ratio - ay;
        const s = (x * (cy - ay) - y * (cx - ax)) / det,
          t = (y * (bx - ax) - x * (by - ay)) / det;
        if (s < -1e-9 || t < -1e-9 || s + t > 1 + 1e-9) continue;
        const colour = table[levelOf(av + s * (bv - av) + t * (cv - av), limit)],
          k = 4 * (j * width + i);
        pixel[k] = colour[0];
        pixel[k + 1] = colour[1];
        pixel[k + 2] = colour[2];
        pixel[k + 3] = 255;
      }
  }

  function paintFaces(c, ratio) {
    const image = c.createImageData(canvas.width, canvas.height),
      v = values(),
      table = levels(colours()),
      limit = limits();
    for (const face of faces) {
      const middle = [0, 0, 0];
      for (const i of face)
        [sx[i], sy[i], v[i]].forEach((q, k) => {
          middle[k] += q / face.length;
        });
      face.forEach((i, k) => {
        const j = face[(k + 1) % face.length];
        triangle(image, ratio, table, limit, [middle, [sx[i], sy[i], v[i]], [sx[j], sy[j], v[j]]]);
      });
    }
    c.putImageData(image, 0, 0);
  }

  // Fills each facet with one colour. Its border has the same colour, so that there is no gap between neighbours.
  function paintFacets(c) {
    const table = levels(colours()),
      limit = limits(),
      v = values();
    c.lineWidth = 0.6;
    facets.forEach((facet, k) => {
      if (!Number.isFinite(v[k])) return;
      c.fillStyle = c.strokeStyle = rgb(table[levelOf(v[k], limit)]);
      c.beginPath();
      for (const i of facet) c.lineTo(sx[i], sy[i]);
      c.closePath();
      c.fill();
      c.stroke();
    });
  }

  // Draws a disc at every node, for a net without closed faces.
  function paintNodes(c) {
    const table = levels(colours()),
      limit = limits(),
      v = values();
    for (let i = 0; i < n; i++) {
      if (!on[i]) continue;
      c.fillStyle = rgb(table[levelOf(v[i], limit)]);
      c.beginPath();
      c.arc(sx[i], sy[i], 8, 0, 7);
      c.fill();
    }
  }

  function paintNet(c) {
    c.strokeStyle = css("--ink");
    c.globalAlpha = 0.28;
    c.lineWidth = 0.7;
    c.beginPath();
    for (const e of cables) {
      c.moveTo(sx[net.end[2 * e]], sy[net.end[2 * e]]);
      c.lineTo(sx[net.end[2 * e + 1]], sy[net.end[2 * e + 1]]);
    }
    c.stroke();
    c.globalAlpha = 1;
    const side = n > 1000 ? 1 : 2.5;
    c.fillStyle = css("--ink");
    for (let i = 0; i < n; i++)
      if (on[i] && digit(net.role, i) === 0) c.fillRect(sx[i] - side, sy[i] - side, 2 * side, 2 * side);
  }

  function paintAxes(c, width, height, toX, toY) {
    c.fillStyle = c.strokeStyle = css("--soft");
    c.font = "12px system-ui, sans-serif";
    c.textAlign = "center";
    for (const t of linearTicks(box[0][0], box[0][1], 6)) c.fillText(t.text, toX(t.at), height - bottom + 20);
    c.textAlign = "right";
    c.textBaseline = "middle";
    for (const t of linearTicks(box[1][0], box[1][1], 6)) c.fillText(t.text, toX(box[0][0]) - 12, toY(t.at));
    c.fillStyle = css("--ink");
    c.textAlign = "center";
    c.fillText("xy"[across] + " (m)", (toX(box[0][0]) + toX(box[0][1])) / 2, height - 10);
    c.textAlign = "left";
    c.fillText("xy"[up] + " (m)", Math.max(2, toX(box[0][0]) - 54), toY(box[1][1]) - 16);
  }

  function draw() {
    queued = false;
    const width = canvas.clientWidth,
      height = canvas.clientHeight,
      c = canvas.getContext("2d");
    if (!width || !height) return;
    const ratio = printing.matches ? 3 : Math.max(1, devicePixelRatio || 1);
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
    const span = box.map(([a, b]) => b - a || 1);
    const fit = Math.min((width - left - right) / span[0], (height - top - bottom) / span[1]);
    const x0 = left + (width - left - right - fit * span[0]) / 2,
      y0 = height - bottom;
    const toX = (x) => x0 + fit * (x - box[0][0]),
      toY = (y) => y0 - fit * (y - box[1][0]);
    for (let i = 0; i < n; i++) {
      sx[i] = toX(p[3 * i + across]);
      sy[i] = toY(p[3 * i + up]);
    }
    if (!ofFacets()) paintFaces(c, ratio);
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    if (ofFacets()) paintFacets(c);
    paintNet(c);
    if (!faces.length && !ofFacets()) paintNodes(c);
    paintAxes(c, width, height, toX, toY);
    if (isRounding())
      return bar.replaceChildren(roundingNote(ofFacets() ? 0 : outerMost(state.shape.distance_mm, on)));
    drawBar(
      bar,
      colours(),
      limits(),
      {
        distance: "distance to target position (mm)",
        height: "height above target, Δz (mm)",
        normal: "above the target surface (mm)",
        fit: "above the best fit (mm)",
      }[state.quantity],
      range(ofFacets() ? values() : values().filter((_, i) => on[i])),
    );
  }
  const redraw = () => {
    if (!queued) requestAnimationFrame(draw);
    queued = true;
  };

  const middleOf = (facet, s) => facet.reduce((sum, i) => sum + s[i] / facet.length, 0);
  // Returns whether a point is inside a convex facet: all sides then turn the same way around it.
  function isInside(facet, x, y) {
    const turns = facet.map((i, k) => {
      const j = facet[(k + 1) % facet.length];
      return (sx[j] - sx[i]) * (y - sy[i]) - (sy[j] - sy[i]) * (x - sx[i]);
    });
    return turns.every((t) => t >= 0) || turns.every((t) => t <= 0);
  }
  function tellFacet(x, y) {
    const k = facets.findIndex((facet) => isInside(facet, x, y));
    if (k < 0) {
      tip.hidden = true;
      return;
    }
    const mm = (values) => (Number.isFinite(values[k]) ? `${fmt(1e3 * values[k], 4)} mm` : "–"),
      { facet_normal_mean_m: mean, facet_normal_rms_m: rms, facet_fit_normal_mean_m: fit } = state.shape;
    placeTip(
      tip,
      middleOf(facets[k], sx),
      middleOf(facets[k], sy),
      tipContent(`facet ${facets[k].map((i) => net.node_id[i]).join(", ")}`, [
        ["along the normal, mean", mm(mean), ""],
        ["RMS", mm(rms), ""],
        ["above the best fit, mean", mm(fit), ""],
      ]),
    );
  }

  canvas.addEventListener("pointermove", (event) => {
    const frame = canvas.getBoundingClientRect(),
      x = event.clientX - frame.left,
      y = event.clientY - frame.top;
    if (ofFacets()) return tellFacet(x, y);
    let best = -1,
      nearest = 24;
    for (let i = 0; i < n; i++) {
      if (!on[i]) continue;
      const d = Math.hypot(sx[i] - x, sy[i] - y);
      if (d < nearest) [nearest, best] = [d, i];
    }
    if (best < 0) {
      tip.hidden = true;
      return;
    }
    placeTip(
      tip,
      sx[best],
      sy[best],
      tipContent(`node ${net.node_id[best]}`, [
        ["to target position", `${fmt(state.shape.distance_mm[best], 5)} mm`, ""],
        ["height, Δz", `${fmt(state.shape.height_mm[best], 5)} mm`, ""],
      ]),
    );
  });
  canvas.addEventListener("pointerleave", () => {
    tip.hidden = true;
  });
  new ResizeObserver(redraw).observe(canvas);
  darkScheme.addEventListener("change", redraw);
  printing.addEventListener("change", draw);
  addEventListener("beforeprint", draw);
  addEventListener("afterprint", redraw);
  const facetAt = (k) => [middleOf(facets[k], sx), middleOf(facets[k], sy)];
  return { state, redraw, facetAt };
}

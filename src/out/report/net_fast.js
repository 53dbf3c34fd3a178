// Draws lines of one pixel directly into the pixels of a picture. While a large net is turned, this takes a fraction of
// the time of strokes, which a browser smooths one by one.

// Cuts the line p + t d, t within `part` = [t0, t1], to 0..end. Returns false when nothing is left.
function cutLine(part, p, d, end) {
  if (d === 0) return p >= 0 && p <= end;
  const a = -p / d,
    b = (end - p) / d;
  part[0] = Math.max(part[0], Math.min(a, b));
  part[1] = Math.min(part[1], Math.max(a, b));
  return part[0] <= part[1];
}

// Returns a picture of width x height pixels of a context, with functions to draw lines and to show it.
function linePicture(c, width, height) {
  const image = c.createImageData(width, height),
    pixels = new Uint32Array(image.data.buffer),
    part = new Float64Array(2),
    lastX = width - 1,
    lastY = height - 1,
    bytes = new Uint8Array(4),
    word = new Uint32Array(bytes.buffer);

  // Returns the pixel of a colour of the style. The context parses any notation of it.
  function pixelOf(colour) {
    c.fillStyle = colour;
    const text = c.fillStyle; // #rrggbb
    bytes.set([1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)));
    bytes[3] = 255;
    return word[0];
  }
  function line(pixel, ax, ay, bx, by) {
    let dx = bx - ax,
      dy = by - ay;
    if (ax < 0 || bx < 0 || ay < 0 || by < 0 || ax > lastX || bx > lastX || ay > lastY || by > lastY) {
      part[0] = 0;
      part[1] = 1;
      if (!cutLine(part, ax, dx, lastX) || !cutLine(part, ay, dy, lastY)) return;
      ax += part[0] * dx;
      ay += part[0] * dy;
      dx *= part[1] - part[0];
      dy *= part[1] - part[0];
    }
    const steps = Math.ceil(Math.max(Math.abs(dx), Math.abs(dy))) || 1;
    dx /= steps;
    dy /= steps;
    for (let k = 0; k <= steps; k++) {
      pixels[((ay + 0.5) | 0) * width + ((ax + 0.5) | 0)] = pixel;
      ax += dx;
      ay += dy;
    }
  }
  // Draws the lines from..to between the screen positions x, y of their ends.
  function lines(colour, from, to, first, second, { x, y }) {
    const pixel = pixelOf(colour);
    for (let k = from; k < to; k++) line(pixel, x[first[k]], y[first[k]], x[second[k]], y[second[k]]);
  }
  return { width, height, clear: () => pixels.fill(0), lines, show: () => c.putImageData(image, 0, 0) };
}

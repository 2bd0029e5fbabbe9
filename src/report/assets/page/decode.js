"use strict";

/** Bytes of base64. */
function bytes(text) {
  const raw = atob(text);
  const out = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i);
  return out;
}

/** What gzip packed, of base64. */
function unpacked(text) {
  const stream = new Blob([bytes(text.trim())]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Response(stream).arrayBuffer();
}

/** 32-bit floats of base64; numbers stay as they are. */
function floats(values) {
  return typeof values === "string" ? new Float32Array(bytes(values).buffer) : values;
}

/** Values of a matrix of levels as an axis shows them; NaN in gaps. A number in place of the text means that matrix of the page. */
function matrix(z, axis, shared) {
  const text = typeof z.levels === "number" ? shared[z.levels] : z.levels;
  const steps = new Uint16Array(bytes(text).buffer);
  const step = (z.high - z.low) / 65534;
  const table = new Float64Array(65536).fill(NaN);
  for (let k = 1; k < 65536; k++) {
    const u = z.low + (k - 1) * step;
    const v = z.log ? 10 ** u : u;
    table[k] = axis.reference ? 20 * Math.log10(Math.abs(v) / axis.reference) : (axis.factor ?? 1) * v;
  }
  return Float64Array.from(steps, (k) => table[k]);
}

/** The least and the largest of each of so many parts of a row, in their order: what a pixel can show. */
function decimated(x, y, parts) {
  const n = x.length;
  if (n <= 2 * parts) return [x, y];
  const xs = [], ys = [];
  for (let p = 0; p < parts; p++) {
    const from = Math.floor((p * n) / parts), to = Math.floor(((p + 1) * n) / parts);
    let least = from, most = from;
    for (let i = from; i < to; i++) {
      if (y[i] < y[least] || Number.isNaN(y[least])) least = i;
      if (y[i] > y[most] || Number.isNaN(y[most])) most = i;
    }
    for (const i of least < most ? [least, most] : [most, least]) {
      xs.push(x[i]);
      ys.push(y[i]);
    }
  }
  return [xs, ys];
}

/** A number to so many digits, without zeros at its end. */
function digits(value, most = 6) {
  if (!Number.isFinite(value)) return "–";
  return String(Number(value.toPrecision(most))).replace("-", "−");
}

/** A value with its standard uncertainty to two digits of that. */
function estimate(value, std) {
  if (!(std > 0)) return digits(value);
  const power = Math.floor(Math.log10(std)) - 1;
  const places = Math.max(0, -power);
  if (places > 12 || Math.abs(value) > 1e9) return `${digits(value)} ± ${digits(std, 2)}`;
  return `${value.toFixed(places)} ± ${std.toFixed(places)}`.replaceAll("-", "−");
}

/** Borders half-way between places, for the cells around them. */
function borders(places) {
  const n = places.length;
  if (n === 1) return [places[0] - 0.5, places[0] + 0.5];
  const out = [places[0] - (places[1] - places[0]) / 2];
  for (let i = 1; i < n; i++) out.push((places[i - 1] + places[i]) / 2);
  out.push(places[n - 1] + (places[n - 1] - places[n - 2]) / 2);
  return out;
}

/** Index of the place nearest to a value; places rise. */
function nearest(places, value) {
  let low = 0, high = places.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (places[middle] > value) high = middle;
    else low = middle;
  }
  return value - places[low] < places[high] - value ? low : high;
}

const VIRIDIS = [
  [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
];

/** Colour of a place from 0 to 1 on the map viridis. */
function viridis(part) {
  const at = Math.min(Math.max(part, 0), 1) * (VIRIDIS.length - 1);
  const k = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const mix = (c) => Math.round(VIRIDIS[k][c] + (at - k) * (VIRIDIS[k + 1][c] - VIRIDIS[k][c]));
  return `rgb(${mix(0)},${mix(1)},${mix(2)})`;
}

if (typeof module !== "undefined") module.exports = { bytes, unpacked, floats, matrix, decimated, digits, estimate, borders, nearest, viridis };

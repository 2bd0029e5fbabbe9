"use strict";

/** Colours of the page as it is shown now. */
function theme(element) {
  const style = getComputedStyle(element);
  const of = (name) => style.getPropertyValue(name).trim();
  return { ink: of("--ink"), faint: of("--faint"), paper: of("--paper"), font: `12px ${style.fontFamily}` };
}

/** Relative luminance of a colour #rrggbb (WCAG 2). */
function luminance(parts) {
  const [r, g, b] = parts.map((v) => (v <= 10.31475 ? v / 3294.6 : ((v / 255 + 0.055) / 1.055) ** 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

/** Least contrast of a line with a dark page. */
const CONTRAST = 4.5;

/** A colour of print as the page shows it: on a dark page black is white, greys are as far from the paper as in print, and dark colours are lightened. */
function onPage(colour, ink) {
  if (colour === "#000000") return ink;
  if (ink <= "#8") return colour;
  let parts = [1, 3, 5].map((k) => parseInt(colour.slice(k, k + 2), 16));
  if (parts.every((v) => v === parts[0])) parts = parts.map((v) => 255 - v);
  // The dark paper, #16181a, has a luminance of 0.009.
  while (luminance(parts) + 0.05 < CONTRAST * 0.059) parts = parts.map((v) => Math.round(v + 0.08 * (255 - v)));
  return `rgb(${parts.join(",")})`;
}

/** A button with a text. */
function button(text, title, action) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.title = title;
  made.addEventListener("click", action);
  return made;
}

/** A tick's number, as a power of ten where it has many zeros. */
function short(value) {
  const size = Math.abs(value);
  if (size === 0 || (size >= 1e-3 && size < 1e6)) return digits(value, 10);
  const power = Math.floor(Math.log10(size) + 1e-9), raised = String(power).replace(/./g, (c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻");
  const first = digits(value / 10 ** power, 4);
  return first === "1" ? `10${raised}` : `${first}×10${raised}`;
}

/** Least length in pixels of a decade that has ticks between its powers, and of one that has numbers at them. */
const DECADE = 40, NUMBERED = 70;

/** Ticks of a logarithmic axis: all multiples of its powers of ten, on a short one even steps; powers alone, or every second or third of them, where `room` pixels for a decade hold no more. */
function logTicks(low, high, room) {
  const decades = Math.log10(high / low), ticks = [];
  if (decades < 0.7) {
    const size = 10 ** Math.floor(Math.log10((high - low) / 3));
    const step = [5, 2, 1].map((k) => k * size).find((s) => s <= (high - low) / 3) ?? size;
    for (let i = Math.ceil(low / step); i * step <= high; i++) ticks.push(Number((i * step).toPrecision(12)));
    return ticks;
  }
  const stride = Math.max(1, Math.ceil(18 / room));
  for (let power = stride * Math.floor(Math.log10(low) / stride); power <= Math.log10(high); power += stride) {
    for (let k = 1; k < (room < DECADE ? 2 : 10); k++) ticks.push(Number(`${k}e${power}`));
  }
  return ticks.filter((tick) => tick >= low && tick <= high);
}

/** What an axis has at its ticks: on a logarithmic one of more than a few, only 1, 2 and 5 times a power of ten have numbers, or the powers alone. */
function marks(log) {
  if (!log) return { values: (_, ticks) => ticks.map((v) => (v == null ? "" : short(v))) };
  const first = (v) => Math.round(v / 10 ** Math.floor(Math.log10(v) + 1e-9));
  // Pixels of a decade.
  const room = ({ bbox }, axis, low, high) => Math.max(1, (axis ? bbox.height : bbox.width) / devicePixelRatio / Math.log10(high / low));
  const splits = (plot, axis, low, high) => logTicks(low, high, room(plot, axis, low, high));
  const values = (plot, ticks, axis) => {
    const { min, max } = plot.scales[axis ? "y" : "x"], few = ticks.at(-1) < 5 * ticks[0];
    const named = few || max < 30 * min || room(plot, axis, min, max) >= NUMBERED ? [1, 2, 5] : [1];
    return ticks.map((v) => (v != null && (few || named.includes(first(v))) ? short(v) : ""));
  };
  return { values, splits, filter: (_, ticks) => ticks };
}

/** Paths of markers of half width `s` around points. */
const MARKERS = {
  circle: (c, x, y, s) => { c.moveTo(x + s, y); c.arc(x, y, s, 0, 7); },
  square: (c, x, y, s) => c.rect(x - 0.9 * s, y - 0.9 * s, 1.8 * s, 1.8 * s),
  triangle: (c, x, y, s) => corners(c, x, y, s, [[0, -1.3], [1.2, 0.85], [-1.2, 0.85]]),
  limit: (c, x, y, s) => corners(c, x, y, s, [[0, 1.3], [1.2, -0.85], [-1.2, -0.85]]),
  diamond: (c, x, y, s) => corners(c, x, y, s, [[0, -1.3], [1.2, 0], [0, 1.3], [-1.2, 0]]),
  cross: (c, x, y, s) => strokes(c, x, y, s, [[-1.2, 0, 1.2, 0], [0, -1.2, 0, 1.2]]),
  saltire: (c, x, y, s) => strokes(c, x, y, s, [[-0.9, -0.9, 0.9, 0.9], [-0.9, 0.9, 0.9, -0.9]]),
  star: (c, x, y, s) => { MARKERS.cross(c, x, y, s); MARKERS.saltire(c, x, y, s); },
};

function corners(c, x, y, s, points) {
  points.forEach(([dx, dy], k) => c[k ? "lineTo" : "moveTo"](x + dx * s, y + dy * s));
  c.closePath();
}

function strokes(c, x, y, s, lines) {
  for (const [x0, y0, x1, y1] of lines) {
    c.moveTo(x + x0 * s, y + y0 * s);
    c.lineTo(x + x1 * s, y + y1 * s);
  }
}

/** Draws one marker of a name. */
function mark(c, name, x, y, s, colour) {
  const open = name.startsWith("open-");
  const path = MARKERS[open ? name.slice(5) : name];
  c.beginPath();
  if (!path) {
    c.fillStyle = colour;
    c.fillText(name, x, y);
    return;
  }
  // As in print, an open one shows around a filled one.
  path(c, x, y, open ? 1.3 * s : s);
  c.fillStyle = colour;
  if (!open) c.fill();
  c.stroke();
}

/** Series over two axes: uPlot has axes, zoom and cursor; what is drawn in the frame is drawn here, since motions turn back along the abscissa. */
class Plot {
  constructor(host, panel, height, shared, spectra = () => null) {
    this.host = host;
    this.panel = panel;
    this.shared = shared;
    this.spectra = spectra;
    this.height = height;
    this.series = panel.series.map((s) => ({
      ...s, x: floats(s.x), y: floats(s.y), low: floats(s.low), high: floats(s.high), std: floats(s.std ?? []), hidden: false,
    }));
    if (panel.map) {
      const { x, y, z, key } = panel.map;
      const values = matrix(z, key, shared);
      this.map = { ...panel.map, x: floats(x), y: floats(y), z: key.classes ? values.map(Math.round) : values };
    }
    this.log = panel.y.log;
    this.tools();
    this.frame = document.createElement("div");
    this.tip = document.createElement("div");
    this.tip.className = "tip";
    this.tip.setAttribute("role", "status");
    this.below = document.createElement("div");
    this.keys = document.createElement("code");
    host.append(this.frame, this.tip, this.keys, this.below);
    this.build();
  }

  /** Buttons above, and names that switch their series. */
  tools() {
    const bar = document.createElement("div");
    bar.className = "tools";
    if (this.panel.title) {
      const title = document.createElement("b");
      title.textContent = this.panel.title;
      bar.append(title);
    }
    for (const series of this.series.filter((s) => s.name && !["vertical", "horizontal"].includes(s.shape))) {
      if (series.shape === "heading") {
        const heading = document.createElement("span");
        heading.textContent = series.name;
        bar.append(heading);
        continue;
      }
      const alike = this.series.filter((s) => s.name === series.name && s.shape === series.shape);
      if (alike[0] !== series) continue;
      const name = button(series.name, "Show or hide", () => {
        const hidden = !series.hidden;
        alike.forEach((s) => (s.hidden = hidden));
        name.setAttribute("aria-pressed", String(!series.hidden));
        this.plot.redraw();
      });
      name.setAttribute("aria-pressed", "true");
      name.className = "name";
      name.prepend(this.key(series));
      bar.append(name);
    }
    for (const [k, name] of (this.panel.map?.key.classes ?? []).entries()) {
      const entry = document.createElement("span");
      const box = document.createElement("i");
      box.style.background = this.panel.map.key.colours[k];
      box.className = "box";
      entry.append(box, name);
      bar.append(entry);
    }
    if (this.map && !this.map.key.classes) bar.append(this.scale());
    const any = (holds) => this.series.some((s) => s.y.some(holds));
    const { title, reference } = this.panel.y;
    if (any((v) => v > 0) && !any((v) => v < 0) && !this.panel.map && reference === null && !title.endsWith("(°)")) {
      this.switch = button(this.log ? "linear" : "log", "Scale of the ordinate", () => {
        this.log = !this.log;
        this.switch.textContent = this.log ? "linear" : "log";
        this.build();
      });
      bar.append(this.switch);
    }
    bar.append(button("reset", "Show all (or click twice in the figure)", () => this.build()));
    this.host.append(bar);
  }

  /** The colours of a map with the ends of their scale. */
  scale() {
    const { key } = this.map, entry = document.createElement("span"), strip = document.createElement("i");
    const stops = Array.from({ length: 9 }, (_, k) => viridis(k / 8));
    strip.className = "strip";
    strip.style.background = `linear-gradient(to right, ${stops.join(",")})`;
    entry.append(`${key.title}: ${digits(key.low, 3)} `, strip, ` ${digits(key.high, 3)}`);
    return entry;
  }

  /** The row of a map under the cursor, as a curve below it. */
  slice(r) {
    if (this.row === r) return;
    this.row = r;
    const n = this.map.x.length, { key } = this.map;
    const data = [this.map.x, this.map.z.slice(r * n, (r + 1) * n)];
    if (this.curve) {
      this.curve.setData(data, false);
      this.curve.redraw();
    } else this.lower(data, this.panel.x, key);
  }

  /** The spectrum that a point of a sweep is taken from, as a curve below the figure. */
  spectrum() {
    const [series, i] = this.under ?? [], waterfall = series && this.spectra(series.name);
    if (!waterfall || this.plot.select.width > 0) return;
    const frequency = floats(waterfall.frequency), excitation = floats(waterfall.excitation), n = frequency.length;
    const away = excitation.map((f) => Math.abs(f - series.x[i])), r = away.indexOf(away.reduce((a, b) => Math.min(a, b)));
    const least = 1e-5 * waterfall.up.high, { title } = waterfall.up;
    const values = matrix(waterfall.z, waterfall.up, this.shared).slice(r * n, (r + 1) * n).map((v) => Math.max(v, least));
    this.lower([frequency, values], waterfall.x, { title, log: true, low: least, high: 2 * waterfall.up.high });
    this.tip.textContent = `${series.name}: spectrum at ${digits(excitation[r])} Hz, below`;
  }

  /** Draws a curve below the figure, in place of an earlier one. */
  lower(data, x, y) {
    this.curve?.destroy();
    const { ink, faint, font } = theme(this.host);
    const axis = { stroke: ink, font, labelFont: font, labelSize: 22, grid: { stroke: faint, width: 1 }, ticks: { show: false } };
    this.curve = new uPlot({
      width: this.plot.width, height: 240, legend: { show: false }, cursor: { show: false },
      scales: {
        x: { time: false, range: [x.low, x.high] },
        y: { distr: y.log ? 3 : 1, range: [y.low, y.high] },
      },
      axes: [{ ...axis, size: 34, label: x.title }, { ...axis, size: 58, label: y.title, ...marks(y.log) }],
      series: [{}, { stroke: onPage("#0072b2", ink), width: 1.2, points: { show: false } }],
    }, data, this.below);
  }

  /** A sample of a series' look. */
  key(series) {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height, canvas.className] = [52, 28, "key"];
    const c = canvas.getContext("2d"), { ink } = theme(this.host);
    this.pen(c, series, ink, 2);
    if (series.joined) {
      c.beginPath();
      c.moveTo(2, 14);
      c.lineTo(50, 14);
      c.stroke();
    }
    c.setLineDash([]);
    if (series.shape === "points") mark(c, series.look.marker, 26, 14, 8, c.strokeStyle);
    c.globalAlpha = series.shape === "band" ? 0.3 : 0.5;
    if (series.shape === "band" || series.shape === "bars") c.fillRect(4, 4, 44, 20);
    return canvas;
  }

  pen(c, series, ink, ratio) {
    const { colour, width, dashes } = series.look;
    c.strokeStyle = onPage(colour, ink);
    c.fillStyle = c.strokeStyle;
    c.lineWidth = 1.3 * width * ratio;
    c.setLineDash(dashes.map((d) => 1.3 * d * ratio));
  }

  build() {
    this.plot?.destroy();
    const { x, y } = this.panel, { ink, faint, font } = theme(this.host);
    const positive = this.series.flatMap((s) => Array.from(s.y).filter((v) => v > 0));
    const least = positive.reduce((a, b) => Math.min(a, b), Infinity);
    // Room above and below that a linear axis has and a logarithmic one has not.
    const room = this.log && !y.log ? 1.6 : 1;
    const ends = [(this.log && !(y.low > 0) ? Math.max(least, y.high * 1e-9) : y.low) / room, y.high * room];
    const scale = (all, log) => ({
      time: false, distr: log ? 3 : 1,
      range: (_, a, b) => (a == null || b == null || a === b ? all : [a, b]),
    });
    const rule = (axis, size, log) => ({
      label: axis.title, labelSize: 22, size, stroke: ink, font, labelFont: font, grid: { show: !this.map, stroke: faint, width: 1 },
      ticks: { stroke: faint, width: 1 }, ...marks(log),
    });
    const width = Math.max(this.host.clientWidth, 200);
    this.plot = new uPlot({
      width, height: this.height, legend: { show: false },
      cursor: { drag: { x: true, y: true, uni: 20 }, points: { show: false } },
      scales: { x: scale([x.low, x.high], x.log), y: scale(ends, this.log) },
      axes: [rule(x, 34, x.log), { ...rule(y, width < 420 ? 64 : 70, this.log), ...(y.title.endsWith("(°)") ? { incrs: [5, 15, 45, 90, 180] } : {}) }],
      series: [{}, { paths: () => null, points: { show: false } }],
      hooks: {
        drawClear: [() => this.map && this.cells()],
        draw: [() => this.draw()],
        setCursor: [() => this.point()],
        setScale: [(plot, name) => name === "x" && this.span(plot.scales.x)],
      },
    }, [[x.low, x.high], ends], this.frame);
    if (this.panel.square) this.square(x, y);
    this.plot.over.addEventListener("click", () => {
      this.spectrum();
      this.pick();
    });
  }

  /** The place of a click in a trace with impacts as the keys by which a campaign counts what is higher, and nothing sooner behind an impact. */
  pick() {
    const [trace, impacts] = ["trace", "impacts"].map((name) => this.series.find((s) => s.name === name));
    if (!trace || !impacts?.x.length || this.plot.select.width > 0) return;
    const [t, v] = [this.plot.posToVal(this.plot.cursor.left, "x"), this.plot.posToVal(this.plot.cursor.top, "y")];
    const times = Array.from(impacts.x), ends = times.map((from, k) => from + ((times[k + 1] ?? Infinity) - from) / 4);
    const heights = times.map((from, k) => trace.x.reduce((most, at, i) => (at >= from && at < ends[k] ? Math.max(most, Math.abs(trace.y[i])) : most), 0));
    const height = heights.sort((a, b) => a - b)[Math.floor(heights.length / 2)], last = times.findLast((one) => one < t);
    const keys = [`threshold = ${digits(Math.abs(v) / height, 2)}  # of the median impact: what is lower is none`];
    if (last !== undefined) keys.push(`refractory = ${digits(t - last, 3)}  # s behind an impact: what comes sooner is an echo`);
    this.keys.textContent = keys.join("\n");
  }

  /** The part of a time trace that is shown, as the key by which a campaign uses this part alone. */
  span({ min, max }) {
    const { x } = this.panel, part = max - min < 0.999 * (x.high - x.low), places = Math.max(0, 3 - Math.floor(Math.log10(max - min)));
    this.keys.textContent = x.title === "Time (s)" && part ? `span = [${min.toFixed(places)}, ${max.toFixed(places)}]` : "";
  }

  /** Widens the axis with room to spare, so that both have the same length a unit. */
  square(x, y) {
    const { width, height } = this.plot.bbox, unit = Math.max((x.high - x.low) / width, (y.high - y.low) / height);
    const about = ({ low, high }, length) => ({ min: (low + high - unit * length) / 2, max: (low + high + unit * length) / 2 });
    this.plot.setScale("x", about(x, width));
    this.plot.setScale("y", about(y, height));
  }

  inFrame(drawing) {
    const { ctx, bbox } = this.plot;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    drawing(ctx);
    ctx.restore();
  }

  at(x, y) {
    const of = (v, name, log) => (log && !(v > 0) ? NaN : Number.isNaN(v) ? NaN : this.plot.valToPos(v, name, true));
    return [of(x, "x", this.panel.x.log), of(y, "y", this.log)];
  }

  cells() {
    const { x, y, z, key } = this.map, across = borders(x), up = borders(y);
    const part = (v) => key.log
      ? Math.log(v / key.low) / Math.log(key.high / key.low)
      : (v - key.low) / (key.high - key.low);
    const colour = (v) => (key.classes ? key.colours[v] : viridis(part(v)));
    this.inFrame((c) => {
      const xs = across.map((v) => this.at(v, this.panel.y.low)[0]);
      const ys = up.map((v) => this.at(this.panel.x.low, v)[1]);
      for (let r = 0; r < y.length; r++) {
        for (let k = 0; k < x.length; k++) {
          const v = z[r * x.length + k];
          if (Number.isNaN(v) || xs[k + 1] < 0) continue;
          c.fillStyle = colour(v);
          c.fillRect(Math.floor(xs[k]), Math.floor(ys[r + 1]), Math.ceil(xs[k + 1]) - Math.floor(xs[k]), Math.ceil(ys[r]) - Math.floor(ys[r + 1]));
        }
      }
    });
  }

  draw() {
    const { ink, font } = theme(this.host), ratio = devicePixelRatio;
    this.inFrame((c) => {
      c.textAlign = "left";
      c.textBaseline = "alphabetic";
      c.font = font.replace("12px", `${11 * ratio}px`);
      this.taken = [];
      for (const series of this.series.filter((s) => !s.hidden)) {
        this.pen(c, series, ink, ratio);
        this[series.shape]?.(c, series, ratio);
      }
      c.setLineDash([]);
      c.fillStyle = ink;
      for (const note of this.panel.notes) this.write(c, note.text, this.at(note.x, note.y), 6 * ratio, -1);
    });
  }

  /** Writes a name beside a point. Those of near points stand above each other, or below where `way` is 1. */
  write(c, text, [x, y], gap, way) {
    const { left, top, width, height } = this.plot.bbox, tall = 13 * devicePixelRatio, wide = c.measureText(text).width;
    const begins = x + (x > left + 0.6 * width ? -gap - wide : gap);
    let foot = y - gap;
    const over = (one) => begins < one.ends && one.begins < begins + wide && Math.abs(foot - one.foot) < tall;
    while (this.taken.some(over) && (way < 0 ? foot > top + tall : foot < top + height - tall)) foot += way * tall;
    this.taken.push({ begins, ends: begins + wide, foot });
    c.fillText(text, begins, foot);
  }

  line(c, series) {
    c.beginPath();
    let pen = false;
    for (let i = 0; i < Math.min(series.x.length, series.y.length); i++) {
      const [x, y] = this.at(series.x[i], series.y[i]);
      const is = Number.isFinite(x) && Number.isFinite(y);
      if (is) c[pen ? "lineTo" : "moveTo"](x, y);
      pen = is;
    }
    c.stroke();
  }

  points(c, series, ratio) {
    if (series.joined) this.line(c, series);
    c.setLineDash([]);
    c.lineWidth = ratio;
    const size = ratio * 3.4 * Math.min(1, Math.max(0.5, Math.sqrt(60 / series.x.length)));
    c.beginPath();
    for (let i = 0; i < series.low.length; i++) {
      const [x, a] = this.at(series.x[i], series.low[i]), b = this.at(series.x[i], series.high[i])[1];
      if (!Number.isFinite(x + b) || Number.isNaN(series.low[i])) continue;
      c.moveTo(x, Number.isFinite(a) ? a : 1e5);
      c.lineTo(x, b);
    }
    c.stroke();
    const colour = c.strokeStyle;
    for (let i = 0; i < series.x.length; i++) {
      const [x, y] = this.at(series.x[i], series.y[i]);
      if (Number.isFinite(x + y)) mark(c, series.look.marker, x, y, size, colour);
    }
  }

  band(c, series) {
    c.globalAlpha = 0.3;
    c.beginPath();
    for (let i = 0; i < series.x.length; i++) c.lineTo(...this.at(series.x[i], series.high[i]));
    for (let i = series.x.length - 1; i >= 0; i--) {
      const [x, y] = this.at(series.x[i], series.low[i]);
      c.lineTo(x, Number.isFinite(y) ? y : 1e5);
    }
    c.fill();
    c.globalAlpha = 1;
  }

  bars(c, series) {
    c.globalAlpha = 0.5;
    const zero = this.at(0, 0)[1];
    for (let i = 0; i < series.y.length; i++) {
      const [a, y] = this.at(series.x[i], series.y[i]), b = this.at(series.x[i + 1], 0)[0];
      c.fillRect(a, y, b - a, (Number.isFinite(zero) ? zero : 1e5) - y);
    }
    c.globalAlpha = 1;
  }

  vertical(c, series, ratio) {
    this.reference(c, series, [series.x[0], null], ratio);
  }

  horizontal(c, series, ratio) {
    this.reference(c, series, [null, series.y[0]], ratio);
  }

  reference(c, series, [x, y], ratio) {
    const { left, top, width, height } = this.plot.bbox;
    c.beginPath();
    if (y === null) {
      const at = this.plot.valToPos(x, "x", true);
      c.moveTo(at, top);
      c.lineTo(at, top + height);
      this.write(c, series.name, [at, top + 15 * ratio], 3 * ratio, 1);
    } else {
      const at = this.plot.valToPos(y, "y", true);
      c.moveTo(left, at);
      c.lineTo(left + width, at);
      c.fillText(series.name, left + 4 * ratio, at - 3 * ratio);
    }
    c.stroke();
  }

  /** Says what lies under the cursor. */
  point() {
    const { left, top } = this.plot.cursor;
    if (!(left >= 0)) {
      this.tip.textContent = "";
      return;
    }
    const [x, y] = [this.plot.posToVal(left, "x"), this.plot.posToVal(top, "y")];
    if (this.map) {
      const k = nearest(this.map.x, x), r = nearest(this.map.y, y), v = this.map.z[r * this.map.x.length + k];
      const value = this.map.key.classes ? this.map.key.classes[v] ?? "–" : `${this.map.key.title}: ${digits(v, 4)}`;
      if (!this.map.key.classes) this.slice(r);
      this.tip.textContent = `${this.panel.x.title}: ${digits(this.map.x[k])}, ${this.panel.y.title}: ${digits(this.map.y[r])}, ${value}`;
      return;
    }
    let best = null, least = 40;
    for (const series of this.series.filter((s) => !s.hidden && s.y.length > 1)) {
      for (let i = 0; i < Math.min(series.x.length, series.y.length); i++) {
        const distance = Math.hypot(this.plot.valToPos(series.x[i], "x") - left, this.plot.valToPos(series.y[i], "y") - top);
        if (distance < least) [best, least] = [[series, i], distance];
      }
    }
    this.under = best;
    if (!best) {
      this.tip.textContent = `${this.panel.x.title}: ${digits(x, 5)}, ${this.panel.y.title}: ${digits(y, 4)}`;
      return;
    }
    const [series, i] = best, std = series.std[i] ?? NaN;
    const name = series.name ? `${series.name}: ` : "";
    const picks = series.name === "trace" && this.series.some((s) => s.name === "impacts");
    const click = this.spectra(series.name) ? " (click: its spectrum)" : picks ? " (click: threshold and dead time of this place)" : "";
    this.tip.textContent = `${name}${this.panel.x.title} ${digits(series.x[i])}, ${this.panel.y.title} ${estimate(series.y[i], std)}${click}`;
  }
}

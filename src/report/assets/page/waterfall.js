"use strict";

/** Parts of a spectrum while it is turned. */
const COARSE = 100;

/** Spectra behind each other that can be turned: by dragging, or with the arrow keys. */
class Waterfall {
  constructor(host, panel, height, shared) {
    this.host = host;
    this.panel = panel;
    this.x = floats(panel.frequency);
    this.depth = floats(panel.excitation);
    this.z = matrix(panel.z, panel.up, shared);
    this.level = false;
    [this.turn, this.tilt] = [0.28, 0.5];
    const bar = document.createElement("div");
    bar.className = "tools";
    this.switch = button("dB", "Height linear or as level", () => {
      this.level = !this.level;
      this.switch.textContent = this.level ? "linear" : "dB";
      this.prepare();
    });
    bar.append(this.switch, button("reset", "First view", () => {
      [this.turn, this.tilt] = [0.28, 0.5];
      this.draw();
    }));
    this.canvas = document.createElement("canvas");
    this.canvas.tabIndex = 0;
    this.canvas.className = "turn";
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Waterfall; turn it with the arrow keys");
    this.canvas.style.height = `${height}px`;
    this.tip = document.createElement("div");
    this.tip.className = "tip";
    this.tip.setAttribute("role", "status");
    host.append(bar, this.canvas, this.tip);
    this.listen();
    this.prepare();
  }

  listen() {
    const canvas = this.canvas;
    let from = null;
    canvas.addEventListener("pointerdown", (e) => {
      from = [e.clientX, e.clientY, this.turn, this.tilt];
      canvas.setPointerCapture(e.pointerId);
    });
    canvas.addEventListener("pointerup", () => (from = null));
    canvas.addEventListener("pointermove", (e) => {
      if (from) this.view(from[2] + (e.clientX - from[0]) / 600, from[3] + (from[1] - e.clientY) / 600);
      else this.point(e.offsetX, e.offsetY);
    });
    canvas.addEventListener("pointerleave", () => {
      this.marked = null;
      this.tip.textContent = "";
      this.draw();
    });
    const keys = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
    canvas.addEventListener("keydown", (e) => {
      const way = keys[e.key];
      if (!way) return;
      e.preventDefault();
      this.view(this.turn + 0.04 * way[0], this.tilt + 0.04 * way[1]);
    });
  }

  view(turn, tilt) {
    this.turn = Math.min(Math.max(turn, -0.6), 0.6);
    this.tilt = Math.min(Math.max(tilt, 0.1), 0.8);
    if (this.waits) return;
    this.waits = requestAnimationFrame(() => {
      this.waits = 0;
      this.draw(true);
      clearTimeout(this.rests);
      this.rests = setTimeout(() => this.draw(), 120);
    });
  }

  /** Brings the spectra to the unit cube, with no more points than the canvas has columns. */
  prepare() {
    const { x, up, depth } = this.panel, n = this.x.length;
    const parts = Math.max(100, Math.round(this.canvas.clientWidth || 600));
    const top = up.log ? Math.log10(up.high) : up.high;
    const height = this.level
      ? (v) => 1 + Math.log10(v / (up.log ? up.high : top)) / 3
      : (v) => (up.log ? (Math.log10(v) - Math.log10(up.low)) / (top - Math.log10(up.low)) : (v - up.low) / (top - up.low));
    this.rows = Array.from(this.depth, (at, r) => {
      const seen = [], heights = [];
      for (let k = 0; k < n; k++) {
        const across = (this.x[k] - x.low) / (x.high - x.low), v = this.z[r * n + k];
        if (across < 0 || across > 1 || Number.isNaN(v)) continue;
        seen.push(across);
        heights.push(Math.min(1, Math.max(0, height(v) || 0)));
      }
      const [xs, ys] = decimated(seen, heights, parts), turning = decimated(seen, heights, COARSE);
      return { at: (at - depth.low) / (depth.high - depth.low), excitation: at, top: heights.reduce((a, b) => Math.max(a, b), 0), xs, ys, turning };
    }).sort((a, b) => a.at - b.at);
    this.draw();
  }

  /** Where a point of the cube lies on the canvas. */
  project(x, depth, up) {
    const { width, height } = this.size, back = this.turn, slant = this.tilt;
    const w = width * (1 - Math.abs(back)) - 90, left = 56 + Math.max(0, -back) * width;
    const rise = (height - 64) * this.stretch;
    return [left + x * w + depth * back * width, height - 42 - (depth * slant + up * (1 - slant)) * rise];
  }

  /** Draws all spectra; while it is turned with fewer points. */
  draw(turning = false) {
    const canvas = this.canvas, ratio = devicePixelRatio, { ink, faint, font } = theme(this.host);
    this.size = { width: canvas.clientWidth || 600, height: canvas.clientHeight || 360 };
    [canvas.width, canvas.height] = [this.size.width * ratio, this.size.height * ratio];
    // All is drawn so high that it fills the canvas.
    const top = (row) => row.at * this.tilt + row.top * (1 - this.tilt);
    this.stretch = 1 / Math.max(this.tilt, 0.3, ...this.rows.map(top));
    const c = canvas.getContext("2d");
    c.scale(ratio, ratio);
    c.font = font;
    this.axes(c, ink, faint);
    c.lineJoin = "round";
    // From the front to the back: what lies below the horizon of those before it is hidden.
    const horizon = new Float32Array(Math.ceil(this.size.width) + 2).fill(Infinity);
    c.strokeStyle = ink;
    c.lineWidth = 0.8;
    c.beginPath();
    for (const row of this.rows) {
      if (row !== this.marked) this.visible(c, row, turning, horizon);
      else {
        c.stroke();
        c.beginPath();
        c.strokeStyle = "#d55e00";
        this.visible(c, row, turning, horizon);
        c.lineWidth = 2;
        c.stroke();
        c.beginPath();
        [c.strokeStyle, c.lineWidth] = [ink, 0.8];
      }
    }
    c.stroke();
  }

  /** The parts of a spectrum above the horizon, which it raises. */
  visible(c, row, turning, horizon) {
    const [xs, ys] = turning ? row.turning : [row.xs, row.ys], n = xs.length;
    const [x0, y0] = this.project(0, row.at, 0), [x1, y1] = [this.project(1, row.at, 0)[0], this.project(0, row.at, 1)[1]];
    let pen = false, before = -1, last = 0;
    for (let i = 0; i < n; i++) {
      const x = x0 + xs[i] * (x1 - x0), y = y0 + ys[i] * (y1 - y0), column = Math.max(0, Math.round(x));
      const seen = y <= horizon[column] + 0.2;
      if (seen) {
        if (pen) c.lineTo(x, y);
        else c.moveTo(x, y);
      } else if (pen) c.lineTo(x, horizon[column]);
      pen = seen;
      // Columns between two points have the line between them.
      for (let k = before < 0 ? column : before + 1; k <= column; k++) {
        const at = before < 0 || column === before ? y : last + ((y - last) * (k - before)) / (column - before);
        if (at < horizon[k]) horizon[k] = at;
      }
      if (column === before && y < horizon[column]) horizon[column] = y;
      [before, last] = [column, y];
    }
  }

  axes(c, ink, faint) {
    const { x, depth, up } = this.panel;
    c.strokeStyle = faint;
    c.fillStyle = ink;
    c.lineWidth = 1;
    const edge = (a, b) => {
      c.beginPath();
      c.moveTo(...this.project(...a));
      c.lineTo(...this.project(...b));
      c.stroke();
    };
    for (const depths of [0, 1]) edge([0, depths, 0], [1, depths, 0]);
    for (const across of [0, 1]) edge([across, 0, 0], [across, 1, 0]);
    edge([0, 0, 0], [0, 0, 1]);
    const ticks = (low, high) => {
      const raw = (high - low) / 5, power = 10 ** Math.floor(Math.log10(raw));
      const step = power * [1, 2, 5, 10].find((s) => s * power >= raw), out = [];
      for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) out.push(v);
      return out;
    };
    c.textAlign = "center";
    for (const v of ticks(x.low, x.high)) {
      const [px, py] = this.project((v - x.low) / (x.high - x.low), 0, 0);
      c.fillText(digits(v, 4), px, py + 15);
    }
    const [mx, my] = this.project(0.5, 0, 0);
    c.fillText(x.title, mx, my + 33);
    c.textAlign = this.turn < 0 ? "right" : "left";
    const side = this.turn < 0 ? 0 : 1, away = this.turn < 0 ? -6 : 6;
    for (const v of ticks(depth.low, depth.high)) {
      const [px, py] = this.project(side, (v - depth.low) / (depth.high - depth.low), 0);
      c.fillText(digits(v, 4), px + away, py + 4);
    }
    c.textAlign = "left";
    c.fillText(`${depth.title}, to the back`, 4, 14);
    c.textAlign = "right";
    const [ux, uy] = this.project(0, 0, 1);
    if (this.level) {
      c.textAlign = "left";
      c.fillText(`60 dB below ${digits(up.high, 3)} (${up.title})`, 4, uy - 10);
    }
    if (!this.level) for (const v of ticks(up.low, up.high)) {
      const [px, py] = this.project(0, 0, up.log ? Math.log10(v / up.low) / Math.log10(up.high / up.low) : (v - up.low) / (up.high - up.low));
      c.fillText(digits(v, 4), px - 6, py + 4);
    }
    if (!this.level) {
      c.textAlign = "left";
      c.fillText(up.title, Math.max(ux - 52, 4), uy - 10);
    }
  }

  /** Marks the spectrum under the pointer. */
  point(px, py) {
    let best = null, least = 25;
    for (const row of this.rows) {
      for (let i = 0; i < row.xs.length; i++) {
        const [x, y] = this.project(row.xs[i], row.at, row.ys[i]);
        const distance = Math.hypot(x - px, y - py);
        if (distance <= least) [best, least] = [[row, i], distance];
      }
    }
    if (best?.[0] !== this.marked) {
      this.marked = best?.[0] ?? null;
      this.draw();
    }
    if (!best) {
      this.tip.textContent = "";
      return;
    }
    const { x, depth, up } = this.panel, [row, i] = best, frequency = x.low + row.xs[i] * (x.high - x.low);
    const k = nearest(this.x, frequency), r = this.depth.indexOf(row.excitation);
    this.tip.textContent =
      `${depth.title} ${digits(row.excitation)}, ${x.title} ${digits(this.x[k])}, ${up.title} ${digits(this.z[r * this.x.length + k], 4)}`;
  }
}

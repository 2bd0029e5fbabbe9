"use strict";

/** Parameters of a rig with their units, in the order in which the model takes them; those on a scale by factors may be so many times larger or smaller. */
const PARAMETERS = [
  { key: "m1", name: "mass 1", unit: "kg", factor: 4 },
  { key: "m2", name: "mass 2", unit: "kg", factor: 4 },
  { key: "k1", name: "spring 1", unit: "N/m", factor: 4 },
  { key: "k2", name: "spring 2", unit: "N/m", factor: 4 },
  { key: "c1", name: "damper 1", unit: "N s/m", factor: 10 },
  { key: "c2", name: "damper 2", unit: "N s/m", factor: 10 },
  { key: "gap", name: "gap", unit: "m", low: 0 },
  { key: "restitution", name: "restitution", unit: "", low: 0, high: 1 },
  { key: "force", name: "force", unit: "N", factor: 10 },
  { key: "stiffness", name: "contact stiffness", unit: "N/m", powers: [3, 8] },
];

/** Steps of a slider. */
const STEPS = 1000;

/** The model, compiled from the same code as the program: numbers in, numbers out. */
class Model {
  constructor(exports) {
    this.exports = exports;
  }

  /** Asks a function of the module with the parameters and what is asked. */
  ask(name, values, asked) {
    const { memory, input, output } = this.exports;
    new Float64Array(memory.buffer, input(), 16).set([...values, ...asked]);
    const n = this.exports[name]();
    return new Float64Array(memory.buffer, output(), n).slice();
  }

  /** Amplitudes over frequency: rows of 8. */
  response(values, from, to, points) {
    return this.ask("response", values, [from, to, points]);
  }

  /** The motion that is reached from rest: rows of 5. */
  motion(values, frequency) {
    return this.ask("motion", values, [frequency]);
  }
}

const column = (rows, wide, k) => Float64Array.from({ length: rows.length / wide }, (_, i) => rows[i * wide + k]);
const INK = "#000000", MASSES = ["#0072b2", "#d55e00"];
const look = (colour, dashes = [], marker = "circle") => ({ colour, width: 1.1, dashes, marker });

/** Sliders for a rig, the curves that it would then give over what was measured, and its motion at one frequency. */
class WhatIf {
  constructor(host, start, model) {
    this.model = model;
    this.start = start;
    this.values = PARAMETERS.map(({ key }) => start.rig[key] ?? start[key] ?? 0);
    this.frequency = start.frequency;
    const controls = document.createElement("div");
    controls.className = "sliders";
    this.sliders = PARAMETERS.map((parameter, k) => this.slider(controls, parameter, k));
    this.sliders.push(this.slider(controls, { key: "frequency", name: "frequency of the motion below", unit: "Hz" }, null));
    this.panels = document.createElement("div");
    this.panels.className = "panels";
    this.toml = document.createElement("pre");
    const tools = document.createElement("div");
    tools.className = "tools";
    tools.append(button("reset", "The values of the campaign", () => this.reset()), button("copy TOML", "Copy the values for a campaign", async () => {
      try {
        await navigator.clipboard.writeText(this.toml.textContent);
      } catch {
        getSelection().selectAllChildren(this.toml);
      }
    }));
    host.replaceChildren(controls, tools, this.panels, this.toml);
    const columns = host.clientWidth < 700 ? 1 : 2, axis = (title, low, high, log = false) => ({ title, low, high, log });
    this.panels.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
    const place = (title, x, y, series) => {
      const cell = document.createElement("div");
      this.panels.append(cell);
      return new Plot(cell, { kind: "plot", title, x, y, series, notes: [], map: null }, 300, []);
    };
    const { from, to, low, high } = start;
    this.curves = [0, 1].map((mass) => place(`mass ${mass + 1}`, axis("Excitation frequency (Hz)", from, to), axis("Displacement amplitude (mm)", low, high, true), [
      { name: "stable motion", shape: "line", look: look(INK) },
      { name: "unstable or neutral motion", shape: "line", look: look(INK, [4.5, 2.2]) },
      ...(mass ? [] : [{ name: "without impacts", shape: "line", look: look("#808080") }]),
      ...start.measured.filter((m) => m.mass === mass + 1).map((m) => ({
        name: m.name, shape: "points", x: m.x, y: m.y, look: look(MASSES[mass], [], m.down ? "open-circle" : "circle"),
      })),
    ].map((s) => ({ x: [], y: [], low: [], high: [], joined: s.shape === "line", ...s }))));
    const two = () => MASSES.map((colour, k) => ({
      name: `mass ${k + 1}`, shape: "line", joined: true, x: [], y: [], low: [], high: [], look: look(colour, k ? [4.5, 2.2] : []),
    }));
    this.trace = place("motion from rest, after 300 cycles", axis("Time (s)", 0, 1), axis("Displacement (mm)", -1, 1), two());
    this.plane = place("phase plane", axis("Displacement (mm)", -1, 1), axis("Velocity (m/s)", -1, 1), two());
    this.update();
  }

  slider(controls, parameter, k) {
    const label = document.createElement("label"), input = document.createElement("input"), shown = document.createElement("output");
    [input.type, input.min, input.max] = ["range", 0, STEPS];
    label.append(`${parameter.name} `, shown, input);
    controls.append(label);
    const slider = { parameter, k, input, shown };
    input.addEventListener("input", () => {
      this.set(slider, this.of(slider, Number(input.value)));
      this.later();
    });
    this.place(slider);
    return slider;
  }

  first({ parameter, k }) {
    return k === null ? this.start.frequency : this.start.rig[parameter.key] ?? this.start[parameter.key] ?? 0;
  }

  /** Ends of a slider's range. */
  ends(slider) {
    const { low, high, factor, powers } = slider.parameter, value = this.first(slider);
    if (slider.k === null) return [this.start.from, this.start.to];
    if (powers) return [10 ** powers[0], 10 ** powers[1]];
    if (factor) return [value > 0 ? value / factor : 0, value > 0 ? value * factor : 1];
    return [low ?? 0, high ?? Math.max(3 * value, 1e-4)];
  }

  /** Whether a step is a factor. */
  byFactor({ parameter }, low) {
    return (parameter.factor || parameter.powers) && low > 0;
  }

  of(slider, step) {
    const [low, high] = this.ends(slider), part = step / STEPS;
    if (slider.parameter.powers && step === STEPS) return 0;
    return this.byFactor(slider, low) ? low * (high / low) ** part : low + part * (high - low);
  }

  set(slider, value) {
    if (slider.k === null) this.frequency = value;
    else this.values[slider.k] = value;
    const { powers, unit } = slider.parameter;
    slider.shown.textContent = powers && !(value > 0) ? "rigid" : `${digits(value, 4)} ${unit}`;
  }

  /** Puts a slider at its first value. */
  place(slider) {
    const value = this.first(slider), [low, high] = this.ends(slider);
    const part = this.byFactor(slider, low) ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    slider.input.value = slider.parameter.powers && !(value > 0) ? STEPS : Math.round(part * STEPS);
    this.set(slider, value);
  }

  reset() {
    this.sliders.forEach((slider) => this.place(slider));
    this.update();
  }

  later() {
    if (this.waits) return;
    this.waits = requestAnimationFrame(() => {
      this.waits = 0;
      this.update();
    });
  }

  update() {
    const began = performance.now(), { from, to } = this.start;
    const rows = this.model.response(this.values, from, to, 600), f = column(rows, 8, 0);
    for (const [mass, curve] of this.curves.entries()) {
      // One branch behind the other, with a gap between.
      const branch = (state) => {
        const x = [], y = [];
        for (const at of [2, 5]) {
          for (let i = 0; i < f.length; i++) {
            x.push(f[i]);
            y.push(rows[i * 8 + at + 2] === state ? 1e3 * rows[i * 8 + at + mass] : NaN);
          }
          x.push(NaN);
          y.push(NaN);
        }
        return { x, y };
      };
      Object.assign(curve.series[0], branch(2));
      Object.assign(curve.series[1], branch(1));
      if (!mass) Object.assign(curve.series[2], { x: f, y: column(rows, 8, 1).map((v) => 1e3 * v) });
      curve.plot.redraw(false);
    }
    const motion = this.model.motion(this.values, this.frequency), t = column(motion, 5, 0);
    for (const k of [0, 1]) {
      const x = column(motion, 5, 1 + k).map((v) => 1e3 * v), v = column(motion, 5, 3 + k);
      Object.assign(this.trace.series[k], { x: t, y: x });
      Object.assign(this.plane.series[k], { x, y: v });
    }
    this.trace.tip.textContent = t.length ? "" : "No motion from rest: the rig cannot be simulated with these values.";
    this.fit(this.trace);
    this.fit(this.plane);
    const text = (key, value) => `${key} = ${digits(value, 6).replace("−", "-")}`;
    const rig = PARAMETERS.slice(0, 8).map(({ key }, k) => text(key, this.values[k]));
    const contact = this.values[9] > 0 ? `\n\n[contact]\n${text("stiffness", this.values[9])}` : "";
    this.toml.textContent = `[rig]\n${rig.join("\n")}\n\n[excitation]\nkind = "sine"\n${text("force", this.values[8])}${contact}`;
    this.took = performance.now() - began;
  }

  /** Brings the axes of a plot around its series. */
  fit(plot) {
    const ends = (key) => {
      const all = plot.series.flatMap((s) => Array.from(s[key])).filter(Number.isFinite);
      const low = all.reduce((a, b) => Math.min(a, b), Infinity), high = all.reduce((a, b) => Math.max(a, b), -Infinity);
      const room = 0.05 * (high - low) || 1e-6;
      return all.length ? [low - room, high + room] : [-1, 1];
    };
    const [x, y] = [ends("x"), ends("y")];
    plot.plot.setData([x, y]);
  }
}

/** Begins what-if with the model in a module. */
async function whatIf(host, start, module) {
  const { instance } = await WebAssembly.instantiate(module, {});
  return new WhatIf(host, start, new Model(instance.exports));
}

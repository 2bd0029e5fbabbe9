/** Keys that the mouse drags in the trace of a kind of record, with what each does. */
const PICKS = {
  threshold: { of: ["impacts", "drop"], about: "smallest impact counted, as a part of the median height of all sounds" },
  refractory: { of: ["impacts", "drop"], unit: "s", about: "dead time behind an impact, in s" },
  span: { of: ["impacts", "drop", "decay", "pulse", "spectrum"], unit: "s", about: "the part that is used, from and to in s" },
  band: { of: ["impacts", "decay"], unit: "Hz", about: "band in Hz, dragged in the spectrum" },
};

/** Threshold of the program where none is stated. */
const THRESHOLD = { impacts: 0.125, drop: 0.02 };
/** Colours of what each proposed value would detect. */
const TRIALS = ["--other", "--edge"];
/** Time in s behind an impact within which quieter sounds count as its echoes. */
const SHADOW = 0.06;
/** Time in s by which the onset of a sound may be off from where it is heard. */
const NEAR_TIME = 0.004;
/** Distance in pixels within which the mouse takes a line. */
const NEAR = 5;

/** A value with as many digits as a step of the picture tells. */
const rounded = (value, step) => String(Number(value.toFixed(Math.min(Math.max(Math.ceil(-Math.log10(step || 1)), 0) + 1, 12))));
const pairOf = (value) => (value ?? "").match(/[-+\d.eE]+/g)?.map(Number) ?? null;

/** Multiples of 1, 2 or 5 times a power of ten, three to eight of them. */
function roundSteps(from, to) {
  const size = 10 ** Math.floor(Math.log10((to - from) / 3 || 1)), step = [5, 2, 1].map((k) => k * size).find((one) => one <= (to - from) / 3) ?? size;
  const first = Math.ceil(from / step - 1e-9), n = Math.floor(to / step + 1e-9) - first;
  return Array.from({ length: Math.max(n, 0) + 1 }, (_, k) => Number(((first + k) * step).toPrecision(12)));
}

/** Writes round values of the abscissa of a picture below it. */
function writeSteps(pen, { from, to }, across, unit, width, foot) {
  for (const value of roundSteps(from, to)) {
    const x = across(value);
    pen.textAlign = x < 30 ? "left" : x > width - 30 ? "right" : "center";
    pen.fillText(quantity(value, unit) || `0 ${unit}`, x, foot);
  }
}

/** The raw trace of a table, with what was detected, and lines that the mouse drags. */
class TraceView {
  /**
   * `events(table, file, results)` are the times of what was detected, `inBand(table, file)` is whether in a band;
   * `said(table)` is why there is no answer; `stand(identity)` puts the view below a card.
   */
  constructor(host, { ask, attempt, set, events, inBand, said, stand }) {
    Object.assign(this, { host, ask, attempt, set, events, inBand, refusals: said, stand });
    [this.part, this.times, this.trials, this.isLevel, this.ignored] = [[null, null], [], [], false, []];
  }

  async open(tables, id, file = 0) {
    const k = tables.findIndex((_, k) => identity(tables, k) === id);
    if (this.id !== id || this.file !== file) [this.part, this.times, this.trials, this.tried, this.before] = [[null, null], [], [], undefined, undefined];
    // What another record shows does not stand below this card.
    if (this.id !== id) this.host.replaceChildren();
    Object.assign(this, { tables, id, k, table: tables[k], file });
    this.stand(id);
    this.host.hidden = false;
    await this.load().catch((error) => this.failed(error));
    this.host.scrollIntoView({ block: "nearest" });
  }

  /** Says why a record cannot be shown. */
  failed(error) {
    this.data = this.canvas = this.band = this.tried = undefined;
    const close = make("button", { textContent: "close", title: "Close the record", onclick: () => this.close() });
    this.host.replaceChildren(make("p", { className: "refused" }, ...worded(here(error.message))), close);
  }

  close() {
    this.host.hidden = true;
    this.stand();
    this.id = this.tried = undefined;
  }

  /** The table as it is now; what is dragged is shown anew. */
  async refresh(tables) {
    // What is being dragged stays; its end runs the campaign once more.
    if (this.id === undefined || this.canvas?.onpointermove || this.band?.onpointermove) return;
    const k = tables.findIndex((_, k) => identity(tables, k) === this.id);
    if (k < 0) return this.close();
    Object.assign(this, { tables, k, table: tables[k] });
    await new Promise((resolve) => { pressed.after(Symbol("trace"), resolve); });
    await this.load().catch((error) => this.failed(error));
  }

  value(key) {
    return valueOf(this.table, key);
  }

  picks() {
    return Object.keys(PICKS).filter((key) => PICKS[key].of.includes(this.table.section));
  }

  async load() {
    const [from, to] = this.part, columns = Math.max(200, Math.round(this.host.clientWidth) - 60);
    this.data = await this.ask("trace", { table: this.k, file: this.file, from, to, columns });
    // The sounds are those of the part that is used; a threshold is a part of their median height.
    const of = JSON.stringify([this.id, this.file, ...["span", "band", "envelope", "keep_hum"].map((key) => this.value(key))]);
    if (of !== this.heardOf) {
      this.heardOf = of;
      const sounds = this.picks().includes("threshold") ? this.ask("sounds", { table: this.k, file: this.file }) : null;
      this.heard = await Promise.resolve(sounds).catch(() => null);
    }
    // Where nothing is detected any more, the marks stay as they were.
    const found = this.events(this.table, this.data.files[this.file]);
    this.lost = found.length === 0 && this.times?.length > 0;
    if (!this.lost) this.times = found;
    // Once for each answer: lines are drawn with every move of the mouse.
    this.isLevel = this.hasLevel();
    this.ignored = this.unused();
    this.build();
    this.draw();
    this.tryOut();
  }

  /** Shows what would be detected with each value that the refusal of the record proposes. */
  async tryOut() {
    const proposed = proposedIn(this.refusals(this.table)).filter(({ key }) => this.picks().includes(key)).slice(0, TRIALS.length);
    const of = JSON.stringify([this.id, this.file, proposed, this.table.keys.map(({ key, value }) => [key, value])]);
    if (of === this.tried) return;
    [this.tried, this.trials] = [of, []];
    for (const one of proposed) {
      const results = await this.attempt({ table: this.k, ...one });
      if (this.tried !== of) return;
      const times = results ? this.events(this.table, this.data.files[this.file], results) : [];
      // Two values may find the same impacts.
      const known = this.trials.some((other) => other.times.length === times.length && other.times.every((t, i) => Math.abs(t - times[i]) < this.pixel()));
      if (times.length && !known) this.trials.push({ ...one, times });
    }
    pressed.after("offer", () => {
      if (!this.data) return;
      this.offer();
      this.draw();
    });
  }

  /** Buttons for what was tried out, in the colours of its lines, and what else can be done. */
  offer() {
    const button = ({ key, value, times }, k) => {
      const take = make("button", { textContent: `${times.length} impacts, with ${fieldOf(this.table, key)} = ${value}`, onclick: () => this.state(key, () => value) });
      take.style.borderLeft = `6px solid ${colour(TRIALS[k])}`;
      return take;
    };
    this.offers.replaceChildren(...this.trials.map(button));
    const help = this.trials.length ? "Each button sets its value; lines in its colour are the impacts found with it. " : "";
    this.said.replaceChildren(...this.changed(), `${this.picks().includes("threshold") ? `${this.counted()} ` : ""}${help}${this.picks().length ? "Drag a line to move it; drag beside the lines to zoom" : "Drag to zoom"}; double-click for all.`);
  }

  /** How many impacts there are, and why other sounds above the threshold are none. */
  counted() {
    const ignored = this.ignored.filter(({ high }) => high), reasons = new Map();
    for (const { why } of ignored) reasons.set(why, (reasons.get(why) ?? 0) + 1);
    if (this.lost || !this.times.length) return `No answer: ${obstacle(this.refusals(this.table)[0] ?? "no impact is found")}. ${ignored.length} sounds are louder than the threshold (hollow marks).`;
    const others = ignored.length ? ` ${ignored.length} louder than the threshold, not taken (hollow marks): ${Array.from(reasons, ([why, n]) => `${n} ${why}`).join(", ")}.` : "";
    const elsewhere = this.heard && !this.isLevel ? " They were found in a band of the trace, which has levels of its own." : "";
    return `${this.times.length} impacts (filled marks).${others}${elsewhere}`;
  }

  /** What the last value that was set here has changed. */
  changed() {
    // Taken back, a value changed nothing.
    if (!this.before || this.value(this.before.key) !== this.before.value) return [];
    const { key, value, times, why } = this.before, now = this.lost ? [] : this.times, reason = this.refusals(this.table)[0] ?? "";
    const same = times.length === now.length && times.every((t, k) => t === now[k]) && why === reason;
    const text = same ? `nothing changed${reason ? ", the record gives no answer for the same reason" : `, the same ${now.length} impacts`}.` : now.length ? `${times.length || "no"} → ${now.length} impacts.` : "no answer now.";
    return [make("b", { textContent: `${fieldOf(this.table, key)} = ${value}: ${text}` }), " "];
  }

  /** Whether a time is that of a sound. */
  static isOf(t, { from, to }) { return t > from - NEAR_TIME && t < Math.max(to, from + NEAR_TIME); }

  /** Whether the threshold is a level of this trace: impacts that were searched for in a band have others. */
  hasLevel() {
    if (!this.heard?.sounds.length || this.inBand(this.table, this.data.files[this.file])) return false;
    const high = this.heard.sounds.filter(({ height }) => height > this.least()), times = this.lost ? [] : this.times;
    return times.filter((t) => high.some((sound) => TraceView.isOf(t, sound))).length >= 0.8 * times.length;
  }

  /** Sounds that are no impacts of the answer, whether each exceeds the threshold, and why it is not taken. */
  unused() {
    if (!this.isLevel) return [];
    const times = this.lost ? [] : this.times, dead = Number(this.value("refractory")) || 0, least = this.least();
    const isTaken = (sound) => times.some((t) => TraceView.isOf(t, sound));
    const why = ({ from }) => {
      const before = times.filter((t) => t < from).at(-1);
      if (before === undefined) return "before the first impact";
      if (from - before < dead) return "within the dead time";
      if (from - before < SHADOW) return "echoes of an impact";
      return this.table.section === "drop" ? "no bounce of this fall" : "echoes";
    };
    return this.heard.sounds.filter((sound) => !isTaken(sound)).map((sound) => ({ ...sound, high: sound.height > least, why: why(sound) }));
  }

  /** Height over the level at rest from which a sound counts. */
  least() { return Math.max((Number(this.value("threshold")) || THRESHOLD[this.table.section]) * this.heard.median, this.heard.reach); }

  build() {
    const { data } = this, title = `${data.files[this.file]}, ${data.name || "channel 1"}: ${data.n} values`;
    const tool = (textContent, about, onclick) => make("button", { textContent, title: about, onclick });
    const zoom = (by) => () => this.zoom(by, 0.5);
    const shift = (by) => () => { const wide = this.wide(); this.go(data.picture.from + by * wide, data.picture.to + by * wide); };
    const bar = make("div", { className: "does" }, make("strong", { textContent: title }));
    if (data.files.length > 1) {
      const choice = make("select", { onchange: () => this.open(this.tables, this.id, Number(choice.value)) });
      choice.setAttribute("aria-label", "File");
      data.files.forEach((name, k) => choice.append(make("option", { value: k, textContent: name, selected: k === this.file })));
      bar.append(choice);
    }
    bar.append(tool("closer", "Zoom in", zoom(0.5)), tool("wider", "Zoom out", zoom(2)), tool("←", "Earlier", shift(-0.5)), tool("→", "Later", shift(0.5)), tool("all", "The whole record", () => this.go(null, null)), tool("close", "Close the record", () => this.close()));
    this.canvas = make("canvas", { tabIndex: 0 });
    this.canvas.setAttribute("aria-label", `Trace of ${title}; ${this.times.length} detected`);
    this.band = make("canvas", { className: "band", hidden: !data.spectrum || !this.picks().includes("band") });
    this.band.setAttribute("aria-label", "Spectrum of the part that is shown");
    const fields = make("div", { className: "does" }), inputs = {}, before = this.inputs ?? {};
    for (const key of this.picks()) {
      const input = make("input", { size: 12, value: this.value(key), placeholder: "not stated", title: PICKS[key].about });
      input.onchange = () => !this.redraws && this.state(key, () => toToml(input.value, PICKS[key].unit));
      inputs[key] = input;
      fields.append(make("label", {}, `${fieldOf(this.table, key)} `, input));
    }
    this.inputs = inputs;
    this.said = make("p", { className: "soft" });
    this.toml = make("pre");
    const copy = tool("copy these keys", "Copy as TOML", async () => {
      await navigator.clipboard.writeText(this.toml.textContent).catch(() => getSelection().selectAllChildren(this.toml));
    });
    this.offers = make("div", { className: "does" });
    // A field that is being typed in stays as it is.
    const typed = Object.entries(before).find(([, input]) => input === document.activeElement);
    this.redraws = true;
    this.host.replaceChildren(bar, this.canvas, this.offers, this.band, fields, this.said, this.toml, make("div", { className: "does" }, copy));
    this.redraws = false;
    if (typed && inputs[typed[0]]) {
      inputs[typed[0]].value = typed[1].value;
      inputs[typed[0]].focus();
    }
    this.canvas.onpointerdown = (event) => this.press(event);
    this.canvas.onwheel = (event) => {
      event.preventDefault();
      this.zoom(event.deltaY < 0 ? 0.7 : 1 / 0.7, event.offsetX / this.canvas.clientWidth);
    };
    this.canvas.ondblclick = () => this.go(null, null);
    this.band.onpointerdown = (event) => this.pressBand(event);
    this.offer();
  }

  /** Time that a pixel stands for. */
  pixel() { return this.wide() / this.canvas.clientWidth; }

  wide() { return this.data.picture.to - this.data.picture.from; }

  zoom(by, at) {
    const { from } = this.data.picture, wide = this.wide(), centre = from + at * wide;
    this.go(centre - at * wide * by, centre + (1 - at) * wide * by);
  }

  go(from, to) {
    const { first, last } = this.data;
    this.part = from === null ? [null, null] : [Math.max(from, first), Math.min(to, last)];
    this.load().catch((error) => { this.said.textContent = inShort(error.message); });
  }

  /** Time of the largest value that is shown. */
  largest() {
    const { picture } = this.data, size = (k) => Math.max(Math.abs(picture.low[k] ?? 0), Math.abs(picture.high[k] ?? 0));
    const k = picture.low.reduce((best, _, k) => (size(k) > size(best) ? k : best), 0);
    return picture.from + k / picture.low.length * this.wide();
  }

  draw() {
    const { pen, width, height } = canvasOf(this.canvas), { picture, unit } = this.data;
    let [low, high] = range(picture);
    const room = 0.06 * (high - low || 1), foot = 20;
    [low, high] = [low - room, high + room];
    this.across = (t) => (t - picture.from) / (this.wide() || 1) * width;
    this.up = (v) => (height - foot) * (1 - (v - low) / (high - low));
    this.at = (x) => picture.from + x / width * this.wide();
    this.level = (y) => low + (1 - y / (height - foot)) * (high - low);
    this.drawTrials(pen, height - foot);
    drawBand(pen, picture, this.across, this.up);
    // What the analysis does not read lies in the shade.
    const used = pairOf(this.value("span"));
    if (used?.length === 2) {
      pen.fillStyle = colour("--faint");
      pen.globalAlpha = 0.6;
      pen.fillRect(0, 0, this.across(used[0]), height - foot);
      pen.fillRect(this.across(used[1]), 0, width, height - foot);
      pen.globalAlpha = 1;
    }
    pen.fillStyle = colour("--soft");
    pen.font = "11px sans-serif";
    writeSteps(pen, picture, this.across, "s", width, height - 4);
    pen.textAlign = "left";
    pen.fillText(quantity(high - room, unit), 4, 12);
    pen.fillText(quantity(low + room, unit), 4, height - foot - 4);
    const mark = (t) => {
      const x = this.across(t);
      pen.beginPath();
      pen.moveTo(x, height - foot);
      pen.lineTo(x - 4, height - foot + 7);
      pen.lineTo(x + 4, height - foot + 7);
      pen.closePath();
    };
    pen.lineWidth = 1;
    pen.strokeStyle = colour("--soft");
    for (const { from, high } of this.ignored) {
      if (!high) continue;
      mark(from);
      pen.stroke();
    }
    pen.strokeStyle = pen.fillStyle = colour("--edge");
    for (const t of this.lost ? [] : this.times) {
      mark(t);
      pen.fill();
    }
    this.handles = this.lines();
    for (const line of this.handles.filter(({ name }) => name !== this.dragged)) this.drawHandle(pen, line, width, height - foot);
    if (!this.band.hidden) this.drawSpectrum();
    const stated = this.picks().filter((key) => this.value(key));
    this.toml.textContent = stated.map((key) => `${key} = ${this.value(key)}`).join("\n") || "# nothing is stated: all is found from the record";
  }

  /** Lines at the impacts that each proposed value finds, one set above the other, so that an impact of both is seen. */
  drawTrials(pen, height) {
    this.trials.forEach(({ times }, k) => {
      pen.strokeStyle = colour(TRIALS[k]);
      pen.lineWidth = 2;
      const [from, to] = [k, k + 1].map((part) => part * height / this.trials.length);
      for (const x of times.map(this.across)) {
        pen.beginPath();
        pen.moveTo(x, from);
        pen.lineTo(x, to);
        pen.stroke();
      }
    });
  }

  drawHandle(pen, { place, level, mirrored, name }, width, height) {
    // A name is read also over the trace.
    const write = (text, x, y) => {
      pen.save();
      [pen.strokeStyle, pen.lineWidth, pen.lineJoin] = [colour("--paper"), 4, "round"];
      pen.strokeText(text, x, y);
      pen.restore();
      pen.fillText(text, x, y);
    };
    pen.setLineDash([6, 4]);
    pen.lineWidth = 1.5;
    pen.beginPath();
    if (level !== undefined) {
      pen.moveTo(0, this.up(level));
      pen.lineTo(width, this.up(level));
      if (mirrored !== undefined) {
        pen.moveTo(0, this.up(mirrored));
        pen.lineTo(width, this.up(mirrored));
      }
    } else {
      pen.moveTo(this.across(place), 0);
      pen.lineTo(this.across(place), height);
    }
    pen.stroke();
    pen.setLineDash([]);
    pen.textAlign = "right";
    if (level !== undefined) write(name, width - 4, Math.max(this.up(level) - 4, 12));
    // Names of lines that stand near each other have heights of their own.
    else {
      const x = this.across(place), left = x < width / 2;
      pen.textAlign = left ? "left" : "right";
      write(name, left ? x + 4 : x - 4, name === "from" || name === "to" ? 26 : 40);
    }
    pen.textAlign = "left";
  }

  /** The lines that are dragged, each with the value that it sets. */
  lines() {
    const all = [], { picture, first, last } = this.data, can = this.picks();
    // Where a band is searched, a threshold is a level of that, and no level of this trace.
    if (can.includes("threshold") && this.isLevel) {
      const { median, rest, sides: [up, down] } = this.heard, own = this.value("threshold"), part = own || THRESHOLD[this.table.section];
      const level = (height) => rest + (up ? height : -height), least = this.least();
      const noise = least > part * median, words = noise ? "noise limit, above the threshold" : `threshold ${part}${own ? "" : " (default)"} of the median height`;
      const name = this.canvas.clientWidth < 500 ? (noise ? "noise limit" : `threshold ${part}`) : `${words}: ${quantity(least, this.data.unit)}`;
      all.push({ name, level: level(least), mirrored: up && down ? rest - least : undefined, key: "threshold", to: (x, y) => rounded(Math.min(Math.max(Math.abs(this.level(y) - rest) / median, 1e-3), 0.99), 0.01) });
    }
    if (can.includes("refractory")) {
      const begins = this.times.find((t) => t >= picture.from) ?? this.times[0] ?? this.largest(), dead = Number(this.value("refractory")) || 0;
      // Where none is stated, the line waits at the impact.
      all.push({ name: dead ? `dead time ${quantity(dead, "s")}` : "dead time: drag to the right", place: begins + dead, key: "refractory", to: (x) => rounded(Math.max(this.at(x) - begins, 1e-6), this.pixel()) });
    }
    if (can.includes("span")) {
      const [from, to] = pairOf(this.value("span")) ?? [first, last], [low, high] = this.value("span").match(/[-+\d.eE]+/g) ?? [String(first), String(last)];
      all.push({ name: "from", place: from, key: "span", to: (x) => `[${rounded(Math.min(this.at(x), to), this.pixel())}, ${high}]` });
      all.push({ name: "to", place: to, key: "span", to: (x) => `[${low}, ${rounded(Math.max(this.at(x), from), this.pixel())}]` });
    }
    return all;
  }

  press(event) {
    const near = ({ place, level }) => level !== undefined ? Math.abs(this.up(level) - event.offsetY) : Math.abs(this.across(place) - event.offsetX);
    const line = this.handles.filter((one) => near(one) < NEAR).sort((a, b) => near(a) - near(b))[0];
    const begun = event.offsetX, ends = (x) => Math.min(Math.max(x, 0), this.canvas.clientWidth);
    let moved = begun, value = "";
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.onpointermove = ({ offsetX, offsetY }) => {
      moved = ends(offsetX);
      // The line that is dragged stands where the mouse is, not where it was.
      this.dragged = line?.name;
      this.draw();
      const { pen, height } = { pen: this.canvas.getContext("2d"), height: this.canvas.clientHeight };
      if (line) {
        value = line.to(moved, offsetY);
        this.drawHandle(pen, line.level !== undefined ? { name: `${value} of the median height`, level: this.level(offsetY) } : { name: value, place: this.at(moved) }, this.canvas.clientWidth, height - 20);
        if (this.inputs[line.key]) this.inputs[line.key].value = value;
      } else {
        pen.globalAlpha = 0.2;
        pen.fillStyle = colour("--link");
        pen.fillRect(Math.min(begun, moved), 0, Math.abs(moved - begun), height);
        pen.globalAlpha = 1;
      }
    };
    this.canvas.onpointerup = () => {
      this.canvas.onpointermove = this.canvas.onpointerup = null;
      this.dragged = undefined;
      if (line?.key === "threshold" && value && Number(value) * this.heard.median < this.heard.reach) this.belowNoise();
      else if (line && value) this.state(line.key, () => value);
      else if (!line && Math.abs(moved - begun) > 5) this.go(this.at(Math.min(begun, moved)), this.at(Math.max(begun, moved)));
      else this.draw();
    };
  }

  /** Leaves the threshold as it was, and says why. */
  belowNoise() {
    this.draw();
    this.inputs.threshold.value = this.value("threshold");
    this.said.replaceChildren(make("b", { textContent: `Nothing was set: below ${quantity(this.heard.reach, this.data.unit)} sounds are not told from the noise of this record, whatever the threshold is.` }));
  }

  drawSpectrum() {
    const { pen, width, height } = canvasOf(this.band), { spectrum } = this.data, [low, high] = range(spectrum);
    const across = (f) => (f - spectrum.from) / (spectrum.to - spectrum.from || 1) * width;
    this.hertz = (x) => spectrum.from + x / width * (spectrum.to - spectrum.from);
    const shown = Math.max(low, high - 6);
    drawBand(pen, spectrum, across, (v) => (height - 16) * (1 - (Math.max(v, shown) - shown) / (high - shown || 1)));
    pen.fillStyle = colour("--soft");
    pen.font = "11px sans-serif";
    writeSteps(pen, spectrum, across, "Hz", width, height - 3);
    const band = pairOf(this.value("band"));
    if (!band) return;
    pen.fillStyle = colour("--edge");
    pen.globalAlpha = 0.2;
    pen.fillRect(across(band[0]), 0, across(band[1]) - across(band[0]), height - 16);
    pen.globalAlpha = 1;
  }

  pressBand(event) {
    const begun = event.offsetX;
    let moved = begun;
    this.band.setPointerCapture(event.pointerId);
    this.band.onpointermove = ({ offsetX }) => {
      moved = Math.min(Math.max(offsetX, 0), this.band.clientWidth);
      this.drawSpectrum();
      const pen = this.band.getContext("2d");
      pen.globalAlpha = 0.25;
      pen.fillStyle = colour("--edge");
      pen.fillRect(Math.min(begun, moved), 0, Math.abs(moved - begun), this.band.clientHeight - 16);
      pen.globalAlpha = 1;
    };
    this.band.onpointerup = () => {
      this.band.onpointermove = this.band.onpointerup = null;
      if (Math.abs(moved - begun) < 4) return;
      const [low, high] = [begun, moved].sort((a, b) => a - b).map((x) => rounded(this.hertz(x), (this.data.spectrum.to - this.data.spectrum.from) / this.band.clientWidth));
      this.state("band", () => `[${low}, ${high}]`);
    };
  }

  async state(key, value) {
    try {
      const typed = value();
      this.before = { key, value: typed, times: this.lost ? [] : this.times, why: this.refusals(this.table)[0] ?? "" };
      await this.set(this.id, key, typed);
    } catch (error) {
      this.before = undefined;
      this.said.replaceChildren(make("span", { className: "wrong", textContent: here(error.message) }));
      this.inputs[key]?.setAttribute("aria-invalid", "true");
    }
  }
}

/** An element with its class, text and children. */
function make(tag, about = {}, ...children) {
  const element = Object.assign(document.createElement(tag), about);
  element.append(...children);
  return element;
}

/** The colour that the style names. */
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

/** A number in a few digits with its unit. */
function quantity(value, unit) {
  if (!Number.isFinite(value)) return "";
  // A part of full scale is no physical unit.
  if (unit === "FS") return `${Number(value.toPrecision(4))} FS`;
  const steps = [[1e9, "G"], [1e6, "M"], [1e3, "k"], [1, ""], [1e-3, "m"], [1e-6, "µ"]];
  const [by, letter] = steps.find(([step]) => Math.abs(value) >= step) ?? [1, ""];
  return `${Number((value / by).toPrecision(4))} ${letter}${unit}`.trim();
}

/** Canvas ready to draw on in pixels of the style. */
function canvasOf(canvas) {
  const sharp = devicePixelRatio || 1, { clientWidth: width, clientHeight: height } = canvas;
  [canvas.width, canvas.height] = [Math.round(width * sharp), Math.round(height * sharp)];
  const pen = canvas.getContext("2d");
  pen.setTransform(sharp, 0, 0, sharp, 0, 0);
  pen.clearRect(0, 0, width, height);
  return { pen, width, height };
}

/** Smallest and largest of a picture's values. */
function range(picture) {
  const all = [...picture.low, ...picture.high].filter((v) => v !== null);
  return all.length ? [all.reduce((a, b) => Math.min(a, b)), all.reduce((a, b) => Math.max(a, b))] : [0, 1];
}

/** Draws a picture as a band from the smallest to the largest value of each column. */
function drawBand(pen, picture, across, up) {
  pen.strokeStyle = colour("--curve");
  pen.lineWidth = 1;
  pen.beginPath();
  let last = null;
  const step = (picture.to - picture.from) / picture.low.length;
  picture.low.forEach((low, k) => {
    if (low === null) return;
    const x = across(picture.from + (k + 0.5) * step), high = picture.high[k];
    if (last === null) pen.moveTo(x, up(low));
    else pen.lineTo(x, up(Math.abs(last - low) < Math.abs(last - high) ? low : high));
    pen.lineTo(x, up(low));
    pen.lineTo(x, up(high));
    last = high;
  });
  pen.stroke();
}

/** The small picture of a record. */
function thumbnail(canvas, picture) {
  const { pen, width, height } = canvasOf(canvas), [low, high] = range(picture), tall = high - low || 1;
  drawBand(pen, picture, (x) => (x - picture.from) / (picture.to - picture.from || 1) * width, (v) => height - 2 - (v - low) / tall * (height - 4));
}

/** What a record is, in words. */
function described(record) {
  const what = { trace: "trace", spectrum: "spectrum", frf: "function" }[record.kind] ?? record.kind;
  const of = record.quantity === "other" ? "" : ` of ${record.quantity}`;
  return `${what}${of}`;
}

/** What is wrong with a file, without its name. */
const faultOf = ({ path, problem }) => inShort(problem).split(`${path}, `).at(-1);

/** Rows of the list that are shown at first. */
const FIRST_ROWS = 12;

/** The list of files, each with its records and a small picture of each. */
class Recordings {
  /** `pictures(path)` gives those of a file; `measure(path, section)` adds a table for one that none uses. */
  constructor(host, { pictures, measure }) {
    Object.assign(this, { host, pictures, measure });
    this.watch = new IntersectionObserver((seen) => seen.filter((one) => one.isIntersecting).forEach(({ target }) => this.draw(target)));
  }

  show(recordings) {
    this.watch.disconnect();
    const head = make("tr", {}, ...["file", "channel", "what", "in SI unit", "rate", "length", ""].map((name) => make("th", { textContent: name, className: /rate|length/.test(name) ? "number" : "" })));
    const body = make("tbody");
    // Of a file with missing values the records are listed, too.
    const unread = recordings.filter(({ problem, records }) => problem && !records.length), read = recordings.filter((file) => !unread.includes(file));
    this.unread = new Set(unread.map(({ path }) => path));
    for (const file of read) body.append(...this.rows(file));
    const rows = Array.from(body.rows);
    rows.slice(FIRST_ROWS).forEach((row) => { row.hidden = true; });
    // The pictures that are seen first are asked for before longer work.
    for (const canvas of Array.from(body.querySelectorAll("canvas")).slice(0, FIRST_ROWS)) this.pictures(canvas.dataset.path).catch(() => []);
    this.host.replaceChildren(make("div", { className: "files" }, make("table", {}, make("thead", {}, head), body)));
    if (rows.length > FIRST_ROWS) {
      const all = make("button", { textContent: `show all ${rows.length} rows` });
      all.onclick = () => { rows.forEach((row) => { row.hidden = false; }); all.remove(); };
      this.host.append(all);
    }
    this.left = make("div");
    this.host.append(this.left);
    this.known = new Map(read.map(({ path, records }) => [path, records]));
    this.fold(this.host, `${unread.length === 1 ? "1 file holds" : `${unread.length} files hold`} no record`, unread.map((file) => make("li", {}, ...worded(`${file.path}: ${faultOf(file)}`))));
  }

  /** Names of the channels of a file. */
  channels(path) { return (this.known?.get(path) ?? []).map(({ name }) => name); }

  /** Whether a file has a time trace; those of a pattern are not looked at. */
  isTrace(path) { return this.known?.get(path)?.some(({ kind }) => kind === "trace") ?? true; }

  /** Whether a channel of a file, or its only one, has no unit that the file states. */
  unitless(path, channel) {
    const records = (this.known?.get(path) ?? []).filter(({ name }, k) => !channel || name === channel || String(k + 1) === channel);
    return records.length > 0 && records.every(({ unit, quantity, kind }) => kind === "trace" && !unit && quantity === "other");
  }

  /** A folded list; nothing where it is empty. */
  fold(host, name, items, open = false) {
    if (items.length) host.append(make("details", { open }, make("summary", { textContent: name }), make("ul", {}, ...items)));
  }

  /** Files that no table uses, each with the reason; one with records can be measured as a kind. */
  showLeft(left, kinds) {
    const item = ([name, why]) => {
      const row = make("li", { textContent: `${name}: ${why} ` });
      if (!this.known.has(name)) return row;
      const choice = make("select", {}, make("option", { textContent: "measure it as …", value: "" }), ...kinds.map(([value, textContent]) => make("option", { value, textContent })));
      choice.setAttribute("aria-label", `Measure ${name} as`);
      choice.onchange = () => {
        choice.disabled = true;
        this.measure(name, choice.value).then(() => row.remove());
      };
      row.append(choice);
      return row;
    };
    this.left.replaceChildren();
    // A file without records is listed below.
    left = left.filter(([name]) => !this.unread.has(name));
    // Where a choice of the person may help, it is seen.
    const open = left.some(([name]) => this.known.has(name));
    this.fold(this.left, `${left.length} not used`, left.map(item), open);
  }

  rows(file) {
    const cell = (text, className = "") => make("td", { textContent: text, className });
    const lacks = (k) => (file.problem && !k ? make("div", { className: "soft", textContent: obstacle(faultOf(file)).split("; expected ")[0] }) : "");
    return file.records.map((record, k) => {
      const canvas = make("canvas", { title: "smallest and largest values" });
      Object.assign(canvas.dataset, { path: file.path, record: k });
      this.watch.observe(canvas);
      const name = make("td", { textContent: k ? "" : file.path, title: `${file.format}, ${file.bytes} bytes` }, lacks(k));
      const rate = record.rate ? quantity(record.rate, "Hz") : record.dx && record.x_unit ? `${quantity(record.dx, record.x_unit)} apart` : record.x_unit === "s" && record.dx === null ? "uneven" : "not stated";
      const length = record.duration ? quantity(record.duration, "s") : `${record.n} values`;
      const unit = record.unit || (record.quantity === "other" ? "not stated" : "1");
      return make("tr", {}, name, cell(record.name || String(k + 1)), cell(described(record)), cell(unit), cell(rate, "number"), cell(length, "number"), make("td", {}, canvas));
    });
  }

  async draw(canvas) {
    this.watch.unobserve(canvas);
    const pictures = await this.pictures(canvas.dataset.path).catch(() => []);
    const picture = pictures[canvas.dataset.record];
    if (picture) thumbnail(canvas, picture);
  }
}

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

/** Rows of the list that are shown at first. */
const FIRST_ROWS = 12;

/** The list of files, each with its records and a small picture of each. */
class Recordings {
  constructor(host, pictures) {
    [this.host, this.pictures] = [host, pictures];
    this.watch = new IntersectionObserver((seen) => seen.filter((one) => one.isIntersecting).forEach(({ target }) => this.draw(target)));
  }

  show(recordings) {
    this.watch.disconnect();
    const head = make("tr", {}, ...["file", "channel", "what", "unit", "rate", "length", ""].map((name) => make("th", { textContent: name, className: /rate|length/.test(name) ? "number" : "" })));
    const body = make("tbody");
    const unread = recordings.filter(({ problem }) => problem);
    for (const file of recordings.filter(({ problem }) => !problem)) body.append(...this.rows(file));
    const rows = Array.from(body.rows);
    rows.slice(FIRST_ROWS).forEach((row) => { row.hidden = true; });
    this.host.replaceChildren(make("div", { className: "files" }, make("table", {}, make("thead", {}, head), body)));
    if (rows.length > FIRST_ROWS) {
      const all = make("button", { textContent: `show all ${rows.length} rows` });
      all.onclick = () => { rows.forEach((row) => { row.hidden = false; }); all.remove(); };
      this.host.append(all);
    }
    this.left = make("div");
    this.host.append(this.left);
    this.fold(this.host, `${unread.length} without records that can be read`, unread.map(({ path, problem }) => `${path}: ${inShort(problem)}`));
  }

  /** A folded list; nothing where it is empty. */
  fold(host, name, lines) {
    const items = lines.map((line) => make("li", { textContent: line }));
    if (items.length) host.append(make("details", {}, make("summary", { textContent: name }), make("ul", {}, ...items)));
  }

  /** Files that no table uses, each with the reason. */
  showLeft(left) {
    this.left.replaceChildren();
    this.fold(this.left, `${left.length} not used`, left.map(([name, why]) => `${name}: ${why}`));
  }

  rows(file) {
    const cell = (text, className = "") => make("td", { textContent: text, className });
    return file.records.map((record, k) => {
      const canvas = make("canvas", { title: "smallest and largest values" });
      Object.assign(canvas.dataset, { path: file.path, record: k });
      this.watch.observe(canvas);
      const name = make("td", { textContent: k ? "" : file.path, title: `${file.format}, ${file.bytes} bytes` });
      const rate = record.rate ? quantity(record.rate, "Hz") : record.dx && record.x_unit ? `${quantity(record.dx, record.x_unit)} apart` : "not stated";
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

/** An error without the line of the text at which it stands: that is shown in the text. */
const inShort = (message) => message.split("\n").filter((line) => !/^\s*(\d+\s*)?\|/.test(line)).join("\n");

/** A value as a person types it, in TOML. */
function toToml(typed) {
  // 1,000 may be a thousand: it stays text, which no number takes.
  const text = typed.trim(), number = text.replace(/^(-?\d+),(?!\d{3}$)(\d+)$/, "$1.$2").replace(/^(-?)\./, "$10.");
  if (text === "" || /^(true|false|["'[{].*|[-+]?\d[\d_]*(\.\d+)?([eE][-+]?\d+)?)$/s.test(number)) return number;
  return JSON.stringify(text);
}

/** A value of TOML as a person reads it: text without its quotes. */
function fromToml(value) {
  try {
    const plain = JSON.parse(value);
    if (typeof plain === "string" && toToml(plain) === value) return plain;
  } catch { /* A value that JSON does not have is shown as it is written. */ }
  return value;
}

/** The value of a key of a table. */
const valueOf = (table, key) => table.keys.find((row) => row.key === key)?.value ?? "";

/** What tells a table from the others, wherever it stands in the list. */
function identity(tables, k) {
  const of = (table) => [table.section, table.files, valueOf(table, "channel"), valueOf(table, "name")].join("\n");
  const own = of(tables[k]);
  return `${own}\n${tables.slice(0, k).filter((table) => of(table) === own).length}`;
}

/** The tables of the campaign as cards with fields. */
class Tables {
  /** `set(identity, key, value)` states a value; `look(identity)` shows the trace; `find(line)` shows the text. */
  constructor(host, { set, look, find }) {
    Object.assign(this, { host, set, look, find });
    [this.refused, this.redraws] = [[], false];
  }

  show(tables, problems) {
    // A browser may say that a field was left when it is only drawn anew: what is half typed in it is no value.
    this.redraws = true;
    this.draw(tables, problems);
    this.redraws = false;
  }

  draw(tables, problems) {
    // A field that is being typed in stays as it is, and a fold as it was opened.
    const { dataset, value, selectionStart, selectionEnd } = document.activeElement ?? {}, field = dataset?.field;
    const open = new Set(Array.from(this.host.querySelectorAll("details[open]"), (fold) => fold.parentElement.dataset.table));
    this.host.replaceChildren(...tables.map((table, k) => this.card(table, identity(tables, k), tables[k + 1]?.line, problems)));
    for (const fold of this.host.querySelectorAll("details")) fold.open = open.has(fold.parentElement.dataset.table);
    const none = problems.length ? "The campaign has an error, which its text below names: put right, the tables come back." : "Nothing is measured yet. A table can be written below, in the campaign.";
    if (!tables.length) this.host.append(make("p", { textContent: none }));
    const input = field && this.host.querySelector(`[data-field="${CSS.escape(field)}"]`);
    if (!input) return;
    input.value = value;
    input.focus();
    input.setSelectionRange(selectionStart, selectionEnd);
  }

  card(table, id, next, problems) {
    const card = make("article", { className: "card" });
    card.dataset.table = id;
    card.append(make("h3", { textContent: table.files || table.section }));
    const kind = [table.about || `[[${table.section}]]`, table.guess ? "guessed" : ""].filter(Boolean).join(", ");
    card.append(make("p", { className: "kind", textContent: kind }));
    if (table.refused && !table.line) card.append(make("p", { className: "refused", textContent: table.refused }));
    const name = fromToml(valueOf(table, "name"));
    for (const [record, why] of table.line ? this.refused : []) {
      if (record === name || record === table.files) card.append(make("p", { className: "refused", textContent: why }));
    }
    const wrong = problems.filter(({ line }) => line && table.line && line >= table.line && line < (next ?? Infinity));
    for (const { text } of wrong) card.append(make("p", { className: "refused", textContent: inShort(text) }));
    const rows = (...known) => table.keys.filter((row) => known.includes(row.known)).map((row) => this.row(row, id));
    card.append(...rows("missing"), ...rows("guessed"), ...rows("stated"), ...rows("found"));
    const open = rows("open");
    if (open.length) card.append(make("details", {}, make("summary", { textContent: `${open.length} more that would help` }), ...open));
    const does = make("div", { className: "does" });
    if (valueOf(table, "file")) {
      does.append(make("button", { textContent: "see the record", onclick: () => this.look(id) }));
    }
    if (table.line) does.append(make("button", { textContent: "in the text", onclick: () => this.find(table.line) }));
    card.append(does);
    return card;
  }

  row({ key, value, known, why }, table) {
    const id = `field-${table}-${key}`, input = make("input", { id, value: fromToml(value), autocomplete: "off", spellcheck: false });
    // A value of several lines is changed in the text.
    input.readOnly = value.includes("\n");
    input.dataset.field = `${table} ${key}`;
    const wrong = make("span", { className: "wrong" });
    let sent = input.value;
    input.onchange = input.onblur = async () => {
      if (input.value === sent || input.readOnly || this.redraws) return;
      [sent, wrong.textContent] = [input.value, ""];
      try {
        await this.set(table, key, toToml(input.value));
      } catch (error) {
        wrong.textContent = inShort(error.message);
      }
    };
    const reason = known === "guessed" ? `guessed: ${why}` : known === "missing" ? `missing: ${why}` : why;
    const row = make("div", { className: `row ${known}` }, make("label", { htmlFor: id, textContent: key }), input);
    if (reason) row.append(make("span", { className: "why", textContent: reason }));
    row.append(wrong);
    return row;
  }
}

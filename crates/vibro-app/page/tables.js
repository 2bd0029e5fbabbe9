/** An error without the line of the text at which it stands: that is shown in the text. */
const inShort = (message) => message.split("\n").filter((line) => !/^\s*(\d+\s*)?\|/.test(line)).join("\n").replace(/[.:]?\n\s*try: /, ". Try: ").replaceAll(/\S*campaign\.toml, (line \d+), column \d+: /g, "$1: ");

/** An error at its field. */
const here = (message) => inShort(message).replaceAll(/\bline \d+: /g, "");

/** Why a record gives no answer, without what to try. */
const obstacle = (why) => here(why).split(/\.? Try: |; try: /)[0].replace(/^Left out: /, "");

/** A sentence with what stands between backticks as code. */
const worded = (text) => text.split("`").map((part, k) => (k % 2 ? make("code", { textContent: part }) : part));

/** A sentence of a card with the names of its fields in place of their keys. */
const inFields = (text, table) => worded(text.replaceAll(/`([a-z_]+)( = [^`]+)?`/g, (all, key, value = "") => (
  table.keys.some((row) => row.key === key && row.label) ? `“${fieldOf(table, key)}”${value}` : all
)));

/** Parts and multiples of a unit. */
const STEPS = { µ: 1e-6, u: 1e-6, m: 1e-3, c: 1e-2, "": 1, k: 1e3, M: 1e6 };

/** What people type in place of a unit, in that unit. */
const OTHERS = { Hz: { rpm: 1 / 60, "1/min": 1 / 60, k: 1e3 }, "°": { deg: 1, degrees: 1 }, m: { in: 0.0254 }, s: { min: 60 } };

/** May be a thousand, or one with decimals. Nothing that begins with 0 is a thousand. */
const THOUSAND = /[1-9]\d*,\d{3}(?!\d)/;

/** A number that a person types with its unit, in the unit of the key: 57 cm as 0.57 where that is m. */
function inUnit(text, unit) {
  const found = text.match(/^([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*([^-+\d\s.,].*)$/);
  if (!found || !unit || Number.isFinite(Number(text.replace(",", ".")))) return text;
  const [, number, behind] = found, value = Number(number.replace(",", "."));
  if (!Number.isFinite(value) || THOUSAND.test(number)) return text;
  const typed = behind.replaceAll("^2", "²").replaceAll(/[\s·*]/g, ""), base = unit === "kg" ? "g" : unit;
  const step = typed.endsWith(base) ? STEPS[typed.slice(0, -base.length)] : OTHERS[unit]?.[typed];
  if (step === undefined) throw new Error(`${text}: this is in ${unit}. Type the number alone, or with ${unit}`);
  return String(Number((value * step / (unit === "kg" ? 1e3 : 1)).toPrecision(12)));
}

/** Two or more numbers that a person types without brackets, such as 0.5; 3 s, as a list in the unit of the key. The last unit holds for numbers without one. */
function asList(text, unit) {
  const parts = text.replace(/^\[|\]$/g, "").split(/;| to |,\s+|(?<=[\d.])\s+(?=[-+.\d])|(?<=[^\W\d_])\s+(?=[-+.\d])|(?<=\.\d+),(?=\d+\.)/).map((part) => part.trim()).filter(Boolean);
  const last = parts.at(-1)?.match(/[^-+\d\s.,eE].*$/)?.[0] ?? "";
  const values = parts.map((part) => inUnit(/[^-+\d\s.,eE]/.test(part) ? part : `${part}${last}`, unit).replace(/^(-?\d+),(\d+)$/, "$1.$2"));
  return parts.length > 1 && !THOUSAND.test(text) && values.every((value) => Number.isFinite(Number(value))) ? `[${values.join(", ")}]` : null;
}

/** A value as a person types it, in TOML. */
function toToml(typed, unit = "", isList = true) {
  if (unit && !isList && /^[-+]?\d[\d.,]*\s+\d/.test(typed.trim())) throw new Error(`${typed}: one number is wanted here. Type it without a gap`);
  // 1,000 may be a thousand: it stays text, which no number takes.
  const text = unit ? (isList ? asList(typed.trim(), unit) : null) ?? inUnit(typed.trim(), unit) : typed.trim(), number = text.replace(/^(-?0+),(\d+)$/, "$1.$2").replace(/^(-?\d+),(?!\d{3}$)(\d+)$/, "$1.$2").replace(/^(-?)\./, "$10.");
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

/** Keys that name a channel of the file. */
const OF_CHANNEL = ["channel", "reference", "velocity", "force", "response", "handle"];

/** Values to choose from, and whether there are no others: the channels of the file, or what the meaning of the key lists. */
function choices({ key, unit, meaning = "" }, table, channels) {
  if (OF_CHANNEL.includes(key)) {
    const names = channels(table).filter((name) => name !== "");
    // A reference may be in another file, and a force in several channels: those are typed.
    return { picks: names, all: key === "channel" && names.length > 0 && new Set(names).size === names.length && names.every((name) => fromToml(toToml(name)) === name) };
  }
  const keys = table.keys.map((row) => row.key);
  const listed = Array.from(meaning.matchAll(/`([a-z][a-z0-9/-]*)`/g), ([, word]) => word).filter((word) => !keys.includes(word));
  return listed.join() === "true" ? { picks: ["true", "false"], all: true } : { picks: listed, all: listed.length > 1 && !unit && !/such as|…/.test(meaning) };
}

/** Keys that an error names, such as `low_pass`. */
const namedIn = (texts) => texts.flatMap((text) => Array.from(text.matchAll(/`([a-z_]+)(?: = [^`]*)?`/g), ([, key]) => key));

/** Keys with the values that an error or a caution proposes, such as `threshold = 0.43`: these were tried. */
const proposedIn = (texts) => texts.flatMap((text) => Array.from(text.matchAll(/`([a-z0-9_]+) = ([^`]+)`/g), ([, key, value]) => ({ key, value })));

/** Cautions of a record that are seen at once. */
const MOST_CAUTIONS = 3;

/** What is typed, by the unit of a key. */
const SUCH_AS = { m: "57 cm", Hz: "20 kHz", s: "3 ms", kg: "250 g", "m/s": "1.5", "°": "30" };
/** As above, of two values. */
const PAIR_AS = { s: "0.5 to 3 s", Hz: "200 to 800 Hz", kg: "0.1; 0.2 kg", "m/s": "1.5; 0" };

/** Height of a row of the grid, and gap between cards, in pixels. */
const [ROW, GAP] = [4, 13];

/** The name of a key in plain words. */
const labelOf = ({ key, label }) => label?.replaceAll("`", "") ?? key.replaceAll("_", " ");

/** The name of the field of a key in a table. */
const fieldOf = (table, key) => labelOf(table.keys.find((row) => row.key === key) ?? { key });

/** What tells a table from the others, wherever it stands in the list. */
function identity(tables, k) {
  const of = (table) => [table.section, table.files, valueOf(table, "channel")].join("\n");
  const own = of(tables[k]);
  return `${own}\n${tables.slice(0, k).filter((table) => of(table) === own).length}`;
}

/** What a person presses stays below the pointer until it is let go: else the click would meet something else. */
class Pressed {
  constructor() {
    [this.held, this.waiting] = [false, new Map()];
    let later;
    const free = () => {
      this.held = false;
      const all = Array.from(this.waiting.values());
      this.waiting.clear();
      all.forEach((todo) => todo());
    };
    // A list of a browser may keep the end of the press to itself.
    addEventListener("pointerdown", ({ target }) => {
      this.held = !target.closest?.("select");
      clearTimeout(later);
      later = setTimeout(free, 1500);
    }, true);
    for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => setTimeout(free), true);
  }

  /** Does something at once, or when nothing is pressed any more; of several with one name the last. */
  after(name, todo) {
    if (this.held) this.waiting.set(name, todo);
    else {
      this.waiting.delete(name);
      todo();
    }
  }
}

const pressed = new Pressed();

/** The tables of the campaign as cards with fields. */
class Tables {
  /**
   * `set(identity, key, value)` states a value, and `refused()` is told of one that is refused; `kind(identity, section)` makes it another kind;
   * `look(identity)` shows the trace; `find(line)` shows the text; `channels(table)` are those of its file;
   * `unitless(table)` tells whether its file states no unit; `below` stands below the card that it names.
   */
  constructor(host, { set, kind, refused, look, find, channels, unitless, isTrace, below }) {
    Object.assign(this, { host, set, kind, told: refused, look, find, channels, unitless, isTrace, below, kinds: [] });
    // What the last run found of each record: main numbers, and cautions and doubts with their severity.
    [this.numbers, this.doubts] = [[], []];
    // Values that were refused stand, with the reason, until they are typed anew.
    [this.refused, this.redraws, this.wrong] = [[], false, new Map()];
    this.sizes = new ResizeObserver(() => this.pack());
    this.forget();
  }

  /** Begins with other files. */
  forget() {
    // Keys of each table outside of its folds: they stay, in their order, whatever becomes of their values.
    this.stood = new Map();
    // Places of the cards: they stay when the text has a table elsewhere.
    this.places = new Map();
  }

  /** Takes back the values that were typed and refused. */
  withoutWrong() {
    this.wrong.clear();
    this.told();
    this.show(this.tables, this.problems);
  }

  /** Gives each card as many rows of the grid as it is high, so that none leaves a gap below it. */
  pack() {
    for (const one of this.host.children) {
      if (one.hidden) continue;
      const rows = `span ${Math.ceil((one.offsetHeight + GAP) / ROW)}`;
      if (one.style.gridRowEnd !== rows) one.style.gridRowEnd = rows;
    }
  }

  show(tables, problems) {
    this.problems = problems;
    pressed.after("tables", () => this.redraw(tables, problems));
  }

  redraw(tables, problems) {
    // A browser may say that a field was left when it is only drawn anew: what is half typed in it is no value.
    this.redraws = true;
    // A record that is looked at stays where it is on the screen, however high its card has become.
    const seen = () => this.below.element.getBoundingClientRect(), before = seen();
    this.draw(tables, problems);
    this.sizes.disconnect();
    for (const one of this.host.children) this.sizes.observe(one);
    this.pack();
    if (before.height && before.top < innerHeight && before.bottom > 0) scrollBy(0, seen().top - before.top);
    this.redraws = false;
  }

  draw(tables, problems) {
    // A field that is being typed in stays as it is, and a fold as it was opened.
    const active = document.activeElement, { dataset, value, selectionStart, selectionEnd } = document.activeElement ?? {}, field = dataset?.field;
    const nameOf = (fold) => `${fold.parentElement.dataset.table}\n${fold.className}`;
    const open = new Set(Array.from(this.host.querySelectorAll("details[open]"), nameOf));
    const cards = tables.map((table, k) => this.card(table, identity(tables, k), tables[k + 1]?.line, problems));
    // At first those that wait for a value.
    const waits = (k) => tables[k].keys.some(({ known }) => known === "missing");
    const order = tables.map((_, k) => k).sort((a, b) => waits(b) - waits(a));
    const ids = tables.map(({ files }, k) => `${files}\n${tables.slice(0, k).filter((other) => other.files === files).length}`);
    for (const k of order) if (!this.places.has(ids[k])) this.places.set(ids[k], this.places.size);
    const inOrder = order.sort((a, b) => this.places.get(ids[a]) - this.places.get(ids[b])).map((k) => cards[k]);
    this.host.replaceChildren(...inOrder);
    this.tables = tables;
    this.place(this.below.id);
    if (this.below.element.contains(active)) active.focus({ preventScroll: true });
    this.head = make("div", { className: "head" });
    this.host.prepend(this.head);
    this.listed();
    for (const fold of this.host.querySelectorAll("details")) fold.open = open.has(nameOf(fold));
    const none = problems.length ? "The text of the campaign, below, has an error. Once it is put right the tables come back." : "Nothing is measured yet. Choose “measure it as …” at a file, or write a table into the campaign below.";
    if (!tables.length) this.host.append(make("p", { textContent: none }));
    const input = field && this.host.querySelector(`[data-field="${CSS.escape(field)}"]`);
    if (!input) return;
    if (input.matches("input")) input.value = value;
    input.focus({ preventScroll: true });
    input.setSelectionRange?.(selectionStart, selectionEnd);
  }

  /** As `under`, while the cards are drawn. */
  place(id) {
    this.host.querySelector(`[data-table="${CSS.escape(id ?? "")}"]`)?.after(this.below.element);
  }

  /** Puts what stands below a card there. */
  under(id) {
    this.place(id);
    this.sizes.observe(this.below.element);
    this.pack();
  }

  /** Lists the values that are missing, and those that were typed and refused, as links. */
  listed() {
    const linked = (of, one, more) => {
      const links = this.tables.flatMap((table, k) => {
        const id = identity(this.tables, k);
        return table.keys.filter((row) => of(row, id, table)).map((row) => this.toField(id, table, row));
      });
      const words = `${links.length} ${links.length === 1 ? one : more}: `;
      return links.length ? [make("p", { className: "waits" }, words, ...links.flatMap((link, k) => (k ? [", ", link] : [link])))] : [];
    };
    // A record with an obstacle of its own is told below, with that.
    const stuck = ({ refused, line }) => refused && !line;
    const missing = linked(({ known }, _, table) => known === "missing" && !stuck(table), "value is missing", "values are missing");
    const refused = linked(({ key }, id) => this.wrong.has(`field-${id}-${key}`), "typed value was refused, and the report keeps the one before", "typed values were refused, and the report keeps those before");
    // Records without an answer for another reason; a name that no card has stands with its reason.
    const toCard = (k, textContent) => make("button", { className: "link", textContent, onclick: () => this.host.querySelector(`[data-table="${CSS.escape(identity(this.tables, k))}"]`).scrollIntoView({ block: "center" }) });
    const silent = [...this.tables.flatMap((table, k) => (stuck(table) ? [[toCard(k, table.files), table.refused]] : [])), ...this.refused.map(([record, why]) => {
      const k = this.tables.findIndex((table) => table.line && this.isOf(table, record));
      return [k < 0 ? record : toCard(k, record), why];
    })];
    const without = silent.length ? [make("p", { className: "waits" }, `${silent.length} ${silent.length === 1 ? "record gives" : "records give"} no answer: `, ...silent.flatMap(([one, why], k) => [k ? "; " : "", one, `: ${obstacle(why)}`]))] : [];
    this.head.replaceChildren(...without, ...missing, ...refused);
    this.head.hidden = !this.head.children.length;
  }

  /** A link to a field. */
  toField(id, table, row) {
    const { key } = row, find = () => {
      const field = this.host.querySelector(`[data-field="${CSS.escape(`${id} ${key}`)}"]`);
      field.closest("details")?.setAttribute("open", "");
      field.focus();
    };
    return make("button", { className: "link", textContent: `${labelOf(row)}, ${table.files || table.section}`, onclick: find });
  }

  card(table, id, next, problems) {
    const card = make("article", { className: "card" });
    card.dataset.table = id;
    card.append(make("h3", { textContent: table.files || table.section }));
    card.append(this.kindOf(table, id));
    const wrong = problems.filter(({ line }) => line && table.line && line >= table.line && line < (next ?? Infinity));
    // An error of a value stands below its field.
    const atKey = ({ line }) => table.keys.some((row) => row.line === line);
    const said = this.said(table, wrong.filter((one) => !atKey(one)).map(({ text }) => here(text)));
    for (const text of said) card.append(make("p", { className: "refused" }, ...inFields(text, table)));
    const of = ([record]) => table.line && (this.isOf(table, record) || this.covers(table, record));
    const pending = Array.from(this.wrong).filter(([field]) => field.startsWith(`field-${id}-`)).map(([, { why }]) => why);
    const numbers = this.numbers.filter(of);
    for (const [, [heads, ...rows]] of numbers) card.append(this.answer(heads, rows));
    if (pending.length && numbers.length) card.append(make("p", { className: "soft", textContent: "as before: the value that was refused is not in it" }));
    // Doubts first, then cautions that propose a value; a few are seen.
    const rank = ([, severity, text]) => (severity === "doubt" ? 2 : proposedIn([text]).length ? 1 : 0);
    const own = said.length ? [] : this.doubts.filter(of).sort((a, b) => rank(b) - rank(a));
    // The files of a pattern may have the same one.
    const doubts = own.filter(([,, text], k) => own.findIndex((other) => other[2] === text) === k);
    const lines = doubts.map(([, severity, text]) => make("p", { className: severity }, make("b", { textContent: severity }), " ", ...inFields(text, table)));
    const seen = Math.max(MOST_CAUTIONS, doubts.filter(([, severity]) => severity === "doubt").length), more = lines.splice(seen);
    card.append(...lines);
    if (more.length) card.append(make("details", { className: "cautions" }, make("summary", { textContent: more.length === 1 ? "1 more caution" : `${more.length} more cautions` }), ...more));
    const told = [...said, ...doubts.map(([,, text]) => text)];
    const proposed = proposedIn(told).filter(({ key, value }) => table.keys.some((row) => row.key === key && row.value !== value));
    // Found again when the card is drawn anew.
    const button = (textContent, onclick) => {
      const made = make("button", { textContent, onclick });
      made.dataset.field = `${id} ${textContent}`;
      return made;
    };
    const take = ({ key, value }) => button(`set ${fieldOf(table, key)} = ${value}`, () => this.set(id, key, value).catch((error) => { wrongs.textContent = here(error.message); }));
    const wrongs = make("span", { className: "wrong" });
    if (proposed.length) card.append(make("div", { className: "does" }, ...proposed.map(take), wrongs));
    // Keys that an error names stand with those that are in use; the title names the file.
    const named = namedIn([...told, ...pending, ...wrong.map(({ text }) => text)]), isTitle = (row) => row.key === "file" && fromToml(row.value) === table.files;
    // The unit is asked for where the file states none.
    const unitless = this.unitless(table), needed = namedIn(pending);
    const asked = (row) => {
      if (row.key === "unit" && unitless && row.known === "possible") return { ...row, known: "open", left_out: "such as m/s²", why: "the file states none: the values are used as they are" };
      // A value that was refused needs this one.
      return !row.value && needed.includes(row.key) && !this.wrong.has(`field-${id}-${row.key}`) ? { ...row, known: "missing" } : row;
    };
    // What is missing, proposed, guessed or changed stands first; what the files say is one of all settings.
    const stood = this.stood.get(id) ?? new Set();
    const matters = (row) => !isTitle(row) && (named.includes(row.key) || !["found", "possible"].includes(asked(row).known) && row.key !== "name");
    const used = table.keys.filter(matters);
    for (const row of [...used.filter(({ known }) => known === "missing"), ...used]) stood.add(row.key);
    this.stood.set(id, stood);
    const rows = (all) => all.map((row) => this.row(asked(row), id, table));
    card.append(...rows(Array.from(stood, (key) => table.keys.find((row) => row.key === key)).filter(Boolean)));
    for (const { line, text } of wrong) {
      const input = card.querySelector(`[data-line="${line}"]`);
      input?.setAttribute("aria-invalid", "true");
      const below = input?.parentElement.querySelector(".wrong");
      if (below) below.textContent ||= here(text);
    }
    const rest = table.keys.filter(({ key }) => !stood.has(key)), summary = make("summary", { textContent: `all settings (${rest.length} more)` });
    summary.dataset.field = `${id} settings`;
    if (rest.length) card.append(make("details", { className: "settings" }, summary, ...rows(rest.filter(({ shared }) => !shared)), ...rows(rest.filter(({ shared }) => shared))));
    const does = make("div", { className: "does" });
    if (valueOf(table, "file") && this.isTrace(table)) {
      does.append(button("see the record", () => this.look(id)));
    }
    if (table.line) does.append(button("in the text", () => this.find(table.line)));
    card.append(does);
    return card;
  }

  /** Whether a record has the name of a table. */
  isOf(table, record) { return [fromToml(valueOf(table, "name")), table.files].includes(record); }

  /** Whether a record is a file of a table, or one of its pattern. */
  covers(table, record) {
    const base = (path) => path.split("/").pop(), plain = (text) => text.replace(/[.+?^${}()|[\]\\]/g, "\\$&");
    const names = [...table.files.split(", "), fromToml(valueOf(table, "file"))].filter(Boolean);
    return names.some((name) => new RegExp(`^${plain(base(name)).replaceAll("*", ".*")}$`).test(base(record)));
  }

  /** The main numbers of a record: one row as a list, several as a table. */
  answer(heads, rows) {
    // A unit of a row stands behind its number.
    const units = heads.indexOf("unit"), without = (cells) => cells.filter((_, k) => k !== units);
    const named = without(heads), valued = rows.map((row) => without(row.map((cell, k) => (units > 0 && k === units - 1 ? `${cell} ${row[units]}`.trim() : cell))));
    if (rows.length > 1) {
      const line = (cells, tag) => make("tr", {}, ...cells.map((textContent) => make(tag, { textContent })));
      return make("div", { className: "answer" }, make("table", {}, line(named, "th"), ...valued.map((row) => line(row, "td"))));
    }
    // So does that of the head.
    const parts = named.map((head, k) => [head.match(/^(.*?)(?: \((.*)\))?$/), valued[0][k]]);
    return make("p", { className: "answer" }, ...parts.flatMap(([[, name, unit], value], k) => [k ? ", " : "", `${name} `, make("b", { textContent: [value, unit].filter(Boolean).join(" ") })]));
  }

  /** Why a table gives no answer, and what else is said of it. */
  said(table, more = []) {
    const said = table.refused && !table.line ? [table.refused] : [];
    said.push(...(table.line ? this.refused : []).filter(([record]) => this.isOf(table, record)).map(([, why]) => here(why)), ...more);
    // The same reason may stand in a longer sentence.
    return said.filter((text, k) => said.every((other, i) => i === k || !other.includes(text) || (other === text && i > k)));
  }

  /** The kind of a table, which can be changed where it is of one file. */
  kindOf(table, id) {
    const about = [table.about, table.guess ? "guessed" : ""].filter(Boolean).join(", ");
    const known = this.kinds.some(([section]) => section === table.section);
    if (!known || !valueOf(table, "file")) return make("p", { className: "kind", textContent: about || table.section });
    const choice = make("select", { title: "Measure it as another kind" });
    choice.setAttribute("aria-label", `Kind of ${table.files}`);
    choice.dataset.field = `${id} kind`;
    this.kinds.forEach(([section, title]) => choice.append(make("option", { value: section, textContent: title, selected: section === table.section })));
    choice.onchange = () => this.kind(id, choice.value);
    return make("p", { className: "kind", title: about }, choice, table.guess ? " guessed" : "");
  }

  row(one, table, of) {
    const { key, value, known, why, line, unit, meaning, rest, left_out: without } = one, isList = /[[…]/.test(meaning ?? "");
    const id = `field-${table}-${key}`, { picks, all } = choices(one, of, this.channels), plain = fromToml(value);
    const isChoice = all && ["", ...picks].includes(plain), empty = known === "missing" ? "choose" : `not set: ${without ?? ""}`.replaceAll("`", "");
    const option = (choice) => make("option", { value: choice, textContent: choice || empty, selected: choice === plain });
    const input = isChoice ? make("select", { id }, ...["", ...picks].map(option)) : make("input", { id, value: plain, autocomplete: "off", spellcheck: false });
    const example = (isList ? PAIR_AS : SUCH_AS)[unit], such = example && `such as ${example}`;
    if (!isChoice) input.title = input.placeholder = known === "missing" ? such ?? "" : [without ? `not set: ${without.replaceAll("`", "")}` : "", isList && such].filter(Boolean).join(", or ");
    // A value of several lines is changed in the text.
    input.readOnly = value.includes("\n");
    [input.dataset.field, input.dataset.line] = [`${table} ${key}`, line ?? ""];
    // A value that was refused without another one is taken with it.
    if (value && this.wrong.get(id)?.toml === value) this.wrong.delete(id);
    const wrong = make("span", { className: "wrong" }), refused = this.wrong.get(id);
    let sent = input.value;
    if (refused) {
      [input.value, wrong.textContent] = [refused.value, refused.why];
      sent = refused.value;
      input.setAttribute("aria-invalid", "true");
    }
    input.onchange = input.onblur = async () => {
      if (input.value === sent || input.readOnly || this.redraws) return;
      let toml;
      [sent, wrong.textContent] = [input.value, ""];
      this.wrong.delete(id);
      input.removeAttribute("aria-invalid");
      try {
        toml = toToml(input.value, unit, isList);
        // Values that were refused may go with this one.
        const also = Array.from(this.wrong).filter(([field, { toml }]) => toml && field.startsWith(`field-${table}-`)).map(([field, { toml }]) => [field.slice(`field-${table}-`.length), toml]);
        await this.set(table, key, toml, also);
      } catch (error) {
        this.wrong.set(id, { value: input.value, toml, why: here(error.message) });
        this.told();
        this.show(this.tables, this.problems);
      }
    };
    // A field that was drawn anew while it was typed in has not changed for the browser.
    input.onkeydown = (event) => { if (event.key === "Enter") input.onchange(); };
    // What it means, below it: over other fields it would hide them.
    const state = ["guessed", "missing"].includes(known) ? known : "", more = (why || rest || "").replaceAll("`", "");
    const reason = [state, more].filter(Boolean).join(": ");
    const label = make("label", { htmlFor: id }, labelOf(one), " ", make("code", { textContent: key }));
    const row = make("div", { className: `row ${known}` }, label, input, ...(unit ? [make("span", { className: "unit", textContent: unit })] : []));
    if (picks.length && !isChoice) {
      input.setAttribute("list", `${id}-picks`);
      row.append(make("datalist", { id: `${id}-picks` }, ...picks.map((value) => make("option", { value }))));
    }
    row.append(wrong);
    if (reason) {
      row.append(make("span", { className: "why", id: `${id}-why`, textContent: reason }));
      input.setAttribute("aria-describedby", `${id}-why`);
    }
    return row;
  }
}

/** An error without the line of the text at which it stands: that is shown in the text. */
const inShort = (message) => message.split("\n").filter((line) => !/^\s*(\d+\s*)?\|/.test(line)).join("\n").replaceAll(/\S*campaign\.toml, (line \d+), column \d+: /g, "$1: ");

/** An error at its field. */
const here = (message) => inShort(message).replaceAll(/\bline \d+: /g, "");

/** Parts and multiples of a unit. */
const STEPS = { µ: 1e-6, u: 1e-6, m: 1e-3, c: 1e-2, "": 1, k: 1e3, M: 1e6 };

/** May be a thousand, or one with decimals. */
const THOUSAND = /\d,\d{3}(?!\d)/;

/** A number that a person types with its unit, in the unit of the key: 57 cm as 0.57 where that is m. */
function inUnit(text, unit) {
  const found = text.match(/^([-+]?[\d.,]+(?:[eE][-+]?\d+)?)\s*([^-+\d\s.,].*)$/);
  if (!found || !unit || Number.isFinite(Number(text.replace(",", ".")))) return text;
  const [, number, behind] = found, value = Number(number.replace(",", "."));
  if (!Number.isFinite(value) || THOUSAND.test(number)) return text;
  const typed = behind.replaceAll("^2", "²").replaceAll(/[\s·*]/g, ""), base = unit === "kg" ? "g" : unit;
  const step = typed.endsWith(base) ? STEPS[typed.slice(0, -base.length)] : undefined;
  if (step === undefined) throw new Error(`${text}: this is in ${unit}. Type the number alone, or with ${unit}`);
  return String(Number((value * step / (unit === "kg" ? 1e3 : 1)).toPrecision(12)));
}

/** Two or more numbers that a person types without brackets, such as 0.5; 3 s, as a list in the unit of the key. The last unit holds for numbers without one. */
function asList(text, unit) {
  const parts = text.replace(/^\[|\]$/g, "").split(/;|,\s+|(?<=[\d.])\s+(?=[-+.\d])|(?<=[^\W\d_])\s+(?=[-+.\d])|(?<=\.\d+),(?=\d+\.)/).map((part) => part.trim()).filter(Boolean);
  const last = parts.at(-1)?.match(/[^-+\d\s.,eE].*$/)?.[0] ?? "";
  const values = parts.map((part) => inUnit(/[^-+\d\s.,eE]/.test(part) ? part : `${part}${last}`, unit).replace(/^(-?\d+),(\d+)$/, "$1.$2"));
  return parts.length > 1 && !THOUSAND.test(text) && values.every((value) => Number.isFinite(Number(value))) ? `[${values.join(", ")}]` : null;
}

/** A value as a person types it, in TOML. */
function toToml(typed, unit = "", isList = true) {
  if (unit && !isList && /^[-+]?\d[\d.,]*\s+\d/.test(typed.trim())) throw new Error(`${typed}: one number is wanted here. Type it without a gap`);
  // 1,000 may be a thousand: it stays text, which no number takes.
  const text = unit ? (isList ? asList(typed.trim(), unit) : null) ?? inUnit(typed.trim(), unit) : typed.trim(), number = text.replace(/^(-?\d+),(?!\d{3}$)(\d+)$/, "$1.$2").replace(/^(-?)\./, "$10.");
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

/** Values to choose from: the channels of the file, or what the meaning of the key lists. */
function choices({ key, meaning = "" }, table, channels) {
  if (OF_CHANNEL.includes(key)) return channels(table).filter((name) => name !== "");
  const keys = table.keys.map((row) => row.key);
  const listed = Array.from(meaning.matchAll(/`([a-z][a-z0-9/-]*)`/g), ([, word]) => word).filter((word) => !keys.includes(word));
  return listed.length === 1 && listed[0] === "true" ? ["true", "false"] : listed;
}

/** Keys that an error names, such as `low_pass`. */
const namedIn = (texts) => texts.flatMap((text) => Array.from(text.matchAll(/`([a-z_]+)(?: = [^`]*)?`/g), ([, key]) => key));

/** What tells a table from the others, wherever it stands in the list. */
function identity(tables, k) {
  const of = (table) => [table.section, table.files, valueOf(table, "channel")].join("\n");
  const own = of(tables[k]);
  return `${own}\n${tables.slice(0, k).filter((table) => of(table) === own).length}`;
}

/** The tables of the campaign as cards with fields. */
class Tables {
  /**
   * `set(identity, key, value)` states a value; `kind(identity, section)` makes it another kind;
   * `look(identity)` shows the trace; `find(line)` shows the text; `channels(table)` are those of its file.
   */
  constructor(host, { set, kind, look, find, channels }) {
    Object.assign(this, { host, set, kind, look, find, channels, kinds: [] });
    // Values that were refused stand, with the reason, until they are typed anew.
    [this.refused, this.redraws, this.wrong] = [[], false, new Map()];
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
    const nameOf = (fold) => `${fold.parentElement.dataset.table}\n${fold.className}`;
    const open = new Set(Array.from(this.host.querySelectorAll("details[open]"), nameOf));
    this.host.replaceChildren(...tables.map((table, k) => this.card(table, identity(tables, k), tables[k + 1]?.line, problems)));
    this.tables = tables;
    this.head = make("div");
    this.host.prepend(this.head);
    this.listed();
    for (const fold of this.host.querySelectorAll("details")) fold.open = open.has(nameOf(fold));
    const none = problems.length ? "The text of the campaign, below, has an error. Once it is put right the tables come back." : "Nothing is measured yet. Choose “measure it as …” at a file, or write a table into the campaign below.";
    if (!tables.length) this.host.append(make("p", { textContent: none }));
    const input = field && this.host.querySelector(`[data-field="${CSS.escape(field)}"]`);
    if (!input) return;
    input.value = value;
    input.focus();
    input.setSelectionRange?.(selectionStart, selectionEnd);
  }

  /** Lists the values that are missing, and those that were typed and refused, as links. */
  listed() {
    const linked = (of, one, more) => {
      const links = this.tables.flatMap((table, k) => {
        const id = identity(this.tables, k);
        return table.keys.filter((row) => of(row, id)).map(({ key }) => this.toField(id, table, key));
      });
      const words = links.length === 1 ? `One value ${one}: ` : `${links.length} values ${more}: `;
      return links.length ? [make("p", { className: "waits" }, words, ...links.flatMap((link, k) => (k ? [", ", link] : [link])))] : [];
    };
    const missing = linked(({ known }) => known === "missing", "is missing", "are missing");
    const refused = linked(({ key }, id) => this.wrong.has(`field-${id}-${key}`), "is not taken, the report has the one before", "are not taken, the report has those before");
    this.head.replaceChildren(...missing, ...refused);
  }

  /** A link to a field. */
  toField(id, table, key) {
    const find = () => {
      const field = this.host.querySelector(`[data-field="${CSS.escape(`${id} ${key}`)}"]`);
      field.closest("details")?.setAttribute("open", "");
      field.focus();
    };
    return make("button", { className: "link", textContent: `${key.replaceAll("_", " ")} of ${table.files || table.section}`, onclick: find });
  }

  card(table, id, next, problems) {
    const card = make("article", { className: "card" });
    card.dataset.table = id;
    card.append(make("h3", { textContent: table.files || table.section }));
    card.append(this.kindOf(table, id));
    const name = fromToml(valueOf(table, "name")), said = table.refused && !table.line ? [table.refused] : [];
    said.push(...(table.line ? this.refused : []).filter(([record]) => record === name || record === table.files).map(([, why]) => here(why)));
    const wrong = problems.filter(({ line }) => line && table.line && line >= table.line && line < (next ?? Infinity));
    // An error of a value stands below its field.
    const atKey = ({ line }) => table.keys.some((row) => row.line === line);
    said.push(...wrong.filter((one) => !atKey(one)).map(({ text }) => here(text)));
    // The same reason may stand in a longer sentence.
    const whole = (text, k) => said.every((other, i) => i === k || !other.includes(text) || (other === text && i > k));
    for (const text of said.filter(whole)) card.append(make("p", { className: "refused", textContent: text }));
    // Keys that an error names stand with those that are in use; the title names the file.
    const named = namedIn([...said, ...wrong.map(({ text }) => text)]), isTitle = (row) => row.key === "file" && fromToml(row.value) === table.files;
    const shown = (row) => (isTitle(row) || (row.known === "possible" && row.shared && !named.includes(row.key)) ? "reading" : named.includes(row.key) && ["open", "possible"].includes(row.known) ? "named" : row.known);
    const rows = (...known) => table.keys.filter((row) => known.includes(shown(row))).map((row) => this.row(row, id, table));
    card.append(...rows("missing"), ...rows("named"), ...rows("guessed", "stated", "found"));
    for (const { line, text } of wrong) {
      const input = card.querySelector(`[data-line="${line}"]`);
      input?.setAttribute("aria-invalid", "true");
      const below = input?.parentElement.querySelector(".wrong");
      if (below) below.textContent ||= here(text);
    }
    const folds = { open: (n) => `${n} more that would help`, possible: (n) => `${n} further keys`, reading: (n) => `${n} on how the file is read` };
    for (const [known, title] of Object.entries(folds)) {
      const all = rows(known);
      if (all.length) card.append(make("details", { className: known }, make("summary", { textContent: title(all.length) }), ...all));
    }
    const does = make("div", { className: "does" });
    if (valueOf(table, "file")) {
      does.append(make("button", { textContent: "see the record", onclick: () => this.look(id) }));
    }
    if (table.line) does.append(make("button", { textContent: "in the text", onclick: () => this.find(table.line) }));
    card.append(does);
    return card;
  }

  /** The kind of a table, which can be changed where it is of one file. */
  kindOf(table, id) {
    const about = [table.about, table.guess ? "guessed" : ""].filter(Boolean).join(", ");
    const known = this.kinds.some(([section]) => section === table.section);
    if (!known || !valueOf(table, "file")) return make("p", { className: "kind", textContent: about || table.section });
    const choice = make("select", { title: "Measure it as another kind" });
    choice.setAttribute("aria-label", `Kind of ${table.files}`);
    this.kinds.forEach(([section, title]) => choice.append(make("option", { value: section, textContent: title, selected: section === table.section })));
    choice.onchange = () => this.kind(id, choice.value);
    const title = this.kinds.find(([section]) => section === table.section)[1];
    return make("p", { className: "kind" }, choice, about && about !== title ? ` ${about}` : "");
  }

  row(one, table, of) {
    const { key, value, known, why, line, unit, meaning, left_out: without } = one;
    const id = `field-${table}-${key}`, picks = choices(one, of, this.channels);
    const isSwitch = picks.join() === "true,false" && ["", ...picks].includes(value);
    const input = isSwitch ? make("select", { id }, ...["", ...picks].map((choice) => make("option", { value: choice, textContent: choice, selected: choice === value }))) : make("input", { id, value: fromToml(value), autocomplete: "off", spellcheck: false });
    // A value of several lines is changed in the text.
    input.readOnly = value.includes("\n");
    [input.dataset.field, input.dataset.line] = [`${table} ${key}`, line ?? ""];
    const wrong = make("span", { className: "wrong" }), refused = this.wrong.get(id);
    let sent = input.value;
    if (refused) {
      [input.value, wrong.textContent] = [refused.value, refused.why];
      sent = refused.value;
      input.setAttribute("aria-invalid", "true");
    }
    input.onchange = input.onblur = async () => {
      if (input.value === sent || input.readOnly || this.redraws) return;
      [sent, wrong.textContent] = [input.value, ""];
      this.wrong.delete(id);
      input.removeAttribute("aria-invalid");
      try {
        await this.set(table, key, toToml(input.value, unit, /[[…]/.test(meaning ?? "")));
      } catch (error) {
        wrong.textContent = here(error.message);
        this.wrong.set(id, { value: input.value, why: wrong.textContent });
        input.setAttribute("aria-invalid", "true");
        this.listed();
      }
    };
    // A field that was drawn anew while it was typed in has not changed for the browser.
    input.onkeydown = (event) => { if (event.key === "Enter") input.onchange(); };
    const reason = known === "guessed" ? `guessed: ${why}` : known === "missing" ? `missing: ${why || meaning}` : why;
    const label = make("label", { htmlFor: id, textContent: key.replaceAll("_", " "), title: key });
    const row = make("div", { className: `row ${known}` }, label, input, make("span", { className: "unit", textContent: unit ?? "" }));
    if (picks.length && !isSwitch) {
      input.setAttribute("list", `${id}-picks`);
      row.append(make("datalist", { id: `${id}-picks` }, ...picks.map((value) => make("option", { value }))));
    }
    // Shown while the field is used.
    if (meaning) {
      const means = `${meaning}; left out: ${without}`.replaceAll("`", "");
      row.append(make("span", { className: "means", id: `${id}-means`, textContent: means }));
      input.setAttribute("aria-describedby", `${id}-means`);
    }
    if (reason) row.append(make("span", { className: "why", textContent: reason }));
    row.append(wrong);
    return row;
  }
}

/** The text of the campaign, with the numbers of its lines and its errors beside them. */
class Editor {
  constructor(root, changed) {
    this.fold = root;
    [this.lines, this.text, this.problems] = ["lines", "text", "problems"].map((id) => document.getElementById(id));
    this.changed = changed;
    this.text.addEventListener("input", () => {
      this.number([]);
      clearTimeout(this.later);
      this.later = setTimeout(() => this.flush().catch(() => {}), 500);
    });
  }

  /** Hands over what was typed and is not known yet. */
  async flush() {
    clearTimeout(this.later);
    const text = this.text.value, before = this.known;
    if (before === undefined || text === before) return;
    this.known = text;
    await this.changed(text).catch((error) => {
      // What the program does not have is handed over again.
      if (this.known === text) this.known = before;
      throw error;
    });
  }

  show(text, problems) {
    // What is being typed, and not yet known, stays as it is.
    if (document.activeElement !== this.text || this.text.value === this.known) {
      if (this.text.value !== text) this.text.value = text;
      // With the ends of lines that the browser makes of them.
      this.known = this.text.value;
    }
    this.number(problems.map(({ line }) => line));
    const item = ({ text: words, line }) => {
      const row = make("li", { textContent: `${inShort(words)} ` });
      if (line) row.append(make("button", { className: "link", textContent: `to line ${line}`, onclick: () => this.find(line) }));
      return row;
    };
    this.problems.replaceChildren(...problems.map(item));
    if (problems.some(({ line }) => line)) this.fold.open = true;
  }

  number(wrong) {
    const n = this.text.value.split("\n").length;
    this.text.rows = n;
    this.lines.replaceChildren(...Array.from({ length: n }, (_, k) => make(wrong.includes(k + 1) ? "b" : "span", { textContent: `${k + 1}\n` })));
  }

  find(line) {
    this.fold.open = true;
    const before = this.text.value.split("\n").slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
    this.text.focus({ preventScroll: true });
    this.text.setSelectionRange(before, before + this.text.value.slice(before).indexOf("\n"));
    this.lines.children[line - 1]?.scrollIntoView({ block: "center" });
  }
}

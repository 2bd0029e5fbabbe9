const at = (id) => document.getElementById(id);

/** Words of the button that keeps the files, whenever what is kept is not what there is. */
const KEEP = "keep all in this browser";

/** Script of the report in its frame: a link to a file saves it, and the place on the page outlives a new report. */
const IN_REPORT = `<script>
addEventListener("click", (event) => {
  const link = event.target.closest?.("a[href^='./']");
  if (!link) return;
  event.preventDefault();
  parent.postMessage({ file: decodeURIComponent(link.getAttribute("href").slice(2)) }, "*");
}, true);
addEventListener("keydown", (event) => event.key === "Escape" && parent.postMessage({ back: true }, "*"));
addEventListener("scroll", () => parent.postMessage({ scroll: scrollY }, "*"));
addEventListener("load", () => setTimeout(() => scrollTo(0, SCROLL), 50));
<\/script>`;

/** The report without links to files that do not lie beside it. */
function withoutFiles(bytes) {
  const html = new TextDecoder().decode(bytes);
  return new TextEncoder().encode(html.replace("</head>", () => "<style>a[href^='./'] { display: none; }</style></head>"));
}

/** Whether two paths end in one name. */
const isSameFile = (path, file) => path?.split("/").pop() === file.split("/").pop();

/** The page: files, campaign, report. */
class App {
  constructor() {
    this.program = new Program((progress) => this.progress(progress));
    [this.files, this.name, this.example, this.text] = [[], "", null, ""];
    [this.tables, this.problems, this.results, this.scroll] = [[], [], null, 0];
    // Earlier texts of the campaign, and those that were taken back.
    [this.history, this.undone] = [[], []];
    const measure = (path, section) => this.editor.flush().then(() => this.edit((text) => `${text.trimEnd()}\n\n[[${section}]]\nfile = ${JSON.stringify(path)}\n`)).catch((error) => this.trouble(error.message));
    this.recordings = new Recordings(at("recordings"), { pictures: (path) => this.pictures(path), measure });
    const set = (id, key, value, also = []) => this.change(id, "state", { key, value, also });
    const kind = (id, section) => this.change(id, "kind", { section }).catch((error) => this.trouble(error.message));
    const look = (id) => this.trace.open(this.tables, id).catch((error) => this.trouble(error.message));
    const fileOf = (table) => fromToml(valueOf(table, "file")), below = { element: at("trace") };
    this.cards = new Tables(at("tables"), { set, kind, refused: () => this.steps(), look, below, find: (line) => this.editor.find(line), channels: (table) => this.recordings.channels(fileOf(table)), unitless: (table) => this.recordings.unitless(fileOf(table), fromToml(valueOf(table, "channel"))), isTrace: (table) => this.recordings.isTrace(fileOf(table)) });
    this.editor = new Editor(at("campaign"), (text) => this.edit(text));
    // Edited: not as it was proposed. Unsaved: the edits are nowhere else.
    [this.edited, this.unsaved, this.setting, this.looking] = [false, false, Promise.resolve(), Promise.resolve()];
    const ask = (what, more) => this.program.ask(what, more);
    // Stopped, the program gets its files again.
    const attempt = (more) => this.work("trying what is proposed", () => ask("try", more).catch((error) => {
      if (error instanceof Refused) return null;
      throw error;
    }));
    const stand = (id) => { below.id = id; this.cards.under(id); };
    this.trace = new TraceView(at("trace"), { ask, attempt, set, stand, events: (...of) => this.events(...of), inBand: (...of) => this.inBand(...of), said: (table) => this.cards.said(table) });
    this.drawn = new Map();
    this.wire();
    this.program.ready.then(() => { document.body.dataset.ready = "yes"; }, (error) => this.trouble(`This browser cannot run the program: ${error.message}`));
  }

  wire() {
    at("choose-files").onclick = at("add").onclick = () => at("files").click();
    at("choose-folder").onclick = () => at("folder").click();
    for (const id of ["files", "folder"]) {
      at(id).onchange = () => { this.take(chosen(at(id))); at(id).value = ""; };
    }
    for (const button of document.querySelectorAll("[data-example]")) button.onclick = () => this.look({ example: button.dataset.example });
    at("anew").onclick = () => location.reload();
    for (const [id, from, to] of [["undo", "history", "undone"], ["redo", "undone", "history"]]) {
      at(id).onclick = () => {
        // A value that was refused is in no text: it goes first.
        if (id === "undo" && this.cards.wrong.size) this.cards.withoutWrong();
        else this.step(this[from], this[to]).catch((error) => this.trouble(error.message));
      };
    }
    // In a field or in the text the browser takes back what was typed.
    addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.target.closest("input, textarea")) return;
      const id = { z: event.shiftKey ? "redo" : "undo", y: "redo" }[event.key.toLowerCase()];
      if (id) at(id).click();
    });
    at("to-report").onclick = at("alone").onclick = () => this.read(true);
    at("back").onclick = () => this.read(false);
    addEventListener("keydown", (event) => event.key === "Escape" && document.body.classList.contains("reading") && this.read(false));
    at("again").onclick = () => this.look({ files: this.files, name: this.name, example: this.example, known: this.edited ? this.text : null });
    at("stop").onclick = () => this.program.end("stopped");
    at("save-report").onclick = at("save-read").onclick = () => this.save("report.html", "text/html");
    at("save-campaign").onclick = () => this.save("campaign.toml", "text/plain");
    at("save-all").onclick = () => this.work("packing", async () => {
      await this.editor.flush();
      save(`${this.name || "results"}.zip`, await this.program.ask("archive"), "application/zip");
      this.unsaved = false;
    });
    at("keep").onclick = () => this.keep();
    const over = (on) => (event) => { event.preventDefault(); document.body.classList.toggle("over", on); };
    addEventListener("dragover", over(true));
    addEventListener("dragleave", over(false));
    addEventListener("drop", async (event) => {
      over(false)(event);
      this.take(await dropped(event.dataTransfer).catch(() => []));
    });
    // The browser asks before it closes a page with changes that were neither saved nor kept.
    addEventListener("beforeunload", (event) => this.unsaved && event.preventDefault());
    const redraw = () => this.trace.id !== undefined && this.trace.data && this.trace.draw();
    addEventListener("resize", redraw);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    addEventListener("message", ({ source, data }) => {
      if (source !== at("report").contentWindow) return;
      if (typeof data.scroll === "number") this.scroll = data.scroll;
      if (typeof data.file === "string") this.save(data.file);
      if (data.back) this.read(false);
    });
    shelf.get().then((kept) => kept && this.offer(kept), () => {});
  }

  /** The report alone on the page, or below the files. */
  read(alone) {
    if (alone) this.place = scrollY;
    document.body.classList.toggle("reading", alone);
    at(alone ? "report" : "to-report").focus({ preventScroll: true });
    if (!alone) scrollTo(0, this.place);
  }

  /** Kept files are taken up only if the person says so. */
  offer(kept) {
    const again = make("button", { textContent: `go on with ${kept.name}, kept in this browser` });
    again.onclick = () => { again.remove(); this.look(kept); };
    const forget = make("button", { textContent: "forget it" });
    forget.onclick = () => shelf.clear().then(() => { again.remove(); forget.remove(); }, () => {});
    at("drop").append(make("p", {}, again, " ", forget));
  }

  keep() {
    return this.work("keeping", async () => {
      const files = await Promise.all(this.files.map(async ({ path, file, packed }) => ({ path, packed, file: new Blob([await file.arrayBuffer()]) })));
      await this.editor.flush();
      await shelf.put({ name: this.name, files, example: this.example, text: this.text });
      at("keep").textContent = "kept";
      this.unsaved = false;
    });
  }

  /** Takes files to those that are there. */
  take(dropped) { return this.inTurn(() => this.taken(dropped)); }

  /** Begins with other files. */
  look(what) { return this.inTurn(() => this.begin(what)); }

  /** One set of files after another. */
  inTurn(todo) {
    this.looking = this.looking.then(todo).catch((error) => this.trouble(error.message));
    return this.looking;
  }

  async taken(dropped) {
    const lost = dropped.filter(({ problem }) => problem), files = dropped.filter(({ problem }) => !problem);
    const said = lost.map(({ path, problem }) => `${path} ${problem}`);
    if (files.length) {
      await this.editor.flush();
      const { name, files: own } = inFolder(files);
      const before = this.example ? [] : this.files;
      const known = new Map(before.map((one) => [one.path, one]));
      for (const { path, file, packed } of own) {
        const same = (held) => held.size === file.size && held.lastModified === file.lastModified;
        let free = path;
        for (let k = 2; known.has(free) && !same(known.get(free).file); k++) free = path.replace(/(\.[^./]*)?$/, ` (${k})$1`);
        if (free !== path) said.push(`${path} was there already: the new file is ${free}`);
        known.set(free, { path: free, file, packed: packed && before.length === 0 });
      }
      // What a person changed stays: tables for further files are added at its end.
      await this.begin({ files: Array.from(known.values()), name: before.length ? this.name : name, known: this.edited && before.length ? this.text : null });
    }
    said.forEach((text) => this.trouble(text));
  }

  /** Lists the files, and runs the campaign for them. Where that fails, all stays as it was. */
  async begin({ files = [], name = "", example = null, text = null, known = null }) {
    const before = { files: this.files, name: this.name, example: this.example };
    at("troubles").replaceChildren();
    const all = files.reduce((sum, { file }) => sum + file.size, 0);
    if (all > MOST_BYTES) {
      const largest = files.reduce((a, b) => (b.file.size > a.file.size ? b : a));
      return this.trouble(`${Math.round(all / 1e6)} MB are more than a page holds; the largest file is ${largest.path} with ${Math.round(largest.file.size / 1e6)} MB. Drop fewer files, or use the command on this computer: vibro run ${JSON.stringify(name)}`);
    }
    Object.assign(this, { files, name: example ?? name, example });
    const listed = await this.work("reading files", () => this.load());
    if (!listed) {
      Object.assign(this, before);
      if (this.files.length || this.example) await this.restore();
      return undefined;
    }
    this.drawn.clear();
    this.trace.close();
    if (known === null) this.cards.forget();
    [at("bench").hidden, at("drop").hidden] = [false, true];
    at("keep").textContent = KEEP;
    if (known === null) [this.results, this.edited, this.unsaved, this.history, this.undone, at("report").srcdoc] = [null, false, false, [], [], ""];
    this.recordings.show(listed.recordings);
    const found = await this.work("looking at files", () => this.program.ask("propose", { known }));
    this.recordings.showLeft(found?.left ?? [], found?.kinds ?? []);
    if (found?.none && !found.tables.length) this.trouble(found.none);
    // A campaign among the files is a person's: further files are added to it.
    if (found?.own) this.edited = true;
    at("unseen").hidden = found !== null;
    if (text !== null) return this.changed(() => this.program.ask("edit", { text }), false);
    if (known !== null && found) this.history.push(known);
    // Stopped, the page goes on with what it had.
    if (found) return this.state(found);
    return this.changed(() => this.program.ask("edit", { text: known ?? `name = ${JSON.stringify(this.name)}\n` }), false);
  }

  /** Gives the program that began anew its files and the campaign. */
  async restore() {
    await this.load();
    Object.assign(this, await this.program.ask("edit", { text: this.text }));
    this.cards.show(this.tables, this.problems);
    at("unseen").hidden = false;
  }

  /** Gives the program its files; also after it was stopped. */
  async load() {
    await this.program.ready;
    if (this.example) await this.program.ask("example", { name: this.example });
    else {
      await this.program.begin(this.name);
      for (const [k, { path, file, packed }] of this.files.entries()) {
        this.progress({ what: `reading ${path}`, done: k, all: this.files.length });
        await this.program.add(path, file).catch((error) => this.without(error));
        if (packed) await this.program.ask("unpack", { path }).catch((error) => this.without(error));
      }
    }
    return this.program.ask("look");
  }

  /** One file that cannot be used loses only itself. */
  without(error) {
    if (!(error instanceof Refused)) throw error;
    this.trouble(error.message);
  }

  /** Goes to the last text of one list, and puts the one that there is on the other. */
  async step(from, to) {
    await this.editor.flush();
    const text = from.pop();
    if (text === undefined) return;
    to.push(this.text);
    await this.changed(() => this.program.ask("edit", { text }), false);
  }

  /** Whether there is a change to take back, and one to make again. */
  steps() {
    at("undo").disabled = !this.history.length && !this.cards.wrong.size;
    at("redo").disabled = !this.undone.length;
  }

  async state({ text, tables, problems, kinds }) {
    this.steps();
    Object.assign(this, { text, tables, problems });
    this.cards.kinds = kinds;
    this.cards.show(tables, problems);
    this.editor.show(text, problems);
    await this.run();
  }

  /** One change of the campaign after another: each finds the text and the tables that the one before left. */
  changed(todo, isStep = true) {
    const next = this.setting.catch(() => {}).then(async () => {
      at("troubles").replaceChildren();
      const before = this.text, after = await todo();
      if (isStep && after.text !== before) {
        this.history.push(before);
        this.undone.length = 0;
        [this.edited, this.unsaved] = [true, true];
        at("keep").textContent = KEEP;
      }
      [this.text, this.tables] = [after.text, after.tables];
      return after;
    });
    this.setting = next;
    return next.then((after) => this.state(after));
  }

  /** Changes a table, wherever it stands in the list by then. */
  change(id, what, more) {
    return this.changed(() => {
      const table = this.tables.findIndex((_, k) => identity(this.tables, k) === id);
      if (table < 0) throw new Error("this table has changed meanwhile: type it again");
      return this.program.ask(what, { table, ...more });
    });
  }

  /** Takes a text, or what a function makes of the one that there is. */
  edit(text) {
    return this.changed(() => this.program.ask("edit", { text: typeof text === "function" ? text(this.text) : text }));
  }

  /** Runs the campaign as it is now; of several changes only the last one. */
  async run() {
    if (this.running) {
      this.again = true;
      return;
    }
    this.running = true;
    let done = null;
    try {
      do {
        this.again = false;
        this.stale(true, "The answers to the last change are being computed: the report is still the one before.");
        done = await this.work("running", () => this.program.ask("run").then((found) => this.report().then(() => found)), true);
        if (done) Object.assign(this.cards, { refused: done.refused, numbers: done.numbers, doubts: done.doubts });
        // Without an answer no mark stands for the campaign as it is.
        else this.results = null;
        this.cards.show(this.tables, this.problems);
      } while (this.again);
    } finally {
      this.running = false;
    }
    this.stale(done === null, "The last change gave no report: this one is of the campaign before it.", "troubles");
    await this.trace.refresh(this.tables);
    document.body.dataset.runs = String(1 + Number(document.body.dataset.runs ?? 0));
  }

  /** Says that the report is not of the campaign as it is, and why. */
  stale(is, why, className = "soft") {
    Object.assign(at("stale"), { textContent: why, className, hidden: !is || !at("report").srcdoc });
  }

  async report() {
    const text = new TextDecoder(), file = async (name) => text.decode(await this.program.ask("file", { name }));
    const html = await file("report.html");
    this.results = JSON.parse(await file("results.json"));
    const meta = document.querySelector("meta[http-equiv]").outerHTML;
    at("report").srcdoc = html.replace("<head>", () => `<head>${meta}`).replace("</body>", () => `${IN_REPORT.replace("SCROLL", String(this.scroll))}</body>`);
  }

  /** Whether impacts were found in a band, which the program chose. */
  inBand({ section }, file) {
    const list = { impacts: this.results?.impacts, drop: this.results?.drops }[section] ?? [];
    return list.some((one) => [one.file, ...one.files ?? []].some((path) => isSameFile(path, file)) && one.findings?.some(({ code }) => code === "impacts-in-band"));
  }

  /** Times in s of what was detected in a file of a table. */
  events({ section }, file, results = this.results ?? {}) {
    const own = (path) => isSameFile(path, file);
    if (section === "impacts") return results.impacts?.find((one) => own(one.file))?.times ?? [];
    if (section === "drop") {
      for (const { files = [], times = [] } of results.drops ?? []) {
        const k = files.findIndex(own);
        if (k >= 0) return times[k] ?? [];
      }
    }
    if (section === "decay") {
      const found = results.decays?.find((one) => own(one.file));
      return found ? [found.start, found.end].filter(Number.isFinite) : [];
    }
    return [];
  }

  pictures(path) {
    if (!this.drawn.has(path)) this.drawn.set(path, this.program.ask("pictures", { path }));
    return this.drawn.get(path);
  }

  save(name, type) {
    return this.work("saving", async () => {
      await this.editor.flush();
      const bytes = await this.program.ask("file", { name });
      save(name, name === "report.html" ? withoutFiles(bytes) : bytes, type);
      this.unsaved &&= name !== "campaign.toml";
    });
  }

  progress({ what, done, all }) {
    at("doing").textContent = what;
    at("bar").hidden = at("stop").hidden = false;
    if (all > 0) at("bar").value = Math.min(done / all, 1);
    else at("bar").removeAttribute("value");
  }

  trouble(text) {
    at("troubles").append(make("li", { textContent: text }));
  }

  /** Does something that may take long; says what fails. Stopped or out of memory, the program gets its files again. */
  async work(what, todo, isRun = false) {
    const began = performance.now(), late = setTimeout(() => this.progress({ what, done: 0, all: 0 }), 300);
    const clock = setInterval(() => { at("took").textContent = `${Math.round((performance.now() - began) / 1000)} s`; }, 1000);
    try {
      return await todo();
    } catch (error) {
      if (error instanceof Stopped) {
        const why = error.message === "stopped" ? "Stopped." : `The page could not finish: ${error.message}. The command on this computer has more room: vibro run ${JSON.stringify(this.name || "FOLDER")}`;
        // Stopped while files were read, what was there before comes back elsewhere.
        if (what !== "reading files") await this.restore().catch(() => {});
        this.trouble(why);
      } else if (!(isRun && error instanceof Refused && this.problems.some((one) => one.text === error.message))) this.trouble(error.message);
      return null;
    } finally {
      clearTimeout(late);
      clearInterval(clock);
      at("doing").textContent = at("took").textContent = "";
      at("bar").hidden = at("stop").hidden = true;
    }
  }
}

const app = new App();

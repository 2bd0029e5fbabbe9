"use strict";

/** Buttons and, for a long one, a search above a table. */
function tableTools(table) {
  const bar = document.createElement("div");
  bar.className = "tools";
  const name = table.caption?.textContent || "table";
  bar.classList.add("beside");
  if (table.tBodies[0]?.rows.length > 12) {
    const search = document.createElement("input");
    [search.type, search.placeholder] = ["search", "find a row"];
    search.setAttribute("aria-label", `Find a row of ${name}`);
    search.addEventListener("input", () => {
      for (const row of table.tBodies[0].rows) row.hidden = !row.textContent.toLowerCase().includes(search.value.toLowerCase());
    });
    bar.append(search);
  }
  const copy = button("copy", "Copy with tabs, for a spreadsheet", async () => {
    const text = Array.from(table.rows, (row) => Array.from(row.cells, (c) => c.textContent).join("\t")).join("\n");
    try {
      await navigator.clipboard.writeText(text);
      copy.textContent = "copied";
    } catch {
      getSelection().selectAllChildren(table);
      copy.textContent = "selected: press Ctrl+C";
    }
  });
  bar.append(copy, button("CSV", "Save as CSV: all digits, in units without prefixes", () => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([table.dataset.csv], { type: "text/csv" }));
    link.download = `${name.replace(/[^\p{L}\p{N}]+/gu, "_")}.csv`;
    link.click();
    URL.revokeObjectURL(link.href);
  }));
  if (table.caption) table.caption.append(bar);
  else table.parentElement.before(bar);
}

/** Columns and rows of a figure's panels where it stands, and their height in pixels. */
function extent(host, figure) {
  const columns = host.clientWidth < 560 ? 1 : figure.columns, rows = Math.ceil(figure.panels.length / columns);
  // Ten records are looked through at once; a waterfall needs its depth.
  const deep = figure.panels.some((panel) => panel?.kind === "waterfall"), most = deep ? [460, 320] : [320, 240];
  return { columns, rows, height: Math.round(Math.min(Math.max(host.clientWidth * figure.aspect / rows, 220), most[rows > 1 ? 1 : 0])) };
}

/** Draws a figure into its place. */
function drawFigure(host, figure, shared, spectra) {
  host.replaceChildren();
  const { columns, height } = extent(host, figure);
  host.style.gridTemplateColumns = `repeat(${columns}, minmax(0, 1fr))`;
  host.style.minHeight = "";
  for (const panel of figure.panels) {
    const cell = document.createElement("div");
    host.append(cell);
    if (panel?.kind === "plot") new Plot(cell, panel, height, shared, spectra);
    else if (panel?.kind === "waterfall") new Waterfall(cell, panel, height, shared);
  }
}

/** The figure that stands there without a script. */
function asPrinted(host) {
  host.innerHTML = host.nextElementSibling.textContent;
}

/** Height in pixels of what stands above and below a panel. */
const TOOLS = 62;

async function start() {
  const hosts = document.querySelectorAll("[data-figure]");
  const drawn = new Map();
  // A page may be printed before its data are unpacked.
  let draw = asPrinted;
  const again = () => {
    const before = Array.from(drawn.keys());
    drawn.clear();
    before.forEach(draw);
  };
  // Paper is white, whatever the screen is.
  addEventListener("beforeprint", () => {
    for (const fold of document.querySelectorAll("details")) fold.open = true;
    document.documentElement.classList.add("printing");
    again();
    hosts.forEach(draw);
  });
  addEventListener("afterprint", () => {
    document.documentElement.classList.remove("printing");
    again();
  });
  const data = await unpacked(document.getElementById("data").textContent);
  const { figures, matrices, whatif } = JSON.parse(new TextDecoder().decode(data));
  // The spectra of a sweep are those of its waterfall.
  const waterfalls = figures.flatMap((figure) => figure.panels).filter((panel) => panel?.kind === "waterfall");
  const spectra = (name) => waterfalls.find((waterfall) => waterfall.record === name);
  draw = (host) => {
    if (drawn.get(host) === host.clientWidth) return;
    drawn.set(host, host.clientWidth);
    drawFigure(host, figures[host.dataset.figure], matrices, spectra);
  };
  const seen = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) if (isIntersecting) draw(target);
  }, { rootMargin: "400px" });
  for (const host of hosts) {
    // Links into the page land where they point, also before what is above is drawn.
    const { rows, height } = extent(host, figures[host.dataset.figure]);
    host.style.minHeight = `${rows * (height + TOOLS)}px`;
    seen.observe(host);
  }
  let waits = 0;
  addEventListener("resize", () => {
    clearTimeout(waits);
    waits = setTimeout(() => Array.from(drawn.keys()).forEach(draw), 150);
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);
  for (const table of document.querySelectorAll(".table table")) tableTools(table);
  const place = document.getElementById("what-if");
  if (!place) return;
  const near = new IntersectionObserver(async (entries) => {
    if (!entries.some((entry) => entry.isIntersecting)) return;
    near.disconnect();
    const module = await unpacked(document.getElementById("model").textContent);
    place.whatIf = await whatIf(place, whatif, module);
  }, { rootMargin: "400px" });
  near.observe(place);
}

start().catch(() => {
  // An old browser: the figures as they are printed.
  document.querySelectorAll("[data-figure]").forEach(asPrinted);
});

// The report page in a real browser: node --test, with Chromium from the system. `VIBRO` is the program, `REPORT` the example's page.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, writeFileSync, copyFileSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { gunzipSync } from "node:zlib";
import { chromium } from "playwright-core";

const root = resolve(import.meta.dirname, "../..");
const vibro = process.env.VIBRO ?? join(root, "target/release/vibro");
const report = process.env.REPORT ?? join(root, "examples/two_mass_rig/results/report.html");
const flags = ["--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];

let browser;
before(async () => (browser = await chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args: flags })));
after(() => browser.close());

/** A page whose errors and requests fail the test. */
async function open(path, options = {}, todo) {
  const context = await browser.newContext({ viewport: { width: 1200, height: 900 }, acceptDownloads: true, ...options });
  const page = await context.newPage(), wrong = [];
  page.on("pageerror", (error) => wrong.push(error.stack));
  page.on("console", (message) => message.type() === "error" && wrong.push(message.text()));
  page.on("dialog", (dialog) => wrong.push(`dialog ${dialog.message()}`) && dialog.dismiss());
  page.on("request", (request) => /^(file|blob|data):/.test(request.url()) || wrong.push(request.url()));
  await page.goto(`file://${path}`);
  const given = await todo(page);
  assert.deepEqual(wrong, []);
  await context.close();
  return given;
}

/** Scrolls to an element and waits until its figure is drawn. */
async function show(page, selector, nth = 0) {
  const element = page.locator(selector).nth(nth);
  await element.evaluate((e) => e.scrollIntoView());
  await element.locator("canvas").first().waitFor();
  await page.waitForTimeout(150);
  return element;
}

/** Waits until what is asked is so: a busy machine draws later. */
async function until(holds) {
  for (let k = 0; k < 100; k++) {
    if (await holds()) return;
    await new Promise((done) => setTimeout(done, 50));
  }
  assert.fail(`after 5 s it is not so: ${holds}`);
}

/** What the pixels of a canvas add up to. */
const ink = (canvas) => canvas.evaluate((c) => c.toDataURL().length);

test("the page is small and shows its first view in 0.3 s", async (t) => {
  const size = statSync(report).size;
  t.diagnostic(`${Math.round(size / 1000)} kB`);
  assert.ok(size < 900_000, String(size));
  const times = [];
  for (let k = 0; k < 5; k++) {
    times.push(await open(report, {}, (page) => page.evaluate(() => performance.getEntriesByName("first-contentful-paint")[0]?.startTime
      ?? performance.getEntriesByType("navigation")[0].domContentLoadedEventEnd)));
  }
  const median = times.sort((a, b) => a - b)[2];
  t.diagnostic(`first view ${Math.round(median)} ms`);
  assert.ok(median < 300, String(times));
});

test("a click on a point of a sweep shows its spectrum below", () => open(report, {}, async (page) => {
  const figure = await show(page, "[data-figure]");
  const over = figure.locator(".u-over").first(), box = await over.boundingBox();
  const said = () => figure.locator(".tip").first().textContent();
  let found = false;
  for (let x = 20; x < box.width && !found; x += 4) {
    for (let y = 10; y < box.height && !found; y += 30) {
      await page.mouse.move(box.x + x, box.y + y);
      found = (await said()).includes("click: its spectrum");
    }
  }
  const frequency = (await said()).match(/Hz\) ([\d.]+)/)[1], plots = figure.locator(".uplot"), before = await plots.count();
  await page.mouse.down();
  await page.mouse.up();
  assert.equal(await plots.count(), before + 1);
  assert.ok(Math.abs((await said()).match(/spectrum at ([\d.]+) Hz/)[1] - frequency) < 0.01, await said());
}));

test("a value under the pointer is named with its uncertainty, and names switch their series", () => open(report, {}, async (page) => {
  const figure = await show(page, "[data-figure]");
  const over = figure.locator(".u-over").first(), canvas = figure.locator(".uplot canvas").first();
  const box = await over.boundingBox();
  await over.hover({ position: { x: 1, y: box.height - 1 } });
  let said = "";
  for (let x = 20; x < box.width && !said.includes("±"); x += 4) {
    for (let y = 10; y < box.height && !said.includes("±"); y += 30) {
      await page.mouse.move(box.x + x, box.y + y);
      said = await figure.locator(".tip").first().textContent();
    }
  }
  assert.match(said, /mass [12], (up|down): .*Hz.* \d.*±/);
  const name = figure.locator("button.name").first(), all = await ink(canvas);
  await name.click();
  assert.equal(await name.getAttribute("aria-pressed"), "false");
  assert.notEqual(await ink(canvas), all);
  await name.click();
  assert.equal(await ink(canvas), all);
}));

test("a response is shown on a logarithmic axis and back", () => open(report, {}, async (page) => {
  const figure = await show(page, "[data-figure]"), canvas = () => figure.locator(".uplot canvas").first(), first = await ink(canvas());
  assert.equal(await figure.locator(".uplot").count(), 1);
  await figure.getByRole("button", { name: "log" }).click();
  assert.notEqual(await ink(canvas()), first);
  await figure.getByRole("button", { name: "linear" }).click();
  assert.equal(await ink(canvas()), first);
}));

test("a dragged rectangle zooms, and reset shows all", () => open(report, {}, async (page) => {
  const figure = await show(page, "[data-figure]");
  const canvas = figure.locator(".uplot canvas").first(), all = await ink(canvas);
  const box = await figure.locator(".u-over").first().boundingBox();
  await page.mouse.move(box.x + 100, box.y + 40);
  await page.mouse.down();
  await page.mouse.move(box.x + 300, box.y + 200, { steps: 4 });
  await page.mouse.up();
  assert.notEqual(await ink(canvas), all);
  await figure.getByRole("button", { name: "reset" }).first().click();
  await page.mouse.move(5, 5);
  assert.equal(await ink(figure.locator(".uplot canvas").first()), all);
}));

test("a waterfall turns by pointer and keys, changes to levels, and names the spectrum under the pointer", () => open(report, {}, async (page) => {
  await show(page, "[data-figure]", 2);
  await page.locator("canvas.turn").first().scrollIntoViewIfNeeded();
  const canvas = page.locator("canvas.turn").first(), first = await ink(canvas), box = await canvas.boundingBox();
  await page.mouse.move(box.x + 300, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 200, box.y + 150, { steps: 3 });
  await page.mouse.up();
  await until(async () => await ink(canvas) !== first);
  await page.waitForTimeout(60);
  const turned = await ink(canvas);
  await canvas.focus();
  await page.keyboard.press("ArrowLeft");
  await until(async () => await ink(canvas) !== turned);
  const figure = page.locator("[data-figure]", { has: page.locator("canvas.turn") }).first();
  await figure.getByRole("button", { name: "dB" }).click();
  await canvas.scrollIntoViewIfNeeded();
  const now = await canvas.boundingBox();
  await page.mouse.move(now.x + 400, now.y + 250);
  await until(async () => /Excitation frequency \(Hz\) [\d.]+, Frequency \(Hz\) [\d.]+, .* \d/.test(await figure.locator(".tip").textContent()));
}));

test("a map names the cell under the pointer and shows its spectrum", () => open(report, {}, async (page) => {
  const map = await show(page, "[data-figure]", 4);
  await map.locator(".u-over").first().hover();
  await until(async () => /dB|mm|µm/.test(await map.locator(".tip").textContent()));
  assert.equal(await map.locator(".uplot").count(), 2);
}));

test("tables are searched, copied and saved", () => open(report, { permissions: ["clipboard-read", "clipboard-write"] }, async (page) => {
  const fold = page.locator("details", { has: page.locator("input[type=search]") }).first();
  await fold.locator("summary").click();
  const rows = fold.locator("tbody tr"), n = await rows.count();
  await fold.locator("input[type=search]").fill("5.5");
  const left = await rows.evaluateAll((all) => all.filter((row) => !row.hidden).length);
  assert.ok(left > 0 && left < n, `${left} of ${n}`);
  await fold.getByRole("button", { name: "copy" }).click();
  await fold.getByRole("button", { name: /copied|selected/ }).waitFor();
  const [file] = await Promise.all([page.waitForEvent("download"), fold.getByRole("button", { name: "CSV" }).click()]);
  const text = readFileSync(await file.path(), "utf8");
  const lines = text.trimEnd().split("\n");
  assert.equal(lines.length, n + 1);
  // More digits than are shown.
  assert.match(lines[1], /\d\.\d{7,}/);
}));

test("nothing is wider than a phone of 360 px, light or dark", async () => {
  for (const colorScheme of ["light", "dark"]) {
    await open(report, { viewport: { width: 360, height: 740 }, colorScheme }, async (page) => {
      await show(page, "[data-figure]");
      await show(page, "[data-figure]", 2);
      const [wide, paper] = await page.evaluate(() => [document.documentElement.scrollWidth, getComputedStyle(document.body).backgroundColor]);
      assert.ok(wide <= 360, `${wide} px`);
      assert.equal(paper === "rgb(255, 255, 255)", colorScheme === "light");
    });
  }
});

test("print opens what is folded, on white paper of A4 and of Letter", () => open(report, { colorScheme: "dark" }, async (page) => {
  for (const format of ["A4", "Letter"]) {
    await page.evaluate(() => dispatchEvent(new Event("beforeprint")));
    const ink = await page.evaluate(() => theme(document.querySelector("[data-figure]")).ink);
    assert.equal(ink, "#1a1a1a");
    const pdf = await page.pdf({ format });
    assert.ok(pdf.length > 50_000, String(pdf.length));
    // The end of this print must not come after the begin of the next.
    await page.waitForFunction(() => !document.documentElement.classList.contains("printing"));
  }
  assert.equal(await page.locator("details:not([open])").count(), 0);
}));

test("a page that is printed before its data are unpacked has every figure or its file", async () => {
  const context = await browser.newContext({ colorScheme: "dark" }), page = await context.newPage();
  await page.addInitScript(() => addEventListener("DOMContentLoaded", () => {
    dispatchEvent(new Event("beforeprint"));
    const hosts = Array.from(document.querySelectorAll("[data-figure]"));
    window.printed = [hosts.length, hosts.filter((host) => host.firstElementChild).length, document.querySelectorAll("details:not([open])").length];
  }));
  await page.goto(`file://${report}`);
  const [figures, printed, folded] = await page.evaluate(() => window.printed);
  assert.ok(figures >= 6, String(figures));
  assert.deepEqual([printed, folded], [figures, 0]);
  await show(page, "[data-figure]");
  await context.close();
});

test("ticks of a logarithmic axis are multiples of powers of ten, even steps on a short one, powers on a long one", () => open(report, {}, async (page) => {
  const of = (low, high, room = 100) => page.evaluate(([a, b, c]) => logTicks(a, b, c), [low, high, room]);
  const wide = await of(0.00187, 74.65);
  assert.deepEqual([wide[0], wide.at(-1), wide.length], [0.002, 70, 8 + 3 * 9 + 7]);
  assert.deepEqual(await of(0.0089, 0.0161), [0.01, 0.012, 0.014, 0.016]);
  assert.deepEqual(await of(3e-5, 2e4, 30), [1e-4, 1e-3, 1e-2, 0.1, 1, 10, 100, 1000, 1e4]);
}));

test("without scripts the figures stand as printed", () => open(report, { javaScriptEnabled: false }, async (page) => {
  const html = await page.content();
  assert.ok((html.match(/<svg/g) ?? []).length >= 6);
}));

test("markup in names stays text", () => {
  const folder = mkdtempSync(join(tmpdir(), "page-"));
  copyFileSync(join(root, "examples/bench/DECAY.CSV"), join(folder, "DECAY.CSV"));
  const name = JSON.stringify("</script><script>alert(1)</script><img src=x onerror=alert(2)>");
  writeFileSync(join(folder, "campaign.toml"), `name = ${name}\n[[decay]]\nname = ${name}\nfile = "DECAY.CSV"\n`);
  execFileSync(vibro, ["run", join(folder, "campaign.toml")], { stdio: "pipe" });
  return open(join(folder, "results/report.html"), {}, async (page) => {
    await show(page, "[data-figure]");
    assert.match(await page.title(), /<script>alert\(1\)/);
    assert.equal(await page.locator("img").count(), 0);
  });
});

test("200 spectra of 6400 lines are drawn in 1 s and turn at 60 frames a second", (t) => open(report, {}, async (page) => {
  const [drawn, frames] = await page.evaluate(async () => {
    const [rows, lines] = [200, 6400], steps = new Uint16Array(rows * lines);
    for (let i = 0; i < steps.length; i++) steps[i] = 20000 + ((i * 7919) % 40000);
    const base64 = (array) => {
      const raw = new Uint8Array(array.buffer);
      let text = "";
      for (let i = 0; i < raw.length; i += 32768) text += String.fromCharCode(...raw.subarray(i, i + 32768));
      return btoa(text);
    };
    const axis = (title, low, high) => ({ title, low, high, log: false, reference: null, factor: 1 });
    const panel = {
      kind: "waterfall", x: axis("Frequency (Hz)", 0, lines), depth: axis("Excitation frequency (Hz)", 0, rows), up: axis("m", 0, 1),
      frequency: base64(Float32Array.from({ length: lines }, (_, k) => k)), excitation: base64(Float32Array.from({ length: rows }, (_, k) => k)),
      z: { levels: base64(steps), low: -3, high: 0, log: true },
    };
    const host = document.createElement("div");
    document.querySelector("main").prepend(host);
    const began = performance.now();
    const waterfall = new Waterfall(host, panel, 420, []);
    const drawn = performance.now() - began, times = [];
    for (let k = 0; k < 30; k++) {
      const from = performance.now();
      waterfall.turn = -0.3 + 0.02 * k;
      waterfall.draw(true);
      // Until the pixels are there.
      waterfall.canvas.getContext("2d").getImageData(0, 0, 1, 1);
      times.push(performance.now() - from);
    }
    return [drawn, times.sort((a, b) => a - b)];
  });
  t.diagnostic(`drawn in ${Math.round(drawn)} ms, a frame in ${frames[15].toFixed(1)} ms (median), ${frames[28].toFixed(1)} ms at most but one`);
  assert.ok(drawn < 1000, String(drawn));
  assert.ok(frames[15] < 1000 / 60, String(frames[15]));
}));

test("sliders move the curve within 50 ms, reset brings it back, and the values are those of a campaign", (t) => open(report, {}, async (page) => {
  const place = page.locator("#what-if");
  await place.scrollIntoViewIfNeeded();
  await place.locator("canvas").first().waitFor();
  const canvas = place.locator(".uplot canvas").first(), gap = place.locator("label", { hasText: "gap" }).locator("input");
  const first = await ink(canvas), toml = await place.locator("pre").textContent();
  const times = [];
  for (const value of [100, 300, 500, 700, 900]) {
    await place.evaluate((host) => (host.whatIf.took = null));
    await gap.fill(String(value));
    await until(() => place.evaluate((host) => host.whatIf.took !== null));
    times.push(await place.evaluate((host) => host.whatIf.took));
  }
  t.diagnostic(`a step of a slider: ${times.map((ms) => ms.toFixed(0)).join(", ")} ms`);
  assert.ok(Math.max(...times) < 50, String(times));
  assert.notEqual(await ink(canvas), first);
  assert.match(await place.locator("pre").textContent(), /\[rig\]\nm1 = 0\.125\n/);
  await place.getByRole("button", { name: "reset" }).first().click();
  await until(async () => await place.locator("pre").textContent() === toml);
  const folder = mkdtempSync(join(tmpdir(), "page-"));
  writeFileSync(join(folder, "campaign.toml"), toml);
  execFileSync(vibro, ["check", join(folder, "campaign.toml")], { stdio: "pipe" });
}));

/** Answers of a module of the model, asked in Node. */
async function wasm(packed, questions) {
  const { instance } = await WebAssembly.instantiate(gunzipSync(readFileSync(packed)), {});
  const { memory, input, output } = instance.exports;
  return questions.map(([what, numbers]) => {
    new Float64Array(memory.buffer, input(), 16).set(numbers);
    const n = instance.exports[what]();
    return Array.from(new Float64Array(memory.buffer, output(), n));
  });
}

test("the model of the page answers as the library for 400 rigs, and so does one that is built anew", async (t) => {
  let state = 1;
  const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
  const around = (value, factor) => value * factor ** (2 * random() - 1);
  const questions = Array.from({ length: 400 }, (_, k) => {
    const contact = k % 3 ? 0 : 10 ** (5 + 3 * random());
    const rig = [around(0.125, 4), around(0.094, 4), around(135, 4), around(128, 4), around(0.1, 5), around(0.1, 5), 3e-3 * random(), 0.2 + 0.79 * random(), around(0.1, 10), contact];
    return k % 10 ? ["response", [...rig, 3, 13, 20, 0, 0, 0]] : ["motion", [...rig, 3 + 10 * random(), 0, 0, 0, 0, 0]];
  });
  const asked = questions.map(([what, numbers]) => `${what} ${numbers.join(" ")}`).join("\n");
  const run = ["run", "--locked", "--release", "--quiet", "--package", "vibro-whatif", "--example", "answers"];
  const native = execFileSync("cargo", run, { cwd: root, input: asked, maxBuffer: 1 << 28, encoding: "utf8" }).trimEnd().split("\n");
  const files = [join(root, "src/report/assets/page/whatif.wasm.gz"), process.env.WHATIF].filter(Boolean);
  for (const file of files) {
    let largest = 0, answered = 0, different = 0;
    for (const [k, found] of (await wasm(file, questions)).entries()) {
      const expected = native[k] === "" ? [] : native[k].split(" ").map(Number);
      assert.equal(found.length, expected.length, asked.split("\n")[k]);
      // A motion from rest may be chaotic: there the last bit of a sine decides, and only responses are compared number by number.
      if (questions[k][0] === "motion") continue;
      const size = Math.max(...expected.filter(Number.isFinite));
      found.forEach((v, i) => {
        if (Number.isNaN(v) !== Number.isNaN(expected[i])) different++;
        else if (!Number.isNaN(v)) [answered, largest] = [answered + 1, Math.max(largest, Math.abs(v - expected[i]) / Math.max(Math.abs(expected[i]), 1e-12 * size))];
      });
    }
    t.diagnostic(`${file.split("/").at(-1)}: ${answered} numbers, largest relative difference ${largest.toExponential(1)}, ${different} that one has and the other has not`);
    assert.ok(answered > 10_000);
    assert.equal(different, 0);
    // Where two motions meet, √ε is what rounding leaves of a number.
    assert.ok(largest < 1e-7, String(largest));
  }
});

// Numbers of the page by themselves.
import assert from "node:assert/strict";
import { createRequire } from "node:module";
import { test } from "node:test";

const { floats, matrix, decimated, digits, estimate, borders, nearest } = createRequire(import.meta.url)("../../src/report/assets/page/decode.js");
const base64 = (array) => Buffer.from(array.buffer).toString("base64");

test("floats and levels are read as they were written", () => {
  assert.deepEqual(Array.from(floats(base64(Float32Array.of(1, -2.5, NaN)))), [1, -2.5, NaN]);
  const z = { levels: base64(Uint16Array.of(0, 1, 65535)), low: -3, high: 1, log: true };
  const [gap, low, high] = matrix(z, { factor: 1000 }, []);
  assert.ok(Number.isNaN(gap) && Math.abs(low - 1) < 1e-9 && Math.abs(high - 10_000) < 1e-6);
  assert.ok(Math.abs(matrix(z, { reference: 1e-3 }, [])[2] - 80) < 1e-9);
  assert.equal(matrix({ ...z, levels: 0 }, { factor: 1 }, [z.levels]).length, 3);
});

test("no extreme is lost where a row has more points than pixels", () => {
  const y = Array.from({ length: 10_000 }, (_, i) => (i === 4321 ? 9 : i === 7777 ? -9 : Math.sin(i)));
  const [, shown] = decimated(y.map((_, i) => i), y, 100);
  assert.ok(shown.length <= 200 && shown.includes(9) && shown.includes(-9));
});

test("numbers are written with their uncertainty to two digits", () => {
  assert.equal(estimate(5.514457, 0.00045), "5.51446 ± 0.00045");
  assert.equal(estimate(1234.5, 120), "1235 ± 120");
  assert.equal(estimate(-0.5, NaN), "−0.5");
  assert.equal(digits(NaN), "–");
});

test("cells reach half-way, and the nearest place is found", () => {
  assert.deepEqual(borders([0, 1, 3]), [-0.5, 0.5, 2, 4]);
  assert.deepEqual([-5, 0.4, 0.6, 2.1, 9].map((v) => nearest([0, 1, 3], v)), [0, 0, 1, 2, 2]);
});

"use strict";
let wasm;
const utf8 = new TextEncoder(), text = new TextDecoder();
/** Largest part of a file that is copied at once. */
const PART = 1 << 23;

/** What cannot be done, while the program goes on. */
class Refusal extends Error {}

/** Writes bytes where the module reads its input. */
function put(bytes) {
  const place = wasm.room(bytes.length) >>> 0;
  if (place === 0) throw new Refusal("the memory of the page does not suffice");
  new Uint8Array(wasm.memory.buffer, place, bytes.length).set(bytes);
}

function answer(kind) {
  const bytes = new Uint8Array(wasm.memory.buffer, wasm.answer_place() >>> 0, wasm.answer_bytes() >>> 0);
  if (kind === 2) return { bytes: bytes.slice() };
  const value = JSON.parse(text.decode(bytes));
  return kind === 1 ? { refused: value } : { value };
}

/** Copies a file into the module part by part, so that it is never in memory twice. */
async function add(path, file) {
  const name = utf8.encode(path), place = wasm.room(name.length + file.size) >>> 0;
  if (place === 0) throw new Refusal(`${path} has ${Math.round(file.size / 1e6)} MB, more than the memory of a page holds`);
  new Uint8Array(wasm.memory.buffer, place, name.length).set(name);
  for (let at = 0; at < file.size; at += PART) {
    const read = file.slice(at, at + PART).arrayBuffer();
    const part = new Uint8Array(await read.catch(() => { throw new Refusal(`${path} cannot be read; it may have been moved or deleted`); }));
    new Uint8Array(wasm.memory.buffer, place + name.length + at, part.length).set(part);
  }
  return answer(wasm.add(name.length));
}

/** Bytes from text that has five characters for four of them, as pack.py writes it. */
function bytesOf({ text: packed, bytes: length }) {
  const digits = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz!#$%&()*+-;,=>?@^_`{|}~";
  const of = new Uint8Array(128), all = new DataView(new ArrayBuffer(packed.length / 5 * 4));
  for (let k = 0; k < digits.length; k++) of[digits.charCodeAt(k)] = k;
  for (let from = 0, to = 0; from < packed.length; from += 5, to += 4) {
    let value = 0;
    for (let k = 0; k < 5; k++) value = value * 85 + of[packed.charCodeAt(from + k)];
    all.setUint32(to, value);
  }
  return new Uint8Array(all.buffer, 0, length);
}

/** The module: LZMA, which a small module of its own unpacks. */
async function unpacked(unpacker, packed, size) {
  const stream = new Blob([bytesOf(unpacker)]).stream().pipeThrough(new DecompressionStream("gzip"));
  const { instance } = await WebAssembly.instantiate(await new Response(stream).arrayBuffer(), {});
  const { memory, room, unpack } = instance.exports, bytes = bytesOf(packed), place = room(bytes.length) >>> 0;
  if (place === 0) throw new Error("the memory of the page does not suffice");
  new Uint8Array(memory.buffer, place, bytes.length).set(bytes);
  const from = unpack(size) >>> 0;
  if (from === 0) throw new Error("this file is damaged: load it anew");
  return WebAssembly.compile(new Uint8Array(memory.buffer, from, size));
}

async function started({ unpacker, packed, size, module }) {
  module ??= await unpacked(unpacker, packed, size);
  let shown = 0;
  const progress = (place, length, done, all) => {
    const now = performance.now();
    if (now - shown < 50 && done !== 0) return;
    shown = now;
    postMessage({ what: text.decode(new Uint8Array(wasm.memory.buffer, place >>> 0, length).slice()), done, all });
  };
  // Libraries name functions of a browser, such as its clock, that no record needs.
  const imports = {};
  for (const { module: from, name } of WebAssembly.Module.imports(module)) {
    (imports[from] ??= {})[name] = () => { throw new Error(`${name} is not on this page`); };
  }
  imports.page = { progress };
  wasm = (await WebAssembly.instantiate(module, imports)).exports;
  return { module };
}

async function handle({ id, start, begin, path, file, ask }) {
  try {
    let found;
    if (start) found = await started(start);
    else if (begin !== undefined) { put(utf8.encode(begin)); wasm.begin(); found = {}; }
    else if (file) found = await add(path, file);
    else { put(utf8.encode(JSON.stringify(ask))); found = answer(wasm.ask()); }
    postMessage({ id, ...found }, found.bytes ? [found.bytes.buffer] : []);
  } catch (error) {
    const text = String(error.message ?? error);
    postMessage(error instanceof Refusal ? { id, refused: { text } } : { id, died: text });
  }
}

// One after another: a file is read in parts, and all share the input of the program.
let last = Promise.resolve();
onmessage = ({ data }) => { last = last.then(() => handle(data)); };

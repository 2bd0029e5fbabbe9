/** Most bytes of all files together: the page needs some three times as many. */
const MOST_BYTES = 1e9;

/** All files of an entry that was dropped, each with its path. */
async function filesOf(entry, above = "") {
  if (entry.isFile) {
    const path = above + entry.name;
    return new Promise((resolve) => entry.file((file) => resolve([{ path, file }]), () => resolve([{ path, problem: "cannot be read" }])));
  }
  const reader = entry.createReader(), all = [];
  for (;;) {
    const some = await new Promise((resolve) => reader.readEntries(resolve, () => resolve([])));
    if (some.length === 0) break;
    for (const one of some) all.push(...await filesOf(one, `${above}${entry.name}/`));
  }
  return all;
}

/** The files of a drop; entries must be asked for before anything waits. */
async function dropped(transfer) {
  const entries = Array.from(transfer.items, (item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (entries.length === 0) return Array.from(transfer.files, (file) => ({ path: file.name, file }));
  const all = await Promise.all(entries.map((entry) => filesOf(entry)));
  return all.flat();
}

/** The files that were chosen. */
const chosen = (input) => Array.from(input.files, (file) => ({ path: file.webkitRelativePath || file.name, file }));

/** The name of the one folder that holds all files, and the files as they stand in it. */
function inFolder(files) {
  const top = files[0]?.path.split("/")[0];
  const one = files.length > 0 && files.every(({ path }) => path.startsWith(`${top}/`));
  // A zip that comes alone is the folder that was packed; beside other files it is a recording.
  if (files.length === 1 && /\.zip$/i.test(top)) files[0].packed = true;
  const name = one ? top : files.length === 1 ? top.replace(/\.[^.]*$/, "") : "recordings";
  return { name, files: one ? files.map(({ path, file }) => ({ path: path.slice(top.length + 1), file })) : files };
}

/** Offers bytes as a file to save. */
function save(name, bytes, type = "application/octet-stream") {
  const link = document.createElement("a"), place = URL.createObjectURL(new Blob([bytes], { type }));
  [link.href, link.download] = [place, name];
  link.click();
  setTimeout(() => URL.revokeObjectURL(place), 10_000);
}

/** The browser's own storage, in which a person may keep files. */
const shelf = {
  open() {
    return new Promise((resolve, reject) => {
      const asked = indexedDB.open("vibroimpact", 1);
      asked.onupgradeneeded = () => asked.result.createObjectStore("kept");
      [asked.onsuccess, asked.onerror] = [() => resolve(asked.result), () => reject(asked.error)];
    });
  },
  async with(mode, work) {
    const base = await shelf.open();
    return new Promise((resolve, reject) => {
      const transaction = base.transaction("kept", mode), asked = work(transaction.objectStore("kept"));
      transaction.oncomplete = () => { base.close(); resolve(asked.result); };
      transaction.onerror = () => { base.close(); reject(transaction.error); };
    });
  },
  put: (value) => shelf.with("readwrite", (store) => store.put(value, "bench")),
  get: () => shelf.with("readonly", (store) => store.get("bench")),
  clear: () => shelf.with("readwrite", (store) => store.delete("bench")),
};

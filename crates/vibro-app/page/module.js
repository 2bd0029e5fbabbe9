/** What the program in the worker refuses, with its words. */
class Refused extends Error {
  constructor({ text, line }) {
    super(text);
    this.line = line;
  }
}

/** The work was ended, by a person or by the browser. */
class Stopped extends Error {}

/** The program, in a worker of its own so that the page stays awake. */
class Program {
  constructor(onProgress) {
    this.onProgress = onProgress;
    this.module = null;
    this.start();
  }

  start() {
    const source = new Blob([document.getElementById("worker").textContent], { type: "text/javascript" });
    const place = URL.createObjectURL(source);
    this.worker = new Worker(place);
    URL.revokeObjectURL(place);
    [this.waiting, this.next] = [new Map(), 0];
    this.worker.onmessage = ({ data }) => {
      if (data.id === undefined) return this.onProgress(data);
      const { resolve, reject } = this.waiting.get(data.id);
      this.waiting.delete(data.id);
      // After a fault the program cannot go on: the next one begins without files.
      if (data.died !== undefined) {
        reject(new Stopped(data.died));
        if (this.module) this.end(data.died);
      }
      else if (data.refused) reject(new Refused(data.refused));
      else resolve(data.bytes ?? data.value ?? data.module);
    };
    this.worker.onerror = (event) => {
      if (this.module) return this.end(event.message || "the worker failed");
      for (const { reject } of this.waiting.values()) reject(new Stopped(event.message || "no worker"));
    };
    const of = (id) => ({ text: document.getElementById(id).textContent, bytes: Number(document.getElementById(id).dataset.bytes) });
    const begun = this.module ? { module: this.module } : { unpacker: of("unpacker"), packed: of("module"), size: Number(document.getElementById("module").dataset.unpacked) };
    this.ready = this.send({ start: begun }).then((module) => { this.module = module; });
    this.ready.catch(() => {});
  }

  send(message) {
    return new Promise((resolve, reject) => {
      const id = this.next++;
      this.waiting.set(id, { resolve, reject });
      this.worker.postMessage({ id, ...message });
    });
  }

  /** Ends the work at once; all that waits for it is told why. The next one begins without files. */
  end(why) {
    this.worker.terminate();
    const waiting = this.waiting;
    this.start();
    for (const { reject } of waiting.values()) reject(new Stopped(why));
  }

  begin(name) { return this.send({ begin: name }); }
  add(path, file) { return this.send({ path, file }); }
  ask(what, more = {}) { return this.send({ ask: { do: what, ...more } }); }
}

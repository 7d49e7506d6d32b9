// Python for one page, in its own thread: loads the runtime, then runs what the page sends.
import display from "../python/IPython/display.py";
import ipython from "../python/IPython/__init__.py";
import interactiveshell from "../python/IPython/core/interactiveshell.py";
import pretty from "../python/IPython/lib/pretty.py";
import plainNumpy from "../python/plain_numpy.py";
import session from "../python/session.py";
import { named } from "./names.js";

const FILES = {
  "session.py": session,
  "plain_numpy.py": plainNumpy,
  "IPython/__init__.py": ipython,
  "IPython/core/interactiveshell.py": interactiveshell,
  "IPython/display.py": display,
  "IPython/lib/__init__.py": "",
  "IPython/lib/pretty.py": pretty,
};
const SILENCE = 14; // seconds without data, after which a download is given up
let refused = {};
const faults = []; // failed downloads, with reasons
const NUMERICAL = ["numpy", "matplotlib"];

let python, shell, packages, job;
const COURSEWORK = ".coursework"; // the folder for the files of coursework, with who works here and the progress
const DROPPED = "dropped"; // the folder for files that the reader gives to a cell
let files = {}; // the texts of the files of coursework, as the page has them
let widget = null; // the widget whose observers are running
let line = false; // whether widgets can exchange messages with the page

const errorText = (error) => String(error?.message ?? error);
// Names of modules, by the packages that contain them and are not loaded.
const absentModules = () =>
  Object.entries(packages)
    .filter(([name]) => !(name in python.loadedPackages))
    .flatMap(([name, { imports }]) => imports.map((module) => [module, name]));

const packageOf = (module) => absentModules().find(([found]) => found === module)?.[1];

function tellWhatIsMissing() {
  const reasons = {};
  for (const name of NUMERICAL.filter((name) => !(name in packages))) {
    reasons[name] = `${named(name)} is not part of this site`;
  }
  for (const [module, name] of absentModules()) reasons[module] = refused[name] ?? `${named(name)} is not loaded yet`;
  const missing = python.toPy(reasons);
  shell.lack(missing);
  missing.destroy();
}

const fileOf = (url) => new URL(url, location.href).pathname.split("/").at(-1);

// Every file is fetched through this function: it counts the bytes, gives up if none come, and reports failures.
function watchFetching(all) {
  const plain = self.fetch;
  let bytes = 0, told = 0;
  self.fetch = async (address, { integrity, ...options } = {}) => {
    const url = String(address.url ?? address), giveUp = new AbortController();
    let waiting = true, silent = 0;
    // Seconds in which this thread was free to receive data, and received none.
    const clock = setInterval(() => {
      silent = waiting ? silent + 1 : 0;
      if (silent >= SILENCE) giveUp.abort();
    }, 1000);
    const fail = (reason) => {
      clearInterval(clock);
      const why = silent >= SILENCE ? `nothing arrived for ${SILENCE} seconds` : reason;
      faults.push(`${fileOf(url)} could not be fetched from ${new URL(url, location.href).host} (${why})`);
      if (!python) postMessage({ type: "dead", reason: faults.at(-1) }); // Python cannot start without it
      return new Error(faults.at(-1));
    };
    let answer;
    try {
      answer = await plain(address, { ...options, signal: giveUp.signal });
    } catch {
      throw fail("there was no answer");
    }
    if (!answer.ok) throw fail(`the server answered ${answer.status}`);
    const reader = answer.body.getReader();
    const body = new ReadableStream({
      async pull(out) {
        try {
          [waiting, silent] = [true, 0];
          const { done, value } = await reader.read();
          [waiting, silent] = [false, 0];
          if (done) {
            clearInterval(clock);
            return out.close();
          }
          bytes += value.length;
          if (all() && performance.now() - told > 100) {
            told = performance.now();
            postMessage({ type: "progress", bytes: Math.min(bytes, all()), all: all() });
          }
          out.enqueue(value);
        } catch (error) {
          out.error(fail(errorText(error)));
        }
      },
    });
    const seen = new Response(body, { status: answer.status, headers: answer.headers });
    if (!integrity) return seen;
    // The browser checks a fingerprint only when everything has arrived, so the bytes are counted before that.
    const whole = URL.createObjectURL(await seen.blob());
    try {
      return await plain(whole, { integrity });
    } catch {
      throw fail("it is not the file of this edition");
    } finally {
      URL.revokeObjectURL(whole);
    }
  };
}

// Report a module that is broken or forbidden, as Pyodide reports it only to the console.
function watchModules() {
  if (typeof WebAssembly === "undefined") throw new Error("this browser, or one of its settings, forbids WebAssembly");
  for (const name of ["instantiate", "instantiateStreaming"]) {
    const plain = WebAssembly[name];
    WebAssembly[name] = async (...given) => {
      // Small modules only test what the browser supports.
      if (name === "instantiateStreaming" || given[0]?.byteLength > 1e6) postMessage({ type: "compiling" });
      try {
        return await plain(...given);
      } catch (error) {
        if (error instanceof WebAssembly.CompileError || error instanceof WebAssembly.LinkError) {
          const forbidden = /Content Security Policy|unsafe-eval|disallowed/i.test(errorText(error));
          const reason = forbidden ? "the rules of this site forbid WebAssembly" : `one of the files of Python is damaged (${errorText(error)})`;
          postMessage({ type: "dead", reason: faults[0] ?? reason });
        }
        throw error;
      }
    };
  }
}

async function start({ runtime, pyodide, lock: listed, interrupts }) {
  let lock;
  watchModules();
  watchFetching(() => lock?.bytes);
  const [{ loadPyodide }] = await Promise.all([
    import(`${runtime}${pyodide}pyodide.js`).catch(() => {
      throw new Error(`pyodide.js was not served by ${location.host}, or not as JavaScript`);
    }),
    fetch(`${runtime}${listed}pyodide-lock.json`).then(async (answer) => (lock = await answer.json())),
  ]);
  packages = lock.packages;
  postMessage({ type: "progress", bytes: 0, all: lock.bytes });
  python = await loadPyodide({
    indexURL: `${runtime}${pyodide}`,
    lockFileContents: lock,
    packageBaseUrl: runtime,
    packages: [lock.first],
    env: { HOME: "/home/reader", MPLBACKEND: "agg" },
  });
  const lost = [lock.first, ...packages[lock.first].depends, "sympy", "mpmath"].find((name) => !(name in python.loadedPackages));
  if (lost) throw new Error(faults[0] ?? `${lost} could not be loaded: the file is not the one of this edition`);
  const site = python.runPython("import sysconfig; sysconfig.get_path('purelib')");
  for (const folder of ["core", "lib"]) python.FS.mkdirTree(`${site}/IPython/${folder}`);
  for (const [name, text] of Object.entries(FILES)) python.FS.writeFile(`${site}/${name}`, text);
  if (interrupts) python.setInterruptBuffer(new Uint8Array(interrupts));
  shell = python.pyimport("session").start((text) => {
    const message = JSON.parse(text);
    if (message.type.startsWith("comm_")) postMessage({ type: "widget", message });
    else if (widget) postMessage({ type: "observed", widget, message });
    else postMessage({ type: "output", job, message });
  });
  tellWhatIsMissing();
  const fetched = Object.values(packages).map(({ file_name: file }) => file).find((file) => file.includes("://"));
  postMessage({
    type: "ready",
    modules: Object.values(packages).flatMap(({ imports }) => imports),
    elsewhere: fetched ? new URL(fetched).host : null,
  });
}

// Put the page's newest texts into the folder; what a run has written there is sent to the page.
function putFiles(kept) {
  python.FS.mkdirTree(COURSEWORK);
  for (const [name, text] of Object.entries(kept)) {
    if (files[name] !== text) python.FS.writeFile(`${COURSEWORK}/${name}`, text);
  }
  files = { ...kept };
}

function takeFiles() {
  for (const name of ["me.txt", "progress.json"]) {
    const path = `${COURSEWORK}/${name}`;
    if (!python.FS.analyzePath(path).exists) continue;
    const text = python.FS.readFile(path, { encoding: "utf8" });
    if (files[name] === text) continue;
    postMessage({ type: "kept", name, text, base: files[name] });
    files[name] = text;
  }
}

// Load the package that contains a module, and say why if that fails.
async function bring(module) {
  const name = packageOf(module);
  if (!name || name in refused) return false;
  const { file_name: file } = packages[name];
  const place = file.includes("://") ? new URL(file).host : "this site";
  postMessage({ type: "fetching", job, name, place });
  const problems = [];
  try {
    await python.loadPackage(name, { messageCallback() {}, errorCallback: (text) => problems.push(text) });
  } catch (error) {
    problems.push(errorText(error));
  }
  const came = name in python.loadedPackages;
  if (!came) {
    console.info(problems.join("\n"));
    const silent = faults.at(-1)?.includes("nothing arrived for");
    refused[name] = `${named(name)} could not be fetched from ${place}${silent ? ", which does not answer" : ""}`;
  }
  tellWhatIsMissing();
  if (!line && "comm" in python.loadedPackages) {
    shell.open_line();
    line = true;
  }
  return came;
}

// Store the files that a reader has given to a cell of the page.
function putDropped(files) {
  python.FS.mkdirTree(DROPPED);
  for (const name of python.FS.readdir(DROPPED)) if (!/^\.+$/.test(name)) python.FS.unlink(`${DROPPED}/${name}`);
  for (const [name, bytes] of files) python.FS.writeFile(`${DROPPED}/${name.replaceAll("/", "_")}`, bytes);
}

async function run({ code, name, needs = [], retry, kept }) {
  if (retry) refused = {};
  putFiles(kept);
  let lacked;
  for (const module of needs) {
    if (!lacked && packageOf(module) && !(await bring(module))) lacked = module;
  }
  for (;;) {
    const outcome = JSON.parse(await shell.run(code, name));
    takeFiles();
    // The build knows that without this module the cell fails, or gives another number than the book prints. It runs
    // all the same, as in the build: the cells below may use the names that it defines before it fails.
    if (lacked && ["ok", "error"].includes(outcome.status)) {
      return { status: "missing", package: lacked, reason: refused[packageOf(lacked)] };
    }
    if (outcome.status !== "missing") return outcome;
    if (!(await bring(outcome.package))) {
      // It may have been requested only now: the reason is the newest one.
      return { ...outcome, reason: refused[packageOf(outcome.package)] ?? outcome.reason };
    }
    postMessage({ type: "output", job, message: { type: "clear" } });
  }
}

// The reader has moved a figure: tell its Python side, and its observers.
function hear({ name, data }) {
  widget = name;
  postMessage({ type: "observed", widget, message: { type: "clear" } });
  try {
    shell.hear(name, JSON.stringify(data));
  } finally {
    widget = null;
  }
}

addEventListener("message", async ({ data }) => {
  try {
    if (data.type === "start") await start(data);
    else if (data.type === "widget") hear(data);
    else if (data.type === "files") putDropped(data.files);
    else {
      job = data.job;
      postMessage({ type: "done", job, outcome: await run(data) });
    }
  } catch (error) {
    postMessage({ type: "dead", job: data.job, reason: errorText(error) });
  }
});

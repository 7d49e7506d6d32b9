// Python for one page, in a thread of its own: loads the runtime, then runs what the page sends.
import display from "../python/IPython/display.py";
import ipython from "../python/IPython/__init__.py";
import pretty from "../python/IPython/lib/pretty.py";
import session from "../python/session.py";
import { named } from "./names.js";

const FILES = {
  "session.py": session,
  "IPython/__init__.py": ipython,
  "IPython/display.py": display,
  "IPython/lib/__init__.py": "",
  "IPython/lib/pretty.py": pretty,
};
const refused = {};
const OURS = "orientation-of-reference-frames";
const NUMERICAL = ["numpy", "matplotlib"];

let python, shell, packages, job;

const errorText = (error) => String(error?.message ?? error);
// Names of modules, by the packages that bring them and are not loaded.
const absentModules = () =>
  Object.entries(packages)
    .filter(([name]) => !(name in python.loadedPackages))
    .flatMap(([name, { imports }]) => imports.map((module) => [module, name]));

function tellWhatIsMissing() {
  const reasons = {};
  for (const name of NUMERICAL.filter((name) => !(name in packages))) {
    reasons[name] = `${named(name)} is not part of this site`;
  }
  for (const [module, name] of absentModules()) reasons[module] = refused[name] ?? `${named(name)} is not loaded yet`;
  const given = python.toPy(reasons);
  shell.lack(given);
  given.destroy();
}

// What has come so far, of all that comes before the first cell runs.
function followLoading(all) {
  const sizes = {};
  new PerformanceObserver((list) => {
    for (const { name, decodedBodySize } of list.getEntries()) sizes[name] = decodedBodySize;
    const bytes = Object.values(sizes).reduce((sum, size) => sum + size, 0);
    postMessage({ type: "progress", bytes: Math.min(bytes, all), all });
  }).observe({ type: "resource", buffered: true });
}

async function start({ runtime, interrupts }) {
  const [{ loadPyodide }, lock] = await Promise.all([
    import(`${runtime}pyodide/pyodide.mjs`),
    fetch(`${runtime}pyodide-lock.json`, { cache: "no-cache" }).then((answer) => answer.json()),
  ]);
  packages = lock.packages;
  followLoading(lock.bytes);
  python = await loadPyodide({
    indexURL: `${runtime}pyodide/`,
    lockFileContents: lock,
    packageBaseUrl: runtime,
    packages: [OURS],
    env: { HOME: "/home/reader", MPLBACKEND: "agg" },
  });
  const site = python.runPython("import sysconfig; sysconfig.get_path('purelib')");
  python.FS.mkdirTree(`${site}/IPython/lib`);
  for (const [name, text] of Object.entries(FILES)) python.FS.writeFile(`${site}/${name}`, text);
  if (interrupts) python.setInterruptBuffer(new Uint8Array(interrupts));
  shell = python.pyimport("session").start((text) =>
    postMessage({ type: "output", job, message: JSON.parse(text) }));
  tellWhatIsMissing();
  const fetched = Object.values(packages).map(({ file_name: file }) => file).find((file) => file.includes("://"));
  postMessage({
    type: "ready",
    numerical: NUMERICAL.filter((name) => name in packages),
    elsewhere: fetched ? new URL(fetched).host : null,
  });
}

// Load the package that brings a module, and say why if it does not come.
async function bring(module) {
  const name = absentModules().find(([found]) => found === module)?.[1];
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
    refused[name] = `${named(name)} could not be fetched from ${place}`;
  }
  tellWhatIsMissing();
  return came;
}

async function run({ code, name, needs = [] }) {
  for (const module of needs) if (!(await bring(module))) break;
  for (;;) {
    const outcome = JSON.parse(shell.run(code, name));
    if (outcome.status !== "missing") return outcome;
    if (!(await bring(outcome.package))) {
      // It may have been asked for only now: the reason is the newest one.
      const name = absentModules().find(([module]) => module === outcome.package)?.[1];
      return { ...outcome, reason: refused[name] ?? outcome.reason };
    }
    postMessage({ type: "output", job, message: { type: "clear" } });
  }
}

addEventListener("message", async ({ data }) => {
  try {
    if (data.type === "start") await start(data);
    else {
      job = data.job;
      postMessage({ type: "done", job, outcome: await run(data) });
    }
  } catch (error) {
    postMessage({ type: "dead", job: data.job, reason: errorText(error) });
  }
});

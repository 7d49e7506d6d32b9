// The whole book kept in this browser, to be read where there is no network: by choice, and with its size told.
// offline.json lists the files of the site by what each is for: a fingerprint and a number of bytes. What is kept lies in
// one cache, from which service-worker.js answers.
import { SITE } from "./answers.js";

const CACHE = `book ${SITE}`;
const LIST = new URL(`${SITE}kept.json`, location.href).href;
const TOLD = `book ${SITE} kept`;
const AT_ONCE = 6; // files that are fetched side by side
const megabytes = (bytes) => `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`;
const sum = (files) => Object.values(files).reduce((all, [, bytes]) => all + bytes, 0);
const address = (path) => new URL(SITE + encodeURI(path), location.href).href;

async function offered() {
  const answer = await fetch(`${SITE}offline.json`, { cache: "no-cache" });
  if (!answer.ok) throw new Error("these pages do not say what there is to keep (offline.json)");
  return answer.json();
}

async function kept() {
  if (!(await caches.has(CACHE))) return null;
  return (await (await caches.open(CACHE)).match(LIST))?.json() ?? null;
}

// What of ``files`` is not kept yet as it is now.
function missing(files, there) {
  return Object.fromEntries(Object.entries(files).filter(([path, [print]]) => there?.files[path] !== print));
}

async function renew(tools, offer, parts) {
  const files = Object.assign({}, ...parts.map((part) => offer[part]));
  const there = await kept();
  const wanted = Object.entries(missing(files, there));
  const all = sum(Object.fromEntries(wanted));
  let loaded = 0;
  const registration = await navigator.serviceWorker.register(`${SITE}service-worker.js`);
  const cache = await caches.open(CACHE);
  tools.say("The book is being fetched ...");
  tools.progress(0, all);
  const fetched = { ...there?.files };
  const note = (whole) => cache.put(LIST, new Response(JSON.stringify({ edition: whole ? offer.edition : null, parts, files: fetched })));
  try {
    const take = async () => {
      for (let next = wanted.shift(); next; next = wanted.shift()) {
        const [path, [print, bytes]] = next;
        const answer = await fetch(address(path), { cache: "no-cache" });
        if (!answer.ok) throw new Error(`${path} did not come (${answer.status})`);
        const content = await answer.arrayBuffer();
        const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", content));
        const found = Array.from(digest, (byte) => byte.toString(16).padStart(2, "0")).join("").slice(0, print.length);
        if (found !== print) throw new Error(`${path} is of another edition; try once more`);
        const headers = { "Content-Type": answer.headers.get("Content-Type") ?? "application/octet-stream" };
        await cache.put(address(path), new Response(content, { headers }));
        fetched[path] = print;
        tools.progress(loaded += bytes, all);
      }
    };
    await Promise.all(Array.from({ length: AT_ONCE }, take));
  } catch (error) {
    await note(false); // what has come need not be fetched again
    tools.progress(null);
    throw error;
  }
  for (const path of Object.keys(fetched)) {
    if (path in files) continue;
    delete fetched[path];
    await cache.delete(address(path));
  }
  await note(true);
  localStorage.setItem(TOLD, offer.edition);
  await navigator.storage?.persist?.(); // or the browser may make room when it likes
  tools.progress(null);
  return registration;
}

function hindrance() {
  if (!isSecureContext || !navigator.serviceWorker || !globalThis.caches) {
    return "This browser, or this address (it is not https), does not let pages be kept. “Offline pages” on the front page is the same book as a zip.";
  }
  return self === top ? null : "In a frame nothing can be kept: open the book in a tab of its own.";
}

// What the menu's entry does: tell the sizes, and ask.
export async function keep(tools) {
  const reason = hindrance();
  if (reason) return tools.say(reason);
  const there = await kept();
  let offer;
  try {
    offer = await offered();
  } catch (error) {
    if (!there) throw error;
    return tools.say("The book is kept in this browser, and there is no network now.");
  }
  const after = (words) => async (parts) => {
    try {
      await renew(tools, offer, parts);
      tools.say(words);
    } catch (error) {
      tools.say(`That did not work: ${error.message}.`);
    }
  };
  const take = after("The book is kept in this browser: its pages open without a network. Some browsers offer to install it as an app.");
  const size = (parts) => megabytes(parts.reduce((all, part) => all + sum(missing(offer[part], there)), 0));
  const forget = async () => {
    await caches.delete(CACHE);
    localStorage.removeItem(TOLD);
    tools.say("The book is no longer kept in this browser. Your answers still are.");
  };
  const actions = {};
  if (there?.edition !== offer.edition) {
    actions[`The pages, ${size(["book"])}`] = () => take(["book"]);
  }
  if (there?.edition !== offer.edition || !there.parts.includes("python")) {
    actions[`With Python, ${size(["book", "python"])}`] = () => take(["book", "python"]);
  }
  if (there) actions["Forget it"] = forget;
  actions["Not now"] = () => tools.say("Nothing was changed.");
  tools.ask(there?.edition === offer.edition ? "The book is kept in this browser, for reading without a network."
    : there ? "A copy of the book is kept here, of another edition. Renew it?"
      : "Keep the book in this browser, for reading without a network? It is fetched once.", actions);
}

// A kept book may have become old: say so, and what a new one weighs.
export async function remind(tools) {
  const there = await kept();
  if (!there) return localStorage.removeItem(TOLD);
  const offer = await offered().catch(() => null);
  if (!offer || offer.edition === there.edition) return;
  localStorage.setItem(TOLD, offer.edition); // once for each edition
  const size = megabytes(there.parts.reduce((all, part) => all + sum(missing(offer[part], there)), 0));
  tools.ask(`There is a new edition of the book that you keep for reading offline (${size}).`, {
    "Renew it": async () => {
      try {
        await renew(tools, offer, there.parts);
        tools.say("The newest edition is kept.");
      } catch (error) {
        tools.say(`That did not work: ${error.message}.`);
      }
    },
    "Not now": () => tools.say("The copy stays as it is; “Take away: read offline” renews it."),
  });
}

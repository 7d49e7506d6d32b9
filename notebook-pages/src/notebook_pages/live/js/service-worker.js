// Registered when the reader asks for what it does, and for nothing else: it isolates the pages, so that Python can be
// interrupted also where the server sends no such headers, and it gives the pages that were kept when there is no network.
const SITE = new URL("./", location.href).pathname;
const KEPT = `book ${SITE}`;
const LIST = `${SITE}kept.json`; // in the cache only: what is kept, as offline.json had it

addEventListener("install", () => skipWaiting());
addEventListener("activate", (event) => event.waitUntil(clients.claim()));

const ISOLATED = {
  "Cross-Origin-Opener-Policy": "same-origin",
  "Cross-Origin-Embedder-Policy": "require-corp",
  "Cross-Origin-Resource-Policy": "cross-origin",
};

function isolated(answer) {
  if (answer.status === 0 || answer.redirected) return answer; // a redirection: the browser asks again
  const headers = new Headers(answer.headers);
  for (const [name, value] of Object.entries(ISOLATED)) headers.set(name, value);
  const empty = [101, 204, 205, 304].includes(answer.status);
  return new Response(empty ? null : answer.body, { status: answer.status, statusText: answer.statusText, headers });
}

// The copy that is kept of a file; of a file whose address names a version, that version only.
async function copyOf(url) {
  if (!(await caches.has(KEPT))) return undefined;
  const cache = await caches.open(KEPT);
  const list = await (await cache.match(LIST))?.json();
  const path = decodeURI(url.pathname.slice(SITE.length)).replace(/(^|\/)$/, "$1index.html");
  const version = url.searchParams.get("v");
  if (!list?.files[path] || (version && !list.files[path].startsWith(version))) return undefined;
  return cache.match(new URL(SITE + path, location.href));
}

async function answer(request) {
  const url = new URL(request.url);
  // What never changes under its address need not be asked for again.
  const lasts = url.searchParams.has("v") || /\/(scripts|pyodide|sealed)-[0-9a-f]{12}\/|\/wheels\//.test(url.pathname);
  const kept = lasts && await copyOf(url);
  if (kept) return isolated(kept);
  try {
    return isolated(await fetch(request));
  } catch (error) {
    const copy = await copyOf(url);
    if (copy) return isolated(copy);
    throw error;
  }
}

addEventListener("fetch", (event) => {
  const { request } = event, url = new URL(request.url);
  // JupyterLite has a service worker of its own, and hangs in an isolated page.
  if (request.method !== "GET" || url.origin !== location.origin || url.pathname.startsWith(`${SITE}lite/`)) return;
  if (request.cache === "only-if-cached" && request.mode !== "same-origin") return;
  event.respondWith(answer(request));
});

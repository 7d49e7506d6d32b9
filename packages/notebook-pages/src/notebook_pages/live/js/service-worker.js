// Registered when the reader asks for what it does, and for nothing else: it isolates the pages, so that Python can be
// interrupted also where the server sends no such headers, and it gives the pages that were kept.
import { Editions } from "./editions.js";

const SITE = new URL("./", location.href).pathname;
const editions = new Editions(SITE);
const RACE = 2000; // milliseconds: so long a page waits for a newer edition to come whole, before the kept one is shown

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

// Whether the address is one of the book's own: below a root, others may have theirs. ``self.bookHolds`` is what
// install.py found at the top of the site; JupyterLite has a service worker of its own, and hangs in an isolated page.
function isOurs({ origin, pathname, searchParams }) {
  if (origin !== location.origin || !pathname.startsWith(SITE) || searchParams.has("kept")) return false;
  return ["", ...self.bookHolds].includes(decodeURI(pathname.slice(SITE.length)).split("/")[0]);
}

// A kept book renews itself: whole, or not at all. Pages that are open, and were there before, are told.
let looking = null;
async function renew() {
  const there = await editions.newest();
  if (!there || (await editions.offered()).edition === there.edition) return;
  const { edition } = await editions.renew();
  if (edition !== there.edition) for (const client of await clients.matchAll({ type: "window" })) client.postMessage({ edition });
}

async function answer(event, url) {
  // Where nothing has come of the last look, or it still goes on, no page waits for the next one.
  if (event.request.mode === "navigate" && !looking) {
    looking = renew().catch((error) => console.info(`The stored book stays as it is: ${error.message}`));
    const over = looking.finally(() => (looking = null));
    event.waitUntil(over);
    await Promise.race([over, new Promise((go) => setTimeout(go, RACE))]);
  }
  return isolated((await editions.find(url)) ?? (await fetch(event.request)));
}

addEventListener("fetch", (event) => {
  const { request } = event, url = new URL(request.url);
  if (request.method !== "GET" || !isOurs(url)) return;
  if (request.cache === "only-if-cached" && request.mode !== "same-origin") return;
  event.respondWith(answer(event, url));
});

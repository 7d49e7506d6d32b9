// Registered only when the reader asks for something that needs it: it isolates the pages, so that Python can be
// interrupted even if the server does not send the required headers, and it returns the stored pages.
import { Editions } from "./editions.js";

const SITE = new URL("./", location.href).pathname;
const editions = new Editions(SITE);
const RACE = 2000; // milliseconds that a page waits for a newer edition before the stored one is shown

addEventListener("install", () => skipWaiting());
addEventListener("activate", (event) => event.waitUntil(clients.claim()));

const ISOLATED = {
  "Cross-Origin-Opener-Policy": "same-origin",
  "Cross-Origin-Embedder-Policy": "require-corp",
  "Cross-Origin-Resource-Policy": "cross-origin",
};

function isolated(answer) {
  if (answer.status === 0 || answer.redirected) return answer; // the browser follows a redirection by a new request
  const headers = new Headers(answer.headers);
  for (const [name, value] of Object.entries(ISOLATED)) headers.set(name, value);
  const empty = [101, 204, 205, 304].includes(answer.status);
  return new Response(empty ? null : answer.body, { status: answer.status, statusText: answer.statusText, headers });
}

// Whether the address is one of the book's own, as below a root there may be others. ``self.bookHolds`` is what
// install.py found at the top of the site; JupyterLite has its own service worker, and hangs in an isolated page.
function isOurs({ origin, pathname, searchParams }) {
  if (origin !== location.origin || !pathname.startsWith(SITE) || searchParams.has("kept")) return false;
  return ["", ...self.bookHolds].includes(decodeURI(pathname.slice(SITE.length)).split("/")[0]);
}

// Update a stored book, completely or not at all, and tell the pages that were open before.
let looking = null;
async function renew() {
  const there = await editions.newest();
  if (!there || (await editions.offered()).edition === there.edition) return;
  const { edition } = await editions.renew();
  if (edition !== there.edition) for (const client of await clients.matchAll({ type: "window" })) client.postMessage({ edition });
}

async function answer(event, url) {
  // A page that opens while an update is in progress does not wait for it.
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

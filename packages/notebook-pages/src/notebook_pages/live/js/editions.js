// The editions of the book that this browser stores, completely or not at all: for the service worker, and for the
// page's menu. A file is stored under its path and its content, so that no edition overwrites a file of another. An
// edition is a list of such files, and the one entry that names the newest is written when all of them are there. The
// files of the edition before stay for open tabs that still show it. The list has the version of the store.
import { cacheOf, NEWER, VERSION } from "./store.js";

const SILENCE = 20_000; // milliseconds without data, after which a download is given up
const AT_ONCE = 6; // files that are fetched in parallel

export class Editions {
  constructor(site) {
    this.site = site;
    this.name = cacheOf(site);
    this.list = this.address("kept.json"); // in the cache only
  }

  address(path) {
    return new URL(this.site + encodeURI(path), location.href).href;
  }

  // The address of a file in the cache, and for fetching it, so that no cache returns the file of another edition.
  key(path, print) {
    return `${this.address(path)}?kept=${print}`;
  }

  // {format, edition, parts, files, before}: the newest complete edition, or null. ``files`` has fingerprints by path.
  // Throws an error if it is to be changed and a newer version of the store has written it.
  async newest(toChange = false) {
    if (!(await caches.has(this.name))) return null;
    const list = await (await (await caches.open(this.name)).match(this.list))?.json();
    if (toChange && list?.format > VERSION) throw new Error(NEWER);
    return list?.edition && !(list.format > VERSION) ? list : null;
  }

  // The stored file for ``url``: of the newest edition, or of the one before if ``url`` has the version of that one.
  async find(url) {
    const list = await this.newest();
    if (!list) return undefined;
    const path = decodeURI(url.pathname.slice(this.site.length)).replace(/(^|\/)$/, "$1index.html");
    const version = url.searchParams.get("v") ?? "";
    const print = [list.files[path], list.before?.[path]].find((known) => known?.startsWith(version));
    return print && this.file(path, print);
  }

  async file(path, print) {
    return (await caches.open(this.name)).match(this.key(path, print));
  }

  // The server's list of files to store, in two parts, with [fingerprint, bytes] by path.
  async offered() {
    const answer = await fetch(this.address("offline.json"), { cache: "no-cache", signal: AbortSignal.timeout(SILENCE) });
    if (!answer.ok) throw new Error("this site has no list of the pages to store (offline.json)");
    return answer.json();
  }

  // The files of some parts that have to be fetched.
  async missing(offer, parts) {
    const files = Object.entries(Object.assign({}, ...parts.map((part) => offer[part])));
    const there = new Set((await caches.has(this.name)) ? (await (await caches.open(this.name)).keys()).map(({ url }) => url) : []);
    return files.filter(([path, [print]]) => !there.has(this.key(path, print)));
  }

  // Fetch the missing files, then make this the newest edition. If this is interrupted, nothing has changed except that
  // less is missing the next time. Two tabs would do the same work, so the second one waits. Returns the list.
  renew(parts, progress = () => {}) {
    return navigator.locks.request(this.name, async () => {
      const there = await this.newest(true), offer = await this.offered();
      const wanted = await this.missing(offer, parts ??= there.parts);
      if (there?.edition === offer.edition && parts.every((part) => there.parts.includes(part))) return there;
      const cache = await caches.open(this.name);
      const all = wanted.reduce((sum, [, [, bytes]]) => sum + bytes, 0);
      let loaded = 0;
      progress(0, all);
      const take = async () => {
        for (let next = wanted.shift(); next; next = wanted.shift()) {
          const [path, [print, bytes]] = next;
          await cache.put(this.key(path, print), await this.fetch(path, print));
          progress(loaded += bytes, all);
        }
      };
      await Promise.all(Array.from({ length: AT_ONCE }, take));
      const prints = (of) => Object.fromEntries(Object.entries(of).map(([path, [print]]) => [path, print]));
      const files = prints(Object.assign({}, ...parts.map((part) => offer[part])));
      const same = there?.edition === offer.edition;
      const before = same ? there.before : there?.files;
      const list = { format: VERSION, edition: offer.edition, parts, files, before };
      await cache.put(this.list, new Response(JSON.stringify(list), { headers: { "Content-Type": "application/json" } }));
      const used = new Set([files, before ?? {}].flatMap((of) => Object.entries(of)).map(([path, print]) => this.key(path, print)));
      for (const { url } of await cache.keys()) if (url !== this.list && !used.has(url)) await cache.delete(url);
      return list;
    });
  }

  // Fetch one file, and return it if it is the one that the edition names.
  async fetch(path, print) {
    const giveUp = new AbortController();
    let clock;
    const wait = () => {
      clearTimeout(clock);
      clock = setTimeout(() => giveUp.abort(new Error(`${path} has sent nothing for ${SILENCE / 1000} seconds`)), SILENCE);
    };
    try {
      wait();
      const answer = await fetch(this.key(path, print), { cache: "no-cache", signal: giveUp.signal });
      if (!answer.ok) throw new Error(`${path} could not be downloaded (${answer.status})`);
      const parts = [], reader = answer.body.getReader();
      for (let { done, value } = await reader.read(); !done; { done, value } = await reader.read()) {
        wait();
        parts.push(value);
      }
      const content = await new Blob(parts).arrayBuffer();
      const digest = new Uint8Array(await crypto.subtle.digest("SHA-256", content));
      const found = Array.from(digest, (byte) => byte.toString(16).padStart(2, "0")).join("").slice(0, print.length);
      if (found !== print) throw new Error(`${path} belongs to a different edition; try again`);
      return new Response(content, { headers: { "Content-Type": answer.headers.get("Content-Type") ?? "application/octet-stream" } });
    } finally {
      clearTimeout(clock);
    }
  }

  forget() {
    return caches.delete(this.name);
  }
}

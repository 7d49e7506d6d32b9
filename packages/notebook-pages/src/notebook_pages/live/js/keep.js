// Store the whole book in this browser for reading without a network, when the reader asks for it and knows its size.
import { SITE } from "./answers.js";
import { Editions } from "./editions.js";

const editions = new Editions(SITE);
const megabytes = (bytes) => `${(bytes / 1e6).toFixed(bytes < 1e7 ? 1 : 0)} MB`;

function hindrance() {
  if (!isSecureContext || !navigator.serviceWorker || !globalThis.caches) {
    return "This browser, or this address (it is not https), cannot store pages. “Offline pages” on the front page is the same book as a zip.";
  }
  return self === top ? null : "A page in a frame cannot store anything. Open the book in its own tab.";
}

async function take(tools, parts) {
  tools.say("Downloading the book ...");
  try {
    await navigator.serviceWorker.register(`${SITE}service-worker.js`);
    await editions.renew(parts, tools.progress);
    tools.say("The book is stored in this browser, and its pages open without a network. Some browsers offer to install it as an app.");
    // Otherwise the browser may delete it when it needs space. Some browsers ask the reader, which may take time.
    navigator.storage?.persist?.().catch(() => {});
  } catch (error) {
    const full = error.name === "QuotaExceededError";
    tools.say(`That did not work: ${full ? "this browser has no room left for the book" : error.message}. Nothing was changed.`);
  }
  tools.progress(null);
}

// The action of the menu's entry: show the sizes, and ask.
export async function keep(tools) {
  const reason = hindrance();
  if (reason) return tools.say(reason);
  let there, offer;
  try {
    there = await editions.newest(true);
  } catch (error) {
    return tools.say(error.message); // stored by a newer edition: it is left alone
  }
  try {
    offer = await editions.offered();
  } catch (error) {
    if (!there) throw error;
    return tools.say("The book is stored in this browser, but there is no network now.");
  }
  const size = async (parts) => megabytes((await editions.missing(offer, parts)).reduce((all, [, [, bytes]]) => all + bytes, 0));
  const isNewest = there?.edition === offer.edition;
  const actions = {};
  if (!isNewest) actions[`The pages, ${await size(["book"])}`] = () => take(tools, ["book"]);
  if (!isNewest || !there.parts.includes("python")) {
    actions[`With Python, ${await size(["book", "python"])}`] = () => take(tools, ["book", "python"]);
  }
  if (there) {
    actions["Forget it"] = async () => {
      await editions.forget();
      tools.say("The book is no longer stored in this browser. Your answers still are.");
    };
  }
  actions["Not now"] = () => tools.say("Nothing was changed.");
  tools.ask(isNewest ? "The book is stored in this browser, so you can read it without a network."
    : there ? "The copy stored here is from a different edition. Update it?"
      : "Store the book in this browser, to read it without a network? The browser then downloads whatever changes in the pages.", actions);
}

// The sections of a page by their headings, without their subsections.
function sections(text) {
  const page = new DOMParser().parseFromString(text, "text/html");
  page.querySelectorAll(".headerlink, .katex math").forEach((part) => part.remove());
  return new Map([...page.querySelectorAll("article section[id]")].map((section) => {
    const heading = section.querySelector("h1, h2, h3, h4")?.textContent.trim() ?? section.id;
    section.querySelectorAll("section").forEach((part) => part.remove());
    return [heading, section.textContent.replace(/\s+/g, " ")];
  }));
}

// A newer edition was stored while this page was open: say so, and what has changed on the page.
export async function tellOfRenewal(tools) {
  const list = await editions.newest();
  const page = decodeURI(location.pathname.slice(SITE.length)).replace(/(^|\/)$/, "$1index.html");
  const copy = async (files) => (await editions.file(page, files?.[page]))?.text();
  const [before, now] = [await copy(list.before), await copy(list.files)];
  if (!before || !now || before === now) return;
  const [old, fresh] = [sections(before), sections(now)];
  const changed = [...fresh].filter(([heading, text]) => old.get(heading) !== text).map(([heading]) => `“${heading}”`);
  const what = !changed.length ? "The text of this page has not changed."
    : `Changed on this page: ${changed.slice(0, 4).join(", ")}${changed.length > 4 ? ` and ${changed.length - 4} more` : ""}.`;
  tools.ask(`There is a new edition of the book. ${what}`, {
    "Show it": () => location.reload(),
    "Not now": () => tools.say("The page stays as it is until you open it again."),
  });
}

// Show the target of a link to an equation, a figure, a term or a source beside the link, when the pointer or the
// keyboard focus is on it. Escape, or leaving both, closes the preview; a touch follows the link as usual. Targets on
// another page are fetched when first needed (see previews.py).
{
  const LINKS = ["#equation-", "#fig", "#term-", "bibliography.html#id"].map((part) => `.bd-article a.internal[href*="${part}"]`).join();
  const root = new URL(document.documentElement.dataset.content_root || "./", location.href);
  const [SOON, LATER] = [300, 250]; // milliseconds until it is shown, and until it closes
  const article = document.querySelector(".bd-article");
  let wanted, shown, timer;

  const coming = {};
  const places = (page) => coming[page] ??= new Promise((resolve) => {
    const script = Object.assign(document.createElement("script"), { src: new URL(`_static/previews/${page.replaceAll("/", "-")}.js`, root) });
    script.onload = () => resolve(self.previews[page]);
    script.onerror = () => (delete coming[page], resolve({})); // try again later, as the network may return
    document.head.append(script);
  });

  // A copy of a place on this page, without its names and links.
  const copied = (place) => {
    const box = document.createElement("div");
    if (place.matches("dt")) {
      let text = place;
      while (text && !text.matches("dd")) text = text.nextElementSibling;
      const list = Object.assign(document.createElement("dl"), { className: "glossary" });
      list.append(place.cloneNode(true), text?.cloneNode(true) ?? "");
      box.append(list);
    } else if (place.matches("figure")) {
      const drawing = Object.assign(document.createElement("div"), { className: "orientation-figure" });
      const [image, caption] = ["svg, img", "figcaption"].map((name) => place.querySelector(name)?.cloneNode(true) ?? "");
      drawing.append(image);
      box.append(drawing, caption);
    } else box.append(place.cloneNode(true));
    box.querySelectorAll(".headerlink, .label").forEach((part) => part.remove());
    box.querySelectorAll("a").forEach((link) => link.replaceWith(...link.childNodes));
    box.querySelectorAll("[id]:not(svg [id])").forEach((part) => part.removeAttribute("id"));
    box.querySelectorAll(".later").forEach((part) => part.classList.remove("later"));
    return box;
  };

  const contentOf = async (link) => {
    const url = new URL(link.href), name = decodeURIComponent(url.hash.slice(1));
    if (url.pathname === location.pathname) {
      const place = document.getElementById(name);
      return place && copied(place);
    }
    if (!url.href.startsWith(root.href)) return null;
    const found = (await places(url.href.slice(root.href.length).replace(/(\.html)?[?#].*$/, "")))[name];
    return found ? Object.assign(document.createElement("div"), { innerHTML: found }) : null;
  };

  // Constants, because function declarations here would replace those of the window.
  const close = () => {
    clearTimeout(timer);
    wanted = null;
    if (!shown) return;
    shown.link.removeAttribute("aria-describedby");
    shown.box.remove();
    shown = null;
  };

  const open = (link, wait) => {
    clearTimeout(timer);
    if (shown?.link === link) return;
    wanted = link;
    timer = setTimeout(async () => {
      const box = await contentOf(link);
      if (wanted !== link || !box) return;
      close();
      [wanted, shown] = [link, { link, box }];
      Object.assign(box, { id: "preview", className: "preview" });
      box.setAttribute("role", "tooltip");
      article.append(box);
      link.setAttribute("aria-describedby", "preview");
      const at = link.getClientRects()[0], size = box.getBoundingClientRect(), from = box.offsetParent.getBoundingClientRect();
      const below = at.bottom + 6 + size.height <= innerHeight || at.top < size.height + 6;
      box.style.left = `${Math.max(8, Math.min(at.left, document.documentElement.clientWidth - size.width - 8)) - from.left}px`;
      box.style.top = `${(below ? at.bottom + 6 : at.top - size.height - 6) - from.top}px`;
    }, wait);
  };

  const linkAt = ({ target }) => target.closest?.(LINKS);
  document.addEventListener("pointerover", (event) => {
    if (event.pointerType === "touch") return;
    const link = linkAt(event);
    if (link) open(link, SOON);
    else if (shown?.box.contains(event.target)) clearTimeout(timer);
    else if (wanted && !wanted.matches(":focus-visible")) {
      clearTimeout(timer);
      timer = setTimeout(close, LATER);
    }
  });
  document.addEventListener("focusin", (event) => {
    const link = linkAt(event);
    if (link?.matches(":focus-visible")) open(link, SOON);
    else close();
  });
  document.addEventListener("focusout", (event) => linkAt(event) && close());
  document.addEventListener("keydown", ({ key }) => key === "Escape" && close());
  document.addEventListener("click", (event) => linkAt(event) && close());
  addEventListener("pagehide", close);
}

// On every page with code: the buttons, and a bar for what there is to say. All else is loaded when asked for.
{
  const data = JSON.parse(document.getElementById("live-data").textContent);
  const boxes = [...document.querySelectorAll("div.cell")].filter((box) => box.querySelector(".cell_input"));
  const make = (tag, attributes, text = "") => Object.assign(document.createElement(tag), attributes, { textContent: text });

  // The bar at the foot of the window: it lies over the page, so that no line moves.
  const bar = make("section", { className: "live-bar", hidden: true });
  bar.setAttribute("aria-label", "Python on this page");
  const words = make("p", { id: "live-words" });
  words.setAttribute("role", "status");
  const progress = make("progress", { hidden: true });
  progress.setAttribute("aria-label", "Loading Python");
  const bytes = make("span", { className: "live-bytes" });
  bytes.setAttribute("aria-hidden", "true"); // the words are said once; the numbers change all the time
  const keys = make("p", { id: "live-keys" }, "Shift+Enter runs a cell, Escape leaves it.");
  const close = make("button", { type: "button", className: "live-close", title: "Close this bar" }, "×");
  close.setAttribute("aria-label", "Close this bar");
  close.addEventListener("click", () => (bar.hidden = true));
  bar.append(words, bytes, progress, keys, close);
  document.body.append(bar);
  const tools = {
    say(text) {
      bar.hidden = false;
      words.textContent = text;
    },
    progress(loaded, all) {
      progress.hidden = loaded === null;
      bytes.textContent = loaded === null ? "" : `${Math.round(loaded / 1e6)} of ${Math.round(all / 1e6)} MB`;
      if (loaded !== null) Object.assign(progress, { max: all, value: loaded });
    },
    buttons(actions) {
      return Object.entries(actions).map(([text, action]) => {
        const button = make("button", { type: "button" }, text);
        button.addEventListener("click", action);
        close.before(button);
        return button;
      });
    },
  };

  const fromDisk = location.protocol === "file:";
  const FROM_DISK = "A page opened from disk cannot run code. In the folder of the book run: python serve.py, and open the address that it prints.";
  document.querySelector("a.open-notebook")?.addEventListener("click", (event) => {
    if (!fromDisk) return;
    event.preventDefault();
    tools.say(FROM_DISK);
  });

  let page;
  const ask = async (number) => {
    if (fromDisk) return tools.say(FROM_DISK);
    try {
      page ??= import(new URL(data.script, location.href)).then(({ open }) => open({ data, boxes, bar: tools }));
      const opened = await page;
      if (number !== undefined) opened.run(opened.cells[number]);
    } catch (error) {
      page = undefined;
      tools.say(`What runs the code could not be loaded: ${error.message}.`);
    }
  };

  boxes.forEach((box, number) => {
    const button = make("button", { type: "button", className: "run-cell" }, "Run");
    button.setAttribute("aria-label", `Run cell ${number + 1}`);
    button.addEventListener("click", () => ask(number));
    box.querySelector(".cell_input").append(button);
  });
  document.querySelector("button.run-page").addEventListener("click", () => ask(-1));
  try {
    if (localStorage.getItem(`code of ${data.page}`)) ask();
  } catch {
    // Without storage there is nothing to bring back.
  }
}

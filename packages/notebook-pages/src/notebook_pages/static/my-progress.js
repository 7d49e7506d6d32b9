// Fill in the table of My progress, and let the reader export the record, import it and delete it.
{
  const table = document.querySelector("table.my-progress");
  const gone = document.createElement("p"); // about answers to an edition that asked more
  const record = (page) => progress.all()[page] ?? { read: [], done: [], checked: [], answers: {} };
  const fill = () => {
    let older = 0;
    for (const row of table.tBodies[0].rows) {
      const { read, done, checked, answers } = record(row.dataset.page);
      // Answers that were right with numbers other than the reader's do not count, but stay in the record.
      const mine = [...checked, ...record(row.dataset.companion).checked].filter((name) => bookStore.standing(name)?.whose === undefined);
      const all = { read, done, checked: mine, predictions: Object.keys(answers), recap: Object.keys(answers) };
      for (const cell of row.querySelectorAll("td")) {
        const names = cell.dataset.names.split(" ").filter(Boolean);
        const reached = names.filter((name) => all[cell.dataset.kind].includes(name));
        if (names.length) cell.textContent = `${reached.length} of ${names.length}`; // else there is nothing to do
        if (cell.dataset.kind === "recap" && reached.length)
          cell.textContent += `, ${reached.filter((name) => answers[name].rightAtFirst).length} right on the first try`;
        cell.classList.toggle("whole", names.length > 0 && reached.length === names.length);
      }
      const asked = [...row.querySelectorAll("td")].flatMap((cell) => cell.dataset.names.split(" "));
      older += [...Object.keys(answers), ...done].filter((name) => !asked.includes(name)).length;
    }
    gone.hidden = !older;
    gone.textContent = `Your record also holds answers to questions of an earlier edition that this one no longer asks: ${older} in all. It is kept, and Export saves it.`;
  };

  const make = (tag, attributes) => Object.assign(document.createElement(tag), attributes);
  const words = make("p", { className: "said" });
  words.setAttribute("role", "status");
  const say = (text) => (words.textContent = text);
  const take = make("button", { type: "button", textContent: "Export" });
  take.addEventListener("click", () => {
    const address = URL.createObjectURL(new Blob([JSON.stringify({ pages: progress.all() }, null, 1)], { type: "application/json" }));
    make("a", { href: address, download: "my-progress.json" }).click();
    URL.revokeObjectURL(address);
    say("Saved as my-progress.json.");
  });
  const file = make("input", { type: "file", accept: ".json,application/json", hidden: true });
  const bring = make("button", { type: "button", textContent: "Import" });
  bring.addEventListener("click", () => file.click());
  file.addEventListener("change", async () => {
    try {
      const imported = JSON.parse(await file.files[0].text());
      if (typeof imported?.pages !== "object") throw new Error("no pages");
      progress.replace(imported);
      fill();
      say("Imported: your record is back.");
    } catch {
      say("That file was not exported from this page, so nothing has changed.");
    }
    file.value = "";
  });
  const clear = make("button", { type: "button", textContent: "Clear" });
  let asked = false;
  clear.addEventListener("click", () => {
    if (!asked) {
      asked = true;
      clear.textContent = "Yes, clear everything";
      return say("This erases everything in the table. Export it first if you would like to keep it.");
    }
    asked = false;
    clear.textContent = "Clear";
    progress.replace({});
    fill();
    say("Cleared.");
  });
  const actions = make("p", { className: "actions" });
  actions.append(take, bring, file, clear);
  table.parentElement.after(gone, actions, words);
  fill();
  say(progress.whyNotKept());
}

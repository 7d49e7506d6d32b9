// Questions on the page: the reader commits to an answer, and then sees the reply to it.
{
  const make = (tag, attributes = {}, ...children) => {
    const element = Object.assign(document.createElement(tag), attributes);
    element.append(...children);
    return element;
  };
  const ANY_OTHER = "anything else";
  const replies = (box) => [...box.querySelectorAll(".replies li[data-name]")];

  // Each way of answering has a control, the name of the reply to an answer, and a function to show an answer again.
  const choosing = (box) => {
    const list = box.querySelector(".choices");
    list.setAttribute("role", "radiogroup");
    list.setAttribute("aria-label", "Choices");
    const inputs = [...list.children].map((item) => {
      const input = make("input", { type: "radio", name: box.id, value: item.dataset.name });
      const words = make("span", {}, ...item.firstElementChild.childNodes);
      // Browsers leave formulas out of the names of controls.
      const spoken = words.cloneNode(true);
      spoken.querySelectorAll(".katex > i:last-child").forEach((drawing) => drawing.remove());
      input.setAttribute("aria-label", `${item.dataset.name}: ${spoken.textContent.trim()}`);
      item.setAttribute("role", "presentation");
      item.replaceChildren(make("label", {}, input, make("b", { textContent: item.dataset.name }), words));
      return input;
    });
    return {
      element: list,
      answer: () => inputs.find((input) => input.checked)?.value,
      show: (answer) => inputs.forEach((input) => (input.checked = input.value === answer)),
      reply: (answer) => answer,
      hint: "Choose one first.",
    };
  };
  const nearest = (box, answer, turn) => {
    const tolerance = Number(box.dataset.tolerance) + 1e-9;
    const away = (name) => {
      const difference = Math.abs(Number(name) - Number(answer)) % (turn || Infinity);
      return turn ? Math.min(difference, turn - difference) : difference;
    };
    return replies(box).map((item) => item.dataset.name).find((name) => name !== ANY_OTHER && away(name) <= tolerance) ?? ANY_OTHER;
  };
  // Read a number as people write it: "0,5", "1/2", "45°", "45 degrees". A unit has to be one that the question names.
  const DEGREES = /^(°|deg\b|degrees?\b)/i;
  const numberIn = (text, asked) => {
    const match = /^([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?)(?:\s*\/\s*(\d+\.?\d*))?\s*(\D*)$/i.exec(text.trim().replace(",", ".").replace("\u2212", "-"));
    if (!match) return NaN;
    const [, above, below = 1, unit] = match;
    const named = DEGREES.test(unit) ? /°|degree/i.test(asked) : asked.toLowerCase().includes(unit.trim().toLowerCase());
    return named ? above / below : NaN;
  };
  const typing = (box) => {
    const input = make("input", { type: "text", inputMode: "decimal", autocomplete: "off", size: 8, name: box.id });
    const value = () => numberIn(input.value, box.textContent);
    return {
      element: make("label", { className: "number" }, "Your number: ", input),
      answer: () => (Number.isFinite(value()) ? String(value()) : undefined),
      show: (answer) => (input.value = answer),
      reply: (answer) => nearest(box, answer, 0),
      hint: "First type a number in the unit that the question gives, such as 0.5, 1/2 or 45°.",
    };
  };
  // An arrow to drag around a circle, from the x axis on the right towards the y axis, or to turn by the arrow keys.
  const STEP = 5;
  const drawing = (box) => {
    const figure = make("div", { className: "dial" });
    figure.innerHTML = `<svg viewBox="-100 -100 200 200" width="200" height="200" aria-hidden="true">
      <circle r="72"/><path class="axes" d="M0 0H80M0 0V-80"/><path class="tips" d="M80 -4l9 4l-9 4zM-4 -80l4 -9l4 9z"/>
      <text x="84" y="20">n\u0302<tspan dy="4">x</tspan></text><text x="-32" y="-82">n\u0302<tspan dy="4">y</tspan></text>
      <g class="needle"><path d="M0 0H60"/><path class="tip" d="M60 -6l14 6l-14 6z"/></g></svg>`;
    figure.tabIndex = 0;
    let angle = 0, touched = false;
    const set = (value) => {
      angle = ((value % 360) + 360) % 360;
      figure.querySelector(".needle").setAttribute("transform", `rotate(${-angle})`);
      figure.setAttribute("aria-valuenow", angle);
      figure.setAttribute("aria-valuetext", `${angle} degrees from n x towards n y`);
    };
    for (const [name, value] of [["role", "slider"], ["aria-label", "Your arrow"], ["aria-valuemin", 0], ["aria-valuemax", 360]])
      figure.setAttribute(name, value);
    const follow = (event) => {
      const { left, top, width, height } = figure.firstElementChild.getBoundingClientRect();
      const degrees = (Math.atan2(top + height / 2 - event.clientY, event.clientX - left - width / 2) * 180) / Math.PI;
      touched = true;
      set(STEP * Math.round(degrees / STEP));
    };
    figure.addEventListener("pointerdown", (event) => {
      figure.setPointerCapture(event.pointerId);
      follow(event);
    });
    figure.addEventListener("pointermove", (event) => figure.hasPointerCapture(event.pointerId) && follow(event));
    figure.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: STEP, ArrowUp: STEP, ArrowRight: -STEP, ArrowDown: -STEP, Home: -angle }[event.key];
      if (step === undefined) return;
      event.preventDefault();
      touched = true;
      set(angle + step);
    });
    set(0);
    return {
      element: figure,
      answer: () => (touched ? String(angle) : undefined),
      show(answer) {
        touched = true;
        set(Number(answer));
      },
      reply: (answer) => nearest(box, answer, 360),
      hint: "Drag the arrow first, or turn it with the arrow keys.",
    };
  };

  // Cover what follows a prediction and would give it away, until the reader has committed to an answer.
  const cover = (box) => {
    const covered = make("div", { className: "covered", inert: true });
    const next = [];
    for (let element = box.nextElementSibling; element && next.length < Number(box.dataset.covers); element = element.nextElementSibling)
      next.push(element);
    box.after(covered);
    covered.append(...next);
    return covered;
  };

  const openers = [];   // of the predictions, to open all of them or none
  for (const box of document.querySelectorAll(".question")) {
    const way = { answer: choosing, number: typing, angle: drawing }[box.dataset.kind](box);
    const fold = box.querySelector(".replies");
    const result = make("div", { className: "result" });
    result.setAttribute("role", "status");
    const commit = make("button", { type: "button", textContent: box.classList.contains("predict") ? "That is my prediction" : "Check" });
    const skip = make("button", { type: "button", className: "quiet", textContent: "Show the answer" });
    const name = box.querySelector(".question-name, .admonition-title").textContent;
    for (const button of [commit, skip]) button.setAttribute("aria-label", `${button.textContent}: ${name}`);
    fold.before(way.element, make("p", { className: "actions" }, commit, skip), result);
    fold.hidden = true;

    const before = progress.here().answers[box.id];
    const covered = Number(box.dataset.covers) && !before ? cover(box) : null;
    if (covered) box.append(make("p", { className: "cover-note", textContent: "The next part is hidden until you answer." }));
    const uncover = () => {
      box.querySelector(".cover-note")?.remove();
      if (!covered?.inert) return;
      covered.inert = false;
      covered.className = "uncovered";
    };
    const show = (answer) => {
      const chosen = replies(box).find((item) => item.dataset.name === way.reply(answer));
      const right = chosen.classList.contains("right");
      const words = chosen.querySelector("div").cloneNode(true);
      result.className = `result ${right ? "right" : "wrong"}`;
      result.replaceChildren(make("p", { className: "verdict" }, make("strong", { textContent: right ? "Right." : "Not quite." })), words);
      fold.hidden = false;
      fold.firstElementChild.textContent = right ? "All replies" : "The answer";
      skip.hidden = true;
      return right;
    };
    commit.addEventListener("click", () => {
      const answer = way.answer();
      if (answer === undefined) return Object.assign(result, { className: "result", textContent: way.hint });
      const right = show(answer);
      uncover();
      progress.change(({ answers }) => {
        const { first = answer, rightAtFirst = right } = answers[box.id] ?? {};
        answers[box.id] = { first, last: answer, right, rightAtFirst };
      });
    });
    way.element.addEventListener("keydown", ({ key, isComposing }) => key === "Enter" && !isComposing && commit.click());
    const open = () => {
      uncover();
      fold.hidden = false;
      fold.open = true;
    };
    skip.addEventListener("click", () => {
      open();
      fold.firstElementChild.focus();
      skip.hidden = true;
    });
    if (before) {
      way.show(before.last);
      show(before.last);
    }
    // A link to a place that is covered uncovers it.
    const arrive = () => {
      const place = location.hash && document.getElementById(location.hash.slice(1));
      if (!place || !covered?.inert || !covered.contains(place)) return;
      uncover();
      place.scrollIntoView();
    };
    addEventListener("hashchange", arrive);
    arrive();
    addEventListener("beforeprint", open);
    if (box.classList.contains("predict")) openers.push({ open, uncover });
  }

  // The reader can choose once to open all predictions of the book, or to leave them out.
  const first = document.querySelector(".question.predict");
  if (first) {
    const ways = [["asked", "asked as they come"], ["open", "all open"], ["none", "left out"]];
    const choice = make("select", {}, ...ways.map(([value, words]) => make("option", { value, textContent: words })));
    const line = make("p", { className: "said predictions" }, make("label", {}, "Predictions: ", choice));
    const apply = (chosen) => {
      document.documentElement.dataset.predictions = chosen;
      choice.value = chosen;
      // In the space above the first prediction, where it moves no line; without predictions it is a line of its own.
      if (chosen === "none") first.before(line);
      else first.prepend(line);
      if (chosen === "open") for (const { open } of openers) open();
      if (chosen === "none") for (const { uncover } of openers) uncover();
    };
    choice.addEventListener("change", () => {
      apply(choice.value);
      bookStore.put("setting predictions", choice.value);
    });
    const chosen = bookStore.read("setting predictions");
    apply(ways.some(([value]) => value === chosen) ? chosen : "asked");
  }

  // The result of the recap, in one line.
  for (const recap of document.querySelectorAll(".recap")) {
    const line = make("p", { className: "score" });
    recap.append(line);
    const names = [...recap.querySelectorAll(".question")].map((box) => box.id);
    const tell = () => {
      const answers = names.map((name) => progress.here().answers[name]).filter(Boolean);
      const right = answers.filter((answer) => answer.rightAtFirst).length;
      line.textContent = answers.length ? `${answers.length} of ${names.length} answered, ${right} right on the first try.` : "";
    };
    document.addEventListener("progress", tell);
    tell();
  }
}

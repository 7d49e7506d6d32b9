// Keys: each thing that has one names it in `data-key`. Without this script everything is still reached by Tab.
document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const field = event.target.closest("input, textarea, select");
  if (field) {
    // In a field signs are signs; Escape leaves it.
    if (event.key === "Escape") field.blur();
    else if (event.key === "Enter" && field.matches("form.decide input")) event.preventDefault();
    return;
  }
  const found = [...document.querySelectorAll("[data-key]")].find((one) => one.dataset.key === event.key);
  if (!found) return;
  event.preventDefault();
  if (found.matches("input, textarea, select")) found.focus();
  else found.click();
});

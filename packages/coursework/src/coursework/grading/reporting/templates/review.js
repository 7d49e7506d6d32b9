// Elements name their key in `data-key`. Without this script, everything can still be reached by Tab. Single keys are off
// at first, so that dictating, or hitting a key by accident, decides nothing.
const keys = document.getElementById("keys");
keys.checked = sessionStorage.getItem("keys") === "on";
keys.addEventListener("change", () => sessionStorage.setItem("keys", keys.checked ? "on" : "off"));

document.addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  if (!keys.checked && event.key !== "Escape") return;
  const field = event.target.closest("input:not([type=checkbox]), textarea, select");
  if (field) {
    // In a field, keys only enter text; Escape leaves it.
    if (event.key === "Escape") field.blur();
    else if (event.key === "Enter" && field.matches("form.decide input:not([name=given])")) event.preventDefault();
    return;
  }
  const found = [...document.querySelectorAll("[data-key]")].find((one) => one.dataset.key === event.key);
  if (!found) return;
  event.preventDefault();
  if (found.matches("input, textarea, select")) found.focus();
  else found.click();
});

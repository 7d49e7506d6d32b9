// Packages under the names that people use for them.
const NAMES = { numpy: "NumPy", matplotlib: "Matplotlib", scipy: "SciPy", pygments: "Pygments" };

export const named = (...modules) => modules.map((module) => NAMES[module] ?? module).join(" and ");

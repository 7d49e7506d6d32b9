// What somebody has pasted, if it is nothing but the numbers of an orientation.
const WRAPPING = /\b(?:np|numpy|sm|sympy|array|asarray|Matrix|matrix|Quaternion|quaternion|Rotation|R|q|dtype|float64)\b\.?|[=()[\]{},;|<>\s]/g;
const NUMBER = /[-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?\s*°?/gi;

export function pasted(text) {
  const numbers = text.match(NUMBER) ?? [];
  if (text.replace(NUMBER, "").replace(WRAPPING, "") !== "") return null;
  return { 9: "matrix", 4: "quaternion", 3: "triple" }[numbers.length] ?? null;
}

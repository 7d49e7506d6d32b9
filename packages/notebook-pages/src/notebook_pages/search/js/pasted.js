// The kind of a pasted text, if it consists of the numbers of an orientation and what programs write around them: the
// workbench reads such texts, too.
const WRAPPING = /\b(?:np|numpy|sm|sympy|array|asarray|dtype|float64|geometry_msgs|msg|Matrix|Quaternion|Rotation|R|q|q?[wxyz0-3]|[ijk]|roll|pitch|yaw|deg(?:rees)?|rad(?:ians)?)\b\.?|[-+−=:'"()[\]{},;|<>\s]/gi;
const NUMBER = /(?<![\w.])[-+−]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?\s*°?/gi;
const KINDS = { 3: "triple", 4: "quaternion", 9: "matrix", 12: "matrix", 16: "matrix" }; // some with a position

const kind = (text) => (text.replace(NUMBER, "").replace(WRAPPING, "") === "" ? KINDS[text.match(NUMBER)?.length] : undefined);

// A comma separates numbers, or else is a decimal comma.
export const pasted = (text) => kind(text) ?? kind(text.replace(/(\d),(?=\d)/g, "$1.")) ?? null;

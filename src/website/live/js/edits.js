// The reader's edits, kept in this browser: for each page a list of cells with their code, and a
// fingerprint of the book's code that was edited.

export function fingerprint(text) {
  let a = 0xdeadbeef, b = 0x41c6ce57; // cyrb53, a short hash that is good enough to tell texts apart
  for (let k = 0; k < text.length; k++) {
    const unit = text.charCodeAt(k);
    a = Math.imul(a ^ unit, 2654435761);
    b = Math.imul(b ^ unit, 1597334677);
  }
  a = Math.imul(a ^ (a >>> 16), 2246822507) ^ Math.imul(b ^ (b >>> 13), 3266489909);
  b = Math.imul(b ^ (b >>> 16), 2246822507) ^ Math.imul(a ^ (a >>> 13), 3266489909);
  return (4294967296 * (2097151 & b) + (a >>> 0)).toString(36);
}

export function load(key) {
  try {
    return JSON.parse(localStorage.getItem(key)) ?? [];
  } catch {
    return [];
  }
}

// Returns whether the browser has kept them.
export function save(key, edits) {
  try {
    if (edits.length) localStorage.setItem(key, JSON.stringify(edits));
    else localStorage.removeItem(key);
    return true;
  } catch {
    return false;
  }
}

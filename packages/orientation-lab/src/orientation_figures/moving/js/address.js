// The fragment of an address of the book, behind the #, is usually the name of a place on the page. It may continue
// with "=1." and plain data: the state of a figure, or the numbers of two programs. The number is the version of this
// format; addresses that somebody has kept must remain readable.

const ADDRESS_VERSION = 1, LONGEST_ADDRESS = 6000;
const NEWER_ADDRESS = 'This address was made by a newer edition of the book than this page. Reload the page.';
const CUT_ADDRESS = 'This address is incomplete, or its letters were changed from capitals to small ones. Copy it again, to its last character.';
const LONG_ADDRESS = 'This is too long for an address, which some programs would cut off. Send it as a file or in a message.';

function finite(name, value) {
  if (typeof value === 'number' && !Number.isFinite(value)) throw new Error(`${name} is ${value}, which cannot be stored in an address.`);
  return value;
}

// Return the fragment of an address, with its #, that carries plain data (an object, as in JSON) to a place on a page.
export function fragmentOf(place, content) {
  const bytes = new TextEncoder().encode(JSON.stringify(content, finite));
  const text = btoa(String.fromCharCode(...bytes.slice(0, LONGEST_ADDRESS + 1)));
  if (text.length > LONGEST_ADDRESS) throw new Error(LONG_ADDRESS);
  return `#${place}=${ADDRESS_VERSION}.${text.replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

// Return the content of a fragment, { place, content }, or null for the plain name of a place; throw an Error for the
// reader. Callers must accept only what a reader could have entered. A full stop that messages add is ignored.
export function carriedBy(fragment) {
  const [, place, version, text] = /^#?([a-z0-9-]+)=(\d+)\.([\w-]*)/.exec(fragment) ?? [];
  if (place === undefined) return null;
  if (Number(version) > ADDRESS_VERSION) throw new Error(NEWER_ADDRESS);
  let content = null;
  try {
    const bytes = Uint8Array.from(atob(text.replaceAll('-', '+').replaceAll('_', '/')), (letter) => letter.charCodeAt(0));
    content = JSON.parse(new TextDecoder('utf-8', { fatal: true }).decode(bytes));
  } catch { /* said below */ }
  if (text.length > LONGEST_ADDRESS || content === null || typeof content !== 'object' || Array.isArray(content)) throw new Error(CUT_ADDRESS);
  return { place, content };
}

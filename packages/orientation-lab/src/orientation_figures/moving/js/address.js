// What an address of the book carries behind its #: the name of a place on the page, as a rule, and after it, where
// there is more to say, "=1." and plain data: how a figure stands, or what two programs gave. The number is the version
// of this format; an address that somebody has kept is read for ever.

const ADDRESS_VERSION = 1, LONGEST_ADDRESS = 6000;
const NEWER_ADDRESS = 'This address was made by a newer edition of the book than this page. Reload the page.';
const CUT_ADDRESS = 'This address is incomplete. Copy it again, to its last character.';
const LONG_ADDRESS = 'This is too long for an address, which some programs would cut off. Send it as a file or in a message.';

function finite(name, value) {
  if (typeof value === 'number' && !Number.isFinite(value)) throw new Error(`${name} is ${value}, which cannot be stored in an address.`);
  return value;
}

// The fragment of an address, with its #, that carries plain data (an object, as JSON has it) to a place on a page.
export function fragmentOf(place, content) {
  const bytes = new TextEncoder().encode(JSON.stringify(content, finite));
  const text = btoa(String.fromCharCode(...bytes.slice(0, LONGEST_ADDRESS + 1)));
  if (text.length > LONGEST_ADDRESS) throw new Error(LONG_ADDRESS);
  return `#${place}=${ADDRESS_VERSION}.${text.replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

// What a fragment carries: { place, content }; null where it is a plain name of a place. It may come from anybody:
// whoever takes it up accepts what a reader could have entered and nothing else. Throws an Error for the reader.
export function carriedBy(fragment) {
  const [, place, version, text] = /^#?([a-z0-9-]+)=(\d+)\.(.*)$/s.exec(fragment) ?? [];
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

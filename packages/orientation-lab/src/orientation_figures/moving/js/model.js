// The part of anywidget's model that figures use, for pages without a kernel. `told` is called with what the reader has
// changed, as soon as it is saved.
export class Model {
  constructor(state, told = () => {}) {
    this.state = { ...state };
    this.told = told;
    this.heard = new Map();
    this.unsaved = {};
    this.moved = {};   // the reader's changes, by name
  }

  get(name) { return this.state[name]; }

  set(name, value) {
    if (this.put(name, value)) this.unsaved[name] = value;
  }

  // Change the state as if the reader had done it.
  move(state) {
    for (const [name, value] of Object.entries(state ?? {})) if (name in this.state) this.set(name, value);
    this.save_changes();
  }

  // Take values from Python, which need not be sent back.
  take(state) {
    for (const [name, value] of Object.entries(state)) {
      delete this.moved[name];
      this.put(name, value);
    }
  }

  put(name, value) {
    if (JSON.stringify(this.state[name]) === JSON.stringify(value)) return false;
    this.state[name] = value;
    for (const listener of this.heard.get(`change:${name}`) ?? []) listener();
    return true;
  }

  on(event, listener) { this.heard.set(event, [...this.heard.get(event) ?? [], listener]); }

  off(event, listener) { this.heard.set(event, (this.heard.get(event) ?? []).filter((registered) => registered !== listener)); }

  save_changes() {
    const changes = this.unsaved;
    this.unsaved = {};
    Object.assign(this.moved, changes);
    if (Object.keys(changes).length) this.told(changes);
  }
}

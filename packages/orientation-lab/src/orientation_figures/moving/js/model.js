// The part of anywidget's model that figures use, where no kernel's own is there. `told` is given what the reader
// has changed, as soon as it is saved.
export class Model {
  constructor(state, told = () => {}) {
    this.state = { ...state };
    this.told = told;
    this.heard = new Map();
    this.unsaved = {};
    this.moved = {};   // what the reader has moved, and where it stands
  }

  get(name) { return this.state[name]; }

  set(name, value) {
    if (this.put(name, value)) this.unsaved[name] = value;
  }

  // As if the reader had moved it there.
  move(state) {
    for (const [name, value] of Object.entries(state ?? {})) if (name in this.state) this.set(name, value);
    this.save_changes();
  }

  // What Python says: it need not be told again.
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

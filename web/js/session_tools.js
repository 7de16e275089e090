// The session's people, its history, and its snapshots and files.
const kLargestMessage = 65536;
const kSureMs = 4000;
const element = (id) => document.getElementById(id);

/** "Ann, guest 2 (you)": who is there. */
export function peopleText(present, more, you) {
  const names = present.map(({ id, name }) => (id === you?.id ? `${name} (you)` : name));
  if (more > 0) names.push(`${more} more`);
  return names.join(', ');
}

/** 'undo', 'redo' or null for a key with its modifiers; text fields keep theirs. */
export function shortcut({ key, ctrlKey, metaKey, altKey, shiftKey, target }) {
  const isText = target?.matches?.('input:not([type]), input[type="text"], textarea');
  if (!(ctrlKey || metaKey) || altKey || isText) return null;
  if (key.toLowerCase() === 'y') return 'redo';
  return key.toLowerCase() === 'z' ? (shiftKey ? 'redo' : 'undo') : null;
}

/** The import message of a file's text; null where it is too large for one. Throws an Error that says what is wrong. */
export function importOf(text) {
  let file;
  try {
    file = JSON.parse(text);
  } catch {
    throw new Error('This file is no JSON.');
  }
  if (typeof file?.state !== 'object' || file.state === null) throw new Error('This file has no state of a session.');
  const message = { type: 'import', state: file.state };
  if (new TextEncoder().encode(JSON.stringify(message)).length + 100 > kLargestMessage) {
    return null;
  }
  return message;
}

/** Calls onCommand(message without id), onError(text); download() resolves to {name, text}, upload(text) when a state is imported. */
export class SessionTools {
  #you = null;
  #present = [];
  #more = 0;
  #depth = { undo: 0, redo: 0 };
  #snapshots = [];
  #onCommand;
  #onError;
  #download;
  #upload;

  constructor({ onCommand, onError, download, upload }) {
    this.#onCommand = onCommand;
    this.#onError = onError;
    this.#download = download;
    this.#upload = upload;
    for (const type of ['undo', 'redo']) element(type).addEventListener('click', () => this.#travel(type));
    document.addEventListener('keydown', (event) => {
      const type = shortcut(event);
      if (!type) return;
      event.preventDefault();
      this.#travel(type);
    });
    element('snapshot-form').addEventListener('submit', (event) => {
      event.preventDefault();
      const name = element('snapshot-name').value.trim();
      if (!name) return;
      onCommand({ type: 'snapshot', action: 'make', name });
      element('snapshot-name').value = '';
    });
    element('export-state').addEventListener('click', () => this.#export());
    element('import-state').addEventListener('click', () => element('import-file').click());
    element('import-file').addEventListener('change', () => this.#import());
    element('delete-session').addEventListener('click', () => this.#deleteSession());
    element('snapshots').addEventListener('keydown', (event) => {
      if (event.key !== 'Escape') return;
      element('snapshots').open = false;
      element('snapshots').querySelector('summary').focus();
    });
  }

  get canEdit() {
    return this.#you !== null && this.#you.role !== 'viewer';
  }
  get #isOwner() {
    return this.#you?.role === 'owner';
  }

  welcome({ you, present, more, history, snapshots, by }) {
    this.#you = you;
    this.#snapshots = snapshots;
    document.body.dataset.role = you.role;
    element('watching').hidden = this.canEdit;
    for (const part of [element('curves'), ...document.querySelectorAll('#controls > .control:not(.actions)')]) {
      part.inert = !this.canEdit;
    }
    for (const id of ['reset-rotation', 'reset-view', 'reset-exposure', 'snapshot-name', 'snapshot-save']) {
      element(id).disabled = !this.canEdit;
    }
    for (const id of ['import-state', 'delete-session']) element(id).disabled = !this.#isOwner;
    element('owners-only').hidden = this.#isOwner;
    this.presence({ present, more });
    this.history(history);
    this.changed(by);
    this.#showSnapshots();
  }

  presence({ present, more }) {
    this.#present = present;
    this.#more = more;
    element('people').textContent = peopleText(present, more, this.#you);
  }

  history(depth) {
    this.#depth = depth;
    for (const type of ['undo', 'redo']) element(type).disabled = !this.canEdit || depth[type] === 0;
  }

  /** Who made the newest revision. */
  changed(by) {
    const name = by?.id === this.#you?.id ? 'you' : by?.name;
    element('last-change').textContent = by ? `Last change: ${name}` : '';
  }

  snapshots({ snapshots }) {
    this.#snapshots = snapshots;
    this.#showSnapshots();
  }

  #travel(type) {
    if (this.canEdit && this.#depth[type] > 0) this.#onCommand({ type });
  }

  #showSnapshots() {
    element('snapshot-list').replaceChildren(...this.#snapshots.map((one) => this.#row(one)));
    element('snapshot-none').hidden = this.#snapshots.length > 0;
  }

  #row({ name, by, at }) {
    const row = document.createElement('li');
    const label = document.createElement('span');
    label.textContent = name;
    label.title = `${by ? `${by.name}, ` : ''}${new Date(at).toLocaleString()}`;
    const restore = this.#button('Restore', `Restore ${name}`, () => this.#use('restore', name));
    const remove = this.#button('Delete', `Delete ${name}`, () => {
      if (remove.textContent === 'Delete') { // it cannot be undone: asked once more
        remove.textContent = 'Sure?';
        setTimeout(() => { remove.textContent = 'Delete'; }, kSureMs);
      } else {
        this.#use('delete', name);
      }
    });
    row.append(label, restore, remove);
    return row;
  }

  #button(text, label, act) {
    const button = document.createElement('button');
    button.type = 'button';
    button.textContent = text;
    button.setAttribute('aria-label', label);
    button.disabled = !this.#isOwner;
    button.addEventListener('click', act);
    return button;
  }

  /** Asked once more: it cannot be undone. */
  #deleteSession() {
    const button = element('delete-session');
    if (button.textContent !== 'Sure?') {
      button.textContent = 'Sure?';
      setTimeout(() => { button.textContent = 'Delete session'; }, kSureMs);
    } else {
      this.#onCommand({ type: 'delete_session' });
    }
  }

  #use(action, name) {
    this.#onCommand({ type: 'snapshot', action, name });
  }

  async #export() {
    try {
      const { name, text } = await this.#download();
      const link = document.createElement('a');
      link.href = URL.createObjectURL(new Blob([text], { type: 'application/json' }));
      link.download = name;
      link.click();
      URL.revokeObjectURL(link.href);
    } catch (failure) {
      this.#onError(`The state could not be exported: ${failure.message}`);
    }
  }

  async #import() {
    const [file] = element('import-file').files;
    element('import-file').value = '';
    if (!file) return;
    try {
      const text = await file.text();
      const message = importOf(text);
      if (message) this.#onCommand(message);
      else await this.#upload(text);
    } catch (failure) {
      this.#onError(failure.message);
    }
  }
}

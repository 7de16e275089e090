/** The server's bound. */
export const LARGEST_UPLOAD = 32 * 2 ** 20;

/** A name for URLs from a file's: without its ending, and of letters that names have. */
export function environmentName(file) {
  const stem = file.replace(/\.[^.]*$/, '');
  const name = stem.normalize('NFKD').replace(/[^A-Za-z0-9._-]+/g, '_').slice(0, 64);
  return /[A-Za-z0-9]/.test(name) ? name : 'environment';
}

/** Why a file is not sent; '' when it is. */
export function uploadFault({ name, size }) {
  if (!/\.(hdr|exr)$/i.test(name)) return `${name} is no .hdr or .exr picture.`;
  if (size > LARGEST_UPLOAD) return `${name} is larger than 32 MiB.`;
  return '';
}

/**
 * The button and the place to drop files that send an environment to the session, and the button that
 * deletes the one that is shown. Calls onReady(name) when the server has it, onError(text) when not,
 * and onLeave(name) to have another one shown first.
 */
export class EnvironmentUpload {
  #button = document.getElementById('environment-upload');
  #file = document.getElementById('environment-file');
  #area = document.getElementById('environments');
  #headers;
  #onReady;
  #onLeave;
  #onError;
  #place = null;
  #own = null; // the names of the scene's, which stay
  #shown = '';
  #leaving = ''; // it is deleted when another one is shown
  #delete = document.getElementById('environment-delete');

  constructor({ headers, onReady, onLeave, onError }) {
    this.#headers = headers;
    this.#onLeave = onLeave;
    this.#delete.addEventListener('click', () => this.#leave());
    this.#onReady = onReady;
    this.#onError = onError;
    this.#button.addEventListener('click', () => this.#file.click());
    this.#file.addEventListener('change', () => {
      const [file] = this.#file.files;
      this.#file.value = ''; // so that the same file can be chosen again
      if (file) this.#send(file);
    });
    this.#area.addEventListener('dragover', (event) => {
      event.preventDefault();
      this.#area.classList.add('dropping');
    });
    for (const end of ['dragleave', 'drop']) {
      this.#area.addEventListener(end, () => this.#area.classList.remove('dropping'));
    }
    this.#area.addEventListener('drop', (event) => {
      event.preventDefault();
      const [file] = event.dataTransfer.files;
      if (file) this.#send(file);
    });
  }

  setPlace(session, scene) {
    this.#place = { session, scene };
    this.#findOwn(scene);
  }

  /** The environment that the session shows now. */
  setShown(name, canEdit) {
    this.#shown = name;
    this.#delete.hidden = !canEdit || !isUploaded(name, this.#own);
    if (!this.#leaving || name === this.#leaving) return;
    const gone = this.#leaving;
    this.#leaving = '';
    this.#remove(gone);
  }

  async #findOwn(scene) {
    if (this.#own) return;
    try {
      const answer = await fetch('/api/scenes', { headers: this.#headers });
      const { scenes } = await answer.json();
      this.#own = scenes.find(({ name }) => name === scene)?.environments ?? null;
      this.#delete.hidden = !isUploaded(this.#shown, this.#own);
    } catch {
      this.#own = null; // nothing is offered to be deleted
    }
  }

  /** What is shown cannot be deleted: the scene's first takes its place. */
  #leave() {
    if (this.#delete.textContent !== 'Sure?') { // others lose it too: asked once more
      this.#delete.textContent = 'Sure?';
      setTimeout(() => { this.#delete.textContent = 'Delete'; }, 4000);
      return;
    }
    this.#leaving = this.#shown;
    this.#onLeave(this.#own[0]);
  }

  async #remove(name) {
    const { session, scene } = this.#place;
    try {
      const url = `/sessions/${session}/environments/${name}?scene=${scene}`;
      const answer = await fetch(url, { method: 'DELETE', headers: this.#headers });
      if (!answer.ok) this.#onError(`${name} was not deleted: ${reasonOf(await answer.text())}`);
    } catch (failure) {
      this.#onError(`${name} could not be deleted: ${failure.message}`);
    }
  }

  async #send(file) {
    const fault = uploadFault(file);
    if (fault || !this.#place) {
      this.#onError(fault || 'Not connected yet.');
      return;
    }
    const name = environmentName(file.name);
    const { session, scene } = this.#place;
    this.#button.disabled = true;
    try {
      const url = `/sessions/${session}/environments/${name}?scene=${scene}`;
      const answer = await fetch(url, { method: 'POST', headers: this.#headers, body: file });
      const text = await answer.text();
      if (answer.ok) {
        this.#onReady(name);
      } else {
        this.#onError(`${file.name} was not taken: ${reasonOf(text)}`);
      }
    } catch (failure) {
      this.#onError(`${file.name} could not be sent: ${failure.message}`);
    } finally {
      this.#button.disabled = false;
    }
  }
}

/** Whether an environment is none of the scene's own, where those are known. */
export function isUploaded(name, own) {
  return own !== null && name !== '' && !own.includes(name);
}

/** What an answer says went wrong. */
export function reasonOf(text) {
  try {
    return JSON.parse(text).reason;
  } catch {
    return text.trim();
  }
}

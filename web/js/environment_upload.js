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
 * The button and the place to drop files that send an environment to the session. Calls
 * onReady(name) when the server has it, onError(text) when not.
 */
export class EnvironmentUpload {
  #button = document.getElementById('environment-upload');
  #file = document.getElementById('environment-file');
  #area = document.getElementById('environments');
  #headers;
  #onReady;
  #onError;
  #place = null;

  constructor({ headers, onReady, onError }) {
    this.#headers = headers;
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

function reasonOf(text) {
  try {
    return JSON.parse(text).reason;
  } catch {
    return text.trim();
  }
}

const kShownMs = 6000;
const kMost = 4;

/** Says what went wrong, for a while; the same thing once. */
export class Toasts {
  #list;

  constructor(list) {
    this.#list = list;
  }

  say(text) {
    const same = [...this.#list.children].some((toast) => toast.textContent === text);
    if (same) return;
    const toast = document.createElement('p');
    toast.className = 'toast';
    toast.textContent = text;
    this.#list.append(toast);
    while (this.#list.children.length > kMost) this.#list.firstChild.remove();
    setTimeout(() => toast.remove(), kShownMs);
  }
}

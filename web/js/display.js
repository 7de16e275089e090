import { canDecodeVp8 } from './frame_decoder.js';

/** Tells the server what this page can show, whenever that changes: the `display` message. */
export class Display {
  #send;
  #vp8;

  /** `send` takes a message; VP8 is left out where the page's address says codec=jpeg. */
  constructor(send, location = window.location) {
    this.#send = send;
    const isAsked = new URLSearchParams(location.search).get('codec') !== 'jpeg';
    this.#vp8 = isAsked ? canDecodeVp8() : Promise.resolve(false);
    document.addEventListener('visibilitychange', () => this.tell());
  }

  async tell() {
    const codecs = (await this.#vp8) ? ['vp8', 'jpeg', 'png'] : ['jpeg', 'png'];
    this.#send({ type: 'display', codecs, parts: true, hidden: document.hidden });
  }

  /** A stream could not be decoded: from now on JPEG. */
  giveUpVp8() {
    this.#vp8 = Promise.resolve(false);
    return this.tell();
  }
}

// The server's curves: what BRDFs are as they were baked or measured, fetched once each.

/** headers: of each request; onArrival() when one came that was asked for; onError(text) when it could not. */
export class CurveLibrary {
  #scene = '';
  #known = new Map(); // URL → curves; null while they are on their way
  #headers;
  #onArrival;
  #onError;

  constructor({ headers = {}, onArrival, onError }) {
    this.#headers = headers;
    this.#onArrival = onArrival;
    this.#onError = onError;
  }

  setScene(scene) {
    if (scene === this.#scene) return;
    this.#scene = scene;
    this.#known.clear();
  }

  /** {half_angle, difference_angle, rest, fit_error}, or null: not here yet. */
  get(material, measured = null) {
    const query = new URLSearchParams({ scene: this.#scene, material });
    if (measured !== null) query.set('measured', measured);
    const url = `/api/curves?${query}`;
    if (!this.#known.has(url)) {
      this.#known.set(url, null);
      this.#fetch(url);
    }
    return this.#known.get(url);
  }

  async #fetch(url) {
    try {
      const response = await fetch(url, { headers: this.#headers });
      const body = await response.json();
      if (!response.ok) throw new Error(body.reason);
      this.#known.set(url, body);
      this.#onArrival();
    } catch (failure) {
      this.#known.delete(url);
      this.#onError(`Curves could not be fetched: ${failure.message}`);
    }
  }
}

const kWindowMs = 1000;
const kLatencies = 31;

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[sorted.length >> 1];
}

/** The small overlay: frame rate in motion, edit-to-pixel latency, and what a frame says of itself. */
export class Measurements {
  #fields;
  #quality;
  #times = [];
  #latencies = [];

  constructor(document) {
    const field = (name) => document.getElementById(`stat-${name}`);
    this.#fields = Object.fromEntries(
      ['fps', 'latency', 'terms', 'exact', 'error', 'server', 'frame'].map((name) => [name, field(name)]));
    this.#quality = document.getElementById('quality');
  }

  /** `bytes`: of the message; of a frame in parts, the image's. */
  show(header, messageBytes, latencyMs, now) {
    const bytes = header.part?.size ?? messageBytes;
    if (!header.exact) this.#times.push(now);
    while (this.#times.length > 0 && this.#times[0] < now - kWindowMs) this.#times.shift();
    if (latencyMs !== null && !header.exact) {
      this.#latencies.push(latencyMs);
      if (this.#latencies.length > kLatencies) this.#latencies.shift();
    }
    const times = header.times;
    const work = times.rotate_ms + times.update_ms + times.display_ms + times.encode_ms;
    this.#fields.fps.textContent = header.exact ? 'still' : `${this.#times.length} a second`;
    if (this.#latencies.length > 0) {
      this.#fields.latency.textContent = `${median(this.#latencies).toFixed(0)} ms`;
    }
    this.#fields.terms.textContent = header.terms.toLocaleString('en');
    this.#fields.exact.textContent = header.exact ? 'exact' : 'approximate';
    this.#fields.error.textContent =
      header.estimate === null ? '–' : `${(header.estimate * 100).toFixed(2)} %`;
    this.#fields.server.textContent = `${work.toFixed(1)} ms`;
    const size = bytes < 10240 ? (bytes / 1024).toFixed(1) : (bytes / 1024).toFixed(0);
    this.#fields.frame.textContent =
      `${header.codec.toUpperCase()}, ${header.width} × ${header.height}, ${size} KB`;
    this.#quality.dataset.exact = String(header.exact);
    const unshown = header.unshown.length > 0 ? ` · not shown: ${header.unshown.join(', ')}` : '';
    this.#quality.textContent = (header.exact ? 'Exact' : 'In motion') + unshown;
  }
}

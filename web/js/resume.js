// What makes this tab the same user of a session again, after a lost link or when it is loaded anew.

/** Kept by this tab alone, for one session of one scene. */
export class Resume {
  #storage;
  #key;

  constructor(storage, session, scene) {
    this.#storage = storage;
    this.#key = `rimlight-resume ${session} ${scene}`;
  }

  /** {resume, seen} for the query of the stream's URL; empty the first time. */
  get query() {
    try {
      const { resume, seen } = JSON.parse(this.#storage.getItem(this.#key));
      return /^[0-9a-f]{64}$/.test(resume) && Number.isSafeInteger(seen) ? { resume, seen } : {};
    } catch {
      return {};
    }
  }

  keep(resume, seen) {
    this.#storage.setItem(this.#key, JSON.stringify({ resume, seen }));
  }
}

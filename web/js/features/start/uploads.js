// Uploads of plans: chosen, named, sent, unpacked, scanned, listed; or the reason why not. The name of the chosen file or folder stays
// in this page: it is often a patient's name, and everybody sees the names of plans.
import { signal } from '../../../lib/signals-core.js';
import { say } from './later_words.js';

const jobMs = 200;

const megabytes = (n) => `${Math.ceil(n / 1e6)} MB`;

export class UploadsState {
  #api;
  #clock;
  #send;
  #next = 1;
  #isStopped = false;
  #aborts = new Map();
  #tasks = new Map();

  /** @param {object} world {api, clock, send: (task: object) => Promise<object>, arrived: (plan: string) => void, limit: () => number} limit in bytes; Infinity while unknown */
  constructor({ api, clock, send, arrived, limit = () => Infinity, popover = signal('') }) {
    this.#api = api;
    this.#clock = clock;
    this.#send = send;
    this.limit = limit;
    this.arrived = arrived;
    this.rows = signal([]); // {key, name, bytes, sent, job, error, state: asking (for a name) | sending | working | failed}; name stays in this page
    this.popover = popover; // 'upload': the card to choose files in is open
    this.isOver = signal(false); // something is being dragged over the page
    this.error = signal(''); // an error in choosing, before anything was sent
  }

  stop() {
    this.#isStopped = true;
    for (const abort of this.#aborts.values()) abort.abort();
  }

  /** Adds an upload that waits for the name everybody will see; send() starts it. @param {{name: string, body: Blob, type: string}} task @returns {number} its key */
  offer({ name, body, type }) {
    const key = this.#next++;
    this.#tasks.set(key, { body, type });
    this.rows.value = [...this.rows.value, { key, name, bytes: body.size, sent: 0, job: null, error: '', state: 'asking' }];
    return key;
  }

  /** @param {string} publicName '' lets the server choose */
  async send(key, publicName) {
    const task = this.#tasks.get(key);
    if (!task) return;
    this.#tasks.delete(key);
    const { body, type } = task;
    const abort = new AbortController();
    this.#aborts.set(key, abort);
    this.#change(key, { state: 'sending' });
    try {
      if (body.size > this.limit()) throw new Error(say.tooLarge({ size: megabytes(body.size), limit: megabytes(this.limit()) }));
      let job = await this.#send({
        publicName: publicName.trim(),
        body,
        type,
        signal: abort.signal,
        onSent: (sent) => this.#change(key, { sent }),
      });
      while (!this.#isStopped) {
        this.#change(key, { job, sent: body.size, state: 'working' });
        if (job.state === 'done') {
          this.dismiss(key);
          this.arrived(job.plan);
          return;
        }
        if (job.state === 'cancelled') {
          this.dismiss(key);
          return;
        }
        if (job.state === 'failed') throw new Error(job.problem?.detail ?? say.planRefused);
        await new Promise((resolve) => {
          this.#clock.setTimeout(resolve, jobMs);
        });
        job = await this.#api.job(job.id);
      }
    } catch (error) {
      if (abort.signal.aborted) this.dismiss(key);
      else this.#change(key, { error: error.message, state: 'failed' });
    }
  }

  /** Cancels an upload in any state. */
  async cancel(key) {
    const row = this.rows.value.find((other) => other.key === key);
    if (!row) return;
    if (row.state === 'asking') this.dismiss(key);
    else if (row.job) await this.#api.cancelJob(row.job.id).catch((error) => this.#change(key, { error: error.message, state: 'failed' }));
    else this.#aborts.get(key)?.abort();
  }

  dismiss(key) {
    this.#aborts.delete(key);
    this.#tasks.delete(key);
    this.rows.value = this.rows.value.filter((row) => row.key !== key);
  }

  #change(key, part) {
    this.rows.value = this.rows.value.map((row) => (row.key === key ? { ...row, ...part } : row));
  }
}

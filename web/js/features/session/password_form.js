// A password: asked for, sent, and what the server says of it: wrong, with the tries left; a pause, counted down.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const minute = 60;

/** "1 minute", "45 seconds" */
export const pauseWords = (seconds) =>
  seconds >= minute && seconds % minute === 0 ? say.minutes({ n: seconds / minute }) : say.seconds({ n: seconds });

/** "0:45", in seconds under a minute */
export const leftWords = (seconds) =>
  seconds > minute ? `${Math.floor(seconds / minute)}:${String(seconds % minute).padStart(2, '0')}` : say.seconds({ n: seconds });

/** Sends JSON to the API. @returns {Promise<{status: number, answer: object}>} status 0: no answer */
export async function send(method, path, body) {
  try {
    const response = await fetch(`/api/v1/${path}`, {
      method,
      headers: body === undefined ? {} : { 'Content-Type': 'application/json' },
      body: body === undefined ? undefined : JSON.stringify(body),
    });
    const answer = (await response.json().catch(() => null)) ?? {};
    const waitS = Number(response.headers.get('Retry-After')) || Math.ceil((answer.retry_after_ms ?? 0) / 1000);
    return { status: response.status, answer, waitS };
  } catch {
    return { status: 0, answer: {}, waitS: 0 };
  }
}

export class PasswordState {
  #timer = 0;

  constructor() {
    this.isBusy = signal(false);
    this.error = signal(''); // a sentence
    this.leftS = signal(0); // of a pause
    this.hasCapsLock = signal(false);
  }

  stop() {
    clearInterval(this.#timer);
  }

  /** @returns {Promise<object|null>} the answer; null: refused, and error says why */
  async send(method, path, body) {
    this.isBusy.value = true;
    this.error.value = '';
    const { status, answer, waitS } = await send(method, path, body);
    this.isBusy.value = false;
    if (status >= 200 && status < 300) return answer;
    this.#refused(status, answer, waitS);
    return null;
  }

  #refused(status, answer, waitS) {
    const values = { ...answer.detail_values, ...answer };
    const { tries_left: n, pause_s: pauseS } = values;
    if (status === 0) this.error.value = say.noAnswer;
    else if (status === 401 && n > 0) this.error.value = say.wrong({ n, pause: pauseWords(pauseS) });
    else if (status === 401 && n === 0) this.#pause(waitS || pauseS, say.wrongPause);
    else if (status === 429) this.#pause(waitS || 1, answer.code === 'pause' ? '' : say.busy);
    else this.error.value = answer.detail || answer.title || say.noAnswer;
  }

  #pause(seconds, words) {
    this.error.value = words;
    const end = Date.now() + seconds * 1000;
    const count = () => {
      this.leftS.value = Math.max(0, Math.ceil((end - Date.now()) / 1000));
      if (this.leftS.peek()) return;
      clearInterval(this.#timer);
      this.error.value = '';
    };
    clearInterval(this.#timer);
    this.#timer = setInterval(count, 250);
    count();
  }
}

/** @param {PasswordState} state @param {{id: string, label: unknown, placeholder?: string, autocomplete?: string, name?: string}} field */
export function passwordField(state, { id, label, placeholder = '', autocomplete = 'current-password', name = 'password', least = 1 }) {
  const look = (event) => {
    state.hasCapsLock.value = event.getModifierState?.('CapsLock') ?? false;
  };
  return html`${label ? html`<label for=${id}>${label}</label>` : nothing}
    <input id=${id} name=${name} type="password" required minlength=${least} maxlength="256" autocomplete=${autocomplete} placeholder=${placeholder}
      aria-describedby=${`${id}-caps ${id}-error`} @keydown=${look} @keyup=${look} @blur=${() => {
        state.hasCapsLock.value = false;
      }}>
    <p id=${`${id}-caps`} class="sign-in-caps" role="status">${state.hasCapsLock.value ? html`${icon('warning', 12)} ${say.capsLock}` : nothing}</p>`;
}

/** Why the server refused; read aloud when it comes, the seconds that are counted down are not. */
export function passwordError(state, id) {
  const [words, left] = [state.error.value, state.leftS.value];
  return html`<div id=${`${id}-error`} class="sign-in-error">
    <p role="alert">${words ? html`${icon('error')} <span>${words}</span>` : nothing}</p>
    ${left ? html`<p>${words ? nothing : icon('error')} <span>${words ? say.tryIn({ time: leftWords(left) }) : say.paused({ time: leftWords(left) })}</span></p>` : nothing}</div>`;
}

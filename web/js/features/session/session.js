// The sign-in of this browser: the person, its end, and what happens then. Loaded where people sign in.
import { computed, effect, signal } from '../../../lib/signals-core.js';
import { ofMember } from '../../net/api.js';
import { styled } from '../../parts/lazy.js';
import { mount } from '../../parts/mount.js';
import { againCard } from './again_card.js';
import { PasswordState, send } from './password_form.js';
import { openStrip } from './open_strip.js';
import { peoplePanel } from './people_panel.js';
import { PeopleState } from './people_state.js';
import { invites, menu } from './session_menu.js';
import { forgetSigning, signing } from './signing.js';

const lookMs = 5000;
const askMs = 60000; // the proxy's own end is met by asking
const inputMs = 60000; // input is told at most this often
const soonMs = 5 * 60000; // before the end the page says so
const inputs = ['pointerdown', 'keydown', 'wheel', 'touchstart'];

export class Session {
  #world;
  #askedAt = Date.now();
  #toldAt = 0; // time of the newest input that the server knows of
  #skewMs = 0; // the server's clock less this one

  /** @param {object} facts answer of GET /session @param {object} world {api, ownName, entered: () => {room, connection, member, secret}|null, signIn: goes to the sign-in page} */
  constructor(facts, world) {
    this.#world = world;
    this.facts = signal(facts);
    this.person = signal(facts.sign_in.length ? facts.identity : null); // kept after the end
    this.now = signal(Date.now());
    this.endedAt = signal(0); // 0: goes on
    this.isStaying = signal(false); // the card is open before the end
    this.isMenuOpen = signal(false);
    this.error = signal('');
    this.waiting = signal(null); // a window in which somebody signs in: stops waiting for it
    this.state = new PasswordState();
    this.people = signal(null); // of the room that is open
    void styled('js/features/session/session.css').catch(() => {});
    if (facts.open_to_everybody) openStrip();
    if (!this.person.peek()) return;
    world.ownName.isFixed.value = true;
    for (const event of inputs) addEventListener(event, () => this.#acted(), { passive: true, capture: true });
    addEventListener('pointerdown', ({ target }) => {
      if (!target.closest?.('.session-menu')) this.isMenuOpen.value = false;
    });
    setInterval(() => this.#look(), lookMs);
  }

  /** Wall clock of this machine; 0: it does not end. */
  get endsAt() {
    const { idle_ends_ms: idle, ends_ms: end } = this.facts.value;
    const first = Math.min(idle || Infinity, end || Infinity);
    return Number.isFinite(first) ? first - this.#skewMs : 0;
  }

  /** True in the minutes before the end. */
  get isEnding() {
    return !this.endedAt.value && this.endsAt > 0 && this.endsAt - this.now.value <= soonMs;
  }

  /** True where people sign in. */
  get isOn() {
    return this.facts.value.sign_in.length > 0;
  }

  /** Calls of a guest, who is nobody to the server but in this room. */
  ofGuest(init = {}) {
    const isGuest = !this.person.peek() && this.facts.peek().sign_in.length > 0;
    const room = isGuest ? this.#world.entered() : null;
    return room?.member ? { ...init, headers: { ...ofMember(room), ...init.headers } } : init;
  }

  /** The server answered that nobody is signed in. */
  refused() {
    if (this.person.peek()) void this.ask();
    else if (!this.#world.entered()) this.#world.signIn();
  }

  async ask() {
    this.#askedAt = Date.now();
    const { status, answer } = await send('GET', 'session');
    if (status === 200) this.#told(answer);
    else if (status === 401) this.#end(); // the proxy's own sign-in is over
  }

  #told(facts) {
    const isSame = facts.identity && facts.identity.user === this.person.peek().user;
    if (!isSame) return void this.#end();
    this.facts.value = facts;
    this.person.value = facts.identity;
  }

  #end() {
    const room = this.#world.entered();
    if (!room) return void this.#world.signIn();
    if (!this.endedAt.peek()) this.endedAt.value = Date.now();
    room.connection.pause();
  }

  #look() {
    const now = Date.now();
    this.now.value = now;
    if (this.endedAt.peek()) return;
    if (now - this.#askedAt >= askMs || (this.endsAt && now >= this.endsAt)) void this.ask();
  }

  async #acted() {
    const now = Date.now();
    if (this.endedAt.peek() || now - this.#toldAt < inputMs) return;
    this.#toldAt = now;
    await this.stay();
  }

  /** Tells the server that there was input. */
  async stay() {
    await send('POST', 'session/input', {});
    await this.ask();
  }

  /** The person of the card has signed in again: the room goes on from here. */
  goOn(facts) {
    const [{ user, name }, other] = [this.person.peek(), facts.identity];
    if (other?.user !== user) return { other: other?.name || other?.user || '', name: name || user };
    this.endedAt.value = 0;
    this.isStaying.value = false;
    this.waiting.peek()?.();
    this.waiting.value = null;
    this.#told(facts);
    this.#world.entered()?.connection.renew(); // also one that is open: the server ends it with the sign-in that it was opened by
    return null;
  }

  async signOut() {
    const { status, answer } = await send('DELETE', 'session');
    if (status !== 204 && status !== 401) {
      this.error.value = answer.detail || answer.title || String(status);
      return;
    }
    forget();
    location.replace('/signin');
  }

  /** Leaves seat and what waits for somebody else, who signs in then. */
  async leave() {
    const path = location.pathname;
    await send('DELETE', 'session');
    forget();
    location.replace(`/signin?return=${encodeURIComponent(path)}`);
  }

  // ---- what is drawn ------------------------------------------------------------------------------------------------

  /** In the banner; null: nobody. */
  who() {
    return this.person.value ? menu(this) : null;
  }

  /** In the banner of a room, in the place of the form that invites where nobody signs in; null: that one. */
  invites() {
    return this.isOn && this.people.value ? invites(this.people.value) : null;
  }

  /** The form by which a person signs in the record of a review. */
  signing(form) {
    return signing(this, form);
  }

  /** Stands over the room at the end of the sign-in; everything else is then without effect. @returns {() => void} stops */
  inRoom(world) {
    const host = document.createElement('div');
    document.body.append(host);
    const people = new PeopleState(world);
    if (this.isOn) void styled('js/features/session/people.css').catch(() => {});
    this.people.value = people;
    const unmount = mount(host, () => [peoplePanel(people, world, this.facts.value.guest_links), againCard(this, world)]);
    const onKey = ({ key }) => key === 'Escape' && people.close(); // also when what had the focus is gone
    addEventListener('keydown', onKey);
    const paused = computed(() => world.room.link.value.state === 'paused');
    const covered = computed(() => paused.value || this.isStaying.value);
    const stop = effect(() => {
      const isPaused = paused.value;
      if (isPaused && !this.endedAt.peek()) this.endedAt.value = Date.now();
      const page = document.querySelector('#page');
      page.inert = isPaused;
      page.classList.toggle('paused', isPaused);
      if (isPaused) people.close();
    });
    let opener = null; // what had the focus before the card
    const stopFocus = effect(() => {
      const isCovered = covered.value;
      if (isCovered) opener = document.activeElement;
      queueMicrotask(() => {
        if (isCovered) return void host.querySelector('.again :is(button, input:not([readonly]))')?.focus();
        if (opener?.isConnected && document.activeElement === document.body) opener.focus();
        opener = null;
      });
    });
    return () => {
      stopFocus();
      stop();
      this.waiting.peek()?.();
      this.waiting.value = null;
      this.isStaying.value = false;
      forgetSigning();
      removeEventListener('keydown', onKey);
      const page = document.querySelector('#page');
      page.inert = false;
      page.classList.remove('paused');
      unmount();
      host.remove();
      this.people.value = null;
    };
  }
}

/** Clears what this page keeps in the browser: it uses no other storage. The server clears all of it (Clear-Site-Data). */
function forget() {
  for (const store of [() => localStorage, () => sessionStorage])
    try {
      store().clear();
    } catch {
      // it keeps nothing
    }
}

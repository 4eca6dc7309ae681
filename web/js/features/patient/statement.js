// Statements of people of whom the plan is of: that the patients of its files are one person, or who the patient is that they do not name. A name that is
// typed is sent, and kept nowhere in the page.
import { html, nothing } from '../../../lib/lit-html.js';
import { signal } from '../../../lib/signals-core.js';
import { ofMember } from '../../net/api.js';
import { icon } from '../../parts/icons.js';
import { day } from '../../parts/when.js';
import { statedBy } from '../../room/stated.js';
import { say } from './later_words.js';

const retryMs = 500;
const mostTries = 60;
const leastWords = 10; // letters, as the server asks for
const form = signal({ room: null, kind: '', error: '', isSent: false });
let turns = 0; // of sending: the newest counts
const closed = { room: null, kind: '', error: '', isSent: false };

const set = (more) => {
  form.value = { ...form.peek(), ...more };
};

/** Closes the form: nothing that is still under way is sent again, and its answer says nothing here. */
function close() {
  turns++;
  form.value = closed;
}

/** @param {object|null} body null: withdraws it */
async function send(world, body, tries = mostTries, turn = ++turns) {
  const { room, api, clock } = world;
  set({ room, ...(!body && { kind: '' }), error: '', isSent: true });
  try {
    const path = `plans/${encodeURIComponent(room.planId.peek())}/statement?room=${room.id}`;
    await api.call(body ? 'POST' : 'DELETE', path, { ...(body && { body }), more: ofMember(room.identity) });
    if (turn === turns) form.value = closed;
  } catch (problem) {
    if (turn !== turns) return;
    if (room.isLeft.peek()) return void close();
    const again = () => turn === turns && (room.isLeft.peek() ? close() : void send(world, body, tries - 1, turn));
    if (problem.status === 503 && tries > 0) return void clock.setTimeout(again, retryMs); // the files are being looked at
    set({ error: problem.message, isSent: false });
  }
}

/** Where people sign in, a planner who may read the identity. */
const mayState = ({ room, session }) =>
  room.seesIdentity.value && (!session?.value?.facts.value.sign_in.length || room.control.me.value?.role === 'planner');

const isUnderWay = ({ room }) => form.value.room === room && form.value.isSent;

const withdraw = (world) =>
  mayState(world)
    ? html`<button ?disabled=${isUnderWay(world)} @click=${() => void send(world, null)}>${say.withdrawStatement}</button>`
    : nothing;

const failed = ({ room }, kind) =>
  form.value.error && form.value.kind === kind && (!form.value.room || form.value.room === room)
    ? html`<p class="note err" role="alert">${form.value.error}</p>`
    : nothing;

const voidWords = { contradicted: say.isContradicted, unread: say.isUnread };

/** Above the panes, while files of several patients are used as of one, and when a statement does not count any more. */
export function statementBar(world) {
  const { statement, patients } = world.room.plan.value ?? {};
  if (!statement || (statement.state === 'used' && statement.kind === 'identity')) return nothing;
  const facts = { by: statement.by, date: day(statement.time_ms), words: statement.words, n: patients.length };
  const isUsed = statement.state === 'used';
  const words = isUsed ? say.countAsOne(facts) : (voidWords[statement.state] ?? say.isOutdated)(facts);
  return html`<div class=${isUsed ? 'fit-bar' : 'fit-bar err'} role=${isUsed ? 'status' : 'alert'}>
    <span class=${isUsed ? 'warn' : 'err'}>${icon(isUsed ? 'warning' : 'error')}</span><p>${words}</p>${withdraw(world)}${failed(world, '')}</div>`;
}

const field = (name, label, more = {}) =>
  html`<label class="fit-label" for=${`stated-${name}`}>${label}</label><input id=${`stated-${name}`} name=${name} type=${more.type ?? 'text'}
    ?required=${!more.isOptional} maxlength=${more.most ?? 24} autocomplete="off">`;

function open({ room }, kind) {
  close();
  form.value = { room, kind, error: '', isSent: false };
}

const isOpen = ({ room }, kind) => form.value.room === room && form.value.kind === kind;

const buttons = (word) =>
  html`<div class="buttons"><button class="primary" type="submit" ?disabled=${form.value.isSent}>${word}</button>
    <button type="button" @click=${close}>${say.cancelStatement}</button></div>`;

/** Beside the compared identities: the way to say that they are one person, with a reason. */
export function onePersonForm(world) {
  if (!mayState(world)) return nothing;
  if (!isOpen(world, 'one-person'))
    return html`<button ?disabled=${isUnderWay(world)} @click=${() => open(world, 'one-person')}>${say.onePerson}</button>`;
  const submit = (event) => {
    event.preventDefault();
    void send(world, { kind: 'one-person', words: event.target.elements.words.value.trim() });
  };
  return html`<form class="fit-block statement" @submit=${submit}><label class="fit-label" for="stated-words">${say.whyOne({ n: leastWords })}</label>
    <textarea id="stated-words" name="words" rows="2" required minlength=${leastWords} maxlength="300"></textarea>
    <p class="note">${say.onePersonIs}</p>${failed(world, 'one-person')}${buttons(say.onePersonYes)}</form>`;
}

/** In the Plan tab, where the files name nobody: the patient, as a planner states it. */
export function identityForm(world) {
  if (!mayState(world)) return nothing;
  if (!isOpen(world, 'identity'))
    return html`<button ?disabled=${isUnderWay(world)} @click=${() => open(world, 'identity')}>${say.stateIdentity}</button>`;
  const submit = (event) => {
    event.preventDefault();
    const of = (name) => event.target.elements[name].value.trim();
    const birth = of('birth');
    void send(world, { kind: 'identity', name: `${of('family')}^${of('given')}`, id: of('id'), ...(birth && { birth_date: birth }) });
  };
  return html`<form class="fit-block statement" @submit=${submit}>${field('family', say.familyName)}${field('given', say.givenName, { most: 23 })}
    ${field('id', say.id, { most: 32 })}${field('birth', say.born, { type: 'date', isOptional: true })}
    <p class="note">${say.statedIs}</p>${failed(world, 'identity')}${buttons(say.stateIt)}</form>`;
}

export { statedBy };

/** In the Plan tab: who has stated whom the plan is of. */
export const statedRow = (world) => html`<div>${statedBy(world.room.plan.value)}</div>${withdraw(world)}${failed(world, '')}`;

// The page between two cases: a card with the next patient on plain ground, "not open to you", the question whether to go along.
import { html, nothing } from '../../../lib/lit-html.js';
import { icon } from '../../parts/icons.js';
import { mount } from '../../parts/mount.js';
import { approvalOf } from '../../room/identity.js';
import { say } from './later_words.js';

const cardMs = 1500;

function cover() {
  const host = document.createElement('div');
  host.className = 'case-cover';
  document.body.append(host);
  return host;
}

/** For 1.5 s the next patient, masked, on plain ground: the page of the new room comes up below it. @param {object} to the message meeting.case */
export function showCard(to, clock) {
  const host = cover();
  const [word, kind, picture] = approvalOf(to);
  const stop = mount(
    host,
    () => html`<section class="case-card" role="status" data-case=${to.to}><p class="dim">${say.caseOf(to)}</p><h1>${to.patient || say.noIdentity}</h1>
    <p class="case-plan">${to.plan}</p><p class=${`pill ${kind}`}>${picture ? icon(picture, 12) : nothing}<span>${word}</span></p>
    ${to.by ? html`<p class="dim">${say.movedBy({ name: to.by })}</p>` : nothing}</section>`,
  );
  clock.setTimeout(() => {
    stop();
    host.remove();
  }, cardMs);
}

const closedCard = ({ n }) => html`<section class="case-card" role="status"><h1>${say.notOpen({ n })}</h1><p>${say.notOpenIs}</p>
  <p><a class="button" href="/">${say.toPlans}</a></p></section>`;

const question = (
  words,
  act,
  other,
) => html`<div class="case-line" role="alertdialog" aria-label=${words}><span>${icon('table', 12)} ${words}</span>
  <button class="primary" @click=${act.do}>${act.word}</button><button @click=${other.do}>${other.word}</button></div>`;

/** Draws what the meeting puts over the page of this room. @returns {() => void} stops */
export function overlay({ ui }, meeting) {
  const host = document.createElement('div');
  host.className = 'case-over';
  document.body.append(host);
  const stop = mount(host, () => {
    const closed = meeting.waits.value;
    document.querySelector('#page')?.toggleAttribute('inert', Boolean(closed));
    if (closed) return html`<div class="case-cover">${closedCard(closed)}</div>`;
    const asked = meeting.asked.value;
    const asks = meeting.asks.value;
    if (asks)
      return question(
        say.writing,
        { word: say.goWithout, do: asks.go },
        {
          word: say.stay,
          do: () => {
            meeting.asks.value = null;
          },
        },
      );
    if (!asked) return nothing;
    const s = Math.max(1, Math.ceil((asked.until - ui.now.value) / 1000));
    return question(say.wentOn(asked), { word: say.goAlongIn({ s }), do: meeting.along }, { word: say.stay, do: meeting.stay });
  });
  return () => {
    stop();
    document.querySelector('#page')?.removeAttribute('inert');
    host.remove();
  };
}

// The banner of a room: name of the plan, members, invitation, help.
import { html, nothing } from '../../lib/lit-html.js';
import { icon } from './icons.js';
import { initials } from './pane.js';
import { roomChip } from './room_chip.js';

export const brand = () => html`<a class="brand" href="#/" title="All plans">${icon('logo', 20)}<b>Beamroom</b></a>`;

async function copyLink(ui) {
  const field = document.querySelector('#invite-link');
  field.select();
  try {
    // a page not served securely has no clipboard; the link is selected and can be copied by hand
    await navigator.clipboard.writeText(location.href);
    ui.popover.value = '';
    ui.notify('ok', 'Link copied. Who has it can join this room.');
  } catch {
    ui.notify('warn', 'Press Ctrl+C to copy the selected link.');
  }
}

export function banner({ room, ui }) {
  const plan = room.plan.value;
  const you = room.member.value;
  const members = room.members.value.filter((member) => member.connected !== false);
  const own = members.find((member) => member.id === you);
  const others = members.filter((member) => member.id !== you);
  return html`${brand()}<i class="rule"></i>
    <div class="plan-name"><h1>${plan?.name ?? room.planId.value}${plan?.isPhantom ? html`<span class="tag phantom">PHANTOM</span>` : nothing}</h1>
      <span class="dim">Plan <code>${room.planId.value}</code></span></div>
    <span class="grow"></span>
    ${own ? html`<div class="you"><span class="avatar own">${initials(own.name)}</span><span class="you-words"><b>${own.name} (you)</b>
      <span class="dim">${others.length ? `${others.length} more in this room` : 'alone in this room'}</span></span></div>` : nothing}
    <div class="members" aria-label="Members">${others.slice(0, 6).map((member, index) => html`<span class=${`avatar tint-${index % 4}`} title=${member.name}>${initials(member.name)}</span>`)}
      ${others.length > 6 ? html`<span class="dim">+${others.length - 6}</span>` : nothing}</div>
    ${roomChip({ room, ui }, 'banner')}
    <span class="anchor"><button @click=${() => ui.toggle('invite')} aria-expanded=${ui.popover.value === 'invite'}>${icon('invite')}<span>Invite</span></button>
      ${ui.popover.value === 'invite' ? html`<div class="popover invite"><label for="invite-link">Link to this room <code>${room.id}</code></label>
        <div class="pair"><input id="invite-link" readonly .value=${location.href}><button class="primary" @click=${() => copyLink(ui)}>Copy</button></div></div>` : nothing}</span>
    <button class="icon-button" title="Keys and mouse (?)" aria-label="Help" aria-expanded=${ui.popover.value === 'help'} @click=${() => ui.toggle('help')}>${icon('help')}</button>`;
}

// The banner of a room: name of the plan, its warnings, members, invitation, help.
import { initials, listed } from '../parts/format.js';
import { html, nothing } from '../../lib/lit-html.js';
import { troubles } from '../room/plan.js';
import { partsOf } from '../features/index.js';
import { icon } from '../parts/icons.js';
import { later } from '../parts/lazy.js';
import { variables } from '../parts/mount.js';
import { roomChip } from './room_chip.js';
import { roving } from '../parts/roving.js';
import { stripEnd } from './tools.js';
import { say } from './words.js';

/** hasWord: in a room the place is the patient's. */
export const brand = (hasWord = true) =>
  html`<a class="brand" href="/" title=${say.allPlans} aria-label=${say.brand}>${icon('logo', 20)}${hasWord ? html`<b>Beamroom</b>` : nothing}</a>`;

const invite = later(() => import('./invite.js'), 'js/shell/invite.css');

async function copyLink(ui) {
  const field = document.querySelector('#invite-link');
  field.select();
  try {
    // a page not served securely has no clipboard; the link is selected and can be copied by hand
    await navigator.clipboard.writeText(location.href);
    ui.popover.value = '';
    ui.notify('ok', say.copied);
  } catch {
    ui.notify('warn', say.pressCopy);
  }
}

/** Counts the errors and warnings of loading, and opens the report. */
function warnings({ room, ui }) {
  const report = room.plan.value?.report;
  const words = report && troubles(report);
  if (!words) return nothing;
  const isError = report.lines.some(({ severity }) => severity === 'error');
  return html`<button class="chip" title=${say.openReport} aria-label=${say.troubles({ troubles: words })} @click=${() => ui.showTab('plan')}><span class=${`pill ${isError ? 'err' : 'warn'}`}>${icon(isError ? 'error' : 'warning')}<span>${words}</span></span></button>`;
}

/** The shown plan; below it its folder, by name where that is not what stands above. */
function planName(world) {
  const { room } = world;
  const plan = room.plan.value;
  const own = partsOf('bannerPlan', world).find(Boolean);
  const folder = plan?.name ?? room.planId.value;
  const below = own ? listed(folder, own.place) : say.planId({ id: html`<code>${room.planId.value}</code>` });
  return html`<div class=${own ? 'anchor plan-name labelled' : 'plan-name'}><h1 title=${folder}><span>${own?.name ?? folder}</span></h1>
    <span class="dim plan-id">${below}</span>${partsOf('bannerName', world)}${own?.menu ?? nothing}</div>`;
}

export function banner(world) {
  const { room, ui } = world;
  const you = room.member.value;
  const isTouch = ui.isTouch.value;
  const members = room.members.value.filter((member) => member.connected !== false);
  const own = members.find((member) => member.id === you);
  const others = members.filter((member) => member.id !== you);
  return html`${brand(false)}<i class="rule"></i>${partsOf('bannerStart', world)}
    ${planName(world)}
    ${partsOf('bannerFacts', world)}
    ${warnings(world)}
    <span class="grow"></span>
    ${
      own
        ? html`<div class="you" title=${say.you(own)}><span class="avatar own">${initials(own.name)}</span><span class="you-words"><b>${say.you(own)}</b>
      <span class="dim">${others.length ? say.others({ n: others.length }) : say.alone}</span></span></div>`
        : nothing
    }
    <div class="members" role="group" aria-label=${say.members}>${others.slice(0, 6).map((member) => html`<span class="avatar member" ${variables({ '--member': member.color ?? '#929ba6' })} title=${member.name}>${initials(member.name)}</span>`)}
      ${others.length > 6 ? html`<span class="dim">+${others.length - 6}</span>` : nothing}</div>
    ${roomChip(world, 'banner')}
    ${isTouch ? html`<div class="strip-end" role="toolbar" aria-label=${say.thisPicture} @keydown=${roving}>${stripEnd(world)}</div>` : nothing}
    ${
      world.session.value?.invites() ??
      html`<span class="anchor"><button class="invite-button" @click=${() => ui.toggle('invite')} aria-label=${say.invite} aria-expanded=${ui.popover.value === 'invite'}>${icon('invite')}<span>${say.invite}</span></button>
      ${
        ui.popover.value === 'invite'
          ? html`<div class="popover invite"><label for="invite-link">${say.linkTo({ room: html`<code>${room.id}</code>` })}</label>
        <div class="pair"><input id="invite-link" readonly .value=${location.href}><button class="primary" @click=${() => copyLink(ui)}>${say.copy}</button></div>${room.control.may('control') ? invite.draw((loaded) => loaded.inviteForm(world)) : nothing}</div>`
          : nothing
      }</span>`
    }
    ${world.session.value?.who() ?? nothing}<button class="icon-button" title=${ui.keys.tip(say.keysTip, 'help')} aria-label=${say.help} aria-expanded=${ui.popover.value === 'help'} @click=${() => ui.toggle('help')}>${icon('help')}</button>`;
}

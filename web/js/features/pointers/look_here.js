// "Look here": asking everybody to look at a point, the message about it, coming; the menu of pointers.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect, untracked } from '../../../lib/signals-core.js';
import { crosshair, crosshairPatch, shownImage } from '../../room/plan.js';
import { toPicture } from '../../parts/vec.js';
import { checkbox, keyMark } from '../../parts/fields.js';
import { icon } from '../../parts/icons.js';
import { say } from './later_words.js';

const topic = 'look';
const shownMs = 60000; // LOOK_KEPT_S of the server
const edgePart = 0.08; // of a picture; a point nearer to its edge is brought to the middle

/** Asks everybody to look where this person points, else at the crosshair. */
export function askToLook({ room, ui }) {
  const { pointers } = room;
  const scene = room.scene.peek();
  if (!scene) return;
  const own = pointers.isPointing.peek() ? pointers.own.peek() : null;
  if (!pointers.ask(own?.point ?? crosshair(scene))) ui.notify('warn', say.notAsked, topic);
}

/** The own view centres on the point; who follows stays with the presenter, whose view it is. */
export function come({ room, panes }, { number, point }) {
  const { pointers, following, plan, scene } = room;
  pointers.come(number);
  if ((following.isFollowing.value && !following.isPresenting.value) || !room.canChange.value) return;
  const at = performance.now();
  room.patchScene(crosshairPatch(plan.value, shownImage(plan.value, scene.value), point), { at });
  for (const [index, pane] of panes().entries()) {
    const { header, box } = pane.place;
    const view = room.view(index + 1);
    if (!view.isOpen.value || !header || view.kind === 'beam') continue; // that camera is locked
    const place = toPicture(header.clip_from_lps_mm, point);
    const isIn = place?.every((part) => part > edgePart && part < 1 - edgePart);
    if (place && !isIn) pane.actions.cameras.pan((0.5 - place[0]) * box.width, (0.5 - place[1]) * box.height, at);
  }
}

/** @returns {() => void} stops */
export function startLook(world) {
  const { room, ui } = world;
  const { pointers } = room;
  let told = 0;
  const close = () => {
    const toast = ui.toasts.peek().find((other) => other.topic === topic);
    if (toast) ui.dismiss(toast.id);
  };
  const stop = effect(() => {
    const look = pointers.look.value;
    const n = pointers.others.value.length;
    const isOwn = look?.by === room.member.value;
    untracked(() => {
      if (!look) {
        if (told) close();
        told = 0;
      } else if (isOwn) {
        told = look.number;
        ui.notify(
          'ok',
          say.youAsk({ n: look.came.length, all: Math.max(n, look.came.length) }),
          topic,
          { word: say.end, act: () => pointers.ask(null) },
          shownMs,
        );
      } else if (look.came.includes(room.member.peek())) {
        told = look.number;
        close();
      } else if (told !== look.number) {
        told = look.number;
        ui.notify('ok', say.asksYou({ name: pointers.nameOf(look.by) }), topic, { word: say.come, act: () => come(world, look) }, shownMs);
      }
    });
  });
  return () => {
    stop();
    close();
  };
}

/** The popover beside the button that points. */
export function pointMenu(world, isDock) {
  const { room, ui } = world;
  const { pointers } = room;
  const look = pointers.look.value;
  const act = (run) => (event) => {
    event.currentTarget.closest('.anchor').querySelector('button').focus(); // the item goes
    ui.popover.value = '';
    run();
  };
  const comeButton = () =>
    html`<button @click=${act(() => come(world, look))}>${icon('crosshair')}<span>${say.comeTo({ name: pointers.nameOf(look.by) })}</span></button>`;
  return html`<div class=${isDock ? 'popover point-menu up' : 'popover point-menu'} role="dialog" aria-label=${say.pointers}>
    <div class="menu">
      ${
        pointers.mayPoint.value
          ? html`<button title=${say.askIs} @click=${act(() => askToLook(world))}>
        ${icon('target')}<span>${say.ask}</span>${isDock ? nothing : keyMark(ui.keys.text('askToLook'))}</button>`
          : nothing
      }
      ${look && look.by !== room.member.value ? comeButton() : nothing}
      ${look && look.by === room.member.value ? html`<button @click=${act(() => pointers.ask(null))}>${icon('close')}<span>${say.askNoMore}</span></button>` : nothing}</div>
    <div class="checks">${checkbox(say.ofOthers, !pointers.isHidden.value, false, (isOn) => pointers.hide(!isOn), say.ofOthersIs)}</div></div>`;
}

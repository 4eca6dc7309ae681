// While pointing is on: the place of the mouse, pen or finger in any pane is sent as a patient point.
import { effect, untracked } from '../../../lib/signals-core.js';
import { Pointing } from './pointing.js';
import { isInSpace } from '../../room/kinds.js';
import { PanePick } from '../../pane/pane_pick.js';
import { boxOf, placeOf } from '../../parts/page_look.js';

/** @returns {() => void} stops */
export function startPointing({ room, api, clock, panes }) {
  const { pointers } = room;
  const pointing = new Pointing(pointers, clock);
  const abort = new AbortController();
  const picks = new Map(panes().map((pane, index) => [index + 1, new PanePick(room, api, room.view(index + 1), () => pane.place.box)]));
  let last = null; // where the pointer is: {number, x, y}

  const send = ({ number, x, y }) => {
    const { box } = panes()[number - 1].place;
    const pick = picks.get(number);
    const isIn = x >= box.x && y >= box.y && x <= box.x + box.width && y <= box.y + box.height;
    if (!isIn) pointing.at(number, null);
    else if (!isInSpace(room.view(number).kind)) pointing.at(number, pick.pointAt(x, y));
    else pointing.seen(number, async () => (await pick.seenAt(x, y))?.point_lps_mm ?? null);
  };
  const leave = () => {
    last = null;
    pointing.stop();
  };

  for (const [index, pane] of panes().entries()) {
    const number = index + 1;
    const picture = pane.host.querySelector('.picture');
    const move = (event) => {
      const { left, top } = boxOf(picture);
      const { x, y } = placeOf(event);
      last = { number, x: x - left, y: y - top };
      if (event.pointerType !== 'touch' && event.buttons && isInSpace(room.view(number).kind)) return; // the camera turns
      send(last);
    };
    /** A finger that points does nothing else: the pane does not hear of it. */
    const take = (event) => {
      if (!pointers.isPointing.peek() || !picture.contains(event.target)) return;
      const isFinger = event.pointerType === 'touch';
      if (isFinger) event.stopPropagation();
      if (event.type === 'pointermove' || (isFinger && event.type === 'pointerdown')) move(event);
      else if (isFinger && event.type !== 'pointerdown') last = null; // the place stays until it fades
    };
    for (const type of ['pointerdown', 'pointermove', 'pointerup', 'pointercancel'])
      pane.host.addEventListener(type, take, { signal: abort.signal, capture: true });
    picture.addEventListener('pointerleave', (event) => event.pointerType !== 'touch' && pointers.isPointing.peek() && leave(), {
      signal: abort.signal,
    });
  }

  const stops = [
    effect(() => {
      // what lies under a pointer at rest changes with the picture
      if (!pointers.isPointing.value) return;
      for (const { number, painted, kind } of room.views) {
        const header = painted.value;
        if (header && last?.number === number && (header.is_still || !isInSpace(kind))) untracked(() => send(last));
      }
    }),
    effect(() => {
      const isOn = pointers.isPointing.value;
      document.querySelector('.room')?.classList.toggle('pointing', isOn);
      if (isOn && (!pointers.others.value.length || !pointers.mayPoint.value)) queueMicrotask(() => pointers.stop());
      if (!isOn) untracked(leave);
    }),
  ];
  return () => {
    abort.abort();
    for (const stop of stops) stop();
  };
}

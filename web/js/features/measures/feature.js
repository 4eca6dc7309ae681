// Measures: distances, angles, polylines and ellipses in slices. The code is loaded before the first click, or with the first measure.
import { known, later, laterPart } from '../../parts/lazy.js';
import { isInSpace } from '../../room/kinds.js';
import { crosshair } from '../../room/plan.js';
import { toPicture } from '../../parts/vec.js';
import { Ellipses } from './ellipses.js';
import { say } from './words.js';

const blocks = later(() => import('./later_blocks.js'), 'js/features/image/image.css'); // the sheet of images has the style of measures

const sameMm = 0.05;

const hasMeasures = (scene) => Object.keys(scene?.measures ?? {}).length > 0;

/**
 * Acts of a quick hand between the choice of the tool and the arrival of its code are held and done then, at the same places of the patient: not
 * once another plane is in the picture. Until then nothing else takes it: a line that is drawn moves no crosshair, Enter maximises no pane.
 */
function held(part, { room, ui, box, pointAt }, view) {
  const acts = [];
  const isTool = () => ui.tool.value === 'measure' && !isInSpace(view.kind) && room.canChange.value;
  const isComing = () => acts.length > 0 || (isTool() && !known(blocks));
  const hold = (act) => {
    if (!acts.length)
      blocks.load().then(() => {
        const all = acts.splice(0);
        if (isTool()) for (const each of all) each();
      });
    acts.push(act);
    return true;
  };
  /** A pointer's event where its place in the patient is by now; null: not in the picture. */
  const moved = (event, point) => {
    const [at, { x, y, width, height }] = [toPicture(view.painted.value.clip_from_lps_mm, point), box()];
    const now = at && { ...event, x: x + at[0] * width, y: y + at[1] * height };
    const there = now && pointAt(now.x, now.y);
    return there && Math.hypot(...there.map((mm, axis) => mm - point[axis])) < sameMm ? now : null;
  };
  const holdAt = (event, act) => {
    const point = pointAt(event.x, event.y);
    return hold(() => {
      const now = point && moved(event, point);
      if (now) act(now);
    });
  };
  const pressed = (name) => (event) => (isComing() ? holdAt(event, (now) => part[name](now)) : part[name](event));
  return {
    start: (mode, press) => (mode === 'primary' && isComing() ? holdAt(press, (now) => part.start(mode, now)) : part.start(mode, press)),
    move: (mode, move) => (acts.length ? holdAt(move, (now) => part.move(mode, now)) : part.move(mode, move)),
    end: (at) => (acts.length ? hold(() => part.end(at)) : part.end(at)),
    tap: pressed('tap'),
    doubleTap: pressed('doubleTap'),
    key({ key }, at) {
      if (!['Enter', 'Backspace'].includes(key) || !isComing()) return part.key({ key }, at);
      const point = crosshair(room.scene.value);
      return () => hold(() => part.key({ key }, at, point)?.());
    },
  };
}

/** @type {import('../index.js').Feature} */
export const measures = {
  make(world) {
    world.ellipses = new Ellipses(world.api.ellipse, world.clock);
  },
  sections: [
    {
      id: 'measures',
      name: say.section,
      icon: 'measure',
      place: 8,
      has: (plan, scene) => hasMeasures(scene),
      note: () => '',
      rows: (world) => known(blocks)?.measureRows(world),
    },
  ],
  kinds: { measure: 'measures', measures: '' },
  blocks,
  isSoon: true,
  pane({ room, ui, ellipses, box, pointAt }, view) {
    const part = laterPart(
      () => ui.tool.value === 'measure' || hasMeasures(room.scene.value),
      blocks,
      ({ PaneMeasures }) => new PaneMeasures({ room, ui, ellipses }, view, box, pointAt),
    );
    return { ...part, ...held(part, { room, ui, box, pointAt }, view) };
  },
};

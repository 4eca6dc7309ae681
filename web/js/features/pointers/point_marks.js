// Draws the pointers of the others, the own one in the panes beside, and the point of "look here", into every pane; asks in 3-D what hides them.
import { nothing, svg } from '../../../lib/lit-html.js';
import { effect, signal, untracked } from '../../../lib/signals-core.js';
import { heightOver, stepAcross } from '../../room/obliques.js';
import { crosshair, shownImage } from '../../room/plan.js';
import { say } from './later_words.js';
import { colorOf, fading, isBehind, labelled, lookInSlice, lookInSpace, placeOf } from './pointer_marks.js';
import { isInSpace } from '../../room/kinds.js';
import { mount } from '../../parts/mount.js';
import { PanePick } from '../../pane/pane_pick.js';

const restMs = 300; // a pointer that has not moved for so long is asked about

/** The pointers to draw: {id, name, color, point, movedAt, isLook}. */
function shown({ room }, number) {
  const { pointers } = room;
  const [look, own] = [pointers.look.value, pointers.own.value];
  const list = [];
  if (!pointers.isHidden.value)
    for (const member of pointers.shown.value) {
      const pointer = pointers.all.value.get(member.id);
      if (pointer) list.push({ id: member.id, name: member.name, color: colorOf(member), point: pointer.point, movedAt: pointer.movedAt });
    }
  if (own && own.view !== number)
    list.push({
      id: own.member,
      name: say.you,
      color: colorOf(room.members.value.find(({ id }) => id === own.member) ?? { id: own.member }),
      point: own.point,
      movedAt: own.movedAt,
    });
  if (look) {
    const asker = room.members.value.find(({ id }) => id === look.by) ?? { id: look.by, name: look.by };
    list.push({
      id: `look-${look.number}`,
      name: look.by === room.member.value ? say.youLookHere : say.lookHere({ name: asker.name }),
      color: colorOf(asker),
      point: look.point,
      movedAt: null,
      isLook: true,
    });
  }
  return list;
}

function marksOf(world, pane, number, hidden) {
  const { room, ui, clock } = world;
  const list = shown(world, number);
  if (!list.length) return [];
  const { header, box, pane: size } = pane.place;
  const scene = room.scene.value;
  if (!header || !scene || size[0] < 2) return [];
  void ui.now.value; // drawn again a few times a second, as they fade
  const now = clock.now();
  const { kind } = room.view(number);
  const plane = isInSpace(kind) ? null : pane.actions.plane;
  const half = plane && stepAcross(plane.normal, shownImage(room.plan.value, scene)?.stepMm ?? [1, 1, 1]) / 2;
  const marks = list.flatMap((pointer) => {
    const place = placeOf(header.clip_from_lps_mm, pointer.point, box);
    const look =
      place &&
      (plane ? lookInSlice(heightOver(plane, pointer.point), half) : lookInSpace(hidden.get(`${number} ${pointer.id}`)?.isHidden ?? false));
    const fade = pointer.movedAt === null ? 1 : fading(now - pointer.movedAt);
    return look && fade > 0 ? [{ ...pointer, ...place, ...look, fade }] : [];
  });
  return labelled(marks, size, !plane, world.isWall ? placeOf(header.clip_from_lps_mm, crosshair(scene), box) : null);
}

function drawn({ id, x, y, size, strength, fade, color, text, box, words, isLook }) {
  const r = 8 * size;
  const cross = `M${x - r - 5} ${y}h${5 + r * 0.4}M${x + r + 5} ${y}h${-5 - r * 0.4}M${x} ${y - r - 5}v${5 + r * 0.4}M${x} ${y + r + 5}v${-5 - r * 0.4}`;
  return svg`<g class=${`person-pointer${isLook ? ' look' : ''}`} data-member=${id} data-x=${x.toFixed(2)} data-y=${y.toFixed(2)} data-words=${words} data-strength=${strength.toFixed(2)} opacity=${fade.toFixed(2)}>
    <g opacity=${strength.toFixed(2)}><circle class="under" cx=${x} cy=${y} r=${r} />${isLook ? svg`<path class="under" d=${cross} /><path d=${cross} stroke=${color} />` : nothing}
      <circle cx=${x} cy=${y} r=${r} stroke=${color} stroke-dasharray=${words ? '3 2.5' : nothing} /><circle class="tip" cx=${x} cy=${y} r=${1.6 * size} fill=${color} /></g>
    <g class="label" opacity=${Math.max(strength, 0.8).toFixed(2)}><rect x=${box.x} y=${box.y} width=${box.width} height=${box.height} rx="4" stroke=${color} /><text x=${box.x + box.width / 2} y=${box.y + 14} text-anchor="middle">${text}</text></g></g>`;
}

/** @param {object} world {room, ui, api, clock, panes} @returns {() => void} stops */
export function startMarks(world) {
  const hidden = signal(new Map()); // "view id" of a pointer -> {of: what was asked about, isHidden}
  const layers = world
    .panes()
    .map((pane, index) =>
      mount(pane.host.querySelector('.pointers'), () => svg`${marksOf(world, pane, index + 1, hidden.value).map(drawn)}`),
    );
  const stop = askDepths(world, hidden);
  return () => {
    stop();
    for (const stopLayer of layers) stopLayer();
  };
}

/**
 * Asks for each pointer at rest, in each 3-D picture at rest, whether what is seen at its pixel lies before it; one question at a time.
 * While pointer or picture move, the last answer holds.
 */
function askDepths(world, hidden) {
  const { room, api, clock, panes } = world;
  const picks = panes().map((pane, index) => new PanePick(room, api, room.view(index + 1), () => pane.place.box));
  let isAsking = false;
  let timer = 0;
  let isStopped = false;

  /** The next question; none: in how many ms there may be one. */
  const next = (answers) => {
    const now = clock.now();
    let waitMs = Infinity;
    for (const { number, kind, isOpen, painted } of room.views) {
      const header = painted.value;
      if (!isInSpace(kind) || !isOpen.value || !header?.is_still) continue;
      for (const { id, point, movedAt } of shown(world, number)) {
        const of = `${header.scene_revision} ${header.clip_from_lps_mm} ${point}`;
        if (answers.get(`${number} ${id}`)?.of === of) continue;
        const restsInMs = movedAt === null ? 0 : movedAt + restMs - now;
        if (restsInMs > 0) waitMs = Math.min(waitMs, restsInMs);
        else return { key: `${number} ${id}`, of, number, point, header };
      }
    }
    return { waitMs };
  };

  const run = async () => {
    clock.clearTimeout(timer);
    if (isAsking || isStopped) return;
    const { key, of, number, point, header, waitMs } = next(hidden.peek());
    if (!key) return void (waitMs < Infinity && (timer = clock.setTimeout(run, waitMs)));
    const matrix = header.clip_from_lps_mm;
    const place = placeOf(matrix, point, panes()[number - 1].place.box);
    isAsking = true;
    // a question that fails leaves the last answer
    const hit = place && (await picks[number - 1].seenAt(place.x, place.y).catch(() => undefined));
    isAsking = false;
    const isHidden = hit === undefined ? (hidden.peek().get(key)?.isHidden ?? false) : isBehind(matrix, point, hit?.point_lps_mm ?? null);
    const ids = new Set(room.views.flatMap((view) => shown(world, view.number).map(({ id }) => `${view.number} ${id}`)));
    hidden.value = new Map([...hidden.peek(), [key, { of, isHidden }]].filter(([known]) => ids.has(known)));
    run();
  };
  const stop = effect(() => {
    for (const { number, painted } of room.views) void [painted.value, shown(world, number)];
    untracked(run);
  });
  return () => {
    isStopped = true;
    clock.clearTimeout(timer);
    stop();
  };
}

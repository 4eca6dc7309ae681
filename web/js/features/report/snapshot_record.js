// Record in an annotated snapshot: plan, revision, scene and view (server/wire/snapshot_record.h). Reading it from a
// file, and showing it again in a room.
import { isPng, maxFileBytes, textOfPng } from '../../net/png.js';
import { isId, readDocument } from '../../wire/check.js';
import { isObject } from '../../wire/merge.js';
import { adopted } from '../../room/marks.js';
import { mergedScene } from '../../room/scene_merge.js';
import { say } from './later_words.js';

export { toldOfMerge } from '../../room/scene_merge.js';

const keyword = 'beamroom';
const version = 1;
const longestName = 200;

/**
 * @typedef {object} SnapshotRecord
 * @property {{id: string, name: string}} plan @property {string} date ISO 8601 @property {number} revision 0: no room's
 * @property {object} scene complete @property {object} view complete, without override
 */

/** @param {string} text JSON @returns {SnapshotRecord} checked; throws an Error with a sentence */
export function readRecord(text) {
  let json;
  try {
    json = JSON.parse(text);
  } catch {
    throw new Error(say.damaged);
  }
  if (!isObject(json) || !isObject(json.plan) || !isId(json.plan.id)) throw new Error(say.saysNoPlan);
  if (json.version !== version) throw new Error(say.otherVersion);
  try {
    const scene = readDocument('scene', json.scene);
    const view = readDocument('view', json.view);
    const name = typeof json.plan.name === 'string' ? json.plan.name.slice(0, longestName) : '';
    const date = typeof json.date === 'string' && Number.isFinite(Date.parse(json.date)) ? new Date(json.date).toISOString() : '';
    const revision = Number.isInteger(json.revision) && json.revision >= 0 && json.revision < 2 ** 32 ? json.revision : 0;
    return { plan: { id: json.plan.id, name: name || json.plan.id }, date, revision, scene, view };
  } catch (error) {
    throw new Error(say.notValid({ why: error.message }));
  }
}

/**
 * @param {Blob} file
 * @returns {Promise<SnapshotRecord|null>} null: no PNG; throws an Error with a sentence when it is one that cannot be shown
 */
export async function recordOfFile(file) {
  const first = new Uint8Array(await file.slice(0, 8).arrayBuffer());
  if (!isPng(first)) return null;
  if (file.size > maxFileBytes) throw new Error(say.tooLarge);
  const text = await textOfPng(new Uint8Array(await file.arrayBuffer()), keyword);
  if (text === null) throw new Error(say.noRecord);
  return readRecord(text);
}

const isEqual = (a, b) => JSON.stringify(a) === JSON.stringify(b);

/** The patch with the fields of wanted that differ; fields that only now has stay. */
export function difference(now, wanted) {
  const patch = {};
  for (const [name, value] of Object.entries(wanted)) {
    const before = Object.hasOwn(now, name) ? now[name] : undefined;
    if (isEqual(before, value)) continue;
    const inner = isObject(before) && isObject(value) ? difference(before, value) : value;
    if (!isObject(inner) || Object.keys(inner).length) patch[name] = inner;
  }
  return patch;
}

/**
 * Shows the record's scene, and its camera in the view of its kind, as changes of this person: one step to undo. A view that no pane
 * shows, as the oblique one, takes the place of the active one.
 * @param {object} world {room, ui, undo} @returns what of the room's scene it hid or left: mergedScene
 */
export function restore({ room, ui, undo }, record) {
  const { kind, number, plane, camera, beam } = record.view;
  const view =
    room.views.find((other) => other.kind === kind && other.ofKind === number) ?? room.views.find((other) => other.kind === kind);
  const merge = mergedScene(room.scene.value, record.scene);
  const scene = adopted(difference(room.scene.value, merge.scene), room.scene.value, room.member.value);
  undo?.press();
  if (Object.keys(scene).length) room.patchScene(scene, { view: view.number });
  room.patchView(view.number, kind === 'oblique' ? { camera, plane } : kind === 'beam' ? { camera, beam } : { camera });
  undo?.release();
  if (!ui.maximised.value && !ui.visible.value.includes(view.number)) ui.showInPlaceOf(ui.active.value, view.number);
  ui.active.value = view.number;
  if (ui.maximised.value) ui.maximised.value = view.number;
  return merge;
}

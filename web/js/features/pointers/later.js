// Pointing, loaded when somebody else is in the room.
import { startLook } from './look_here.js';
import { startMarks } from './point_marks.js';
import { startPointing } from './point_gesture.js';
import { startWatch } from '../watch/start_watch.js';

export { askToLook } from './look_here.js';
export { pointTools } from './point_tools.js';

/** @param {object} world {room, ui, api, clock, panes, storage, connection, decode} @returns {() => void} stops */
export function start(world) {
  world.room.pointers.hide = world.room.pointers.keepIn(world.storage);
  const stops = [startMarks(world), startPointing(world), startLook(world), startWatch(world)];
  return () => stops.forEach((stop) => stop());
}

// The name of a room: the one that it was given, else that of its plan and of its first day.
import { signal } from '../../lib/signals-core.js';
import { roomName } from '../parts/when.js';

const begun = new WeakMap(); // by room: a signal of when it was made

/** @param {{room: import('./room.js').RoomState, api: object}} world */
export function roomCalled({ room, api }) {
  const plan = room.plan.value;
  if (!begun.has(room)) {
    begun.set(room, signal(''));
    api.room(room.id).then(
      ({ created_at }) => {
        begun.get(room).value = created_at;
      },
      () => {},
    );
  }
  const title = plan?.treatmentPlans[plan.shownPlan]?.label || plan?.name || room.planId.value;
  const created_at = begun.get(room).value;
  return room.name.value || (created_at ? roomName({ name: '', created_at }, title) : title);
}

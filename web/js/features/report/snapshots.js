// Snapshots: the camera button, and annotated pictures that are dropped on the page or for which a room was opened.
import { html, nothing } from '../../../lib/lit-html.js';
import { effect } from '../../../lib/signals-core.js';
import { filesOfDrop } from '../../net/dropped.js';
import { icon } from '../../parts/icons.js';
import { later } from '../../parts/lazy.js';
import { say } from './words.js';

export const code = later(() => import('./later_snapshots.js'));

/** Its exports. Throws when it cannot be loaded. */
async function load() {
  await code.load();
  if (!code.loaded.peek()) throw new Error(say.cannotRead);
  return code.loaded.peek();
}

export function snapshotMenu(world) {
  const { ui, room } = world;
  if (!room.control.mayExport) return nothing;
  const isOpen = ui.popover.value === 'snapshot';
  return html`<span class="anchor"><button class="tool plain" tabindex="-1" title=${say.snapshotOf} aria-label=${say.snapshot} aria-haspopup="menu"
      aria-expanded=${isOpen} @click=${() => ui.toggle('snapshot')}>${icon('camera')}</button>
    ${isOpen ? code.draw(({ menu }) => menu(world)) : nothing}</span>`;
}

// ---- pictures that come back ------------------------------------------------------------------------------------------

export const pendingKey = (room) => `snapshot ${room}`;

/** Shows annotated pictures that are dropped anywhere on the room's page. @returns {() => void} stops */
export function listenSnapshots(world, target = globalThis) {
  const abort = new AbortController();
  const isFiles = (event) => event.dataTransfer?.types.includes('Files');
  const drop = async (data) => {
    try {
      const files = filesOfDrop(data); // at once: what was dropped is gone after the event
      await (await load()).showFirst(world, await files);
    } catch (error) {
      world.ui.notify('err', error.message, 'snapshot');
    }
  };
  target.addEventListener(
    'dragover',
    (event) => {
      if (isFiles(event)) event.preventDefault();
    },
    { signal: abort.signal },
  );
  target.addEventListener(
    'drop',
    (event) => {
      if (!isFiles(event)) return;
      event.preventDefault();
      drop(event.dataTransfer);
    },
    { signal: abort.signal },
  );
  return () => abort.abort();
}

/** Shows the picture that this room was opened for, once its plan is loaded. @returns {() => void} stops */
export function resumeSnapshot(world) {
  const text = sessionStorage.getItem(pendingKey(world.room.id));
  if (!text) return () => {};
  let isShown = false;
  return effect(() => {
    if (isShown || !world.room.canChange.value || !world.room.plan.value) return;
    isShown = true;
    sessionStorage.removeItem(pendingKey(world.room.id));
    load()
      .then(({ show }) => show(world, JSON.parse(text)))
      .catch((error) => world.ui.notify('err', error.message, 'snapshot'));
  });
}

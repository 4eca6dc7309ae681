// The words of snapshots before their menu is opened.
import { sentences } from '../../parts/sentences.js';

export const say = sentences('report', {
  snapshot: 'Snapshot',
  snapshotOf: 'Snapshot of the active pane',
  cannotRead: 'The picture cannot be read: the server does not answer.',
});

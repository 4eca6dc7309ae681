// The record of the review. The rest comes when its tab is opened.
import { later } from '../../parts/lazy.js';
import { say } from './words.js';

const tab = later(() => import('./record_tab.js'), 'js/features/notes/notes.css', 'js/features/record/record.css');

/** @type {import('../index.js').Feature} */
export const record = { tabs: [{ id: 'record', name: say.tab, draw: (world) => tab.draw(({ recordTab }) => recordTab(world)) }] };

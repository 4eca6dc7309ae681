// The record of the review on the page: what a first visit loads of it. The rest comes when its tab is opened.
import { Lazy, styled } from '../../parts/lazy.js';

const record = new Lazy(
  async () =>
    (await Promise.all([import('./record_tab.js'), styled('js/features/notes/notes.css'), styled('js/features/record/record.css')]))[0],
);

/** The inspector's Record. */
export const drawRecord = (world) => record.draw(({ recordTab }) => recordTab(world));

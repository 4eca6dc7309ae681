// The sections of the tree, which features have. A section without rows is not shown.
import { features } from '../features/index.js';

/** The sections of this plan, and of what the scene has besides. @returns {import('../features/index.js').Section[]} */
export const sectionsOf = (plan, scene) =>
  plan
    ? features
        .flatMap(({ sections = [] }) => sections)
        .filter((section) => section.has(plan, scene))
        .sort((a, b) => a.place - b.place)
    : [];

/** The section in which a row for a selection of this kind is; '' or undefined: none. */
export const sectionOf = (kind) => features.find(({ kinds }) => kinds && kind in kinds)?.kinds[kind];

// Which univels of a region count in its figures. Pure.

/** "own univels, without regions inside", "whole region"; '' not known. */
export const populationWords = (population) => ({ own: 'own univels, without regions inside', whole: 'whole region' })[population] ?? '';

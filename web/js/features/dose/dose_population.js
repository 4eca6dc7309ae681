// Which univels of a region count in its figures. Pure.
import { say } from './data_words.js';

/** "own univels, without regions inside", "whole region"; '' not known. */
export const populationWords = (population) => ({ own: say.own, whole: say.whole })[population] ?? '';

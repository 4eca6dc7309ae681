// The words of undo is called in proto/scene.json, in English; a language has its words under "undo", by the English ones.
import { undoWords } from '../../gen/undo_words.js';
import { sentences } from '../parts/sentences.js';

const wordsIn = (tree) => Object.values(tree).flatMap((value) => (typeof value === 'object' ? wordsIn(value) : value));

export const say = sentences('undo', Object.fromEntries(wordsIn(undoWords).map((word) => [word, word])));

// The words of a CSV file that cannot be read, and of times in lists.
import { sentences } from './sentences.js';

export const say = sentences('parts.later', {
  quoteInside: 'Line {line}: a quotation mark inside a field.',
  afterQuote: 'Line {line}: text after a quotation mark.',
  roomOfDay: '{plan}, {day}',
  yesterday: 'yesterday {time}',
  quoteOpen: 'Line {line}: a quotation mark is not closed.',
});

// The words of a CSV file that cannot be read, of times in lists, and of who stated an identity.
import { sentences } from './sentences.js';

export const say = sentences('parts.later', {
  quoteInside: 'Line {line}: a quotation mark inside a field.',
  afterQuote: 'Line {line}: text after a quotation mark.',
  roomOfDay: '{plan}, {day}',
  yesterday: 'yesterday {time}',
  statedBy: 'stated by {by}, {date}',
  quoteOpen: 'Line {line}: a quotation mark is not closed.',
});

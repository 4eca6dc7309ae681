// The words of the small things that all of the page uses.
import { sentences } from './sentences.js';

export const say = sentences('parts', {
  windowInverted: '{window}  low white',
  counts: 'counts',
  relativeCounts: 'relative counts',
  suv: '{unit} (SUV)',
  standardDeviations: 'standard deviations',
  modifiedUnit: '{unit} (modified)',
  fromSourceEnd: '{distance} from source end',
  beforeSourceEnd: '{distance} before source end',
  and: '{names} and {last}',
  andMore: '{names} and {n} more',
  notLoaded: 'This part of the page could not be loaded.',
  tryAgain: 'Try again',
  loading: 'Loading …',
  error: 'Error',
  warning: 'Warning',
  note: 'Note',
  nothing: 'Nothing was noticed while loading.',
  codeIs: 'What it means and what to do',
  moreDropped: '{n} more are not kept.',
  shown: 'shown',
  hidden: 'hidden',
});

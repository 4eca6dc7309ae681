// The words of size and colours of the page.
import { sentences } from '../parts/sentences.js';

export const say = sentences('shell.look', {
  pageSize: 'Size of the page',
  percent: '{n} %',
  pageColours: 'Colours',
  dark: 'Dark',
  light: 'Light',
  asSystem: 'As the system',
});

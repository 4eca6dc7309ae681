// Small parts that the people panel and its links share.
import { html, nothing } from '../../../lib/lit-html.js';
import { rolesUpTo } from './people_state.js';
import { say } from './people_words.js';

export const errorOf = (state, form) =>
  state.error.value[form] ? html`<p class="err" role="alert">${state.error.value[form]}</p>` : nothing;

/** The roles that this member may give. */
export const roleOptions = (room) =>
  rolesUpTo(room.control.role.value).map((role) => html`<option value=${role} ?selected=${role === 'reviewer'}>${say[role]}</option>`);

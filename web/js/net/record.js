// The record of a room's review, from the HTTP API; apart from api.js, as a first visit does not need it.
import { ofMember, Problem } from './api.js';
import { say } from './words.js';

/** Fetches a room's record. An export is recorded as one. @param {string} room its id @param {{member: string, secret: string}} identity of who asks */
export async function fetchRecord(room, identity, isExport = false) {
  const response = await fetch(`/api/v1/rooms/${room}/record?export=${isExport}`, { headers: ofMember(identity) }).catch(() => {
    throw new Problem({ detail: say.noAnswer });
  });
  const answer = await response.json().catch(() => null);
  if (!response.ok || !answer) throw new Problem({ status: response.status, ...(answer ?? { detail: say.answered(response) }) });
  return answer;
}

const pathOf = (id) => `/api/v1/records/${encodeURIComponent(id)}`;

/** Fetches the record of a decision as paper; recorded as an export. @param {string} id of the decision @param {boolean} isNamed with the patient's name */
export async function fetchPaper(id, isNamed) {
  const response = await fetch(`${pathOf(id)}/paper?identity=${isNamed}`).catch(() => {
    throw new Problem({ detail: say.noAnswer });
  });
  const answer = await response.json().catch(() => null);
  if (!response.ok || !answer) throw new Problem({ status: response.status, ...(answer ?? { detail: say.answered(response) }) });
  return answer;
}

/** Where a kept picture is. @param {number} place from 0 on */
export const pathOfFigure = (id, place) => `${pathOf(id)}/figures/${place + 1}`;
export const pathOfPdf = (id, isNamed) => `${pathOf(id)}/record.pdf?identity=${isNamed}`;

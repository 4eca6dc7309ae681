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

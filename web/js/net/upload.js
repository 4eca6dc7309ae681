// Uploads a plan. By XMLHttpRequest, as only that reports how much has been sent.
import { told } from '../parts/sentences.js';
import { Problem } from './api.js';
import { say } from './words.js';

/**
 * @param {{makeRequest: () => XMLHttpRequest, url: string, body: Blob, type: string, onSent: (bytes: number) => void, signal: AbortSignal}} task
 * @returns {Promise<object>} the job that unpacks it
 */
export function sendPlan({ makeRequest, url, body, type, onSent, signal }) {
  return new Promise((resolve, reject) => {
    const request = makeRequest();
    const answer = () => {
      try {
        return told(JSON.parse(request.responseText));
      } catch {
        return null;
      }
    };
    request.open('POST', url);
    request.setRequestHeader('Content-Type', type);
    request.upload.addEventListener('progress', (event) => onSent(event.loaded));
    request.addEventListener('load', () => {
      if (request.status === 202 && answer()) resolve(answer());
      else reject(new Problem({ status: request.status, ...(answer() ?? { detail: say.answered(request) }) }));
    });
    request.addEventListener('error', () => reject(answer() ? new Problem(answer()) : new Problem({ detail: say.broke })));
    request.addEventListener('abort', () => reject(new Problem({ detail: say.cancelled })));
    signal.addEventListener('abort', () => request.abort());
    request.send(body);
  });
}

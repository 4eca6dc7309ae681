// Signing in at the hospital, in place of this page or in a small window beside it.
import { send } from './password_form.js';

const channel = 'beamroom sign-in';
const lookMs = 2000;

/** The address that the proxy protects. @param {string} path where it leads back to */
export const proxyPath = (path) => `/signin/proxy?return=${encodeURIComponent(path)}`;

/** Tells the page that opened this window. */
export function tellDone() {
  const told = new BroadcastChannel(channel);
  told.postMessage('done');
  told.close();
}

/** Opens the window; calls back with the session once somebody has signed in. @param {(answer: object) => unknown} isDone whether the session is that of a new sign-in: who proves it once more is signed in already @returns {(() => void)|null} stops; null: the browser did not open it */
export function openWindow(signedIn, isDone = ({ identity }) => identity) {
  const opened = window.open(proxyPath('/signin/done'), 'beamroom-sign-in', 'popup,width=520,height=700');
  if (!opened) return null;
  const told = new BroadcastChannel(channel);
  let isStopped = false;
  const stop = () => {
    isStopped = true;
    clearInterval(timer);
    told.close();
  };
  const look = async () => {
    const { status, answer } = await send('GET', 'session');
    if (isStopped || status !== 200 || !isDone(answer)) return;
    stop();
    opened.close();
    signedIn(answer);
  };
  const timer = setInterval(look, lookMs); // a browser that keeps the windows apart tells nothing
  told.onmessage = look;
  return stop;
}

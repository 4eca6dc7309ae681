import { proves } from './checks.mjs';

proves('Caddy');
proves('Caddy with forward_auth');

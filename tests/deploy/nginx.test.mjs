import { proves } from './checks.mjs';

proves('nginx');
proves('nginx with auth_request');

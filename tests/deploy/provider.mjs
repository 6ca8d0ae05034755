// A provider of OpenID Connect that signs in whoever comes: node provider.mjs PORT PERSON
// PERSON: a JSON file with the claims of who comes next. "gone": the provider knows this person no more.
import { readFileSync } from 'node:fs';
import { argv } from 'node:process';
import { OAuth2Server } from 'oauth2-mock-server';

const [port, file] = argv.slice(2);
const ACCESS_S = 30; // less than what Apache refreshes at
const person = () => JSON.parse(readFileSync(file, 'utf8'));
const server = new OAuth2Server();
await server.issuer.keys.generate('RS256');
let refreshed = 0;
server.service.on('beforeResponse', (answer, { body }) => {
  if (person().gone) Object.assign(answer, { statusCode: 400, body: { error: 'invalid_grant' } });
  else answer.body.expires_in = ACCESS_S;
  if (body.grant_type === 'refresh_token') console.log(`refresh ${++refreshed}: ${answer.statusCode}`);
});
server.service.on('beforeUserinfo', (answer) => {
  const { gone, ...claims } = person();
  if (gone) Object.assign(answer, { statusCode: 401, body: { error: 'invalid_token' } });
  else Object.assign(answer.body, claims);
});
await server.start(Number(port), '127.0.0.1');
console.log(`issuer ${server.issuer.url}`);

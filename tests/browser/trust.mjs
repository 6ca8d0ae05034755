// Tokens in the page, in a real Chromium: node --test tests/browser/trust.mjs
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { randomBytes } from "node:crypto";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { createServer, request } from "node:http";
import { connect } from "node:net";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, describe, test } from "node:test";
import {
  connected,
  isPaused,
  openPage,
  pausedIs,
  settled,
  startBrowser,
  until,
} from "./pages.mjs";
import { BINARY, startServer } from "./server.mjs";

let browser, folder, key, server;
before(async () => {
  folder = mkdtempSync(join(tmpdir(), "brume-"));
  key = join(folder, "token.key");
  writeFileSync(key, randomBytes(32), { mode: 0o600 });
  browser = await startBrowser();
  server = await startServer("--token-key", key);
});
after(async () => {
  await browser?.close();
  if (server) assert.equal(await server.stop(), 0, "the server’s exit");
  if (folder) rmSync(folder, { recursive: true });
});

const token = (role, seconds = 600) =>
  execFileSync(BINARY, [
    "--token-key",
    key,
    "--make-token",
    role,
    "--valid-for",
    String(seconds),
  ])
    .toString()
    .trim();

const disabled = (page, id) =>
  page.evaluate((name) => document.getElementById(name).disabled, id);
const inert = (page) =>
  page.evaluate(() =>
    Object.fromEntries(
      [...document.querySelectorAll("#panel details")].map((part) => [
        part.querySelector("summary").textContent,
        part.inert,
      ]),
    ),
  );

describe("a server with a key", () => {
  test("without a token the page says what is missing", async (t) => {
    const page = await openPage(t, browser, server.url);
    await until(page, "it is refused", (brume) => brume.state === "refused");
    const text = await page.evaluate(
      () => document.getElementById("curtain").innerText,
    );
    assert.match(text, /may not look here/);
    assert.match(text, /A token is needed/);
    await page.leave();
  });

  test("a viewer looks, its token leaves the address bar, and what it may not do is off", async (t) => {
    const mine = token("viewer");
    const page = await openPage(
      t,
      browser,
      `${server.url}/?predict=0#token=${mine}`,
    );
    assert.equal(
      await page.evaluate(() => location.href),
      `${server.url}/?predict=0`,
    );
    await connected(page);
    await settled(page);
    assert.ok(await disabled(page, "tool-push"));
    assert.ok(await disabled(page, "tool-pause"));
    const parts = await inert(page);
    for (const part of ["Light", "Medium", "Render", "Simulation"])
      assert.equal(parts[part], true, part);
    assert.equal(parts["Picture, yours alone"], false);
    const { tick } = await page.evaluate(() => window.brume.scene);
    await page.keyboard.press("p");
    await until(
      page,
      "the scene is told again, a second later",
      (brume, old) => brume.scene.tick > old + 60,
      tick,
    );
    assert.equal(await isPaused(page), false);
    // Loaded again, the tab still has it; the server never wrote it down.
    await page.reload();
    await connected(page);
    assert.ok(
      !server.output().includes(mine.slice(0, 20)),
      "a token in the log",
    );
    await page.leave();
  });

  test("a controller pauses, an operator may do everything", async (t) => {
    const page = await openPage(
      t,
      browser,
      `${server.url}/#token=${token("controller")}`,
    );
    await connected(page);
    assert.ok(!(await disabled(page, "tool-pause")));
    const parts = await inert(page);
    assert.deepEqual(
      [parts["Light"], parts["Simulation"], parts["Render"]],
      [false, false, true],
    );
    await page.keyboard.press("p");
    await until(page, "it is paused", pausedIs, true);
    const guest = await openPage(
      t,
      browser,
      `${server.url}/#token=${token("viewer")}`,
    );
    await guest
      .locator("#status-text", { hasText: "Paused: a controller can resume" })
      .waitFor();
    await guest.leave();
    const chief = await openPage(
      t,
      browser,
      `${server.url}/#token=${token("operator")}`,
    );
    await connected(chief);
    assert.ok(Object.values(await inert(chief)).every((part) => !part));
    await chief.keyboard.press("p");
    await until(page, "it goes on", pausedIs, false);
    await chief.leave();
    await page.leave();
  });

  test("a controller drags what is in the scene, a viewer sees no handle of it", async (t) => {
    const openSpheres = async (role) => {
      const page = await openPage(
        t,
        browser,
        `${server.url}/#token=${token(role)}`,
      );
      await connected(page);
      await page.locator("#tool-panel").click();
      const group = page
        .locator("#panel details")
        .filter({ has: page.getByText("Spheres", { exact: true }) });
      await group.locator("summary").click();
      return { page, group };
    };
    const { page, group } = await openSpheres("controller");
    const guest = await openSpheres("viewer");
    await group.getByRole("button", { name: "Add" }).click();
    await page.getByRole("button", { name: "Move sphere 1" }).waitFor();
    await guest.group.getByRole("combobox", { name: "Sphere" }).waitFor(); // the guest knows of it
    assert.equal(await guest.page.locator("#handles button").count(), 0);
    await group.getByRole("button", { name: "Remove" }).click();
    await page.locator("#handles button").waitFor({ state: "detached" });
    const { frames } = await page.evaluate(() => window.brume);
    await until(
      page,
      "shaders are compiled",
      (brume, before) => brume.frames > before + 1,
      frames,
      60_000,
    );
    await guest.page.leave();
    await page.leave();
  });

  test("a forged token is told apart from none", async (t) => {
    const page = await openPage(
      t,
      browser,
      `${server.url}/#token=${token("viewer").slice(0, -4)}AAAA`,
    );
    await until(page, "it is refused", (brume) => brume.state === "refused");
    assert.match(
      await page.evaluate(() => document.getElementById("curtain").innerText),
      /not made with this server/,
    );
    await page.leave();
  });
});

// The certificate is made by the program `openssl`; Chromium is told to trust it.
test("over https the page speaks wss", async (t) => {
  const chain = join(folder, "certificate.pem");
  const secret = join(folder, "key.pem");
  const made =
    "req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 1 -subj /CN=localhost".split(
      " ",
    );
  made.push(
    "-addext",
    "subjectAltName=IP:127.0.0.1",
    "-out",
    chain,
    "-keyout",
    secret,
  );
  execFileSync("openssl", made, { stdio: "ignore" });
  const secure = await startServer(
    "--token-key",
    key,
    "--tls-certificate",
    chain,
    "--tls-key",
    secret,
  );
  t.after(() => secure.stop());
  assert.match(secure.url, /^https:/);
  const page = await openPage(
    t,
    browser,
    `${secure.url}/#token=${token("viewer")}`,
    { ignoreHTTPSErrors: true },
  );
  await connected(page);
  await settled(page);
  await page.leave();
  assert.equal(await secure.stop(), 0, "the server’s exit");
});

// A proxy that passes on either WebSockets or the Host header. Returns its port.
async function proxyTo(t, target, upgrades) {
  const { hostname, port, host: own } = new URL(target);
  const sockets = new Set();
  const proxy = createServer((incoming, outgoing) => {
    const headers = {
      ...incoming.headers,
      host: upgrades ? own : incoming.headers.host,
    };
    const onward = request(
      { hostname, port, path: incoming.url, method: incoming.method, headers },
      (answer) =>
        answer.pipe(outgoing.writeHead(answer.statusCode, answer.headers)),
    );
    onward.on("error", () => outgoing.destroy());
    incoming.pipe(onward);
  });
  proxy.on("connection", (socket) => sockets.add(socket));
  proxy.on("upgrade", (incoming, socket) => {
    const headers = upgrades
      ? { ...incoming.headers, host: own }
      : { ...incoming.headers, upgrade: "none", connection: "close" };
    const lines = Object.entries(headers).map(
      ([name, value]) => `${name}: ${value}`,
    );
    const onward = connect(port, hostname);
    onward.write(
      [`GET ${incoming.url} HTTP/1.1`, ...lines, "", ""].join("\r\n"),
    );
    for (const end of [onward, socket]) end.on("error", () => end.destroy());
    onward.pipe(socket).pipe(onward);
  });
  await new Promise((resolve) => proxy.listen(0, "127.0.0.1", resolve));
  t.after(() => {
    for (const socket of sockets) socket.destroy();
    proxy.close();
  });
  return proxy.address().port;
}

describe("a proxy that changes what it passes on", () => {
  for (const [what, upgrades, said] of [
    ["the host", true, /does not pass the Host header/],
    ["no WebSockets", false, /does not pass WebSockets on/],
  ])
    test(`${what}: the page says so`, async (t) => {
      const port = await proxyTo(t, server.url, upgrades);
      const page = await openPage(
        t,
        browser,
        `http://127.0.0.1:${port}/#token=${token("viewer")}`,
      );
      await until(page, "it is refused", (brume) => brume.state === "refused");
      assert.match(
        await page.evaluate(() => document.getElementById("curtain").innerText),
        said,
      );
      await page.leave();
    });
});

describe("a page of another origin", () => {
  test("its element says that it is not allowed, and the log says which", async (t) => {
    const site = createServer((incoming, outgoing) => {
      outgoing.setHeader("content-type", "text/html");
      outgoing.end("<!doctype html><title>elsewhere</title>");
    });
    await new Promise((resolve) => site.listen(0, "127.0.0.1", resolve));
    t.after(() => site.close());
    const origin = `http://127.0.0.1:${site.address().port}`;
    const page = await browser.newPage();
    await page.goto(origin);
    const answer = await page.evaluate(async (url) => {
      const said = await fetch(`${url}/ws`);
      return [
        said.status,
        said.headers.get("brume-refused"),
        await said.text(),
      ];
    }, server.url);
    assert.deepEqual(answer.slice(0, 2), [403, "origin"]);
    assert.match(answer[2], new RegExp(`--allow-origin ${origin}`));
    assert.ok(server.output().includes(`a page of ${origin} was refused`));
    await page.close();
  });
});
